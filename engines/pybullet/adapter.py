"""PyBullet's variants: Bullet computes contact and impact. Tested with PyBullet 3.2.7.

In order: joints without Bullet's default damping and motors; the scene of the tuned variants (`BulletBodies`), which is
read back to check the values that Bullet uses; the scene of a first script with the API's defaults (`FreeBox`);
Bullet's calls and the chosen numbers of each variant; the variants; the run.

The pitfalls named in the comments were observed with PyBullet 3.2.7.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from importlib.metadata import version
from typing import TYPE_CHECKING

import numpy as np  # before PyBullet, which would load it slowly

from analytic.response import Caution, Failure
from analytic.stack.equations import StackModel

from ..contract import Run, Variant
from ..guard import without
from ..loads import moving_mass, placements, slabs_of
from ..loop import CONSTANTS as STEPS
from ..loop import (
    GIVEN,
    GROWTH,
    MEAN_LOADS,
    NEAR,
    RULED,
    SAMPLED,
    SHARE,
    SLOW,
    SMALLEST_STEP,
    FirstScript,
    FixedStep,
    ImpactAware,
    Settings,
    raw_trace_of,
    require,
    run_of,
)

with without(b"pybullet build time"):
    import pybullet

__all__ = ["pybullet"]


def chain(client: int, links: list[tuple], fixed: int = -1, **options: int) -> int:
    """Create a multibody of links (mass, shape, position, joint, axis, parent); return its number.

    The links stand on a fixed body at the origin, of shape `fixed`, by default of none.
    """
    masses, shapes, positions, joints, axes, parents = (list(column) for column in zip(*links, strict=True))
    count = len(links)
    return pybullet.createMultiBody(
        0,
        fixed,
        linkMasses=masses,
        linkCollisionShapeIndices=shapes,
        linkVisualShapeIndices=[-1] * count,
        linkPositions=positions,
        linkOrientations=[[0, 0, 0, 1]] * count,
        linkInertialFramePositions=[[0, 0, 0]] * count,
        linkInertialFrameOrientations=[[0, 0, 0, 1]] * count,
        linkParentIndices=parents,
        linkJointTypes=joints,
        linkJointAxis=axes,
        physicsClientId=client,
        **options,
    )


def without_losses(client: int, body: int, links: int, friction: float, **limits: float) -> None:
    """Remove Bullet's damping of .04 1/s and motors of 1 N s per step from a body and its links; set their friction.

    A call that sets damping or velocity limits forces linkIndex to -1, so that friction is set in a separate call.
    """
    for link in range(-1, links):
        pybullet.changeDynamics(body, link, linearDamping=0.0, angularDamping=0.0, physicsClientId=client, **limits)
        pybullet.changeDynamics(body, link, lateralFriction=friction, physicsClientId=client)
    if links:
        motors = pybullet.VELOCITY_CONTROL
        pybullet.setJointMotorControlArray(body, range(links), motors, forces=[0.0] * links, physicsClientId=client)


if TYPE_CHECKING:
    from analytic import Scene

# Coefficient of friction of the block where the scene gives none: it prevents sliding. Bullet multiplies the frictions
# of two bodies and limits the product to 10 without a message.
FRICTION = 10.0

# contactERP, the share of a penetration that a step removes, is not set for one block, as its corners do not penetrate.
# With 0 to .9 per step e is the same to 2e-9 at every level. It matters for the contact of a box: with a fixed share of
# .08 per step the base velocity jump is off by 2 to 5 % at any step. It also matters where a block that falls from its
# pedestal lands on a corner anew: in a short step, a fixed share throws it up. Penetration decays at this rate [1/s].
CORRECTION_RATE, MOST_CORRECTION = 30.0, 0.1


def correction(step: float) -> float:
    """The contactERP of a step [s]."""
    return min(MOST_CORRECTION, CORRECTION_RATE * step)


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

TILT = 2  # of the links of a block: along x, along z, tilt
MOST_VELOCITY = 1e9  # m/s and rad/s: Bullet's limit for joints; its default is 100


def iterations(scene: Scene, corners: int) -> int:
    """Iterations of the contact solver to a residual of ROCKING_REST (one corner) or STANDING_REST (two).

    Sequential impulses are the Gauss-Seidel method, normal impulses first. Its convergence rate is an eigenvalue, near
    1 for J_O near m R^2, and 1 - 3 tan^2 gamma for slender blocks on two corners. The forces on a light base are shared
    by friction, which takes more iterations. A formula without the base takes a third more CPU time; 50 for all leave
    peak tilts off by up to 4e-4 and let a slender block rock that stands.
    """
    slabs, light = slabs_of(scene), moving_mass(scene) if scene.base else math.inf
    mobility = np.diag([*(1 / part for slab in slabs for part in (slab.mass, slab.mass, slab.inertia)), 1 / light])
    if scene.is_stack:
        rows = StackModel.of(scene).contacts((0.0, 0.0))[:, 2 - corners :].reshape(-1, len(mobility))
        directions = np.vstack([rows.imag, rows.real])
    else:
        b, h = scene.block.half_width, scene.block.half_height
        across = (b,) if corners == 1 else (-b, b)
        directions = np.array([[0, 1, -x, 0] for x in across] + [[1, 0, -h, -1] for _ in across])
    delassus = directions @ mobility @ directions.T
    lower = np.tril(delassus)
    rates = np.abs(np.linalg.eigvals(np.linalg.solve(lower, lower - delassus)))
    rate = rates[rates < 1 - 1e-9].max()  # 1: distribution of the friction between the corners, irrelevant
    rest = (ROCKING_REST, STANDING_REST)[corners - 1]
    needed = math.log(rest * min(1.0, light / scene.block.mass)) / math.log(rate) if rate > 0 else 1.0
    return min(max(math.ceil(needed), 1), MOST_ITERATIONS)


def _both(read: Sequence[Sequence[float]]) -> Sequence[float]:
    """The states of pedestal and block from those of the joints, see `engines.loop.Bodies`."""
    (x1, vx1, *_), (z1, vz1, *_), (first, w1, *_), _, (x, vx, *_), (z, vz, *_), (tilt, rate, *_), *base = read
    return first, w1, x1, z1, vx1, vz1, tilt, rate, x, z, vx, vz, *(base[0][:2] if base else (0.0, 0.0))


class BulletBodies:
    """The planar chain of a scene in a fresh client.

    The block is on massless x-prismatic, z-prismatic and y-revolute joints, and has two contact corners. So is a free
    pedestal, whose top is a plane: on a box, the corners would act only after penetration. The base is a plane on an
    x-prismatic joint of the same multibody, so that one call reads all; rigid ground is its fixed plane.

    Raises
    ------
    Mismatch
        Bullet reports other values than it was given.
    """

    def __init__(self, client: int, scene: Scene, pedestal_tilt: float = 0.0) -> None:
        base, start, slabs, r = scene.base, scene.start, slabs_of(scene), CORNER_RADIUS * scene.block.radius
        plane = pybullet.createCollisionShape(pybullet.GEOM_PLANE, physicsClientId=client)
        sliding, turning = pybullet.JOINT_PRISMATIC, pybullet.JOINT_REVOLUTE
        # link: mass, shape, position, joint, axis, parent
        links: list[tuple] = []
        states: list[tuple[float, float]] = []
        height, self.turning = 0.0, []
        for slab, places in zip(slabs, placements(scene, pedestal_tilt), strict=True):
            i = len(links)
            corners = pybullet.createCollisionShapeArray(
                [pybullet.GEOM_SPHERE] * 2,
                radii=[r] * 2,
                collisionFramePositions=[[x, 0, r - slab.h] for x in (-slab.b, slab.b)],
                physicsClientId=client,
            )
            links += [
                (0.0, -1, [0, 0, height + slab.h], sliding, [1, 0, 0], 0),
                (0.0, -1, [0, 0, 0], sliding, [0, 0, 1], i + 1),
                (slab.mass, corners, [0, 0, 0], turning, [0, 1, 0], i + 2),
            ]
            states += places
            self.turning.append(i + TILT)
            if slab is not slabs[-1]:  # the pedestal's top; Bullet numbers children next to their parents
                links.append((0.0, plane, [0, 0, slab.h], pybullet.JOINT_FIXED, [0, 0, 1], i + 3))
                states.append((0.0, 0.0))
            height += 2 * slab.h
        self.carrier = len(links)
        states.append((start.base_displacement, start.base_velocity))
        if base is not None:
            links.append((moving_mass(scene), plane, [0, 0, 0], sliding, [1, 0, 0], 0))
        flags = pybullet.URDF_USE_SELF_COLLISION
        body = chain(client, links, plane if base is None else -1, flags=flags)
        rough = math.sqrt(FRICTION if scene.friction is None else min(scene.friction, FRICTION))
        without_losses(client, body, len(links), rough, maxJointVelocity=MOST_VELOCITY)
        # About the centre. Setting it without the mass in the same call can set the mass to 0, with NaN in the first
        # step.
        for link, slab in zip(self.turning, slabs, strict=True):
            pybullet.changeDynamics(
                body, link, mass=slab.mass, localInertiaDiagonal=[slab.inertia] * 3, physicsClientId=client
            )
        self.client, self.body, self.joints = client, body, range(len(links))
        for joint in self.joints:
            pybullet.resetJointState(body, joint, *states[joint], physicsClientId=client)
        self.mass, self.loaded, self.two = moving_mass(scene), scene.bearings is not None, scene.is_stack
        self.sweeps = iterations(scene, 1), iterations(scene, 2)
        self.fall = scene.gravity / (4 * scene.block.half_width)
        self.tilt, self.rate, self.used = start.tilt, start.tilt_rate, (0.0, 0)
        self._check(scene, rough, links, states)

    def _check(self, scene: Scene, rough: float, links: list[tuple], states: list[tuple[float, float]]) -> None:
        """Compare what Bullet reports with what the scene needs; raises `Mismatch` naming what differs."""
        dynamics = [pybullet.getDynamicsInfo(self.body, link, self.client) for link in (-1, *self.joints)]
        joints = [pybullet.getJointInfo(self.body, joint, self.client) for joint in self.joints]
        moved = pybullet.getJointStates(self.body, self.joints, self.client)
        require(
            [
                ("masses", [row[0] for row in dynamics], [0.0, *(link[0] for link in links)]),
                ("friction", [row[1] for row in dynamics], rough),
                ("restitution", [row[5] for row in dynamics], 0.0),
                (
                    "block: inertia",
                    [dynamics[link + 1][2] for link in self.turning],
                    [[slab.inertia] * 3 for slab in slabs_of(scene)],
                ),
                ("joints: types", [row[2] for row in joints], [link[3] for link in links]),
                ("joints: damping and friction", [row[6:8] for row in joints], 0.0),
                ("start", [row[:2] for row in moved], states[: len(links)]),
            ]
        )

    def step(self, step: float, before: float, across: float, up: float, impulse: float) -> Sequence[float]:
        """A step: see `engines.loop.Bodies`.

        Few iterations suffice while only one corner may be loaded. More are used while both may be: where the higher
        one can reach contact within the step by its velocity or by free fall. Many in every step take up to six times
        the CPU time.
        """
        client = self.client
        sweeps = self.sweeps[self.two or abs(self.tilt) < step * (self.fall * step + abs(self.rate))]
        if (step, sweeps) != self.used:  # a call takes a tenth of a step's time
            self.used = step, sweeps
            pybullet.setPhysicsEngineParameter(
                fixedTimeStep=step, numSolverIterations=sweeps, contactSlop=0.0, physicsClientId=client
            )
            if self.two:
                pybullet.setPhysicsEngineParameter(contactERP=correction(step), physicsClientId=client)
        pybullet.setGravity(across / step, 0.0, up / step, client)
        if self.loaded:  # a force on the link equals one on its joint, and takes half the time
            force = impulse / step, 0.0, 0.0
            pybullet.applyExternalForce(self.body, self.carrier, force, (0.0, 0.0, 0.0), pybullet.LINK_FRAME, client)
        pybullet.stepSimulation(client)
        read = pybullet.getJointStates(self.body, self.joints, client)
        if self.two:
            return _both(read)
        (x, vx, _, _), (z, vz, _, _), (tilt, rate, _, _), *base = read
        self.tilt, self.rate = tilt, rate
        b, v = base[0][:2] if base else (0.0, 0.0)
        return tilt, rate, x, z, vx, vz, b, v

    def twist(self, moment: float) -> None:
        """See `engines.loop.Bodies`; Bullet forgets it after the step."""
        pybullet.applyExternalTorque(self.body, TILT, (0.0, moment, 0.0), pybullet.LINK_FRAME, self.client)

    def weigh(self, added: float) -> None:
        """See `engines.loop.Bodies`."""
        pybullet.changeDynamics(self.body, self.carrier, mass=self.mass + added, physicsClientId=self.client)


THICKNESS = 1.0  # m, of the slab
# Gap [m] below which Bullet keeps contact points: its own default. It is global to the process and not returned by the
# getter, so that it is set in every client.
BREAKING_THRESHOLD = 0.02
DEFAULT_MOST_VELOCITY = 100.0  # m/s and rad/s: Bullet's default limit of joints, applied without a message


class FreeBox:
    """A free 3-D box, or two on each other, on a slab, which is fixed or, where the scene has a base, on one joint."""

    def __init__(self, client: int, scene: Scene, step: float, pedestal_tilt: float = 0.0) -> None:
        block, slabs = scene.block, slabs_of(scene)
        pybullet.setTimeStep(step, client)
        pybullet.setPhysicsEngineParameter(contactBreakingThreshold=BREAKING_THRESHOLD, physicsClientId=client)
        pybullet.setGravity(0, 0, -scene.gravity, client)
        half = [20 * block.radius, 20 * block.radius, THICKNESS / 2]
        flat = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=half, physicsClientId=client)
        below = [0, 0, -THICKNESS / 2]
        if scene.base is None:
            ground = pybullet.createMultiBody(0, flat, -1, below, physicsClientId=client)
        else:
            ground = chain(client, [(moving_mass(scene), flat, below, pybullet.JOINT_PRISMATIC, [1, 0, 0], 0)])
            pybullet.resetJointState(
                ground, 0, scene.start.base_displacement, scene.start.base_velocity, physicsClientId=client
            )
        self.boxes: list[tuple[int, float]] = []
        height = 0.0
        for slab, ((x, vx), (z, vz), (tilt, rate)) in zip(slabs, placements(scene, pedestal_tilt), strict=True):
            half, height = [slab.b, slab.b, slab.h], height + slab.h
            box = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=half, physicsClientId=client)
            turn = pybullet.getQuaternionFromEuler([0, tilt, 0])
            body = pybullet.createMultiBody(slab.mass, box, -1, [x, 0, z + height], turn, physicsClientId=client)
            pybullet.resetBaseVelocity(body, [vx, 0, vz], [0, rate, 0], physicsClientId=client)
            self.boxes.append((body, height))
            height += slab.h
        if scene.friction is not None:  # Bullet multiplies the two
            pybullet.changeDynamics(body, -1, lateralFriction=math.sqrt(scene.friction), physicsClientId=client)
            pybullet.changeDynamics(
                ground,
                -1 if scene.base is None else 0,
                lateralFriction=math.sqrt(scene.friction),
                physicsClientId=client,
            )
        self.client, self.body, self.slab = client, body, ground
        self.on_base, self.loaded = scene.base is not None, scene.bearings is not None

    def step(self, step: float, before: float, across: float, up: float, impulse: float) -> Sequence[float]:
        """A step: see `engines.loop.Bodies`."""
        client, frame = self.client, pybullet.LINK_FRAME
        pybullet.setGravity(across / step, 0, up / step, client)
        if self.loaded:
            force = [impulse / step, 0, 0]
            pybullet.applyExternalForce(self.slab, 0, force, [0, 0, 0], frame, physicsClientId=client)
        pybullet.stepSimulation(client)
        state: list[float] = []
        for body, high in self.boxes:
            (x, _, z), turn = pybullet.getBasePositionAndOrientation(body, client)
            (vx, _, vz), (_, rate, _) = pybullet.getBaseVelocity(body, client)
            state += [2 * math.atan2(turn[1], turn[3]), rate, x, z - high, vx, vz]
        return *state, *(pybullet.getJointState(self.slab, 0, client)[:2] if self.on_base else (0.0, 0.0))

    def weigh(self, added: float) -> None:
        """Not needed in a first script."""


CHAIN = {
    f"r = {CORNER_RADIUS:g} * R": "m",
    "createCollisionShapeArray([GEOM_SPHERE] * 2, radii=[r] * 2, "
    "collisionFramePositions=[[-b, 0, r - h], [b, 0, r - h]])": "a sphere at each lower corner; a box misses impacts",
    "createCollisionShape(GEOM_PLANE)": "the top of the base, or the ground",
    "createMultiBody(0, -1, linkMasses=[0, 0, m, mb], linkPositions=[[0, 0, h], [0, 0, 0], [0, 0, 0], [0, 0, 0]], "
    "linkParentIndices=[0, 1, 2, 0], "
    "linkJointTypes=[JOINT_PRISMATIC, JOINT_PRISMATIC, JOINT_REVOLUTE, JOINT_PRISMATIC], "
    "linkJointAxis=[[1, 0, 0], [0, 0, 1], [0, 1, 0], [1, 0, 0]], flags=URDF_USE_SELF_COLLISION)": "links: x, z, tilt "
    "of the block, x of the base, in one body; without the flag the block falls through",
    f"changeDynamics(body, link, linearDamping=0, angularDamping=0, maxJointVelocity={MOST_VELOCITY:g})": "of link "
    "-1 to 3; by default .04 1/s, and 100 m/s at most",
    f"changeDynamics(body, link, lateralFriction=sqrt({FRICTION:g}))": "in a call of its own; Bullet multiplies two "
    f"bodies', and takes {FRICTION:g} at most; sqrt(mu) of a scene that gives mu",
    "setJointMotorControlArray(body, range(4), VELOCITY_CONTROL, forces=[0] * 4)": "by default each joint has a motor "
    "that brakes",
    "changeDynamics(body, 2, mass=m, localInertiaDiagonal=[J - m * R**2] * 3)": "about the centre; by default that of "
    "the spheres; the mass must stand in the same call",
    "resetJointState(body, link, value, rate)": "the start, of links 0 to 3",
}
EACH_STEP = {
    "setPhysicsEngineParameter(fixedTimeStep=step, numSolverIterations=sweeps, contactSlop=0)": "where they change; "
    f"sweeps: to a residual of {ROCKING_REST:g} on one corner, {STANDING_REST:g} where both may touch",
    "kick = (step + before) / (2 * step)": "velocities are half a step early: loads act from one to the next",
    "setGravity(-a * kick, 0, -g * kick)": "a: the ground's mean acceleration over that time",
    "applyExternalForce(body, 3, [-force * kick, 0, 0], [0, 0, 0], LINK_FRAME)": "of the bearings, for one step only",
    "stepSimulation()": "",
}


def impact_aware(settings: ImpactAware) -> dict[str, str]:
    """Bullet's calls in impact-aware, for `engines.contract.Variant.calls`."""
    largest, smallest = settings.largest_step, SMALLEST_STEP * (settings.largest_step / settings.balanced_step) ** 2
    return {
        **CHAIN,
        f"last = max(before, {smallest:g} * scale)": "s",
        f"most = min({1 + GROWTH:g} * last, {largest:g} * scale)": "s; shorter on stiff bearings",
        f"near = {NEAR:g} * g * last**2": "m",
        f"slow = {SLOW:g} * g * last": "m/s",
        f"landing = [{SHARE:g} * gap / closing for gap, closing in corners if gap > 0 < closing and (gap > near or "
        "closing > slow)]": "s, of corners on their way to a landing, by gap and closing speed of both",
        f"step = max(min([most] + landing), {smallest:g} * scale)": "before each call of stepSimulation",
        **EACH_STEP,
    }


def fixed_step(settings: FixedStep) -> dict[str, str]:
    """Bullet's calls in fixed-step."""
    return {**CHAIN, f"step = {settings.step:g} * scale": "s; the one before is 0 at the start", **EACH_STEP}


def first_script(settings: FirstScript) -> dict[str, str]:
    """Bullet's calls in first-script."""
    return {
        f"step = {settings.step:g}": "s",
        "setTimeStep(step)": "",
        f"setPhysicsEngineParameter(contactBreakingThreshold={BREAKING_THRESHOLD:g})": "the default",
        f"createCollisionShape(GEOM_BOX, halfExtents=[20 * R, 20 * R, {THICKNESS / 2:g}])": "of the base",
        f"createMultiBody(0, -1, linkMasses=[mb], linkPositions=[[0, 0, {-THICKNESS / 2:g}]], linkParentIndices=[0], "
        "linkJointTypes=[JOINT_PRISMATIC], linkJointAxis=[[1, 0, 0]])": "the base",
        "resetJointState(slab, 0, value, rate)": "its start",
        "createCollisionShape(GEOM_BOX, halfExtents=[b, b, h])": "of the block",
        "createMultiBody(m, box, -1, place, turn)": "the block, free",
        "resetBaseVelocity(body, speed, spin)": "its start",
        "setGravity(-a, 0, -g)": "a: the ground's acceleration where the step begins",
        "applyExternalForce(slab, 0, [-force, 0, 0], [0, 0, 0], LINK_FRAME)": "of the bearings, for one step only",
        "stepSimulation()": "",
    }


HERE = "engines.pybullet.adapter"
CONSTANTS = {
    **STEPS,
    f"{HERE}:FRICTION": "coefficient where the scene gives none",
    f"{HERE}:CORNER_RADIUS": "radius of the corners' spheres, over R",
    f"{HERE}:ROCKING_REST": "relative residual of the contact solver's impulses on one corner",
    f"{HERE}:STANDING_REST": "the same on two corners",
    f"{HERE}:MOST_ITERATIONS": "iterations of the contact solver, at most",
}


TUNED, FIXED = ImpactAware(1e-3, 1e-3), FixedStep(1e-4)
PLAIN = FirstScript(1 / 240)  # Bullet's own default
# Bullet holds the corner by velocities, with the lever (n, -c) of the centre where a step begins: the corner creeps by
# h^2 n phi'^2/2 in a step h. And a slip that turns back within a step keeps one sign of its friction N mu to the end,
# which leaves a velocity of up to 2 N mu h/m. Among 525 drawn scenes with vertical motion that slip by 1e-4 R or more,
# the largest slip is off by 1e-5 in the median, by 3.4 % at most; by half of that with half the step.
CREEPS = (
    "the corner of a rocking block creeps by some 1e-5 R in a swing, and a slip turns back at the end of a step: first "
    "order in the step; a slip below .002 R is up to 4 % off"
)
VARIANTS = {
    "impact-aware": Variant(
        TUNED,
        kind="tuned",
        levels=(7e-3, 3e-3, 1e-3, 5e-4),
        constants=CONSTANTS,
        takes_restitution=True,
        computes="motion, contact, impact and rest",
        imposes=f"a plane, by joints; {RULED}; {GIVEN}",
        calls=impact_aware(TUNED),
        faults=CREEPS,
    ),
    "fixed-step": Variant(
        FIXED,
        kind="tuned",
        levels=(4e-3, 1e-3, 2.5e-4, 1e-4),
        finer=({"step": 2e-5},),
        free_block="engines.pybullet.free_block:simulate",
        computes="motion, contact, impact and rest",
        imposes=f"a plane, by joints; {MEAN_LOADS}",
        calls=fixed_step(FIXED),
    ),
    "first-script": Variant(  # default damping: e off by .01 to .5 at every step
        PLAIN,
        kind="defaults",
        levels=(1 / 60, 1 / 240, 1 / 1000),
        finer=({"step": 2e-4},),
        friction=0.5 * 0.5,  # the product of the defaults of both bodies
        flight_damping=0.04,  # the default of a multibody
        computes="motion, contact, impact and rest",
        imposes=SAMPLED,
        calls=first_script(PLAIN),
    ),
}

FIRST_CONTACT = 1e-3  # tilt below which a first script's block counts as in flat contact, over the slenderness


def versions() -> dict[str, str]:
    """Versions of the packages that compute: {package: version}."""
    return {"pybullet": version("pybullet"), "bullet-api": str(pybullet.getAPIVersion())}


def run(scene: Scene, variant: str, settings: Settings, pedestal_tilt: float = 0.0) -> Run:
    """The `Run` of a scene; pedestal_tilt: of a free pedestal at the start [rad]."""
    plain, edge, friction = isinstance(settings, FirstScript), FIRST_CONTACT * scene.block.slenderness, scene.friction
    client = pybullet.connect(pybullet.DIRECT)
    try:
        result = run_of(
            scene,
            settings,
            lambda step: (
                FreeBox(client, scene, step, pedestal_tilt) if plain else BulletBodies(client, scene, pedestal_tilt)
            ),
            lambda rows: raw_trace_of(rows, scene, edge),
            depth=0.0,  # contacts act before penetration
            pedestal_tilt=pedestal_tilt,
        )
    except pybullet.error as error:
        return Run(None, 0, math.nan, Failure("Bullet raised an error", str(error)))
    finally:
        pybullet.disconnect(client)
    if plain:
        return _fail_if_limited(result)
    if friction is not None and friction > FRICTION:
        words = f"friction = {friction:.4g} is above {FRICTION:g}: Bullet takes it as {FRICTION:g}"
        result = replace(result, warnings=(Caution("engine", words, "friction", friction, FRICTION),))
    return result


run_stack = run  # the same calls build one block and a stack


def _fail_if_limited(result: Run) -> Run:
    """Make a first script's run a failure where Bullet may have limited a velocity, which it does silently."""
    if result.trace is None or result.failure:
        return result
    fastest = max(np.abs(result.trace.tilt_rate).max(), np.abs(result.trace.base_velocity).max())
    if fastest <= 0.1 * DEFAULT_MOST_VELOCITY:
        return result
    words = f"{fastest:.3g} m/s or rad/s; its limit: {DEFAULT_MOST_VELOCITY:g}"
    return replace(result, failure=Failure("Bullet limits velocities", words))
