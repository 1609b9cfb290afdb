"""What is right in a hard case: the outcome, and the tilt, uplifts and rests up to where motions part."""

import dataclasses
import functools
import math

import numpy as np

from analytic import Response, SampledMotion, Scene, simulate
from analytic.checks.closed_form import free_rocking_tilt, rest_time
from analytic.checks.time_stepping import simulate_time_stepping
from analytic.checks.twin import simulate_twin
from analytic.rocking import restitution
from analytic.solver import HISTORY_POINTS
from engines.comparison import changed_copies, outcome_of
from engines.simulating import outside

from ...metrics.errors import PERTURBATION, energy_errors, sensitivity_horizon
from .cases import FREE, HardCase, hard_cases

JUDGE_TOLERANCE = 1e-15  # of the kernel as the judge of others
LEAST_RESTITUTION = 1e-30  # in place of 0 in the closed form, which divides by its logarithm
LAST_PART = 0.1  # share of the run, at its end, over which a block at rest must not drift
STEP, COARSER = 2e-6, (2, 4, 8)  # of Moreau's time stepping [s], and how many times it in further runs
TIMES = 200  # about so many of the kernel's samples are compared with the closed form


@dataclasses.dataclass(frozen=True, eq=False)
class Oracle:
    """What is right in a hard case up to `until` [s].

    outcome: None where a change of 1e-4 in restitution, motion or start changes it. uplifts, rests: times [s]. settled:
    whether the block is at rest over the last part of the run. response: that of the solver that judges. noise: (energy
    drift, energy gain) that the measures themselves show on a right history; None where the block slides, because these
    measures do not know the work of friction.
    """

    case: HardCase
    outcome: str | None
    until: float
    uplifts: list[float]
    rests: list[float]
    settled: bool
    response: Response
    noise: tuple[float, float] | None

    def tilt(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the times [s] up to `until` at which the tilt is compared, and the tilt [rad] at them."""
        times = times[times <= self.until]
        if self.case.oracle != FREE:
            return times, column_at(self.response, times, "tilt")
        times, parameters = times[:: max(1, len(times) // TIMES)], _free_rocking(self.case.scene)
        return times, np.array([free_rocking_tilt(*parameters, time) for time in times])


@functools.cache
def comparable_until(name: str) -> tuple[float, bool]:
    """Return the time [s] up to which the trajectory can be compared, and whether the outcome can."""
    scene = hard_cases()[name].scene
    copies = (scene, *changed_copies(scene, PERTURBATION).values())
    outcome, *changed = (simulate(copy, history=False).outcome for copy in copies)
    return sensitivity_horizon(scene).horizon, all(other == outcome for other in changed)


def twin_step(scene: Scene) -> float:
    """Return the longest step of the twin [s]: its own choice, or less where interpolation to 1e-8 needs it."""
    longest, rates, motion = 0.005, [0.0], scene.motion
    if isinstance(motion, SampledMotion):
        longest = min(longest, 0.5 * motion.dt)
    elif motion is not None and motion.length > scene.end / HISTORY_POINTS:  # else no sample falls into it
        rates.append(motion.frequency)
    if scene.bearings is not None:
        stiffness, damping = (
            scene.bearings.count * constant for constant in (scene.bearings.ka, scene.bearings.damping)
        )
        rates += [math.sqrt(stiffness / scene.total_mass), damping / scene.total_mass]
    return min(longest, 0.05 / max(rates)) if max(rates) else longest


@functools.cache
def oracle(name: str, of_kernel: bool) -> Oracle:
    """Return the `Oracle` of the case `name`.

    of_kernel: whether it judges the kernel, which the twin does; the kernel judges all others.
    """
    case = hard_cases()[name]
    until, robust = comparable_until(name)
    response = simulate(case.scene, tolerance=JUDGE_TOLERANCE)
    noise = None
    if not response.sliding:  # which samples beside an uplift others leave out depends on their last digits
        noise = energy_errors(case.scene, response, until=until, step=case.step or 0.0, settle=0.0)
    if of_kernel:
        until, robust = min(until, case.twin_until), math.isinf(case.twin_until)
        short = case.scene if robust else case.scene.with_(duration=case.twin_until)
        response = simulate_twin(short, energy=False, max_step=twin_step(case.scene))
    if response.unstable_time is not None:  # beyond, two motions part exponentially
        until = min(until, response.unstable_time)
    lifts = outcome_of(case.scene, response) not in ("stands", "slides")
    outcome = case.expected.get("outcome", outcome_of(case.scene, response) if robust else None)
    uplifts, rests = ([t for t in times if t <= until and lifts] for times in (response.uplifts, response.rests))
    if "uplift time" in case.expected:
        uplifts[0] = case.expected["uplift time"]
    if case.oracle == FREE and rests:
        rests = [rest_time(*_free_rocking(case.scene))]
    last = response.rests[-1] if response.rests else math.inf
    at_rest = last < case.scene.duration * (1 - LAST_PART) and all(time < last for time in response.uplifts)
    return Oracle(case, outcome, until, uplifts, rests, outcome == "stands" or at_rest, response, noise)


def _free_rocking(scene: Scene) -> tuple[float, float, float, float]:
    """Parameters of the closed form of free rocking: omega_r [rad/s], slenderness, restitution, tilt [rad]."""
    e = max(restitution(scene), LEAST_RESTITUTION)
    return scene.rocking_frequency, scene.block.slenderness, e, scene.start.tilt


@functools.cache
def beyond_range(name: str) -> dict[str, float]:
    """Return {quantity: its value} for the quantities of a case outside the statue range, in the kernel's run."""
    scene = hard_cases()[name].scene
    return {
        str(property.quantity): float(property.value) for property in outside(scene, simulate(scene, history=False))
    }


SLIPS = ("peak slip", "end slip")


def slips(run: Response) -> tuple[float, float]:
    """Return the largest |slip| and the slip at the end [m]; both are 0 for a block that does not slide."""
    return (run.sliding.peak, run.sliding.end) if run.sliding else (0.0, 0.0)


def slip_errors(hard: HardCase, run: Response, judge: Response, unit: float) -> dict[str, float]:
    """Errors of the slips of a `run`, over `unit` [m].

    They are taken against the values known beforehand, else against those of the judge.
    """
    pairs = zip(SLIPS, slips(run), slips(judge), strict=True)
    return {name: abs(slip - hard.expected.get(name, other)) / unit for name, slip, other in pairs}


def slip_unit(scene: Scene, model: Response) -> float:
    """Return the largest slip of the model [m]; half the block's width where it does not slide."""
    return slips(model)[0] or scene.block.half_width


@functools.cache
def stepped(name: str) -> list[Response]:
    """Run a case with friction by Moreau's time stepping: first the run that judges, then those of coarser steps."""
    scene = hard_cases()[name].scene
    return [simulate_time_stepping(scene, step=STEP * factor, history=False) for factor in (1, *COARSER)]


def stepping_errors(hard: HardCase, model: Response) -> dict[str, float]:
    """Differences of the model's run from Moreau's time stepping, beyond the latter's own error, and this error.

    The error of time stepping is of first order in the step, but not monotonic: an event falls anywhere in a step. A
    run of eight times the step errs by about eight times as much. So the run that judges may err by as much as such a
    run, or one of a step between, differs from it. The measure "judge's doubt" is the largest of these errors.
    """
    judge, *coarser = stepped(hard.name)
    unit = slip_unit(hard.scene, model)
    errors = {"outcome": float(model.outcome != judge.outcome)}
    if model.uplifts and "uplift time" in hard.expected:
        errors["uplift time"] = abs(model.uplifts[0] - hard.expected["uplift time"])
    others, doubt = [_distances(hard, coarse, judge, unit) for coarse in coarser], 0.0
    for name, error in _distances(hard, model, judge, unit).items():
        error_of_judge = 0.0 if name in hard.expected else max(coarse.get(name, math.inf) for coarse in others)
        errors[name], doubt = max(0.0, error - error_of_judge), max(doubt, error_of_judge)
    return errors | {"judge's doubt": doubt}


def _distances(hard: HardCase, run: Response, judge: Response, unit: float) -> dict[str, float]:
    """Return {measure: distance of a run from the one that judges}, for slips and for tilt and displacement.

    Tilt and displacement are compared at their peak and at the end of the run.
    """
    differences, falls = slip_errors(hard, run, judge, unit), judge.overturning_time is not None
    if run.overturning_time is not None and judge.overturning_time is not None:
        differences["overturning time"] = abs(run.overturning_time - judge.overturning_time)
    columns = {"tilt": hard.scene.block.slenderness}
    if hard.scene.base is not None:
        columns["base_displacement"] = judge.peak_base_displacement
    for column, scale in columns.items():
        apart = [abs(getattr(run.end, column) - getattr(judge.end, column))]
        if not falls:  # the model's peaks leave the last fall out
            apart.append(abs(getattr(run, f"peak_{column}") - getattr(judge, f"peak_{column}")))
        differences[column.removeprefix("base_")] = max(apart) / scale
    return differences


RATES = {"tilt": "tilt_rate", "base_displacement": "base_velocity"}  # of the columns that are compared


def column_at(response: Response, times: np.ndarray, name: str) -> np.ndarray:
    """Interpolate a column of a history at `times`, by the cubic through both ends of each step.

    Beyond the end of the history it is the last value.
    """
    history = response.history
    t, y, v = history.time, getattr(history, name), getattr(history, RATES[name])
    i = np.clip(np.searchsorted(t, times, side="right") - 1, 0, len(t) - 2)
    h = t[i + 1] - t[i]
    u = np.clip((times - t[i]) / np.where(h > 0, h, 1.0), 0.0, 1.0)
    cubic = (
        (1 + 2 * u) * (1 - u) ** 2 * y[i]
        + u * (1 - u) ** 2 * h * v[i]
        + u * u * (3 - 2 * u) * y[i + 1]
        - u * u * (1 - u) * h * v[i + 1]
    )
    return np.where(times >= t[-1], y[-1], cubic)
