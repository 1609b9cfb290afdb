"""From the runs of the restitution study to its result: errors of each cell, each setting and each experiment."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.integrate import solve_ivp

from analytic import simulate
from analytic.caryatid import MASS, RADIUS
from analytic.rocking import RockingModel, base_jump_length, base_jump_length_as_printed, restitution
from analytic.twin.run import Event
from engines import get_engine

from ...measuring.errors import SLOWEST_IMPACT, impact_errors, rms, strong_impacts, worst
from ...running.study import Batch, Found
from .cases import (
    CARYATID_BASE,
    EXPERIMENT_SLENDERNESS,
    FULL,
    IMPACTS,
    QUICK,
    SCALES,
    experiment_cases,
    experiments_of,
    free_scene,
    grid_cases,
    knob_of,
    variants_of,
)

if TYPE_CHECKING:
    from analytic import Response, Scene

    from ...running.cases import Case
    from ...running.study import Ask, Plan
    from ...running.sweep import Row
    from .cases import Grid

GROUNDS = ("rigid ground", "sliding base")
DIGITS = 4


def measure(case: Case, response: Response) -> dict[str, Any]:
    """What is measured in one run: the errors of its first `IMPACTS` impacts."""
    return {
        "outcome": response.outcome,
        "end": response.end.time,
        "steps": response.steps,
        "errors": impact_errors(case.scene, response, IMPACTS),
    }


def plan(ask: Ask, grid: Grid | None = None) -> Plan:
    """The plan of the study; grid: what to cover, in place of FULL or QUICK."""
    grid = grid or (QUICK if ask.quick else FULL)
    cases = grid_cases(grid, ask.engines) + experiment_cases(grid, ask.engines)
    rows = yield Batch(cases, measure, "restitution", time_limit=60.0)
    return _found(grid, rows)


def _found(grid, rows):
    """The answer, from the rows of all runs."""
    engines = list(dict.fromkeys(row.case.solver for row in rows))
    cells, experiments = {}, {}
    for row in rows:
        tag = row.case.tag
        if tag["part"] == "grid":
            key = (row.case.solver, row.case.variant, tag["knob"], tag["ratio"], tag["slenderness"])
            cells.setdefault(key, []).append(row)
        else:
            key = (tag["experiment"], row.case.solver, row.case.variant, tag["ratio"], tag["value"])
            experiments.setdefault(key, []).append(row)
    pooled = {key: _Pool(members) for key, members in cells.items()}
    entries = [_cell(key, pool) for key, pool in pooled.items()]
    entries += _summaries(pooled, engines, grid)
    phases = {(*key[1:3], key[-1]): members for key, members in experiments.items() if key[0] == "phase"}
    entries += [_experiment(key, _Pool(members)) for key, members in experiments.items() if key[0] != "phase"]
    found, arrays = _phases(phases)
    entries += found + _flight_damping(pooled) + _failures(rows)
    return Found(_settings(grid, engines), [_short(entry) for entry in entries], arrays)


def _settings(grid, engines):
    """What was asked, for the result file."""
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
        "knobs": [
            {
                "engine": engine,
                "variant": variant,
                **dict(zip(("knob", "default", "values"), knob_of(engine, variant), strict=True)),
                "applies_impact": get_engine(engine).variants[variant].takes_restitution,
            }
            for engine, variant in variants_of(engines)
        ],
        "default_variants": {engine: get_engine(engine).default_variant for engine in engines},
        "experiments": [
            dict(zip(("experiment", "engine", "variant", "setting"), experiment[:4], strict=True))
            for experiment in experiments_of(engines)
        ],
        "experiment_slenderness": EXPERIMENT_SLENDERNESS,
        "friction_needed": {
            ground: friction_needed(free_scene(EXPERIMENT_SLENDERNESS, ratio, 0.6))
            for ground, ratio in zip(GROUNDS, (None, CARYATID_BASE), strict=True)
        },
        "formulas": [
            {
                "ratio": ratio,
                "slenderness": gamma,
                "restitution": restitution(scene),
                "jump_length": base_jump_length(scene),
                "jump_length_printed": base_jump_length_as_printed(scene),
            }
            for (ratio, gamma), scene in scenes.items()
        ],
        "printed_factors": {
            scale: free_scene(EXPERIMENT_SLENDERNESS, 1.0, 0.6, scale).block.half_height for scale in SCALES
        },
    }


class _Pool:
    """The runs of one cell, measured: arrays of all impacts together."""

    def __init__(self, members: Sequence[Row]) -> None:
        self.runs, self.members = len(members), members
        self.sound = [row for row in members if not row.failed]
        errors = [_errors(row) for row in self.sound]
        self.errors = {
            name: np.concatenate([one[name] for one in errors if name in one])
            for name in {name for one in errors for name in one}
        }
        self.expected = sum(len(_model_times(row.case.scene)) for row in self.sound)
        late = [
            one["time"][: len(times)] / times[: len(one["time"])] - 1
            for one, times in ((one, _model_times(row.case.scene)) for one, row in zip(errors, self.sound, strict=True))
        ]
        self.late = np.concatenate(late) if late else np.empty(0)
        self.cpu = sum(row.cost["cpu_seconds"] for row in self.sound)
        self.simulated = sum(row.values["end"] for row in self.sound)
        self.steps = sum(row.values["steps"] for row in self.sound)

    def get(self, name):
        values = self.errors.get(name, np.empty(0))
        return values[np.isfinite(values)]


def _errors(row):
    return {name: np.array(values, dtype=float) for name, values in row.values["errors"].items()}


def _model_times(scene):
    return np.array([impact.time for impact in strong_impacts(simulate(scene, history=False))[:IMPACTS]])


def _measures(pools):
    """Errors and cost of one or more pools together."""

    def of(name, measure):
        values = np.concatenate([pool.get(name) for pool in pools])
        return float(measure(values)) if len(values) else None

    late = np.concatenate([pool.late for pool in pools])
    simulated = sum(pool.simulated for pool in pools)
    return {
        "runs": sum(pool.runs for pool in pools),
        "failed": sum(pool.runs - len(pool.sound) for pool in pools),
        "impacts": sum(len(pool.get("swing")) for pool in pools),
        "lost": sum(pool.expected - len(pool.late) for pool in pools),
        "bias": of("swing", np.mean),
        "rms": of("swing", rms),
        "worst": of("swing", worst),
        "rms_state": of("state", rms),
        "jump_rms": of("jump", rms),
        "jump_worst": of("jump", worst),
        "jump_8": of("jump_8", rms),
        "jump_8_printed": of("jump_8_printed", rms),
        "time_rms": rms(late) if len(late) else None,
        "cpu_per_second": sum(pool.cpu for pool in pools) / simulated if simulated else None,
        "steps_per_second": sum(pool.steps for pool in pools) / simulated if simulated else None,
    }


def _cell(key, pool):
    engine, variant, value, ratio, slenderness = key
    return {
        "part": "cell",
        "engine": engine,
        "variant": variant,
        "value": value,
        "ratio": ratio,
        "slenderness": slenderness,
        **_measures([pool]),
    }


def _summaries(pooled, engines, grid):
    """All cells of a variant together, on rigid ground and on bases: at its default, and at each step of its ladder.

    A row "order" holds the slope of log error over log knob value along the ladder.
    """
    entries = []
    for engine, variant in variants_of(engines):
        _, default, values = knob_of(engine, variant)
        for ground in GROUNDS:

            def pools(value, where, one=(engine, variant), ground=ground):
                return [
                    pool
                    for key, pool in pooled.items()
                    if key[:3] == (*one, value)
                    and (key[3] is None) == (ground == GROUNDS[0])
                    and (where is None or (key[4], key[3]) in where)
                ]

            given = {"engine": engine, "variant": variant, "ground": ground}
            everywhere = pools(default, None)
            if everywhere:
                entries.append({"part": "summary", "scope": "all", **given, "value": default, **_measures(everywhere)})
            ladder = [
                {"part": "summary", "scope": "ladder", **given, "value": value, **_measures(points)}
                for value in values
                if (points := pools(value, grid.ladder))
            ]
            points = [(row["value"], row["rms"]) for row in ladder if row["rms"]]
            steps, errors = np.log(np.transpose(points)) if points else ((), ())
            order = np.polyfit(steps, errors, 1)[0] if len(points) > 1 else None
            entries += [*ladder, {"part": "order", **given, "order": order and float(order)}]
    return entries


def _experiment(key, pool):
    name, engine, variant, ratio, value = key
    return {
        "part": "experiment",
        "experiment": name,
        "engine": engine,
        "variant": variant,
        "ratio": ratio,
        "value": value,
        **_measures([pool]),
    }


def _phases(members):
    """Error of the first impact against where in the step the model's impact falls, by engine, variant and step.

    `explained`: share of the error's variance that a sawtooth of that phase explains; `least`, `most`: its ends,
    error over step [1/s].
    """
    entries, arrays = [], {}
    for (engine, variant, step), rows in members.items():
        sound = [row for row in rows if not row.failed and row.values["errors"].get("swing")]
        if len(sound) < 3:  # nothing to fit; the failures have rows of their own
            continue
        phase = np.array([_model_times(row.case.scene)[0] / step % 1.0 for row in sound])
        error = np.array([_errors(row)["swing"][0] for row in sound])
        fits = []
        for cut in np.sort(phase):
            basis = np.column_stack([np.ones(len(phase)), (phase - cut) % 1.0])
            constants = np.linalg.lstsq(basis, error, rcond=None)[0]
            fits.append((float(np.sum((error - basis @ constants) ** 2)), constants))
        left, (begin, rise) = min(fits, key=lambda fit: fit[0])
        key = f"phase/{engine}/{variant}/{step:g}"
        arrays[f"{key}/phase"], arrays[f"{key}/error"] = phase, error
        ends = sorted((float(begin / step), float((begin + rise) / step)), key=abs)
        entries.append(
            {
                "part": "phase",
                "engine": engine,
                "variant": variant,
                "step": step,
                "runs": len(rows),
                "bias": float(error.mean()),
                "rms": rms(error),
                "explained": 1 - left / float(np.sum((error - error.mean()) ** 2)),
                "least": ends[0],
                "most": ends[1],
            }
        )
    return entries, arrays


def _flight_damping(pooled):
    """Damping in flight as the cause of a variant's error on rigid ground: predicted beside measured."""
    entries = []
    for key, pool in pooled.items():
        kind = get_engine(key[0]).variants[key[1]]
        if kind.flight_damping is None or key[3] is not None:
            continue
        predicted = [damped_error(row.case.scene, kind.flight_damping) for row in pool.sound]
        if predicted and len(pool.get("swing")):
            entries.append(
                {
                    "part": "flight damping",
                    "engine": key[0],
                    "variant": key[1],
                    "friction": kind.friction,
                    "value": key[2],
                    "slenderness": key[4],
                    "friction_needed": friction_needed(pool.members[0].case.scene),
                    "predicted": float(np.mean(np.concatenate(predicted))),
                    "measured": float(pool.get("swing").mean()),
                }
            )
    return entries


def damped_error(scene: Scene, damping: float) -> np.ndarray:
    """Error of restitution by swing energies, shape (impacts,), of a block on rigid ground that is damped in flight.

    J_O phi'' = -m g R sin(gamma - phi) - d phi' [J_O + (m R^3 + I_c) |phi'|], d = damping [1/s]; impacts by eq. (7).
    """
    block = scene.block
    p2, gamma, e = scene.rocking_frequency**2, block.slenderness, max(restitution(scene), 0.0)
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


def _failures(rows):
    """Each distinct reason of failure with its count, one message and where it first happened."""
    failed = {}
    for row in rows:
        if row.failed:
            key = (row.case.solver, row.case.variant, row.failure["reason"])
            failed.setdefault(key, []).append(row)
    return [
        {
            "part": "failure",
            "engine": key[0],
            "variant": key[1],
            "reason": key[2],
            "count": len(members),
            "message": members[0].failure["message"],
            "tag": members[0].case.tag,
            "last_state": members[0].failure.get("last_state"),
        }
        for key, members in failed.items()
    ]


def _short(entry):
    """Numbers to `DIGITS` significant digits, but for the coordinates of the grid."""
    exact = ("value", "ratio", "slenderness", "step", "tag", "last_state")
    return {
        key: float(f"{value:.{DIGITS}g}")
        if isinstance(value, float) and key not in exact and math.isfinite(value)
        else value
        for key, value in entry.items()
    }
