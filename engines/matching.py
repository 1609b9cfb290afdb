"""Matching of the impacts of two runs of one scene: which count, which match, which have no match.

Impacts are those at tilt 0. A corner that lands at another tilt, after a flight, is an impact of the analytic model,
too, but the trace of an engine does not tell it. It is left out here.

Two impacts on the same side match if they are closer to each other than to the next ones on that side. An impact counts
if its rate is at least `COUNTED` of the largest of its run, and at least that of a swing of a tenth of `LEAST_TILT`: an
engine cannot tell smaller ones from the compliance of its contact.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from analytic.layout import FLIGHT, MODES
from analytic.rocking import RockingModel

if TYPE_CHECKING:
    from analytic import Response, Scene

COUNTED = 0.1
LEAST_TILT = 0.01  # of the slenderness: a smaller tilt is compared as one of that size
STILL = 0.02 * LEAST_TILT  # of the slenderness: a block whose peak tilt is smaller has not lifted; a contact yields


def impacts_of(response: Response) -> np.ndarray:
    """Rows of time [s], rate before and rate after [rad/s] of the impacts that end no flight, shape (impacts, 3)."""
    rows = [(impact.time, impact.rate_before, impact.rate_after) for impact in response.impacts]
    impacts = np.array(rows, dtype=float).reshape(-1, 3)
    modes = response.sliding.modes if response.sliding else ()
    begun = np.searchsorted([time for time, _ in modes], impacts[:, 0])  # of the modes; an impact ends the last
    flown = np.array([False, *(mode == MODES[FLIGHT] for _, mode in modes)])
    return impacts[~flown[begun]]


def matched(scene: Scene, impacts: np.ndarray, others: np.ndarray, until: float) -> tuple[np.ndarray, np.ndarray]:
    """(`impacts` that count up to `until`, index in `others` of the match of each, -1 without one)."""
    partner = np.full(len(impacts), -1)
    for side in (-1.0, 1.0):
        mine, theirs = (np.flatnonzero(np.sign(rows[:, 1]) == side) for rows in (impacts, others))
        if not (len(mine) and len(theirs)):
            continue
        time, other = impacts[mine, 0], others[theirs, 0]
        nearest = np.searchsorted((other[1:] + other[:-1]) / 2, time)  # of the others to each of mine
        back = np.searchsorted((time[1:] + time[:-1]) / 2, other)
        mutual = back[nearest] == np.arange(len(mine))
        partner[mine[mutual]] = theirs[nearest[mutual]]
    counted = counts(scene, impacts) & ~(impacts[:, 0] > until)
    return impacts[counted], partner[counted]


def counts(scene: Scene, impacts: np.ndarray, share: float = COUNTED) -> np.ndarray:
    """Whether each impact counts, at `share` of the largest rate. A NaN counts, so that it is found."""
    model = RockingModel.of(scene)
    before, after = np.abs(impacts[:, 1:]).T
    pull = abs(model.accelerations(1.0, 0.0, 0.0, 0.0, 0.0)[0])
    least = math.sqrt(2 * pull * 0.1 * LEAST_TILT * model.gamma)  # rate at the impact of a swing that small
    small = (before < max(least, share * np.nanmax(before, initial=0.0))) | (np.fmax(before, after) < least)
    return ~small


def parting(scene: Scene, one: Response, other: Response) -> float:
    """Time [s] of the first impact that counts of either run without a match in the other; inf where all match."""
    pairs = (one, other), (other, one)
    rows = (matched(scene, impacts_of(here), impacts_of(there), math.inf) for here, there in pairs)
    return float(min(impacts[partner < 0, 0].min(initial=math.inf) for impacts, partner in rows))
