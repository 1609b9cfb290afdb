"""Stepping a scene in Drake: loads, step length, readback.

An update of Drake's plant kicks all bodies, contacts included; what it would then move them by is left aside, as the
plant's step is not ours (see `scene`). Loads are impulses over that step; those of a kick act from the middle of our
step before to the middle of this one.
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
from .scene import STICTION, start_of

if TYPE_CHECKING:
    from analytic import Scene

    from .scene import Assembly

SLIP = 1.1  # slip of a corner that slides, over the most of one that sticks


def run(assembly: Assembly, scene: Scene, largest: float, accuracy: float) -> tuple[np.ndarray, str]:
    """Step until the duration is over, the block has overturned, a state is not finite or Drake finds no solution.

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
        Rows as `engines.leapfrog` has them, the start first; "done", "overturned", "not finite", "too many steps", or
        what Drake said.
    """
    model, on_base = RockingModel.of(scene), scene.base is not None
    block, base = Block(scene, model), Base(assembly, scene, model, largest)
    pace, push = pace_of(model, scene, largest, accuracy), pushes(scene.motion, model.g)
    limit, fitted = limits(scene.duration, largest, scene.motion.jumps if scene.motion else ())
    m, height, fallen, slip = model.m, block.height, 0.5 * math.pi, SLIP * STICTION * math.sqrt(model.R * model.g)
    across, up, vx, vz = placement(scene)
    state = start_of(scene)
    count = len(state) // 2
    impulse = np.zeros(count)
    t, h, rate, tilt, interval, side = 0.0, 0.0, scene.start.tilt_rate, block.tilt, 1.0, block.tilt > 0
    rows = array("d", (t, h, tilt, rate, base.x, base.v, base.z, base.force, across, up, vx, vz))
    keep, width, end, ended = rows.extend, len(rows), scene.duration - ROUNDING * largest, "too many steps"
    for _ in range(row_limit(scene.duration, largest)):
        jumped, side = (tilt > 0) != side, tilt > 0
        step, purpose = pace(tilt, rate, jumped, interval)
        if t + step >= limit:
            step, limit = fitted(t, step)
        interval = 0.5 * (h + step)
        across, up = push(t + 0.5 * step, interval)
        spin = block.lost_spin(rate) if block.turned else 0.0
        if not math.isfinite(across + up + spin + base.force):
            ended = "not finite"
            break
        impulse[:3] = m * up, m * across, spin
        if on_base:
            base.load(impulse, interval, across, block.lag(rate, step))
        try:
            velocities = _kicked(assembly, state, impulse, block, interval, slip)
        except RuntimeError as error:
            ended = str(error)
            break
        vz, vx, rate = velocities[:3]
        if on_base:
            base.follow(velocities[3], step)
            state[3] = base.x
        block.move(rate, vx, vz, step, interval, purpose == REST)
        state[:3] = block.up, block.x, block.tilt
        state[count:] = velocities
        t, h, tilt = t + step, step, block.tilt
        keep((t, h, tilt, rate, base.x, base.v, base.z, base.force, block.x, block.up - height, vx, vz))
        if not -fallen < tilt < fallen:
            ended = "overturned" if math.isfinite(tilt) else "not finite"
            break
        if t >= end:
            ended = "done"
            break
    return np.frombuffer(rows).reshape(-1, width), ended


def _kicked(assembly, state, impulse, block, interval, slip):
    """Velocities after an impulse; those of `holding` where the lower corner would slide faster than `slip` [m/s]."""
    try:
        velocities = assembly.contacts.kick(state, impulse)
        vz, vx, rate, *v = velocities
        slides = abs(vx - block.c * rate - sum(v)) > slip and vz - block.n * rate <= block.lifting * interval
        if not (assembly.holding and slides):
            return velocities
    except RuntimeError:
        if not assembly.holding:
            raise
    return assembly.holding.kick(state, impulse)


class Base(SlidingBase):
    """The base as a body of Drake on a prismatic joint."""

    def __init__(self, assembly: Assembly, scene: Scene, model: RockingModel, largest: float) -> None:
        super().__init__(scene, model, largest)
        self.bodies = [(one.base, one.context) for one in (assembly.contacts, assembly.holding) if one]

    def weigh(self, mass: float) -> None:
        """Give it a mass [kg]."""
        for body, context in self.bodies:
            body.SetMass(context, mass)

    def load(self, loads: np.ndarray, interval: float, pushed: float, lag: float) -> None:
        """Give it its share of a kick's loads [N s]: see `SlidingBase.impulse`."""
        loads[3] = self.impulse(interval, pushed, lag)
