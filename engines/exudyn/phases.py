"""Two integrators of exudyn for one model: explicit steps through impacts, implicit ones while contact does not change.

A stiff corner needs thousands of explicit steps per second, even while the block only pivots or stands. There exudyn's
generalized-alpha method takes steps of a millisecond: the same errors at a fifth of the CPU time. Both integrate the
same corners and bearings: a change of integrator changes no state and no force.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import exudyn as exu

from analytic.motion import SampledMotion
from analytic.response import Failure
from analytic.rocking import RockingModel

from ..vibration import longest_step
from .ground import ALL, END, Ground
from .scene import standing_until
from .stepping import solve, solver_settings

if TYPE_CHECKING:
    from collections.abc import Callable

    from .model import Model
    from .sizing import CompliantCorners
    from .stepping import Steps

INITIAL = exu.ConfigurationType.Initial

# Number of steps to the impact at which implicit steps end; rate that a base may cause meanwhile, over that of the
# block's free fall. With 2 and 1 peaks of swings of a thousandth of the slenderness are off by .05, not .01.
AHEAD, PUSHED = 4.0, 3.0
CARRIES = 0.1  # least share of the weight on a loaded corner; .2 gives the same errors
# Implicit steps shorter than this share of `pivoting_step`, as stiff bearings need, are slower than explicit ones.
WORTHWHILE = 0.1
# Share of the step of leapfrog engines where bearings vibrate: the phase error is (h omega)^2/12 per radian.
SMOOTH = 0.075
LEAST_STEP = 1e-13  # s; exudyn stops where it would need a shorter one
SUMS = 1e-12  # round-off of a sum of steps, over the duration
WHOLE = 1e-6  # tolerated excess of a time over a whole number of steps, in steps
FIRST = 2e-3  # of the longest explicit step: the first step of a part
# Residual of Newton's method, over the block's weight; at least the corner force from some rounding errors of a
# coordinate, below which Newton's method does not converge.
RESIDUAL, ROUNDING = 1e-7, 30 * 2.0**-52
DIFFERENCE = 0.02  # of a corner's penetration: exudyn's increment in numerical differentiation


class Phases:
    """The choice of integrator at each step, and the parts of exudyn's time integration that follow from it.

    settings: scaled to the scene. sink: penetration of a corner under half the weight [m]. settle: relaxation time
    after a change of contact [s]. early: time before a landing whose steps are explicit: implicit ones make e of a
    couple ten times as far off [s].
    """

    def __init__(
        self,
        model: Model,
        settings: CompliantCorners,
        steps: Steps,
        record: Callable[..., bool],
        *,
        sink: float,
        settle: float,
        early: float,
    ) -> None:
        scene, self.model, self.steps, self.record = model.scene, model, steps, record
        self.shape = scene.block.half_width, scene.block.half_height, 2 * CARRIES * sink
        step, self.longest = settings.pivoting_step, settings.longest_step
        smooth, self.settle = SMOOTH * longest_step(scene, step / SMOOTH), settle
        self.dt = scene.motion.dt if isinstance(scene.motion, SampledMotion) else math.inf
        self.step = self.dt / math.ceil(self.dt / smooth) if self.dt < math.inf else smooth
        self.ahead, rocking = AHEAD * self.step + early, RockingModel.of(scene)
        self.fallen = 0.5 * PUSHED * rocking.m * rocking.g * scene.block.half_width / rocking.J * self.ahead**2
        self.implicit, self.since = False, 0.0
        self.contact: tuple[object, ...] = ()  # of either corner, and the place of a block that slides
        # Since this time the steps may be implicit: where Newton's method fails they are explicit for a while.
        self.free = 0.0 if smooth >= WORTHWHILE * step else math.inf
        model.mbs.SetPostStepUserFunction(self.keep)
        self.ground = Ground(model)
        if scene.motion:
            model.mbs.SetPreStepUserFunction(self.ground.prepare)
        self.solvers = self._explicit(settings), self._smooth(sink)

    def _explicit(self, settings):
        """exudyn's explicit solver with its settings."""
        return exu.MainSolverExplicit(), solver_settings(
            self.model.scene,
            solverType=exu.DynamicSolverType.DOPRI5,
            automaticStepSize=True,
            minimumStepSize=LEAST_STEP,
            relativeTolerance=1e-14,  # round-off: with 0 the steps never end after a shock that overflows
            absoluteTolerance=settings.tolerance,
        )

    def _smooth(self, sink):
        """exudyn's implicit solver with its settings."""
        block, gravity = self.model.scene.block, self.model.scene.gravity
        made = solver_settings(
            self.model.scene,
            solverType=exu.DynamicSolverType.GeneralizedAlpha,
            automaticStepSize=False,
            adaptiveStep=False,
        )
        newton, weight = made.timeIntegration.newton, block.mass * gravity
        newton.absoluteTolerance = max(RESIDUAL * weight, ROUNDING * block.radius * weight / (2 * sink))
        # Numerical differentiation uses a share of the corner's penetration, so that the corner stays in contact.
        newton.numericalDifferentiation.minimumCoordinateSize = 1.0
        newton.numericalDifferentiation.relativeEpsilon = DIFFERENCE * sink / block.radius
        return exu.MainSolverImplicitSecondOrder(), made

    def keep(self, mbs: exu.MainSystem, t: float) -> bool:
        """After each step (PostStep): record it; False ends the run, or a part of it."""
        if t <= self.steps.times[-1]:
            return True  # exudyn also calls it at the start of each part
        return self.record(mbs, t) and self.quiet(t) == self.implicit

    def quiet(self, t: float) -> bool:
        """Whether contact has not changed for a while before the last step, and will not change in the next steps."""
        states, width, (b, h, least) = self.steps.states, self.steps.width, self.shape
        up, turn, rate = states[1 - 2 * width], states[2 - 2 * width], states[2 - width]
        drop, lean = h * (math.cos(turn) - 1) - up - least, b * math.sin(turn)
        left, right = drop + lean >= 0, drop - lean >= 0
        contact = left, right, self.model.anchor and self.model.anchor.at
        if contact != self.contact or not (left or right):
            self.contact, self.since = contact, t  # a corner landed, lifted or slid
        if t - self.since < self.settle or t < self.free:
            return False
        return left and right or abs(turn) + math.copysign(rate, turn * rate) * self.ahead > self.fallen

    def run(self) -> Failure | None:
        """Step to the scene's end, to overturning or to the limit of steps; exudyn's failure, or None."""
        steps, scene = self.steps, self.model.scene
        begin, duration = standing_until(scene), scene.duration
        for t in sorted({0.0, begin}):
            self.record(self.model.mbs, t)
        jumps = [t for t in scene.motion.jumps if begin < t < duration] if scene.motion else []
        for self.end in (*jumps, duration):
            self.since = steps.times[-1]  # a jump may lift a standing block within one implicit step
            while steps.times[-1] < self.end - SUMS * duration:
                count = len(steps.times)
                self.implicit = self.quiet(steps.times[-1])
                failure = self._piece(steps.times[-1])
                if failure and not self.implicit:
                    return failure
                if failure:
                    self.free = steps.times[-1] + self.settle
                elif steps.ended:
                    return None
                elif len(steps.times) == count:
                    return Failure("the solver made no step", f"from {steps.times[-1]:.9g} s")
        return None

    def _meets(self, t):
        """End [s] of equal implicit steps from t: a record bends at its samples, which they must meet."""
        now, last = t / self.dt, math.floor(self.end / self.dt + WHOLE)
        if abs(now - round(now)) > WHOLE:
            return min(math.ceil(now) * self.dt, self.end)
        return last * self.dt if round(now) < last else self.end

    def _piece(self, t):
        """Integrate from the last step to the next change of integrator or jump of the ground's acceleration; the
        failure."""
        mbs, (solver, settings), (q, v) = self.model.mbs, self.solvers[self.implicit], self.steps.last()
        mbs.systemData.SetODE2Coordinates(q, configuration=INITIAL)
        mbs.systemData.SetODE2Coordinates_t(v, configuration=INITIAL)
        integration, end = settings.timeIntegration, self._meets(t) if self.implicit else self.end
        self.ground.part = END if self.implicit else ALL
        integration.startTime, integration.endTime = t, end
        integration.numberOfSteps = math.ceil((end - t) / (self.step if self.implicit else self.longest) - WHOLE)
        integration.initialStepSize = min(end - t, FIRST * self.longest)
        return solve(solver, mbs, settings)
