"""The study of recorded motions: each component free-standing and isolated, in model and engines.

A block and a scale are drawn for each component, and for the isolated block a base on bearings too. They follow from a
fixed seed and the component's name alone, so no result could choose them.
"""

import hashlib
import itertools
import math
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from analytic import Base, Bearings, Response, SampledMotion, Scene, SceneError, simulate
from analytic.records.content import PREFIX
from analytic.records.folder import folder_motions
from analytic.response import OUTCOMES
from analytic.rocking import BearingLaw, design_bearings
from analytic.scene import MASS, caryatid_block
from engines import get_engine
from engines.comparison import END, LEAST_DISPLACEMENT, Reference, compare
from engines.events import LEAST_TILT

from ...ensembles import Folder, peak_velocity, source_of
from ...execution.cases import Case, variant_settings
from ...execution.plan import Batch, Computed, Plan, Request
from ...execution.results import Result
from ...execution.sweep import Row
from ...metrics.errors import PERTURBATION, SAMPLES_PER_PERIOD, sensitivity_horizon, solver_horizon
from ...metrics.statistics import EQUAL, class_of
from ...schemas.columns import declared, number_of, word_of
from ..rows import SHARED

# The columns of its rows, and by part which of them a row has; see `comparisons.studies.rows`.
COLUMNS = SHARED | declared(
    word_of("record", "record", "name of the record, of both its components"),
    word_of("component", "component", 'component of the record: "a" or "b"'),
    word_of("configuration", "configuration", '"free-standing" or "isolated"'),
    number_of("intensity", "intensity", "peak ground velocity times omega_r over g tan(slenderness), as scaled"),
    number_of("scale", "scale", "factor on the motion as it was recorded"),
    number_of("base_mass", "base mass", "mass of the base over the block's"),
    number_of("period", "period", "period of block and base on the bearings, secant at x_max of the settings", "s"),
    number_of("damping", "damping", "equivalent viscous damping of the bearings there, over the critical one"),
    number_of("tilt", "tilt", "peak tilt of the run over the slenderness"),
    number_of("displacement", "displacement", "peak base displacement of the run", "m"),
    number_of("horizon", "horizon", "time up to which peaks are compared in all engines", "s"),
    number_of("own_horizon", "own horizon", "time up to which the engine's own errors let peaks be compared", "s"),
    word_of("class", "class", '"right" or "differs" (how the block ends, and when), "failed" or "left out"'),
    word_of("model_outcome", "model", "outcome of the analytic model"),
    number_of("model_tilt", "peak tilt, model", "peak tilt of the analytic model over the slenderness"),
    number_of("model_displacement", "model displacement", "peak base displacement of the analytic model", "m"),
    number_of(
        "tilt_error", "peak tilt, common", "relative error of the peak tilt up to the common horizon", percent=True
    ),
    number_of(
        "displacement_error",
        "peak base displacement, common",
        "relative error of the peak base displacement up to the common horizon",
        percent=True,
    ),
    number_of(
        "own_tilt_error",
        "peak tilt, own",
        "relative error of the peak tilt up to the engine's own horizon",
        percent=True,
    ),
    number_of(
        "own_displacement_error",
        "peak base displacement, own",
        "relative error of the peak base displacement up to the engine's own horizon",
        percent=True,
    ),
)
PARTS = {
    "scene": """engine variant record component configuration slenderness intensity scale outcome tilt displacement
            comparable horizon""",
    "run": """engine variant tier record component configuration class comparable horizon model_outcome model_tilt
            model_displacement outcome | differences quantities tilt displacement own_horizon tilt_error?
            displacement_error? own_tilt_error? own_displacement_error?""",
    "absent": "engine variant reason",
}

SEED = 695
X_MAX = 0.30  # m, at which period and damping of the bearings hold
LAWS = ("algebraic", "bouc-wen", "bilinear")
# Chosen once by the outcomes of the analytic model alone: both outcomes occur, few blocks do not lift. intensity:
# omega_r PGV/(g tan(slenderness)); base_mass: over the block's; period [s] and damping of the bearings at X_MAX.
RANGES: dict[str, dict[str, tuple[float, float]]] = {
    "free-standing": {"slenderness": (0.1, 0.3), "intensity": (0.35, 1.8)},
    "isolated": {
        "slenderness": (0.1, 0.2),
        "intensity": (0.5, 1.6),
        "base_mass": (0.1, 2.0),
        "period": (1.0, 2.0),
        "damping": (0.1, 0.2),
    },
}
LOGARITHMIC = ("intensity", "base_mass")  # drawn evenly over the logarithm


def drawn_scene(configuration: str, name: str, motion: SampledMotion) -> tuple[Scene, dict[str, Any]]:
    """Return the scene of a component, and what was drawn for it.

    name: the component's. motion: as it was recorded.
    """
    seed = int(hashlib.sha256(f"{configuration} {name}".encode()).hexdigest()[:16], 16)
    rng = np.random.default_rng([SEED, seed])
    drawn: dict[str, Any] = {key: _draw(rng, key, *ends) for key, ends in RANGES[configuration].items()}
    scene = Scene(block=caryatid_block(drawn["slenderness"]), name=f"{name}, {configuration}")
    if "period" in drawn:
        drawn["law"] = str(rng.choice(LAWS))
        base = Base(mass=MASS * drawn["base_mass"])
        bearings = design_bearings(MASS + base.mass, drawn["period"], drawn["damping"], X_MAX)
        scene = scene.with_(base=base, bearings=_by_law(bearings, drawn["law"]))
    uplift = scene.gravity * math.tan(drawn["slenderness"])
    drawn["scale"] = drawn["intensity"] * uplift / (scene.rocking_frequency * peak_velocity(motion))
    return scene.with_(motion=motion.scaled(drawn["scale"])), drawn


def _draw(rng: np.random.Generator, key: str, low: float, high: float) -> float:
    """Draw a value between `low` and `high`, evenly or evenly over the logarithm."""
    return low * (high / low) ** rng.random() if key in LOGARITHMIC else float(rng.uniform(low, high))


def _by_law(bearings: Bearings, law: str) -> Bearings:
    """Return bearings of another law with the stiffnesses and the characteristic strength of algebraic ones."""
    if law != "bilinear":
        return Bearings(**{**bearings.model_dump(), "law": law})
    algebraic = BearingLaw.of(bearings)
    strength = algebraic.f0 / (1 - bearings.given("kb") / bearings.ka)
    return Bearings(law=law, count=bearings.count, ka=bearings.ka, kb=bearings.kb, yield_force=strength, x_max=X_MAX)


# numbers of records for the tuned variants of subject engines (None: all), and for the other variants
FULL, QUICK = (None, 20), (2, 1)
TIME_LIMIT = 900.0  # s, of a run: motions last up to 90 s, steps are fixed, and the machine may be busy
NAMES = ("record", "component", "configuration")
ERRORS = ("tilt_error", "displacement_error", "own_tilt_error", "own_displacement_error")


def plan(request: Request, *, records: Folder = None) -> Plan:
    """Plan the study; it gives an answer after each variant.

    Rows by "part": "scene" holds what was drawn for a component in a configuration, and the model's answer; "run" holds
    one run of an engine beside that answer; "absent" stands alone where there are no records. Of a record the answer
    keeps its name, the scale, outcomes, peaks and times of falls.

    Parameters
    ----------
    request : Request
    records : str, optional
        Folder of records, or a set of FEMA P695, in place of all of these.
    """
    try:
        moving, left_out = _shuffled(records)
    except SceneError as error:
        if records is not None:
            raise
        row = {"part": "absent", "engine": "analytic", "variant": "", "reason": f"{error.problem}; {error.remedy}"}
        return Computed({"quick": request.quick, "records": 0, "variants": []}, [row])
    many, few = QUICK if request.quick else FULL
    names = list(moving)
    model = yield Batch(_model_cases({name: moving[name] for name in names[:many]}), of_model, "analytic model")
    scenes = [(row.case.scene, {**row.case.tag, **row.values}) for row in model if not row.failed]
    scene_rows = [drawn for _, drawn in scenes]
    settings: dict[str, Any] = {
        "quick": request.quick,
        "source": source_of(records),
        "records": len(names[:many]),
        "records_of_others": len(names[:few]),
        "left_out": left_out,
        "ranges": RANGES,
        "laws": LAWS,
        "x_max": X_MAX,
        "mix": {name: _outcome_counts(name, scene_rows) for name in RANGES},
        "perturbation": PERTURBATION,
        "equal": EQUAL,
        "variants": [],
    }
    rows: list[dict[str, Any]] = [
        {"part": "scene", "engine": "analytic", "variant": "", **drawn} for drawn in scene_rows
    ]
    answer = Computed(settings, rows, seed=SEED)
    for engine, variant, on_all in itertools.chain.from_iterable(map(_variants, request.engines)):
        cases = [
            Case(scene, engine, variant, {"history": True}, {key: drawn[key] for key in (*NAMES, "horizon")})
            for scene, drawn in scenes
            if on_all or drawn["record"] in names[:few]
        ]
        runs = yield Batch(cases, of_engine, f"{engine}, {variant}", TIME_LIMIT)
        rows = [*rows, *(_run_row(row, scene_rows) for row in runs)]
        settings = {**settings, "variants": [*settings["variants"], variant_settings(engine, variant)]}
        answer = Computed(settings, rows, seed=SEED)
        yield answer
    return answer


def _shuffled(records: str | None) -> tuple[dict[str, list[SampledMotion]], list[str]]:
    """Return the components of a folder's records, and what is left out and why.

    The components are {record: motions}, in an order drawn by `SEED`.
    """
    folder, left_out = folder_motions(records or PREFIX)
    still = [name for name, motions in folder.items() if not all(motion.peak for motion in motions)]
    left_out += [f"{name}: left out, it does not move" for name in still]
    names = np.random.default_rng(SEED).permutation([name for name in folder if name not in still])
    return {str(name): folder[str(name)] for name in names}, left_out


def _variants(name: str) -> Iterator[tuple[str, str, bool]]:
    """Yield (engine, variant, whether it runs all records): tuned variants, and the defaults of subject engines."""
    engine = get_engine(name)
    for variant, spec in engine.variants.items():
        if spec.kind == "tuned" or (engine.subject and spec.kind == "defaults"):
            yield name, variant, engine.subject and spec.kind == "tuned"


def _model_cases(records: dict[str, list[SampledMotion]]) -> list[Case]:
    """Cases of each component in each configuration, with what was drawn for it."""
    return [
        Case(scene, settings={"history": False}, tag=dict(zip(NAMES, (record, component, name), strict=True)) | drawn)
        for record, motions in records.items()
        for component, motion in zip("ab", motions, strict=False)
        for name in RANGES
        for scene, drawn in (drawn_scene(name, motion.label, motion),)
    ]


def of_model(case: Case, response: Response) -> dict[str, Any]:
    """Measure the model's run.

    comparable: "yes", or why no engine's run is compared with it.
    """
    scene, comparable = case.scene, Reference.of(case.scene).end_comparable
    fallen = response.outcome == "overturns"
    horizon = min(sensitivity_horizon(scene).horizon, response.unstable_time if fallen else np.inf)
    return {**_outcome_and_peaks(response), "comparable": comparable, "horizon": float(horizon)}


def of_engine(case: Case, response: Response) -> dict[str, Any]:
    """Measure an engine's run: its differences from the model, and the relative errors of its peaks.

    The errors are taken up to the horizon common to all engines, and up to the engine's own.
    """
    step = 2 * np.pi / case.scene.rocking_frequency / SAMPLES_PER_PERIOD
    model = simulate(case.scene, output_step=step)
    own_horizon = solver_horizon(case.scene, response, model).horizon
    if model.outcome == "overturns":
        own_horizon = min(own_horizon, model.unstable_time)
    errors = [
        *_errors(case.scene, response, model, case.tag["horizon"]),
        *_errors(case.scene, response, model, own_horizon),
    ]
    differences = compare(case.scene, response).differences
    compared = {
        "differences": [str(difference) for difference in differences],
        "quantities": [difference.quantity for difference in differences],
    }
    return {
        **_outcome_and_peaks(response),
        **compared,
        "own_horizon": own_horizon,
        **dict(zip(ERRORS, errors, strict=True)),
    }


def _outcome_and_peaks(response):
    """Outcome and peaks of a run."""
    peaks = {"tilt": response.peak_tilt_ratio, "displacement": response.peak_base_displacement}
    return {"outcome": response.outcome, **peaks}


def _errors(scene: Scene, response: Response, model: Response, until: float) -> Iterator[float | None]:
    """Yield the relative errors of peak tilt and peak base displacement up to a time.

    An error is None where the model's peak is too small to count.
    """
    length = scene.block.slenderness
    for name, least in (
        ("tilt", LEAST_TILT * length),
        ("base_displacement", LEAST_DISPLACEMENT * scene.block.radius * length),
    ):
        peak, model_peak = (_peak(run.history, name, until) for run in (response, model))
        yield peak / model_peak - 1 if model_peak >= least else None


def _peak(history, name, until):
    """Return the largest size of a quantity up to and at a time; a growing tilt has its peak at that time."""
    values = getattr(history, name)
    return float(np.abs([*values[history.time <= until], np.interp(until, history.time, values)]).max())


def _run_row(row: Row, scene_rows: Iterable[dict[str, Any]]) -> dict[str, Any]:
    tag = {key: row.case.tag[key] for key in NAMES}
    (model,) = (scene_row for scene_row in scene_rows if tag.items() <= scene_row.items())
    variant = get_engine(row.case.solver).variants[row.case.variant]
    return {
        "part": "run",
        "engine": row.case.solver,
        "variant": row.case.variant,
        "tier": variant.kind,
        **tag,
        "class": class_of(model["comparable"], row.values.get("quantities"), END),
        "comparable": model["comparable"],
        "horizon": model["horizon"],
        **{f"model_{key}": model[key] for key in ("outcome", "tilt", "displacement")},
        **({"outcome": "failed", "failure": row.failure} if row.failed else row.values),
    }


def _outcome_counts(configuration, scene_rows):
    """Count how often each outcome comes in the model."""
    outcomes = [row["outcome"] for row in scene_rows if row["configuration"] == configuration]
    return {outcome: outcomes.count(outcome) for outcome in OUTCOMES if outcome in outcomes}


def problems(result: Result) -> list[str]:
    """Return why nothing was run; empty if something was."""
    return [row["reason"] for row in result.rows if row["part"] == "absent"]
