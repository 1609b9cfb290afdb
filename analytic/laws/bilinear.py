"""The bilinear law, what most design codes use for a lead-rubber bearing: ka up to yield, kb after it, unloading at ka.

z' = (ka - kb) x' while |z| < f0, and z = +-f0 beyond. f0 is the characteristic strength Q_d = F_y (1 - kb/ka), the
force at which the line of kb meets x = 0; the yield displacement is x_y = F_y/ka = f0/(ka - kb).
"""

import math

from numba import njit

from .law import Law


def constants(bearings):
    dk = bearings.ka - bearings.kb
    return {"kb": bearings.kb, "dk": dk, "f0": bearings.yield_force * (dk / bearings.ka)}


@njit(cache=True)
def after_travel(z, dx, dk, alpha, d0, f0):
    return min(max(z + dk * dx, -f0), f0)


def work(z, dx, dk, alpha, d0, f0):
    z, length = math.copysign(1.0, dx) * z, abs(dx)
    elastic = min((f0 - z) / dk, length)
    return z * elastic + 0.5 * dk * elastic**2 + f0 * (length - elastic)


@njit(cache=True)
def recoverable(z, dk, alpha, d0, f0):
    return 0.5 * z * z / dk


@njit(cache=True)
def begin(s, z, travel, dk, alpha, d0, f0):
    if s * z < f0:
        return z, (dk, 0.0, 0.0), f0
    return z, (0.0, 0.0, 0.0), math.inf


@njit(cache=True, inline="always")
def term(k, factors, x, v, q):
    """q is z."""
    q[k] = factors[0] * x[k]
    return q[k]


def branch(z, direction, law):
    slope = law.dk if direction * z < law.f0 else 0.0
    return lambda z, v: slope * v


def expression(ops, dx, first, second, dk, alpha, d0, f0):
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
