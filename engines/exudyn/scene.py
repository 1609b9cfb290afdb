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
    ObjectConnectorCartesianSpringDamper,
    ObjectGround,
    ObjectMass1D,
    ObjectRigidBody2D,
)

from analytic import Start
from analytic.bearing import BearingLaw

from ..placement import placement
from .model import LEAST, Bearing, Model

if TYPE_CHECKING:
    from collections.abc import Sequence

    from analytic import Scene


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
        base = mbs.AddObject(ObjectMass1D(mass=scene.base.mass, nodeNumber=node))
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
    spring = ObjectConnectorCartesianSpringDamper(markerNumbers=markers, damping=damping, **model.bearing.spring(LEAST))
    model.bearing.connector = mbs.AddObject(spring)


def _add_loads(model: Model) -> None:
    """Weight of the block, and room for the inertia of the base in the ground's frame; see `Ground`."""
    scene, mbs = model.scene, model.mbs
    block = mbs.AddMarker(MarkerBodyMass(bodyNumber=model.block))
    model.weight = mbs.AddLoad(LoadMassProportional(markerNumber=block, loadVector=[0.0, -scene.gravity, 0.0]))
    if scene.base and scene.motion:
        base = mbs.AddMarker(MarkerBodyPosition(bodyNumber=model.base))
        model.push = mbs.AddLoad(LoadForceVector(markerNumber=base, loadVector=[0.0, 0.0, 0.0]))


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
