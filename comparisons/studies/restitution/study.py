"""The restitution study: what is measured in a run, and rows of errors of each cell, each level and each experiment."""

import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from analytic import Response, Scene, simulate
from analytic.caryatid import MASS, RADIUS
from analytic.rocking import (
    RockingModel,
    base_jump_length,
    base_jump_length_as_printed,
    momentum_restitution,
    restitution,
)
from analytic.twin import Event
from engines import get_engine

from ...measuring.autopsy import CAUSES, LEAST, diagnosis
from ...measuring.errors import SLOWEST_IMPACT, impact_errors, lost_impacts, rms, strong_impacts, worst
from ...running.cases import Case, variant_settings
from ...running.plan import Batch, Computed, Plan, Request
from ...running.sweep import Row
from .cases import (
    CARYATID_BASE,
    EXPERIMENT_SLENDERNESS,
    FULL,
    GROUNDS,
    IMPACT_START,
    IMPACTS,
    QUICK,
    Grid,
    bearing_cases,
    experiment_cases,
    experiments_of,
    free_scene,
    grid_cases,
    impact_cases,
    variants_of,
)

FACTORS = ("slenderness", "ratio", "period", "law", "excitation")  # of blocks on bearings
DIGITS = 4
EXACT = ("level", "value", "ratio", "slenderness", "step", "tag", "last_state")  # not rounded


def measure(case: Case, response: Response) -> dict[str, Any]:
    """What is measured in one run: the errors of its first `IMPACTS` impacts, and when the model's are [s].

    Error "late": time of an impact over the model's, less 1.
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
    """The `diagnosis` of the first impact; the run is made once more, for its steps."""
    return diagnosis(case.solver, case.variant, case.scene)


def plan(request: Request, grid: Grid | None = None) -> Plan:
    """The plan of the study; grid: what to cover, in place of FULL or QUICK; quick: impacts apart on rigid ground only.

    Rows of the part "why": `diagnosis`, or the failure, with the ground.
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
        *(_row("cell", _named(key, "level", "ratio", "slenderness"), members) for key, members in cells.items()),
        *_summaries(cells, request.engines, grid),
        *_on_bearings(runs),
        *(
            _row("experiment", _named(key, "experiment", "ratio", "value"), members)
            for key, members in experiments.items()
            if key not in phases
        ),
        *phase_rows,
        *_flight_damping(cells),
        *_failures(runs),
    ]
    settings = {"quick": request.quick, **_settings(grid, request.engines)}
    return Computed(settings, [*map(_short, rows), *map(_why, impacts)], arrays)


def _why(run):
    """The row of an impact that was taken apart."""
    found = {} if run.failed else run.values
    own = {"part": "why", "engine": run.case.solver, "variant": run.case.variant}
    return {**own, **run.case.tag, "failure": run.failure, **found}


def _grouped(runs, part, *tags):
    """{(engine, variant, tags ...): runs} of a part."""
    groups: dict[tuple, list] = {}
    for run in runs:
        if run.case.tag["part"] == part:
            key = (run.case.solver, run.case.variant, *(run.case.tag[tag] for tag in tags))
            groups.setdefault(key, []).append(run)
    return groups


def _named(key, *tags):
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
        "experiments": [_named(one[1:4], "setting") | {"experiment": one[0]} for one in experiments_of(engines)],
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
    """Errors of all impacts of some runs, those that are known."""
    found = np.array([error for run in runs for error in run.values["errors"].get(name, ())], dtype=float)
    return found[np.isfinite(found)]


def _row(part, key, runs):
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
    """All cells of a variant together, on rigid ground and on bases: at its default, and at each of its levels.

    A row "order" holds the slope of log error over log accuracy parameter along the levels.
    """
    for engine, variant, kind in variants_of(engines):
        for ground in GROUNDS:
            key = {"engine": engine, "variant": variant, "ground": ground}
            own = {
                (level, gamma, ratio): runs
                for (*pair, level, ratio, gamma), runs in cells.items()
                if pair == [engine, variant] and (ratio is None) == (GROUNDS[ground] is None)
            }
            everywhere = [run for (level, *_), runs in own.items() if level == kind.default for run in runs]
            if everywhere:
                yield _row("summary", {"scope": "all", **key, "level": kind.default}, everywhere)
            points = []
            for level in sorted(kind.levels):
                runs = [run for (one, *place), runs in own.items() for run in runs
                        if one == level and tuple(place) in grid.refined]  # fmt: skip
                if runs:
                    points.append(_row("summary", {"scope": "levels", **key, "level": level}, runs))
            yield from points
            errors = [(row["level"], row["rms"]) for row in points if row["rms"]]
            steps, sizes = np.log(np.transpose(errors)) if errors else ((), ())
            order = float(np.polyfit(steps, sizes, 1)[0]) if len(errors) > 1 else None
            yield {"part": "order", **key, "order": order}


def _on_bearings(runs):
    """Errors by states of blocks on bearings: of a variant all together, and apart for each value of each factor."""
    for (engine, variant), members in _grouped(runs, "bearings").items():
        parted = {("all", None): members}
        for factor in FACTORS:
            for run in members:
                parted.setdefault((factor, run.case.tag[factor]), []).append(run)
        for (factor, value), some in parted.items():
            row = _row("bearings", {"engine": engine, "variant": variant, "factor": factor, "of": value}, some)
            yield {key: row[key] for key in BEARING_COLUMNS}


BEARING_COLUMNS = (
    "part", "engine", "variant", "factor", "of", "runs", "failed", "impacts", "lost", "rms_state", "worst_state",
    "jump_rms", "jump_worst", "time_rms", "cpu_per_second",
)  # fmt: skip


def _phases(groups):
    """Error of the first impact against where in the step the model's impact falls, by engine, variant and step.

    `explained`: share of the error's variance that a sawtooth of that phase explains; `least`, `most`: its ends,
    error over step [1/s].
    """
    rows, arrays = [], {}
    for (engine, variant, _, _, step), runs in groups.items():
        sound = [run for run in _sound(runs) if run.values["errors"].get("swing")]
        if len(sound) < 3:  # nothing to fit; the failures have rows of their own
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
    """Damping in flight as the cause of a variant's error on rigid ground: predicted beside measured."""
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
    """Error of restitution by swing energies, shape (impacts,), of a block on rigid ground that is damped in flight.

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
    kept = np.array(energies)
    return np.sqrt(kept[1:] / kept[:-1]) - e


def friction_needed(scene: Scene) -> float:
    """Friction that an impact of the model needs: horizontal over vertical impulse on the block.

    Centre of mass: before, velocity (h, -b) |w|, after, (e h, e b) |w|, less the base's jump.
    """
    model, block = RockingModel.of(scene), scene.block
    after, jump = model.impact(-1.0)
    horizontal = block.half_height * (1 + after) - abs(jump)
    return abs(horizontal) / (block.half_width * (1 - after))


def _failures(runs: Sequence[Row]) -> Iterator[dict[str, Any]]:
    """Each distinct reason of failure with its count, one message and where it first happened."""
    failed: dict[tuple, list[Row]] = {}
    for run in runs:
        if run.failed:
            failed.setdefault((run.case.solver, run.case.variant, run.failure["reason"]), []).append(run)
    for key, (first, *others) in failed.items():
        yield {
            "part": "failure",
            **_named(key, "reason"),
            "count": 1 + len(others),
            "message": first.failure["message"],
            "tag": first.case.tag,
            "last_state": first.failure.get("last_state"),
        }


def _short(row):
    """Numbers to `DIGITS` significant digits, but for the coordinates of the grid."""
    return {
        key: float(f"{value:.{DIGITS}g}")
        if isinstance(value, float) and key not in EXACT and math.isfinite(value)
        else value
        for key, value in row.items()
    }
