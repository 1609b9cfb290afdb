"""A scene as exudyn bodies, loads and bearing; the variants add the contact between block and base.

Coordinates: ground frame, x horizontal, y up; exudyn's rotation is counter-clockwise, so theta = -tilt. The ground
motion enters as inertial load, x is relative to the ground.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import exudyn as exu
import numpy as np
from exudyn.advancedUtilities import CreateSymbolicUserFunction
from exudyn.itemInterface import (
    LoadForceVector,
    LoadMassProportional,
    MarkerBodyMass,
    MarkerBodyPosition,
    Node1D,
    NodeRigidBody2D,
    ObjectConnectorCartesianSpringDamper,
    ObjectGround,
    ObjectMass1D,
    ObjectRigidBody2D,
)

from analytic.bearing import BearingLaw

from ..placement import placement
from .ground import ground_load

if TYPE_CHECKING:
    from analytic import Scene
    from analytic.types import Motion

    from .corners import Anchor

Real = exu.symbolic.Real


@dataclass
class Model:
    """An exudyn system of one scene. `keep` holds the expression trees, which exudyn does not own."""

    scene: Scene
    container: exu.SystemContainer
    mbs: exu.MainSystem
    ground: exu.ObjectIndex
    block: exu.ObjectIndex
    base: exu.ObjectIndex
    bearing: Bearing | None = None
    anchor: Anchor | None = None  # of the friction, see `corners`
    loads: list = field(default_factory=list)  # (number, motion whose segment it follows)
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

    def load(self, item: Any, function: Callable[..., Any], motion: Motion) -> None:
        """A load with a symbolic value, whose vector holds the segment's parameters of the motion."""
        number = exu.LoadIndex(self.mbs.AddLoad(item))
        self._make_symbolic(number, function, "loadVectorUserFunction", self.mbs.SetLoadParameter)
        self.loads.append((number, motion))

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


class _Symbols:
    """What a law's formula is made of, see `Law.expression`."""

    @staticmethod
    def where(condition: Any, a: Any, b: Any) -> Any:
        a, b = (Real(one) if isinstance(one, float) else one for one in (a, b))
        return exu.symbolic.IfThenElse(condition, a, b)

    @staticmethod
    def power(a: Any, b: float) -> Any:
        return exu.symbolic.pow(a, Real(b))

    @staticmethod
    def exp(a: Any) -> Any:
        return exu.symbolic.exp(a)


class Bearing:
    """All bearings as one force between ground and base: symbolic inside a step, its history committed after it.

    x, z : base displacement [m] and hysteretic force of one bearing [N] at the last accepted step.
    """

    def __init__(self, law: BearingLaw, displacement: float) -> None:
        self.law, self.x, self.z, self.connector = law, displacement, law.start(displacement), None

    def memory(self) -> list[float]:
        """The history as the three numbers the force expression reads."""
        return [self.x, *self.law.moved(self.z, 0.0)[1:]]

    def commit(self, mbs: exu.MainSystem, x: float) -> float:
        """Move the history to an accepted displacement; the hysteretic force there."""
        if self.law.unit.memory:
            self.z, first, second = self.law.moved(self.z, x - self.x)
            self.x = x
            mbs.SetObjectParameter(self.connector, "offset", [x, first, second])
        return self.z

    def restore(self, mbs: exu.MainSystem, x: float, z: float) -> None:
        """Take the history back to an earlier step."""
        self.x, self.z = x, z
        mbs.SetObjectParameter(self.connector, "offset", self.memory())

    def force(self, displacement: Any, velocity: Any, offset: Any) -> list[Any]:
        """Symbolic force against the base [N], by the law's formula from the committed point.

        exudyn has already subtracted the offset, here the committed displacement, from the displacement.
        """
        law, dx = self.law, displacement[0]
        z = law.unit.expression(_Symbols, dx, offset[1], offset[2], *law.constants)
        total = law.kb * (dx + offset[0]) + law.damping * velocity[0] + z
        return [law.count * total, Real(0.0), Real(0.0)]


def start_coordinates(scene: Scene, sink: float) -> tuple[list[float], list[float]]:
    """(q, v) of the block's centre [m, m/s; rad, rad/s], relative to its place at rest; `sink` is the static
    penetration [m] of a block that stands."""
    x, z, across, up = placement(scene)
    tilt, rate = scene.start.tilt, scene.start.tilt_rate
    lower = sink if tilt == 0 and rate == 0 else 0.0
    q = [x, z - lower, -tilt]
    v = [across, up, -rate]
    return q, v


def build(scene: Scene, sink: float = 0.0) -> Model:
    """The `Model` of a scene without contact."""
    container = exu.SystemContainer()
    mbs = container.AddSystem()
    ground = mbs.AddObject(ObjectGround())
    q, v = start_coordinates(scene, sink)
    node = mbs.AddNode(
        NodeRigidBody2D(
            referenceCoordinates=[0.0, scene.block.half_height, 0.0], initialCoordinates=q, initialVelocities=v
        )
    )
    block = mbs.AddObject(ObjectRigidBody2D(mass=scene.block.mass, inertia=scene.block.centre_inertia, nodeNumber=node))
    base = ground
    if scene.base:
        start = scene.start
        node = mbs.AddNode(
            Node1D(
                referenceCoordinates=[0.0],
                initialCoordinates=[start.base_displacement],
                initialVelocities=[start.base_velocity],
            )
        )
        base = mbs.AddObject(ObjectMass1D(mass=scene.base.mass, nodeNumber=node))
    model = Model(scene, container, mbs, ground, block, base)
    if scene.bearings:
        _add_bearing(model)
    _add_loads(model)
    return model


def _add_bearing(model: Model) -> None:
    mbs, law = model.mbs, BearingLaw.of(model.scene.bearings)
    model.bearing = Bearing(law, model.scene.start.base_displacement)
    markers = [mbs.AddMarker(MarkerBodyPosition(bodyNumber=body)) for body in (model.ground, model.base)]
    model.bearing.connector = model.connect("bearing", markers, model.bearing.force, offset=model.bearing.memory())


def _add_loads(model: Model) -> None:
    """Weight of the block, and inertia of block and base in the ground's frame."""
    scene, mbs = model.scene, model.mbs
    block = mbs.AddMarker(MarkerBodyMass(bodyNumber=model.block))
    if scene.motion is None:
        mbs.AddLoad(LoadMassProportional(markerNumber=block, loadVector=[0.0, -scene.gravity, 0.0]))
        return
    acceleration = ground_load(scene.motion)

    def on_block(mbs, t, load):
        return [-acceleration(t, load), Real(-scene.gravity), Real(0.0)]

    model.load(LoadMassProportional(markerNumber=block), on_block, scene.motion)
    if scene.motion.vertical:
        rising = ground_load(scene.motion.vertical)

        def upright(mbs, t, load):
            return [Real(0.0), -rising(t, load), Real(0.0)]

        model.load(LoadMassProportional(markerNumber=block), upright, scene.motion.vertical)
    if scene.base:
        base = mbs.AddMarker(MarkerBodyPosition(bodyNumber=model.base))

        def on_base(mbs, t, load):
            return [-scene.base.mass * acceleration(t, load), Real(0.0), Real(0.0)]

        model.load(LoadForceVector(markerNumber=base), on_base, scene.motion)


def read_back(model: Model) -> dict[str, tuple[Any, Any]]:
    """What exudyn really holds, as a dict name -> (in exudyn, in the scene)."""
    scene, mbs = model.scene, model.mbs
    block = mbs.GetObject(model.block)
    values = {
        "block.mass": (block["mass"], scene.block.mass),
        "block.centre_inertia": (block["inertia"], scene.block.centre_inertia),
    }
    if scene.base:
        values["base.mass"] = (mbs.GetObject(model.base)["mass"], scene.base.mass)
    q = np.asarray(mbs.systemData.GetODE2Coordinates())
    v = np.asarray(mbs.systemData.GetODE2Coordinates_t())
    values["start.tilt"] = (-q[2], scene.start.tilt)
    values["start.tilt_rate"] = (-v[2], scene.start.tilt_rate)
    if scene.base:
        values["start.base_displacement"] = (q[3], scene.start.base_displacement)
        values["start.base_velocity"] = (v[3], scene.start.base_velocity)
    values["coordinates"] = (len(q), 4 if scene.base else 3)
    for (number, name), wanted in model.expected.items():
        item = mbs.GetObject(number)
        values[f"{item['objectType']} {number} {name}"] = (item[name], wanted)
    return values
