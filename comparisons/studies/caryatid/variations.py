"""What the paper leaves out: which slenderness it can have meant, other slendernesses, intensities and motions."""

import math
from functools import partial, reduce
from itertools import product
from typing import Any

import numpy as np

from analytic import rocking_spectrum, simulate, simulate_many, synthetic_motion
from analytic.motion import Motion

from ...running.refine import boundaries, drive
from .runs import FREE, ISOLATED, VULNERABLE_ABOUT, VULNERABLE_PERIOD, X_MAX, caryatid

LOW, HIGH = 0.10, 0.45  # rad
TOLERANCE = 1e-5  # rad
LONGEST = 8.0  # s, of the rocking periods looked at
# who stays upright
BOTH, ONLY_ISOLATED, ONLY_FREE, NEITHER = range(4)
CATEGORIES = ("both stay upright", "only the isolated one does", "only the free-standing one does", "both overturn")
WITHIN = "only the isolated one does, within 0.30 m"
SEEDS = 12


def vulnerable_period(motion: Motion, slenderness: float, step: float = 0.02) -> float:
    """Largest rocking period T_r [s] up to `LONGEST` at which a block overturns, on a grid of `step`; 0 if none."""
    periods = np.arange(LONGEST, 0.4, -step)
    overturns = rocking_spectrum(motion, periods, slenderness).overturns
    return round(float(periods[overturns].max(initial=0.0)), 6)


def claims(motion: Motion, quick: bool = False) -> tuple[list[dict[str, Any]], dict[str, np.ndarray]]:
    """Rows: for each of the paper's three claims the intervals of slenderness in which it holds; then where all do.

    Also the arrays of vulnerable period over slenderness.
    """
    free, isolated = caryatid(FREE, motion), caryatid(ISOLATED, motion)
    scan, step, near = (29, 0.1, 1e-2) if quick else (71, 0.02, 1e-3)

    def run(scene, points):
        return simulate_many([scene.with_(block={"slenderness": point}) for point in points])

    def vulnerable(points):
        periods = np.array([vulnerable_period(motion, point, step) for point in points])
        return abs(periods - VULNERABLE_PERIOD) <= VULNERABLE_ABOUT

    tests = {
        "free-standing overturns": (lambda points: run(free, points).overturns, 141, TOLERANCE),
        f"vulnerable below T_r = {VULNERABLE_PERIOD:g} ± {VULNERABLE_ABOUT:g} s": (vulnerable, scan, near),
        "isolated does not rock": (lambda points: ~run(isolated, points).lifted, 141, TOLERANCE),
    }
    rows = []
    for claim, (holds, points, tolerance) in tests.items():
        search = boundaries(LOW, HIGH, points, tolerance)
        (column,) = drive([search], partial(_outcomes, holds))
        intervals = _intervals(column.transitions, bool(holds([LOW])[0]))
        rows.append({"part": "claim", "claim": claim, "intervals": intervals, "evaluations": column.evaluations})
    together = reduce(_overlap, [row["intervals"] for row in rows])
    own, grid = free.block.slenderness, np.linspace(LOW, HIGH, scan)
    rows += [
        {"part": "claim", "claim": "all three", "intervals": together, "evaluations": None},
        {"part": "vulnerable", "slenderness": own, "step": step, "period": vulnerable_period(motion, own, step)},
    ]
    periods = np.array([vulnerable_period(motion, float(gamma), step) for gamma in grid])
    return rows, {"claims/slenderness": grid, "claims/vulnerable period": periods}


def _outcomes(holds, batch):
    return list(map(bool, holds([point for _, point in batch])))


def uplift_slenderness(motion: Motion) -> float:
    """Least slenderness [rad] that stays down on the bearings, from the acceleration alone: atan(max|a|/g).

    A block that stays down does not change the acceleration of its base, so any that does gives it.
    """
    scene = caryatid(ISOLATED, motion).with_(block={"slenderness": 1.2})
    return math.atan(simulate(scene, history=False).peak_base_acceleration / scene.gravity)


def _intervals(transitions, holds_at_low):
    edges = [LOW] if holds_at_low else []
    edges += [transition.high if transition.after else transition.low for transition in transitions]
    edges += [HIGH] if len(edges) % 2 else []
    return [edges[k : k + 2] for k in range(0, len(edges), 2)]


def _overlap(ones, others):
    pairs = [(max(a[0], b[0]), min(a[1], b[1])) for a in ones for b in others]
    return [[low, high] for low, high in sorted(pairs) if low < high]


def grid(quick: bool, fine: bool = True) -> tuple[np.ndarray, np.ndarray]:
    """(slendernesses [rad], intensities [-])."""
    slendernesses, intensities = (15, 12) if quick else (71, 56) if fine else (36, 34)
    return np.linspace(LOW, HIGH, slendernesses), np.linspace(0.25, 3.0, intensities)


def benefit(
    motion: Motion, slendernesses: np.ndarray, intensities: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Category (uint8), whether the isolated block lifts, and its peak base displacement [m], shape (n, k).

    The displacement is NaN where the isolated block overturns: runs end when that is certain.
    """
    scaled = [motion.scaled(float(factor)) for factor in intensities]
    changes = [{"block": {"slenderness": float(gamma)}, "motion": one} for gamma, one in product(slendernesses, scaled)]
    shape = len(slendernesses), len(intensities)
    free, isolated = (
        simulate_many([scene.with_(**change) for change in changes])
        for scene in (caryatid(FREE, motion), caryatid(ISOLATED, motion))
    )
    if free.failed.any() or isolated.failed.any():
        raise RuntimeError("the analytic model failed on a scene of the map; report it with its slenderness")
    category = np.select(
        [~free.overturns & ~isolated.overturns, ~isolated.overturns, ~free.overturns],
        [BOTH, ONLY_ISOLATED, ONLY_FREE],
        NEITHER,
    )
    displacement = np.where(isolated.overturns, np.nan, isolated.peak_base_displacement)
    return (
        category.astype(np.uint8).reshape(shape),
        isolated.lifted.reshape(shape),
        displacement.astype(np.float32).reshape(shape),
    )


def maps(motion: Motion, quick: bool = False) -> tuple[list[dict[str, Any]], dict[str, np.ndarray]]:
    """(rows, arrays): shares of the map of `motion` and of synthetic motions' maps, and the map itself."""
    fine, coarse = grid(quick), grid(quick, fine=False)
    found = benefit(motion, *fine)
    rows = [_shares("this motion", *found)]
    names = ("slenderness", "intensity", "category", "isolated lifts", "isolated displacement")
    arrays = {f"benefit/{name}": values for name, values in zip(names, (*fine, *found), strict=True)}
    for seed in range(3 if quick else SEEDS):
        rows.append(_shares(f"synthetic, seed {seed}", *benefit(synthetic_motion(seed=seed), *coarse)))
    return rows, arrays


def _shares(name, category, lifted, displacement):
    shares = {text: float((category == kind).mean()) for kind, text in enumerate(CATEGORIES)}
    within = (category == ONLY_ISOLATED) & (displacement <= X_MAX)
    return {
        "part": "benefit",
        "motion": name,
        "cells": int(category.size),
        **shares,
        WITHIN: float(within.mean()),
        "isolated lifts": float(lifted.mean()),
        "beyond x_max": float((displacement > X_MAX).mean()),
    }
