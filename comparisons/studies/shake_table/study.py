"""The study of a shake table: what the model and the engines say of blocks that were really shaken.

Statistics, said before the results: right answers with the 95 % interval of a bootstrap over records, as tests under
one record at several scales are alike; misses and false alarms; of engines the sign of their differences to the model
(exact test); of probabilities the Brier score, its difference to that of PGV, paired, by the same bootstrap, and
reliability; who is right where the model and PGV disagree. An engine is equal to the model where the upper limit of the
share of tests that it ends otherwise is below `EQUAL`.
"""

from collections.abc import Sequence
from typing import Annotated, Any

import numpy as np
import typer

from analytic import SettingError
from engines import get_engine

from ...measuring.forecasts import reliability, right
from ...measuring.statistics import EQUAL
from ...running.cases import Case, variant_settings
from ...running.plan import Batch, Computed, Plan, Request
from ...running.progress import bar
from ...running.provenance import Result
from ...running.sweep import Row
from . import at_hand, granite
from .campaign import Campaign, outcomes_of
from .judging import (
    AS_IT_IS,
    AUTHORS,
    BOTH,
    BY_HALVES,
    BY_RECORD,
    IN_SAMPLE,
    MODEL,
    ONE,
    PGV,
    THRESHOLD,
    Forecast,
    Outcomes,
    forecasts,
    judged,
    paired,
    score,
)
from .measures import measures_of
from .reading import read_campaign
from .runs import engine_rows, run_row
from .shaking import OVERTURNS, ended, ended_near, leaning, over_slendernesses
from .telling import cell_rows

# Why one engine's rows cannot be computed anew by themselves, see `Study.whole`.
WHOLE = "what may be told of an engine's right answers depends on the outcomes of the others"

SEED = 0  # of the bootstrap
QUICK = 20  # of so many tests one
OTHERS = 6  # of so many tests engines that are not in question, and their further variants, run one
TIME_LIMIT = 900.0  # s, of an engine's run
# What is changed in the model, one at a time; the first is as it is. Friction: granite on a steel table is not known.
KINDS: tuple[dict[str, float], ...] = (
    {},
    *({"restitution": factor} for factor in (0.98, 0.95, 0.9)),
    *({"friction": value} for value in (0.7, 0.5, 0.3)),
    *({"inertia": factor} for factor in (0.93, 1.07)),
)
EDGES = (0.0, 0.02, 0.1, 0.3, 0.5, 0.7, 0.9, 0.98, 1.0)  # of probability, of the cells of reliability
TWICE = (MODEL, ONE, "PGA, threshold", THRESHOLD, "PGA and PGV, logistic")  # judged in both ways
SHOWN = (MODEL, PGV)  # whose reliability is told

Data = Annotated[
    str | None, typer.Option(metavar="FOLDER", help="The tests: as their authors publish them, or your own.")
]


def plan(request: Request, *, data: Data = None) -> Plan:
    """The plan of the study; an answer with one variant more each time.

    Rows by "part": "score" (of a forecast, see `judging`), "paired", "reliability", "cell", "fit" (of the model to all
    tests), "where", "run" (a solver's outcomes by test) and "engine" (beside the model's); "absent", alone, without
    data. Arrays ``right/<kind>``: right answers of the model by specimen and slenderness. What is stored: `telling`.

    Parameters
    ----------
    request : Request
    data : str, optional
        Folder of the tests, see `reading`.
    """
    if data is None:
        reason = f"--data is missing: {granite.WHERE}"
        row = {"part": "absent", "engine": "analytic", "variant": "", "reason": reason}
        return Computed({"quick": request.quick, "campaign": "", "variants": []}, [row])
    with bar("reading the tests") as progress:
        campaign = read_campaign(data, QUICK if request.quick else 1, progress)
    model = yield Batch(_on_grids(campaign), over_slendernesses, "model over slenderness")
    known = _outcomes(campaign, model)
    places = [one[0].best(np.ones(len(campaign.tests), dtype=bool)) for one in known]
    slendernesses = [float(one[0].slendernesses[place]) for one, place in zip(known, places, strict=True)]
    rows = [row for k in range(len(known)) for row in _of_specimen(campaign, k, known[k])]
    records = [test.record for test in campaign.tests]
    at_hand.keep(campaign, [judged(Forecast(MODEL, one[0].spread), records) for one in known])
    settings = _settings(request, campaign, slendernesses) | {"model_runs": len(model) * len(KINDS) * _grid(campaign)}
    settings["model_seconds"] = float(sum(row.cost["grid_seconds"] for row in model))
    arrays = {
        f"right/{_name(kind)}": np.array([(one[k].model == one[k].measured[:, None]).sum(axis=0) for one in known])
        for k, kind in enumerate(KINDS)
    }
    own = yield Batch(_at(campaign, slendernesses, "analytic", None, 1), ended_near, "model")
    rows += [run_row(campaign, k, own, slendernesses[k]) for k in range(len(known))]
    answer = Computed(settings, rows, arrays, seed=SEED)
    yield answer
    for engine, variant, every in [one for name in request.engines for one in _variants(name)]:
        found = yield Batch(
            _at(campaign, slendernesses, engine, variant, every), ended, f"{engine}, {variant}", TIME_LIMIT
        )
        runs = [run_row(campaign, k, found, slendernesses[k]) for k in range(len(known))]
        rows = [*rows, *runs, *engine_rows(campaign, runs, rows, (own, found))]
        rows = [*rows, *(_failure(row) for row in found if row.failed)]
        settings = {**settings, "variants": [*settings["variants"], variant_settings(engine, variant)]}
        answer = Computed(settings, rows, arrays, seed=SEED)
        yield answer
    return answer


def _name(kind):
    return ", ".join(f"{name} {value:g}" for name, value in kind.items()) or AS_IT_IS


def _grid(campaign):
    return len(campaign.specimens[0].slendernesses())


def _variants(name: str) -> list[tuple[str, str, int]]:
    """(engine, variant, of how many tests one is run): of those in question the main variant and the defaults, all."""
    engine = get_engine(name)
    chosen = [engine.default_variant, *(one for one, spec in engine.variants.items() if spec.kind == "defaults")]
    return [(name, one, 1 if engine.subject else OTHERS) for one in dict.fromkeys(chosen)]


def _on_grids(campaign: Campaign) -> list[Case]:
    return [
        Case(
            specimen.scene.with_(motion=test.motion),
            settings={"history": False},
            tag={"test": test.name, "specimen": specimen.name, "slendernesses": specimen.slendernesses().tolist()}
            | {"kinds": [dict(kind) for kind in KINDS]},
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


def _outcomes(campaign: Campaign, rows: Sequence[Row]) -> list[list[Outcomes]]:
    """By specimen and kind."""
    if failed := next((row for row in rows if row.failed), None):
        raise SettingError(f"test {failed.case.tag['test']}: the model failed ({failed.failure['reason']})")
    found = []
    for k, specimen in enumerate(campaign.specimens):
        own = [row.values["outcomes"] for row in rows if row.case.tag["specimen"] == specimen.name]
        overturned = np.array([[[digit == OVERTURNS for digit in text] for text in one] for one in own])
        measured, grid = outcomes_of(campaign.tests, k), specimen.slendernesses()
        found.append([Outcomes(grid, overturned[:, kind], measured) for kind in range(len(KINDS))])
    return found


def _of_specimen(campaign: Campaign, k: int, kinds: Sequence[Outcomes]) -> list[dict[str, Any]]:
    """All rows of one specimen that need no engine."""
    tests, main = campaign.tests, kinds[0]
    measured, records = main.measured, [test.record for test in tests]
    shared = {"engine": "analytic", "variant": "", "specimen": campaign.specimens[k].name}
    others = [outcomes_of(tests, other) for other in range(len(campaign.specimens)) if other != k]
    settings = list(tests[0].authors[k]) if tests[0].authors else []
    authors = {name: np.array([test.authors[k][name] for test in tests]) for name in settings}
    measures = measures_of(campaign)
    found, rows = {}, []
    for forecast in forecasts(main, measures, others[0] if others else None, authors):
        ways = (BY_RECORD, *((BY_HALVES,) if forecast.name in TWICE else ()))
        for how in (*ways, *((IN_SAMPLE,) if forecast.name in (AUTHORS, ONE) else ())):
            probability = judged(forecast, records, how)
            found.setdefault(forecast.name, probability)
            said = score(probability, measured, records, forecast.sure)
            rows.append({"part": "score", **shared, "forecast": forecast.name, "judged": how, **said})
    rows += [_fit(shared, kind, one, records) for kind, one in zip(KINDS, kinds, strict=True)]
    for other in (THRESHOLD, PGV, "PGA and PGV, logistic", ONE):
        said = paired(found[MODEL], found[other], measured, records)
        rows.append({"part": "paired", **shared, "forecast": MODEL, "beside": other, **said})
    said = paired(found[BOTH], found[MODEL], measured, records)
    rows.append({"part": "paired", **shared, "forecast": BOTH, "beside": MODEL, **said})
    for name in SHOWN:
        cells = reliability(found[name], measured, EDGES)
        rows += [{"part": "reliability", **shared, "forecast": name, **cell} for cell in cells]
    if others:
        same = others[0] == measured
        counts = {name: int(right(found[name], measured)[same].sum()) for name in SHOWN}
        rows += [
            {"part": "where", **shared, "forecast": name, "size": int(same.sum()), "right": count}
            for name, count in counts.items()
        ]
    plane = measures["PGA"], measures["PGV"] / (campaign.specimens[k].scene.gravity * measures["PGA"])
    return rows + [{"part": "cell", **shared, **cell} for cell in cell_rows(plane, measured, found[MODEL])]


def _fit(shared, kind, outcomes, records):
    """The model of a kind: what is fitted to all tests, and how good it is held out by record."""
    whole = np.ones(len(records), dtype=bool)
    mean, spread = outcomes.settings[outcomes.fitted(whole)]
    alone = outcomes.best(whole)
    probability = judged(Forecast(MODEL, outcomes.spread), records)
    said = score(probability, outcomes.measured, records)
    best = float(outcomes.slendernesses[alone])
    kept = {name: said[name] for name in ("size", "right", "brier", "brier_interval", "misses", "false_alarms")}
    numbers = {"slenderness": best, "centre": float(mean), "spread": float(spread)}
    alone_right = int((outcomes.model[:, alone] == outcomes.measured).sum())
    return {"part": "fit", **shared, "change": _name(kind), **numbers, "alone_right": alone_right, **kept}


def _settings(request, campaign, slendernesses):
    tests = campaign.tests
    return {
        "quick": request.quick,
        "campaign": campaign.name,
        "digest": campaign.digest(),
        "cite": campaign.cite,
        "tests": [test.name for test in tests],
        "records": len({test.record for test in tests}),
        "missing": campaign.missing,
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
        "kinds": [_name(kind) for kind in KINDS],
        "equal": EQUAL,
        "others": OTHERS,
        "variants": [],
    }


def _agree(tests):
    """In how many tests the first two specimens end alike; None with one."""
    if len(tests[0].overturned) < 2:
        return None
    return sum(test.overturned[0] == test.overturned[1] for test in tests)


def problems(result: Result) -> list[str]:
    """Why nothing was run, where it was not."""
    return [row["reason"] for row in result.rows if row["part"] == "absent"]
