"""The scene as a user of Drake would write it: a free 3-D block on the ground, or on a slab on a prismatic joint.

A first script leaves all as Drake has it: a box, whose contact with another box is the one point that is deepest,
materials of a stiffness that lets a body sink 1 mm under its weight, and lagged dissipation. `tuned`: what an hour
brings. Small spheres at the corners give the block as many points of contact (models that come with Drake put them on
boxes; its documentation of contact says why). TAMSI finds its solutions in a quarter of the others' time. A stiffness
of 1e12 N/m lets nothing sink; a dissipation of 1e3 s/m lets nothing rebound faster than 1 mm/s; the stiction
tolerance is a tenth of the default 1e-4 m/s, and the time step a fifth of 1 ms.
"""

from __future__ import annotations

import math
from array import array
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from pydrake.geometry import Box, Sphere
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.math import SpatialVelocity
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, DiscreteContactApproximation, MultibodyPlant
from pydrake.multibody.tree import PrismaticJoint, RigidBody
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import Context, DiagramBuilder

from analytic.bearing import BearingLaw
from analytic.motion import vertical_acceleration

from ..leapfrog import row_limit
from ..placement import placement
from .scene import add_ground, material, solid
from .stepping import said

if TYPE_CHECKING:
    from analytic import Scene

FRICTION = 1.0  # where the scene gives none: Drake asks for one
STIFFNESS, DISSIPATION, STICTION, CORNER_RADIUS = 1e12, 1e3, 1e-5, 1e-6  # tuned; N/m, s/m, m/s, m


@dataclass(frozen=True)
class Parts:
    """Drake's simulator, its plant with its context, the block, and the base's joint (None: rigid ground)."""

    simulator: Simulator
    plant: MultibodyPlant
    context: Context
    block: RigidBody
    slide: PrismaticJoint | None


def build(scene: Scene, step: float, tuned: bool) -> Parts:
    """The `Parts` of a scene at its start, for steps [s]."""
    block, builder = scene.block, DiagramBuilder()
    plant, _ = AddMultibodyPlantSceneGraph(builder, step)
    friction = FRICTION if scene.friction is None else scene.friction
    touching = material(friction, STIFFNESS, DISSIPATION) if tuned else material(friction)
    body = plant.AddRigidBody("block", solid(block.mass, block.centre_inertia))
    b, h = block.half_width, block.half_height
    if tuned:
        plant.set_discrete_contact_approximation(DiscreteContactApproximation.kTamsi)
        plant.set_stiction_tolerance(STICTION)
        for name, x, y in (("front left", -b, -b), ("front right", b, -b), ("back left", -b, b), ("back right", b, b)):
            place = RigidTransform([x, y, CORNER_RADIUS - h])
            plant.RegisterCollisionGeometry(body, place, Sphere(CORNER_RADIUS), name, touching)
    else:
        plant.RegisterCollisionGeometry(body, RigidTransform(), Box(2 * b, 2 * b, 2 * h), "box", touching)
    base = add_ground(plant, scene, touching)
    plant.Finalize()
    simulator = Simulator(builder.Build())
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    start, (x, z, vx, vz) = scene.start, placement(scene)
    plant.SetFreeBodyPose(context, body, RigidTransform(RotationMatrix.MakeYRotation(start.tilt), [x, 0.0, z + h]))
    plant.SetFreeBodySpatialVelocity(context, body, SpatialVelocity([0.0, start.tilt_rate, 0.0], [vx, 0.0, vz]))
    slide = None
    if base is not None:
        slide = plant.GetJointByName("slide")
        slide.set_translation(context, start.base_displacement)
        slide.set_translation_rate(context, start.base_velocity)
    simulator.Initialize()
    return Parts(simulator, plant, context, body, slide)


def run(parts: Parts, scene: Scene, step: float) -> tuple[np.ndarray, str]:
    """(rows, ended) as `stepping.run`: rates are those at the step's end, loads those at its beginning."""
    plant, context, body, slide = parts.plant, parts.context, parts.block, parts.slide
    law, g, height, motion = BearingLaw.of(scene.bearings), scene.gravity, scene.block.half_height, scene.motion
    port, gravity = plant.get_applied_generalized_force_input_port(), plant.mutable_gravity_field()
    start, fallen, ended = scene.start, 0.5 * math.pi, "done"
    x, v = start.base_displacement, start.base_velocity
    z = law.start(x)
    force = law.force(x, z)
    rows = array("d", (0.0, 0.0, start.tilt, start.tilt_rate, x, v, z, force, *placement(scene)))
    width = len(rows)
    pull, loads = [0.0, 0.0, -g], np.zeros(plant.num_velocities())
    gravity.set_gravity_vector(pull)
    for k in range(1, min(round(scene.duration / step), row_limit(scene.duration, step)) + 1):
        if motion:
            t = (k - 1) * step
            pull = [-float(motion.acceleration(t)), 0.0, -g - float(vertical_acceleration(motion, t))]
            gravity.set_gravity_vector(pull)
        if scene.bearings:
            loads[slide.velocity_start()] = -law.force(x, z, v)
            port.FixValue(context, loads)
        if not math.isfinite(pull[0] + pull[2] + loads.sum()):
            return np.frombuffer(rows).reshape(-1, width), "not finite"
        try:
            parts.simulator.AdvanceTo(k * step)
        except RuntimeError as error:
            return np.frombuffer(rows).reshape(-1, width), said(error)
        pose, twist = plant.EvalBodyPoseInWorld(context, body), plant.EvalBodySpatialVelocityInWorld(context, body)
        turn, place, speed = pose.rotation().matrix(), pose.translation(), twist.translational()
        tilt, rate = math.atan2(turn[0, 2], turn[0, 0]), twist.rotational()[1]
        if slide is not None:
            before, x, v = x, slide.get_translation(context), slide.get_translation_rate(context)
            z = law.hysteretic(z, x - before)
            force = law.force(x, z)
        rows.extend((k * step, step, tilt, rate, x, v, z, force, place[0], place[2] - height, speed[0], speed[2]))
        if not math.isfinite(tilt + rate + speed[0] + speed[2]):
            ended = "not finite"
            break
        if not -fallen < tilt < fallen:
            ended = "overturned"
            break
    return np.frombuffer(rows).reshape(-1, width), ended
