"""A scene built from Bullet's parts, and read back to see what Bullet really uses.

All traps named here were met with PyBullet 3.2.7; see the comments.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Self

import numpy as np

from ..placement import placement
from ..readback import require
from ..stepping import State
from .first_script import BREAKING_THRESHOLD
from .imported import pybullet
from .links import chain, without_losses

if TYPE_CHECKING:
    from analytic import Scene

# Coefficient between the block and what it stands on where the scene gives none: the model's "no sliding". Bullet
# multiplies the frictions of two bodies and cuts the product to 10, in silence.
MOST_FRICTION = 10.0
FRICTION = MOST_FRICTION

# Not set is contactERP, the share of a penetration that a step takes back: with these corners nothing penetrates.
# Between 0 and .9 a step e is the same to 2e-9 at every accuracy; with a box's contact it matters.

# The block touches by a sphere at each bottom corner, radius in shares of R (1e-9 gives the same e to 1e-6). A box
# shows Bullet only its lowest corners: on a box it lost weak impacts (e off by .3), on a plane it did not stand still
# (tilt 8e-6 of gamma at rest at 1 ms, slenderness .45; the spheres 8e-11).
CORNER_RADIUS = 1e-6

# What the sequential impulses of a step may leave undone, as a share, rocking on one corner and standing on two; see
# `iterations`. With too few e is .99998 for .64 (J_O = 1.05 m R^2) and a standing block rocks (10: at 9e-5 of gamma
# under shaking of .9 of the uplift threshold, gamma .1). The direct solver (Dantzig) stands too, but its friction is
# wrong on two corners: under a horizontal load the block and its base part. The default solverResidualThreshold does
# not end the iterations early.
ROCKING_REST, STANDING_REST, MOST_ITERATIONS = 1e-6, 1e-4, 20_000

MOST_VELOCITY = 1e9  # m/s and rad/s, above which Bullet would cut a joint's; its default is 100


@dataclass(frozen=True)
class Assembly:
    """Bullet's handles of a scene: client, body and joints (None: no base)."""

    client: int
    body: int
    ground: int | None
    slide: int
    lift: int
    tilt: int
    base: int | None


@dataclass(frozen=True)
class Units:
    """Size of Bullet's units of length [m] and time [s]; those of acceleration, mass and force are SI.

    Bullet has thresholds in metres, and step lengths go with sqrt(R/g): a block of .5 to 2 m stays as it is, others are
    brought there. By powers of 4, so nothing is rounded.
    """

    length: float
    time: float

    @classmethod
    def of(cls, scene: Scene) -> Self:
        power = round(math.log(scene.block.radius, 4))
        return cls(4.0**power, 2.0**power)

    def scale(self, scene: Scene) -> Scene:
        """The scene in these units, but for its motion and bearings, which stay in SI."""
        block, start, length, speed = scene.block, scene.start, self.length, self.length / self.time
        inertia = None if block.corner_inertia is None else block.corner_inertia / length**2
        duration = None if scene.duration is None else scene.duration / self.time
        return scene.with_(
            block={"radius": block.radius / length, "corner_inertia": inertia},
            duration=duration,
            start={
                "tilt_rate": start.tilt_rate * self.time,
                "base_displacement": start.base_displacement / length,
                "base_velocity": start.base_velocity / speed,
            },
        )


def iterations(scene: Scene, corners: int) -> int:
    """Iterations of the contact solver until ROCKING_REST (one corner) or STANDING_REST (two) is left.

    Sequential impulses are Gauss-Seidel's method, the normals first: its rate is an eigenvalue, near 1 for J_O near
    m R^2, and for slender blocks on two corners as 1 - 3 tan^2 gamma. The forces on a light base are shared out by
    friction: there is more to undo.
    """
    block = scene.block
    b, h, light = block.half_width, block.half_height, scene.base.mass if scene.base else math.inf
    mobility = np.diag([1 / block.mass, 1 / block.mass, 1 / block.centre_inertia, 1 / light])
    across = (b,) if corners == 1 else (-b, b)
    directions = np.array([[0, 1, -x, 0] for x in across] + [[1, 0, -h, -1] for _ in across])
    delassus = directions @ mobility @ directions.T
    lower = np.tril(delassus)
    rates = np.abs(np.linalg.eigvals(np.linalg.solve(lower, lower - delassus)))
    rate = rates[rates < 1 - 1e-9].max()  # 1: the two corners' shares of the friction, which do not matter
    rest = (ROCKING_REST, STANDING_REST)[corners - 1]
    needed = math.log(rest * min(1.0, light / block.mass)) / math.log(rate) if rate > 0 else 1.0
    return min(max(math.ceil(needed), 1), MOST_ITERATIONS)


def assemble(client: int, scene: Scene, step: float) -> Assembly:
    """Build the planar chain of a scene, in Bullet's `Units`, in a fresh client.

    The block, on x-prismatic, z-prismatic and y-revolute joints without mass, touches with two corners. The base is
    a plane on an x-prismatic joint of the same multibody (one call then reads both), or a fixed plane for rigid
    ground.

    Raises
    ------
    Mismatch
        What Bullet reports back differs from what was asked for.
    """
    block, start = scene.block, scene.start
    many = iterations(scene, 2)
    rough = math.sqrt(FRICTION if scene.friction is None else min(scene.friction, MOST_FRICTION))  # of each body
    inertia = block.centre_inertia
    pybullet.setPhysicsEngineParameter(
        fixedTimeStep=step,
        numSubSteps=0,
        contactSlop=0.0,
        contactBreakingThreshold=BREAKING_THRESHOLD,
        numSolverIterations=many,
        physicsClientId=client,
    )
    pybullet.setGravity(0.0, 0.0, -scene.gravity, client)
    corners, plane = _shapes(client, block)
    sliding, turning = pybullet.JOINT_PRISMATIC, pybullet.JOINT_REVOLUTE
    # link: mass, shape, position, joint, axis, parent
    links = [
        (0.0, -1, [0, 0, block.half_height], sliding, [1, 0, 0], 0),
        (0.0, -1, [0, 0, 0], sliding, [0, 0, 1], 1),
        (block.mass, corners, [0, 0, 0], turning, [0, 1, 0], 2),
    ]
    ground = base = None
    if scene.base is None:
        ground = pybullet.createMultiBody(0, plane, physicsClientId=client)
        pybullet.changeDynamics(ground, -1, lateralFriction=rough, restitution=0.0, physicsClientId=client)
    else:
        base = 3
        links.append((scene.base.mass, plane, [0, 0, 0], sliding, [1, 0, 0], 0))
    body = chain(client, links, flags=pybullet.URDF_USE_SELF_COLLISION)
    for link in range(-1, len(links)):
        without_losses(client, body, link, rough, maxJointVelocity=MOST_VELOCITY)
    # Inertia without mass in the same call can set the mass to 0 and give NaN in the first step.
    pybullet.changeDynamics(body, 2, mass=block.mass, localInertiaDiagonal=[inertia] * 3, physicsClientId=client)
    x, z, vx, vz = placement(scene)
    for joint, value, rate in ((0, x, vx), (1, z, vz), (2, start.tilt, start.tilt_rate)):
        pybullet.resetJointState(body, joint, value, rate, physicsClientId=client)
    if base is not None:
        pybullet.resetJointState(body, base, start.base_displacement, start.base_velocity, physicsClientId=client)
    assembly = Assembly(client, body, ground, 0, 1, 2, base)
    check_readback(assembly, scene, step, many, rough)
    return assembly


def _shapes(client, block):
    """Two corners for the block's link, and a plane for what it stands on."""
    b, h, r = block.half_width, block.half_height, CORNER_RADIUS * block.radius
    corners = pybullet.createCollisionShapeArray(
        shapeTypes=[pybullet.GEOM_SPHERE] * 2,
        radii=[r] * 2,
        collisionFramePositions=[[-b, 0, r - h], [b, 0, r - h]],
        physicsClientId=client,
    )
    plane = pybullet.createCollisionShape(pybullet.GEOM_PLANE, planeNormal=[0, 0, 1], physicsClientId=client)
    return corners, plane


def check_readback(assembly: Assembly, scene: Scene, step: float, many: int, rough: float) -> None:
    """Compare what Bullet reports with what the scene needs; raises `Mismatch` naming what differs.

    contactSlop and contactBreakingThreshold have no getter in Bullet.
    """
    client, body, values = assembly.client, assembly.body, []

    def expect(*value):
        values.append(value)

    engine = pybullet.getPhysicsEngineParameters(client)
    expect("time step", engine["fixedTimeStep"], step)
    expect("substeps", engine["numSubSteps"], 0)
    expect("solver iterations", engine["numSolverIterations"], many)
    expect("gravity", engine["gravityAccelerationZ"], -scene.gravity)
    expect("joints", pybullet.getNumJoints(body, client), 3 if assembly.base is None else 4)
    parts = [("block", body, assembly.tilt, scene.block.mass)]
    if assembly.base is None:
        parts.append(("ground", assembly.ground, -1, 0.0))
    else:
        parts.append(("base", body, assembly.base, scene.base.mass))
    parts += [("x link", body, assembly.slide, 0.0), ("z link", body, assembly.lift, 0.0)]
    for name, owner, link, mass in parts:
        info = pybullet.getDynamicsInfo(owner, link, client)
        expect(f"{name}: mass", info[0], mass)
        expect(f"{name}: friction", info[1], rough)
        expect(f"{name}: restitution", info[5], 0.0)
        if name == "block":
            expect("block: inertia", info[2][1], scene.block.centre_inertia)
    types = (pybullet.JOINT_PRISMATIC, pybullet.JOINT_PRISMATIC, pybullet.JOINT_REVOLUTE, pybullet.JOINT_PRISMATIC)
    for joint in range(pybullet.getNumJoints(body, client)):
        info = pybullet.getJointInfo(body, joint, client)
        expect(f"joint {joint}: type", info[2], types[joint])
        expect(f"joint {joint}: damping", info[6], 0.0)
        expect(f"joint {joint}: friction", info[7], 0.0)
    x, z, vx, vz = placement(scene)
    start = scene.start
    states = [(x, vx), (z, vz), (start.tilt, start.tilt_rate), (start.base_displacement, start.base_velocity)]
    for joint in range(pybullet.getNumJoints(body, client)):
        value, rate, *_ = pybullet.getJointState(body, joint, client)
        expect(f"joint {joint}: position", value, states[joint][0])
        expect(f"joint {joint}: velocity", rate, states[joint][1])
    require(values)


class BulletBodies:
    """The planar chain of an `Assembly`, its units SI outside.

    Few iterations do while one corner may carry, more while both may: where the higher one is within what its speed or
    free fall cover in the step.
    """

    def __init__(self, client: int, scene: Scene, largest: float) -> None:
        """In a fresh client; largest: longest step [s]."""
        self.units = Units.of(scene)
        assembly = assemble(client, self.units.scale(scene), largest / self.units.time)
        self.client, self.body, self.base = assembly.client, assembly.body, assembly.base
        self.joints = (0, 1, 2) if assembly.base is None else (0, 1, 2, 3)
        self.mass, self.loaded = scene.base.mass if scene.base else 0.0, scene.bearings is not None
        self.sweeps = iterations(scene, 1), iterations(scene, 2)
        self.fall = scene.gravity / (4 * scene.block.half_width)
        self.tilt, self.rate = scene.start.tilt, scene.start.tilt_rate
        self.used, self.gravity = (0.0, 0), (0.0, 0.0)

    def step(self, step: float, before: float, across: float, up: float, impulse: float) -> State:
        """A step: see `engines.stepping.Bodies`."""
        client, length, time = self.client, self.units.length, self.units.time
        used = step, self.sweeps[abs(self.tilt) < step * (self.fall * step + abs(self.rate))]
        if used != self.used:
            self.used = used
            pybullet.setPhysicsEngineParameter(
                fixedTimeStep=step / time, numSolverIterations=used[1], physicsClientId=client
            )
        gravity = across / step, up / step
        if gravity != self.gravity:
            self.gravity = gravity
            pybullet.setGravity(gravity[0], 0.0, gravity[1], client)
        if self.loaded:  # a force on the base's link is the same as one on its joint, and the call costs half as much
            force = impulse / step, 0.0, 0.0
            pybullet.applyExternalForce(self.body, self.base, force, (0.0, 0.0, 0.0), pybullet.LINK_FRAME, client)
        pybullet.stepSimulation(client)
        (x, vx, _, _), (z, vz, _, _), (tilt, rate, _, _), *base = pybullet.getJointStates(
            self.body, self.joints, client
        )
        rate, speed = rate / time, length / time
        self.tilt, self.rate = tilt, rate
        b, v = base[0][:2] if base else (0.0, 0.0)
        return tilt, rate, length * x, length * z, speed * vx, speed * vz, length * b, speed * v

    def weigh(self, added: float) -> None:
        """Give the base more mass."""
        pybullet.changeDynamics(self.body, self.base, mass=self.mass + added, physicsClientId=self.client)
