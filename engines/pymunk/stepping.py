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

from analytic.bearing import BearingLaw
from analytic.rocking import RockingModel

from ..kicks import pushes
from ..leapfrog import row_limit
from ..pace import IMPACT, REST, ROUNDING, StepRule, fixed, impact_aware, least_pull, limits
from ..pivoting import DEPTH, Block
from ..placement import placement
from ..vibration import VISCOUS, added_mass, driven_mass, leapfrog_stiffness
from .scene import size_scale

if TYPE_CHECKING:
    from analytic import Scene

    from .scene import Assembly

APPROACH = 0.3  # share of the remaining time to the impact that a step may take
SMALLEST_STEP = 1e-7  # s, at `UNIT_RADIUS`
LEAST_VISCOUS = (
    1e-5  # of the accuracy, where viscous bearings set the step at an impact: below, Chipmunk's corners pull
)


def run(assembly: Assembly, scene: Scene, largest: float, accuracy: float | None) -> tuple[np.ndarray, str]:
    """Step until the duration is over, the block has overturned or a state is not finite.

    Parameters
    ----------
    assembly : Assembly
    scene : Scene
    largest : float
        Longest step [s]; the only one where `accuracy` is None.
    accuracy : float or None
        Share of its speed at the impact that the block may gain in one step there.

    Returns
    -------
    rows, ended
        Rows as `engines.leapfrog` has them, the start first; "done", "overturned", "not finite" or "too many steps".
    """
    space, body, model = assembly.space, assembly.block, RockingModel.of(scene)
    block, base = Block(scene, model), Base(assembly, scene, model, largest)
    pace, push = _pace(model, scene, largest, accuracy), pushes(scene.motion, model.g)
    limit, fitted = limits(scene.duration, largest, scene.motion.jumps if scene.motion and accuracy else ())
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


def _pace(model, scene, largest, accuracy):
    """Length and purpose of a step as `engines.pace` has them; without accuracy all are `largest` [s]."""
    # Both corners count as loaded where the higher one is within what a step of free fall covers.
    standing = 2 * least_pull(model) * model.g * largest * largest / (2 * scene.block.half_width)
    if accuracy is None:
        return fixed(model, largest, standing)
    damping, smallest = model.bearing.count * model.bearing.damping, SMALLEST_STEP * size_scale(scene)
    sharpest = VISCOUS * max(accuracy, LEAST_VISCOUS) * model.M / damping if damping else math.inf
    rule = StepRule(largest, smallest, accuracy, APPROACH, sharpest, standing, overlong=True, cruise=True)
    return impact_aware(model, scene.start.tilt_rate, rule)


class Base:
    """The base on its bearings: its wheel's loads and its way. All zeros on rigid ground."""

    __slots__ = ("wheel", "radius", "law", "mass", "driven", "damping", "heavier", "held", "lagged", *"xvz", "force")

    def __init__(self, assembly: Assembly, scene: Scene, model: RockingModel, largest: float) -> None:
        self.wheel, self.radius, self.law = assembly.wheel, assembly.radius, BearingLaw.of(scene.bearings)
        self.mass, self.driven = model.M - model.m, driven_mass(model)
        self.damping = self.law.count * self.law.damping
        self.heavier = leapfrog_stiffness(self.law, largest, self.driven)
        self.held = self.lagged = 0.0
        self.x, self.v = scene.start.base_displacement, scene.start.base_velocity
        self.z = self.law.start(self.x)
        self.force = self.law.force(self.x, self.z)

    def load(self, call: float, interval: float, pushed: float, lag: float) -> None:
        """Load the wheel for a call of Chipmunk [s] that stands for `interval` [s].

        pushed: gain of velocity from the ground's motion [m/s]; lag: of `Block.lag`.
        """
        if interval != self.held and (self.damping or self.heavier):
            self.held = interval
            added = added_mass(self.damping, interval, self.driven) + self.heavier * interval * interval
            self.wheel.moment = (self.mass + added) * self.radius**2
        impulse = self.mass * pushed + lag - self.lagged - (self.force + self.damping * self.v) * interval
        self.wheel.torque = -impulse / call * self.radius
        self.wheel.angle = self.v / self.radius * call  # and 0 after the call's way
        self.lagged = lag

    def move(self, step: float) -> None:
        """Move at the velocity that a kick left; the bearings follow."""
        self.v = -self.radius * self.wheel.angular_velocity
        self.x += self.v * step
        if self.law.count:
            self.z = self.law.hysteretic(self.z, self.v * step)
            self.force = self.law.force(self.x, self.z)
