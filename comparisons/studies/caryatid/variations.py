"""What the paper leaves out: which slenderness it can have meant, other slendernesses, intensities and motions; and its
cost claim: the algebraic bearing against Bouc-Wen, at equal error, interleaved in one process.
"""

import math
import time
from functools import partial, reduce
from itertools import product
from typing import Any

import numpy as np
from numba import njit

from analytic import PulseMotion, kernel, layout, rocking_spectrum, simulate, simulate_many, synthetic_motion
from analytic.laws import NUMBERS
from analytic.laws.algebraic import after_travel, on_branch, virtual_travel
from analytic.motion import Motion
from analytic.solver import ground, options, parameters

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


LAWS = ("algebraic", "bouc-wen")
BOUC_WEN = NUMBERS["bouc-wen"]
TOLERANCES = (1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
DIVISIONS = (1, 2, 4, 8, 16)  # fixed steps per sample of the motion
ERRORS = {"kernel": (1e-8, 1e-10, 1e-12), "fixed-step RK4": (1e-6, 3e-7, 1e-7, 3e-8)}
REPEATS = 6  # of which the least counts, in every round


def cost_rows(motion: Motion, quick: bool = False) -> list[dict[str, Any]]:
    """Rows: CPU of the algebraic over that of the Bouc-Wen bearing, median and spread over rounds.

    Errors are those of the final displacement over the peak, of each law against its own tight solution.
    """
    rounds = 3 if quick else 7
    record = {law: caryatid(ISOLATED, motion).with_(bearings={"law": law}, duration=motion.end) for law in LAWS}
    shaking = PulseMotion("one-sine", 3.0, math.pi)
    pulse = {law: scene.with_(motion=shaking, duration=10.0) for law, scene in record.items()}
    return [
        _compared(
            "kernel",
            "one-sine pulse: Taylor steps, code alike for both laws",
            pulse,
            [partial(_kernel, tolerance=tolerance, repeats=20) for tolerance in TOLERANCES],
            rounds,
        ),
        _compared(
            "fixed-step RK4",
            "record: the same loop; x_j fixed at each reversal",
            record,
            [partial(_fixed_step, divisions=divisions) for divisions in DIVISIONS],
            rounds,
        ),
    ]


def _least(runs):
    """Least CPU of each of `runs` (each returns CPU and a value) over interleaved repeats, and their values.

    Another load on the core's other thread doubles a run's CPU time, and only ever adds to it.
    """
    spent = np.full((REPEATS, len(runs)), np.inf)
    values = [None] * len(runs)
    for repeat in range(REPEATS):
        for i in range(len(runs)) if repeat % 2 else reversed(range(len(runs))):
            spent[repeat, i], values[i] = runs[i]()
    return spent.min(axis=0), values


def _kernel(scene, tolerance, repeats):
    """CPU of the compiled run alone, and its final displacement."""
    run = parameters(scene), ground(scene.motion), options(tolerance)
    begin = time.process_time()
    for _ in range(repeats):
        totals, *_ = kernel.run(*run)
    return (time.process_time() - begin) / repeats, float(totals[layout.END_X])


@njit  # no cache: numba would not see that a law has changed
def _algebraic(z, s, travel, dx, c):
    """z after dx from z: on the branch of direction s, where `travel` = D_c + s (x - x_c) is known, with one power."""
    if dx * s < 0:
        return after_travel(z, dx, c)
    return on_branch(s, travel + s * dx, c)


@njit
def _rk4(dt, samples, divisions, par):
    """Final displacement in full contact, eq. (2), with RK4; the algebraic history is committed at each step's end."""
    x, v, z, s = 0.0, 0.0, 0.0, 1.0
    law, count, kb, c, mass = par.law, par.count, par.kb, par.constants, par.M
    travel = virtual_travel(s, z, c)
    h = dt / divisions
    for i in range(len(samples) - 1):
        slope = (samples[i + 1] - samples[i]) / dt
        for k in range(divisions):
            x1, v1, z1 = x, v, z
            dx, dv, dz = 0.0, 0.0, 0.0
            for stage in range(4):
                at = 0.0 if stage == 0 else (h if stage == 3 else 0.5 * h)
                rate = 0.0
                if law == BOUC_WEN:
                    rate = 0.5 * c.dk * v1 * (1 - math.copysign(1.0, v1) * z1 / c.f0)
                elif stage > 0:
                    z1 = _algebraic(z, s, travel, x1 - x, c)
                push = -count * (kb * x1 + z1) / mass - (samples[i] + slope * (k * h + at))
                weight = 1 / 6 if stage == 0 or stage == 3 else 1 / 3
                dx, dv, dz = dx + weight * v1, dv + weight * push, dz + weight * rate
                ahead = 0.5 * h if stage < 2 else h
                x1, v1, z1 = x + ahead * v1, v + ahead * push, z + ahead * rate
            if law == BOUC_WEN:
                z += h * dz
            elif s * dx >= 0:
                z = _algebraic(z, s, travel, h * dx, c)
                travel += s * h * dx
            else:  # a reversal: the history is fixed anew
                s, before = -s, z
                z = after_travel(before, h * dx, c)
                travel = virtual_travel(s, before, c) + s * h * dx
            x, v = x + h * dx, v + h * dv
    return x


def _fixed_step(scene, divisions):
    par, motion = parameters(scene), scene.motion
    begin = time.process_time()
    end = _rk4(motion.dt, motion.samples, divisions, par)
    return time.process_time() - begin, end


def _compared(integrator, what, scenes, runs, rounds):
    """CPU of both laws, a ratio per round; runs: by accuracy, coarse to fine, each gives (CPU, final displacement).

    Compared at equal error, between the levels of each law on logarithmic scales.
    """
    tight = {law: simulate(scene, tolerance=1e-16, history=False) for law, scene in scenes.items()}
    for scene in scenes.values():
        runs[0](scene)  # compiled
    cpu, errors = np.empty((rounds, len(LAWS), len(runs))), np.empty((len(LAWS), len(runs)))
    for number, (k, run) in product(range(rounds), enumerate(runs)):
        cpu[number, :, k], ends = _least([partial(run, scenes[law]) for law in LAWS])
        errors[:, k] = [
            abs(end - tight[law].end.base_displacement) / tight[law].peak_base_displacement
            for law, end in zip(LAWS, ends, strict=True)
        ]
    at = [
        [_cpu_at(target, own, spent) for own, spent in zip(errors, one, strict=True)]
        for one, target in product(cpu, ERRORS[integrator])
    ]
    ratios = [a / b for a, b in at if a is not None and b is not None]
    low, middle, high = np.percentile(ratios, (10, 50, 90)) if ratios else (None, None, None)
    return {
        "part": "cost",
        "integrator": integrator,
        "what": what,
        "ratio": middle,
        "ratio_low": low,
        "ratio_high": high,
        "ratios": len(ratios),
        "errors": errors.tolist(),
        "cpu_seconds": np.median(cpu, axis=0).tolist(),  # shape (laws, levels)
        "at_errors": ERRORS[integrator],
    }


def _cpu_at(error, errors, cpu):
    """CPU at `error` by logarithmic interpolation; None outside the errors of the levels."""
    errors = np.maximum(errors, 1e-17)
    best = np.minimum.accumulate(errors)  # errors that do not increase with finer levels
    if not best[-1] <= error <= best[0]:
        return None
    return float(np.exp(np.interp(-np.log(error), -np.log(best), np.log(cpu))))
