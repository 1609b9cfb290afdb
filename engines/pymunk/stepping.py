"""Stepping a scene in Chipmunk: loads, step length, readback.

A call of Chipmunk first moves all bodies at their velocities, then finds contacts, then kicks: it is leapfrog, and a
kick stands between the step before and the step after. Its loads are scaled by (h + h')/(2 h), as Chipmunk multiplies
them by h, the step before; h', the step after, is chosen first, from tilt and rate that the kick will find. The first
call begins a step before the start, on the way that leads to it, and kicks by half a step.
"""

from __future__ import annotations

import math
from array import array
from typing import TYPE_CHECKING

import numpy as np

from analytic.rocking import RockingModel

from ..kicks import pushes
from ..leapfrog import row_limit
from ..pace import IMPACT, REST, ROUNDING, limits
from ..pivoting import DEPTH, Block
from ..placement import placement
from ..planar import pace_of
from ..sliding import SlidingBase

if TYPE_CHECKING:
    from analytic import Scene

    from .scene import Assembly

# Least accuracy at which viscous bearings set the step at an impact: below it Chipmunk's corners pull.
LEAST_VISCOUS = 1e-5


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
    space, body, model = assembly.space, assembly.block, RockingModel.of(scene)
    block, base = Block(scene, model), Base(assembly, scene, model, largest)
    pace, push = pace_of(model, scene, largest, accuracy, LEAST_VISCOUS), pushes(scene.motion, model.g)
    limit, fitted = limits(scene.duration, largest, scene.motion.jumps if scene.motion else ())
    advance, on_base, sweeps, used = space.step, assembly.wheel is not None, assembly.sweeps, 0
    height, fallen, close = block.height, 0.5 * math.pi, DEPTH * model.gamma
    across, up, vx, vz = placement(scene)
    t, h, rate, tilt, interval, side = 0.0, 0.0, scene.start.tilt_rate, scene.start.tilt, 1.0, scene.start.tilt > 0
    rows = array("d", (t, h, tilt, rate, base.x, base.v, base.z, base.force, across, up, vx, vz))
    keep, width, end, ended = rows.extend, len(rows), scene.duration - ROUNDING * largest, "too many steps"
    for _ in range(row_limit(scene.duration, largest)):
        jumped, side = (tilt > 0) != side, tilt > 0
        step, purpose = pace(tilt, rate, jumped, interval)
        if -close < tilt < close and purpose != REST:
            # Both corners are in contact. Chipmunk begins with the impulses before, in proportion to the steps: where
            # these change, what is too much of them pulls.
            step, purpose = h or step, IMPACT
        if t + step >= limit:
            step, limit = fitted(t, step)
        if sweeps[purpose] != used:
            space.iterations = used = sweeps[purpose]
        # The kick, from the middle of the step before to the middle of this one; Chipmunk takes it for `call` seconds.
        call, interval = h or step, 0.5 * (h + step)
        across, up = push(t + 0.5 * step, interval)
        _load(body, block, call, across, up, rate, vx, vz)
        if on_base:
            base.load(call, interval, across, block.lag(rate, step))
        if not h:
            body.angle = rate * call - tilt
        advance(call)
        rate, (vx, vz) = -body.angular_velocity, body.velocity
        if on_base:
            base.move(step)
        if block.move(rate, vx, vz, step, interval, purpose == REST):
            body.angle = 0.0
        t, h, tilt = t + step, step, block.tilt
        keep((t, h, tilt, rate, base.x, base.v, base.z, base.force, block.x, block.up - height, vx, vz))
        if not -fallen < tilt < fallen:
            ended = "overturned" if math.isfinite(tilt) else "not finite"
            break
        if t >= end:
            ended = "done"
            break
    return np.frombuffer(rows).reshape(-1, width), ended


def _load(body, block, call, across, up, rate, vx, vz):
    """Load Chipmunk's body for a call of so many seconds that gains it velocities [m/s], from where the block was."""
    body.force = block.m * across / call, block.m * up / call
    if block.turned:
        body.torque = -block.lost_spin(rate) / call
    body.position = block.x - vx * call, block.up - vz * call


class Base(SlidingBase):
    """The base as the rim of a wheel of Chipmunk."""

    def __init__(self, assembly: Assembly, scene: Scene, model: RockingModel, largest: float) -> None:
        super().__init__(scene, model, largest)
        self.wheel, self.radius = assembly.wheel, assembly.radius

    def weigh(self, mass: float) -> None:
        """Give it a mass [kg]."""
        self.wheel.moment = mass * self.radius**2

    def load(self, call: float, interval: float, pushed: float, lag: float) -> None:
        """Load it for a call of Chipmunk [s]: see `SlidingBase.impulse`."""
        self.wheel.torque = -self.impulse(interval, pushed, lag) / call * self.radius
        self.wheel.angle = self.v / self.radius * call  # and 0 after the call's way

    def move(self, step: float) -> None:
        """Move at the velocity that a kick left."""
        self.follow(-self.radius * self.wheel.angular_velocity, step)
