"""exudyn: ``get_engine("exudyn").simulate(scene, variant=...)``: record, tolerances, and mistakes in a script.

The tolerances of a variant are those of the tolerance table's scenes. The mistakes are sorted by what they concern.
"""

from ..contract import HELD, NO_MATTER, READING, ROUNDING, Engine, Mistake, ToleranceRow

ENGINE = Engine(
    name="exudyn",
    package="exudyn",
    install="pip install exudyn",
    adapter="engines.exudyn.adapter",
    tolerances="engines.exudyn",
    script="engines.exudyn:script.py.jinja",
    mistakes="engines.exudyn",
    colour="#E69F00",
    marker="s",
    dashes="--",
    subject=True,
)


# A jump of the ground's acceleration errs as the others only where the block is at rest from the start until then; see
# `scene.CompliantCorners`.
STIFFNESS = "contact stiffness; goes as its inverse"

TOLERANCES = {
    "compliant-corners": (
        ToleranceRow("restitution, rms", "rigid ground", 8.8e-6, 4.41e-6, STIFFNESS),
        ToleranceRow("restitution, rms", "sliding base", 1.9e-5, 9.76e-6, STIFFNESS),
        ToleranceRow("base velocity jump, rms", "sliding base", 1.37e-5, 6.89e-6, STIFFNESS),
        ToleranceRow("impact times", "rigid ground", 1.8e-4, 1.0e-4, STIFFNESS),
        ToleranceRow("impact times", "sliding base", 3.8e-5, 2.44e-5, STIFFNESS),
        ToleranceRow("peak tilt", "rocking on bearings, one-sine", 6.4e-4, 3.23e-4, STIFFNESS),
        ToleranceRow("tilt graph", "rocking on bearings, one-sine", 1.6e-3, 8.14e-4, STIFFNESS),
        ToleranceRow("peak displacement", "rocking on bearings, one-sine", 3.8e-5, 2.72e-5, STIFFNESS),
        ToleranceRow("peak displacement", "isolated Caryatid, synthetic motion", 1.4e-5, 1.09e-5, STIFFNESS),
        ToleranceRow("overturning time", "one-sine of 3.8 g slenderness, rigid ground", 8.2e-5, 4.12e-5, STIFFNESS),
        ToleranceRow(
            "overturning boundary", "one-sine at 2 and 5 times omega_r, rigid ground", 7.5e-5, 3.75e-5, STIFFNESS
        ),
        ToleranceRow(
            "overturning boundary",
            "one-sine at 7, one-cosine at 2 times omega_r, rigid ground",
            5.3e-4,
            2.67e-4,
            STIFFNESS,
        ),
        ToleranceRow("bearing force replayed", "rocking on bearings, one-sine", 1e-9, 2.2e-13, ROUNDING),
        ToleranceRow("bearing force replayed", "isolated Caryatid, synthetic motion", 1e-9, 4.4e-13, ROUNDING),
        ToleranceRow("bearing impulse in the motion", "rocking on bearings, one-sine", 7.5e-6, 3.77e-6, READING),
        ToleranceRow("bearing impulse in the motion", "isolated Caryatid, synthetic motion", 8e-6, 4.11e-6, READING),
        ToleranceRow("corner lift at rest", "60 s of shaking below uplift, rigid ground", 2.8e-7, 1.40e-7, HELD),
        ToleranceRow("base drift at rest", "60 s of shaking below uplift, on bearings", 1.5e-6, 9.98e-7, HELD),
    ),
    "native-contact": (
        ToleranceRow(
            "restitution from swings, |mean error|",
            "rigid ground, slenderness 0.2",
            0.04,
            0.0275,
            "the damper pulls at the lifting corner, friction creeps",
        ),
        ToleranceRow(
            "restitution from swings, |mean error|",
            "sliding base, slenderness 0.2",
            0.07,
            0.0451,
            "the damper pulls at the lifting corner, friction creeps",
        ),
    ),
}


STIFFNESS_LINE = "(1.43e-7 * R)"
NORMAL = "exu.symbolic.max(zero, k * depth * (1 - v[1] / rebound))"
REBOUND = "rebound, slip = 3e-4 *"
STICK = "kt * u[0] + (ct + normal / slip) * v[0]"
MU = "mu = 5"
INERTIA = "inertia=J - m * R**2"
TOLERANCE = "absoluteTolerance = 1e-6 *"
SOLVER = "DynamicSolverType.DOPRI5"
STEPS_OF = "math.ceil(duration / longest)"
LONGEST = "longest = 3 /"
COMMITTED = "hyst, x = hysteretic(hyst, new - x), new"
BEARINGS = "bearings = mbs.AddObject(eii.CartesianSpringDamper(markerNumbers=[fixed, carried]))"
MEAN = "mean = (ground_velocity(t) - ground_velocity(last)) / (t - last)"
# exudyn calls the function of a spring at each stage of a step, also of steps that it rejects.
EACH_CALL = {
    BEARINGS: """\
past = [0.0, 0.0]


def each_call(mbs, t, item, u, v, stiffness, damping, offset):
    past[:] = u[0], hysteretic(past[1], u[0] - past[0])
    return [bearing_force(*past), 0, 0]


bearings = mbs.AddObject(
    eii.CartesianSpringDamper(markerNumbers=[fixed, carried], springForceUserFunction=each_call)
)""",
    COMMITTED: "hyst, x = past[1], new",
}


def _soft(factor: int, stiffness: str) -> Mistake:
    return Mistake(f"{factor} × softer", f"Contact {factor} times softer", "contact", {STIFFNESS_LINE: stiffness})


def _solver(name: str, step: str | None = None) -> dict[str, str]:
    """Another integrator, with fixed steps where one is given."""
    fixed = {STEPS_OF: f"math.ceil(duration / {step})", "minimumStepSize = 1e-13": "adaptiveStep = False"}
    return {SOLVER: f"DynamicSolverType.{name}"} | (fixed if step else {})


BODY = (
    Mistake("corner inertia", "Inertia about a corner given as that about the centre", "body", {INERTIA: "inertia=J"}),
    Mistake("inertia + 1 %", "Inertia 1 % too large", "body", {INERTIA: "inertia=1.01 * (J - m * R**2)"}),
)
CONTACT = (
    _soft(10, "(1.43e-6 * R)"),
    _soft(100, "(1.43e-5 * R)"),
    _soft(1000, "(1.43e-4 * R)"),
    Mistake("no damping", "Contact without damping", "contact", {NORMAL: "k * depth"}),
    Mistake("light damping", "Contact with 1/1000 of the damping", "contact", {REBOUND: "rebound, slip = 0.3 *"}),
    Mistake(
        "Kelvin-Voigt",
        "Damping that does not grow with the depth (Kelvin and Voigt)",
        "contact",
        {
            NORMAL: "exu.symbolic.max(zero, k * depth - 2 * math.sqrt(k * m) * v[1]) * exu.symbolic.IfThenElse("
            "u[1] < 0, exu.symbolic.Real(1), zero)"
        },
    ),
    Mistake("pulling contact", "Contact that may pull", "contact", {NORMAL: "k * depth * (1 - v[1] / rebound)"}),
    Mistake(
        "springs alone",
        "Springs and dampers that hold the corners, without a contact law",
        "contact",
        {"springForceUserFunction=law": "stiffness=[kt, k, 0], damping=[ct, ct, 0]"},
    ),
    Mistake(
        "viscous friction",
        "Friction that rises with the velocity, up to 0.1 m/s, and holds nothing",
        "contact",
        {STICK: "mu * normal * v[0] / 0.1"},
    ),
    Mistake("no friction", "No friction", "contact", {MU: "mu = 0"}),
    Mistake("undamped sticking", "Corners held without damping along the ground", "contact", {STICK: "kt * u[0]"}),
    Mistake(
        "soft sticking", "Corners held 10 times softer along the ground", "contact", {"kt = 0.3 * k": "kt = 0.03 * k"}
    ),
)
STEPS = (
    Mistake("tolerance 10⁻³", "Tolerance 10⁻³", "steps", {TOLERANCE: "absoluteTolerance = 1e-3 *"}),
    Mistake("RK44", "Runge-Kutta of order 4, steps of 0.1 ms", "steps", _solver("RK44", "1e-4")),
    Mistake("RK67", "Runge-Kutta of order 6, without control of the error", "steps", _solver("RK67")),
    Mistake("gen. alpha, 1 ms", "Generalized alpha, steps of 1 ms", "steps", _solver("GeneralizedAlpha", "1e-3")),
    Mistake("gen. alpha, 0.1 ms", "Generalized alpha, steps of 0.1 ms", "steps", _solver("GeneralizedAlpha", "1e-4")),
    Mistake(
        "gen. alpha, soft",
        "Generalized alpha, steps of 1 ms, contact 1000 times softer",
        "steps",
        {**_solver("GeneralizedAlpha", "1e-3"), STIFFNESS_LINE: "(1.43e-4 * R)"},
    ),
)
FORCES = (
    Mistake(
        "memory each call", "Memory of the bearings moved on in each call of the force", "forces", EACH_CALL, "bearings"
    ),
    Mistake(
        "no memory",
        "Bearings without memory: each force as in a first loading",
        "forces",
        {COMMITTED: "hyst, x = hysteretic(0.0, new), new"},
        "bearings",
    ),
    Mistake(
        "force held",
        "Force of the bearings held over each step",
        "forces",
        {"max((bearing_force(x + ahead, hysteretic(hyst, ahead)) - force) / ahead, 1e-9 * ka)": "1e-9 * ka"},
        "bearings",
    ),
)
MOTION = (
    Mistake(
        "base not shaken",
        "Ground acceleration on the block, not on the base",
        "motion",
        {'"loadVector", [-mb * mean, 0, 0]': '"loadVector", [0, 0, 0]'},
        "base motion",
    ),
    Mistake(
        "record held",
        "Acceleration of the record held between its samples",
        "motion",
        {MEAN: "mean = GROUND[min(int(last / TIME[1]), len(GROUND) - 1)]"},
        "record",
    ),
)
WITHOUT = (
    Mistake(
        "not pressed in",
        "Corners that start at the ground, not pressed in by the weight",
        NO_MATTER,
        {"-m * g / (2 * k), 0], [0, 0, 0]": "0, 0], [0, 0, 0]"},
        "motion",
    ),
    Mistake(
        "end of step",
        "Acceleration of the ground at the end of each step, not its mean",
        NO_MATTER,
        {MEAN: "mean = (ground_velocity(t + 1e-6) - ground_velocity(t)) / 1e-6"},
        "motion",
    ),
    Mistake("friction 0.5", "Friction 0.5", NO_MATTER, {MU: "mu = 0.5"}),
    Mistake("friction 50", "Friction 50", NO_MATTER, {MU: "mu = 50"}),
    Mistake("no slip term", "Friction without its viscous part", NO_MATTER, {"(ct + normal / slip)": "ct"}),
    Mistake(
        "slower rebound", "Corners that rebound three times slower", NO_MATTER, {REBOUND: "rebound, slip = 1e-4 *"}
    ),
    Mistake("tolerance 10⁻⁴", "Tolerance 10⁻⁴", NO_MATTER, {TOLERANCE: "absoluteTolerance = 1e-4 *"}),
    Mistake("tolerance 10⁻⁹", "Tolerance 10⁻⁹", NO_MATTER, {TOLERANCE: "absoluteTolerance = 1e-9 *"}),
    Mistake("half longest step", "Longest step halved", NO_MATTER, {LONGEST: "longest = 1.5 /"}),
    Mistake("10 × longest step", "Longest step ten times longer", NO_MATTER, {LONGEST: "longest = 30 /"}),
    Mistake("ODE23", "Runge-Kutta of order 2, with control of the error (ODE23)", NO_MATTER, _solver("ODE23")),
)
MISTAKES = (*BODY, *CONTACT, *STEPS, *FORCES, *MOTION, *WITHOUT)
