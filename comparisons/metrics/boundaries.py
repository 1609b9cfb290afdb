"""Overturning boundaries: those of the analytic model, and the search for a solver's boundary beside one of them.

Amplitudes are given over g tan(slenderness), frequencies over omega_r.
"""

import itertools
import math
from collections.abc import Generator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from analytic import PulseMotion, Response, Scene, simulate, simulate_many
from analytic.motion import Motion
from engines import get_engine

from ..execution.cases import Case
from ..execution.plan import Batch, boundaries, drive, together
from ..execution.sweep import Row

LOWEST, HIGHEST = 0.5, 20.0  # range of the amplitudes searched
SCAN = 400  # points of the first scan, equidistant in the logarithm: 0.9 % apart
ANALYTIC = 1e-6  # tolerance of the analytic boundaries, relative
BESIDE = 2e-5  # relative distance from a boundary at which the model is run for its mode and least normal force
CUT = 0.45  # point at which a bracket is divided; the middle may be the analytic boundary itself
WIDEST = 5e-3  # relative half-width of a bracket beyond which a boundary counts as not found
ROOM = 0.9  # part of the way to the middle between two boundaries that a search may use
# {outcomes seen, True: overturns: why there is no boundary}
REASONS = {
    frozenset(): "no run was decided",
    frozenset({True}): "overturns on both sides",
    frozenset({False}): "stands on both sides",
    frozenset({True, False}): "outcomes the other way round",
}


@dataclass(frozen=True)
class Edge:
    """A boundary of the analytic model along the amplitude.

    rises: overturning lies above it. mode: number of impacts before overturning. low, high: amplitudes half way to the
    neighbouring boundaries. min_normal: least normal force over m g in the analytic model beside it; below 0 the model
    holds the corner down, whereas a block would slide or jump.
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
    """A solver's boundary: its relative shift and the half-width of the bracket. shift: None if it was not found."""

    shift: float | None
    half_width: float | None
    reason: str | None
    runs: int


def pulse(scene: Scene, shape: str, frequency: float, amplitude: float) -> PulseMotion:
    """Return the `PulseMotion` with this frequency over omega_r and amplitude over g tan(slenderness)."""
    unit = scene.gravity * math.tan(scene.block.slenderness)
    return PulseMotion(shape, amplitude * unit, frequency * scene.rocking_frequency)


def edges(scene: Scene, ground: str, shape: str, frequencies: Sequence[float]) -> list[Edge]:
    """Return all `Edge`s of the analytic model at each frequency, ascending. ground: its name.

    Raises
    ------
    RuntimeError
        The analytic model failed.
    """

    def evaluate(batch):
        motions = [pulse(scene, shape, frequencies[index], math.exp(point)) for index, point in batch]
        outcomes = simulate_many([scene.with_(motion=motion, duration=None) for motion in motions])
        if outcomes.failed.any():
            raise RuntimeError(f"the analytic model failed on {motions[int(outcomes.failed.argmax())].label}")
        return np.where(outcomes.overturns, outcomes.impacts, -1).tolist()

    columns = drive([boundaries(math.log(LOWEST), math.log(HIGHEST), SCAN, ANALYTIC) for _ in frequencies], evaluate)
    return [
        edge
        for frequency, column in zip(frequencies, columns, strict=True)
        for edge in _edges(scene, ground, shape, frequency, column.transitions)
    ]


def _edges(scene, ground, shape, frequency, transitions):
    """Yield the edges: the transitions at which overturning begins or ends."""
    transitions = [transition for transition in transitions if -1 in (transition.before, transition.after)]
    amplitudes = [math.exp(transition.position) for transition in transitions]
    limits = [LOWEST, *(math.sqrt(a * b) for a, b in itertools.pairwise(amplitudes)), 1.5 * HIGHEST]
    for transition, amplitude, low, high in zip(transitions, amplitudes, limits, limits[1:], strict=False):
        rises = transition.before == -1
        beside = pulse(scene, shape, frequency, amplitude * (1 + BESIDE if rises else 1 - BESIDE))
        mode, normal = int(transition.after if rises else transition.before), least_normal(scene, beside)
        yield Edge(ground, shape, frequency, amplitude, rises, mode, low, high, normal)


def least_normal(scene: Scene, motion: Motion) -> float:
    """Return the least N/(m g) in the analytic model under `motion`."""
    return simulate(scene.with_(motion=motion, duration=None), history=False).min_normal_ratio


def locate(
    edge: Edge, distances: Sequence[Sequence[float]], tolerance: float
) -> Generator[list[float], list[Any], Located]:
    """Search for a solver's boundary beside an analytic one, outward at `distances`, then by bisection.

    The nearest of several boundaries is taken. Distances that reach beyond the middle between two analytic boundaries
    are shortened.

    Parameters
    ----------
    edge : Edge
    distances : sequence of tuples of float
        Relative distances above 0. A further tuple is tried only if the earlier ones show no boundary.
    tolerance : float
        Largest width of the bracket, relative.

    Returns
    -------
    generator
        For `plan.drive`. It yields lists of amplitudes, is sent True (overturns), False or None (failed, undecided),
        and returns a `Located`.
    """
    known: dict[float, bool | None] = {}
    bracket = None
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
    """The pair of neighbouring offsets, nearest to 0, between which the outcome changes as at the edge, or None."""
    points = sorted(point for point, answer in known.items() if answer is not None)
    pairs = [(a, b) for a, b in itertools.pairwise(points) if known[a] == (not rises) and known[b] == rises]
    return min(pairs, key=lambda pair: abs(pair[0] + pair[1]), default=None)


DISTANCES = ((2e-4, 1.2e-2), (3e-2,), (0.1,), (0.3,))  # relative distances of `locate`
TOLERANCE = 2e-5  # of a solver's boundary
LEVEL_DISTANCES, LEVEL_TOLERANCE = ((2e-3, 2e-2), (0.1,), (0.3,)), 2e-4  # for other levels, and for defaults


@dataclass(frozen=True)
class Setting:
    """A variant at a level of its accuracy parameter. settings: those that give the level; none at the default."""

    engine: str
    variant: str
    level: float
    settings: Mapping[str, float] = field(default_factory=dict)

    def row(self) -> dict[str, Any]:
        return {"engine": self.engine, "variant": self.variant, "level": self.level}


class Point(NamedTuple):
    """A pulse on a ground. min_normal: least N/(m g) of the analytic model there or at the boundary nearby."""

    ground: str
    shape: str
    frequency: float
    amplitude: float
    min_normal: float


def usual_settings(engines: Sequence[str]) -> tuple[list[Setting], list[Setting]]:
    """Return (main variants of the engines, their other variants of the kind "defaults"), at their default levels."""
    main, others = [], []
    for engine in map(get_engine, engines):
        for variant, spec in engine.variants.items():
            if variant == engine.default_variant:
                main.append(Setting(engine.name, variant, spec.default))
            elif spec.kind == "defaults":
                others.append(Setting(engine.name, variant, spec.default))
    return main, others


def measure(case: Case, response: Response) -> dict[str, Any]:
    return {"outcome": response.outcome, "decided": response.decided, "end_tilt": response.end.tilt}


Asked = Generator[Batch, list[Row], list[Any]]


class Runs:
    """Runs pulses in solvers, and stores failures and the outcomes at default levels.

    outcomes: {(engine, ground, shape, frequency, amplitude): (overturns, None if undecided; whether of the scan)}.
    """

    def __init__(self, grounds: Mapping[str, Scene], default: Sequence[Setting] = ()) -> None:
        self.outcomes: dict[tuple[Any, ...], tuple[bool | None, bool]] = {}
        self.failures: list[dict[str, Any]] = []
        self._grounds, self._default = grounds, default

    def ask(self, points: Sequence[tuple[Setting, Point]], label: str, scan: bool = False) -> Asked:
        """Run (`Setting`, `Point`) pairs and return whether each overturns, None if undecided."""
        cases = [
            Case(
                under(self._grounds, point),
                setting.engine,
                setting.variant or None,
                {"history": False, **setting.settings},
            )
            for setting, point in points
        ]
        answers = []
        rows = yield Batch(cases, measure, label)
        for (setting, point), row in zip(points, rows, strict=True):
            decided = not row.failed and row.values["decided"]
            answers.append(row.values["outcome"] == "overturns" if decided else None)
            if not decided:
                failure = row.failure or {
                    "kind": "undecided",
                    "reason": "the longest run ends without a certain outcome",
                    "message": f"tilt {row.values['end_tilt']:.6g} rad",
                }
                self.failures.append({"part": "failure", **setting.row(), **point._asdict(), **failure})
            if setting in self._default:
                self.outcomes[setting.engine, *point[:-1]] = answers[-1], scan
        return answers

    def search_usual(self, part: str, engines: Sequence[str], model_edges: Sequence[Edge]) -> Asked:
        """Return rows of `search` for the `usual_settings`, with the finer tolerance for the main variants."""
        main, others = usual_settings(engines)
        rows = yield from self.search(part, main, model_edges, DISTANCES, TOLERANCE)
        return rows + (yield from self.search(part, others, model_edges, LEVEL_DISTANCES, LEVEL_TOLERANCE))

    def search(
        self,
        part: str,
        settings: Sequence[Setting],
        model_edges: Sequence[Edge],
        distances: Sequence[Sequence[float]],
        tolerance: float,
    ) -> Asked:
        """Return rows of the boundaries of `settings` beside those of the analytic model. part: of each row."""
        jobs = list(itertools.product(settings, model_edges))
        label = f"{part}: {', '.join(f'{setting.engine} {setting.variant}' for setting in settings)}"
        searches = together([locate(edge, distances, tolerance) for _, edge in jobs])
        answers: Any = None
        while True:
            try:
                batch = searches.send(answers)
            except StopIteration as stop:
                located = stop.value
                break
            points = [
                (setting, Point(edge.ground, edge.shape, edge.frequency, float(amplitude), edge.min_normal))
                for index, amplitude in batch
                for setting, edge in (jobs[index],)
            ]
            answers = yield from self.ask(points, label)
        return [
            {
                "part": part,
                **setting.row(),
                "ground": edge.ground,
                "shape": edge.shape,
                "frequency": edge.frequency,
                "amplitude": edge.amplitude,
                "rises": edge.rises,
                "mode": edge.mode,
                "room": min(1 - edge.low / edge.amplitude, edge.high / edge.amplitude - 1),
                **vars(boundary),
            }
            for (setting, edge), boundary in zip(jobs, located, strict=True)
        ]


def under(grounds: Mapping[str, Scene], point: Point) -> Scene:
    scene = grounds[point.ground]
    return scene.with_(motion=pulse(scene, point.shape, point.frequency, point.amplitude))
