"""The force of one bearing: elastic kb x, hysteretic z with |z| <= f0 by one of `laws`, and viscous."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import TYPE_CHECKING, Self

import numpy as np

from .compiled import entry, inner
from .laws import LAWS, NUMBERS, Constants, law_function

if TYPE_CHECKING:
    from .laws.law import Law
    from .scene import Bearings
    from .types import Values

_after_travel = law_function("after_travel")


@inner
def hysteretic_force(z: float, dx: float, law: float, c: Constants) -> float:
    """Hysteretic force [N] after monotonic travel dx [m] from a point with hysteretic force z [N]."""
    if dx == 0:
        return z
    return _after_travel(law, z, dx, c)


@entry
def _path(z: float, x: np.ndarray, law: int, c: Constants, forces: np.ndarray) -> None:
    forces[0] = z
    for i in range(1, len(x)):
        z = hysteretic_force(z, x[i] - x[i - 1], float(law), c)
        forces[i] = z


# Engines call it at every step: passing numbers takes half the time of passing a record.
@entry
def _hysteretic(z: float, dx: float, law: int, *constants: float) -> float:
    return hysteretic_force(z, dx, float(law), Constants(*constants))


@dataclass(frozen=True)
class BearingLaw:
    """Constants of the law of one bearing, and its force.

    Attributes
    ----------
    law : int
        Index of the law in `LAWS`.
    count : int
        Number of bearings n_d.
    damping : float
        Viscous coefficient [N s/m].
    kb : float
        Elastic stiffness [N/m]; for a linear law it is the stiffness.
    constants : Constants
        dk = ka - kb [N/m] and f0, the limit of the hysteretic part [N], both 0 for a linear law; and the law's own
        constants: for the algebraic law its exponent alpha, x0 [m] of eq. (13) and d0 = (1 + 2 x0)^(1 - alpha).
    """

    law: int
    count: int
    damping: float
    kb: float
    constants: Constants

    @classmethod
    @functools.lru_cache(maxsize=64)  # needed some forty times in a run of an engine
    def of(cls, bearings: Bearings | None) -> Self:
        """The law of a `Bearings` part; None gives no force."""
        if bearings is None:
            return cls(NUMBERS["linear"], 0, 0.0, 0.0, Constants(dk=0.0, f0=0.0))
        number = NUMBERS[bearings.law]
        values = LAWS[number].constants(bearings)
        return cls(number, bearings.count, bearings.damping, values.pop("kb"), Constants(**values))

    @property
    def unit(self) -> Law:
        """The `Law` itself."""
        return LAWS[self.law]

    @property
    def dk(self) -> float:
        """ka - kb [N/m]."""
        return self.constants.dk

    @property
    def f0(self) -> float:
        """Limit of the hysteretic part [N]."""
        return self.constants.f0

    def hysteretic(self, z: float, dx: float) -> float:
        """z of one bearing [N] after monotonic travel dx [m] from z."""
        return _hysteretic(z, dx, self.law, *self.constants)

    def path(self, x: np.ndarray) -> np.ndarray:
        """z [N] along displacements x [m], shape (n,), monotonic in between; x[0] is reached by `start`."""
        forces = np.empty(len(x))
        _path(self.start(float(x[0])), x, self.law, self.constants, forces)
        return forces

    def start(self, displacement: float) -> float:
        """z of one bearing [N] after monotonic loading of the virgin bearing to `displacement` [m]."""
        return self.hysteretic(0.0, displacement)

    def force(self, x: Values, z: Values, v: Values | float = 0.0) -> Values:
        """Force of all bearings together [N], positive against positive x: eqs (9), (11), plus the viscous part."""
        return self.count * (self.kb * x + z + self.damping * v)

    def work(self, z: float, dx: float) -> float:
        """Integral of the hysteretic force of one bearing over monotonic travel dx [m] from z [J], exact."""
        return 0.0 if dx == 0 else self.unit.work(z, dx, self.constants)
