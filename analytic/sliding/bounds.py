"""Coefficients of friction at which a sliding block is well posed, and closed forms of its impacts."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..scene import Scene


def slipping_friction(scene: Scene) -> float:
    """mu_c: below it the impact of a block that did not slide makes it slip.

    m b h/(J_G + m h^2 + J_G m/m_b), on rigid ground without the last term; always below tan(gamma), so that a block
    that lifts from rest does not slip at its impacts unless it slid before.
    """
    block = scene.block
    b, h, m, centre = block.half_width, block.half_height, block.mass, block.centre_inertia
    return m * b * h / (centre + m * h**2 + (centre * m / scene.base.mass if scene.base else 0.0))


def slipping_restitution(scene: Scene, friction: float) -> float:
    """Restitution of an impact at a friction below mu_c of a block that did not slide before it, on any base."""
    block = scene.block
    b, h, m, centre = block.half_width, block.half_height, block.mass, block.centre_inertia
    return (centre - m * b**2 + friction * m * b * h) / (centre + m * b**2 - friction * m * b * h)


def paradoxical_friction(scene: Scene) -> float:
    """Friction above which a sliding corner may have no motion, or several (Painleve): 2 sqrt(k (1 + k)), k = J_G/(m R^2).

    4/3 for a rectangle.
    """
    k = scene.block.centre_inertia / (scene.block.mass * scene.block.radius**2)
    return 2 * math.sqrt(k * (1 + k))
