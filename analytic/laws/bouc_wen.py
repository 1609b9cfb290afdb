"""The Bouc-Wen law matched to f0, ka and kb of the algebraic one: dz/dx = (ka - kb)/2 (1 - s z/f0)."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ..kernel.compiled import inlined, inner
from ..kernel.polynomial import INVERSE
from . import algebraic
from .law import Constants, Law


@inner
def after_travel(z: float, dx: float, c: Constants) -> float:
    s = math.copysign(1.0, dx)
    return s * c.f0 - (s * c.f0 - z) * math.exp(-0.5 * c.dk / c.f0 * abs(dx))


def work(z: float, dx: float, c: Constants) -> float:
    length, decay = abs(dx), 0.5 * c.dk / c.f0
    return c.f0 * length + (c.f0 - math.copysign(1.0, dx) * z) * math.expm1(-decay * length) / decay


@inner
def recoverable(z: float, c: Constants) -> float:
    """Return the energy of unloading, which follows dz/dx = (ka - kb)/2 (1 + z/f0)."""
    return 2 / c.dk * c.f0 * (z - c.f0 * math.log1p(z / c.f0))


@inner
def begin(
    s: float, z: float, travel: float, power: float, c: Constants
) -> tuple[float, tuple[float, float, float], float]:
    return z, (0.5 * c.dk, 0.5 * c.dk * s / c.f0, 0.0), math.inf


@inlined
def term(k: int, factors: tuple[float, float, float], x: np.ndarray, v: np.ndarray, q: np.ndarray) -> float:
    """Return term k by z' = (ka - kb)/2 v (1 - s z/f0); q is z."""
    total = 0.0
    for j in range(k):
        total += q[j] * v[k - 1 - j]
    q[k] = (factors[0] * v[k - 1] - factors[1] * total) * INVERSE[k]
    return q[k]


def branch(z: float, direction: float, c: Constants) -> Callable[[float, float], float]:
    return lambda z, v: 0.5 * c.dk * v * (1 - direction * z / c.f0)


LAW = Law(
    "bouc-wen",
    needs=("kb", "alpha"),
    constant_names=algebraic.LAW.constant_names,
    constants=algebraic.constants,
    after_travel=after_travel,
    work=work,
    recoverable=recoverable,
    begin=begin,
    term=term,
    branch=branch,
)
