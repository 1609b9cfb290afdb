"""The Bouc-Wen law matched to f0, ka and kb of the algebraic one: dz/dx = (ka - kb)/2 (1 - s z/f0)."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numba import njit

from ..polynomial import INVERSE
from . import algebraic
from .law import Law

if TYPE_CHECKING:
    from ..bearing import BearingLaw


@njit(cache=True)
def after_travel(z: float, dx: float, dk: float, alpha: float, d0: float, f0: float) -> float:
    s = math.copysign(1.0, dx)
    return s * f0 - (s * f0 - z) * math.exp(-0.5 * dk / f0 * abs(dx))


def work(z: float, dx: float, dk: float, alpha: float, d0: float, f0: float) -> float:
    length, decay = abs(dx), 0.5 * dk / f0
    return f0 * length + (f0 - math.copysign(1.0, dx) * z) * math.expm1(-decay * length) / decay


@njit(cache=True)
def recoverable(z: float, dk: float, alpha: float, d0: float, f0: float) -> float:
    """dz/dx = (ka - kb)/2 (1 + z/f0) on the way back."""
    return 2 / dk * f0 * (z - f0 * math.log1p(z / f0))


@njit(cache=True)
def begin(
    s: float, z: float, travel: float, dk: float, alpha: float, d0: float, f0: float
) -> tuple[float, tuple[float, float, float], float]:
    return z, (0.5 * dk, 0.5 * dk * s / f0, 0.0), math.inf


@njit(cache=True, inline="always")
def term(k: int, factors: tuple[float, float, float], x: np.ndarray, v: np.ndarray, q: np.ndarray) -> float:
    """z' = (ka - kb)/2 v (1 - s z/f0); q is z."""
    total = 0.0
    for j in range(k):
        total += q[j] * v[k - 1 - j]
    q[k] = (factors[0] * v[k - 1] - factors[1] * total) * INVERSE[k]
    return q[k]


def branch(z: float, direction: float, law: BearingLaw) -> Callable[[float, float], float]:
    return lambda z, v: 0.5 * law.dk * v * (1 - direction * z / law.f0)


def expression(ops: Any, dx: Any, first: Any, second: Any, dk: float, alpha: float, d0: float, f0: float) -> Any:
    s = ops.where(dx >= 0.0, 1.0, -1.0)
    return s * f0 - (s * f0 - first) * ops.exp((-0.5 * dk / f0) * s * dx)


LAW = Law(
    "bouc-wen",
    needs=("kb", "alpha"),
    constants=algebraic.constants,
    after_travel=after_travel,
    work=work,
    recoverable=recoverable,
    begin=begin,
    term=term,
    branch=branch,
    expression=expression,
)
