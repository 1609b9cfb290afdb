"""What is run of an ensemble of random scenes, and the class of each run."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from analytic import simulate
from engines import get_engine
from engines.comparison import Reference
from engines.statue_range import RANGE, in_words

from ...measuring.classes import class_of
from ...running.cases import Case
from ...running.plan import Batch, Computed
from ...running.provenance import commit_seed
from .scenes import random_scene

if TYPE_CHECKING:
    from analytic import Response

    from ...running.plan import Plan, Request
    from ...running.sweep import Row

SCENES, QUICK_SCENES = 500, 20  # of the engines' main variants
FEWER = 5  # other variants run one scene in so many, and at least so many

SEED = "Of the scenes, without it of the commit; with --check of the draw of runs."
Seed = Annotated[int | None, typer.Option(min=0, max=2**63, help=SEED)]
Number = Annotated[int | None, typer.Option(min=1, max=10**6, help="How many are drawn. Default 500, quick 20.")]


def plan(request: Request, *, seed: Seed = None, scenes: Number = None) -> Plan:
    """The plan of the study: scenes of an ensemble that every commit draws anew; seed: of another one."""
    seed = commit_seed() if seed is None else seed
    most = scenes or (QUICK_SCENES if request.quick else SCENES)
    drawn = [random_scene(seed, index) for index in range(most)]
    reached = [simulate(scene, history=False).peak_tilt_ratio >= RANGE["tilt"][0] for scene in drawn]
    cases = []
    for name in request.engines:
        engine = get_engine(name)
        for variant in engine.variants:
            count = most if variant == engine.default_variant else min(most, max(FEWER, most // FEWER))
            cases += [
                Case(drawn[k], name, variant, {"history": False, "compare": True}, {"index": k})
                for k in range(count)
                if reached[k]
            ]
    rows = yield Batch(cases, compared, "random scenes")
    found = [
        {
            "engine": row.case.solver,
            "variant": row.case.variant,
            "tier": get_engine(row.case.solver).variants[row.case.variant or ""].kind,
            **row.case.tag,
            **(_failed(row) if row.failed else row.values),
        }
        for row in rows
    ]
    settings = {"scenes": most, "below_range": reached.count(False), "range": in_words(), "quick": request.quick}
    return Computed(settings, found, seed=seed)


def _failed(row: Row) -> dict[str, Any]:
    """What is kept of a run that failed: left out where no run of its scene is judged, of all engines alike."""
    why = Reference.of(row.case.scene).comparable
    return {"class": class_of(why, None), "comparable": why, "failure": row.failure}


def compared(case: Case, response: Response) -> dict[str, Any]:
    """Measure: the class of a run, and in what it differs, or why it is left out.

    A scene near an outcome boundary is left out for all engines alike; the differences of its runs are kept.
    """
    quantities = [one.quantity for one in response.differences]
    return {
        "class": class_of(response.comparable, quantities),
        "comparable": response.comparable,
        "differences": [str(one) for one in response.differences],
        "quantities": quantities,
    }
