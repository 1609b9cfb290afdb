"""USGS SMC: 11 lines of text, 48 integers in 8I10, 50 reals in 5E15.7, comments, then cm/s2 in 8E10.4 or 5E14.7.

Of the integers the 16th counts the comments, the 17th the samples, the 18th flags a problem and the 47th says 8 where
the data have 7 decimals; of the reals the second is the sampling frequency, the 30th and the 32nd are maximum and
minimum. U.S. Geological Survey Open-File Report 92-296 and D. M. Boore's SMCWrite.
"""

import re
from collections.abc import Sequence

from ..errors import SceneError
from .content import HEADER_WIDTH, Asked, Content, begun_by
from .fixed import DAMAGED, Layout, fixed_values
from .numbers import number, odd_peak
from .times import usable
from .units import Unit

NAME = "USGS SMC"
FIRST = re.compile(r"\s*[0-9] +(?:(?:un)?corrected +)?(accelerogram|velocity|displacement|response spectra)\b", re.I)
TEXT, INTEGERS, REALS = 11, (6, 8), (10, 5)  # lines, and numbers a line
COMMENTS, SAMPLES, PROBLEM, PRECISION = 15, 16, 17, 46
FREQUENCY, EXTREMES = 1, (29, 31)
LAYOUTS = {True: Layout(5, 14, 7), False: Layout(8, 10, 4)}
LARGEST = 1e30  # 1.7e38 stands for an unknown real


recognises = begun_by(FIRST)


def read(lines: Sequence[str], asked: Asked) -> tuple[Content, ...]:
    """The `Content` of the one channel.

    Raises
    ------
    SceneError
        No acceleration, uneven times, a header or data that are not whole.
    """
    begin = next(index for index, line in enumerate(lines) if line.strip())
    kind = FIRST.match(lines[begin][:HEADER_WIDTH])[1].lower()  # type: ignore[index]  # `recognises` found it
    if kind != "accelerogram":
        raise SceneError(f"line {begin + 1}", kind, "not an acceleration", "give the accelerogram of this record")
    at = begin + TEXT
    integers, at = _table(lines, at, *INTEGERS)
    reals, at = _table(lines, at, *REALS)
    comments, count, precision = (_whole(integers[index]) for index in (COMMENTS, SAMPLES, PRECISION))
    frequency = reals[FREQUENCY]
    if not 0 < frequency < LARGEST:
        raise SceneError(
            "the second real", frequency, "no sampling frequency: the file has uneven times", "give the corrected file"
        )
    at += max(comments, 0)
    values, behind = fixed_values(lines, at, count, LAYOUTS[precision == 8])
    if any(line.strip() for line in lines[behind:]):
        raise SceneError("the 17th integer", count, "more numbers follow than these", DAMAGED)
    warnings = ("its header flags a problem: see its comments",) if integers[PROBLEM] == 1 else ()
    peak = max((abs(reals[index]) for index in EXTREMES if abs(reals[index]) < LARGEST), default=None)
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
