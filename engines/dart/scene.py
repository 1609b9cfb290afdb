"""The scene as skeletons of DART: the block on a planar joint (z, x, tilt), the base on a prismatic one."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import dartpy
import numpy as np

from ..pivoting import depth
from ..placement import placement
from ..readback import require

if TYPE_CHECKING:
    from analytic import Scene

FRICTION = 5.0  # stands for the model's "no sliding", where the scene gives none; of two shapes DART takes the smaller
CORNER_RADIUS = 1e-6  # share of R: the block touches by a sphere at each bottom corner
WIDTH, THICKNESS = 2e3, 2.0  # of the ground, shares of R
# The second solver is Gauss and Seidel's; with c of 2.9, measured, exp(-c gamma^2) of an error is left by an iteration.
SWEEPS, LEAST_CHANGE, LEAST_DIVISOR = 5.0, 1e-12, 1e-15


@dataclass(frozen=True)
class Assembly:
    """DART's world, the skeletons of block and ground, and the body that is the base (None: rigid ground)."""

    world: dartpy.simulation.World
    block: dartpy.dynamics.Skeleton
    ground: dartpy.dynamics.Skeleton
    base: dartpy.dynamics.BodyNode | None


def add_shape(body: dartpy.dynamics.BodyNode, shape: object, place: list[float], friction: float | None) -> None:
    """Give a body a shape that touches; friction None: DART's own."""
    node = body.createShapeNode(shape)
    node.createCollisionAspect()
    node.createDynamicsAspect()
    node.setRelativeTranslation(place)
    if friction is not None:
        node.getDynamicsAspect().setFrictionCoeff(friction)


def add_ground(world: dartpy.simulation.World, scene: Scene, friction: float | None) -> Assembly:
    """The ground of a scene, its top at z = 0, in a world that has no block yet."""
    dynamics, R = dartpy.dynamics, scene.block.radius
    ground, base = dynamics.Skeleton("ground"), None
    if scene.base is None:
        _, body = ground.createWeldJointAndBodyNodePair()
    else:
        joint, body = ground.createPrismaticJointAndBodyNodePair()
        joint.setAxis([1.0, 0.0, 0.0])
        body.setInertia(dynamics.Inertia(scene.base.mass, [0.0, 0.0, 0.0], np.eye(3) * scene.base.mass * R**2))
        base = body
        ground.setPositions([scene.start.base_displacement])
        ground.setVelocities([scene.start.base_velocity])
    slab = dynamics.BoxShape([WIDTH * R, WIDTH * R, THICKNESS * R])
    add_shape(body, slab, [0.0, 0.0, -0.5 * THICKNESS * R], friction)
    world.addSkeleton(ground)
    return Assembly(world, dynamics.Skeleton("block"), ground, base)


def build(scene: Scene) -> Assembly:
    """The `Assembly` of a scene at its start. Gravity and all loads are given as forces: the world has none.

    Raises
    ------
    Mismatch
        DART reports other values than it was given.
    """
    block, dynamics = scene.block, dartpy.dynamics
    friction = FRICTION if scene.friction is None else scene.friction
    world = dartpy.simulation.World()
    world.setGravity([0.0, 0.0, 0.0])
    world.setCollisionDetector(dartpy.collision.DARTCollisionDetector())
    world.getConstraintSolver().setSplitImpulseEnabled(True)  # what has sunk is taken back without a speed
    _solve_standing(world, block.slenderness)
    assembly = add_ground(world, scene, friction)
    skeleton = assembly.block
    joint, body = skeleton.createPlanarJointAndBodyNodePair()
    joint.setZXPlane()
    body.setInertia(dynamics.Inertia(block.mass, [0.0, 0.0, 0.0], np.eye(3) * block.centre_inertia))
    r = CORNER_RADIUS * block.radius
    for x in (-block.half_width, block.half_width):
        add_shape(body, dynamics.SphereShape(r), [x, 0.0, r - block.half_height], friction)
    x, z, vx, vz = placement(scene)
    skeleton.setPositions([z + block.half_height - depth(scene), x, scene.start.tilt])
    skeleton.setVelocities([vz, vx, scene.start.tilt_rate])
    world.addSkeleton(skeleton)
    check_readback(assembly, scene, friction)
    return assembly


def _solve_standing(world, slenderness):
    """Give DART's second solver what it needs for a block on two corners, where its first, Dantzig's, finds no answer.

    Two corners share one friction. With the 30 iterations of the default a slender block that nobody pushes is turned
    over one of them at up to .03 g/R.
    """
    count = math.ceil(SWEEPS / slenderness**2)
    option = dartpy.constraint.PgsBoxedLcpSolverOption(count, LEAST_CHANGE, LEAST_CHANGE, LEAST_DIVISOR, False)
    world.getConstraintSolver().getSecondaryBoxedLcpSolver().setOption(option)


def check_readback(assembly: Assembly, scene: Scene, friction: float) -> None:
    """Compare what DART reports with what the scene needs; raises `Mismatch` naming what differs."""
    body, solver = assembly.block.getBodyNode(0), assembly.world.getConstraintSolver()
    x, z, vx, vz = placement(scene)
    height = z + scene.block.half_height - depth(scene)
    expected = [
        ("gravity", assembly.world.getGravity(), 0.0),
        ("split impulses", solver.isSplitImpulseEnabled(), True),
        ("block: mass", body.getMass(), scene.block.mass),
        ("block: inertia", body.getInertia().getMoment()[1][1], scene.block.centre_inertia),
        ("block: position", assembly.block.getPositions(), [height, x, scene.start.tilt]),
        ("block: velocity", assembly.block.getVelocities(), [vz, vx, scene.start.tilt_rate]),
    ]
    for dof in range(3):
        joint = assembly.block.getJoint(0)
        expected += [
            (f"joint {dof}: damping", joint.getDampingCoefficient(dof), 0.0),
            (f"joint {dof}: friction", joint.getCoulombFriction(dof), 0.0),
            (f"joint {dof}: stiffness", joint.getSpringStiffness(dof), 0.0),
        ]
    for owner in (body, assembly.ground.getBodyNode(0)):
        for k in range(owner.getNumShapeNodes()):
            aspect = owner.getShapeNode(k).getDynamicsAspect()
            expected += [
                ("friction", aspect.getFrictionCoeff(), friction),
                ("restitution", aspect.getRestitutionCoeff(), 0.0),
            ]
    if assembly.base is not None:
        expected += [
            ("base: mass", assembly.base.getMass(), scene.base.mass),
            ("base: position", assembly.ground.getPositions(), [scene.start.base_displacement]),
            ("base: velocity", assembly.ground.getVelocities(), [scene.start.base_velocity]),
        ]
    require(expected)
