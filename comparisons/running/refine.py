"""Location of the changes of an outcome along a line, with evaluations near the changes only.

A search is a generator: it yields a list of points, is sent the list of their outcomes, and returns its result.
`together` runs many searches in rounds, so that every round is one batch (one sweep); `drive` asks a function for the
outcomes. Outcomes are any labels that compare equal or not. Labels that say more find more: between "overturns after
one impact" and "overturns without" bisection must meet the safe gap, however thin; between two plain "overturns" it
cannot.
"""

from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Transition:
    """The outcome changes from `before` to `after` between `low` and `high`."""

    low: float
    high: float
    before: object
    after: object

    @property
    def position(self) -> float:
        return 0.5 * (self.low + self.high)


@dataclass(frozen=True)
class Column:
    """All transitions found along one line, in rising order, and the number of evaluations they took."""

    transitions: tuple[Transition, ...]
    evaluations: int


def together(
    searches: Sequence[Generator[list[Any], list[Any], Any]],
) -> Generator[list[tuple[int, Any]], list[Any], list[Any]]:
    """Many searches as one, in rounds.

    Parameters
    ----------
    searches : list of generators
        As `boundaries` makes them.

    Returns
    -------
    generator
        Yields once a round a list of (index of the search, point), is sent the list of their outcomes, and returns a
        list of what each search returned.

    Raises
    ------
    ValueError
        It was sent another number of outcomes than it gave points.
    """
    results = [None] * len(searches)
    answers: dict[int, Any] = dict.fromkeys(range(len(searches)))
    while answers:
        asked = {}
        for index, answer in answers.items():
            try:
                asked[index] = list(searches[index].send(answer))
            except StopIteration as stop:
                results[index] = stop.value
        batch = [(index, point) for index, points in asked.items() for point in points]
        answers = {index: [] for index in asked}
        for (index, _), outcome in zip(batch, (yield batch) if batch else (), strict=True):
            answers[index].append(outcome)
    return results


def drive(
    searches: Sequence[Generator[list[Any], list[Any], Any]], evaluate: Callable[[list[tuple[int, Any]]], list[Any]]
) -> list[Any]:
    """What each of `searches` returned; evaluate(batch) gives the outcomes of a round, see `together`."""
    rounds, outcomes = together(searches), None
    while True:
        try:
            batch = rounds.send(outcomes)  # type: ignore[arg-type]  # None starts it
        except StopIteration as stop:
            return stop.value
        outcomes = evaluate(batch)


def boundaries(
    low: float, high: float, scan: int, tolerance: float, near: int = 4
) -> Generator[list[float], list[Any], Column]:
    """Search for all transitions on [low, high]: scan, look closer beside each change, then bisect each.

    The outcome need not be monotone. Found for certain: every stretch of one outcome wider than the scan
    step (high - low)/(scan - 1); within one step of a change, every stretch wider than step/near; between
    two points with different outcomes, at least one transition.

    Parameters
    ----------
    low, high : float
    scan : int
        Points of the first, equidistant scan, at least 2.
    tolerance : float
        Transitions are located within brackets no wider than this.
    near : int
        Parts into which the scan's intervals with a change, and their neighbours, are divided.

    Returns
    -------
    generator
        For `together`; yields lists of float, returns a `Column`.
    """
    known: dict[float, Any] = {}

    def learn(points):
        points = [point for point in points if point not in known]
        if points:
            known.update(zip(points, (yield points), strict=True))

    yield from learn(np.linspace(low, high, scan).tolist())
    edges = sorted(known)
    changes = {i for i in range(scan - 1) if known[edges[i]] != known[edges[i + 1]]}
    close = sorted({j for i in changes for j in (i - 1, i, i + 1) if 0 <= j < scan - 1})
    yield from learn([point for i in close for point in np.linspace(edges[i], edges[i + 1], near + 1)[1:-1].tolist()])
    edges = sorted(known)
    waiting = [(a, b) for a, b in zip(edges, edges[1:], strict=False) if known[a] != known[b]]
    narrow = []
    while waiting:
        halves = [(a, 0.5 * (a + b), b) for a, b in waiting]
        wide = [(a, middle, b) for a, middle, b in halves if b - a > tolerance and a < middle < b]
        narrow += [(a, b) for a, middle, b in halves if not (b - a > tolerance and a < middle < b)]
        yield from learn([middle for _, middle, _ in wide])
        waiting = [(c, d) for a, middle, b in wide for c, d in ((a, middle), (middle, b)) if known[c] != known[d]]
    transitions = tuple(Transition(a, b, known[a], known[b]) for a, b in sorted(narrow))
    return Column(transitions, len(known))
