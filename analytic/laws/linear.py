"""A linear spring, f = ka x: no hysteretic part."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numba import njit

from .law import Law

if TYPE_CHECKING:
    from ..scene import Bearings


def constants(bearings: Bearings) -> dict[str, float]:
    return {"kb": bearings.ka, "dk": 0.0, "f0": 0.0}


@njit(cache=True)
def after_travel(z: float, dx: float, dk: float, alpha: float, d0: float, f0: float) -> float:
    return z


def work(z: float, dx: float, dk: float, alpha: float, d0: float, f0: float) -> float:
    return 0.0


@njit(cache=True)
def recoverable(z: float, dk: float, alpha: float, d0: float, f0: float) -> float:
    return 0.0


@njit(cache=True)
def begin(
    s: float, z: float, travel: float, dk: float, alpha: float, d0: float, f0: float
) -> tuple[float, tuple[float, float, float], float]:
    return z, (0.0, 0.0, 0.0), math.inf


@njit(cache=True, inline="always")
def term(k: int, factors: tuple[float, float, float], x: np.ndarray, v: np.ndarray, q: np.ndarray) -> float:
    return 0.0


@njit(cache=True)
def reached(
    s: float,
    z: float,
    q: np.ndarray,
    order: int,
    h: float,
    travel: float,
    dk: float,
    alpha: float,
    d0: float,
    f0: float,
) -> float:
    return z


def expression(ops: Any, dx: Any, first: Any, second: Any, dk: float, alpha: float, d0: float, f0: float) -> Any:
    return first


LAW = Law(
    "linear",
    needs=(),
    ignores=("kb", "alpha"),
    constants=constants,
    memory=False,
    after_travel=after_travel,
    work=work,
    recoverable=recoverable,
    begin=begin,
    term=term,
    reached=reached,
    expression=expression,
)
