"""The paper's cost claim: the algebraic bearing against Bouc-Wen, at equal error, interleaved in one process."""

from __future__ import annotations

import math
import time
from functools import partial
from itertools import product
from typing import Any

import numpy as np
from numba import njit

from analytic import PulseMotion, kernel, layout, simulate
from analytic.laws import NUMBERS
from analytic.laws.algebraic import after_travel, on_branch, virtual_travel
from analytic.motion import Motion
from analytic.solver import ground, options, parameters

from .runs import ISOLATED, caryatid

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
