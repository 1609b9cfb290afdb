"""Criteria of a choice: the duration of the runs, and the error of a run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from analytic import Scene, simulate
from analytic.errors import SettingError
from analytic.rocking import restitution

from ..measuring.errors import impact_errors, impact_time_errors, rate_restitution, rms, strong_impacts
from ..measuring.horizon import sensitivity_horizon

if TYPE_CHECKING:
    from analytic import Response

    from ..running.cases import Case

CRITERIA = ("restitution", "tilt", "displacement", "outcome")
IMPACTS = 8  # strong impacts of the model up to which a scene is run for its restitution
AFTER = 0.25  # of a rocking period, by which a run is longer
PERIODS = 1.0  # rocking periods after its peak up to which tilt or displacement is compared
FACTORS = (0.95, 0.975, 1.025, 1.05)  # of start and motion together: the neighbours
MORE_FACTORS = (0.9625, 0.9875, 1.0125, 1.0375)  # further ones where outcomes are counted
SAFETY = 2.0  # error asked for over the worst one of a level, so that other neighbours pass, too


def safety(criterion: str) -> float:
    """Error asked for over the largest that passes."""
    return 1.0 if criterion == "outcome" else SAFETY


def neighbours(scene: Scene, criterion: str) -> dict[float, Scene]:
    """{factor: the scene with its start and its motion times that}, the scene itself with 1 first.

    For outcomes they have no duration, as a run that ends before its outcome is decided has none.

    Raises
    ------
    SettingError
        Neither a start nor a motion is given.
    """
    if scene.motion is None and not any(scene.start.model_dump().values()):
        raise SettingError(f"{scene.name}: nothing moves; give the scene a [start] or a [motion]")
    if criterion == "outcome":
        scene = scene.with_(duration=None)
    start = scene.start.model_dump().items()
    return {1.0: scene} | {
        factor: scene.with_(
            start={name: factor * value for name, value in start}, motion=scene.motion and scene.motion.scaled(factor)
        )
        for factor in sorted(FACTORS + (MORE_FACTORS if criterion == "outcome" else ()))
    }


def fitting(scene: Scene) -> str:
    """The default: restitution if there are impacts, else displacement if there is a base, else outcome."""
    if strong_impacts(simulate(scene, history=False)):
        return "restitution"
    return "displacement" if scene.base else "outcome"


def until(scene: Scene, criterion: str) -> float:
    """Time [s] up to which a scene is run and compared.

    Raises
    ------
    SettingError
        The criterion does not apply to the scene.
    """
    reference = simulate(scene, history=False)
    if criterion == "displacement" and scene.base is None:
        raise SettingError("--for displacement: the scene has no base; choose restitution, tilt or outcome")
    if criterion == "restitution":
        strong = strong_impacts(reference)[:IMPACTS]
        if not strong:
            raise SettingError(
                f"--for restitution: the block of {scene.name} never hits its base; choose displacement or outcome"
            )
        return float(min(reference.end.time, strong[-1].time + AFTER * 2 * np.pi / scene.rocking_frequency))
    if criterion == "tilt" and reference.outcome == "stands":
        raise SettingError(f"--for tilt: the block of {scene.name} never lifts; choose displacement or outcome")
    if criterion == "outcome":
        return reference.end.time
    cut = scene.with_(duration=reference.end.time)
    history = simulate(cut).history
    assert history is not None
    column = history.tilt if criterion == "tilt" else history.base_displacement
    after = PERIODS * 2 * np.pi / scene.rocking_frequency
    return min(sensitivity_horizon(cut).horizon, float(history.time[np.abs(column).argmax()]) + after)


@dataclass(frozen=True)
class Measure:
    """Measure of a run: its error in the sense of `criterion`."""

    criterion: str

    def __call__(self, case: Case, response: Response) -> dict[str, Any]:
        reference = simulate(case.scene)
        return {
            "outcome": response.outcome,
            "error": error(self.criterion, case.scene, response, reference),
            "simulated": response.end.time,
        }


def error(criterion: str, scene: Scene, response: Response, reference: Response) -> float | None:
    """The error of a run; None if the criterion does not apply to it."""
    if criterion == "outcome":
        return float(response.outcome != reference.outcome)
    if criterion == "restitution":
        return _restitution(scene, response, reference)
    ours, theirs = response.history, reference.history
    if ours is None or theirs is None:
        return None
    column, unit = "tilt", scene.block.slenderness
    if criterion == "displacement":
        column, unit = "base_displacement", reference.peak_base_displacement
    time = theirs.time[theirs.time <= ours.time[-1]]  # one that overturns ends there
    apart = np.interp(time, ours.time, getattr(ours, column)) - getattr(theirs, column)[: len(time)]
    return float(np.abs(apart).max() / unit)


def _restitution(scene, response, reference):
    if not reference.impacts:
        return 0.0  # a neighbour that stands
    if not response.impacts or np.isnan(impact_time_errors(response, reference)[0]):
        return None
    errors = [rms(impact_errors(scene, response)["state"])]
    if scene.motion is None and scene.bearings is None:  # the loss between impacts counts, too
        rates = np.array([impact.rate_before for impact in strong_impacts(response)])
        if (rates[:-1] * rates[1:] >= 0).any():
            return None  # sides do not alternate: an impact was missed
        swings = rate_restitution(response)
        errors += [rms(swings - restitution(scene))] if len(swings) else []
    return max(errors)
