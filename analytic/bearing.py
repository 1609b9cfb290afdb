"""The force of one bearing: elastic kb x, hysteretic z with |z| <= f0 by one of `laws`, and viscous."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Self

import numpy as np
from numba import njit

from .laws import LAWS, NUMBERS, chosen

if TYPE_CHECKING:
    from .laws.law import Law
    from .scene import Bearings
    from .types import Values

_after_travel, _sides = chosen("after_travel"), chosen("sides")


@njit(cache=True)
def hysteretic_force(z: float, dx: float, law: int, dk: float, alpha: float, d0: float, f0: float) -> float:
    """Hysteretic force [N] after monotonic travel dx [m] from a point with hysteretic force z [N]."""
    if dx == 0:
        return z
    return _after_travel(law, z, dx, dk, alpha, d0, f0)


@njit(cache=True)
def _path(z: float, x: np.ndarray, law: int, dk: float, alpha: float, d0: float, f0: float) -> np.ndarray:
    forces = np.empty_like(x)
    forces[0] = z
    for i in range(1, len(x)):
        z = hysteretic_force(z, x[i] - x[i - 1], law, dk, alpha, d0, f0)
        forces[i] = z
    return forces


@njit(cache=True)
def _moved(z: float, dx: float, law: int, dk: float, alpha: float, d0: float, f0: float) -> tuple[float, float, float]:
    z = hysteretic_force(z, dx, law, dk, alpha, d0, f0)
    first, second = _sides(law, z, dk, alpha, d0, f0)
    return z, first, second


@dataclass(frozen=True)
class BearingLaw:
    """Constants of the law of one bearing, and its force.

    Attributes
    ----------
    law : int
        Place of the law in `LAWS`.
    count : int
        Number of bearings n_d.
    damping : float
        Viscous coefficient [N s/m].
    kb, dk : float
        Elastic stiffness and ka - kb [N/m]; for a linear law kb is its stiffness, and dk is 0.
    f0 : float
        Limit of the hysteretic part [N], 0 for a linear law.
    alpha, x0, d0 : float
        Constants of the law itself. algebraic: its exponent, x0 [m] of eq. (13), D0 = (1 + 2 x0)^(1 - alpha).
    """

    law: int
    count: int
    damping: float
    kb: float
    dk: float
    f0: float
    alpha: float = 2.0
    x0: float = 0.0
    d0: float = 1.0

    @classmethod
    def of(cls, bearings: Bearings | None) -> Self:
        """The law of a `Bearings` part; of None, no force at all."""
        if bearings is None:
            return cls(NUMBERS["linear"], 0, 0.0, 0.0, 0.0, 0.0)
        number = NUMBERS[bearings.law]
        return cls(number, bearings.count, bearings.damping, **LAWS[number].constants(bearings))

    @property
    def unit(self) -> Law:
        """The `Law` itself."""
        return LAWS[self.law]

    @property
    def constants(self) -> tuple[float, float, float, float]:
        """(dk, alpha, d0, f0), the last arguments of the law's functions."""
        return self.dk, self.alpha, self.d0, self.f0

    def hysteretic(self, z: float, dx: float) -> float:
        """z of one bearing [N] after monotonic travel dx [m] from z."""
        return hysteretic_force(z, dx, self.law, *self.constants)

    def moved(self, z: float, dx: float) -> tuple[float, float, float]:
        """(z after dx, the two numbers that `Law.expression` continues from there)."""
        return _moved(z, dx, self.law, *self.constants)

    def path(self, x: np.ndarray) -> np.ndarray:
        """z [N] along displacements x [m], shape (n,), monotonic in between; x[0] is reached by `start`."""
        return _path(self.start(float(x[0])), x, self.law, *self.constants)

    def start(self, displacement: float) -> float:
        """z of one bearing [N] after monotonic loading of the virgin bearing to `displacement` [m]."""
        return self.hysteretic(0.0, displacement)

    def force(self, x: Values, z: Values, v: Values | float = 0.0) -> Values:
        """Force of all bearings together [N], positive against positive x: eqs (9), (11), plus the viscous part."""
        return self.count * (self.kb * x + z + self.damping * v)

    def work(self, z: float, dx: float) -> float:
        """Integral of the hysteretic force of one bearing over monotonic travel dx [m] from z [J], exact."""
        return 0.0 if dx == 0 else self.unit.work(z, dx, *self.constants)
