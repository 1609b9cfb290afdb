"""The schemas written down are those of the values that become JSON."""

import json

import pytest

from comparisons.advice import Choice
from comparisons.running.provenance import PROJECT_FOLDER
from comparisons.schemas.advice import Design, Margins, SuitedBearings
from comparisons.schemas.inputs import New, Record
from comparisons.schemas.results import Report, Sheet, Verification
from comparisons.schemas.runs import Comparison, Run
from comparisons.schemas.study import StudyResult
from comparisons.sheet.score import Score

FOLDER = PROJECT_FOLDER / "comparisons" / "schemas"
FORMS = (
    Choice,
    Comparison,
    Design,
    Margins,
    New,
    Record,
    Report,
    Run,
    Score,
    Sheet,
    StudyResult,
    SuitedBearings,
    Verification,
)


def name(form):
    return f"{form.model_fields['schema_'].default.replace(' ', '-')}.json"


@pytest.mark.parametrize("form", FORMS)
def test_a_schema_is_written_down_under_its_version(form):
    schema = form.model_json_schema(mode="serialization", by_alias=True)
    assert json.loads((FOLDER / name(form)).read_text()) == schema
    assert "schema" in schema["properties"]


def test_every_schema_has_its_form():
    assert {file.name for file in FOLDER.glob("*.json")} == {name(form) for form in FORMS}
