"""What predicts the outcomes of a campaign, and how well: the model, and simpler forecasts.

Each forecast is judged on tests that it was not fitted to. Of the model the slenderness in the plane of motion and its
spread are fitted, because a boulder has no drawing and does not stand twice alike. The model's probability of
overturning is the share of a normal spread of slendernesses at which it overturns. Mean and spread are those of the
least Brier score on the tests they are fitted to. All else of the model is as given.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ...metrics.statistics import (
    HALF,
    bent,
    brier,
    clustered,
    folds,
    halves,
    held_out,
    logistic,
    middle,
    right,
    threshold,
)
from .campaign import ALL, Campaign, measures_of, outcomes_of

BY_RECORD, BY_HALVES, IN_SAMPLE = "held out by record", "fitted to every other test", "fitted to the same tests"
SPREADS = np.arange(1, 21) / 60  # of the normal distribution, over the width of the grid of slendernesses
MODEL, ONE, BOTH = "model", "model, one slenderness", "model and PGV, logistic"
PGV, THRESHOLD = "PGV, logistic", "PGV, threshold"
CURVE, BEYOND = "PGA and PGV, curve", "curve and model"
FREQUENT, EACH = "the more frequent outcome", "a threshold of PGA for each record"
OTHER, AUTHORS = "the other specimen", "authors’ discrete elements"
AS_IT_IS = "as it is"  # the model without a change
SURE = 1e-3  # least distance of a probability from 0 and 1 where its odds are taken


@dataclass(frozen=True, eq=False)
class Outcomes:
    """Outcomes of the model, bool, shape (tests, slendernesses), and measured ones, bool, shape (tests,)."""

    slendernesses: np.ndarray
    model: np.ndarray
    measured: np.ndarray

    @cached_property
    def settings(self) -> np.ndarray:
        """All (mean, spread) [rad] of normal spreads that are tried, shape (settings, 2)."""
        width = np.ptp(self.slendernesses)
        return np.array([(mean, spread * width) for mean in self.slendernesses for spread in SPREADS])

    @cached_property
    def probabilities(self) -> np.ndarray:
        """Probabilities of overturning, shape (tests, settings)."""
        mean, spread = self.settings.T
        weights = np.exp(-0.5 * ((self.slendernesses[:, None] - mean) / spread) ** 2)
        return self.model @ (weights / weights.sum(axis=0))

    @cached_property
    def _errors(self) -> np.ndarray:
        return brier(self.probabilities, self.measured[:, None])

    def fitted(self, chosen: np.ndarray) -> int:
        """Return the index of the setting with the least Brier score on the tests chosen."""
        return int(self._errors[chosen].mean(axis=0).argmin())

    def best(self, chosen: np.ndarray) -> int:
        """Return the index of the slenderness right most often on the tests chosen; of several, the middle one."""
        score = (self.model[chosen] == self.measured[chosen, None]).sum(axis=0)
        return middle(np.flatnonzero(score == score.max()))

    def spread(self, chosen: np.ndarray) -> np.ndarray:
        """Return probabilities of all tests, fitted to those chosen."""
        return self.probabilities[:, self.fitted(chosen)]

    def alone(self, chosen: np.ndarray) -> np.ndarray:
        """Return 0 or 1 for all tests, by the slenderness fitted to those chosen."""
        return self.model[:, self.best(chosen)].astype(float)


@dataclass(frozen=True, eq=False)
class Forecast:
    """A way to predict outcomes.

    fit: function from the tests chosen to the probabilities of all tests. sure: whether these are 0 or 1.
    """

    name: str
    fit: Callable[[np.ndarray], np.ndarray]
    sure: bool = False


def forecasts(
    outcomes: Outcomes, measures: dict[str, np.ndarray], other: np.ndarray | None, authors: dict[str, np.ndarray]
) -> list[Forecast]:
    """Return all forecasts of one specimen.

    measures: {"PGA", "PGV", and others: array of shape (tests,)}. other: outcomes of the other specimen, or None.
    authors: {setting: outcomes} of their simulations.
    """
    measured = outcomes.measured
    logs = {name: np.log(values)[:, None] for name, values in measures.items()}

    two = np.column_stack([logs["PGA"], logs["PGV"]])

    def joined(features):
        def fit(chosen):
            p = np.clip(outcomes.spread(chosen), SURE, 1 - SURE)
            return logistic(np.column_stack([features, np.log(p / (1 - p))]), measured, chosen)

        return fit

    all_forecasts = [Forecast(MODEL, outcomes.spread), Forecast(ONE, outcomes.alone, sure=True)]
    all_forecasts.append(
        Forecast(FREQUENT, lambda chosen: np.full(len(measured), measured[chosen].mean() >= HALF), sure=True)
    )
    for name, values in measures.items():
        all_forecasts.append(Forecast(f"{name}, threshold", _above(values, measured), sure=True))
        all_forecasts.append(Forecast(f"{name}, logistic", _logistic(logs[name], measured)))
    all_forecasts += [Forecast("PGA and PGV, logistic", _logistic(two, measured))]
    all_forecasts += [Forecast(CURVE, _logistic(bent(two), measured))]
    all_forecasts += [Forecast(BOTH, joined(logs["PGV"])), Forecast(BEYOND, joined(bent(two)))]
    if other is not None:
        all_forecasts.append(Forecast(OTHER, _logistic(other[:, None].astype(float), measured)))
    if authors:
        settings = np.array(list(authors.values()))
        all_forecasts.append(Forecast(AUTHORS, lambda chosen: _most_often(settings, measured, chosen), sure=True))
    return all_forecasts


def of_each_record(values: np.ndarray, measured: np.ndarray, records: Sequence[str]) -> np.ndarray:
    """Return 0 or 1 by a threshold of a measure for each record, fitted to its own tests.

    It shows how far the outcome under a record depends on its scale alone.
    """
    names, answers = np.array(records), np.zeros(len(measured))
    for name in dict.fromkeys(records):
        under_record = names == name
        answers[under_record] = values[under_record] > threshold(values[under_record], measured[under_record])
    return answers


def _above(values, measured):
    return lambda chosen: (values > threshold(values[chosen], measured[chosen])).astype(float)


def _logistic(features, measured):
    return lambda chosen: logistic(features, measured, chosen)


def _most_often(settings, measured, chosen):
    """Outcomes of the authors' setting that is right most often on the tests chosen."""
    score = (settings[:, chosen] == measured[chosen]).sum(axis=1)
    return settings[middle(np.flatnonzero(score == score.max()))].astype(float)


def judged(forecast: Forecast, records: Sequence[str], how: str = BY_RECORD) -> np.ndarray:
    """Return the probabilities of a forecast, fitted to the tests that `how` says."""
    count = len(records)
    if how == IN_SAMPLE:
        return forecast.fit(np.ones(count, dtype=bool))
    return held_out(forecast.fit, folds(records) if how == BY_RECORD else halves(count), count)


def score(probability: np.ndarray, measured: np.ndarray, records: Sequence[str], sure: bool = False) -> dict[str, Any]:
    """Return counts and the Brier score of a forecast.

    They are right answers with the 95 % interval of their share by record, misses, false alarms, and the Brier score
    with its interval. A sure forecast has no Brier score.
    """
    hit = right(probability, measured)
    low, high = clustered(hit, records)
    counts: dict[str, Any] = {
        "size": len(hit),
        "right": int(hit.sum()),
        "low": low,
        "high": high,
        "misses": int((measured & ~hit).sum()),
        "false_alarms": int((~measured & ~hit).sum()),
    }
    errors = brier(probability, measured)
    brier_score = None if sure else (float(errors.mean()), clustered(errors, records))
    return {**counts, "brier": brier_score and brier_score[0], "brier_interval": brier_score and brier_score[1]}


def paired(first: np.ndarray, second: np.ndarray, measured: np.ndarray, records: Sequence[str]) -> dict[str, Any]:
    """Compare two forecasts test by test.

    The values are how much smaller the Brier score of the first is and in how many more tests it is right, each with
    its interval by record, and which is right where they disagree.
    """
    less = brier(second, measured) - brier(first, measured)
    more = right(first, measured).astype(int) - right(second, measured)
    disagree = (first >= HALF) != (second >= HALF)
    return {
        "difference": float(less.mean()),
        "interval": clustered(less, records),
        "more_right": int(more.sum()),
        "more_interval": [len(more) * end for end in clustered(more, records)],
        "disagree": int(disagree.sum()),
        "right": int(right(first, measured)[disagree].sum()),
    }


TWICE = (MODEL, ONE, "PGA, threshold", THRESHOLD, "PGA and PGV, logistic", CURVE)  # forecasts judged by both rules
PAIRS = ((MODEL, THRESHOLD), (MODEL, PGV), (MODEL, CURVE), (BEYOND, CURVE), (BOTH, MODEL), (MODEL, ONE))


def rows_of(
    campaign: Campaign, k: int, kinds: Sequence[Outcomes], names: Sequence[str]
) -> tuple[dict[str, np.ndarray], list[dict]]:
    """Return the probabilities of each forecast of specimen k, held out by record, and the rows on them.

    kinds, names: outcomes of the model over slenderness and the name, for each kind of model.
    """
    tests, main = campaign.tests, kinds[0]
    measured, records, measures = main.measured, [test.record for test in tests], measures_of(campaign)
    shared = {"engine": "analytic", "variant": "", "specimen": campaign.specimens[k].name}
    others = [outcomes_of(tests, other) for other in range(len(campaign.specimens)) if other != k]
    settings = list(tests[0].authors[k]) if tests[0].authors else []
    authors = {name: np.array([test.authors[k][name] for test in tests]) for name in settings}
    probabilities, rows = {}, []
    for forecast in forecasts(main, measures, others[0] if others else None, authors):
        rules = (BY_RECORD, *((BY_HALVES,) if forecast.name in TWICE else ()))
        for how in (*rules, *((IN_SAMPLE,) if forecast.name in (AUTHORS, ONE) else ())):
            probability = judged(forecast, records, how)
            probabilities.setdefault(forecast.name, probability)
            scores = score(probability, measured, records, forecast.sure)
            rows.append({"part": "score", **shared, "forecast": forecast.name, "judged": how, **scores})
    scores = score(of_each_record(measures["PGA"], measured, records), measured, records, sure=True)
    rows.append({"part": "score", **shared, "forecast": EACH, "judged": IN_SAMPLE, **scores})
    rows += [_fit(shared, name, kind, records) for name, kind in zip(names, kinds, strict=True)]
    return probabilities, rows


def pairs_of(campaign: Campaign, probabilities: Sequence[dict[str, np.ndarray]]) -> list[dict[str, Any]]:
    """Return rows that compare forecasts in pairs, for each specimen and for all together.

    Forecasts may err alike under one record, so intervals count records.

    probabilities: those of each forecast, by specimen.
    """
    records, rows = [test.record for test in campaign.tests], []
    shared = {"part": "paired", "engine": "analytic", "variant": ""}
    groups = [([k], specimen.name) for k, specimen in enumerate(campaign.specimens)]
    if len(groups) > 1:
        groups.append((list(range(len(groups))), ALL))
    for members, name in groups:
        measured = np.concatenate([outcomes_of(campaign.tests, k) for k in members])
        for pair in PAIRS:
            first, other = (np.concatenate([probabilities[k][which] for k in members]) for which in pair)
            comparison = paired(first, other, measured, records * len(members))
            rows.append({**shared, "specimen": name, "forecast": pair[0], "beside": pair[1], **comparison})
    return rows


def _fit(shared, name, outcomes, records):
    """Row of the model of a kind: what is fitted to all tests, and how good it is held out by record."""
    whole = np.ones(len(records), dtype=bool)
    mean, spread = outcomes.settings[outcomes.fitted(whole)]
    alone = outcomes.best(whole)
    probability = judged(Forecast(MODEL, outcomes.spread), records)
    scores = score(probability, outcomes.measured, records)
    shown = {key: scores[key] for key in ("size", "right", "brier", "brier_interval", "misses", "false_alarms")}
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
        **shown,
    }
