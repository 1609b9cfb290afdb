"""The range of a statue: scenes for which the tuned variants are tested, and outside which nothing is promised."""

import math

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


def in_words() -> str:
    """The limits, in one line."""
    return ", ".join(words.format(low=low, high=high) for low, high, words in RANGE.values())
