"""The command ``python -m comparisons.schemas``, which writes the schemas after a change of the types."""

import json
from pathlib import Path
from typing import Any

from . import schema_of
from .advice import BearingSearch, Choice, Design, Margins, Risk
from .runs import Comparison, New, Record, Report, Run, Sheet, StudyResult, Verification

FOLDER = Path(__file__).parent
FORMS = (
    *(Choice, Comparison, Design, Margins, New, Record, Report, Risk, Run, Sheet, StudyResult),
    *(BearingSearch, Verification),
)


def schemas() -> dict[str, dict[str, Any]]:
    """Return {file name without ending: schema} of every form."""
    written = [schema_of(form) for form in FORMS]
    return {schema["properties"]["schema"]["default"].replace(" ", "-"): schema for schema in written}


if __name__ == "__main__":
    for name, schema in schemas().items():
        (FOLDER / f"{name}.json").write_text(json.dumps(schema, indent=2) + "\n", encoding="utf-8")
