"""DART's variants: its boxed LCP solver computes contact and impact, in double precision. Tested with dartpy 6.20.0.

The scene is built as a user of DART would write it: a free 3-D box on the ground, or on a slab on a prismatic joint.
Collision detection is DART's default, FCL. A first script keeps all other defaults, too. The tuned variant corrects
penetrations by split impulses, which add no velocity (ConstraintSolver.setSplitImpulseEnabled), and sets a friction
that prevents sliding where the scene gives none.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import dartpy
import numpy as np

from ..contract import Run, Variant
from ..loads import placement
from ..loop import RULED, SAMPLED, FirstScript, ImpactAware, State, raw_trace_of, require, run_of

if TYPE_CHECKING:
    from analytic import Scene

FRICTION, FIRST_FRICTION = 5.0, 1.0  # where the scene gives none; the second is DART's own
WIDTH, THICKNESS = 2e3, 2.0  # of the ground, over R


class DartBodies:
    """DART's world with the skeletons of block and ground in the initial state.

    Raises
    ------
    Mismatch
        DART reports other values than it was given.
    """

    def __init__(self, scene: Scene, plain: bool) -> None:
        dynamics, block, R, start = dartpy.dynamics, scene.block, scene.block.radius, scene.start
        self.mass, self.loaded = scene.base_mass, scene.bearings is not None
        if scene.friction is not None:
            friction = scene.friction
        else:
            friction = FIRST_FRICTION if plain else FRICTION
        self.half_height, self.used, self.gravity = block.half_height, 0.0, (0.0, 0.0, 0.0)
        self.world = dartpy.simulation.World()
        self.world.setGravity(self.gravity)
        self.world.getConstraintSolver().setSplitImpulseEnabled(not plain)
        self.ground = dynamics.Skeleton("ground")
        if scene.base is None:
            _, self.slab = self.ground.createWeldJointAndBodyNodePair()
        else:
            joint, self.slab = self.ground.createPrismaticJointAndBodyNodePair()
            joint.setAxis([1.0, 0.0, 0.0])
            self.slab.setInertia(dynamics.Inertia(self.mass, [0.0, 0.0, 0.0], np.eye(3) * self.mass * R**2))
            self.ground.setPositions([start.base_displacement])
            self.ground.setVelocities([start.base_velocity])
        size = [WIDTH * R, WIDTH * R, THICKNESS * R]
        _touch(self.slab, size, [0.0, 0.0, -0.5 * THICKNESS * R], friction)
        self.block = dynamics.Skeleton("block")
        joint, self.body = self.block.createFreeJointAndBodyNodePair()
        self.body.setInertia(dynamics.Inertia(block.mass, [0.0, 0.0, 0.0], np.eye(3) * block.centre_inertia))
        _touch(self.body, [2 * block.half_width] * 2 + [2 * block.half_height], [0.0, 0.0, 0.0], friction)
        x, z, vx, vz = placement(scene)
        # The positions of a free joint are a rotation vector and a translation. Its velocities are set by dedicated
        # functions, which take them along the world's axes.
        self.block.setPositions([0.0, start.tilt, 0.0, x, 0.0, z + block.half_height])
        joint.setLinearVelocity([vx, 0.0, vz])
        joint.setAngularVelocity([0.0, start.tilt_rate, 0.0])
        for skeleton in (self.ground, self.block):
            self.world.addSkeleton(skeleton)
        self._check(scene, plain, friction)

    def step(self, step: float, before: float, across: float, up: float, impulse: float) -> State:
        """A step: see `engines.loop.Bodies`."""
        world = self.world
        if step != self.used:
            world.setTimeStep(step)
            self.used = step
        gravity = across / step, 0.0, up / step
        if gravity != self.gravity:
            world.setGravity(gravity)
            self.gravity = gravity
        if self.loaded:
            self.ground.setForces((impulse / step,))
        world.step()
        base, v = (self.ground.getPosition(0), self.ground.getVelocity(0)) if self.mass else (0.0, 0.0)
        _, tilt, _, x, _, z = self.block.getPositions().tolist()
        _, rate, _, vx, _, vz = self.block.getVelocities().tolist()
        return tilt, rate, x, z - self.half_height, vx, vz, base, v

    def weigh(self, added: float) -> None:
        """See `engines.loop.Bodies`."""
        self.slab.setMass(self.mass + added)

    def _check(self, scene: Scene, plain: bool, friction: float) -> None:
        """Compare what DART reports with what the scene needs; raises `Mismatch` naming what differs."""
        x, z, vx, vz = placement(scene)
        expected = [
            ("split impulses", self.world.getConstraintSolver().isSplitImpulseEnabled(), not plain),
            ("block: mass", self.body.getMass(), scene.block.mass),
            ("block: inertia", self.body.getInertia().getMoment()[1][1], scene.block.centre_inertia),
            ("block: position", self.body.getCOM(), [x, 0.0, z + scene.block.half_height]),
            ("block: velocity", self.body.getCOMLinearVelocity(), [vx, 0.0, vz]),
            ("block: tilt rate", self.body.getAngularVelocity(), [0.0, scene.start.tilt_rate, 0.0]),
        ]
        for body in (self.body, self.slab):
            aspect = body.getShapeNode(0).getDynamicsAspect()
            expected += [
                ("friction", aspect.getFrictionCoeff(), friction),
                ("restitution", aspect.getRestitutionCoeff(), 0.0),
            ]
        if scene.base is not None:
            expected += [
                ("base: mass", self.slab.getMass(), scene.base_mass),
                ("base: position", self.ground.getPositions(), [scene.start.base_displacement]),
                ("base: velocity", self.ground.getVelocities(), [scene.start.base_velocity]),
            ]
        require(expected)


def _touch(body: dartpy.dynamics.BodyNode, size: list[float], place: list[float], friction: float) -> None:
    """Add a box with contact to a body."""
    node = body.createShapeNode(dartpy.dynamics.BoxShape(size))
    node.createCollisionAspect()
    node.createDynamicsAspect()
    node.setRelativeTranslation(place)
    node.getDynamicsAspect().setFrictionCoeff(friction)


VARIANTS = {
    "impact-aware": Variant(
        ImpactAware(),
        kind="tuned",
        levels=(2e-3, 6e-4, 2e-4, 1e-4),
        computes="motion, contact, impact and rest",
        imposes=RULED,
    ),
    "first-script": Variant(
        FirstScript(1e-3),  # DART's own default
        kind="defaults",
        levels=(5e-3, 1e-3, 2e-4),
        computes="motion, contact, impact and rest",
        imposes=SAMPLED,
    ),
}

# Tilt rate, in gamma per second, whose tilt in one step is the flat contact of a first script: contact acts in the step
# after a corner has penetrated, which is passed in one or two steps.
PASSING = 10.0


def versions() -> dict[str, str]:
    """Versions of the packages that compute: {package: version}."""
    return {"dartpy": dartpy.__version__}


def run(scene: Scene, variant: str, settings: ImpactAware | FirstScript) -> Run:
    """The `Run` of a scene."""
    plain = isinstance(settings, FirstScript)
    return run_of(
        scene,
        settings,
        lambda step: DartBodies(scene, plain),
        lambda rows: raw_trace_of(rows, scene, PASSING * rows[1, 1] * scene.block.slenderness),
    )
