"""PEER AT2, the old and the new headers: values in columns of Fortran after a line with NPTS and DT."""

import re
from collections.abc import Sequence

from ..errors import SceneError
from .content import HEADER_WIDTH, MARK, Asked, Content
from .numbers import NUMBER, check_count, count, fortran_values
from .statements import read_statements, stated_unit

NAME = "PEER AT2"
HEADER_LINES = 8  # the NPTS line is the fourth in every known variant

NPTS = re.compile(r"\bNPTS\s*[=:]\s*([^\s,;]*)", re.I)
DT = re.compile(r"\bDT\s*(?:[(\[]\s*[a-z]*\s*[)\]]\s*)?[=:]", re.I)
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
    head, npts, old = _head(lines)  # type: ignore[misc]  # `recognises` found it
    where = f"line {head + 1}"
    numbered = [(at, line[:HEADER_WIDTH]) for at, line in enumerate(lines[: head + 1], 1)]
    if old:
        numbered[-1] = head + 1, f"dt = {old[2]} {old[3] or ''}"
    found = read_statements(numbered)
    marked = MARK.fullmatch("".join(lines[head + 1 : head + 2])[:HEADER_WIDTH])
    values = fortran_values(lines, head + (2 if marked else 1))
    check_count(f"{where}, NPTS", count(f"{where}, NPTS", npts), values)
    return (Content(found.step, values, stated_unit(found.rest, titles=head)),)


def _head(lines: Sequence[str]) -> tuple[int, str, re.Match[str] | None] | None:
    """Index of the line with count and step, the count as printed, and the match of a line of the old form."""
    for index, line in enumerate(lines[:HEADER_LINES]):
        line = line[:HEADER_WIDTH]
        if old := OLD.match(line):
            return index, old[1], old
        npts = NPTS.findall(line)
        if npts and DT.search(line):
            if len(DT.findall(line)) > 1 or len(npts) > 1:
                raise SceneError(f"line {index + 1}", line, "names NPTS or DT twice", "remove the wrong one")
            return index, npts[0], None
    return None
