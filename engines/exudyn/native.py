"""exudyn, variant native-contact: exudyn's own sphere-triangle contact, as in a first script."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import exudyn as exu
from exudyn.itemInterface import MarkerBodyRigid, NodeGenericData, ObjectContactSphereTriangle

from .scene import build
from .stepping import in_one_go, solver_settings, step_through

if TYPE_CHECKING:
    from analytic import Scene

    from ..contract import Run
    from .scene import Model


@dataclass(frozen=True)
class NativeContact:
    """Settings of native-contact. `step` is the accuracy parameter, but the contact has an error at any step.

    The contact's damper pulls at a lifting corner, and its friction is a regularised slip law: restitution is off by
    1 to 10 %, whatever the step.
    """

    step: float = 1e-4  # s
    stiffness: float = 1e8  # N/m; at 1e9 Newton's method fails at the first impact of most blocks
    damping: float = 0.5  # over the critical one of the block's mass on one corner
    friction: float = 1.0
    slip_speed: float = 1e-2  # m/s, below it friction is proportional to speed
    sphere: float = 2e-2  # m, radius of the corner spheres; with 1e-3 stocky blocks are thrown into the air


def assemble(scene: Scene, settings: NativeContact) -> tuple[Model, float]:
    """Build a scene with sphere-triangle contacts: (model, static penetration [m])."""
    block = scene.block
    sink = block.mass * scene.gravity / (2 * settings.stiffness)
    model = build(scene, (0.0, -sink, 0.0))
    mbs, b, h, r = model.mbs, block.half_width, block.half_height, settings.sphere
    wide = 10 * block.radius
    triangle = [[-wide, 0.0, wide], [wide, 0.0, wide], [0.0, 0.0, -2 * wide]]
    plane = mbs.AddMarker(MarkerBodyRigid(bodyNumber=model.base))
    for side, name in ((-1, "left"), (1, "right")):
        centre = mbs.AddMarker(MarkerBodyRigid(bodyNumber=model.block, localPosition=[side * b, -h + r, 0.0]))
        memory = mbs.AddNode(NodeGenericData(initialCoordinates=[0.0] * 4, numberOfDataCoordinates=4))
        values = dict(
            sphereRadius=r,
            includeEdges=0,
            contactStiffness=settings.stiffness,
            contactDamping=2 * settings.damping * math.sqrt(settings.stiffness * block.mass),
            dynamicFriction=settings.friction,
            frictionProportionalZone=settings.slip_speed,
        )
        number = mbs.AddObject(
            ObjectContactSphereTriangle(
                markerNumbers=[centre, plane], nodeNumber=memory, trianglePoints=exu.Vector3DList(triangle), **values
            )
        )
        model.connectors[name] = number
        model.expected.update({(number, key): value for key, value in values.items()})
    return model, sink


def run(scene: Scene, settings: NativeContact) -> Run:
    """Step a scene with exudyn's own contact."""
    model, sink = assemble(scene, settings)
    solver = solver_settings(
        scene, numberOfSteps=math.ceil(scene.duration / settings.step - 1e-9), automaticStepSize=False
    )
    solver.timeIntegration.newton.useModifiedNewton = False
    return step_through(model, lambda model, steps: in_one_go(model, solver, steps), 4 * sink / scene.block.half_width)
