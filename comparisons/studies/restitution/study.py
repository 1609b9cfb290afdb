"""The restitution study: blocks released from rest, in every engine, variant and level.

There are four parts: the grid (slenderness x base x level), blocks on bearings, released or under a pulse (slenderness
x base x isolation period, laws in turn), experiments that change one suspected cause of error at a time, and the first
impact of a block, taken apart. Each run is measured at its first impacts; rows hold the errors of each cell, each level
and each experiment.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from analytic import Base, Bearings, Block, PulseMotion, Response, Scene, Start, simulate
from analytic.checks.twin import Event
from analytic.rocking import (
    RockingModel,
    base_jump_length,
    base_jump_length_as_printed,
    momentum_restitution,
    restitution,
)
from analytic.scene import BASE, BEARINGS, MASS, RADIUS
from engines import get_engine
from engines.contract import Variant

from ...execution.cases import Case, variant_settings
from ...execution.plan import Batch, Computed, Plan, Request
from ...execution.sweep import Row
from ...metrics.autopsy import CAUSES, LEAST, diagnosis
from ...metrics.errors import SLOWEST_IMPACT, impact_errors, lost_impacts, rms, strong_impacts, worst
from ...schemas.columns import declared, flag_of, number_of, table_of, whole_of, word_of
from ..rows import SHARED

# The columns of its rows, and by part which of them a row has; see `comparisons.studies.rows`.
COLUMNS = SHARED | declared(
    number_of("ratio", "base mass over block mass", "base mass over block mass; null: rigid ground"),
    word_of("scope", "scope", 'what a summary covers: "all" cells at the default level, or the "levels"'),
    whole_of("impacts", "impacts", "strong impacts with a known error"),
    number_of(
        "bias", "mean error by swings", "error of restitution by swing energies, e less eq. (7): mean over impacts"
    ),
    number_of(
        "rms",
        "error of restitution by swings, rms",
        "error of restitution by swing energies: root mean square over impacts",
    ),
    number_of("worst", "worst impact by swings", "error of restitution by swing energies: largest absolute value"),
    number_of(
        "rms_state",
        "error of restitution by states, rms",
        "error of restitution by the states at impacts: root mean square",
    ),
    number_of(
        "worst_state", "worst impact by states", "error of restitution by the states at impacts: largest absolute value"
    ),
    word_of("factor", "factor", 'what blocks on bearings have in common, or "all"'),
    number_of("of", "value", "value of that factor", "rad, 1 or s", type="number or word"),
    number_of(
        "jump_rms",
        "base velocity jump, relative error, rms",
        "error of the base's velocity jump against momentum, relative: root mean square",
    ),
    number_of(
        "jump_worst",
        "worst base velocity jump",
        "error of the base's velocity jump against momentum, relative: largest",
    ),
    number_of(
        "jump_8",
        "against (8) corrected",
        "error of the base's velocity jump against eq. (8) corrected, relative: root mean square",
    ),
    number_of(
        "jump_8_printed",
        "as printed",
        "error of the base's velocity jump against eq. (8) as printed, relative: root mean square",
    ),
    number_of("time_rms", "impact times, relative, rms", "error of impact times, relative: root mean square"),
    number_of("steps_per_second", "steps per simulated second", "steps over simulated time", "1/s", digits=3),
    number_of("order", "order by swings", "slope of log error over log accuracy parameter"),
    word_of("experiment", "experiment", "setting that is varied by itself"),
    number_of("value", "value (SI)", "value of the setting that is varied", "of the setting", digits=None),
    number_of("step", "step", "step size", "s", shown="ms"),
    number_of(
        "explained",
        "variance explained",
        "share of the error's variance that the phase within a step explains",
        digits=3,
        percent=True,
    ),
    number_of("least", "least", "lower end of the fitted sawtooth, error over step", "1/s"),
    number_of("most", "most", "upper end of the fitted sawtooth, error over step", "1/s"),
    number_of("friction", "friction there", "coefficient of friction of the variant"),
    number_of("friction_needed", "friction needed", "max |H|/N in the analytic model"),
    number_of(
        "predicted", "predicted by the damping alone", "error of restitution by damping in flight, computed", digits=3
    ),
    number_of("measured", "measured", "error of restitution that was measured", digits=3),
    whole_of("count", "count", "number of runs that failed for this reason"),
    table_of("tag", "tag", "scene of the first of these runs"),
    flag_of("best", "best", "whether the variant is its engine's main one"),
    flag_of("placed", "placed", "whether the engine says where the block's centre is"),
    number_of("error", "error of restitution", "error of restitution at the impact"),
    word_of("cause", "cause", "cause of the error in one word; null if the error is too small to have one"),
    word_of("words", "how it shows: what it is", "the cause in a sentence"),
    table_of("parts", "parts", "parts of the error by the impulses that made them; they add up to it"),
    whole_of("steps", "steps in contact", "steps during which the engine was in contact"),
    number_of(
        "energy_lost",
        "energy lost",
        "energy lost in the impact over the kinetic energy before it",
        digits=3,
        percent=True,
    ),
    table_of("frames", "frames", "what is drawn of the impact: times and values by frame"),
    number_of("deepest", "deepest penetration", "largest penetration of the landing corner", "m", shown="mm"),
    word_of("why_not", "why not", "why the impact cannot be analysed"),
)
ERRORS = """runs failed impacts lost bias? rms? worst? rms_state? worst_state? jump_rms? jump_worst? jump_8?
    jump_8_printed? time_rms? cpu_per_second? steps_per_second?"""
PARTS = {
    "cell": f"engine variant level ratio? slenderness {ERRORS}",
    "summary": f"scope engine variant ground level {ERRORS}",
    "order": "engine variant ground order?",
    "bearings": """engine variant factor of? runs failed rms_state? jump_rms? jump_worst? time_rms? cpu_per_second?
            impacts lost worst_state?""",
    "experiment": f"engine variant experiment ratio? value {ERRORS}",
    "phase": "engine variant step runs bias rms explained? least most",
    "flight damping": "engine variant friction? level slenderness friction_needed predicted measured",
    "failure": "engine variant reason count message tag",
    "why": "engine variant ground failure? | tier best placed error cause? words? parts steps energy_lost frames",
}

CARYATID_BASE = BASE.mass / MASS  # its m_b/m
# impacts used of each run; on rigid ground the slowest is about as fast as the first from a third of the tilt
IMPACTS = 3


@dataclass(frozen=True)
class Grid:
    """Scope of the study: slendernesses [rad], m_b/m (None: rigid ground), starts (tilt over slenderness).

    refined: (slenderness, m_b/m) where the accuracy parameters run through their levels. bearings: slendernesses [rad],
    m_b/m and isolation periods [s] of blocks on bearings.
    """

    slendernesses: tuple
    ratios: tuple
    starts: tuple
    refined: tuple
    phase_starts: int  # starts in the experiment on the phase of the steps
    bearings: tuple


STARTS = tuple(round(float(start), 4) for start in np.linspace(0.3, 0.8, 4))
FULL = Grid(
    (0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45),
    (None, 10.0, 1.0, 0.3, CARYATID_BASE, 0.01),
    STARTS,
    tuple((gamma, ratio) for gamma in (0.1, 0.2, 0.3, 0.45) for ratio in (None, 1.0, CARYATID_BASE)),
    48,
    ((0.15, 0.25, 0.35), (0.1, 1.0, 10.0), (1.0, 2.0, 4.0)),
)
QUICK = Grid(
    (0.1, 0.2, 0.3, 0.45),
    (None, 10.0, 1.0, CARYATID_BASE),
    STARTS,
    ((0.2, None), (0.2, CARYATID_BASE)),
    16,
    ((0.25,), (0.1, 1.0, 10.0), (2.0,)),
)
LAWS = ("algebraic", "bouc-wen", "linear")
EXCITATIONS = ("let go", "pulse")
LET_GO = 0.5  # tilt over slenderness
PULSE = (0.5, 3.0)

EXPERIMENT_SLENDERNESS = 0.2
EXPERIMENT_RATIOS = (None, CARYATID_BASE)
PHASE_STEPS = (4e-3, 1e-3, 2.5e-4)  # s
SCALES = (0.25, 1.0, 4.0)  # sizes of the block, to tell (8) from (8) as printed

# The block whose first impact is taken apart: tilt over slenderness; duration [s], past the swing after that impact.
IMPACT_START, IMPACT_SECONDS = 0.6, 1.6
GROUNDS = {"rigid ground": None, "sliding base": Base(mass=BASE.mass)}


def free_scene(slenderness: float, ratio: float | None, start: float, scale: float = 1.0) -> Scene:
    """Return a block on rigid ground or on a freely sliding base, tilted and released.

    slenderness [rad]. ratio: mass of the base over the block's; None: rigid ground. start: tilt over slenderness.
    scale: size of the block over the Caryatid's.

    The scene ends past the peak of the swing after the third impact of the model, or a little after coming to rest.
    """
    scene = Scene(
        block=Block(mass=MASS, radius=RADIUS * scale, slenderness=slenderness),
        base=Base(mass=ratio * MASS) if ratio else None,
        start=Start(tilt=start * slenderness),
        duration=12.0 * math.sqrt(scale),
    )
    return _cut(scene, [impact.time for impact in simulate(scene, history=False).impacts], 0.2 * math.sqrt(scale))


def _cut(scene, times, rest):
    """Shorten a scene: it ends past the swing after impact number `IMPACTS`, or `rest` [s] after the last impact."""
    if len(times) > IMPACTS:
        before, after = times[IMPACTS - 1 : IMPACTS + 1]
        return scene.with_(duration=before + 0.75 * (after - before))
    return scene.with_(duration=times[-1] + rest)


def bearing_scene(slenderness: float, ratio: float, period: float, law: str, excitation: str) -> Scene:
    """Return the Caryatid's block with a slenderness, on bearings of a period [s] at the stiffness after yielding.

    It is released at `LET_GO`, with the ground at rest or under a pulse. `PULSE` holds the pulse's amplitude over g
    tan(slenderness) and its frequency over omega_r. The scene ends as in `free_scene`.
    """
    base = Base(mass=ratio * MASS)
    kb = (MASS + base.mass) * (2 * math.pi / period) ** 2 / BEARINGS.count
    softening = {} if law == "linear" else {"kb": kb, "alpha": BEARINGS.alpha}
    ka = kb if law == "linear" else kb * BEARINGS.ka / BEARINGS.kb
    scene = Scene(
        block=Block(mass=MASS, radius=RADIUS, slenderness=slenderness),
        base=base,
        bearings=Bearings(law=law, count=BEARINGS.count, ka=ka, **softening),
        start=Start(tilt=LET_GO * slenderness),
        duration=12.0,
    )
    if excitation == "pulse":
        amplitude, frequency = PULSE[0] * scene.gravity * math.tan(slenderness), PULSE[1] * scene.rocking_frequency
        scene = scene.with_(motion=PulseMotion("one-sine", amplitude, frequency, 0.0))
    return _cut(scene, [impact.time for impact in strong_impacts(simulate(scene, history=False))], 0.2)


def bearing_cases(grid: Grid, engines: Sequence[str]) -> Iterator[Case]:
    """Yield blocks on bearings at default levels; the laws take turns, so each is combined with all other values."""
    for places in product(*map(enumerate, grid.bearings)):
        ranks, (slenderness, ratio, period) = zip(*places, strict=True)
        law = LAWS[sum(ranks) % len(LAWS)]
        for excitation in EXCITATIONS:
            scene = bearing_scene(slenderness, ratio, period, law, excitation)
            place = {"slenderness": slenderness, "ratio": ratio, "period": period, "law": law}
            for engine, variant, _ in variants_of(engines):
                yield Case(scene, engine, variant, {}, {"part": "bearings", **place, "excitation": excitation})


def impact_scene(ground: str) -> Scene:
    """Return the block whose first impact is taken apart, released on a ground of `GROUNDS`."""
    scene = free_scene(EXPERIMENT_SLENDERNESS, None, IMPACT_START)
    return scene.with_(name="one impact", base=GROUNDS[ground], duration=IMPACT_SECONDS)


def impact_cases(engines: Sequence[str], grounds: Iterable[str]) -> Iterator[Case]:
    """Yield the block of `impact_scene` in every variant, tagged with the ground."""
    for (engine, variant, _), ground in product(variants_of(engines), grounds):
        yield Case(impact_scene(ground), engine, variant, tag={"ground": ground})


def variants_of(engines: Sequence[str]) -> list[tuple[str, str, Variant]]:
    """Return (engine, name, record) of every variant."""
    return [(engine, name, kind) for engine in engines for name, kind in get_engine(engine).variants.items()]


# s, fixed steps at which every variant with a fixed step is run, beside its own levels: a game's frame, to a fine one
STEPS = {"1/60 s": 1 / 60, "1/240 s": 1 / 240, "1 ms": 1e-3, "1/4000 s": 2.5e-4, "0.1 ms": 1e-4}


def levels_run(kind: Variant) -> list[float]:
    """Return the values of a variant's accuracy parameter that are run: its levels, and `STEPS` where it is a step."""
    return sorted({*kind.levels, *(STEPS.values() if kind.accuracy_parameter == "step" else ())})


def grid_cases(grid: Grid, engines: Sequence[str]) -> Iterator[Case]:
    """Yield the cases of the grid, tagged with part, ratio, slenderness, start and level."""
    for ratio in grid.ratios:
        for slenderness in grid.slendernesses:
            scenes = {start: free_scene(slenderness, ratio, start) for start in grid.starts}
            for engine, variant, kind in variants_of(engines):
                for level in levels_run(kind) if (slenderness, ratio) in grid.refined else (kind.default,):
                    settings = {} if level == kind.default else {kind.accuracy_parameter: level}
                    for start, scene in scenes.items():
                        tag = {"ratio": ratio, "slenderness": slenderness, "start": start, "level": level}
                        yield Case(scene, engine, variant, settings, {"part": "grid", **tag})


def experiments_of(engines: Sequence[str]) -> list[tuple[str, str, str, str, tuple[float, ...]]]:
    """Return (name, engine, variant, setting, values) of the settings that variants say to change one at a time."""
    return [
        (setting.replace("_", " "), engine, variant, setting, values)
        for engine, variant, kind in variants_of(engines)
        for setting, values in kind.varied.items()
    ]


def experiment_cases(grid: Grid, engines: Sequence[str]) -> Iterator[Case]:
    """Yield cases that change one suspected cause.

    They are tagged with part, experiment, ratio, slenderness, start and value.
    """

    def case(name, ratio, start, value, engine, variant, settings, scale=1.0):
        tag = {"ratio": ratio, "slenderness": EXPERIMENT_SLENDERNESS, "start": start, "value": value}
        scene = free_scene(EXPERIMENT_SLENDERNESS, ratio, start, scale)
        return Case(scene, engine, variant, settings, {"part": "experiment", "experiment": name, **tag})

    for name, engine, variant, setting, values in experiments_of(engines):
        for ratio in EXPERIMENT_RATIOS:
            for start in grid.starts[::2]:
                for value in values:
                    yield case(name, ratio, start, value, engine, variant, {setting: value})
    # The phase is studied where one fixed step decides the impact. The starts are so close together that all impacts
    # lie within the longest step.
    for engine, variant, spec in variants_of(engines):
        if spec.kind == "tuned" and spec.accuracy_parameter == "step":
            for start in map(float, np.linspace(0.600, 0.604, grid.phase_starts)):
                for step in PHASE_STEPS:
                    yield case("phase", None, start, step, engine, variant, {"step": step})
    for engine in engines:
        for scale in SCALES:
            yield case("size", CARYATID_BASE, 0.6, scale, engine, get_engine(engine).default_variant, {}, scale)


FACTORS = ("slenderness", "ratio", "period", "law", "excitation")  # factors of blocks on bearings
DIGITS = 4
EXACT = ("level", "value", "ratio", "slenderness", "step", "tag", "last_state")  # not rounded


def measure(case: Case, response: Response) -> dict[str, Any]:
    """Measure one run: the errors of its first `IMPACTS` impacts, and the times [s] of the model's.

    The error "late" is the time of an impact over the model's, less 1.
    """
    errors = impact_errors(case.scene, response, IMPACTS)
    reference = simulate(case.scene, history=False)
    model = [impact.time for impact in strong_impacts(reference)[:IMPACTS]]
    late = [time / expected - 1 for time, expected in zip(errors["time"], model, strict=False)]
    return {
        "outcome": response.outcome,
        "end": response.end.time,
        "steps": response.steps,
        "model": model,
        "lost": lost_impacts(response, reference),
        "errors": {**errors, "late": late},
    }


def taken_apart(case: Case, response: Response) -> dict[str, Any]:
    """Return the `diagnosis` of the first impact; the run is made once more, for its steps."""
    return diagnosis(case.solver, case.variant, case.scene)


def plan(request: Request, grid: Grid | None = None) -> Plan:
    """Plan the study.

    grid: what to cover, in place of FULL or QUICK. A quick study takes impacts apart on rigid ground only.

    Rows of the part "why" hold the `diagnosis` or the failure, and the ground.
    """
    grid = grid or (QUICK if request.quick else FULL)
    cases = [
        *grid_cases(grid, request.engines),
        *bearing_cases(grid, request.engines),
        *experiment_cases(grid, request.engines),
    ]
    runs = yield Batch(cases, measure, "restitution", time_limit=60.0)
    grounds = list(GROUNDS)[: 1 if request.quick else None]
    impacts = yield Batch([*impact_cases(request.engines, grounds)], taken_apart, "one impact", time_limit=60.0)
    cells = _grouped(runs, "grid", "level", "ratio", "slenderness")
    experiments = _grouped(runs, "experiment", "experiment", "ratio", "value")
    phases = {key: members for key, members in experiments.items() if key[2] == "phase"}
    phase_rows, arrays = _phases(phases)
    rows = [
        *(_row("cell", _columns_of(key, "level", "ratio", "slenderness"), members) for key, members in cells.items()),
        *_summaries(cells, request.engines, grid),
        *_on_bearings(runs),
        *(
            _row("experiment", _columns_of(key, "experiment", "ratio", "value"), members)
            for key, members in experiments.items()
            if key not in phases
        ),
        *phase_rows,
        *_flight_damping(cells),
        *_failures(runs),
    ]
    settings = {"quick": request.quick, **_settings(grid, request.engines)}
    return Computed(settings, [*map(_rounded, rows), *map(_impact_row, impacts)], arrays)


def _impact_row(run):
    """Row of an impact that was taken apart."""
    values = {} if run.failed else run.values
    identity = {"part": "why", "engine": run.case.solver, "variant": run.case.variant}
    return {**identity, **run.case.tag, "failure": run.failure, **values}


def _grouped(runs, part, *tags):
    """Return {(engine, variant, tags ...): runs} of a part."""
    groups: dict[tuple, list] = {}
    for run in runs:
        if run.case.tag["part"] == part:
            key = (run.case.solver, run.case.variant, *(run.case.tag[tag] for tag in tags))
            groups.setdefault(key, []).append(run)
    return groups


def _columns_of(key, *tags):
    return dict(zip(("engine", "variant", *tags), key, strict=True))


def _settings(grid, engines):
    scenes = {(ratio, gamma): free_scene(gamma, ratio, 0.6) for ratio in grid.ratios for gamma in grid.slendernesses}
    return {
        "slendernesses": grid.slendernesses,
        "ratios": grid.ratios,
        "starts": grid.starts,
        "impacts": IMPACTS,
        "slowest_impact": SLOWEST_IMPACT,
        "mass": MASS,
        "radius": RADIUS,
        "engines": engines,
        "variants": [variant_settings(engine, variant) for engine, variant, _ in variants_of(engines)],
        "default_variants": {engine: get_engine(engine).default_variant for engine in engines},
        "experiments": [
            _columns_of(experiment[1:4], "setting") | {"experiment": experiment[0]}
            for experiment in experiments_of(engines)
        ],
        "experiment_slenderness": EXPERIMENT_SLENDERNESS,
        "why": {"slenderness": EXPERIMENT_SLENDERNESS, "start": IMPACT_START, "least": LEAST, "causes": CAUSES},
        "bearings": dict(zip(("slendernesses", "ratios", "periods"), grid.bearings, strict=True)),
        "friction_needed": {
            ground: friction_needed(free_scene(EXPERIMENT_SLENDERNESS, ratio, 0.6))
            for ground, ratio in zip(GROUNDS, (None, CARYATID_BASE), strict=True)
        },
        "formulas": [
            {
                "ratio": ratio,
                "slenderness": gamma,
                "restitution": momentum_restitution(scene),
                "jump_length": base_jump_length(scene),
                "jump_length_printed": base_jump_length_as_printed(scene),
            }
            for (ratio, gamma), scene in scenes.items()
        ],
    }


def _sound(runs):
    return [run for run in runs if not run.failed]


def _errors(runs, name):
    """Array of the known errors of all impacts of some runs."""
    errors = np.array([error for run in runs for error in run.values["errors"].get(name, ())], dtype=float)
    return errors[np.isfinite(errors)]


def _row(part, key, runs):
    """Row of errors, counts and costs of some runs; key: the columns that say which runs."""
    sound = _sound(runs)
    simulated = sum(run.values["end"] for run in sound)

    def of(name: str, measure: Callable[[np.ndarray], float]) -> float | None:
        values = _errors(sound, name)
        return float(measure(values)) if len(values) else None

    def per_second(amounts: Sequence[float]) -> float | None:
        return sum(amounts) / simulated if simulated else None

    return {
        "part": part,
        **key,
        "runs": len(runs),
        "failed": len(runs) - len(sound),
        "impacts": len(_errors(sound, "state")),
        "lost": sum(run.values["lost"] for run in sound),
        "bias": of("swing", np.mean),
        "rms": of("swing", rms),
        "worst": of("swing", worst),
        "rms_state": of("state", rms),
        "worst_state": of("state", worst),
        "jump_rms": of("jump", rms),
        "jump_worst": of("jump", worst),
        "jump_8": of("jump_8", rms),
        "jump_8_printed": of("jump_8_printed", rms),
        "time_rms": of("late", rms),
        "cpu_per_second": per_second([run.cost["cpu_seconds"] for run in sound]),
        "steps_per_second": per_second([run.values["steps"] for run in sound]),
    }


def _summaries(cells, engines, grid):
    """Rows of all cells of a variant together, by ground: at its default level, and at each of its levels.

    A row of the part "order" holds the slope of log error over log accuracy parameter along the levels.
    """
    for engine, variant, kind in variants_of(engines):
        for ground in GROUNDS:
            key = {"engine": engine, "variant": variant, "ground": ground}
            runs_at = {
                (level, gamma, ratio): runs
                for (*pair, level, ratio, gamma), runs in cells.items()
                if pair == [engine, variant] and (ratio is None) == (GROUNDS[ground] is None)
            }
            everywhere = [run for (level, *_), runs in runs_at.items() if level == kind.default for run in runs]
            if everywhere:
                yield _row("summary", {"scope": "all", **key, "level": kind.default}, everywhere)
            points = []
            for level in levels_run(kind):
                runs = [run for (run_level, *place), runs in runs_at.items() for run in runs
                        if run_level == level and tuple(place) in grid.refined]  # fmt: skip
                if runs:
                    points.append(_row("summary", {"scope": "levels", **key, "level": level}, runs))
            yield from points
            errors = [(row["level"], row["rms"]) for row in points if row["rms"] and row["level"] in kind.levels]
            steps, sizes = np.log(np.transpose(errors)) if errors else ((), ())
            order = float(np.polyfit(steps, sizes, 1)[0]) if len(errors) > 1 else None
            yield {"part": "order", **key, "order": order}


def _on_bearings(runs):
    """Rows of errors by states on bearings: one of all runs of a variant, and one for each value of each factor."""
    for (engine, variant), members in _grouped(runs, "bearings").items():
        groups = {("all", None): members}
        for factor in FACTORS:
            for run in members:
                groups.setdefault((factor, run.case.tag[factor]), []).append(run)
        for (factor, value), group_runs in groups.items():
            row = _row("bearings", {"engine": engine, "variant": variant, "factor": factor, "of": value}, group_runs)
            yield {key: row[key] for key in BEARING_COLUMNS}


BEARING_COLUMNS = (
    "part", "engine", "variant", "factor", "of", "runs", "failed", "impacts", "lost", "rms_state", "worst_state",
    "jump_rms", "jump_worst", "time_rms", "cpu_per_second",
)  # fmt: skip


def _phases(groups):
    """Rows and arrays of the error of the first impact over where in the step the model's impact falls.

    There is one row for each engine, variant and step.

    `explained`: share of the error's variance that a sawtooth of that phase explains; `least`, `most`: its ends,
    error over step [1/s].
    """
    rows, arrays = [], {}
    for (engine, variant, _, _, step), runs in groups.items():
        sound = [run for run in _sound(runs) if run.values["errors"].get("swing")]
        if len(sound) < 3:  # too few to fit; failures have rows of their own
            continue
        phase = np.array([run.values["model"][0] / step % 1.0 for run in sound])
        error = np.array([run.values["errors"]["swing"][0] for run in sound], dtype=float)
        fits = []
        for cut in np.sort(phase):
            basis = np.column_stack([np.ones(len(phase)), (phase - cut) % 1.0])
            constants = np.linalg.lstsq(basis, error, rcond=None)[0]
            fits.append((float(np.sum((error - basis @ constants) ** 2)), constants))
        left, (begin, rise) = min(fits, key=lambda fit: fit[0])
        key = f"phase/{engine}/{variant}/{step:g}"
        arrays[f"{key}/phase"], arrays[f"{key}/error"] = phase, error
        ends = sorted((float(begin / step), float((begin + rise) / step)), key=abs)
        rows.append(
            {
                "part": "phase",
                "engine": engine,
                "variant": variant,
                "step": step,
                "runs": len(runs),
                "bias": float(error.mean()),
                "rms": rms(error),
                "explained": 1 - left / float(np.sum((error - error.mean()) ** 2)),
                "least": ends[0],
                "most": ends[1],
            }
        )
    return rows, arrays


def _flight_damping(cells):
    """Rows of damping in flight as the cause of a variant's error on rigid ground: predicted beside measured."""
    for (engine, variant, level, ratio, gamma), runs in cells.items():
        kind, sound = get_engine(engine).variants[variant], _sound(runs)
        measured = _errors(sound, "swing")
        if kind.flight_damping is not None and ratio is None and len(measured):
            predicted = [damped_error(run.case.scene, kind.flight_damping) for run in sound]
            yield {
                "part": "flight damping",
                "engine": engine,
                "variant": variant,
                "friction": kind.friction,
                "level": level,
                "slenderness": gamma,
                "friction_needed": friction_needed(runs[0].case.scene),
                "predicted": float(np.mean(np.concatenate(predicted))),
                "measured": float(measured.mean()),
            }


def damped_error(scene: Scene, damping: float) -> np.ndarray:
    """Error of restitution by swing energies of a block on rigid ground that is damped in flight; shape (impacts,).

    J_O phi'' = -m g R sin(gamma - phi) - d phi' [J_O + (m R^3 + I_c) |phi'|], d = damping [1/s]; impacts by eq. (7).
    """
    block = scene.block
    p2, gamma, e = scene.rocking_frequency**2, block.slenderness, restitution(scene)
    quadratic = (block.mass * block.radius**3 + block.centre_inertia) / block.inertia

    def fall(t, y):
        return y[1], -p2 * math.sin(gamma - y[0]) - damping * y[1] * (1 + quadratic * abs(y[1]))

    def landing(t, y):
        return y[0]

    def peak(t, y):
        return y[1]

    tilt, energies = abs(scene.start.tilt), []
    for _ in range(IMPACTS + 1):
        energies.append(math.cos(gamma - tilt) - math.cos(gamma))
        down = solve_ivp(fall, (0, 30), (tilt, 0.0), events=Event(landing), rtol=1e-9, atol=1e-12)
        up = solve_ivp(fall, (0, 30), (1e-12, -e * down.y[1, -1]), events=Event(peak), rtol=1e-9, atol=1e-12)
        tilt = up.y[0, -1]
    energy = np.array(energies)
    return np.sqrt(energy[1:] / energy[:-1]) - e


def friction_needed(scene: Scene) -> float:
    """Return the friction that an impact of the model needs: horizontal over vertical impulse on the block.

    Centre of mass: before, velocity (h, -b) |w|, after, (e h, e b) |w|, less the base's jump.
    """
    model, block = RockingModel.of(scene), scene.block
    after, jump = model.impact(-1.0)
    horizontal = block.half_height * (1 + after) - abs(jump)
    return abs(horizontal) / (block.half_width * (1 - after))


def _failures(runs: Sequence[Row]) -> Iterator[dict[str, Any]]:
    """Rows of each distinct reason of failure, with its count, one message and where it first happened."""
    failed: dict[tuple, list[Row]] = {}
    for run in runs:
        if run.failed:
            failed.setdefault((run.case.solver, run.case.variant, run.failure["reason"]), []).append(run)
    for key, (first, *others) in failed.items():
        yield {
            "part": "failure",
            **_columns_of(key, "reason"),
            "count": 1 + len(others),
            "message": first.failure["message"],
            "tag": first.case.tag,
            "last_state": first.failure.get("last_state"),
        }


def _rounded(row):
    """Round the numbers of a row to `DIGITS` significant digits, but for the coordinates of the grid."""
    return {
        key: float(f"{value:.{DIGITS}g}")
        if isinstance(value, float) and key not in EXACT and math.isfinite(value)
        else value
        for key, value in row.items()
    }
