"""Forecasts of a yes or no, as probabilities: how good they are, fitted to some cases and judged on others.

Cases of one group (tests under one record) may all say the same. So a group is held out as a whole, and intervals are
those of a bootstrap over groups. A forecast says yes where its probability is one half or more.
"""

from collections.abc import Callable, Iterator, Sequence
from itertools import combinations_with_replacement
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.optimize import minimize
from scipy.special import expit

from .statistics import draws

DRAWS = 2000
HALF = 0.5
STEPS, SMALL, SETTLED = 1000, 1e-8, 1e-6  # of the search; of the slope, at its end, a case
RIDGE = 1e-6  # keeps the slope finite where outcomes are separated


def right(probability: npt.ArrayLike, happened: npt.ArrayLike) -> np.ndarray:
    """Where the forecast is right, bool."""
    return (np.asarray(probability) >= HALF) == np.asarray(happened, dtype=bool)


def brier(probability: npt.ArrayLike, happened: npt.ArrayLike) -> np.ndarray:
    """Brier's score (1950) of each case, the square of its error; the score of a forecast is the mean. 0 is best, a
    probability of one half throughout has 1/4."""
    return (np.asarray(probability, dtype=float) - np.asarray(happened, dtype=float)) ** 2


def folds(groups: Sequence[Any]) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """(the others, its own) of each group, bool arrays: no group is on both sides."""
    names = np.array([str(group) for group in groups])
    for name in dict.fromkeys(names.tolist()):
        yield names != name, names == name


def halves(count: int) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Fitted to every other case and judged on the rest, and the other way."""
    even = np.arange(count) % 2 == 0
    yield even, ~even
    yield ~even, even


def held_out(
    fit: Callable[[np.ndarray], np.ndarray], sides: Iterator[tuple[np.ndarray, np.ndarray]], count: int
) -> np.ndarray:
    """Probabilities, shape (count,), each from a fit to others alone; ``fit(chosen)``: of all cases, fitted to some."""
    found = np.full(count, np.nan)
    for others, own in sides:
        found[own] = fit(others)[own]
    return found


def threshold(values: npt.ArrayLike, happened: npt.ArrayLike) -> float:
    """The value above which a yes is right most often; between two of the cases, of several the one in the middle."""
    values, happened = np.asarray(values, dtype=float), np.asarray(happened, dtype=bool)
    order = np.argsort(values, kind="stable")
    values, happened = values[order], happened[order]
    below = np.concatenate([[0], np.cumsum(~happened)])  # right where the first k are a no, the rest a yes
    score = below + np.concatenate([[happened.sum()], happened.sum() - np.cumsum(happened)])
    score[1:-1][values[1:] == values[:-1]] = -1  # equal values are not parted
    best = middle(np.flatnonzero(score == score.max()))
    if best in (0, len(values)):
        return -np.inf if best == 0 else np.inf
    return float(values[best - 1 : best + 1].mean())


def middle(places: npt.ArrayLike) -> int:
    """Of several places that are as good as each other the one in the middle."""
    places = np.asarray(places)
    return int(places[(len(places) - 1) // 2])


def logistic(features: npt.ArrayLike, happened: npt.ArrayLike, chosen: np.ndarray) -> np.ndarray:
    """Probabilities of all cases by logistic regression, the likeliest one, fitted to those chosen.

    features : shape (cases, features), in their logarithms where that is meant.

    Raises
    ------
    ArithmeticError
        The search has not settled.
    """
    features, happened = np.asarray(features, dtype=float), np.asarray(happened, dtype=float)
    columns = np.column_stack([np.ones(len(features)), _standard(features, chosen)])
    mine, yes = columns[chosen], happened[chosen]
    ridge = RIDGE * np.append(0, np.ones(columns.shape[1] - 1))

    def loss(beta):
        z = mine @ beta
        value = (np.logaddexp(0, z) - yes * z).sum() + 0.5 * (ridge * beta**2).sum()
        return value, mine.T @ (expit(z) - yes) + ridge * beta

    def curvature(beta):
        p = expit(mine @ beta)
        return (mine.T * (p * (1 - p))) @ mine + np.diag(ridge + RIDGE)

    start = np.zeros(columns.shape[1])
    found = minimize(
        loss, start, jac=True, hess=curvature, method="trust-exact", options={"gtol": SMALL, "maxiter": STEPS}
    )
    if np.abs(loss(found.x)[1]).max() > SETTLED * len(yes):
        raise ArithmeticError(f"logistic regression of {len(yes)} cases has not settled: {found.message}")
    return expit(columns @ found.x)


def bent(features: npt.ArrayLike) -> np.ndarray:
    """Features, standardised, with their squares and products: a logistic curve of these may bend."""
    features = np.asarray(features, dtype=float)
    plain = _standard(features, np.ones(len(features), dtype=bool))
    pairs = combinations_with_replacement(range(plain.shape[1]), 2)
    return np.column_stack([plain, *(plain[:, one] * plain[:, other] for one, other in pairs)])


def _standard(features, chosen):
    """By the mean and the standard deviation of those chosen; what is alike in all of them is left as it is."""
    centre, spread = features[chosen].mean(axis=0), features[chosen].std(axis=0)
    return (features - centre) / np.where(spread > 0, spread, 1)


def clustered(values: npt.ArrayLike, groups: Sequence[Any], seed: int = 0) -> list[float]:
    """The 95 % interval [low, high] of the mean of values: percentiles of a bootstrap over groups.

    A draw takes as many groups as there are, with replacement, each with all of its cases.
    """
    values = np.asarray(values, dtype=float)
    _, places = np.unique([str(group) for group in groups], return_inverse=True)
    sums, sizes = np.bincount(places, values), np.bincount(places)
    weights = draws(DRAWS, len(sizes), seed)
    low, high = np.percentile((weights @ sums) / (weights @ sizes), [2.5, 97.5])
    return [float(low), float(high)]
