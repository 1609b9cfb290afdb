"""The runs of the study: a block of another slenderness under a table's motion, and what is kept of a run.

Apart from the rest of the study, so that no change of what is made of the runs makes them again.
"""

import time
from typing import Any

import numpy as np

from analytic import Response, Scene, simulate_many
from analytic.rocking import RockingModel
from engines.comparison import Reference

from ...running.cases import Case

OVERTURNS, STANDS, FAILED = "1", "0", "x"


def leaning(
    scene: Scene, slenderness: float, *, restitution: float = 1, inertia: float = 1, friction: float | None = None
) -> Scene:
    """A scene whose block has another slenderness [rad], its centre of mass as high as before.

    restitution: factor on that of the block. inertia: factor on the moment about the centre of mass. friction: in place
    of the scene's.
    """
    block = scene.block
    radius = float(block.half_height / np.cos(slenderness))
    corner = float(inertia * block.centre_inertia + block.mass * radius**2)
    changed = scene.with_(block={"radius": radius, "slenderness": float(slenderness), "corner_inertia": corner})
    if restitution != 1:
        changed = changed.with_(block={"restitution": restitution * RockingModel.of(changed).restitution})
    return changed if friction is None else changed.with_(friction=friction)


def over_slendernesses(case: Case, response: Response) -> dict[str, Any]:
    """Measure: a digit for each slenderness, for each kind of model."""
    kinds, grid = case.tag["kinds"], case.tag["slendernesses"]
    scenes = [leaning(case.scene, slenderness, **kind) for kind in kinds for slenderness in grid]
    began = time.process_time()
    found = simulate_many(scenes, workers=1)
    seconds = time.process_time() - began
    digits = np.where(found.failed, FAILED, np.where(found.overturns, OVERTURNS, STANDS))
    return {
        "outcomes": ["".join(one) for one in digits.reshape(len(kinds), -1).tolist()],
        "cost": {"grid_seconds": seconds},
    }


def ended(case: Case, response: Response) -> dict[str, Any]:
    """Measure: how a run ended, and its peak tilt over the slenderness."""
    return {"outcome": response.outcome, "tilt": response.peak_tilt_ratio}


def ended_near(case: Case, response: Response) -> dict[str, Any]:
    """Measure of the model's run: `ended`, and whether a change of the scene by 1e-4 changes the outcome."""
    return {**ended(case, response), "near": "outcome" in Reference.of(case.scene).near}
