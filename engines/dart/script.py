"""The scene as a user of DART would write it: a free 3-D box on the ground, or on a slab on a prismatic joint.

`tuned`: what an hour with the manual brings: a time step well below the default of 1 ms, and penetrations taken back by
split impulses, so that they bring no speed (ConstraintSolver.setSplitImpulseEnabled). Without it all is left as DART
has it. Friction is DART's default of 1, collision detection its default, FCL's.
"""

from __future__ import annotations

import math
from array import array
from typing import TYPE_CHECKING

import dartpy
import numpy as np

from analytic.bearing import BearingLaw
from analytic.motion import vertical_acceleration

from ..leapfrog import row_limit
from ..placement import placement
from .scene import Assembly, add_ground, add_shape

if TYPE_CHECKING:
    from analytic import Scene


def build(scene: Scene, tuned: bool) -> Assembly:
    """The `Assembly` of a scene."""
    block, dynamics = scene.block, dartpy.dynamics
    world = dartpy.simulation.World()
    world.getConstraintSolver().setSplitImpulseEnabled(tuned)
    assembly = add_ground(world, scene, scene.friction)
    joint, body = assembly.block.createFreeJointAndBodyNodePair()
    inertia = np.eye(3) * block.centre_inertia
    body.setInertia(dynamics.Inertia(block.mass, [0.0, 0.0, 0.0], inertia))
    size = [2 * block.half_width, 2 * block.half_width, 2 * block.half_height]
    add_shape(body, dynamics.BoxShape(size), [0.0, 0.0, 0.0], scene.friction)
    x, z, vx, vz = placement(scene)
    assembly.block.setPositions([0.0, scene.start.tilt, 0.0, x, 0.0, z + block.half_height])
    # By name: a free joint's generalised velocities are along the world's axes, not the body's.
    joint.setLinearVelocity([vx, 0.0, vz])
    joint.setAngularVelocity([0.0, scene.start.tilt_rate, 0.0])
    world.addSkeleton(assembly.block)
    return assembly


def run(assembly: Assembly, scene: Scene, step: float) -> tuple[np.ndarray, str]:
    """(rows, ended) as `stepping.run`: rates are those at the step's end, loads those at its beginning."""
    world, body, ground = assembly.world, assembly.block.getBodyNode(0), assembly.ground
    law, g, height, motion = BearingLaw.of(scene.bearings), scene.gravity, scene.block.half_height, scene.motion
    start, fallen = scene.start, 0.5 * math.pi
    x, v = start.base_displacement, start.base_velocity
    z = law.start(x)
    force = law.force(x, z)
    rows = array("d", (0.0, 0.0, start.tilt, start.tilt_rate, x, v, z, force, *placement(scene)))
    width = len(rows)
    world.setTimeStep(step)
    pull = [0.0, 0.0, -g]
    world.setGravity(pull)
    for k in range(1, min(round(scene.duration / step), row_limit(scene.duration, step)) + 1):
        if motion:
            t = (k - 1) * step
            pull = [-float(motion.acceleration(t)), 0.0, -g - float(vertical_acceleration(motion, t))]
            world.setGravity(pull)
        load = -law.force(x, z, v) if scene.bearings else 0.0
        if not math.isfinite(pull[0] + pull[2] + load):  # DART would go on without an acceleration
            return np.frombuffer(rows).reshape(-1, width), "not finite"
        if scene.bearings:
            ground.setForces([load])
        world.step()
        turn, place, speed = body.getTransform().rotation(), body.getCOM(), body.getCOMLinearVelocity()
        tilt, rate = math.atan2(turn[0, 2], turn[0, 0]), body.getAngularVelocity()[1]
        if scene.base is not None:
            before, x, v = x, ground.getPosition(0), ground.getVelocity(0)
            z = law.hysteretic(z, x - before)
            force = law.force(x, z)
        rows.extend((k * step, step, tilt, rate, x, v, z, force, place[0], place[2] - height, speed[0], speed[2]))
        if not math.isfinite(tilt + rate + speed[0] + speed[2]):
            return np.frombuffer(rows).reshape(-1, width), "not finite"
        if not -fallen < tilt < fallen:
            return np.frombuffer(rows).reshape(-1, width), "overturned"
    return np.frombuffer(rows).reshape(-1, width), "done"
