"""The report on one's own scenes: their runs, and the sections they need."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import partial
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from analytic import Block, load_scene
from analytic.caryatid import RADIUS

from ..running.cases import Case
from ..running.solving import spinner
from ..running.study import Batch, say
from ..showing.drawing import draw_scenes
from ..showing.parts import Section
from . import figures
from .histories import ToFile
from .runs import (
    FREE_SECONDS,
    LIMIT_PER_SAMPLE,
    LIMIT_PER_SECOND,
    TIME_LIMIT,
    described_variants,
    free_rocking_cases,
    free_rocking_found,
    impacts_only,
    scenes_found,
)
from .sections import outcome_section, parameters, tilt_limits
from .statue import statue_of

if TYPE_CHECKING:
    from analytic import SampledMotion, Scene
    from analytic.types import Motion

    from ..running.provenance import Result
    from ..running.study import Ask, Plan

SCENES_FILE = "scenes.json"


def load_scenes(places: list[str], motion: SampledMotion | None = None) -> dict[str, Scene]:
    """{a name of its own: scene} of scene files or shipped scenes; with a motion in place of theirs where it is given.

    Raises
    ------
    SceneError
        A file is no scene.
    """
    scenes: dict[str, Scene] = {}
    for place in places:
        scene, name = load_scene(place), Path(place).stem
        key = name if name not in scenes else f"{name}-{len(scenes) + 1}"
        scenes[key] = scene if motion is None else scene.with_(motion=motion)
    return scenes


def plan(
    ask: Ask,
    scenes: Mapping[str, Scene],
    histories: str | PathLike[str],
    variants: Mapping[str, str | None],
    motions: Mapping[str, Mapping[str, Sequence[Motion]]],
) -> Plan:
    """The plan of a report's runs: the scenes in every solver and, where a block rocks, its restitution.

    histories: folder in which those of the runs are kept meanwhile. variants: of the engines not taken as they come.
    motions: of each scene, {record: its motions} besides its own.
    """
    cases = [
        Case(
            scene,
            solver,
            variants.get(solver),
            settings={"compare": True} if solver in ask.engines else {},
            tag={"scene": name},
        )
        for solver in ("analytic", *ask.engines)
        for name, scene in scenes.items()
    ]
    longest = max((scene.motion.end for scene in scenes.values() if scene.motion), default=0.0)
    samples = max((len(getattr(scene.motion, "samples", ())) for scene in scenes.values()), default=0)
    limit = TIME_LIMIT + LIMIT_PER_SECOND * longest + LIMIT_PER_SAMPLE * samples
    say(f"{', '.join(scenes)} in {', '.join(('the analytic model', *ask.engines))}")
    rows = yield Batch(cases, ToFile(str(Path(histories).resolve())), "scenes", limit)
    statues = {}
    for name, scene in scenes.items():
        with spinner(f"{scene.name}: the analytic model") as tell:
            statues[name] = statue_of(scene, motions.get(name, {}), partial(_tell, tell, scene.name))
    described = {"variants": described_variants(ask.engines), "statues": statues}
    found = scenes_found(Path(histories), rows, scenes, SCENES_FILE, **described)
    rocking = [row.case.scene for row in rows if row.case.solver == "analytic" and row.values["outcome"] != "stands"]
    if not rocking:
        return found
    yield found
    block = rocking[0].block
    bases = _bases(rocking)
    seconds = FREE_SECONDS * math.sqrt(block.radius / RADIUS)
    plain = Block(**{**block.model_dump(), "restitution": None})  # engines decide it
    cases = free_rocking_cases(ask.engines, (block.slenderness,), plain, bases, seconds)
    rows = yield Batch(cases, impacts_only, "restitution", limit)
    return free_rocking_found(rows, ask.engines, bases, seconds)


def _tell(tell, name, quantity):
    tell(f"{name}: margin of {quantity}")


def _bases(scenes):
    """{ground: its base} on which the blocks of the scenes rock."""
    bases = {}
    for scene in scenes:
        if scene.base is None:
            bases["rigid ground"] = None
        else:
            bases.setdefault("sliding base", {"mass": scene.base.mass})
    return bases


def own_sections(result: Result) -> list[Section]:
    """Scenes and motion, outcomes, and the histories that the scenes have."""
    scenes = result.settings["scenes"]
    pictures = [draw_scenes(list(scenes.values()))]
    if result.settings["motion"]:
        pictures.append(figures.ground_motion(result))
    shown = []
    for name, scene in scenes.items():
        rows = [row for row in result.rows if row["scene"] == name and not row["failure"]]
        if not rows:
            continue
        gamma = scene["block"]["slenderness"]
        if any(row["outcome"] != "stands" for row in rows):
            limits = tilt_limits(result, name, gamma)
            shown.append(figures.histories(result, name, "tilt", "tilt φ/γ [-]", gamma, limits))
        if scene["base"]:
            shown.append(figures.histories(result, name, "base_displacement", "base displacement x [m]"))
        if scene["bearings"]:
            shown.append(figures.loops(result, name))
    sections = [Section("The scenes", (), (parameters(scenes),), tuple(pictures)), outcome_section(result)]
    if shown:
        words = (
            "Upper axes: all solvers over each other; lower axes: by how much they differ from the analytic model. A "
            "block that never lifts in any solver has no tilt to show."
        )
        sections.append(Section("Histories", (words,), (), tuple(shown)))
    return sections
