"""The runs behind the fragility study: synthetic motions x intensities x solvers, and their statistics."""

from __future__ import annotations

import math
import time
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from analytic import load_scene, simulate_many, synthetic_motion
from analytic.rocking import RockingModel
from analytic.synthetic import PEAK, G
from engines import get_engine

from ...measuring.statistics import compare, fit_fragility, holm, wilson
from ...running.cases import Case
from ...running.study import Batch, Found, say
from ...showing.wording import solver_name

if TYPE_CHECKING:
    from analytic import Response

    from ...running.study import Ask, Plan

CHANGE = 1e-4  # relative change of the restitution: the model's own sensitivity
REFERENCE, SENSITIVITY = "analytic", "analytic, restitution + 1e-4"
FAILED = -1

# name: (shipped scene, change of its block, factors of the motions)
FULL = {
    "free-standing": ("caryatid-rigid", {}, (0.85, 0.9, 0.95, 1.0, 1.1, 1.3)),
    "isolated": ("caryatid-isolated", {"slenderness": 0.15}, (0.5, 0.6, 0.7, 0.8, 1.0, 1.2)),
}
QUICK = {"free-standing": ("caryatid-rigid", {}, (0.9, 1.0, 1.3))}
MOTIONS, QUICK_MOTIONS = 200, 16


def solvers_of(engines: Sequence[str]) -> list[tuple[str, str | None]]:
    """(engine, variant) of what is compared: every engine as it comes, None, and its first scripts."""
    return [
        *((name, None) for name in engines),
        *(
            (name, variant)
            for name in engines
            for variant, kind in get_engine(name).variants.items()
            if kind.rung == "first script"
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
    return {"outcome": response.outcome}


def plan(ask: Ask, scenes: Mapping[str, Any] | None = None, motions: int | None = None) -> Plan:
    """The plan of the study; an answer with one scene more each time.

    Rows by "part": "curve" (probability of overturning of one solver at one intensity), "fit" (lognormal curve), "pair"
    (a solver against the analytic model at one intensity), "check" and "failure". Arrays ``<scene>/<solver>``: int8,
    shape (intensities, motions): 1 overturns, 0 does not, -1 failed.

    Parameters
    ----------
    ask : Ask
    scenes, motions : dict and int, optional
        In place of `FULL` or `QUICK`, and of the number of motions.
    """
    scenes = scenes or (QUICK if ask.quick else FULL)
    count = motions or (QUICK_MOTIONS if ask.quick else MOTIONS)
    solvers = solvers_of(ask.engines)
    shakings = [synthetic_motion(seed=seed) for seed in range(count)]
    rows, arrays, described = [], {}, {}
    for name, (shipped, block, factors) in scenes.items():
        scene = load_scene(shipped).with_(block=block, motion=None, duration=None)
        intensities = [factor * PEAK / G for factor in factors]
        described[name] = _described(shipped, scene, factors, intensities)
        outcomes, costs, checks = _analytic(scene, shakings, factors)
        rows.append({"part": "check", "scene": name, **checks})
        for solver, variant in solvers:
            label = solver_name(solver, variant)
            cases = _cases(scene, solver, variant, shakings, factors)
            results = yield Batch(cases, measure, f"{name}: {label}")
            outcomes[label] = np.array(
                [FAILED if row.failed else row.values["outcome"] == "overturns" for row in results], dtype=np.int8
            ).reshape(len(factors), count)
            seconds = [row.cost["cpu_seconds"] for row in results if row.cost]
            costs[label] = float(np.sum(seconds)) / max(len(seconds), 1)
            rows += [
                {"part": "failure", "scene": name, "solver": label, **row.case.tag, **row.failure}
                for row in results
                if row.failed
            ]
        rows += _curves(name, outcomes, intensities, costs) + _pairs(name, outcomes, intensities)
        arrays |= {f"{name}/{label}": values for label, values in outcomes.items()}
        settings = {
            "quick": ask.quick,
            "scenes": described,
            "motions": count,
            "seeds": [0, count - 1],
            "motion": "synthetic duzce-like, scaled",
            "change": CHANGE,
            "friction": low_frictions(solvers),
            "solvers": [REFERENCE, *(solver_name(*pair) for pair in solvers)],
        }
        answer = Found(settings, list(rows), dict(arrays), seed=settings["seeds"])
        yield answer
    return answer


def _described(shipped, scene, factors, intensities):
    """A scene and its intensities [g], for the result file."""
    return {
        "scene": shipped,
        "block": scene.block.model_dump(),
        "base": scene.base.model_dump() if scene.base else None,
        "bearings": scene.bearings.model_dump() if scene.bearings else None,
        "tan_slenderness": math.tan(scene.block.slenderness),
        "factors": list(factors),
        "intensities": intensities,
    }


def _cases(scene, solver, variant, shakings, factors):
    """The runs of a solver, all motions at the first factor first; tagged with factor and seed."""
    return [
        Case(
            scene.with_(motion=shaking.scaled(factor)),
            solver,
            variant,
            {"history": False},
            {"factor": factor, "seed": seed},
        )
        for factor in factors
        for seed, shaking in enumerate(shakings)
    ]


def _analytic(scene, shakings, factors):
    """Outcomes of the model and of its perturbed copy, CPU seconds per run, and how many runs end undecided."""
    say("analytic model")
    shape = len(factors), len(shakings)
    scenes = [scene.with_(motion=shaking.scaled(factor)) for factor in factors for shaking in shakings]
    simulate_many(scenes[:1], workers=1)  # compiled or loaded before the clock starts
    began = time.process_time()
    outcomes = simulate_many(scenes)
    cost = (time.process_time() - began) / len(scenes)
    restitution = RockingModel.of(scene).restitution * (1 + CHANGE)
    copy = simulate_many([one.with_(block={"restitution": restitution}) for one in scenes])
    found = {}
    for label, values in ((REFERENCE, outcomes), (SENSITIVITY, copy)):
        found[label] = np.where(values.failed, FAILED, values.overturns).astype(np.int8).reshape(shape)
    checks = {"runs": len(scenes), "undecided": int((~outcomes.decided).sum())}
    return found, {REFERENCE: cost}, checks


def _curves(name, found, intensities, costs):
    """Probability of overturning with its Wilson interval at each intensity, and the lognormal fit."""
    rows = []
    for label, outcomes in found.items():
        size = (outcomes != FAILED).sum(axis=1)
        fallen = (outcomes == 1).sum(axis=1)
        for intensity, k, n in zip(intensities, fallen.tolist(), size.tolist(), strict=True):
            low, high = wilson(k, n) if n else (None, None)
            rows.append(
                {
                    "part": "curve",
                    "scene": name,
                    "solver": label,
                    "intensity": intensity,
                    "overturned": k,
                    "size": n,
                    "failed": outcomes.shape[1] - n,
                    "low": low,
                    "high": high,
                }
            )
        fit = {"part": "fit", "scene": name, "solver": label, "cpu_per_run": costs.get(label)}
        try:
            curve = fit_fragility(intensities, fallen, size)
        except ValueError as error:
            fit |= {"median": None, "reason": str(error)}
        else:
            fit |= {
                "median": curve.median,
                "dispersion": curve.dispersion,
                "median_interval": list(curve.median_interval),
                "dispersion_interval": list(curve.dispersion_interval),
                "reason": None,
            }
        rows.append(fit)
    return rows


def _pairs(name, found, intensities):
    """Each solver against the analytic model, motion by motion; p-values adjusted over the intensities."""
    rows = []
    reference = found[REFERENCE]
    for label, outcomes in found.items():
        if label == REFERENCE:
            continue
        group = []
        for k, intensity in enumerate(intensities):
            sound = (outcomes[k] != FAILED) & (reference[k] != FAILED)
            row = {
                "part": "pair",
                "scene": name,
                "solver": label,
                "intensity": intensity,
                "left_out": int((~sound).sum()),
            }
            if sound.any():
                group.append(row | compare(reference[k][sound] == 1, outcomes[k][sound] == 1, (REFERENCE, label)))
        adjusted = holm([row["p_value"] for row in group]) if group else []
        for row, p_value in zip(group, adjusted, strict=True):
            row["p_holm"] = float(p_value)
        rows += group
    return rows
