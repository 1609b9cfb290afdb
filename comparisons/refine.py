"""Maps of outcomes at the price of their boundaries: evaluate where outcomes change, not everywhere.

A search is a generator: it yields a list of points, is sent the list of their outcomes, and returns its
result. `drive` runs many searches in rounds, so that every round is one batch (one sweep). Outcomes are any
labels that compare equal or not. Labels that say more find more: between "overturns after one impact" and
"overturns without" bisection must meet the safe gap, however thin; between two plain "overturns" it cannot.
"""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Transition:
    """The outcome changes from `before` to `after` between `low` and `high`."""

    low: float
    high: float
    before: object
    after: object

    @property
    def position(self):
        return 0.5 * (self.low + self.high)


@dataclass(frozen=True)
class Column:
    """All transitions found along one line, in rising order, and the number of evaluations they took."""

    transitions: tuple[Transition, ...]
    evaluations: int


@dataclass(frozen=True, eq=False)
class Map:
    """Outcomes on the finest grid.

    x, y: grid lines, shapes (nx,) and (ny,). labels: shape (nx, ny), dtype object. evaluated: shape
    (nx, ny), False where the label is that of the surrounding cell, whose corners agree.
    """

    x: np.ndarray
    y: np.ndarray
    labels: np.ndarray
    evaluated: np.ndarray

    @property
    def evaluations(self):
        return int(self.evaluated.sum())


def drive(searches, evaluate):
    """Run several searches side by side.

    Parameters
    ----------
    searches : list of generators
        As `boundaries` and `refine_map` make them.
    evaluate : callable
        Called once a round with the list of (index of the search, point); returns the outcomes in that
        order. Put a sweep here.

    Returns
    -------
    list
        What each search returned.

    Raises
    ------
    ValueError
        `evaluate` returned another number of outcomes than it was given points.
    """
    results = [None] * len(searches)
    answers = dict.fromkeys(range(len(searches)))
    while answers:
        asked = {}
        for index, answer in answers.items():
            try:
                asked[index] = list(searches[index].send(answer))
            except StopIteration as stop:
                results[index] = stop.value
        batch = [(index, point) for index, points in asked.items() for point in points]
        outcomes = list(evaluate(batch)) if batch else []
        if len(outcomes) != len(batch):
            raise ValueError(f"evaluate returned {len(outcomes)} outcomes for {len(batch)} points")
        arriving = iter(outcomes)
        answers = {index: [next(arriving) for _ in points] for index, points in asked.items()}
    return results


def boundaries(low, high, scan, tolerance, near=4):
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
        For `drive`; yields lists of float, returns a `Column`.
    """
    if not (low < high and scan >= 2 and tolerance > 0 and near >= 1):
        raise ValueError(f"boundaries needs low < high, scan >= 2, tolerance > 0 and near >= 1, not low = {low!r}, "
                         f"high = {high!r}, scan = {scan!r}, tolerance = {tolerance!r}, near = {near!r}")
    return _boundaries(low, high, scan, tolerance, near)


def _boundaries(low, high, scan, tolerance, near):
    known = {}

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
    found = []
    while waiting:
        halves = [(a, 0.5 * (a + b), b) for a, b in waiting]
        wide = [(a, middle, b) for a, middle, b in halves if b - a > tolerance and a < middle < b]
        found += [(a, b) for a, middle, b in halves if not (b - a > tolerance and a < middle < b)]
        yield from learn([middle for _, middle, _ in wide])
        waiting = [(c, d) for a, middle, b in wide for c, d in ((a, middle), (middle, b)) if known[c] != known[d]]
    transitions = tuple(Transition(a, b, known[a], known[b]) for a, b in sorted(found))
    return Column(transitions, len(known))


def refine_map(x, y, levels):
    """Search for the outcomes over a grid: cells whose corners disagree, and their neighbours, are quartered.

    Parameters
    ----------
    x, y : arrays, shapes (kx,) and (ky,)
        Rising lines of the coarse grid; a feature smaller than its cells may be missed.
    levels : int
        How often cells are halved, at least 0.

    Returns
    -------
    generator
        For `drive`; yields lists of (x, y), returns a `Map` with (kx - 1) 2^levels + 1 by
        (ky - 1) 2^levels + 1 points.
    """
    x, y = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
    if len(x) < 2 or len(y) < 2 or (np.diff(x) <= 0).any() or (np.diff(y) <= 0).any() or levels < 0:
        raise ValueError("refine_map needs two or more rising lines each way, and levels >= 0")
    return _refine_map(_halved(x, levels), _halved(y, levels), 2**levels)


def _refine_map(x, y, step):
    labels = np.empty((len(x), len(y)), dtype=object)
    evaluated = np.zeros(labels.shape, dtype=bool)

    def learn(nodes):
        nodes = sorted(node for node in nodes if not evaluated[node])
        if nodes:
            outcomes = yield [(float(x[i]), float(y[j])) for i, j in nodes]
            for node, outcome in zip(nodes, outcomes, strict=True):
                labels[node], evaluated[node] = outcome, True

    cells = {(i, j) for i in range(0, len(x) - 1, step) for j in range(0, len(y) - 1, step)}
    yield from learn({(i + di, j + dj) for i, j in cells for di in (0, step) for dj in (0, step)})
    while True:
        mixed = {cell for cell in cells if _mixed(labels, cell, step)}
        for i, j in cells:
            if (i, j) not in mixed:  # finer cells overwrite the shared edges with what they evaluate
                _fill(labels, evaluated, i, j, step)
        if step == 1:
            return Map(x, y, labels, evaluated)
        split = {(i + di, j + dj) for i, j in mixed for di in (-step, 0, step) for dj in (-step, 0, step)} & cells
        half = step // 2
        cells = {(i + di, j + dj) for i, j in split for di in (0, half) for dj in (0, half)}
        yield from learn({(i + di, j + dj) for i, j in cells for di in (0, half) for dj in (0, half)})
        step = half


def _mixed(labels, cell, step):
    i, j = cell
    first = labels[i, j]
    return any(labels[i + di, j + dj] != first for di, dj in ((step, 0), (0, step), (step, step)))


def _fill(labels, evaluated, i, j, step):
    part = slice(i, i + step + 1), slice(j, j + step + 1)
    label = labels[i, j]
    block, known = labels[part], evaluated[part]
    for node in zip(*np.nonzero(~known), strict=True):
        block[node] = label


def _halved(lines, levels):
    """`lines` with every gap divided into 2^levels equal parts."""
    parts = 2**levels
    fine = np.interp(np.arange((len(lines) - 1) * parts + 1), np.arange(len(lines)) * parts, lines)
    fine[::parts] = lines
    return fine
