"""Formats of databases and networks whose numbers blanks or commas part: PEER AT2, ESM/DYNA, K-NET.

PEER AT2, the old and the new headers: values in columns of Fortran after a line with NPTS and DT. ESM/DYNA 1.2 ASCII,
also as AFAD writes it: lines KEY: value, then one value a line. NIED's K-NET and KiK-net ASCII: 17 lines of header,
then counts; acceleration = (count - mean of all) times scale factor. K-NET CSV: a header of lines that begin with #,
then a time stamp, a time [s] and three components [gal] a line, whose offsets the header states.
"""

import re
from collections.abc import Sequence
from typing import Any

import numpy as np

from ..errors import SceneError
from .content import DAMAGED, HEADER_WIDTH, MARK, Asked, Content, Format, begun_by, first_of
from .numbers import NUMBER, check_count, count, form_of, fortran_values, number, odd_peak
from .statements import read_statements, stated_unit
from .times import SAME, exact, interval, uniform_step, usable
from .units import Unit, factor_of

_PEER_LINES = 8  # the NPTS line is the fourth in every known variant

_NPTS = re.compile(r"\bNPTS\s*[=:]\s*([^\s,;]*)", re.I)
_DT = re.compile(r"\bDT\s*(?:[(\[]\s*[a-z]*\s*[)\]]\s*)?[=:]", re.I)
_OLD = re.compile(rf"\s*([0-9]+)[\s,]+({NUMBER})[\s,]+NPTS[\s,]+DT\b(?!\s*[=:])(?:\s*[(\[]\s*([a-z]*))?", re.I)


def _is_peer(lines: Sequence[str]) -> bool:
    """Whether the lines are a PEER AT2 file."""
    return _peer_head(lines) is not None


def _peer(lines: Sequence[str], asked: Asked) -> tuple[Content, ...]:
    """The `Content` of a PEER AT2 file.

    Raises
    ------
    SceneError
        No acceleration, an unreadable number, or another count than stated.
    """
    head, npts, old = _peer_head(lines)  # type: ignore[misc]  # `_is_peer` found it
    where = f"line {head + 1}"
    numbered = [(at, line[:HEADER_WIDTH]) for at, line in enumerate(lines[: head + 1], 1)]
    if old:
        numbered[-1] = head + 1, f"dt = {old[2]} {old[3] or ''}"
    found = read_statements(numbered)
    marked = MARK.fullmatch("".join(lines[head + 1 : head + 2])[:HEADER_WIDTH])
    values = fortran_values(lines, head + (2 if marked else 1))
    check_count(f"{where}, NPTS", count(f"{where}, NPTS", npts), values)
    return (Content(found.step, values, stated_unit(found.rest, titles=head)),)


def _peer_head(lines: Sequence[str]) -> tuple[int, str, re.Match[str] | None] | None:
    """Index of the line with count and step, the count as printed, and the match of a line of the old form."""
    for index, line in enumerate(lines[:_PEER_LINES]):
        line = line[:HEADER_WIDTH]
        if old := _OLD.match(line):
            return index, old[1], old
        npts = _NPTS.findall(line)
        if npts and _DT.search(line):
            if len(_DT.findall(line)) > 1 or len(npts) > 1:
                raise SceneError(f"line {index + 1}", line, "names NPTS or DT twice", "remove the wrong one")
            return index, npts[0], None
    return None


_DYNA_KEY = re.compile(r"([A-Z][A-Z0-9_/^]*+):(.*)")
_DYNA_LINES = 70  # 64 in version 1.2
_DYNA_SIGNS = ("EVENT_NAME", "SAMPLING_INTERVAL_S", "HEADER_FORMAT")
_DYNA_REMEDY = "give a complete ESM/DYNA 1.2 ASCII file"


def _is_dyna(lines: Sequence[str]) -> bool:
    """Whether the lines are an ESM/DYNA file."""
    return bool(_DYNA_KEY.match(first_of(lines))) and any(line.startswith(_DYNA_SIGNS) for line in lines[:_DYNA_LINES])


def _dyna(lines: Sequence[str], asked: Asked) -> tuple[Content, ...]:
    """The `Content` of an ESM/DYNA file.

    Raises
    ------
    SceneError
        A key is missing, the data are no accelerations, an unreadable number, or another count than stated.
    """
    header, begin = _dyna_header(lines)
    for key in ("SAMPLING_INTERVAL_S", "UNITS", "NDATA"):
        if not header.get(key, ("",))[0]:
            raise SceneError(key, None, "missing from the header", _DYNA_REMEDY)
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


def _dyna_header(lines: Sequence[str]) -> tuple[dict[str, tuple[str, int]], int]:
    """{key: (value, line number)} and the index of the first line after them."""
    header: dict[str, tuple[str, int]] = {}
    begin = next((index for index, line in enumerate(lines) if line.strip()), 0)
    while begin < len(lines) and (match := _DYNA_KEY.match(lines[begin][:HEADER_WIDTH])):
        key, value = match[1], match[2].strip()
        if key in header and header[key][0] != value:
            raise SceneError(
                f"line {begin + 1}, {key}", value, f"but line {header[key][1]} says {header[key][0]}", _DYNA_REMEDY
            )
        header[key] = (value, begin + 1)
        begin += 1
    return header, begin


_KNET_LINES = 30  # 17 in every known file
_SCALE = re.compile(r"Scale Factor *([0-9]{1,9}(?:\.[0-9]*)?) *\(gal\) */ *([0-9]{1,12}(?:\.[0-9]*)?) *", re.I)
_FREQUENCY = re.compile(r"Sampling Freq *\(Hz\) *([0-9]{1,6}(?:\.[0-9]*)?) *(?:Hz)? *", re.I)
_DURATION = re.compile(r"Duration Time *\(s\) *([0-9]{1,6}(?:\.[0-9]*)?) *", re.I)
_DIRECTION = re.compile(r"Dir\. *(.*)", re.I)
_PEAK = re.compile(rf"Max\. Acc\. *\(gal\) *({NUMBER}) *", re.I)
_COUNT = re.compile(r"[+-]?[0-9]{1,9}")
_KNET_REMEDY = "give the file as the network sends it, in ASCII or CSV"


def _knet(lines: Sequence[str], asked: Asked) -> tuple[Content, ...]:
    """The `Content` of the one channel [gal], its mean removed.

    Raises
    ------
    SceneError
        A line of the header is missing, what is no whole number, or another count than duration and frequency make.
    """
    end = next((index for index, line in enumerate(lines[:_KNET_LINES]) if line.lower().startswith("memo.")), None)
    if end is None:
        raise SceneError("Memo.", None, "missing from the header", _KNET_REMEDY)
    header = [line[:HEADER_WIDTH] for line in lines[:end]]
    frequency, duration = (number(key, _found(header, key, by)[1]) for key, by in _NUMBERS.items())
    scale = _found(header, "Scale Factor", _SCALE)
    gal, steps = number("Scale Factor", scale[1]), number("Scale Factor", scale[2])
    for key, value in (("Sampling Freq(Hz)", frequency), ("Scale Factor", gal), ("Scale Factor", steps)):
        if not value:
            raise SceneError(key, value, "not above 0", _KNET_REMEDY)
    _check_places(lines[end + 1 :], end + 2)
    counts = [_count(at, token) for at, line in enumerate(lines[end + 1 :], end + 2) for token in line.split()]
    if len(counts) != round(duration * frequency):
        raise SceneError("Duration Time(s)", duration, f"but {len(counts)} samples follow at {frequency:g} Hz", DAMAGED)
    size, total = len(counts), sum(counts)
    # The difference from the mean is taken in whole numbers: nothing is lost of small counts on a large mean.
    values = np.array([float(size * count - total) for count in counts]) * (gal / (steps * max(size, 1)))
    peak = next((number("Max. Acc. (gal)", match[1]) for match in map(_PEAK.fullmatch, header) if match), None)
    return (
        Content(
            usable("Sampling Freq(Hz)", 1 / frequency),
            values,
            Unit("gal", 0.01, "Scale Factor"),
            warnings=odd_peak(peak, "gal", values),
            direction=_found(header, "Dir.", _DIRECTION)[1].strip(),
            note="mean removed",
        ),
    )


_NUMBERS = {"Sampling Freq(Hz)": _FREQUENCY, "Duration Time(s)": _DURATION}


def _found(header: Sequence[str], key: str, pattern: re.Pattern[str]) -> re.Match[str]:
    """The only line of the header that `pattern` matches."""
    return _only(key, [match for match in map(pattern.fullmatch, header) if match])


def _only(key: str, found: Sequence[Any]) -> Any:
    """The only one found of a key of the header."""
    if len(found) != 1:
        raise SceneError(key, None, "stated twice" if found else "missing from the header, or damaged", _KNET_REMEDY)
    return found[0]


def _count(at: int, token: str) -> int:
    if not _COUNT.fullmatch(token):
        raise SceneError(f"line {at}", token, "not a whole number", DAMAGED)
    return int(token)


def _check_places(lines: Sequence[str], first: int) -> None:
    """Refuse a line whose counts end elsewhere than those of the first one: a digit slipped in or was lost."""
    usual = {found.end() for found in re.finditer(r"\S+", lines[0])} if lines else set()
    for at, line in enumerate(lines, first):
        if not {found.end() for found in re.finditer(r"\S+", line)} <= usual:
            raise SceneError(f"line {at}", line, "its counts do not stand below those of the first line", DAMAGED)


_COMPONENT = re.compile(r"([^,()]+)\(gal\)", re.I)


def _knet_csv(lines: Sequence[str], asked: Asked) -> tuple[Content, ...]:
    """The `Content` of each component [gal], its offset subtracted.

    Raises
    ------
    SceneError
        A line of the header is missing, a damaged number, or times that are not those of the sampling frequency.
    """
    header = [line.strip()[1:HEADER_WIDTH] for line in lines if line.startswith("#")]
    rows = [(f"line {at}", line.split(",")) for at, line in enumerate(lines, 1) if line.strip() and line[0] != "#"]
    frequency = number("SamplingFrequency(Hz)", _below(header, "SamplingFrequency(Hz)"))
    duration = number("DurationTime(s)", _below(header, "DurationTime(s)"))
    titles = _below(header, "Offset")
    names, offsets = _COMPONENT.findall(titles), _below(header, titles).split(",")
    if not 0 < frequency or len(names) != len(offsets) or header[-1] != f"Time,RelativeTime(s),{titles}":
        raise SceneError("header", None, "no sampling frequency, or no offset of each component", _KNET_REMEDY)
    if len(rows) < 2:
        raise SceneError("record", None, f"holds {len(rows)} samples", _KNET_REMEDY)
    for name, offset in zip(names, offsets, strict=True):
        number(f"Offset, {name}", offset)
    for where, fields in rows:
        if len(fields) != 2 + len(names):
            raise SceneError(where, ",".join(fields), f"holds {len(fields)} columns, not {2 + len(names)}", DAMAGED)
        for field, first in zip(fields[1:], rows[0][1][1:], strict=True):
            number(where, field)
            if form_of(field) != form_of(first):
                raise SceneError(where, field, "not printed as the other numbers are: a damaged number", DAMAGED)
    step = uniform_step([fields[1] for _, fields in rows])
    if abs(step * frequency - 1) > SAME:
        raise SceneError("SamplingFrequency(Hz)", frequency, f"but the times have a step of {step:.9g} s", DAMAGED)
    whole = f"the header states {duration:g} s, the data have {len(rows) / frequency:g} s: check that the file is whole"
    warnings = () if len(rows) == round(duration * frequency) else (whole,)
    return tuple(
        Content(
            usable("SamplingFrequency(Hz)", 1 / frequency),
            # Taken as decimals: nothing is lost of a small motion on a large offset.
            np.array([float(exact(fields[place]) - exact(offset)) for _, fields in rows]),
            Unit("gal", 0.01, "the titles"),
            warnings=warnings,
            channel=str(place - 1),
            direction=name,
            note="offset subtracted",
        )
        for place, (name, offset) in enumerate(zip(names, offsets, strict=True), 2)
    )


def _below(header: Sequence[str], key: str) -> str:
    """The line of the header below the only one that is the key."""
    return _only(key, [after for line, after in zip(header, header[1:], strict=False) if line == key])


PEER = Format("PEER AT2", _is_peer, _peer)
DYNA = Format("ESM/DYNA 1.2 ASCII", _is_dyna, _dyna)
KNET = Format("K-NET", begun_by(re.compile("origin time ", re.I)), _knet)
KNET_CSV = Format("K-NET CSV", begun_by(re.compile(r"#\s*k-net csv\b", re.I)), _knet_csv)
