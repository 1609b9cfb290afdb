"""Measures of intensity of a campaign's tests: what is simpler than any model."""

import numpy as np
from scipy.signal import butter, sosfiltfilt

from analytic import SampledMotion

from ...ensembles.motions import peak_velocity
from .campaign import Campaign

CORNER = 0.2  # Hz, below which a measured acceleration is drift
TABLE = "PGV of the table"
PADDED = 9  # samples by which the filter extends a motion at either end: it has to be longer


def unfit(motion: SampledMotion) -> str | None:
    """Why a motion has no PGA or PGV whose logarithm can be taken, and the remedy; None: it has both."""
    if (count := len(motion.samples)) <= PADDED:
        return f"holds {count} samples, PGV needs {PADDED + 1} or more; give the whole record, or remove the test"
    if not motion.dt < 0.5 / CORNER:
        return (
            f"sampled at {motion.dt:g} s, PGV above {CORNER:g} Hz needs less than {0.5 / CORNER:g} s; give it as it "
            "was sampled, or mend its step"
        )
    if np.ptp(motion.samples) == 0 or not _peak_velocity(motion) > 0:
        return f"is {motion.samples[0]:g} m/s2 throughout, no shaking; give what was measured, or remove the test"
    return None


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
    return peak_velocity(SampledMotion(motion.dt, sosfiltfilt(high, steady, padlen=PADDED), motion.label))
