"""Fragility curves: of the analytic model in every intensity measure, and what an engine makes of them."""

from typing import Any

import numpy as np
from scipy.stats import norm

from ...measuring.statistics import compare, draws, fit_fragility, goodness, holm, interval, points, resampled

DRAWS, POINTS = 200, 14
PAIRED_DRAWS = 500
SHIFTS = ("median_shift", "median_interval", "dispersion_shift", "dispersion_interval", "detectable_shift")


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


def effects(
    measures: dict[str, np.ndarray],
    chosen: np.ndarray,
    states: dict[str, tuple[str, float]],
    values: tuple[dict[str, np.ndarray], dict[str, np.ndarray]],
    curves: list[dict[str, Any]],
    pair: tuple[str, str],
) -> list[dict[str, Any]]:
    """A row per limit state: `compare` of the two on the runs that failed in neither, and what it makes of the curve.

    median_shift and dispersion_shift: the engine's median and dispersion over the model's, in the measure of least
    dispersion in `curves`, with intervals by paired bootstrap over runs; detectable_shift: the ratio of medians whose
    difference of probability the test would have found with 80 % probability. p_holm: p adjusted over limit states.

    Parameters
    ----------
    measures : {name: (n,)}
    chosen : indices of the runs compared, shape (k,)
    states : {name: (value, limit)}
    values : of the model and of the engine, arrays of shape (k,)
    curves : rows of `fits`
    pair : engine and variant
    """
    best = {curve["state"]: curve["measure"] for curve in curves if curve["best"]}
    rows: list[dict[str, Any]] = []
    for name, state in states.items():
        ours, theirs = (exceeds(side, state) for side in values)
        sound = ~np.isnan(ours) & ~np.isnan(theirs)
        if sound.any():
            row: dict[str, Any] = {"part": "effect", "engine": pair[0], "variant": pair[1], "state": name}
            row |= {"left_out": int((~sound).sum()), "measure": best.get(name)}
            row |= compare(ours[sound] == 1, theirs[sound] == 1)
            intensity = measures[row["measure"]][chosen[sound]] if row["measure"] else None
            rows.append(row | _shift(intensity, ours[sound], theirs[sound], row["detectable_difference"]))
    adjusted = holm([row["p_value"] for row in rows]) if rows else []
    return [row | {"p_holm": float(p_value)} for row, p_value in zip(rows, adjusted, strict=True)]


def _shift(intensity, ours, theirs, detectable):
    """Ratios of the two fits; None, with the reason, where one of them does not exist."""
    found = dict.fromkeys(SHIFTS)
    if intensity is None:
        return {**found, "reason": "no measure has a curve"}
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
