"""The runs behind the study of what matters: motions near the boundary, and each of them changed in every way.

The factors of the motions lie about the one at which half of them overturn the block: what flips a verdict depends on
how near the verdicts are, and this is said with the answer.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import typer
from scipy.stats import norm

from analytic import load_scene, simulate_many, synthetic_motion
from analytic.rocking import RockingModel
from engines import get_engine

from ...measuring.statistics import confusion, mcnemar, wilson
from ...running.cases import Case
from ...running.study import Batch, Found, say
from ...showing.wording import solver_name
from .changes import changes
from .records import record_cases, record_rows, triples
from .vertical import vertical_cases, vertical_rows

if TYPE_CHECKING:
    from analytic import Response

    from ...running.study import Ask, Plan

ANALYTIC, AS_IT_IS = "analytic", "as it is"
SPREAD = 0.4  # standard deviation of the logarithm of the motions' factors
TRIED = np.geomspace(0.1, 4.0, 40)  # factors among which the one is found that overturns half
# name: (shipped scene, slendernesses [rad])
SCENES = {"free-standing": ("caryatid-rigid", (0.15, 0.2, 0.28)), "isolated": ("caryatid-isolated", (0.12, 0.15, 0.18))}
# motions for the analytic changes, for engines at their best, in other variants (these run the middle slenderness)
FULL, QUICK = (300, 60, 12), (16, 2, 1)
LIFTING = 1.3  # least peak over g tan γ of the engines' motions: a stiff corner that hardly lifts takes minutes
TIME_LIMIT = 60.0  # s, of an engine's run
RECORDS = "Folder of recorded triples, searched for files with two horizontal channels and a vertical one."
Folder = Annotated[str | None, typer.Option("--records", metavar="FOLDER", help=RECORDS)]


def measure(case: Case, response: Response) -> dict[str, Any]:
    """What is kept of a run."""
    return {
        "overturns": response.outcome == "overturns",
        "tilt": response.peak_tilt_ratio,
        "displacement": response.peak_base_displacement,
        "demand": response.friction_demand,
        "normal": response.min_normal_ratio,
    }


def plan(
    ask: Ask,
    scenes: dict[str, Any] | None = None,
    motions: tuple[int, int, int] | None = None,
    *,
    records: Folder = None,
) -> Plan:
    """The plan of the study; an answer with one scene more each time.

    Rows by "part": "change" (a change or an engine's variant in a scene, over all motions and slendernesses: how many
    verdicts it flips, and how far it moves the peaks of those that stay upright), "vertical" (see `vertical_rows`) and
    "record" (see `record_rows`; none without a folder).

    Parameters
    ----------
    ask : Ask
    scenes, motions : dict and (int, int, int), optional
        In place of `SCENES`, and of the numbers of motions, `FULL` or `QUICK`.
    records : str, optional
        Folder of recorded triples. Of what they hold, the answer keeps counts and ratios.
    """
    scenes = scenes or SCENES
    counts = motions or (QUICK if ask.quick else FULL)
    count, recorded = counts[0], triples(records)
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
        run = yield Batch(_by_engines(bases, variants, counts), measure, f"{name}: engines", TIME_LIMIT)
        raised = yield Batch(vertical_cases(bases, max(count // 3, 1)), measure, f"{name}: vertical motions")
        rows += _rows(name, changed + run) + vertical_rows(name, _usual(changed), raised)
        if recorded:
            held = yield Batch(record_cases(usual, slendernesses, recorded), measure, f"{name}: records")
            rows += record_rows(name, recorded, held)
        described[name] = {"scene": shipped, "slendernesses": list(slendernesses), "half": list(factors.values())}
        settings = {
            "quick": ask.quick,
            "scenes": dict(described),
            "motions": count,
            "motions_of_engines": counts[1],
            "motions_of_other_variants": counts[2],
            "slenderness_of_engines": {
                key: scene["slendernesses"][len(scene["slendernesses"]) // 2] for key, scene in described.items()
            },
            "lifting": LIFTING,
            "records": len(recorded),
            "spread": SPREAD,
            "best": [solver_name(*pair) for pair in variants if _at_best(*pair)],
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


def _by_engines(bases, variants, counts):
    """The first scenes of the middle ensemble that lift, in every (engine, variant); most at an engine's best."""
    place = len(bases) // 2
    lifting = [
        (seed, base)
        for seed, base in enumerate(bases[place])
        if base.motion.peak >= LIFTING * RockingModel.of(base).uplift_acceleration
    ]
    return [
        Case(
            base,
            solver,
            variant,
            {"history": False},
            {"change": solver_name(solver, variant), "seed": seed, "place": place},
        )
        for solver, variant in variants
        for seed, base in lifting[: counts[1] if _at_best(solver, variant) else counts[2]]
    ]


def _at_best(solver, variant):
    return variant == get_engine(solver).default_variant


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
    usual = _usual(results)
    groups: dict[tuple[str, str], list] = {}
    for row in results:
        if row.case.tag["change"] != AS_IT_IS:
            groups.setdefault((row.case.solver, row.case.tag["change"]), []).append(row)
    return [_row(name, solver, change, usual, members) for (solver, change), members in groups.items()]


def _usual(results):
    """{(place, seed): values} of the model as it is."""
    return {
        (row.case.tag["place"], row.case.tag["seed"]): row.values
        for row in results
        if row.case.tag["change"] == AS_IT_IS and not row.failed
    }


def _row(name, solver, change, usual, members):
    pairs = [
        (usual[row.case.tag["place"], row.case.tag["seed"]], row.values)
        for row in members
        if not row.failed and (row.case.tag["place"], row.case.tag["seed"]) in usual
    ]
    found = {
        "part": "change",
        "scene": name,
        "solver": solver,
        "change": change,
        "runs": len(pairs),
        "failed": len(members) - len(pairs),
    }
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
