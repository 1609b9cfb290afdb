"""The study of what changes the outcome: motions near the boundary of overturning, each changed.

The factors of the motions lie about the one at which half of them overturn the block. How often a change changes the
outcome depends on how near the boundary the motions are, so the answer states it.
"""

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.stats import norm

from analytic import Response, SampledMotion, Scene, load_scene, simulate_many, synthetic_motion
from analytic.rocking import BearingLaw, RockingModel
from engines import get_engine

from ...ensembles import OTHERS, USUAL_RATIO, with_vertical
from ...execution.cases import Case
from ...execution.plan import Batch, Computed, Plan, Request
from ...execution.progress import log
from ...metrics.statistics import confusion, mcnemar, wilson
from ...schemas.columns import declared, number_of, whole_of, word_of
from ..rows import SHARED

# The columns of its rows, and by part which of them a row has; see `comparisons.studies.rows`.
COLUMNS = SHARED | declared(
    word_of("change", "change", "how the scene was changed; null: an engine in place of the model"),
    whole_of("outcomes_changed", "outcomes changed", "runs with another outcome than before the change"),
    whole_of("to_overturning", "to overturning", "number of these runs that overturn only after the change"),
    number_of("low", "low", "lower end of the 95 % Wilson interval of their share"),
    number_of("high", "high", "upper end of the 95 % Wilson interval of their share"),
    number_of(
        "tilt", "peak tilt", "relative change of the peak tilt of blocks that stay upright: median", percent=True
    ),
    number_of("displacement", "displacement", "relative change of the peak base displacement: median", percent=True),
    whole_of(
        "faster",
        "vertical over horizontal frequency",
        "how many times as fast as the horizontal motion the vertical one is",
    ),
    number_of("ratio", "V/H", "peak vertical over peak horizontal acceleration", digits=None),
    whole_of("lifts_off", "lifts off", "runs in which N reaches zero"),
)
CHANGED = "runs outcomes_changed? low? high?"
PARTS = {
    "change": f"scene engine variant change? failed to_overturning? p_value? tilt? displacement? {CHANGED}",
    "vertical": f"scene faster ratio lifts_off {CHANGED}",
}

ARIAS = 0.95  # share of the intensity after which the motion is cut off
# (name, quantity, relative change)
BLOCK = (
    ("slenderness ±1 %", "slenderness", 0.01),
    ("size ±1 %", "radius", 0.01),
    ("restitution ±5 %", "restitution", 0.05),
    ("restitution ±1 %", "restitution", 0.01),
    ("restitution ±0.01 %", "restitution", 1e-4),
)
BEARINGS = (
    ("bearing stiffness ka ±10 %", "ka"),
    ("bearing stiffness kb ±10 %", "kb"),
    ("bearing exponent α ±10 %", "alpha"),
)


def changes(scene: Scene, seed: int) -> Iterator[tuple[str, Scene]]:
    """Yield (name, changed scene) for all changes that the scene has room for; both signs of a change have one name.

    scene: its motion is sampled, the synthetic one of this seed times a factor.
    """
    motion = scene.motion
    samples, dt = motion.samples, motion.dt

    def shaken(samples):
        return scene.with_(motion=replace(motion, samples=samples))

    for ratio in (USUAL_RATIO, 2 * USUAL_RATIO):
        yield f"vertical motion, V/H {ratio:.2f}", scene.with_(motion=with_vertical(motion, seed, ratio))
    # the plane in which the block rocks is turned against two horizontal components of equal peak
    other = synthetic_motion(seed=seed + OTHERS)
    other = other.scaled(motion.peak / other.peak)
    turned = math.cos(math.pi / 6) * samples + math.sin(math.pi / 6) * other.samples
    yield "direction turned by 30°", shaken(turned)
    for factor in (0.99, 1.01):
        yield "scale of the motion ±1 %", scene.with_(motion=motion.scaled(factor))
    intensity = np.cumsum(samples**2)
    kept = int(np.searchsorted(intensity, ARIAS * intensity[-1])) + 1
    yield "cut off at 95 % intensity", shaken(samples[:kept])
    for shift in (-1e-3 * motion.peak, 1e-3 * motion.peak):  # as if the baseline was corrected in another way
        yield "baseline off 0.1 % of peak", shaken(samples + shift)
    # every fourth sample, as in many catalogues
    yield "record's time step 0.02 s", scene.with_(motion=SampledMotion(4 * dt, samples[::4], motion.label))
    for name, key, share in BLOCK:
        value = RockingModel.of(scene).restitution if key == "restitution" else getattr(scene.block, key)
        most = 1.0 if key == "restitution" else math.inf
        for factor in (1 - share, 1 + share):
            yield name, scene.with_(block={key: min(value * factor, most)})
    if scene.bearings:
        yield from _bearings(scene)


def _bearings(scene):
    """Yield other values of the bearings, and other laws of the same two stiffnesses and characteristic strength."""
    bearings = scene.bearings
    for name, key in BEARINGS:
        for factor in (0.9, 1.1):
            yield name, scene.with_(bearings={key: factor * getattr(bearings, key)})
    yields = BearingLaw.of(bearings).f0 * bearings.ka / (bearings.ka - bearings.kb)
    yield "bilinear bearings", scene.with_(bearings={"law": "bilinear", "alpha": None, "yield_force": yields})
    yield "Bouc-Wen bearings", scene.with_(bearings={"law": "bouc-wen"})


SPREAD = 0.4  # standard deviation of the logarithm of the motions' factors
TRIED = np.geomspace(0.1, 4.0, 40)  # factors among which the one that overturns half is searched for
# {name: (shipped scene, slendernesses [rad])}
SCENES = {"free-standing": ("caryatid-rigid", (0.15, 0.2, 0.28)), "isolated": ("caryatid-isolated", (0.12, 0.15, 0.18))}
# numbers of motions for the changes, for main variants, and for other variants (engines run the middle slenderness)
FULL, QUICK = (300, 60, 12), (16, 2, 1)
LIFTING = 1.3  # least peak over g tan γ of the engines' motions: a stiff corner that hardly lifts takes minutes
TIME_LIMIT = 60.0  # s, of an engine's run
RATIOS = (0.3, 0.5, 0.7, 0.9, 1.1, 1.3, 1.5)  # V/H: peak vertical over peak horizontal acceleration
FASTER = (1, 2, 4)  # how many times as fast as the horizontal motion: vertical ones hold higher frequencies


def measure(case: Case, response: Response) -> dict[str, Any]:
    """Return what is kept of a run."""
    return {
        "overturns": response.outcome == "overturns",
        "tilt": response.peak_tilt_ratio,
        "displacement": response.peak_base_displacement,
        "normal": response.min_normal_ratio,
    }


def plan(request: Request, scenes: dict[str, Any] | None = None, motions: tuple[int, int, int] | None = None) -> Plan:
    """Plan the study; it gives an answer after each scene.

    Rows by "part" count outcomes over all motions and slendernesses; `low` and `high` bound the 95 % interval of the
    share:

    - "change": one for each change of the scene in the analytic model (`variant` "") and for each engine and variant
      (`change` None). outcomes_changed, and to_overturning among them; p_value: McNemar's; tilt, displacement: median
      relative change of the peaks of blocks that stay upright in both.
    - "vertical": one for each V/H (`ratio`) and speed (`faster`), and one of V/H 0, without vertical motion. lifts_off:
      runs in which N reaches zero, where the model ends.

    Parameters
    ----------
    request : Request
    scenes, motions : dict and (int, int, int), optional
        In place of `SCENES`, and of the numbers of motions, `FULL` or `QUICK`.
    """
    scenes = scenes or SCENES
    counts = motions or (QUICK if request.quick else FULL)
    count, rows, described = counts[0], [], {}
    for name, (shipped, slendernesses) in scenes.items():
        usual = load_scene(shipped).with_(motion=None, duration=None)
        steep = [usual.with_(block={"slenderness": slenderness}) for slenderness in slendernesses]
        halves = [_half_factor(name, scene, min(count, 50)) for scene in steep]
        bases = [_ensemble(scene, half, count) for scene, half in zip(steep, halves, strict=True)]
        changed = yield Batch(_changed_cases(bases), measure, f"{name}: changes")
        run = yield Batch(_engine_cases(bases, request.engines, counts), measure, f"{name}: engines", TIME_LIMIT)
        raised = yield Batch(_vertical_cases(bases, max(count // 3, 1)), measure, f"{name}: vertical motions")
        scene_rows = [*_change_rows(changed, run), *_vertical_rows(_unchanged_runs(changed), raised)]
        rows += [{"scene": name, **row} for row in scene_rows]
        described[name] = {
            "scene": shipped,
            "slendernesses": list(slendernesses),
            "half": halves,
            "slenderness_of_engines": slendernesses[len(slendernesses) // 2],
        }
        settings = {
            "quick": request.quick,
            "scenes": dict(described),
            "motions": count,
            "motions_of_engines": counts[1],
            "motions_of_other_variants": counts[2],
            "lifting": LIFTING,
            "spread": SPREAD,
            "default_variants": {engine: get_engine(engine).default_variant for engine in request.engines},
        }
        answer = Computed(settings, list(rows), seed=[0, count - 1])
        yield answer
    return answer


def _half_factor(name, scene, count):
    """Find the factor at which half of the motions overturn a block."""
    log(f"{name}: slenderness {scene.block.slenderness:g}, the factor that overturns half")
    scenes = [scene.with_(motion=synthetic_motion(seed=seed)) for seed in range(count) for _ in TRIED]
    runs = simulate_many(scenes, scales=np.tile(TRIED, count))
    fallen = runs.overturns.reshape(count, -1).mean(axis=0)
    above = int(np.argmax(fallen >= 0.5))
    if above == 0:
        raise ValueError(f"{name}: no factor from {TRIED[0]:g} to {TRIED[-1]:g} overturns half of {count} motions")
    return float(np.exp(np.interp(0.5, fallen[above - 1 : above + 1], np.log(TRIED[above - 1 : above + 1]))))


def _ensemble(scene, half, count):
    """Return the scene under every motion.

    The factors are lognormal about `half`, evenly spread and in no order.
    """
    spread = norm.ppf((np.random.Generator(np.random.PCG64(7)).permutation(count) + 0.5) / count)
    return [
        scene.with_(motion=synthetic_motion(seed=seed).scaled(float(half * np.exp(SPREAD * spread[seed]))))
        for seed in range(count)
    ]


def _case(scene, engine="analytic", variant=None, **tag):
    return Case(scene, engine, variant, {"history": False}, tag)


def _changed_cases(bases):
    """Cases of every scene as it is (change None) and changed in every way, in the model.

    bases: an ensemble for each slenderness.
    """
    return [
        _case(scene, change=change, seed=seed, place=place)
        for place, ensemble in enumerate(bases)
        for seed, base in enumerate(ensemble)
        for change, scene in ((None, base), *changes(base, seed))
    ]


def _engine_cases(bases, engines, counts):
    """Cases of the first scenes of the middle ensemble that lift, in every (engine, variant).

    An engine's main variant runs more of them than the others.
    """
    place = len(bases) // 2
    lifting = [
        (seed, base)
        for seed, base in enumerate(bases[place])
        if base.motion.peak >= LIFTING * RockingModel.of(base).uplift_acceleration
    ]
    return [
        _case(base, engine, variant, change=None, seed=seed, place=place)
        for engine in engines
        for variant in get_engine(engine).variants
        for seed, base in lifting[: counts[1] if variant == get_engine(engine).default_variant else counts[2]]
    ]


def _vertical_cases(bases, count):
    """Cases of the first `count` scenes of every ensemble under every vertical motion, in the analytic model."""
    return [
        _case(
            base.with_(motion=with_vertical(base.motion, seed, ratio, faster)),
            ratio=ratio,
            faster=faster,
            seed=seed,
            place=place,
        )
        for place, ensemble in enumerate(bases)
        for seed, base in enumerate(ensemble[:count])
        for faster in FASTER
        for ratio in RATIOS
    ]


def _unchanged_runs(changed):
    """Return {(place, seed): values} of the model's runs of the unchanged scenes."""
    return {_motion(row): row.values for row in changed if row.case.tag["change"] is None and not row.failed}


def _motion(row):
    return row.case.tag["place"], row.case.tag["seed"]


def _paired(usual, results, key):
    """Return {key of a run: list of pairs (values of the unchanged scene, values)}; None for a run that failed."""
    groups = {}
    for row in results:
        sound = not row.failed and _motion(row) in usual
        groups.setdefault(key(row), []).append((usual[_motion(row)], row.values) if sound else None)
    return groups


def _outcomes(pairs):
    """Return the table of outcomes before and after, and the columns on it."""
    table = confusion(*([values["overturns"] for values in side] for side in zip(*pairs, strict=True)))
    low, high = wilson(table.discordant, table.size)
    return table, {"runs": table.size, "outcomes_changed": table.discordant, "low": low, "high": high}


def _change_rows(changed, run):
    """Yield a row for every change and every engine's variant, against the model of the unchanged scene."""
    results = [*(row for row in changed if row.case.tag["change"] is not None), *run]
    groups = _paired(
        _unchanged_runs(changed), results, lambda row: (row.case.solver, row.case.variant, row.case.tag["change"])
    )
    for (engine, variant, change), members in groups.items():
        pairs = list(filter(None, members))
        row = {"part": "change", "engine": engine, "variant": variant or "", "change": change, "runs": len(pairs)}
        row["failed"] = len(members) - len(pairs)
        if not pairs:
            yield row | dict.fromkeys(
                ("outcomes_changed", "to_overturning", "low", "high", "p_value", "tilt", "displacement")
            )
            continue
        table, outcomes = _outcomes(pairs)
        upright = [(a, b) for a, b in pairs if not a["overturns"] and not b["overturns"]]
        moved = {peak: _peak_change(upright, peak) for peak in ("tilt", "displacement")}
        yield row | outcomes | {"to_overturning": table.only_b, "p_value": mcnemar(table), **moved}


def _peak_change(pairs, peak):
    """Median relative change of a peak; None without one."""
    moved = [abs(b[peak] / a[peak] - 1) for a, b in pairs if a[peak] > 0]
    return float(np.median(moved)) if moved else None


def _vertical_rows(usual, raised):
    """Yield a row without vertical motion, then one for every (faster, ratio)."""
    groups = _paired(usual, raised, lambda row: (row.case.tag["faster"], row.case.tag["ratio"]))
    sound = {key: list(filter(None, members)) for key, members in groups.items()}
    without = [(before, before) for before, _ in next(filter(None, sound.values()), [])]
    for (faster, ratio), pairs in {(1, 0.0): without, **sound}.items():
        if pairs:
            yield {
                "part": "vertical",
                "faster": faster,
                "ratio": ratio,
                **_outcomes(pairs)[1],
                "lifts_off": sum(after["normal"] <= 0 for _, after in pairs),
            }
