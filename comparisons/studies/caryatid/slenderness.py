"""Which slendernesses fit the paper's three claims: the number it does not print, enclosed by bisection."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from analytic import rocking_spectrum, simulate, simulate_many

from ...running.refine import boundaries, drive
from . import paper
from .runs import FREE, ISOLATED, caryatid

if TYPE_CHECKING:
    from analytic.types import Motion

LOW, HIGH = 0.10, 0.45  # rad
TOLERANCE = 1e-5  # rad
LONGEST = 8.0  # s, of the rocking periods looked at


def vulnerable_period(motion: Motion, slenderness: float, step: float = 0.02) -> float:
    """Largest rocking period T_r [s] up to `LONGEST` at which a block overturns, on a grid of `step`; 0 if none."""
    periods = np.arange(LONGEST, 0.4, -step)
    overturns = rocking_spectrum(motion, periods, slenderness).overturns
    return round(float(periods[overturns].max(initial=0.0)), 6)


def claims(motion: Motion, quick: bool = False) -> tuple[list[dict[str, Any]], dict[str, np.ndarray]]:
    """Rows: for each claim the intervals of slenderness in which it holds; the last row is where all do.

    Also the arrays of vulnerable period over slenderness.
    """
    free, isolated = caryatid(FREE, motion), caryatid(ISOLATED, motion)

    def run(scene, points):
        return simulate_many([scene.with_(block={"slenderness": point}) for point in points])

    def vulnerable(points):
        return [
            abs(vulnerable_period(motion, point, step) - paper.VULNERABLE_PERIOD) <= paper.VULNERABLE_ABOUT
            for point in points
        ]

    scan, step, near = (29, 0.1, 1e-2) if quick else (71, 0.02, 1e-3)
    tests = {
        "free-standing overturns": (lambda points: run(free, points).overturns, 141, TOLERANCE),
        f"vulnerable below T_r = {paper.VULNERABLE_PERIOD:g} ± {paper.VULNERABLE_ABOUT:g} s": (vulnerable, scan, near),
        "isolated does not rock": (lambda points: ~run(isolated, points).lifted, 141, TOLERANCE),
    }
    rows, claimed = [], []
    for claim, (holds, points, tolerance) in tests.items():
        (column,) = drive(
            [boundaries(LOW, HIGH, points, tolerance)],
            lambda batch, holds=holds: list(map(bool, holds([point for _, point in batch]))),  # type: ignore[misc]  # of a round's batch, see `drive`
        )
        intervals = _intervals(column.transitions, bool(holds([LOW])[0]))
        claimed.append(intervals)
        rows.append({"part": "claim", "claim": claim, "intervals": intervals, "evaluations": column.evaluations})
    together = claimed[0]
    for intervals in claimed[1:]:
        together = _overlap(together, intervals)
    rows.append({"part": "claim", "claim": "all three", "intervals": together, "evaluations": None})
    own = free.block.slenderness
    rows.append(
        {"part": "vulnerable", "slenderness": own, "step": step, "period": vulnerable_period(motion, own, step)}
    )
    grid = np.linspace(LOW, HIGH, scan)
    return rows, {
        "claims/slenderness": grid,
        "claims/vulnerable period": np.array([vulnerable_period(motion, float(gamma), step) for gamma in grid]),
    }


def uplift_slenderness(motion: Motion) -> float:
    """Least slenderness [rad] that stays down on the bearings, from the acceleration alone: atan(max|a|/g).

    A block that stays down does not change the acceleration of its base, so any that does gives it.
    """
    scene = caryatid(ISOLATED, motion).with_(block={"slenderness": 1.2})
    return math.atan(simulate(scene, history=False).peak_base_acceleration / scene.gravity)


def _intervals(transitions, holds_at_low):
    edges = [LOW] if holds_at_low else []
    for transition in transitions:
        edges.append(transition.high if transition.after else transition.low)
    edges += [HIGH] if len(edges) % 2 else []
    return [edges[k : k + 2] for k in range(0, len(edges), 2)]


def _overlap(ones, others):
    pairs = [(max(a[0], b[0]), min(a[1], b[1])) for a in ones for b in others]
    return [[low, high] for low, high in sorted(pairs) if low < high]
