"""Stepping an exudyn model: record the accepted steps, commit the bearing's history, stop at overturning."""

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

from analytic.response import Failure

from ..contract import Mismatch, Run
from ..swings import Trace
from .ground import Ground
from .scene import read_back

if TYPE_CHECKING:
    from analytic import Scene

    from .model import Model

OVERTURNED = math.pi / 2

# Limit of steps per rocking period of the scene, the first one counted double. The default level takes up to 3e4 per
# period where impacts are frequent. Bearings that are stiff or viscous for the mass of their base take as many as
# stability of explicit steps requires.
STEPS_PER_PERIOD = 300_000


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
    came: list[int]
    came, handler = [], signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or not callable(handler):
        yield came  # not the main thread, or no such signal
        return
    signal.signal(signal.SIGINT, lambda number, frame: came.append(number))
    try:
        yield came
    finally:
        signal.signal(signal.SIGINT, handler)
        if came:
            signal.raise_signal(signal.SIGINT)


def step_limit(scene: Scene) -> int:
    """Largest number of steps of a run of a scene."""
    return int(STEPS_PER_PERIOD * (2 + scene.duration * scene.rocking_frequency / (2 * math.pi)))


def solver_settings(scene: Scene, **time_integration: Any) -> exu.SimulationSettings:
    """exudyn settings for one scene, without output; fields of the time integration as given."""
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


class Steps:
    """Recorded steps of a run: times, states (coordinates, then velocities) and bearing forces.

    Arrays take 100 bytes per step, lists would take 500. interrupts: see `interruptible`. ended: the run must stop, by
    overturning, interrupt, the number of steps or a state that is not finite.
    """

    def __init__(self, width: int) -> None:
        self.times, self.states, self.forces = array("d"), array("d"), array("d")
        self.interrupts: list[int] = []
        self.width, self.ended = width, False  # width: coordinates of a state

    def last(self) -> tuple[np.ndarray, np.ndarray]:
        """(coordinates, velocities) of the last step."""
        q, v = np.split(np.array(self.states[-2 * self.width :]), 2)
        return q, v


def step_through(
    model: Model,
    drive: Callable[[Model, Steps, Callable[..., bool]], Failure | None],
    contact_tilt: float,
    settle: float = 0.0,
) -> Run:
    """Run a model to the scene's end, overturning or failure.

    Parameters
    ----------
    model : Model
        A model with contact.
    drive : callable
        (model, steps, record) -> failure or None: sets exudyn's user functions and runs the integration. record, called
        after a step, stores it in steps and returns whether to continue.
    contact_tilt : float
        See `Trace` [rad].
    settle : float
        See `Trace` [s].
    """
    exu.config.printToConsole = False
    scene, mbs, limit = model.scene, model.mbs, step_limit(model.scene)
    check(model)
    steps = Steps(4 if scene.base else 3)
    began = time.process_time()
    try:
        with interruptible() as steps.interrupts:
            failure = drive(model, steps, _recorder(model, steps, limit))
    finally:
        release(mbs)
    cpu = time.process_time() - began
    if failure is None and len(steps.times) > limit:
        failure = Failure(
            "the run took too many steps",
            f"{limit} steps reached t = {steps.times[-1]:.9g} s of {scene.duration:.9g} s",
        )
    trace = _trace(model, steps, contact_tilt, settle)
    ended = "overturned" if trace is not None and abs(trace.tilt[-1]) >= OVERTURNED else None
    return Run(trace, len(steps.times) - 1, cpu, failure, ended)


def _recorder(model, steps, limit):
    """Function to call after each step: stores it in `steps` and returns whether to continue, up to `limit` steps."""
    bearing, anchor, twist, system = model.bearing, model.anchor, model.twist, model.mbs.systemData
    times, states, forces = steps.times, steps.states, steps.forces
    coordinates, velocities = system.GetODE2Coordinates, system.GetODE2Coordinates_t

    def keep(mbs, t):
        q, v = coordinates(), velocities()
        times.append(t)
        states.frombytes(q.tobytes())
        states.frombytes(v.tobytes())
        if bearing is not None:
            forces.append(bearing.commit(mbs, q.item(3)))
        if anchor is not None:
            anchor.commit(mbs)
        if twist is not None:
            twist.commit(mbs, t, q.item(2), v.item(2))
        # False for NaN, too
        steps.ended = not (-OVERTURNED < q.item(2) < OVERTURNED and len(times) <= limit and not steps.interrupts)
        return not steps.ended

    return keep


def in_one_go(
    model: Model, settings: exu.SimulationSettings, steps: Steps, record: Callable[..., bool]
) -> Failure | None:
    """`drive` of `step_through` by the implicit trapezoidal rule in equal steps."""
    mbs, integration = model.mbs, settings.timeIntegration
    integration.solverType = exu.DynamicSolverType.TrapezoidalIndex2
    integration.generalizedAlpha.useNewmark = integration.generalizedAlpha.useIndex2Constraints = True
    mbs.SetPostStepUserFunction(record)
    if model.scene.motion is not None:
        mbs.SetPreStepUserFunction(Ground(model).prepare)
    solver = exu.MainSolverImplicitSecondOrder()
    return solve(solver, mbs, settings)


def solve(solver: Any, mbs: exu.MainSystem, settings: exu.SimulationSettings) -> Failure | None:
    """Run a solver of exudyn; the failure with its message, or None."""
    try:
        done = solver.SolveSystem(mbs, settings)
    except exu.ExudynError as error:
        return Failure("the solver stopped with an error", f"{error} {solver.GetErrorString()}".strip())
    return None if done else Failure("the solver gave up", solver.GetErrorString())


def release(mbs: exu.MainSystem) -> None:
    """Remove the user functions from a system after its run.

    They form a reference cycle through exudyn that the garbage collector cannot detect. Without this, each run leaks
    400 bytes a step (40 MB for 100 000 steps) and the segments of the ground motion.
    """
    mbs.SetPreStepUserFunction(0)
    mbs.SetPostStepUserFunction(0)


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
