"""Rows of a leapfrog engine: their largest number, failures at their end, and their conversion to a `Trace`.

A row is (time [s], length of the step that led there [s], tilt [rad], its rate [rad/s], base displacement [m] and
velocity [m/s], hysteretic force of one bearing [N], total force without viscous part [N]) and, where read, the block's
centre x, z [m] and x', z' [m/s] as in `Trace.centre`. Rates are half a step early, except at the start.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from analytic.response import Failure
from analytic.rocking import RockingModel

from .swings import Trace

if TYPE_CHECKING:
    from analytic import Scene

# Steps after which a run is given up: this many per largest step of the duration, and a reserve for the impacts.
ROWS_PER_STEP, RESERVE, MOST_ROWS = 50, 100_000, 20_000_000


def row_limit(duration: float, largest: float) -> int:
    """Largest number of steps of a run, from its duration and largest step [same unit of time]."""
    return int(min(MOST_ROWS, ROWS_PER_STEP * duration / largest + RESERVE))


def failure_of(scene: Scene, rows: Sequence[Sequence[float]] | np.ndarray, ended: str | None) -> Failure | None:
    """The `Failure` of a run that "not finite" or "too many steps" ended, or None."""
    count, t = len(rows) - 1, rows[-1][0]
    if ended == "not finite":
        return Failure("the state is no longer finite", f"at step {count}, t = {t:.9g} s")
    if ended == "too many steps":
        return Failure(ended, f"{count} by t = {t:.9g} s of {scene.duration:.9g} s")
    return None


def trace_of(
    rows: Sequence[Sequence[float]] | np.ndarray, scene: Scene, contact_tilt: float, smeared: int | None = None
) -> Trace:
    """The `Trace` of rows, with velocities interpolated to the times of the displacements.

    A velocity at t_n is the mean of its neighbours, weighted by their distance. Contact solvers spread an impact over
    the steps that reach contact and leave it; there the velocity is extrapolated from the neighbours in flight.
    smeared: number of steps on each side of tilt = 0 to which this applies; None: all steps at the contact tilt.
    """
    t, h, tilt, rate, x, v, _, force, *centre = np.array(rows).T
    law = RockingModel.of(scene).bearing
    if len(rows) >= 4:
        side = np.where(np.abs(tilt) > contact_tilt, np.sign(tilt), 0.0)
        changes = side[1:] != side[:-1]
        leaving = np.append(changes, False) & (side != 0)  # the next step is at contact or beyond
        coming = np.append(False, changes) & (side != 0)
        if smeared is not None:
            crossed = np.flatnonzero((tilt[1:] > 0) != (tilt[:-1] > 0))
            close = np.zeros(len(t), dtype=bool)
            for shift in range(1 - smeared, smeared + 1):
                close[np.clip(crossed + shift, 0, len(t) - 1)] = True
            leaving, coming = leaving & close, coming & close
        rate, v, *centre[2:] = (
            _synchronised(value, h, leaving & ~coming, coming & ~leaving) for value in (rate, v, *centre[2:])
        )
    return Trace(
        t,
        tilt,
        rate,
        x,
        v,
        force + law.count * law.damping * v,
        contact_tilt,
        centre=np.column_stack(centre) if centre else None,
    )


def _synchronised(value: np.ndarray, h: np.ndarray, from_before: np.ndarray, from_after: np.ndarray) -> np.ndarray:
    """`value`, known half a step early, interpolated to the steps' ends."""
    gain = np.diff(value) / (0.5 * (h[1:] + h[:-1]))  # per second, at t_0 .. t_(n-2)
    result = value.copy()  # the start is not half a step early
    result[1:-1] = (value[1:-1] * h[2:] + value[2:] * h[1:-1]) / (h[1:-1] + h[2:])
    result[-1] = value[-1] + 0.5 * h[-1] * gain[-1]
    i = np.flatnonzero(from_before[2:]) + 2
    result[i] = value[i] + 0.5 * h[i] * gain[i - 1]
    i = np.flatnonzero(from_after[1:-2]) + 1
    result[i] = value[i + 1] - 0.5 * h[i + 1] * gain[i + 1]
    return result


def raw_trace_of(rows: Sequence[Sequence[float]] | np.ndarray, scene: Scene, contact_tilt: float) -> Trace:
    """The `Trace` of uncorrected rows, as in a first script; the block's position is read only where it may slide."""
    t, _, tilt, rate, x, v, _, force, *centre = np.array(rows).T
    law = RockingModel.of(scene).bearing
    place = np.column_stack(centre) if centre and scene.friction is not None else None
    total = force + law.count * law.damping * v
    return Trace(t, tilt, rate, x, v, total, contact_tilt, centre=place, first_script=True)
