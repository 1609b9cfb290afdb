"""Input and output of every reader of records: lines of text; step, values and their unit."""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path

import numpy as np

from ..errors import SceneError
from ..files import read_plain
from .foreign import refuse_binary
from .packed import unpacked
from .units import Unit

LARGEST = 200_000_000  # bytes: some 1e7 samples
HEADER_WIDTH = 400  # characters of a header line that are read
UNKNOWN = (
    "not a known record format",
    "give PEER AT2 (a line NPTS= ..., DT= ...), ESM/DYNA 1.2, CSMIP volume 2, COSMOS, K-NET, SMC or columns of numbers",
)
# What some files write above and below their data: *** Begin data ***, *** End data ***.
MARK = re.compile(r"\s*\*{2,}\s*(?:begin|end)\b[^*0-9]*\*{2,}\s*", re.I)
CONTROL = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f]")


@dataclass(frozen=True)
class Asked:
    """What the user states of a record. None: not stated, so that the file must state it.

    dt : float or None
        Sampling interval [s].
    column : int or str or None
        The column of the accelerations, from 1 on, or its title.
    """

    dt: float | None = None
    column: int | str | None = None


@dataclass(frozen=True)
class Content:
    """One channel of a record as read: sampling interval dt [s] and unit as stated in the file (None: not stated),
    values as printed, shape (n,), message for a missing unit, warnings, number and direction of the channel, processing
    of the values, and sentences on words about the sampling that are not understood."""

    dt: float | None
    values: np.ndarray
    unit: Unit | None
    no_unit: str = "the header names no unit"
    warnings: tuple[str, ...] = ()
    channel: str = ""
    direction: str = ""
    note: str = ""
    unread: tuple[str, ...] = ()


def first_of(lines: Sequence[str]) -> str:
    """The first line that is not blank, "" without one."""
    return next((line for line in lines if line.strip()), "")


def begun_by(pattern: re.Pattern[str]) -> Callable[[Sequence[str]], bool]:
    """The `recognises` of a format whose first line is of the pattern."""
    return lambda lines: bool(pattern.match(first_of(lines)[:HEADER_WIDTH]))


def read_lines(path: str | PathLike[str]) -> tuple[list[str], str]:
    """(lines without their ends, name) of a text file, or of the one file that a packed file holds; a last line that
    marks the end of the data is blank.

    Raises
    ------
    SceneError
        The file cannot be read or unpacked, or is not text.
    """
    try:
        content = read_plain(path, LARGEST)
    except OSError as error:
        raise SceneError(
            "motion.record",
            str(path),
            f"cannot be read ({error.strerror})",
            "give the path of a record, relative to the scene file",
        ) from error
    content, name = unpacked(content, Path(path).name, LARGEST)
    refuse_binary(content)
    # Ctrl-Z ended DOS files. CR CR LF is what a DOS text becomes after one more conversion.
    lines = re.sub(r"\r++\n?+", "\n", _text(content).rstrip("\x1a")).split("\n")
    for number, line in enumerate(lines, 1):
        if not line.isprintable() and (odd := CONTROL.search(line)):
            raise SceneError(
                f"line {number}", None, f"{UNKNOWN[0]}: it holds the control character {odd[0]!r}", UNKNOWN[1]
            )
    last = next((at for at in reversed(range(len(lines))) if lines[at].strip()), 0)
    if MARK.fullmatch(lines[last][:HEADER_WIDTH]):
        lines[last] = ""
    return lines, name


def _text(content: bytes) -> str:
    if content.startswith((b"\xff\xfe", b"\xfe\xff")):
        return content.decode("utf-16", errors="replace")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return content.decode("latin-1")  # old headers, and "cm/s²" of Windows programs
