"""What several lessons compute, and every installed engine, in every variant, on one small scene: a block released on
rigid ground, to its second impact.

The engines are those of `engines`; without any, the lessons use the model's own fixed-step integrator.
"""

import functools
import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from analytic import Response, Scene, Start, simulate
from analytic.caryatid import caryatid_block
from analytic.time_stepping import simulate_time_stepping
from engines import get_engine, installed_engines

G = 9.81  # m/s2
HALVINGS = 50


def edge(differs: Callable[[float], bool], low: float, high: float) -> float:
    """The value at which `differs` changes between low and high, by bisection; on the side of high.

    Raises
    ------
    ValueError
        `differs` is the same at both ends.
    """
    there = differs(high)
    if differs(low) == there:
        raise ValueError(f"nothing changes between {low:g} and {high:g}")
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if differs(middle) == there else (middle, high)
    return high


def overturns(scene: Scene) -> bool:
    return simulate(scene, history=False).outcome == "overturns"


def history_until(scene: Scene, duration: float) -> Response:
    """The response of the first `duration` [s], with its history every 0.01 s."""
    return simulate(scene.with_(duration=duration), output_step=0.01)


SLENDERNESS, START = 0.28, 0.6  # rad, tilt over slenderness
SCENE = Scene(block=caryatid_block(SLENDERNESS), start=Start(tilt=START * SLENDERNESS), duration=1.5)
FIRST = 1.0  # s: between the first and the second impact
OWN = "fixed steps"  # the model's own integrator
# s. The impact falls at another phase of each of these steps, so that the error falls with every one of them: not all
# halvings do, as steps of 20 and of 10 ms happen to end at the same time beside it.
OWN_STEPS = (0.018, 0.012, 6e-3, 2.4e-3, 1e-3, 5e-4, 2e-4, 1e-4)
PHASES = np.linspace(0.9, 1.1, 41)  # factors on a step, over which the phase of the impact in it varies
ROUNDS = 3  # runs of a timing; the least CPU time counts


@dataclass(frozen=True)
class EngineRun:
    """One run: solver, name with variant, kind, accuracy parameter and its value.

    error: of the tilt rate after the first impact, nan without one. cpu: CPU time [s].
    """

    solver: str
    name: str
    kind: str
    parameter: str
    value: float
    error: float
    cpu: float


@functools.cache
def exact_rate() -> float:
    """Tilt rate after the first impact [rad/s], of the model."""
    return simulate(SCENE, history=False).impacts[0].rate_after


def error_of(response: Response) -> float:
    """Relative error of the tilt rate after the first impact, nan where there is none."""
    hits = [impact for impact in response.impacts if impact.time < FIRST]
    return abs(hits[0].rate_after / exact_rate() - 1) if hits else math.nan


def straddled(step: float) -> tuple[float, float]:
    """(shift of the first impact [s], relative error of the rate after it), root mean square over steps within a tenth
    of `step` [s]: of fixed steps, the model's own integrator.
    """
    exact = simulate(SCENE, history=False).impacts[0]
    hits = [simulate_time_stepping(SCENE, step=step * factor, history=False).impacts[0] for factor in PHASES]
    found = [(hit.time - exact.time, hit.rate_after / exact.rate_after - 1) for hit in hits]
    shift, rate = np.sqrt(np.mean(np.square(found), axis=0))
    return float(shift), float(rate)


def timed(
    solver: str, parameter: str, values: Iterable[float], simulated: Callable[..., Response]
) -> tuple[EngineRun, ...]:
    """Runs of one of our own solvers, one for each level."""
    found = []
    for value in values:
        runs = [simulated(SCENE, history=False, **{parameter: value}) for _ in range(ROUNDS)]
        cpu = min(run.cpu_seconds for run in runs)
        found.append(EngineRun(solver, solver, "", parameter, value, error_of(runs[0]), cpu))
    return tuple(found)


@functools.cache
def own_runs() -> tuple[EngineRun, ...]:
    """Runs of the model's fixed-step integrator."""
    return timed(OWN, "step", OWN_STEPS, simulate_time_stepping)


@functools.cache
def engine_runs() -> tuple[EngineRun, ...]:
    """Runs of every installed engine: each variant at all its levels."""
    found = []
    for name in installed_engines():
        engine = get_engine(name)
        for variant, spec in engine.variants.items():
            for value in spec.levels:
                response = engine.simulate(
                    SCENE, variant=variant, history=False, compare=False, **{spec.accuracy_parameter: value}
                )
                error = math.nan if response.outcome == "failed" else error_of(response)
                found.append(
                    EngineRun(
                        name,
                        f"{name}, {variant}",
                        spec.kind,
                        spec.accuracy_parameter,
                        value,
                        error,
                        response.cpu_seconds,
                    )
                )
    return tuple(found)
