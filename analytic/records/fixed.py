"""Numbers in columns of equal width, as a Fortran format such as 8F10.5 prints them: cut by position, not by blanks.

Numbers that fill their columns touch each other, so that blanks do not separate them. A missing or an additional
character shifts all that follows, which is detected.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..errors import SceneError
from .numbers import form_of, number

DAMAGED = "the file is cut or damaged: fetch it again"
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
