"""Known formats that are not read: each is refused by name, with a remedy."""

import re
from collections.abc import Sequence
from typing import NoReturn

from ..errors import SceneError

NAME = "a format that is not read"
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


def recognises(lines: Sequence[str]) -> bool:
    """Whether the first lines are those of a known format that is not read."""
    return _name(lines) is not None


def read(lines: Sequence[str], asked: object) -> NoReturn:
    """Refuse the file, saying what to do instead."""
    name = _name(lines) or ""  # `recognises` found one
    raise _refused(name, SIGNS[name][1])


def refuse_binary(content: bytes) -> None:
    """Refuse the bytes of a binary format that is known."""
    for name, sign in BINARY.items():
        if sign.match(content):
            raise _refused(name, WITH_OBSPY)


def _refused(name: str, remedy: str) -> SceneError:
    return SceneError("record", None, f"is a {name} file, which is not read", remedy)


def _name(lines: Sequence[str]) -> str | None:
    first = next((at for at, line in enumerate(lines) if line.strip()), 0)
    top = "\n".join(line[:200] for line in lines[first : first + TOP])
    return next((name for name, sign in _SIGNS.items() if sign.match(top)), None)
