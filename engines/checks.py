"""What must hold in every engine run, whatever its accuracy: the bearing law, and no energy from nowhere."""

import dataclasses
import math

import numpy as np
from numba import njit
from scipy.interpolate import CubicHermiteSpline

from analytic.bearing import LINEAR, BearingLaw, hysteretic_force
from analytic.motion import SampledMotion

from .swings import ArrayModel

# Energy gain of a run, in the units of `energy_gain`, above which it counts as failed: half of the motion's energy
# came from nowhere. The errors of legitimate steps stay below a tenth of it (tests/engines/test_observe.py, steps up
# to 1/60 s); a contact instability reaches 1, as its gain becomes the largest kinetic energy.
GAIN_LIMIT = 0.5


@njit(cache=True)
def _replay(z, x, law, dk, alpha, d0, f0):
    forces = np.empty_like(x)
    forces[0] = z
    for i in range(1, len(x)):
        z = hysteretic_force(z, x[i] - x[i - 1], law, dk, alpha, d0, f0)
        forces[i] = z
    return forces


def replayed_force(scene, trace):
    """Force of all bearings together [N] at the steps, by the law on the trace's displacements, eqs (9)-(14)."""
    law = BearingLaw.of(scene.bearings)
    x = trace.base_displacement
    z = _replay(law.start(float(x[0])), x, law.law, law.dk, law.alpha, law.d0, law.f0)
    return law.force(x, z, trace.base_velocity)


def replay_bearing(scene, trace):
    """Largest difference per bearing between the trace's force and the law replayed, over f0.

    The steps of the trace are taken as monotonic, as an engine takes them that commits the history once per
    accepted step. A linear law has no f0: there it is over the largest replayed force. 0 without bearings.
    """
    if scene.bearings is None:
        return 0.0
    law = BearingLaw.of(scene.bearings)
    force = replayed_force(scene, trace)
    scale = np.abs(force).max() / law.count if law.law == LINEAR else law.f0
    return float(np.abs(trace.bearing_force - force).max() / law.count / scale) if scale > 0 else 0.0


def energy_balance(scene, trace):
    """(balance, kinetic) [J], shape (n,): mechanical energy + loss in the bearings - input work, 0 at the start.

    In the ground's frame, where the ground motion is the inertial load -a_g on both masses. Constant in flight
    for an exact solution; every impact lowers it. Work by the trapezoidal rule, over the trace's steps and the
    motion's samples together.
    """
    model = ArrayModel.of(scene)
    law = model.bearing
    time, tilt, x = _refined(scene, trace)
    kept = np.searchsorted(time, trace.time)
    # Centre of mass relative to the base's middle: s b - n; its velocity is c phi'.
    b, h = model.R * math.sin(model.gamma), model.R * math.cos(model.gamma)
    side = np.where(tilt < 0, -1.0, 1.0)
    c, n = model.lever(side, tilt)
    M = model.M if model.on_base else 0.0
    ground = scene.motion.acceleration(time) if scene.motion else np.zeros_like(x)
    work = -_trapezoid(ground, M * x + model.m * (side * b - n))[kept]
    c, w, x, v = c[kept], trace.tilt_rate, trace.base_displacement, trace.base_velocity
    kinetic = 0.5 * M * v**2 + model.m * c * w * v + 0.5 * model.J * w**2
    potential = model.m * model.g * (c - h) + 0.5 * law.count * law.kb * x**2
    lost = _trapezoid(trace.bearing_force - law.count * law.kb * x, x)
    balance = kinetic + potential + lost - work
    return balance - balance[0], kinetic


def _refined(scene, trace):
    """(time, tilt, base displacement) at the steps and at the motion's samples between them."""
    time = trace.time
    if isinstance(scene.motion, SampledMotion):
        samples = scene.motion.dt * np.arange(len(scene.motion.samples))
        time = np.union1d(time, samples[(samples > time[0]) & (samples < time[-1])])
    curves = CubicHermiteSpline(trace.time, np.column_stack([trace.tilt, trace.base_displacement]),
                                np.column_stack([trace.tilt_rate, trace.base_velocity]))
    return time, *curves(time).T


def _trapezoid(force, path):
    return np.concatenate(([0.0], np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(path))))


def energy_gain(scene, trace):
    """Largest rise of `energy_balance` over its lowest value so far; such a rise has no physical cause.

    In units of m g R (1 - cos gamma), which takes the block from rest to the unstable point, or of the largest
    kinetic energy where that is more. NaN where the energy overflows. Steps within ``trace.settle`` after a
    crossing of tilt = 0 are left out.
    """
    trace = _settled(trace)
    with np.errstate(over="ignore", invalid="ignore"):  # a state that exploded has no balance: NaN
        balance, kinetic = energy_balance(scene, trace)
    block = scene.block
    unit = block.mass * scene.gravity * block.radius * (1 - math.cos(block.slenderness))
    return float((balance - np.minimum.accumulate(balance)).max() / max(unit, kinetic.max()))


def _settled(trace):
    """The steps of a trace outside the relaxation of a compliant contact after each crossing of tilt = 0.

    There the block does not pivot about its corner, and the energy of a pivoting block does not describe it.
    """
    crossings = trace.time[1:][np.diff(np.sign(trace.tilt)) != 0]
    last = np.searchsorted(crossings, trace.time, side="right") - 1
    since = trace.time - np.concatenate(([-math.inf], crossings))[last + 1]
    steps = np.flatnonzero(since >= trace.settle)
    if len(steps) < 2:
        return trace
    return dataclasses.replace(trace, **{name: getattr(trace, name)[steps] for name in trace.COLUMNS})
