"""The algebraic hysteretic law of the paper, eqs (9)-(14).

It gives z after monotonic travel from any point (x_c, z_c) of the path in closed form. The pair (x, z) is therefore the
complete memory: no list of reversal points is needed.
"""

from __future__ import annotations

import math

import numpy as np

from ..kernel.compiled import inlined, inner
from ..kernel.polynomial import INVERSE
from .law import Constants, Given, Law


def constants(bearings: Given) -> dict[str, float]:
    kb, alpha = bearings.given("kb"), bearings.given("alpha")
    dk = bearings.ka - kb
    x0 = 0.5 * ((bearings.given("delta_k") / dk) ** (-1 / alpha) - 1)  # (13)
    d0 = (1 + 2 * x0) ** (1 - alpha)
    f0 = 0.5 * dk * (d0 - 1) / (1 - alpha)  # (14)
    return {"kb": kb, "dk": dk, "alpha": alpha, "x0": x0, "d0": d0, "f0": f0}


@inner
def virtual_travel(s: float, z: float, c: Constants) -> float:
    """Return D_c: the position on the limit curve of direction s [m] at which the hysteretic force is z.

    With x_j as in eqs (10) and (12), a negative number would be raised to a power beyond 1.33 m of travel; this form is
    equivalent and avoids it. (The bracket of eq. (12) is misprinted; it must read 1 - x + x_j + 2 x0.)
    """
    power = c.d0 + (1 - c.alpha) * (s * z - c.f0) / c.dk  # D_c^(1 - alpha)
    return max(c.d0, power) ** (1 / (1 - c.alpha))


@inner
def power(travel: float, c: Constants) -> float:
    return travel ** (1 - c.alpha)


@inner
def on_branch(s: float, power: float, c: Constants) -> float:
    """Return z on the branch of direction s, eqs (9), (11) less their kb x."""
    return s * (c.dk * (power - c.d0) / (1 - c.alpha) + c.f0)


@inner
def after_travel(z: float, dx: float, c: Constants) -> float:
    s = math.copysign(1.0, dx)
    return on_branch(s, power(virtual_travel(s, z, c) + abs(dx), c), c)


def work(z: float, dx: float, c: Constants) -> float:
    alpha, length = c.alpha, abs(dx)
    start = virtual_travel.py_func(math.copysign(1.0, dx), z, c)
    if alpha == 2:
        curved = math.log1p(length / start)
    else:
        curved = ((start + length) ** (2 - alpha) - start ** (2 - alpha)) / (2 - alpha)
    return c.dk * (curved - length * c.d0) / (1 - alpha) + length * c.f0


@inner
def recoverable(z: float, c: Constants) -> float:
    """Return the energy along the path of eqs (11), (12) between the virtual travels D of z and of 0.

    These are D^-a = D0 + a (f0 + z)/(ka - kb) with a = alpha - 1.
    """
    a, dk, d0, f0 = c.alpha - 1, c.dk, c.d0, c.f0
    begin, end = -math.log(d0 + a * (f0 + z) / dk) / a, -math.log(d0 + a * f0 / dk) / a  # log D
    length = end - begin
    if end > 600:
        return math.inf  # alpha near 1: unbounded
    power = length if abs((1 - a) * length) < 1e-8 else math.expm1((1 - a) * length) / (1 - a)
    travel = math.exp(begin) * math.expm1(length)
    return dk / a * math.exp((1 - a) * begin) * power - (f0 + dk * d0 / a) * travel


@inner
def begin(
    s: float, z: float, travel: float, power: float, c: Constants
) -> tuple[float, tuple[float, float, float], float]:
    """Return the start of a step; q is y^(1 - alpha) with y = D_c + s (x - x_c), the `travel`."""
    return power if s != 0 else 0.0, (s * (1.0 / travel), 2 - c.alpha, s * c.dk / (1 - c.alpha)), math.inf


@inlined
def term(k: int, factors: tuple[float, float, float], x: np.ndarray, v: np.ndarray, q: np.ndarray) -> float:
    """Return term k by y q' = (1 - alpha) y' q with y' = s v: k y_0 q_k = s sum((2 - alpha) v q - k x q)."""
    speed, travel = 0.0, 0.0
    for j in range(k):
        speed += v[j] * q[k - 1 - j]
        travel += x[j + 1] * q[k - 1 - j]
    over, power, slope = factors
    q[k] = over * (power * speed * INVERSE[k] - travel)
    return slope * q[k]


@inner
def reached(s: float, z: float, q: np.ndarray, order: int, h: float, power: float, c: Constants) -> float:
    return z if s == 0 else on_branch(s, power, c)


LAW = Law(
    "algebraic",
    needs=("kb", "alpha"),
    constant_names=("alpha", "x0", "d0"),
    constants=constants,
    after_travel=after_travel,
    work=work,
    recoverable=recoverable,
    begin=begin,
    term=term,
    mark=virtual_travel,
    power=power,
    reached=reached,
)
