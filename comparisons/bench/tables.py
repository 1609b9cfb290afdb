"""Tables of the benchmark for the terminal."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from rich.table import Table

if TYPE_CHECKING:
    from .figures import Figure


def solver_table(rows: Sequence[Mapping[str, Any]]) -> Table:
    """CPU time and error of every solver at every tolerance."""
    table = Table("problem", "solver", "tolerance", "CPU [ms]", "10-90 %", "error", "impacts", title="One run")
    for row in rows:
        if row["failure"]:
            table.add_row(
                row["problem"],
                row["solver"],
                f"{row['tolerance']:g}",
                "-",
                "-",
                "failed",
                row["failure"],
                style="yellow",
            )
            continue
        impacts = str(row["impacts"]) if row["counted"] else f"{row['impacts']}, not {row['impacts_expected']}"
        spread = f"{row['cpu_seconds_low'] * 1e3:.4g}-{row['cpu_seconds_high'] * 1e3:.4g}"
        table.add_row(
            row["problem"],
            row["solver"],
            f"{row['tolerance']:g}",
            f"{row['cpu_seconds'] * 1e3:.4g}",
            spread,
            f"{row['error']:.1e}",
            impacts,
            style=None if row["counted"] else "yellow",
        )
    return table


def figure_table(figures: Iterable[Figure]) -> Table:
    """The figures beside what was asked for."""
    table = Table("figure", "measured", "asked for", "met", "how", title="Figures")
    for figure in figures:
        value = "-" if figure.value is None else f"{figure.value:.3g} {figure.unit}"
        asked = "-" if figure.limit is None else f"{figure.sense} {figure.limit:g} {figure.unit}"
        table.add_row(figure.name, value, asked, {True: "yes", False: "no", None: "-"}[figure.met], figure.how)
    return table
