"""What is measured in one run of a hard case: errors against the case's oracle, drift, gained energy, lost events."""

from __future__ import annotations

import dataclasses
import functools
import math
from typing import TYPE_CHECKING, Any

import numpy as np

from analytic import simulate
from analytic.closed_form import free_rocking, free_rocking_tilt, rest_time
from analytic.rocking import restitution
from analytic.twin import simulate_twin
from engines.comparison import changed_copies

from ...measuring.errors import energy_errors
from ...measuring.horizon import PERTURBATION, sensitivity_horizon
from .cases import hard_cases

if TYPE_CHECKING:
    from analytic import Response, Scene

    from ...running.cases import Case

JUDGE_TOLERANCE = 1e-15  # of the kernel where it judges others
# Impacts are counted down to this share of the strongest one's rate, but not below 1e-3 omega_r slenderness, which
# moves nothing: engines rest earlier than the model. A run's own impacts count from OWN of that, for their rates err.
LEAST_RATE, LEAST_SHARE, OWN = 0.05, 1e-3, 0.95
LAST_PART = 0.1  # share of the run, at its end, over which a block at rest must not drift


@dataclasses.dataclass(frozen=True, eq=False)
class Oracle:
    """What is right: times [s] with tilt [rad] and base displacement [m]; events; up to `until` [s].

    outcome is None where a change of 1e-4 in restitution, motion or start changes it. settled: the block is at rest
    over the last part of the run. response: whose history is the trajectory. noise: (energy drift, energy gain) that
    the measures themselves show on a right history.
    """

    outcome: str | None
    overturning_time: float | None
    uplifts: tuple
    rests: tuple
    settled: bool
    until: float
    response: object
    noise: tuple


@functools.cache
def _case(name):
    return hard_cases()[name]


@functools.cache
def comparable_until(name: str) -> tuple[float, bool]:
    """(time [s] up to which the trajectory can be compared, whether the outcome can)."""
    scene = _case(name).scene
    until = sensitivity_horizon(scene).horizon
    outcome = simulate(scene, history=False).outcome
    robust = all(
        simulate(copy, history=False).outcome == outcome for copy in changed_copies(scene, PERTURBATION).values()
    )
    return until, robust


def twin_step(scene: Scene) -> float:
    """Longest step of the twin [s]: its own choice, but short enough to interpolate in to 1e-8."""
    longest = 0.005
    if hasattr(scene.motion, "dt"):
        longest = min(longest, 0.5 * scene.motion.dt)
    if scene.bearings is not None:
        longest = min(longest, 0.05 / math.sqrt(scene.bearings.count * scene.bearings.ka / scene.total_mass))
    return longest


@functools.cache
def oracle(name: str, of_kernel: bool) -> Oracle:
    """The `Oracle` of the case `name`: the twin for the kernel, the kernel for all others."""
    case = _case(name)
    until, robust = comparable_until(name)
    response = simulate(case.scene, tolerance=JUDGE_TOLERANCE)
    noise = energy_errors(case.scene, response, until=until, step=case.step or 0.0)
    if of_kernel:
        until, robust = min(until, case.twin_until), math.isinf(case.twin_until)
        short = case.scene if robust else case.scene.with_(duration=case.twin_until)
        response = simulate_twin(short, energy=False, max_step=twin_step(case.scene))
    outcome = case.expected.get("outcome", response.outcome if robust else None)
    if response.unstable_time is not None:  # beyond, two motions part exponentially
        until = min(until, response.unstable_time)
    last = case.scene.duration * (1 - LAST_PART)
    settled = outcome == "stands" or (
        bool(response.rests)
        and response.rests[-1] < last
        and all(time < response.rests[-1] for time in response.uplifts)
    )
    return Oracle(outcome, response.overturning_time, response.uplifts, response.rests, settled, until, response, noise)


def measure(run: Case, response: Response) -> dict[str, Any]:
    """Errors of one run, name -> number, and its outcome; see `MEASURES` for the units.

    What does not apply is left out. run: a `Case` whose tag names the hard case.
    """
    case = _case(run.tag["case"])
    scene, of_kernel = case.scene, response.engine == "analytic"
    truth = oracle(case.name, of_kernel)
    errors = {}
    if truth.outcome is not None:
        errors["outcome"] = float(response.outcome != truth.outcome)
    errors.update(_trajectory_errors(case, response, truth, of_kernel))
    errors.update(_event_errors(case, response, truth))
    if truth.settled:
        history = response.history
        late = history.time >= scene.duration * (1 - LAST_PART)
        if case.expected.get("outcome") == "stands":
            late[:] = True
        errors["tilt at rest"] = float(np.abs(history.tilt[late]).max(initial=0.0)) / scene.block.slenderness
    if response.energy is not None:
        errors["energy imbalance"] = _imbalance(response.energy)
    else:
        drift, gain = energy_errors(case.scene, response, until=comparable_until(case.name)[0], step=case.step or 0.0)
        errors["energy drift"] = max(0.0, drift - truth.noise[0])
        errors["energy gain"] = max(0.0, gain - truth.noise[1])
    return {
        "outcome": response.outcome,
        "errors": errors,
        "until": truth.until,
        "impacts": response.impact_count,
        "peak_tilt_ratio": response.peak_tilt_ratio,
        "peak_base_displacement": response.peak_base_displacement,
        "steps": response.steps,
        "settings": response.settings,
    }


def _trajectory_errors(case, response, truth, of_kernel):
    """Largest differences up to the horizon, at the samples of the kernel's history."""
    scene, block = case.scene, case.scene.block
    kernel = response if of_kernel else truth.response
    times = kernel.history.time[kernel.history.time <= truth.until]
    if case.oracle == "free rocking":
        p, e = scene.rocking_frequency, max(restitution(scene), 0.0)
        times = times[:: max(1, len(times) // 200)]
        tilt = (
            [free_rocking_tilt(p, block.slenderness, e, scene.start.tilt, t) for t in times]
            if e > 1e-9
            else (np.interp(times, kernel.history.time, kernel.history.tilt))
        )
    else:
        tilt = _at(truth.response, times, "tilt", "tilt_rate")
    errors = {"tilt": float(np.abs(_at(response, times, "tilt", "tilt_rate") - tilt).max()) / block.slenderness}
    if scene.base is not None:
        x = _at(truth.response, times, "base_displacement", "base_velocity")
        own = _at(response, times, "base_displacement", "base_velocity")
        errors["displacement"] = float(np.abs(own - x).max() / np.abs(x).max())
    return errors


def _event_errors(case, response, truth):
    scene, errors = case.scene, {}
    uplifts = [time for time in truth.uplifts if time <= truth.until]
    rests = [time for time in truth.rests if time <= truth.until]
    if case.oracle == "free rocking":
        p, e, gamma = scene.rocking_frequency, max(restitution(scene), 0.0), scene.block.slenderness
        if rests and e > 1e-9:
            rests = [rest_time(p, gamma, e, scene.start.tilt)]
        elif rests:
            rests = [float(free_rocking(p, gamma, 0.0, scene.start.tilt, 1).times[0])]
    if "uplift time" in case.expected:
        uplifts[0] = case.expected["uplift time"]
    if uplifts:
        errors["lost uplifts"] = float(max(0, len(uplifts) - len(response.uplifts)))
        if response.uplifts:
            errors["uplift time"] = abs(response.uplifts[0] - uplifts[0])
    if rests:
        errors["lost rests"] = float(max(0, len(rests) - len(response.rests)))
        if response.rests:
            own = np.array(response.rests)
            errors["rest time"] = max(float(np.abs(own / time - 1).min()) for time in rests)
    if truth.overturning_time is not None and response.overturning_time is not None:
        errors["overturning time"] = abs(response.overturning_time - truth.overturning_time)
    wanted = [abs(impact.rate_before) for impact in truth.response.impacts if impact.time <= truth.until]
    least = max(LEAST_RATE * max(wanted, default=0.0), LEAST_SHARE * scene.rocking_frequency * scene.block.slenderness)
    if count := sum(rate >= least for rate in wanted):
        own = sum(abs(impact.rate_before) >= OWN * least for impact in response.impacts)
        errors["lost impacts"] = float(max(0, count - own))
    return errors


def _imbalance(energy):
    """The ledger's imbalance over the largest entry."""
    largest = max(abs(getattr(energy, part.name)) for part in dataclasses.fields(energy))
    return abs(energy.imbalance) / largest if largest > 0 else 0.0


def _at(response, times, value, rate):
    """A column at `times` by the cubic through both ends of each step; its last value beyond its end."""
    history = response.history
    t, y, v = history.time, getattr(history, value), getattr(history, rate)
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
