"""A scene built in Bullet, and read back to check the values that Bullet uses.

The pitfalls named in the comments were observed with PyBullet 3.2.7.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from ..placement import placement
from ..readback import require
from ..stepping import State
from .imported import pybullet
from .links import chain, without_losses

if TYPE_CHECKING:
    from analytic import Scene

# Coefficient of friction of the block where the scene gives none: it prevents sliding. Bullet multiplies the frictions
# of two bodies and limits the product to 10 without a message.
FRICTION = 10.0

# contactERP, the share of a penetration that a step removes, is not set, as these corners do not penetrate. With 0 to
# .9 per step e is the same to 2e-9 at every level. It matters for the contact of a box.

# The block has a sphere at each bottom corner for contact, radius over R (1e-9 gives the same e to 1e-6). Of a box,
# Bullet uses only the lowest corners: on a box it missed weak impacts (e off by .3), on a plane it did not stand still
# (tilt 8e-6 of gamma at rest at 1 ms, slenderness .45; spheres: 8e-11).
CORNER_RADIUS = 1e-6

# Relative residual of the sequential impulses of a step, rocking on one corner and standing on two; see `iterations`.
# With too few iterations e is .99998 instead of .64 (J_O = 1.05 m R^2), and a standing block rocks (10: at 9e-5 of
# gamma under shaking of .9 of the uplift threshold, gamma .1). With the direct solver (Dantzig) the block stands, too,
# but its friction is wrong on two corners: under a horizontal load the block and its base separate. The default
# solverResidualThreshold does not end the iterations early.
ROCKING_REST, STANDING_REST, MOST_ITERATIONS = 1e-6, 1e-4, 20_000

TILT, BASE = 2, 3  # the links of the block and of its base
MOST_VELOCITY = 1e9  # m/s and rad/s: Bullet's limit for joints; its default is 100


def iterations(scene: Scene, corners: int) -> int:
    """Iterations of the contact solver to a residual of ROCKING_REST (one corner) or STANDING_REST (two).

    Sequential impulses are the Gauss-Seidel method, normal impulses first. Its convergence rate is an eigenvalue, near
    1 for J_O near m R^2, and 1 - 3 tan^2 gamma for slender blocks on two corners. The forces on a light base are shared
    by friction, which takes more iterations. A formula without the base takes a third more CPU time; 50 for all leave
    peak tilts off by up to 4e-4 and let a slender block rock that stands.
    """
    block = scene.block
    b, h, light = block.half_width, block.half_height, scene.base.mass if scene.base else math.inf
    mobility = np.diag([1 / block.mass, 1 / block.mass, 1 / block.centre_inertia, 1 / light])
    across = (b,) if corners == 1 else (-b, b)
    directions = np.array([[0, 1, -x, 0] for x in across] + [[1, 0, -h, -1] for _ in across])
    delassus = directions @ mobility @ directions.T
    lower = np.tril(delassus)
    rates = np.abs(np.linalg.eigvals(np.linalg.solve(lower, lower - delassus)))
    rate = rates[rates < 1 - 1e-9].max()  # 1: distribution of the friction between the corners, irrelevant
    rest = (ROCKING_REST, STANDING_REST)[corners - 1]
    needed = math.log(rest * min(1.0, light / block.mass)) / math.log(rate) if rate > 0 else 1.0
    return min(max(math.ceil(needed), 1), MOST_ITERATIONS)


class BulletBodies:
    """The planar chain of a scene in a fresh client.

    The block is on massless x-prismatic, z-prismatic and y-revolute joints, and has two contact corners. The base is a
    plane on an x-prismatic joint of the same multibody, so that one call reads both; rigid ground is its fixed plane.

    Raises
    ------
    Mismatch
        Bullet reports other values than it was given.
    """

    def __init__(self, client: int, scene: Scene) -> None:
        block, base, start = scene.block, scene.base, scene.start
        b, h, r = block.half_width, block.half_height, CORNER_RADIUS * block.radius
        corners = pybullet.createCollisionShapeArray(
            [pybullet.GEOM_SPHERE] * 2,
            radii=[r] * 2,
            collisionFramePositions=[[-b, 0, r - h], [b, 0, r - h]],
            physicsClientId=client,
        )
        plane = pybullet.createCollisionShape(pybullet.GEOM_PLANE, physicsClientId=client)
        sliding, turning = pybullet.JOINT_PRISMATIC, pybullet.JOINT_REVOLUTE
        # link: mass, shape, position, joint, axis, parent
        links = [
            (0.0, -1, [0, 0, h], sliding, [1, 0, 0], 0),
            (0.0, -1, [0, 0, 0], sliding, [0, 0, 1], 1),
            (block.mass, corners, [0, 0, 0], turning, [0, 1, 0], 2),
        ]
        if base is not None:
            links.append((base.mass, plane, [0, 0, 0], sliding, [1, 0, 0], 0))
        flags = pybullet.URDF_USE_SELF_COLLISION
        body = chain(client, links, plane if base is None else -1, flags=flags)
        rough = math.sqrt(FRICTION if scene.friction is None else min(scene.friction, FRICTION))
        without_losses(client, body, len(links), rough, maxJointVelocity=MOST_VELOCITY)
        # About the centre. Setting it without the mass in the same call can set the mass to 0, with NaN in the first
        # step.
        pybullet.changeDynamics(
            body, TILT, mass=block.mass, localInertiaDiagonal=[block.centre_inertia] * 3, physicsClientId=client
        )
        x, z, vx, vz = placement(scene)
        states = [(x, vx), (z, vz), (start.tilt, start.tilt_rate), (start.base_displacement, start.base_velocity)]
        self.client, self.body, self.joints = client, body, range(len(links))
        for joint in self.joints:
            pybullet.resetJointState(body, joint, *states[joint], physicsClientId=client)
        self.mass, self.loaded = base.mass if base else 0.0, scene.bearings is not None
        self.sweeps = iterations(scene, 1), iterations(scene, 2)
        self.fall = scene.gravity / (4 * b)
        self.tilt, self.rate, self.used = start.tilt, start.tilt_rate, (0.0, 0)
        self._check(scene, rough, links, states)

    def _check(self, scene: Scene, rough: float, links: list[tuple], states: list[tuple[float, float]]) -> None:
        """Compare what Bullet reports with what the scene needs; raises `Mismatch` naming what differs."""
        told = [pybullet.getDynamicsInfo(self.body, link, self.client) for link in (-1, *self.joints)]
        joints = [pybullet.getJointInfo(self.body, joint, self.client) for joint in self.joints]
        now = pybullet.getJointStates(self.body, self.joints, self.client)
        require(
            [
                ("masses", [one[0] for one in told], [0.0, *(link[0] for link in links)]),
                ("friction", [one[1] for one in told], rough),
                ("restitution", [one[5] for one in told], 0.0),
                ("block: inertia", told[TILT + 1][2], scene.block.centre_inertia),
                ("joints: types", [one[2] for one in joints], [link[3] for link in links]),
                ("joints: damping and friction", [one[6:8] for one in joints], 0.0),
                ("start", [one[:2] for one in now], states[: len(links)]),
            ]
        )

    def step(self, step: float, before: float, across: float, up: float, impulse: float) -> State:
        """A step: see `engines.stepping.Bodies`.

        Few iterations suffice while only one corner may be loaded. More are used while both may be: where the higher
        one can reach contact within the step by its velocity or by free fall. Many in every step take up to six times
        the CPU time.
        """
        client = self.client
        sweeps = self.sweeps[abs(self.tilt) < step * (self.fall * step + abs(self.rate))]
        if (step, sweeps) != self.used:  # a call takes a tenth of a step's time
            self.used = step, sweeps
            pybullet.setPhysicsEngineParameter(
                fixedTimeStep=step, numSolverIterations=sweeps, contactSlop=0.0, physicsClientId=client
            )
        pybullet.setGravity(across / step, 0.0, up / step, client)
        if self.loaded:  # a force on the link equals one on its joint, and takes half the time
            force = impulse / step, 0.0, 0.0
            pybullet.applyExternalForce(self.body, BASE, force, (0.0, 0.0, 0.0), pybullet.LINK_FRAME, client)
        pybullet.stepSimulation(client)
        (x, vx, _, _), (z, vz, _, _), (tilt, rate, _, _), *base = pybullet.getJointStates(
            self.body, self.joints, client
        )
        self.tilt, self.rate = tilt, rate
        b, v = base[0][:2] if base else (0.0, 0.0)
        return tilt, rate, x, z, vx, vz, b, v

    def twist(self, moment: float) -> None:
        """See `engines.stepping.Bodies`; Bullet forgets it after the step."""
        pybullet.applyExternalTorque(self.body, TILT, (0.0, moment, 0.0), pybullet.LINK_FRAME, self.client)

    def weigh(self, added: float) -> None:
        """See `engines.stepping.Bodies`."""
        pybullet.changeDynamics(self.body, BASE, mass=self.mass + added, physicsClientId=self.client)
