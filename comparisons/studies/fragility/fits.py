"""What the analytic model's cloud says: a fragility curve for each limit state and intensity measure."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...measuring.fragility import draws, fit_fragility, goodness, interval, points, resampled

DRAWS, POINTS = 200, 14


def exceeds(values: dict[str, np.ndarray], state: tuple[str, float]) -> np.ndarray:
    """1 where a run exceeds the limit state, 0 where not, NaN where it failed; shape (n,)."""
    key, limit = state
    return np.where(np.isnan(values[key]), np.nan, values[key] > limit)


def fits(
    measures: dict[str, np.ndarray], states: dict[str, tuple[str, float]], values: dict[str, np.ndarray]
) -> list[dict[str, Any]]:
    """A row per limit state and measure.

    median, dispersion and their intervals (bootstrap over runs); p_value of the curve's fit; best: of the least
    dispersion of this state; ratio_interval: of its dispersion over the best one's, over the same bootstrap samples;
    points: shares with Wilson intervals. reason: why there is no curve, or None.
    """
    return [row for name, state in states.items() for row in _of_state(name, exceeds(values, state), measures)]


def _of_state(name, exceeded, measures):
    sound = ~np.isnan(exceeded)
    exceeded, weights = exceeded[sound], draws(DRAWS, int(sound.sum()))
    rows, spreads = [], {}
    for measure, intensity in measures.items():
        intensity = intensity[sound]
        row = {"part": "fit", "state": name, "measure": measure, "size": len(exceeded), "exceeded": int(exceeded.sum())}
        row["points"] = points(intensity, exceeded, POINTS)
        rows.append(row)
        try:
            curve = fit_fragility(intensity, exceeded)
        except ValueError as error:
            row |= dict.fromkeys(("median", "dispersion", "median_interval", "dispersion_interval", "p_value"))
            row["reason"] = str(error)
            continue
        medians, spreads[measure] = resampled(intensity, exceeded, weights)
        row |= {
            "median": curve.median,
            "dispersion": curve.dispersion,
            "median_interval": interval(curve.median, medians),
            "dispersion_interval": interval(curve.dispersion, spreads[measure]),
            "p_value": goodness(intensity, exceeded, curve),
            "reason": None,
        }
    fitted = {row["measure"]: row["dispersion"] for row in rows if row["dispersion"] is not None}
    best = min(fitted, key=fitted.get, default=None)
    for row in rows:
        measure = row["measure"]
        row["best"] = measure == best
        row["ratio_interval"] = None
        if measure in fitted and measure != best:
            row["ratio_interval"] = interval(fitted[measure] / fitted[best], spreads[measure] / spreads[best])
    return rows
