"""One measurement in a worker: warm, repeated if short; error and CPU time from the very same runs."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from .scenes import BOUNDARY_RUNS, Boundary, at_amplitude, margin

if TYPE_CHECKING:
    from analytic import Response, Scene

    from ...running.cases import Case

TICK = 4e-3  # s of CPU: shorter measurements are repeated until they took as long, and the mean counts
MOST_REPEATS = 200
LONG = 0.5  # s of CPU: next to it what is loaded in a first run is nothing, and it is not run again
STRIDE = 0.05  # longest move of a boundary search, relative; it ends within six of them or finds no boundary
SMALL = 1e-3  # margin below which the reference's slope alone is as good as a chord


def measure(case: Case, response: Response) -> dict[str, Any]:
    """What is kept of one measurement, and its CPU time: the mean over runs of at least `TICK` in all.

    The run that made `response` has loaded code and caches; where it was long enough it is the measurement itself. A
    case whose tag holds a boundary, (amplitude, slope) of a `Boundary`, is a search for it.
    """
    goal = Boundary(*case.tag["boundary"]) if case.tag["boundary"] else None

    def run(scene):
        return dataclasses.replace(case, scene=scene).run()

    shifts, cpu, repeats = None, response.cpu_seconds, 1
    if goal or cpu < LONG:
        response, shifts, cpu = _measure(run, case.scene, goal)
        if 0 < cpu < TICK and response.outcome != "failed":
            repeats = min(MOST_REPEATS, math.ceil(TICK / cpu))
            cpu = sum(_measure(run, case.scene, goal)[2] for _ in range(repeats)) / repeats
    return {
        **response.to_json(),
        "boundary_shifts": shifts,
        "cost": {"cpu_seconds": cpu / (BOUNDARY_RUNS if goal else 1), "repeats": repeats},
    }


def searched(
    run: Callable[[Scene], Response], scene: Scene, boundary: Boundary | None
) -> tuple[Response, list[float | None] | None]:
    """(the first response, boundary shifts or None): a single run, or a search for the solver's own boundary.

    The margin is smooth in the amplitude, so moving by the reference's slope converges at once for a solver near the
    reference; one far from it is bracketed.
    """
    return _measure(run, scene, boundary)[:2]


def _measure(run, scene, boundary):
    """(first response, shifts or None, CPU seconds of all runs)."""
    if boundary is None:
        response = run(scene)
        return response, None, response.cpu_seconds
    shift, shifts, cpu, first, known = 0.0, [], 0.0, None, {}
    for _ in range(BOUNDARY_RUNS):
        moved = at_amplitude(scene, boundary.amplitude * (1 + shift))
        response = run(moved)
        first = first or response
        cpu += response.cpu_seconds
        if response.outcome == "failed":
            return response, None, cpu
        known[shift] = margin(moved, response.end) / boundary.slope
        shift = _next(known, shift)
        shifts.append(shift)
    return first, shifts, cpu


def _next(known, last):
    """Where to look next: by the chord of the two nearest points on either side, else by the reference's slope."""
    below = max((at for at, value in known.items() if value <= 0), default=None)
    above = min((at for at, value in known.items() if value > 0), default=None)
    if below is None or above is None or abs(known[last]) < SMALL:
        return last - min(max(known[last], -STRIDE), STRIDE)
    if below > above:  # not monotone here: stay
        return last
    return below + (above - below) * min(max(-known[below] / (known[above] - known[below]), 0.1), 0.9)
