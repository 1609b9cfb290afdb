"""The `Response` of an engine's run, derived from its accepted steps by the same code for all engines.

An engine returns its accepted steps as a `Trace`. Events, peaks and contact forces are determined here, outside the
engine, so that all engines are measured alike. The time this takes is not part of ``cpu_seconds``.

An impact is reported where the swings before and after it are both resolved, that is, exceed contact_tilt. Its tilt
rates and base velocities are extrapolated to tilt = 0 by the model's equations of flight. In a scene with a friction
the block may pass tilt = 0 in the air, which is no impact. If no resolved swing follows a landing, the block came to
rest, at the limit time of the model's impacts after it. Friction demand and normal force follow from the states and the
model's accelerations.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import astuple, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from analytic.kernel.decision import model_warnings
from analytic.motion import SampledMotion
from analytic.response import Caution, Failure, History, Response, about_record, limit_warnings
from analytic.solver import is_decided

from .events import (
    STILL,
    check_impacts,
    contact_measures,
    ended_early,
    find_events,
    finite_part,
    last_state,
    unstable_time,
    upright_part,
    upto_edge,
    upto_overturning,
)
from .swings import Trace, cubic_through, find_swings
from .trace_checks import check_energy, check_impulse, check_place, slip_of, slips

if TYPE_CHECKING:
    from analytic import Scene

HISTORY_POINTS = 2000


@np.errstate(all="ignore")  # an overflow gives numbers that are not finite, which are checked
def observe(
    scene: Scene,
    trace: Trace,
    *,
    beyond: Trace | None = None,
    history: bool = True,
    failure: Failure | None = None,
    ended: str | None = None,
    warnings: Iterable[Caution | str] = (),
    **run: Any,
) -> Response:
    """The response of an engine's run.

    Its outcome is "stands" where |tilt| never exceeded ``trace.contact_tilt`` or `STILL` of the slenderness, and
    "failed" where states are not finite or `_judged` finds a failure.

    Parameters
    ----------
    scene : Scene
    trace : Trace
        Accepted steps from the start on. The first step past overturning is used to find its time; later ones are not.
    beyond : Trace or None
        A longer trace of the same run, from which events up to the end of `trace` are read, so that none is cut short.
    history : bool
        Keep the history: on the motion's own grid for a sampled motion, else on 2000 equal intervals.
    failure : Failure or None
        The engine's own failure: the outcome is "failed", and the last finite state is filled in.
    ended : str or None
        "overturned" if the adapter stopped the run. If the last step lies before |tilt| = pi/2, the rest of the fall is
        taken at the model's acceleration.
    warnings : iterable of Caution or str
        Warnings of the engine. Those of the motion's record and of a run outside the model are added.
    **run
        engine, variant, cpu_seconds, steps, settings, versions: copied to the response.
    """
    finite, failure = finite_part(trace, failure)
    if finite is None:
        return failed_response(scene, failure, warnings=warnings, **run)
    trace, overturning_time = upto_overturning(scene, finite, ended)
    trace, off = upto_edge(scene, trace)
    overturning_time = None if off else overturning_time
    end = last_state(trace)
    measured, missed, lifted = _measured(scene, trace, beyond or trace, overturning_time)
    sliding = slip_of(scene, trace)
    falls = "falls off" if off else None if overturning_time is None else "overturns"
    slip = sliding.peak if sliding and not falls else 0.0
    failure, warnings = _judged(scene, trace, {**measured, "peak_slip": slip}, missed, failure, warnings, bool(falls))
    lifted = lifted and measured["peak_tilt"] >= STILL * scene.block.slenderness
    upright = "rocks" if lifted else "slides" if sliding and sliding.peak else "stands"
    if sliding and sliding.peak and scene.friction:  # what no-slip formulas ask for is no demand
        measured["friction_demand"] = min(measured["friction_demand"], scene.friction)
    response = Response(
        outcome="failed" if failure else falls or upright,
        end=end,
        failure=failure and replace(failure, last_state=failure.last_state or end),
        warnings=cautions(scene, warnings),
        history=run_history(scene, trace) if history else None,
        scene=scene.name,
        sliding=sliding,
        **measured,
        **run,
    )
    return replace(response, decided=is_decided(scene, response, contact_tilt=trace.contact_tilt))


def _measured(
    scene: Scene, trace: Trace, beyond: Trace, overturning_time: float | None
) -> tuple[dict[str, Any], Any, bool]:
    """Measure a run: ({field of `Response`: number or events}, times of missed impacts, whether the block lifted)."""
    end = trace.time[-1]
    swings = find_swings(beyond)
    impacts, *times = find_events(scene, beyond, swings)
    uplifts, rests, missed = (tuple(time for time in each if time <= end) for each in times)
    upright = upright_part(scene, trace, falls=overturning_time is not None)  # any falling block slides and jumps
    demand, normal, acceleration = contact_measures(scene, upright)
    peak = _peak(trace.time, trace.tilt, trace.tilt_rate)
    measured = dict(
        overturning_time=overturning_time,
        unstable_time=unstable_time(scene, trace),
        fall_time=None if overturning_time is None else float(upright.time[-1]),
        peak_tilt=peak,
        peak_tilt_ratio=peak / scene.block.slenderness,
        peak_base_displacement=_peak(upright.time, upright.base_displacement, upright.base_velocity),
        peak_base_acceleration=acceleration,
        impacts=tuple(impact for impact in impacts if impact.time <= end),
        uplifts=uplifts,
        rests=rests,
        friction_demand=demand,
        min_normal_ratio=normal,
    )
    return measured, missed, bool((beyond.time[swings.first] <= end).any())


def _judged(
    scene: Scene,
    trace: Trace,
    measured: Mapping[str, Any],
    missed: Any,
    failure: Failure | None,
    warnings: Iterable[Caution | str],
    falls: bool,
) -> tuple[Failure | None, Iterable[Caution | str]]:
    """Judge a run: (the engine's own failure, or the first check that is not met, or None; warnings).

    falls: it ended in a fall, over or off the pedestal.

    The checks are: the scene's duration is reached; the block is where it should be (`check_place`); no energy is
    gained (`check_energy`); impacts gain no energy, are resolved and are not skipped by the steps (`check_impacts`);
    all measures are finite; the motion matches the bearing force (`check_impulse`; for a first script a warning).
    """
    failure = (
        failure
        or (None if falls else ended_early(scene, trace))
        or check_place(scene, trace, falls)
        or check_energy(scene, trace)
        or check_impacts(scene, trace, measured["impacts"], missed)
        or _check_finite(measured)
    )
    if failure is not None:
        return failure, warnings  # without warnings on forces, which are meaningless in a failed run
    failure = check_impulse(scene, trace)
    if failure and not trace.first_script:
        return failure, warnings
    if failure:
        warnings = (*warnings, Caution("engine", f"{failure.reason}: {failure.message}"))
    beyond = limit_warnings(scene, measured["peak_base_displacement"], measured["peak_slip"])
    outside = model_warnings(
        scene, measured["friction_demand"], measured["min_normal_ratio"], slides=trace.centre is not None
    )
    return None, (*warnings, *outside, *beyond)


def failed_response(
    scene: Scene, failure: Failure | None, *, warnings: Iterable[Caution | str] = (), **run: Any
) -> Response:
    """A response of outcome "failed" for a run without states: all numbers are NaN, and the failure is kept.

    run: as in `observe`; cpu_seconds and steps may be left out.
    """
    known = cautions(scene, warnings)
    return Response.unmeasured(
        outcome="failed", decided=False, scene=scene.name, failure=failure, warnings=known, **run
    )


def cautions(scene: Scene, warnings: Iterable[Caution | str]) -> tuple[Caution, ...]:
    """The engine's warnings, sentences as `Caution`, and those about the motion's record, without repetition."""
    each = (Caution("engine", warning) if isinstance(warning, str) else warning for warning in warnings)
    return tuple(dict.fromkeys((*about_record(scene.motion), *each)))


def _check_finite(measured: Mapping[str, Any]) -> Failure | None:
    """A `Failure` where a number of `_measured` is not finite, else None."""
    peaks = [measured[name] for name in ("peak_tilt", "peak_base_displacement", "peak_base_acceleration")]
    numbers = {
        "a peak": peaks,
        "the normal force": [measured["min_normal_ratio"]],
        "an uplift": measured["uplifts"],
        "a rest": measured["rests"],
        "an impact": np.array([astuple(impact) for impact in measured["impacts"]]).ravel(),
    }
    wrong = [name for name, values in numbers.items() if not np.isfinite(values).all()]
    return Failure("measuring the run gave no number", f"not finite: {', '.join(wrong)}") if wrong else None


def _peak(time: np.ndarray, value: np.ndarray, rate: np.ndarray) -> float:
    """Largest |value|, with cubic (Hermite) interpolation between the steps."""
    i = int(np.abs(value).argmax())
    side, best = math.copysign(1.0, value[i]), abs(value[i])
    for k in (i - 1, i):
        if 0 <= k < len(time) - 1 and side * rate[k] > 0 > side * rate[k + 1]:
            cubic = cubic_through(time[k : k + 2], value[k : k + 2], rate[k : k + 2])
            roots = cubic.derivative().roots(extrapolate=False)
            best = max(best, *np.abs(cubic(roots)), 0.0)
    return float(best)


def run_history(scene: Scene, trace: Trace) -> History:
    """The trace on an equidistant grid: tilt and displacement by cubic, the others by linear interpolation."""
    end = trace.time[-1]
    dt = scene.motion.dt if isinstance(scene.motion, SampledMotion) else scene.end / HISTORY_POINTS
    time = trace.time[0] + dt * np.arange(math.floor((end - trace.time[0]) / dt * (1 + 1e-12)) + 1)
    if time[-1] < end - 1e-9 * dt:
        time = np.append(time, end)
    linear = {name: np.interp(time, trace.time, getattr(trace, name)) for name in Trace.COLUMNS[1:]}
    for value, rate in (("tilt", "tilt_rate"), ("base_displacement", "base_velocity")):
        linear[value] = _cubic(trace, value, rate, time)
    ground = scene.motion.acceleration(time) if scene.motion else np.zeros(len(time))
    slip = slips(scene, trace)
    slip = None if slip is None else np.interp(time, trace.time, slip)
    return History(time=time, ground_acceleration=ground, slip=slip, **linear)


def _cubic(trace: Trace, value: str, rate: str, time: np.ndarray) -> np.ndarray:
    """A column of the trace at other times, by cubic interpolation; the times increase and lie within the trace."""
    values = np.empty_like(time)
    for piece in trace.pieces():
        begin = np.searchsorted(time, piece.time[0])
        end = np.searchsorted(time, piece.time[-1], side="right") if piece.time[-1] < trace.time[-1] else None
        cubic = cubic_through(piece.time, getattr(piece, value), getattr(piece, rate))
        values[begin:end] = cubic(time[begin:end])
    return values
