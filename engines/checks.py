"""What must hold in every engine run, however coarse: the bearing law, the block's place, no energy from nowhere."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from analytic.bearing import BearingLaw
from analytic.motion import SampledMotion
from analytic.response import Failure

from .swings import ArrayModel

if TYPE_CHECKING:
    from analytic import Scene
    from analytic.motion import Motion

    from .swings import Trace

# Energy gain of a run, in the units of `energy_gain`, above which it counts as failed: half of the motion's energy
# came from nowhere. The errors of legitimate steps stay below a tenth of it (tests/engines/test_observe.py, steps up
# to 1/60 s); a contact instability reaches 1, as its gain becomes the largest kinetic energy.
GAIN_LIMIT = 0.5

# Sliding and height of the lower corner [share of R] that end a run as failed.
SLIDING_TOLERANCE, HEIGHT_TOLERANCE = 0.03, 2e-3


def replayed_force(scene: Scene, trace: Trace) -> np.ndarray:
    """Force of all bearings together [N] at the steps, by the law on the trace's displacements, eqs (9)-(14)."""
    law = BearingLaw.of(scene.bearings)
    return law.force(trace.base_displacement, law.path(trace.base_displacement), trace.base_velocity)


def replay_bearing(scene: Scene, trace: Trace) -> float:
    """Largest difference per bearing between the trace's force and the law replayed, over f0.

    The steps of the trace are taken as monotonic, as an engine takes them that commits the history once per
    accepted step. A linear law has no f0: there it is over the largest replayed force. 0 without bearings.
    """
    if scene.bearings is None:
        return 0.0
    law = BearingLaw.of(scene.bearings)
    force = replayed_force(scene, trace)
    scale = np.abs(force).max() / law.count if law.f0 == 0 else law.f0
    return float(np.abs(trace.bearing_force - force).max() / law.count / scale) if scale > 0 else 0.0


def energy_balance(scene: Scene, trace: Trace) -> tuple[np.ndarray, np.ndarray]:
    """(balance, kinetic) [J], shape (n,): mechanical energy + loss in the bearings - input work, 0 at the start.

    In the ground's frame, where the ground motion is the inertial load -a_g on both masses and -a_v on the block.
    Constant in flight, about a corner or free, for an exact solution; every impact lowers it. Work by the trapezoidal
    rule, over the trace's steps and the motion's samples together.
    """
    model = ArrayModel.of(scene)
    law, m, base = model.bearing, model.m, model.M - model.m if model.on_base else 0.0
    centre = pivoting_centre(scene, trace) if trace.centre is None else trace.centre
    x, v, z = trace.base_displacement, trace.base_velocity, centre[:, 1]
    kinetic = 0.5 * (
        base * v**2 + m * (centre[:, 2] ** 2 + centre[:, 3] ** 2) + scene.block.centre_inertia * trace.tilt_rate**2
    )
    potential = m * model.g * z + 0.5 * law.count * law.kb * x**2
    lost = _trapezoid(trace.bearing_force - law.count * law.kb * x, x)
    moved = base * x + m * centre[:, 0], base * v + m * centre[:, 2]
    balance = kinetic + potential + lost - _work(scene.motion, trace.time, *moved)
    if scene.motion is not None:
        balance = balance - _work(scene.motion.vertical, trace.time, m * z, m * centre[:, 3])
    return balance - balance[0], kinetic


def pivoting_centre(scene: Scene, trace: Trace) -> np.ndarray:
    """Centre of a block that turns about its lower corner at the place of a standing one, as `Trace.centre`."""
    side = np.where(trace.tilt < 0, -1.0, 1.0)
    c, n = ArrayModel.of(scene).lever(side, trace.tilt)
    return np.column_stack(
        [
            trace.base_displacement + side * scene.block.half_width - n,
            c - scene.block.half_height,
            trace.base_velocity + c * trace.tilt_rate,
            n * trace.tilt_rate,
        ]
    )


def check_place(scene: Scene, trace: Trace, overturned: bool) -> Failure | None:
    """A `Failure` where at the end the block has slid on its base, sunk into it or left it, else None.

    On the way it may fly and land again: that is the engine's decision, as long as it lands where it stood. A block
    that overturns may do so anywhere. None, too, where the engine's place of the block was not read.
    """
    if trace.centre is None or overturned:
        return None
    R = scene.block.radius
    slid, height = (trace.centre - pivoting_centre(scene, trace))[:, :2].T
    flown = f"; its lower corner was at up to {height.max():.3g} m before"
    if abs(slid[-1]) > SLIDING_TOLERANCE * R:
        return Failure(
            "the block slid on its base", f"by {slid[-1]:.6g} m; tolerated: {SLIDING_TOLERANCE * R:.3g} m{flown}"
        )
    if abs(height[-1]) > HEIGHT_TOLERANCE * R:
        word = "sank into" if height[-1] < 0 else "left"
        return Failure(
            f"the block {word} its base",
            f"lower corner at {height[-1]:.6g} m; tolerated: {HEIGHT_TOLERANCE * R:.3g} m{flown}",
        )
    return None


def _work(motion: Motion | None, time: np.ndarray, moved: np.ndarray, rate: np.ndarray) -> np.ndarray:
    """Work [J] of the inertial load up to each step, from the sum of mass times displacement [kg m] and its rate."""
    if motion is None:
        return np.zeros_like(time)
    fine, between = time, moved
    if isinstance(motion, SampledMotion):
        samples = motion.dt * np.arange(len(motion.samples))
        fine = np.union1d(time, samples[(samples > time[0]) & (samples < time[-1])])
        between = CubicHermiteSpline(time, moved, rate)(fine)
    return -_trapezoid(motion.acceleration(fine), between)[np.searchsorted(fine, time)]


def _trapezoid(force: np.ndarray, path: np.ndarray) -> np.ndarray:
    return np.concatenate(([0.0], np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(path))))


def energy_gain(scene: Scene, trace: Trace) -> float:
    """Largest rise of `energy_balance` over its lowest value so far; such a rise has no physical cause.

    In units of m g R (1 - cos gamma), which takes the block from rest to the unstable point, or of the largest
    kinetic energy where that is more. NaN where the energy overflows. Steps within ``trace.settle`` after a
    crossing of tilt = 0 are left out.
    """
    block = scene.block
    level = low = rise = 0.0
    unit = block.mass * scene.gravity * block.radius * (1 - math.cos(block.slenderness))
    with np.errstate(over="ignore", invalid="ignore"):  # a state that exploded has no balance: NaN
        for piece in trace.pieces(_settled(trace)):
            balance, kinetic = energy_balance(scene, piece)
            balance = level + balance
            lowest = np.minimum(low, np.minimum.accumulate(balance))
            rise, unit = np.maximum(rise, (balance - lowest).max()), np.maximum(unit, kinetic.max())
            level, low = balance[-1], lowest[-1]
    return float(rise / unit)


def check_energy(scene: Scene, trace: Trace) -> Failure | None:
    """A `Failure` where a run gained energy beyond `GAIN_LIMIT`, or its energy overflows, else None."""
    gain = energy_gain(scene, trace)
    if gain <= GAIN_LIMIT:
        return None
    return Failure(
        "the run gained energy", f"{gain:.3g} of its energy scale, at most {GAIN_LIMIT} can be error of the steps"
    )


def _settled(trace: Trace) -> np.ndarray:
    """Indices of the steps outside the relaxation of a compliant contact after each crossing of tilt = 0.

    There the block does not pivot about its corner, and the energy of a pivoting block does not describe it.
    """
    crossings = trace.time[1:][np.diff(np.sign(trace.tilt)) != 0]
    last = np.searchsorted(crossings, trace.time, side="right") - 1
    since = trace.time - np.concatenate(([-math.inf], crossings))[last + 1]
    steps = np.flatnonzero(since >= trace.settle)
    return steps if len(steps) >= 2 else np.arange(len(trace.time))
