"""A made-up study with rows of all kinds: of the model, of no solver, of engines in turns and apart."""

import fake_solvers
import numpy as np

from analytic import Block, Scene, Start
from comparisons.execution.cases import Case
from comparisons.execution.plan import Batch, Computed, Study
from engines import ENGINES

STARTS = (0.05, 0.1)


def plan(request, *, mass: float = 1.0):
    scenes = [
        Scene(block=Block(mass=mass, radius=1.0, slenderness=0.3), start=Start(tilt=tilt), duration=0.1)
        for tilt in STARTS
    ]
    solvers = ("analytic", *request.engines)
    cases = [Case(scene, solver, tag={"start": scene.start.tilt}) for scene in scenes for solver in solvers]
    runs = yield Batch(cases, fake_solvers.tilt, "swings")
    swings = [
        {"part": "swing", "engine": run.case.solver, **run.case.tag, "tilt": run.values["peak"], **run.cost}
        for run in runs
    ]
    least = [
        {"part": "least", "engine": name, "tilt": min(one["tilt"] for one in swings if one["engine"] == name)}
        for name in request.engines
    ]
    arrays = {
        f"swings/{name}/tilt": np.array([one["tilt"] for one in swings if one["engine"] == name]) for name in solvers
    }
    settings = {
        "mass": mass,
        "quick": request.quick,
        "engines": request.engines,
        "best": {name: ENGINES[name].default_variant for name in request.engines},
        "variants": [{"engine": name} for name in request.engines] + [{"engine": "twin"}],
    }
    rows = [{"part": "starts", "starts": STARTS}, *swings, *least]
    return Computed(settings, rows, arrays, seed=3)


MADE = Study("made", "How far?", plan)
