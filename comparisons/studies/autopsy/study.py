"""The autopsy study: the first impact of a block released, on both grounds, in every engine and variant."""

from typing import Any

from analytic import Base, Block, Response, Scene, Start
from analytic.caryatid import BASE, MASS, RADIUS
from engines import get_engine

from ...measuring.autopsy import CAUSES, LEAST, diagnosis
from ...running.cases import Case
from ...running.plan import Batch, Computed, Plan, Request

SLENDERNESS, START = 0.2, 0.6  # rad, tilt over slenderness
SECONDS = 1.6  # past the swing after the first impact
GROUNDS = {"rigid ground": None, "sliding base": Base(mass=BASE.mass)}


def scene_on(ground: str) -> Scene:
    """The block released, on a ground of `GROUNDS`."""
    return Scene(
        name="one impact",
        block=Block(mass=MASS, radius=RADIUS, slenderness=SLENDERNESS),
        base=GROUNDS[ground],
        start=Start(tilt=START * SLENDERNESS),
        duration=SECONDS,
    )


def measure(case: Case, response: Response) -> dict[str, Any]:
    """The `diagnosis` of the first impact; the run is made once more, for its steps."""
    return diagnosis(case.solver, case.variant, case.scene)


def plan(request: Request) -> Plan:
    """The plan of the study. Rows: `diagnosis`, or the failure, with the ground.

    Parameters
    ----------
    request : Request
        quick: rigid ground only.
    """
    cases = [
        Case(scene_on(ground), engine, variant, tag={"ground": ground})
        for engine in request.engines
        for variant in get_engine(engine).variants
        for ground in (list(GROUNDS)[:1] if request.quick else GROUNDS)
    ]
    runs = yield Batch(cases, measure, "one impact", time_limit=60.0)
    rows = [
        {
            "part": "impact",
            "engine": run.case.solver,
            "variant": run.case.variant,
            **run.case.tag,
            "failure": run.failure,
            **({} if run.failed else run.values),
        }
        for run in runs
    ]
    settings = {"quick": request.quick, "slenderness": SLENDERNESS, "start": START, "least": LEAST, "causes": CAUSES}
    return Computed(settings, rows)
