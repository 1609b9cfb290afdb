"""Columns of numbers, time [s] and accelerations, or accelerations alone at a step that is stated or given.

Parted by blanks, tabs, semicolons or commas, with a header or without. Accelerations alone may stand several a line,
one after the other, as OpenSees and other programs read them.
"""

import itertools
import re
from collections.abc import Sequence

import numpy as np

from ..errors import SceneError
from .content import HEADER_WIDTH, UNKNOWN, Asked, Content
from .numbers import NUMBER, number
from .times import PER_SECOND, SAME, interval, uniform_step, usable
from .units import START, stated_unit

NAME = "columns"
# A line that begins like a number is data and must be read, or else damage would pass as a header.
DATA = re.compile(r"\s*(?:[-+.,;0-9]|(?:nan|inf|infinity)\b)", re.I)
COMMENT = ("#", "%", "!", "//")
HEADER_LINES = 200
NUMERIC = re.compile(r"[-+]?[.,]?[0-9]")
TIME = re.compile(rf"{START}(?:time|t)[ ,:=_/(\[]+(?:in |units?[ :=]+)?[(\[]?(µs|[a-z]+)(?![a-z0-9_])", re.I)
STEP = re.compile(rf"{START}dt ?(?:[(\[] ?([a-zµ]+) ?[)\]] ?)?[:=] ?(?:({NUMBER})(?![0-9.]|,[0-9]) ?([a-zµ]*))?", re.I)
OTHER_TIMES = {"us", "µs", "usec", "ns", "min", "minute", "minutes", "h", "hour", "hours", "samples"}
REMEDY = "write time [s] and acceleration, two numbers a line"
# Of numbers one after the other, neighbours in a line are no rougher than those a line apart, wherever in the line they
# stand; in columns of their own they are, or some of them are.
SMOOTHER, ALIKE = 0.7, 1.6

Table = Sequence[tuple[int, list[str]]]  # line numbers and fields of the rows


def recognises(lines: Sequence[str]) -> bool:
    """Columns are what is left when no other format is recognised."""
    return True


def read(lines: Sequence[str], asked: Asked) -> tuple[Content, ...]:
    """The `Content` of one of the columns, or of accelerations alone.

    Raises
    ------
    SceneError
        Lines of unlike length, an unreadable number, decimal commas that cannot be told from separators, times that
        are not uniform or contradict a stated step, no acceleration, or several columns and none chosen.
    """
    header, rows = _split(lines)
    separator, decimal = _dialect(rows)
    titles = _titles(header, separator)
    stated = _stated_step(header)
    table = [(at, _fields(row.replace(",", ".") if decimal == "," else row, separator)) for at, row in rows]
    known = asked.dt is not None or stated is not None
    timed = len(table[0][1]) > 1 and not (known and not _rises(table))
    printed = None
    if timed or asked.column is not None:
        column = _column(table, rows, asked.column, timed)
        values = [number(f"line {at}", fields[column]) for at, fields in table]
        if timed:
            printed = _printed_step(table) / _per_second(header)
    else:
        values = _one_after_the_other(table, rows, known)
    if printed is not None and stated is not None and abs(printed - stated) > SAME * printed:
        raise SceneError("dt", stated, f"but the times have a step of {printed:.9g} s", "correct the wrong one")
    words = [(at, line[:HEADER_WIDTH]) for at, line in header]
    if asked.column is not None and titles is not None:
        words[-1] = titles, _title(words[-1][1], separator, len(table[0][1]), asked.column)
    return (
        Content(
            stated if printed is None or stated is not None else usable("time", printed),
            np.array(values),
            stated_unit(words, titles),
            "the header names no unit" if header else "columns of numbers carry no unit",
            note="" if asked.column is None else f"column {asked.column}",
        ),
    )


def _rises(table: Table) -> bool:
    """Whether the first column is one of times: it only rises."""
    first = [number(f"line {at}", fields[0]) for at, fields in table]
    return len(first) > 1 and all(before < after for before, after in itertools.pairwise(first))


def _column(table: Table, rows: Sequence[tuple[int, str]], wanted: int | None, timed: bool) -> int:
    """Index of the column of accelerations; `timed`: the first one holds the times."""
    width, first = len(table[0][1]), 2 if timed else 1
    for (at, fields), (_, row) in zip(table, rows, strict=True):
        if len(fields) != width:
            raise SceneError(f"line {at}", row, f"holds {len(fields)} columns, the first line {width}", REMEDY)
    choice = f"{first} to {width}" if first < width else f"{width}"
    if wanted is None and width > 2:
        raise SceneError("motion.column", None, f"missing; the file has {width} columns", f"add column, {choice}")
    wanted = 2 if wanted is None else wanted
    if not first <= wanted <= width:
        problem = "is the time" if wanted == 1 else f"but the file has {width} columns"
        raise SceneError("motion.column", wanted, problem, f"give column, {choice}")
    return wanted - 1


def _one_after_the_other(table: Table, rows: Sequence[tuple[int, str]], known: bool) -> list[float]:
    """All numbers, shape (n,): one a line, or as many in each line but the last.

    Numbers of channels side by side are refused: read along the lines they jump.
    """
    width = len(table[0][1])
    if not known:
        problem = "missing; the file holds one column of numbers, no times"
        raise SceneError("motion.dt", None, problem, "add dt, the step in s, or write time [s] and acceleration")
    values = []
    for index, ((at, fields), (_, row)) in enumerate(zip(table, rows, strict=True)):
        if len(fields) > width or (len(fields) < width and index + 1 < len(table)):
            raise SceneError(f"line {at}", row, f"holds {len(fields)} numbers, the first line {width}", REMEDY)
        values += [number(f"line {at}", field) for field in fields]
    if 1 < width < len(values):
        along, across = np.abs(np.diff(values)), np.abs(np.array(values[width:]) - values[:-width])
        places = [along[place::width].mean() for place in range(width)]
        if not (along.mean() < SMOOTHER * across.mean() and max(places) < ALIKE * min(places)):
            problem = f"missing; the {width} numbers a line may be columns of their own"
            raise SceneError("motion.column", None, problem, "add column, or write one number a line")
    return values


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


def _title(line: str, separator: str | None, width: int, column: int) -> str:
    """The title of a column; the whole line where it cannot be told which word belongs to which column."""
    separator = "\t" if separator is None else separator
    titles = line.split(separator)
    return titles[column - 1] if len(titles) == width else line


def _stated_step(header: Sequence[tuple[int, str]]) -> float | None:
    """The sampling interval [s] that a line of the header states, dt = .01 s; None without one."""
    found = {}
    for at, line in header:
        for match in STEP.finditer(" ".join(line[:HEADER_WIDTH].split())):
            if match[2] is None:
                raise SceneError(f"line {at}", line, "its dt is no number", "write dt = .01 s")
            word = (match[3] or match[1] or "").lower()
            unit = word if word in PER_SECOND or word in OTHER_TIMES else match[1] or ""
            found[interval(f"line {at}, dt", match[2], unit)] = at
    if len(found) > 1:
        raise SceneError(f"line {max(found.values())}", None, "dt is stated twice", "correct the wrong one")
    return next(iter(found), None)


def _printed_step(table: Table) -> float:
    """The interval of the times in the first column, in their own unit."""
    tokens = [fields[0] for _, fields in table]
    for at, fields in table:
        number(f"line {at}", fields[0])
    return uniform_step(tokens) if len(tokens) > 1 else 1.0  # one sample is refused by the caller


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
