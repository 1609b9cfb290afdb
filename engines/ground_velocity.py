"""Ground velocity over time, exact for records and pulses; its differences are the impulses of an engine's steps."""

from __future__ import annotations

import math
from array import array
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from analytic.motion import SampledMotion

if TYPE_CHECKING:
    from analytic import PulseMotion
    from analytic.motion import Motion


def ground_velocity(motion: Motion | None) -> Callable[[float], float] | None:
    """A function of time [s] giving the integral of the ground acceleration from 0 [m/s].

    The mean acceleration of a step is the difference of two values over the time between them. An engine that samples
    the acceleration instead loses part of a pulse that starts or ends within a step.
    """
    if motion is None:
        return None
    return _sampled(motion) if isinstance(motion, SampledMotion) else _pulse(motion)


def _sampled(motion: SampledMotion) -> Callable[[float], float]:
    dt, a = motion.dt, motion.samples
    # compact, and read as quickly as a list
    sums = array("d", np.concatenate(([0.0], np.cumsum(0.5 * dt * (a[1:] + a[:-1])))).tobytes())
    level, slope = array("d", a.tobytes()), array("d", (np.diff(a) / dt).tobytes())
    last, end = len(slope), sums[-1]

    def velocity(t):
        if t <= 0:
            return 0.0
        i = int(t / dt)
        if i >= last:
            return end
        u = t - i * dt
        return sums[i] + u * (level[i] + 0.5 * slope[i] * u)

    return velocity


def _pulse(motion: PulseMotion) -> Callable[[float], float]:
    frequency, start, length = motion.frequency, motion.start, motion.length
    size, phase = motion.amplitude / frequency, motion.phase
    integral = motion.form.integral

    def velocity(t):
        return size * integral(math, frequency * min(max(t - start, 0.0), length), phase)

    return velocity
