"""The schemas written down are those of the values that become JSON."""

import json

from comparisons.schemas.__main__ import FOLDER, schemas


def test_every_form_has_its_schema_written_down_under_its_version_and_every_schema_its_form():
    found = {file.stem: json.loads(file.read_text()) for file in FOLDER.glob("*.json")}
    assert found == schemas(), "python -m comparisons.schemas writes them"
