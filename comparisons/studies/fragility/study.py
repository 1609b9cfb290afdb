"""The fragility study: many runs of the analytic model, some of them in every engine, and curves.

The runs form a cloud: their blocks and motions are random. No two runs share a motion, a block or an intensity, so runs
are independent. Accelerations are evenly spread over the logarithm, from far below to far above what matters. Fragility
curves are fitted to the analytic model, and engines are compared by what they make of them.
"""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.stats import norm

from analytic import Response, SampledMotion, Scene, load_scene, synthetic_motion
from analytic.advice.bearing_scan import displacement_spectrum
from analytic.rocking import RockingModel, properties
from analytic.scene import BASE, BEARINGS, MASS
from engines import get_engine
from engines.comparison import END, Reference, compare

from ...ensembles import peak_velocity
from ...execution.cases import Case
from ...execution.plan import Batch, Computed, Plan, Request
from ...execution.sweep import Row
from ...metrics.statistics import (
    class_of,
    compare_outcomes,
    draws,
    fit_fragility,
    goodness,
    holm,
    interval,
    points,
    resampled,
)
from ...schemas.columns import declared, flag_of, list_of, number_of, whole_of, word_of
from ..rows import SHARED

# The columns of its rows, and by part which of them a row has; see `comparisons.studies.rows`.
COLUMNS = SHARED | declared(
    word_of("state", "state", "limit state"),
    word_of("measure", "measure", "intensity measure"),
    whole_of("size", "size", "runs that failed in no solver compared"),
    whole_of("exceeded", "exceeded", "number of these runs beyond the limit state"),
    list_of("points", "points", "shares beyond it in classes of intensity, with 95 % Wilson intervals"),
    number_of("median", "median", "median of the lognormal curve", "of the measure", within="median_interval"),
    number_of(
        "dispersion",
        "dispersion",
        "dispersion of the lognormal curve: standard deviation of ln(intensity)",
        within="dispersion_interval",
    ),
    list_of(
        "median_interval",
        "median interval",
        "interval of the median, or of its shift (95 %, bootstrap over runs): [low, high]",
        "of the measure, or -",
    ),
    list_of(
        "dispersion_interval",
        "dispersion interval",
        "interval of the dispersion, or of its shift (95 %, bootstrap over runs): [low, high]",
    ),
    number_of("p_value", "p of the fit", "p of the fit of a curve, or of McNemar's exact test of the outcomes"),
    whole_of("undecided", "undecided at their end", "runs that ended before their outcome was certain"),
    number_of("cpu_per_run", "cpu per run", "CPU time: mean", "s"),
    whole_of("left_out", "failed", "runs that failed in one of the two"),
    number_of("difference", "difference", "share beyond the limit state in the engine less that in the model"),
    number_of(
        "detectable_difference",
        "detectable difference",
        "difference of shares that the test would have found with 80 % probability",
        percent=True,
    ),
    number_of(
        "median_shift",
        "median over the model's",
        "median of the engine over that of the model",
        digits=3,
        within="median_interval",
    ),
    number_of(
        "dispersion_shift",
        "dispersion over the model's",
        "dispersion of the engine over that of the model",
        digits=3,
        within="dispersion_interval",
    ),
    number_of(
        "detectable_shift",
        "detectable median ratio",
        "ratio of medians that the test would have found with 80 % probability",
        digits=3,
    ),
    number_of("p_holm", "p (McNemar, Holm)", "p_value adjusted over limit states, by Holm"),
    word_of("class", "class", '"right" or "differs" (how the block ends, and when), "failed" or "left out"'),
    whole_of("seed", "seed", "seed of the synthetic motion"),
    flag_of("overturns", "overturns", "whether the block overturns in the engine; null: the run failed"),
    flag_of("model_overturns", "model overturns", "whether it overturns in the model"),
)
PARTS = {
    "fit": """scene state measure size exceeded points median? dispersion? median_interval? dispersion_interval?
            p_value? reason?""",
    "check": "scene engine variant runs undecided failed",
    "run": "scene engine variant seed comparable class quantities? model_overturns overturns?",
    "cost": "scene engine variant runs cpu_per_run?",
    "effect": """scene engine variant state left_out measure both_stand both_overturn only_a only_b p_value
            difference detectable_difference? median_shift? median_interval? dispersion_shift? dispersion_interval?
            detectable_shift? reason? p_holm""",
    "failure": "scene engine variant seed kind reason message",
}

DRAWS, POINTS = 200, 14
PAIRED_DRAWS = 500
SHIFTS = ("median_shift", "median_interval", "dispersion_shift", "dispersion_interval", "detectable_shift")


@dataclass(frozen=True)
class State:
    """A limit state: it is exceeded where a run's value of `key` is above the limit.

    measure: the intensity measure of its curve.
    """

    key: str
    limit: float
    measure: str

    def exceeded(self, values: dict[str, np.ndarray]) -> np.ndarray:
        """Return 1 where a run exceeds it, 0 where not, NaN where the run failed; shape (n,)."""
        reached = values[self.key]
        return np.where(np.isnan(reached), np.nan, reached > self.limit)


def fits(
    measures: dict[str, np.ndarray], states: dict[str, State], values: dict[str, np.ndarray]
) -> list[dict[str, Any]]:
    """Fit a curve to each limit state; return a row for each.

    A row has median, dispersion and their intervals (bootstrap over runs); p_value of the curve's fit; points: shares
    with Wilson intervals; reason: why there is no curve, or None.
    """
    rows = []
    for name, state in states.items():
        exceeded = state.exceeded(values)
        sound = ~np.isnan(exceeded)
        row = {"part": "fit", "state": name, "measure": state.measure, "size": int(sound.sum())}
        row["exceeded"] = int(exceeded[sound].sum())
        rows.append(row | _curve(measures[state.measure][sound], exceeded[sound]))
    return rows


def _curve(intensity, exceeded):
    shares = {"points": points(intensity, exceeded, POINTS)}
    try:
        curve = fit_fragility(intensity, exceeded)
    except ValueError as error:
        lost = dict.fromkeys(("median", "dispersion", "median_interval", "dispersion_interval", "p_value"))
        return {**shares, **lost, "reason": str(error)}
    medians, spreads = resampled(intensity, exceeded, draws(DRAWS, len(exceeded)))
    return {
        **shares,
        "median": curve.median,
        "dispersion": curve.dispersion,
        "median_interval": interval(curve.median, medians),
        "dispersion_interval": interval(curve.dispersion, spreads),
        "p_value": goodness(intensity, exceeded, curve),
        "reason": None,
    }


def effects(
    measures: dict[str, np.ndarray],
    chosen: np.ndarray,
    states: dict[str, State],
    values: tuple[dict[str, np.ndarray], dict[str, np.ndarray]],
    pair: tuple[str, str],
) -> list[dict[str, Any]]:
    """Compare an engine with the model on the runs that failed in neither; return a row for each limit state.

    median_shift and dispersion_shift: the engine's median and dispersion over the model's, with intervals by paired
    bootstrap over runs; detectable_shift: the ratio of medians whose difference of
    probability the test would have found with 80 % probability. p_holm: p adjusted over limit states.

    Parameters
    ----------
    measures : {name: (n,)}
    chosen : indices of the runs compared, shape (k,)
    states : {name: `State`}
    values : of the model and of the engine, arrays of shape (k,)
    pair : engine and variant
    """
    rows: list[dict[str, Any]] = []
    for name, state in states.items():
        ours, theirs = map(state.exceeded, values)
        sound = ~np.isnan(ours) & ~np.isnan(theirs)
        if sound.any():
            row: dict[str, Any] = {"part": "effect", "engine": pair[0], "variant": pair[1], "state": name}
            row |= {"left_out": int((~sound).sum()), "measure": state.measure}
            row |= compare_outcomes(ours[sound] == 1, theirs[sound] == 1)
            intensity = measures[state.measure][chosen[sound]]
            rows.append(row | _shift(intensity, ours[sound], theirs[sound], row["detectable_difference"]))
    adjusted = holm([row["p_value"] for row in rows]) if rows else []
    return [row | {"p_holm": float(p_value)} for row, p_value in zip(rows, adjusted, strict=True)]


def _shift(intensity, ours, theirs, detectable):
    """Ratios of the two fits; None, with the reason, where one of them does not exist."""
    shift = dict.fromkeys(SHIFTS)
    try:
        model, engine = (fit_fragility(intensity, exceeded) for exceeded in (ours, theirs))
    except ValueError as error:
        return {**shift, "reason": str(error)}
    weights = draws(PAIRED_DRAWS, len(ours))
    medians, spreads = zip(*(resampled(intensity, exceeded, weights) for exceeded in (ours, theirs)), strict=True)
    shift["median_shift"] = engine.median / model.median
    shift["dispersion_shift"] = engine.dispersion / model.dispersion
    if (ours != theirs).any():  # without a difference the bootstrap gives no width, which would mean certainty
        shift["median_interval"] = interval(shift["median_shift"], medians[1] / medians[0])
        shift["dispersion_interval"] = interval(shift["dispersion_shift"], spreads[1] / spreads[0])
    if detectable is not None:
        # a shift d of ln(median) changes the probability of a run by phi(z) d/dispersion
        steepness = (norm.pdf(np.log(intensity / model.median) / model.dispersion) / model.dispersion).mean()
        shift["detectable_shift"] = float(np.exp(detectable / steepness))
    return {**shift, "reason": None}


X_MAX = 0.30  # m, what the bearings are built for: Table 1(a) of the paper
PERIOD = properties(BEARINGS, MASS + BASE.mass, X_MAX).period  # s, isolation period, secant at X_MAX
DAMPING = 0.05  # damping of the spectrum, as in catalogues
STRETCH = (0.5, 2.0)  # factors on a motion's time, as all synthetic motions have nearly one spectrum
RADII = (0.6, 2.0)  # m
PEAKS = (0.08, 3.0)  # g
# {name: (shipped scene, least and greatest slenderness [rad])}
SCENES = {"free-standing": ("caryatid-rigid", (0.12, 0.32)), "isolated": ("caryatid-isolated", (0.1, 0.25))}
DRAWN = ("stretch", "radius", "slenderness", "peak")

# intensity measures; g tan(slenderness) is the uplift acceleration, omega_r the rocking frequency
UPLIFT, ROCKING, ISOLATED, STROKE = "PGA/(g tan γ)", "ω_r PGV/(g tan γ)", "Sa/(g tan γ)", "PGV"


@dataclass(frozen=True, eq=False)
class Cloud:
    """Runs of a scene with random blocks and motions.

    scenes: those of n runs. drawn: {what was drawn: values of shape (n,)}. measures: {name: values of shape (n,)}, see
    `measures`.
    """

    scenes: tuple[Scene, ...]
    drawn: dict[str, np.ndarray]
    measures: dict[str, np.ndarray]

    def near(self, least: float, most: float) -> np.ndarray:
        """Return the indices of the runs whose PGA/(g tan γ) lies between the two values, in their order."""
        ratio = self.measures[UPLIFT]
        return np.flatnonzero((ratio >= least) & (ratio <= most))


def cloud(shipped: str, slendernesses: tuple[float, float], count: int) -> Cloud:
    """Draw `count` runs of a shipped scene; run k is under the synthetic motion of seed k.

    A smaller cloud is the beginning of a larger one.
    """
    usual = load_scene(shipped).with_(motion=None, duration=None)
    if usual.bearings is not None:
        usual = usual.with_(bearings={"x_max": X_MAX})
    ranges = dict(zip(DRAWN, (STRETCH, RADII, slendernesses, PEAKS), strict=True))
    uniform = np.random.Generator(np.random.PCG64(1)).random((count, len(DRAWN))).T
    drawn = {name: low * (high / low) ** u for (name, (low, high)), u in zip(ranges.items(), uniform, strict=True)}
    scenes = []
    for seed in range(count):
        stretch, radius, slenderness, peak = (float(drawn[name][seed]) for name in DRAWN)
        motion = synthetic_motion(seed=seed)
        samples = motion.samples * (peak * usual.gravity / motion.peak)
        shaking = SampledMotion(motion.dt * stretch, samples, f"{motion.label}, {stretch:.3g} times as slow")
        scenes.append(usual.with_(block={"radius": radius, "slenderness": slenderness}, motion=shaking))
    return Cloud(tuple(scenes), drawn, measures(scenes))


def measures(scenes: list[Scene]) -> dict[str, np.ndarray]:
    """Return {name: values of shape (n,)} of the intensity measures of scenes with sampled motions.

    They are the measures of the limit states, PGV [m/s], and on bearings Sa [g].
    """
    gravity = np.array([scene.gravity for scene in scenes])
    steepness = np.tan([scene.block.slenderness for scene in scenes])
    peak = np.array([scene.motion.peak for scene in scenes]) / gravity
    speed = np.array([peak_velocity(scene.motion) for scene in scenes])
    rocking = np.array([scene.rocking_frequency for scene in scenes])
    values = {UPLIFT: peak / steepness, STROKE: speed, ROCKING: rocking * speed / (gravity * steepness)}
    if scenes[0].bearings is None:
        return values
    displacement = np.array([displacement_spectrum(scene.motion, [PERIOD], [DAMPING])[0, 0] for scene in scenes])
    spectral = displacement * (2 * math.pi / PERIOD) ** 2 / gravity
    return {**values, "Sa": spectral, ISOLATED: spectral / steepness}


CHANGE = 1e-4  # relative change of the restitution: the model's own sensitivity
MODEL, PERTURBED = ("analytic", ""), ("analytic", "perturbed")
NEAR = (1.3, 6.0)  # PGA/(g tan γ) of the runs that engines make: outcomes are mixed there
TIME_LIMIT = 60.0  # s, of an engine's run; a stiff corner that hardly lifts may take more, and fails
# Numbers of runs of the analytic model, of the engines' main variants (with 73 motions or more, no difference shows
# equality), and of variants of the kind "defaults" (a few runs show large errors).
FULL, QUICK = (2000, 80, 20), (200, 6, 2)
# {limit state of |tilt|/slenderness: measure}; on bearings the measure is always `ISOLATED`. Of PGA, PGV and Sa, each
# also over g tan γ, these had the curves of least dispersion: a small tilt is an uplift, which PGA alone decides.
TILTS = {0.1: UPLIFT, 0.5: ROCKING, 1.0: ROCKING}
KEPT = ("overturns", "tilt", "displacement")


def variants_of(engines: Sequence[str]) -> list[tuple[str, str]]:
    """Return (engine, variant) of all compared: the main variant of every engine, then those of the kind "defaults"."""
    defaults = {name: get_engine(name).default_variant for name in engines}
    return [
        *defaults.items(),
        *(
            (name, variant)
            for name, default in defaults.items()
            for variant, spec in get_engine(name).variants.items()
            if spec.kind == "defaults" and variant != default
        ),
    ]


def measure(case: Case, response: Response) -> dict[str, Any]:
    """Return outcome and peaks of a run, and whether its end was decided."""
    return {
        "overturns": response.outcome == "overturns",
        "tilt": response.peak_tilt_ratio,
        "displacement": response.peak_base_displacement,
        "decided": response.decided,
    }


def beside_model(case: Case, response: Response) -> dict[str, Any]:
    """Measure an engine's run as `measure` does, and in what it differs from the model."""
    differences = compare(case.scene, response).differences
    return {**measure(case, response), "quantities": [difference.quantity for difference in differences]}


def plan(request: Request, scenes: dict[str, Any] | None = None, runs: tuple[int, int, int] | None = None) -> Plan:
    """Plan the study; it gives an answer after each scene.

    Rows by "part": "fit" and "effect" (see `comparisons.studies.fragility.study`), "run" (an engine's, its class by how
    the block ends), "cost" (CPU seconds per run), "check" and "failure". The model with its restitution changed by
    `CHANGE` is the variant "perturbed" of "analytic". Arrays, float32: ``<scene>/<drawn>``, of all runs, with PGV and,
    on bearings, Sa; ``<scene>/<engine>, <variant>/tilt`` and ``/displacement`` of the first in ``<scene>/near``
    (``<scene>/analytic/``: of all): NaN where a run failed, the tilt infinite where it overturned.

    Parameters
    ----------
    request : Request
    scenes, runs : dict and (int, int, int), optional
        They stand in place of `SCENES`, and of `FULL` or `QUICK`.
    """
    scenes = scenes or (dict(list(SCENES.items())[:1]) if request.quick else SCENES)
    counts, variants = runs or (QUICK if request.quick else FULL), variants_of(request.engines)
    rows, arrays = [], {}
    for name, (shipped, slendernesses) in scenes.items():
        drawn = cloud(shipped, slendernesses, counts[0])
        near, states = drawn.near(*NEAR)[: counts[1]], states_of(drawn)
        whole = yield Batch(_cases(enumerate(drawn.scenes), *MODEL), measure, f"{name}: analytic model")
        model = values_of(whole)
        undecided = sum(not row.values["decided"] for row in whole if not row.failed)
        failed = sum(row.failed for row in whole)
        ends = {int(seed): Reference.of(drawn.scenes[seed]).end_comparable for seed in near}
        check = {"runs": len(whole), "undecided": undecided, "failed": failed}
        own_rows = [
            *fits(drawn.measures, states, model),
            {"part": "check", "engine": "analytic", "variant": "", **check},
            *_cost_rows(MODEL, whole),
        ]
        scene_arrays = {
            **drawn.drawn,
            **{key: drawn.measures[key] for key in ("PGV", "Sa") if key in drawn.measures},
            **_stored_arrays("analytic", model),
        }
        for pair, cases in _engine_cases(drawn, near, counts[2], variants):
            label = ", ".join(filter(None, pair))
            run = yield Batch(cases, measure if pair == PERTURBED else beside_model, f"{name}: {label}", TIME_LIMIT)
            few, theirs = near[: len(cases)], values_of(run)
            ours = {key: array[few] for key, array in model.items()}
            own_rows += effects(drawn.measures, few, states, (ours, theirs), pair)
            own_rows += _cost_rows(pair, run)
            if pair != PERTURBED:
                own_rows += [
                    _run_row(pair, row, ends, falls) for row, falls in zip(run, ours["overturns"], strict=True)
                ]
            scene_arrays |= _stored_arrays(label, theirs)
        rows += [{"scene": name, **row} for row in own_rows]
        arrays |= {f"{name}/{key}": array.astype(np.float32) for key, array in scene_arrays.items()} | {
            f"{name}/near": near
        }
        answer = Computed(
            _settings(request, scenes, counts, variants), list(rows), dict(arrays), seed=[0, counts[0] - 1]
        )
        yield answer
    return answer


def states_of(drawn: Cloud) -> dict[str, State]:
    """Return the limit states by name."""
    bearings = drawn.scenes[0].bearings
    tilts = TILTS if bearings is None else dict.fromkeys(TILTS, ISOLATED)
    states = {f"|φ|/γ > {limit:g}": State("tilt", limit, measure) for limit, measure in tilts.items()}
    states["overturning"] = State("overturns", 0.5, tilts[1.0])
    if bearings is not None:
        states[f"displacement > {bearings.x_max:g} m"] = State("displacement", bearings.x_max, STROKE)
    return states


def values_of(results: Sequence[Row]) -> dict[str, np.ndarray]:
    """Return {each of `KEPT`: values of shape (n,)}; NaN where a run failed, the tilt infinite where it overturned."""
    values = {
        key: np.array([np.nan if row.failed else row.values[key] for row in results], dtype=float) for key in KEPT
    }
    values["tilt"][values["overturns"] == 1] = np.inf
    return values


def _cases(scenes: Iterable[tuple[int, Scene]], engine: str, variant: str) -> list[Case]:
    return [Case(scene, engine, variant or None, {"history": False}, {"seed": seed}) for seed, scene in scenes]


def _engine_cases(drawn: Cloud, near: np.ndarray, few: int, variants: Iterable[tuple[str, str]]) -> Iterator[tuple]:
    """Yield ((engine, variant), cases): the model with another restitution, then engines.

    Variants of the kind "defaults" run `few` cases.
    """
    chosen = [(int(seed), drawn.scenes[seed]) for seed in near]
    yield PERTURBED, _cases([(seed, _more_elastic(scene)) for seed, scene in chosen], *MODEL)
    for engine, variant in variants:
        default = variant == get_engine(engine).default_variant
        yield (engine, variant), _cases(chosen if default else chosen[:few], engine, variant)


def _more_elastic(scene):
    return scene.with_(block={"restitution": min(RockingModel.of(scene).restitution * (1 + CHANGE), 1.0)})


def _stored_arrays(label, values):
    return {f"{label}/{key}": values[key] for key in KEPT[1:]}


def _run_row(pair, row, ends, falls):
    """Row of an engine's run.

    ends: {seed: whether a run of its scene can be judged by how the block ends}. falls: whether the model's overturns.
    """
    seed = row.case.tag["seed"]
    quantities = row.values.get("quantities")
    columns = {"comparable": ends[seed], "class": class_of(ends[seed], quantities, END), "quantities": quantities}
    columns |= {"model_overturns": bool(falls), "overturns": row.values.get("overturns")}
    return {"part": "run", "engine": pair[0], "variant": pair[1], "seed": seed, **columns}


def _cost_rows(pair, results):
    """Rows on what runs cost, and on those that failed."""
    key = {"engine": pair[0], "variant": pair[1]}
    seconds = [row.cost["cpu_seconds"] for row in results if row.cost]
    mean = float(np.mean(seconds)) if seconds else None
    return [
        {"part": "cost", **key, "runs": len(results), "cpu_per_run": mean},
        *({"part": "failure", **key, "seed": row.case.tag["seed"], **row.failure} for row in results if row.failed),
    ]


def _settings(request, scenes, counts, variants):
    kinds = [(engine, variant, get_engine(engine).variants[variant]) for engine, variant in variants]
    return {
        "quick": request.quick,
        "scenes": {name: {"scene": shipped, "slendernesses": list(s)} for name, (shipped, s) in scenes.items()},
        "runs": counts[0],
        "runs_of_engines": counts[1],
        "runs_of_defaults": counts[2],
        "drawn": dict(zip(DRAWN, (list(STRETCH), list(RADII), None, list(PEAKS)), strict=True)),
        "near": list(NEAR),
        "period": PERIOD,
        "damping": DAMPING,
        "x_max": X_MAX,
        "change": CHANGE,
        "variants": [
            {"engine": engine, "variant": variant, "tier": spec.kind, "friction": spec.friction}
            for engine, variant, spec in kinds
        ],
    }
