"""A linear spring, f = ka x: no hysteretic part."""

import math

from numba import njit

from .law import Law


def constants(bearings):
    return {"kb": bearings.ka, "dk": 0.0, "f0": 0.0}


@njit(cache=True)
def after_travel(z, dx, dk, alpha, d0, f0):
    return z


def work(z, dx, dk, alpha, d0, f0):
    return 0.0


@njit(cache=True)
def recoverable(z, dk, alpha, d0, f0):
    return 0.0


@njit(cache=True)
def begin(s, z, travel, dk, alpha, d0, f0):
    return z, (0.0, 0.0, 0.0), math.inf


@njit(cache=True, inline="always")
def term(k, factors, x, v, q):
    return 0.0


@njit(cache=True)
def reached(s, z, q, order, h, travel, dk, alpha, d0, f0):
    return z


def expression(ops, dx, first, second, dk, alpha, d0, f0):
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
