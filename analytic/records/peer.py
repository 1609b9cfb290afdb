"""PEER AT2, the old and the new headers: values in columns of Fortran after a line with NPTS and DT."""

import re
from collections.abc import Sequence

from ..errors import SceneError
from .content import HEADER_WIDTH, Asked, Content
from .numbers import NUMBER, check_count, count, fortran_values
from .times import PER_SECOND, interval
from .units import stated_unit

NAME = "PEER AT2"
HEADER_LINES = 8  # the NPTS line is the fourth in every known variant

NPTS = re.compile(r"\bNPTS\s*[=:]\s*([^\s,;]*)", re.I)
DT = re.compile(r"\bDT\s*(?:[(\[]\s*([a-z]*)\s*[)\]]\s*)?[=:]\s*((?:[^\s,;]|,(?=[0-9]))*)(?:[ \t]*([a-zµ]+))?", re.I)
OLD = re.compile(rf"\s*([0-9]+)[\s,]+({NUMBER})[\s,]+NPTS[\s,]+DT\b(?!\s*[=:])(?:\s*[(\[]\s*([a-z]*))?", re.I)


def recognises(lines: Sequence[str]) -> bool:
    """Whether the lines are a PEER AT2 file."""
    return _head(lines) is not None


def read(lines: Sequence[str], asked: Asked) -> tuple[Content, ...]:
    """The `Content` of a PEER AT2 file.

    Raises
    ------
    SceneError
        No acceleration, an unreadable number, or another count than stated.
    """
    head, npts, dt, unit_of_dt = _head(lines)  # type: ignore[misc]  # `recognises` found it
    where = f"line {head + 1}"
    dt = interval(f"{where}, DT", dt, unit_of_dt)
    unit = stated_unit(((number, line[:HEADER_WIDTH]) for number, line in enumerate(lines[: head + 1], 1)), titles=head)
    values = fortran_values(lines, head + 1)
    check_count(f"{where}, NPTS", count(f"{where}, NPTS", npts), values)
    return (Content(dt, values, unit),)


def _head(lines: Sequence[str]) -> tuple[int, str, str, str] | None:
    """Index of the line with count and step, both as printed, and the word for the unit of the step."""
    for index, line in enumerate(lines[:HEADER_LINES]):
        line = line[:HEADER_WIDTH]
        if old := OLD.match(line):
            return index, old[1], old[2], old[3] or ""
        npts, dt = NPTS.search(line), DT.search(line)
        if npts and dt:
            if len(DT.findall(line)) > 1 or len(NPTS.findall(line)) > 1:
                raise SceneError(f"line {index + 1}", line, "names NPTS or DT twice", "remove the wrong one")
            before, behind = dt[1] or "", dt[3] or ""
            return index, npts[1], dt[2], behind if behind.lower() not in PER_SECOND or not before else before
    return None
