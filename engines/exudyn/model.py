"""An exudyn system of one scene: bodies, bearings with their history, and the anchor of the friction."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import exudyn as exu
from exudyn.advancedUtilities import CreateSymbolicUserFunction
from exudyn.itemInterface import (
    MarkerBodyPosition,
    MarkerBodyRigid,
    ObjectConnectorCartesianSpringDamper,
    ObjectConnectorTorsionalSpringDamper,
)

if TYPE_CHECKING:
    from analytic import Scene
    from analytic.bearing import BearingLaw

    from ..couple import Couple

Real = exu.symbolic.Real
SLIDES = 1 - 1e-9  # friction over its limit, but for round-off
LEAST = 1e-9  # travel [m] of a chord where the base was at rest
DISPLACEMENT, FORCE = exu.OutputVariableType.Displacement, exu.OutputVariableType.Force


class Bearing:
    """All bearings as one spring and damper between ground and base. Within a step the spring follows the law along its
    chord over the travel of the step before, by which the errors are those of the law as a formula; the history is
    committed after each step.

    x, z : base displacement [m] and hysteretic force of one bearing [N] at the last accepted step.
    """

    def __init__(self, law: BearingLaw, displacement: float) -> None:
        self.law, self.x, self.z, self.connector = law, displacement, law.start(displacement), None

    def spring(self, ahead: float) -> dict[str, list[float]]:
        """Its parameters for the next step, in which the base is expected to move by `ahead` [m]."""
        law = self.law
        chord = law.kb + (law.hysteretic(self.z, ahead) - self.z) / ahead
        place = self.x - (law.kb * self.x + self.z) / chord
        return {"stiffness": [law.count * chord, 0.0, 0.0], "offset": [place, 0.0, 0.0]}

    def commit(self, mbs: exu.MainSystem, x: float) -> float:
        """Move the history to an accepted displacement; the hysteretic force there."""
        if self.law.unit.memory:
            ahead = x - self.x
            self.x, self.z = x, self.law.hysteretic(self.z, ahead)
            for name, value in self.spring(ahead or LEAST).items():
                mbs.SetObjectParameter(self.connector, name, value)
        return self.z


def _strengths(kept: float) -> tuple[float, float]:
    """(c, d) of dy/dx = (c + d a/y) s (1 - s) - a/y, s = x/y: rate and tilt over those at the couple's begin.

    a: pull toward the ground, in the same units, small. From y(1) = 1 the rate becomes `kept` times what it would be
    without the couple, y(0)^2 = kept^2 (1 + 2 a).
    """

    from scipy.integrate import solve_ivp  # not at every start: only a given restitution needs it
    from scipy.optimize import brentq

    def at_ground(c, d=0.0, a=0.0):
        def slope(x, y):
            return (c + d * a / y) * x / y * (1 - x / y) - a / y

        y = solve_ivp(slope, (1.0, 0.0), [1.0], rtol=1e-10, atol=1e-13).y[0, -1]
        return y - kept * math.sqrt(1 + 2 * a)

    c = brentq(at_ground, -20.0, 20.0)
    return c, brentq(lambda d: at_ground(c, d, 1e-3), -100.0, 100.0)


class Anchor:
    """State of Coulomb friction: the position at which the block sticks to its base, committed once per accepted step.

    connectors: of the two corners. friction: coefficient. sticking: tangential stiffness of a corner [N/m].
    """

    def __init__(self, connectors: tuple[Any, ...], friction: float, sticking: float) -> None:
        self.at, self.connectors, self.friction, self.sticking = 0.0, connectors, friction, sticking

    def commit(self, mbs: exu.MainSystem) -> None:
        """After a step: move the anchor by what every loaded corner has slid, and a block in flight's with its lower
        corner."""
        limits = []  # of friction [N]
        for connector in self.connectors:
            across, up, _ = mbs.GetObjectOutput(connector, FORCE)
            limits.append(-self.friction * up)
            if abs(across) < SLIDES * limits[-1]:
                return
        gaps = [mbs.GetObjectOutput(connector, DISPLACEMENT) for connector in self.connectors]
        loaded = [(self.at + gap[0], limit / self.sticking) for gap, limit in zip(gaps, limits, strict=True) if limit]
        if not loaded:
            loaded = [(self.at + min(gaps, key=lambda gap: gap[1])[0], 0.0)]
        low, high = min(place - most for place, most in loaded), max(place + most for place, most in loaded)
        at = min(max(self.at, low), high)
        if at != self.at:
            self.at = at
            for connector in self.connectors:
                mbs.SetObjectParameter(connector, "offset", [at, 0.0, 0.0])


class Twist:
    """The couple of a given restitution, as a torsional connector; see `engines.couple`.

    It rises and falls as s (1 - s), s = |tilt/rate|/acts, since a step would set the corners swinging. Its part against
    the pull toward the ground takes that of the time acts before, committed after each step.
    """

    def __init__(self, couple: Couple, least: float) -> None:
        """least: tilt [rad] of the block in contact, without couple."""
        self.couple, self.least, self.connector = couple, least, None
        self.begin: tuple[float, float] | None = None  # time and speed

    def torque(self, rotation: Any, rate: Any, pull: Any) -> Any:
        """Symbolic torque against the block's rotation [N m]."""
        acts, (rate_part, pull_part) = self.couple.acts, _strengths(self.couple.kept)
        left = -rotation / (acts * rate)
        part = (rate_part / acts) * rate + pull_part * pull * exu.symbolic.sign(rate)
        bump = exu.symbolic.IfThenElse(left < 1.0, self.couple.inertia * left * (1.0 - left) * part, Real(0.0))
        closing = exu.symbolic.IfThenElse(rotation * rate < 0.0, bump, Real(0.0))
        return exu.symbolic.IfThenElse(exu.symbolic.abs(rotation) > self.least, closing, Real(0.0))

    def commit(self, mbs: exu.MainSystem, t: float, rotation: float, rate: float) -> None:
        """After a step to time t: the mean pull [rad/s2] since twice `acts` before the landing."""
        acts, speed = self.couple.acts, abs(rate)
        if rotation * rate >= 0 or abs(rotation) > 2 * acts * speed:
            self.begin = None
        elif abs(rotation) > acts * speed:
            if self.begin is None:
                self.begin = t, speed
            elif t > self.begin[0]:
                mbs.SetObjectParameter(self.connector, "damping", (speed - self.begin[1]) / (t - self.begin[0]))


@dataclass
class Model:
    """An exudyn system of one scene. `keep` holds the expression trees, which exudyn does not own."""

    scene: Scene
    container: exu.SystemContainer
    mbs: exu.MainSystem
    ground: exu.ObjectIndex
    block: exu.ObjectIndex
    base: exu.ObjectIndex
    deflected: Sequence[float]  # see `engines.exudyn.scene.build`
    bearing: Bearing | None = None
    anchor: Anchor | None = None
    twist: Twist | None = None
    weight: Any = None  # load of the block
    push: Any = None  # load of the base under a motion
    connectors: dict = field(default_factory=dict)
    keep: list = field(default_factory=list)
    expected: dict = field(default_factory=dict)  # (object number, field): value the variant asked for

    def connect(
        self, name: str, markers: Sequence[Any], function: Callable[[Any, Any, Any], Any], **parameters: Any
    ) -> Any:
        """A Cartesian connector with a symbolic force, kept by name; function(displacement, velocity, offset)."""

        def spring(mbs, t, item, displacement, velocity, stiffness, damping, offset):
            return function(displacement, velocity, offset)

        item = ObjectConnectorCartesianSpringDamper(markerNumbers=markers, **parameters)
        number = self.mbs.AddObject(item)
        self._make_symbolic(number, spring, "springForceUserFunction", self.mbs.SetObjectParameter)
        self.connectors[name] = number
        self.expected[number, "activeConnector"] = True
        return number

    def add_twist(self, twist: Twist) -> None:
        """Connect ground and block by a given restitution's couple."""

        def torque(mbs, t, item, rotation, rate, stiffness, damping, offset):
            return twist.torque(rotation, rate, damping)

        markers = [self.mbs.AddMarker(MarkerBodyRigid(bodyNumber=body)) for body in (self.ground, self.block)]
        twist.connector = self.mbs.AddObject(ObjectConnectorTorsionalSpringDamper(markerNumbers=markers))
        self._make_symbolic(twist.connector, torque, "springTorqueUserFunction", self.mbs.SetObjectParameter)
        self.twist = twist

    def _make_symbolic(self, number: Any, function: Callable[..., Any], name: str, setter: Callable[..., Any]) -> None:
        tree = CreateSymbolicUserFunction(self.mbs, function, name, number)
        setter(number, name, tree)
        self.keep.append(tree)

    def corner_markers(self, side: int) -> list[Any]:
        """Markers of the base point and of the block's bottom corner of that side."""
        b, h = self.scene.block.half_width, self.scene.block.half_height
        return [
            self.mbs.AddMarker(MarkerBodyPosition(bodyNumber=self.base, localPosition=[side * b, 0.0, 0.0])),
            self.mbs.AddMarker(MarkerBodyPosition(bodyNumber=self.block, localPosition=[side * b, -h, 0.0])),
        ]
