"""Options for many motions of a scene, the same in every command."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from analytic import Response, Scene
    from analytic.motion import Motion

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


def motions_of(
    scene: Scene, records: str | None, both_signs: bool, directions: int | None, units: str | None = None
) -> dict[str, list[Motion]]:
    """{record: its motions}, the scene's own first; one that lies in the folder counts once. What is left out is said.

    Raises
    ------
    SettingError
        No such folder, no motion in it, or directions or units without a folder.
    """
    from analytic.errors import SettingError
    from analytic.records.folder import folder_motions, reversed_sign, same_reversed

    from .options import named_by_options
    from .progress import say

    for name, value in (("directions", directions), ("units", units)):
        if value is not None and records is None:
            raise SettingError(f"--{name} {value}: give the folder of the records with --records")
    found: dict[str, list[Motion]] = {}
    own = scene.motion
    if records is not None:
        with named_by_options({"directions": "--directions"}):
            others, left = folder_motions(records, directions=directions, own=own, units=units)
        found = {name: [*motions] for name, motions in others.items()}
        for line in left:
            say(line)
    first = next(iter(found.values()), [])[:1]
    if own is not None and own.digest() not in [motion.digest() for motion in first]:
        found = {own.label: [own, *found.pop(own.label, [])], **found}
    if both_signs and same_reversed(scene):
        say("--both-signs: mirrored the same, as block and start are symmetric; each motion is run once")
    elif both_signs:
        found = {name: [*motions, *map(reversed_sign, motions)] for name, motions in found.items()}
    return found


def other_motions(
    scene: Scene, records: str | None, both_signs: bool, directions: int | None, units: str | None = None
) -> dict[str, list[Motion]]:
    """`motions_of` where one of the options is given, else none."""
    given = both_signs or any(value is not None for value in (records, directions, units))
    return motions_of(scene, records, both_signs, directions, units) if given else {}


def rows_of(
    scene: Scene, groups: Mapping[str, Sequence[Motion]], simulate: Callable[[Scene], Response]
) -> list[dict[str, Any]]:
    """A row for each motion: record, motion, peak [m/s2], outcome, tilt over slenderness, base displacement [m]."""
    from .progress import bar

    pairs = [(record, motion) for record, motions in groups.items() for motion in motions]
    rows = []
    with bar(f"{scene.name}: motions") as progress:
        for number, (record, motion) in enumerate(pairs, 1):
            response = simulate(scene.with_(motion=motion))
            rows.append(
                {
                    "record": record,
                    "motion": motion.label,
                    "peak": motion.peak,
                    "outcome": response.outcome,
                    "tilt": response.peak_tilt_ratio,
                    "stroke": response.peak_base_displacement if scene.base else None,
                }
            )
            progress(number, len(pairs))
    return rows
