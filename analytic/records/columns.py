"""Two columns, time and acceleration: parted by blanks, semicolons or commas, with a header or without."""

import re
from collections.abc import Sequence

import numpy as np

from ..errors import SceneError
from .content import HEADER_WIDTH, UNKNOWN, Asked, Content
from .numbers import number
from .times import PER_SECOND, uniform_step, usable
from .units import stated_unit

NAME = "two columns"
# A line that begins like a number is data and must be read, or else damage would pass as a header.
DATA = re.compile(r"\s*(?:[-+.,;0-9]|(?:nan|inf|infinity)\b)", re.I)
COMMENT = ("#", "%", "!", "//")
HEADER_LINES = 200
NUMERIC = re.compile(r"[-+]?[.,]?[0-9]")
TIME = re.compile(r"(?<![a-z])(?:time|t)[ ,:=_/(\[]+(?:in |units?[ :=]+)?[(\[]?(µs|[a-z]+)\b", re.I)
OTHER_TIMES = {"us", "µs", "usec", "ns", "min", "minute", "minutes", "h", "hour", "hours", "samples"}
REMEDY = "write time [s] and acceleration, two numbers a line"


def recognises(lines: Sequence[str]) -> bool:
    """Two columns are what is left when no other format is recognised."""
    return True


def read(lines: Sequence[str], asked: Asked) -> tuple[Content, ...]:
    """The `Content` of two columns.

    Raises
    ------
    SceneError
        Other columns than two, an unreadable number, decimal commas that cannot be told from separators, times that
        are not uniform, or no acceleration.
    """
    header, rows = _split(lines)
    separator, decimal = _dialect(rows)
    titles = _titles(header, separator)
    unit = stated_unit([(at, line[:HEADER_WIDTH]) for at, line in header], titles)
    per_second = _per_second(header)
    times, values = [], []
    for at, row in rows:
        where = f"line {at}"
        fields = _fields(row, separator)
        if len(fields) != 2:
            raise SceneError(where, row, f"holds {len(fields)} columns", REMEDY)
        if decimal == ",":
            fields = [field.replace(",", ".") for field in fields]
        number(where, fields[0])
        times.append(fields[0])
        values.append(number(where, fields[1]))
    dt = uniform_step(times) if len(times) > 1 else 1.0  # one sample is refused by the caller
    no_unit = "the header names no unit" if header else "two columns carry no unit"
    return (Content(usable("time", dt / per_second), np.array(values), unit, no_unit),)


def _split(lines: Sequence[str]) -> tuple[list[tuple[int, str]], list[tuple[int, str]]]:
    """(line number, text) of the header and of the rows of data, without comments and blank lines."""
    header: list[tuple[int, str]]
    rows: list[tuple[int, str]]
    header, rows = [], []
    for at, line in enumerate(lines, 1):
        text = line.strip()
        if text.startswith(COMMENT):
            if not rows:
                header.append((at, text))
        elif text and not rows and not DATA.match(text):
            header.append((at, text))
        elif text:
            rows.append((at, text.split("#")[0].strip()))
    if not rows or len(header) > HEADER_LINES:
        first = next(line for line in lines if line.strip())
        raise SceneError("line 1", first.strip()[:60], *UNKNOWN)
    return header, rows


def _dialect(rows: Sequence[tuple[int, str]]) -> tuple[str | None, str]:
    """(separator, decimal sign) of all rows; the separator of blanks is None."""
    texts = [row for _, row in rows]
    points = sum("." in text for text in texts)
    first = next((row for row in rows if "," in row[1]), None)
    if first is None:
        return (";" if any(";" in text for text in texts) else None), "."
    if any(";" in text for text in texts):
        separator = ";"
    elif any(re.search(r",[ \t]|[ \t],|^,|,$", text) for text in texts):
        separator = ","
    elif all(len(text.split()) > 1 for text in texts):
        separator = None
    elif 2 * points >= len(texts):
        separator = ","
    else:
        raise SceneError(
            f"line {first[0]}",
            first[1],
            "its comma may part columns or be a decimal sign",
            "write decimal points, or part the columns by semicolons",
        )
    if separator != "," and points:
        raise SceneError(
            f"line {first[0]}",
            first[1],
            "a decimal comma in a file that has decimal points too",
            "write decimal points throughout",
        )
    return separator, "." if separator == "," else ","


def _fields(row: str, separator: str | None) -> list[str]:
    return row.split() if separator is None else [field.strip() for field in row.split(separator)]


def _titles(header: Sequence[tuple[int, str]], separator: str | None) -> int | None:
    """Line number of the column titles, the last line before the data; refused if it may be a damaged row."""
    if not header:
        return None
    at, text = header[-1]
    for number_of_line, line in header:
        if re.search(r"\bNPTS\b", line, re.I):
            raise SceneError(
                f"line {number_of_line}",
                line,
                "names NPTS, but not as PEER AT2 does",
                "mend the line: NPTS= ..., DT= ... SEC",
            )
    if not text.startswith(COMMENT) and any(NUMERIC.match(field) for field in _fields(text, separator)[1:]):
        raise SceneError(
            f"line {at}", text, "neither a header nor two numbers", "mend the number, or begin a header line with #"
        )
    return at


def _per_second(header: Sequence[tuple[int, str]]) -> float:
    """Units of time in a second, from the words of the header."""
    found = {}
    for at, line in header:
        for match in TIME.finditer(" ".join(line[:HEADER_WIDTH].split())):
            word = match[1].lower()
            if word in OTHER_TIMES:
                raise SceneError(f"line {at}", match[0], "not a time in s or ms", "write the times in seconds")
            if word in PER_SECOND:
                found[PER_SECOND[word]] = at
    if len(found) > 1:
        raise SceneError(f"line {max(found.values())}", None, "times in s and in ms", "correct the wrong unit of time")
    return next(iter(found), 1)
