"""Smooth segments of a ground motion, so that an integrator need not step across a corner of it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from .motion import SampledMotion

if TYPE_CHECKING:
    from .motion import Motion, PulseMotion
    from .types import GroundFunction


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
        turns = motion.form.turns(motion.form.length, motion.phase)
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
    a, w, start, phase, value = motion.amplitude, motion.frequency, motion.start, motion.phase, motion.form.value
    return lambda t: a * value(math, w * (t - start) + phase)
