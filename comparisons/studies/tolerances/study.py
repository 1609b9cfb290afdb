"""The tolerances study: the rows of the table, measured engine by engine."""

from engines import ENGINES, get_engine

from ...measuring.tolerances import TABLE, measure_all
from ...running.plan import Computed, Plan, Request
from ...running.progress import log
from ...running.provenance import Result


def plan(request: Request) -> Plan:
    """The plan of the study: rows of `TABLE`; quick: of the engines' main variants only."""
    rows = []
    for engine in request.engines:
        log(f"tolerances: {engine}")
        default = get_engine(engine).default_variant
        own = [row for row in TABLE if row.engine == engine and (row.variant == default or not request.quick)]
        rows += [{"part": "tolerance", **row} for row in measure_all(own)]
    bounds = tuple(f"{ENGINES[name].tolerances}:TOLERANCES" for name in request.engines if ENGINES[name].tolerances)
    yield from ()
    return Computed({"engines": request.engines, "quick": request.quick}, rows, solvers=bounds)


def problems(result: Result) -> list[str]:
    """Sentences on the rows that do not hold."""
    return [
        f"does not hold: {row['quantity']}, {row['engine']}, {row['variant']}, {row['scenes']}: "
        f"{row['failure'] or row['found']}, tolerated {row['bound']:g} {row['unit']}"
        for row in result.rows
        if not row["holds"]
    ]
