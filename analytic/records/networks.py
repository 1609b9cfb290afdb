"""Formats of databases and networks: PEER AT2, ESM/DYNA, K-NET, CSMIP, COSMOS, SMC.

Blanks or commas part the numbers of the first three.

PEER AT2, the old and the new headers: values in columns of Fortran after a line with NPTS and DT. ESM/DYNA 1.2 ASCII,
also as AFAD writes it: lines KEY: value, then one value a line. NIED's K-NET and KiK-net ASCII: 17 lines of header,
then counts; acceleration = (count - mean of all) times scale factor. K-NET CSV: a header of lines that begin with #,
then a time stamp, a time [s] and three components [gal] a line, whose offsets the header states.

The numbers of the others stand in columns of equal width, as a Fortran format prints them. They are cut by position,
not by blanks: numbers that fill their columns touch each other. A missing or an additional character shifts all that
follows, which is detected.

CSMIP, CDMG and CGS volume 2: A. F. Shakal and M. J. Huang 1985, Standard tape format for CSMIP strong-motion data
tapes, OSMS 85-03. Each channel has 25 lines of text, 100 integers in 16I5, 100 reals in 8F10, the data in 8F10
(velocity and displacement follow), and a line /&.

COSMOS: Strong-Motion Programs Board 2001, COSMOS strong motion data format, version 1.20. Each channel has text, 100
integers, 100 reals, comments and data. The second integer says what is measured. The 62nd real is the step of these
data [ms] (the 34th is that of the raw record), the 63rd their length [s] and the 64th their peak.

USGS SMC: Open-File Report 92-296 and D. M. Boore's SMCWrite. 11 lines of text, 48 integers in 8I10, 50 reals in 5E15.7,
comments, then cm/s2 in 8E10.4 or 5E14.7. The 16th integer counts the comments, the 17th the samples, the 18th flags a
problem and the 47th is 8 where the data have 7 decimals. The second real is the sampling frequency, the 30th and the
32nd are maximum and minimum.
"""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import SceneError
from .content import DAMAGED, HEADER_WIDTH, MARK, Content, Format, Given, begun_by, first_of
from .notation import (
    NUMBER,
    SAME,
    G,
    Unit,
    check_count,
    count,
    exact,
    factor_of,
    form_of,
    fortran_values,
    interval,
    number,
    odd_peak,
    uniform_step,
    usable,
)
from .statements import read_statements, stated_unit

_PEER_LINES = 8  # the NPTS line is the fourth in every known variant

_NPTS = re.compile(r"\bNPTS\s*[=:]\s*([^\s,;]*)", re.I)
_DT = re.compile(r"\bDT\s*(?:[(\[]\s*[a-z]*\s*[)\]]\s*)?[=:]", re.I)
_OLD = re.compile(rf"\s*([0-9]+)[\s,]+({NUMBER})[\s,]+NPTS[\s,]+DT\b(?!\s*[=:])(?:\s*[(\[]\s*([a-z]*))?", re.I)


def _is_peer(lines: Sequence[str]) -> bool:
    """Return whether the lines are a PEER AT2 file."""
    return _peer_head(lines) is not None


def _peer(lines: Sequence[str], given: Given) -> tuple[Content, ...]:
    """Return the `Content` of a PEER AT2 file.

    Raises
    ------
    SceneError
        No acceleration, an unreadable number, or another count than stated.
    """
    head, npts, old_form = _peer_head(lines)  # type: ignore[misc]  # `_is_peer` found it
    where = f"line {head + 1}"
    numbered = [(at, line[:HEADER_WIDTH]) for at, line in enumerate(lines[: head + 1], 1)]
    if old_form:
        numbered[-1] = head + 1, f"dt = {old_form[2]} {old_form[3] or ''}"
    statements = read_statements(numbered)
    marked = MARK.fullmatch("".join(lines[head + 1 : head + 2])[:HEADER_WIDTH])
    values = fortran_values(lines, head + (2 if marked else 1))
    check_count(f"{where}, NPTS", count(f"{where}, NPTS", npts), values)
    return (Content(statements.step, values, stated_unit(statements.rest, titles=head)),)


def _peer_head(lines: Sequence[str]) -> tuple[int, str, re.Match[str] | None] | None:
    """Return (index of the line with count and step, the count as printed, match of a line of the old form)."""
    for index, line in enumerate(lines[:_PEER_LINES]):
        line = line[:HEADER_WIDTH]
        if old_form := _OLD.match(line):
            return index, old_form[1], old_form
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
    """Return whether the lines are an ESM/DYNA file."""
    return bool(_DYNA_KEY.match(first_of(lines))) and any(line.startswith(_DYNA_SIGNS) for line in lines[:_DYNA_LINES])


def _dyna(lines: Sequence[str], given: Given) -> tuple[Content, ...]:
    """Return the `Content` of an ESM/DYNA file.

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
    """Return {key: (value, line number)} and the index of the first line after them."""
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


def _knet(lines: Sequence[str], given: Given) -> tuple[Content, ...]:
    """Return the `Content` of the one channel [gal], its mean removed.

    Raises
    ------
    SceneError
        A line of the header is missing, a count is no whole number, or there are not as many as duration and frequency
        make.
    """
    end = next((index for index, line in enumerate(lines[:_KNET_LINES]) if line.lower().startswith("memo.")), None)
    if end is None:
        raise SceneError("Memo.", None, "missing from the header", _KNET_REMEDY)
    header = [line[:HEADER_WIDTH] for line in lines[:end]]
    frequency, duration = (number(key, _only_match(header, key, by)[1]) for key, by in _NUMBERS.items())
    scale = _only_match(header, "Scale Factor", _SCALE)
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
            direction=_only_match(header, "Dir.", _DIRECTION)[1].strip(),
            note="mean removed",
        ),
    )


_NUMBERS = {"Sampling Freq(Hz)": _FREQUENCY, "Duration Time(s)": _DURATION}


def _only_match(header: Sequence[str], key: str, pattern: re.Pattern[str]) -> re.Match[str]:
    """Return the match of the only line of the header that has the pattern."""
    return _only(key, [match for match in map(pattern.fullmatch, header) if match])


def _only(key: str, matches: Sequence[Any]) -> Any:
    """Return the only match of a key of the header."""
    if len(matches) != 1:
        raise SceneError(key, None, "stated twice" if matches else "missing from the header, or damaged", _KNET_REMEDY)
    return matches[0]


def _count(at: int, token: str) -> int:
    if not _COUNT.fullmatch(token):
        raise SceneError(f"line {at}", token, "not a whole number", DAMAGED)
    return int(token)


def _check_places(lines: Sequence[str], first: int) -> None:
    """Refuse a line whose counts end elsewhere than those of the first one: a digit slipped in or was lost."""
    usual = {match.end() for match in re.finditer(r"\S+", lines[0])} if lines else set()
    for at, line in enumerate(lines, first):
        if not {match.end() for match in re.finditer(r"\S+", line)} <= usual:
            raise SceneError(f"line {at}", line, "its counts do not stand below those of the first line", DAMAGED)


_COMPONENT = re.compile(r"([^,()]+)\(gal\)", re.I)


def _knet_csv(lines: Sequence[str], given: Given) -> tuple[Content, ...]:
    """Return the `Content` of each component [gal], its offset subtracted.

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
    lasts = f"the header states {duration:g} s, the data have {len(rows) / frequency:g} s"
    warnings = () if len(rows) == round(duration * frequency) else (f"{lasts}: check that the file is whole",)
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
    """Return the line of the header below the only one that is the key."""
    return _only(key, [after for line, after in zip(header, header[1:], strict=False) if line == key])


PEER = Format("PEER AT2", _is_peer, _peer)
DYNA = Format("ESM/DYNA 1.2 ASCII", _is_dyna, _dyna)
KNET = Format("K-NET", begun_by(re.compile("origin time ", re.I)), _knet)
KNET_CSV = Format("K-NET CSV", begun_by(re.compile(r"#\s*k-net csv\b", re.I)), _knet_csv)


_FORMAT = re.compile(r"\( *([1-9][0-9]?) *[A-Z]{1,2}([1-9][0-9]?)\.([0-9]{1,2})(?:E[0-9]?)? *\)", re.I)


@dataclass(frozen=True)
class Layout:
    """Numbers a line, characters of each, and its digits after the point (None: as many as the first one has)."""

    per_line: int
    width: int
    decimals: int | None = None


def stated_layout(line: str) -> Layout | None:
    """Return the `Layout` of the last Fortran format in brackets that a line holds, (8F10.5); None without one."""
    formats = _FORMAT.findall(line)
    return Layout(*(int(part) for part in formats[-1])) if formats else None


def fixed_values(lines: Sequence[str], begin: int, count: int, layout: Layout) -> tuple[np.ndarray, int]:
    """Return (`count` numbers from the line of index `begin` on, index of the next line that is not blank).

    Raises
    ------
    SceneError
        A line that is not full (the last one may hold fewer numbers), a field that is not a number ending where its
        column ends, or other digits after the point; names the line.
    """
    values: list[float] = []
    usual, at = None, begin
    while len(values) < count:
        expected = min(layout.per_line, count - len(values))
        text = lines[at].rstrip(" ") if at < len(lines) else ""
        where = f"line {at + 1}"
        if len(text) != expected * layout.width:
            problem = f"not {expected} numbers of {layout.width} characters; {count} samples are stated"
            raise SceneError(where, text, problem, DAMAGED)
        for left in range(0, len(text), layout.width):
            field = text[left : left + layout.width].lstrip(" ")
            values.append(number(where, field))
            form = form_of(field)
            usual = form if usual is None else usual
            if form is None or form != usual or layout.decimals not in (None, form[0]):
                raise SceneError(where, field, "not printed as the other numbers are: a damaged number", DAMAGED)
        at += 1
    return np.array(values), next((index for index in range(at, len(lines)) if lines[index].strip()), len(lines))


_END = re.compile(r"\s*(?:end-of-data\b|/&)", re.I)  # the last line of a channel


def _by_channel(name: str, first: re.Pattern[str], channel: Callable[..., Content]) -> Format:
    """Return the `Format` of files of several channels, each of which begins with a line of the pattern `first`."""

    def read(lines: Sequence[str], given: Given) -> tuple[Content, ...]:
        begins = [index for index, line in enumerate(lines) if first.match(line[:HEADER_WIDTH])]
        ends = [*begins[1:], len(lines)]
        return tuple(channel(lines, *place) for place in zip(begins, ends, range(1, len(ends) + 1), strict=True))

    return Format(name, begun_by(first), read)


def _data(
    lines: Sequence[str], at: int, end: int, count: int, layout: Layout, announced: re.Pattern[str]
) -> np.ndarray:
    """Return the `count` numbers below the line of index `at`, in a channel that goes up to `end`.

    The channel's last line follows them, or further data, which a line of the pattern `announced` precedes.
    """
    values, behind = fixed_values(lines, at + 1, count, layout)
    if behind < end and not (announced.match(lines[behind][:HEADER_WIDTH]) or _END.match(lines[behind])):
        raise SceneError(f"line {at + 1}", count, "more numbers follow than these", DAMAGED)
    if not any(_END.match(line) for line in lines[behind:end]):
        raise SceneError(f"line {at + 1}", None, "no line that ends the channel follows", DAMAGED)
    return values


_CSMIP = re.compile(r"\s*corrected accelerogram\b", re.I)
_CSMIP_CHANNEL = re.compile(r"\bchan(?:nel)?\s*([0-9]{1,4})\s*:\s*(.*?)\s*(?:\bfrom\s*)?$", re.I)
_CSMIP_DATA = re.compile(r"\s*([0-9]{1,9}) points of (accel|veloc|displ) data equally spaced at +(\S+) +([a-z]+)", re.I)
_CSMIP_PEAK = re.compile(rf"\s*peak acceleration\s*=\s*({NUMBER})\s*cm/sec/sec\b", re.I)
_CSMIP_LAYOUT = Layout(8, 10)
_CSMIP_REALS, _CSMIP_STEP = 13, (7, slice(40, 50))  # lines of reals before the data; the 61st is the step
_CSMIP_REMEDY = "give a CSMIP volume 2 file (.V2), or two columns, time [s] and acceleration"


def _csmip_channel(lines: Sequence[str], begin: int, end: int, order: int) -> Content:
    """Return the `Content` of the channel whose lines are those from index `begin` up to `end`.

    Raises
    ------
    SceneError
        It is not whole, holds an unreadable number, or its steps contradict each other.
    """
    where = f"line {begin + 1}"
    named = _CSMIP_CHANNEL.search(lines[begin][:HEADER_WIDTH].rstrip())
    if not named:
        raise SceneError(where, lines[begin].strip(), "names no channel, as Chan 1: 90 Deg", _CSMIP_REMEDY)
    data = next((index for index in range(begin, end) if _CSMIP_DATA.match(lines[index])), None)
    data_line = _CSMIP_DATA.match(lines[data]) if data is not None else None
    if data is None or data_line is None or data_line[2].lower() != "accel":
        raise SceneError(where, None, f"no line N points of accel data follows for channel {named[1]}", _CSMIP_REMEDY)
    layout = stated_layout(lines[data][:HEADER_WIDTH]) or _CSMIP_LAYOUT
    values = _data(lines, data, end, int(data_line[1]), layout, _CSMIP_DATA)
    peak = next((number("peak", match[1]) for match in map(_CSMIP_PEAK.match, lines[begin:data]) if match), None)
    return Content(
        _csmip_step(lines, begin, data, data_line),
        values,
        stated_unit([(data + 1, lines[data][:HEADER_WIDTH])]),
        warnings=odd_peak(peak, "cm/s2", values),
        channel=str(int(named[1])),
        direction=" ".join(named[2].split()),
    )


def _csmip_step(lines: Sequence[str], begin: int, data: int, data_line: re.Match[str]) -> float:
    """Return the sampling interval [s]: the line before the data rounds to 3 decimals what the reals give to 7."""
    where = f"line {data + 1}, step"
    rounded = interval(where, data_line[3], data_line[4])
    row, columns = _CSMIP_STEP
    text = lines[data - _CSMIP_REALS + row][columns].strip() if data - _CSMIP_REALS > begin else ""
    if not re.fullmatch(NUMBER, text) or number(where, text) <= 0:  # 0 and -999 stand for an unknown one
        return rounded
    exact = number(where, text)
    if abs(exact - rounded) > 0.5000001 * 10.0 ** -len(data_line[3].partition(".")[2]):
        raise SceneError(
            f"line {data - _CSMIP_REALS + row + 1}, step", exact, f"but line {data + 1} says {rounded} s", DAMAGED
        )
    return interval(where, text)


_COSMOS = re.compile(r"[^(]*\(format v[0-9.]+ with ([0-9]{1,2}) text lines\)", re.I)
_COSMOS_HEADERS = tuple(
    re.compile(rf"\s*([0-9]{{1,4}}) +{kind}-header values follow on +([0-9]{{1,3}}) +lines\b", re.I)
    for kind in ("integer", "real")
)
_COSMOS_COMMENTS = re.compile(r"\s*([0-9]{1,4}) +comment line", re.I)
# CESMD writes no comma before the format in its files of volume 1.
_COSMOS_DATA = re.compile(
    r"\s*([0-9]{1,9}) +([a-z]+) pts,.*?\bunits *= *([^,(]*?[^,( ]) *(?:\(0*([0-9]+) *\))? *,? *\bformat *=", re.I
)
_COSMOS_CHANNEL = re.compile(r"\s*sta chan? *:? *([0-9]{1,4}|\?) *: *([^(]*)", re.I)
_MEASURED_LINE, _STEP_LINE, _LENGTH_LINE, _PEAK_LINE = 1, 61, 62, 63
_ACCELERATION, _UNKNOWN = 1, -999
_CODES = {"2": G, "4": 0.01}  # of units -> m/s2
_COSMOS_REMEDY = "give a COSMOS file of corrected accelerations (.V2c), or two columns, time [s] and acceleration"


def _cosmos_channel(lines: Sequence[str], begin: int, end: int, order: int) -> Content:
    """Return the `Content` of the channel whose lines go from index `begin` up to `end`; `order` counts the channels.

    Raises
    ------
    SceneError
        A header or data that are not whole, no acceleration, or a step that contradicts the length.
    """
    at = begin + int(_COSMOS.match(lines[begin][:HEADER_WIDTH])[1])  # type: ignore[index]  # it begins the channel
    chosen = next(
        (match for match in map(_COSMOS_CHANNEL.match, (line[:HEADER_WIDTH] for line in lines[begin:at])) if match),
        None,
    )
    integers, at = _header(lines, at, _COSMOS_HEADERS[0])
    reals, at = _header(lines, at, _COSMOS_HEADERS[1])
    comments = _match(_COSMOS_COMMENTS, lines, at, "the count of comment lines")
    at += 1 + int(comments[1])
    data = _match(_COSMOS_DATA, lines, at, "the line N acceleration pts, ... units=..., Format=(...)")
    where = f"line {at + 1}"
    if data[2].lower() != "acceleration" or integers(_MEASURED_LINE) not in (_ACCELERATION, _UNKNOWN):
        raise SceneError(where, data[0].strip(), "not an acceleration", _COSMOS_REMEDY)
    unit, layout = _unit(data, at), stated_layout(lines[at][:HEADER_WIDTH])
    if layout is None:
        raise SceneError(where, lines[at].strip(), "names no Fortran format of decimals, as (8F10.5)", _COSMOS_REMEDY)
    values = _data(lines, at, end, int(data[1]), layout, _COSMOS_DATA)
    stated = reals(_PEAK_LINE)
    return Content(
        _cosmos_step(reals(_STEP_LINE), reals(_LENGTH_LINE), len(values), where),
        values,
        unit,
        warnings=() if stated == _UNKNOWN else odd_peak(stated, data[3], values),
        channel=chosen[1] if chosen and chosen[1] != "?" else str(order),
        direction=" ".join(chosen[2].split()) if chosen else "",
    )


def _match(pattern: re.Pattern[str], lines: Sequence[str], at: int, expected: str) -> re.Match[str]:
    match = pattern.match(lines[at][:HEADER_WIDTH]) if at < len(lines) else None
    if not match:
        raise SceneError(f"line {at + 1}", lines[at].strip() if at < len(lines) else None, f"not {expected}", DAMAGED)
    return match


def _header(lines: Sequence[str], at: int, pattern: re.Pattern[str]) -> tuple[Callable[[int], float], int]:
    """Return (function that gives the number of an index, index of the line behind) of the header at the line `at`.

    Only the numbers asked for are read: networks fill in what they have.
    """
    stated = _match(pattern, lines, at, "the count of header values")
    behind = at + 1 + int(stated[2])
    tokens = [(row, token) for row in range(at + 1, min(behind, len(lines))) for token in lines[row].split()]
    if len(tokens) != int(stated[1]):
        raise SceneError(f"line {at + 1}", int(stated[1]), f"but {len(tokens)} header values follow", DAMAGED)

    def value(index: int) -> float:
        if index >= len(tokens):
            return _UNKNOWN
        row, token = tokens[index]
        return number(f"line {row + 1}", token)

    return value, behind


def _unit(data: re.Match[str], at: int) -> Unit:
    """Return the `Unit` that the line before the data names, with its code in brackets."""
    factor = factor_of(data[3])
    if factor is None:
        raise SceneError(f"line {at + 1}, units", data[3], "not an acceleration", _COSMOS_REMEDY)
    if _CODES.get(data[4] or "", factor) != factor:
        raise SceneError(f"line {at + 1}, units", data[3], f"but their code is {data[4]}", "correct the wrong one")
    return Unit(data[3], factor, f"line {at + 1}")


def _cosmos_step(milliseconds: float, length: float, count: int, where: str) -> float | None:
    """Return the sampling interval [s], None where the reals give none; `length` [s] of the record checks it."""
    if milliseconds <= 0:  # 0 and -999 stand for an unknown one
        return None
    dt = usable(f"{where}, step", milliseconds / 1000)
    if length > 0 and abs(length - count * dt) > max(0.01 * length, 2 * dt):
        problem = f"but {count} samples at the step of {dt:.6g} s, the 62nd real, last {count * dt:.6g} s"
        raise SceneError(f"{where}, length", length, problem, DAMAGED)
    return dt


_SMC = re.compile(r"\s*[0-9] +(?:(?:un)?corrected +)?(accelerogram|velocity|displacement|response spectra)\b", re.I)
_TEXT, _INTEGERS, _REALS = 11, (6, 8), (10, 5)  # lines, and numbers a line
_COMMENTS, _SAMPLES, _PROBLEM, _PRECISION = 15, 16, 17, 46
_SMC_FREQUENCY, _EXTREMES = 1, (29, 31)
_SMC_LAYOUTS = {True: Layout(5, 14, 7), False: Layout(8, 10, 4)}
_LARGEST = 1e30  # 1.7e38 stands for an unknown real


def _smc(lines: Sequence[str], given: Given) -> tuple[Content, ...]:
    """Return the `Content` of the one channel.

    Raises
    ------
    SceneError
        No acceleration, uneven times, a header or data that are not whole.
    """
    begin = next(index for index, line in enumerate(lines) if line.strip())
    kind = _SMC.match(lines[begin][:HEADER_WIDTH])[1].lower()  # type: ignore[index]  # `recognises` found it
    if kind != "accelerogram":
        raise SceneError(f"line {begin + 1}", kind, "not an acceleration", "give the accelerogram of this record")
    at = begin + _TEXT
    integers, at = _table(lines, at, *_INTEGERS)
    reals, at = _table(lines, at, *_REALS)
    comments, count, precision = (_whole(integers[index]) for index in (_COMMENTS, _SAMPLES, _PRECISION))
    frequency = reals[_SMC_FREQUENCY]
    if not 0 < frequency < _LARGEST:
        raise SceneError(
            "the second real", frequency, "no sampling frequency: the file has uneven times", "give the corrected file"
        )
    at += max(comments, 0)
    values, behind = fixed_values(lines, at, count, _SMC_LAYOUTS[precision == 8])
    if any(line.strip() for line in lines[behind:]):
        raise SceneError("the 17th integer", count, "more numbers follow than these", DAMAGED)
    warnings = ("its header flags a problem: see its comments",) if integers[_PROBLEM] == 1 else ()
    peak = max((abs(reals[index]) for index in _EXTREMES if abs(reals[index]) < _LARGEST), default=None)
    return (
        Content(
            usable("the second real", 1 / frequency),
            values,
            Unit("cm/s2", 0.01, "as SMC has it"),
            warnings=warnings + odd_peak(peak, "cm/s2", values),
        ),
    )


def _whole(value: float) -> int:
    if value != int(value):
        raise SceneError("integers of the header", value, "not a whole number", DAMAGED)
    return int(value)


def _table(lines: Sequence[str], at: int, rows: int, per_row: int) -> tuple[list[float], int]:
    """Return (numbers of a header, index of the line behind)."""
    numbers: list[float] = []
    for index in range(at, at + rows):
        tokens = lines[index].split() if index < len(lines) else []
        if len(tokens) != per_row:
            raise SceneError(f"line {index + 1}", " ".join(tokens), f"not {per_row} header values", DAMAGED)
        numbers += [number(f"line {index + 1}", token) for token in tokens]
    return numbers, at + rows


CSMIP = _by_channel("CSMIP volume 2", _CSMIP, _csmip_channel)
COSMOS = _by_channel("COSMOS", _COSMOS, _cosmos_channel)
SMC = Format("USGS SMC", begun_by(_SMC), _smc)
