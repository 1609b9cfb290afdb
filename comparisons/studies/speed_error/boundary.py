"""An overturning boundary, and the search for the one that a solver has in the reference's place."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from analytic import Response, Scene, State
from analytic.motion import PulseMotion

RUNS = 6  # of a search: the first at the reference's boundary, then at the corrected ones
STRIDE = 0.05  # longest move of a search, relative; it ends within its runs or finds no boundary
SMALL = 1e-3  # margin below which the reference's slope alone is as good as a chord


@dataclass(frozen=True)
class Boundary:
    """Pulse amplitude [m/s2] at which the block just overturns, and slope: d margin / d (amplitude / boundary)."""

    amplitude: float
    slope: float


def margin(scene: Scene, end: State) -> float:
    """Energy beyond what tipping over needs, over m g R (1 - cos gamma), after the motion's end; conserved in flight.

    Negative: the block falls back; positive: it overturns. With u = gamma - |phi|: (w^2/2 - p^2 (1 - cos u))/(p^2 (1 -
    cos gamma)).
    """
    gamma, p2 = scene.block.slenderness, scene.rocking_frequency**2
    u = gamma - abs(end.tilt)
    return (0.5 * end.tilt_rate**2 - 2 * p2 * math.sin(0.5 * u) ** 2) / (2 * p2 * math.sin(0.5 * gamma) ** 2)


def at_amplitude(scene: Scene, amplitude: float) -> Scene:
    """The scene with its pulse at another amplitude [m/s2]."""
    assert isinstance(scene.motion, PulseMotion)
    return scene.with_(motion=replace(scene.motion, amplitude=float(amplitude)))


def searched(
    run: Callable[[Scene], Response], scene: Scene, boundary: Boundary | None
) -> tuple[Response, list[float] | None, float]:
    """A single run, or a search for the solver's own boundary.

    The margin is smooth in the amplitude, so moving by the reference's slope converges at once for a solver near the
    reference; one far from it is bracketed.

    Returns
    -------
    response : Response
        The first.
    shifts : list of float or None
        Relative position of the boundary against the reference's after each run; None without one, or if a run failed.
    cpu_seconds : float
        Of all runs.
    """
    first = run(scene)
    if boundary is None:
        return first, None, first.cpu_seconds
    shift, shifts, cpu, known = 0.0, list[float](), 0.0, dict[float, float]()
    for _ in range(RUNS):
        moved = at_amplitude(scene, boundary.amplitude * (1 + shift))
        response = run(moved) if known else first
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
