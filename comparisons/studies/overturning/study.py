"""The overturning study: boundaries of the model and of every engine, and outcomes between them."""

import itertools
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from analytic import load_scene, overturning_map, simulate
from engines import get_engine

from ...execution.cases import variant_settings
from ...execution.plan import Computed, Plan, Request
from ...execution.progress import log
from ...metrics.boundaries import (
    HIGHEST,
    LEVEL_DISTANCES,
    LEVEL_TOLERANCE,
    LOWEST,
    TOLERANCE,
    Point,
    Runs,
    Setting,
    edges,
    least_normal,
    pulse,
    under,
    usual_settings,
)
from ...metrics.statistics import Confusion, cohen_kappa, confusion, equality
from ...schemas.columns import declared, flag_of, list_of, number_of, whole_of, word_of
from ..rows import BOUNDARY, BOUNDARY_ROW, EDGE, PULSE, SHARED, SOUGHT

# The columns of its rows, and by part which of them a row has; see `comparisons.studies.rows`.
COLUMNS = (
    SHARED
    | BOUNDARY
    | declared(
        whole_of("runs", "runs judged", "runs that the search took; of a scan, those that are judged"),
        list_of(
            "interval", "interval", "95 % interval of the share of a scan that differs or failed (Wilson, by frequency)"
        ),
        word_of(
            "region",
            "region",
            'region of a confusion table: "scan", "outside" or "inside" the band, "held down" where N < 0',
        ),
        number_of("kappa", "kappa", "Cohen's kappa of the outcomes"),
        number_of("kappa_low", "kappa low", "lower end of kappa's 95 % interval"),
        number_of("kappa_high", "kappa high", "upper end of kappa's 95 % interval"),
        flag_of("analytic_overturns", "analytic overturns", "whether the block overturns in the analytic model"),
        number_of(
            "distance",
            "distance from the nearest boundary",
            "relative distance from the nearest boundary of the analytic model",
            percent=True,
        ),
    )
)
PARTS = {
    "edge": EDGE,
    "shift": BOUNDARY_ROW,
    "refinement": BOUNDARY_ROW,
    "confusion": """engine variant level ground region both_stand both_overturn only_a only_b kappa? kappa_low?
            kappa_high?""",
    "scan": "engine variant level runs failed both_stand both_overturn only_a only_b interval",
    "disagreement": f"{PULSE} min_normal analytic_overturns distance?",
    "failure": SOUGHT,
}

# The isolated Caryatid itself overturns only at base displacements far beyond its bearings' 0.30 m. A more slender
# block on the same bearings overturns at amplitudes of a strong earthquake.
GROUNDS = {"rigid ground": ("caryatid-rigid", {}), "isolated base": ("caryatid-isolated", {"slenderness": 0.15})}
SHAPES = ("one-sine", "one-cosine", "ricker")
LEVEL_FREQUENCY = 4.0  # pulse frequency over omega_r at which other levels are run
BAND = 0.01  # relative distance from a boundary beyond which no engine may differ
# the model's equations by another method, beside the variants of engines
STEPPING = {
    "engine": "time-stepping",
    "variant": "",
    "tier": "model",
    "parameter": "step",
    "default": 1e-4,
    "levels": (1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 1e-5),
    "applies_impact": True,
    "friction": None,
}


@dataclass(frozen=True)
class Grid:
    """Scope of the study.

    frequencies: over omega_r. scan: amplitudes of the coarse scan over g tan(slenderness).

    size: numbers of amplitudes and frequencies of the analytic maps. levels: which levels of a variant are run.
    """

    grounds: tuple[str, ...]
    shapes: tuple[str, ...]
    frequencies: tuple[float, ...]
    scan: tuple[float, ...]
    size: tuple[int, int]
    levels: slice


SCAN = tuple(np.geomspace(1.05, 19.5, 11).tolist())
FULL = Grid(tuple(GROUNDS), SHAPES, (2.0, 4.0, 6.0, 8.0), SCAN, (240, 141), slice(None))
QUICK = Grid(tuple(GROUNDS), SHAPES[:1], (2.0, 4.0), SCAN[::4], (60, 36), slice(1, 2))


def plan(request: Request, grid: Grid | None = None) -> Plan:
    """Plan the study: a first answer at the default levels, then answers with more levels.

    grid: what to cover, in place of FULL or QUICK.

    Rows by "part": "edge" (a boundary of the analytic model), "shift" (an engine's beside it, of its main variant and
    the kind "defaults"), "scan" (their outcomes over a coarse scan), "refinement" (other levels), "confusion" (counts
    of outcomes), "disagreement" (an outcome that differs outside the band) and "failure".

    Arrays: frequency, amplitude; ``<ground>/<shape>``: int16, shape (amplitudes, frequencies), impacts before
    overturning in the analytic model, -1 where it does not overturn.
    """
    grid = grid or (QUICK if request.quick else FULL)
    grounds = {
        name: load_scene(shipped).with_(block=block, motion=None, duration=None)
        for name, (shipped, block) in GROUNDS.items()
        if name in grid.grounds
    }
    # 1. boundaries of the analytic model
    arrays, boundaries = _maps(grounds, grid), []
    for ground, shape in itertools.product(grounds, grid.shapes):
        log(f"analytic boundaries: {ground}, {shape}")
        boundaries += edges(grounds[ground], ground, shape, grid.frequencies)
    rows = [{"part": "edge", **vars(edge)} for edge in boundaries]
    # 2. at default levels: outcomes of engines over a coarse scan, and their boundaries
    default, coarser = usual_settings(request.engines)
    runs, points = Runs(grounds, default), _scan(grounds, grid)
    model_outcomes = _model_outcomes(grounds, points, boundaries)
    for setting in (*default, *coarser):
        answers = yield from runs.ask([(setting, point) for point in points], f"scan: {setting.engine}", scan=True)
        rows.append({"part": "scan", **setting.row(), **_scan_counts(points, model_outcomes, answers)})
    rows += yield from runs.search_usual("shift", request.engines, boundaries)
    records = _records(runs.outcomes, default, grounds, boundaries)
    rows += [*_confusions(records, default, grounds), *_disagreements(records)]
    variants = ((name, variant) for name in request.engines for variant in get_engine(name).variants)
    described = [*itertools.starmap(_described_variant, variants), STEPPING]
    settings = _settings(request, grid, grounds, described)
    yield Computed(settings, rows + runs.failures, arrays)
    # 3. some of these boundaries at other levels
    chosen = [edge for edge in boundaries if edge.shape == SHAPES[0] and edge.frequency == LEVEL_FREQUENCY]
    for setting in _other_settings(described, grid.levels):
        rows += yield from runs.search("refinement", [setting], chosen, LEVEL_DISTANCES, LEVEL_TOLERANCE)
        yield Computed(settings, rows + runs.failures, arrays)
    return Computed(settings, rows + runs.failures, arrays)


def _described_variant(engine: str, variant: str) -> dict[str, Any]:
    """Describe a variant as the settings list it; levels: those that are run."""
    spec = get_engine(engine).variants[variant]
    tried = () if spec.applies_impact or spec.kind == "defaults" else spec.levels
    return variant_settings(engine, variant, tried) | {"friction": spec.friction}


def _other_settings(described, levels):
    """Yield the `Setting`s that are run beside the default ones: the model by another method, then all levels."""
    for variant in sorted(described, key=lambda variant: variant["tier"] != "model"):
        for level in variant["levels"][levels] or variant["levels"]:
            yield Setting(variant["engine"], variant["variant"], level, {variant["parameter"]: level})


def _settings(request, grid, grounds, described):
    return {
        "quick": request.quick,
        "grounds": {
            name: {
                "scene": GROUNDS[name][0],
                "block": scene.block.model_dump(),
                "omega_r": scene.rocking_frequency,
                "unit": scene.gravity * math.tan(scene.block.slenderness),
                "tan_slenderness": math.tan(scene.block.slenderness),
                "base": scene.base.model_dump() if scene.base else None,
                "bearings": scene.bearings.model_dump() if scene.bearings else None,
            }
            for name, scene in grounds.items()
        },
        "shapes": grid.shapes,
        "frequencies": grid.frequencies,
        "scan": grid.scan,
        "amplitudes": (LOWEST, HIGHEST),
        "band": BAND,
        "tolerance": TOLERANCE,
        "level_tolerance": LEVEL_TOLERANCE,
        "engines": request.engines,
        "variants": described,
        "default_variants": {engine: get_engine(engine).default_variant for engine in request.engines},
    }


def _maps(grounds, grid):
    frequency, amplitude = np.linspace(1.5, 8.5, grid.size[1]), np.geomspace(LOWEST, HIGHEST, grid.size[0])
    arrays = {"frequency": frequency, "amplitude": amplitude}
    for (ground, scene), shape in itertools.product(grounds.items(), grid.shapes):
        log(f"analytic map: {ground}, {shape}")
        outcomes = overturning_map(scene, shape, frequency, amplitude)
        impacts = np.minimum(outcomes.impacts, 32767)
        arrays[f"{ground}/{shape}"] = np.where(outcomes.overturns, impacts, -1).astype(np.int16)
    return arrays


def _scan(grounds, grid):
    """Return the points of the coarse scan."""
    places = itertools.product(grid.grounds, grid.shapes, grid.frequencies, grid.scan)
    return [Point(*place, least_normal(grounds[place[0]], pulse(grounds[place[0]], *place[1:]))) for place in places]


def _model_outcomes(grounds, points, boundaries):
    """Return whether the block overturns in the model at each point; None near a boundary, and where it would jump."""
    models = [simulate(under(grounds, point), history=False) for point in points]
    return [
        model.outcome == "overturns" if model.min_normal_ratio >= 0 and _distance(boundaries, point) > BAND else None
        for point, model in zip(points, models, strict=True)
    ]


def _scan_counts(points, model_outcomes, answers):
    """Count the points that are judged, the failed runs, and the outcomes of the others.

    In the interval of the share that differs or fails, runs of one shape and frequency on one ground count as one.
    """
    chosen = [
        (*run, point[:3]) for *run, point in zip(model_outcomes, answers, points, strict=True) if run[0] is not None
    ]
    models, engines, groups = zip(*chosen, strict=True)
    both = [(a, b) for a, b in zip(models, engines, strict=True) if b is not None]
    _, interval = equality([a != b for a, b in zip(models, engines, strict=True)], groups)
    counts = vars(confusion(*np.transpose(both)) if both else Confusion(0, 0, 0, 0))
    return {"runs": len(chosen), "failed": len(chosen) - len(both), **counts, "interval": interval}


def _distance(boundaries, point):
    """Relative distance of a point to the nearest boundary of the analytic model."""
    near = (edge.amplitude for edge in boundaries if (edge.ground, edge.shape, edge.frequency) == point[:3])
    return min((abs(point.amplitude / amplitude - 1) for amplitude in near), default=math.inf)


def _records(outcomes, default, grounds, boundaries):
    """Records of `Runs.outcomes`, each with what the analytic model says at its point.

    scan: whether the point is one of the scan. distance: relative distance from the nearest boundary of the model.
    """
    rows, records = {setting.engine: setting.row() for setting in default}, []
    for (engine, *place), (overturns, scan) in outcomes.items():
        point = Point._make((*place, math.nan))
        response = simulate(under(grounds, point), history=False)
        records.append(
            {
                **rows[engine],
                **point._asdict(),
                "min_normal": response.min_normal_ratio,
                "overturns": overturns,
                "analytic_overturns": response.outcome == "overturns",
                "scan": scan,
                "distance": _distance(boundaries, point),
            }
        )
    return records


def _confusions(
    records: Sequence[dict[str, Any]], default: Iterable[Setting], grounds: Iterable[str]
) -> Iterator[dict[str, Any]]:
    """Yield rows of counts, the engines' outcomes against the analytic model's, by engine, ground and region.

    Outside the band, points at which the normal force of the analytic model becomes negative ("held down") are counted
    apart.
    """
    regions = {
        "scan": lambda record: record["scan"],
        "outside": lambda record: record["distance"] > BAND and record["min_normal"] >= 0,
        "held down": lambda record: record["distance"] > BAND and record["min_normal"] < 0,
        "inside": lambda record: record["distance"] <= BAND,
    }
    for setting, ground, region in itertools.product(default, grounds, regions):
        identity = {**setting.row(), "ground": ground}
        chosen = [
            (record["analytic_overturns"], record["overturns"])
            for record in records
            if identity.items() <= record.items() and record["overturns"] is not None and regions[region](record)
        ]
        if chosen:
            counts = confusion(*np.transpose(chosen))
            kappa, low, high = cohen_kappa(counts.table())
            agreement = {"kappa": kappa, "kappa_low": low, "kappa_high": high}
            yield {"part": "confusion", **identity, "region": region, **vars(counts), **agreement}


def _disagreements(records):
    """Yield a row for each outcome outside the band that differs."""
    for record in records:
        if record["distance"] > BAND and record["overturns"] not in (None, record["analytic_overturns"]):
            row = {key: value for key, value in record.items() if key not in ("overturns", "scan")}
            yield {"part": "disagreement", **row}
