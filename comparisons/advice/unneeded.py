"""What need not be modelled in a scene, and what modelling it all the same costs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

import numpy as np

from analytic import SampledMotion, Scene, simulate
from engines import get_engine

from ..measuring.models import on_heavy_base, on_stiff_springs
from ..running.cases import Case
from .answer import Level, ModelPart

if TYPE_CHECKING:
    from analytic import Response

REPEATS = 7  # of a timing, of which the least counts


def cpu_seconds(scene: Scene) -> float:
    """CPU time of the analytic model on a scene, the least of several [s]."""
    return min(simulate(scene, history=False).cpu_seconds for _ in range(REPEATS))


def model_parts(
    scene: Scene, family: Mapping[float, Scene], error: float, found: Level | None, engines: Iterable[str], own: float
) -> list[ModelPart]:
    """Which parts of a model the scene needs; family: its neighbours; found: the level chosen, or the best; own:
    `cpu_seconds` of the scene."""
    runs = [simulate(one, history=False) for one in family.values()]
    engine = None if found is None or found.cpu_per_second is None else found.cpu_per_second * runs[0].end.time / own
    return [_rocking(runs, engine), _base(scene, own), _vertical(scene, runs[0], own, error), _space(scene, engines)]


def _rocking(runs, engine):
    lifted = sum(run.outcome != "stands" for run in runs)
    if lifted:
        return ModelPart(
            part="rocking", needed=True, why=f"the block lifts in {lifted} of {len(runs)} scenes looked at", cost=None
        )
    why = "the block never lifts, nor in any neighbour: block and base are one mass on the bearings"
    return ModelPart(
        part="rocking", needed=False, why=f"{why}; an engine's contact is modelled for nothing", cost=engine
    )


def _base(scene, own):
    if scene.base is not None:
        return ModelPart(part="base", needed=True, why="the block stands on a base that moves", cost=None)
    if scene.motion is None:
        cost = cpu_seconds(on_heavy_base(scene)) / own
        return ModelPart(part="base", needed=False, why="the ground is rigid; in its place a heavy base", cost=cost)
    cost = cpu_seconds(on_stiff_springs(scene)) / own
    return ModelPart(part="base", needed=False, why="the ground is rigid; in its place a support of 50 Hz", cost=cost)


def _vertical(scene: Scene, reference: Response, own: float, error: float) -> ModelPart:
    part = "vertical motion"
    if scene.motion is None or scene.motion.vertical is None:
        return ModelPart(part=part, needed=False, why="the scene has none", cost=None)
    motion = scene.motion
    level = scene.with_(
        motion=SampledMotion(motion.dt, motion.samples, motion.label, motion.warnings)
        if isinstance(motion, SampledMotion)
        else type(motion)(motion.shape, motion.amplitude, motion.frequency, motion.start, motion.phase)
    )
    without = simulate(level, history=False)
    apart = abs(without.peak_tilt - reference.peak_tilt) / scene.block.slenderness
    if reference.peak_base_displacement:
        apart = max(apart, abs(without.peak_base_displacement / reference.peak_base_displacement - 1))
    same = without.outcome == reference.outcome and apart <= error
    why = f"without it the outcome is {without.outcome} and the peaks differ by {apart:.1e}"
    return ModelPart(part=part, needed=not same, why=why, cost=own / cpu_seconds(level))


def _space(scene, engines):
    """The third dimension: a free block of six degrees of freedom against the planar one, at one step."""
    why = "nothing acts out of the plane"
    part = "third dimension"
    able = [] if scene.bearings is not None else [get_engine(name) for name in engines]
    scene = scene.with_(duration=simulate(scene, history=False).end.time)
    for engine, variant, kind in [(one, *each) for one in able for each in one.variants.items()]:
        if kind.free_block and kind.step:
            step = kind.default if kind.knob == kind.step else min(kind.ladder)
            runs = [
                Case(scene, kind.free_block, settings={"step": step, "history": False}).run(),
                Case(scene, engine.name, variant, {kind.step: step, "history": False}).run(),
            ]
            if not any(run.failure for run in runs):
                spent = np.array([run.cpu_seconds / run.end.time for run in runs])
                return ModelPart(
                    part=part, needed=False, why=f"{why}; in {engine.name}", cost=float(spent[0] / spent[1])
                )
    return ModelPart(part=part, needed=False, why=why, cost=None)
