"""The `Response` of a statue on a free pedestal in an engine: what is read from its steps, and its checks.

An adapter that builds a stack has a function ``run_stack(scene, variant, settings, pedestal_tilt=0.0)``: a `Run` with a
`StackTrace`, of `engines.loop.run_of`, whose `Pair` gives the corners to the step rule. In traces and responses, the
tilt of the block is from the pedestal.

The forces on contacts are not read, so that friction demands, normal forces, impulses and the acceleration of the base
are NaN.
"""

from __future__ import annotations

import math
from dataclasses import asdict, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from analytic.response import Failure, Impact, Response, Stack, limit_warnings
from analytic.solver import parameters
from analytic.stack.equations import UPPER, StackModel
from analytic.stack.run import FALLS, NAMES
from analytic.stack.run import Run as StackRun

from .contract import Run
from .events import STILL, ended_early, finite_part, last_state
from .loads import centres, moving_mass, slabs_of
from .loop import SMEARED
from .observe import cautions, failed_response, run_history
from .swings import StackTrace, Trace, find_swings
from .trace_checks import GAIN_LIMIT, HEIGHT_TOLERANCE, SLIDING_TOLERANCE, trapezoid, work

if TYPE_CHECKING:
    from analytic import Scene

    from .contract import Engine

FALLEN = 0.5 * math.pi


def observe_stack(scene: Scene, run: Run, *, history: bool = True, **labels: Any) -> Response:
    """The `Response` of a run of a stack; labels: as in `engines.observe.observe`.

    Raises
    ------
    TypeError
        The run's trace is no `StackTrace`.
    """
    if run.trace is None:
        return failed_response(scene, run.failure, **labels)
    if not isinstance(run.trace, StackTrace):
        raise TypeError(f"run_stack returned a {type(run.trace).__name__}, no engines.swings.StackTrace")
    trace, failure = finite_part(run.trace, run.failure)
    if not isinstance(trace, StackTrace):
        return failed_response(scene, failure, **labels)
    both, gammas = (trace.pedestal, trace), [slab.slenderness for slab in slabs_of(scene)]
    sizes = np.abs([part.tilt for part in both])
    k = int(sizes[:, -1].argmax())
    falls = bool(sizes[k, -1] >= FALLEN)
    fall = _passages(trace.time, sizes[k], gammas[k])[-1] if falls else math.inf
    failure = failure or _checked(scene, trace, falls)
    (landings, lifts, still), (impacts, uplifts, rests) = (_events(part) for part in both)
    first, second = np.minimum(sizes.max(axis=1), FALLEN).tolist()  # the last step of a fall is beyond
    rocked = tuple(
        name
        for name, peak, gamma, part in zip(NAMES, (first, second), gammas, both, strict=True)
        if peak >= STILL * gamma and peak > part.contact_tilt
    )
    x, end = float(np.abs(trace.base_displacement[trace.time <= fall]).max()), last_state(trace)
    outcome = FALLS[k] if falls else "rocks" if rocked else "stands"
    return Response.unmeasured(
        outcome="failed" if failure else outcome,
        overturning_time=_passages(trace.time, sizes[k], FALLEN)[-1] if falls else None,
        unstable_time=next(iter(_passages(trace.time, sizes[UPPER], gammas[UPPER])), None),
        fall_time=fall if falls else None,
        peak_tilt=second,
        peak_tilt_ratio=second / gammas[UPPER],
        peak_base_displacement=x,
        impacts=impacts,
        uplifts=uplifts,
        rests=rests,
        end=end,
        scene=scene.name,
        decided=not failure and (falls or _decided(scene, trace)),
        failure=failure and replace(failure, last_state=failure.last_state or end),
        stack=Stack(
            rocked=rocked,
            peak_tilt=first,
            statue_tilt=float(np.abs(trace.tilt + trace.pedestal.tilt).max()),
            impacts=landings,
            uplifts=lifts,
            rests=still,
            friction_demand=math.nan,
            min_normal_ratio=math.nan,
            impulses=(math.nan, math.nan),
            closest=None,
        ),
        history=replace(run_history(scene, trace), pedestal_tilt=run_history(scene, trace.pedestal).tilt)
        if history
        else None,
        **{**labels, "warnings": cautions(scene, (*labels["warnings"], *limit_warnings(scene, x)))},
    )


def _passages(time: np.ndarray, size: np.ndarray, limit: float) -> list[float]:
    """Times [s] at which a tilt of these sizes rises through a limit; the start, too, where it is above."""
    above = np.append(False, size >= limit)
    ends = np.flatnonzero(above[1:] & ~above[:-1])
    before = np.maximum(ends - 1, 0)
    share = np.divide(size[ends] - limit, size[ends] - size[before], out=np.zeros(len(ends)), where=ends > before)
    return (time[ends] - share * (time[ends] - time[before])).tolist()


def _events(trace: Trace) -> tuple[tuple[Impact, ...], tuple[float, ...], tuple[float, ...]]:
    """Impacts, uplifts and rests of a block on what carries it; the rate after an impact into contact is 0."""
    swings, time, v = find_swings(trace), trace.time, trace.base_velocity
    impacts: list[Impact] = []
    uplifts, rests, left = [], [], -math.inf
    for first, last in zip(swings.first.tolist(), swings.last.tolist(), strict=True):
        # time in which a block passes through contact, at its rates and with the steps on both ends
        passing = left + _blur(trace, first)
        if impacts and time[first] <= passing:
            impacts[-1] = replace(impacts[-1], rate_after=_at_contact(trace, first, -1)[1])
        elif first:
            uplifts.append(float(time[first]))
            rests += [impact.time for impact in impacts[-1:]]
        if last == len(time) - 1:
            return tuple(impacts), tuple(uplifts), tuple(rests)
        jump = v[min(last + 1 + SMEARED, len(v) - 1)] - v[last]
        impacts.append(Impact(*_at_contact(trace, last, 1), 0.0, float(jump)))
        left = time[last] + _blur(trace, last)
    return tuple(impacts), tuple(uplifts), (*rests, *(impact.time for impact in impacts[-1:]))


def _blur(trace: Trace, step: int) -> float:
    """Time [s] from a swing's end to contact, at the rate there, and two steps."""
    rate = abs(trace.tilt_rate[step])
    near = np.diff(trace.time[max(step - 1, 0) : step + 2]).max()
    return float(2 * near + (trace.contact_tilt / rate if rate else 0.0))


def _at_contact(trace: Trace, step: int, way: int) -> tuple[float, float]:
    """Time [s] and rate [rad/s] at tilt = 0 after a step (way 1) or before it (-1), at the acceleration there."""
    beside = min(max(step - way, 0), len(trace.time) - 1)
    (t, near), (rate, other) = trace.time[[step, beside]], trace.tilt_rate[[step, beside]]
    tilt, spin = trace.tilt[step], (rate - other) / (t - near) if beside != step else 0.0
    closing = -way * math.copysign(1.0, tilt) * rate
    speed = closing + math.sqrt(max(closing * closing - 2 * tilt * spin, 0.0))
    ahead = way * 2 * abs(tilt) / speed if speed > 0 else 0.0
    return float(t + ahead), float(rate + spin * ahead)


def _checked(scene: Scene, trace: StackTrace, falls: bool) -> Failure | None:
    """A `Failure` if the run ends early, gains energy, or ends with a block that has left its place, else None.

    The energy is that of `engines.trace_checks.energy_balance`, the place that of `check_place`: a block that falls and
    those of a first script may slide.
    """
    if not falls and (early := ended_early(scene, trace)):
        return early
    motion, time, x = scene.motion, trace.time, trace.base_displacement
    slabs, parts = slabs_of(scene), (trace.pedestal, trace)
    moved = moving_mass(scene) * np.array([x, trace.base_velocity, 0 * x, 0 * x])
    kinetic, rate = 0.5 * moving_mass(scene) * trace.base_velocity**2, np.zeros(len(time))
    for slab, part in zip(slabs, parts, strict=True):
        across, up, *speeds = part.centre.T
        rate = rate + part.tilt_rate
        moved += slab.mass * np.array([across, speeds[0], up, speeds[1]])
        kinetic = kinetic + 0.5 * (slab.mass * np.square(speeds).sum(axis=0) + slab.inertia * rate**2)
    gained = work(motion, time, *moved[:2]) + work(motion and motion.vertical, time, *moved[2:])
    balance = kinetic + scene.gravity * moved[2] + trapezoid(trace.bearing_force, x) - gained
    gain = (balance - np.minimum.accumulate(balance)).max() / max(StackModel.of(scene).barrier[0], kinetic.max())
    if not gain <= GAIN_LIMIT:
        return Failure("the run gained energy", f"{gain:.3g} of its energy scale; at most {GAIN_LIMIT} can be error")
    if falls or trace.first_script:
        return None
    tilts = float(trace.pedestal.tilt[-1]), float(trace.pedestal.tilt[-1] + trace.tilt[-1])
    for name, part, place in zip(NAMES, parts, centres(StackModel.of(scene), tilts), strict=True):
        off, R = complex(*part.centre[-1, :2]) - place - x[-1], scene.block.radius
        if not (abs(off.real) <= SLIDING_TOLERANCE * R and abs(off.imag) <= HEIGHT_TOLERANCE * R):
            return Failure(f"the {name} has left its place", f"by {off.real:.6g} m across and {off.imag:.6g} m up")
    return None


def _decided(scene: Scene, trace: StackTrace) -> bool:
    """Whether the analytic model's outcome is certain from the state at the end on; a tilt in contact is none."""
    run, parts = StackRun(scene, parameters(scene.with_(pedestal={"free": False})), False, 0.0), (trace.pedestal, trace)
    state = np.array([[part.tilt[-1], part.tilt_rate[-1]] for part in parts])
    state[[abs(tilt) < part.contact_tilt for tilt, part in zip(state[:, 0], parts, strict=True)]] = 0.0
    run.t, run.sides = float(trace.time[-1]), np.sign(state[:, 0]).astype(int).tolist()
    run.fixed = x, z = float(trace.base_displacement[-1]), float(trace.hysteretic[-1])
    run.y[:] = [*state.ravel(), x, trace.base_velocity[-1], z][: len(run.y)]
    return run.certain()


def release(
    engine: Engine, scene: Scene, pedestal_tilt: float, *, variant: str | None = None, **settings: float
) -> Response:
    """The response of a stack with a duration whose pedestal is tilted at the start, too [rad]."""
    name = variant or engine.default_variant
    chosen = replace(engine.variants[name].settings, **settings)
    run = engine.load().run_stack(scene, name, chosen, pedestal_tilt)
    labels: dict[str, Any] = dict(engine=engine.name, variant=name, settings=asdict(chosen), versions=engine.versions())
    return observe_stack(scene, run, cpu_seconds=run.cpu_seconds, steps=run.steps, warnings=run.warnings, **labels)
