"""Options that commands share (of a record, of the many motions a scene is tried under), and messages that name them:
options, not the parameters or the keys behind them.
"""

from __future__ import annotations

import contextlib
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Annotated, Any

import typer

from analytic.errors import SceneError, SettingError

if TYPE_CHECKING:
    from analytic import Caution, Response, Scene
    from analytic.motion import Motion

# What a user says of a record that the file itself does not.
Units = Annotated[
    str | None, typer.Option(help="Unit, if header and titles state none: m/s2, cm/s2, gal, mm/s2, g or %g.")
]
Step = Annotated[
    float | None, typer.Option(metavar="SECONDS", help="Sampling interval, if no line such as dt = 0.01 s states one.")
]
Column = Annotated[
    str | None, typer.Option(help="Of several columns: the accelerations', its number from 1 on or its title.")
]
Channel = Annotated[str | None, typer.Option(help="Of several channels: its number or direction, 3 or Up.")]
# What `rocking new` and `rocking design` share; those of a record, wherever one is read.
DEFINITION = "Of the damping. equivalent: W_D/(4 pi E_s), the usual one; paper: W_D/(2 pi E_s), twice as much."
RATIO = "By design: ka/kb; Table 1(b) of the paper has 10."
RECORD_OPTIONS = {f"motion.{name}": f"--{name}" for name in ("units", "dt", "column", "channel")}
_SAME = ("height", "width", "depth", "density", "mass", "period", "damping", "definition", "count", "friction")
OPTIONS = {
    **{name: f"--{name}" for name in _SAME},
    **{f"bearings.{name}": f"--{name}" for name in ("count", "ka", "kb", "alpha")},
    **RECORD_OPTIONS,
    **{"x_max": "--xmax", "bearings.x_max": "--xmax", "stiffness_ratio": "--ratio", "start.tilt": "--tilt"},
    **{"block.mass": "--mass", "base.mass": "--base-mass"},
}


@contextlib.contextmanager
def named_by_options(options: Mapping[str, str]) -> Iterator[None]:
    """Errors raised inside name options; options : {parameter of a function, or key of a scene: option}."""
    try:
        yield
    except SettingError as error:
        words = str(error)
        for name, option in options.items():
            end = r"\b" if "_" in name else "(?= = )"  # a word of a sentence stays one
            words = re.sub(rf"(?<![\w.-]){re.escape(name)}{end}", option, words)
        raise SettingError(words) from None
    except SceneError as error:
        raise _by_options(error, options) from None


def _by_options(error: SceneError, options: Mapping[str, str]) -> SceneError:
    """The same mistakes, naming options."""
    key = options.get(error.key, error.key)
    of_a_file = key == error.key or error.key in RECORD_OPTIONS
    file = error.file if of_a_file else None  # other options name no file
    others = tuple(_by_options(other, options) for other in error.others)
    return SceneError(key, error.value, error.problem, error.remedy, file, others)


Records = Annotated[
    str | None, typer.Option(metavar="FOLDER", help="Also under the records in this folder, as they are recorded.")
]
BothSigns = Annotated[
    bool,
    typer.Option(
        "--both-signs", help="Also under every motion with its sign changed, unless block and start are symmetric."
    ),
]
Directions = Annotated[
    int | None,
    typer.Option(
        metavar="NUMBER", help="Under so many directions of each record's two horizontal components, over half a turn."
    ),
]


OWN = "the scene's own motion"  # the record of one that is not among those of the folder


def motions_of(
    scene: Scene, records: str | None, both_signs: bool, directions: int | None, units: str | None = None
) -> tuple[dict[str, list[Motion]], list[str]]:
    """({record: its motions}, the scene's own among them as of `with_own`; what is left out and why, said).

    Raises
    ------
    SettingError
        No such folder, no motion in it, or directions or units without a folder.
    """
    from analytic.records.folder import folder_motions, reversed_sign, same_reversed

    from .progress import say

    for name, value in (("directions", directions), ("units", units)):
        if value is not None and records is None:
            raise SettingError(f"--{name} {value}: give the folder of the records with --records")
    found: dict[str, list[Motion]] = {}
    left: list[str] = []
    if records is not None:
        with named_by_options({"directions": "--directions"}):
            others, left = folder_motions(records, directions=directions, own=scene.motion, units=units)
        found = {name: [*motions] for name, motions in others.items()}
        for line in left:
            say(line)
    found = with_own(scene.motion, found)
    if both_signs and same_reversed(scene):
        say("--both-signs: mirrored the same, as block and start are symmetric; each motion is run once")
    elif both_signs:
        found = {name: [*motions, *map(reversed_sign, motions)] for name, motions in found.items()}
    return found, left


def with_own(own: Motion | None, groups: Mapping[str, Sequence[Motion]]) -> dict[str, list[Motion]]:
    """{record: its motions}, a scene's own motion among them: where it is not yet, the first of the record of its name
    or, without one, of `OWN`."""
    found = {record: [*motions] for record, motions in groups.items()}
    if own is None or any(one.digest() == own.digest() for motions in found.values() for one in motions):
        return found
    return {own.label if own.label in found else OWN: [own, *found.pop(own.label, [])], **found}


def other_motions(
    scene: Scene, records: str | None, both_signs: bool, directions: int | None, units: str | None = None
) -> tuple[dict[str, list[Motion]], list[str]]:
    """`motions_of` where one of the options is given, else none."""
    given = both_signs or any(value is not None for value in (records, directions, units))
    return motions_of(scene, records, both_signs, directions, units) if given else ({}, [])


def read_row(record: str, motion: Motion, warnings: Sequence[Caution] = ()) -> dict[str, Any]:
    """A motion as it was read: record, motion, peak [m/s2], and warnings on it, as `schemas.runs.MotionRead` has it;
    further `warnings` behind them."""
    from analytic.response import about_record

    told = dict.fromkeys((*about_record(motion), *warnings))
    return {"record": record, "motion": motion.label, "peak": motion.peak, "warnings": list(map(asdict, told))}


def rows_of(
    scene: Scene,
    groups: Mapping[str, Sequence[Motion]],
    simulate: Callable[[Scene], Response],
    more: Callable[[Scene], Mapping[str, Any]] = lambda scene: {},
) -> list[dict[str, Any]]:
    """`row_of` each motion, in the groups' order; shown as it goes on."""
    from .progress import bar

    pairs = [(record, motion) for record, motions in groups.items() for motion in motions]
    if not pairs:
        return []
    rows = []
    with bar(f"{scene.name}: {len(pairs)} motions") as progress:
        for record, motion in pairs:
            rows.append(row_of(scene, record, motion, simulate, more))
            progress(len(rows), len(pairs))
    return rows


def row_of(
    scene: Scene,
    record: str,
    motion: Motion,
    simulate: Callable[[Scene], Response],
    more: Callable[[Scene], Mapping[str, Any]] = lambda scene: {},
) -> dict[str, Any]:
    """A scene under one of many motions, as `schemas.runs.MotionRun` has it: the one way from a motion to its warnings.

    simulate : of the scene under the motion; where it is refused, the row is that of a failed run. more : what else a
    row of a run has.
    """
    from analytic.errors import SceneError

    try:
        under = scene.with_(motion=motion)
        response, added = simulate(under), more(under)
    except SceneError as error:
        response, added = refused(scene.with_(motion=None), error), {}
    return {**read_row(record, motion, response.warnings), **_measures(scene, response), **added}


def end_with(rows: Sequence[Mapping[str, Any]], *responses: Response) -> None:
    """End the command with status 1 where the run of a motion, or one of the responses, failed."""
    if any(row["failure"] for row in rows) or any(response.failure for response in responses):
        raise typer.Exit(1)


def refused(scene: Scene, error: SceneError, **known: Any) -> Response:
    """The failed response of a scene that a solver refuses; known : engine, variant, ..., the model's without them."""
    from analytic.response import Failure
    from engines.observe import failed_response

    from .cases import versions
    from .solving import ANALYTIC

    name = known.get("engine", ANALYTIC)
    solver = {"engine": name, "variant": "", "settings": {}, "versions": versions(name)}
    return failed_response(scene, Failure("it cannot run this scene", str(error)), **{**solver, **known})


def _measures(scene: Scene, response: Response) -> dict[str, Any]:
    """What a run did."""
    failure = response.failure
    return {
        "outcome": response.outcome,
        "failure": failure and f"{failure.reason}: {failure.message.partition(chr(10))[0]}".removesuffix(": "),
        "tilt": response.peak_tilt_ratio,
        "stroke": response.peak_base_displacement if scene.base else None,
        "slip": response.sliding and response.sliding.peak,
    }
