"""Parts of a model that a scene does not need, and the cost of modelling them."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

from analytic import simulate
from engines import get_engine

from ..measuring.models import on_heavy_base, on_stiff_springs
from ..running.cases import Case
from .answer import Level, ModelPart

if TYPE_CHECKING:
    from analytic import Scene

REPEATS = 7  # of a timing; the least counts


def cpu_seconds(scene: Scene) -> float:
    """CPU time of the analytic model on a scene, the least of several [s]."""
    return min(simulate(scene, history=False).cpu_seconds for _ in range(REPEATS))


def model_parts(
    scene: Scene, family: Mapping[float, Scene], error: float, found: Level | None, engines: Iterable[str], own: float
) -> list[ModelPart]:
    """The parts of a model, and whether the scene needs them. family: its neighbours; found: the level chosen, or the
    best; own: `cpu_seconds` of the scene."""
    runs = [simulate(one, history=False) for one in family.values()]
    engine = None if found is None or found.cpu_per_second is None else found.cpu_per_second * runs[0].end.time / own
    parts = {
        "rocking": _rocking(runs, engine),
        "base": _base(scene, own),
        "vertical motion": _vertical(scene, runs[0], own, error),
        "third dimension": _space(scene, engines),
    }
    return [ModelPart(part=part, needed=need, why=why, cost=cost) for part, (need, why, cost) in parts.items()]


# Each returns (needed, why, cost) of its `ModelPart`.


def _rocking(runs, engine):
    lifted = sum(run.outcome != "stands" for run in runs)
    if lifted:
        return True, f"the block lifts in {lifted} of {len(runs)} scenes", None
    why = "the block lifts neither here nor in any neighbour: block and base are one mass on the bearings"
    return False, f"{why}; an engine's contact model is not needed", engine


def _base(scene, own):
    if scene.base is not None:
        return True, "the block stands on a base that moves", None
    if scene.motion is None:
        more, words = on_heavy_base(scene), "a heavy base"
    else:
        more, words = on_stiff_springs(scene), "a support of 50 Hz"
    return False, f"the ground is rigid (tried: {words})", cpu_seconds(more) / own


def _vertical(scene, reference, own, error):
    if scene.motion is None or scene.motion.vertical is None:
        return False, "the scene has none", None
    level = scene.with_(motion=dataclasses.replace(scene.motion, vertical=None))
    without = simulate(level, history=False)
    apart = abs(without.peak_tilt - reference.peak_tilt) / scene.block.slenderness
    if reference.peak_base_displacement:
        apart = max(apart, abs(without.peak_base_displacement / reference.peak_base_displacement - 1))
    same = without.outcome == reference.outcome and apart <= error
    why = f"without it the outcome is {without.outcome} and the peaks differ by {apart:.1e}"
    return not same, why, own / cpu_seconds(level)


def _space(scene, engines):
    """A free block of six degrees of freedom compared with the planar one, at one step."""
    why = "nothing acts out of the plane"
    able = [] if scene.bearings is not None else [get_engine(name) for name in engines]
    scene = scene.with_(duration=simulate(scene, history=False).end.time)
    for engine, variant, kind in [(one, *each) for one in able for each in one.variants.items()]:
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
