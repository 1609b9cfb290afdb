"""Sizes of the bearings of a scene, whether such bearings are made, and pendulum bearings.

A lead-rubber bearing follows from its law and the weight on it: the lead core from the characteristic strength,
Q_d = f0 = (yield stress of lead) x (area of the core); the height T_r of the rubber from x_max and the shear strain;
its area A from kb = G A/T_r, the hole of the core neglected. What overlaps of two circles of this area at x_max carries
the weight there.

A pendulum bearing (friction pendulum, curved surface slider) of radius R and friction mu under the weight W has the
force f = mu W + W x/R: the bilinear law with Q_d = mu W and kb = W/R. Before it slides it is as stiff as a yield
displacement of `SLIDES_AT` makes it.
"""

from __future__ import annotations

import contextlib
import math
from dataclasses import dataclass

from ..errors import SettingError, require
from ..rocking import BearingLaw, properties
from ..scene import LEAST, MOST, Bearings

LEAD = 10e6  # Pa, yield stress: Robinson 2011, Seism. Isol. Prot. Syst. 2(1), 5-19, measured 10.5 MPa
RUBBER = 0.4e6  # Pa, shear modulus of a soft compound: assumed
STRAIN = 1.5  # shear of the rubber at x_max: assumed
SLIDES_AT = 1e-3  # m, yield displacement of a pendulum: assumed
STIFF = (
    2e-3  # m: a bilinear bearing that yields before is taken as a pendulum; lead-rubber bearings yield later: assumed
)

SORTS = ("lead-rubber", "rubber", "pendulum")
ASSUMED = (
    f"Assumed: lead yields at {LEAD / 1e6:g} MPa (Robinson 2011 measured 10.5), the rubber is soft, "
    f"G = {RUBBER / 1e6:g} MPa, and sheared by {STRAIN:.0%} at x_max."
)
SIMPLIFIED = (
    "Not modelled: friction that depends on velocity, pressure or temperature; a weight on the bearing that changes "
    "with vertical motion and rocking; bearings that lift; sliding in two directions. "
    f"Assumed: sliding begins at {1000 * SLIDES_AT:g} mm."
)
# {quantity: (in words, unit, its factor, least, most, whose limit)}; 0 and inf: none
MADE = {
    "core": ("lead core", "mm", 1000, 0.050, math.inf, "the smallest that Robinson 2011 tested"),
    "diameter": ("rubber diameter", "mm", 1000, 0.200, 1.200, "as a manufacturer, SUPS, lists"),
    "overlap": ("overlap at x_max", "%", 100, 0.20, math.inf, "assumed"),
    "pressure": ("pressure", "MPa", 1e-6, 2e6, 15e6, "assumed"),
    "radius": ("radius", "m", 1, 0.25, 6.2, "periods of 1 to 5 s: Earthquake Protection Systems 2005"),
    "friction": ("friction", "", 1, 0.03, 0.20, "Earthquake Protection Systems 2005"),
}


@dataclass(frozen=True)
class BearingSizes:
    """Sizes of one bearing under its share of the weight.

    kind : one of SORTS.
    core, diameter, height : of lead core and rubber [m]; None where it has none.
    overlap : share of the rubber's area that overlaps at x_max.
    pressure, overlap_pressure : weight over the rubber's area and over the overlap [Pa]; None: no area.
    radius, friction : of a pendulum [m, -]; for other bearings of one with their secant period and damping at x_max.
        None where there is none.
    reasons : why no such bearing is made; empty if such bearings are made.
    """

    kind: str
    core: float | None
    diameter: float | None
    height: float | None
    overlap: float | None
    pressure: float | None
    overlap_pressure: float | None
    radius: float | None
    friction: float | None
    reasons: tuple[str, ...]

    @property
    def assumed(self) -> str:
        """Sentences on what is assumed, and on what is not modelled."""
        return SIMPLIFIED if self.kind == "pendulum" else ASSUMED

    @property
    def sentences(self) -> tuple[str, ...]:
        """Sentences for a user: the sizes, whether such bearings are made, and what could be in their place."""
        unmade = (f"No such bearing is made: {'; '.join(self.reasons)}.",) if self.reasons else ()
        pendulum = f"radius of curvature {self.radius:.3g} m, friction {self.friction:.3g}" if self.radius else ""
        if self.kind == "pendulum":
            return f"Each pendulum bearing: {pendulum}.", *unmade
        assert self.diameter and self.height and self.overlap is not None and self.pressure  # all but a pendulum have
        overlap = f"{self.overlap:.0%} of its area overlaps" if self.overlap else "top and bottom no longer overlap"
        sizes = (
            f"Each {self.kind} bearing: {f'lead core {round(1000 * self.core, 1):g} mm, ' if self.core else ''}"
            f"rubber {round(1000 * self.diameter, 1):g} mm in diameter, "
            f"{round(1000 * self.height, 1):g} mm high; {overlap} at x_max; "
            f"pressure {self.pressure / 1e6:.3g} MPa"
            + (f", {self.overlap_pressure / 1e6:.3g} MPa on the overlap." if self.overlap_pressure else ".")
        )
        outside = _unmade({"radius": self.radius, "friction": self.friction}) if self.radius else ()
        instead = (
            "Light statues stand on sliders or on pendulum bearings instead, as the Hermes of Olympia does."
            + (f" Pendulum bearings of the same period and damping at x_max: {pendulum}" if pendulum else "")
            + (f" (outside what is made: {'; '.join(outside)})" if outside else "")
            + ("." if pendulum else "")
        )
        return (sizes, *unmade, instead) if self.reasons else (sizes,)


def _unmade(values):
    """Return clauses on those of the values {quantity of `MADE`: number or None} that are outside their limits."""
    clauses = []
    for name, value in values.items():
        words, unit, factor, least, most, source = MADE[name]
        if value is not None and not least * (1 - 1e-9) <= value <= most * (1 + 1e-9):
            side, limit = ("below", least) if value < least else ("above", most)
            size, end = (f"{float(f'{factor * number:.3g}'):g} {unit}".rstrip() for number in (value, limit))
            clauses.append(f"{words} {size}, {side} {end} ({source})")
    return tuple(clauses)


def overlap_share(diameter: float, displacement: float) -> float:
    """Return the share of a circle's area that overlaps the same circle displaced; both in m."""
    ratio = min(displacement / diameter, 1.0)
    return 2 / math.pi * (math.acos(ratio) - ratio * math.sqrt(1 - ratio**2))


def bearing_sizes(bearings: Bearings, mass: float, gravity: float = 9.81) -> BearingSizes | None:
    """Return the sizes of each of the bearings under `mass`, block and base together [kg].

    A bilinear law that yields within `STIFF` is a pendulum. None: the rubber of bearings without x_max is unknown.
    """
    law, weight, x_max = BearingLaw.of(bearings), mass * gravity / bearings.count, bearings.x_max
    if bearings.law == "bilinear" and law.f0 <= STIFF * law.dk and law.kb > 0:
        radius, friction = weight / law.kb, law.f0 / weight
        unmade = _unmade({"radius": radius, "friction": friction})
        return BearingSizes("pendulum", None, None, None, None, None, None, radius, friction, unmade)
    if x_max is None or not law.kb > 0:
        return None
    height = x_max / STRAIN
    area, core = law.kb * height / RUBBER, 2 * math.sqrt(law.f0 / (math.pi * LEAD)) or None
    diameter = 2 * math.sqrt(area / math.pi)
    overlap, pressure = overlap_share(diameter, x_max), weight / area
    back, pendulum = properties(bearings, mass, x_max), (None, None)
    damping = back.damping_equivalent + math.pi * bearings.damping / (back.period * back.secant_stiffness)
    with contextlib.suppress(SettingError):  # no friction has that damping
        pendulum = pendulum_of(back.period, damping, x_max, gravity)  # type: ignore[assignment]  # as above, or numbers
    return BearingSizes(
        "lead-rubber" if core else "rubber",
        core,
        diameter,
        height,
        overlap,
        pressure,
        pressure / overlap if overlap > 0 else None,
        *pendulum,
        _unmade({"core": core, "diameter": diameter, "overlap": overlap, "pressure": pressure}),
    )


def pendulum_of(period: float, damping: float, x_max: float, gravity: float = 9.81) -> tuple[float, float]:
    """Return (radius [m], friction) of the pendulum with a secant period [s] and an equivalent damping at x_max [m].

    With k the secant stiffness over the weight, (2 pi/T)^2/g: the loop 4 mu (x_max - x_y) is damping x 2 pi k x_max^2,
    and 1/R = k - mu/x_max.

    Raises
    ------
    SettingError
        No pendulum has that damping: it is between 0 and 2/pi (1 - x_y/x_max).
    """
    require(x_max > 2 * SLIDES_AT, f"x_max = {x_max!r}: a pendulum slides from {SLIDES_AT:g} m on; give more")
    most = 2 / math.pi * (1 - SLIDES_AT / x_max)
    require(0 < damping < most, f"damping = {damping:.4g}: a pendulum has from 0 to {most:.3g}; give a share between")
    stiffness = (2 * math.pi / period) ** 2 / gravity
    friction = math.pi * damping * stiffness * x_max**2 / (2 * (x_max - SLIDES_AT))
    return 1 / (stiffness - friction / x_max), friction


def pendulum_bearings(
    mass: float, radius: float, friction: float, *, count: int = 4, x_max: float | None = None, gravity: float = 9.81
) -> Bearings:
    """Return pendulum bearings as the bilinear law.

    Parameters
    ----------
    mass : float
        Block and base together [kg], carried by all bearings alike.
    radius, friction : float
        Radius of curvature [m], and coefficient of friction.
    count, x_max, gravity : int, float, float
        Number of bearings; design displacement [m]; [m/s2].

    Raises
    ------
    SettingError
        A number is out of range.
    """
    for name, value in {"mass": mass, "radius": radius, "friction": friction}.items():
        require(LEAST <= value <= MOST, f"{name} = {value!r}: give a number from {LEAST:g} to {MOST:g}")
    require(count >= 1, f"count = {count!r}: give at least one bearing")
    kb, strength = mass * gravity / (count * radius), friction * mass * gravity / count
    ka = kb + strength / SLIDES_AT
    return Bearings(law="bilinear", count=count, ka=ka, kb=kb, yield_force=ka * SLIDES_AT, x_max=x_max)


def design_pendulum(
    mass: float, period: float, damping: float, x_max: float, *, count: int = 4, gravity: float = 9.81
) -> Bearings:
    """Return pendulum bearings with a secant period [s] and an equivalent damping at x_max [m]; see `pendulum_of`."""
    radius, friction = pendulum_of(period, damping, x_max, gravity)
    return pendulum_bearings(mass, radius, friction, count=count, x_max=x_max, gravity=gravity)


def pendulum_note(bearings: Bearings | None, mass: float, gravity: float = 9.81) -> list[str]:
    """Return lines for a scene file on pendulum bearings under `mass` [kg] and their limits; none for others."""
    sizes = bearings and bearing_sizes(bearings, mass, gravity)
    return [*sizes.sentences, sizes.assumed] if sizes and sizes.kind == "pendulum" else []
