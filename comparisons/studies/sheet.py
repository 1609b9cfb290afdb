"""The problem sheet solved by every engine and variant: what ``rocking score`` ranks other codes beside."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from engines import get_engine

from ..running.cases import Case
from ..running.study import Batch, Found, Study
from ..sheet.answers import error, own_error
from ..sheet.observed import of_response, solved
from ..sheet.problems import PROBLEMS, VERSION
from ..showing.parts import Section, Table, number

if TYPE_CHECKING:
    from analytic import Response

    from ..running.provenance import Result
    from ..running.study import Ask, Plan


def plan(ask: Ask) -> Plan:
    """The plan of the study: each scene in each variant at its default setting; quick: in default variants only."""
    names = [
        (engine, variant)
        for engine in ask.engines
        for variant in get_engine(engine).variants
        if not ask.quick or variant == get_engine(engine).default_variant
    ]
    cases = [
        Case(problem.scene, engine, variant, tag={"scene": problem.name})
        for engine, variant in names
        for problem in PROBLEMS
    ]
    rows = yield Batch(cases, answered, "problem sheet")
    found = []
    for row in rows:
        sound = {} if row.failed else row.values
        found.append(
            {
                "solver": row.case.solver,
                "variant": row.case.variant,
                **row.case.tag,
                "error": sound.get("error"),
                "missing": sound.get("missing", []),
                "warnings": sound.get("warnings", []),
                "failure": row.failure,
                **row.cost,
            }
        )
    settings = {
        "sheet": VERSION,
        "engines": ask.engines,
        "scenes": {problem.name: problem.title for problem in PROBLEMS},
        "own_error": {problem.name: own_error(problem) for problem in PROBLEMS},
    }
    return Found(settings, found)


def answered(case: Case, response: Response) -> dict[str, Any]:
    """Measure: the largest error of the answers, None where some are missing, and which."""
    problem = next(one for one in PROBLEMS if one.name == case.tag["scene"])
    given = of_response(problem, response)
    missing = [one.name for one in problem.quantities if one.name not in given]
    errors = error(problem, given, solved(problem))
    return {
        "outcome": response.outcome,
        "error": None if missing else max(errors.values()),
        "missing": missing,
        "warnings": [warning.text for warning in response.warnings],
    }


def section(result: Result) -> Section:
    """The errors as a section of the report."""
    scenes = result.settings["scenes"]
    rows = []
    for solver in dict.fromkeys((row["solver"], row["variant"]) for row in result.rows):
        own = {row["scene"]: row for row in result.rows if (row["solver"], row["variant"]) == solver}
        rows.append([", ".join(solver), *(_cell(own.get(name)) for name in scenes)])
    exact_row = ["the exact answers themselves", *(number(result.settings["own_error"][name], 2) for name in scenes)]
    return Section(
        "The problem sheet",
        (
            f"{len(scenes)} scenes stated as equations and numbers, for codes that are not ours (rocking sheet, "
            "rocking score), solved by the engines at their default settings. Error: the largest of a scene's "
            "answers, over the scale of each. The exact answers' own is the largest difference to another tolerance "
            "and to a second implementation.",
        ),
        (Table("Largest error of a scene's answers [-]", ("solver", *scenes), [*rows, exact_row]),),
    )


def _cell(row):
    if row is None:
        return "–"
    if row["failure"]:
        return "failed"
    return f"{len(row['missing'])} missing" if row["missing"] else number(row["error"], 2)


STUDY = Study(
    "sheet",
    "The problem sheet in every engine: what rocking score ranks other codes beside.",
    plan,
    lambda result: {},
    section,
)
