"""Errors of one run against the reference, the same code for every solver; nothing here knows who made the run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np

from analytic.response import Impact
from analytic.rocking import restitution

from ...measuring.errors import (
    SLOWEST_IMPACT,
    impact_time_errors,
    rate_restitution,
    rms,
    state_restitution,
    strong_impacts,
)

if TYPE_CHECKING:
    from .scenes import Trial

# measure: (label with unit, words)
MEASURES = {
    "restitution": ("restitution error, rms [-]", "restitution"),
    "impact_time": ("impact time error, rms [s]", "impact times"),
    "peak_tilt": ("error of peak tilt / slenderness [-]", "peak tilt"),
    "peak_displacement": ("relative error of the peak base displacement [-]", "peak displacement"),
    "end_tilt": ("error of |tilt| / slenderness at the end [-]", "tilt at the end"),
    "boundary_shift": ("relative shift of the overturning boundary [-]", "overturning boundary"),
}

# A boundary search that still moves this far has found none. Where steps are fixed, the boundary depends on where in a
# step the impact falls, which differs from run to run: the root mean square of the last positions stands for it.
STRAY, LAST = 0.025, 3


def errors(trial: Trial, values: Mapping[str, Any], shifts: Sequence[float | None] = None) -> dict[str, float]:
    """Absolute errors by measure, of those the trial asks for and the run can show; and "lost_impacts".

    Parameters
    ----------
    trial : Trial
    values : dict
        `Response.to_json()` of the run, or of the first run of a boundary search.
    shifts : list of float or None
        Relative position of the boundary against the reference's, one per run of the search. A solver without a
        boundary nearby has no error "boundary_shift".
    """
    impacts = SimpleNamespace(impacts=[Impact(**impact) for impact in values["impacts"]])
    errors = {"lost_impacts": _lost(impacts, trial.reference)}
    if "restitution" in trial.measures:
        errors["restitution"] = _restitution_error(trial.scene, impacts)
    if "impact_time" in trial.measures:
        errors["impact_time"] = _impact_time_error(impacts, trial.reference)
    gamma = trial.scene.block.slenderness
    if "peak_tilt" in trial.measures and values["peak_tilt"] is not None:
        errors["peak_tilt"] = abs(values["peak_tilt"] - trial.reference.peak_tilt) / gamma
    if "peak_displacement" in trial.measures and values["peak_base_displacement"] is not None:
        errors["peak_displacement"] = abs(values["peak_base_displacement"] / trial.reference.peak_base_displacement - 1)
    end = values["end"]
    if "end_tilt" in trial.measures and abs(end["time"] - trial.scene.duration) < 1e-9:
        errors["end_tilt"] = abs(abs(end["tilt"]) - abs(trial.reference.end.tilt)) / gamma
    if shifts and abs(shifts[-1] - shifts[-2]) < STRAY:
        errors["boundary_shift"] = float(np.sqrt(np.mean(np.square(shifts[-LAST:]))))
    return {name: value for name, value in errors.items() if value is not None}


def _strong(reference):
    rates = np.abs([impact.rate_before for impact in reference.impacts])
    return rates >= SLOWEST_IMPACT * rates.max(initial=0.0)


def _lost(impacts, reference):
    """Impacts of the reference without a partner."""
    if not reference.impacts:
        return 0
    return int(np.isnan(impact_time_errors(impacts, reference)[_strong(reference)]).sum())


def _impact_time_error(impacts, reference):
    errors = impact_time_errors(impacts, reference)[_strong(reference)]
    errors = errors[np.isfinite(errors)]
    return float(np.sqrt(np.mean(errors**2))) if len(errors) else None


def _restitution_error(scene, impacts):
    """Root mean square of e - eq. (7) over the impacts fast enough; under a motion e is that of the states."""
    if scene.motion is None and scene.bearings is None:
        errors = rate_restitution(impacts) - restitution(scene)
    else:
        errors = state_restitution(SimpleNamespace(impacts=strong_impacts(impacts))) - restitution(scene)  # type: ignore[arg-type]  # its impacts are all that is read
    return rms(errors) if len(errors) else None
