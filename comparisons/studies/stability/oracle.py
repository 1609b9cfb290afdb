"""What is right in a hard case: the outcome, the tilt, uplifts and rests up to where motions part."""

import dataclasses
import functools
import math

import numpy as np

from analytic import Response, Scene, simulate
from analytic.closed_form import free_rocking_tilt, rest_time
from analytic.rocking import restitution
from analytic.twin import simulate_twin
from engines.copies import changed_copies

from ...measuring.errors import energy_errors
from ...measuring.horizon import PERTURBATION, sensitivity_horizon
from .cases import HardCase, hard_cases

JUDGE_TOLERANCE = 1e-15  # of the kernel where it judges others
LEAST_RESTITUTION = 1e-30  # stands for none in the closed form, which divides by its logarithm
LAST_PART = 0.1  # share of the run, at its end, over which a block at rest must not drift
TIMES = 200  # about so many of the kernel's samples are compared with the closed form


@dataclasses.dataclass(frozen=True, eq=False)
class Oracle:
    """What is right up to `until` [s].

    outcome: None where a change of 1e-4 in restitution, motion or start changes it. uplifts, rests: times [s]. settled:
    the block is at rest over the last part of the run. response: of the solver that judges. noise: (energy drift,
    energy gain) that the measures themselves show on a right history.
    """

    case: HardCase
    outcome: str | None
    until: float
    uplifts: list[float]
    rests: list[float]
    settled: bool
    response: Response
    noise: tuple[float, float]

    def tilt(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(times [s] up to `until` where it is compared, the tilt there [rad])."""
        times = times[times <= self.until]
        if self.case.oracle != "free rocking":
            return times, column_at(self.response, times, "tilt")
        times, known = times[:: max(1, len(times) // TIMES)], _free(self.case.scene)
        return times, np.array([free_rocking_tilt(*known, time) for time in times])


@functools.cache
def comparable_until(name: str) -> tuple[float, bool]:
    """(time [s] up to which the trajectory can be compared, whether the outcome can)."""
    scene = hard_cases()[name].scene
    copies = (scene, *changed_copies(scene, PERTURBATION).values())
    outcome, *changed = (simulate(copy, history=False).outcome for copy in copies)
    return sensitivity_horizon(scene).horizon, all(other == outcome for other in changed)


def twin_step(scene: Scene) -> float:
    """Longest step of the twin [s]: its own choice, but short enough to interpolate in to 1e-8."""
    longest = min(0.005, 0.5 * getattr(scene.motion, "dt", math.inf))
    if scene.bearings is None:
        return longest
    return min(longest, 0.05 / math.sqrt(scene.bearings.count * scene.bearings.ka / scene.total_mass))


@functools.cache
def oracle(name: str, of_kernel: bool) -> Oracle:
    """The `Oracle` of the case `name`: the twin for the kernel, the kernel for all others."""
    case = hard_cases()[name]
    until, robust = comparable_until(name)
    response = simulate(case.scene, tolerance=JUDGE_TOLERANCE)
    noise = energy_errors(case.scene, response, until=until, step=case.step or 0.0)
    if of_kernel:
        until, robust = min(until, case.twin_until), math.isinf(case.twin_until)
        short = case.scene if robust else case.scene.with_(duration=case.twin_until)
        response = simulate_twin(short, energy=False, max_step=twin_step(case.scene))
    if response.unstable_time is not None:  # beyond, two motions part exponentially
        until = min(until, response.unstable_time)
    outcome = case.expected.get("outcome", response.outcome if robust else None)
    uplifts, rests = ([time for time in times if time <= until] for times in (response.uplifts, response.rests))
    if "uplift time" in case.expected:
        uplifts[0] = case.expected["uplift time"]
    if case.oracle == "free rocking" and rests:
        rests = [rest_time(*_free(case.scene))]
    last = response.rests[-1] if response.rests else math.inf
    at_rest = last < case.scene.duration * (1 - LAST_PART) and all(time < last for time in response.uplifts)
    return Oracle(case, outcome, until, uplifts, rests, outcome == "stands" or at_rest, response, noise)


def _free(scene: Scene) -> tuple[float, float, float, float]:
    """What the closed form takes of a scene of free rocking: omega_r [rad/s], slenderness, restitution, tilt [rad]."""
    e = max(restitution(scene), LEAST_RESTITUTION)
    return scene.rocking_frequency, scene.block.slenderness, e, scene.start.tilt


RATES = {"tilt": "tilt_rate", "base_displacement": "base_velocity"}  # of the columns that are compared


def column_at(response: Response, times: np.ndarray, name: str) -> np.ndarray:
    """A column of a history at `times` by the cubic through both ends of each step; its last value beyond its end."""
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
