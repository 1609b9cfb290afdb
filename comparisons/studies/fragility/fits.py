"""Fragility curves: of the analytic model, and what an engine makes of them."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.stats import norm

from ...measuring.statistics import compare, draws, fit_fragility, goodness, holm, interval, points, resampled

DRAWS, POINTS = 200, 14
PAIRED_DRAWS = 500
SHIFTS = ("median_shift", "median_interval", "dispersion_shift", "dispersion_interval", "detectable_shift")


@dataclass(frozen=True)
class State:
    """A limit state: exceeded where a run's value of this key is above the limit; measure: of its curve's intensity."""

    key: str
    limit: float
    measure: str

    def exceeded(self, values: dict[str, np.ndarray]) -> np.ndarray:
        """1 where a run exceeds it, 0 where not, NaN where it failed; shape (n,)."""
        found = values[self.key]
        return np.where(np.isnan(found), np.nan, found > self.limit)


def fits(
    measures: dict[str, np.ndarray], states: dict[str, State], values: dict[str, np.ndarray]
) -> list[dict[str, Any]]:
    """A row per limit state.

    median, dispersion and their intervals (bootstrap over runs); p_value of the curve's fit; points: shares with Wilson
    intervals. reason: why there is no curve, or None.
    """
    rows = []
    for name, state in states.items():
        exceeded = state.exceeded(values)
        sound = ~np.isnan(exceeded)
        row = {"part": "fit", "state": name, "measure": state.measure, "size": int(sound.sum())}
        row["exceeded"] = int(exceeded[sound].sum())
        rows.append(row | _curve(measures[state.measure][sound], exceeded[sound]))
    return rows


def _curve(intensity, exceeded):
    found = {"points": points(intensity, exceeded, POINTS)}
    try:
        curve = fit_fragility(intensity, exceeded)
    except ValueError as error:
        lost = dict.fromkeys(("median", "dispersion", "median_interval", "dispersion_interval", "p_value"))
        return {**found, **lost, "reason": str(error)}
    medians, spreads = resampled(intensity, exceeded, draws(DRAWS, len(exceeded)))
    return {
        **found,
        "median": curve.median,
        "dispersion": curve.dispersion,
        "median_interval": interval(curve.median, medians),
        "dispersion_interval": interval(curve.dispersion, spreads),
        "p_value": goodness(intensity, exceeded, curve),
        "reason": None,
    }


def effects(
    measures: dict[str, np.ndarray],
    chosen: np.ndarray,
    states: dict[str, State],
    values: tuple[dict[str, np.ndarray], dict[str, np.ndarray]],
    pair: tuple[str, str],
) -> list[dict[str, Any]]:
    """A row per limit state: `compare` of the two on the runs that failed in neither, and what it makes of the curve.

    median_shift and dispersion_shift: the engine's median and dispersion over the model's, with intervals by paired
    bootstrap over runs; detectable_shift: the ratio of medians whose
    difference of probability the test would have found with 80 % probability. p_holm: p adjusted over limit states.

    Parameters
    ----------
    measures : {name: (n,)}
    chosen : indices of the runs compared, shape (k,)
    states : {name: `State`}
    values : of the model and of the engine, arrays of shape (k,)
    pair : engine and variant
    """
    rows: list[dict[str, Any]] = []
    for name, state in states.items():
        ours, theirs = map(state.exceeded, values)
        sound = ~np.isnan(ours) & ~np.isnan(theirs)
        if sound.any():
            row: dict[str, Any] = {"part": "effect", "engine": pair[0], "variant": pair[1], "state": name}
            row |= {"left_out": int((~sound).sum()), "measure": state.measure}
            row |= compare(ours[sound] == 1, theirs[sound] == 1)
            intensity = measures[state.measure][chosen[sound]]
            rows.append(row | _shift(intensity, ours[sound], theirs[sound], row["detectable_difference"]))
    adjusted = holm([row["p_value"] for row in rows]) if rows else []
    return [row | {"p_holm": float(p_value)} for row, p_value in zip(rows, adjusted, strict=True)]


def _shift(intensity, ours, theirs, detectable):
    """Ratios of the two fits; None, with the reason, where one of them does not exist."""
    found = dict.fromkeys(SHIFTS)
    try:
        model, engine = (fit_fragility(intensity, exceeded) for exceeded in (ours, theirs))
    except ValueError as error:
        return {**found, "reason": str(error)}
    weights = draws(PAIRED_DRAWS, len(ours))
    medians, spreads = zip(*(resampled(intensity, exceeded, weights) for exceeded in (ours, theirs)), strict=True)
    found["median_shift"] = engine.median / model.median
    found["dispersion_shift"] = engine.dispersion / model.dispersion
    if (ours != theirs).any():  # else bootstrap knows of no difference: no width, which would be certainty
        found["median_interval"] = interval(found["median_shift"], medians[1] / medians[0])
        found["dispersion_interval"] = interval(found["dispersion_shift"], spreads[1] / spreads[0])
    if detectable is not None:
        # a shift d of ln(median) changes the probability of a run by phi(z) d/dispersion
        steepness = (norm.pdf(np.log(intensity / model.median) / model.dispersion) / model.dispersion).mean()
        found["detectable_shift"] = float(np.exp(detectable / steepness))
    return {**found, "reason": None}
