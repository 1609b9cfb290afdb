"""The schemas written down are those of the values that become JSON."""

import json

from comparisons.advice import Choice
from comparisons.running.provenance import PROJECT_FOLDER
from comparisons.schemas.advice import BearingSearch, Design, Margins
from comparisons.schemas.runs import Comparison, New, Record, Report, Run, Sheet, Verification
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
    BearingSearch,
    Verification,
)


def test_every_form_has_its_schema_written_down_under_its_version_and_every_schema_its_form():
    found = {file.stem: json.loads(file.read_text()) for file in FOLDER.glob("*.json")}
    schemas = [form.model_json_schema(mode="serialization", by_alias=True) for form in FORMS]
    assert found == {schema["properties"]["schema"]["default"].replace(" ", "-"): schema for schema in schemas}
