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

    from .model import Bearing, Model

OVERTURNED = math.pi / 2

# Steps after which a run is given up: so many per rocking period of the scene, the first one counted double. The
# defaults take up to 3e4 per period where impacts are frequent; bearings that are stiff or viscous for the mass of
# their base take what the stability of explicit steps asks for.
STEPS_PER_PERIOD = 300_000


@contextmanager
def interruptible() -> Iterator[list[Any]]:
    """Runs of exudyn in here end at Ctrl-C, as Python code does.

    exudyn takes the KeyboardInterrupt that Python raises in a user function for a failure of its solver. So the
    signal is only noted, the user functions stop the run, and the signal comes again, to its handler, afterwards.

    Yields
    ------
    list
        Not empty once the signal has come.
    """
    came: list[int]
    came, handler = [], signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or not callable(handler):
        yield came  # signals are handled elsewhere, or not at all
        return
    signal.signal(signal.SIGINT, lambda number, frame: came.append(number))
    try:
        yield came
    finally:
        signal.signal(signal.SIGINT, handler)
        if came:
            signal.raise_signal(signal.SIGINT)


def step_limit(scene: Scene) -> int:
    """Number of steps after which a run of a scene is given up."""
    return int(STEPS_PER_PERIOD * (2 + scene.duration * scene.rocking_frequency / (2 * math.pi)))


def solver_settings(scene: Scene, **time_integration: Any) -> exu.SimulationSettings:
    """Silent exudyn settings for one scene; the time integration's fields as given."""
    settings = exu.SimulationSettings()
    settings.solution.file.write = False
    settings.solution.solverInformationFileName = ""
    settings.timeIntegration.verboseMode = 0
    settings.timeIntegration.endTime = scene.duration
    explicit = settings.timeIntegration.explicit  # for what no scene has; without it a step costs 15 % less
    explicit.useLieGroupIntegration = explicit.eliminateConstraints = False
    explicit.computeEndOfStepAccelerations = False
    for name, value in time_integration.items():
        setattr(settings.timeIntegration, name, value)
        held = getattr(settings.timeIntegration, name)
        if held != value:
            raise Mismatch(f"timeIntegration.{name} is {held!r} in exudyn, {value!r} was set")
    return settings


class Steps:
    """What is recorded of a run: times, states (coordinates, then velocities) and bearing forces, step after step.

    Not in lists: a step costs 100 bytes instead of 500. interrupts: as of `interruptible`. ended: the run is not to go
    on, by overturning, interrupt, the number of steps or a state that is not finite.
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
        With its contact.
    drive : callable
        (model, steps, record) -> failure or None: sets exudyn's user functions and lets it integrate; record, called
        after a step, keeps it in steps and says whether to go on.
    contact_tilt : float
        For the trace [rad].
    settle : float
        For the trace [s].
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
    q, v = np.split(np.asarray(steps.states).reshape(-1, 2 * steps.width), 2, axis=1)
    trace = make_trace(scene, np.asarray(steps.times), q, v, steps.forces, model.bearing, contact_tilt, settle)
    ended = "overturned" if trace is not None and abs(trace.tilt[-1]) >= OVERTURNED else None
    return Run(trace, len(steps.times) - 1, cpu, failure, ended)


def _recorder(model, steps, limit):
    """exudyn's function after each step: keeps it in `steps` and says whether to go on, at most for `limit` of them."""
    bearing, anchor, system = model.bearing, model.anchor, model.mbs.systemData
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
            anchor.commit(mbs, q, v)
        # Not for NaN either
        steps.ended = not (-OVERTURNED < q.item(2) < OVERTURNED and len(times) <= limit and not steps.interrupts)
        return not steps.ended

    return keep


def in_one_go(
    model: Model, settings: exu.SimulationSettings, steps: Steps, record: Callable[..., bool]
) -> Failure | None:
    """Drive a model by the implicit trapezoidal rule in equal steps, as `step_through` asks."""
    mbs, integration = model.mbs, settings.timeIntegration
    integration.solverType = exu.DynamicSolverType.TrapezoidalIndex2
    integration.generalizedAlpha.useNewmark = integration.generalizedAlpha.useIndex2Constraints = True
    mbs.SetPostStepUserFunction(record)
    if model.scene.motion is not None:
        mbs.SetPreStepUserFunction(Ground(model).prepare)
    solver = exu.MainSolverImplicitSecondOrder()
    return solve(solver, mbs, settings)


def solve(solver: Any, mbs: exu.MainSystem, settings: exu.SimulationSettings) -> Failure | None:
    """Let a solver of exudyn integrate; what it says where it fails, or None."""
    try:
        done = solver.SolveSystem(mbs, settings)
    except exu.ExudynError as error:
        return Failure("the solver stopped with an error", f"{error} {solver.GetErrorString()}".strip())
    return None if done else Failure("the solver gave up", solver.GetErrorString())


def release(mbs: exu.MainSystem) -> None:
    """Take the user functions out of a system that has run.

    With them the system and what they hold are alive as long as the process, in a cycle through exudyn that the
    garbage collector does not see: 400 bytes a step (40 MB a run of 100 000), and the segments of the ground motion.
    """
    mbs.SetPreStepUserFunction(0)
    mbs.SetPostStepUserFunction(0)


def check(model: Model) -> None:
    """Assemble a model and refuse one in which exudyn holds other values than the scene.

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


def make_trace(
    scene: Scene,
    t: np.ndarray,
    q: np.ndarray,
    v: np.ndarray,
    z: array,
    bearing: Bearing | None,
    contact_tilt: float,
    settle: float,
) -> Trace | None:
    """The `Trace` of the recorded steps, or None where there are fewer than two."""
    if bearing:
        t, q, v = t[: len(z)], q[: len(z)], v[: len(z)]  # a step whose history could not be committed is not a step
    if len(t) < 2:
        return None
    x, speed = (q[:, 3], v[:, 3]) if scene.base else (np.zeros_like(t), np.zeros_like(t))
    force = bearing.law.force(x, np.asarray(z), speed) if bearing else np.zeros_like(t)
    centre = np.column_stack([q[:, :2], v[:, :2]])
    return Trace(t, -q[:, 2], -v[:, 2], x, speed, force, contact_tilt, settle, centre)
