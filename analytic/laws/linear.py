"""A linear spring, f = ka x: no hysteretic part."""

from __future__ import annotations

import math

import numpy as np

from ..kernel.compiled import inlined, inner
from .law import Constants, Given, Law


def constants(bearings: Given) -> dict[str, float]:
    return {"kb": bearings.ka, "dk": 0.0, "f0": 0.0}


@inner
def after_travel(z: float, dx: float, c: Constants) -> float:
    return z


def work(z: float, dx: float, c: Constants) -> float:
    return 0.0


@inner
def recoverable(z: float, c: Constants) -> float:
    return 0.0


@inner
def begin(
    s: float, z: float, travel: float, power: float, c: Constants
) -> tuple[float, tuple[float, float, float], float]:
    return z, (0.0, 0.0, 0.0), math.inf


@inlined
def term(k: int, factors: tuple[float, float, float], x: np.ndarray, v: np.ndarray, q: np.ndarray) -> float:
    return 0.0


@inner
def reached(s: float, z: float, q: np.ndarray, order: int, h: float, power: float, c: Constants) -> float:
    return z


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
)
