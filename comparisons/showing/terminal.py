"""Tables and sentences in the terminal."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Sequence
from typing import Any

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text


def grid(
    heads: Sequence[str],
    rows: Iterable[Sequence[str | Text]],
    *,
    left: Collection[str] = (),
    wraps: Collection[str] = (),
    **look: Any,
) -> Table:
    """A table of cells as they are: a unit in brackets is no markup.

    left : heads of the columns whose cells stand to the left, besides the first. wraps : of those that a narrow
    terminal may break. look : as `rich.table.Table` takes it.
    """
    table = Table(**{"box": box.SIMPLE_HEAD, "padding": (0, 1, 0, 0), **look})
    for head in heads:
        justify: Any = "left" if head == heads[0] or head in left else "right"
        table.add_column(Text(head), justify=justify, no_wrap=head not in wraps, overflow="fold")
    for row in rows:
        table.add_row(*(Text(cell) if isinstance(cell, str) else cell for cell in row))
    return table


def echo(*parts: Table | Text | str, wrap: bool = False) -> None:
    """Print tables, and sentences as they are; wrap: their lines broken to the width of the terminal."""
    console = Console(highlight=False)
    for part in parts:
        console.print(Text(part) if isinstance(part, str) else part, soft_wrap=not (wrap or isinstance(part, Table)))


def digits(value: float | None, form: str = ".4g") -> str:
    """A number so written; a hyphen where there is none."""
    return "-" if value is None or math.isnan(value) else f"{value:{form}}"
