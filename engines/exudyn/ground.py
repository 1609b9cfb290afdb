"""Ground acceleration for exudyn: one smooth expression per segment, and steps that end where segments meet."""

from __future__ import annotations

import math
from array import array
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import exudyn as exu
import numpy as np

from analytic.motion import SampledMotion

if TYPE_CHECKING:
    from analytic.motion import Motion

    from .model import Model


SUMS = 1e-12  # round-off of a sum of steps, over the duration
WHOLE = 1e-9  # of a step: tolerated excess of a segment over a whole number of steps


def ground_load(motion: Motion) -> Callable[[Any, Any], Any]:
    """Symbolic ground acceleration [m/s2] from time and the load vector, which holds the segment's parameters.

    Sampled: load = (a, slope) of a = a0 + slope t. Pulse: load = (amplitude, 0), zero outside the pulse.
    """
    if isinstance(motion, SampledMotion):
        return lambda t, load: load[0] + load[1] * t

    def pulse(t, load):
        u = motion.frequency * (t - motion.start)
        if motion.phase:
            u = u + motion.phase
        return load[0] * motion.form.value(exu.symbolic, u)

    return pulse


def segments(motion: Motion, duration: float) -> tuple[array, np.ndarray]:
    """(ends, loads): end times [s] of the n smooth segments up to `duration`; their load vectors, shape (n, 3)."""
    if isinstance(motion, SampledMotion):
        slope = np.diff(motion.samples) / motion.dt
        start = np.arange(len(slope)) * motion.dt
        ends, loads = start + motion.dt, np.column_stack([motion.samples[:-1] - slope * start, slope, 0 * slope])
    else:
        ends, loads = np.array([motion.start, motion.end]), np.array([[0.0, 0.0, 0.0], [motion.amplitude, 0.0, 0.0]])
    loads, ends = loads[ends > 0], ends[ends > 0]
    inside = int(np.searchsorted(ends, duration))
    still = np.zeros((1, 3))  # after the motion
    return array("d", [*ends[:inside], duration]), np.concatenate([loads, still])[: inside + 1]


class Ground:
    """Sets the loads to the segment of the next step, and keeps each step inside one segment."""

    def __init__(self, model: Model, longest: float = math.inf) -> None:
        """longest : longest step [s]."""
        self.ends, _ = segments(model.scene.motion, model.scene.duration)
        vectors = {motion: segments(motion, model.scene.duration)[1] for _, motion in model.loads}
        self.loads = [(number, vectors[motion]) for number, motion in model.loads]
        self.mbs, self.longest = model.mbs, longest
        self.slack = SUMS * max(1.0, model.scene.duration)
        self.dt = model.scene.motion.dt if isinstance(model.scene.motion, SampledMotion) else None
        self.at, self.limited = 0, False
        self.iterations = None
        self._enter()

    def _enter(self):
        self.end = self.ends[self.at]
        for number, vectors in self.loads:
            self.mbs.SetLoadParameter(number, "loadVector", vectors[self.at].tolist())

    def _next(self):
        self.at += 1
        self._enter()

    def begin(self, t: float, iterations: Any) -> float:
        """Begin a part of the integration at t [s]; returns the remaining time [s] of its segment.

        iterations: exudyn's iteration data of the adaptive solver; None: equal steps.
        """
        self.iterations, self.limited = iterations, False
        while self.end <= t + self.slack and self.at + 1 < len(self.ends):
            self._next()
        return self.end - t

    def equal(self, t: float, step: float) -> tuple[float, int]:
        """(end [s], number) of equal steps from t, each at most `step` [s], that meet the ends of segments."""
        left, samples = self.end - t, len(self.ends) - 1 - self.at  # segments of equal length, and the last
        if self.dt and samples and abs(left - self.dt) < self.slack:
            return self.ends[-2], samples * math.ceil(self.dt / step - WHOLE)
        return self.end, math.ceil(left / step)

    def prepare(self, mbs: exu.MainSystem, t: float) -> bool:
        """Before each attempt of a step that would end at t (PreStep): set its segment and the longest step after it.

        The rest of a segment is one step, or at least two equal ones, so that no very short step remains.
        """
        rest = self.end - t
        while rest < -self.slack and self.at + 1 < len(self.ends):
            self._next()
            rest = self.end - t
        iterations = self.iterations
        if iterations is None:  # fixed steps
            return True
        step = iterations.currentStepSize
        if rest > 2 * step:
            if self.limited:
                iterations.maxStepSize, self.limited = self.longest, False
            return True
        if rest > self.slack:
            limit = rest if rest <= step else rest / 2
        elif self.at + 1 < len(self.ends):
            limit = self.ends[self.at + 1] - self.end
        else:
            limit = self.longest
        iterations.maxStepSize, self.limited = min(limit, self.longest), True
        return True
