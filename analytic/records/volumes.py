"""Formats whose numbers stand in columns of equal width, as a Fortran format prints them: CSMIP, COSMOS and SMC.

They are cut by position, not by blanks: numbers that fill their columns touch each other. A missing or an additional
character shifts all that follows, which is detected.

CSMIP, CDMG and CGS volume 2: A. F. Shakal and M. J. Huang 1985, Standard tape format for CSMIP strong-motion data
tapes, OSMS 85-03. Of each channel 25 lines of text, 100 integers in 16I5, 100 reals in 8F10, the data in 8F10 (velocity
and displacement follow), and a line /&.

COSMOS: Strong-Motion Programs Board 2001, COSMOS strong motion data format, version 1.20. Of each channel text, 100
integers, 100 reals, comments and data. Of the integers the second says what is measured; of the reals the 62nd is the
step of these data [ms] (the 34th is that of the raw record), the 63rd their length [s] and the 64th their peak.

USGS SMC: Open-File Report 92-296 and D. M. Boore's SMCWrite. 11 lines of text, 48 integers in 8I10, 50 reals in 5E15.7,
comments, then cm/s2 in 8E10.4 or 5E14.7. Of the integers the 16th counts the comments, the 17th the samples, the 18th
flags a problem and the 47th says 8 where the data have 7 decimals; of the reals the second is the sampling frequency,
the 30th and the 32nd are maximum and minimum.
"""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ..errors import SceneError
from .content import DAMAGED, HEADER_WIDTH, Asked, Content, Format, begun_by
from .numbers import NUMBER, form_of, number, odd_peak
from .statements import stated_unit
from .times import interval, usable
from .units import G, Unit, factor_of

_FORMAT = re.compile(r"\( *([1-9][0-9]?) *[A-Z]{1,2}([1-9][0-9]?)\.([0-9]{1,2})(?:E[0-9]?)? *\)", re.I)


@dataclass(frozen=True)
class Layout:
    """Numbers a line, characters of each, and its digits after the point (None: as many as the first one has)."""

    per_line: int
    width: int
    decimals: int | None = None


def stated_layout(line: str) -> Layout | None:
    """The `Layout` of the last Fortran format in brackets that a line holds, (8F10.5); None without one."""
    found = _FORMAT.findall(line)
    return Layout(*(int(part) for part in found[-1])) if found else None


def fixed_values(lines: Sequence[str], begin: int, count: int, layout: Layout) -> tuple[np.ndarray, int]:
    """(`count` numbers from the line of index `begin` on, index of the next line that is not blank).

    Raises
    ------
    SceneError
        A line that is not full (the last one may hold fewer numbers), what is not a number that ends where its column
        ends, or other digits after the point; names the line.
    """
    values: list[float] = []
    usual, at = None, begin
    while len(values) < count:
        wanted = min(layout.per_line, count - len(values))
        text = lines[at].rstrip(" ") if at < len(lines) else ""
        where = f"line {at + 1}"
        if len(text) != wanted * layout.width:
            problem = f"not {wanted} numbers of {layout.width} characters; {count} samples are stated"
            raise SceneError(where, text, problem, DAMAGED)
        for left in range(0, len(text), layout.width):
            field = text[left : left + layout.width].lstrip(" ")
            values.append(number(where, field))
            found = form_of(field)
            usual = found if usual is None else usual
            if found is None or found != usual or layout.decimals not in (None, found[0]):
                raise SceneError(where, field, "not printed as the other numbers are: a damaged number", DAMAGED)
        at += 1
    return np.array(values), next((index for index in range(at, len(lines)) if lines[index].strip()), len(lines))


_END = re.compile(r"\s*(?:end-of-data\b|/&)", re.I)  # the last line of a channel


def _by_channel(name: str, first: re.Pattern[str], channel: Callable[..., Content]) -> Format:
    """The `Format` of files of several channels, each of which begins with a line of the pattern `first`."""

    def read(lines: Sequence[str], asked: Asked) -> tuple[Content, ...]:
        begins = [index for index, line in enumerate(lines) if first.match(line[:HEADER_WIDTH])]
        ends = [*begins[1:], len(lines)]
        return tuple(channel(lines, *place) for place in zip(begins, ends, range(1, len(ends) + 1), strict=True))

    return Format(name, begun_by(first), read)


def _data(
    lines: Sequence[str], at: int, end: int, count: int, layout: Layout, announced: re.Pattern[str]
) -> np.ndarray:
    """The `count` numbers below the line of index `at`, of a channel that goes up to `end`: further data, which a line
    of the pattern `announced` precedes, or the channel's last line follow."""
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
    """The `Content` of the channel whose lines are those from index `begin` up to `end`.

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
    found = _CSMIP_DATA.match(lines[data]) if data is not None else None
    if data is None or found is None or found[2].lower() != "accel":
        raise SceneError(where, None, f"no line N points of accel data follows for channel {named[1]}", _CSMIP_REMEDY)
    layout = stated_layout(lines[data][:HEADER_WIDTH]) or _CSMIP_LAYOUT
    values = _data(lines, data, end, int(found[1]), layout, _CSMIP_DATA)
    peak = next((number("peak", match[1]) for match in map(_CSMIP_PEAK.match, lines[begin:data]) if match), None)
    return Content(
        _csmip_step(lines, begin, data, found),
        values,
        stated_unit([(data + 1, lines[data][:HEADER_WIDTH])]),
        warnings=odd_peak(peak, "cm/s2", values),
        channel=str(int(named[1])),
        direction=" ".join(named[2].split()),
    )


def _csmip_step(lines: Sequence[str], begin: int, data: int, found: re.Match[str]) -> float:
    """The sampling interval [s]: the line before the data rounds to 3 decimals what the reals give to 7."""
    where = f"line {data + 1}, step"
    rounded = interval(where, found[3], found[4])
    row, columns = _CSMIP_STEP
    text = lines[data - _CSMIP_REALS + row][columns].strip() if data - _CSMIP_REALS > begin else ""
    if not re.fullmatch(NUMBER, text) or number(where, text) <= 0:  # 0 and -999 stand for an unknown one
        return rounded
    exact = number(where, text)
    if abs(exact - rounded) > 0.5000001 * 10.0 ** -len(found[3].partition(".")[2]):
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
_MEASURED, _STEP, _LENGTH, _PEAK = 1, 61, 62, 63
_ACCELERATION, _UNKNOWN = 1, -999
_CODES = {"2": G, "4": 0.01}  # of units -> m/s2
_COSMOS_REMEDY = "give a COSMOS file of corrected accelerations (.V2c), or two columns, time [s] and acceleration"


def _cosmos_channel(lines: Sequence[str], begin: int, end: int, order: int) -> Content:
    """The `Content` of the channel whose lines go from index `begin` up to `end`; `order` counts the channels.

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
    if data[2].lower() != "acceleration" or integers(_MEASURED) not in (_ACCELERATION, _UNKNOWN):
        raise SceneError(where, data[0].strip(), "not an acceleration", _COSMOS_REMEDY)
    unit, layout = _unit(data, at), stated_layout(lines[at][:HEADER_WIDTH])
    if layout is None:
        raise SceneError(where, lines[at].strip(), "names no Fortran format of decimals, as (8F10.5)", _COSMOS_REMEDY)
    values = _data(lines, at, end, int(data[1]), layout, _COSMOS_DATA)
    stated = reals(_PEAK)
    return Content(
        _cosmos_step(reals(_STEP), reals(_LENGTH), len(values), where),
        values,
        unit,
        warnings=() if stated == _UNKNOWN else odd_peak(stated, data[3], values),
        channel=chosen[1] if chosen and chosen[1] != "?" else str(order),
        direction=" ".join(chosen[2].split()) if chosen else "",
    )


def _match(pattern: re.Pattern[str], lines: Sequence[str], at: int, wanted: str) -> re.Match[str]:
    found = pattern.match(lines[at][:HEADER_WIDTH]) if at < len(lines) else None
    if not found:
        raise SceneError(f"line {at + 1}", lines[at].strip() if at < len(lines) else None, f"not {wanted}", DAMAGED)
    return found


def _header(lines: Sequence[str], at: int, pattern: re.Pattern[str]) -> tuple[Callable[[int], float], int]:
    """(function that gives the number of an index, index of the line behind) of the header at the line of index `at`.

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
    """The `Unit` that the line before the data names, with its code in brackets."""
    factor = factor_of(data[3])
    if factor is None:
        raise SceneError(f"line {at + 1}, units", data[3], "not an acceleration", _COSMOS_REMEDY)
    if _CODES.get(data[4] or "", factor) != factor:
        raise SceneError(f"line {at + 1}, units", data[3], f"but their code is {data[4]}", "correct the wrong one")
    return Unit(data[3], factor, f"line {at + 1}")


def _cosmos_step(milliseconds: float, length: float, count: int, where: str) -> float | None:
    """The sampling interval [s], None where the reals give none; `length` [s] of the record checks it."""
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
_FREQUENCY, _EXTREMES = 1, (29, 31)
_SMC_LAYOUTS = {True: Layout(5, 14, 7), False: Layout(8, 10, 4)}
_LARGEST = 1e30  # 1.7e38 stands for an unknown real


def _smc(lines: Sequence[str], asked: Asked) -> tuple[Content, ...]:
    """The `Content` of the one channel.

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
    frequency = reals[_FREQUENCY]
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
    """(numbers of a header, index of the line behind)."""
    found: list[float] = []
    for index in range(at, at + rows):
        tokens = lines[index].split() if index < len(lines) else []
        if len(tokens) != per_row:
            raise SceneError(f"line {index + 1}", " ".join(tokens), f"not {per_row} header values", DAMAGED)
        found += [number(f"line {index + 1}", token) for token in tokens]
    return found, at + rows


CSMIP = _by_channel("CSMIP volume 2", _CSMIP, _csmip_channel)
COSMOS = _by_channel("COSMOS", _COSMOS, _cosmos_channel)
SMC = Format("USGS SMC", begun_by(_SMC), _smc)
