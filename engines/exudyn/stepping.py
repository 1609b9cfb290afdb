"""Stepping an exudyn model: loads before each step, the record after it, and the choice of integrator.

The ground motion enters as gravity does: in the ground's frame its acceleration acts on every mass.

A run with compliant corners uses two integrators of exudyn. Explicit steps lead through impacts, implicit steps through
the time in which contact does not change. A stiff corner needs thousands of explicit steps per second, even while the
block only pivots or stands. There exudyn's generalized-alpha method takes steps of a millisecond: the same errors at a
fifth of the CPU time. Both integrate the same corners and bearings, so a change of integrator changes no state and no
force.
"""

from __future__ import annotations

import math
import signal
import threading
import time
from array import array
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import exudyn as exu
import numpy as np

from analytic.motion import SampledMotion
from analytic.response import Failure
from analytic.rocking import RockingModel

from ..contract import Mismatch, Run
from ..loads import ground_gain, longest_step
from ..swings import Trace
from .scene import read_back, standing_until

if TYPE_CHECKING:
    from analytic import Scene

    from .scene import CompliantCorners, Model

ALL, END = 1.0, 1e-4  # `Ground.part` of explicit and of implicit steps
BEGIN, INITIAL = exu.ConfigurationType.StartOfStep, exu.ConfigurationType.Initial
OVERTURNED = math.pi / 2
# Limit of steps per rocking period of the scene, the first one counted double. The default level takes up to 3e4 per
# period where impacts are frequent. Bearings that are stiff or viscous for the mass of their base take as many as
# stability of explicit steps requires.
STEPS_PER_PERIOD = 300_000
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


class Ground:
    """Sets the loads of a scene's motion before each attempt of a step.

    part: share of the step, up to its end, whose mean acceleration is the load. An explicit step takes all of it, so
    that a jump of the acceleration gives its impulse. The implicit rules weigh the loads at both ends of a step.
    """

    def __init__(self, model: Model) -> None:
        scene, self.weight, self.push, self.part = model.scene, model.weight, model.push, END
        self.mass, self.gravity = scene.base_mass, scene.gravity
        self.across, self.up = ground_gain(scene.motion), ground_gain(scene.motion and scene.motion.vertical)

    def prepare(self, mbs: exu.MainSystem, t: float) -> bool:
        """Set the loads of an attempt of a step that would end at t (PreStep)."""
        begin = t - self.part * (t - mbs.systemData.GetTime(BEGIN))
        if t == begin:  # the last of steps that Newton's method makes shorter and shorter
            return True
        across = self.across(begin, t) / (t - begin) if self.across else 0.0
        up = self.up(begin, t) / (t - begin) if self.up else 0.0
        mbs.SetLoadParameter(self.weight, "loadVector", [-across, -self.gravity - up, 0.0])
        if self.push is not None:
            mbs.SetLoadParameter(self.push, "loadVector", [-self.mass * across, 0.0, 0.0])
        return True


class Steps:
    """Recorded steps of a run: times, states (coordinates, then velocities) and bearing forces.

    Arrays take 100 bytes per step, lists would take 500. limit: largest number of steps. interrupts: see
    `interruptible`. ended: whether the run must stop, by overturning, interrupt, the number of steps or a state that is
    not finite.
    """

    def __init__(self, scene: Scene) -> None:
        self.times, self.states, self.forces = array("d"), array("d"), array("d")
        self.interrupts: list[int] = []
        self.width = 4 if scene.base else 3  # coordinates of a state
        self.limit, self.ended = step_limit(scene), False

    def last(self) -> tuple[np.ndarray, np.ndarray]:
        """(coordinates, velocities) of the last step."""
        q, v = np.split(np.array(self.states[-2 * self.width :]), 2)
        return q, v


def recorder(
    model: Model, steps: Steps, goes_on: Callable[[float], bool] | None = None
) -> Callable[[exu.MainSystem, float], bool]:
    """Return the function that exudyn calls after each step (PostStep).

    It stores the step in `steps` and commits the histories of the model. It returns False, upon which exudyn stops,
    where the run must stop or `goes_on` (time) is false.
    """
    bearing, anchor, twist, system = model.bearing, model.anchor, model.twist, model.mbs.systemData
    times, states, forces, limit = steps.times, steps.states, steps.forces, steps.limit
    coordinates, velocities = system.GetODE2Coordinates, system.GetODE2Coordinates_t

    def record(mbs, t):
        if times and t <= times[-1]:
            return True  # exudyn also calls it where an integration starts
        q, v = coordinates(), velocities()
        times.append(t)
        states.frombytes(q.tobytes())
        states.frombytes(v.tobytes())
        if bearing is not None:
            forces.append(bearing.commit(mbs, q.item(3)) if bearing.nonlinear else bearing.z)
        if anchor is not None:
            anchor.commit(mbs)
        if twist is not None:
            twist.commit(mbs, t, q.item(2), v.item(2))
        # True for NaN, too
        steps.ended = not (-OVERTURNED < q.item(2) < OVERTURNED and len(times) <= limit and not steps.interrupts)
        return not steps.ended and (goes_on is None or goes_on(t))

    return record


def step_through(
    model: Model, drive: Callable[[Model, Steps], Failure | None], contact_tilt: float, settle: float = 0.0
) -> Run:
    """Run a model to the scene's end, overturning or failure.

    Parameters
    ----------
    model : Model
        A model with contact.
    drive : callable
        (model, steps) -> failure or None: sets exudyn's user functions and runs the integration. A `recorder` fills
        the steps.
    contact_tilt : float
        See `Trace` [rad].
    settle : float
        See `Trace` [s].
    """
    exu.config.printToConsole = False
    scene, steps = model.scene, Steps(model.scene)
    check(model)
    began = time.process_time()
    try:
        with interruptible() as steps.interrupts:
            failure = drive(model, steps)
    finally:
        release(model.mbs)
    cpu = time.process_time() - began
    if failure is None and len(steps.times) > steps.limit:
        failure = Failure(
            "the run took too many steps",
            f"{steps.limit} steps reached t = {steps.times[-1]:.9g} s of {scene.duration:.9g} s",
        )
    trace = _trace(model, steps, contact_tilt, settle)
    ended = "overturned" if trace is not None and abs(trace.tilt[-1]) >= OVERTURNED else None
    return Run(trace, len(steps.times) - 1, cpu, failure, ended)


@contextmanager
def interruptible() -> Iterator[list[Any]]:
    """Context in which a run of exudyn ends at Ctrl-C, as Python code does.

    exudyn takes a KeyboardInterrupt raised in a user function for a failure of its solver. The signal is therefore only
    recorded, the user functions stop the run, and the signal is sent again afterwards.

    Yields
    ------
    list
        Not empty after the signal.
    """
    interrupts: list[int]
    interrupts, handler = [], signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or not callable(handler):
        yield interrupts  # not the main thread, or no such signal
        return
    signal.signal(signal.SIGINT, lambda number, frame: interrupts.append(number))
    try:
        yield interrupts
    finally:
        signal.signal(signal.SIGINT, handler)
        if interrupts:
            signal.raise_signal(signal.SIGINT)


def step_limit(scene: Scene) -> int:
    """Largest number of steps of a run of a scene."""
    return int(STEPS_PER_PERIOD * (2 + scene.duration * scene.rocking_frequency / (2 * math.pi)))


def check(model: Model) -> None:
    """Assemble a model and check that exudyn holds the values of the scene.

    Raises
    ------
    Mismatch
        Names each quantity with both values.
    """
    model.mbs.Assemble()
    wrong = [
        f"{name} is {held!r} in exudyn, {wanted!r} in the scene"
        for name, (held, wanted) in read_back(model).items()
        if held != wanted
    ]
    if wrong:
        raise Mismatch("; ".join(wrong))


def release(mbs: exu.MainSystem) -> None:
    """Remove the user functions from a system after its run.

    They form a reference cycle through exudyn that the garbage collector cannot detect. Without this, each run leaks
    400 bytes a step (40 MB for 100 000 steps) and the segments of the ground motion.
    """
    mbs.SetPreStepUserFunction(0)
    mbs.SetPostStepUserFunction(0)


def _trace(model: Model, steps: Steps, contact_tilt: float, settle: float) -> Trace | None:
    """The `Trace` of the recorded steps, or None where there are fewer than two."""
    t, z, bearing = np.asarray(steps.times), steps.forces, model.bearing
    q, v = np.split(np.asarray(steps.states).reshape(-1, 2 * steps.width), 2, axis=1)
    if bearing:
        t, q, v = t[: len(z)], q[: len(z)], v[: len(z)]  # without a step whose history was not committed
    if len(t) < 2:
        return None
    x, speed = (q[:, 3], v[:, 3]) if model.scene.base else (np.zeros_like(t), np.zeros_like(t))
    force = bearing.law.force(x, np.asarray(z), speed) if bearing else np.zeros_like(t)
    centre = np.column_stack([q[:, :2], v[:, :2]])
    return Trace(t, -q[:, 2], -v[:, 2], x, speed, force, contact_tilt, settle, centre)


def solver_settings(scene: Scene, **time_integration: Any) -> exu.SimulationSettings:
    """exudyn's settings for one scene, without output.

    time_integration: fields of its time integration and their values.
    """
    settings = exu.SimulationSettings()
    settings.solution.file.write = False
    settings.solution.solverInformationFileName = ""
    settings.timeIntegration.verboseMode = 0
    settings.timeIntegration.endTime = scene.duration
    explicit = settings.timeIntegration.explicit  # for features that no scene has; a step takes 15 % less time
    explicit.useLieGroupIntegration = explicit.eliminateConstraints = False
    explicit.computeEndOfStepAccelerations = False
    for name, value in time_integration.items():
        setattr(settings.timeIntegration, name, value)
        held = getattr(settings.timeIntegration, name)
        if held != value:
            raise Mismatch(f"timeIntegration.{name} is {held!r} in exudyn, {value!r} was set")
    return settings


def solve(solver: Any, mbs: exu.MainSystem, settings: exu.SimulationSettings) -> Failure | None:
    """Run a solver of exudyn; return the failure with its message, or None."""
    try:
        done = solver.SolveSystem(mbs, settings)
    except exu.ExudynError as error:
        return Failure("the solver stopped with an error", f"{error} {solver.GetErrorString()}".strip())
    return None if done else Failure("the solver gave up", solver.GetErrorString())


def in_one_go(model: Model, settings: exu.SimulationSettings, steps: Steps) -> Failure | None:
    """Integrate by the implicit trapezoidal rule in equal steps; a `drive` of `step_through`."""
    mbs, integration = model.mbs, settings.timeIntegration
    integration.solverType = exu.DynamicSolverType.TrapezoidalIndex2
    integration.generalizedAlpha.useNewmark = integration.generalizedAlpha.useIndex2Constraints = True
    mbs.SetPostStepUserFunction(recorder(model, steps))
    if model.scene.motion is not None:
        mbs.SetPreStepUserFunction(Ground(model).prepare)
    solver = exu.MainSolverImplicitSecondOrder()
    return solve(solver, mbs, settings)


class Phases:
    """The parts of a run with compliant corners: each is integrated by one of the two solvers.

    settings: scaled to the scene. sink: penetration of a corner under half the weight [m]. settle: relaxation time
    after a change of contact [s]. early: time before a landing whose steps are explicit [s]; implicit steps make the
    error of e under a couple ten times as large.
    """

    def __init__(
        self, model: Model, settings: CompliantCorners, steps: Steps, *, sink: float, settle: float, early: float
    ) -> None:
        scene, self.model, self.steps = model.scene, model, steps
        self.shape = scene.block.half_width, scene.block.half_height, 2 * CARRIES * sink
        step, self.longest = settings.pivoting_step, settings.longest_step
        smooth, self.settle = SMOOTH * longest_step(scene, step / SMOOTH), settle
        self.dt = scene.motion.dt if isinstance(scene.motion, SampledMotion) else math.inf
        self.step = self.dt / math.ceil(self.dt / smooth) if self.dt < math.inf else smooth
        self.ahead, rocking = AHEAD * self.step + early, RockingModel.of(scene)
        self.fallen = 0.5 * PUSHED * rocking.m * rocking.g * scene.block.half_width / rocking.J * self.ahead**2
        self.implicit = self.quiet = False  # the integrator now; whether contact is quiet after the last step
        self.contact: tuple[object, ...] = ()  # of either corner, and the place of a block that slides
        self.changed = 0.0  # time of the last change of contact
        # Time from which steps may be implicit: where Newton's method fails they are explicit for a while.
        self.implicit_from = 0.0 if smooth >= WORTHWHILE * step else math.inf
        self.record, self.ground = recorder(model, steps, self.goes_on), Ground(model)
        model.mbs.SetPostStepUserFunction(self.record)
        if scene.motion:
            model.mbs.SetPreStepUserFunction(self.ground.prepare)
        self.solvers = self._explicit(settings), self._implicit(sink)

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

    def _implicit(self, sink):
        """exudyn's implicit solver with its settings."""
        block, gravity = self.model.scene.block, self.model.scene.gravity
        settings = solver_settings(
            self.model.scene,
            solverType=exu.DynamicSolverType.GeneralizedAlpha,
            automaticStepSize=False,
            adaptiveStep=False,
        )
        newton, weight = settings.timeIntegration.newton, block.mass * gravity
        newton.absoluteTolerance = max(RESIDUAL * weight, ROUNDING * block.radius * weight / (2 * sink))
        # Numerical differentiation uses a share of the corner's penetration, so that the corner stays in contact.
        newton.numericalDifferentiation.minimumCoordinateSize = 1.0
        newton.numericalDifferentiation.relativeEpsilon = DIFFERENCE * sink / block.radius
        return exu.MainSolverImplicitSecondOrder(), settings

    def goes_on(self, t: float) -> bool:
        """Whether the same integrator takes the step after that to t.

        Contact is quiet, and steps are implicit, where it has not changed for a while and will not change in the next
        steps.
        """
        states, width, (b, h, least) = self.steps.states, self.steps.width, self.shape
        up, turn, rate = states[1 - 2 * width], states[2 - 2 * width], states[2 - width]
        drop, lean = h * (math.cos(turn) - 1) - up - least, b * math.sin(turn)
        left, right = drop + lean >= 0, drop - lean >= 0
        contact = left, right, self.model.anchor and self.model.anchor.at
        if contact != self.contact or not (left or right):
            self.contact, self.changed = contact, t  # a corner landed, lifted or slid
        self.quiet = (
            t - self.changed >= self.settle
            and t >= self.implicit_from
            and (left and right or abs(turn) + math.copysign(rate, turn * rate) * self.ahead > self.fallen)
        )
        return self.quiet == self.implicit

    def run(self) -> Failure | None:
        """Step to the scene's end, to overturning or to the limit of steps; return exudyn's failure, or None."""
        steps, scene = self.steps, self.model.scene
        begin, duration = standing_until(scene), scene.duration
        for t in sorted({0.0, begin}):
            self.record(self.model.mbs, t)
        jumps = [t for t in scene.motion.jumps if begin < t < duration] if scene.motion else []
        for self.end in (*jumps, duration):
            self.changed, self.quiet = steps.times[-1], False  # a jump may lift a standing block in one implicit step
            while steps.times[-1] < self.end - SUMS * duration:
                count, self.implicit = len(steps.times), self.quiet
                failure = self._integrate_part(steps.times[-1])
                if failure and not self.implicit:
                    return failure
                if failure:
                    self.implicit_from, self.quiet = steps.times[-1] + self.settle, False
                elif steps.ended:
                    return None
                elif len(steps.times) == count:
                    return Failure("the solver made no step", f"from {steps.times[-1]:.9g} s")
        return None

    def _implicit_end(self, t):
        """End [s] of equal implicit steps from t: a record bends at its samples, which they must meet."""
        sample, last = t / self.dt, math.floor(self.end / self.dt + WHOLE)
        if abs(sample - round(sample)) > WHOLE:
            return min(math.ceil(sample) * self.dt, self.end)
        return last * self.dt if round(sample) < last else self.end

    def _integrate_part(self, t):
        """Integrate from the last step, at t, to the next change of integrator or jump; return the failure.

        A jump is one of the ground's acceleration.
        """
        mbs, (solver, settings), (q, v) = self.model.mbs, self.solvers[self.implicit], self.steps.last()
        mbs.systemData.SetODE2Coordinates(q, configuration=INITIAL)
        mbs.systemData.SetODE2Coordinates_t(v, configuration=INITIAL)
        integration, end = settings.timeIntegration, self._implicit_end(t) if self.implicit else self.end
        self.ground.part = END if self.implicit else ALL
        integration.startTime, integration.endTime = t, end
        integration.numberOfSteps = math.ceil((end - t) / (self.step if self.implicit else self.longest) - WHOLE)
        integration.initialStepSize = min(end - t, FIRST * self.longest)
        return solve(solver, mbs, settings)
