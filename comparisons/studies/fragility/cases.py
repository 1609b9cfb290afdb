"""The runs behind the fragility study: a cloud of them in the analytic model, the first of it in every engine."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from analytic.rocking import RockingModel
from engines import get_engine

from ...running.cases import Case
from ...running.study import Batch, Found
from ...showing.wording import solver_name
from .cloud import DAMPING, DRAWN, PEAKS, PERIOD, RADII, SCENES, STRETCH, X_MAX, Cloud, cloud
from .effects import effects
from .fits import fits

if TYPE_CHECKING:
    from analytic import Response

    from ...running.study import Ask, Plan

CHANGE = 1e-4  # relative change of the restitution: the model's own sensitivity
ANALYTIC, SENSITIVITY = "analytic", "analytic, restitution + 1e-4"
NEAR = (1.3, 6.0)  # PGA/(g tan γ) of the runs that engines get: there verdicts are mixed
TIME_LIMIT = 60.0  # s, of an engine's run; a stiff corner that hardly lifts may take more, and fails
# runs: of the analytic model, of engines at their best, of first scripts (gross errors show in few)
FULL, QUICK = (2000, 60, 20), (200, 6, 2)
TILTS = (0.1, 0.5, 1.0)  # limit states of |tilt|/slenderness


def solvers_of(engines: Sequence[str]) -> list[tuple[str, str | None]]:
    """(engine, variant) of what is compared: every engine as it comes, None, and its first scripts."""
    return [
        *((name, None) for name in engines),
        *(
            (name, variant)
            for name in engines
            for variant, kind in get_engine(name).variants.items()
            if kind.tier == "defaults"
        ),
    ]


def low_frictions(solvers: Iterable[tuple[str, str | None]]) -> dict[str, float]:
    """{label: friction} of those of the (engine, variant) whose block may slide for it."""
    found = {}
    for name, variant in solvers:
        engine = get_engine(name)
        found[solver_name(name, variant)] = engine.variants[variant or engine.default_variant].friction
    return {label: friction for label, friction in found.items() if friction is not None}


def measure(case: Case, response: Response) -> dict[str, Any]:
    """What is kept of a run."""
    return {
        "overturns": response.outcome == "overturns",
        "tilt": response.peak_tilt_ratio,
        "displacement": response.peak_base_displacement,
        "decided": response.decided,
    }


def plan(ask: Ask, scenes: dict[str, Any] | None = None, runs: tuple[int, int, int] | None = None) -> Plan:
    """The plan of the study; an answer with one scene more each time.

    Rows by "part": "fit" (see `fits`), "effect" (of a solver, see `effects`), "cost" (CPU seconds per run), "check" and
    "failure". Arrays, float32: ``<scene>/<drawn>``, of all runs, with PGV and Sa; ``<scene>/<solver>/tilt`` and
    ``/displacement`` of the first in ``<scene>/near`` (of the model all): NaN where a run failed, the tilt infinite
    where it overturned.

    Parameters
    ----------
    ask : Ask
    scenes, runs : dict and (int, int, int), optional
        In place of `SCENES`, and of `FULL` or `QUICK`.
    """
    scenes = scenes or (dict(list(SCENES.items())[:1]) if ask.quick else SCENES)
    counts = runs or (QUICK if ask.quick else FULL)
    solvers = solvers_of(ask.engines)
    rows, arrays = [], {}
    for name, (shipped, slendernesses) in scenes.items():
        drawn = cloud(shipped, slendernesses, counts[0])
        near = drawn.near(*NEAR)[: counts[1]]
        whole = yield Batch(_cases(enumerate(drawn.scenes), ANALYTIC), measure, f"{name}: analytic model")
        states = states_of(drawn)
        curves = fits(drawn.measures, states, values_of(whole))
        rows += [{"scene": name, **row} for row in (*curves, _check(whole), *_costs(ANALYTIC, whole))]
        arrays |= _kept(f"{name}/{ANALYTIC}", values_of(whole))
        arrays |= {f"{name}/{key}": array.astype(np.float32) for key, array in _made_of(drawn).items()}
        arrays[f"{name}/near"] = near
        for label, cases in _compared(drawn, near, counts[2], solvers):
            others = yield Batch(cases, measure, f"{name}: {label}", TIME_LIMIT)
            few = near[: len(cases)]
            pair = ({key: array[few] for key, array in values_of(whole).items()}, values_of(others))
            found = effects(drawn.measures, few, states, pair, curves, label)
            rows += [{"scene": name, **row} for row in (*found, *_costs(label, others), *_failures(label, others))]
            arrays |= _kept(f"{name}/{label}", values_of(others))
        answer = Found(_settings(ask, scenes, counts, solvers), list(rows), dict(arrays), seed=[0, counts[0] - 1])
        yield answer
    return answer


def states_of(drawn: Cloud) -> dict[str, tuple[str, float]]:
    """Limit states {name: (value of a run, limit)}: exceeded where the value is above the limit."""
    tilts = {f"|φ|/γ > {limit:g}": ("tilt", limit) for limit in TILTS}
    states = {**tilts, "overturning": ("overturns", 0.5)}
    if (bearings := drawn.scenes[0].bearings) is not None:
        states[f"displacement > {bearings.x_max:g} m"] = ("displacement", bearings.x_max)
    return states


def values_of(results: Sequence[Any]) -> dict[str, np.ndarray]:
    """{"overturns", "tilt", "displacement": (n,)} of rows; NaN where a run failed, the tilt infinite in overturning."""
    found = {
        key: np.array([np.nan if row.failed else row.values[key] for row in results], dtype=float)
        for key in ("overturns", "tilt", "displacement")
    }
    found["tilt"][found["overturns"] == 1] = np.inf
    return found


def _cases(scenes, solver, variant=None):
    return [Case(scene, solver, variant, {"history": False}, {"seed": seed}) for seed, scene in scenes]


def _compared(drawn, near, few, solvers):
    """(label, cases) of the model with another restitution, then of every engine and its first scripts."""
    chosen = [(int(seed), drawn.scenes[seed]) for seed in near]
    yield SENSITIVITY, _cases([(seed, _more_elastic(scene)) for seed, scene in chosen], ANALYTIC)
    for solver, variant in solvers:
        yield solver_name(solver, variant), _cases(chosen if variant is None else chosen[:few], solver, variant)


def _more_elastic(scene):
    return scene.with_(block={"restitution": min(RockingModel.of(scene).restitution * (1 + CHANGE), 1.0)})


def _made_of(drawn):
    """What was drawn, and the measures that do not follow from it."""
    return drawn.drawn | {name: drawn.measures[name] for name in ("PGV", "Sa")}


def _kept(place, values):
    return {f"{place}/{key}": values[key].astype(np.float32) for key in ("tilt", "displacement")}


def _costs(label, results):
    seconds = [row.cost["cpu_seconds"] for row in results if row.cost]
    mean = float(np.mean(seconds)) if seconds else None
    return [{"part": "cost", "solver": label, "runs": len(results), "cpu_per_run": mean}]


def _check(results):
    undecided = sum(not row.values["decided"] for row in results if not row.failed)
    failed = sum(row.failed for row in results)
    return {"part": "check", "solver": ANALYTIC, "runs": len(results), "undecided": undecided, "failed": failed}


def _failures(label, results):
    return [
        {"part": "failure", "solver": label, "seed": row.case.tag["seed"], **row.failure}
        for row in results
        if row.failed
    ]


def _settings(ask, scenes, counts, solvers):
    return {
        "quick": ask.quick,
        "scenes": {name: {"scene": shipped, "slendernesses": list(s)} for name, (shipped, s) in scenes.items()},
        "runs": counts[0],
        "runs_of_engines": counts[1],
        "runs_of_first_scripts": counts[2],
        "drawn": dict(zip(DRAWN, (list(STRETCH), list(RADII), None, list(PEAKS)), strict=True)),
        "near": list(NEAR),
        "period": PERIOD,
        "damping": DAMPING,
        "x_max": X_MAX,
        "change": CHANGE,
        "friction": low_frictions(solvers),
        "solvers": [SENSITIVITY, *(solver_name(*pair) for pair in solvers)],
    }
