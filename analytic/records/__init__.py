"""Readers of recorded ground acceleration. A format is a module that recognises its lines and reads them."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

import numpy as np

from ..errors import SceneError
from ..motion import SampledMotion
from . import columns, csmip, dyna, foreign, peer
from .content import Asked, read_lines
from .units import UNITS, G, resolve

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .content import Content
    from .units import Unit

__all__ = ["FORMATS", "G", "UNITS", "read_record"]

FORMATS: tuple[Format, ...] = (peer, dyna, csmip, foreign, columns)  # the first that recognises the lines reads them
NOT_ACCELERATIONS = {".vt2": "velocities", ".dt2": "displacements"}
USUAL_PEAK = (1e-4 * G, 3 * G)  # m/s2
USUAL_STEP = (1e-4, 0.1)  # s
LARGEST_PEAK = 1e6 * G  # m/s2: a damaged number


class Format(Protocol):
    """What the module of a format offers."""

    NAME: str

    def recognises(self, lines: Sequence[str]) -> bool:
        """Whether the lines of a file are of this format."""

    def read(self, lines: Sequence[str], asked: Asked) -> Sequence[Content]:
        """The `Content` of each channel, in the order of the file; raises `SceneError`."""


def read_record(
    path: str | PathLike[str], units: str | None = None, scale: float = 1.0, *, channel: int | str | None = None
) -> SampledMotion:
    """The ground motion in a record file; the format is recognised from the content.

    Parameters
    ----------
    path : str or Path
        PEER AT2, ESM/DYNA 1.2 ASCII (also as AFAD writes it), CSMIP volume 2 or two columns (time, acceleration; CSV).
    units : {"m/s2", "cm/s2", "g"}, optional
        Unit of a record whose own words state none; must not contradict them.
    scale : float
        Factor on the accelerations.
    channel : int or str, optional
        Number (3) or direction ("Up") of one of the channels of a file that has several.

    Returns
    -------
    SampledMotion
        In m/s2; its time counts from the first sample. Its warnings say what is odd about the file.

    Raises
    ------
    SceneError
        Names the file, the line or header key, what was found and the remedy.
    """
    path = Path(path)
    try:
        return _motion(_content(path, Asked(channel)), path.name, units, scale)
    except SceneError as error:
        raise error.in_file(path) from None


def _content(path: Path, asked: Asked) -> Content:
    lines = read_lines(path)
    if path.suffix.lower() in NOT_ACCELERATIONS:
        raise SceneError(
            "record",
            None,
            f"holds {NOT_ACCELERATIONS[path.suffix.lower()]}, as {path.suffix} files do",
            "give the acceleration file (.AT2) of this record",
        )
    if not any(line.strip() for line in lines):
        raise SceneError("record", None, "is empty", "give a record with at least two accelerations")
    return _chosen(next(form for form in FORMATS if form.recognises(lines)).read(lines, asked), asked.channel)


def _chosen(contents: Sequence[Content], channel: int | str | None) -> Content:
    """The one of a file's contents that `channel`, a number or a direction, names; without it the only one."""
    choice = " or ".join(content.channel_words for content in contents)
    if channel is None and len(contents) > 1:
        raise SceneError(
            "motion.channel", None, f"missing; the file holds channels {choice}", "add channel, one of these"
        )
    if channel is None:
        return contents[0]
    if not contents[0].channel:
        raise SceneError("motion.channel", channel, "but the file has no several channels", "remove channel")
    word = " ".join(str(channel).split()).casefold()
    found = [content for content in contents if content.channel == word] or [
        content for content in contents if content.direction.casefold() == word
    ]
    if len(found) != 1:
        problem = "names several channels" if found else "not a channel of the file"
        raise SceneError("motion.channel", channel, problem, f"choose one of {choice}, by its number")
    return found[0]


def _motion(content: Content, name: str, units: str | None, scale: float) -> SampledMotion:
    """The `SampledMotion` of a `Content`: its unit, its label and what is odd about it."""
    unit = resolve(content.unit, units, content.no_unit)
    if len(content.values) < 2:
        raise SceneError("record", None, f"holds {len(content.values)} samples", "give at least two accelerations")
    samples = content.values * unit.factor
    peak = float(np.abs(samples).max())
    if peak > LARGEST_PEAK:
        raise SceneError("record", None, f"its peak of {peak / G:.3g} g is no ground motion", "mend the damaged number")
    if not abs(scale) * peak <= LARGEST_PEAK:
        raise SceneError("motion.scale", scale, f"makes a peak of {abs(scale) * peak / G:.3g} g", "give a smaller one")
    label = f"{name}, channel {content.channel_words}" if content.channel else name
    label = label if scale == 1 else f"{label} x {scale:g}"
    odd = _odd(peak, content.dt, unit) + content.warnings
    return SampledMotion(content.dt, samples * scale, label, tuple(f"{name}: {sentence}" for sentence in odd))


def _odd(peak: float, dt: float, unit: Unit) -> tuple[str, ...]:
    """Sentences on a peak [m/s2] or a step dt [s] that records seldom have."""
    sentences = []
    if not USUAL_PEAK[0] <= peak <= USUAL_PEAK[1]:
        side = "above 3 g" if peak > USUAL_PEAK[1] else "below 1e-4 g"
        sentences.append(f"the peak of {peak / G:.4g} g is {side}: check the unit (read in {unit.word}, {unit.where})")
    if not USUAL_STEP[0] <= dt <= USUAL_STEP[1]:
        side = "above .1 s" if dt > USUAL_STEP[1] else "below 1e-4 s"
        sentences.append(f"the sampling interval of {dt:.4g} s is {side}: check the unit of time")
    return tuple(sentences)
