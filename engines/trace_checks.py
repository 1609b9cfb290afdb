"""Checks that every engine run must pass at any step size.

They concern the bearing law, the position of the block, its energy, and its momentum, which is compared with the
impulse of the bearing law on the engine's motion.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from analytic.motion import SampledMotion
from analytic.response import Failure, Sliding
from analytic.rocking import BearingLaw

from .loads import ground_velocities
from .swings import ArrayModel, cubic_through

if TYPE_CHECKING:
    from analytic import Scene
    from analytic.motion import Motion

    from .swings import Trace

# Energy gain of a run, in the units of `energy_gain`, above which it counts as failed: half of the motion's energy has
# no physical source. Errors of stable steps stay below a tenth of it (tests/engines/test_observe.py, steps up to
# 1/60 s). A contact instability reaches 1, as its gain becomes the largest kinetic energy.
GAIN_LIMIT = 0.5

# Sliding, where the scene gives no friction, and height of the lower corner [share of R] that end a run as failed.
SLIDING_TOLERANCE, HEIGHT_TOLERANCE = 0.03, 2e-3
# Slip [share of R] that is none: contacts creep, and compliant ones yield.
LEAST_SLIP = 1e-4


def replayed_force(scene: Scene, trace: Trace) -> np.ndarray:
    """Force of all bearings together [N] at the steps, by the law on the trace's displacements, eqs (9)-(14)."""
    law = BearingLaw.of(scene.bearings)
    return law.force(trace.base_displacement, law.path(trace.base_displacement), trace.base_velocity)


def replay_bearing(scene: Scene, trace: Trace) -> float:
    """Largest difference per bearing between the trace's force and the law replayed, over f0.

    The displacement is taken as monotonic within each step, as in an engine that commits the history once per accepted
    step. For a linear law, which has no f0, the difference is relative to the largest replayed force. 0 without
    bearings.
    """
    if scene.bearings is None:
        return 0.0
    law = BearingLaw.of(scene.bearings)
    force = replayed_force(scene, trace)
    scale = np.abs(force).max() / law.count if law.f0 == 0 else law.f0
    return float(np.abs(trace.bearing_force - force).max() / law.count / scale) if scale > 0 else 0.0


def energy_balance(scene: Scene, trace: Trace) -> tuple[np.ndarray, np.ndarray]:
    """Return (balance, kinetic energy) [J], shape (n,).

    The balance is mechanical energy + loss in the bearings - input work, 0 at the start.

    Taken in the ground's frame, where the ground motion is the inertial load -a_g on both masses and -a_v on the block.
    For an exact solution it is constant while the block pivots or flies, and every impact lowers it. The work is
    integrated by the trapezoidal rule over the union of the trace's steps and the motion's samples.
    """
    model = ArrayModel.of(scene)
    law, m, base = model.bearing, model.m, model.M - model.m if model.on_base else 0.0
    centre = pivoting_centre(scene, trace) if trace.centre is None else trace.centre
    x, v, z = trace.base_displacement, trace.base_velocity, centre[:, 1]
    kinetic = 0.5 * (
        base * v**2 + m * (centre[:, 2] ** 2 + centre[:, 3] ** 2) + scene.block.centre_inertia * trace.tilt_rate**2
    )
    potential = m * model.g * z + 0.5 * law.count * law.kb * x**2
    lost = trapezoid(trace.bearing_force - law.count * law.kb * x, x)
    moved = base * x + m * centre[:, 0], base * v + m * centre[:, 2]
    balance = kinetic + potential + lost - work(scene.motion, trace.time, *moved)
    if scene.motion is not None:
        balance = balance - work(scene.motion.vertical, trace.time, m * z, m * centre[:, 3])
    return balance - balance[0], kinetic


def pivoting_centre(scene: Scene, trace: Trace) -> np.ndarray:
    """`Trace.centre` of a block that pivots about its lower corner without sliding."""
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


def slips(scene: Scene, trace: Trace) -> np.ndarray | None:
    """Slip [m] of the lower corner along the base, shape (n,), where the scene gives a friction.

    None, too, if the block's position was not read from the engine.
    """
    if scene.friction is None or trace.centre is None:
        return None
    slip = (trace.centre - pivoting_centre(scene, trace))[:, 0]
    return slip - slip[0]


def slip_of(scene: Scene, trace: Trace) -> Sliding | None:
    """The `Sliding` of a run from its `slips`: all 0 where they are too small. Its work and modes are not known."""
    if (slip := slips(scene, trace)) is None:
        return None
    peak = float(np.abs(slip).max())
    if peak < LEAST_SLIP * scene.block.radius:
        return Sliding(peak=0.0, end=0.0, path=0.0, work=math.nan, modes=())
    return Sliding(peak=peak, end=float(slip[-1]), path=float(np.abs(np.diff(slip)).sum()), work=math.nan, modes=())


def check_place(scene: Scene, trace: Trace, overturned: bool) -> Failure | None:
    """A `Failure` if at the end the block has sunk into its base, left it or slid on it, else None.

    A block may slide where the scene gives a friction. During the run it may fly, if it lands where it stood. A block
    that overturns may end anywhere. Nothing is checked where the block's position was not read from the engine, and in
    a first script, whose contact is soft.
    """
    if trace.centre is None or overturned or trace.first_script:
        return None
    R = scene.block.radius
    slid, height = (trace.centre - pivoting_centre(scene, trace))[:, :2].T
    flown = f"; its lower corner was at up to {height.max():.3g} m before"
    if scene.friction is None and abs(slid[-1]) > SLIDING_TOLERANCE * R:
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


def work(motion: Motion | None, time: np.ndarray, moved: np.ndarray, rate: np.ndarray) -> np.ndarray:
    """Work [J] of the inertial load up to each step; moved: sum of mass times displacement [kg m]; rate: its rate."""
    if motion is None:
        return np.zeros_like(time)
    fine, between = time, moved
    if isinstance(motion, SampledMotion):
        samples = motion.dt * np.arange(len(motion.samples))
        fine = np.union1d(time, samples[(samples > time[0]) & (samples < time[-1])])
        between = cubic_through(time, moved, rate)(fine)
    return -trapezoid(motion.acceleration(fine), between)[np.searchsorted(fine, time)]


def trapezoid(force: np.ndarray, path: np.ndarray) -> np.ndarray:
    return np.concatenate(([0.0], np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(path))))


def energy_gain(scene: Scene, trace: Trace) -> float:
    """Largest rise of `energy_balance` over its lowest earlier value; such a rise has no physical cause.

    Relative to the larger of m g R (1 - cos gamma), the energy from rest to the unstable point, and the largest kinetic
    energy. NaN where the energy overflows. Steps within ``trace.settle`` after a crossing of tilt = 0 are left out, but
    not the work done in them: a short pulse may do all of its work there.
    """
    block = scene.block
    level = low = rise = 0.0
    unit = block.mass * scene.gravity * block.radius * (1 - math.cos(block.slenderness))
    still, begin = settled(trace), 0
    with np.errstate(over="ignore", invalid="ignore"):  # the balance of an unstable run is NaN
        for piece in trace.pieces():
            balance, kinetic = energy_balance(scene, piece)
            balance, clean = level + balance, still[begin : begin + len(balance)]
            lowest = np.minimum(low, np.minimum.accumulate(np.where(clean, balance, np.inf)))
            rise = np.maximum(rise, (balance - lowest).max(initial=0.0, where=clean))
            unit = np.maximum(unit, kinetic.max(initial=0.0, where=clean))
            level, low, begin = balance[-1], lowest[-1], begin + len(balance) - 1
    return float(rise / unit)


def check_energy(scene: Scene, trace: Trace) -> Failure | None:
    """A `Failure` if a run gains more energy than `GAIN_LIMIT`, or its energy overflows, else None."""
    gain = energy_gain(scene, trace)
    if gain <= GAIN_LIMIT:
        return None
    return Failure(
        "the run gained energy", f"{gain:.3g} of its energy scale, at most {GAIN_LIMIT} can be error of the steps"
    )


def settled(trace: Trace) -> np.ndarray:
    """Whether each step lies outside those in which a compliant contact relaxes after a crossing of tilt = 0.

    In those the contact holds energy, and the block does not pivot about its corner.
    """
    crossings = trace.time[1:][np.diff(np.sign(trace.tilt)) != 0]
    last = np.searchsorted(crossings, trace.time, side="right") - 1
    clean = trace.time - np.concatenate(([-math.inf], crossings))[last + 1] >= trace.settle
    return clean if clean.sum() >= 2 else np.ones(len(trace.time), dtype=bool)


# `impulse_error` above which a run counts as failed. A doubled or missing force gives 1. Exact motions sampled at
# random steps of 1/60 s on average give up to .03, tuned variants at most 2e-3.
IMPULSE_LIMIT = 0.1
# Share of the momentum below which the impulse of the bearings is not checked.
LEAST_IMPULSE = 0.1
# Share of a rocking block's momentum below which the motion is round-off.
LEAST_MOMENTUM = 1e-3


def bearing_impulse(scene: Scene, trace: Trace) -> np.ndarray:
    """Impulse of the bearings from the start to each step [N s], by their law on the trace's displacements; shape (n,).

    The viscous part is exact: damping times displacement. The others are integrated by Simpson's rule, with cubic
    interpolation of the displacement between steps.
    """
    law = BearingLaw.of(scene.bearings)
    h, x, v = np.diff(trace.time), trace.base_displacement, trace.base_velocity
    middle = 0.5 * (x[1:] + x[:-1]) + 0.125 * h * (v[:-1] - v[1:])
    path = np.empty(2 * len(x) - 1)
    path[::2], path[1::2] = x, middle
    force = law.kb * path + law.path(path)
    parts = h / 6 * (force[:-1:2] + 4 * force[1::2] + force[2::2]) + law.damping * np.diff(x)
    return law.count * np.concatenate(([0.0], np.cumsum(parts)))


def momentum(scene: Scene, trace: Trace) -> np.ndarray:
    """Horizontal momentum of block and base relative to the ground [N s], shape (n,); an impact keeps it."""
    centre = pivoting_centre(scene, trace) if trace.centre is None else trace.centre
    base = scene.total_mass - scene.block.mass
    return base * trace.base_velocity + scene.block.mass * centre[:, 2]


def missing_impulse(scene: Scene, trace: Trace) -> tuple[np.ndarray, np.ndarray]:
    """Return (unexplained impulse up to each step, the law's impulse) [N s], shapes (n,).

    The first is momentum + impulse of the bearings + total mass times ground velocity, less its value at the start. It
    is constant for an exact solution, whatever the impacts.
    """
    law = bearing_impulse(scene, trace)
    ground = ground_velocities(scene.motion, trace.time) if scene.motion else 0.0
    unexplained = momentum(scene, trace) + law + scene.total_mass * ground
    return unexplained - unexplained[0], law


def impulse_error(scene: Scene, trace: Trace) -> float:
    """Largest range of `missing_impulse` within a window, over that of the law's impulse; 0 without bearings.

    A window lasts a rocking period 2 pi/omega_r, and windows overlap by half. A doubled or missing force gives 1; a
    force delayed by dt gives about dt times the base's frequency.
    """
    if scene.bearings is None:
        return 0.0
    if trace.centre is None:  # a falling block need not pivot about its corner
        over = np.flatnonzero(np.abs(trace.tilt) >= scene.block.slenderness)
        trace = trace.upto(max(2, over[0])) if len(over) else trace
    missing, law = missing_impulse(scene, trace)
    period = 2 * math.pi / scene.rocking_frequency
    begins = np.arange(trace.time[0], trace.time[-1], 0.5 * period)
    first = np.searchsorted(trace.time, begins)
    last = np.searchsorted(trace.time, begins + period)
    windows = [slice(a, b + 1) for a, b in zip(first, last, strict=True)]
    block = scene.block
    rocking = block.mass * block.radius * scene.rocking_frequency * block.slenderness  # momentum at such a tilt rate
    scale = max(
        max(np.ptp(law[window]) for window in windows),
        LEAST_IMPULSE * np.ptp(momentum(scene, trace)),
        LEAST_MOMENTUM * rocking,
    )
    return float(max(np.ptp(missing[window]) for window in windows) / scale)


def check_impulse(scene: Scene, trace: Trace) -> Failure | None:
    """A `Failure` if the engine's motion does not match the bearing force, else None."""
    error = impulse_error(scene, trace)
    if error <= IMPULSE_LIMIT:
        return None
    return Failure(
        "the motion does not match the bearing force",  # a NaN, too
        f"momentum and impulse of the law differ by {error:.3g} of the impulse; at most {IMPULSE_LIMIT} can "
        "be error of the steps",
    )
