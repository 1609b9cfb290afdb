"""Stepping a scene in MuJoCo: loads, step length, readback."""

from __future__ import annotations

import math
from array import array
from typing import TYPE_CHECKING, Self

import mujoco
import numpy as np

from analytic.bearing import BearingLaw
from analytic.motion import vertical_acceleration
from analytic.rocking import RockingModel

from ..ground_velocity import ground_velocity
from ..leapfrog import row_limit
from ..pace import FLIGHT, ROUNDING, THROWN, StepRule, impact_aware, limits
from ..scale import size_scale
from ..vibration import base_decay, leapfrog_stiffness
from .scene import contact_reference, least_mass, recovery_rate

if TYPE_CHECKING:
    from analytic import Scene

    from .scene import Settings

APPROACH = 0.15  # share of the remaining time to the impact that a step may take; .1 to .3: no accuracy knob
SMALLEST_STEP = 1e-7  # s, at `scale.UNIT_RADIUS`; 1e-8 to 1e-6
# Viscous impulse of a step over the base's momentum from which on it is solved with the contacts. (MuJoCo's least
# impedance is 1e-4.) Below, it is taken at the velocity half a step earlier: an error of half of this.
LEAST_RATIO = 2e-4


def run(model: mujoco.MjModel, data: mujoco.MjData, scene: Scene, chosen: Settings) -> tuple[np.ndarray, str]:
    """Step until the duration is over, the block has overturned or a state is not finite.

    MuJoCo's Euler is leapfrog: displacements live at the steps' ends, velocities half a step earlier. A load that
    acts for the mean of two steps is scaled by (h + h')/(2 h'), see engines.pybullet.stepping; not so for a first
    script.

    Returns
    -------
    rows, ended
        Rows as `engines.leapfrog` has them, the start first; "done", "overturned", "not finite" or "too many steps".
    """
    largest, corners = model.opt.timestep, chosen.recovery is not None  # a first script has a box's
    law, start, loaded = BearingLaw.of(scene.bearings), scene.start, scene.bearings is not None
    pace = _pace(scene, chosen, largest)
    limit, fitted = limits(scene.duration, largest, scene.motion.jumps if scene.motion and chosen.accuracy else ())
    load = _mean_loads(model, data, scene, chosen) if corners else _sampled_loads(model, data, scene)
    advance, state, speed = mujoco.mj_step, data.qpos, data.qvel
    half_height, half_width, on_base = scene.block.half_height, scene.block.half_width, scene.base is not None
    end, fallen, most = scene.duration - ROUNDING * largest, 0.5 * math.pi, row_limit(scene.duration, largest)
    t, h, interval, jumped = 0.0, 0.0, 1.0, False
    tilt, rate, x, v = start.tilt, start.tilt_rate, start.base_displacement, start.base_velocity
    z = law.start(x)
    force = law.force(x, z)
    rows = array("d", (t, h, tilt, rate, x, v, z, force, *state[-3:-1].tolist(), *speed[-3:-1].tolist()))
    ended, width = "done", len(rows)
    while t < end:
        step = pace(tilt, rate, jumped, interval)[0]
        if t + step >= limit:
            step, limit = fitted(t, step)
        interval = load(t, step, h, tilt, rate, v, force, jumped)
        advance(model, data)
        before, was = x, tilt > 0
        tilt, rate, across, up = state.item(-1), speed.item(-1), state.item(-3), state.item(-2)
        if on_base:
            x, v = state.item(0), speed.item(0)
            if loaded:
                z = law.hysteretic(z, x - before)
                force = law.force(x, z)
        if corners and data.ncon:
            # On a corner the centre moves on an arc, not along its tangent as MuJoCo moves it: that would lift the
            # corner out of contact every now and then, and a bearing flings a light base away within one step.
            turned = step * rate
            turned *= 0.5 * turned
            state[-3] = across = across - turned * (across - x - (half_width if tilt > 0 else -half_width))
            state[-2] = up = up - turned * (up + half_height)
        t, h, jumped = t + step, step, (tilt > 0) != was
        rows.extend((t, h, tilt, rate, x, v, z, force, across, up, speed.item(-3), speed.item(-2)))
        if not -fallen < tilt < fallen:
            ended = "overturned" if math.isfinite(tilt) else "not finite"
            break
        if len(rows) > most * width:
            ended = "too many steps"
            break
    return np.frombuffer(rows).reshape(-1, width), ended


def _pace(scene, chosen, largest):
    """Length and purpose of a step as `engines.pace` has them; without an accuracy all are the largest [s]."""
    if not chosen.accuracy:
        return lambda *_: (largest, FLIGHT)
    smallest, thrown = SMALLEST_STEP * size_scale(scene), THROWN if scene.motion else 1.0
    rule = StepRule(largest, smallest, chosen.accuracy, APPROACH, decay=base_decay(scene), thrown=thrown)
    return impact_aware(RockingModel.of(scene), scene.start.tilt_rate, rule)


def _sampled_loads(model, data, scene):
    """As `_mean_loads`, taken as they are at the start of the step."""
    motion, law, g = scene.motion, BearingLaw.of(scene.bearings), scene.gravity
    option, gravity, push = model.opt, model.opt.gravity, data.qfrc_applied
    loaded, damping = scene.bearings is not None, law.count * law.damping

    def load(t, step, h, tilt, rate, v, force, jumped):
        option.timestep = step
        if motion:
            gravity[0] = -float(motion.acceleration(t))
        if motion and motion.vertical:
            gravity[2] = -g - float(vertical_acceleration(motion, t))
        if loaded:
            push[0] = -(force + damping * v)
        return 0.5 * (step + h)

    return load


def _mean_loads(model, data, scene, chosen):
    """A function (t, step, h, tilt, rate, v, force, jumped) that sets length and loads of a step after one of h [s].

    It returns the time between the velocities before and after the step [s].
    """
    ground, upright = ground_velocity(scene.motion), ground_velocity(scene.motion and scene.motion.vertical)
    viscous, recovery = Viscous.of(scene, model, data), recovery_rate(scene, chosen)
    option, gravity, solref, push = model.opt, model.opt.gravity, model.geom_solref, data.qfrc_applied
    loaded, g = scene.bearings is not None, scene.gravity
    used, gained, risen, last_scale, held = option.timestep, 0.0, 0.0, 1.0, 0.0
    heavier = leapfrog_stiffness(BearingLaw.of(scene.bearings), used, least_mass(scene)) if loaded else 0.0

    def load(t, step, h, tilt, rate, v, force, jumped):
        nonlocal used, gained, risen, last_scale, held
        if step != used:
            option.timestep = used = step
            solref[:] = contact_reference(step, recovery)
        interval = 0.5 * (step + h)
        scale = interval / step
        if ground:
            reached = ground(t + 0.5 * step)
            gravity[0] = (gained - reached) / step
            gained = reached
        if upright:
            reached = upright(t + 0.5 * step)
            gravity[2] = -g * scale + (risen - reached) / step
            risen = reached
        elif scale != last_scale:
            gravity[2] = -g * scale
            last_scale = scale
        if loaded:
            if viscous and not viscous.solved(h, step, scale, jumped or (tilt > 0) != (tilt + step * rate > 0)):
                force += viscous.most(step) * v
            push[0] = -force * scale
            if heavier and interval != held:  # inertia alone: gravity, which is the ground's motion, acts on body_mass
                held = interval
                model.dof_M0[0] = scene.base.mass + heavier * interval * interval
        return interval

    return load


class Viscous:
    """The bearings' viscous force as a constraint that MuJoCo solves with its contacts, so that no step is too long.

    A soft constraint on the base's joint gives it the force -(a + b v)/R, a its acceleration in the step and v its
    velocity before. With b = 1/(theta h), R = 1/(c theta h) that is -c (v + theta h a), the damper at a velocity
    between the step's ends. Not in the step of an impact: there the damper would hold the base that the block kicks.
    """

    def __init__(
        self, model: mujoco.MjModel, data: mujoco.MjData, damping: float, mass: float, lightest: float
    ) -> None:
        self.model, self.active = model, data.eq_active
        self.damping, self.mass, self.lightest = damping, mass, lightest

    @classmethod
    def of(cls, scene: Scene, model: mujoco.MjModel, data: mujoco.MjData) -> Self | None:
        law = BearingLaw.of(scene.bearings)
        if not law.count * law.damping:
            return None
        return cls(model, data, law.count * law.damping, scene.base.mass, least_mass(scene))

    def solved(self, h: float, step: float, scale: float, landing: bool) -> bool:
        """Set the constraint for a step [s] after one of h; False where the force is to be applied by itself."""
        pull = self.damping * scale * step
        # v at the end of the step before is the mean of its neighbours, weighted; where that would ring, the later one.
        share = max(h / (h + step), 1 - self.lightest / pull)
        ratio = pull * share / self.mass
        self.active[0] = ratio >= LEAST_RATIO and not landing
        if not self.active[0]:
            return False
        d = ratio / (1 + ratio)
        self.model.eq_solimp[0, :2] = d
        self.model.eq_solref[0] = 0.0, -d / (share * step)
        return True

    def most(self, step: float) -> float:
        """The damping [N s/m] to apply in a step [s], at most that which stops the base in it."""
        return min(self.damping, self.lightest / step)
