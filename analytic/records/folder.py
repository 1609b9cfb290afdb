"""The records of a folder as motions of a scene, and two horizontal components turned into other directions."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import SceneError, SettingError
from ..motion import SampledMotion
from ..pairing import paired

if TYPE_CHECKING:
    from ..types import Motion

VERTICAL = ("up", "u-d", "ud", "vertical", "vert", "dwn", "ver", "v", "z", "u")  # how files call it
AXES = (("e", "ew", "e-w", "x", "1", "h1"), ("n", "ns", "n-s", "y", "2", "h2"))  # and the two horizontal components
# The component in a file's name: a word of its own, after the letters of an instrument (HNE), or an azimuth.
_WORD = re.compile(
    r"(?<![A-Za-z])(?:[BEHS][HNLG])?(E-?W|N-?S|U-?D|UP|VERT|VER|DWN|H[12]|[ENZXYUV12])(?![A-Za-z0-9])", re.I
)
_AZIMUTH = re.compile(r"(?<!\d)(\d{3})(?=(\.\w+)*$)")


def turned(first: SampledMotion, second: SampledMotion, angle: float, name: str) -> SampledMotion:
    """The motion in the plane at `angle` [rad] from the first of two horizontal components to the second.

    The two are brought to one step and one length as `paired` does; neither has a vertical motion.
    """
    both = paired(first, second)
    assert both.vertical is not None
    samples = math.cos(angle) * both.samples + math.sin(angle) * both.vertical.samples
    return SampledMotion(both.dt, samples, f"{name}, {math.degrees(angle):.4g} degrees", both.warnings)


def directions_of(first: SampledMotion, second: SampledMotion, count: int, name: str) -> list[SampledMotion]:
    """`count` directions of two components, evenly over half a turn; the other half are these with their signs changed.

    Raises
    ------
    SettingError
        count is below 1.
    """
    if count < 1:
        raise SettingError(f"directions = {count!r}: give 1 or more")
    return [turned(first, second, math.pi * step / count, name) for step in range(count)]


def reversed_sign(motion: Motion) -> Motion:
    """The horizontal motion with its sign changed; the vertical one stays."""
    return (
        replace(motion.scaled(-1.0), label=f"{motion.label}, reversed", vertical=motion.vertical)
        if isinstance(motion, SampledMotion)
        else replace(motion, amplitude=-motion.amplitude)
    )


def folder_motions(
    folder: str | PathLike[str], *, directions: int | None = None, **said: object
) -> tuple[dict[str, list[SampledMotion]], list[str]]:
    """The horizontal motions of the records in a folder, and what was left out.

    Parameters
    ----------
    folder : path
        Its files, not those of folders in it, in the order of their names.
    directions : int or None
        So many directions of each pair of horizontal components, over half a turn; without it the components as they
        are. A pair is two horizontal channels of one file, or two files whose names differ in the component alone:
        E and N, EW and NS, H1 and H2, X and Y, azimuths 90 degrees apart.
    said : units, dt
        Of records that do not say, as `read_record` takes them.

    Returns
    -------
    (dict, list of str)
        {record: its motions}, one record a pair; and a sentence for each file or channel that is left out.

    Raises
    ------
    SettingError
        There is no such folder, or no horizontal motion in it.
    """
    folder = Path(folder)
    if not folder.is_dir():
        raise SettingError(f"--records {folder}: no folder; give one with record files")
    components, left = _components(folder, said)
    found: dict[str, list[SampledMotion]] = {}
    for record, axes in components.items():
        whole = [motion for axis in axes for motion in axis]
        if directions is None:
            found[whole[0].label if len(whole) == 1 else record] = whole
        elif [len(axis) for axis in axes] == [1, 1]:
            found[record] = directions_of(axes[0][0], axes[1][0], directions, record)
        else:
            left += [f"{motion.label}: no pair of horizontal components, so its direction stays" for motion in whole]
            found |= {motion.label: [motion] for motion in whole}
    if not found:
        raise SettingError(
            f"--records {folder}: no horizontal ground motion in it; " + "; ".join(left[:3] or ["empty"])
        )
    return found, left


def _components(folder: Path, said: dict) -> tuple[dict[str, tuple[list, list]], list[str]]:
    """{record: (motions of its first axis, of its second)}, and what was left out."""
    from . import read_channels

    found: dict[str, tuple[list, list]] = {}
    left = []
    azimuths: dict[str, float] = {}
    for path in sorted(folder.iterdir()):
        if not path.is_file():
            continue
        try:
            channels = read_channels(path, **said)
        except (SceneError, OSError) as error:
            left.append(f"{path.name}: left out, {getattr(error, 'problem', error)}")
            continue
        level = [channel for channel in channels if not is_vertical(channel.direction)]
        stem, word = _named(path.name) if len(channels) == 1 else (path.name, "")
        if not level or is_vertical(word):
            left.append(f"{path.name}: left out, a vertical motion")
            continue
        for number, channel in enumerate(level):
            axis = number if len(level) == 2 else _axis(word, stem, azimuths)
            key = stem if axis is not None else path.name
            found.setdefault(key, ([], []))[axis or 0].append(channel.motion)
    return found, left


def is_vertical(word: str) -> bool:
    """Whether a file means the vertical component by this word."""
    return word.casefold() in VERTICAL


def _named(name: str) -> tuple[str, str]:
    """(the name with its component replaced by *, the component); ("" where the name holds none)."""
    words = list(_WORD.finditer(name)) or list(_AZIMUTH.finditer(name))
    if not words:
        return name, ""
    start, end = words[-1].span(1)
    return f"{name[:start]}*{name[end:]}", words[-1][1]


def _axis(word: str, stem: str, azimuths: dict[str, float]) -> int | None:
    """0 or 1: which horizontal axis of the record a component is; None where its name says nothing."""
    if word.isdigit() and len(word) == 3:
        first = azimuths.setdefault(stem, float(word))
        turn = (float(word) - first) % 180
        return {0.0: 0, 90.0: 1}.get(turn)
    return next((number for number, names in enumerate(AXES) if word.casefold() in names), None)
