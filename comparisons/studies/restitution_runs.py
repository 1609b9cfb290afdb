"""One run of the restitution study: what is kept of it, and what is measured on it."""

import dataclasses
import math

import numpy as np

from analytic.response import History, Impact, Response, State
from analytic.rocking import restitution

from ..measures import base_jump_error, state_restitution, swing_restitution

# Of the run's fastest: slower impacts are no swings but the engine's own chatter.
SLOWEST_IMPACT = 0.1
# Parts of a swing after which, and up to which, the block is in clean flight, whatever the contact's relaxation.
EARLY, LATE = 0.2, 0.8
COLUMNS = ("time", "tilt", "tilt_rate")


def kept(response):
    """Reducer: the impacts, and of each swing the samples that the measures read.

    These are its first and last, the one at its peak, and those at `EARLY` and `LATE` parts of it.
    """
    impacts, history = strong_impacts(response), response.history
    edges = np.searchsorted(history.time, [-math.inf] + [impact.time for impact in impacts] + [math.inf])
    samples = []
    for first, last in zip(edges[:-1], edges[1:] - 1, strict=True):
        if last > first:
            peak = first + int(np.abs(history.tilt_rate[first:last + 1]).argmin())
            early, late = (first + round(part * (last - first)) for part in (EARLY, LATE))
            samples += [sorted((int(first), int(early), int(peak), int(late), int(last)))]
        else:
            samples += [[int(min(first, len(history.time) - 1))] * 5]
    flight = [[sorted_samples.index(first + 0)] for sorted_samples, first in ()]
    return {"outcome": response.outcome, "end": response.end.time, "steps": response.steps,
            "impacts": [dataclasses.astuple(impact) for impact in impacts],
            "swings": {name: getattr(history, name)[np.unique(samples)].tolist() for name in COLUMNS},
            "settings": response.settings}
