"""Momentum of an engine's motion compared with the impulse of the bearing law on that motion."""

from __future__ import annotations

import math
from array import array
from typing import TYPE_CHECKING

import numpy as np

from analytic.bearing import BearingLaw
from analytic.response import Failure

from .checks import pivoting_centre
from .ground_velocity import ground_velocity

if TYPE_CHECKING:
    from analytic import Scene

    from .swings import Trace

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
    """(unexplained impulse up to each step [N s], the law's impulse [N s]), shapes (n,).

    The first is momentum + impulse of the bearings + total mass times ground velocity, less its value at the start. It
    is constant for an exact solution, whatever the impacts.
    """
    law = bearing_impulse(scene, trace)
    velocity = ground_velocity(scene.motion)
    ground = np.fromiter(map(velocity, array("d", trace.time.tobytes())), float, len(trace.time)) if velocity else 0.0
    left = momentum(scene, trace) + law + scene.total_mass * ground
    return left - left[0], law


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
