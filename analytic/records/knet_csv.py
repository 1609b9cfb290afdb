"""K-NET CSV: a header of lines that begin with #, then a time stamp, a time [s] and three components [gal] a line.

NIED strong-motion seismograph networks. The header states an offset of each component, which is subtracted.
"""

import re
from collections.abc import Sequence

import numpy as np

from ..errors import SceneError
from .content import HEADER_WIDTH, Asked, Content, begun_by
from .fixed import DAMAGED
from .numbers import form_of, number
from .times import SAME, exact, uniform_step, usable
from .units import Unit

NAME = "K-NET CSV"
FIRST = re.compile(r"#\s*k-net csv\b", re.I)
COMPONENT = re.compile(r"([^,()]+)\(gal\)", re.I)
REMEDY = "give the file as the network sends it, or the ASCII file of this record"


recognises = begun_by(FIRST)


def read(lines: Sequence[str], asked: Asked) -> tuple[Content, ...]:
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
    names, offsets = COMPONENT.findall(titles), _below(header, titles).split(",")
    if not 0 < frequency or len(names) != len(offsets) or header[-1] != f"Time,RelativeTime(s),{titles}":
        raise SceneError("header", None, "no sampling frequency, or no offset of each component", REMEDY)
    if len(rows) < 2:
        raise SceneError("record", None, f"holds {len(rows)} samples", REMEDY)
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
    found = [after for line, after in zip(header, header[1:], strict=False) if line == key]
    if len(found) != 1:
        raise SceneError(key, None, "stated twice" if found else "missing from the header", REMEDY)
    return found[0]
