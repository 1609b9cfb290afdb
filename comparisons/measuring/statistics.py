"""Intervals and paired tests for differences between the outcomes of two solvers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.optimize import brentq
from scipy.stats import binom, binomtest, norm

if TYPE_CHECKING:
    import numpy.typing as npt

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


def compare(a: npt.ArrayLike, b: npt.ArrayLike) -> dict[str, Any]:
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
