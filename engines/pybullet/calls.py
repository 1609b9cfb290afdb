"""Bullet's calls in each variant, for `engines.contract.Variant.calls`."""

from ..step_size import GROWTH, NEAR, SHARE, SLOW
from ..stepping import SMALLEST_STEP, FirstScript, FixedStep, ImpactAware
from .first_script import BREAKING_THRESHOLD, THICKNESS
from .scene import CORNER_RADIUS, FRICTION, MOST_VELOCITY, ROCKING_REST, STANDING_REST

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
    """Calls of impact-aware."""
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
    """Calls of fixed-step."""
    return {**CHAIN, f"step = {settings.step:g} * scale": "s; the one before is 0 at the start", **EACH_STEP}


def first_script(settings: FirstScript) -> dict[str, str]:
    """Calls of first-script."""
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
