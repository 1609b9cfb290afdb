"""Where overturning begins and ends: the analytic boundaries, and a solver's boundary searched for beside one of them;
and blocks drawn in the promised range.

Amplitudes are over g tan(slenderness), frequencies over omega_r.
"""

import itertools
import math
from collections.abc import Generator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from analytic import PulseMotion, Scene, Start, simulate, simulate_many
from analytic.bearing import BearingLaw
from analytic.motion import Motion

from ...running.refine import boundaries, drive
from ..random_scenes.study import random_scene

LOWEST, HIGHEST = 0.5, 20.0  # of the amplitudes searched
SCAN = 400  # points of the first scan, equidistant in the logarithm: 0.9 % apart
TOLERANCE = 1e-6  # of the analytic boundaries, relative
BESIDE = 2e-5  # relative distance from a boundary at which the analytic run tells how long overturning takes
CUT = 0.45  # where a bracket is divided: not in the middle, which may be the analytic boundary itself
WIDEST = 5e-3  # half-width of a bracket, relative, beyond which a boundary counts as not found
ROOM = 0.9  # of the way to the middle between two boundaries, what a search may use
# why there is no boundary, by the outcomes seen: whether it overturns
REASONS = {
    frozenset(): "no run was decided",
    frozenset({True}): "overturns on both sides",
    frozenset({False}): "stands on both sides",
    frozenset({True, False}): "outcomes the other way round",
}


@dataclass(frozen=True)
class Edge:
    """A boundary of the analytic model along the amplitude.

    rises: overturning lies above it. mode: impacts before overturning. low, high: amplitudes half way to the
    neighbouring boundaries. min_normal: least normal force over m g of the analytic model beside it; below 0 that model
    holds the corner down, where a block would slide or jump.
    """

    ground: str
    shape: str
    frequency: float
    amplitude: float
    rises: bool
    mode: int
    low: float
    high: float
    min_normal: float


@dataclass(frozen=True)
class Located:
    """A solver's boundary: its relative shift and the half-width of the bracket; shift None where it was not found."""

    shift: float | None
    half_width: float | None
    reason: str | None
    runs: int


def pulse(scene: Scene, shape: str, frequency: float, amplitude: float) -> PulseMotion:
    """The `PulseMotion` of the two ratios."""
    unit = scene.gravity * math.tan(scene.block.slenderness)
    return PulseMotion(shape, amplitude * unit, frequency * scene.rocking_frequency)


def edges(scene: Scene, ground: str, shape: str, frequencies: Sequence[float]) -> list[Edge]:
    """All `Edge`s of the analytic model on a ground of that name, ascending at each frequency.

    Raises
    ------
    RuntimeError
        The analytic model failed.
    """

    def evaluate(batch):
        scenes = [
            scene.with_(motion=pulse(scene, shape, frequencies[index], math.exp(point)), duration=None)
            for index, point in batch
        ]
        outcomes = simulate_many(scenes)
        if outcomes.failed.any():
            raise RuntimeError(f"the analytic model failed on {scenes[int(outcomes.failed.argmax())].motion.label}")
        return np.where(outcomes.overturns, outcomes.impacts, -1).tolist()

    columns = drive([boundaries(math.log(LOWEST), math.log(HIGHEST), SCAN, TOLERANCE) for _ in frequencies], evaluate)
    return [
        edge
        for frequency, column in zip(frequencies, columns, strict=True)
        for edge in _edges(scene, ground, shape, frequency, column.transitions)
    ]


def _edges(scene, ground, shape, frequency, transitions):
    """Those of the transitions at which overturning begins or ends."""
    transitions = [one for one in transitions if -1 in (one.before, one.after)]
    amplitudes = [math.exp(one.position) for one in transitions]
    limits = [LOWEST, *(math.sqrt(a * b) for a, b in itertools.pairwise(amplitudes)), 1.5 * HIGHEST]
    for one, amplitude, low, high in zip(transitions, amplitudes, limits, limits[1:], strict=False):
        rises = one.before == -1
        beside = pulse(scene, shape, frequency, amplitude * (1 + BESIDE if rises else 1 - BESIDE))
        mode, normal = int(one.after if rises else one.before), least_normal(scene, beside)
        yield Edge(ground, shape, frequency, amplitude, rises, mode, low, high, normal)


def least_normal(scene: Scene, motion: Motion) -> float:
    """Least N/(m g) in the analytic model under `motion`."""
    return simulate(scene.with_(motion=motion, duration=None), history=False).min_normal_ratio


def locate(
    edge: Edge, distances: Sequence[Sequence[float]], tolerance: float
) -> Generator[list[float], list[Any], Located]:
    """Search for a solver's boundary beside an analytic one, outward in the steps of `distances`, then by bisection.

    Of several boundaries the nearest is taken. Where two boundaries lie closer than the distances reach, it is
    shortened to their middle.

    Parameters
    ----------
    edge : Edge
    distances : sequence of tuples of float
        Relative distances above 0; a further tuple is tried only where those before show no boundary.
    tolerance : float
        Largest width of the bracket, relative.

    Returns
    -------
    generator
        For `refine.drive`; yields lists of amplitudes, is sent True (overturns), False or None (failed, undecided),
        returns a `Located`.
    """
    known, bracket = {}, None
    below, above = ROOM * (edge.low / edge.amplitude - 1), ROOM * (edge.high / edge.amplitude - 1)
    for steps in distances:
        offsets = {max(-d, below) for d in steps} | {min(d, above) for d in steps}
        points = sorted(offsets - set(known))
        if not points:
            continue
        answers = yield [edge.amplitude * (1 + point) for point in points]
        known.update(zip(points, answers, strict=True))
        bracket = _nearest(known, edge.rises)
        if bracket:
            break
    if bracket is None:
        seen, failed = {answer for answer in known.values() if answer is not None}, list(known.values()).count(None)
        reason = REASONS[frozenset(seen)]
        reach = f"from {100 * min(known):+.3g} to {100 * max(known):+.3g} %"
        return Located(None, None, f"{reason}, {reach}" + (f"; {failed} undecided" if failed else ""), len(known))
    low, high = bracket
    while high - low > tolerance:
        middle = low + CUT * (high - low)
        (answer,) = yield [edge.amplitude * (1 + middle)]
        known[middle] = answer
        if answer is None:
            break
        low, high = (low, middle) if answer == edge.rises else (middle, high)
    if high - low > 2 * WIDEST:
        return Located(None, None, f"undecided between {100 * low:+.3g} and {100 * high:+.3g} %", len(known))
    return Located(0.5 * (low + high), 0.5 * (high - low), None, len(known))


def _nearest(known, rises):
    """The pair of neighbouring offsets between which the outcome changes the way of the edge, nearest to 0."""
    points = sorted(point for point, answer in known.items() if answer is not None)
    pairs = [(a, b) for a, b in itertools.pairwise(points) if known[a] == (not rises) and known[b] == rises]
    return min(pairs, key=lambda pair: abs(pair[0] + pair[1]), default=None)


SEED = 46
DRAWN = ("one-sine", "one-cosine", "half-sine", "rectangular", "ricker")  # by name: a new pulse redraws nothing
FREQUENCY = (1.5, 8.0)  # of the pulses over omega_r, evenly over the logarithm
APART = 0.02  # relative distance of the next boundary, at least: nearer ones alternate as a fractal's do
JUMPS = tuple(shape for shape in DRAWN if PulseMotion(shape, 1.0, 1.0, start=1.0).jumps)  # they begin with one


def drawn_edges(count: int) -> list[tuple[Scene, Edge]]:
    """`count` blocks with their lowest boundary at which the model keeps the block pressed on its base.

    Scenes of `random_scenes`, at rest; the pulses' shapes take turns. A block without such a boundary, and one that has
    another boundary within `APART` of it, is passed over.
    """
    found: list[tuple[Scene, Edge]] = []
    index = 0
    while len(found) < count:
        scene = random_scene(SEED, index).with_(motion=None, start=Start())
        low, high = map(math.log, FREQUENCY)
        frequency = math.exp(np.random.default_rng([SEED, index, 1]).uniform(low, high))
        index += 1
        for edge in edges(scene, f"drawn block {index}", DRAWN[len(found) % len(DRAWN)], (frequency,)):
            room = min(1 - edge.low / edge.amplitude, edge.high / edge.amplitude - 1)
            if edge.rises and edge.min_normal >= 0 and room >= APART:
                found.append((scene, edge))
                break
    return found


def drawn_columns(scene: Scene) -> dict[str, Any]:
    """The columns that say what was drawn; period [s] on the stiffness after yielding."""
    base, bearings = scene.base, scene.bearings
    law = BearingLaw.of(bearings)
    period = 2 * math.pi * math.sqrt(scene.total_mass / (law.count * law.kb)) if bearings else None
    return {
        "slenderness": scene.block.slenderness,
        "radius": scene.block.radius,
        "base_mass": base and base.mass / scene.block.mass,
        "law": bearings and bearings.law,
        "period": period,
    }
