"""Lognormal fragility of independent runs: the fit, its intervals by bootstrap, and whether the curve fits at all."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.special import log_ndtr
from scipy.stats import chi2, norm

from .statistics import wilson

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
