"""Two integrators of exudyn for one model: explicit steps through impacts, implicit ones while contact does not change.

A stiff corner needs thousands of explicit steps per second, even while the block only pivots or stands. There exudyn's
generalized-alpha method takes steps of a millisecond. Both integrate the same corners and bearings: a change of
integrator changes no state and no force.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import exudyn as exu
import numpy as np
from numba import njit

from analytic.motion import PulseMotion
from analytic.rocking import RockingModel

from ..vibration import longest_step
from .ground import SUMS, Ground
from .stepping import solve, solver_settings

if TYPE_CHECKING:
    from collections.abc import Callable

    from analytic.response import Failure

    from .model import Model
    from .stepping import Steps

INITIAL = exu.ConfigurationType.Initial
NEITHER, BOTH = -2, 0  # loaded corners; -1 and 1: that one

# Implicit steps begin only if at least so many of them fit before the impact, and end if fewer than LEAVE do.
ENTER, LEAVE = 4.0, 2.0
# Least share of the weight on a loaded corner, for steps to become implicit and to remain so.
CARRIES, HOLDS = 0.2, 0.1
# Rate toward the impact that a base may cause, over that of the block's free fall.
PUSHED = 3.0
# Implicit steps shorter than this share of `pivoting_step`, as stiff bearings need, are no faster than explicit ones.
WORTHWHILE = 0.1
# Share of the step of leapfrog engines where bearings vibrate: the phase error is (h omega)^2/12 per radian.
SMOOTH = 0.075
FIRST = 2e-3  # of the longest explicit step: the first step of a part
# Numerical damping of generalized-alpha for vibrations that steps do not resolve: 1 less its spectral radius. .02 to .4
# give the same e to 2e-7.
DAMPED = 0.1
# Residual of Newton's method, over the block's weight; at least the corner force from some rounding errors of a
# coordinate, below which Newton's method does not converge.
RESIDUAL, ROUNDING = 1e-7, 30 * 2.0**-52
DIFFERENCE = 0.02  # of a corner's penetration: exudyn's increment in numerical differentiation


@dataclass(frozen=True)
class Rule:
    """Parameters of the steps of a variant.

    explicit: settings of the explicit solver. longest, step: longest explicit and implicit step [s]. sink: penetration
    of a corner under half the weight [m]. settle: relaxation time after a change of contact [s]. early: time before a
    landing whose steps are explicit in any case [s].
    """

    explicit: exu.SimulationSettings
    longest: float
    step: float
    sink: float
    settle: float
    early: float = 0.0


@njit("i8(f8[::1], f8, f8, f8)", cache=True)  # compiled when it is imported
def carrying(q: np.ndarray, b: float, h: float, least: float) -> int:
    """The corner with a penetration above `least` [m]: -1, 1, BOTH or NEITHER."""
    sin, drop = math.sin(q[2]), h * (math.cos(q[2]) - 1) - q[1]
    left, right = drop + b * sin >= least, drop - b * sin >= least
    if left:
        return 0 if right else -1
    return 1 if right else -2


class Phases:
    """The choice of integrator at each step, and the parts of exudyn's time integration that follow from it."""

    def __init__(self, model: Model, rule: Rule, steps: Steps, record: Callable[..., bool]) -> None:
        scene, self.model, self.rule, self.steps, self.record = model.scene, model, rule, steps, record
        rocking = RockingModel.of(scene)
        self.pull = PUSHED * rocking.m * rocking.g * scene.block.half_width / rocking.J
        self.shape = scene.block.half_width, scene.block.half_height
        self.step = SMOOTH * longest_step(scene, rule.step / SMOOTH)
        self.worthwhile = self.step >= WORTHWHILE * rule.step
        self.implicit, self.state, self.since, self.anchored, self.refused = False, NEITHER, 0.0, 0.0, -math.inf
        self.ground = Ground(model, rule.longest) if scene.motion else None
        # The ground acceleration may jump where a pulse begins or ends, and lift a standing block within one implicit
        # step.
        self.jumps = (scene.motion.start, scene.motion.end) if isinstance(scene.motion, PulseMotion) else ()
        model.mbs.SetPostStepUserFunction(self.keep)
        if self.ground:
            model.mbs.SetPreStepUserFunction(self.ground.prepare)
        self.smooth = solver_settings(scene, automaticStepSize=False, adaptiveStep=False)
        integration = self.smooth.timeIntegration
        integration.solverType = exu.DynamicSolverType.GeneralizedAlpha
        integration.generalizedAlpha.spectralRadius = 1 - DAMPED
        integration.newton.useModifiedNewton = True
        weight = scene.block.mass * scene.gravity
        rounding = ROUNDING * scene.block.radius * weight / (2 * rule.sink)
        integration.newton.absoluteTolerance = max(RESIDUAL * weight, rounding)
        # Numerical differentiation uses a share of the corner's penetration, so that the corner stays in contact.
        differences = integration.newton.numericalDifferentiation
        differences.minimumCoordinateSize = 1.0
        differences.relativeEpsilon = DIFFERENCE * rule.sink / scene.block.radius
        self.solvers = exu.MainSolverExplicit(), exu.MainSolverImplicitSecondOrder()

    def keep(self, mbs: exu.MainSystem, t: float) -> bool:
        """After each step (PostStep): record it; False ends the run, or a part of it."""
        if t <= self.steps.times[-1]:
            return True  # exudyn also calls it at the start of each part
        if not self.record(mbs, t):
            return False
        system = self.model.mbs.systemData
        return self.quiet(t, system.GetODE2Coordinates(), system.GetODE2Coordinates_t()) == self.implicit

    def quiet(self, t: float, q: np.ndarray, v: np.ndarray) -> bool:
        """Whether contact has not changed for a while, and will not change in the next steps."""
        least = 2 * (HOLDS if self.implicit else CARRIES) * self.rule.sink
        state, at = carrying(q, *self.shape, least), self.model.anchor.at
        if state != self.state or at != self.anchored or state == NEITHER:
            # A corner landed, lifted or slid.
            self.state, self.since, self.anchored = state, t, at
            return False
        if not self.worthwhile or t - self.since < self.rule.settle or t < self.refused:
            return False
        if any(-self.ground.slack < t - jump < self.rule.settle for jump in self.jumps):
            return False
        if state == BOTH:
            return True
        tilt, fall = abs(q.item(2)), v.item(2) * math.copysign(1.0, q.item(2))
        ahead = (LEAVE if self.implicit else ENTER) * self.step + self.rule.early
        return tilt + fall * ahead - 0.5 * self.pull * ahead * ahead > 0.0

    def run(self) -> Failure | None:
        """Step to the scene's end, to overturning or to the limit of steps; exudyn's failure, or None."""
        steps, duration = self.steps, self.model.scene.duration
        self.record(self.model.mbs, 0.0)
        while steps.times[-1] < duration * (1 - SUMS):
            t, count = steps.times[-1], len(steps.times)
            q, v = steps.last()
            self.implicit = self.quiet(t, q, v)
            failure = self._piece(t, q, v)
            if failure and not self.implicit:
                return failure
            if failure:
                self.refused = steps.times[-1] + self.rule.settle  # explicit steps where Newton's method fails
            elif len(steps.times) == count or steps.ended:
                return None
        return None

    def _piece(self, t, q, v):
        """Integrate from a state to the next change of integrator; the failure, or None."""
        mbs, settings = self.model.mbs, self.smooth if self.implicit else self.rule.explicit
        mbs.systemData.SetODE2Coordinates(q, configuration=INITIAL)
        mbs.systemData.SetODE2Coordinates_t(v, configuration=INITIAL)
        solver, integration = self.solvers[self.implicit], settings.timeIntegration
        duration, first = self.model.scene.duration, FIRST * self.rule.longest
        left = self.ground.begin(t, None if self.implicit else solver.it) if self.ground else duration - t
        integration.startTime, integration.endTime = t, duration
        if self.implicit:
            end, count = self.ground.equal(t, self.step) if self.ground else (duration, math.ceil(left / self.step))
            integration.endTime, integration.numberOfSteps = end, count
        else:
            integration.numberOfSteps = math.ceil((duration - t) / self.rule.longest)
            integration.initialStepSize = min(left, first)
        return solve(solver, mbs, settings)
