"""A scene in exudyn: bodies, loads, bearings with their history; settings of compliant-corners and their scaling.

The variants add the contact between block and base. Coordinates: ground frame, x horizontal, y up; exudyn's rotation is
counter-clockwise, so theta = -tilt. The ground motion enters as an inertial load, and x is relative to the ground.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import exudyn as exu
import numpy as np
from exudyn.advancedUtilities import CreateSymbolicUserFunction
from exudyn.itemInterface import (
    LoadForceVector,
    LoadMassProportional,
    MarkerBodyMass,
    MarkerBodyPosition,
    MarkerBodyRigid,
    Node1D,
    NodeRigidBody2D,
    ObjectConnectorCartesianSpringDamper,
    ObjectConnectorTorsionalSpringDamper,
    ObjectGround,
    ObjectMass1D,
    ObjectRigidBody2D,
)

from analytic import Start
from analytic.rocking import BearingLaw

from ..loads import placement

if TYPE_CHECKING:
    from analytic import Scene

    from ..loads import Couple

Real = exu.symbolic.Real
SLIDES = 1 - 1e-9  # friction over its limit, but for round-off
LEAST = 1e-9  # travel [m] of a chord where the base was at rest
DISPLACEMENT, FORCE = exu.OutputVariableType.Displacement, exu.OutputVariableType.Force


def standing_until(scene: Scene) -> float:
    """Time [s] at which a run begins: the beginning of the motion, if everything is at rest until then."""
    return min(scene.motion.start, scene.duration) if scene.motion and scene.start == Start() else 0.0


def build(scene: Scene, deflected: Sequence[float]) -> Model:
    """The `Model` of a scene without contact. A standing block is `deflected` by what carries it [m, m, rad]."""
    start, (x, z, across, up) = scene.start, placement(scene)
    dx, dz, turn = deflected = (0.0, 0.0, 0.0) if start.tilt or start.tilt_rate else deflected
    container = exu.SystemContainer()
    mbs = container.AddSystem()
    ground = mbs.AddObject(ObjectGround())
    node = mbs.AddNode(
        NodeRigidBody2D(
            referenceCoordinates=[0.0, scene.block.half_height, 0.0],
            initialCoordinates=[x + dx, z + dz, turn - start.tilt],
            initialVelocities=[across, up, -start.tilt_rate],
        )
    )
    block = mbs.AddObject(ObjectRigidBody2D(mass=scene.block.mass, inertia=scene.block.centre_inertia, nodeNumber=node))
    base = ground
    if scene.base:
        node = mbs.AddNode(
            Node1D(
                referenceCoordinates=[0.0],
                initialCoordinates=[start.base_displacement],
                initialVelocities=[start.base_velocity],
            )
        )
        base = mbs.AddObject(ObjectMass1D(mass=scene.base_mass, nodeNumber=node))
    model = Model(scene, container, mbs, ground, block, base, deflected)
    if scene.bearings:
        _add_bearing(model)
    _add_loads(model)
    return model


def _add_bearing(model: Model) -> None:
    mbs, law = model.mbs, BearingLaw.of(model.scene.bearings)
    model.bearing = Bearing(law, model.scene.start.base_displacement)
    markers = [mbs.AddMarker(MarkerBodyPosition(bodyNumber=body)) for body in (model.ground, model.base)]
    damping = [law.count * law.damping, 0.0, 0.0]
    spring = ObjectConnectorCartesianSpringDamper(markerNumbers=markers, damping=damping)
    model.bearing.connector = mbs.AddObject(spring)
    model.bearing.commit(mbs, model.scene.start.base_displacement)


def _add_loads(model: Model) -> None:
    """Add the block's weight and, under a motion, the base's load, which `stepping.Ground` sets at each step."""
    scene, mbs = model.scene, model.mbs
    block = mbs.AddMarker(MarkerBodyMass(bodyNumber=model.block))
    model.weight = mbs.AddLoad(LoadMassProportional(markerNumber=block, loadVector=[0.0, -scene.gravity, 0.0]))
    if scene.base and scene.motion:
        base = mbs.AddMarker(MarkerBodyPosition(bodyNumber=model.base))
        model.push = mbs.AddLoad(LoadForceVector(markerNumber=base, loadVector=[0.0, 0.0, 0.0]))


def read_back(model: Model) -> dict[str, tuple[Any, Any]]:
    """Read values back from exudyn: {name: (value in exudyn, value in the scene)}."""
    scene, mbs = model.scene, model.mbs
    block = mbs.GetObject(model.block)
    values = {
        "block.mass": (block["mass"], scene.block.mass),
        "block.centre_inertia": (block["inertia"], scene.block.centre_inertia),
    }
    if scene.base:
        values["base.mass"] = (mbs.GetObject(model.base)["mass"], scene.base_mass)
    q = np.asarray(mbs.systemData.GetODE2Coordinates())
    v = np.asarray(mbs.systemData.GetODE2Coordinates_t())
    values["start.tilt"] = (-q[2], scene.start.tilt - model.deflected[2])
    values["start.tilt_rate"] = (-v[2], scene.start.tilt_rate)
    if scene.base:
        values["start.base_displacement"] = (q[3], scene.start.base_displacement)
        values["start.base_velocity"] = (v[3], scene.start.base_velocity)
    values["coordinates"] = (len(q), 4 if scene.base else 3)
    for (number, name), wanted in model.expected.items():
        item = mbs.GetObject(number)
        values[f"{item['objectType']} {number} {name}"] = (item[name], wanted)
    return values


@dataclass
class Model:
    """An exudyn system of one scene. `keep` holds the expression trees, which exudyn does not own."""

    scene: Scene
    container: exu.SystemContainer
    mbs: exu.MainSystem
    ground: exu.ObjectIndex
    block: exu.ObjectIndex
    base: exu.ObjectIndex
    deflected: Sequence[float]  # see `build`
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


class Bearing:
    """All bearings as one spring and damper between ground and base.

    Within a step the spring follows the law along its chord over the travel of the step before; its errors are then
    those of the law as a formula. The history is committed after each step.

    x, z : base displacement [m] and hysteretic force of one bearing [N] at the last accepted step.
    """

    def __init__(self, law: BearingLaw, displacement: float) -> None:
        self.law, self.x, self.z, self.connector = law, displacement, law.start(displacement), None
        self.nonlinear = law.constants.f0 > 0

    def commit(self, mbs: exu.MainSystem, x: float) -> float:
        """Move history and spring to the displacement x after a step; return the hysteretic force there."""
        law, ahead = self.law, x - self.x
        self.x, self.z = x, law.hysteretic(self.z, ahead)
        ahead = ahead or LEAST
        chord = law.kb + (law.hysteretic(self.z, ahead) - self.z) / ahead
        mbs.SetObjectParameter(self.connector, "stiffness", [law.count * chord, 0.0, 0.0])
        mbs.SetObjectParameter(self.connector, "offset", [x - (law.kb * x + self.z) / chord, 0.0, 0.0])
        return self.z


class Anchor:
    """State of Coulomb friction: the position at which the block sticks to its base.

    It is committed once per accepted step.

    connectors: of the two corners. friction: coefficient. sticking: tangential stiffness of a corner [N/m].
    """

    def __init__(self, connectors: tuple[Any, ...], friction: float, sticking: float) -> None:
        self.at, self.connectors, self.friction, self.sticking = 0.0, connectors, friction, sticking

    def commit(self, mbs: exu.MainSystem) -> None:
        """Move the anchor after a step.

        It moves by what every loaded corner has slid, and goes with the lower corner of a block in flight.
        """
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
    """The couple of a given restitution, as a torsional connector; see `engines.loads`.

    It rises and falls as s (1 - s), s = |tilt/rate|/acts, since a step would set the corners swinging. Its part against
    the pull toward the ground takes that of the time acts before, committed after each step.
    """

    def __init__(self, couple: Couple, least: float) -> None:
        """least: tilt [rad] below which no couple acts, as the block is in contact."""
        self.couple, self.least, self.connector = couple, least, None
        self.begin: tuple[float, float] | None = None  # time and speed

    def torque(self, rotation: Any, rate: Any, pull: Any) -> Any:
        """Symbolic torque against the block's rotation [N m]."""
        acts, (rate_part, pull_part) = self.couple.acts, _strengths(self.couple.kept)
        remaining = -rotation / (acts * rate)
        part = (rate_part / acts) * rate + pull_part * pull * exu.symbolic.sign(rate)
        bump = exu.symbolic.IfThenElse(
            remaining < 1.0, self.couple.inertia * remaining * (1.0 - remaining) * part, Real(0.0)
        )
        closing = exu.symbolic.IfThenElse(rotation * rate < 0.0, bump, Real(0.0))
        return exu.symbolic.IfThenElse(exu.symbolic.abs(rotation) > self.least, closing, Real(0.0))

    def commit(self, mbs: exu.MainSystem, t: float, rotation: float, rate: float) -> None:
        """Set the mean pull [rad/s2] since twice `acts` before the landing, after a step to time t."""
        acts, speed = self.couple.acts, abs(rate)
        if rotation * rate >= 0 or abs(rotation) > 2 * acts * speed:
            self.begin = None
        elif abs(rotation) > acts * speed:
            if self.begin is None:
                self.begin = t, speed
            elif t > self.begin[0]:
                mbs.SetObjectParameter(self.connector, "damping", (speed - self.begin[1]) / (t - self.begin[0]))


def _strengths(kept: float) -> tuple[float, float]:
    """Strengths (c, d) of a couple that leaves the share `kept` of a rate at the ground.

    dy/dx = (c + d a/y) s (1 - s) - a/y, s = x/y; y, x: rate and tilt over those at the couple's begin. a: pull toward
    the ground, in the same units, small. From y(1) = 1 the rate becomes `kept` times what it would be
    without the couple, y(0)^2 = kept^2 (1 + 2 a).
    """

    from scipy.integrate import solve_ivp
    from scipy.optimize import brentq

    def at_ground(c, d=0.0, a=0.0):
        def slope(x, y):
            return (c + d * a / y) * x / y * (1 - x / y) - a / y

        y = solve_ivp(slope, (1.0, 0.0), [1.0], rtol=1e-10, atol=1e-13).y[0, -1]
        return y - kept * math.sqrt(1 + 2 * a)

    c = brentq(at_ground, -20.0, 20.0)
    return c, brentq(lambda d: at_ground(c, d, 1e-3), -100.0, 100.0)


# The block for which the default values were determined: the Caryatid, mass [kg], radius [m], gravity [m/s2].
MEASURED = 3172.05, 1.0884, 9.81


@dataclass(frozen=True)
class CompliantCorners:
    """Settings of compliant-corners, for the Caryatid's weight and size. `stiffness` is the accuracy parameter.

    Errors are proportional to its inverse, at nearly the same cost: 2e9, 2e10 and 2e11 give e off by 1.2e-2, 1.0e-3 and
    2.6e-5 on the isolated Caryatid (slenderness .15), peak tilts by 1.9e-2, 3.7e-3 and 1.3e-4 of the slenderness, in
    .21, .23 and .24 s of CPU time. No other setting trades error for time: pivoting steps of 1 to 4 ms
    change neither; a tolerance of 1e-5 makes the error five times as large and saves 5 % of the time. stiffness [N/m]
    is that of a corner. Blocks of other mass, size and gravity get the dimensional equivalent: the same penetration
    over radius, the same speeds over sqrt(g R), the same steps over sqrt(R/g).

    Where a jump of the ground's acceleration lifts a block that was released and has come to rest before, on rigid
    ground, errors go as the root of that inverse: the peak tilt is off by .01 and more. See `corners.deflected`.
    """

    # The error of smaller swings is larger, by the inverse square of their speed.
    stiffness: float = 2e11
    # Largest rebound speed of a corner [m/s]: Hunt-Crossley damping of 1000 s/m.
    rebound: float = 1e-3
    # No slip in any impact, as the model's friction demand is far below it. The scene's coefficient replaces it.
    friction: float = 5.0
    # Tangential over normal stiffness. 0.1: three times the error; 1: twice the steps.
    sticking: float = 0.3
    # Tangential damping, over the critical one of block and base on the contact; 0.3 to 1 give the same error.
    damping: float = 0.5
    # Sliding speed [m/s] at which the viscous part of friction, proportional to the normal force, equals that force. A
    # corner must stick as soon as it lands; otherwise the other corner is pressed down and takes part in the impact.
    # Where an impact slips, e is off in proportion: 1.6e-2, 2e-3 and 5e-4 with .1, .01 and .003. Where none does,
    # .001 to .1 give the same e; .003 and .001 take 10 and 50 % more steps.
    slip: float = 0.01
    # Local error per step [m, rad, m/s, rad/s]. The step is limited by stability of the stiff contact, not by this.
    tolerance: float = 1e-7
    # [s]; of explicit steps, not reached in contact.
    longest_step: float = 5e-3
    # [s]; of implicit steps, while the block pivots or stands.
    pivoting_step: float = 2e-3


def scaled(scene: Scene, settings: CompliantCorners) -> CompliantCorners:
    """The settings scaled to a scene's weight, size and gravity."""
    block, (mass, radius, gravity) = scene.block, MEASURED
    speed = math.sqrt(scene.gravity * block.radius / (gravity * radius))
    time = math.sqrt(block.radius / scene.gravity / (radius / gravity))
    weight = block.mass * scene.gravity / block.radius / (mass * gravity / radius)
    return replace(
        settings,
        stiffness=settings.stiffness * weight,
        rebound=settings.rebound * speed,
        slip=settings.slip * speed,
        tolerance=settings.tolerance * min(speed, 1 / speed, 1.0),  # one tolerance for four units: the smallest scale
        longest_step=settings.longest_step * time,
        pivoting_step=settings.pivoting_step * time,
    )
