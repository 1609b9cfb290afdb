"""Drake's variant: its contact solver computes contact and impact, in double precision. Tested with drake 1.51.1.

A plant has one fixed time step, so that steps cannot be shortened at impacts: there is only a first script. Its scene
is a free box on the ground, or on a slab on a prismatic joint. All defaults are Drake's: two boxes have one contact
point, the deepest; a body penetrates by 1 mm under its weight; dissipation is lagged.
"""

from __future__ import annotations

import math
from importlib import metadata
from typing import TYPE_CHECKING

import numpy as np
from pydrake.geometry import AddContactMaterial, Box, ProximityProperties
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.math import SpatialVelocity
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, CoulombFriction
from pydrake.multibody.tree import PrismaticJoint, SpatialInertia, UnitInertia
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from ..contract import Run, Variant
from ..loads import placement
from ..loop import SAMPLED, FirstScript, NoSolution, State, raw_trace_of, run_of

if TYPE_CHECKING:
    from analytic import Scene

FRICTION = 1.0  # where the scene gives none, as Drake requires one
WIDTH, THICKNESS = 2e3, 2.0  # of the ground, over R


class DrakeBodies:
    """Drake's simulator with the plant of block and base in the initial state; step: time step of the plant [s]."""

    def __init__(self, scene: Scene, step: float) -> None:
        block, builder, start, R = scene.block, DiagramBuilder(), scene.start, scene.block.radius
        b, h = block.half_width, block.half_height
        self.plant, _ = plant, _ = AddMultibodyPlantSceneGraph(builder, step)
        friction, touching = FRICTION if scene.friction is None else scene.friction, ProximityProperties()
        AddContactMaterial(properties=touching, friction=CoulombFriction(friction, friction))
        self.block = plant.AddRigidBody("block", _solid(block.mass, block.centre_inertia))
        plant.RegisterCollisionGeometry(self.block, RigidTransform(), Box(2 * b, 2 * b, 2 * h), "box", touching)
        ground, self.slide = plant.world_body(), None
        if scene.base is not None:
            ground = plant.AddRigidBody("base", _solid(scene.base_mass, scene.base_mass * R**2))
            frames = plant.world_frame(), ground.body_frame()
            self.slide = plant.AddJoint(PrismaticJoint("slide", *frames, [1.0, 0.0, 0.0]))
        below = RigidTransform([0.0, 0.0, -0.5 * THICKNESS * R])
        slab = Box(WIDTH * R, WIDTH * R, THICKNESS * R)
        plant.RegisterCollisionGeometry(ground, below, slab, "slab", touching)
        plant.Finalize()
        self.simulator = Simulator(builder.Build())
        self.context = context = plant.GetMyMutableContextFromRoot(self.simulator.get_mutable_context())
        x, z, vx, vz = placement(scene)
        pose = RigidTransform(RotationMatrix.MakeYRotation(start.tilt), [x, 0.0, z + h])
        plant.SetFreeBodyPose(context, self.block, pose)
        velocity = SpatialVelocity([0.0, start.tilt_rate, 0.0], [vx, 0.0, vz])
        plant.SetFreeBodySpatialVelocity(context, self.block, velocity)
        if self.slide is not None:
            self.slide.set_translation(context, start.base_displacement)
            self.slide.set_translation_rate(context, start.base_velocity)
        self.simulator.Initialize()
        self.half_height, self.done, self.loads = h, 0, np.zeros(plant.num_velocities())

    def step(self, step: float, before: float, across: float, up: float, impulse: float) -> State:
        """A step: see `engines.loop.Bodies`."""
        plant, context, slide = self.plant, self.context, self.slide
        plant.mutable_gravity_field().set_gravity_vector([across / step, 0.0, up / step])
        if slide is not None:
            self.loads[slide.velocity_start()] = impulse / step
            plant.get_applied_generalized_force_input_port().FixValue(context, self.loads)
        self.done += 1
        try:
            self.simulator.AdvanceTo(self.done * plant.time_step())
        except RuntimeError as error:
            why = str(error).partition(" at simulation time")[0]
            raise NoSolution(f"Drake found no solution of a step: {why}") from error
        pose = plant.EvalBodyPoseInWorld(context, self.block)
        twist = plant.EvalBodySpatialVelocityInWorld(context, self.block)
        turn, (x, _, z), (vx, _, vz) = pose.rotation().matrix(), pose.translation(), twist.translational()
        tilt = math.atan2(turn[0, 2], turn[0, 0])
        base, v = (slide.get_translation(context), slide.get_translation_rate(context)) if slide else (0.0, 0.0)
        return tilt, twist.rotational()[1], x, z - self.half_height, vx, vz, base, v

    def weigh(self, added: float) -> None:
        """Not needed in a first script."""


def _solid(mass: float, inertia: float) -> SpatialInertia:
    """Inertia of a body with the same moment of inertia [kg m2] about every axis through its centre."""
    return SpatialInertia(mass, [0.0, 0.0, 0.0], UnitInertia(*[inertia / mass] * 3))


VARIANTS = {
    "first-script": Variant(
        FirstScript(1e-3),  # Drake's own default
        kind="defaults",
        levels=(5e-3, 2e-3, 1e-3),
        computes="motion, contact, impact and rest",
        imposes=SAMPLED,
    )
}

# Tilt rate, in gamma per second, whose tilt in one step counts as flat contact: contact acts in the step after a corner
# has penetrated, which is passed in one or two steps.
PASSING = 10.0


def versions() -> dict[str, str]:
    """Versions of the packages that compute: {package: version}."""
    return {"pydrake": metadata.version("drake")}


def run(scene: Scene, variant: str, settings: FirstScript) -> Run:
    """The `Run` of a scene."""
    edge = PASSING * settings.step * scene.block.slenderness
    return run_of(scene, settings, lambda step: DrakeBodies(scene, step), lambda rows: raw_trace_of(rows, scene, edge))
