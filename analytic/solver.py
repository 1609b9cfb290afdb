"""``simulate(scene)``: the analytic model, by the compiled kernel; limits of a run, and when it may end.

A run has limits of steps, events and rows of its history; a scene that exceeds them is refused with an error that names
the cause. The rules of `decision` are applied to the end state of another solver's run, too: they say whether that run
may end.
"""

from __future__ import annotations

import functools
import math
import time
from collections.abc import Callable
from dataclasses import astuple
from typing import TYPE_CHECKING

import numpy as np

from .errors import SceneError, SettingError, require
from .kernel import layout
from .kernel import march as kernel
from .kernel.compiled import compiling
from .kernel.decision import (
    CAP_PERIODS,
    longest_duration,
    motion_end,
    peaks_are_final,
    period,
    run_warnings,
    shortest_duration,
    will_not_overturn,
)
from .kernel.events import NEARLY_ELASTIC
from .kernel.layout import Base, Body, Ground, Options, Parameters, Shaking
from .kernel.steps import LINEAR_GROUND, PULSE, QUIET, SHORT_ORDER
from .motion import SERIES, SampledMotion, slowest_key
from .response import FALLS, Energy, Failure, History, Impact, Response, State
from .rocking import BearingLaw, RockingModel
from .scene import refuse_free
from .sliding.run import contact_of, is_needed
from .sliding.run import slid as march

if TYPE_CHECKING:
    from .motion import Motion
    from .scene import Scene

# Steps of a run until its outcome is decided, some seconds of CPU time: both Caryatid scenes take 6000, bearings of ten
# thousand rocking frequencies five million. A longer given duration may take more, up to a minute or two.
STEPS, MOST_STEPS = 5_000_000, 100_000_000
STEPS_PER_SAMPLE = 10  # further steps for each sample of a record; one or two of them are usual
EVENTS = 1_000_000  # impacts, uplifts or rests of a response
ROWS, MOST_ROWS = 1_000_000, 10_000_000  # of a history: by default, and with a given interval
USUAL_EXPONENT = 100.0  # of a bearing law: up to it, the yielding is no stiffer than the rest


def most_steps(scene: Scene) -> int:
    """Return the largest number of steps of a run of the scene."""
    longer = 1.0
    if scene.duration is not None:
        longer = max(1.0, (scene.duration - motion_end(scene)) / (CAP_PERIODS * period(scene)))
    samples = len(scene.motion.samples) if isinstance(scene.motion, SampledMotion) else 0
    return int(min(STEPS * longer, MOST_STEPS)) + STEPS_PER_SAMPLE * samples


def too_long(scene: Scene, spent: str) -> SceneError:
    """Return the error for a run that has `spent` its limit; it names the part of the scene furthest from usual.

    The bearings' frequency and decay rate are compared with omega_r, their exponent with 100, and the duration with a
    hundred rocking periods.
    """
    _, key, value, problem, remedy = max(_parts(scene), key=lambda part: part[0])
    return SceneError(key, value, f"{problem}: {spent}", remedy, scene.name or None)


def _parts(scene: Scene) -> list[tuple[float, str, float, str, str]]:
    """Return [(ratio to a usual value, key, value, problem, remedy)] of all causes of a long run."""
    model, omega, turn = RockingModel.of(scene), scene.rocking_frequency, 2 * math.pi
    parts = [(0.0, "block.radius", scene.block.radius, f"the block rocks at {omega:.3g} rad/s", "give a larger one")]
    if model.restitution > NEARLY_ELASTIC:
        problem, remedy = "impacts lose almost no energy", "give a smaller one"
        parts.append((1.0, "block.restitution", model.restitution, problem, remedy))
    if scene.duration is not None:
        periods = scene.duration * omega / turn
        parts.append((periods / 100, "run.duration", scene.duration, f"{periods:.3g} rocking periods", "shorten it"))
    if scene.motion is not None:
        periods, key = scene.motion.end * omega / turn, slowest_key(scene.motion)
        problem = f"the motion lasts {scene.motion.end:.3g} s, {periods:.3g} rocking periods"
        remedy = "raise it" if key == "motion.frequency" else "lower it"
        parts.append((periods / 100, key, getattr(scene.motion, key.removeprefix("motion.")), problem, remedy))
    return parts + _bearing_parts(scene, model)


def _bearing_parts(scene, model):
    bearings, law, omega = scene.bearings, model.bearing, scene.rocking_frequency
    if bearings is None:
        return []
    free = model.M - (model.m * model.R * math.cos(model.gamma)) ** 2 / model.J  # effective mass of the base [kg]
    ringing, decay = math.sqrt(law.count * (law.kb + law.dk) / free), law.count * law.damping / free
    problem = f"the base vibrates at {ringing:.3g} rad/s on such bearings"
    parts = [(ringing / omega, "bearings.ka", bearings.ka, problem, "lower it")]
    if decay:
        problem = f"such dampers stop the base within {1 / decay:.3g} s"
        parts.append((decay / omega, "bearings.damping", law.damping, problem, "lower it"))
    if bearings.alpha is not None:
        problem, remedy = "the law yields almost at a point", 'lower it, or give law = "bilinear"'
        parts.append((bearings.alpha / USUAL_EXPONENT, "bearings.alpha", bearings.alpha, problem, remedy))
    return parts


# Chosen by measurement (`rocking study speed-error`): where CPU against error is least.
ORDER = 18  # free flight and pulses: long steps
TOLERANCE = 1e-11
# Impacts are followed down to this fraction of omega_r, then summed to their limit; see `events.remaining_hops`.
REST_RATE = 1e-8
# History points where the motion has no sampling interval of its own.
HISTORY_POINTS = 2000

# Events of a kind kept in the first run; a run with more is repeated with room for all.
CAPACITY = 4096

_NO_SAMPLES = np.zeros(2)
_NO_SAMPLES.flags.writeable = False  # the same compiled type as the samples of a motion


def parameters(scene: Scene) -> Parameters:
    """Return the scene as the kernel's `Parameters`."""
    refuse_free(scene, "the model of one block")
    model, law, start = RockingModel.of(scene), BearingLaw.of(scene.bearings), scene.start
    return Parameters(
        m=model.m,
        M=model.M,
        J=model.J,
        R=model.R,
        gamma=model.gamma,
        slope=math.tan(model.gamma),
        g=model.g,
        p2=scene.rocking_frequency**2,
        e=float(model.restitution),
        arm=model.jump_arm,
        on_base=float(model.on_base),
        law=float(law.law),
        count=float(law.count),
        kb=law.kb,
        damping=law.damping,
        tilt=start.tilt,
        rate=start.tilt_rate,
        x=start.base_displacement,
        v=start.base_velocity,
        z=law.start(start.base_displacement),
        duration=longest_duration(scene) if scene.duration is None else scene.duration,
        constants=law.constants,
    )


def ground(motion: Motion | None, scale: float = 1.0) -> Ground:
    """Return the motion as the kernel's `Ground`, times `scale`."""
    scale = float(scale)
    if motion is None:
        return Ground(QUIET, 1.0, _NO_SAMPLES, None, Shaking(*[0.0] * len(Shaking._fields)))
    if isinstance(motion, SampledMotion):
        times = Shaking(scale, 0.0, 0.0, 0.0, motion.end, scale, 0.0)
        upright = motion.vertical.samples if motion.vertical else None
        return Ground(LINEAR_GROUND, motion.dt, motion.samples, upright, times)
    form, kind, frequency = motion.form, PULSE, 0.0
    if form.series:
        kind, frequency = PULSE + SERIES.index(form.series), motion.frequency
    phase = form.shift
    up = (motion.vertical.amplitude * scale, phase + motion.vertical.phase) if motion.vertical else (0.0, 0.0)
    pulse = Shaking(motion.amplitude * scale, frequency, phase + motion.phase, motion.start, motion.end, *up)
    return Ground(kind, 1.0, _NO_SAMPLES, _NO_SAMPLES if motion.vertical else None, pulse)


def options(
    tolerance: float = TOLERANCE,
    rest_rate: float = REST_RATE,
    record: bool = True,
    decide: bool = False,
    output_step: float = 0.0,
    capacity: int = CAPACITY,
    shortest: float | None = None,
    steps: int = MOST_STEPS,
) -> Options:
    """Return the kernel's `Options`, checked; `shortest` is by default 0 where the run is to `decide`, else infinite.

    Raises
    ------
    SettingError
        A setting is out of range.
    """
    require(1e-17 <= tolerance <= 1e-2, f"tolerance = {tolerance!r}: give a value from 1e-17 to 1e-2")
    require(0 < rest_rate <= 1e-2, f"rest_rate = {rest_rate!r}: give a value above 0, up to 1e-2")
    if shortest is None:
        shortest = 0.0 if decide else math.inf
    return Options(
        float(tolerance), ORDER, float(rest_rate), record, decide, float(output_step), capacity, float(shortest), steps
    )


def simulate(
    scene: Scene,
    *,
    history: bool = True,
    tolerance: float = TOLERANCE,
    rest_rate: float = REST_RATE,
    output_step: float | None = None,
) -> Response:
    """Simulate a scene with the analytic rocking model; one with a free pedestal by `simulate_stack`.

    Without a duration the run ends when its outcome is decided and its peaks are final (`decision`). With one, a base
    that oscillates under a block which will not lift again is followed up to `longest_duration`. If the duration ends
    while the block is certain to overturn (rigid ground, after the motion), the outcome is "overturns" all the same.

    Parameters
    ----------
    scene : Scene
    history : bool
        Keep the history at multiples of `output_step` (and at the end).
    tolerance : float
        The last Taylor term of a step, relative to the motion within the step. The error at the end is larger by the
        sensitivity of the motion (a few hundred times near overturning).
    rest_rate : float
        Impacts slower than this fraction of omega_r are summed to their limit and end in rest.
    output_step : float or None
        [s]; by default the sampling interval of the motion or a 2000th of the duration, or a multiple (`_output_step`).

    Raises
    ------
    SettingError
        A setting is out of range.
    SceneError
        The run needs too many steps (`most_steps`) or has too many impacts; the message names the cause in the scene.
    """
    if scene.is_stack:
        return simulate_stack(scene, history=history)
    output_step = _output_step(scene, output_step, history)
    settings = {"tolerance": tolerance, "rest_rate": rest_rate, "order": ORDER, "short_order": SHORT_ORDER}
    chosen = options(
        tolerance,
        rest_rate=rest_rate,
        output_step=output_step if history else 0.0,
        decide=scene.duration is None,
        shortest=(shortest_duration if scene.duration is None else longest_duration)(scene),
        steps=most_steps(scene),
    )
    par, shaking = parameters(scene), ground(scene.motion)
    compile_kernels(shaking.upright is not None)
    begin = time.process_time()
    totals, *result = _kernel_run(scene, par, shaking, chosen)
    cpu, slid, sliding = time.process_time() - begin, None, None
    at_end = totals[layout.END_TILT : layout.END_V + 1].tolist()
    energies = _stored(par, *at_end) - _stored(par, par.tilt, par.rate, par.x, par.v)
    if (contact := contact_of(scene)) and is_needed(par, contact, totals):
        slid = march(scene, par, contact, shaking, chosen)
    if slid:
        cpu, totals, result, energies, sliding = slid
    elif totals[layout.WILL_OVERTURN] and totals[layout.MODE] == layout.ROCK:  # ends during the fall
        later = par._replace(duration=par.duration + longest_duration(scene))
        further, *_ = kernel.run(later, shaking, options(tolerance, rest_rate=rest_rate))
        totals[[layout.OVER_TIME, layout.FALL_TIME]] = further[[layout.TIME, layout.FALL_TIME]]
    return _response(scene, totals, result, energies, sliding, settings, cpu, history)


def simulate_stack(scene: Scene, *, history: bool = True, pedestal_tilt: float = 0.0) -> Response:
    """Simulate a statue on a free pedestal.

    Without a duration the run ends when, after the motion, the energy suffices for no fall and no larger peak, or at
    `longest_duration`.

    Parameters
    ----------
    scene : Scene
        With a free pedestal. The tilt at the start is that of the statue from the pedestal.
    history : bool
        Keep the history, at several points of each step.
    pedestal_tilt : float
        Tilt of the pedestal at the start [rad].

    Returns
    -------
    Response
        Tilts, impacts, friction demand and normal force are those of the statue on the pedestal; `Response.stack` has
        those of the pedestal. A run that has left the model has failed, for a reason "outside the model: ...".
    """
    from .stack.run import Run  # loads scipy.integrate

    compile_kernels()
    begin, par = time.process_time(), parameters(scene.with_(pedestal={"free": False}))
    run = Run(scene, par, history, pedestal_tilt)
    failure = run.go()
    return run.response(time.process_time() - begin, failure)


def _kernel_run(scene, par, shaking, chosen):
    """Return what the kernel returns, with room for all events; refuse a run beyond the limits."""
    totals, *result = kernel.run(par, shaking, chosen)
    most = int(totals[[layout.IMPACTS, layout.UPLIFTS, layout.RESTS]].max())
    if totals[layout.STATUS] == layout.SPENT:
        reached = f"{chosen.most_steps:.3g} steps of the analytic model reach only {totals[layout.TIME]:.3g} s"
        raise too_long(scene, reached)
    if most > EVENTS:
        raise too_long(scene, f"{most} impacts, of which no more than {EVENTS} are kept")
    return (totals, *result) if most <= chosen.capacity else kernel.run(par, shaking, chosen._replace(capacity=most))


def _output_step(scene, step, history):
    """Return the interval of the history [s]; by default that of the motion's samples, or a share of the duration."""
    longest = longest_duration(scene) if scene.duration is None else scene.duration
    if step is None:
        span = shortest_duration(scene) if scene.duration is None else scene.duration
        step = scene.motion.dt if isinstance(scene.motion, SampledMotion) else span / HISTORY_POINTS
        return step * max(1, math.ceil(longest / step / ROWS))
    require(step > 0 and math.isfinite(step), f"output_step = {step!r}: give a time above 0 [s]")
    if history and longest / step > MOST_ROWS:
        least = longest / MOST_ROWS
        raise SettingError(
            f"output_step = {step!r}: up to {longest / step:.3g} rows of history; give at least {least:.3g} s, or "
            "history=False"
        )
    return step


@functools.cache
def compile_kernels(vertical: bool = False) -> None:
    """Load the compiled functions, or compile them: once per machine, some ten seconds.

    `simulate` does so before it takes the time; call it before your own timing. vertical : also for motions with a
    vertical component.
    """
    from .scene import Block, Scene

    scene = Scene(block=Block(mass=1.0, radius=1.0, slenderness=0.2), duration=1e-3)
    quiet = ground(None)._replace(upright=_NO_SAMPLES if vertical else None)
    with compiling():
        state = parameters(scene), Body(0.0, 0.0, 0.0), Base(0.0, 0.0, 0.0)
        kernel.run(state[0], quiet, options(output_step=1.0))
        # other functions that solvers call from Python
        BearingLaw.of(None).hysteretic(0.0, 1e-6)
        will_not_overturn(*state, False)
        peaks_are_final(*state, (0.0, 0.0, 0.0))


@functools.cache
def versions() -> dict[str, str]:
    """Return the versions of Python and of the packages behind the analytic model."""
    import numba

    return {"numpy": np.__version__, "numba": numba.__version__}


_LEDGER = [layout.INPUT, layout.HYSTERETIC, layout.VISCOUS, layout.IMPACT_LOSS, layout.FRICTION_WORK]
_REASONS = {
    layout.STUCK: "the step became too small to advance",
    layout.NOT_FINITE: "the state is not finite",
    layout.SPENT: "too many steps",
    layout.NO_MODE: "not exactly one mode of contact is admissible",
}


def _response(scene, totals, result, energies, sliding, settings, cpu, history):
    """Return the `Response` of a run of the kernel, or, with a `Sliding`, of the march of a block that may slide."""
    impacts, uplifts, rests, table = result
    tilt, rate, x, v, z = totals[layout.END_TILT : layout.END_Z + 1].tolist()
    end = State(float(totals[layout.TIME]), tilt, rate, x, v, BearingLaw.of(scene.bearings).force(x, z, v))
    status, over = int(totals[layout.STATUS]), float(totals[layout.OVER_TIME])
    failure = None
    if status not in (layout.COMPLETE, layout.DECIDED):
        failure = Failure(_REASONS[status], last_state=end)
    fallen = over > 0 or totals[layout.MODE] == layout.FALLEN
    falls = "falls off" if totals[layout.MODE] == layout.OFF else "overturns" if fallen else None
    upright = "rocks" if totals[layout.LIFTED] else "slides" if totals[layout.PATH] > 0 else "stands"
    unstable, peak_x = float(totals[layout.UNSTABLE_TIME]), float(totals[layout.PEAK_X])
    demand, normal = float(totals[layout.FRICTION]), float(totals[layout.NORMAL])
    slip = 0.0 if falls else float(totals[layout.PEAK_SLIP])
    return Response(
        engine="analytic",
        variant="kernel",
        scene=scene.name,
        outcome="failed" if failure else falls or upright,
        overturning_time=(over or end.time) if fallen else None,
        unstable_time=unstable if unstable >= 0 else None,
        fall_time=float(totals[layout.FALL_TIME]) if fallen else None,
        peak_tilt=float(totals[layout.PEAK_TILT]),
        peak_tilt_ratio=float(totals[layout.PEAK_TILT]) / scene.block.slenderness,
        peak_base_displacement=peak_x,
        peak_base_acceleration=float(totals[layout.PEAK_ACCELERATION]),
        impacts=tuple(Impact(*row) for row in impacts.tolist()),
        uplifts=tuple(uplifts.tolist()),
        rests=tuple(rests.tolist()),
        friction_demand=demand,
        min_normal_ratio=normal,
        end=end,
        cpu_seconds=cpu,
        steps=int(totals[layout.STEPS]),
        settings=settings,
        versions=dict(versions()),
        failure=failure,
        decided=failure is None and bool(totals[layout.CERTAIN]),
        warnings=run_warnings(scene, demand, normal, peak_x, v, slides=sliding is not None, peak_slip=slip),
        energy=Energy(*energies.tolist(), *totals[_LEDGER].tolist()),
        sliding=sliding,
        history=_history(scene, table, end, *([] if sliding is None else [sliding.end])) if history else None,
    )


def _stored(par, tilt, rate, x, v):
    """Return (kinetic, potential) energy [J] of a block that does not slide, in the ground's frame."""
    side = math.copysign(1.0, tilt if tilt != 0 else rate)
    c = par.R * math.cos(side * par.gamma - tilt)
    moving = 0.5 * par.M * v * v + par.m * c * v * rate if par.on_base else 0.0
    # cos(gamma - |tilt|) - cos(gamma) without cancellation
    rise = 2 * math.sin(par.gamma - 0.5 * abs(tilt)) * math.sin(0.5 * abs(tilt))
    bearing_kb = par.count * par.kb
    return np.array([0.5 * par.J * rate * rate + moving, par.m * par.g * par.R * rise + 0.5 * bearing_kb * x * x])


def _history(scene: Scene, table: np.ndarray, end: State, *slip: float) -> History:
    """Return the `History` of a table of rows and the end state. slip : at the end [m], of a block that slides."""
    last = np.array([[*astuple(end), *slip]])
    if not len(table) or table[-1, 0] < end.time:
        table = np.vstack([table, last])
    columns = np.ascontiguousarray(table.T)
    shaking = np.zeros(len(table)) if scene.motion is None else scene.motion.acceleration(columns[0])
    return History(*columns[:6], shaking, columns[6] if slip else None)  # type: ignore[call-arg]  # of six


def is_decided(scene: Scene, response: Response, *, contact_tilt: float = 0.0) -> bool:
    """Return whether the outcome of a run is certain at its end, by rules (a), (b) and (c).

    Parameters
    ----------
    scene : Scene
    response : Response
    contact_tilt : float
        Tilt [rad] up to which the solver's block counts as in full contact.

    Returns
    -------
    bool
        False for a failed run, and for one that ended before the ground motion.
    """
    return _at_end(scene, response, contact_tilt)[0]


def is_finished(scene: Scene, response: Response, *, contact_tilt: float = 0.0) -> bool:
    """Return whether the outcome of a run is certain at its end and its peaks can no longer grow; see `is_decided`."""
    decided, state = _at_end(scene, response, contact_tilt)
    if not decided or state is None:
        return decided
    peaks = response.peak_tilt, response.peak_base_displacement, response.peak_base_acceleration
    return bool(peaks_are_final(*state, peaks))


def _at_end(scene: Scene, response: Response, contact_tilt: float) -> tuple[bool, tuple[Parameters, Body, Base] | None]:
    """Return (decided, the kernel's parameters and state; None if the block has overturned or the run failed)."""
    if response.outcome in (*FALLS, "failed"):
        return response.outcome in FALLS, None
    par, end = parameters(scene), response.end
    if scene.friction is not None:  # at rest the block slides where it does not lift
        par = par._replace(slope=min(par.slope, scene.friction))
    if end.time < motion_end(scene) * (1 - 1e-9):
        return False, None
    x, v, z = end.base_displacement, end.base_velocity, 0.0
    if par.count:
        z = end.bearing_force / par.count - par.kb * x - par.damping * v
        z = min(max(z, -par.constants.f0), par.constants.f0)
    body = Body(0.0, 0.0, 0.0)
    if abs(end.tilt) > contact_tilt or contact_tilt == 0 and end.tilt_rate != 0:
        body = Body(math.copysign(1.0, end.tilt if end.tilt != 0 else end.tilt_rate), end.tilt, end.tilt_rate)
    state = par, body, Base(x, v, z)
    return bool(will_not_overturn(*state, response.outcome == "rocks")), state


def until_decided(
    simulate: Callable[[Scene], Response],
    scene: Scene,
    *,
    at_least: float = 0.0,
    finished: Callable[[Scene, Response], bool] = is_finished,
) -> Response:
    """Return the response of runs with increasing durations until one has finished or the longest is reached.

    Parameters
    ----------
    simulate : callable
        From a scene with a duration to a `Response`.
    scene : Scene
        Without a duration.
    at_least : float
        First duration [s], if longer than `shortest_duration`.
    finished : callable
        (scene, response) -> whether the run may end here.
    """
    longest, begin = longest_duration(scene), motion_end(scene)
    duration = min(max(shortest_duration(scene), at_least), longest)
    while True:
        response = simulate(scene.with_(duration=duration))
        if response.outcome == "failed" or duration >= longest or finished(scene, response):
            return response
        duration = min(begin + 2 * (duration - begin), longest)
