"""What an engine's step history says, as a `Response`: one piece of code for all engines.

An engine hands over its accepted steps as a `Trace`; the events, peaks and contact forces are found here, outside
the engine, so that no engine is judged by its own measure. The time this takes is not part of ``cpu_seconds``.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import astuple, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from analytic.decision import is_decided, model_warnings
from analytic.motion import SampledMotion, vertical_acceleration
from analytic.response import Failure, History, Response, State

from .checks import check_energy, check_place, energy_gain, replay_bearing
from .events import check_impacts, contact_measures, find_events
from .momentum import check_impulse
from .swings import ArrayModel, Trace, find_swings

if TYPE_CHECKING:
    from analytic import Scene

__all__ = ["Trace", "energy_gain", "failed_response", "observe", "replay_bearing"]

HISTORY_POINTS = 2000


@np.errstate(all="ignore")  # what overflows shows in the numbers, and these are looked at
def observe(
    scene: Scene,
    trace: Trace,
    *,
    engine: str,
    variant: str,
    cpu_seconds: float,
    steps: int,
    settings: dict[str, Any],
    versions: dict[str, Any],
    history: bool = True,
    failure: Failure | None = None,
    ended: str | None = None,
    warnings: Iterable[str] = (),
) -> Response:
    """The response of an engine's run.

    Parameters
    ----------
    scene : Scene
    trace : Trace
        Accepted steps from the start on; a step past overturning is used to find its time, what follows is not.
    engine, variant, cpu_seconds, steps, settings, versions
        Kept as they are in the response.
    history : bool
        Keep the history, on the motion's own grid for a sampled motion, else on 2000 equal intervals.
    failure : Failure or None
        The engine's own failure: the outcome is "failed", and the last finite state is filled in.
    ended : str or None
        "overturned" where the adapter stopped the run at overturning: if the last step lies before
        |tilt| = pi/2, the block is taken to fall on at the model's acceleration.
    warnings : iterable of str
        Sentences of the engine, as of `engines.verified.outside`; those of the motion's record, and where the run is
        outside the model (`analytic.decision.model_warnings`), are added.

    Returns
    -------
    Response
        stands: |tilt| never exceeded ``trace.contact_tilt``. A trace with non-finite states, or one that ends
        before ``scene.duration`` for no stated reason, is "failed".

    An impact is reported where the swings before and after it are both resolved, that is exceed contact_tilt;
    its rates and base velocities are carried to tilt = 0 by the model's equations of flight. Where no such
    swing follows, the block came to rest: at the limit of the model's impacts after the last landing.
    Friction demand and normal force follow from the states and the model's accelerations.

    A failure too, with its numbers: a block off its place (`check_place`), a gain of energy (`check_energy`), an impact
    that gives energy, that cannot be resolved or that the steps leap over (`check_impacts`), a motion that is not the
    bearings' (`check_impulse`; of a first script a warning), and a measure that is not finite.
    """
    trace, failure = _finite_part(trace, failure)  # type: ignore[assignment]  # None, where nothing is finite, goes no further
    overturning_time = None
    if trace is not None:
        trace, overturning_time = _upto_overturning(scene, trace, ended)
    given: dict[str, Any] = dict(
        engine=engine,
        variant=variant,
        cpu_seconds=cpu_seconds,
        steps=steps,
        settings=settings,
        versions=versions,
        scene=scene.name,
    )
    if trace is None:
        return failed_response(
            scene,
            failure,
            engine=engine,
            variant=variant,
            settings=settings,
            versions=versions,
            cpu_seconds=cpu_seconds,
            steps=steps,
            warnings=warnings,
        )
    end = State(*(float(getattr(trace, name)[-1]) for name in Trace.COLUMNS))
    short = scene.duration * (1 - 1e-9) - end.time  # type: ignore[operator]  # a run has a duration; the last of equal steps need not end at the duration
    if failure is None and overturning_time is None and short > np.diff(trace.time).max():
        failure = Failure("the run ended early", f"last step at {end.time:.9g} s of {scene.duration:.9g} s", end)
    swings = find_swings(trace)
    impacts, uplifts, rests, missed = find_events(scene, trace, swings)
    demand, normal, acceleration = contact_measures(scene, trace, falls=overturning_time is not None)
    peak = _peak(trace.time, trace.tilt, trace.tilt_rate)
    displacement = _peak(trace.time, trace.base_displacement, trace.base_velocity)
    measured = {
        "a peak": [peak, displacement, acceleration],
        "the normal force": [normal],
        "an uplift": uplifts,
        "a rest": rests,
        "an impact": np.array([astuple(impact) for impact in impacts]).ravel(),
    }
    failure = (
        failure
        or check_place(scene, trace, overturning_time is not None)
        or check_energy(scene, trace)
        or check_impacts(scene, trace, impacts, missed)
        or _check_finite(measured)
    )
    pushed = check_impulse(scene, trace) if failure is None else None
    if pushed and trace.first_script:
        warnings = (*warnings, f"{pushed.reason}: {pushed.message}")
    else:
        failure = failure or pushed
    if failure is not None and failure.last_state is None:
        failure = replace(failure, last_state=end)
    if failure is not None:
        outcome = "failed"
    elif overturning_time is not None:
        outcome = "overturns"
    else:
        outcome = "rocks" if len(swings) else "stands"
    if failure is None:  # the forces of a failed run say nothing about the scene
        warnings = (*warnings, *model_warnings(scene, demand, normal))
    response = Response(
        outcome=outcome,
        overturning_time=overturning_time,
        unstable_time=_unstable_time(scene, trace),
        peak_tilt=peak,
        peak_tilt_ratio=peak / scene.block.slenderness,
        peak_base_displacement=displacement,
        peak_base_acceleration=acceleration,
        impacts=impacts,
        uplifts=uplifts,
        rests=rests,
        friction_demand=demand,
        min_normal_ratio=normal,
        end=end,
        failure=failure,
        warnings=_warnings(scene, warnings),
        history=_history(scene, trace) if history else None,
        **given,
    )
    return replace(response, decided=is_decided(scene, response, contact_tilt=trace.contact_tilt))


def failed_response(
    scene: Scene,
    failure: Failure,
    *,
    engine: str,
    variant: str,
    settings: dict[str, Any],
    versions: dict[str, Any],
    cpu_seconds: float = math.nan,
    steps: int = 0,
    warnings: Iterable[str] = (),
) -> Response:
    """A response of outcome "failed" for a run that left no states: every number is NaN, the evidence is kept."""
    nan = math.nan
    return Response(
        engine=engine,
        variant=variant,
        outcome="failed",
        overturning_time=None,
        unstable_time=None,
        peak_tilt=nan,
        peak_tilt_ratio=nan,
        peak_base_displacement=nan,
        peak_base_acceleration=nan,
        impacts=(),
        uplifts=(),
        rests=(),
        decided=False,
        friction_demand=nan,
        min_normal_ratio=nan,
        end=State(nan, nan, nan, nan, nan, nan),
        cpu_seconds=cpu_seconds,
        steps=steps,
        settings=settings,
        versions=versions,
        scene=scene.name,
        failure=failure,
        warnings=_warnings(scene, warnings),
    )


def _warnings(scene: Scene, warnings: Iterable[str]) -> tuple[str, ...]:
    """The engine's sentences and those about the record of the motion, each once."""
    record = getattr(scene.motion, "warnings", ())  # pulses have none
    return tuple(dict.fromkeys((*record, *warnings)))


def _check_finite(measured: Mapping[str, Any]) -> Failure | None:
    """A `Failure` where a measure, {name: numbers}, is not finite, else None."""
    wrong = [name for name, numbers in measured.items() if not np.isfinite(numbers).all()]
    return Failure("measuring the run gave no number", f"not finite: {', '.join(wrong)}") if wrong else None


def _finite_part(trace: Trace, failure: Failure | None) -> tuple[Trace | None, Failure | None]:
    """(the steps before the first non-finite one or None, the failure with its last finite state)."""
    finite: np.ndarray = np.isfinite([getattr(trace, name) for name in Trace.COLUMNS]).all(axis=0)  # type: ignore[assignment]  # of all columns at once
    if trace.centre is not None:
        finite &= np.isfinite(trace.centre).all(axis=1)
    count = len(finite) if finite.all() else int(np.argmin(finite))
    last = State(*(float(getattr(trace, name)[count - 1]) for name in Trace.COLUMNS)) if count else None
    if count < len(finite):
        first = Failure("the state is no longer finite", f"at step {count}, t = {trace.time[count]:.9g} s")
        failure = failure or first
    if failure is not None and failure.last_state is None:
        failure = Failure(failure.reason, failure.message, last)
    return (trace.upto(count) if count >= 2 else None), failure


def _upto_overturning(scene: Scene, trace: Trace, ended: str | None) -> tuple[Trace, float | None]:
    """The trace up to |tilt| = pi/2 with that state as its last step, and its time; or the whole trace and None."""
    limit = math.pi / 2
    over = np.flatnonzero(np.abs(trace.tilt) >= limit)
    if len(over) and over[0] > 0:
        last = int(over[0])
        pair = slice(last - 1, last + 1)
        t = _crossing(trace.time[pair], trace.tilt[pair], trace.tilt_rate[pair], limit * np.sign(trace.tilt[last]))
        weight = (t - trace.time[last - 1]) / (trace.time[last] - trace.time[last - 1])

        def closed(values, end=None):
            """The steps before it, and the state at it."""
            if end is None:
                end = (1 - weight) * values[last - 1] + weight * values[last]
            return np.append(values[: last if weight > 0 else last - 1], [end], axis=0)

        columns = {name: closed(getattr(trace, name)) for name in Trace.COLUMNS[2:]}
        columns.update(time=closed(trace.time, t), tilt=closed(trace.tilt, math.copysign(limit, trace.tilt[last])))
        return replace(trace, centre=None if trace.centre is None else closed(trace.centre), **columns), t
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


def _crossing(time: np.ndarray, value: np.ndarray, rate: np.ndarray, level: float) -> float:
    """Time at which the cubic through both ends of a step first takes `level`."""
    roots = CubicHermiteSpline(time, value, rate).solve(level, extrapolate=False)
    roots = roots[np.isfinite(roots)]
    if len(roots):
        return float(roots.min())
    return float(np.interp(level, value, time)) if value[0] < value[1] else float(np.interp(-level, -value, time))


def _unstable_time(scene: Scene, trace: Trace) -> float | None:
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


def _peak(time: np.ndarray, value: np.ndarray, rate: np.ndarray) -> float:
    """Largest |value|, between the steps by the cubic through both ends of a step."""
    i = int(np.abs(value).argmax())
    side, best = math.copysign(1.0, value[i]), abs(value[i])
    for k in (i - 1, i):
        if 0 <= k < len(time) - 1 and side * rate[k] > 0 > side * rate[k + 1]:
            cubic = CubicHermiteSpline(time[k : k + 2], value[k : k + 2], rate[k : k + 2])
            roots = cubic.derivative().roots(extrapolate=False)
            best = max(best, *np.abs(cubic(roots)), 0.0)
    return float(best)


def _history(scene: Scene, trace: Trace) -> History:
    """The steps on an equal grid: tilt and displacement by cubics through the steps, the others linear."""
    end = trace.time[-1]
    dt = scene.motion.dt if isinstance(scene.motion, SampledMotion) else scene.duration / HISTORY_POINTS  # type: ignore[operator]  # as above
    time = trace.time[0] + dt * np.arange(math.floor((end - trace.time[0]) / dt * (1 + 1e-12)) + 1)
    if time[-1] < end - 1e-9 * dt:
        time = np.append(time, end)
    linear = {name: np.interp(time, trace.time, getattr(trace, name)) for name in Trace.COLUMNS[1:]}
    for value, rate in (("tilt", "tilt_rate"), ("base_displacement", "base_velocity")):
        cubic = CubicHermiteSpline(trace.time, getattr(trace, value), getattr(trace, rate))
        linear[value] = cubic(time)
    ground = scene.motion.acceleration(time) if scene.motion else np.zeros(len(time))
    return History(time=time, ground_acceleration=ground, **linear)
