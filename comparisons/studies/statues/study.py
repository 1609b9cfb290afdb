"""The study of random statues in the promised range: are engines right, and what does sliding change?

Engines run beside the model without friction, with friction where the block slides, and at the overturning boundaries
of some statues. What sliding changes is counted in the model.
"""

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Annotated, Any

import numpy as np
import typer

from analytic import Response, SampledMotion, Scene, SceneError, Start, simulate, simulate_many
from analytic.records.content import PREFIX
from analytic.records.folder import folder_motions
from analytic.rocking import BearingLaw
from engines import get_engine
from engines.comparison import LAST, PEAK, Reference, compare
from engines.events import LEAST_TILT, impacts_of, matched
from engines.simulating import RANGE, in_words
from engines.trace_checks import LEAST_SLIP

from ...ensembles import (
    FRICTION,
    MOTIONS,
    PEAKS,
    SHAPES,
    USUAL_RATIO,
    VERTICAL,
    Folder,
    random_scene,
    random_slider,
    source_of,
)
from ...execution.cases import Case, variant_settings
from ...execution.plan import Batch, Computed, Plan, Request
from ...execution.progress import log
from ...execution.results import commit_seed
from ...execution.sweep import Row
from ...metrics.boundaries import DISTANCES, TOLERANCE, Edge, Runs, edges
from ...metrics.statistics import class_of
from ...schemas.columns import declared, flag_of, list_of, number_of, whole_of, word_of
from ..rows import BOUNDARY, BOUNDARY_ROW, EDGE, SHARED, SOUGHT
from .levels import FALLS, draw, level_cases, level_row, level_settings, of_level

# The columns of its rows, and by part which of them a row has; see `comparisons.studies.rows`.
COLUMNS = (
    SHARED
    | BOUNDARY
    | declared(
        number_of("radius", "R", "distance from a base corner to the centre of mass of a drawn block", "m", digits=3),
        number_of("base_mass", "base mass", "mass of the base over the block's; null: rigid ground"),
        number_of(
            "period", "period", "period of the block on its bearings, at their stiffness after yielding", "s", digits=3
        ),
        whole_of("runs", "scenes", "scenes that the row sums up; of a boundary, runs that the search took"),
        whole_of("index", "scene", "number of the scene in its ensemble: one without a friction, one with", ""),
        word_of("support", "support", "what the block's base is: rigid ground, or isolated"),
        word_of("motion", "motion", "pulse, synthetic or recorded"),
        number_of(
            "friction",
            "friction",
            "coefficient, null: none; of a cell its interval [low, high]",
            type="number or list",
            digits=3,
        ),
        whole_of("undecided", "undecided", "number of runs whose end is not certain, with friction or without"),
        whole_of(
            "moves", "that lift or slide", "number of runs in which the block lifts or slides, with friction or without"
        ),
        whole_of(
            "lacking",
            "that need more than the friction",
            "number of runs whose friction demand exceeds the friction before any last fall",
        ),
        whole_of("slides", "slide and never lift", "number of runs in which the block slides and never lifts"),
        whole_of(
            "falls_without", "overturn without sliding", "number of runs that overturn where the block cannot slide"
        ),
        whole_of("saved", "saved by sliding", "number of these that stay upright as the block slides"),
        whole_of("overturned", "overturned by sliding", "number of runs that overturn only as the block slides"),
        flag_of("raised", "raised", "whether the motion has a vertical component"),
        number_of("slip", "largest slip", "largest slip over the block's half width"),
        number_of("tilt", "peak tilt", "peak tilt over the slenderness"),
        number_of("slip_error", "slip error", "relative error of the largest slip, of a block that stays upright"),
        number_of("tilt_error", "tilt error", "relative error of the peak tilt, of a block that stays upright"),
        list_of("slipping", "slipping", "errors of the restitution at impacts in which the corner slides"),
        list_of("sticking", "sticking", "errors of the restitution at other impacts"),
        whole_of("draw", "draw", "number of the draw of a statue at a level: 1 chooses, 2 judges", ""),
        word_of("model_outcome", "outcome in the model", "outcome of the analytic model's run"),
        number_of("displacement", "peak displacement", "peak base displacement in the analytic model", "m"),
        number_of("peak_error", "error of the peak tilt", "of a block that stays upright, over the slenderness"),
        number_of("displacement_error", "error of the peak displacement", "relative, of a block on bearings"),
        flag_of("warned", "warned", "whether the run itself says that it is too coarse"),
        number_of("cpu_ratio", "cpu ratio", "CPU time over the analytic model's"),
    )
)
PARTS = {
    "cell": """engine variant support motion friction runs failed undecided moves lacking slides falls_without saved
            overturned""",
    "scene": "engine variant index support motion friction slenderness raised outcome comparable slip tilt",
    "run": "engine variant tier index friction? class comparable | differences quantities",
    "drawn edge": f"{EDGE} slenderness radius base_mass? law? period?",
    "drawn shift": BOUNDARY_ROW,
    "level": """engine variant level draw index motion friction? model_outcome comparable tilt displacement outcome
             | peak_error? displacement_error? warned cpu_per_second""",
    "level shift": BOUNDARY_ROW,
    "failure": SOUGHT,
}

# numbers of scenes without friction, of scenes with it, of those that engines run, and of statues whose boundaries are
# searched for
FULL, QUICK = (500, 20_000, 50, 20), (20, 400, 10, 2)
DRAWN, DRAWN_QUICK = 200, 4  # statues of a draw at all levels
LEVEL_EDGES = 30  # statues whose boundaries are searched for at all levels; at most those of the draw
FEWER = 5  # variants other than the main ones of subject engines run one scene in so many
BINS = 6  # intervals of the friction in which outcomes are counted
SUPPORTS = ("rigid ground", "isolated")
CHUNK = 500  # scenes held at once

SEED = "Of the scenes, without it of the commit; with --check of the draw of runs."
Seed = Annotated[int | None, typer.Option(min=0, max=2**63, help=SEED)]
Number = Annotated[
    int | None, typer.Option(min=1, max=10**6, help="Number of scenes without friction. Default 500, quick 20.")
]
Sliders = Annotated[
    int | None, typer.Option(min=1, max=10**7, help="Number of scenes with friction. Default 20000, quick 400.")
]

Drawn = Annotated[
    int | None,
    typer.Option(
        "--levels", min=1, max=10**4, help="Number of statues in each draw that are run at all levels. Default 200."
    ),
]


# Long, because a plan is best read in one piece, from the first run to the last row.
def plan(
    request: Request,
    boundaries: int | None = None,
    *,
    seed: Seed = None,
    scenes: Number = None,
    sliders: Sliders = None,
    levels: Drawn = None,
    records: Folder = None,
) -> Plan:
    """Plan the study.

    Rows by "part": "cell", how many scenes of a support, a kind of motion and an interval of friction have which fate
    in the model; "scene", a scene with friction that the engines run, and the model's answer; "run", an engine's run of
    a scene, with friction null where it has none; "drawn edge" and "drawn shift", a statue's boundary in the model and
    in an engine; "failure", a failed run of the search for it; "level", a run of a statue at a level of a tuned
    variant, and "level shift", a statue's boundary there, see `levels`.

    Parameters
    ----------
    request : Request
    boundaries, scenes, sliders : int, optional
        How many statues are drawn in place of those of `FULL` or `QUICK`.
    seed : int, optional
        Seed of the scenes.
    levels : int, optional
        How many statues each of the two draws at levels has. Their seeds do not change.
    records : str, optional
        Folder of records, or a set of FEMA P695, in place of all of these.
    """
    seed = commit_seed() if seed is None else seed
    most, sliding, few, count = QUICK if request.quick else FULL
    most, sliding = scenes or most, sliders or sliding
    motions, source = _recorded(records)
    drawn = [Case(random_scene(seed, index), tag={"index": index}) for index in range(most)]
    reached = [case for case in drawn if simulate(case.scene, history=False).peak_tilt_ratio >= RANGE["tilt"][0]]
    rows, chosen = _ensemble(motions, seed, sliding, few)
    model = yield Batch(chosen, of_model, "analytic model")
    model_runs = {row.case.tag["index"]: row for row in model if not row.failed}
    rows += [
        {"part": "scene", "engine": "analytic", "variant": "", **row.case.tag, **row.values}
        for row in model_runs.values()
    ]
    cases = [*_cases(request.engines, reached), *_cases(request.engines, [row.case for row in model_runs.values()])]
    engine_runs = yield Batch(cases, of_engine, "engines")
    rows += [_run_row(row, model_runs) for row in engine_runs]
    log("analytic boundaries of drawn statues")
    drawn_count = levels or (DRAWN_QUICK if request.quick else DRAWN)
    counts = (count, min(LEVEL_EDGES, drawn_count)) if boundaries is None else (boundaries, boundaries)
    all_statues = drawn_edges(max(counts))
    statues, level_statues = (all_statues[:number] for number in counts)
    rows += [{"part": "drawn edge", **vars(edge), **drawn_columns(scene)} for scene, edge in statues]
    runs = Runs({edge.ground: scene for scene, edge in statues})
    rows += yield from runs.search_usual("drawn shift", request.engines, [edge for _, edge in statues])
    log("statues drawn for levels")
    at_levels = [case for number in (1, 2) for case in draw(motions, number, drawn_count)]
    level_runs = yield Batch(list(level_cases(request.engines, at_levels)), of_level, "levels")
    rows += map(level_row, level_runs)
    level_search = Runs({edge.ground: scene for scene, edge in level_statues})
    settings_of_levels = level_settings(request.engines)
    rows += yield from level_search.search(
        "level shift", settings_of_levels, [edge for _, edge in level_statues], DISTANCES, TOLERANCE
    )
    variants = [(engine, variant) for engine in request.engines for variant in get_engine(engine).variants]
    settings = {
        "quick": request.quick,
        "scenes": most,
        "below_range": most - len(reached),
        "sliders": sliding,
        "range": in_words(),
        "source": source,
        "vertical": VERTICAL,
        "ratio": USUAL_RATIO,
        "peak": PEAKS,
        "fewer": FEWER,
        "tolerance": TOLERANCE,
        "variants": list(itertools.starmap(variant_settings, variants)),
        "faults": [
            {"engine": engine, "variant": variant, "words": words}
            for engine, variant in variants
            if (words := get_engine(engine).variants[variant].faults)
        ],
        "default_variants": {engine: get_engine(engine).default_variant for engine in request.engines},
    }
    return Computed(settings, rows + runs.failures + level_search.failures, seed=seed)


def _recorded(folder: str | None) -> tuple[list[SampledMotion], str]:
    """Return recorded motions and their source; empty where the package that has them is not installed."""
    try:
        folder_records, _ = folder_motions(folder or PREFIX)
    except SceneError:
        if folder is not None:
            raise
        return [], ""
    return [motion for motions in folder_records.values() for motion in motions if motion.peak], source_of(folder)


def _cases(engines: Sequence[str], scenes: Sequence[Case]) -> Iterator[Case]:
    """Yield runs of scenes in engines: all in main variants of subject engines, one in `FEWER` in other variants."""
    for engine in map(get_engine, engines):
        for variant in engine.variants:
            step = 1 if engine.subject and variant == engine.default_variant else FEWER
            for case in scenes[::step]:
                yield Case(case.scene, engine.name, variant, {"history": False}, {"index": case.tag["index"]})


def fates(scenes: Sequence[Scene]) -> dict[str, np.ndarray]:
    """Compare scenes with the same scenes without friction; each value is an array of bool, shape (n,).

    failed: the model has no answer to one of the two. undecided: one of the two has no certain end. Of all others:
    moves: the block lifts or slides. lacking: without sliding it needs more than the friction, before any last fall.
    slides: it slides and never lifts. falls_without: it overturns without friction. saved: it overturns without
    friction, but not with it. overturned: it overturns with friction only. chosen: lacking, decided, and its peak tilt,
    if it lifts, is within the range of a statue; engines run these scenes.
    """
    sliding, plain = (
        simulate_many(scenes),
        simulate_many([scene.with_(friction=None) for scene in scenes], contact=True),
    )
    friction = np.array([scene.friction for scene in scenes])
    slenderness = np.array([scene.block.slenderness for scene in scenes])
    level = ~sliding.lifted & (friction < np.tan(slenderness))  # it cannot lift: |H| <= mu N < N tan(gamma)
    failed = sliding.failed | plain.failed
    sound = ~failed & (sliding.decided | level) & plain.decided
    lacking = sound & ((plain.friction_demand > friction) | (plain.min_normal_ratio <= 0))
    small = sliding.lifted & (sliding.peak_tilt < RANGE["tilt"][0] * slenderness)
    falls, falls_without = sound & (sliding.names == FALLS), sound & (plain.names == FALLS)
    return {
        "runs": np.ones(len(scenes), dtype=bool),
        "failed": failed,
        "undecided": ~failed & ~sound,
        "moves": sound & ((sliding.names != "stands") | (plain.names != "stands")),
        "lacking": lacking,
        "slides": sound & (sliding.names == "slides"),
        "falls_without": falls_without,
        "saved": falls_without & ~falls,
        "overturned": falls & ~falls_without,
        "chosen": lacking & sliding.decided & ~small,
    }


def _ensemble(
    records: Sequence[SampledMotion], seed: int, most: int, few: int
) -> tuple[list[dict[str, Any]], list[Case]]:
    """Return the rows of cells, and the first `few` scenes with friction for engines."""
    counts: dict[tuple[Any, ...], dict[str, int]] = {}
    chosen: list[Case] = []
    for begin in range(0, most, CHUNK):
        numbers = range(begin, min(begin + CHUNK, most))
        scenes, kinds = zip(*(random_slider(records, seed, index) for index in numbers), strict=True)
        fates_of_scenes = fates(scenes)
        engines = fates_of_scenes.pop("chosen")
        for k, (index, scene, kind) in enumerate(zip(numbers, scenes, kinds, strict=True)):
            place = SUPPORTS[scene.base is not None], kind, _bin(scene.friction)
            cell = counts.setdefault(place, dict.fromkeys(fates_of_scenes, 0))
            for name, values in fates_of_scenes.items():
                cell[name] += int(values[k])
            if engines[k] and len(chosen) < few:
                tag = {"index": index, "support": place[0], "motion": kind, "friction": scene.friction}
                tag |= {"slenderness": scene.block.slenderness, "raised": scene.motion.vertical is not None}
                chosen.append(Case(scene, settings={"history": False}, tag=tag))
    ends = np.linspace(*FRICTION, BINS + 1).round(12).tolist()
    rows = [
        {"part": "cell", "engine": "analytic", "variant": "", "support": support, "motion": kind}
        | {"friction": [ends[k], ends[k + 1]], **cell}
        for support, kind, k in itertools.product(SUPPORTS, MOTIONS, range(BINS))
        if (cell := counts.get((support, kind, k)))
    ]
    return rows, chosen


def _bin(friction: float) -> int:
    """Index of the interval of friction in which outcomes are counted."""
    low, high = FRICTION
    return min(int(BINS * (friction - low) / (high - low)), BINS - 1)


def of_model(case: Case, response: Response) -> dict[str, Any]:
    """Measure the model's run.

    slip: the largest, over the block's half width.
    """
    return {
        "outcome": response.outcome,
        "comparable": Reference.of(case.scene, response).comparable,
        "slip": _slip(response) / case.scene.block.half_width,
        "tilt": response.peak_tilt_ratio,
    }


def of_engine(case: Case, response: Response) -> dict[str, Any]:
    """Measure an engine's run: its differences from the model.

    Of a run without friction it keeps the class, of one with friction also the errors.

    slip_error, tilt_error: errors of the peaks of a block that stays upright in both; None for a slip too small to
    count, see `engines.trace_checks`. slipping, sticking: errors of the restitution at impacts in which the model's
    corner slides before or after, and at others; lost: slipping ones without a match.
    """
    scene, reference = case.scene, Reference.of(case.scene)
    differences = compare(scene, response, reference).differences
    quantities = [difference.quantity for difference in differences]
    compared = {"differences": [str(difference) for difference in differences], "quantities": quantities}
    if scene.friction is None:
        comparable = reference.comparable
        return {"class": class_of(comparable, quantities), "comparable": comparable, **compared}
    model, radius = reference.model, scene.block.radius
    assert model is not None  # of_model had one
    upright, slips = FALLS not in (response.outcome, model.outcome), (_slip(response), _slip(model))
    return {
        "outcome": response.outcome,
        **compared,
        "slip_error": _error(*slips, LEAST_SLIP / PEAK * radius)
        if upright and max(slips) >= LEAST_SLIP * radius
        else None,
        "tilt_error": _error(response.peak_tilt_ratio, model.peak_tilt_ratio, LEAST_TILT) if upright else None,
        **_restitutions(scene, model, response, reference.until),
        "simulated": response.end.time,
    }


def _error(value: float, model: float, least: float) -> float:
    """Relative error of a peak; a peak too small to count is compared as one that just counts."""
    return (value - model) / max(model, least)


def _slip(response: Response) -> float:
    return response.sliding.peak if response.sliding else 0.0


def _restitutions(scene: Scene, model: Response, run: Response, until: float) -> dict[str, Any]:
    """Errors of the restitution at impacts up to a time; see `of_engine`."""
    end = min(until, model.end.time, run.end.time) - LAST * 2 * math.pi / scene.rocking_frequency
    impacts = impacts_of(run)
    reference, partner = matched(scene, impacts_of(model), impacts, end)
    slips = np.array([slips_at(model, time) for time in reference[:, 0]], dtype=bool)
    met = partner >= 0
    errors = impacts[partner[met], 2] / impacts[partner[met], 1] - reference[met, 2] / reference[met, 1]
    return {
        "slipping": errors[slips[met]].tolist(),
        "sticking": errors[~slips[met]].tolist(),
        "lost": int((slips & ~met).sum()),
    }


def slips_at(model: Response, time: float) -> bool:
    """Return whether the corner slides before or after an impact of the model."""
    modes = model.sliding.modes if model.sliding else ()
    before = [mode for when, mode in modes if when < time][-1:]
    after = [mode for when, mode in modes if when <= time][-1:]
    return "slide-rock" in (*before, *after)


def _run_row(row: Row, model_runs: Mapping[int, Row]) -> dict[str, Any]:
    """Row of a run.

    A failed run is left out where no run of its scene is judged, of all engines alike.

    model_runs: those of the scenes with friction, by their number.
    """
    case, values = row.case, dict(row.values)
    model = None if case.scene.friction is None else model_runs[case.tag["index"]]
    comparable = model.values["comparable"] if model else Reference.of(case.scene).comparable
    identity = {
        "part": "run",
        "engine": case.solver,
        "variant": case.variant,
        "tier": get_engine(case.solver).variants[case.variant or ""].kind,
        "index": case.tag["index"],
        "friction": case.scene.friction,
        "class": class_of(comparable, values.get("quantities")),
        "comparable": comparable,
    }
    if row.failed:
        return {**identity, "outcome": "failed", "failure": row.failure}
    if model:
        cpu = row.cost["cpu_seconds"]
        values |= {"cpu_per_second": cpu / values.pop("simulated"), "cpu_ratio": cpu / model.cost["cpu_seconds"]}
    return {**identity, **values}


BOUNDARY_SEED = 46
FREQUENCY = (1.5, 8.0)  # of pulses over omega_r, drawn evenly over the logarithm
APART = 0.02  # least relative distance of the next boundary: nearer ones alternate as in a fractal


def drawn_edges(count: int) -> list[tuple[Scene, Edge]]:
    """Return `count` statues with their lowest boundary at which the model keeps the block pressed on its base.

    The scenes are those of `random_scene`, at rest; the pulses' shapes take turns. A statue without such a boundary, or
    with another boundary within `APART` of it, is passed over.
    """
    drawn: list[tuple[Scene, Edge]] = []
    index = 0
    while len(drawn) < count:
        scene = random_scene(BOUNDARY_SEED, index).with_(motion=None, start=Start())
        low, high = map(math.log, FREQUENCY)
        frequency = math.exp(np.random.default_rng([BOUNDARY_SEED, index, 1]).uniform(low, high))
        index += 1
        for edge in edges(scene, f"drawn block {index}", SHAPES[len(drawn) % len(SHAPES)], (frequency,)):
            room = min(1 - edge.low / edge.amplitude, edge.high / edge.amplitude - 1)
            if edge.rises and edge.min_normal >= 0 and room >= APART:
                drawn.append((scene, edge))
                break
    return drawn


def drawn_columns(scene: Scene) -> dict[str, Any]:
    """Return the columns that say what was drawn; period [s] on the stiffness after yielding."""
    base, bearings = scene.base, scene.bearings
    law = BearingLaw.of(bearings)
    period = 2 * math.pi * math.sqrt(scene.total_mass / (law.count * law.kb)) if bearings else None
    return {
        "slenderness": scene.block.slenderness,
        "radius": scene.block.radius,
        "base_mass": base and base.mass / scene.block.mass,
        "law": bearings and bearings.law,
        "period": period,
    }
