"""From a study's rows to tables: choose rows, group them, say once what a column is.

    default = where(result.rows, part="summary", scope="all")
    table("Restitution", default, NAME, Column("error, rms [-]", "rms"), Column("failed", "{failed} of {runs}"))

The same `Column` is an axis of a figure (`comparisons.showing.figures`).
"""

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from .parts import Table, number, percent, short

Row = Mapping[str, Any]
Key = str | Callable[[Any], Any]
UNITS = {"stiffness": "N/m", "step": "s", "largest_step": "s"}  # of accuracy parameters


def where(rows: Iterable[Row], **wanted: Any) -> list[Any]:
    """The rows with these values, in order; a set means any of its members. A row without the column is not chosen.

    >>> where([{"part": "a", "x": 1}, {"part": "b"}, {"part": "a", "x": 2}], part="a", x={2, 3})
    [{'part': 'a', 'x': 2}]
    """

    def chosen(row, key, value):
        return key in row and (row[key] in value if isinstance(value, set | frozenset) else row[key] == value)

    return [row for row in rows if all(chosen(row, key, value) for key, value in wanted.items())]


def grouped(rows: Iterable[Any], *keys: Key) -> dict[tuple[Any, ...], list[Any]]:
    """{values of the keys: their rows}, in the order in which they come; a key is a column or a function of a row.

    >>> grouped([{"x": 2, "y": 1}, {"x": 1, "y": 2}, {"x": 2, "y": 3}], "x")
    {(2,): [{'x': 2, 'y': 1}, {'x': 2, 'y': 3}], (1,): [{'x': 1, 'y': 2}]}
    """
    groups: dict[tuple[Any, ...], list[Any]] = {}
    for row in rows:
        groups.setdefault(tuple(value_of(row, key) for key in keys), []).append(row)
    return groups


def cheapest(
    rows: Iterable[Row], name: Key, keeps: Callable[[Row], bool], cost: Callable[[Row], float]
) -> dict[Any, Row]:
    """{name: cheapest of its rows, which come from coarse to fine, that keeps with all finer ones}, cheapest first."""
    found = {}
    for (who,), some in grouped(rows, name).items():
        bad = [k for k, row in enumerate(some) if not keeps(row)]
        if good := some[bad[-1] + 1 :] if bad else some:
            found[who] = min(good, key=cost)
    return dict(sorted(found.items(), key=lambda item: cost(item[1])))


def value_of(row: Row, key: Key) -> Any:
    """What a function makes of a row, or its value in the column of that name.

    Raises
    ------
    KeyError
        The row has no such column.
    """
    return key(row) if callable(key) else row[key]


@dataclass(frozen=True)
class Column:
    """One quantity of rows, as a column of a table or as an axis.

    Parameters
    ----------
    head : str
        With its unit: "error, rms [-]".
    value : str or function
        Name of the rows' column; a pattern of several, as "{failed} of {runs}"; or a function of a row.
    digits : int or None
        Significant digits of numbers that are not whole; None: those of a number that was chosen, as 0.3.
    percent : bool
        A fraction, written in per cent.
    within : str or function or None
        The interval [low, high] of the value, written behind it; the rows may have None.
    """

    head: str
    value: Key
    digits: int | None = 2
    percent: bool = False
    within: Key | None = None

    def of(self, row: Row) -> Any:
        """The value itself, what `text` writes; of a pattern the text."""
        if isinstance(self.value, str) and "{" in self.value:
            return re.sub(r"{(\w+)}", lambda found: self.words(row[found[1]]), self.value)
        return value_of(row, self.value)

    def ends(self, row: Row) -> tuple[Any, ...]:
        """Low and high end of the value's interval; empty where there is none."""
        return tuple((value_of(row, self.within) if self.within else None) or ())

    def text(self, row: Row) -> str:
        """The cell of a row: text as it is, whole numbers as they are, others to `digits`, a dash for None."""
        ends = " to ".join(map(self.words, self.ends(row)))
        return self.words(self.of(row)) + (f" ({ends})" if ends else "")

    def words(self, value: Any) -> str:
        """A value of this column as its cells have it."""
        if isinstance(value, str):
            return value
        if isinstance(value, list | tuple):
            return ", ".join(map(self.words, value)) or "–"
        if self.digits is None or isinstance(value, int):
            return short(value) if self.digits is None else str(value)
        return percent(value, self.digits) if self.percent else number(value, self.digits)


# a solver without variants says "variant": "", and its engine's name stands alone
NAME = Column("engine, variant", lambda row: ", ".join(filter(None, (row["engine"], row["variant"]))))


def table(caption: str, rows: Iterable[Row], *columns: Column) -> Table:
    """The `Table` of these rows; the first column names them."""
    return Table(
        caption, tuple(column.head for column in columns), [[column.text(row) for column in columns] for row in rows]
    )


def across(caption: str, rows: Iterable[Row], name: Column, *columns: Column) -> Table:
    """The `Table` with a column for each of these rows, named by `name`, and a row for each of the `columns`."""
    rows = list(rows)
    cells = [[column.head, *map(column.text, rows)] for column in columns]
    return Table(caption, (name.head, *map(name.text, rows)), cells)


def setting_of(row: Row) -> str:
    """The level of a row's accuracy parameter, with its name and unit: step = 0.001 s."""
    return f"{row['parameter'].replace('_', ' ')} = {short(row['level'])} {UNITS.get(row['parameter'], '')}".rstrip()
