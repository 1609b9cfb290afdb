"""A horizontal and a vertical recorded motion brought to one step and one length, as one motion."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from .errors import SceneError
from .motion import SampledMotion

MOST_SAMPLES = 10_000_000  # of a component: a day at 100 Hz
SAME_STEP = 1e-9  # relative difference of two equal steps that are printed with different precision


def paired(level: SampledMotion, upright: SampledMotion) -> SampledMotion:
    """The motion `level` with `upright` as its vertical component; the time of both starts at their first sample.

    The coarser one is resampled linearly to the step of the other, and the shorter one is padded with zeros. Warnings
    say so, after those of `upright`.

    Raises
    ------
    SceneError
        The two together would hold more than `MOST_SAMPLES`.
    """
    said: list[str] = []
    step = min(level.dt, upright.dt)
    samples = max(level.end, upright.end) / step
    if samples > MOST_SAMPLES:
        raise SceneError(
            "motion.vertical",
            f"{upright.end:.4g} s at {upright.dt:.4g} s",
            f"beside {level.end:.4g} s at {level.dt:.4g} s they are {samples:.3g} samples together",
            f"resample the finer one, to at most {MOST_SAMPLES:.0e} in the longer one's time",
        )
    first, second = (_resampled(motion, step, said) for motion in (level, upright))
    count = max(len(first), len(second))
    first, second = (
        _padded(samples, count, step, motion.label, said) for samples, motion in ((first, level), (second, upright))
    )
    warnings = tuple(dict.fromkeys((*level.warnings, *upright.warnings, *said)))
    vertical = replace(upright, dt=step, samples=second, warnings=())
    return SampledMotion(step, first, f"{level.label}, vertical {upright.label}", warnings, vertical)


def _resampled(motion: SampledMotion, step: float, said: list[str]) -> np.ndarray:
    """Samples at the step [s]; the last one at the motion's end, or the first after it."""
    if math.isclose(motion.dt, step, rel_tol=SAME_STEP):
        return motion.samples
    said.append(f"{motion.label}: resampled from {motion.dt:.6g} s to the {step:.6g} s of the other component")
    times = step * np.arange(math.ceil(motion.end / step * (1 - SAME_STEP)) + 1)
    last = times[-1] <= motion.end * (1 + SAME_STEP)
    return motion.acceleration(np.append(times[:-1], motion.end) if last else times)


def _padded(samples: np.ndarray, count: int, step: float, label: str, said: list[str]) -> np.ndarray:
    missing = count - len(samples)
    if missing:
        said.append(f"{label}: {missing * step:.6g} s of zeros put at its end, as the other component is longer")
    return np.append(samples, np.zeros(missing))
