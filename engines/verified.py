"""The range in which a variant of an engine was held against the analytic model, and the warnings outside it."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

from .vibration import base_decay, base_frequency, given_back

if TYPE_CHECKING:
    from analytic import Scene

ANY = (0.0, math.inf)
LITTLE = 0.005  # the most by which e can be misread then: it was off by all of it at 1.5e5 to 9e5 omega_r (MuJoCo)
NOWHERE = "this variant is verified in no range: its settings are not meant to be right"


@dataclass(frozen=True)
class Range:
    """Lowest and highest value of each quantity at which a variant is verified; the defaults do not limit.

    slenderness [rad]; inertia: J_O/(m R^2); base_mass: m_b/m; radius R [m]; stiffness: step omega_b [-] with omega_b^2
    = n_d k_a/m_b, the fastest vibration of the base on its bearings; damping: step n_d c/m_b [-], c the viscous
    constant of a bearing; decay: n_d c/m_b over omega_r [-], how fast a kicked base stops: beyond some 3e3 to 1e5 it
    has stopped before the tilt rate after an impact can be read, which matters where it gives back more than LITTLE of
    that rate; tilt: peak tilt over slenderness.
    """

    slenderness: tuple[float, float] = ANY
    inertia: tuple[float, float] = ANY
    base_mass: tuple[float, float] = ANY
    radius: tuple[float, float] = ANY
    stiffness: tuple[float, float] = ANY
    damping: tuple[float, float] = ANY
    decay: tuple[float, float] = ANY
    tilt: tuple[float, float] = ANY


WORDS = {
    "slenderness": "slenderness [rad]",
    "inertia": "J_O/(m R^2)",
    "base_mass": "base mass over block mass",
    "radius": "radius R [m]",
    "stiffness": "step times the base's frequency on its bearings",
    "damping": "step times viscous damping over base mass",
    "decay": "viscous damping over base mass and rocking frequency",
    "tilt": "peak tilt over slenderness",
}


def speaks_of_range(warning: str) -> bool:
    """Whether a warning of a run says that it lies outside what its variant, or its settings, were verified for."""
    return "verified" in warning


def in_words(verified: Range | None) -> str:
    """The limits of a `Range`, or that there is none."""
    if verified is None:
        return "nowhere"
    limits = {field.name: getattr(verified, field.name) for field in fields(Range)}
    return "; ".join(f"{WORDS[name]} {_limits(*pair)}" for name, pair in limits.items() if pair != ANY) or "anywhere"


def _limits(low: float, high: float) -> str:
    if low <= 0 or high == math.inf:
        return f"at most {high:.4g}" if low <= 0 else f"at least {low:.4g}"
    return f"{low:.4g} to {high:.4g}"


def quantities(scene: Scene, step: float, peak_tilt: float | None = None) -> dict[str, float]:
    """{name: value} of the quantities of `Range` that a scene has, at a step [s]; peak_tilt [rad]."""
    block = scene.block
    values = {
        "slenderness": block.slenderness,
        "inertia": block.inertia / (block.mass * block.radius**2),
        "radius": block.radius,
    }
    if scene.base is not None:
        values["base_mass"] = scene.base.mass / block.mass
    if scene.bearings is not None:
        decay = base_decay(scene)
        values["stiffness"] = step * base_frequency(scene)
        values["damping"] = step * decay
        if given_back(scene) > LITTLE:
            values["decay"] = decay / scene.rocking_frequency
    if peak_tilt:
        values["tilt"] = peak_tilt / block.slenderness
    return values


def outside(scene: Scene, verified: Range | None, *, step: float, peak_tilt: float | None = None) -> tuple[str, ...]:
    """Sentences, one for each quantity of a scene that lies outside the `Range` verified; () inside.

    Parameters
    ----------
    scene : Scene
    verified : Range or None
        None: no range at all.
    step : float
        Step length of the engine [s].
    peak_tilt : float or None
        Largest tilt of the run [rad]; None or 0 where it never lifted.
    """
    if verified is None:
        return (NOWHERE,)
    found, sentences = quantities(scene, step, peak_tilt), []
    for name in (field.name for field in fields(Range)):
        low, high = getattr(verified, name)
        value = found.get(name)
        if value is not None and not low <= value <= high:
            limit = f"below {low:.4g}" if value < low else f"above {high:.4g}"
            sentences.append(f"{WORDS[name]} = {value:.4g} is {limit}, the limit of the range verified")
    return tuple(sentences)
