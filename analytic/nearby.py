"""Sensitivity of outcome and peak tilt to the scale of the motion.

The motion is one of many possible ones, and its scale is known to a few per cent at best.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .batch import Outcomes, simulate_many
from .margins import STEP, check_cost
from .response import Caution

if TYPE_CHECKING:
    from .scene import Scene

SHARE = 0.05  # of the motion, up and down: the scale of a recorded motion is seldom known better
FOLD = 5.0  # a peak tilt is sensitive if it changes by this factor within SHARE ...
SEEN = 0.01  # ... and exceeds this share of the slenderness, below which engines are not tested either
MOST_STEPS = 1e8  # of all runs: a minute on two cores


def nearby(scene: Scene, *, workers: int | None = None) -> tuple[np.ndarray, Outcomes]:
    """(relative changes of the motion from -SHARE to SHARE, shape (n,); the `Outcomes` at each), 0 in the middle.

    Raises
    ------
    SceneError
        The scene takes too many steps for so many runs.
    """
    count = round(SHARE / STEP)
    changes = STEP * np.arange(-count, count + 1)
    check_cost(scene, len(changes), MOST_STEPS)
    return changes, simulate_many([scene] * len(changes), scales=1 + changes, workers=workers)


def cliffs(scene: Scene, changes: np.ndarray, found: Outcomes) -> tuple[Caution, ...]:
    """A warning if a change of the motion below `SHARE` changes the outcome, or the peak tilt by a factor of `FOLD`.

    changes, found : results of `nearby`. The value of a `Caution` is the smallest such change.
    """
    own = len(changes) // 2
    names, ratios = found.names, found.peak_tilt / scene.block.slenderness
    said = []
    other = _nearest(changes, names != names[own])
    if other is not None:
        there = "the analytic model fails" if names[other] == "failed" else f"it {names[other]}"
        text = (
            f"The outcome is sensitive to changes of the motion below {SHARE:.0%}: the block {names[own]}, but at "
            f"{changes[other]:+.2%} {there}."
        )
        said.append(Caution("motion", text, "outcome", float(changes[other]), SHARE))
    upright = (names != "overturns") & (names != "failed")
    low, high = np.minimum(ratios, ratios[own]), np.maximum(ratios, ratios[own])
    apart = _nearest(changes, upright & upright[own] & (high >= np.maximum(FOLD * low, SEEN)))
    if apart is not None:
        text = (
            f"The peak tilt is sensitive to changes of the motion below {SHARE:.0%}: {ratios[own]:.3g} of the "
            f"slenderness, but {ratios[apart]:.3g} at {changes[apart]:+.2%}."
        )
        said.append(Caution("motion", text, "peak tilt", float(changes[apart]), SHARE))
    return tuple(said)


def _nearest(changes: np.ndarray, wanted: np.ndarray) -> int | None:
    """Index of the smallest change among those wanted, None if there is none."""
    return min(np.flatnonzero(wanted).tolist(), key=lambda index: (abs(changes[index]), changes[index]), default=None)
