"""Stepping a scene in DART: loads, step length, readback.

A call of DART kicks all bodies, contacts included, and then moves them: it is leapfrog, as Bullet is (see
`engines.pybullet.stepping`): loads are scaled by (h + h')/(2 h').
"""

from __future__ import annotations

import math
from array import array
from typing import TYPE_CHECKING

import numpy as np

from analytic.rocking import RockingModel

from ..kicks import pushes
from ..leapfrog import row_limit
from ..pace import REST, ROUNDING, limits
from ..pivoting import Block
from ..placement import placement
from ..planar import pace_of
from ..sliding import SlidingBase

if TYPE_CHECKING:
    from analytic import Scene

    from .scene import Assembly


def run(assembly: Assembly, scene: Scene, largest: float, accuracy: float) -> tuple[np.ndarray, str]:
    """Step until the duration is over, the block has overturned or a state is not finite.

    Parameters
    ----------
    assembly : Assembly
    scene : Scene
    largest : float
        Longest step [s].
    accuracy : float
        Share of its speed at the impact that the block may gain in one step there.

    Returns
    -------
    rows, ended
        Rows as `engines.leapfrog` has them, the start first; "done", "overturned", "not finite" or "too many steps".
    """
    world, skeleton, model = assembly.world, assembly.block, RockingModel.of(scene)
    block, base = Block(scene, model), Base(assembly, scene, model, largest)
    pace, push = pace_of(model, scene, largest, accuracy), pushes(scene.motion, model.g)
    limit, fitted = limits(scene.duration, largest, scene.motion.jumps if scene.motion else ())
    advance, on_base, m, height, fallen = world.step, assembly.base is not None, model.m, block.height, 0.5 * math.pi
    across, up, vx, vz = placement(scene)
    t, h, rate, tilt, interval, side, used = 0.0, 0.0, scene.start.tilt_rate, block.tilt, 1.0, block.tilt > 0, 0.0
    rows = array("d", (t, h, tilt, rate, base.x, base.v, base.z, base.force, across, up, vx, vz))
    keep, width, end, ended = rows.extend, len(rows), scene.duration - ROUNDING * largest, "too many steps"
    for _ in range(row_limit(scene.duration, largest)):
        jumped, side = (tilt > 0) != side, tilt > 0
        step, purpose = pace(tilt, rate, jumped, interval)
        if t + step >= limit:
            step, limit = fitted(t, step)
        if step != used:
            world.setTimeStep(step)
            used = step
        interval = 0.5 * (h + step)
        across, up = push(t + 0.5 * step, interval)
        spin = block.lost_spin(rate) / step if block.turned else 0.0
        if not math.isfinite(across + up + spin + base.force):  # DART would go on without an acceleration
            ended = "not finite"
            break
        skeleton.setForces((m * up / step, m * across / step, spin))
        if on_base:
            base.load(step, interval, across, block.lag(rate, step))
        advance()
        vz, vx, rate = skeleton.getVelocities().tolist()
        if on_base:
            base.move(step)
        block.move(rate, vx, vz, step, interval, purpose == REST)
        skeleton.setPositions((block.up, block.x, block.tilt))
        t, h, tilt = t + step, step, block.tilt
        keep((t, h, tilt, rate, base.x, base.v, base.z, base.force, block.x, block.up - height, vx, vz))
        if not -fallen < tilt < fallen:
            ended = "overturned" if math.isfinite(tilt) else "not finite"
            break
        if t >= end:
            ended = "done"
            break
    return np.frombuffer(rows).reshape(-1, width), ended


class Base(SlidingBase):
    """The base as a body of DART on a prismatic joint."""

    def __init__(self, assembly: Assembly, scene: Scene, model: RockingModel, largest: float) -> None:
        super().__init__(scene, model, largest)
        self.skeleton, self.body = assembly.ground, assembly.base

    def weigh(self, mass: float) -> None:
        """Give it a mass [kg]."""
        self.body.setMass(mass)

    def load(self, step: float, interval: float, pushed: float, lag: float) -> None:
        """Load it for a step [s]: see `SlidingBase.impulse`."""
        self.skeleton.setForces((self.impulse(interval, pushed, lag) / step,))

    def move(self, step: float) -> None:
        """Move at the velocity that a kick left."""
        self.follow(self.skeleton.getVelocity(0), step)
