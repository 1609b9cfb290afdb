"""What every reader of a record starts from and hands back: lines of text; step, values and their unit."""

import re
from dataclasses import dataclass
from os import PathLike

import numpy as np

from ..errors import SceneError
from ..files import read_plain
from .units import Unit

LARGEST = 200_000_000  # bytes: some 1e7 samples
HEADER_WIDTH = 400  # characters of a header line that are looked at
UNKNOWN = (
    "not a known record format",
    "give PEER AT2 (a line NPTS= ..., DT= ...), ESM/DYNA 1.2 ASCII, CSMIP volume 2 or two columns of numbers",
)
PACKED = {
    b"\x1f\x8b": ("gzip", "gunzip"),
    b"PK\x03\x04": ("zip", "unzip"),
    b"BZh": ("bzip2", "bunzip2"),
    b"\xfd7zXZ": ("xz", "unxz"),
}
CONTROL = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f]")


@dataclass(frozen=True)
class Asked:
    """What the user says of a record. None: nothing, and the file itself must say it.

    channel : int, str or None
        Number or direction of one of several channels.
    """

    channel: int | str | None = None


@dataclass(frozen=True)
class Content:
    """One channel of a record as read: sampling interval dt [s], values as printed, shape (n,), the unit its own words
    state (None: none), what it says of a missing one, sentences on what is odd, the channel's number and direction."""

    dt: float
    values: np.ndarray
    unit: Unit | None
    no_unit: str = "the header names no unit"
    warnings: tuple[str, ...] = ()
    channel: str = ""
    direction: str = ""

    @property
    def channel_words(self) -> str:
        """The channel as messages name it: 3 (Up)."""
        return f"{self.channel} ({self.direction})" if self.direction else self.channel


def read_lines(path: str | PathLike[str]) -> list[str]:
    """The lines of a text file, without their ends.

    Raises
    ------
    SceneError
        The file cannot be read, is packed, or is not text.
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
    for magic, (name, command) in PACKED.items():
        if content.startswith(magic):
            raise SceneError("record", None, f"is packed by {name}", f"unpack it first ({command})")
    # Ctrl-Z ended DOS files. CR CR LF is what a DOS text becomes after one more conversion.
    lines = re.sub(r"\r++\n?+", "\n", _text(content).rstrip("\x1a")).split("\n")
    for number, line in enumerate(lines, 1):
        if not line.isprintable() and (odd := CONTROL.search(line)):
            raise SceneError(
                f"line {number}", None, f"{UNKNOWN[0]}: it holds the control character {odd[0]!r}", UNKNOWN[1]
            )
    return lines


def _text(content: bytes) -> str:
    if content.startswith((b"\xff\xfe", b"\xfe\xff")):
        return content.decode("utf-16", errors="replace")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return content.decode("latin-1")  # old headers, and "cm/s²" of Windows programs
