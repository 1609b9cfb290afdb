"""Equations of two rigid blocks on each other: motion between impacts, uplift, impact, energy.

The lower block is the pedestal, the upper one the statue, centred on it. Nothing slides. phi_1 and phi_2 are *absolute*
tilts, positive toward +x. The pedestal pivots on the ground or the base about its corner of side s_1, the statue on the
pedestal about its corner of side s_2; side 0 is full contact: nine states. A vector of the plane is a complex number,
across + 1j up. R(phi) p = p exp(-1j phi) turns it, and d/dphi of that is -1j R p. With half widths b, half heights h,
the pedestal's height H_1 = 2 h_1, and

    r_1 = -s_1 b_1 + 1j h_1,  d = -s_1 b_1 + s_2 b_2 + 1j H_1,  r_2 = -s_2 b_2 + 1j h_2

from the pedestal's pivot to its centre and to the statue's pivot, and from that to the statue's centre, let R_1, R_d
be the first two turned by phi_1, R_2 the last by phi_2, and T, D, U = -1j times these. Let a = x'' + a_g be the
absolute acceleration of the support, I the inertias about the centres and p.q the inner product. Then

    (S1) A_11 phi_1'' + A_12 phi_2'' + c_1 a = m_2 D.R_2 phi_2'^2 - (g + a_v)(m_1 T_z + m_2 D_z)
    (S2) A_12 phi_1'' + A_22 phi_2'' + c_2 a = m_2 U.R_d phi_1'^2 - (g + a_v) m_2 U_z
    (S3) c_1 phi_1'' + c_2 phi_2'' + M a = (m_1 R_1x + m_2 R_dx) phi_1'^2 + m_2 R_2x phi_2'^2 - F

    A_11 = I_1 + m_1 |r_1|^2 + m_2 |d|^2,  A_12 = m_2 D.U,  A_22 = I_2 + m_2 |r_2|^2
    c_1 = m_1 T_x + m_2 D_x,  c_2 = m_2 U_x,  M = m_1 + m_2 + m_b

with the bearings' force F. On rigid ground a = a_g, and (S3) is not used. A pedestal in full contact has phi_1 = 0 and
no (S1); a statue in full contact phi_2 = phi_1 and the sum of (S1) and (S2). They are Lagrange's equations of x, phi_1
and phi_2.

The forces on the statue and on the pedestal from below are F_2 = m_2 (a_2 + 1j (g + a_v)) and G = m_1 (a_1 + 1j (g +
a_v)) + F_2, with the accelerations a_1, a_2 of the centres. Full contact ends where the centre of pressure, from the
middle, reaches a corner: with F_2 along (t) and off (n) the top of the pedestal,

    (S4) xi_2 = -(I_2 phi_2'' + h_2 F_2t)/F_2n,  xi_1 = (-h_1 G_x - (H_1 - h_1) F_2x + xi_2 F_2z)/G_z

(xi_2 = s_2 b_2 of a statue on its corner). An impact is Moreau's: of all velocities at which no closed corner
penetrates and those that carry stick, the ones nearest to the velocities before, in the metric of the kinetic energy.

J. J. Moreau (1999), Numerical aspects of the sweeping process, Comput. Methods Appl. Mech. Eng. 177, 329-349.
"""

from __future__ import annotations

import cmath
import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations, product
from typing import TYPE_CHECKING, NamedTuple, Self

import numpy as np

from ..rocking import BearingLaw

if TYPE_CHECKING:
    from ..scene import Scene

Geometry = tuple[complex, complex, complex, float, float, float, float, float]  # of `StackModel.geometry`
LOWER, UPPER = 0, 1  # the two interfaces, and the block on each
PLACES = np.array([[0, 1], [3, 4]])  # of the velocities of both centres, see `StackModel.contacts`
OPENINGS = sorted(product((0, 1, -1), repeat=2), key=lambda sides: abs(sides[0]) + abs(sides[1]))
# Of velocities and impulses of an impact, relative to those of the closing: far above rounding, below any that count.
ROUNDING = 1e-9
RIM = np.linspace(0.02, 1.0, 50)  # shares of the slendernesses of which `StackModel.rim` takes the best


@dataclass(frozen=True)
class Slab:
    """A block: mass [kg], inertia about its centre [kg m2], half width and half height [m]."""

    mass: float
    inertia: float
    b: float
    h: float

    @property
    def slenderness(self) -> float:
        return math.atan2(self.b, self.h)


class Instant(NamedTuple):
    """What the equations give at one time.

    a : absolute acceleration of the support [m/s2]. spins : phi_1'', phi_2'' [rad/s2]. along, normal : forces [N] from
    below on pedestal and statue. pressure : xi_1, xi_2 [m].
    """

    a: float
    spins: tuple[float, float]
    along: tuple[float, float]
    normal: tuple[float, float]
    pressure: tuple[float, float]


class Answer(NamedTuple):
    """An answer of the impact law.

    rates : phi_1', phi_2' after it [rad/s]. v : velocity of the base [m/s]. sides : of the corners that carry, 0 for
    both, None for an interface that jumps. impulses : on pedestal and statue from below, along + 1j normal [N s].
    """

    rates: tuple[float, float]
    v: float
    sides: list[int | None]
    impulses: tuple[complex, complex]


@dataclass(frozen=True)
class StackModel:
    """The equations of one scene: (pedestal, statue), mass of the base alone [kg], inf on rigid ground, and gravity."""

    slabs: tuple[Slab, Slab]
    base: float
    g: float
    bearing: BearingLaw

    @classmethod
    def of(cls, scene: Scene) -> Self:
        """Return the equations of a scene whose pedestal has a width, a mass and a height."""
        width, mass, height = (float(getattr(scene.pedestal, name)) for name in ("width", "mass", "height"))
        block, b, h = scene.block, 0.5 * width, 0.5 * height
        return cls(
            (
                Slab(mass, mass * (b * b + h * h) / 3, b, h),
                Slab(block.mass, block.centre_inertia, block.half_width, block.half_height),
            ),
            scene.base.mass if scene.base else math.inf,
            scene.gravity,
            BearingLaw.of(scene.bearings),
        )

    @property
    def mass(self) -> float:
        """Return M [kg], inf on rigid ground."""
        return self.slabs[LOWER].mass + self.slabs[UPPER].mass + self.base

    def geometry(self, sides: Sequence[int], tilts: Sequence[float]) -> Geometry:
        """Return R_1, R_d, R_2 [m], A_11, A_12, A_22 [kg m2], c_1, c_2 [kg m] at these sides and tilts [rad]."""
        one, two = self.slabs
        r1 = complex(-sides[0] * one.b, one.h)
        d = complex(sides[1] * two.b - sides[0] * one.b, 2 * one.h)
        r2 = complex(-sides[1] * two.b, two.h)
        turn, turn2 = cmath.exp(-1j * tilts[0]), cmath.exp(-1j * tilts[1])
        R1, Rd, R2 = r1 * turn, d * turn, r2 * turn2
        return (
            R1,
            Rd,
            R2,
            one.inertia + one.mass * abs(r1) ** 2 + two.mass * abs(d) ** 2,
            two.mass * (Rd * R2.conjugate()).real,  # D.U
            two.inertia + two.mass * abs(r2) ** 2,
            one.mass * R1.imag + two.mass * Rd.imag,  # T_x = R_1z
            two.mass * R2.imag,
        )

    def instant(
        self,
        sides: Sequence[int],
        tilts: Sequence[float],
        rates: Sequence[float],
        ground: float,
        force: float = 0.0,
        vertical: float = 0.0,
    ) -> Instant:
        """Return accelerations, forces and centres of pressure of a state that the sides allow.

        Parameters
        ----------
        sides : s_1, s_2
        tilts, rates : absolute, of pedestal and statue [rad, rad/s]
        ground, vertical : a_g, a_v [m/s2]
        force : F of all bearings [N]; not used on rigid ground
        """
        (one, two), (w1, w2), g = self.slabs, rates, self.g + vertical
        R1, Rd, R2, A11, A12, A22, c1, c2 = self.geometry(sides, tilts)
        D_R2 = -(Rd.conjugate() * R2).imag  # D.R_2 = -U.R_d
        f1 = two.mass * D_R2 * w2 * w2 + g * (one.mass * R1.real + two.mass * Rd.real)  # (S1); T_z = -R_1x
        f2 = -two.mass * D_R2 * w1 * w1 + g * two.mass * R2.real  # (S2)
        f3 = (one.mass * R1.real + two.mass * Rd.real) * w1 * w1 + two.mass * R2.real * w2 * w2 - force  # (S3)
        M, a = self.mass, ground
        if M < math.inf:
            a = f3 / M
            A11, A12, A22 = A11 - c1 * c1 / M, A12 - c1 * c2 / M, A22 - c2 * c2 / M  # a eliminated
        f1, f2 = f1 - c1 * a, f2 - c2 * a
        if not sides[LOWER]:
            spins = (0.0, f2 / A22 if sides[UPPER] else 0.0)
        elif not sides[UPPER]:
            spins = ((f1 + f2) / (A11 + 2 * A12 + A22),) * 2
        else:
            determinant = A11 * A22 - A12 * A12
            spins = ((A22 * f1 - A12 * f2) / determinant, (A11 * f2 - A12 * f1) / determinant)
        if M < math.inf:
            a -= (c1 * spins[0] + c2 * spins[1]) / M
        turn1, turn2 = -1j * spins[0] - w1 * w1, -1j * spins[1] - w2 * w2
        F2 = two.mass * (a + Rd * turn1 + R2 * turn2 + 1j * g)
        G = one.mass * (a + R1 * turn1 + 1j * g) + F2
        f = F2 * cmath.exp(1j * tilts[0])
        xi2 = sides[1] * two.b or -(two.inertia * spins[1] + two.h * f.real) / (f.imag or math.ulp(0))  # (S4)
        moment = -one.h * (G.real + F2.real) + xi2 * F2.imag
        return Instant(a, spins, (G.real, f.real), (G.imag, f.imag), (sides[0] * one.b or moment / G.imag, xi2))

    def opened(
        self, sides: Sequence[int], shut: Sequence[bool], tilts: Sequence[float], rates: Sequence[float], *loads: float
    ) -> list[int] | None:
        """Return the sides after uplift, None where no choice of them has compressive forces.

        shut : interfaces in full contact that move as one, which may open. loads : a_g, F and a_v of `instant`. By
        Gauss's principle there is one choice, unless a pivot would jump.
        """
        for choice in OPENINGS:
            if all(may or not side for may, side in zip(shut, choice, strict=True)):
                after = [new if may else old for may, new, old in zip(shut, choice, sides, strict=True)]
                now = self.instant(after, tilts, rates, *loads)
                relative = now.spins[0], now.spins[1] - now.spins[0]
                if all(
                    not may or (side * spin > 0 if side else abs(xi) <= slab.b * (1 + 1e-12))
                    for may, side, spin, xi, slab in zip(shut, after, relative, now.pressure, self.slabs, strict=True)
                ):
                    return after
        return None

    # impacts

    def contacts(self, tilts: Sequence[float]) -> np.ndarray:
        """Return the rows of the velocities of the corners off what carries them, complex (2, 2, 7): along + 1j normal.

        Of [interface, side - or +], over the velocities of both centres and both rates, (X_1, Z_1, phi_1, X_2, Z_2,
        phi_2)', and x'.
        """
        one, two = self.slabs
        turn, turn2 = cmath.exp(-1j * tilts[0]), cmath.exp(-1j * tilts[1])
        rows = []
        for side in (-1, 1):
            foot, corner = complex(side * one.b, -one.h) * turn, complex(side * two.b, -two.h) * turn2
            seat = complex(side * two.b, one.h) * turn
            rows.append([[1, 1j, -1j * foot, 0, 0, 0, -1], [-1, -1j, 1j * seat, 1, 1j, -1j * corner, 0]])
        return np.array(rows).swapaxes(0, 1) * np.array([1, 1 / turn])[:, None, None]

    def impact(
        self,
        sides: Sequence[int],
        tilts: Sequence[float],
        rates: Sequence[float],
        v: float,
        shut: Sequence[bool],
        forced: Sequence[bool] = (False, False),
    ) -> list[Answer]:
        """Return all answers of the impact law, those first that keep all interfaces.

        Parameters
        ----------
        sides : of the pivots before
        tilts, rates : [rad, rad/s]
        v : velocity of the base [m/s]
        shut : interfaces of which both corners are closed; of the others the pivot is
        forced : interfaces that stay in full contact, as at the limit of an accumulation, in which weights have time to
            act: their corners, and those of an interface that does not land, may pull
        """
        one, two = self.slabs
        R1, Rd, R2, *_ = self.geometry(sides, tilts)
        V1 = v - 1j * R1 * rates[0]
        V2 = v - 1j * Rd * rates[0] - 1j * R2 * rates[1]
        u = np.array([V1.real, V1.imag, rates[0], V2.real, V2.imag, rates[1], v])
        inverse = 1 / np.array([one.mass, one.mass, one.inertia, two.mass, two.mass, two.inertia, self.base])
        rows, answers = self.contacts(tilts), []
        closed = [(0, 1) if both else ((side + 1) // 2,) for both, side in zip(shut, sides, strict=True)]
        corners = [(k, c) for k in (LOWER, UPPER) for c in closed[k]]
        # velocities that count as none: of the closing, or rounding of the motion
        small = ROUNDING * max(abs(rows[corner].imag @ u) for corner in corners) + 1e-15 * np.abs(u).max()
        # interfaces whose impulses may have any sign
        free = [k for k in (LOWER, UPPER) if forced[k] or any(forced) and not (shut[k] and sides[k])]
        for chosen in product(*map(_subsets, closed)):
            used = [(k, c) for k in (LOWER, UPPER) for c in chosen[k]]
            normals = [rows[corner].imag for corner in used]
            along = [rows[k, chosen[k][0]].real for k in (LOWER, UPPER) if chosen[k]]  # two corners stick as one does
            A = np.array(normals + along).reshape(-1, 7)
            p = np.linalg.solve((A * inverse) @ A.T, -A @ u)
            after = u + inverse * (A.T @ p)
            gaps = [rows[corner].imag @ after for corner in corners if corner not in used]
            leaving = [rows[corner].imag @ after for corner in corners if not chosen[corner[0]]]
            least = -ROUNDING * np.abs(p).max(initial=0.0)
            if (
                all(pushed >= least or k in free for pushed, (k, _) in zip(p, used, strict=False))
                and min(gaps, default=0.0) >= -small
                and min(leaving, default=math.inf) > small
                and not any(must and len(both) < 2 for must, both in zip(forced, chosen, strict=True))
            ):
                gain1, gain2 = (
                    slab.mass * complex(*jump) for slab, jump in zip(self.slabs, (after - u)[PLACES], strict=True)
                )
                impulses = gain1 + gain2, gain2 * cmath.exp(1j * tilts[0])
                carrying = [sum(2 * corner - 1 for corner in each) if each else None for each in chosen]
                answers.append(Answer((after[2], after[5]), float(after[6]), carrying, impulses))
        return sorted(answers, key=lambda answer: None in answer.sides)

    # energy

    def kinetic_energy(self, sides: Sequence[int], tilts: Sequence[float], rates: Sequence[float], v: float) -> float:
        """Return the kinetic energy [J] in the ground's frame; v : of the base [m/s]."""
        (_, _, _, A11, A12, A22, c1, c2), (w1, w2) = self.geometry(sides, tilts), rates
        turning = A11 * w1 * w1 + 2 * A12 * w1 * w2 + A22 * w2 * w2
        return 0.5 * (turning + (self.mass * v * v + 2 * v * (c1 * w1 + c2 * w2) if v else 0.0))

    def height_energy(self, first: float, second: float) -> float:
        """Return the energy of gravity [J] over that at rest.

        first : tilt of the pedestal, second : of the statue from it [rad]. The energy is
        m_1 g (R_1z - h_1) + m_2 g (R_dz + R_2z - H_1 - h_2).
        """
        one, two = self.slabs
        R1, Rd, R2, *_ = self.geometry(np.sign([first, second]).astype(int).tolist(), [first, first + second])
        return self.g * (one.mass * (R1.imag - one.h) + two.mass * (Rd.imag + R2.imag - 2 * one.h - two.h))

    def rim(self, first: float, second: float) -> float:
        """Return the energy [J] below which a stack stays within these tilts of the pedestal, and the statue from it.

        It is the least energy of gravity on the rim |phi_1| = first or |phi_2 - phi_1| = second. Between sides it is a
        sum of cosines, concave on each edge of that rim, so that it is least at a corner or where a tilt is 0.
        """
        places = ((first, 0.0), (first, second), (first, -second), (0.0, second))
        return min(self.height_energy(*place) for place in places)

    @functools.cached_property
    def barrier(self) -> tuple[float, float, float]:
        """Return the highest `rim` [J] that was found, and its two tilts [rad]: below it neither block overturns."""
        one, two = (RIM * slab.slenderness for slab in self.slabs)
        return max((self.rim(first, second), first, second) for first in one.tolist() for second in two.tolist())


def _subsets(corners: Sequence[int]) -> list[tuple[int, ...]]:
    """Return the corners of an interface that may carry, the largest set first."""
    return [each for count in range(len(corners), -1, -1) for each in combinations(corners, count)]
