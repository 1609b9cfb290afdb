"""Stepping a scene in Bullet: loads, step size, readback.

Bullet is leapfrog: displacements live at the steps' ends t_n, velocities half a step earlier. Between velocities at
t_n - h/2 and t_n + h'/2 lie (h + h')/2 seconds, but Bullet multiplies the loads by h' alone. Scaling all loads of a
step by (h + h')/(2 h') makes the scheme second order for any sequence of steps, the start included (h = 0), and
needs no correction of velocities when the step changes.

A viscous force is solved for within the step, exactly for a constant rest of the forces: acting with the velocity
known, c v, on a base heavier by `added_mass`. Given explicitly it blows up where a step times c/mass exceeds 2.
"""

import math
from array import array

import numpy as np
import pybullet

from analytic.bearing import hysteretic_force
from analytic.rocking import RockingModel

from ..ground_velocity import ground_velocity
from .scene import iterations, placement

# The next four are no accuracy knobs: measured on free rocking (slenderness .1 and .45, rigid ground and m_b = 212 kg),
# e moved by at most 4e-6 and the number of steps by at most 8 % over the ranges given.
GROWTH = 1.5  # most growth from step to step; 1.25 to 2
APPROACH = 0.3  # share of the remaining time to the impact that a step may take; .15 to .5
SETTLING = 4  # steps that stay as small after an impact as at it: Bullet spreads it over two; 1 to 8
FLAT = 1e-6  # swings below this share of gamma do not matter, their impacts are stepped over; 1e-7 to 1e-5
# [s]; 1e-6 doubles the error of e of the stockiest block on a base, 1e-8 changes nothing.
SMALLEST_STEP = 1e-7

# Most iterations at an impact, where both corners may carry. They matter where e is near 0, for stocky blocks: these
# need fewer to stand. (Slenderness .96, J_O = 1.09 m R^2: e of .03 for 0 with the iterations of one corner.)
LANDING_ITERATIONS = 100
# Most of a step over the time in which the bearings' vibration advances by 1 rad; stable below 2.
VIBRATION = 0.2
# Most that viscous bearings may take of a velocity in a step at an impact, in units of `accuracy`.
VISCOUS = 10.0
# Leapfrog vibrates too fast, by (h omega)^2/24; this share of the stiffness times h^2 as mass cures it. Without damping
# the phase at the next impact decides how far the base goes. Not needed below STIFF = h omega.
LEAPFROG, STIFF = 1 / 12, 0.02


def longest_step(scene, units, largest):
    """The longest step [unit of time], at most `largest`, that follows the base's vibration on its bearings."""
    if scene.bearings is None:
        return largest
    model = RockingModel.of(scene)
    law = model.bearing
    k = law.count * (law.kb + law.dk) * units.length * VIBRATION**-2
    c = law.count * law.damping * units.length / units.time
    # h^2 k = mass + h c: with much damping the base creeps, with the time constant c/k
    return min(largest, (c + math.sqrt(c * c + 4 * k * driven_mass(model))) / (2 * k))


def driven_mass(model):
    """Mass that the base puts up against a force while the block pivots through tilt 0 [kg], least for J_O = m R^2."""
    return model.M - (model.m * model.R * math.cos(model.gamma)) ** 2 / model.J


def added_mass(damping, interval, mass):
    """Mass to add to `mass` where a force c v acts at the velocity before `interval`, to come out right after it."""
    x = damping * interval / mass
    return mass * (x / -math.expm1(-x) - 1) if x > 1e-8 else 0.5 * damping * interval


def run(assembly, scene, units, largest, accuracy, row_limit, places=False):
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
        In SI, per step, the start first: time [s], length of the step that led there [s], tilt [rad], its rate [rad/s],
        base displacement [m] and velocity [m/s], hysteretic force of one bearing [N], total force without viscous
        part [N]; with `places` the centre of the block [m] and its velocity [m/s], as `Trace.centre`. Rates are
        Bullet's own, half a step early.
    ended : str
        "done", "overturned", "not finite" or "too many steps".
    """
    client, body = assembly.client, assembly.body
    model = RockingModel.of(scene)
    law, g = model.bearing, model.g
    on_base, loaded = assembly.base is not None, scene.bearings is not None
    joints, centre = (assembly.tilt, assembly.base), (assembly.slide, assembly.lift)
    ground, clock = ground_velocity(scene.motion), units.time
    aware, fraction = accuracy is not None, accuracy or 0.0
    least_pull = abs(model.accelerations(1.0, 0.0, 0.0, 0.0, 0.0)[0])  # |tilt''| toward contact, unforced
    weak = 2 * least_pull * FLAT * scene.block.slenderness  # square of the speed at the impact of such a swing
    constants = (law.law, *law.constants)
    count, length, spring = law.count, units.length, law.count * law.kb * units.length
    damping, mass = law.count * law.damping * units.length / units.time, driven_mass(model)
    # Small vibrations of a hysteretic bearing are those of about half its initial excess of stiffness.
    elastic = spring + 0.5 * count * law.dk * length
    heavier = LEAPFROG * elastic if largest * math.sqrt(elastic / mass) > STIFF else 0.0
    sharpest = VISCOUS * fraction * model.M / damping if damping else math.inf
    start, end, limit = scene.start, scene.duration, 0.5 * math.pi
    step_simulation, set_gravity = pybullet.stepSimulation, pybullet.setGravity
    read_both, read, turn = pybullet.getJointStates, pybullet.getJointState, assembly.tilt
    # A force on the base's link is the same as one on its joint, and the call costs half as much.
    drive, base, middle, frame = pybullet.applyExternalForce, assembly.base, (0.0, 0.0, 0.0), pybullet.LINK_FRAME
    sqrt, engine_step, change = math.sqrt, pybullet.setPhysicsEngineParameter, pybullet.changeDynamics

    t, h = 0.0, 0.0
    tilt, rate, x, v = start.tilt, start.tilt_rate, start.base_displacement, start.base_velocity
    z = law.start(length * x)
    force, committed = spring * x + count * z, x
    rows = array("d", (t, h, tilt, rate, x, v, z, force, *(placement(scene) if places else ())))
    keep, step, side, width = rows.extend, largest, tilt > 0, len(rows)
    before, interval, gained, settling = 0.0, 1.0, 0.0, 0
    # Below `almost` both corners count as loaded: the higher one is within what a step of free fall covers. With the
    # few iterations for one corner the slow onset of a slender block (.036) gained 1.5 times its tilt.
    twice_pull = 2 * least_pull
    almost = max(100 * weak, twice_pull * g * largest * largest / (2 * scene.block.half_width))
    level_tilt = almost / twice_pull
    last_scale, used, few, many = -1.0, 0, iterations(scene, 1), iterations(scene, 2)
    some = min(many, max(few, LANDING_ITERATIONS))
    pushed, held, added = 0.0, 0.0, 0.0
    if aware:  # a first swing may be short: start small and let the step grow
        step = min(largest, max(SMALLEST_STEP, fraction * abs(rate) / least_pull, 1e-2 * largest))
    end -= 1e-9 * largest  # the steps' sum may miss the duration by rounding
    # Farther than this time from its impact the block is left at the largest step, without a closer look.
    reach = largest / APPROACH * 1.2
    gate, cruising = end + 2e-9 * largest, False
    ended, base_mass = "done", scene.base.mass if on_base else 0.0
    for _ in range(row_limit):
        if t >= end:
            break
        jumped = (tilt > 0) != side
        side = tilt > 0
        wanted, landing = step, False  # landing: both corners may carry in this step
        if aware:
            toward, size = (-rate, tilt) if side else (rate, -tilt)
            far = False
            if cruising and not jumped and size > level_tilt:
                # What the last step gained toward contact, where that is more: the ground may push.
                pull = (before - rate if side else rate - before) / interval
                if pull < least_pull:
                    pull = least_pull
                far = size > reach * (toward + 0.5 * reach * pull)
            if not far:
                energy = toward * toward + twice_pull * size  # of the swing, as the square of its speed at the impact
                standing = energy < almost
                if jumped:
                    settling = SETTLING if energy > weak else 0
                if settling:
                    settling -= 1
                    landing = True
                elif h:
                    wanted = step * GROWTH
                    if wanted > largest:
                        wanted = largest
                    if energy > weak:
                        pull = least_pull if jumped else (before - rate if side else rate - before) / interval
                        if pull < least_pull:
                            pull = least_pull
                        speed = sqrt(toward * toward + 2 * pull * size)
                        finest = max(SMALLEST_STEP, fraction * speed / pull)
                        if finest > sharpest:
                            finest = sharpest
                        near = APPROACH * ((speed - toward) / pull - 3 * finest)
                        if near < wanted:
                            landing = near <= finest
                            wanted = finest if landing else near
                cruising = wanted == step == largest and not standing and not settling
        else:
            standing = -level_tilt < tilt < level_tilt and rate * rate < almost
            landing = jumped or (tilt + 2 * step * rate > 0) != side
        if t + wanted > gate:
            wanted = scene.duration - t
        needed = many if standing else some if landing else few
        if wanted != step or needed != used:
            step, used = wanted, needed
            engine_step(fixedTimeStep=step, physicsClientId=client,
                        numSolverIterations=needed)
        scale = 1.0 if step == h else 0.5 * (step + h) / step
        if ground is not None:
            reached = ground(clock * (t + 0.5 * step)) / clock
            pushed = (gained - reached) / step
            set_gravity(pushed, 0.0, -g * scale, client)
            gained = reached
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
        before = rate
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
    sizes = (units.time, units.time, 1, 1 / units.time, units.length, speed, 1, 1,
             units.length, units.length, speed, speed)
    table = np.frombuffer(rows).reshape(-1, width)
    table *= sizes[:width]
    return table, ended
