"""Columns of numbers: times [s] and accelerations, or accelerations alone at a stated step.

The columns are separated by blanks, tabs, semicolons or commas, with or without quotes and header. Loggers and programs
write such files, and so do the networks of Taiwan (CWA), Japan (JMA) and Turkey (AFAD). A line may hold several pairs
of time and acceleration. Accelerations without times may stand several per line in sequence, as OpenSees and other
programs read them and China's network (CSMNC) writes them; the header, or a first line as eqsig's, may state their
number.
"""

import itertools
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..errors import SceneError
from .content import Content, Format, Given
from .notation import (
    SAME,
    check_count,
    check_last,
    fortran_values,
    in_latin,
    number,
    numbers_in,
    uniform_step,
    usable,
    value_of,
)
from .statements import Statements, read_statements, stated_count, stated_unit, unused_factors
from .table import (
    ACCELERATED,
    COMMENT,
    DEPTH,
    NUMBERS,
    NUMERIC,
    OTHERS,
    PERIODS,
    TIME,
    UNKNOWN,
    Table,
    Titles,
    check_events,
    check_leading,
    counted,
    counts,
    fields_of,
    find_titles,
    has_unit,
    kinds_of,
    name_of,
    parted,
    rises,
    spectrum_in,
    split,
    time_words,
    unpaired,
    unquoted,
    with_unit,
)

REMEDY = "write time [s] and acceleration, two numbers a line"
OF_TIMES = (
    "give the accelerations over time of this record; if these are, title their columns time [s] and acceleration"
)
# In a sequence of numbers, differences between neighbours in a line are no larger than those between lines, at every
# position in the line. In separate columns they are larger, at some positions at least.
SMOOTHER, ALIKE = 0.7, 1.6


@dataclass(frozen=True)
class Sheet:
    """Content of a file of columns.

    Its rows, the titles and kinds of its columns, the other words of the header, the statements in them and in the
    first title, the number of samples stated, the line that names a spectrum, the separator (None: blanks), whether the
    rows hold one sequence of numbers, and the step [s] that the user gives.
    """

    lines: Sequence[str]
    table: Table
    titles: Titles
    kinds: Sequence[str]
    words: Sequence[tuple[int, str]]
    stated: Statements
    count: int | None
    spectrum: tuple[int, str] | None
    separator: str | None
    runs_on: bool
    given: float | None

    @property
    def known(self) -> bool:
        """Return whether the step is known without times."""
        return self.given is not None or self.stated.step is not None

    @property
    def width(self) -> int:
        """Return the number of columns."""
        return len(self.table[0][1])

    @property
    def names(self) -> list[str]:
        """Return the columns as messages name them."""
        titles = [name_of(word) for word in self.titles.words] or [""] * self.width
        return [f"{place} ({title})" if title else str(place) for place, title in enumerate(titles, 1)]

    def content(self, values: Sequence[float] | np.ndarray, step: float | None, place: int, name: bool) -> Content:
        """Return the `Content` of values of a column, or of all columns one after the other."""
        words, last = self.words, self.words[-1][0] if self.words else None
        if self.titles.words:
            words, last = [*words, (self.titles.at, with_unit(self.titles, place))], self.titles.at
        unit = stated_unit(read_statements(words).rest, last)
        no_unit = "the header names no unit" if words else "columns of numbers carry no unit"
        title = name_of(self.titles.words[place]) if self.titles.words and name else ""
        warnings = unused_factors(self.words)
        if self.count not in (None, len(values)):
            parts = f"the header states {self.count} samples, the data have {len(values)}"
            warnings += (f"{parts}: check that the file is whole",)
        return Content(
            step,
            np.array(values),
            unit,
            no_unit,
            warnings=warnings,
            channel=str(place + 1) if name else "",
            direction=title,
            unread=self.stated.unread,
        )


def _read(lines: Sequence[str], given: Given) -> tuple[Content, ...]:
    """Return the `Content` of each column of accelerations, or of the one asked for, or of accelerations alone.

    Raises
    ------
    SceneError
        Lines of unlike length, an unreadable number, decimal commas that cannot be told from separators, times that
        are not uniform or contradict a stated step, a statement inside the data, or no acceleration.
    """
    sheet = _sheet(unquoted(lines), given)
    alone = given.column is None and not sheet.titles.words[1:]
    if alone and sheet.runs_on:
        values = fortran_values(sheet.lines, sheet.table[0][0] - 1)
        check_count("number of samples", sheet.count or 0, values)
        return (sheet.content(values, sheet.stated.step, 0, name=False),)
    _check_header(sheet)
    times = _times(sheet)
    if alone and not times:
        _check_kind(sheet, 0)
        return (sheet.content(_one_after_the_other(sheet), sheet.stated.step, 0, name=False),)
    for at, fields in sheet.table:
        if len(fields) != sheet.width:
            problem = f"holds {len(fields)} columns, the first line {sheet.width}"
            raise SceneError(f"line {at}", sheet.lines[at - 1].strip(), problem, REMEDY)
    return _accelerations(sheet, times, given.column)


def _sheet(lines: Sequence[str], given: Given) -> Sheet:
    """Return the `Sheet` of the lines of a file."""
    header, rows = split(lines)
    separator, table = parted(rows)
    if lines[-1].strip():
        check_last(f"line {table[-1][0]}", [fields for _, fields in table])
    table, leading = counted(table)
    titles = find_titles(header, separator, len(table[0][1]))
    check_events(titles)
    table = unpaired(table, titles.words)
    width = len(table[0][1])
    count = stated_count([*leading, *header])
    runs_on = given.column is None and separator is None and _runs_on(table, bool(titles.words), count)
    titles = Titles() if runs_on else Titles(titles.at, titles.words[:width])
    words = [*leading, *((at, line) for at, line in header if at != titles.at)]
    # Statements in the other titles do not apply to the times.
    stated = read_statements([*words, (titles.at, titles.words[0])] if titles.words else words)
    # A spectrum has no negative values; a motion with the same columns has many.
    positive = not any(field.startswith("-") for _, fields in table for field in fields[1:])
    spectrum = spectrum_in(words) if positive else None
    kinds = kinds_of(titles, bool(spectrum)) or [UNKNOWN] * width
    if width > 2 and not titles.words and rises(table, 1):
        kinds[0] = NUMBERS
    kinds = [UNKNOWN if kind == NUMBERS and not counts(table, place) else kind for place, kind in enumerate(kinds)]
    return Sheet(lines, table, titles, kinds, words, stated, count, spectrum, separator, runs_on, given.dt)


def _runs_on(table: Table, titled: bool, count: int | None) -> bool:
    """Return whether rows separated by blanks hold one sequence of numbers, of which the header states `count`.

    Some numbers touch, or there are no columns.
    """
    if count in (None, len(table)):
        return False
    if any(numbers_in(field) > 1 for _, fields in table for field in fields):
        return True
    return not titled and any(len(fields) > 1 for _, fields in table) and not rises(table, 0)


def _check_header(sheet: Sheet) -> None:
    """Refuse a damaged PEER header, and one whose last line may be a damaged row."""
    numbers = sum(len(fields) for _, fields in sheet.table)
    complete = sheet.stated.step is not None and sheet.count in (len(sheet.table), numbers)
    for at, line in (*sheet.words, (sheet.titles.at, " ".join(sheet.titles.words))):
        if re.search(r"\bNPTS\b", line, re.I) and not complete:
            problem, remedy = "names NPTS, but not as PEER AT2 does", "mend the line: NPTS= ..., DT= ... SEC"
            raise SceneError(f"line {at}", line, problem, remedy)
    for (at, line), (_, rest) in list(zip(sheet.words, sheet.stated.rest, strict=False))[-1:]:
        bare = fields_of(rest, sheet.separator)
        if at > sheet.titles.at and not line.startswith(COMMENT) and any(map(NUMERIC.match, bare[1:])):
            problem, remedy = "neither a header nor two numbers", "mend the number, or begin a header line with #"
            raise SceneError(f"line {at}", line, problem, remedy)
    at, fields = sheet.table[0]
    begun = fields if len(fields) != len(sheet.table[-1][1]) else fields[:1]
    words = [field for field in begun if math.isnan(value_of(field))]
    if words:
        raise SceneError(f"line {at}", words[0], "not a number", "mend it, or begin the lines of the header with #")


def _times(sheet: Sheet) -> list[int]:
    """Return the columns of times: those with such a title, else the first one that increases.

    A column that numbers the rows is no time.
    """
    named = [place for place, kind in enumerate(sheet.kinds) if kind == TIME]
    if named or sheet.width == 1:
        return named
    first = int(sheet.kinds[0] == NUMBERS)
    rising = first < sheet.width - 1 and _only_rises(sheet, first)
    _check_no_period(sheet, first if rising else None)
    if rising and sheet.kinds[first] in (UNKNOWN, ACCELERATED):  # accelerations do not increase monotonically
        return [first]
    if sheet.titles.words or sheet.known:
        return []
    values = [number(f"line {at}", field) for at, fields in sheet.table for field in fields]
    if not rising and sheet.separator is None and len(sheet.table) > 1 and _smooth(values, sheet.width):
        problem = f"missing; the file holds accelerations alone, {sheet.width} a line, or columns without times"
        raise SceneError("motion.dt", None, problem, "add dt, the step in s; and column, if they are columns")
    return [0]


def _check_no_period(sheet: Sheet, rising: int | None) -> None:
    """Refuse a spectrum or a profile, which is no acceleration over time.

    A title names a period or a frequency; or the column that rises, `rising`, has another quantity in its title, or the
    header names a spectrum.
    """
    for place, (title, kind) in enumerate(zip(sheet.titles.words, sheet.kinds, strict=False)):
        if kind in PERIODS or (place == rising and (kind in (DEPTH, *OTHERS) or has_unit(title))):
            problem = f"is {kind or 'of another unit'}, not a time"
            raise SceneError(f"line {sheet.titles.at}, title", title, problem, OF_TIMES)
    if rising is not None and sheet.spectrum:
        at, line = sheet.spectrum
        raise SceneError(f"line {at}", line, "names a spectrum, not an acceleration over time", OF_TIMES)


def _only_rises(sheet: Sheet, place: int) -> bool:
    """Return whether a column increases monotonically; an entry that is not a number, as a damaged time, is refused."""
    values = [number(f"line {at}", fields[min(place, len(fields) - 1)]) for at, fields in sheet.table]
    return len(values) > 1 and all(before < after for before, after in itertools.pairwise(values))


def _accelerations(sheet: Sheet, times: Sequence[int], column: int | str | None) -> tuple[Content, ...]:
    """Return the `Content` of each column of accelerations, or of the one wanted."""
    offered = [place for place, kind in enumerate(sheet.kinds) if place not in times and kind != NUMBERS]
    if not offered:
        raise SceneError("record", None, "holds times, but no column of accelerations", REMEDY)
    chosen = None if column is None else _place(sheet, column)
    named = len(offered) > 1 or column is not None
    places = [chosen] if chosen in offered else offered
    steps = {at: at if at is None else _step(sheet, at) for at in {_nearest(times, place) for place in places}}
    contents: dict[int, Content] = {}
    errors = []
    for place in places:
        try:
            contents[place] = _acceleration(sheet, steps[_nearest(times, place)], place, named)
        except SceneError as error:
            errors.append(error)
    choice = f"column, {' or '.join(sheet.names[place] for place in contents or offered)}"
    if column is not None and chosen not in offered:
        problem = f"but the file has {sheet.width} columns" if chosen is None else f"is {sheet.kinds[chosen] or TIME}"
        raise SceneError("motion.column", column, problem, f"give {choice}")
    if errors and contents:
        problem = f"missing; not all columns are accelerations ({errors[0].key}: {errors[0].problem})"
        raise SceneError("motion.column", None, problem, f"add {choice}")
    if errors:
        raise errors[0]
    return tuple(contents.values())


def _acceleration(sheet: Sheet, step: float | None, place: int, named: bool) -> Content:
    """Return the `Content` of a column; step: of its times [s], None without times."""
    _check_kind(sheet, place)
    values = [number(f"line {at}", fields[place]) for at, fields in sheet.table]
    if step is None:
        _check_leading(sheet, [(at, fields[place]) for at, fields in sheet.table])
    return sheet.content(values, step or sheet.stated.step, place, named)


def _nearest(times: Sequence[int], place: int) -> int | None:
    """Return the column of times before a column, the first one without such; None where there are no times."""
    return max((at for at in times if at < place), default=times[0] if times else None)


def _check_kind(sheet: Sheet, place: int) -> None:
    """Refuse a column whose title names another quantity."""
    if sheet.kinds[place] in OTHERS:
        problem, remedy = f"is {sheet.kinds[place]}, not an acceleration", "give a column of accelerations"
        raise SceneError(f"line {sheet.titles.at}, title", sheet.titles.words[place], problem, remedy)


def _place(sheet: Sheet, column: int | str) -> int | None:
    """Return the index of the column of that number or title; None without one."""
    word = in_latin(str(column).strip()).casefold()
    places = [place for place in range(sheet.width) if word == str(place + 1)] or [
        place
        for place, title in enumerate(sheet.titles.words)
        if word in (name_of(title).casefold(), title.strip().casefold())
    ]
    if len(places) > 1:
        choice = " or ".join(sheet.names[place] for place in places)
        raise SceneError("motion.column", column, "names several columns", f"give column, {choice}, by its number")
    return places[0] if places else None


def _one_after_the_other(sheet: Sheet) -> list[float]:
    """Return all numbers, shape (n,): one per line, or equally many in each line except the last.

    Channels side by side are refused: in sequence their numbers jump.
    """
    if not sheet.known:
        problem = "missing; the file holds one column of numbers, no times"
        problem += f" ({sheet.stated.unread[0]})" if sheet.stated.unread else ""
        raise SceneError("motion.dt", None, problem, "add dt, the step in s, or write time [s] and acceleration")
    values = []
    for at, fields in sheet.table:
        if len(fields) > sheet.width or (len(fields) < sheet.width and at < sheet.table[-1][0]):
            problem = f"holds {len(fields)} numbers, the first line {sheet.width}"
            raise SceneError(f"line {at}", sheet.lines[at - 1].strip(), problem, REMEDY)
        values += [number(f"line {at}", field) for field in fields]
    if not _smooth(values, sheet.width):
        problem = f"missing; the {sheet.width} numbers a line may be columns of their own"
        raise SceneError("motion.column", None, problem, "add column, or write one number a line")
    _check_leading(sheet, [(at, field) for at, fields in sheet.table for field in fields])
    return values


def _check_leading(sheet: Sheet, values: Sequence[tuple[int, str]]) -> None:
    """Refuse numbers without times that may begin with no acceleration, unless the header says how many there are."""
    if sheet.count != len(values):
        check_leading(values, sheet.given if sheet.stated.step is None else None)


def _smooth(values: Sequence[float], width: int) -> bool:
    """Return whether numbers, `width` per line, continue smoothly from line to line."""
    if not 1 < width < len(values):
        return True
    along, across = np.abs(np.diff(values)), np.abs(np.array(values[width:]) - values[:-width])
    places = [along[place::width].mean() for place in range(width)]
    return bool(along.mean() < SMOOTHER * across.mean() and max(places) < ALIKE * min(places))


def _step(sheet: Sheet, place: int) -> float:
    """Return the step [s] of a column of times, or the stated one if the two agree."""
    tokens = [fields[place] for _, fields in sheet.table]
    for at, fields in sheet.table:
        number(f"line {at}", fields[place])
    words = time_words(sheet.titles.words[place]) if sheet.titles.words else ""
    stated = read_statements([*sheet.words, (sheet.titles.at, words)])
    # One sample is refused by the caller.
    printed = (uniform_step(tokens) if len(tokens) > 1 else 1.0) / stated.per_second
    if stated.step is None:
        return usable("time", printed)
    if abs(printed - stated.step) > SAME * printed:
        raise SceneError("dt", stated.step, f"but the times have a step of {printed:.9g} s", "correct the wrong one")
    return stated.step


COLUMNS = Format("columns", lambda lines: True, _read)  # the last one that is tried
