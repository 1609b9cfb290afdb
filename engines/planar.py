"""What adapters share whose engines move bodies along their velocities: pace, the scale of times, the end of a run."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from .contract import Run
from .leapfrog import failure_of
from .pace import StepRule, impact_aware, least_pull
from .vibration import VISCOUS

if TYPE_CHECKING:
    from analytic import Scene
    from analytic.rocking import RockingModel

    from .swings import Trace

APPROACH = 0.3  # share of the remaining time to the impact that a step may take
SMALLEST_STEP = 1e-7  # s, at `UNIT_RADIUS`
UNIT_RADIUS = 1.0884  # m, of the Caryatid, for which the variants' times are given


def size_scale(scene: Scene) -> float:
    """What times set for a block of `UNIT_RADIUS` are multiplied with: rocking goes with sqrt(R/g)."""
    return math.sqrt(scene.block.radius / UNIT_RADIUS)


def pace_of(
    model: RockingModel, scene: Scene, largest: float, accuracy: float, least_viscous: float = 0.0
) -> Callable[[float, float, bool, float], tuple[float, int]]:
    """Length and purpose of a step as `engines.pace` has them, at most `largest` [s].

    least_viscous: the least accuracy for which viscous bearings set the step at an impact.
    """
    # Both corners count as loaded where the higher one is within what a step of free fall covers.
    standing = 2 * least_pull(model) * model.g * largest * largest / (2 * scene.block.half_width)
    damping, smallest = model.bearing.count * model.bearing.damping, SMALLEST_STEP * size_scale(scene)
    sharpest = VISCOUS * max(accuracy, least_viscous) * model.M / damping if damping else math.inf
    rule = StepRule(largest, smallest, accuracy, APPROACH, sharpest, standing, overlong=True, cruise=True)
    return impact_aware(model, scene.start.tilt_rate, rule)


def run_of(
    scene: Scene, rows: np.ndarray, ended: str, cpu: float, trace: Trace, step: float, warnings: tuple[str, ...] = ()
) -> Run:
    """The `Run` of rows as `engines.leapfrog` has them, and of how they ended."""
    overturned = "overturned" if ended == "overturned" else None
    return Run(trace, len(rows) - 1, cpu, failure_of(scene, rows, ended), overturned, step, warnings)
