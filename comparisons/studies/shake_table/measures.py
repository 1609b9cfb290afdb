"""Measures of intensity of a campaign's tests: what is simpler than any model."""

import numpy as np
from scipy.signal import butter, sosfiltfilt

from analytic import SampledMotion

from ..fragility.study import peak_velocity
from .campaign import Campaign

CORNER = 0.2  # Hz, below which a measured acceleration is drift
TABLE = "PGV of the table"


def measures_of(campaign: Campaign) -> dict[str, np.ndarray]:
    """Of each test PGA [g] and PGV [m/s]: as the campaign states them of what the table was to play, and PGV of what
    was measured beside it; without such a statement both as measured."""
    tests, gravity = campaign.tests, campaign.specimens[0].scene.gravity
    table = np.array([_peak_velocity(test.motion) for test in tests])
    if not all({"peak", "ratio"} <= test.stated.keys() for test in tests):
        return {"PGA": np.array([test.motion.peak / gravity for test in tests]), "PGV": table}
    peak, ratio = (np.array([test.stated[name] for test in tests]) for name in ("peak", "ratio"))
    return {"PGA": peak, "PGV": peak * ratio * gravity, TABLE: table}


def _peak_velocity(motion):
    """Peak velocity [m/s] of a measured acceleration, whose integral would gather its drift."""
    steady = motion.samples - motion.samples.mean()
    high = butter(2, CORNER, "highpass", fs=1 / motion.dt, output="sos")
    return peak_velocity(SampledMotion(motion.dt, sosfiltfilt(high, steady), motion.label))
