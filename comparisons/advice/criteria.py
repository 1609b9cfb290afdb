"""Criteria of a choice: the error of a run, the time up to which it counts, and the parts of a model.

`model_parts` tells what need not be modelled, and what it would cost.
"""

import dataclasses
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from analytic import Response, Scene, SceneError, SettingError, simulate
from analytic.response import LEVEL
from analytic.rocking import restitution
from engines import get_engine
from engines.comparison import is_too_coarse

from ..execution.cases import Case
from ..metrics.errors import (
    impact_errors,
    impact_time_errors,
    on_heavy_base,
    on_stiff_springs,
    rate_restitution,
    rms,
    sensitivity_horizon,
    strong_impacts,
)
from ..schemas.advice import Level, ModelPart

CRITERIA = ("restitution", "tilt", "displacement", "slip", "outcome")
COLUMNS = {"tilt": "tilt", "displacement": "base_displacement", "slip": "slip"}  # of a history
IMPACTS = 8  # a scene is run for its restitution up to this number of strong impacts of the model
AFTER = 0.25  # part of a rocking period by which that run is longer
PERIODS = 1.0  # tilt or displacement is compared up to this number of rocking periods after its peak
FACTORS = (0.95, 0.975, 1.025, 1.05)  # of start and motion together: the neighbours
MORE_FACTORS = (0.9625, 0.9875, 1.0125, 1.0375)  # further ones if outcomes are counted
SAFETY = 2.0  # permissible error over the worst error of a level, so that other neighbours pass, too


def safety(criterion: str) -> float:
    """Return the permissible error over the largest one that passes."""
    return 1.0 if criterion == "outcome" else SAFETY


def neighbours(scene: Scene, criterion: str) -> tuple[dict[float, Scene], dict[float, str]]:
    """Return ({factor: the scene with start and motion times the factor}, {factor: why the model refuses it}).

    The scene itself, with factor 1, is the first. For outcomes the scenes have no duration, so that every outcome is
    decided.

    Raises
    ------
    SettingError
        The scene has neither a start nor a motion.
    SceneError
        The model refuses the scene itself.
    """
    if scene.motion is None and not any(scene.start.model_dump().values()):
        raise SettingError(f"{scene.name}: nothing moves; give the scene a [start] or a [motion]")
    if criterion == "outcome":
        scene = scene.with_(duration=None)
    start = scene.start.model_dump().items()
    simulate(scene, history=False)
    family, left = {1.0: scene}, {}
    for factor in sorted(FACTORS + (MORE_FACTORS if criterion == "outcome" else ())):
        changed = {name: factor * value for name, value in start}
        try:
            copy = scene.with_(start=changed, motion=scene.motion and scene.motion.scaled(factor))
            simulate(copy, history=False)
            family[factor] = copy
        except SceneError as error:
            left[factor] = error.problem
    return family, left


def refusals(scene: Scene, reference: Response) -> dict[str, str]:
    """Return {criterion: why it does not apply to a scene}. reference: the model's run of the scene."""
    without = [
        (scene.block.restitution is not None, "the scene gives it"),
        (slides(reference), "the block slides, and then eq. (7) does not hold"),
        (not strong_impacts(reference), "the block never hits its support"),
    ]
    why = {
        "restitution": next((words for true, words in without if true), ""),
        "tilt": "the block never lifts" if reference.outcome in LEVEL else "",
        "displacement": "" if scene.base else "the scene has no base",
        "slip": "" if slides(reference) else "the block does not slide",
    }
    return {criterion: words for criterion, words in why.items() if words}


def fitting(scene: Scene) -> str:
    """Return the default criterion of a scene.

    With impacts it is the restitution; if the restitution is given or the block slides, the tilt. Without impacts it is
    slip (tilt if the block lifts) for a block that slides; otherwise the displacement of the base, if any, or the
    outcome.
    """
    reference = simulate(scene, history=False)
    if strong_impacts(reference):
        return "restitution" if scene.block.restitution is None and not slides(reference) else "tilt"
    if slides(reference):
        return "slip" if reference.outcome in LEVEL else "tilt"
    return "displacement" if scene.base else "outcome"


def slides(response: Response) -> bool:
    """Return whether the block slides."""
    return response.sliding is not None and response.sliding.peak > 0


def until(scene: Scene, criterion: str) -> float:
    """Return the time [s] up to which a scene is run and compared.

    Raises
    ------
    SettingError
        The criterion does not apply to the scene.
    """
    reference = simulate(scene, history=False)
    why = refusals(scene, reference)
    if criterion in why:
        others = [name for name in CRITERIA if name not in why]
        raise SettingError(f"--for {criterion}: {scene.name}: {why[criterion]}; choose one of {', '.join(others)}")
    if criterion == "restitution":
        strong = strong_impacts(reference)[:IMPACTS]
        return float(min(reference.end.time, strong[-1].time + AFTER * 2 * np.pi / scene.rocking_frequency))
    if criterion == "outcome":
        return reference.end.time
    cut = scene.with_(duration=reference.end.time)
    history = simulate(cut).history
    assert history is not None
    column = getattr(history, COLUMNS[criterion])
    after = PERIODS * 2 * np.pi / scene.rocking_frequency
    end = min(sensitivity_horizon(cut).horizon, float(history.time[np.abs(column).argmax()]) + after)
    upright = history.time[(np.abs(history.tilt) <= scene.block.slenderness) & (history.time > 0)]
    if criterion == "tilt" or not len(upright):
        return end
    # As the model's peaks do, these leave out the last fall, in which an engine's block slides on its base.
    return min(end, float(upright[-1]))


@dataclass(frozen=True)
class Measure:
    """Measure of a run: its error as `criterion` defines it."""

    criterion: str

    def __call__(self, case: Case, response: Response) -> dict[str, Any]:
        reference = simulate(case.scene)
        return {
            "outcome": response.outcome,
            "error": error(self.criterion, case.scene, response, reference),
            "simulated": response.end.time,
            "too_coarse": is_too_coarse(response),
        }


def error(criterion: str, scene: Scene, response: Response, reference: Response) -> float | None:
    """Return the error of a run; None if the criterion does not apply to it."""
    if criterion == "outcome":
        return float(response.outcome != reference.outcome)
    if criterion == "restitution":
        return _restitution(scene, response, reference)
    ours, theirs = response.history, reference.history
    if ours is None or theirs is None:
        return None
    column, unit = COLUMNS[criterion], scene.block.slenderness
    if criterion == "displacement":
        unit = reference.peak_base_displacement
    if criterion == "slip":
        if ours.slip is None:
            return None
        if theirs.slip is None or not reference.sliding:
            return 0.0  # a neighbour that does not slide
        unit = reference.sliding.peak
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


REPEATS = 7  # of a timing, of which the least counts


def cpu_seconds(scene: Scene) -> float:
    """Return the least of several CPU times of the analytic model on a scene [s]."""
    return min(simulate(scene, history=False).cpu_seconds for _ in range(REPEATS))


def model_parts(
    scene: Scene,
    family: Mapping[float, Scene],
    error: float,
    level: Level | None,
    engines: Iterable[str],
    model_cpu: float,
) -> list[ModelPart]:
    """Return the parts of a model, and whether the scene needs them.

    family: `neighbours` of the scene. level: the engine's level that was chosen, or the best one. model_cpu:
    `cpu_seconds` of the scene.
    """
    runs = [simulate(member, history=False) for member in family.values()]
    rate = None if level is None else level.cpu_per_second
    parts = {
        "rocking": _rocking(scene, runs, None if rate is None else rate * runs[0].end.time / model_cpu),
        **({} if scene.friction is None else {"sliding": _sliding(scene, runs)}),
        "base": _base(scene, model_cpu),
        "vertical motion": _vertical(scene, runs[0], model_cpu, error),
        "third dimension": _space(scene, engines),
    }
    return [ModelPart(part=part, needed=need, why=why, cost=cost) for part, (need, why, cost) in parts.items()]


# Each returns (needed, why, cost) of its `ModelPart`.


def _rocking(scene, runs, cost):
    lifted = sum(run.outcome not in LEVEL for run in runs)
    if lifted:
        return True, f"the block lifts in {lifted} of {len(runs)} scenes", None
    if any(map(slides, runs)):
        return False, "the block slides and does not lift: a contact with this friction is enough", None
    moves = "block and base are one mass" if scene.base else "the block moves with the ground"
    why = f"the block lifts neither here nor in any neighbour: {moves}"
    return False, f"{why}; an engine's contact model is not needed", cost


def _sliding(scene, runs):
    slid = sum(map(slides, runs))
    if slid:
        return True, f"the block slides in {slid} of {len(runs)} scenes: give the engine's contact this friction", None
    demand = max(run.friction_demand for run in runs)
    return False, f"the friction demand is at most {demand:.3g}, the friction {scene.friction:g}", None


def _base(scene, model_cpu):
    if scene.base is not None:
        return True, "the block stands on a base that moves", None
    if scene.motion is None:
        more, words = on_heavy_base(scene), "a heavy base"
    else:
        more, words = on_stiff_springs(scene), "a support of 50 Hz"
    return False, f"the ground is rigid (tried: {words})", cpu_seconds(more) / model_cpu


def _vertical(scene, reference, model_cpu, error):
    if scene.motion is None or scene.motion.vertical is None:
        return False, "the scene has none", None
    level = scene.with_(motion=dataclasses.replace(scene.motion, vertical=None))
    without = simulate(level, history=False)
    apart = abs(without.peak_tilt - reference.peak_tilt) / scene.block.slenderness
    if reference.peak_base_displacement:
        apart = max(apart, abs(without.peak_base_displacement / reference.peak_base_displacement - 1))
    same = without.outcome == reference.outcome and apart <= error
    why = f"without it the outcome is {without.outcome} and the peaks differ by {apart:.1e}"
    return not same, why, model_cpu / cpu_seconds(level)


def _space(scene, engines):
    """The third dimension: a free block of six degrees of freedom, compared with the planar one at one step."""
    why = "nothing acts out of the plane"
    able = [] if scene.bearings is not None else [get_engine(name) for name in engines]
    # a free block takes no restitution
    scene = scene.with_(duration=simulate(scene, history=False).end.time, block={"restitution": None})
    for engine, variant, kind in [(each, *item) for each in able for item in each.variants.items()]:
        if kind.free_block and kind.step:
            step = kind.default if kind.accuracy_parameter == kind.step else min(kind.levels)
            free, planar = (
                Case(scene, kind.free_block, settings={"step": step, "history": False}).run(),
                Case(scene, engine.name, variant, {kind.step: step, "history": False}).run(),
            )
            if not free.failure and not planar.failure:
                dearer = free.cpu_seconds / free.end.time / (planar.cpu_seconds / planar.end.time)
                return False, f"{why} (tried: {engine.name})", dearer
    return False, why, None
