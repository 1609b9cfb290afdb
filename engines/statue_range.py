"""The statue range: scenes for which the tuned variants are tested. Nothing is promised outside it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from analytic.bearing import BearingLaw
from analytic.response import LEVEL, Caution

if TYPE_CHECKING:
    from analytic import Response, Scene

ROUNDING = 1e-9  # tolerance of a computed value at a limit
# {quantity: (lowest value, highest value, in words)}
RANGE = {
    "slenderness": (0.1, 0.5, "slenderness {low:g} to {high:g} rad"),
    "inertia": (1.2, 2.0, "inertia about a corner {low:g} to {high:g} m R²"),
    "radius": (0.1, 10.0, "R {low:g} to {high:g} m"),
    "base_mass": (0.05, math.inf, "rigid ground or a base of at least {low:g} block masses"),
    "period": (0.3, 5.0, "bearings of {low:g} to {high:g} s"),
    "damping": (0.0, 1.0, "damping up to critical"),
    "tilt": (0.01, math.inf, "a peak tilt of at least {low:g} slendernesses"),
}
NAMES = {"base_mass": "base mass over block mass", "tilt": "peak tilt over slenderness"}  # where not the key


def in_words() -> str:
    """The limits, in one line."""
    return ", ".join(map(_words, RANGE))


def outside(scene: Scene, response: Response) -> tuple[Caution, ...]:
    """A warning for each quantity of the scene, and for the run's peak tilt, that lies outside the range."""
    found = []
    for name, value in _values(scene, response).items():
        low, high, _ = RANGE[name]
        if not low * (1 - ROUNDING) <= value <= high * (1 + ROUNDING):
            words = (
                f"{NAMES.get(name, name)} {value:.3g} is outside the range in which engines are tested "
                f"({_words(name)}): nothing is promised there"
            )
            found.append(Caution("engine", words, name, value, low if value < low else high))
    return tuple(found)


def _words(name: str) -> str:
    """The limits of a quantity."""
    low, high, words = RANGE[name]
    return words.format(low=low, high=high)


def _values(scene: Scene, response: Response) -> dict[str, float]:
    """{quantity of `RANGE`: its value}, of those that the scene has; a block that never lifts has no tilt.

    Period and viscous damping are those of block and base on the stiffness after yielding.
    """
    block, base = scene.block, scene.base
    inertia = block.inertia / (block.mass * block.radius**2)
    found = {"slenderness": block.slenderness, "inertia": inertia, "radius": block.radius}
    if base is not None:
        found["base_mass"] = base.mass / block.mass
    if scene.bearings is not None:
        law = BearingLaw.of(scene.bearings)
        omega = math.sqrt(law.count * law.kb / scene.total_mass)
        found["period"] = 2 * math.pi / omega if omega else math.inf
        found["damping"] = law.count * law.damping / (2 * omega * scene.total_mass) if omega else 0.0
    if response.outcome not in LEVEL:  # an engine that stands has a tilt of rounding
        found["tilt"] = response.peak_tilt_ratio
    return found
