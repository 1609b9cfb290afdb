"""Coefficients of friction at which a sliding block is well posed, and closed forms of its impacts."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from ..layout import Contact

if TYPE_CHECKING:
    from ..layout import Parameters
    from ..scene import Scene


def contact_of(scene: Scene) -> Contact | None:
    """The numbers of the contact; None without a friction."""
    if scene.friction is None:
        return None
    mass = scene.base.mass if scene.base else math.inf
    return Contact(float(scene.friction), mass, scene.block.centre_inertia, scene.block.restitution is not None)


def slipping_friction(par: Parameters) -> float:
    """mu_c: horizontal over vertical impulse of the impact of a block that does not slide, the friction that it needs.

    (1 - e) (h - arm)/((1 + e) b), from the velocities of the centre of mass before and after it and the base's jump,
    eq. (8): with e of eq. (7) m b h/(J_G + m h^2 + J_G m/m_b), on rigid ground without the last term. That is always
    below tan(gamma), so that a block that lifts from rest does not slip at its impacts unless it slid before.
    """
    b, h = par.R * math.sin(par.gamma), par.R * math.cos(par.gamma)
    return (1 - par.e) * (h - par.arm) / ((1 + par.e) * b)


def slipping_restitution(par: Parameters, contact: Contact) -> float:
    """Restitution of an impact at a friction below mu_c of a block that did not slide before it, on any base."""
    b, h = par.R * math.sin(par.gamma), par.R * math.cos(par.gamma)
    gripping = par.m * b * (b - contact.mu * h)
    return (contact.centre - gripping) / (contact.centre + gripping)


def paradoxical_friction(par: Parameters, contact: Contact) -> float:
    """Friction above which a sliding corner may have no motion, or several (Painleve): 2 sqrt(k (1 + k)).

    k = J_G/(m R^2); 4/3 for a rectangle.
    """
    k = contact.centre / (par.m * par.R**2)
    return 2 * math.sqrt(k * (1 + k))
