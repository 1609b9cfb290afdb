"""The range of a statue: scenes for which the tuned variants are tested, and outside which nothing is promised."""

import math

# {quantity: (lowest value, highest value, in words)}
RANGE = {
    "slenderness": (0.1, 0.5, "slenderness [rad]"),
    "inertia": (1.2, 2.0, "J_O/(m R^2)"),
    "radius": (0.1, 10.0, "radius R [m]"),
    "base_mass": (0.05, math.inf, "base mass over block mass, or rigid ground"),
    "period": (0.3, 5.0, "period of block and base on the bearings [s]"),
    "damping": (0.0, 1.0, "viscous damping of the bearings over the critical one"),
    "tilt": (0.01, math.inf, "peak tilt over slenderness"),
}


def in_words() -> str:
    """The limits, in one line."""
    return "; ".join(f"{words} {_limits(low, high)}" for low, high, words in RANGE.values())


def _limits(low: float, high: float) -> str:
    if low == 0:
        return f"at most {high:g}"
    return f"{low:g} to {high:g}" if math.isfinite(high) else f"at least {low:g}"
