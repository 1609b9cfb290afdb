"""K-NET and KiK-net ASCII: 17 lines of header, then counts; the scale factor makes gals of them, the mean is removed.

NIED strong-motion seismograph networks, K-NET ASCII format: acceleration = (count - mean of all) times scale factor.
"""

import re
from collections.abc import Sequence

import numpy as np

from ..errors import SceneError
from .content import HEADER_WIDTH, Asked, Content, begun_by
from .fixed import DAMAGED
from .numbers import NUMBER, number, odd_peak
from .times import usable
from .units import Unit

NAME = "K-NET"
FIRST = re.compile("origin time ", re.I)
HEADER_LINES = 30  # 17 in every known file
SCALE = re.compile(r"Scale Factor *([0-9]{1,9}(?:\.[0-9]*)?) *\(gal\) */ *([0-9]{1,12}(?:\.[0-9]*)?) *", re.I)
FREQUENCY = re.compile(r"Sampling Freq *\(Hz\) *([0-9]{1,6}(?:\.[0-9]*)?) *(?:Hz)? *", re.I)
DURATION = re.compile(r"Duration Time *\(s\) *([0-9]{1,6}(?:\.[0-9]*)?) *", re.I)
DIRECTION = re.compile(r"Dir\. *(.*)", re.I)
PEAK = re.compile(rf"Max\. Acc\. *\(gal\) *({NUMBER}) *", re.I)
COUNT = re.compile(r"[+-]?[0-9]{1,9}")
REMEDY = "give the ASCII file as the network sends it"


recognises = begun_by(FIRST)


def read(lines: Sequence[str], asked: Asked) -> tuple[Content, ...]:
    """The `Content` of the one channel [gal], its mean removed.

    Raises
    ------
    SceneError
        A line of the header is missing, what is no whole number, or another count than duration and frequency make.
    """
    end = next((index for index, line in enumerate(lines[:HEADER_LINES]) if line.lower().startswith("memo.")), None)
    if end is None:
        raise SceneError("Memo.", None, "missing from the header", REMEDY)
    header = [line[:HEADER_WIDTH] for line in lines[:end]]
    frequency, duration = (number(key, _found(header, key, by)[1]) for key, by in _NUMBERS.items())
    scale = _found(header, "Scale Factor", SCALE)
    gal, steps = number("Scale Factor", scale[1]), number("Scale Factor", scale[2])
    for key, value in (("Sampling Freq(Hz)", frequency), ("Scale Factor", gal), ("Scale Factor", steps)):
        if not value:
            raise SceneError(key, value, "not above 0", REMEDY)
    _check_places(lines[end + 1 :], end + 2)
    counts = [_count(at, token) for at, line in enumerate(lines[end + 1 :], end + 2) for token in line.split()]
    if len(counts) != round(duration * frequency):
        raise SceneError("Duration Time(s)", duration, f"but {len(counts)} samples follow at {frequency:g} Hz", DAMAGED)
    size, total = len(counts), sum(counts)
    # The difference from the mean is taken in whole numbers: nothing is lost of small counts on a large mean.
    values = np.array([float(size * count - total) for count in counts]) * (gal / (steps * max(size, 1)))
    peak = next((number("Max. Acc. (gal)", match[1]) for match in map(PEAK.fullmatch, header) if match), None)
    return (
        Content(
            usable("Sampling Freq(Hz)", 1 / frequency),
            values,
            Unit("gal", 0.01, "Scale Factor"),
            warnings=odd_peak(peak, "gal", values),
            direction=_found(header, "Dir.", DIRECTION)[1].strip(),
            note="mean removed",
        ),
    )


_NUMBERS = {"Sampling Freq(Hz)": FREQUENCY, "Duration Time(s)": DURATION}


def _found(header: Sequence[str], key: str, pattern: re.Pattern[str]) -> re.Match[str]:
    """The only line of the header that `pattern` matches."""
    found = [match for match in map(pattern.fullmatch, header) if match]
    if len(found) != 1:
        raise SceneError(key, None, "stated twice" if found else "missing from the header, or damaged", REMEDY)
    return found[0]


def _count(at: int, token: str) -> int:
    if not COUNT.fullmatch(token):
        raise SceneError(f"line {at}", token, "not a whole number", DAMAGED)
    return int(token)


def _check_places(lines: Sequence[str], first: int) -> None:
    """Refuse a line whose counts end elsewhere than those of the first one: a digit slipped in or was lost."""
    usual = {found.end() for found in re.finditer(r"\S+", lines[0])} if lines else set()
    for at, line in enumerate(lines, first):
        if not {found.end() for found in re.finditer(r"\S+", line)} <= usual:
            raise SceneError(f"line {at}", line, "its counts do not stand below those of the first line", DAMAGED)
