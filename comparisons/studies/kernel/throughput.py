"""The kernel at its work: an overturning map, a rocking spectrum, a process that runs one scene."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np

from analytic import Block, Scene, overturning_map, rocking_spectrum, synthetic_motion

PROJECT = Path(__file__).parents[3]
ONE_SCENE = "import analytic; from analytic.problems import problem_a; analytic.simulate(problem_a())"


def overturning_map_run(points: int = 100) -> tuple[float, int]:
    """(share that overturns, runs) of a one-sine map on one core.

    Block: p = 2.14 rad/s, slenderness 0.25, e = 0.9; frequencies 1 to 8 p, amplitudes 1 to 15 g tan(slenderness).
    """
    block = Block(mass=1.0, radius=0.75 * 9.81 / 2.14**2, slenderness=0.25, restitution=0.9)
    ratios = np.linspace(1, 8, points), np.linspace(1, 15, points)
    outcomes = overturning_map(Scene(block=block, duration=30.0), "one-sine", *ratios, workers=1)
    return float(outcomes.overturns.mean()), points**2


def rocking_spectrum_run(periods: int = 500) -> tuple[float, int]:
    """(share that overturns, runs) of a rocking spectrum under the synthetic motion, T_r 0.5 to 10 s, on one core."""
    outcomes = rocking_spectrum(synthetic_motion(), np.linspace(0.5, 10, periods), 0.28, workers=1)
    return float(outcomes.overturns.mean()), periods


def process_run() -> tuple[None, int]:
    """(None, runs) of a new process that imports `analytic` and runs problem A with the cached kernel."""
    environment = {**os.environ, "PYTHONPATH": str(PROJECT)}
    subprocess.run([sys.executable, "-c", ONE_SCENE], check=True, capture_output=True, env=environment, timeout=300)
    return None, 1


# what: (function, words)
WORK: dict[str, tuple[Callable[[], tuple[float | None, int]], str]] = {
    "overturning map": (overturning_map_run, "one-sine overturning map, 100 x 100, one core"),
    "rocking spectrum": (rocking_spectrum_run, "rocking spectrum of 500 periods under the synthetic motion, one core"),
    "process": (process_run, "a new process that runs problem A with the cached kernel"),
}
