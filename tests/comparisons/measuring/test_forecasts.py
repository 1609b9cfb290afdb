"""Forecasts of a yes or no: scores, fits and intervals, against values by hand and by brute force."""

import numpy as np
import pytest
from scipy.optimize import minimize

from comparisons.measuring.forecasts import (
    DRAWS,
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
from comparisons.measuring.statistics import draws


def test_the_score_of_a_forecast_by_hand():
    probability, happened = [0.0, 0.5, 0.8, 1.0], [False, True, False, True]
    assert brier(probability, happened).tolist() == pytest.approx([0.0, 0.25, 0.64, 0.0])
    assert right(probability, happened).tolist() == [True, True, False, True]
    assert brier([0.5] * 7, [True, False] * 3 + [True]).mean() == 0.25


def test_no_group_is_on_both_sides_and_each_is_judged_once():
    groups = ["a", "b", "a", "c", "b", "a"]
    seen = np.zeros(6, dtype=int)
    for others, own in folds(groups):
        assert not (others & own).any() and (others | own).all()
        assert not {groups[k] for k in np.flatnonzero(others)} & {groups[k] for k in np.flatnonzero(own)}
        seen += own
    assert seen.tolist() == [1] * 6
    assert sum(own for _, own in halves(5)).tolist() == [1] * 5
    assert not any((others & own).any() for others, own in halves(5))


def test_what_is_held_out_is_not_fitted_to():
    """A forecast that only repeats what it was fitted to knows nothing of what was held out."""
    happened, groups = np.array([True, False, True, False, True, True]), ["a", "b", "a", "c", "b", "a"]

    def by_heart(chosen):
        return np.where(chosen, happened, 0.5)

    assert held_out(by_heart, folds(groups), 6).tolist() == [0.5] * 6


@pytest.mark.parametrize("seed", range(5))
def test_a_threshold_is_right_as_often_as_any(seed):
    rng = np.random.default_rng(seed)
    values, happened = rng.integers(0, 9, 20).astype(float), rng.random(20) < 0.5
    best = max(int(((values > at) == happened).sum()) for at in [-np.inf, *np.arange(-0.5, 9)])
    assert int(((values > threshold(values, happened)) == happened).sum()) == best


def test_thresholds_that_are_as_good_are_taken_in_the_middle():
    assert threshold([1, 2, 3, 4], [False, False, True, True]) == 2.5
    assert threshold([1, 2], [True, True]) == -np.inf and threshold([1, 2], [False, False]) == np.inf
    assert [middle([3]), middle([3, 8]), middle([3, 4, 9])] == [3, 3, 4]


def test_logistic_regression_is_the_likeliest_one():
    rng = np.random.default_rng(3)
    features = rng.normal(size=(80, 2)) * [1.0, 30.0] + [5.0, -100.0]
    happened = rng.random(80) < 1 / (1 + np.exp(-(features[:, 0] - 5) - 0.05 * (features[:, 1] + 100)))
    chosen = np.arange(80) < 60

    def loss(beta):
        z = np.column_stack([np.ones(80), features - features.mean(axis=0)]) @ beta
        return float((np.log1p(np.exp(z)) - happened * z)[chosen].sum())

    best = minimize(loss, np.zeros(3), method="Nelder-Mead", options={"xatol": 1e-10, "fatol": 1e-12, "maxiter": 9000})
    z = np.column_stack([np.ones(80), features - features.mean(axis=0)]) @ best.x
    np.testing.assert_allclose(logistic(features, happened, chosen), 1 / (1 + np.exp(-z)), atol=1e-4)


@pytest.mark.parametrize("seed", range(5))
def test_logistic_regression_of_collinear_features_and_their_squares_settles(seed):
    """At the likeliest one the slope is 0, but for the ridge, which weighs on other features in each."""
    rng = np.random.default_rng(seed)
    pga = rng.normal(-2, 1, 300)
    plain = np.column_stack([pga, pga + 0.1 * rng.normal(size=300)])
    raw = np.column_stack([plain, plain**2, plain.prod(axis=1)])
    happened = rng.random(300) < 1 / (1 + np.exp(-6 * (pga + 2 + 0.3 * (pga + 2) ** 2)))
    every = np.ones(300, dtype=bool)
    found = [logistic(features, happened, every) for features in (bent(plain), raw)]
    for probability in found:
        assert np.abs(bent(plain).T @ (probability - happened)).max() < 0.01  # of 300 cases
    one, other = (np.log(np.where(happened, probability, 1 - probability)).sum() for probability in found)
    assert one == pytest.approx(other, abs=0.01)
    assert bent(plain).shape == (300, 5)


def test_separated_outcomes_give_a_steep_curve_and_no_overflow():
    x, happened = np.arange(10.0)[:, None], np.arange(10) >= 5
    found = logistic(x, happened, np.ones(10, dtype=bool))
    assert np.isfinite(found).all() and (np.diff(found) >= 0).all() and right(found, happened).all()


def test_an_interval_by_groups_is_that_of_every_draw():
    """Two groups: one of them twice, both, or the other twice, in the ratio 1 to 2 to 1."""
    values, groups = [1.0, 1.0, 1.0, 0.0], ["a", "a", "a", "b"]
    assert clustered(values, groups) == [0.0, 1.0]  # a single group may be drawn alone: a quarter of the draws
    weights = draws(DRAWS, 2, 0)
    means = sorted({(3 * a) / (3 * a + b) for a, b in weights.tolist()})
    assert means == [0.0, 0.75, 1.0]


def test_groups_widen_an_interval_and_do_not_where_each_is_alone():
    values = np.repeat([1.0, 0.0], 50)
    alone, together = clustered(values, range(100)), clustered(values, np.arange(100) // 10)
    assert alone == pytest.approx([0.5 - 0.098, 0.5 + 0.098], abs=0.015)  # 1.96 sqrt(.25/100)
    assert together[1] - together[0] > 2.5 * (alone[1] - alone[0])  # sqrt(10) of it
    assert clustered(values, range(100)) == alone and clustered(values, range(100), seed=1) != alone
