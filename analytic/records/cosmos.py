"""COSMOS format 1.20: several channels, each with text, 100 integers, 100 reals, comments and data.

COSMOS Strong-Motion Programs Board 2001, COSMOS strong motion data format, version 1.20. Of the integers the second
says what is measured; of the reals the 62nd is the step of these data [ms] (the 34th is that of the raw record), the
63rd their length [s] and the 64th their peak.
"""

import re
from collections.abc import Callable, Sequence

from ..errors import SceneError
from .content import HEADER_WIDTH, Asked, Content, begun_by
from .fixed import DAMAGED, fixed_values, stated_layout
from .numbers import number, odd_peak
from .times import usable
from .units import G, Unit, factor_of

NAME = "COSMOS"
FIRST = re.compile(r"[^(]*\(format v[0-9.]+ with ([0-9]{1,2}) text lines\)", re.I)
HEADERS = tuple(
    re.compile(rf"\s*([0-9]{{1,4}}) +{kind}-header values follow on +([0-9]{{1,3}}) +lines\b", re.I)
    for kind in ("integer", "real")
)
COMMENTS = re.compile(r"\s*([0-9]{1,4}) +comment line", re.I)
# CESMD writes no comma before the format in its files of volume 1.
DATA = re.compile(
    r"\s*([0-9]{1,9}) +([a-z]+) pts,.*?\bunits *= *([^,(]*?[^,( ]) *(?:\(0*([0-9]+) *\))? *,? *\bformat *=", re.I
)
CHANNEL = re.compile(r"\s*sta chan? *:? *([0-9]{1,4}|\?) *: *([^(]*)", re.I)
END = re.compile(r"\s*(?:end-of-data\b|/&)", re.I)
MEASURED, STEP, LENGTH, PEAK = 1, 61, 62, 63
ACCELERATION, UNKNOWN = 1, -999
CODES = {"2": G, "4": 0.01}  # of units -> m/s2
REMEDY = "give a COSMOS file of corrected accelerations (.V2c), or two columns, time [s] and acceleration"


recognises = begun_by(FIRST)


def read(lines: Sequence[str], asked: Asked) -> tuple[Content, ...]:
    """The `Content` of each channel.

    Raises
    ------
    SceneError
        A header or data that are not whole, no acceleration, or a step that contradicts the length.
    """
    begins = [index for index, line in enumerate(lines) if FIRST.match(line[:HEADER_WIDTH])]
    return tuple(
        _channel(lines, begin, end, order)
        for order, (begin, end) in enumerate(zip(begins, [*begins[1:], len(lines)], strict=True), 1)
    )


def _channel(lines: Sequence[str], begin: int, end: int, order: int) -> Content:
    """The `Content` of the channel whose lines go from index `begin` up to `end`; `order` counts the channels."""
    at = begin + int(FIRST.match(lines[begin][:HEADER_WIDTH])[1])  # type: ignore[index]  # it begins the channel
    chosen = next(
        (match for match in map(CHANNEL.match, (line[:HEADER_WIDTH] for line in lines[begin:at])) if match), None
    )
    integers, at = _header(lines, at, HEADERS[0])
    reals, at = _header(lines, at, HEADERS[1])
    comments = _match(COMMENTS, lines, at, "the count of comment lines")
    at += 1 + int(comments[1])
    data = _match(DATA, lines, at, "the line N acceleration pts, ... units=..., Format=(...)")
    where = f"line {at + 1}"
    if data[2].lower() != "acceleration" or integers(MEASURED) not in (ACCELERATION, UNKNOWN):
        raise SceneError(where, data[0].strip(), "not an acceleration", REMEDY)
    unit, layout = _unit(data, at), stated_layout(lines[at][:HEADER_WIDTH])
    if layout is None:
        raise SceneError(where, lines[at].strip(), "names no Fortran format of decimals, as (8F10.5)", REMEDY)
    values, behind = fixed_values(lines, at + 1, int(data[1]), layout)
    if behind < end and not (END.match(lines[behind]) or DATA.match(lines[behind][:HEADER_WIDTH])):
        raise SceneError(where, int(data[1]), "more numbers follow than these", DAMAGED)
    if not any(END.match(line) for line in lines[behind:end]):
        raise SceneError(where, None, "no line End-of-data follows", DAMAGED)
    stated = reals(PEAK)
    return Content(
        _step(reals(STEP), reals(LENGTH), len(values), where),
        values,
        unit,
        warnings=() if stated == UNKNOWN else odd_peak(stated, data[3], values),
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
            return UNKNOWN
        row, token = tokens[index]
        return number(f"line {row + 1}", token)

    return value, behind


def _unit(data: re.Match[str], at: int) -> Unit:
    """The `Unit` that the line before the data names, with its code in brackets."""
    factor = factor_of(data[3])
    if factor is None:
        raise SceneError(f"line {at + 1}, units", data[3], "not an acceleration", REMEDY)
    if CODES.get(data[4] or "", factor) != factor:
        raise SceneError(f"line {at + 1}, units", data[3], f"but their code is {data[4]}", "correct the wrong one")
    return Unit(data[3], factor, f"line {at + 1}")


def _step(milliseconds: float, length: float, count: int, where: str) -> float | None:
    """The sampling interval [s], None where the reals give none; `length` [s] of the record checks it."""
    if milliseconds <= 0:  # 0 and -999 stand for an unknown one
        return None
    dt = usable(f"{where}, step", milliseconds / 1000)
    if length > 0 and abs(length - count * dt) > max(0.01 * length, 2 * dt):
        problem = f"but {count} samples at the step of {dt:.6g} s, the 62nd real, last {count * dt:.6g} s"
        raise SceneError(f"{where}, length", length, problem, DAMAGED)
    return dt
