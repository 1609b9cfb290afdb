"""Names of curves in a chart, each written near its curve where nothing else is drawn."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from .charts import LETTER, Chart

GAP = 6  # between a name and the middle of a mark or line
STEP = 5  # between places that are tried
REACHES = 20, 80  # how far a name may stand from its curve; farther only where nothing is free
FAR = 12  # beyond which a thin line leads from a name to its curve
TRIES = 400  # of the best places, among which that with a free line is sought
BOLD, PLAIN = 0.64, 0.53  # width of a character in letterings; at least that of most system fonts


class Named(NamedTuple):
    """A name of one or more curves. who: in the colour of which solver. curves: their marks, each shape (marks, 2)."""

    name: str
    who: str
    bold: bool
    curves: Sequence[np.ndarray]


class Place(NamedTuple):
    """A box for a name. half: of its size. end: the nearest point of the curve. lines: of words."""

    cost: float
    centre: np.ndarray
    half: np.ndarray
    end: np.ndarray
    lines: Sequence[str]


def write_names(chart: Chart, names: Sequence[Named]) -> None:
    """Write each name in one line or two, the first ones at the best places."""
    drawn = [np.concatenate([_along(marks) for marks in named.curves]) for named in names]
    written = np.empty((0, 2))
    for own, named in zip(drawn, names, strict=True):
        others = np.concatenate([written[:0], *(points for points in drawn if points is not own)])
        broken = [named.name], named.name.split(" ", 1)
        for reach in REACHES:
            places = [_place(chart, lines, named.bold, own, others, written, reach) for lines in broken]
            place = min(places, key=lambda place: place.cost)
            if place.cost <= reach:  # no farther place costs less
                break
        for k, line in enumerate(place.lines):
            aside = 0, 4.5 + (k - (len(place.lines) - 1) / 2) * LETTER
            kind = "soft clear" if named.bold else "soft plain clear"
            chart.named(place.centre, line, named.who, aside=aside, anchor="middle", kind=kind)
        begin = _edge(place.centre, place.half, place.end)
        if math.dist(begin, place.end) > FAR:
            chart.lead(begin, place.end, named.who)
        rows = [place.centre + place.half * [[-1, up], [1, up]] for up in np.linspace(-1, 1, 1 + 2 * len(place.lines))]
        written = np.concatenate([written, *map(_along, (*rows, np.array([begin, place.end])))])


def _place(chart, lines, bold, own, others, written, reach):
    """Return the best `Place` of these lines of words up to `reach` from a curve's `own` points."""
    half = np.array([max(map(len, lines)) * LETTER * (BOLD if bold else PLAIN), LETTER * len(lines) + 1]) / 2
    low = np.maximum([chart.left + GAP, chart.top] + half, own.min(axis=0) - half - reach)
    high = np.minimum([chart.width, chart.bottom - GAP] - half, own.max(axis=0) + half + reach)
    grid = np.meshgrid(*(np.arange(begin, max(begin, end) + 1, STEP) for begin, end in zip(low, high, strict=True)))
    centres = np.stack(grid, axis=-1).reshape(-1, 2)
    near = _distance(centres, half, own)
    kept = near <= max(reach, near.min())
    centres, near = centres[kept], near[kept]
    other, name = (_distance(centres, half, points) for points in (others, written))
    clear = np.minimum(np.minimum(near, other), name)
    cost = near + 3 * np.maximum(0, near + GAP - other) + 100 * np.maximum(0, GAP - clear) + 4 * len(lines)
    best = np.argsort(cost)[:TRIES]
    centres, cost, near = centres[best], cost[best], near[best]
    ends = own[_squares(centres, half, own).argmin(axis=1)]
    if near[0] > FAR:  # a line leads there, which should cross none
        begins = _edge(centres, half, ends)
        steps = (begins + (ends - begins) * share for share in np.linspace(0, 0.8, 9))
        cost = cost + 30 * sum(_distance(step, (0, 0), np.concatenate([others, written])) < GAP / 2 for step in steps)
    k = np.argmin(cost)
    return Place(cost[k], centres[k], half, ends[k], lines)


def _edge(centres, half, points):
    """Return the points of boxes that are nearest to these."""
    return centres + np.clip(points - centres, -half, half)


def _squares(centres, half, points):
    """Return the squared distance of each box from each point."""
    x, y = (np.maximum(0, np.abs(centres[:, None, k] - points[:, k]) - half[k]) for k in (0, 1))
    return x * x + y * y


def _distance(centres, half, points):
    """Return the distance of each box from the nearest point."""
    return np.sqrt(_squares(centres, half, points).min(axis=1, initial=np.inf))


def _along(marks):
    """Return points on the line through marks, at most `GAP` apart: no line crosses a box unseen."""
    steps = [np.linspace(a, b, 2 + int(math.dist(a, b) / GAP)) for a, b in zip(marks, marks[1:], strict=False)]
    return np.concatenate([marks, *steps])
