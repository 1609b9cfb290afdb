"""The schemas written down are those of the values that become JSON."""

import json

import pytest

from comparisons.advice import Choice
from comparisons.running.provenance import PROJECT_FOLDER
from comparisons.sheet.score import Score


@pytest.mark.parametrize("kind", [Choice, Score])
def test_a_schema_is_written_down_under_its_version(kind):
    version = kind.model_fields["schema_"].default
    file = PROJECT_FOLDER / "comparisons" / "schemas" / f"{version.replace(' ', '-')}.json"
    assert json.loads(file.read_text()) == kind.model_json_schema(mode="serialization", by_alias=True)
    assert "schema" in kind.model_json_schema(mode="serialization", by_alias=True)["properties"]
