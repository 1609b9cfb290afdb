"""The shake-table study: what the model and the engines say of blocks that were really shaken.

Each engine that ran a campaign's tests has a row beside the model and beside what was measured.

The statistics were fixed before this run, though after a prototype on the same tests. Right answers have the 95 %
interval of a bootstrap over records, as tests under one record at several scales are alike; misses and false alarms are
counted. Engines have the sign of their differences to the model (exact test). Probabilities have the Brier score;
forecasts are compared in pairs by the same bootstrap, and by which is right where two disagree. An engine is equal to
the model where the upper end of the interval of the share of tests that it ends differently is below `EQUAL`.
"""

import time
from collections.abc import Sequence
from dataclasses import asdict
from itertools import product
from typing import Annotated, Any

import numpy as np
import typer
from scipy.stats import binomtest

from analytic import Response, Scene, SceneError, SettingError, simulate_many
from analytic.rocking import RockingModel
from engines import get_engine
from engines.comparison import Reference

from ...execution.cases import Case, variant_settings
from ...execution.plan import Batch, Computed, Plan, Request
from ...execution.progress import bar
from ...execution.results import Result
from ...execution.sweep import Row
from ...metrics.statistics import EQUAL, TOO_FEW, Confusion, clustered, confusion, equality, mcnemar
from ...schemas.columns import declared, list_of, number_of, whole_of, word_of
from ..rows import SHARED
from .campaign import ALL, WHERE, Campaign, disclosed, outcomes_of, read_campaign
from .judging import AS_IT_IS, Outcomes, pairs_of, rows_of

# The columns of its rows, and by part which of them a row has; see `comparisons.studies.rows`.
COLUMNS = SHARED | declared(
    word_of("specimen", "specimen", "block that was tested"),
    word_of("test", "test", "name of the test in the campaign"),
    word_of("forecast", "predicted by", "what predicts the outcomes"),
    word_of("judged", "judged on tests", "tests on which it is judged, beside those it was fitted to"),
    whole_of("size", "size", "tests, five or more"),
    whole_of(
        "right",
        "right",
        "number of tests whose outcome is predicted; null: not disclosed, see shake_table.campaign.disclosed",
    ),
    whole_of("model_right", "model right", "number of the same tests whose outcome the model predicts"),
    whole_of("alone_right", "alone right", "right answers of the slenderness by itself, fitted to the same tests"),
    number_of("low", "low", "lower end of the 95 % interval of their share (bootstrap over records)"),
    number_of("high", "high", "upper end of the 95 % interval of their share (bootstrap over records)"),
    whole_of("misses", "misses", "tests that overturned and were predicted to stand"),
    whole_of("false_alarms", "false alarms", "tests that stood and were predicted to overturn"),
    number_of(
        "brier",
        "Brier score",
        "Brier score, the mean square error of the probability; null: the answer is yes or no",
        digits=2,
        within="brier_interval",
    ),
    list_of("brier_interval", "brier interval", "95 % interval of it (bootstrap over records): [low, high]"),
    word_of("change", "change of the model", "what is changed in the model"),
    number_of("slenderness", "slenderness", "slenderness that is right most often", "rad"),
    number_of("centre", "centre", "mean of the normal spread of slendernesses of least Brier score", "rad"),
    number_of("spread", "spread", "standard deviation of these slendernesses", "rad"),
    word_of("beside", "compared with", "forecast that it is compared with"),
    number_of("difference", "Brier score smaller by", "how much smaller its Brier score is, paired", within="interval"),
    list_of(
        "interval", "interval", "95 % interval: of that difference by bootstrap, of the share that differs Wilson's"
    ),
    whole_of("more_right", "more right", "how many more tests it is right in, paired"),
    list_of("more_interval", "more interval", "95 % interval of that number (bootstrap over records)"),
    whole_of("disagree", "disagree", "tests in which the two answer otherwise"),
    whole_of(
        "records_a", "records a", "records most of whose differences are of tests that overturn in the model alone"
    ),
    whole_of(
        "records_b", "records b", "records most of whose differences are of tests that overturn in the engine alone"
    ),
    number_of("p_records", "p, sign test by record", "p of a sign test of the two numbers of records"),
    list_of(
        "neighbours", "neighbours", "tests that the model itself ends differently at the next slenderness of the grid"
    ),
    whole_of(
        "near", "near", "tests in which a change of the scene by 1e-4 changes the model's outcome or time of a fall"
    ),
    whole_of("near_missed", "near missed", "tests among those that overturn in the model alone"),
    whole_of("near_added", "near added", "tests among those that overturn in the engine alone"),
    whole_of("near_failed", "near failed", "runs among those that failed"),
    word_of(
        "equal", "equal", "whether the engine ends as the model does, as comparisons.metrics.statistics.equality says"
    ),
    number_of(
        "tilt",
        "peak tilt over the model’s",
        "peak tilt over the model's where both rock and stay upright: median over tests",
        digits=3,
    ),
)
PARTS = {
    "score": """engine variant specimen forecast judged size right low high misses false_alarms brier?
            brier_interval?""",
    "fit": """engine variant specimen change slenderness centre spread alone_right neighbours size right brier
            brier_interval misses false_alarms""",
    "paired": """engine variant specimen forecast beside difference interval more_right more_interval disagree
            right""",
    "engine": """engine variant tier specimen size failed both_stand both_overturn only_a only_b p_value?
            records_a records_b p_records? near near_missed near_added near_failed equal interval right? low? high?
            misses? false_alarms? model_right? tilt?""",
    "failure": "engine variant specimen test kind reason message",
    "absent": "engine variant reason",
}

OVERTURNS, STANDS, FAILED = "1", "0", "x"


def leaning(
    scene: Scene, slenderness: float, *, restitution: float = 1, inertia: float = 1, friction: float | None = None
) -> Scene:
    """Return a scene whose block has another slenderness [rad], with its centre of mass as high as before.

    restitution: factor on that of the block. inertia: factor on the moment about the centre of mass. friction: in place
    of the scene's.
    """
    block = scene.block
    radius = float(block.half_height / np.cos(slenderness))
    corner = float(inertia * block.centre_inertia + block.mass * radius**2)
    changed = scene.with_(block={"radius": radius, "slenderness": float(slenderness), "corner_inertia": corner})
    if restitution != 1:
        changed = changed.with_(block={"restitution": restitution * RockingModel.of(changed).restitution})
    return changed if friction is None else changed.with_(friction=friction)


def over_slendernesses(case: Case, response: Response) -> dict[str, Any]:
    """Measure a digit for each slenderness, for each kind of model."""
    kinds, grid = case.tag["kinds"], case.tag["slendernesses"]
    scenes = [leaning(case.scene, slenderness, **kind) for kind in kinds for slenderness in grid]
    began = time.process_time()
    runs = simulate_many(scenes, workers=1)
    seconds = time.process_time() - began
    digits = np.where(runs.failed, FAILED, np.where(runs.overturns, OVERTURNS, STANDS))
    return {
        "outcomes": ["".join(row) for row in digits.reshape(len(kinds), -1).tolist()],
        "cost": {"grid_seconds": seconds},
    }


def ended(case: Case, response: Response) -> dict[str, Any]:
    """Measure how a run ended, and its peak tilt over the slenderness."""
    return {"outcome": response.outcome, "tilt": response.peak_tilt_ratio}


def ended_near(case: Case, response: Response) -> dict[str, Any]:
    """Measure the model's run as `ended` does, and whether a change of the scene by 1e-4 changes the outcome."""
    return {**ended(case, response), "near": "outcome" in Reference.of(case.scene).near}


NOT_RUN = "-"


def engine_rows(campaign: Campaign, model_runs: Sequence[Row], engine_runs: Sequence[Row]) -> list[dict[str, Any]]:
    """Return rows of an engine beside the model, for each specimen and for all together.

    They say in what their outcomes differ, and give right answers where these are disclosed. model_runs, engine_runs:
    runs at one slenderness each.
    """
    case, records, rows = engine_runs[0].case, [test.record for test in campaign.tests], []
    variant = case.variant or ""
    first = {"part": "engine", "engine": case.solver, "variant": variant}
    first["tier"] = get_engine(case.solver).variants[variant].kind
    sides = []
    for k, specimen in enumerate(campaign.specimens):
        ours, theirs = (
            [row for row in runs if row.case.tag["specimen"] == specimen.name] for runs in (model_runs, engine_runs)
        )
        near = np.array([row.values["near"] for row in ours])
        sides.append((_digits(campaign, theirs), _digits(campaign, ours), near))
        judged = answers(*sides[-1][:2], outcomes_of(campaign.tests, k), records)
        differing = differences(*sides[-1], records)
        rows.append({**first, "specimen": specimen.name, **differing, **judged, "tilt": _tilts(ours, theirs)})
    if len(sides) > 1:
        engine, model, near = (np.concatenate(part) for part in zip(*sides, strict=True))
        together = differences(engine, model, near, records * len(sides))
        rows.append({**first, "specimen": ALL, **together, **dict.fromkeys((*judged, "tilt"))})
    return rows


def _digits(campaign, rows):
    """Array of a digit for each test."""
    digits = {"failed": FAILED, "overturns": OVERTURNS}
    digit_of = {row.case.tag["test"]: digits.get(row.values["outcome"], STANDS) for row in rows}
    return np.array([digit_of.get(test.name, NOT_RUN) for test in campaign.tests])


def differences(engine: np.ndarray, model: np.ndarray, near: np.ndarray, records: Sequence[str]) -> dict[str, Any]:
    """Count how an engine's outcomes differ from the model's, in which direction, and whether the two are equal.

    p_value: of a sign test over tests. records_a, records_b, p_records: of a sign test over records, each of which has
    the sign of most of its differences, as those under one record are alike. A failed run has no sign, but differs.
    near: tests in which the model's own end is sensitive, see `ended_near`; near_missed, near_added, near_failed:
    differences in these. equal and interval are of all others.
    """
    sound, run_tests = np.isin(engine, [STANDS, OVERTURNS]), engine != NOT_RUN
    names = np.array(records)
    pair = confusion(model[sound] == OVERTURNS, engine[sound] == OVERTURNS) if sound.any() else Confusion(0, 0, 0, 0)
    away, edge = run_tests & ~near, run_tests & near
    equal, interval = equality((engine != model)[away], names[away].tolist()) if away.any() else (TOO_FEW, (0.0, 1.0))
    sign = np.where(sound, (model == OVERTURNS).astype(int) - (engine == OVERTURNS), 0)
    by_record = [int(np.sign(sign[names == name].sum())) for name in dict.fromkeys(records)]
    model_alone, engine_alone = by_record.count(1), by_record.count(-1)
    return {
        "size": int(run_tests.sum()),
        "failed": int((engine == FAILED).sum()),
        **asdict(pair),
        "p_value": mcnemar(pair) if sound.any() else None,
        "records_a": model_alone,
        "records_b": engine_alone,
        "p_records": float(binomtest(model_alone, model_alone + engine_alone).pvalue)
        if model_alone + engine_alone
        else None,
        "near": int(edge.sum()),
        "near_missed": int((sign[edge] == 1).sum()),
        "near_added": int((sign[edge] == -1).sum()),
        "near_failed": int((engine[edge] == FAILED).sum()),
        "equal": equal,
        "interval": list(interval),
    }


def answers(engine: np.ndarray, model: np.ndarray, measured: np.ndarray, records: Sequence[str]) -> dict[str, Any]:
    """Return right answers of an engine, and of the model on the same tests, with the interval of their share.

    A failed run is not right. Their difference is a sum over the tests that differ; misses and false alarms show how
    failed runs ended.
    """
    truth, run_tests = np.where(measured, OVERTURNS, STANDS), engine != NOT_RUN
    hit = (truth == engine)[run_tests]
    low, high = clustered(hit, np.array(records)[run_tests].tolist())
    right = {"right": int(hit.sum()), "low": low, "high": high, "model_right": int((truth == model)[run_tests].sum())}
    wrong = {
        "misses": int((measured & (engine == STANDS)).sum()),
        "false_alarms": int((~measured & (engine == OVERTURNS)).sum()),
    }
    sizes = len(hit), int((engine != model)[run_tests].sum())
    return disclosed(right, *sizes) | disclosed(wrong, *sizes, int((engine == FAILED).sum()))


def _tilts(model_runs, engine_runs):
    """Median of an engine's peak tilts over the model's where both rock and stay upright; None if nowhere."""
    model = {row.case.tag["test"]: row.values for row in model_runs}
    pairs = ((row.values, model[row.case.tag["test"]]) for row in engine_runs if not row.failed)
    ratios = [a["tilt"] / b["tilt"] for a, b in pairs if a["outcome"] == b["outcome"] == "rocks"]
    return float(np.median(ratios)) if ratios else None


SEED = 0  # of the bootstrap
QUICK = 20  # a quick study has one of so many tests
OTHERS = 6  # other engines, and further variants of subject engines, run one of so many tests
TIME_LIMIT = 900.0  # s, of an engine's run
# What is changed in the model, one at a time; the first is without a change. The friction of granite on a steel table
# is not known.
KINDS: tuple[dict[str, float], ...] = (
    {},
    *({"restitution": factor} for factor in (0.98, 0.95, 0.9, 0.85, 0.8)),
    *({"friction": value} for value in (0.5, 0.3)),
    *({"inertia": factor} for factor in (0.93, 1.07)),
)

Data = Annotated[
    str | None,
    typer.Option(metavar="FOLDER", help="Folder of the tests, as their authors publish them, or of your own."),
]


def plan(request: Request, *, data: Data = None) -> Plan:
    """Plan the study; it gives an answer after each variant.

    Rows by "part": "score" (of a forecast, see `judging`), "paired", "fit" (of the model to all tests), "engine"
    (beside the model) and "failure"; "absent", alone, without data. Arrays ``right/<kind>``: right answers of the model
    by specimen and slenderness. `campaign.disclosed` decides what is stored of the tests.

    Parameters
    ----------
    request : Request
    data : str, optional
        Folder of the tests, see `campaign`.
    """
    if data is None:
        reason = f"--data is missing: {WHERE}"
        row = {"part": "absent", "engine": "analytic", "variant": "", "reason": reason}
        return Computed({"quick": request.quick, "campaign": "", "variants": []}, [row])
    with bar("reading the tests") as progress:
        campaign = read_campaign(data, QUICK if request.quick else 1, progress)
    kinds = _kinds(campaign)
    model = yield Batch(_grid_cases(campaign, kinds), over_slendernesses, "model over slenderness")
    outcomes_by_specimen = _outcomes(campaign, model, len(kinds))
    places = [outcomes[0].best(np.ones(len(campaign.tests), dtype=bool)) for outcomes in outcomes_by_specimen]
    slendernesses = [
        float(outcomes[0].slendernesses[place]) for outcomes, place in zip(outcomes_by_specimen, places, strict=True)
    ]
    names = [_name(kind) for kind in kinds]
    probabilities, parts = zip(
        *(rows_of(campaign, k, outcomes, names) for k, outcomes in enumerate(outcomes_by_specimen)), strict=True
    )
    rows = [row for part in parts for row in part] + pairs_of(campaign, probabilities)
    settings = _settings(request, campaign, slendernesses) | {"kinds": names}
    settings["model_runs"] = len(model) * len(kinds) * outcomes_by_specimen[0][0].slendernesses.size
    settings["cpu_seconds"] = float(sum(row.cost["grid_seconds"] for row in model))
    arrays = {
        f"right/{name}": np.array(
            [(outcomes[k].model == outcomes[k].measured[:, None]).sum(axis=0) for outcomes in outcomes_by_specimen]
        )
        for k, name in enumerate(names)
    }
    model_runs = yield Batch(_fitted_cases(campaign, slendernesses, "analytic", None, 1), ended_near, "model")
    answer = Computed(settings, rows, arrays, seed=SEED)
    yield answer
    for engine, variant, every in [outcomes for name in request.engines for outcomes in _variants(name)]:
        ran = yield Batch(
            _fitted_cases(campaign, slendernesses, engine, variant, every), ended, f"{engine}, {variant}", TIME_LIMIT
        )
        rows = [*rows, *engine_rows(campaign, model_runs, ran), *(_failure(row) for row in ran if row.failed)]
        settings = {**settings, "variants": [*settings["variants"], variant_settings(engine, variant)]}
        answer = Computed(settings, rows, arrays, seed=SEED)
        yield answer
    return answer


def _name(kind):
    """Name of a kind of model."""
    words = (f"{name} {'' if name == 'friction' else 'times '}{value:g}" for name, value in kind.items())
    return ", ".join(words) or AS_IT_IS


def _variants(name: str) -> list[tuple[str, str, int]]:
    """Return (engine, variant, stride): subject engines run every test with their main variant and defaults."""
    engine = get_engine(name)
    chosen = [
        engine.default_variant,
        *(variant for variant, spec in engine.variants.items() if spec.kind == "defaults"),
    ]
    return [(name, variant, 1 if engine.subject else OTHERS) for variant in dict.fromkeys(chosen)]


def _kinds(campaign: Campaign) -> list[dict[str, float]]:
    """Return the kinds of `KINDS` that the model takes: it has no given restitution for a block that slides.

    Raises
    ------
    SettingError
        A block cannot be of the slendernesses between which the fitted one is sought.
    """
    slides = any(specimen.scene.friction is not None for specimen in campaign.specimens)
    kinds = [dict(kind) for kind in KINDS if not (slides and "restitution" in kind)]
    for specimen in campaign.specimens:
        for slenderness, kind in product(specimen.span, kinds):
            try:
                leaning(specimen.scene, slenderness, **kind)
            except SceneError as error:
                raise SettingError(
                    f"{specimen.name}: a slenderness of {slenderness:.4g} rad, which is tried: {error}"
                ) from error
    return kinds


def _grid_cases(campaign: Campaign, kinds: Sequence[dict[str, float]]) -> list[Case]:
    return [
        Case(
            specimen.scene.with_(motion=test.motion),
            settings={"history": False},
            tag={"test": test.name, "specimen": specimen.name, "slendernesses": specimen.slendernesses().tolist()}
            | {"kinds": list(kinds)},
        )
        for test in campaign.tests
        for specimen in campaign.specimens
    ]


def _fitted_cases(campaign, slendernesses, solver, variant, every):
    """Cases of a solver at the fitted slendernesses, on one in `every` tests."""
    return [
        Case(
            leaning(specimen.scene, slenderness).with_(motion=test.motion, name=specimen.name),
            solver,
            variant,
            {"history": False},
            {"test": test.name, "specimen": specimen.name},
        )
        for specimen, slenderness in zip(campaign.specimens, slendernesses, strict=True)
        for test in campaign.tests[::every]
    ]


def _failure(row):
    failure = {name: row.failure.get(name) or "" for name in ("kind", "reason", "message")}
    return {"part": "failure", "engine": row.case.solver, "variant": row.case.variant, **row.case.tag, **failure}


def _outcomes(campaign: Campaign, rows: Sequence[Row], kinds: int) -> list[list[Outcomes]]:
    """Outcomes by specimen and kind of model."""
    if failed := next((row for row in rows if row.failed), None):
        raise SettingError(f"test {failed.case.tag['test']}: the model failed ({failed.failure['reason']})")
    by_specimen = []
    for k, specimen in enumerate(campaign.specimens):
        texts_by_kind = [row.values["outcomes"] for row in rows if row.case.tag["specimen"] == specimen.name]
        overturned = np.array([[[digit == OVERTURNS for digit in text] for text in texts] for texts in texts_by_kind])
        measured, grid = outcomes_of(campaign.tests, k), specimen.slendernesses()
        by_specimen.append([Outcomes(grid, overturned[:, kind], measured) for kind in range(kinds)])
    return by_specimen


def _settings(request, campaign, slendernesses):
    tests = campaign.tests
    return {
        "quick": request.quick,
        "campaign": campaign.name,
        "digest": campaign.digest(),
        "cite": campaign.cite,
        "tests": [test.name for test in tests],
        "records": len({test.record for test in tests}),
        "missing": _tests_without_motion(campaign),
        "published": campaign.published,
        "steps": sorted({test.motion.dt for test in tests}),
        "overturned": [int(outcomes_of(tests, k).sum()) for k in range(len(campaign.specimens))],
        "agree": _same_outcomes(tests),
        "specimens": [
            {
                "name": specimen.name,
                "height": specimen.scene.block.half_height,
                "gyration": float(np.sqrt(specimen.scene.block.centre_inertia / specimen.scene.block.mass)),
                "span": list(specimen.span),
                "grid": specimen.slendernesses().tolist(),
                "slenderness": slenderness,
                "note": specimen.note,
            }
            for specimen, slenderness in zip(campaign.specimens, slendernesses, strict=True)
        ],
        "equal": EQUAL,
        "others": OTHERS,
        "variants": [],
    }


def _tests_without_motion(campaign):
    """Describe the tests without a motion.

    The values are how many there are; how many of them overturned, if single tests are not told by it; and geometric
    means of PGV/PGA [s] of them and of the others, where these are stated.
    """
    tests = campaign.missing
    numbers: dict[str, Any] = {"overturned": None, "ratios": None}
    if tests:
        numbers["overturned"] = [int(outcomes_of(tests, k).sum()) for k in range(len(campaign.specimens))]
        if all("ratio" in test.stated for test in (*tests, *campaign.tests)):
            sides = ([test.stated["ratio"] for test in members] for members in (tests, campaign.tests))
            numbers["ratios"] = [float(np.exp(np.log(ratios).mean())) for ratios in sides]
    return {"tests": len(tests), **disclosed(numbers, len(tests))}


def _same_outcomes(tests):
    """Count the tests in which the first two specimens end alike; None with one specimen."""
    if len(tests[0].overturned) < 2:
        return None
    return sum(test.overturned[0] == test.overturned[1] for test in tests)


def problems(result: Result) -> list[str]:
    """Return why nothing was run; empty if something was."""
    return [row["reason"] for row in result.rows if row["part"] == "absent"]
