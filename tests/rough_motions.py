"""A made-up motion for tests: a sine under noise within a bell, with a corner at every sample."""

import numpy as np

from analytic import SampledMotion


def rough(seed, peak=4.0, duration=6.0, frequency=0.8):
    """The motion of this seed, with its peak [m/s2], over so long [s], the sine of a frequency [Hz]."""
    rng, t = np.random.default_rng(seed), np.arange(0, duration, 0.01)
    a = np.sin(2 * np.pi * frequency * t) + 0.6 * rng.standard_normal(len(t))
    a *= np.exp(-(((t / duration - 0.35) / 0.25) ** 2))
    return SampledMotion(0.01, peak * a / np.abs(a).max())
