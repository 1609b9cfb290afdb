"""Statistics of outcomes: classes of runs, intervals, paired tests, lognormal fragility, and forecasts.

The class of a run is one word, the same in every study. Intervals and paired tests tell whether the overturning
outcomes of two solvers differ. Fragility is fitted to independent runs, with intervals by bootstrap and a test of fit.

A forecast of a yes or no is a probability, fitted to some cases and judged on others; it says yes from one half on.
Cases of one group (tests under one record) may depend on each other. So a group is held out as a whole, and intervals
come from a bootstrap over groups.
"""

import math
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import asdict, dataclass
from itertools import combinations_with_replacement
from typing import Any

import numpy as np
import numpy.typing as npt
import scipy  # a part of it is loaded when it is first used, as some take .2 s

from analytic.response import COMPARED

WIDEST = 8.0  # normal quantile, beyond which a level is 1 in rounding; that of two groups would be 12.7
EQUAL = 0.05  # largest share of differing runs of solvers that count as equal
TOO_FEW = "inconclusive (too few runs)"  # a result of `equality`


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
        """Return the counts, shape (2, 2). Rows: A stands, A overturns; columns: B stands, B overturns."""
        return np.array([[self.both_stand, self.only_b], [self.only_a, self.both_overturn]])


def confusion(a: npt.ArrayLike, b: npt.ArrayLike) -> Confusion:
    """Return the confusion table of two arrays of outcomes, shape (n,), True: overturns.

    Raises
    ------
    ValueError
        The arrays differ in length, are empty, or are not boolean. A failed run has no outcome: leave its pair out, and
        say how many were left out.
    """
    a, b = np.asarray(a), np.asarray(b)
    if a.dtype != bool or b.dtype != bool or a.shape != b.shape or a.ndim != 1 or len(a) == 0:
        raise ValueError(
            f"paired outcomes must be two boolean arrays of one length above 0, not {a.dtype} "
            f"{a.shape} and {b.dtype} {b.shape}; leave failed runs out in pairs"
        )
    return Confusion(int((~a & ~b).sum()), int((a & b).sum()), int((a & ~b).sum()), int((~a & b).sum()))


def wilson(count: float, size: float, level: float = 0.95) -> tuple[float, float]:
    """Return Wilson's score interval (1927) of a probability that was seen `count` times in `size`: (low, high).

    Neither needs to be a whole number: if runs depend on each other, `size` is the number of independent ones.
    """
    z = scipy.special.ndtri(0.5 + level / 2)
    share, spread = count / size, z**2 / size
    half = math.sqrt(spread * (share * (1 - share) + spread / 4))
    ends = [(share + spread / 2 + side * half) / (1 + spread) for side in (-1, 1)]
    return 0.0 if count == 0 else float(max(ends[0], 0.0)), 1.0 if count == size else float(min(ends[1], 1.0))


def wilson_by_group(shares: npt.ArrayLike, size: int, level: float = 0.95) -> tuple[float, float]:
    """Return Wilson's interval of a probability from its shares in independent groups of `size` runs: (low, high).

    The number of independent runs is the one that gives the scatter of the shares, as Korn and Graubard (1998) have it,
    with Student's t for the normal quantile. It is trusted only if half of the groups have each of the two outcomes;
    otherwise each group counts as one run, which is a safe side. Of 4000 draws of 6 to 100 groups from beta-binomial
    distributions, with probabilities from 0.02 to 0.5, 93 to 100 % were covered.

    shares : array, shape (groups,).
    """
    shares = np.asarray(shares, dtype=float)
    mean, count, runs = float(shares.mean()), len(shares), float(len(shares))
    wider = 2 * scipy.special.ndtr(min(scipy.special.stdtrit(max(count - 1, 1), 0.5 + level / 2), WIDEST)) - 1
    if count > 1 and 2 * min((shares > 0).sum(), (shares < 1).sum()) >= count:
        variance = max(float(shares.var(ddof=1)), 1e-300)
        runs = float(np.clip(mean * (1 - mean) * count / variance, count, count * size))
    return wilson(mean * runs, runs, wider)


def equality(differs: npt.ArrayLike, groups: Sequence[Any] | None = None) -> tuple[str, tuple[float, float]]:
    """Return whether two solvers are equal, in a word, and the 95 % interval of the share of runs that differ.

    "yes": the upper limit is below `EQUAL`. `TOO_FEW`: even if no run differed, the upper limit would not be below
    `EQUAL`, and the lower limit is not above it. "no": otherwise; lack of power proves nothing.

    Parameters
    ----------
    differs : bool array, shape (n,), n >= 1
        Whether each run differs; a failed run differs.
    groups : sequence of length n, optional
        Group of each run. Runs of a group, such as those under one record, may depend on each other, so a group counts
        as one run. None: all runs are independent.
    """
    differs = np.asarray(differs, dtype=bool)
    size = len(differs) if groups is None else len(set(groups))
    low, high = wilson(float(differs.mean()) * size, size)
    if wilson(0, size)[1] >= EQUAL and low <= EQUAL:
        return TOO_FEW, (low, high)
    return "yes" if high < EQUAL else "no", (low, high)


def mcnemar(table: Confusion) -> float:
    """Return the two-sided p-value of the exact McNemar test: are the discordant pairs split evenly?"""
    if table.discordant == 0:
        return 1.0
    return float(scipy.stats.binomtest(table.only_a, table.discordant, 0.5).pvalue)


def cohen_kappa(table: npt.ArrayLike, level: float = 0.95) -> tuple[float, float, float] | tuple[None, None, None]:
    """Return Cohen's kappa (1960) of a square table of counts, and its interval: (kappa, low, high).

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
    width = scipy.special.ndtri(0.5 + level / 2) * math.sqrt(max(variance, 0.0))
    return kappa, max(kappa - width, -1.0), min(kappa + width, 1.0)


def detectable_difference(size: int, discordance: float, level: float = 0.05, power: float = 0.8) -> float | None:
    """Return the smallest difference of two overturning probabilities that `size` pairs would show, or None.

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
    binom = scipy.stats.binom
    critical = binom.ppf(level / 2, numbers, 0.5)
    critical = np.where(2 * binom.cdf(critical, numbers, 0.5) <= level, critical, critical - 1)

    def excess(difference):
        rate = max(discordance, difference)
        split = min((rate + difference) / (2 * rate), 1.0)
        rejected = binom.cdf(critical, numbers, split) + binom.sf(numbers - critical - 1, numbers, split)
        return float(binom.pmf(numbers, size, rate) @ np.where(critical >= 0, rejected, 0.0)) - power

    if excess(1.0) < 0:
        return None
    return float(scipy.optimize.brentq(excess, 1e-9, 1.0, xtol=1e-9))


def holm(p_values: npt.ArrayLike) -> np.ndarray:
    """Return the p-values of several tests, adjusted for their number by Holm's step-down method (1979); same shape."""
    p_values = np.asarray(p_values, dtype=float)
    order = np.argsort(p_values, axis=None)
    steps = p_values.ravel()[order] * np.arange(p_values.size, 0, -1)
    adjusted = np.empty(p_values.size)
    adjusted[order] = np.minimum(np.maximum.accumulate(steps), 1.0)
    return adjusted.reshape(p_values.shape)


def compare_outcomes(a: npt.ArrayLike, b: npt.ArrayLike) -> dict[str, Any]:
    """Return whether solvers A and B overturn the same blocks: counts, McNemar's test, and the difference it detects.

    Parameters
    ----------
    a, b : bool arrays, shape (n,)
        Outcomes on the same n independent motions. Several intensities of one motion are not independent: compare each
        intensity separately, and adjust the p-values with `holm`.
    """
    table = confusion(a, b)
    return {
        **asdict(table),
        "p_value": mcnemar(table),
        "difference": (table.only_b - table.only_a) / table.size,
        "detectable_difference": detectable_difference(table.size, table.discordant / table.size),
    }


NORMAL = 1.959963984540054  # half-width of the central 95 % of a normal distribution, in standard deviations
ITERATIONS, HALVINGS = 60, 30  # limits of Newton's method
STEEPEST, FARTHEST = 1e4, 50.0  # largest slope of a curve, beyond which outcomes are separated; of |ln median|
BINS, LEAST_VARIANCE = 10, 3.0  # of the test of fit: most bins, and least variance of the count in each
MISSING = 0.1  # largest share of draws that determine no curve


@dataclass(frozen=True)
class Fragility:
    """Lognormal fragility P(x) = Phi(ln(x/median)/dispersion)."""

    median: float
    dispersion: float

    def probability(self, intensity: npt.ArrayLike) -> Any:
        """Return the probability of exceedance at `intensity` (array or float, in the unit of the fit)."""
        return scipy.special.ndtr(np.log(np.asarray(intensity) / self.median) / self.dispersion)


def fit_fragility(intensity: npt.ArrayLike, exceeded: npt.ArrayLike, size: npt.ArrayLike = 1.0) -> Fragility:
    """Fit a lognormal fragility by maximum likelihood, Baker (2015), doi:10.1193/021113EQS025M, eq. (11).

    Parameters
    ----------
    intensity : array, shape (k,)
        Intensity of each run, or intensity levels; above 0.
    exceeded, size : arrays, shape (k,)
        Number of runs that exceeded the limit state, and of all runs; for single runs 0 or 1, and 1.

    Raises
    ------
    ValueError
        The outcomes determine no rising curve: they are separated, all equal, or fall with intensity.
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
    """Return how often each of `size` runs is in each of `count` bootstrap samples, shape (count, size)."""
    chosen = np.random.Generator(np.random.PCG64(seed)).integers(size, size=(count, size))
    places = chosen + size * np.arange(count)[:, None]
    return np.bincount(places.ravel(), minlength=count * size).reshape(count, size)


def resampled(intensity: npt.ArrayLike, exceeded: npt.ArrayLike, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return (medians, dispersions) of bootstrap samples; NaN where a sample determines no curve.

    weights: as `draws` returns them. Two fits to the same runs with the same weights are paired.
    """
    return _probit(np.log(np.asarray(intensity)), weights * np.asarray(exceeded, dtype=float), weights.astype(float))


def interval(estimate: float, values: np.ndarray) -> list[float] | None:
    """Return the 95 % interval [low, high] of a positive estimate from its bootstrap values, normal in the logarithm.

    This is the standard bootstrap interval, Efron and Tibshirani (1993), sec. 13.3. Percentiles of dispersions cover
    less, because the values lie below their estimate. None if too many values are NaN.
    """
    if np.isnan(values).mean() > MISSING:
        return None
    width = NORMAL * float(np.nanstd(np.log(values)))
    return [estimate * math.exp(-width), estimate * math.exp(width)]


def goodness(intensity: npt.ArrayLike, exceeded: npt.ArrayLike, curve: Fragility) -> float | None:
    """Return the p-value of a fitted curve: Pearson's chi-square over bins, with two parameters fitted.

    The test is that of Hosmer and Lemeshow (1980), but with bins of equal expected variance in place of equally many
    runs: bins in the tails would have hardly any variance. None if the runs are too few for three bins.
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
    return float(scipy.stats.chi2.sf(((seen - meant) ** 2 / spread).sum(), len(starts) - 2))


def points(intensity: npt.ArrayLike, exceeded: npt.ArrayLike, count: int) -> list[dict[str, Any]]:
    """Return the shares in `count` bins of equally many runs, with Wilson intervals. intensity: the geometric mean."""
    intensity, exceeded = np.asarray(intensity), np.asarray(exceeded)
    bins = []
    for members in np.array_split(np.argsort(intensity), count):
        if len(members):
            low, high = wilson(int(exceeded[members].sum()), len(members))
            middle = float(np.exp(np.log(intensity[members]).mean()))
            share = float(exceeded[members].mean())
            bins.append({"intensity": middle, "share": share, "size": len(members), "low": low, "high": high})
    return bins


def _probit(log_intensity, exceeded, size):
    """(median, dispersion) of P = Phi(a + b ln x) by maximum likelihood for several samples at once; NaN without a fit.

    exceeded, size: shape (samples, k). All samples start at the fit to their sum.
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
    """((a, b) of each sample, whether it converged), by Newton's method on a concave likelihood with halved steps."""
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
    return (exceeded * scipy.special.log_ndtr(z) + rest * scipy.special.log_ndtr(-z)).sum(axis=1)


def _newton(ab, x, exceeded, rest):
    """The Newton step of (a, b) from the observed information, shape (samples, 2)."""
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
    return np.exp(-0.5 * z**2 - 0.5 * math.log(2 * math.pi) - scipy.special.log_ndtr(z))


CLASSES = ("right", "differs", "failed", "left out")


def class_of(comparable: str, quantities: Collection[str] | None, counted: Collection[str] | None = None) -> str:
    """Return the class of a run, one of `CLASSES`.

    Parameters
    ----------
    comparable : str
        Whether the model can be compared with in the scene. Unless it is "yes", the runs of all engines are left out.
    quantities : collection of str or None
        Quantities in which the run differs (`Response.differences`); None: the run failed.
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
STEPS, SMALL, SETTLED = 1000, 1e-8, 1e-6  # of the search: most steps, its tolerance, largest slope for each case
RIDGE = 1e-6  # keeps the slope finite if outcomes are separated


def right(probability: npt.ArrayLike, happened: npt.ArrayLike) -> np.ndarray:
    """Return where the forecast is right, bool."""
    return (np.asarray(probability) >= HALF) == np.asarray(happened, dtype=bool)


def brier(probability: npt.ArrayLike, happened: npt.ArrayLike) -> np.ndarray:
    """Return Brier's score (1950) of each case, the squared error. The score of a forecast is the mean.

    0 is best; a probability of one half in all cases gives 1/4.
    """
    return (np.asarray(probability, dtype=float) - np.asarray(happened, dtype=float)) ** 2


def folds(groups: Sequence[Any]) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Yield for each group (the other cases, its own cases), bool arrays."""
    names = np.array([str(group) for group in groups])
    for name in dict.fromkeys(names.tolist()):
        yield names != name, names == name


def halves(count: int) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Yield two sides: every other case and the rest, and the reverse."""
    even = np.arange(count) % 2 == 0
    yield even, ~even
    yield ~even, even


def held_out(
    fit: Callable[[np.ndarray], np.ndarray], sides: Iterator[tuple[np.ndarray, np.ndarray]], count: int
) -> np.ndarray:
    """Return probabilities, shape (count,), each fitted to other cases. fit: (chosen cases) -> those of all cases."""
    probabilities = np.full(count, np.nan)
    for others, held in sides:
        probabilities[held] = fit(others)[held]
    return probabilities


def threshold(values: npt.ArrayLike, happened: npt.ArrayLike) -> float:
    """Return the value, between two cases, above which a yes is right most often; the middle of equally good ones."""
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
    """Return the middle one of several equally good places."""
    places = np.asarray(places)
    return int(places[(len(places) - 1) // 2])


def logistic(features: npt.ArrayLike, happened: npt.ArrayLike, chosen: np.ndarray) -> np.ndarray:
    """Return probabilities of all cases by logistic regression, fitted to the chosen ones by maximum likelihood.

    features: shape (cases, features); the caller takes logarithms.

    Raises
    ------
    ArithmeticError
        The search has not converged.
    """
    features, happened = np.asarray(features, dtype=float), np.asarray(happened, dtype=float)
    columns = np.column_stack([np.ones(len(features)), _standard(features, chosen)])
    mine, yes = columns[chosen], happened[chosen]
    ridge = RIDGE * np.append(0, np.ones(columns.shape[1] - 1))

    def loss(beta):
        z = mine @ beta
        value = (np.logaddexp(0, z) - yes * z).sum() + 0.5 * (ridge * beta**2).sum()
        return value, mine.T @ (scipy.special.expit(z) - yes) + ridge * beta

    def curvature(beta):
        p = scipy.special.expit(mine @ beta)
        return (mine.T * (p * (1 - p))) @ mine + np.diag(ridge + RIDGE)

    start = np.zeros(columns.shape[1])
    fit = scipy.optimize.minimize(
        loss, start, jac=True, hess=curvature, method="trust-exact", options={"gtol": SMALL, "maxiter": STEPS}
    )
    if np.abs(loss(fit.x)[1]).max() > SETTLED * len(yes):
        raise ArithmeticError(f"logistic regression of {len(yes)} cases has not settled: {fit.message}")
    return scipy.special.expit(columns @ fit.x)


def bent(features: npt.ArrayLike) -> np.ndarray:
    """Return standardised features with their squares and products, for a logistic curve that may bend."""
    features = np.asarray(features, dtype=float)
    plain = _standard(features, np.ones(len(features), dtype=bool))
    pairs = combinations_with_replacement(range(plain.shape[1]), 2)
    return np.column_stack([plain, *(plain[:, first] * plain[:, second] for first, second in pairs)])


def _standard(features, chosen):
    """Features less the mean and over the standard deviation of the chosen cases; a constant one is only shifted."""
    centre, spread = features[chosen].mean(axis=0), features[chosen].std(axis=0)
    return (features - centre) / np.where(spread > 0, spread, 1)


def clustered(values: npt.ArrayLike, groups: Sequence[Any], seed: int = 0) -> list[float]:
    """Return the 95 % interval [low, high] of the mean of values: percentiles of a bootstrap over groups.

    A draw takes as many groups as there are, with replacement, each with all its cases.
    """
    values = np.asarray(values, dtype=float)
    _, places = np.unique([str(group) for group in groups], return_inverse=True)
    sums, sizes = np.bincount(places, values), np.bincount(places)
    weights = draws(DRAWS, len(sizes), seed)
    low, high = np.percentile((weights @ sums) / (weights @ sizes), [2.5, 97.5])
    return [float(low), float(high)]
