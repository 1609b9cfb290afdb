"""The kernel and scipy's `solve_ivp` on a problem, both written for speed.

There are no classes, the right-hand side uses floats instead of arrays, the set of events is the smallest possible, and
the first step follows from the length of the next swing. The simple form to learn from is `analytic.twin`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from scipy.integrate import solve_ivp

from analytic import kernel, layout
from analytic.solver import ground, options, parameters
from analytic.twin.run import Event

if TYPE_CHECKING:
    from .problems import Problem

METHODS = ("RK45", "DOP853", "LSODA", "Radau")
SHORT_HOP = 0.3  # in units of 1/omega_r: below it, the first step is the whole hop


def kernel_run(problem: Problem, tolerance: float) -> Callable[[], tuple[float, int]]:
    """A function that runs `problem` without history or ledger; it returns (tilt at the horizon, impacts)."""
    scene = problem.scene
    inside = problem.horizon < scene.duration
    rest = problem.rest_rate / scene.rocking_frequency
    chosen = options(tolerance, rest_rate=rest, record=False, output_step=problem.horizon if inside else 0.0)
    arguments = parameters(scene), ground(scene.motion), chosen

    def run():
        totals, *_, history = kernel.run(*arguments)
        return float(history[1, 1] if inside else totals[layout.END_TILT]), int(totals[layout.IMPACTS])

    return run


def scipy_run(problem: Problem, rtol: float, method: str) -> Callable[[], tuple[float, int]]:
    """A function that runs `problem` by `solve_ivp`, flight by flight; it returns (tilt at the horizon, impacts).

    Absolute tolerances are `rtol` of gamma and of gamma omega_r.
    """
    p2, gamma, a, frequency = problem.p2, problem.gamma, problem.a, problem.frequency
    omega = math.sqrt(p2)
    atol = rtol * np.array([gamma, gamma * omega])
    sin, cos = math.sin, math.cos

    def fly(begin, stop, tilt, rate, side, pushed):
        def free(t, y):
            phi, w = y.tolist()
            return w, -p2 * sin(side * gamma - phi)

        def forced(t, y):
            phi, w = y.tolist()
            angle = side * gamma - phi
            return w, -p2 * (sin(angle) + a * sin(frequency * t) * cos(angle))

        def impact(t, y):  # the root at take-off is divided out
            return side * y[0] / (t - begin) if t > begin else 1.0

        step = {}
        if tilt == 0.0:
            push = a * sin(frequency * begin) * cos(gamma) if pushed else 0.0
            hop = 2 * abs(rate) / (p2 * (sin(gamma) + side * push)) if rate else 0.0
            if 0 < hop * omega < SHORT_HOP:
                step["first_step"] = min(1.1 * hop, stop - begin)
        derivative, event = forced if pushed else free, Event(impact)
        solution = solve_ivp(
            derivative, (begin, stop), (tilt, rate), method, events=event, rtol=rtol, atol=atol, **step
        )
        if solution.status < 0:
            raise RuntimeError(solution.message)
        return float(solution.t[-1]), *solution.y[:, -1].tolist(), solution.status == 1

    def run():
        t, tilt, rate, side = problem.begin, problem.tilt, 0.0, problem.side
        impacts, found = 0, math.nan
        for stop in problem.stops:
            pushed = stop <= problem.pulse_end
            while t < stop:
                t, tilt, rate, hit = fly(t, stop, tilt, rate, side, pushed)
                if hit:
                    impacts, tilt, rate, side = impacts + 1, 0.0, problem.restitution * rate, -side
                    if abs(rate) < problem.rest_rate:
                        return found, impacts
            if stop == problem.horizon:
                found = tilt
        return found, impacts

    return run
