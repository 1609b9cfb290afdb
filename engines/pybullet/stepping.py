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

from analytic.bearing import hysteretic_force
from analytic.rocking import RockingModel

from .. import pace as paces
from ..ground_velocity import ground_velocity
from ..placement import placement
from ..vibration import VISCOUS, added_mass, driven_mass, leapfrog_stiffness
from .scene import iterations

if TYPE_CHECKING:
    from analytic import Scene

    from .scene import Assembly, Units

APPROACH = 0.3  # share of the remaining time to the impact that a step may take; .15 to .5: no accuracy knob
# [s]; 1e-6 doubles the error of e of the stockiest block on a base, 1e-8 changes nothing.
SMALLEST_STEP = 1e-7

# Most iterations at an impact, where both corners may carry. They matter where e is near 0, for stocky blocks: these
# need fewer to stand. (Slenderness .96, J_O = 1.09 m R^2: e of .03 for 0 with the iterations of one corner.)
LANDING_ITERATIONS = 100


def run(
    assembly: Assembly,
    scene: Scene,
    units: Units,
    largest: float,
    accuracy: float | None,
    row_limit: int,
    places: bool = False,
) -> tuple[np.ndarray, str]:
    """Step until the duration is over, the block has overturned or a state is not finite.

    Parameters
    ----------
    scene : Scene
        In Bullet's `Units` (`Units.scale`), but for its motion and bearings.
    units : Units
    largest : float
        Longest step [unit of time]; the only one where `accuracy` is None.
    accuracy : float or None
        Share of its speed at the impact that the block may gain in one step there.
    row_limit : int
        Steps after which the run is given up.
    places : bool
        Read the block's centre, too; a step costs up to a tenth more.

    Returns
    -------
    rows : array, shape (steps + 1, 8), with `places` 12
        As `engines.leapfrog` has them, in SI, the start first.
    ended : str
        "done", "overturned", "not finite" or "too many steps".
    """
    client, body = assembly.client, assembly.body
    model = RockingModel.of(scene)
    law, g = model.bearing, model.g
    on_base, loaded = assembly.base is not None, scene.bearings is not None
    joints, centre = (assembly.tilt, assembly.base), (assembly.slide, assembly.lift)
    ground, clock = ground_velocity(scene.motion), units.time
    upright = ground_velocity(scene.motion.vertical) if scene.motion else None
    constants = (law.law, *law.constants)
    count, length, spring = law.count, units.length, law.count * law.kb * units.length
    damping, mass = law.count * law.damping * units.length / units.time, driven_mass(model)
    heavier = length * leapfrog_stiffness(law, units.time * largest, mass)
    start, end, limit = scene.start, scene.duration, 0.5 * math.pi
    step_simulation, set_gravity = pybullet.stepSimulation, pybullet.setGravity
    read_both, read, turn = pybullet.getJointStates, pybullet.getJointState, assembly.tilt
    # A force on the base's link is the same as one on its joint, and the call costs half as much.
    drive, base, middle, frame = pybullet.applyExternalForce, assembly.base, (0.0, 0.0, 0.0), pybullet.LINK_FRAME
    engine_step, change = pybullet.setPhysicsEngineParameter, pybullet.changeDynamics

    t, h = 0.0, 0.0
    tilt, rate, x, v = start.tilt, start.tilt_rate, start.base_displacement, start.base_velocity
    z = law.start(length * x)
    force, committed = spring * x + count * z, x
    rows = array("d", (t, h, tilt, rate, x, v, z, force, *(placement(scene) if places else ())))
    keep, step, side, width = rows.extend, largest, tilt > 0, len(rows)
    interval, gained, risen, last_scale, used = 1.0, 0.0, 0.0, -1.0, 0
    few, many = iterations(scene, 1), iterations(scene, 2)
    sweeps = few, min(many, max(few, LANDING_ITERATIONS)), many  # in FLIGHT, at an IMPACT, at REST
    pushed, held, added = 0.0, 0.0, 0.0
    # Both corners count as loaded where the higher one is within what a step of free fall covers. With the few
    # iterations for one corner the slow onset of a slender block (.036) gained 1.5 times its tilt.
    standing = 2 * paces.least_pull(model) * g * largest * largest / (2 * scene.block.half_width)
    if accuracy is None:
        pace = paces.fixed(model, largest, standing)
    else:
        sharpest = VISCOUS * accuracy * model.M / damping if damping else math.inf
        pace = paces.impact_aware(
            model,
            rate,
            largest,
            accuracy,
            approach=APPROACH,
            smallest=SMALLEST_STEP,
            sharpest=sharpest,
            standing=standing,
            overlong=True,
            cruise=True,
        )
    end -= 1e-9 * largest  # the steps' sum may miss the duration by rounding
    gate = end + 2e-9 * largest
    jumps = iter([time / clock for time in scene.motion.jumps] if scene.motion and accuracy is not None else ())
    jump = next(jumps, math.inf)
    ended, base_mass = "done", scene.base.mass if on_base else 0.0
    for _ in range(row_limit):
        if t >= end:
            break
        jumped = (tilt > 0) != side
        side = tilt > 0
        wanted, purpose = pace(tilt, rate, jumped, interval)
        if t + wanted >= jump:
            if t >= jump:
                jump = next(jumps, math.inf)
            wanted = paces.aligned(wanted, jump - t)
        if t + wanted > gate:
            wanted = scene.duration - t
        needed = sweeps[purpose]
        if wanted != step or needed != used:
            step, used = wanted, needed
            engine_step(fixedTimeStep=step, physicsClientId=client, numSolverIterations=needed)
        scale = 1.0 if step == h else 0.5 * (step + h) / step
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
        interval = step if scale == 1.0 else 0.5 * (step + h)
        if damping or heavier:
            if interval != held:
                held, added = interval, added_mass(damping, interval, mass) + heavier * interval * interval
                change(body, base, mass=base_mass + added, physicsClientId=client)
            drive(body, base, (-(force + damping * v) * scale - added * pushed, 0.0, 0.0), middle, frame, client)
        elif loaded:
            drive(body, base, (-force * scale, 0.0, 0.0), middle, frame, client)
        step_simulation(client)
        if on_base:
            (tilt, rate, _, _), (x, v, _, _) = read_both(body, joints, client)
            if loaded:
                z = hysteretic_force(z, length * (x - committed), *constants)
                committed = x
                force = spring * x + count * z
        else:
            tilt, rate, _, _ = read(body, turn, client)
        t, h = t + step, step
        if places:
            (across, across_rate, _, _), (up, up_rate, _, _) = read_both(body, centre, client)
            keep((t, h, tilt, rate, x, v, z, force, across, up, across_rate, up_rate))
        else:
            keep((t, h, tilt, rate, x, v, z, force))
        if not -limit < tilt < limit:
            ended = "overturned" if math.isfinite(tilt) and math.isfinite(rate) else "not finite"
            break
    else:
        ended = "done" if t >= end else "too many steps"
    speed = units.length / units.time
    sizes = (
        units.time,
        units.time,
        1,
        1 / units.time,
        units.length,
        speed,
        1,
        1,
        units.length,
        units.length,
        speed,
        speed,
    )
    table = np.frombuffer(rows).reshape(-1, width)
    table *= sizes[:width]
    return table, ended
