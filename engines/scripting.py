"""A scene as a stand-alone script for one engine: its tuned variant in plain calls, nothing of this project.

An engine's template (`engines.contract.Engine.script`) builds the bodies and steps them. What all scripts share are the
templates in the folder `script`, plain functions at the level of the script: the numbers, the ground motion, the
bearing law, the reading of impacts, and the printing.
"""

from __future__ import annotations

import json
import math
import re
from importlib.resources import files
from pathlib import Path
from textwrap import shorten
from typing import TYPE_CHECKING, Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined

import analytic
from analytic.errors import SceneError, SettingError
from analytic.kernel.decision import motion_end, shortest_duration
from analytic.motion import SampledMotion
from analytic.rocking import BearingLaw
from analytic.scene import refuse_free

from .loads import FRICTION, UNIT_RADIUS, holding, share_of, unkept_friction

if TYPE_CHECKING:
    from analytic import Scene

    from .contract import Engine

SHARED = Path(__file__).with_name("script")
LAWS = ("algebraic", "bouc-wen", "bilinear", "linear")  # written out in script/bearings.py.jinja
UNSAFE = str.maketrans({"\\": "/", '"': "'"})  # in a docstring
PULSES = ("one-sine", "one-cosine", "half-sine", "rectangular", "ricker")  # and in script/motion.py.jinja


def write_script(engine: Engine, scene: Scene, name: str | None = None) -> dict[str, str]:
    """Write a scene as a script: {file name: text} of the script and of the record that it reads, if any.

    Parameters
    ----------
    engine : Engine
        Its package need not be installed.
    scene : Scene
        Without a duration, the script runs until the analytic model's run is decided.
    name : str or None
        Name of the script without its suffix; None: the scene's and the engine's.

    Raises
    ------
    SettingError
        The engine has no script.
    SceneError
        The scene has a bearing law, a pulse or a restitution that scripts lack.
    """
    if engine.script is None:
        raise SettingError(f"{engine.name} has no script: its record names no template")
    _check(scene)
    name = name or re.sub(r"[^\w.-]+", "-", f"{scene.name or 'scene'}-{engine.name}")
    sampled = scene.motion if isinstance(scene.motion, SampledMotion) else None
    record = f"{name}-motion.txt" if sampled else None
    environment = Environment(
        loader=FileSystemLoader(SHARED),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    package, _, file = engine.script.partition(":")
    template = environment.from_string((files(package) / file).read_text(encoding="utf-8"))
    text = template.render(_context(engine, scene, name, record))
    texts = {f"{name}.py": re.sub(r"\n{4,}", "\n\n\n", text)}
    if sampled and record:
        texts[record] = _columns(sampled)
    return texts


def _check(scene: Scene) -> None:
    """Raise `SceneError` where a scene has a law, a pulse or a restitution that scripts lack."""
    refuse_free(scene, "scripts")
    bearings, motion = scene.bearings, scene.motion
    if bearings is not None and bearings.law not in LAWS:
        raise SceneError(
            "bearings.law", bearings.law, "is not written out in scripts", f"choose one of {', '.join(LAWS)}"
        )
    if motion is not None and not isinstance(motion, SampledMotion) and motion.shape not in PULSES:
        raise SceneError(
            "motion.pulse", motion.shape, "is not written out in scripts", f"choose one of {', '.join(PULSES)}"
        )
    share_of(scene)
    if scene.friction is not None:
        analytic.simulate(scene, history=False)  # raises where the block's slip is not determined


def _context(engine: Engine, scene: Scene, name: str, record: str | None) -> dict[str, Any]:
    """The variables with which a template is rendered."""
    block, start, given = scene.block, scene.start, (share_of(scene) or 1.0) < 1.0
    friction, unkept = holding(scene).friction if given else scene.friction, unkept_friction(scene)
    return {
        "engine": engine.name,
        "scene": scene,
        "title": f"{shorten(scene.name or 'A scene', 60)}: a rocking block {_support(scene)}".translate(UNSAFE),
        "friction": None if unkept else scene.friction,
        "sticking": max(friction or 0.0, FRICTION),  # where a script has none
        "unkept": unkept,
        "name": name,
        "record": record and json.dumps(record, ensure_ascii=False),  # a string in quotes
        "pulse": scene.motion if scene.motion and not record else None,
        "vertical": scene.motion.vertical if scene.motion else None,
        "block": block,
        "base": scene.base,
        "bearings": scene.bearings,
        "f0": BearingLaw.of(scene.bearings).constants.f0,
        "memory": scene.bearings is not None and BearingLaw.of(scene.bearings).unit.memory,
        "inertia": None if block.corner_inertia is None else block.corner_inertia / (block.mass * block.radius**2),
        "given": given,
        "start": start,
        "moved": bool(start.tilt or start.tilt_rate),
        "base_moved": bool(start.base_displacement or start.base_velocity),
        "tail": None if scene.duration else _tail(scene),
        "unit_radius": UNIT_RADIUS,
    }


def _support(scene: Scene) -> str:
    if scene.base is None:
        return "on rigid ground"
    return "on bearings" if scene.bearings else "on a base that slides freely"


def _tail(scene: Scene) -> float:
    """Time after the motion [s] that decides the outcome: that of the analytic model's run."""
    model = analytic.simulate(scene, history=False)
    later = 2 * math.pi / scene.rocking_frequency if model.outcome == "overturns" else 0.0  # the engine's fall may be
    end = max(model.end.time + later, shortest_duration(scene)) - motion_end(scene)
    return math.ceil(end * 1000) / 1000


def _columns(motion: SampledMotion) -> str:
    """A record as text: time [s], acceleration [m/s2] and the vertical one, if any, one sample a line."""
    columns = [motion.samples, *([motion.vertical.samples] if motion.vertical else [])]
    head = "# time [s], ground acceleration [m/s2]" + (", upward acceleration [m/s2]" if motion.vertical else "")
    rows = zip(*(column.tolist() for column in columns), strict=True)
    lines = (" ".join([f"{i * motion.dt:.12g}", *map(repr, row)]) for i, row in enumerate(rows))
    return "\n".join([head, *lines, ""])
