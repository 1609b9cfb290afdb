"""PyBullet (Bullet's multibody solver): ``get_engine("pybullet").simulate(scene, variant=...)``.

The record, the tolerances of its variants in the scenes of the tolerance table, and mistakes in a script for PyBullet
by what they concern.
"""

from ..contract import HELD, LARGE_STEP, NO_MATTER, READING, ROUNDING, STEP, Engine, Mistake, ToleranceRow

ENGINE = Engine(
    name="pybullet",
    title="PyBullet",
    package="pybullet",
    install="pip install pybullet (its wheels end at CPython 3.11: use Python 3.11)",
    adapter="engines.pybullet.adapter",
    imported="engines.pybullet.adapter",
    tolerances="engines.pybullet",
    script="engines.pybullet:script.py.jinja",
    mistakes="engines.pybullet",
    colour="#0072B2",
    marker="^",
    dashes=":",
    subject=True,
)


TOLERANCES = {
    "impact-aware": (
        ToleranceRow("restitution, rms", "rigid ground", 1.47e-5, 7.41e-6, LARGE_STEP),
        ToleranceRow("restitution, rms", "sliding base", 4e-5, 3.49e-5, LARGE_STEP),
        ToleranceRow("base velocity jump, rms", "sliding base", 1.5e-6, 7.57e-7, LARGE_STEP),
        ToleranceRow("impact times", "rigid ground", 3.36e-4, 1.69e-4, LARGE_STEP),
        ToleranceRow("impact times", "sliding base", 9.37e-5, 4.71e-5, LARGE_STEP),
        ToleranceRow("peak tilt", "rocking on bearings, one-sine", 4.5e-5, 2.26e-5, LARGE_STEP),
        ToleranceRow("tilt graph", "rocking on bearings, one-sine", 7.31e-5, 3.68e-5, LARGE_STEP),
        ToleranceRow("peak displacement", "rocking on bearings, one-sine", 4.58e-6, 2.3e-6, LARGE_STEP),
        ToleranceRow("peak displacement", "isolated Caryatid, synthetic motion", 6.5e-6, 4.26e-6, LARGE_STEP),
        ToleranceRow("overturning time", "one-sine of 3.8 g slenderness, rigid ground", 4.4e-4, 2.21e-4, LARGE_STEP),
        ToleranceRow(
            "overturning boundary", "one-sine at 2 and 5 times omega_r, rigid ground", 1.24e-4, 6.25e-5, LARGE_STEP
        ),
        ToleranceRow(
            "overturning boundary",
            "one-sine at 7, one-cosine at 2 times omega_r, rigid ground",
            1.12e-3,
            5.64e-4,
            LARGE_STEP,
        ),
        ToleranceRow("bearing force replayed", "rocking on bearings, one-sine", 1e-9, 8.7e-14, ROUNDING),
        ToleranceRow("bearing force replayed", "isolated Caryatid, synthetic motion", 1e-9, 2.2e-13, ROUNDING),
        ToleranceRow("bearing impulse in the motion", "rocking on bearings, one-sine", 1.24e-5, 6.26e-6, READING),
        ToleranceRow("bearing impulse in the motion", "isolated Caryatid, synthetic motion", 3.5e-5, 1.88e-5, READING),
        ToleranceRow("corner lift at rest", "60 s of shaking below uplift, rigid ground", 5e-10, 2.52e-10, HELD),
        ToleranceRow("base drift at rest", "60 s of shaking below uplift, on bearings", 4.5e-7, 2.36e-7, LARGE_STEP),
    ),
    "fixed-step": (
        ToleranceRow("restitution, rms", "rigid ground, slenderness 0.2", 1.2e-3, 6.18e-4, STEP),
        ToleranceRow("restitution, rms", "sliding base, slenderness 0.2", 2.1e-3, 1.08e-3, STEP),
        ToleranceRow("base velocity jump, rms", "sliding base, slenderness 0.2", 1.2e-4, 6.18e-5, STEP),
    ),
    "first-script": (
        ToleranceRow(
            "restitution from swings, |mean error|",
            "rigid ground, slenderness 0.2",
            0.025,
            0.0151,
            "default damping of 0.04 in flight; independent of the step",
        ),
        ToleranceRow(
            "restitution from swings, |mean error|",
            "sliding base, slenderness 0.2",
            0.12,
            0.0746,
            "default damping in flight and the joint's default motor",
        ),
        ToleranceRow(
            "base velocity jump, rms",
            "sliding base, slenderness 0.2",
            0.09,
            0.0491,
            "contact spread over several steps",
        ),
    ),
}


# A free body instead of the chain: the same stepping, corners and forces.
FREE_BLOCK = {
    "def build() -> int:": '''\
def build() -> int:
    """A block of six degrees of freedom, with four corners, on a base that slides."""
    p.connect(p.DIRECT)
    r = 1e-6 * R
    places = [[x, y, r - h] for x in (-b, b) for y in (-b, b)]
    corners = p.createCollisionShapeArray([p.GEOM_SPHERE] * 4, radii=[r] * 4, collisionFramePositions=places)
    plane = p.createCollisionShape(p.GEOM_PLANE)
    block = p.createMultiBody(m, corners, -1, [0, 0, h])
    base = p.createMultiBody(
        0,
        linkMasses=[mb],
        linkCollisionShapeIndices=[plane],
        linkVisualShapeIndices=[-1],
        linkPositions=[[0, 0, 0]],
        linkOrientations=[[0, 0, 0, 1]],
        linkInertialFramePositions=[[0, 0, 0]],
        linkInertialFrameOrientations=[[0, 0, 0, 1]],
        linkParentIndices=[0],
        linkJointTypes=[p.JOINT_PRISMATIC],
        linkJointAxis=[[1, 0, 0]],
    )
    for body, link in ((block, -1), (base, 0)):
        p.changeDynamics(body, link, linearDamping=0, angularDamping=0, maxJointVelocity=1e9)
        p.changeDynamics(body, link, lateralFriction=math.sqrt(10))
    p.setJointMotorControl2(base, 0, p.VELOCITY_CONTROL, force=0)
    p.changeDynamics(block, -1, mass=m, localInertiaDiagonal=[J - m * R**2] * 3)
    place = globals().get("start_tilt", 0.0)
    if place:
        side = math.copysign(1, place)
        c, n = R * math.cos(side * gamma - place), R * math.sin(side * gamma - place)
        turn = p.getQuaternionFromEuler([0, place, 0])
        p.resetBasePositionAndOrientation(block, [side * b - n, 0, c], turn)
    return base


def states(base: int, _) -> list[tuple[float, ...]]:
    """Place and velocity, as those of the joints of a chain."""
    (x, _, z), turn = p.getBasePositionAndOrientation(0)
    (vx, _, vz), (_, rate, _) = p.getBaseVelocity(0)
    tilt = 2 * math.atan2(turn[1], turn[3])
    return [(x, vx), (z - h, vz), (tilt, rate), p.getJointState(base, 0)[:2]]


def chain() -> int:''',
    "p.getJointStates(body, range(4))": "states(body, range(4))",
    "p.applyExternalForce(body, 3,": "p.applyExternalForce(body, 0,",
}
SHORTENED = "step = max(min(step, 0.3 * gap / closing), shortest)"
LONGER = "step = min(1.5 * step, longest)"
INERTIA = "localInertiaDiagonal=[J - m * R**2] * 3"
CORNERS = "p.createCollisionShapeArray([p.GEOM_SPHERE] * 2, radii=[r] * 2, collisionFramePositions=places)"
RADIUS = "r = 1e-6 * R"
PLANE = "p.createCollisionShape(p.GEOM_PLANE)"
SLAB = "p.createCollisionShape(p.GEOM_BOX, halfExtents=[20 * R, 20 * R, 0.5], collisionFramePosition=[0, 0, -0.5])"
FRICTION = "lateralFriction=math.sqrt(10)"
FLAGS = "flags=p.URDF_USE_SELF_COLLISION"
SMALLEST = "shortest, longest = 5e-7 * scale"
SLOP = "contactSlop=0"
GRAVITY = "p.setGravity((last - ground) / step,"


def _fixed(step: str) -> dict[str, str]:
    return {LONGER: f"step = {step}", SHORTENED: "pass"}


BODY = (
    Mistake("sleeping", "Bodies at rest may sleep", "body", {FLAGS: f"{FLAGS} | p.URDF_ENABLE_SLEEPING"}),
    Mistake(
        "joint motors on",
        "Motors of the joints left on, as they are by default",
        "body",
        {"p.setJointMotorControlArray(": "# p.setJointMotorControlArray("},
    ),
    Mistake(
        "base motor on",
        "Motor of the base's joint left on",
        "body",
        {"range(4), p.VELOCITY_CONTROL, forces=[0] * 4": "range(3), p.VELOCITY_CONTROL, forces=[0] * 3"},
        "base",
    ),
    Mistake("free block", "A free block with six degrees of freedom, the same steps", "body", FREE_BLOCK, "base"),
    Mistake("inertia of spheres", "Inertia left to PyBullet: that of the corner spheres", "body", {f", {INERTIA}": ""}),
    Mistake(
        "corner inertia",
        "Inertia about a corner given as that about the centre",
        "body",
        {INERTIA: "localInertiaDiagonal=[J] * 3"},
    ),
    Mistake(
        "inertia + 1 %", "Inertia 1 % too large", "body", {INERTIA: "localInertiaDiagonal=[1.01 * (J - m * R**2)] * 3"}
    ),
    Mistake("no self-collision", "No contact between the links of one body", "body", {FLAGS: "flags=0"}),
    Mistake(
        "default damping",
        "Damping of 0.04 1/s left as it is by default",
        "body",
        {"linearDamping=0, angularDamping=0, maxJointVelocity=1e9": "maxJointVelocity=1e9"},
    ),
)
CONTACT = (
    Mistake("restitution 1", "Restitution 1", "contact", {FRICTION: f"{FRICTION}, restitution=1.0"}),
    Mistake(
        "default slop", "Slop left at its default of 10 µm, a depth that is not corrected", "contact", {f", {SLOP}": ""}
    ),
    Mistake("slop of 0.1 mm", "Slop of 0.1 mm", "contact", {SLOP: "contactSlop=1e-4"}),
    Mistake(
        "box",
        "The block as a box, not as spheres at its corners",
        "contact",
        {CORNERS: "p.createCollisionShape(p.GEOM_BOX, halfExtents=[b, b, h])"},
    ),
    Mistake("slab", "A box instead of a plane under the block", "contact", {PLANE: SLAB}),
    Mistake("spheres of 0.01 R", "Corner spheres of 0.01 R", "contact", {RADIUS: "r = 0.01 * R"}),
    Mistake(
        "default friction", "Friction left at its default, 0.5 times 0.5", "contact", {FRICTION: "lateralFriction=0.5"}
    ),
)
STEPS = (
    Mistake("steps of 1/240 s", "Steps of 1/240 s, the default", "steps", _fixed("1 / 240")),
    Mistake("steps of 1 ms", "Steps of 1 ms", "steps", _fixed("1e-3")),
    Mistake("steps of 0.1 ms", "Steps of 0.1 ms", "steps", _fixed("1e-4")),
    Mistake(
        "at least 10 µs",
        "Steps shortened before a landing to 10 µs at least",
        "steps",
        {SMALLEST: "shortest, longest = 1e-5 * scale"},
    ),
    Mistake(
        "at least 0.1 ms",
        "Steps shortened before a landing to 0.1 ms at least",
        "steps",
        {SMALLEST: "shortest, longest = 1e-4 * scale"},
    ),
    Mistake(
        "no half kick",
        "Forces for the whole of each step, though the steps change",
        "steps",
        {"kick = (step + before) / (2 * step)": "kick = 1.0"},
    ),
    Mistake(
        "bouncy, 1 ms",
        "Restitution 1, with steps of 1 ms",
        "steps",
        {**_fixed("1e-3"), FRICTION: f"{FRICTION}, restitution=1.0"},
    ),
    Mistake("substeps", "Four substeps in each step", "steps", {SLOP: f"{SLOP}, numSubSteps=4"}),
)
FORCES = (
    Mistake(
        "force once",
        "Force of the bearings applied in the first step only",
        "forces",
        {"p.applyExternalForce(body,": "if t == 0:\n            p.applyExternalForce(body,"},
        "bearings",
    ),
    Mistake(
        "no memory",
        "Bearings without memory: each force as in a first loading",
        "forces",
        {"hysteretic(hyst, new - x), new": "hysteretic(0.0, new), new"},
        "bearings",
    ),
)
MOTION = (
    Mistake(
        "record held",
        "Acceleration of the record held between its samples",
        "motion",
        {GRAVITY: "p.setGravity(-kick * GROUND[min(int(t / TIME[1]), len(GROUND) - 1)],"},
        "record",
    ),
    Mistake(
        "end of step",
        "Acceleration of the ground at the end of each step, not its mean",
        "motion",
        {GRAVITY: "p.setGravity(kick * (ground_velocity(t + step) - ground_velocity(t + step + 1e-6)) / 1e-6,"},
        "motion",
    ),
)
WITHOUT = (
    Mistake(
        "early velocities",
        "Velocities taken as those of the step's end; they are of half a step before",
        NO_MATTER,
        {"step[1:] / 2 * gain": "0 * gain"},
    ),
    Mistake(
        "ERP 0.8", "Penetration corrected by 0.8 in each step", NO_MATTER, {SLOP: f"{SLOP}, erp=0.8, contactERP=0.8"}
    ),
    Mistake("split impulse", "Split impulse", NO_MATTER, {SLOP: f"{SLOP}, useSplitImpulse=1"}),
    Mistake(
        "breaking distance",
        "Contact kept up to gaps of 0.1 mm",
        NO_MATTER,
        {SLOP: f"{SLOP}, contactBreakingThreshold=1e-4"},
    ),
    Mistake("velocity limit", "Velocity limit left at its default", NO_MATTER, {", maxJointVelocity=1e9": ""}),
    Mistake(
        "10 iterations",
        "10 iterations of the contact solver, for 50",
        NO_MATTER,
        {SLOP: f"{SLOP}, numSolverIterations=10"},
    ),
    Mistake("1000 iterations", "1000 iterations", NO_MATTER, {SLOP: f"{SLOP}, numSolverIterations=1000"}),
    Mistake("friction 0.5", "Friction 0.5", NO_MATTER, {FRICTION: "lateralFriction=math.sqrt(0.5)"}),
    Mistake("spheres of 10⁻⁹ R", "Corner spheres of 10⁻⁹ R", NO_MATTER, {RADIUS: "r = 1e-9 * R"}),
    Mistake("spheres of 10⁻⁴ R", "Corner spheres of 10⁻⁴ R", NO_MATTER, {RADIUS: "r = 1e-4 * R"}),
)
MISTAKES = (*BODY, *CONTACT, *STEPS, *FORCES, *MOTION, *WITHOUT)
