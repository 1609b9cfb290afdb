"""Uplift, rocking and impact of a rigid block: eqs (1)-(8) of the Caryatid paper, corrected where misprinted.

The tilt phi is positive toward +x; s = sgn(phi) is the side of the pivot; x is the base displacement relative to the
ground. Under a vertical ground acceleration a_v, upward, g is replaced by g + a_v: bearings are vertically rigid.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Self

from .bearing import BearingLaw

if TYPE_CHECKING:
    from .scene import Scene
    from .types import Values


@dataclass(frozen=True)
class RockingModel:
    """The equations of one scene, one method per equation.

    Attributes
    ----------
    m, M, J : float
        Mass of the block, of block and base together [kg]; J_O about a base corner [kg m2].
    R, gamma, g : float
        Radius [m], slenderness [rad], gravity [m/s2].
    on_base : bool
        False on rigid ground.
    bearing : BearingLaw
    restitution : float
        e_phi, see `restitution`.
    """

    m: float
    M: float
    J: float
    R: float
    gamma: float
    g: float
    on_base: bool
    bearing: BearingLaw
    restitution: float
    mass_share: float

    @classmethod
    def of(cls, scene: Scene) -> Self:
        block = scene.block
        return cls(
            block.mass,
            scene.total_mass,
            block.inertia,
            block.radius,
            block.slenderness,
            scene.gravity,
            scene.base is not None,
            BearingLaw.of(scene.bearings),
            restitution(scene),
            scene.mass_share,
        )

    def lever(self, s: Values | float, tilt: Values) -> tuple[Values, Values]:
        """(c, n) [m]: height of the centre of mass above the corner, and its signed horizontal lever."""
        angle = s * self.gamma - tilt
        return self.R * math.cos(angle), self.R * math.sin(angle)  # type: ignore[return-value]  # `engines.swings.ArrayModel` has it for arrays

    def contact_acceleration(self, bearing_force: Values) -> Values:
        """x'' + a_g [m/s2] of the base in full contact, eq. (2)."""
        return -bearing_force / self.M

    @property
    def uplift_acceleration(self) -> float:
        """|absolute base acceleration| above which the block lifts: g tan(gamma) [m/s2]."""
        return self.uplift_limit(0.0)

    def uplift_limit(self, vertical: Values) -> Values:
        """The uplift acceleration [m/s2] under a vertical ground acceleration [m/s2]."""
        return (self.g + vertical) * math.tan(self.gamma)

    def accelerations(
        self,
        s: Values | float,
        tilt: Values,
        rate: Values,
        ground: Values,
        bearing_force: Values,
        vertical: Values | float = 0.0,
    ) -> tuple[Values, Values]:
        """(phi'', x'') [rad/s2, m/s2] while rocking about the corner of side s, eqs (3)-(6).

        ground, vertical : ground accelerations a_g and a_v [m/s2]. On rigid ground x'' is 0 and the bearing force is
        not used.
        """
        (c, n), g = self.lever(s, tilt), self.g + vertical
        if not self.on_base:
            return -self.m * (c * ground + g * n) / self.J, 0.0  # type: ignore[return-value]  # 0 for all of an array
        m, M, J = self.m, self.M, self.J
        # M (a_g + x'') + m c phi'' = -m n phi'^2 - F;   m c (a_g + x'') + J phi'' = -m (g + a_v) n
        push, moment = -m * n * rate * rate - bearing_force, -m * g * n
        determinant = M * J - (m * c) ** 2
        absolute = (J * push - m * c * moment) / determinant
        return (M * moment - m * c * push) / determinant, absolute - ground

    @property
    def jump_arm(self) -> float:
        """Velocity that the base gains at an impact per tilt rate lost [m]: mt R cos(gamma), eq. (8).

        (8) is printed with a factor R cos(gamma) too many; this form conserves horizontal momentum.
        """
        return self.mass_share * self.R * math.cos(self.gamma)

    def impact(self, rate: Values) -> tuple[Values, Values]:
        """(phi'+, jump of x') of an impact at tilt rate phi'-, eqs (7) and (8)."""
        after = self.restitution * rate  # (7)
        return after, self.jump_arm * (rate - after)

    def contact_forces(
        self,
        s: Values | float,
        tilt: Values,
        rate: Values,
        tilt_acceleration: Values,
        base_acceleration: Values,
        vertical: Values | float = 0.0,
    ) -> tuple[Values, Values]:
        """(H, N) [N]: horizontal and normal force of the base on the block, base_acceleration absolute."""
        c, n = self.lever(s, tilt)
        horizontal = self.m * (base_acceleration + c * tilt_acceleration + n * rate * rate)
        normal = self.m * (self.g + vertical + n * tilt_acceleration - c * rate * rate)
        return horizontal, normal

    def kinetic_energy(self, s: float, tilt: float, rate: float, v: float) -> float:
        """[J], in the ground's frame; s = 0 for full contact."""
        c = self.lever(s, tilt)[0] if s else 0.0
        return 0.5 * self.M * v * v + self.m * c * rate * v + 0.5 * self.J * rate * rate

    def potential_energy(self, s: float, tilt: float, x: float) -> float:
        """Of gravity and of the springs kb [J], 0 at rest."""
        height = self.lever(s, tilt)[0] - self.R * math.cos(self.gamma) if s else 0.0
        return self.m * self.g * height + 0.5 * self.bearing.count * self.bearing.kb * x**2


def restitution(scene: Scene) -> float:
    """e_phi of a scene: the given one, else that of eq. (7), at least 0."""
    given = scene.block.restitution
    return max(momentum_restitution(scene), 0.0) if given is None else given


def momentum_restitution(scene: Scene) -> float:
    """e_phi of eq. (7) from conservation of momentum, 1 - 2 m b^2/(J_O - m mt h^2), even if the scene gives another.

    It may be negative (stocky block, light base).
    """
    block = scene.block
    b, h = block.half_width, block.half_height
    return 1 - 2 * block.mass * b**2 / (block.inertia - block.mass * scene.mass_share * h**2)  # (7)


def base_jump_length(scene: Scene) -> float:
    """e_x of eq. (8), corrected [m]: x'+ = x'- - e_x phi'-."""
    block, mt = scene.block, scene.mass_share
    R, gamma, m = block.radius, block.slenderness, block.mass
    return (
        2
        * R**3
        * math.sin(gamma) ** 2
        * math.cos(gamma)
        * m
        * mt
        / (R**2 * math.cos(gamma) ** 2 * m * mt - block.inertia)
    )  # (8)


def base_jump_length_as_printed(scene: Scene) -> float:
    """e_x of eq. (8) as printed, with a factor R cos(gamma) too many: a length squared. Kept to show the misprint."""
    block, mt = scene.block, scene.mass_share
    R, gamma, m = block.radius, block.slenderness, block.mass
    return (
        2
        * R**4
        * (math.sin(gamma) * math.cos(gamma)) ** 2
        * m
        * mt
        / (R**2 * math.cos(gamma) ** 2 * m * mt - block.inertia)
    )
