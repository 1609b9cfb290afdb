"""What the solvers are timed on: problems A and B, the isolated Caryatid under a record."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from analytic import Scene, simulate
from analytic.caryatid import BASE, BEARINGS, caryatid_block
from analytic.problems import problem_a, problem_b
from analytic.solver import REST_RATE

if TYPE_CHECKING:
    from analytic import SampledMotion
    from analytic.types import Motion

TIGHTEST = 1e-17
SLENDER = 0.18  # rad: the isolated Caryatid rocks without overturning, under the Duzce record and the synthetic motion


@dataclass(frozen=True, eq=False)
class Problem:
    """A scene, the state a solver is judged by, and the impacts it must count.

    horizon [s]: where the state is read; the run may go on to the scene's duration. rest_rate: the block rests when
    an impact leaves less than this share of omega_r. reference: |tilt| at the horizon, or (tilt, tilt rate,
    displacement, velocity) there. scale: what an error is divided by, per entry of the reference.
    """

    name: str
    scene: Scene
    horizon: float
    rest_rate: float
    impacts: int
    reference: np.ndarray
    scale: np.ndarray

    def error(self, state: Sequence[float] | np.ndarray) -> float:
        """Largest error of a state (tilt, tilt rate, displacement, velocity) at the horizon, over its scale."""
        if len(self.reference) == 1:
            state = np.abs(state[:1])
        return float(np.max(np.abs(np.asarray(state) - self.reference) / self.scale))


def block_problems() -> tuple[Problem, Problem]:
    """Problems A (10 impacts to 7 s) and B (81 impacts, until one leaves less than 1e-4 omega_r)."""
    gamma = problem_a().block.slenderness
    scale = np.array([gamma])
    # |tilt| at the horizon by 30-digit Taylor integration
    a = Problem("A", problem_a(duration=7.0), 7.0, REST_RATE, 10, np.array([0.01588089793859602683756374]), scale)
    b = Problem("B", problem_b(duration=9.2), 6.0, 1e-4, 81, np.array([0.01186179747282689895957273]), scale)
    return a, b


def caryatid(slenderness: float, motion: Motion, duration: float | None) -> Scene:
    """The Caryatid on the bearings of the paper's Table 1 under `motion`."""
    return Scene(
        name=f"isolated Caryatid, slenderness {slenderness:g}",
        motion=motion,
        duration=duration,
        block=caryatid_block(slenderness),
        base=BASE,
        bearings=BEARINGS,
    )


def caryatid_problem(slenderness: float, motion: Motion, duration: float) -> Problem:
    """The isolated Caryatid under `motion`, judged at its end; the reference is the kernel at its tightest.

    How far an independent solver is from that reference is one of the benchmark's figures.
    """
    scene = caryatid(slenderness, motion, duration)
    response = simulate(scene, history=False, tolerance=TIGHTEST)
    end = response.end
    state = np.array([end.tilt, end.tilt_rate, end.base_displacement, end.base_velocity])
    # the velocity that belongs to the peak displacement at the isolation period of 2 s, Table 1(a)
    speed = response.peak_base_displacement * math.pi
    scale = np.array([slenderness, slenderness * scene.rocking_frequency, response.peak_base_displacement, speed])
    return Problem(scene.name, scene, duration, REST_RATE, response.impact_count, state, scale)


def record_problems(motion: SampledMotion) -> tuple[Problem, ...]:
    """The isolated Caryatid under a record: as it is, where it stands, and slender, in the middle of its rocking."""
    stands = caryatid_problem(0.28, motion, motion.end)
    whole = simulate(caryatid(SLENDER, motion, motion.end), history=False)
    if not whole.uplifts:
        return (stands,)
    begin, until = whole.uplifts[0], max(whole.rests, default=whole.end.time)
    return stands, caryatid_problem(SLENDER, motion, round(begin + 0.7 * (until - begin), 2))
