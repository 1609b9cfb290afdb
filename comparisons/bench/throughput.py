"""What the kernel costs at its work: per record sample, per run of a map, per spectrum, per process."""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from analytic import Block, Scene, overturning_map, rocking_spectrum
from analytic.solver import TOLERANCE

from .kernel_solver import kernel_batch

if TYPE_CHECKING:
    from analytic.types import Motion

    from .problems import Problem

PROJECT = Path(__file__).parents[2]
# A process that runs one scene, with the seconds since its start after each part.
ONE_SCENE = """
import time
begin = time.perf_counter()
import numpy
numpy_done = time.perf_counter()
import numba
numba_done = time.perf_counter()
import analytic
from analytic.problems import problem_a
analytic_done = time.perf_counter()
scene = problem_a()
analytic.simulate(scene)
run_done = time.perf_counter()
print(numpy_done - begin, numba_done - numpy_done, analytic_done - numba_done, run_done - analytic_done,
      time.process_time())
"""


def sample_cost(problem: Problem, rounds: int, tolerance: float = TOLERANCE, count: int = 20) -> list[float]:
    """CPU seconds per record sample of equal runs in one compiled loop, one per round."""
    run, samples = kernel_batch(problem, tolerance, count), len(problem.scene.motion.samples) - 1
    return _cpu_seconds(run, rounds, count * samples)


def batch_cost(problem: Problem, rounds: int, tolerance: float, count: int = 200) -> list[float]:
    """CPU seconds per run of equal runs in one compiled loop, one per round."""
    return _cpu_seconds(kernel_batch(problem, tolerance, count), rounds, count)


def map_cost(rounds: int, points: int = 100) -> tuple[list[float], float]:
    """(CPU seconds per run, one per round; share that overturns) of a one-sine map on one core.

    Block: p = 2.14 rad/s, slenderness 0.25, e = 0.9; frequencies 1 to 8 p,
    amplitudes 1 to 15 g tan(slenderness).
    """
    block = Block(mass=1.0, radius=0.75 * 9.81 / 2.14**2, slenderness=0.25, restitution=0.9)
    scene = Scene(block=block, duration=30.0)
    ratios = np.linspace(1, 8, points), np.linspace(1, 15, points)
    share = float(overturning_map(scene, "one-sine", *ratios, workers=1).overturns.mean())
    return _cpu_seconds(lambda: overturning_map(scene, "one-sine", *ratios, workers=1), rounds, points**2), share


def spectrum_cost(motion: Motion, rounds: int, periods: int = 500, workers: int = 2) -> tuple[list[float], float]:
    """(wall seconds, one per round; share that overturns) of a rocking spectrum, T_r from 0.5 to 10 s, on 2 cores."""
    periods, seconds = np.linspace(0.5, 10, periods), []  # type: ignore[assignment]  # from their number to them
    outcomes = rocking_spectrum(motion, periods, 0.28, workers=workers)
    for _ in range(rounds):
        begin = time.perf_counter()
        rocking_spectrum(motion, periods, 0.28, workers=workers)
        seconds.append(time.perf_counter() - begin)
    return seconds, float(outcomes.overturns.mean())


def start_up(rounds: int) -> tuple[list[float], dict[str, float], float]:
    """Processes that run one scene with the cached kernel: elapsed seconds, medians of their parts and of their CPU."""
    environment = {**os.environ, "PYTHONPATH": str(PROJECT)}
    seconds, parts = [], []
    for _ in range(rounds + 1):
        begin = time.perf_counter()
        done = subprocess.run(
            [sys.executable, "-c", ONE_SCENE], capture_output=True, text=True, check=True, env=environment, timeout=300
        )
        seconds.append(time.perf_counter() - begin)
        parts.append([float(word) for word in done.stdout.split()])
    seconds, parts = seconds[1:], parts[1:]  # the first one may compile the kernel
    *medians, cpu = (statistics.median(values) for values in zip(*parts, strict=True))
    names = ("numpy", "numba", "analytic", "first run")
    return seconds, dict(zip(names, medians, strict=True)), cpu


def _cpu_seconds(run, rounds, runs):
    run()
    seconds = []
    for _ in range(rounds):
        begin = time.process_time()
        run()
        seconds.append((time.process_time() - begin) / runs)
    return seconds
