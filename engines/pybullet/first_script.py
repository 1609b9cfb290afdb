"""The scene as a first script would set it up in PyBullet: the API's defaults left as they are.

What that brings: damping .04 on every body, a motor of 1 N s per step in the base's joint, friction .5 times .5,
contact parameters for games, the bearings' force and the ground's acceleration sampled once per step, states read
as they come.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import pybullet

from analytic.bearing import BearingLaw
from analytic.motion import vertical_acceleration

from ..placement import placement
from .links import chain

if TYPE_CHECKING:
    from analytic import Scene

THICKNESS = 1.0  # m, of the slab
# Bullet's own default [m]. Process-global: without it a planar run earlier in the process would leave its own here.
BREAKING_THRESHOLD = 0.02
MOST_VELOCITY = 100.0  # m/s and rad/s: where Bullet cuts a joint's by default, in silence


def build(client: int, scene: Scene, step: float) -> tuple[int, int]:
    """(block, slab) ids: a free 3-D box on a slab; the slab fixed, or on one joint where the scene has a base."""
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
    return body, slab


def run(handles: tuple[int, int], client: int, scene: Scene, step: float) -> tuple[Sequence[tuple[float, ...]], str]:
    """(rows, ended) as `stepping.run`; rates are those Bullet reports at the step's end."""
    body, slab = handles
    law = BearingLaw.of(scene.bearings)
    on_base, acceleration = scene.base is not None, scene.motion.acceleration if scene.motion else None
    start, limit = scene.start, 0.5 * math.pi
    t, x, v = 0.0, start.base_displacement, start.base_velocity
    z = law.start(x)
    force = law.force(x, z)
    rows = [(t, 0.0, start.tilt, start.tilt_rate, x, v, z, force)]
    for k in range(1, round(scene.duration / step) + 1):
        if acceleration:
            up = float(vertical_acceleration(scene.motion, t))
            pybullet.setGravity(-float(acceleration(t)), 0, -scene.gravity - up, client)
        if scene.bearings:
            pybullet.applyExternalForce(
                slab, 0, [-law.force(x, z, v), 0, 0], [0, 0, 0], pybullet.LINK_FRAME, physicsClientId=client
            )
        pybullet.stepSimulation(client)
        t = k * step
        _, turn = pybullet.getBasePositionAndOrientation(body, client)
        _, spin = pybullet.getBaseVelocity(body, client)
        tilt = 2 * math.atan2(turn[1], turn[3])
        if on_base:
            before = x
            x, v, *_ = pybullet.getJointState(slab, 0, client)
            if scene.bearings:
                z = law.hysteretic(z, x - before)
                force = law.force(x, z)
        rows.append((t, step, tilt, spin[1], x, v, z, force))
        if not -limit < tilt < limit:
            return rows, "overturned" if math.isfinite(tilt) else "not finite"
    return rows, "done"
