"""Are two solvers' overturning outcomes different? The class of a run, one word, the same in every study; intervals and
paired tests; lognormal fragility of independent runs: the fit, its intervals by bootstrap, whether the curve fits.

Forecasts of a yes or no, as probabilities: how good they are, fitted to some cases and judged on others.

Cases of one group (tests under one record) may all say the same. So a group is held out as a whole, and intervals are
those of a bootstrap over groups. A forecast says yes where its probability is one half or more.
"""

import math
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import asdict, dataclass
from itertools import combinations_with_replacement
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq, minimize
from scipy.special import expit, log_ndtr
from scipy.stats import binom, binomtest, chi2, norm

from analytic.response import COMPARED

EQUAL = 0.05  # share of runs that may differ between solvers that are called equal
TOO_FEW = "inconclusive (too few runs)"  # of `equality`


@dataclass(frozen=True)
class Confusion:
    """Counts of paired outcomes of two solvers A and B on the same motions."""

    both_stand: int
    both_overturn: int
    only_a: int  # overturns in A alone
    only_b: int  # overturns in B alone

    @property
    def size(self) -> int:
        return self.both_stand + self.both_overturn + self.only_a + self.only_b

    @property
    def discordant(self) -> int:
        return self.only_a + self.only_b

    def table(self) -> np.ndarray:
        """Rows: A stands, A overturns; columns: B stands, B overturns; shape (2, 2)."""
        return np.array([[self.both_stand, self.only_b], [self.only_a, self.both_overturn]])


def confusion(a: npt.ArrayLike, b: npt.ArrayLike) -> Confusion:
    """Confusion table of two arrays of outcomes, shape (n,), True where it overturns.

    Raises
    ------
    ValueError
        The arrays differ in length, are empty or are not boolean: a failed run has no outcome, so leave
        out its pair and say how many were left out.
    """
    a, b = np.asarray(a), np.asarray(b)
    if a.dtype != bool or b.dtype != bool or a.shape != b.shape or a.ndim != 1 or len(a) == 0:
        raise ValueError(
            f"paired outcomes must be two boolean arrays of one length above 0, not {a.dtype} "
            f"{a.shape} and {b.dtype} {b.shape}; leave failed runs out in pairs"
        )
    return Confusion(int((~a & ~b).sum()), int((a & b).sum()), int((a & ~b).sum()), int((~a & b).sum()))


def wilson(count: float, size: float, level: float = 0.95) -> tuple[float, float]:
    """Wilson score interval (low, high) of a probability seen `count` times in `size` (Wilson 1927).

    Neither need be whole: of runs that depend on each other, `size` is the number of independent ones.
    """
    z = norm.ppf(0.5 + level / 2)
    share, spread = count / size, z**2 / size
    half = math.sqrt(spread * (share * (1 - share) + spread / 4))
    ends = [(share + spread / 2 + side * half) / (1 + spread) for side in (-1, 1)]
    return 0.0 if count == 0 else float(max(ends[0], 0.0)), 1.0 if count == size else float(min(ends[1], 1.0))


def equality(differs: npt.ArrayLike, groups: Sequence[Any] | None = None) -> tuple[str, tuple[float, float]]:
    """Whether two solvers are equal, a word, and the 95 % interval of the share of runs in which they are not.

    "yes": its upper limit is below `EQUAL`. `TOO_FEW`: it would not be with none differing, and the lower limit is not
    above `EQUAL`. "no": otherwise; lack of power proves nothing.

    Parameters
    ----------
    differs : bool array, shape (n,), n >= 1
        Run by run; a failed one differs.
    groups : sequence of length n, optional
        Of each run: runs of one group, as of one record, may all depend on each other, and so count as one run. None:
        all runs are independent.
    """
    differs = np.asarray(differs, dtype=bool)
    size = len(differs) if groups is None else len(set(groups))
    low, high = wilson(float(differs.mean()) * size, size)
    if wilson(0, size)[1] >= EQUAL and low <= EQUAL:
        return TOO_FEW, (low, high)
    return "yes" if high < EQUAL else "no", (low, high)


def mcnemar(table: Confusion) -> float:
    """Two-sided p-value of the exact McNemar test: are the discordant pairs of a `Confusion` split evenly?"""
    if table.discordant == 0:
        return 1.0
    return float(binomtest(table.only_a, table.discordant, 0.5).pvalue)


def cohen_kappa(table: npt.ArrayLike, level: float = 0.95) -> tuple[float, float, float] | tuple[None, None, None]:
    """Cohen's kappa (1960) of a square table of counts, and its interval: (kappa, low, high).

    The interval is the large-sample one of Fleiss, Cohen and Everitt (1969). Without any
    disagreement that has no width: then the Wilson interval of the agreement is used, with the chance
    agreement as observed. Where both raters give one and the same class throughout, kappa does not exist
    and all three are None.
    """
    p = np.asarray(table, dtype=float)
    size = p.sum()
    p = p / size
    rows, columns = p.sum(axis=1), p.sum(axis=0)
    observed, chance = float(np.trace(p)), float(rows @ columns)
    if 1 - chance < 1e-12:
        return None, None, None
    kappa = (observed - chance) / (1 - chance)
    if observed > 1 - 0.5 / size:
        least = wilson(int(size), int(size), level)[0]
        return 1.0, (least - chance) / (1 - chance), 1.0
    sums = rows[:, None] + columns[None, :]
    diagonal = np.diag(p) @ (1 - np.diag(sums) * (1 - kappa)) ** 2
    crossed = columns[:, None] + rows[None, :]
    off = (1 - kappa) ** 2 * ((p * crossed**2).sum() - np.diag(p) @ np.diag(crossed) ** 2)
    variance = (diagonal + off - (kappa - chance * (1 - kappa)) ** 2) / (size * (1 - chance) ** 2)
    width = norm.ppf(0.5 + level / 2) * math.sqrt(max(variance, 0.0))
    return kappa, max(kappa - width, -1.0), min(kappa + width, 1.0)


def detectable_difference(size: int, discordance: float, level: float = 0.05, power: float = 0.8) -> float | None:
    """Smallest difference of two overturning probabilities that `size` pairs would show, or None if none.

    Exact power of the exact McNemar test. The number of discordant pairs is binomial with the rate
    `discordance`, or with the difference itself where that is larger; given it, their split is binomial.

    Parameters
    ----------
    size : int
        Number of pairs.
    discordance : float
        Share of pairs whose outcomes differ, in [0, 1].
    level, power : float
        Significance level, and the probability with which the difference is to be found.
    """
    numbers = np.arange(size + 1)
    # Largest count of the rarer side at which the two-sided exact test still rejects; -1: none.
    critical = binom.ppf(level / 2, numbers, 0.5)
    critical = np.where(2 * binom.cdf(critical, numbers, 0.5) <= level, critical, critical - 1)

    def excess(difference):
        rate = max(discordance, difference)
        split = min((rate + difference) / (2 * rate), 1.0)
        rejected = binom.cdf(critical, numbers, split) + binom.sf(numbers - critical - 1, numbers, split)
        return float(binom.pmf(numbers, size, rate) @ np.where(critical >= 0, rejected, 0.0)) - power

    if excess(1.0) < 0:
        return None
    return float(brentq(excess, 1e-9, 1.0, xtol=1e-9))


def holm(p_values: npt.ArrayLike) -> np.ndarray:
    """p-values of several tests, adjusted for their number by Holm's step-down method (1979); shape kept."""
    p_values = np.asarray(p_values, dtype=float)
    order = np.argsort(p_values, axis=None)
    steps = p_values.ravel()[order] * np.arange(p_values.size, 0, -1)
    adjusted = np.empty(p_values.size)
    adjusted[order] = np.minimum(np.maximum.accumulate(steps), 1.0)
    return adjusted.reshape(p_values.shape)


def compare_outcomes(a: npt.ArrayLike, b: npt.ArrayLike) -> dict[str, Any]:
    """Do solvers A and B overturn the same blocks? A dict of counts, of McNemar's test, and of the difference it sees.

    Parameters
    ----------
    a, b : bool arrays, shape (n,)
        Outcomes on the same n independent motions. Several intensities of one motion are not
        independent: compare each intensity by itself, and adjust the p-values with `holm`.
    """
    table = confusion(a, b)
    return {
        **asdict(table),
        "p_value": mcnemar(table),
        "difference": (table.only_b - table.only_a) / table.size,
        "detectable_difference": detectable_difference(table.size, table.discordant / table.size),
    }


NORMAL = 1.959963984540054  # standard deviations that hold 95 %
ITERATIONS, HALVINGS = 60, 30  # of Newton
STEEPEST, FARTHEST = 1e4, 50.0  # slope of a curve, beyond it outcomes are separated; logarithm of a median
BINS, LEAST_VARIANCE = 10, 3.0  # of the test of fit: at most, and of the count in each, at least
MISSING = 0.1  # share of draws that may determine no curve


@dataclass(frozen=True)
class Fragility:
    """Lognormal fragility P(x) = Phi(ln(x/median)/dispersion)."""

    median: float
    dispersion: float

    def probability(self, intensity: npt.ArrayLike) -> Any:
        """Probability of exceedance at `intensity` (array or float, the unit of the fit)."""
        return norm.cdf(np.log(np.asarray(intensity) / self.median) / self.dispersion)


def fit_fragility(intensity: npt.ArrayLike, exceeded: npt.ArrayLike, size: npt.ArrayLike = 1.0) -> Fragility:
    """Lognormal fragility by maximum likelihood, Baker (2015), doi:10.1193/021113EQS025M, eq. (11).

    Parameters
    ----------
    intensity : array, shape (k,)
        Of each run, or intensity levels; above 0.
    exceeded, size : arrays, shape (k,)
        Runs that exceeded the limit state, and all of them; of single runs 0 or 1, of 1.

    Raises
    ------
    ValueError
        The outcomes determine no rising curve: they are separated, all alike, or fall with intensity.
    """
    intensity, exceeded = np.asarray(intensity, dtype=float), np.asarray(exceeded, dtype=float)
    size = np.broadcast_to(np.asarray(size, dtype=float), intensity.shape)
    if (intensity <= 0).any() or (exceeded < 0).any() or (exceeded > size).any():
        raise ValueError("fragility needs intensities above 0 and 0 <= exceeded <= size")
    above, below = intensity[exceeded > 0], intensity[exceeded < size]
    if len(above) == 0 or len(below) == 0 or above.min() >= below.max():
        raise ValueError(
            "outcomes do not overlap: none below the limit state lies above the lowest intensity that exceeds it; "
            "add intensities between, or motions"
        )
    (median,), (dispersion,) = _probit(np.log(intensity), exceeded[None], size[None])
    if np.isnan(median):
        raise ValueError("exceedance does not become likelier with intensity; a fragility curve makes no sense here")
    return Fragility(float(median), float(dispersion))


def draws(count: int, size: int, seed: int = 0) -> np.ndarray:
    """How often each of `size` runs is in each of `count` bootstrap samples, shape (count, size)."""
    chosen = np.random.Generator(np.random.PCG64(seed)).integers(size, size=(count, size))
    places = chosen + size * np.arange(count)[:, None]
    return np.bincount(places.ravel(), minlength=count * size).reshape(count, size)


def resampled(intensity: npt.ArrayLike, exceeded: npt.ArrayLike, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(medians, dispersions) of the bootstrap samples `weights` of `draws`; NaN where one determines no curve.

    Two fits to the same runs with the same weights are paired.
    """
    return _probit(np.log(np.asarray(intensity)), weights * np.asarray(exceeded, dtype=float), weights.astype(float))


def interval(estimate: float, values: np.ndarray) -> list[float] | None:
    """The 95 % interval [low, high] of a positive estimate from its bootstrap values, normal in the logarithm.

    The standard bootstrap interval, Efron and Tibshirani (1993), sec. 13.3: percentiles of dispersions cover less, as
    values lie below their estimate. None where too many values are NaN.
    """
    if np.isnan(values).mean() > MISSING:
        return None
    width = NORMAL * float(np.nanstd(np.log(values)))
    return [estimate * math.exp(-width), estimate * math.exp(width)]


def goodness(intensity: npt.ArrayLike, exceeded: npt.ArrayLike, curve: Fragility) -> float | None:
    """p-value of a fitted curve: Pearson's chi-square over bins of equal expected variance, two parameters fitted.

    As Hosmer and Lemeshow (1980), whose bins hold equally many runs: those in the tails would hold next to none of
    the variance. None where the runs are too few for three bins.
    """
    order = np.argsort(np.asarray(intensity))
    exceeded, expected = np.asarray(exceeded, dtype=float)[order], curve.probability(np.asarray(intensity)[order])
    variance = expected * (1 - expected)
    bins = min(BINS, int(variance.sum() / LEAST_VARIANCE))
    if bins < 3:
        return None
    edges = np.searchsorted(np.cumsum(variance), variance.sum() * np.arange(1, bins) / bins)
    starts = np.unique([0, *edges])
    seen, meant, spread = (np.add.reduceat(part, starts) for part in (exceeded, expected, variance))
    return float(chi2.sf(((seen - meant) ** 2 / spread).sum(), len(starts) - 2))


def points(intensity: npt.ArrayLike, exceeded: npt.ArrayLike, count: int) -> list[dict[str, Any]]:
    """Shares in `count` bins of equally many runs, with their Wilson intervals; intensity: the geometric mean."""
    intensity, exceeded = np.asarray(intensity), np.asarray(exceeded)
    found = []
    for members in np.array_split(np.argsort(intensity), count):
        if len(members):
            low, high = wilson(int(exceeded[members].sum()), len(members))
            middle = float(np.exp(np.log(intensity[members]).mean()))
            share = float(exceeded[members].mean())
            found.append({"intensity": middle, "share": share, "size": len(members), "low": low, "high": high})
    return found


def _probit(log_intensity, exceeded, size):
    """Maximum likelihood of P = Phi(a + b ln x) for several samples at once, as (median, dispersion), NaN without one.

    exceeded, size: shape (samples, k). All samples start at the fit to them together.
    """
    centre = size.sum(axis=0) @ log_intensity / size.sum()
    x = log_intensity - centre
    spread = np.sqrt(size.sum(axis=0) @ x**2 / size.sum())
    start = np.array([[0.0, 1 / max(spread, 1e-12)]])
    if len(size) > 1:
        together, _ = _climbed(start, x, exceeded.sum(axis=0)[None], size.sum(axis=0)[None])
        start = np.where(np.abs(together) <= STEEPEST, together, start)
    ab, settled = _climbed(np.repeat(start, len(size), axis=0), x, exceeded, size)
    sound = settled & (np.abs(ab[:, 0]) < FARTHEST * ab[:, 1]) & (ab[:, 1] <= STEEPEST)
    a, b = np.where(sound, ab.T, np.nan)
    return np.exp(centre - a / b), 1 / b


def _climbed(ab, x, exceeded, size):
    """((a, b) of each sample, whether it settled): Newton on a concave likelihood; a step too far is halved."""
    ab, rest, going = ab.copy(), size - exceeded, np.ones(len(size), dtype=bool)
    for _ in range(ITERATIONS):
        now, up, down = ab[going], exceeded[going], rest[going]
        before, step = _likelihood(now, x, up, down), _newton(now, x, up, down)
        for _ in range(HALVINGS):
            worse = ~(_likelihood(now + step, x, up, down) >= before - 1e-9 * (1 + np.abs(before)))
            if not worse.any():
                break
            step[worse] *= 0.5
        ab[going] = now + step
        small = np.abs(step).max(axis=1) < 1e-8 * (1 + np.abs(now[:, 1]))
        going[np.flatnonzero(going)[small | (np.abs(ab[going, 1]) > STEEPEST)]] = False
        if not going.any():
            break
    return ab, ~going


def _likelihood(ab, x, exceeded, rest):
    z = ab[:, :1] + ab[:, 1:] * x
    return (exceeded * log_ndtr(z) + rest * log_ndtr(-z)).sum(axis=1)


def _newton(ab, x, exceeded, rest):
    """Newton's step of (a, b) from the observed information, shape (samples, 2)."""
    z = ab[:, :1] + ab[:, 1:] * x
    up, down = _hazard(z), _hazard(-z)
    slope = exceeded * up - rest * down
    curvature = exceeded * up * (up + z) + rest * down * (down - z)
    aa, ab_, bb = curvature.sum(axis=1), curvature @ x, curvature @ x**2
    ga, gb = slope.sum(axis=1), slope @ x
    determinant = np.maximum(aa * bb - ab_**2, 1e-300)
    return np.stack([bb * ga - ab_ * gb, aa * gb - ab_ * ga], axis=1) / determinant[:, None]


def _hazard(z):
    """phi(z)/Phi(z), finite far into the lower tail."""
    return np.exp(-0.5 * z**2 - 0.5 * math.log(2 * math.pi) - log_ndtr(z))


CLASSES = ("right", "differs", "failed", "left out")


def class_of(comparable: str, quantities: Collection[str] | None, counted: Collection[str] | None = None) -> str:
    """One of `CLASSES`.

    Parameters
    ----------
    comparable : str
        Of the scene, by the model alone; a run of one that is not "yes" is left out, of all engines alike.
    quantities : collection of str or None
        In what the run differs (`Response.differences`); None: it failed.
    counted : collection of str or None
        The quantities that count; None: all.
    """
    if comparable != COMPARED:
        return "left out"
    if quantities is None:
        return "failed"
    return "differs" if set(quantities) & set(quantities if counted is None else counted) else "right"


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
