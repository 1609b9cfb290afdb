"""The bilinear law of most design codes: ka up to yield, kb after it, unloading at ka.

z' = (ka - kb) x' while |z| < f0, and z = +-f0 beyond. f0 is the characteristic strength Q_d = F_y (1 - kb/ka), the
force at which the line of kb meets x = 0; the yield displacement is x_y = F_y/ka = f0/(ka - kb).
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ..kernel.compiled import inlined, inner
from .law import Constants, Given, Law


def constants(bearings: Given) -> dict[str, float]:
    kb = bearings.given("kb")
    dk = bearings.ka - kb
    return {"kb": kb, "dk": dk, "f0": bearings.given("yield_force") * (dk / bearings.ka)}


@inner
def after_travel(z: float, dx: float, c: Constants) -> float:
    return min(max(z + c.dk * dx, -c.f0), c.f0)


def work(z: float, dx: float, c: Constants) -> float:
    z, length = math.copysign(1.0, dx) * z, abs(dx)
    elastic = min((c.f0 - z) / c.dk, length)
    return z * elastic + 0.5 * c.dk * elastic**2 + c.f0 * (length - elastic)


@inner
def recoverable(z: float, c: Constants) -> float:
    return 0.5 * z * z / c.dk


@inner
def begin(
    s: float, z: float, travel: float, power: float, c: Constants
) -> tuple[float, tuple[float, float, float], float]:
    if s * z < c.f0:
        return z, (c.dk, 0.0, 0.0), c.f0
    return z, (0.0, 0.0, 0.0), math.inf


@inlined
def term(k: int, factors: tuple[float, float, float], x: np.ndarray, v: np.ndarray, q: np.ndarray) -> float:
    """Return term k; q is z."""
    q[k] = factors[0] * x[k]
    return q[k]


def branch(z: float, direction: float, c: Constants) -> Callable[[float, float], float]:
    slope = c.dk if direction * z < c.f0 else 0.0
    return lambda z, v: slope * v


LAW = Law(
    "bilinear",
    needs=("kb", "yield_force"),
    constants=constants,
    after_travel=after_travel,
    work=work,
    recoverable=recoverable,
    begin=begin,
    term=term,
    branch=branch,
)
