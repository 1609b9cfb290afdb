"""The command ``python -m comparisons.schemas``, which writes the schemas after a change of the types."""

import json
from typing import Any

from ..execution.results import PROJECT_FOLDER
from ..execution.writing import write_all
from . import schema_of
from .advice import BearingSearch, Choice, Design, Margins
from .runs import Comparison, New, Record, Report, Run, Sheet, StudyResult, Verification

FOLDER = PROJECT_FOLDER / "comparisons" / "schemas"
FORMS = (Choice, Comparison, Design, Margins, New, Record, Report, Run, Sheet, StudyResult, BearingSearch, Verification)


def schemas() -> dict[str, dict[str, Any]]:
    """Return {file name without ending: schema} of every form."""
    written = [schema_of(form) for form in FORMS]
    return {schema["properties"]["schema"]["default"].replace(" ", "-"): schema for schema in written}


if __name__ == "__main__":
    write_all(FOLDER, {f"{name}.json": json.dumps(schema, indent=2) + "\n" for name, schema in schemas().items()})
