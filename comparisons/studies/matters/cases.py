"""The runs behind the study of what matters: motions near the boundary, and each of them changed in every way.

The factors of the motions lie about the one at which half of them overturn the block: what flips a verdict depends on
how near the verdicts are, and this is said with the answer.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.stats import norm

from analytic import load_scene, simulate_many, synthetic_motion
from engines import get_engine

from ...measuring.statistics import confusion, mcnemar, wilson
from ...running.cases import Case
from ...running.study import Batch, Found, say
from ...showing.wording import solver_name
from .changes import changes

if TYPE_CHECKING:
    from analytic import Response

    from ...running.study import Ask, Plan

ANALYTIC, AS_IT_IS = "analytic", "as it is"
SPREAD = 0.4  # standard deviation of the logarithm of the motions' factors
TRIED = np.geomspace(0.1, 4.0, 40)  # factors among which the one is found that overturns half
# name: (shipped scene, slendernesses [rad])
SCENES = {"free-standing": ("caryatid-rigid", (0.15, 0.2, 0.28)), "isolated": ("caryatid-isolated", (0.12, 0.15, 0.18))}
FULL, QUICK = (300, 60), (16, 2)  # motions for the analytic changes and for the engines


def measure(case: Case, response: Response) -> dict[str, Any]:
    """What is kept of a run."""
    return {
        "overturns": response.outcome == "overturns",
        "tilt": response.peak_tilt_ratio,
        "displacement": response.peak_base_displacement,
    }


def plan(ask: Ask, scenes: dict[str, Any] | None = None, motions: tuple[int, int] | None = None) -> Plan:
    """The plan of the study; an answer with one scene more each time.

    Rows: a change or an engine's variant in a scene, over all motions and slendernesses: how many verdicts it flips,
    and how far it moves the peaks of those that stay upright.

    Parameters
    ----------
    ask : Ask
    scenes, motions : dict and (int, int), optional
        In place of `SCENES`, and of the numbers of motions for changes and engines.
    """
    scenes = scenes or SCENES
    count, of_engines = motions or (QUICK if ask.quick else FULL)
    variants = {(name, variant): kind for name in ask.engines for variant, kind in get_engine(name).variants.items()}
    rows, described = [], {}
    for name, (shipped, slendernesses) in scenes.items():
        usual = load_scene(shipped).with_(motion=None, duration=None)
        bases, factors = [], {}
        for slenderness in slendernesses:
            scene = usual.with_(block={"slenderness": slenderness})
            factors[slenderness] = _half(name, scene, min(count, 50))
            bases.append(_ensemble(scene, factors[slenderness], count))
        changed = yield Batch(_changed(bases), measure, f"{name}: changes")
        run = yield Batch(_by_engines(bases, variants, of_engines), measure, f"{name}: engines")
        rows += _rows(name, changed + run)
        described[name] = {"scene": shipped, "slendernesses": list(slendernesses), "half": list(factors.values())}
        settings = {
            "quick": ask.quick,
            "scenes": dict(described),
            "motions": count,
            "motions_of_engines": of_engines,
            "spread": SPREAD,
            "rungs": {solver_name(*pair): kind.rung for pair, kind in variants.items()},
        }
        answer = Found(settings, list(rows), seed=[0, count - 1])
        yield answer
    return answer


def _changed(bases):
    """Every scene as it is and changed in every way, in the analytic model; bases: an ensemble per slenderness."""
    return [
        Case(scene, tag={"change": change, "seed": seed, "place": place}, settings={"history": False})
        for place, ensemble in enumerate(bases)
        for seed, base in enumerate(ensemble)
        for change, scene in ((AS_IT_IS, base), *changes(base, seed))
    ]


def _by_engines(bases, variants, count):
    """The first scenes of every ensemble as they are, in every (engine, variant)."""
    return [
        Case(
            base,
            solver,
            variant,
            {"history": False},
            {"change": solver_name(solver, variant), "seed": seed, "place": k},
        )
        for solver, variant in variants
        for k, ensemble in enumerate(bases)
        for seed, base in enumerate(ensemble[:count])
    ]


def _half(name, scene, count):
    """The factor at which half of the motions overturn a block."""
    say(f"{name}: slenderness {scene.block.slenderness:g}, the factor that overturns half")
    motions = [synthetic_motion(seed=seed) for seed in range(count)]
    runs = [scene.with_(motion=motion) for motion in motions for _ in TRIED]
    fallen = simulate_many(runs, scales=np.tile(TRIED, count)).overturns.reshape(count, -1).mean(axis=0)
    above = int(np.argmax(fallen >= 0.5))
    if above == 0:
        raise ValueError(f"{name}: no factor from {TRIED[0]:g} to {TRIED[-1]:g} overturns half of {count} motions")
    return float(np.exp(np.interp(0.5, fallen[above - 1 : above + 1], np.log(TRIED[above - 1 : above + 1]))))


def _ensemble(scene, half, count):
    """The scene under every motion, with factors lognormal about the half one, evenly spread and in no order."""
    spread = norm.ppf((np.random.Generator(np.random.PCG64(7)).permutation(count) + 0.5) / count)
    return [
        scene.with_(motion=synthetic_motion(seed=seed).scaled(float(half * np.exp(SPREAD * spread[seed]))))
        for seed in range(count)
    ]


def _rows(name, results):
    """A row for every change, against the model as it is on the same motion."""
    usual = {
        (row.case.tag["place"], row.case.tag["seed"]): row.values
        for row in results
        if row.case.tag["change"] == AS_IT_IS and not row.failed
    }
    groups: dict[tuple[str, str], list] = {}
    for row in results:
        if row.case.tag["change"] != AS_IT_IS:
            groups.setdefault((row.case.solver, row.case.tag["change"]), []).append(row)
    return [_row(name, solver, change, usual, members) for (solver, change), members in groups.items()]


def _row(name, solver, change, usual, members):
    pairs = [
        (usual[row.case.tag["place"], row.case.tag["seed"]], row.values)
        for row in members
        if not row.failed and (row.case.tag["place"], row.case.tag["seed"]) in usual
    ]
    found = {"scene": name, "solver": solver, "change": change, "runs": len(pairs), "failed": len(members) - len(pairs)}
    if not pairs:
        return found | dict.fromkeys(("flips", "falls", "low", "high", "p_value", "tilt", "displacement"))
    table = confusion(*(np.array([values["overturns"] for values in side]) for side in zip(*pairs, strict=True)))
    low, high = wilson(table.discordant, len(pairs))
    upright = [(a, b) for a, b in pairs if not a["overturns"] and not b["overturns"]]
    return found | {
        "flips": table.discordant,
        "falls": table.only_b,
        "low": low,
        "high": high,
        "p_value": mcnemar(table),
        "tilt": _moved(upright, "tilt"),
        "displacement": _moved(upright, "displacement"),
    }


def _moved(pairs, key):
    """Median relative change of a peak, where there is one."""
    moved = [abs(b[key] / a[key] - 1) for a, b in pairs if a[key] > 0]
    return float(np.median(moved)) if moved else None
