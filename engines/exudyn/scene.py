"""A scene as exudyn bodies, loads and bearing; the variants add the contact between block and base.

Coordinates: ground frame, x horizontal, y up; exudyn's rotation is counter-clockwise, so theta = -tilt. The ground
motion enters as inertial load, x is relative to the ground.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import exudyn as exu
import numpy as np
from exudyn.itemInterface import (
    LoadForceVector,
    LoadMassProportional,
    MarkerBodyMass,
    MarkerBodyPosition,
    Node1D,
    NodeRigidBody2D,
    ObjectGround,
    ObjectMass1D,
    ObjectRigidBody2D,
)

from analytic.bearing import BearingLaw

from ..placement import placement
from .ground import ground_load
from .model import Bearing, Model

if TYPE_CHECKING:
    from analytic import Scene

Real = exu.symbolic.Real


def start_coordinates(scene: Scene, sink: float) -> tuple[list[float], list[float]]:
    """(q, v) of the block's centre [m, m/s; rad, rad/s], relative to its position at rest; `sink` is the static
    penetration [m] of a standing block."""
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
    """{name: (value in exudyn, value in the scene)}."""
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
