"""A scene built from Bullet's parts, and read back to see what Bullet really uses.

All traps named here were met with PyBullet 3.2.7; see the comments.
"""

import math
from dataclasses import dataclass

import pybullet

# Lateral frictions of two bodies multiply; 5 x 5 stands for the model's "no sliding".
FRICTION = 5.0

# Gap [m] below which Bullet keeps contact points. Process-global, leaks from client to client and is not returned
# by the getter: set in every client. Bullet's default is 0.02.
BREAKING_THRESHOLD = 1e-3

# Contact error reduction per second: penetration decays at this rate whatever the step. A fixed share of .08 per step
# left the base velocity jump 2 to 5 % off at every step.
CORRECTION_RATE, MOST_CORRECTION = 30.0, 0.1


# The block touches by a sphere at each bottom corner, radius in shares of R (1e-9 gives the same e to 1e-6). A box
# shows Bullet only its lowest corners: on a box it lost weak impacts (e off by .3), on a plane it did not stand still
# (tilt 8e-6 of gamma at rest at 1 ms, slenderness .45; the spheres 8e-11).
CORNER_RADIUS = 1e-6

# Sequential impulses per step. Around one corner 10 are enough: e is the same with 1000. Standing on two corners they
# converge the slower the more slender the block, as exp(-3 n tan^2 gamma); too few let a standing block rock (10: at
# 9e-5 of gamma under shaking of .9 of the uplift threshold, gamma .1; 250: 3e-8). The direct solver (Dantzig) stands
# too, but its friction is wrong on two corners: under a horizontal load the block and its base part. The default
# solverResidualThreshold does not end the iterations early.
ROCKING_ITERATIONS, STANDING_ITERATIONS, MOST_ITERATIONS = 10, 3.0, 600


MOST_VELOCITY = 1e9  # m/s and rad/s, above which Bullet would cut a joint's; its default is 100


class Mismatch(RuntimeError):
    """Bullet does not use what it was given."""


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


def correction(step):
    """contactERP for a step [s]."""
    return min(MOST_CORRECTION, CORRECTION_RATE * step)


def placement(scene):
    """Centre of the block and its velocity at the start: (x, z [m], x', z' [m/s]), z from its standing height."""
    start, block = scene.start, scene.block
    s = math.copysign(1.0, start.tilt or start.tilt_rate)
    angle = s * block.slenderness - start.tilt
    c, n = block.radius * math.cos(angle), block.radius * math.sin(angle)
    return (start.base_displacement + s * block.half_width - n, c - block.half_height,
            start.base_velocity + c * start.tilt_rate, n * start.tilt_rate)


def standing_iterations(scene):
    """Iterations of the contact solver that a standing block needs."""
    needed = math.ceil(STANDING_ITERATIONS / math.tan(scene.block.slenderness) ** 2)
    return min(max(needed, 2 * ROCKING_ITERATIONS), MOST_ITERATIONS)


def assemble(client, scene, step):
    """Build the planar chain of a scene in a fresh client.

    The block, on x-prismatic, z-prismatic and y-revolute joints without mass, touches with two corners. The base is
    a plane on an x-prismatic joint of the same multibody (one call then reads both), or a fixed plane for rigid
    ground.

    Raises
    ------
    Mismatch
        What Bullet reports back differs from what was asked for.
    """
    block, start = scene.block, scene.start
    iterations = standing_iterations(scene)
    b, h, inertia = block.half_width, block.half_height, block.centre_inertia
    pybullet.setPhysicsEngineParameter(
        fixedTimeStep=step, numSubSteps=0, contactSlop=0.0, contactERP=correction(step),
        contactBreakingThreshold=BREAKING_THRESHOLD, numSolverIterations=iterations,
        physicsClientId=client)
    pybullet.setGravity(0.0, 0.0, -scene.gravity, client)
    r = CORNER_RADIUS * block.radius
    corners = pybullet.createCollisionShapeArray(
        shapeTypes=[pybullet.GEOM_SPHERE] * 2, radii=[r] * 2,
        collisionFramePositions=[[-b, 0, r - h], [b, 0, r - h]], physicsClientId=client)
    plane = pybullet.createCollisionShape(pybullet.GEOM_PLANE, planeNormal=[0, 0, 1], physicsClientId=client)
    sliding, turning = pybullet.JOINT_PRISMATIC, pybullet.JOINT_REVOLUTE
    # link: mass, shape, position, joint, axis, parent
    links = [(0.0, -1, [0, 0, h], sliding, [1, 0, 0], 0), (0.0, -1, [0, 0, 0], sliding, [0, 0, 1], 1),
             (block.mass, corners, [0, 0, 0], turning, [0, 1, 0], 2)]
    ground = base = None
    if scene.base is None:
        ground = pybullet.createMultiBody(0, plane, physicsClientId=client)
        pybullet.changeDynamics(ground, -1, lateralFriction=FRICTION, restitution=0.0, physicsClientId=client)
    else:
        base = 3
        links.append((scene.base.mass, plane, [0, 0, 0], sliding, [1, 0, 0], 0))
    masses, shapes, positions, joints, axes, parents = (list(column) for column in zip(*links, strict=True))
    count = len(links)
    body = pybullet.createMultiBody(
        0, -1, -1, [0, 0, 0], linkMasses=masses, linkCollisionShapeIndices=shapes,
        linkVisualShapeIndices=[-1] * count, linkPositions=positions, linkOrientations=[[0, 0, 0, 1]] * count,
        linkInertialFramePositions=[[0, 0, 0]] * count, linkInertialFrameOrientations=[[0, 0, 0, 1]] * count,
        linkParentIndices=parents, linkJointTypes=joints, linkJointAxis=axes,
        flags=pybullet.URDF_USE_SELF_COLLISION, physicsClientId=client)
    for link in range(-1, count):
        # Damping and velocity limits in a call force its linkIndex to -1: friction goes in a call of its own.
        pybullet.changeDynamics(body, link, linearDamping=0.0, angularDamping=0.0, maxJointVelocity=MOST_VELOCITY,
                                physicsClientId=client)
        pybullet.changeDynamics(body, link, lateralFriction=FRICTION, rollingFriction=0.0, spinningFriction=0.0,
                                restitution=0.0, jointDamping=0.0, physicsClientId=client)
        if link >= 0:  # joints come with a motor of 1 N s per step
            pybullet.setJointMotorControl2(body, link, pybullet.VELOCITY_CONTROL, force=0.0, physicsClientId=client)
    # Inertia without mass in the same call can set the mass to 0 and give NaN in the first step.
    pybullet.changeDynamics(body, 2, mass=block.mass, localInertiaDiagonal=[inertia] * 3, physicsClientId=client)
    x, z, vx, vz = placement(scene)
    for joint, value, rate in ((0, x, vx), (1, z, vz), (2, start.tilt, start.tilt_rate)):
        pybullet.resetJointState(body, joint, value, rate, physicsClientId=client)
    if base is not None:
        pybullet.resetJointState(body, base, start.base_displacement, start.base_velocity, physicsClientId=client)
    assembly = Assembly(client, body, ground, 0, 1, 2, base)
    check_readback(assembly, scene, step, iterations)
    return assembly


def check_readback(assembly, scene, step, iterations):
    """Compare what Bullet reports with what the scene needs; raises `Mismatch` naming what differs.

    contactERP, contactSlop and contactBreakingThreshold have no getter in Bullet.
    """
    client, body = assembly.client, assembly.body
    used, wanted = {}, {}

    def expect(name, is_used, is_wanted):
        used[name], wanted[name] = is_used, is_wanted

    engine = pybullet.getPhysicsEngineParameters(client)
    expect("time step", engine["fixedTimeStep"], step)
    expect("substeps", engine["numSubSteps"], 0)
    expect("solver iterations", engine["numSolverIterations"], iterations)
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
        expect(f"{name}: friction", info[1], FRICTION)
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
    wrong = [f"{name} is {used[name]!r}, not {wanted[name]!r}" for name in wanted
             if not math.isclose(used[name], wanted[name], rel_tol=1e-12, abs_tol=1e-15)]
    if wrong:
        raise Mismatch("; ".join(wrong))
