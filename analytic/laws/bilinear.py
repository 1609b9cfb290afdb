"""The bilinear law, what most design codes use for a lead-rubber bearing: ka up to yield, kb after it, unloading at ka.

z' = (ka - kb) x' while |z| < f0, and z = +-f0 beyond. f0 is the characteristic strength Q_d = F_y (1 - kb/ka), the
force at which the line of kb meets x = 0; the yield displacement is x_y = F_y/ka = f0/(ka - kb).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numba import njit

from .law import Law

if TYPE_CHECKING:
    from ..bearing import BearingLaw
    from ..scene import Bearings


def constants(bearings: Bearings) -> dict[str, float]:
    kb = bearings.given("kb")
    dk = bearings.ka - kb
    return {"kb": kb, "dk": dk, "f0": bearings.given("yield_force") * (dk / bearings.ka)}


@njit(cache=True)
def after_travel(z: float, dx: float, dk: float, alpha: float, d0: float, f0: float) -> float:
    return min(max(z + dk * dx, -f0), f0)


def work(z: float, dx: float, dk: float, alpha: float, d0: float, f0: float) -> float:
    z, length = math.copysign(1.0, dx) * z, abs(dx)
    elastic = min((f0 - z) / dk, length)
    return z * elastic + 0.5 * dk * elastic**2 + f0 * (length - elastic)


@njit(cache=True)
def recoverable(z: float, dk: float, alpha: float, d0: float, f0: float) -> float:
    return 0.5 * z * z / dk


@njit(cache=True)
def begin(
    s: float, z: float, travel: float, dk: float, alpha: float, d0: float, f0: float
) -> tuple[float, tuple[float, float, float], float]:
    if s * z < f0:
        return z, (dk, 0.0, 0.0), f0
    return z, (0.0, 0.0, 0.0), math.inf


@njit(cache=True, inline="always")
def term(k: int, factors: tuple[float, float, float], x: np.ndarray, v: np.ndarray, q: np.ndarray) -> float:
    """q is z."""
    q[k] = factors[0] * x[k]
    return q[k]


def branch(z: float, direction: float, law: BearingLaw) -> Callable[[float, float], float]:
    slope = law.dk if direction * z < law.f0 else 0.0
    return lambda z, v: slope * v


def expression(ops: Any, dx: Any, first: Any, second: Any, dk: float, alpha: float, d0: float, f0: float) -> Any:
    elastic = first + dk * dx
    return ops.where(elastic >= f0, f0, ops.where(elastic >= -f0, elastic, -f0))


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
    expression=expression,
)
