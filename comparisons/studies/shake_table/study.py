"""The study of a shake table: what the model and the engines say of blocks that were really shaken.

Statistics, fixed before this run, though after a prototype on the same tests: right answers with the 95 % interval of a
bootstrap over records, as tests under one record at several scales are alike; misses and false alarms; of engines the
sign of their differences to the model (exact test); of probabilities the Brier score, and differences of
forecasts in pairs by the same bootstrap; who is right where two disagree. An engine is equal to the model where the
upper end of the interval of the share of tests that it ends differently is below `EQUAL`.
"""

from collections.abc import Sequence
from itertools import product
from typing import Annotated, Any

import numpy as np
import typer

from analytic import SceneError, SettingError
from engines import get_engine

from ...measuring.statistics import EQUAL
from ...running.cases import Case, variant_settings
from ...running.plan import Batch, Computed, Plan, Request
from ...running.progress import bar
from ...running.provenance import Result
from ...running.sweep import Row
from .campaign import WHERE, Campaign, outcomes_of, read_campaign, told
from .judging import AS_IT_IS, Outcomes, pairs_of, rows_of
from .runs import OVERTURNS, ended, ended_near, engine_rows, leaning, over_slendernesses

SEED = 0  # of the bootstrap
QUICK = 20  # of so many tests one
OTHERS = 6  # of so many tests engines that are not in question, and their further variants, run one
TIME_LIMIT = 900.0  # s, of an engine's run
# What is changed in the model, one at a time; the first is as it is. Friction: granite on a steel table is not known.
KINDS: tuple[dict[str, float], ...] = (
    {},
    *({"restitution": factor} for factor in (0.98, 0.95, 0.9, 0.85, 0.8)),
    *({"friction": value} for value in (0.5, 0.3)),
    *({"inertia": factor} for factor in (0.93, 1.07)),
)

Data = Annotated[
    str | None, typer.Option(metavar="FOLDER", help="The tests: as their authors publish them, or your own.")
]


def plan(request: Request, *, data: Data = None) -> Plan:
    """The plan of the study; an answer with one variant more each time.

    Rows by "part": "score" (of a forecast, see `judging`), "paired", "fit" (of the model to all tests), "engine"
    (beside the model) and "failure"; "absent", alone, without data. Arrays ``right/<kind>``: right answers of the model
    by specimen and slenderness. What is stored of the tests: `campaign.told`.

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
    model = yield Batch(_on_grids(campaign, kinds), over_slendernesses, "model over slenderness")
    known = _outcomes(campaign, model, len(kinds))
    places = [one[0].best(np.ones(len(campaign.tests), dtype=bool)) for one in known]
    slendernesses = [float(one[0].slendernesses[place]) for one, place in zip(known, places, strict=True)]
    names = [_name(kind) for kind in kinds]
    found, parts = zip(*(rows_of(campaign, k, one, names) for k, one in enumerate(known)), strict=True)
    rows = [row for part in parts for row in part] + pairs_of(campaign, found)
    settings = _settings(request, campaign, slendernesses) | {"kinds": names}
    settings["model_runs"] = len(model) * len(kinds) * known[0][0].slendernesses.size
    settings["cpu_seconds"] = float(sum(row.cost["grid_seconds"] for row in model))
    arrays = {
        f"right/{name}": np.array([(one[k].model == one[k].measured[:, None]).sum(axis=0) for one in known])
        for k, name in enumerate(names)
    }
    own = yield Batch(_at(campaign, slendernesses, "analytic", None, 1), ended_near, "model")
    answer = Computed(settings, rows, arrays, seed=SEED)
    yield answer
    for engine, variant, every in [one for name in request.engines for one in _variants(name)]:
        ran = yield Batch(
            _at(campaign, slendernesses, engine, variant, every), ended, f"{engine}, {variant}", TIME_LIMIT
        )
        rows = [*rows, *engine_rows(campaign, own, ran), *(_failure(row) for row in ran if row.failed)]
        settings = {**settings, "variants": [*settings["variants"], variant_settings(engine, variant)]}
        answer = Computed(settings, rows, arrays, seed=SEED)
        yield answer
    return answer


def _name(kind):
    words = (f"{name} {'' if name == 'friction' else 'times '}{value:g}" for name, value in kind.items())
    return ", ".join(words) or AS_IT_IS


def _variants(name: str) -> list[tuple[str, str, int]]:
    """(engine, variant, of how many tests one is run): of those in question the main variant and the defaults, all."""
    engine = get_engine(name)
    chosen = [engine.default_variant, *(one for one, spec in engine.variants.items() if spec.kind == "defaults")]
    return [(name, one, 1 if engine.subject else OTHERS) for one in dict.fromkeys(chosen)]


def _kinds(campaign: Campaign) -> list[dict[str, float]]:
    """Those of `KINDS` that the model takes: it knows no given restitution of a block that slides.

    Raises
    ------
    SettingError
        A block cannot be of the slendernesses between which the fitted one is sought.
    """
    slides = any(one.scene.friction is not None for one in campaign.specimens)
    kinds = [dict(kind) for kind in KINDS if not (slides and "restitution" in kind)]
    for one in campaign.specimens:
        for slenderness, kind in product(one.span, kinds):
            try:
                leaning(one.scene, slenderness, **kind)
            except SceneError as error:
                raise SettingError(
                    f"{one.name}: a slenderness of {slenderness:.4g} rad, which is tried: {error}"
                ) from error
    return kinds


def _on_grids(campaign: Campaign, kinds: Sequence[dict[str, float]]) -> list[Case]:
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


def _at(campaign, slendernesses, solver, variant, every):
    """Cases of a solver at the fitted slendernesses, on one of so many tests."""
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
    """By specimen and kind."""
    if failed := next((row for row in rows if row.failed), None):
        raise SettingError(f"test {failed.case.tag['test']}: the model failed ({failed.failure['reason']})")
    found = []
    for k, specimen in enumerate(campaign.specimens):
        own = [row.values["outcomes"] for row in rows if row.case.tag["specimen"] == specimen.name]
        overturned = np.array([[[digit == OVERTURNS for digit in text] for text in one] for one in own])
        measured, grid = outcomes_of(campaign.tests, k), specimen.slendernesses()
        found.append([Outcomes(grid, overturned[:, kind], measured) for kind in range(kinds)])
    return found


def _settings(request, campaign, slendernesses):
    tests = campaign.tests
    return {
        "quick": request.quick,
        "campaign": campaign.name,
        "digest": campaign.digest(),
        "cite": campaign.cite,
        "tests": [test.name for test in tests],
        "records": len({test.record for test in tests}),
        "missing": _missing(campaign),
        "published": campaign.published,
        "steps": sorted({test.motion.dt for test in tests}),
        "overturned": [int(outcomes_of(tests, k).sum()) for k in range(len(campaign.specimens))],
        "agree": _agree(tests),
        "specimens": [
            {
                "name": one.name,
                "height": one.scene.block.half_height,
                "gyration": float(np.sqrt(one.scene.block.centre_inertia / one.scene.block.mass)),
                "span": list(one.span),
                "grid": one.slendernesses().tolist(),
                "slenderness": slenderness,
                "note": one.note,
            }
            for one, slenderness in zip(campaign.specimens, slendernesses, strict=True)
        ],
        "equal": EQUAL,
        "others": OTHERS,
        "variants": [],
    }


def _missing(campaign):
    """Of the tests without a motion: how many there are and, where it says nothing of single ones, how many of them
    overturned; and geometric means of PGV/PGA [s] of them and of the others, where they are stated."""
    tests = campaign.missing
    found: dict[str, Any] = {"overturned": None, "ratios": None}
    if tests:
        found["overturned"] = [int(outcomes_of(tests, k).sum()) for k in range(len(campaign.specimens))]
        if all("ratio" in test.stated for test in (*tests, *campaign.tests)):
            sides = ([test.stated["ratio"] for test in some] for some in (tests, campaign.tests))
            found["ratios"] = [float(np.exp(np.log(one).mean())) for one in sides]
    return {"tests": len(tests), **told(found, len(tests))}


def _agree(tests):
    """In how many tests the first two specimens end alike; None with one."""
    if len(tests[0].overturned) < 2:
        return None
    return sum(test.overturned[0] == test.overturned[1] for test in tests)


def problems(result: Result) -> list[str]:
    """Why nothing was run, where it was not."""
    return [row["reason"] for row in result.rows if row["part"] == "absent"]
