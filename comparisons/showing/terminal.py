"""Tables and sentences in the terminal."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from rich import box
from rich.cells import cell_len
from rich.console import Console
from rich.table import Table
from rich.text import Text

if TYPE_CHECKING:
    from rich.console import ConsoleOptions, RenderResult

LONGEST_NUMBER = 15  # characters: sign, nine digits, point, exponent; longer words are names, and may be broken
WIDE = 10**4  # columns: wider than any table


def grid(
    heads: Sequence[str],
    rows: Iterable[Sequence[str | Text]],
    *,
    left: Collection[str] = (),
    wraps: Collection[str] = (),
    **look: Any,
) -> Grid:
    """A table of cells as they are: a unit in brackets is no markup.

    left : heads of the columns whose cells stand to the left, besides the first. wraps : of those that a narrow
    terminal breaks first. look : as `rich.table.Table` takes it.
    """
    cells = [[Text(cell) if isinstance(cell, str) else cell for cell in row] for row in rows]
    sides = ["left" if head == heads[0] or head in left else "right" for head in heads]
    look = {"box": box.SIMPLE_HEAD, "padding": (0, 1, 0, 0), **look}
    return Grid(list(heads), cells, sides, [head in wraps for head in heads], look)


@dataclass(frozen=True)
class Grid:
    """A table that fits the terminal: lines are broken at blanks, then the last columns are left out, which it says.

    No number is broken. sides: where the cells of each column stand; first: whether a column is broken before others.
    """

    heads: list[str]
    rows: list[list[Text]]
    sides: list[Any]
    first: list[bool]
    look: dict[str, Any]

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        count = len(self.heads)
        while (widths := self._widths(count, self._room(count, console, options))) is None:
            count -= 1
        yield self._table(widths)
        if count < len(self.heads):
            least = [self._least(column) for column in range(len(self.heads))]
            needed = options.max_width - self._room(len(least), console, options) + sum(least)
            more = ", ".join(head.replace("-\n", "").replace("\n", " ") for head in self.heads[count:])
            yield Text(f"A terminal of {needed} columns (or COLUMNS={needed}) shows more: {more}.")

    def _widths(self, count, room):
        """Of the first `count` columns within this room; None where they have none."""
        widths = [max(1, *map(cell_len, self._lines(column))) for column in range(count)]
        least = [self._least(column) for column in range(count)]
        for early in (True, False):
            while sum(widths) > room:
                wide = [k for k in range(count) if self.first[k] >= early and widths[k] > least[k]]
                if not wide:
                    break
                widths[max(wide, key=widths.__getitem__)] -= 1
        return [min(widths[0], max(room, 1))] if count == 1 else widths if sum(widths) <= room else None

    def _lines(self, column):
        cells = (self.heads[column], *(row[column].plain for row in self.rows))
        return [line for cell in cells for line in cell.split("\n")]

    def _least(self, column):
        """Width that keeps all but the longest words whole."""
        words = (word for line in self._lines(column) for word in line.split())
        return max((min(cell_len(word), LONGEST_NUMBER) for word in words), default=1)

    def _room(self, count, console, options):
        """What the terminal has for the cells of so many columns."""
        empty = console.measure(self._table([1] * count), options=options.update_width(WIDE)).maximum - count
        return options.max_width - empty

    def _table(self, widths):
        table = Table(**self.look)
        for head, side, width in zip(self.heads, self.sides, widths, strict=False):
            table.add_column(Text(head), justify=side, width=width, overflow="fold")
        for row in self.rows:
            table.add_row(*row[: len(widths)])
        return table


def echo(*parts: Grid | Text | str, wrap: bool = False) -> None:
    """Print tables, and sentences as they are; wrap: their lines broken to the width of the terminal."""
    console = Console(highlight=False)
    for part in parts:
        console.print(Text(part) if isinstance(part, str) else part, soft_wrap=not (wrap or isinstance(part, Grid)))


def digits(value: float | None, form: str = ".4g") -> str:
    """A number in this format; a hyphen for None."""
    return "-" if value is None or math.isnan(value) else f"{value:{form}}"
