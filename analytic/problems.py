"""Problems A and B: two scenes with reference solutions, for timing and comparing solvers."""

import math

from .motion import PulseMotion
from .scene import Block, Scene, Start


def benchmark_block() -> Block:
    """The block of problems A and B: omega_r = 2.60 rad/s with g = 9.81 m/s2, slenderness 0.25, Housner's e."""
    return Block(mass=1000.0, radius=0.75 * 9.81 / 2.60**2, slenderness=0.25)


def problem_a(duration: float = 7.0) -> Scene:
    """Problem A: free rocking on rigid ground from 0.9 slenderness."""
    return Scene(name="problem A", block=benchmark_block(), start=Start(tilt=0.9 * 0.25), duration=duration)


def problem_b(duration: float = 6.0) -> Scene:
    """Problem B: the block at rest under one full sine of 1.2 g tan(slenderness) at 5.2 rad/s."""
    block = benchmark_block()
    pulse = PulseMotion("one-sine", 1.2 * 9.81 * math.tan(block.slenderness), 5.2)
    return Scene(name="problem B", block=block, motion=pulse, duration=duration)
