"""Columns of numbers: times [s] and accelerations, or accelerations alone at a step that is stated or given.

Parted by blanks, tabs, semicolons or commas, with a header or without; so do loggers write them, and the networks of
Taiwan (CWA), Japan (JMA) and Turkey (AFAD). Accelerations alone may stand several a line, one after the other, as
OpenSees and other programs read them.
"""

import itertools
import re
from collections.abc import Sequence

import numpy as np

from ..errors import SceneError
from .content import HEADER_WIDTH, UNKNOWN, Asked, Content
from .numbers import check_last, number
from .statements import TIMES, Statements, read_statements, stated_unit
from .times import SAME, uniform_step, usable
from .units import END

NAME = "columns"
# A line that begins like a number is data and must be read, or else damage would pass as a header.
DATA = re.compile(r"\s*(?:[-+.,;0-9]|(?:nan|inf|infinity)\b)", re.I)
COMMENT = ("#", "%", "!", "//")
HEADER_LINES = 200
NUMERIC = re.compile(r"[-+]?[.,]?[0-9]")
SEQUENCE = re.compile(r"datasequence:", re.I)  # Taiwan's line of titles
TIME_TITLE = re.compile(rf"(?:{TIMES}){END}", re.I)
REMEDY = "write time [s] and acceleration, two numbers a line"
# Of numbers one after the other, neighbours in a line are no rougher than those a line apart, wherever in the line they
# stand; in columns of their own they are, or some of them are.
SMOOTHER, ALIKE = 0.7, 1.6

Table = Sequence[tuple[int, list[str]]]  # line numbers and fields of the rows


def recognises(lines: Sequence[str]) -> bool:
    """Columns are what is left when no other format is recognised."""
    return True


def read(lines: Sequence[str], asked: Asked) -> tuple[Content, ...]:
    """The `Content` of each column of accelerations, or of the one asked for, or of accelerations alone.

    Raises
    ------
    SceneError
        Lines of unlike length, an unreadable number, decimal commas that cannot be told from separators, times that
        are not uniform or contradict a stated step, a statement inside the data, or no acceleration.
    """
    header, rows = _split(lines)
    separator, decimal = _dialect(rows)
    last = _last_line(header, separator)
    table = [(at, _fields(row.replace(",", ".") if decimal == "," else row, separator)) for at, row in rows]
    width = len(table[0][1])
    titles_at, titles = _titles(header, separator, width)
    words = [(at, line[:HEADER_WIDTH]) for at, line in header if at != titles_at]
    # What the other titles say of their columns is not said of the times.
    stated = read_statements([*words, (titles_at, titles[0])] if titles else words)
    if lines[-1].strip():
        check_last(f"line {table[-1][0]}", [fields for _, fields in table])
    known = asked.dt is not None or stated.step is not None
    timed = width > 1 and (_rises(table) or (bool(TIME_TITLE.match(titles[0])) if titles else not known))
    listed = not (timed or asked.column is not None or titles[1:])
    if not listed:
        _check_widths(table, rows)
    step = _step(table, stated) if timed else stated.step
    no_unit = "the header names no unit" if header else "columns of numbers carry no unit"
    if listed:
        values = np.array(_one_after_the_other(table, rows, known))
        return (Content(step, values, stated_unit(stated.rest, last), no_unit, unread=stated.unread),)
    names = [f"{place + 1} ({_name(titles[place])})" if titles else str(place + 1) for place in range(width)]
    places = _places(titles, names, asked.column, timed)

    def content(place: int) -> Content:
        said = read_statements([*words, (titles_at, titles[place])]) if titles else stated
        unit = stated_unit(said.rest, titles_at or last)
        values = np.array([number(f"line {at}", fields[place]) for at, fields in table])
        channel, name = str(place + 1), _name(titles[place]) if titles else ""
        if asked.column is None and width == 2 and timed:  # times and accelerations: nothing to choose
            channel = name = ""
        return Content(step, values, unit, no_unit, channel=channel, direction=name, unread=stated.unread)

    try:
        return tuple(content(place) for place in places)
    except SceneError as error:
        if len(places) == 1:
            raise
        problem = f"missing; not all columns are accelerations ({error.key}: {error.problem})"
        raise SceneError("motion.column", None, problem, f"add column, {' or '.join(names[timed:])}") from None


def _rises(table: Table) -> bool:
    """Whether the first column is one of times: it only rises."""
    first = [number(f"line {at}", fields[0]) for at, fields in table]
    return len(first) > 1 and all(before < after for before, after in itertools.pairwise(first))


def _check_widths(table: Table, rows: Sequence[tuple[int, str]]) -> None:
    width = len(table[0][1])
    for (at, fields), (_, row) in zip(table, rows, strict=True):
        if len(fields) != width:
            raise SceneError(f"line {at}", row, f"holds {len(fields)} columns, the first line {width}", REMEDY)


def _places(titles: Sequence[str], names: Sequence[str], wanted: int | str | None, timed: bool) -> Sequence[int]:
    """Indices of the columns of accelerations, or of the one wanted; `timed`: the first one holds the times."""
    places = range(int(timed), len(names))
    if wanted is None:
        return places
    word = str(wanted).strip().casefold()
    found = [place for place in range(len(names)) if word == str(place + 1)] or [
        place for place, title in enumerate(titles) if word in (_name(title).casefold(), title.strip().casefold())
    ]
    if len(found) == 1 and found[0] in places:
        return found
    problem = "names several columns" if found else f"but the file has {len(names)} columns"
    problem = "is the time" if found == [0] else problem
    raise SceneError("motion.column", wanted, problem, f"give column, {' or '.join(names[timed:])}")


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
    """(line number, text) of the header and of the rows of data, without comments and blank lines.

    A comment inside the data that states a step or a unit is refused: there a second record begins.
    """
    header: list[tuple[int, str]] = []
    rows: list[tuple[int, str]] = []
    for at, line in enumerate(lines, 1):
        text = line.strip()
        if text.startswith(COMMENT):
            if not rows:
                header.append((at, text))
            elif (found := read_statements([(at, text[:HEADER_WIDTH])])).step or stated_unit(found.rest):
                raise SceneError(f"line {at}", text, "a statement inside the data", "give one record of the file")
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
    semicolon = ";" if any(";" in text for text in texts) else None
    first = next((row for row in rows if "," in row[1]), None)
    if first is None:
        return semicolon, "."
    spaced = any(re.search(r",[ \t]|[ \t],|^,|,$", text) for text in texts)
    blanks = all(len(text.split()) > 1 for text in texts)
    if not semicolon and (spaced or (not blanks and 2 * points >= len(texts))):
        return ",", "."
    if not (semicolon or blanks):
        problem = "its comma may part columns or be a decimal sign"
        raise SceneError(
            f"line {first[0]}", first[1], problem, "write decimal points, or part the columns by semicolons"
        )
    if points:
        problem = "a decimal comma in a file that has decimal points too"
        raise SceneError(f"line {first[0]}", first[1], problem, "write decimal points throughout")
    return semicolon, ","


def _fields(row: str, separator: str | None) -> list[str]:
    return row.split() if separator is None else [field.strip() for field in row.split(separator)]


def _last_line(header: Sequence[tuple[int, str]], separator: str | None) -> int | None:
    """Number of the last line of the header; refused if it may be a damaged row."""
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


def _titles(header: Sequence[tuple[int, str]], separator: str | None, width: int) -> tuple[int, list[str]]:
    """(line number, titles) of the line that titles the columns; (0, none) where none does."""
    if width == 1:
        return 0, []
    named = [(at, found.string[found.end() :]) for at, line in header if (found := SEQUENCE.match(line.lstrip(" #")))]
    for at, line in named or header[-1:]:
        line = line[:HEADER_WIDTH].lstrip("#%!/ ")
        for parting in (*([re.escape(separator)] if separator else []), "[;,]", r"\t", " {2,}", "[;, ]+"):
            titles = [title.strip(" \"'") for title in re.split(parting, line.strip())]
            if len(titles) == width and all(re.search(r"[^\W\d_]", _name(title)) for title in titles):
                return at, titles
    return 0, []


def _name(title: str) -> str:
    """A title without what stands in brackets: U(+) is U."""
    return " ".join(re.sub(r"[(\[][^)\]]*[)\]]?", " ", title).split())


def _step(table: Table, stated: Statements) -> float:
    """The step [s] of the times in the first column, or that which the header states where the two agree."""
    tokens = [fields[0] for _, fields in table]
    # One sample is refused by the caller.
    printed = (uniform_step(tokens) if len(tokens) > 1 else 1.0) / stated.per_second
    if stated.step is None:
        return usable("time", printed)
    if abs(printed - stated.step) > SAME * printed:
        raise SceneError("dt", stated.step, f"but the times have a step of {printed:.9g} s", "correct the wrong one")
    return stated.step
