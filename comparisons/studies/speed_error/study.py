"""The speed-error study: error and CPU time of every solver at several levels, from the same runs.

Each round is a fresh process in which all solvers are warmed up and take turns. The module holds the scenes with their
references, the solvers and levels that run on each, and the search for a solver's own overturning boundary near the
reference's.
"""

import dataclasses
import json
import math
import statistics
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import zip_longest
from types import SimpleNamespace
from typing import Annotated, Any, Self

import numpy as np
import psutil
import typer
from scipy.optimize import brentq

from analytic import Impact, PulseMotion, Response, Scene, SettingError, Start, State, simulate, synthetic_motion
from analytic.checks.twin import simulate_twin
from analytic.rocking import restitution
from analytic.scene import BASE, BEARINGS, caryatid_block
from engines import ENGINES, get_engine
from engines.contract import Variant

from ...execution.cases import Case, refined, variant_settings
from ...execution.plan import Batch, Computed, Plan, Request
from ...metrics import errors as models
from ...metrics import scripts
from ...metrics.errors import (
    lost_impacts,
    rate_restitution,
    rms,
    sensitivity_horizon,
    state_restitution,
    strong_impacts,
    strong_time_errors,
)
from ...schemas.columns import declared, flag_of, list_of, number_of, table_of, whole_of, word_of
from ..rows import SHARED
from . import integrators
from .integrators import PROBLEMS, SOLVER, timed

# The columns of its rows, and by part which of them a row has; see `comparisons.studies.rows`.
COLUMNS = SHARED | declared(
    word_of("model", "modelled", "how the engine's model stands for the scene"),
    word_of("parameter", "parameter", "accuracy parameter whose value is the level"),
    table_of(
        "errors",
        "errors",
        "by measure: restitution, boundary_shift, peak_displacement [-]; peak_tilt, end_tilt, horizon_tilt "
        "[slenderness]; impact_time [s]",
    ),
    whole_of("timings", "timings", "fresh processes in which the run was timed"),
    number_of("cpu_low", "lowest CPU time", "CPU time of one run: least", "s"),
    number_of("cpu_high", "highest CPU time", "CPU time of one run: most", "s"),
    flag_of("repeatable", "repeatable", "whether all of them gave the same numbers, bit for bit"),
    number_of("simulated", "simulated", "simulated time", "s"),
    number_of("step", "mean step", "mean step size", "s"),
    number_of("cpu_per_step", "CPU time per step", "CPU time over steps", "s"),
    list_of(
        "boundary_shifts",
        "boundary shifts",
        "relative shift of the overturning boundary from the reference's, run by run",
    ),
)
PARTS = {
    "work-precision": """scene engine variant model law? parameter? level? outcome? failure? timings errors lost?
            repeatable | cpu_seconds cpu_low cpu_high simulated steps? step? cpu_per_second cpu_per_step?
            boundary_shifts? settings"""
}

RUNS = 6  # of a search: the first is at the reference's boundary, the others at corrected amplitudes
STRIDE = 0.05  # longest relative move of a search; a search that does not end within its runs finds no boundary
SMALL = 1e-3  # margin below which the reference's slope alone is as good as a chord


@dataclass(frozen=True)
class Boundary:
    """Pulse amplitude [m/s2] at which the block just overturns, and slope: d margin / d (amplitude / boundary)."""

    amplitude: float
    slope: float


def margin(scene: Scene, end: State) -> float:
    """Return the energy beyond what tipping over needs, after the motion's end, over m g R (1 - cos gamma).

    It is conserved in flight.

    Negative: the block falls back; positive: it overturns. With u = gamma - |phi|: (w^2/2 - p^2 (1 - cos u))/(p^2 (1 -
    cos gamma)).
    """
    gamma, p2 = scene.block.slenderness, scene.rocking_frequency**2
    u = gamma - abs(end.tilt)
    return (0.5 * end.tilt_rate**2 - 2 * p2 * math.sin(0.5 * u) ** 2) / (2 * p2 * math.sin(0.5 * gamma) ** 2)


def at_amplitude(scene: Scene, amplitude: float) -> Scene:
    """Return the scene with its pulse at another amplitude [m/s2]."""
    assert isinstance(scene.motion, PulseMotion)
    return scene.with_(motion=replace(scene.motion, amplitude=float(amplitude)))


def searched(
    run: Callable[[Scene], Response], scene: Scene, boundary: Boundary | None
) -> tuple[Response, list[float] | None, float]:
    """Run a scene once, or search for the solver's own boundary.

    The margin is smooth in the amplitude, so moving by the reference's slope converges at once for a solver near the
    reference; one far from it is bracketed.

    Returns
    -------
    response : Response
        The first.
    shifts : list of float or None
        Relative position of the boundary against the reference's after each run; None without one, or if a run failed.
    cpu_seconds : float
        Of all runs.
    """
    first = run(scene)
    if boundary is None:
        return first, None, first.cpu_seconds
    shift, shifts, cpu, margins = 0.0, list[float](), 0.0, dict[float, float]()
    for _ in range(RUNS):
        moved = at_amplitude(scene, boundary.amplitude * (1 + shift))
        response = run(moved) if margins else first
        cpu += response.cpu_seconds
        if response.outcome == "failed":
            return response, None, cpu
        margins[shift] = margin(moved, response.end) / boundary.slope
        shift = _next_shift(margins, shift)
        shifts.append(shift)
    return first, shifts, cpu


def _next_shift(margins, last):
    """Choose the next shift: by the chord of the nearest points on either side, else by the reference's slope."""
    below = max((at for at, value in margins.items() if value <= 0), default=None)
    above = min((at for at, value in margins.items() if value > 0), default=None)
    if below is None or above is None or abs(margins[last]) < SMALL:
        return last - min(max(margins[last], -STRIDE), STRIDE)
    if below > above:  # the margin is not monotone here: stay
        return last
    return below + (above - below) * min(max(-margins[below] / (margins[above] - margins[below]), 0.1), 0.9)


TIGHTEST = 1e-17  # tolerance of the kernel as a reference
LONGEST = 10.0  # s, of a run under the synthetic motion: the strong shaking and what follows
FREQUENCY_RATIO = 3.0  # pulse frequency over omega_r, near-overturning scenes
# {shape of a pulse: amplitudes over g tan(slenderness) on either side of its boundary}; the second starts with a jump
BRACKETS = {"one-sine": (1.35, 1.45), "one-cosine": (1.8, 1.95)}

TRANSPARENT = ("free-rigid", "near-overturning")  # scenes without base or record
SAMPLED = ("isolated-standing", "isolated-rocking")
PLAIN = "isolated-rocking"  # the scene in which engines are compared at their defaults

NEEDED = "as needed"
HEAVY_BASE, SPRINGS, FREE_3D = "rigid ground as a heavy base", "rigid ground as stiff springs", "free block in 3-D"


@dataclass(frozen=True, eq=False)
class Trial:
    """One scene of the study, with its reference.

    measures: names of the errors that mean something here, the principal one first. boundary: the one that the runs
    search for; None: they search for none. reference: the response of the kernel at its tightest.
    """

    name: str
    scene: Scene
    measures: tuple[str, ...]
    boundary: Boundary | None = None

    @cached_property
    def reference(self) -> Response:
        return tight(self.scene)

    def with_law(self, law: str) -> Self:
        """Return the same trial with another bearing law, and that law's own reference."""
        return replace(self, scene=self.scene.with_(bearings={"law": law}))


def tight(scene: Scene) -> Response:
    """Return the reference response of a scene."""
    return simulate(scene, history=False, tolerance=TIGHTEST)


def trials() -> list[Trial]:
    """Return the six trials, in the order of what they ask of a solver."""
    free = caryatid_block(0.2)
    isolated: dict[str, Any] = {"base": BASE, "bearings": BEARINGS, "motion": synthetic_motion()}
    rigid = Scene(name="free rocking on rigid ground", block=free, start=Start(tilt=0.12), duration=5.0)
    sliding = rigid.with_(name="free rocking on a sliding base", base=BASE, duration=4.0)
    stands = Scene(name="isolated, standing", block=caryatid_block(0.28), duration=LONGEST, **isolated)
    rocks = Scene(name="isolated, rocking", block=caryatid_block(0.15), duration=LONGEST, **isolated)
    rocks = rocks.with_(duration=math.floor(100 * sensitivity_horizon(rocks).horizon) / 100)
    events = ("restitution", "impact_time")
    return [
        Trial("free-rigid", rigid, (*events, "end_tilt")),
        Trial("free-sliding", sliding, (*events, "peak_displacement")),
        Trial("isolated-standing", stands, ("peak_displacement",)),
        Trial("isolated-rocking", rocks, ("restitution", "peak_tilt", "impact_time", "peak_displacement")),
        near_overturning("one-sine"),
        near_overturning("one-cosine", name="near-overturning-jump"),
    ]


def problem_trials() -> list[Trial]:
    """Return problems A and B as trials of integrators, to fine errors; their references are not the kernel's."""
    return [Trial(name, problem.scene, ("horizon_tilt",)) for name, problem in integrators.PROBLEMS.items()]


def near_overturning(shape: str, name: str = "near-overturning") -> Trial:
    """Return a trial near the amplitude at which a pulse just overturns the block after one impact.

    The boundary itself is what solvers are asked for.
    """
    block = caryatid_block(0.25)
    unit = 9.81 * math.tan(block.slenderness)
    pulse = PulseMotion(shape, unit, FREQUENCY_RATIO * Scene(block=block, duration=1.0).rocking_frequency)
    words = f"{shape.replace('-', ' ')} at the overturning boundary"
    scene = Scene(name=words, block=block, motion=pulse, duration=2.5)

    def at(amplitude):
        return margin(scene, tight(at_amplitude(scene, amplitude)).end)

    low, high = BRACKETS[shape]
    amplitude = brentq(at, low * unit, high * unit, xtol=1e-15, rtol=1e-15)
    change = 1e-4
    slope = (at(amplitude * (1 + change)) - at(amplitude * (1 - change))) / (2 * change)
    measures = ("boundary_shift", "restitution", "peak_tilt", "impact_time")
    return Trial(name, at_amplitude(scene, amplitude), measures, Boundary(amplitude, slope))


@dataclass(frozen=True, eq=False)
class Entry:
    """One solver at one level of its accuracy parameter on one trial.

    engine, variant: its names in rows. parameter, level: None where there is only one level. solver: what is run, if
    not the engine. model: `NEEDED`, or what is modelled beyond what the scene needs. scene_of: function from the
    trial's scene to the scene so modelled.
    """

    trial: Trial
    engine: str
    variant: str
    parameter: str | None
    level: float | None
    solver: str = ""
    settings: dict = field(default_factory=dict)
    model: str = NEEDED
    scene_of: Callable[[Scene], Scene] = lambda scene: scene

    def case(self, turn: int) -> Case:
        """Return the measurement of one round as a `Case`."""
        solver, boundary = self.solver or self.engine, self.trial.boundary
        level = {self.parameter: self.level} if self.parameter else {}
        return Case(
            self.scene_of(self.trial.scene),
            solver,
            self.variant if solver in ENGINES else None,
            {**self.settings, **level, "history": False},
            {"boundary": boundary and [boundary.amplitude, boundary.slope], "round": turn},
        )


def powers(*exponents: float) -> tuple[float, ...]:
    """Return powers of ten."""
    return tuple(10.0**exponent for exponent in exponents)


# levels of a full and of a quick run
FREE_3D_STEPS = ((1 / 240, 1e-3, 3e-4, 1e-4), (1 / 240, 1e-3))  # s
KERNEL = (powers(-3, -4, -6, -8, -10, -12, -14, -16), powers(-4, -8, -12))
STEPPING = (powers(-2, -2.5, -3, -3.5, -4, -4.5, -5, -6), powers(-2, -3, -4))
SCIPY = {
    "DOP853": (powers(-3, -5, -7, -9, -11, -12), powers(-5, -9)),
    "RK45": (powers(-3, -5, -7, -9, -11), powers(-5, -9)),
    "LSODA": (powers(-3, -5, -7, -9, -11), powers(-7)),
    "Radau": (powers(-3, -5, -7), powers(-5)),
}
# a restart at every sample makes a scipy run under a record cost seconds
SCIPY_SAMPLED = {
    "DOP853": (powers(-3, -6, -9), ()),
    "RK45": (powers(-3, -6, -9), ()),
    "LSODA": (powers(-6), ()),
    "Radau": (powers(-3), ()),
}


def levels_of(spec: Variant, quick: bool) -> list[float]:
    """Return the levels of a variant that are run; few of the kind "defaults", whose error hardly changes."""
    few = (spec.levels[0], spec.default) if quick else spec.levels
    return list(dict.fromkeys(few)) if quick or spec.kind == "defaults" else refined(spec.levels)


def entries(scenes: Sequence[Trial], engines: Sequence[str], quick: bool) -> list[Entry]:
    """Return all entries in an order in which solvers alternate: the first level of each, then the second of each."""
    turns = (turn for trial in scenes for turn in zip_longest(*_levels_by_solver(trial, engines, quick)))
    return [entry for turn in turns for entry in turn if entry]


def _levels_by_solver(trial: Trial, engines: Sequence[str], quick: bool) -> Iterator[list[Entry]]:
    """Yield each solver's entries on a trial, level after level."""
    if trial.name in integrators.PROBLEMS:
        yield from _integrator_entries(trial, quick)
        return
    yield from _model_entries(trial, SCIPY_SAMPLED if trial.name in SAMPLED else SCIPY, quick)
    for name in engines:
        engine = get_engine(name)
        if engine.script and not quick:
            version = {**engine.versions(), "script": scripts.version_of(engine, trial.scene)}
            as_written = {"engine": name, "version": version}
            yield [Entry(trial, name, scripts.NAME, None, None, f"{scripts.__name__}:simulate_script", as_written)]
        for variant, kind in engine.variants.items():
            yield [Entry(trial, name, variant, kind.accuracy_parameter, level) for level in levels_of(kind, quick)]
            if kind.free_block and trial.scene.bearings is None:
                steps = FREE_3D_STEPS[quick]
                yield [Entry(trial, name, variant, "step", step, kind.free_block, model=FREE_3D) for step in steps]
    if trial.name in SAMPLED:
        yield from _model_entries(trial.with_law("bouc-wen"), {"DOP853": SCIPY_SAMPLED["DOP853"]}, quick)
    if trial.name in TRANSPARENT:
        ways = [(SPRINGS, models.on_stiff_springs)]
        if trial.scene.motion is None:  # a free base does not feel the ground's motion
            ways.append((HEAVY_BASE, models.on_heavy_base))
        for model, change in ways:
            yield [_kernel_entry(trial, level, model=model, scene_of=change) for level in powers(-8, -12)[quick:]]


def _model_entries(trial, methods, quick):
    """Entries of the kernel, of time stepping, and of the equations in scipy by these methods."""
    yield [_kernel_entry(trial, level) for level in KERNEL[quick]]
    yield [Entry(trial, "time-stepping", "", "step", step) for step in STEPPING[quick]]
    for method, levels in methods.items():
        settings = {"energy": False, "method": method}
        yield [Entry(trial, "scipy", method, "rtol", level, "twin", settings) for level in levels[quick]]


def _integrator_entries(trial, quick):
    for (engine, variant), levels in integrators.TOLERANCES.items():
        settings = {"engine": engine, "variant": variant}
        yield [
            Entry(trial, engine, variant, "tolerance", level, integrators.SOLVER, settings) for level in levels[quick]
        ]


def _kernel_entry(trial, level, **modelled):
    return Entry(trial, "analytic", "kernel", "tolerance", level, **modelled)


# Why one engine's rows cannot be computed anew by themselves, see `Study.whole`.
WHOLE = "its CPU times are compared with each other, so they have to be measured together"

REPEATS, QUICK_REPEATS = 5, 3
TICK = 4e-3  # s of CPU: shorter measurements are repeated until they took as long, and the mean counts
SLOW = 0.5  # s of CPU: a run as long as this needs no warm-up, as what a first run loads takes little beside it
SECONDS = 1.0  # over which the load of the machine is measured
MOST_REPEATS = 200
TWIN_TOLERANCE = 1e-13  # of the independent solution each reference is compared with
EVIDENCE = 600  # characters of an engine's message that a row keeps
# A search that still moves this far has found no boundary. With fixed steps the boundary depends on where in a step the
# impact falls, which differs from run to run: the root mean square of the last positions stands for it.
STRAY, LAST = 0.025, 3

Repeats = Annotated[
    int | None, typer.Option(min=1, max=1000, help="Number of rounds, each a fresh process. Default 5, quick 3.")
]
Only = Annotated[str | None, typer.Option("--scene", metavar="NAME", help='Run this scene alone, such as "problem A".')]


def load(case: Case, response: Response) -> dict[str, Any]:
    """Measure the share of the machine's CPU time that other processes take while nothing of ours runs [-]."""
    return {"cost": {"load": psutil.cpu_percent(SECONDS) / 100}}


def measure(case: Case, response: Response) -> dict[str, Any]:
    """Return what is kept of one measurement, and its CPU time: the mean over runs of at least `TICK` in all.

    The run that made `response` has loaded code and caches; if it was long enough, it is the measurement itself. A case
    whose tag holds a boundary, (amplitude, slope) of a `Boundary`, is a search for it.
    """
    if case.solver == SOLVER:
        return timed(case, TICK)
    goal = Boundary(*case.tag["boundary"]) if case.tag["boundary"] else None

    def run(scene):
        return dataclasses.replace(case, scene=scene).run()

    shifts, cpu, repeats = None, response.cpu_seconds, 1
    if goal or cpu < SLOW:
        response, shifts, cpu = searched(run, case.scene, goal)
        if 0 < cpu < TICK and response.outcome != "failed":
            repeats = min(MOST_REPEATS, math.ceil(TICK / cpu))
            cpu = sum(searched(run, case.scene, goal)[2] for _ in range(repeats)) / repeats
    cost = {"cpu_seconds": cpu / (RUNS if goal else 1), "repeats": repeats}
    values = response.to_json()
    del values["sliding"]  # no scene gives a friction
    return {**values, "boundary_shifts": shifts, "cost": cost}


def errors(trial: Trial, values: Mapping[str, Any], shifts: Sequence[float] | None = None) -> dict[str, float]:
    """Return absolute errors by measure, and "lost", the number of missed impacts.

    Measures that the trial does not have, or the run does not show, are absent.

    Parameters
    ----------
    trial : Trial
    values : dict
        `Response.to_json()` of the run, or of the first run of a boundary search.
    shifts : list of float or None
        Relative position of the boundary against the reference's, one per run of the search. A solver without a
        boundary nearby has no error "boundary_shift".
    """
    run: Any = SimpleNamespace(impacts=[Impact(**impact) for impact in values["impacts"]])
    reference, end, gamma = trial.reference, values["end"], trial.scene.block.slenderness
    times = strong_time_errors(run, reference)
    by_measure = {"impact_time": times[np.isfinite(times)], "restitution": _restitution_errors(trial.scene, run)}
    if values["peak_tilt"] is not None:
        by_measure["peak_tilt"] = [abs(values["peak_tilt"] - reference.peak_tilt) / gamma]
    if values["peak_base_displacement"] is not None and "peak_displacement" in trial.measures:
        by_measure["peak_displacement"] = [abs(values["peak_base_displacement"] / reference.peak_base_displacement - 1)]
    if abs(end["time"] - trial.scene.duration) < 1e-9:
        by_measure["end_tilt"] = [abs(abs(end["tilt"]) - abs(reference.end.tilt)) / gamma]
    if shifts and abs(shifts[-1] - shifts[-2]) < STRAY:
        by_measure["boundary_shift"] = shifts[-LAST:]
    root_mean_squares = {name: rms(by_measure[name]) for name in trial.measures if len(by_measure.get(name, ()))}
    return {"lost": lost_impacts(run, reference), **root_mean_squares}


def _restitution_errors(scene, run):
    """Errors of restitution, e - eq. (7), at the impacts fast enough; under a motion e is that of the states."""
    if scene.motion is None and scene.bearings is None:
        return rate_restitution(run) - restitution(scene)
    strong: Any = SimpleNamespace(impacts=strong_impacts(run))
    return state_restitution(strong) - restitution(scene)


def plan(
    request: Request,
    scenes: Sequence[Trial] | None = None,
    keep: Callable[[Entry], bool] = lambda entry: True,
    *,
    repeats: Repeats = None,
    scene: Only = None,
) -> Plan:
    """Plan the measurements: in each round, one fresh process, every solver has its turn.

    Parameters
    ----------
    request : Request
    scenes : list of Trial or None
        None: all.
    keep : callable
        Entry -> bool: which of them to run.
    repeats : int or None
        Rounds.
    scene : str or None
        Name of the one scene that is run; None: all.
    """
    rounds = repeats or (QUICK_REPEATS if request.quick else REPEATS)
    all_trials = scenes or [*trials(), *problem_trials()]
    scenes = [trial for trial in all_trials if scene in (None, trial.name)]
    if not scenes:
        raise SettingError(
            f"--scene {scene}: no such scene; give one of {', '.join(trial.name for trial in all_trials)}"
        )
    measured = [(entry, []) for entry in entries(scenes, request.engines, request.quick) if keep(entry)]
    loads = []
    for turn in range(rounds):
        loads += yield Batch([Case(scenes[0].scene, tag={"round": turn})], load, "load", alone=True)
        cases = [entry.case(turn) for entry, _ in measured]
        done = yield Batch(cases, measure, f"round {turn + 1} of {rounds}", alone=True)
        for (_, rows), row in zip(measured, done, strict=True):
            rows.append(row)
    settings = {
        "quick": request.quick,
        "rounds": rounds,
        "load": [load.cost["load"] for load in loads],
        "scenes": {trial.name: description(trial) for trial in scenes},
        "variants": [
            variant_settings(engine, variant, levels_of(kind, request.quick))
            for engine in request.engines
            for variant, kind in get_engine(engine).variants.items()
        ],
    }
    return Computed(settings, [_row(entry, timings) for entry, timings in measured])


def _row(entry, timings):
    """Return the JSON-ready row of an entry from its rounds: CPU times are medians, with lowest and highest."""
    first, trial = timings[0], entry.trial
    values = first.values
    row = {
        "part": "work-precision",
        "scene": trial.name,
        "engine": entry.engine,
        "variant": entry.variant,
        "model": entry.model,
        "law": trial.scene.bearings and trial.scene.bearings.law,
        "parameter": entry.parameter,
        "level": entry.level,
        "outcome": values.get("outcome"),
        "failure": _evidence(first.failure),
        "timings": len(timings),
        "errors": {},
        "lost": None,
        "repeatable": len({json.dumps(timing.values, sort_keys=True) for timing in timings}) == 1,
    }
    seconds = [timing.cost["cpu_seconds"] for timing in timings if timing.cost.get("cpu_seconds")]
    if first.failure or not seconds:
        return row
    measured = dict(values["errors"]) if "errors" in values else errors(trial, values, values["boundary_shifts"])
    cpu, simulated, steps = statistics.median(seconds), values["end"]["time"], values["steps"]
    return row | {
        "lost": measured.pop("lost"),
        "errors": measured,
        "cpu_seconds": cpu,
        "cpu_low": min(seconds),
        "cpu_high": max(seconds),
        "simulated": simulated,
        "steps": steps or None,
        "step": simulated / steps if steps else None,
        "cpu_per_second": cpu / simulated,
        "cpu_per_step": cpu / steps if steps else None,
        "boundary_shifts": values["boundary_shifts"],
        "settings": values["settings"],
    }


def _evidence(failure):
    if failure is None:
        return None
    return {key: str(failure[key])[:EVIDENCE] for key in ("kind", "reason", "message") if failure.get(key)}


def description(trial: Trial) -> dict[str, Any]:
    """Describe a trial for the result file; a problem by its title and measures only.

    reference_difference: errors of an independent solution, scipy DOP853 at its tightest. bouc_wen: what that law
    changes in the scene itself, relative; None without bearings.
    """

    if trial.name in PROBLEMS:
        title = f"{trial.name}, {PROBLEMS[trial.name].impacts} impacts"
        return {"title": title, "measures": list(trial.measures), "reference_difference": {}}

    def run(scene):
        return simulate_twin(scene, rtol=TWIN_TOLERANCE, history=False, energy=False)

    reference, changes = trial.reference, None
    if trial.scene.bearings:
        other = trial.with_law("bouc-wen").reference
        changes = {
            "peak_displacement": other.peak_base_displacement / reference.peak_base_displacement - 1,
            "peak_tilt": other.peak_tilt / reference.peak_tilt - 1 if reference.peak_tilt else None,
        }
    response, shifts, _ = searched(run, trial.scene, trial.boundary)
    return {
        "title": trial.scene.name,
        "duration": trial.scene.duration,
        "runs": RUNS if trial.boundary else 1,
        "measures": list(trial.measures),
        "outcome": reference.outcome,
        "impacts": len(reference.impacts),
        "slenderness": trial.scene.block.slenderness,
        "peak_tilt_ratio": reference.peak_tilt_ratio,
        "peak_base_displacement": reference.peak_base_displacement,
        "digest": trial.scene.digest(),
        "boundary_amplitude": trial.boundary and trial.boundary.amplitude,
        "reference_difference": errors(trial, response.to_json(), shifts),
        "bouc_wen": changes,
    }
