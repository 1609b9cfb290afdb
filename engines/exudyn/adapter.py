"""exudyn's variants: their calls, their chosen numbers, and the run with checks that exudyn's solver does not make."""

from __future__ import annotations

import math
import platform
from dataclasses import replace
from importlib.metadata import version
from typing import TYPE_CHECKING

import numpy as np

from analytic.response import Failure, State
from analytic.rocking import BearingLaw

from ..contract import Variant
from ..trace_checks import replay_bearing
from . import corners, native, stepping
from .scene import MEASURED

if TYPE_CHECKING:
    from analytic import Scene

    from ..contract import Run
    from .native import NativeContact
    from .scene import CompliantCorners

MASS, RADIUS, GRAVITY = MEASURED
BODIES = {
    "NodeRigidBody2D(referenceCoordinates=[0, h, 0])": "of the block's centre; its rotation is -tilt",
    "ObjectRigidBody2D(mass=m, inertia=J - m * R**2)": "inertia about the centre",
    "Node1D(referenceCoordinates=[0])": "of the base",
    "ObjectMass1D(mass=mb)": "",
    "LoadMassProportional()": "of the block; before each step its loadVector is [-a, -g, 0]: in the ground's frame its "
    "acceleration a, here the mean of the step, is one more gravity",
    "LoadForceVector()": "of the base; before each step its loadVector is [-mb * a, 0, 0]",
    "ObjectConnectorCartesianSpringDamper(stiffness=[chord, 0, 0], damping=[dampers, 0, 0])": "of all bearings; after "
    "each step, stiffness and offset are those of the law's chord ahead, from the history that moves on there",
}
QUICKER = {
    f"settings.timeIntegration.explicit.{name} = False": "a step takes less time"
    for name in ("useLieGroupIntegration", "eliminateConstraints", "computeEndOfStepAccelerations")
}


def _speed(value: float) -> str:
    """A speed of the Caryatid [m/s], scaled with the size."""
    return f"{value / math.sqrt(GRAVITY * RADIUS):.6g} * sqrt(g * R)"


def compliant_corners(settings: CompliantCorners) -> dict[str, str]:
    """exudyn's calls in compliant-corners, for `engines.contract.Variant.calls`."""
    softness = MASS * GRAVITY / RADIUS / settings.stiffness
    return {
        **BODIES,
        f"k = m * g / ({softness:.6g} * R)": "N/m, of a corner: under the weight it sinks in by so much",
        f"rebound = {_speed(settings.rebound)}": "m/s, at most",
        f"slip = {_speed(settings.slip)}": "m/s: a corner that slides faster is held by the viscous part alone",
        "part = mb / (m + mb)": "1 on the ground",
        f"kt = {settings.sticking:g} * k * part": "N/m, tangential",
        "turned = 4 / (1 / (m * part) + h**2 / (J - m * R**2))": "kg",
        f"ct = 2 * {settings.damping:g} * sqrt(kt * turned)": "N s/m",
        "N = max(0, k * max(0, depth) * (1 - rise / rebound))": "Hunt and Crossley, of a corner that is depth deep and "
        "rises at rise; it must not pull",
        "stick = kt * across + (ct + part * N / slip) * slide": "N",
        f"T = max(-{settings.friction:g} * N, min({settings.friction:g} * N, stick))": (
            "Coulomb; across: from where the corner stuck, slide: its rate; mu of a scene that gives mu"
        ),
        "CreateSymbolicUserFunction(mbs, f, name, item)": "of the force below: run by exudyn, without Python",
        "ObjectConnectorCartesianSpringDamper(springForceUserFunction=[T, -N, 0])": "of each corner",
        "explicit.timeIntegration.solverType = DynamicSolverType.DOPRI5": "explicit: the SimulationSettings of a "
        "MainSolverExplicit; settings: of every solver",
        f"explicit.timeIntegration.absoluteTolerance = {settings.tolerance:g} * min(scale, 1 / scale)": "",
        "explicit.timeIntegration.relativeTolerance = 1e-14": "round-off",
        f"explicit.timeIntegration.minimumStepSize = {stepping.LEAST_STEP:g}": "s",
        f"settings.timeIntegration.initialStepSize = {stepping.FIRST * settings.longest_step:g} * scale": "s",
        **QUICKER,
        "implicit.timeIntegration.solverType = DynamicSolverType.GeneralizedAlpha": "of a "
        "MainSolverImplicitSecondOrder, while the block pivots or stands",
        f"rounding = {stepping.ROUNDING:.6g} * k * R": "N",
        f"implicit.timeIntegration.newton.absoluteTolerance = max({stepping.RESIDUAL:g} * m * g, rounding)": "N",
        "implicit.timeIntegration.newton.numericalDifferentiation.minimumCoordinateSize = 1": "",
        "implicit.timeIntegration.newton.numericalDifferentiation.relativeEpsilon = "
        f"{stepping.DIFFERENCE / 2:g} * m * g / (k * R)": "a corner must not leave its contact",
        "implicit.timeIntegration.adaptiveStep = False": "",
        "implicit.timeIntegration.automaticStepSize = False": f"steps of {settings.pivoting_step:g} * scale s, "
        "shorter on stiff bearings",
    }


def native_contact(settings: NativeContact) -> dict[str, str]:
    """exudyn's calls in native-contact, for `engines.contract.Variant.calls`."""
    return {
        **BODIES,
        f"ObjectContactSphereTriangle(sphereRadius={settings.sphere:g}, includeEdges=0, contactStiffness="
        f"{settings.stiffness:g}, contactDamping={2 * settings.damping:g} * sqrt({settings.stiffness:g} * m), "
        f"dynamicFriction={settings.friction:g}, frictionProportionalZone={settings.slip_speed:g})": "of each corner; "
        "mu of a scene that gives mu",
        **QUICKER,
        "settings.timeIntegration.solverType = DynamicSolverType.TrapezoidalIndex2": "",
        "settings.timeIntegration.generalizedAlpha.useNewmark = True": "",
        "settings.timeIntegration.generalizedAlpha.useIndex2Constraints = True": "",
        "settings.timeIntegration.automaticStepSize = False": "",
        "settings.timeIntegration.newton.useModifiedNewton = False": "",
        f"settings.timeIntegration.numberOfSteps = ceil((end - start) / {settings.step:g})": "",
    }


HERE = "engines.exudyn"
CONSTANTS = {
    "stiffness": "stiffness of a corner [N/m], the accuracy parameter",
    "rebound": "largest speed at which a corner rebounds [m/s]",
    "friction": "coefficient where the scene gives none",
    "sticking": "tangential over normal stiffness",
    "damping": "tangential, over the critical one",
    "slip": "sliding speed at which viscous friction equals the normal force [m/s]",
    "tolerance": "local error of an explicit step",
    "longest_step": "longest explicit step [s]",
    "pivoting_step": "implicit step, while the block pivots or stands [s]",
    f"{HERE}.corners:RELAX": "time for the corners to relax after an impact, over sqrt(m/k)",
    f"{HERE}.corners:MOST_RELAX": "the same, over sqrt(R/g), at most",
    f"{HERE}.corners:ACTS": "time before a landing in which the couple of a given restitution acts, over RELAX's",
    f"{HERE}.stepping:AHEAD": "number of steps to the impact at which implicit steps end",
    f"{HERE}.stepping:PUSHED": "rate toward the impact that a base may cause, over that of the block's free fall",
    f"{HERE}.stepping:CARRIES": "least share of the weight on a loaded corner in implicit steps",
    f"{HERE}.stepping:WORTHWHILE": "least implicit step that is faster than explicit ones, over pivoting_step",
    f"{HERE}.stepping:SMOOTH": "implicit step where bearings vibrate, over that of leapfrog engines",
    f"{HERE}.stepping:LEAST_STEP": "explicit step at which exudyn gives up [s]",
    f"{HERE}.stepping:FIRST": "first explicit step of a part, over the longest",
    f"{HERE}.stepping:RESIDUAL": "residual of Newton's method, over the block's weight",
    f"{HERE}.stepping:ROUNDING": "least residual, in corner forces from the rounding error of a coordinate",
    f"{HERE}.stepping:DIFFERENCE": "increment of a coordinate in numerical derivatives, over a corner's penetration",
    f"{HERE}.stepping:SUMS": "round-off of a sum of steps, over the duration",
    f"{HERE}.stepping:WHOLE": "tolerated excess of a time over a whole number of steps, in steps",
    f"{HERE}.stepping:END": "share of an implicit step, at its end, whose mean acceleration is its load",
    f"{HERE}.scene:LEAST": "travel [m] of the bearings' chord where the base was at rest",
    "engines.loads:VIBRATION": "step over the time in which the bearings' vibration advances by 1 rad",
}


# Replayed bearing force, over f0: round-off stays below 1e-12.
REPLAY_LIMIT = 1e-9

LOADS = "ground: its acceleration at the step's end"
CHORD = "bearings: within a step a spring along the law's chord"
_MODULES = {"compliant-corners": corners, "native-contact": native}
TUNED, NATIVE = corners.CompliantCorners(), native.NativeContact()
# Such an impact lasts, and the block slides meanwhile; stiffer corners or shorter steps change nothing, a tenth of
# `rebound` or `slip` leaves .3 to .9 of the error. Among 264 drawn scenes with vertical motion that slip by 1e-4 R or
# more, the largest slip is off by 3e-5 in the median, by more than 2 % (and 1e-4 R) in 4.
SLIDES_INTO_IMPACTS = (
    "an impact into which the block slides is up to .02 off in e, and the slip after it by up to 6e-4 R"
)
VARIANTS = {
    "compliant-corners": Variant(
        TUNED,
        kind="tuned",
        calls=compliant_corners(TUNED),
        levels=(1e9, 1e10, 2e11, 1e12),
        finer=(
            {"stiffness": 1e12, "pivoting_step": 2e-4},
            {"stiffness": 1e12, "pivoting_step": 2e-4, "tolerance": 1e-9},
        ),
        varied={
            "stiffness": (1e8, 1e9, 1e10, 1e11, 1e12),
            "rebound": (1e-4, 1e-3, 1e-2, 1e-1),
            "sticking": (0.03, 0.1, 0.3, 1.0),
            "damping": (0.1, 0.5, 1.0),
            "friction": (0.05, 0.1, 0.15, 0.2, 0.3, 0.6, 5.0),
        },
        constants=CONSTANTS,
        takes_restitution=True,
        computes="motion, contact, impact and rest, by integration",
        imposes="contact law: ours (Hunt-Crossley, Coulomb, viscous at low speed, plastic as Housner assumes: "
        "agreement verifies law and integration); a plane; steps: explicit through impacts, implicit between; start: "
        f"with the motion, on corners deflected by what they carry; {LOADS}, of explicit steps its mean; {CHORD}; "
        "restitution given: a couple before each landing",
        faults=SLIDES_INTO_IMPACTS,
    ),
    "native-contact": Variant(
        NATIVE,
        kind="defaults",
        calls=native_contact(NATIVE),
        levels=(1e-3, 3e-4, 1e-4),
        finer=({"step": 5e-5},),
        computes="motion, contact, impact and rest",
        imposes=f"a plane; {LOADS}; {CHORD}",
        faults="the solver may give up some seconds after the motion, with the block at rest",
    ),
}


NO_STACK = (
    ": the contact of its corners is the adapter's own law along the axes of the ground, not of a tilted pedestal"
)


def versions() -> dict[str, str]:
    """Versions of the packages that compute: {package: version}."""
    return {"exudyn": version("exudyn"), "python": platform.python_version()}


def run(scene: Scene, variant: str, settings: CompliantCorners | NativeContact) -> Run:
    """The `Run` of a scene.

    Raises
    ------
    Mismatch
        exudyn holds other values than the scene asks for; nothing was run.
    """
    result = _MODULES[variant].run(scene, settings)
    if result.trace is None:
        failure = replace(result.failure or Failure("the run ended before its first step"), last_state=_start(scene))
        return replace(result, failure=failure, steps=max(result.steps, 0))
    return replace(result, failure=result.failure or _fault(scene, result))


def _fault(scene: Scene, run: Run) -> Failure | None:
    """The failure of a run that exudyn reported as successful, or None."""
    if not all(np.isfinite(getattr(run.trace, name)).all() for name in run.trace.COLUMNS):
        return None  # observe reports it, with the last finite state
    difference = replay_bearing(scene, run.trace)
    if difference > REPLAY_LIMIT:
        return Failure("the bearing force is not the law's", f"it differs by {difference:.3g} f0 when replayed")
    return None


def _start(scene: Scene) -> State:
    law, start = BearingLaw.of(scene.bearings), scene.start
    x, v = start.base_displacement, start.base_velocity
    return State(0.0, start.tilt, start.tilt_rate, x, v, float(law.force(x, law.start(x), v)))
