"""The scene as in a first script for PyBullet, with the API's defaults.

They include damping of .04 on every body, a motor of 1 N s per step in the base's joint, friction of .5 times .5, and
contact parameters for games.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from ..placement import placement
from ..stepping import State
from .imported import pybullet
from .links import chain

if TYPE_CHECKING:
    from analytic import Scene

THICKNESS = 1.0  # m, of the slab
# Gap [m] below which Bullet keeps contact points: its own default. It is global to the process and not returned by the
# getter, so that it is set in every client.
BREAKING_THRESHOLD = 0.02
MOST_VELOCITY = 100.0  # m/s and rad/s: Bullet's default limit of joints, applied without a message


class FreeBox:
    """A free 3-D box on a slab, which is fixed or, where the scene has a base, on one joint."""

    def __init__(self, client: int, scene: Scene, step: float) -> None:
        block = scene.block
        b, h = block.half_width, block.half_height
        pybullet.setTimeStep(step, client)
        pybullet.setPhysicsEngineParameter(contactBreakingThreshold=BREAKING_THRESHOLD, physicsClientId=client)
        pybullet.setGravity(0, 0, -scene.gravity, client)
        half = [20 * block.radius, 20 * block.radius, THICKNESS / 2]
        flat = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=half, physicsClientId=client)
        below = [0, 0, -THICKNESS / 2]
        if scene.base is None:
            slab = pybullet.createMultiBody(0, flat, -1, below, physicsClientId=client)
        else:
            slab = chain(client, [(scene.base.mass, flat, below, pybullet.JOINT_PRISMATIC, [1, 0, 0], 0)])
            pybullet.resetJointState(
                slab, 0, scene.start.base_displacement, scene.start.base_velocity, physicsClientId=client
            )
        box = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=[b, b, h], physicsClientId=client)
        x, z, vx, vz = placement(scene)
        turn = pybullet.getQuaternionFromEuler([0, scene.start.tilt, 0])
        body = pybullet.createMultiBody(block.mass, box, -1, [x, 0, z + h], turn, physicsClientId=client)
        if scene.friction is not None:  # Bullet multiplies the two
            pybullet.changeDynamics(body, -1, lateralFriction=math.sqrt(scene.friction), physicsClientId=client)
            pybullet.changeDynamics(
                slab, -1 if scene.base is None else 0, lateralFriction=math.sqrt(scene.friction), physicsClientId=client
            )
        pybullet.resetBaseVelocity(body, [vx, 0, vz], [0, scene.start.tilt_rate, 0], physicsClientId=client)
        self.client, self.body, self.slab, self.high = client, body, slab, h
        self.on_base, self.loaded = scene.base is not None, scene.bearings is not None

    def step(self, step: float, before: float, across: float, up: float, impulse: float) -> State:
        """A step: see `engines.stepping.Bodies`."""
        client, frame = self.client, pybullet.LINK_FRAME
        pybullet.setGravity(across / step, 0, up / step, client)
        if self.loaded:
            force = [impulse / step, 0, 0]
            pybullet.applyExternalForce(self.slab, 0, force, [0, 0, 0], frame, physicsClientId=client)
        pybullet.stepSimulation(client)
        (x, _, z), turn = pybullet.getBasePositionAndOrientation(self.body, client)
        (vx, _, vz), (_, rate, _) = pybullet.getBaseVelocity(self.body, client)
        base, v = pybullet.getJointState(self.slab, 0, client)[:2] if self.on_base else (0.0, 0.0)
        return 2 * math.atan2(turn[1], turn[3]), rate, x, z - self.high, vx, vz, base, v

    def weigh(self, added: float) -> None:
        """Not needed in a first script."""
