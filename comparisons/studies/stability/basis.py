"""What a hard case is, and the block and the motions that several share."""

import math
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from analytic import SampledMotion, Scene
from analytic.caryatid import BASE, BEARINGS, caryatid_block
from analytic.problems import benchmark_block

BLOCK = benchmark_block()  # omega_r = 2.60 rad/s, slenderness 0.25
GAMMA = BLOCK.slenderness
THRESHOLD = 9.81 * math.tan(GAMMA)  # uplift acceleration on rigid ground [m/s2]
STATUE = caryatid_block(0.28)
ISOLATED = Scene(block=STATUE, base=BASE, bearings=BEARINGS, duration=8.0)

FREE, SLIDING = "free rocking", "model and Moreau"


@dataclass(frozen=True, eq=False)
class HardCase:
    """One hard case.

    title: what is hard about it. closed: the solution is known in closed form. expected: measure -> value known
    beforehand, slips in m. step [s]: what every solver that steps has to take. tolerances: kind of solver -> measure ->
    (value, reason), in place of the general ones. twin_until: the twin is slow, and judges the kernel up to this time
    [s] only. quick: part of the quick study.
    """

    title: str
    scene: Scene
    closed: bool = False
    expected: dict = field(default_factory=dict)
    step: float | None = None
    tolerances: dict = field(default_factory=dict)
    twin_until: float = math.inf
    quick: bool = False

    @property
    def name(self) -> str:
        return self.scene.name

    @property
    def oracle(self) -> str:
        """Who judges: with friction the model all others, and Moreau's time stepping the model; else the closed form of
        free rocking, or kernel and twin each other, and the kernel all others."""
        if self.scene.friction is not None:
            return SLIDING
        return FREE if self.closed else "kernel and twin"


def sampled(values: npt.ArrayLike, dt: float = 0.01) -> SampledMotion:
    return SampledMotion(dt, np.asarray(values, dtype=float))


def times(seconds: float, dt: float = 0.01) -> np.ndarray:
    return np.arange(round(seconds / dt) + 1) * dt
