"""The end of a trace: a state that is not finite, overturning, or an end before the scene's duration."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from analytic.motion import vertical_acceleration
from analytic.response import Failure, State

from .swings import ArrayModel, Trace

if TYPE_CHECKING:
    from analytic import Scene


def finite_part(trace: Trace, failure: Failure | None) -> tuple[Trace | None, Failure | None]:
    """(steps before the first non-finite one, or None; failure with the last finite state)."""
    finite = np.isfinite(trace.time)
    for name in Trace.COLUMNS[1:]:
        finite &= np.isfinite(getattr(trace, name))
    if trace.centre is not None:
        finite &= np.isfinite(trace.centre).all(axis=1)
    whole = bool(finite.all())
    count = len(finite) if whole else int(np.argmin(finite))
    if not whole:
        failure = failure or Failure("the state is no longer finite", f"at step {count}, t = {trace.time[count]:.9g} s")
    if failure is not None and failure.last_state is None and count:
        failure = replace(failure, last_state=last_state(trace, count - 1))
    if count < 2:
        return None, failure
    return trace if whole else trace.upto(count), failure


def upto_overturning(scene: Scene, trace: Trace, ended: str | None) -> tuple[Trace, float | None]:
    """(trace up to |tilt| = pi/2, with that state as its last step; its time), or (the whole trace, None)."""
    limit = math.pi / 2
    over = np.flatnonzero(np.abs(trace.tilt) >= limit)
    if len(over) and over[0] > 0:
        cut = _upto_crossing(trace, int(over[0]), limit)
        return cut, float(cut.time[-1])
    side = np.sign(trace.tilt[-1])
    if ended == "overturned" and side * trace.tilt_rate[-1] > 0:
        model = ArrayModel.of(scene)
        ground = scene.motion.acceleration(trace.time[-1]) if scene.motion else 0.0
        up = vertical_acceleration(scene.motion, trace.time[-1])
        force = trace.bearing_force[-1]
        pull = side * model.accelerations(side, trace.tilt[-1], trace.tilt_rate[-1], ground, force, up)[0]
        q, p = side * trace.tilt_rate[-1], abs(trace.tilt[-1]) - limit
        return trace, float(trace.time[-1] - 2 * p / (q + math.sqrt(max(q * q - 2 * pull * p, 0.0))))
    return trace, None


def upright_part(scene: Scene, trace: Trace, falls: bool) -> Trace:
    """The trace up to the last passage of the slenderness if the block `falls`; all of it otherwise or without one."""
    if not falls:
        return trace
    slenderness = scene.block.slenderness
    below = np.flatnonzero(np.abs(trace.tilt) <= slenderness)
    last = int(below[-1]) + 1 if len(below) else 1
    if last == len(trace.time) or not len(below):
        return trace.upto(max(last, 2))
    return _upto_crossing(trace, last, slenderness)


def _upto_crossing(trace: Trace, last: int, level: float) -> Trace:
    """The steps before step `last`, in whose interval |tilt| passes `level`, then the state at the passage."""
    pair = slice(last - 1, last + 1)
    tilt = math.copysign(level, trace.tilt[last])
    t = _crossing(trace.time[pair], trace.tilt[pair], trace.tilt_rate[pair], tilt)
    weight = (t - trace.time[last - 1]) / (trace.time[last] - trace.time[last - 1])

    def closed(values, end=None):
        """The values before the passage, then the value at it."""
        if end is None:
            end = (1 - weight) * values[last - 1] + weight * values[last]
        return np.append(values[: last if weight > 0 else last - 1], [end], axis=0)

    columns = {name: closed(getattr(trace, name)) for name in Trace.COLUMNS[2:]}
    columns.update(time=closed(trace.time, t), tilt=closed(trace.tilt, tilt))
    return replace(trace, centre=None if trace.centre is None else closed(trace.centre), **columns)


def _crossing(time: np.ndarray, value: np.ndarray, rate: np.ndarray, level: float) -> float:
    """Time at which the cubic through both ends of a step first takes `level`."""
    roots = CubicHermiteSpline(time, value, rate).solve(level, extrapolate=False)
    roots = roots[np.isfinite(roots)]
    if len(roots):
        return float(roots.min())
    return float(np.interp(level, value, time)) if value[0] < value[1] else float(np.interp(-level, -value, time))


def unstable_time(scene: Scene, trace: Trace) -> float | None:
    """First time of |tilt| = slenderness [s], or None."""
    over = np.flatnonzero(np.abs(trace.tilt) >= scene.block.slenderness)
    if not len(over):
        return None
    i = int(over[0])
    if i == 0:
        return float(trace.time[0])
    pair = slice(i - 1, i + 1)
    return _crossing(
        trace.time[pair], trace.tilt[pair], trace.tilt_rate[pair], math.copysign(scene.block.slenderness, trace.tilt[i])
    )


def last_state(trace: Trace, step: int = -1) -> State:
    """The `State` of a trace at a step, by default its last."""
    return State(*(float(getattr(trace, name)[step]) for name in Trace.COLUMNS))


def ended_early(scene: Scene, trace: Trace) -> Failure | None:
    """A `Failure` if a trace ends more than one of its steps before the scene's duration, else None."""
    end = last_state(trace)
    short = scene.end * (1 - 1e-9) - end.time  # equal steps need not end at the duration
    if short > np.diff(trace.time).max():
        return Failure("the run ended early", f"last step at {end.time:.9g} s of {scene.duration:.9g} s", end)
    return None
