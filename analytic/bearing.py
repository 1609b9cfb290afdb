"""The force of one bearing: the algebraic law, eqs (9)-(14), its Bouc-Wen twin and a linear spring.

The force splits into an elastic part kb x, a hysteretic part z with |z| <= f0, and a viscous part. From any point
(x_c, z_c) of its path the algebraic law gives z after monotonic travel in closed form, so the pair (x, z) is its
whole memory: no list of reversal points is needed.
"""

import math
from dataclasses import dataclass

from numba import njit

# Laws by number, for compiled code.
FREE, LINEAR, ALGEBRAIC, BOUC_WEN = range(4)
LAWS = {"linear": LINEAR, "algebraic": ALGEBRAIC, "bouc-wen": BOUC_WEN}


@njit(cache=True, inline="always")
def virtual_travel(s, z, dk, alpha, d0, f0):
    """D_c: where the point with hysteretic force z stands on the limit curve of direction s [m].

    The literal x_j of eqs (10) and (12) raises a negative number to a power beyond 1.33 m of travel; this form
    of the same history does not. (The bracket of eq. (12) is misprinted; it must read 1 - x + x_j + 2 x0.)
    """
    power = d0 + (1 - alpha) * (s * z - f0) / dk  # D_c^(1 - alpha)
    return max(d0, power) ** (1 / (1 - alpha))


@njit(cache=True)
def hysteretic_force(z, dx, law, dk, alpha, d0, f0):
    """Hysteretic force [N] after monotonic travel dx [m] from a point with hysteretic force z [N].

    algebraic: eqs (9), (11) less their kb x, with the history in its stable form.
    bouc-wen: dz/dx = (ka - kb)/2 (1 - s z/f0), solved.
    """
    if dx == 0 or law < ALGEBRAIC:
        return z
    s = math.copysign(1.0, dx)
    if law == BOUC_WEN:
        return s * f0 - (s * f0 - z) * math.exp(-0.5 * dk / f0 * abs(dx))
    travel = virtual_travel(s, z, dk, alpha, d0, f0) + abs(dx)
    return s * (dk * (travel ** (1 - alpha) - d0) / (1 - alpha) + f0)


@dataclass(frozen=True)
class BearingLaw:
    """Constants of the law of one bearing, and its force.

    Attributes
    ----------
    law : int
        One of FREE, LINEAR, ALGEBRAIC, BOUC_WEN.
    count : int
        Number of bearings n_d.
    kb, dk : float
        Elastic stiffness and ka - kb [N/m]; for a linear law kb is its stiffness.
    alpha, x0, d0, f0 : float
        Exponent; x0 [m] of eq. (13); D0 = (1 + 2 x0)^(1 - alpha); f0 [N] of eq. (14).
    damping : float
        Viscous coefficient [N s/m].
    """

    law: int
    count: int
    kb: float
    dk: float
    alpha: float
    x0: float
    d0: float
    f0: float
    damping: float

    @classmethod
    def of(cls, bearings):
        """The law of a `Bearings` part; of None, no force at all."""
        if bearings is None:
            return cls(FREE, 0, 0.0, 1.0, 2.0, 0.0, 1.0, 0.0, 0.0)
        if bearings.law == "linear":
            return cls(LINEAR, bearings.count, bearings.ka, 1.0, 2.0, 0.0, 1.0, 0.0, bearings.damping)
        dk, alpha = bearings.ka - bearings.kb, bearings.alpha
        x0 = 0.5 * ((bearings.delta_k / dk) ** (-1 / alpha) - 1)  # (13)
        d0 = (1 + 2 * x0) ** (1 - alpha)
        f0 = 0.5 * dk * (d0 - 1) / (1 - alpha)  # (14)
        return cls(LAWS[bearings.law], bearings.count, bearings.kb, dk, alpha, x0, d0, f0, bearings.damping)

    def hysteretic(self, z, dx):
        """z of one bearing [N] after monotonic travel dx [m] from z."""
        return hysteretic_force(z, dx, self.law, self.dk, self.alpha, self.d0, self.f0)

    def start(self, displacement):
        """z of one bearing [N] after monotonic loading of the virgin bearing to `displacement` [m]."""
        return self.hysteretic(0.0, displacement)

    def force(self, x, z, v=0.0):
        """Force of all bearings together [N], positive against positive x: eqs (9), (11), plus the viscous part."""
        return self.count * (self.kb * x + z + self.damping * v)

    def cycle_loss(self, amplitude):
        """Energy lost by one bearing in a full cycle between +-amplitude [J], on the limit curves.

        Exact where the limit curve is reached (amplitude of 0.15 m and more for the paper's bearing).
        """
        return 4 * self.f0 * amplitude - 2 * self.dk / ((self.alpha - 1) * (self.alpha - 2))
