"""exudyn's calls in each variant, for `engines.contract.Variant.calls`."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from . import phases
from .sizing import MEASURED

if TYPE_CHECKING:
    from .native import NativeContact
    from .sizing import CompliantCorners

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
    """Calls of compliant-corners."""
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
        f"explicit.timeIntegration.minimumStepSize = {phases.LEAST_STEP:g}": "s",
        f"settings.timeIntegration.initialStepSize = {phases.FIRST * settings.longest_step:g} * scale": "s",
        **QUICKER,
        "implicit.timeIntegration.solverType = DynamicSolverType.GeneralizedAlpha": "of a "
        "MainSolverImplicitSecondOrder, while the block pivots or stands",
        f"rounding = {phases.ROUNDING:.6g} * k * R": "N",
        f"implicit.timeIntegration.newton.absoluteTolerance = max({phases.RESIDUAL:g} * m * g, rounding)": "N",
        "implicit.timeIntegration.newton.numericalDifferentiation.minimumCoordinateSize = 1": "",
        "implicit.timeIntegration.newton.numericalDifferentiation.relativeEpsilon = "
        f"{phases.DIFFERENCE / 2:g} * m * g / (k * R)": "a corner must not leave its contact",
        "implicit.timeIntegration.adaptiveStep = False": "",
        "implicit.timeIntegration.automaticStepSize = False": f"steps of {settings.pivoting_step:g} * scale s, "
        "shorter on stiff bearings",
    }


def native_contact(settings: NativeContact) -> dict[str, str]:
    """Calls of native-contact."""
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
