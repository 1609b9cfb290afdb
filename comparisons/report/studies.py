"""The studies' stored results as sections of the report."""

from dataclasses import replace
from pathlib import Path

from ..running.provenance import PROJECT_FOLDER, ResultError, age, read_result
from ..showing.parts import Section
from ..studies import StudyBroken, get_study, study_names

RESULTS = PROJECT_FOLDER / "comparisons" / "results"


def study_sections(folder: Path = RESULTS) -> list[Section]:
    """Sections of all result files ``<study>.json`` in `folder`, in the studies' order; see the package."""
    order = study_names()

    def place(file):
        return (order.index(file.stem) if file.stem in order else len(order), file.stem)

    return [_section(file) for file in sorted(folder.glob("*.json"), key=place)]


def _section(file):
    try:
        result = read_result(file)
    except ResultError as error:
        return Section(f"Study {file.stem}", (f"{file.name} cannot be shown: {error}",))
    try:
        section = get_study(result.kind).section(result)
    except (KeyError, StudyBroken) as error:
        return Section(f"Study {result.kind}", (f"{file.name} cannot be shown: {error.args[0]}.",), age=age(result))
    return replace(section, age=age(result))
