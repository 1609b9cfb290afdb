"""Ground motion cut where it is not smooth, so that an integrator need not step over a corner."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from .motion import RICKER_PERIODS, SampledMotion

if TYPE_CHECKING:
    from .motion import PulseMotion
    from .types import GroundFunction, Motion


def shared_segments(
    motion: Motion | None, duration: float
) -> list[tuple[float, float, GroundFunction, GroundFunction]]:
    """[(start, end, a_g(t), a_v(t)), ...] as of `segments`: on each both accelerations are smooth and monotone."""
    level = segments(motion, duration)
    if motion is None or motion.vertical is None:
        return [(*piece, _line(0.0, 0.0, 0.0)) for piece in level]
    upright = segments(motion.vertical, duration)
    cuts = sorted({end for pieces in (level, upright) for _, end, _ in pieces})
    found, start, i, j = [], 0.0, 0, 0
    for end in cuts:
        found.append((start, end, level[i][2], upright[j][2]))
        start, i, j = end, i + (level[i][1] == end), j + (upright[j][1] == end)
    return found


def segments(motion: Motion | None, duration: float) -> list[tuple[float, float, GroundFunction]]:
    """[(start, end, a_g(t)), ...] from 0 to duration [s]: on each, a_g is smooth, and monotone in the open.

    One per interval of a record; pulses are cut at their zeros and extremes. a_g takes floats.
    """
    if isinstance(motion, SampledMotion):
        dt, samples = motion.dt, motion.samples.tolist()
        pieces = [
            (i * dt, (i + 1) * dt, _line(i * dt, a, (b - a) / dt))
            for i, (a, b) in enumerate(zip(samples[:-1], samples[1:], strict=True))
        ]
    elif motion is not None:
        if motion.shape == "ricker":
            centre = RICKER_PERIODS * math.pi
            turns = [0.0, *(centre + u for u in (-(6**0.5), -(2**0.5), 0.0, 2**0.5, 6**0.5)), 2 * centre]
        else:
            turns = np.arange(0, motion.length * motion.frequency + 0.1, math.pi / 2).tolist()
            if motion.phase:
                turns = [0.0, *(u + -motion.phase % (math.pi / 2) for u in turns[:-1]), turns[-1]]
        cuts = [motion.start + u / motion.frequency for u in turns[:-1]] + [motion.end]
        pieces = [(0.0, motion.start, _line(0.0, 0.0, 0.0))]
        pieces += [(a, b, _pulse(motion)) for a, b in zip(cuts[:-1], cuts[1:], strict=True)]
    else:
        pieces = []
    pieces.append((pieces[-1][1] if pieces else 0.0, math.inf, _line(0.0, 0.0, 0.0)))
    return [(a, min(b, duration), ground) for a, b, ground in pieces if a < min(b, duration)]


def _line(start: float, value: float, slope: float) -> GroundFunction:
    return lambda t: value + slope * (t - start)


def _pulse(motion: PulseMotion) -> GroundFunction:
    a, w, start, phase = motion.amplitude, motion.frequency, motion.start, motion.phase
    if motion.shape == "rectangular":
        return lambda t: a
    if motion.shape == "one-cosine":
        return lambda t: a * math.cos(w * (t - start) + phase)
    if motion.shape == "ricker":

        def ricker(t):
            b = 0.25 * (w * (t - start) - RICKER_PERIODS * math.pi) ** 2
            return a * (1 - 2 * b) * math.exp(-b)

        return ricker
    return lambda t: a * math.sin(w * (t - start) + phase)
