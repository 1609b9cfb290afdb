"""A scene built in Bullet, and read back to check the values that Bullet uses.

The pitfalls named in the comments were observed with PyBullet 3.2.7.
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

# Coefficient of friction of the block where the scene gives none: it prevents sliding. Bullet multiplies the frictions
# of two bodies and limits the product to 10 without a message.
MOST_FRICTION = 10.0
FRICTION = MOST_FRICTION

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

MOST_VELOCITY = 1e9  # m/s and rad/s: Bullet's limit for joints; its default is 100


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
    """Bullet's units of length [m] and time [s]; acceleration, mass and force are in SI units.

    Bullet has thresholds in metres, and step lengths scale with sqrt(R/g). A block of .5 to 2 m is not scaled; other
    blocks are scaled to that size, by powers of 4, so that nothing is rounded.
    """

    length: float
    time: float

    @classmethod
    def of(cls, scene: Scene) -> Self:
        power = round(math.log(scene.block.radius, 4))
        return cls(4.0**power, 2.0**power)

    def scale(self, scene: Scene) -> Scene:
        """The scene in these units, except its motion and bearings, which stay in SI."""
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
    """Iterations of the contact solver to a residual of ROCKING_REST (one corner) or STANDING_REST (two).

    Sequential impulses are the Gauss-Seidel method, normal impulses first. Its convergence rate is an eigenvalue, near
    1 for J_O near m R^2, and 1 - 3 tan^2 gamma for slender blocks on two corners. The forces on a light base are shared
    by friction, which takes more iterations.
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


def assemble(client: int, scene: Scene, step: float) -> Assembly:
    """Build the planar chain of a scene, in Bullet's `Units`, in a fresh client.

    The block is on massless x-prismatic, z-prismatic and y-revolute joints, and has two contact corners. The base is a
    plane on an x-prismatic joint of the same multibody, so that one call reads both; rigid ground is a fixed plane.

    Raises
    ------
    Mismatch
        Bullet reports other values than it was given.
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
    # Setting the inertia without the mass in the same call can set the mass to 0, with NaN in the first step.
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
    """Two corners for the block's link, and a plane for its support."""
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
    """The planar chain of an `Assembly`, with an interface in SI units.

    Few iterations suffice while only one corner may be loaded. More are used while both may be: where the higher one
    can reach contact within the step by its velocity or by free fall.
    """

    def __init__(self, client: int, scene: Scene, largest: float) -> None:
        """client: a fresh one; largest: longest step [s]."""
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
        if self.loaded:  # a force on the link equals one on its joint, and takes half the time
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

    def twist(self, moment: float) -> None:
        """See `engines.stepping.Bodies`; Bullet forgets it after the step."""
        axis = 0.0, moment / self.units.length, 0.0
        pybullet.applyExternalTorque(self.body, self.joints[2], axis, pybullet.LINK_FRAME, self.client)

    def weigh(self, added: float) -> None:
        """See `engines.stepping.Bodies`."""
        pybullet.changeDynamics(self.body, self.base, mass=self.mass + added, physicsClientId=self.client)
