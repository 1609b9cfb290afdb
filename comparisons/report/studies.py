"""The studies' stored results as sections of the report."""

import importlib
import importlib.util
from dataclasses import replace

from ..provenance import PROJECT_FOLDER, ResultError, age, read_result
from .content import Section

RESULTS = PROJECT_FOLDER / "comparisons" / "results"
ORDER = ("restitution", "overturning", "fragility", "speed-error", "stability", "caryatid")


def study_sections(folder=RESULTS):
    """Sections of all result files in the sub-folders of `folder`, in the studies' order; see the package."""
    files = sorted(folder.glob("*/*.json"), key=lambda file: (_place(file.parent.name), file.parent.name, file.name))
    return [_section(file) for file in files]


def _place(study):
    return ORDER.index(study) if study in ORDER else len(ORDER)


def _section(file):
    name = f"{file.parent.name}/{file.name}"
    try:
        result = read_result(file)
    except ResultError as error:
        return Section(f"Study {file.parent.name}", (f"{name} cannot be shown: {error}",))
    module = f"comparisons.{result.kind.replace('-', '_')}_study"
    if importlib.util.find_spec(module) is None:
        return Section(f"Study {result.kind}", (f"{name} cannot be shown: there is no module {module}.",),
                       age=age(result))
    section = importlib.import_module(module).section(result)
    return replace(section, age=age(result))
