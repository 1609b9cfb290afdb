"""The studies' stored results as sections of the report."""

import importlib
import importlib.util
from dataclasses import replace

from ..running.provenance import PROJECT_FOLDER, ResultError, age, read_result
from ..showing.parts import Section

RESULTS = PROJECT_FOLDER / "comparisons" / "results"
ORDER = ("restitution", "overturning", "fragility", "speed-error", "stability", "caryatid")


def study_sections(folder=RESULTS):
    """Sections of all result files ``<study>.json`` in `folder`, in the studies' order; see the package."""
    files = sorted(folder.glob("*.json"), key=lambda file: (_place(file.stem), file.stem))
    return [_section(file) for file in files]


def _place(study):
    return ORDER.index(study) if study in ORDER else len(ORDER)


def _section(file):
    name = file.name
    try:
        result = read_result(file)
    except ResultError as error:
        return Section(f"Study {file.stem}", (f"{name} cannot be shown: {error}",))
    module = f"comparisons.studies.{result.kind.replace('-', '_')}"
    if importlib.util.find_spec(module) is None:
        return Section(f"Study {result.kind}", (f"{name} cannot be shown: there is no module {module}.",),
                       age=age(result))
    section = importlib.import_module(module).section(result)
    return replace(section, age=age(result))
