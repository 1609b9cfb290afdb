"""CSMIP, CDMG and CGS volume 2: corrected accelerations of several channels, each with header, velocity, displacement.

A. F. Shakal and M. J. Huang 1985, Standard tape format for CSMIP strong-motion data tapes, OSMS 85-03: 25 lines of
text, 100 integers in 16I5, 100 reals in 8F10, the data in 8F10, and a line /& behind each channel.
"""

import re
from collections.abc import Sequence

from ..errors import SceneError
from .content import HEADER_WIDTH, Asked, Content, begun_by
from .fixed import DAMAGED, Layout, fixed_values, stated_layout
from .numbers import NUMBER, number, odd_peak
from .statements import stated_unit
from .times import interval

NAME = "CSMIP volume 2"
FIRST = re.compile(r"\s*corrected accelerogram\b", re.I)
CHANNEL = re.compile(r"\bchan(?:nel)?\s*([0-9]{1,4})\s*:\s*(.*?)\s*(?:\bfrom\s*)?$", re.I)
DATA = re.compile(r"\s*([0-9]{1,9}) points of (accel|veloc|displ) data equally spaced at +(\S+) +([a-z]+)", re.I)
PEAK = re.compile(rf"\s*peak acceleration\s*=\s*({NUMBER})\s*cm/sec/sec\b", re.I)
END = "/&"
LAYOUT = Layout(8, 10)
REALS, STEP = 13, (7, slice(40, 50))  # lines of reals before the data; the 61st is the step
REMEDY = "give a CSMIP volume 2 file (.V2), or two columns, time [s] and acceleration"


recognises = begun_by(FIRST)


def read(lines: Sequence[str], asked: Asked) -> tuple[Content, ...]:
    """The `Content` of each channel.

    Raises
    ------
    SceneError
        A channel that is not whole, an unreadable number, or steps that contradict each other.
    """
    begins = [index for index, line in enumerate(lines) if FIRST.match(line)]
    return tuple(_channel(lines, begin, end) for begin, end in zip(begins, [*begins[1:], len(lines)], strict=True))


def _channel(lines: Sequence[str], begin: int, end: int) -> Content:
    """The `Content` of the channel whose lines are those from index `begin` up to `end`."""
    where = f"line {begin + 1}"
    named = CHANNEL.search(lines[begin][:HEADER_WIDTH].rstrip())
    if not named:
        raise SceneError(where, lines[begin].strip(), "names no channel, as Chan 1: 90 Deg", REMEDY)
    data = next((index for index in range(begin, end) if DATA.match(lines[index])), None)
    found = DATA.match(lines[data]) if data is not None else None
    if data is None or found is None or found[2].lower() != "accel":
        raise SceneError(where, None, f"no line N points of accel data follows for channel {named[1]}", REMEDY)
    values, behind = fixed_values(lines, data + 1, int(found[1]), stated_layout(lines[data][:HEADER_WIDTH]) or LAYOUT)
    if behind < end and not (DATA.match(lines[behind]) or lines[behind].startswith(END)):
        raise SceneError(f"line {data + 1}", int(found[1]), "more numbers follow than these", DAMAGED)
    if not any(line.startswith(END) for line in lines[behind:end]):
        raise SceneError(where, None, f"channel {named[1]} has no last line {END}", DAMAGED)
    peak = next((number("peak", match[1]) for match in map(PEAK.match, lines[begin:data]) if match), None)
    return Content(
        _step(lines, begin, data, found),
        values,
        stated_unit([(data + 1, lines[data][:HEADER_WIDTH])]),
        warnings=odd_peak(peak, "cm/s2", values),
        channel=str(int(named[1])),
        direction=" ".join(named[2].split()),
    )


def _step(lines: Sequence[str], begin: int, data: int, found: re.Match[str]) -> float:
    """The sampling interval [s]: the line before the data rounds to 3 decimals what the reals give to 7."""
    where = f"line {data + 1}, step"
    rounded = interval(where, found[3], found[4])
    row, columns = STEP
    text = lines[data - REALS + row][columns].strip() if data - REALS > begin else ""
    if not re.fullmatch(NUMBER, text) or number(where, text) <= 0:  # 0 and -999 stand for an unknown one
        return rounded
    exact = number(where, text)
    if abs(exact - rounded) > 0.5000001 * 10.0 ** -len(found[3].partition(".")[2]):
        raise SceneError(
            f"line {data - REALS + row + 1}, step", exact, f"but line {data + 1} says {rounded} s", DAMAGED
        )
    return interval(where, text)
