"""A base on stiff or viscous bearings, stepped by a leapfrog engine: how long its steps may be, and what mass it shows.

A viscous force is solved for within the step, exactly for a constant rest of the forces: acting with the velocity
known, c v, on a base heavier by `added_mass`. Given explicitly it blows up where a step times c/mass exceeds 2.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from analytic.bearing import BearingLaw
from analytic.rocking import RockingModel

if TYPE_CHECKING:
    from analytic import Scene

# Most of a step over the time in which the bearings' vibration advances by 1 rad; stable below 2.
VIBRATION = 0.2
# Leapfrog vibrates too fast, by (h omega)^2/24; this share of the stiffness times h^2 as mass cures it. Without damping
# the phase at the next impact decides how far the base goes. Not needed below STIFF = h omega.
LEAPFROG, STIFF = 1 / 12, 0.02


def longest_step(scene: Scene, largest: float) -> float:
    """The longest step [s], at most `largest`, that follows the base's vibration on its bearings."""
    if scene.bearings is None:
        return largest
    model = RockingModel.of(scene)
    law = model.bearing
    k, c = law.count * (law.kb + law.dk) * VIBRATION**-2, law.count * law.damping
    # h^2 k = mass + h c: with much damping the base creeps, with the time constant c/k
    return min(largest, (c + math.sqrt(c * c + 4 * k * driven_mass(model))) / (2 * k))


def driven_mass(model: RockingModel) -> float:
    """Mass that the base puts up against a force while the block pivots through tilt 0 [kg], least for J_O = m R^2."""
    return model.M - (model.m * model.R * math.cos(model.gamma)) ** 2 / model.J


def leapfrog_stiffness(law: BearingLaw, largest: float, mass: float) -> float:
    """Stiffness [N/m] that a base of `mass` [kg] is heavier by, times the square of the step; 0 where steps are short.

    Small vibrations of a hysteretic bearing are those of about half its initial excess of stiffness.
    """
    elastic = law.count * (law.kb + 0.5 * law.dk)
    return LEAPFROG * elastic if largest * math.sqrt(elastic / mass) > STIFF else 0.0


def added_mass(damping: float, interval: float, mass: float) -> float:
    """Mass to add to `mass` where a force c v acts at the velocity before `interval`, to come out right after it."""
    x = damping * interval / mass
    return mass * (x / -math.expm1(-x) - 1) if x > 1e-8 else 0.5 * damping * interval
