"""The kernel as the benchmark calls it: no history, no ledger, outcomes only."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from analytic import kernel, layout
from analytic.batch import pulse_row, run_rows
from analytic.solver import ground, options, parameters

if TYPE_CHECKING:
    from .problems import Problem


def kernel_run(problem: Problem, tolerance: float) -> Callable[[], tuple[Any, int]]:
    """A function without arguments that runs `problem` and returns (state at the horizon, impacts)."""
    scene, totals = problem.scene, np.zeros(layout.TOTALS)
    inside = problem.horizon < scene.duration
    arguments = parameters(scene), ground(scene.motion), _options(problem, tolerance, inside), totals

    def run():
        end, _, _, _, history = kernel.run(*arguments)
        return np.array(history[1, 1:5] if inside else end[:4]), int(totals[layout.IMPACTS])

    return run


def kernel_batch(problem: Problem, tolerance: float, count: int) -> Callable[[], Any]:
    """A function that does `count` equal runs of `problem` in one compiled loop on one core."""
    scene = problem.scene
    shaking, chosen = ground(scene.motion), _options(problem, tolerance, problem.horizon < scene.duration)
    rows = np.tile(np.array(parameters(scene), dtype=float), (count, 1))
    pulses = np.tile(np.array(pulse_row(shaking)), (count, 1))
    return lambda: run_rows(rows, pulses, shaking, chosen, workers=1)


def _options(problem, tolerance, inside):
    return options(tolerance, rest_rate=problem.rest_rate, record=False, output_step=problem.horizon if inside else 0.0)
