"""Rows of a campaign that need no engine: how right each forecast is, and where it is not."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...measuring.forecasts import FEWEST, reliability, right, threshold
from .campaign import Campaign, outcomes_of
from .judging import (
    AUTHORS,
    BEYOND,
    BOTH,
    BY_HALVES,
    BY_RECORD,
    CURVE,
    EACH,
    FREQUENT,
    IN_SAMPLE,
    MODEL,
    ONE,
    PGV,
    THRESHOLD,
    Forecast,
    Outcomes,
    forecasts,
    judged,
    of_each_record,
    paired,
    score,
)
from .measures import measures_of
from .runs import ALL
from .telling import cell_rows, quarter_rows

EDGES = (0.0, 0.02, 0.1, 0.3, 0.5, 0.7, 0.9, 0.98, 1.0)  # of probability, of the cells of reliability
TWICE = (MODEL, ONE, "PGA, threshold", THRESHOLD, "PGA and PGV, logistic", CURVE)  # judged in both ways
SHOWN = (MODEL, PGV)  # whose reliability is told
AMONG = (MODEL, CURVE, PGV, THRESHOLD)  # who is counted where it is hard, and where the specimens agree
PAIRS = ((MODEL, THRESHOLD), (MODEL, PGV), (MODEL, CURVE), (BEYOND, CURVE), (BOTH, MODEL), (MODEL, ONE))
WITHIN = 2  # factor about the threshold of PGV, of the tests that are no easy ones
ALIKE, CLOSE = "both specimens end alike", "PGV within a factor of 2 of its threshold"


@dataclass(frozen=True, eq=False)
class Told:
    """Of a specimen: what it did, and the probabilities of each forecast, held out by record."""

    measured: np.ndarray
    forecasts: dict[str, np.ndarray]


def told_of(campaign: Campaign, k: int, kinds: Sequence[Outcomes], names: Sequence[str]) -> tuple[Told, list[dict]]:
    """(what is told of specimen k, its rows). kinds, names: outcomes of the model over slenderness, of each kind."""
    tests, main = campaign.tests, kinds[0]
    measured, records, measures = main.measured, [test.record for test in tests], measures_of(campaign)
    shared = {"engine": "analytic", "variant": "", "specimen": campaign.specimens[k].name}
    others = [outcomes_of(tests, other) for other in range(len(campaign.specimens)) if other != k]
    settings = list(tests[0].authors[k]) if tests[0].authors else []
    authors = {name: np.array([test.authors[k][name] for test in tests]) for name in settings}
    found, rows = {}, []
    for forecast in forecasts(main, measures, others[0] if others else None, authors):
        ways = (BY_RECORD, *((BY_HALVES,) if forecast.name in TWICE else ()))
        for how in (*ways, *((IN_SAMPLE,) if forecast.name in (AUTHORS, ONE) else ())):
            probability = judged(forecast, records, how)
            found.setdefault(forecast.name, probability)
            said = score(probability, measured, records, forecast.sure)
            rows.append({"part": "score", **shared, "forecast": forecast.name, "judged": how, **said})
    said = score(of_each_record(measures["PGA"], measured, records), measured, records, sure=True)
    rows.append({"part": "score", **shared, "forecast": EACH, "judged": IN_SAMPLE, **said})
    rows += [_fit(shared, name, one, records) for name, one in zip(names, kinds, strict=True)]
    for name in SHOWN:
        cells = reliability(found[name], measured, EDGES)
        rows += [{"part": "reliability", **shared, "forecast": name, **cell} for cell in cells]
    plane = measures["PGA"], measures["PGV"] / (campaign.specimens[k].scene.gravity * measures["PGA"])
    rows += [{"part": "cell", **shared, **cell} for cell in cell_rows(plane, measured, found[MODEL])]
    rows += [{"part": "quarter", **shared, **one} for one in quarter_rows(plane[1], measured, found[MODEL])]
    velocity, limit = measures["PGV"], threshold(measures["PGV"], measured)
    among = {CLOSE: (velocity > limit / WITHIN) & (velocity < limit * WITHIN)}
    if others:
        among[ALIKE] = others[0] == measured
    rows += [row for where, chosen in among.items() for row in _among(shared, where, chosen, found, measured)]
    return Told(measured, found), rows


def pairs_of(campaign: Campaign, all_told: Sequence[Told]) -> list[dict[str, Any]]:
    """Rows of forecasts in pairs, of each specimen and of all together; under one record they may err alike."""
    records, rows = [test.record for test in campaign.tests], []
    shared = {"part": "paired", "engine": "analytic", "variant": ""}
    names = [one.name for one in campaign.specimens]
    everyone = [(name, [one]) for name, one in zip(names, all_told, strict=True)]
    for name, some in (*everyone, *([(ALL, list(all_told))] if len(names) > 1 else [])):
        measured = np.concatenate([one.measured for one in some])
        for pair in PAIRS:
            first, other = (np.concatenate([one.forecasts[which] for one in some]) for which in pair)
            said = paired(first, other, measured, records * len(some))
            rows.append({**shared, "specimen": name, "forecast": pair[0], "beside": pair[1], **said})
    return rows


def _among(shared, where, chosen, found, measured):
    """Right answers among some of the tests, where neither these nor the rest are few."""
    size = int(chosen.sum())
    if size < FEWEST or 0 < len(chosen) - size < FEWEST:
        return []
    return [
        {"part": "where", **shared, "among": where, "forecast": name, "size": size}
        | {"right": int(right(found[name], measured)[chosen].sum())}
        for name in (*AMONG, FREQUENT)
    ]


def _fit(shared, name, outcomes, records):
    """The model of a kind: what is fitted to all tests, and how good it is held out by record."""
    whole = np.ones(len(records), dtype=bool)
    mean, spread = outcomes.settings[outcomes.fitted(whole)]
    alone = outcomes.best(whole)
    probability = judged(Forecast(MODEL, outcomes.spread), records)
    said = score(probability, outcomes.measured, records)
    kept = {key: said[key] for key in ("size", "right", "brier", "brier_interval", "misses", "false_alarms")}
    best = outcomes.model[:, alone]
    beside = [place for place in (alone - 1, alone + 1) if 0 <= place < len(outcomes.slendernesses)]
    return {
        "part": "fit",
        **shared,
        "change": name,
        "slenderness": float(outcomes.slendernesses[alone]),
        "centre": float(mean),
        "spread": float(spread),
        "alone_right": int((best == outcomes.measured).sum()),
        "neighbours": [int((outcomes.model[:, place] != best).sum()) for place in beside],
        **kept,
    }
