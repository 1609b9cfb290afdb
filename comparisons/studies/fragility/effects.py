"""What a solver does to fragility: shift of median and of dispersion against the analytic model on the same runs."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.stats import norm

from ...measuring.fragility import draws, fit_fragility, interval, resampled
from ...measuring.statistics import compare, holm
from .fits import exceeds

DRAWS = 500
ANALYTIC = "analytic"
SHIFTS = ("median_shift", "median_interval", "dispersion_shift", "dispersion_interval", "detectable_shift")


def effects(
    measures: dict[str, np.ndarray],
    chosen: np.ndarray,
    states: dict[str, tuple[str, float]],
    pair: tuple[dict[str, np.ndarray], dict[str, np.ndarray]],
    curves: list[dict[str, Any]],
    label: str,
) -> list[dict[str, Any]]:
    """A row per limit state: `compare` of the two on the runs that failed in neither, and what it makes of the curve.

    median_shift and dispersion_shift: the solver's median and dispersion over the model's, in the measure of least
    dispersion in `curves`, with intervals by paired bootstrap over runs; detectable_shift: the ratio of medians whose
    difference of probability the test would have found with 80 % probability. p_holm: p adjusted over limit states.

    Parameters
    ----------
    measures : {name: (n,)}
    chosen : indices of the runs compared, shape (k,)
    states : {name: (value, limit)}
    pair : values of the model and of the solver, arrays of shape (k,)
    curves : rows of `fits`
    label : the solver
    """
    rows: list[dict[str, Any]] = []
    for name, state in states.items():
        ours, theirs = (exceeds(values, state) for values in pair)
        sound = ~np.isnan(ours) & ~np.isnan(theirs)
        row: dict[str, Any] = {"part": "effect", "solver": label, "state": name, "left_out": int((~sound).sum())}
        best = next((curve["measure"] for curve in curves if curve["state"] == name and curve["best"]), None)
        if sound.any():
            row |= compare(ours[sound] == 1, theirs[sound] == 1, (ANALYTIC, label))
            row |= {"measure": best, **_shift(measures, best, chosen[sound], ours[sound], theirs[sound], row)}
            rows.append(row)
    adjusted = holm([row["p_value"] for row in rows]) if rows else []
    for row, p_value in zip(rows, adjusted, strict=True):
        row["p_holm"] = float(p_value)
    return rows


def _shift(measures, best, chosen, ours, theirs, row):
    """Ratios of the two fits; None, with the reason, where one of them does not exist."""
    found = dict.fromkeys(SHIFTS)
    if best is None:
        return {**found, "reason": "no measure has a curve"}
    intensity = measures[best][chosen]
    try:
        model = fit_fragility(intensity, ours)
        solver = fit_fragility(intensity, theirs)
    except ValueError as error:
        return {**found, "reason": str(error)}
    weights = draws(DRAWS, len(ours))
    medians, spreads = zip(*(resampled(intensity, exceeded, weights) for exceeded in (ours, theirs)), strict=True)
    found["median_shift"] = solver.median / model.median
    found["dispersion_shift"] = solver.dispersion / model.dispersion
    if (ours != theirs).any():  # else bootstrap knows of no difference: no width, which would be certainty
        found["median_interval"] = interval(found["median_shift"], medians[1] / medians[0])
        found["dispersion_interval"] = interval(found["dispersion_shift"], spreads[1] / spreads[0])
    if row["detectable_difference"] is not None:
        # a shift d of ln(median) changes the probability of a run by phi(z) d/dispersion
        steepness = (norm.pdf(np.log(intensity / model.median) / model.dispersion) / model.dispersion).mean()
        found["detectable_shift"] = float(np.exp(row["detectable_difference"] / steepness))
    return {**found, "reason": None}
