"""What a run does where its motion is a little weaker or stronger: do outcome and peak tilt depend on it?

The motion at hand is one of many that could have come, and its scale is known to some per cent at best.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .batch import Outcomes, simulate_many
from .margins import STEP, check_cost
from .response import Caution

if TYPE_CHECKING:
    from .scene import Scene

SHARE = 0.05  # of the motion, either way: what the scale of a recorded motion is seldom known better than
FOLD = 5.0  # a peak tilt that grows or falls so many times within SHARE is said to depend on it ...
SEEN = 0.01  # ... unless it stays below this share of the slenderness, where no range is promised to an engine either
MOST_STEPS = 1e8  # of all runs: a minute on two cores


def nearby(scene: Scene, *, workers: int | None = None) -> tuple[np.ndarray, Outcomes]:
    """(relative changes of the motion from -SHARE to SHARE, shape (n,); the `Outcomes` at each), 0 in the middle.

    Raises
    ------
    SceneError
        The scene costs too much to be run so often.
    """
    count = round(SHARE / STEP)
    changes = STEP * np.arange(-count, count + 1)
    check_cost(scene, len(changes), MOST_STEPS)
    return changes, simulate_many([scene] * len(changes), scales=1 + changes, workers=workers)


def cliffs(scene: Scene, changes: np.ndarray, found: Outcomes) -> tuple[Caution, ...]:
    """Cautions where the outcome, or the peak tilt by `FOLD` times, depends on less than `SHARE` of the motion.

    changes, found : as of `nearby`. value of a `Caution` is the nearest such change; none where nothing depends on it.
    """
    own = len(changes) // 2
    names, ratios = found.names, found.peak_tilt / scene.block.slenderness
    said = []
    other = _nearest(changes, names != names[own])
    if other is not None:
        text = (
            f"The outcome depends on less than {SHARE:.0%} of the motion: as it is the block {names[own]}, at "
            f"{changes[other]:+.2%} it {names[other]}."
        )
        said.append(Caution("motion", text, "outcome", float(changes[other]), SHARE))
    upright = (names != "overturns") & (names != "failed")
    low, high = np.minimum(ratios, ratios[own]), np.maximum(ratios, ratios[own])
    apart = _nearest(changes, upright & upright[own] & (high >= np.maximum(FOLD * low, SEEN)))
    if apart is not None:
        text = (
            f"The peak tilt depends on less than {SHARE:.0%} of the motion: {ratios[own]:.3g} of the slenderness, "
            f"and {ratios[apart]:.3g} at {changes[apart]:+.2%}."
        )
        said.append(Caution("motion", text, "peak tilt", float(changes[apart]), SHARE))
    return tuple(said)


def _nearest(changes: np.ndarray, wanted: np.ndarray) -> int | None:
    """Index of the smallest change among those wanted, None if there is none."""
    return min(np.flatnonzero(wanted).tolist(), key=lambda index: (abs(changes[index]), changes[index]), default=None)
