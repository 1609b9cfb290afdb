"""The Bouc-Wen law matched to f0, ka and kb of the algebraic one: dz/dx = (ka - kb)/2 (1 - s z/f0)."""

import math

from numba import njit

from ..polynomial import INVERSE
from . import algebraic
from .law import Law


@njit(cache=True)
def after_travel(z, dx, dk, alpha, d0, f0):
    s = math.copysign(1.0, dx)
    return s * f0 - (s * f0 - z) * math.exp(-0.5 * dk / f0 * abs(dx))


def work(z, dx, dk, alpha, d0, f0):
    length, decay = abs(dx), 0.5 * dk / f0
    return f0 * length + (f0 - math.copysign(1.0, dx) * z) * math.expm1(-decay * length) / decay


@njit(cache=True)
def recoverable(z, dk, alpha, d0, f0):
    """dz/dx = (ka - kb)/2 (1 + z/f0) on the way back."""
    return 2 / dk * f0 * (z - f0 * math.log1p(z / f0))


@njit(cache=True)
def begin(s, z, travel, dk, alpha, d0, f0):
    return z, (0.5 * dk, 0.5 * dk * s / f0, 0.0), math.inf


@njit(cache=True, inline="always")
def term(k, factors, x, v, q):
    """z' = (ka - kb)/2 v (1 - s z/f0); q is z."""
    total = 0.0
    for j in range(k):
        total += q[j] * v[k - 1 - j]
    q[k] = (factors[0] * v[k - 1] - factors[1] * total) * INVERSE[k]
    return q[k]


def branch(z, direction, law):
    return lambda z, v: 0.5 * law.dk * v * (1 - direction * z / law.f0)


def expression(ops, dx, first, second, dk, alpha, d0, f0):
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
