"""Stepping a scene in Bullet: loads, step size, readback.

Bullet is leapfrog: displacements live at the steps' ends t_n, velocities half a step earlier. Between velocities at
t_n - h/2 and t_n + h'/2 lie (h + h')/2 seconds, but Bullet multiplies the loads by h' alone. Scaling all loads of a
step by (h + h')/(2 h') makes the scheme second order for any sequence of steps, the start included (h = 0), and
needs no correction of velocities when the step changes.
"""

from __future__ import annotations

import math
from array import array
from typing import TYPE_CHECKING

import numpy as np
import pybullet

from analytic.bearing import BearingLaw, hysteretic_force
from analytic.rocking import RockingModel

from ..ground_velocity import ground_velocity
from ..leapfrog import row_limit
from ..pace import ROUNDING, StepRule, fixed, impact_aware, least_pull, limits
from ..placement import placement
from ..vibration import VISCOUS, added_mass, driven_mass, leapfrog_stiffness
from .scene import iterations

if TYPE_CHECKING:
    from analytic import Scene

    from .scene import Assembly, Units

APPROACH = 0.3  # share of the remaining time to the impact that a step may take; .15 to .5: no accuracy knob
# [s]; 1e-6 doubles the error of e of the stockiest block on a base, 1e-8 changes nothing.
SMALLEST_STEP = 1e-7

THROWN = 0.1  # as `engines.pace.THROWN`, see there

# Most iterations at an impact, where both corners may carry. They matter where e is near 0, for stocky blocks: these
# need fewer to stand. (Slenderness .96, J_O = 1.09 m R^2: e of .03 for 0 with the iterations of one corner.)
LANDING_ITERATIONS = 100


def run(
    assembly: Assembly, scene: Scene, units: Units, largest: float, accuracy: float | None, places: bool = False
) -> tuple[np.ndarray, str]:
    """Step until the duration is over, the block has overturned or a state is not finite.

    Parameters
    ----------
    scene, units : Scene, Units
        The scene in Bullet's units (`Units.scale`), but for its motion and bearings.
    largest : float
        Longest step [unit of time]; the only one where `accuracy` is None.
    accuracy : float or None
        As of `engines.pace.StepRule`.
    places : bool
        Read the block's centre, too; a step costs up to a tenth more.

    Returns (rows, ended) as `engines.mujoco.stepping.run`, in SI.
    """
    law, start, loaded = BearingLaw.of(scene.bearings), scene.start, scene.bearings is not None
    pace = _pace(scene, units, largest, accuracy)
    limit, fitted = limits(scene.duration, largest, _jumps(scene, units, accuracy))
    prepare, advance, fallen = _preparation(assembly, scene, units, largest), pybullet.stepSimulation, 0.5 * math.pi
    client, body, turn, on_base = assembly.client, assembly.body, assembly.tilt, assembly.base is not None
    read, read_both, joints = pybullet.getJointState, pybullet.getJointStates, (turn, assembly.base)
    scale, count, spring = units.length, law.count, law.count * law.kb * units.length
    constants = law.law, *law.constants
    t, h, interval, ended = 0.0, 0.0, 1.0, "too many steps"
    tilt, rate, x, v = start.tilt, start.tilt_rate, start.base_displacement, start.base_velocity
    z = law.start(scale * x)
    force = spring * x + count * z
    rows = array("d", (t, h, tilt, rate, x, v, z, force, *(placement(scene) if places else ())))
    end, side, width, keep = scene.duration - ROUNDING * largest, tilt > 0, len(rows), rows.extend
    for _ in range(row_limit(scene.duration, largest)):
        right = tilt > 0
        jumped, side = right != side, right
        step, purpose = pace(tilt, rate, jumped, interval)
        if t + step >= limit:
            step, limit = fitted(t, step)
        interval = prepare(t, step, purpose, h, v, force)
        advance(client)
        if on_base:
            before = x
            (tilt, rate, _, _), (x, v, _, _) = read_both(body, joints, client)
            if loaded:
                z = hysteretic_force(z, scale * (x - before), *constants)
                force = spring * x + count * z
        else:
            tilt, rate, _, _ = read(body, turn, client)
        t, h = t + step, step
        keep((t, h, tilt, rate, x, v, z, force))
        if places:
            keep(_place(assembly))
        if not -fallen < tilt < fallen:
            ended = "overturned" if math.isfinite(tilt) and math.isfinite(rate) else "not finite"
            break
        if t >= end:
            ended = "done"
            break
    return _in_si(rows, width, units), ended


def _pace(scene, units, largest, accuracy):
    """Length and purpose of a step as `engines.pace` has them, in units of time; without accuracy all are `largest`."""
    model = RockingModel.of(scene)
    # Both corners count as loaded where the higher one is within what a step of free fall covers. With the few
    # iterations for one corner the slow onset of a slender block (.036) gained 1.5 times its tilt.
    standing = 2 * least_pull(model) * model.g * largest * largest / (2 * scene.block.half_width)
    if accuracy is None:
        return fixed(model, largest, standing)
    damping = _damping(model.bearing, units)
    sharpest = VISCOUS * accuracy * model.M / damping if damping else math.inf
    decay = damping / scene.base.mass if damping else 0.0
    thrown = THROWN if scene.motion else 1.0
    rule = StepRule(largest, SMALLEST_STEP, accuracy, APPROACH, sharpest, standing, True, True, decay, thrown)
    return impact_aware(model, scene.start.tilt_rate, rule)


def _jumps(scene, units, accuracy):
    """Times of the ground's jumps [unit of time] that the steps are to meet: none where they are all the same."""
    return [time / units.time for time in scene.motion.jumps] if scene.motion and accuracy is not None else []


def _damping(law, units):
    """Viscous constant of all bearings [kg over the unit of time]."""
    return law.count * law.damping * units.length / units.time


def _preparation(assembly, scene, units, largest):
    """A function (t, step, purpose, h, v, force) that sets a step, its iterations and its loads, after a step of h.

    It returns the time between the velocities before and after the step [unit of time].
    """
    client, body, base, model = assembly.client, assembly.body, assembly.base, RockingModel.of(scene)
    law, g, length, clock = model.bearing, model.g, units.length, units.time
    damping, mass, loaded = _damping(law, units), driven_mass(model), scene.bearings is not None
    heavier = length * leapfrog_stiffness(law, units.time * largest, mass)
    base_mass, ground = scene.base.mass if scene.base else 0.0, ground_velocity(scene.motion)
    upright = ground_velocity(scene.motion and scene.motion.vertical)
    # A force on the base's link is the same as one on its joint, and the call costs half as much.
    drive, middle, frame = pybullet.applyExternalForce, (0.0, 0.0, 0.0), pybullet.LINK_FRAME
    set_gravity, change, set_engine = pybullet.setGravity, pybullet.changeDynamics, pybullet.setPhysicsEngineParameter
    few, many = iterations(scene, 1), iterations(scene, 2)
    sweeps = few, min(many, max(few, LANDING_ITERATIONS)), many  # in FLIGHT, at an IMPACT, at REST
    last = used = 0
    gained, risen, pushed, last_scale, held, added = 0.0, 0.0, 0.0, -1.0, 0.0, 0.0

    def prepare(t, step, purpose, h, v, force):
        nonlocal last, used, gained, risen, pushed, last_scale, held, added
        needed = sweeps[purpose]
        if step != last or needed != used:
            last, used = step, needed
            set_engine(fixedTimeStep=step, physicsClientId=client, numSolverIterations=needed)
        if step == h:
            scale, interval = 1.0, step
        else:
            interval = 0.5 * (step + h)
            scale = interval / step
        if ground is not None:
            reached = ground(clock * (t + 0.5 * step)) / clock
            pushed, pull = (gained - reached) / step, -g * scale
            gained = reached
            if upright is not None:
                reached = upright(clock * (t + 0.5 * step)) / clock
                pull += (risen - reached) / step
                risen = reached
            set_gravity(pushed, 0.0, pull, client)
        elif scale != last_scale:
            set_gravity(0.0, 0.0, -g * scale, client)
            last_scale = scale
        if damping or heavier:
            if interval != held:
                held, added = interval, added_mass(damping, interval, mass) + heavier * interval * interval
                change(body, base, mass=base_mass + added, physicsClientId=client)
            drive(body, base, (-(force + damping * v) * scale - added * pushed, 0.0, 0.0), middle, frame, client)
        elif loaded:
            drive(body, base, (-force * scale, 0.0, 0.0), middle, frame, client)
        return interval

    return prepare


def _place(assembly):
    """x, z, x', z' of the block's centre."""
    joints = assembly.slide, assembly.lift
    (x, vx, _, _), (z, vz, _, _) = pybullet.getJointStates(assembly.body, joints, assembly.client)
    return x, z, vx, vz


def _in_si(rows, width, units):
    """Rows in SI, shape (steps + 1, width)."""
    time, length = units.time, units.length
    speed = length / time
    table = np.frombuffer(rows).reshape(-1, width)
    table *= (time, time, 1, 1 / time, length, speed, 1, 1, length, length, speed, speed)[:width]
    return table
