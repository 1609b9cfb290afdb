"""The scene in MuJoCo: its soft constraint solver decides contact and impact.

A MuJoCo contact is a spring and damper per unit of mass (solref: k, b), scaled by an impedance d < 1 (solimp): each
step it gives a corner the acceleration (1 - d) a0 - d (b v + k r), at its sink r, speed v and free acceleration a0. It
knows no restitution. With b = 1/step a corner stops in the step after it has sunk, whatever its speed, and the impact
is that of eq. (7): the old corner is free to lift in the same solve. k must only undo the sink, gently. Measured in
free rocking on rigid ground, gamma .2 (e = .9408) and .45 (.7162), steps of 1 ms, rms error of e:

    b = 1/step, Euler or implicitfast      1.9e-3, 4e-3    in proportion to the step (d = .999; below .9999)
    b = .9/step and 1.1/step               8e-3, 4e-2      whatever the step
    b = 1/step, k = .2/step^2              7e-3, 3e-2      whatever the step: the sink is thrown out
    b = 1/step, RK4; discrete              3e-2, 2e-1; 4e-2, 2e-1
    MuJoCo's defaults                      4e-3, 3e-3      gamma .1: 2e-2, m_b = 212 kg: 3e-2 to 2e-1; whatever the step

Without the flag diagexact a base of 1e-4 m moves 2 % too little (gamma .05). Small steps at impacts alone
(impact-aware) give, over 8 starts and 3 impacts each:

    gamma                        .1       .2       .3       .45
    e, rigid ground              1.0e-5   5e-6     1.0e-5   2.6e-5     .021 to .022 CPU seconds per second
    e, m_b = 212 kg              1.1e-5   7e-6     1.2e-5   3.4e-5     .021 to .026
    base velocity jump           2.4e-4   4e-5     4e-5     5e-5

All with mujoco 4.0.0; diagexact needs 3.9.
"""

import math
import time
from dataclasses import asdict, dataclass, replace
from typing import ClassVar

import mujoco
import numpy as np

from analytic.bearing import BearingLaw
from analytic.response import Failure
from analytic.rocking import RockingModel

from .deciding import until_decided
from .ground_velocity import ground_velocity
from .leapfrog_trace import raw_trace_of, trace_of
from .observe import failed_response, observe
from .settings import choose, leave_restitution

NAME = "mujoco"

DECIDES = (
    "MuJoCo's contact solver decides when a corner lands, sticks or lifts and what an impact does to the tilt rate and "
    "the base velocity; no restitution is given to it. The adapter gives it the bearings' force and the ground's "
    "acceleration, and chooses the length of the steps."
)


@dataclass(frozen=True)
class ImpactAware:
    """Large steps in flight and at rest, small ones on the way to an impact.

    accuracy is the one knob: the share of its speed at the impact that the block may gain in one step there.
    largest_step [s] is that of flight and rest.
    """

    # Table above. At a largest step of 4e-4 s: e within 1.3e-4 at 2e-5, 2.7e-4 at 5e-5; 2e-6 changes little.
    accuracy: float = 5e-6
    # Rocking on bearings the error goes with it, as friction stops the corner along the step's first tangent: under
    # Duzce (gamma .15) the tilt is off by 6e-3 of gamma to the sensitivity horizon, by 2e-3 at 1e-4 s, 2e-2 at 4e-4 s.
    # In free rocking 4e-4 s (e within 4.3e-5, velocity jump 5e-4) is enough, at half the cost.
    largest_step: float = 2e-4

    recovery: ClassVar = 150.0  # 1/s, see MOST_RECOVERY


@dataclass(frozen=True)
class FixedStep:
    """The same model at one step: `step` [s] is the one knob."""

    # e within 2e-4 (gamma .1 to .3, rigid ground) to 2.4e-3 (.45, m_b = 212 kg), .034 to .040 CPU s per s.
    step: float = 1e-4

    recovery: ClassVar = 30.0
    largest_step = property(lambda self: self.step)


@dataclass(frozen=True)
class FirstScript:
    """A box with all defaults of MuJoCo, loads and states taken as they come: `step` [s] hardly matters."""

    step: float = 2e-3  # MuJoCo's own default

    recovery: ClassVar = None
    largest_step = property(lambda self: self.step)


VARIANTS = {"impact-aware": ImpactAware(), "fixed-step": FixedStep(), "first-script": FirstScript()}
DEFAULT_VARIANT = "impact-aware"

FRICTION = 5.0  # stands for the model's "no sliding"; of two geoms MuJoCo takes the larger; e is the same with 1
CORNER_RADIUS = 1e-6  # share of R: the block touches by a sphere at each bottom corner; e is the same with 1e-8
# Of the contacts, at any depth. Largest error of e at steps up to 4e-4 s: 6.4e-5 at .99, 4.3e-5 at .999, 6.2e-5 at
# .9999 (one start 2e-3 at a smaller accuracy).
IMPEDANCE = 0.999

# A sink decays at the variant's rate `recovery`, by at most this share in a step. Steps along a tangent sink the pivot
# by h^2 phi'^2 R/2 each. At a small rate it sinks so far that a slender block lands early (gamma .1 on a base, steps up
# to .5 ms: velocity jump off by 1.4e-3 at 100, 1.1e-3 at 150); a large one throws the landing corner up (gamma .45 on a
# base: e off by 5e-5 at 150, 1.4e-4 at 200). At fixed steps of 1e-4 s only the second matters (rigid ground, gamma .45:
# e off by 4e-4 at 30, 7e-4 at 60, 1.8e-3 at 150).
MOST_RECOVERY = 0.1

# Share of gamma below which the block counts as in flat contact. At rest it tilts by up to 1e-6 of gamma, but on the
# way to an impact its pivot has sunk: gamma .1 is read right (e to 1e-4) from 5e-5 on at a largest step of 4e-4 s, from
# 2e-4 at 1e-3, 4e-4 at 2e-3. The default contact sinks by .02.
CONTACT_TILT, CONTACT_TILT_PER_SECOND, FIRST_CONTACT_TILT = 1e-4, 0.25, 0.05
FIRST_SETTLE = 0.1  # s, 5 time constants of the default contact; 0.2 reads the same e to 2e-3

# No accuracy knobs: over the ranges given e moves by at most 2e-5 and the number of steps by 2 % (gamma .1 and .45 on
# a base of 212 kg, steps up to 4e-4 s).
GROWTH = 1.5  # most growth from step to step; 1.25 to 2
APPROACH = 0.15  # share of the remaining time to the impact that a step may take; .1 to .3
SETTLING = 4  # steps that stay as small after an impact as at it; 1 to 8
FLAT = 1e-6  # swings below this share of gamma do not matter, their impacts are stepped over; 1e-7 to 1e-5
SMALLEST_STEP = 1e-7  # s; 1e-8 to 1e-6
# Steps after which a run is given up: this many per largest step of the duration, and a reserve for the impacts.
ROWS_PER_STEP, MOST_ROWS = 50, 20_000_000


class Mismatch(RuntimeError):
    """MuJoCo does not use what it was given."""


def versions():
    """Versions of what computes: {package: version}."""
    return {"mujoco": mujoco.__version__, "mujoco-library": mujoco.mj_versionString()}


@until_decided
def simulate(scene, *, variant=None, history=True, **settings):
    """The `Response` of a scene in MuJoCo; a run that went wrong has the outcome "failed" with its evidence.

    variant is one of `VARIANTS`, settings replace its fields, history keeps the history.

    Raises
    ------
    SettingError
        Unknown variant or setting, or a value that is no positive number.
    SceneError
        The scene overrides the restitution.
    """
    name, chosen = choose(NAME, VARIANTS, DEFAULT_VARIANT, variant, settings)
    leave_restitution(scene)
    given = dict(engine=NAME, variant=name, settings=asdict(chosen), versions=versions())
    warnings, handler = [], mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(warnings.append)  # else MuJoCo writes a log file into the working directory
    try:
        model, data = build(scene, chosen)
        clock = time.process_time()
        rows, ended = run(model, data, scene, chosen)
        cpu = time.process_time() - clock
    except (Mismatch, mujoco.FatalError) as error:
        return failed_response(scene, Failure("MuJoCo does not run the scene", str(error)), **given)
    finally:
        mujoco.set_mju_user_warning(handler)
    if isinstance(chosen, FirstScript):
        trace = replace(raw_trace_of(rows, scene, FIRST_CONTACT_TILT * scene.block.slenderness), settle=FIRST_SETTLE)
    else:
        share = max(CONTACT_TILT, CONTACT_TILT_PER_SECOND * chosen.largest_step)
        trace = trace_of(rows, scene, share * scene.block.slenderness)
    failure = _failure(scene, rows, ended, "; ".join(line.strip() for line in warnings))
    return observe(scene, trace, cpu_seconds=cpu, steps=len(rows) - 1, failure=failure, history=history,
                   ended=ended if ended == "overturned" else None, **given)


def _failure(scene, rows, ended, warned):
    """What went wrong in a finished run, or None."""
    count, t = len(rows) - 1, rows[-1][0]
    if ended == "not finite":
        return Failure("the state is no longer finite", f"at step {count}, t = {t:.9g} s. {warned}")
    if warned:  # of a bad state, which MuJoCo would reset to the start if it were not told to leave it
        return Failure("MuJoCo warned", warned)
    if ended == "too many steps":
        return Failure(ended, f"{count} by t = {t:.9g} s of {scene.duration:.9g} s")
    return None


def placement(scene):
    """Coordinates and velocities at the start: base (if any), block's centre x, z from its standing height, tilt."""
    start, block = scene.start, scene.block
    s = math.copysign(1.0, start.tilt or start.tilt_rate)
    angle = s * block.slenderness - start.tilt
    c, n = block.radius * math.cos(angle), block.radius * math.sin(angle)
    position = [start.base_displacement + s * block.half_width - n, c - block.half_height, start.tilt]
    velocity = [start.base_velocity + c * start.tilt_rate, n * start.tilt_rate, start.tilt_rate]
    if scene.base is None:
        return position, velocity
    return [start.base_displacement, *position], [start.base_velocity, *velocity]


def _ground(scene, geom=""):
    """MJCF of what the block stands on, its top at z = 0: a plane, or a slab on a slide joint for a base."""
    if scene.base is None:
        return f'<geom type="plane" size="0 0 1" {geom}/>'
    reach, depth = 100 * scene.block.radius, scene.block.radius  # a plane cannot move in MuJoCo
    return (f'<body><joint type="slide" axis="1 0 0"/><inertial pos="0 0 0" mass="{scene.base.mass!r}" '
            f'diaginertia="{scene.base.mass!r} {scene.base.mass!r} {scene.base.mass!r}"/>'
            f'<geom type="box" pos="0 0 {-depth!r}" size="{reach!r} {reach!r} {depth!r}" mass="0" {geom}/></body>')


def contact_reference(step, recovery):
    """solref for a step [s]: -stiffness and -damping per unit of mass that stop a corner in this very step.

    A corner that has sunk by r then moves up at r min(MOST_RECOVERY/step, recovery), whatever its speed was.
    """
    return -min(MOST_RECOVERY / step, recovery) / step, -1.0 / step


def build(scene, chosen):
    """(model, data) of the block on slide-x, slide-z and hinge-y joints over its ground or base, at the start.

    Raises
    ------
    Mismatch
        MuJoCo does not take the scene, or reports other values than it was given.
    """
    block, step = scene.block, chosen.largest_step
    b, h, r, i = block.half_width, block.half_height, CORNER_RADIUS * block.radius, block.centre_inertia
    if chosen.recovery is None:
        solref, option, geom, shape = None, "", "", f'<geom type="box" size="{b!r} {b!r} {h!r}"/>'
    else:
        k, d = solref = contact_reference(step, chosen.recovery)
        option = 'cone="elliptic"'
        geom = f'friction="{FRICTION!r} 0 0" solref="{k!r} {d!r}" solimp="{IMPEDANCE!r} {IMPEDANCE!r} 1 .5 2"'
        shape = "".join(f'<geom type="sphere" size="{r!r}" pos="{x!r} 0 {r - h!r}" {geom}/>' for x in (-b, b))
    try:
        model = mujoco.MjModel.from_xml_string(f"""<mujoco>
            <option timestep="{step!r}" gravity="0 0 {-scene.gravity!r}" {option}>
              <flag autoreset="disable" diagexact="{"enable" if solref else "disable"}"/></option>
            <worldbody>{_ground(scene, geom)}<body pos="0 0 {h!r}">
              <joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/><joint type="hinge" axis="0 1 0"/>
              <inertial pos="0 0 0" mass="{block.mass!r}" diaginertia="{i!r} {i!r} {i!r}"/>{shape}
            </body></worldbody></mujoco>""")
    except ValueError as error:
        raise Mismatch(str(error)) from error
    data = mujoco.MjData(model)
    check_readback(model, data, scene, step, solref)
    data.qpos[:], data.qvel[:] = placement(scene)
    return model, data


def check_readback(model, data, scene, step, solref):
    """Compare what MuJoCo holds with what the scene needs; raises `Mismatch` naming what differs.

    The contacts are looked at as MuJoCo combines them: the block is pushed into its base for it, and put back.
    They, and the solver, are left out where solref is None: those are MuJoCo's defaults.
    """
    option, block, depth = model.opt, scene.block, -1e-3 * scene.block.radius
    masses = [block.mass] if scene.base is None else [scene.base.mass, block.mass]
    expected = [
        ("time step", option.timestep, step), ("gravity", option.gravity, [0.0, 0.0, -scene.gravity]),
        ("integrator", option.integrator, int(mujoco.mjtIntegrator.mjINT_EULER)),
        ("disabled parts", option.disableflags, int(mujoco.mjtDisableBit.mjDSBL_AUTORESET)),
        ("density and viscosity", [option.density, option.viscosity], 0.0),
        ("masses", model.body_mass[1:], masses), ("inertia", model.body_inertia[-1], block.centre_inertia),
        ("centre of mass", model.body_ipos, 0.0), ("coordinates", model.nq, 2 + len(masses)),
        *((name, getattr(model, name), 0.0)
          for name in ("dof_damping", "dof_frictionloss", "dof_armature", "jnt_stiffness")),
    ]
    if solref:
        data.qpos[-2] = depth
        mujoco.mj_fwdPosition(model, data)
        expected += [("cone", option.cone, int(mujoco.mjtCone.mjCONE_ELLIPTIC)),
                     ("solver", option.solver, int(mujoco.mjtSolver.mjSOL_NEWTON)),
                     ("enabled parts", option.enableflags, int(mujoco.mjtEnableBit.mjENBL_DIAGEXACT)),
                     ("contacts of a standing block", data.ncon, 2)]
        for contact in data.contact:
            expected += [("contact: friction", contact.friction[:2], FRICTION), ("contact: dimension", contact.dim, 3),
                         ("contact: solref", contact.solref, solref), ("contact: margin", contact.includemargin, 0.0),
                         ("contact: solimp", contact.solimp, [IMPEDANCE, IMPEDANCE, 1, 0.5, 2]),
                         ("contact: depth", contact.dist, depth)]
        mujoco.mj_resetData(model, data)
    wrong = [f"{name} is {np.asarray(used).tolist()}, not {np.asarray(wanted).tolist()}"
             for name, used, wanted in expected
             if np.size(wanted) not in (1, np.size(used)) or not np.allclose(used, wanted, 1e-12, 1e-14)]
    if wrong:
        raise Mismatch("; ".join(wrong))


def run(model, data, scene, chosen):
    """Step until the duration is over, the block has overturned or a state is not finite.

    MuJoCo's Euler is leapfrog: displacements live at the steps' ends, velocities half a step earlier. A load that
    acts for the mean of two steps is scaled by (h + h')/(2 h'), see pybullet_stepping. Not so for a first script.

    Returns
    -------
    rows, ended
        As pybullet_stepping.run.
    """
    largest, recovery, as_it_comes = chosen.largest_step, chosen.recovery, chosen.recovery is None
    law, g, start = BearingLaw.of(scene.bearings), scene.gravity, scene.start
    pace = Pace(scene, largest, chosen.accuracy) if isinstance(chosen, ImpactAware) else None
    ground, sampled = ground_velocity(scene.motion), scene.motion.acceleration if scene.motion else None
    advance, state, speed, push = mujoco.mj_step, data.qpos, data.qvel, data.qfrc_applied
    option, gravity, solref = model.opt, model.opt.gravity, model.geom_solref
    on_base, loaded, damping = scene.base is not None, scene.bearings is not None, law.count * law.damping
    end, limit = scene.duration - 1e-9 * largest, 0.5 * math.pi
    row_limit = int(min(MOST_ROWS, ROWS_PER_STEP * scene.duration / largest + 100_000))
    t, h, used = 0.0, 0.0, largest
    tilt, rate, x, v = start.tilt, start.tilt_rate, start.base_displacement, start.base_velocity
    z = law.start(x)
    force, earlier, gained, interval, last_scale, jumped = law.force(x, z), v, 0.0, 1.0, 1.0, False
    rows = [(t, h, tilt, rate, x, v, z, force, *state[-3:-1].tolist(), *speed[-3:-1].tolist())]
    while t < end:
        step = pace.next(tilt, rate, jumped, interval) if pace else largest
        if t + step > end + 2e-9 * largest:
            step = scene.duration - t
        if step != used:
            option.timestep = used = step
            if not as_it_comes:
                solref[:] = contact_reference(step, recovery)
        scale = 1.0 if as_it_comes else 0.5 * (step + h) / step
        if sampled and as_it_comes:
            gravity[0] = -float(sampled(t))
        elif ground:
            reached = ground(t + 0.5 * step)
            gravity[0] = (gained - reached) / step
            gained = reached
        if scale != last_scale:
            gravity[2] = -g * scale
            last_scale = scale
        if loaded:
            pushed = force
            if damping:  # at the velocity at t, extrapolated from the last two but never through an impact
                pushed += damping * (v if jumped or as_it_comes else v + (v - earlier) / interval * 0.5 * h)
            push[0] = -pushed * scale
        advance(model, data)
        interval, earlier, side = 0.5 * (step + h), v, tilt > 0
        tilt, rate = state.item(-1), speed.item(-1)
        if on_base:
            before, x, v = x, state.item(0), speed.item(0)
            if loaded:
                z = law.hysteretic(z, x - before)
                force = law.force(x, z)
        t, h, jumped = t + step, step, (tilt > 0) != side
        rows.append((t, h, tilt, rate, x, v, z, force, state.item(-3), state.item(-2), speed.item(-3), speed.item(-2)))
        if not -limit < tilt < limit:
            return rows, "overturned" if math.isfinite(tilt) else "not finite"
        if len(rows) > row_limit:
            return rows, "too many steps"
    return rows, "done"


class Pace:
    """Length of the next step: large in flight and at rest, small on the way to an impact and just after it."""

    def __init__(self, scene, largest, fraction):
        model = RockingModel.of(scene)
        self.largest, self.fraction = largest, fraction
        self.least_pull = abs(model.accelerations(1.0, 0.0, 0.0, 0.0, 0.0)[0])  # |tilt''| toward contact, unforced
        self.weak = 2 * self.least_pull * FLAT * scene.block.slenderness  # square of the speed at such an impact
        # A first swing may be short: start small and let the step grow.
        self.step = min(largest, max(SMALLEST_STEP, fraction * abs(scene.start.tilt_rate) / self.least_pull,
                                     1e-2 * largest))
        self.before, self.settling = None, 0

    def next(self, tilt, rate, jumped, interval):
        """Step [s] from a state; jumped: it lies on the other side than the one before, interval [s] earlier."""
        toward, size = (-rate, tilt) if tilt > 0 else (rate, -tilt)
        least = self.least_pull
        energy = toward * toward + 2 * least * size  # of the swing, as the square of its speed at the impact
        gain = 0.0 if self.before is None or jumped else (self.before - rate if tilt > 0 else rate - self.before)
        first, self.before = self.before is None, rate
        if jumped:
            self.settling = SETTLING if energy > self.weak else 0
        if self.settling:
            self.settling -= 1
        elif not first:
            wanted = min(self.step * GROWTH, self.largest)
            if energy > self.weak:
                pull = max(least, gain / interval)  # what the last step gained, where that is more: the ground may push
                speed = math.sqrt(toward * toward + 2 * pull * size)
                finest = max(SMALLEST_STEP, self.fraction * speed / pull)
                near = APPROACH * ((speed - toward) / pull - 3 * finest)
                wanted = min(wanted, max(near, finest))
            self.step = wanted
        return self.step
