"""Measures of intensity of a campaign's tests: what is simpler than any model."""

import numpy as np

from ..fragility.study import peak_velocity
from .campaign import Campaign


def measures_of(campaign: Campaign) -> dict[str, np.ndarray]:
    """Of each test PGA [g] and PGV [m/s]: as the campaign states them of what the table was to play, where it does.
    The table's measured acceleration has noise, which its integral gathers; those of it stand beside them."""
    tests, gravity = campaign.tests, campaign.specimens[0].scene.gravity
    table = np.array([(test.motion.peak / gravity, _peak_velocity(test.motion)) for test in tests]).T
    if not all({"peak", "ratio"} <= test.stated.keys() for test in tests):
        return {"PGA": table[0], "PGV": table[1]}
    peak, ratio = (np.array([test.stated[name] for test in tests]) for name in ("peak", "ratio"))
    stated = {"PGA": peak, "PGV": peak * ratio * gravity}
    return stated | {"PGA of the table": table[0], "PGV of the table": table[1]}


def _peak_velocity(motion):
    """Peak velocity [m/s] of a table that is at rest before and after."""
    return peak_velocity(type(motion)(motion.dt, motion.samples - motion.samples.mean(), motion.label))
