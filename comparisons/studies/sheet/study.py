"""The sheet study: the problem sheet's scenes in every engine and variant, compared with the exact answers."""

from typing import Any

from analytic import Response
from engines import get_engine

from ...running.cases import Case
from ...running.plan import Batch, Computed, Plan, Request
from ...sheet.problems import PROBLEMS, VERSION
from ...sheet.variants import error, of_response, own_error, solved


def plan(request: Request) -> Plan:
    """The plan of the study: each scene in each variant at its default level; quick: in main variants only."""
    cases = [
        Case(problem.scene, engine, variant, tag={"scene": problem.name})
        for engine in request.engines
        for variant in get_engine(engine).variants
        if not request.quick or variant == get_engine(engine).default_variant
        for problem in PROBLEMS
    ]
    runs = yield Batch(cases, answered, "problem sheet")
    nothing = {"error": None, "missing": [], "warnings": []}
    rows = [
        {
            "part": "scene",
            "engine": run.case.solver,
            "variant": run.case.variant,
            **run.case.tag,
            **(nothing if run.failed else {key: run.values[key] for key in nothing}),
            "failure": run.failure,
            **run.cost,
        }
        for run in runs
    ]
    settings = {
        "quick": request.quick,
        "sheet": VERSION,
        "engines": request.engines,
        "scenes": {problem.name: problem.title for problem in PROBLEMS},
        "own_error": {problem.name: own_error(problem) for problem in PROBLEMS},
    }
    return Computed(settings, rows)


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
