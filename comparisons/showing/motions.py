"""Results of a scene under many motions: a table for the terminal, and shares of records."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from ..measuring.statistics import wilson
from ..running.readable import readable
from .parts import number, percent
from .terminal import echo, grid

if TYPE_CHECKING:
    from analytic import Scene

LIFTED = ("rocks", "overturns")


def print_motions(scene: Scene, rows: Sequence[Mapping[str, Any]]) -> None:
    """Print a row for each motion, and how many records lift and overturn the block; nothing without motions.

    rows : as of `rows_of`, and for each more column of a `Mapping` called changes a name and what stands there.
    """
    if not rows:
        return
    more = list(dict.fromkeys(name for row in rows for name in row.get("changes", ())))
    more_heads = [name.replace(" > ", " >\n") for name in more]
    heads = ["motion", "peak\n[g]", "outcome", *(["tilt\n[-]"] if "tilt" in rows[0] else []), *more_heads]
    heads += ["base\n[m]"] if rows[0].get("stroke") is not None else []
    table = []
    for row in rows:
        cells = [readable(row["motion"]), f"{row['peak'] / scene.gravity:.3g}", row["outcome"]]
        cells += [f"{row['tilt']:.3g}"] if "tilt" in row else []
        cells += [row["changes"][name] for name in more]
        table.append(cells + ([f"{row['stroke']:.3g}"] if row.get("stroke") is not None else []))
    words = f"The block {odds(rows, LIFTED, 'lifts')}, and {odds(rows, LIFTED[1:], 'overturns')}."
    echo(grid(heads, table, wraps=["motion"]), words, wrap=True)


def odds(rows: Iterable[Mapping[str, Any]], outcomes: Sequence[str], word: str) -> str:
    """Under how many records the block comes to one of these outcomes, in some direction or sign at least.

    The interval of the share is Wilson's, of records: motions of one record are no sample. A record under which no
    motion does so and one failed is left out.
    """
    found: dict[str, float] = {}
    for row in rows:
        hit = 1.0 if row["outcome"] in outcomes else math.nan if row["outcome"] == "failed" else 0.0
        before = found.get(row["record"], 0.0)
        found[row["record"]] = 1.0 if 1.0 in (hit, before) else before + hit
    known = [hit for hit in found.values() if not math.isnan(hit)]
    if not known:
        return f"{word} under no record that could be run"
    low, high = wilson(int(sum(known)), len(known))
    return f"{word} under {sum(known):.0f} of {len(known)} records ({number(100 * low, 2)} to {percent(high)} at 95 %)"
