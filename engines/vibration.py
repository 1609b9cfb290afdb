"""A base on stiff or viscous bearings in a leapfrog engine: its longest stable step and its added mass.

The viscous force is implicit: the known force c v acts on a base heavier by `added_mass`, which is exact if the other
forces are constant in the step. Applied explicitly, it would be unstable where step times c/mass exceeds 2; a tenth of
that makes PyBullet's block fall .25 s late.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from analytic.bearing import BearingLaw
from analytic.rocking import RockingModel

if TYPE_CHECKING:
    from analytic import Scene

# Largest step over the time in which the bearings' vibration advances by 1 rad; stable below 2.
VIBRATION = 0.2
# The frequency of a leapfrog is too high by (h omega)^2/24. An added mass of this share of the stiffness times h^2
# corrects it: without damping, the phase at the next impact determines the base displacement. On bearings 100 times as
# stiff as the Caryatid's its peak is off by 2e-3, without the mass by 5e-2. Not needed below STIFF = h omega.
LEAPFROG, STIFF = 1 / 12, 0.02


def longest_step(scene: Scene, largest: float) -> float:
    """The longest step [s], at most `largest`, that resolves the base's vibration on its bearings."""
    if scene.bearings is None:
        return largest
    model = RockingModel.of(scene)
    law = model.bearing
    k, c = law.count * (law.kb + law.dk) * VIBRATION**-2, law.count * law.damping
    # h^2 k = mass + h c: an overdamped base creeps with the time constant c/k
    return min(largest, (c + math.sqrt(c * c + 4 * k * driven_mass(model))) / (2 * k))


def driven_mass(model: RockingModel) -> float:
    """Effective mass of the base while the block pivots through tilt 0 [kg], least for J_O = m R^2."""
    return model.M - (model.m * model.R * math.cos(model.gamma)) ** 2 / model.J


def leapfrog_stiffness(law: BearingLaw, largest: float, mass: float) -> float:
    """Stiffness [N/m] whose product with the step squared is added to the base's `mass` [kg]; 0 for short steps.

    Small vibrations of a hysteretic bearing have about half its initial excess stiffness ka - kb.
    """
    elastic = law.count * (law.kb + 0.5 * law.dk)
    return LEAPFROG * elastic if largest * math.sqrt(elastic / mass) > STIFF else 0.0


def added_mass(damping: float, interval: float, mass: float) -> float:
    """Mass to add to `mass`, so that a force c v at the velocity before `interval` gives the velocity after it."""
    x = damping * interval / mass
    return mass * (x / -math.expm1(-x) - 1) if x > 1e-8 else 0.5 * damping * interval
