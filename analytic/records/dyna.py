"""ESM/DYNA 1.2 ASCII, also as AFAD writes it: lines KEY: value, then one value a line."""

import re
from collections.abc import Sequence

from ..errors import SceneError
from .content import HEADER_WIDTH, Asked, Content, first_of
from .numbers import NUMBER, check_count, count, fortran_values, number, odd_peak
from .times import interval
from .units import Unit, factor_of

NAME = "ESM/DYNA 1.2 ASCII"
KEY = re.compile(r"([A-Z][A-Z0-9_/^]*+):(.*)")
HEADER_LINES = 70  # 64 in version 1.2
SIGNS = ("EVENT_NAME", "SAMPLING_INTERVAL_S", "HEADER_FORMAT")
REMEDY = "give a complete ESM/DYNA 1.2 ASCII file"


def recognises(lines: Sequence[str]) -> bool:
    """Whether the lines are an ESM/DYNA file."""
    return bool(KEY.match(first_of(lines))) and any(line.startswith(SIGNS) for line in lines[:HEADER_LINES])


def read(lines: Sequence[str], asked: Asked) -> tuple[Content, ...]:
    """The `Content` of an ESM/DYNA file.

    Raises
    ------
    SceneError
        A key is missing, the data are no accelerations, an unreadable number, or another count than stated.
    """
    header, begin = _header(lines)
    for key in ("SAMPLING_INTERVAL_S", "UNITS", "NDATA"):
        if not header.get(key, ("",))[0]:
            raise SceneError(key, None, "missing from the header", REMEDY)
    stated, line = header["UNITS"]
    kind = header.get("DATA_TYPE", ("acceleration",))[0]
    factor = factor_of(stated)
    if factor is None or (kind and not re.match(r"acc(?!.*spectr)", kind, re.I)):
        key, value = ("UNITS", stated) if factor is None else ("DATA_TYPE", kind)
        raise SceneError(key, value, "not an acceleration this reader knows", "give the acceleration file, in cm/s^2")
    values = fortran_values(lines, begin)
    check_count("NDATA", count("NDATA", header["NDATA"][0]), values)
    dt = interval("SAMPLING_INTERVAL_S", header["SAMPLING_INTERVAL_S"][0])
    pga = header.get("PGA_CM/S^2", ("",))[0]
    peak = number("PGA_CM/S^2", pga) if re.fullmatch(NUMBER, pga) else None
    unit = Unit(stated, factor, f"line {line}")
    return (Content(dt, values, unit, warnings=odd_peak(peak, "cm/s2", values)),)


def _header(lines: Sequence[str]) -> tuple[dict[str, tuple[str, int]], int]:
    """{key: (value, line number)} and the index of the first line after them."""
    header: dict[str, tuple[str, int]] = {}
    begin = next((index for index, line in enumerate(lines) if line.strip()), 0)
    while begin < len(lines) and (match := KEY.match(lines[begin][:HEADER_WIDTH])):
        key, value = match[1], match[2].strip()
        if key in header and header[key][0] != value:
            raise SceneError(
                f"line {begin + 1}, {key}", value, f"but line {header[key][1]} says {header[key][0]}", REMEDY
            )
        header[key] = (value, begin + 1)
        begin += 1
    return header, begin
