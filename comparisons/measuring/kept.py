"""What is kept of a response to be judged by: a module of its own, so that a change of the judgement repeats no run."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from analytic import History, Response

    from ..running.cases import Case

RESOLVED = 0.1  # share of the run's largest rate from which on an impact counts
GRID, MOST_IMPACTS = 50, 400  # points of the growing peaks, impacts kept


def ends(response: Response) -> dict[str, Any]:
    """What is kept of a response without its history and its impacts, as JSON values."""
    return {
        "outcome": response.outcome,
        "decided": response.decided,
        "unstable": response.unstable_time,
        "tilt": response.peak_tilt,
        "displacement": response.peak_base_displacement,
    }


def keep(case: Case, response: Response) -> dict[str, Any]:
    """Measure: what the judgement needs of a response with its history, as JSON values."""
    history: History = response.history  # type: ignore[assignment]  # a measure is given one
    steps = (
        np.searchsorted(
            history.time, history.time[1] * (2000 / GRID) * np.arange(1, GRID + 1) * (1 + 1e-9), side="right"
        )
        - 1
    )
    rates = np.abs([impact.rate_before for impact in response.impacts])
    counted = [
        impact for impact, rate in zip(response.impacts, rates, strict=True) if not rate < 0.5 * RESOLVED * rates.max()
    ][:MOST_IMPACTS]
    return {
        **ends(response),
        "tilts": np.maximum.accumulate(np.abs(history.tilt))[steps],
        "displacements": np.maximum.accumulate(np.abs(history.base_displacement))[steps],
        "impacts": [[impact.time, impact.rate_before, impact.rate_after] for impact in counted],
        "normal": response.min_normal_ratio,
        "friction": response.friction_demand,
        "warnings": response.warnings,
        "steps": response.steps,
    }
