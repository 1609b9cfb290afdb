"""Tables of ``rocking bench engines`` for the terminal."""

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from rich.markup import escape
from rich.table import Table

from ...measuring.verdicts import CLASSES

TELLING = 3  # quantities shown for a cause: those in which its scenes lie furthest from the others


def causes(row: Mapping[str, Any]) -> list[str]:
    """Why a row is not simply right: words, without numbers, that rows of one cause share."""
    if row["class"] == "left out":
        return [row["cause"]]
    if row["class"] == "failed and said":
        return [_numberless(row["cause"])]
    words = [f"off: {finding['quantity']}" for finding in row["findings"]]
    return words + [f"warned: {_numberless(re.split(r' = | is ', sentence)[0])[:60]}" for sentence in row["warnings"]]


def _numberless(words):
    return re.sub(r"(?<!\S)-?\d[\d.e+-]*", "#", words)  # m R^2 keeps its own


def class_table(rows: Sequence[Mapping[str, Any]], title: str) -> Table:
    """Counts and shares of the classes, in all and in the core range; shares are of the scenes not left out."""
    table = Table("class", "scenes", "share", "core range", "share", title=title)
    core = [row for row in rows if row["place"]["core"]]
    total, total_core = (max(sum(row["class"] != "left out" for row in part), 1) for part in (rows, core))
    for name in CLASSES:
        count, count_core = (sum(row["class"] == name for row in part) for part in (rows, core))
        shares = ("-", "-") if name == "left out" else (f"{count / total:.1%}", f"{count_core / total_core:.1%}")
        table.add_row(name, str(count), shares[0], str(count_core), shares[1])
    notes = Counter(note for row in rows for note in row["notes"])
    for note, count in notes.items():
        table.add_row(f"  judged in part: {note}", str(count), "", "", "")
    upto = sum(row["judged_until"] is not None for row in rows)
    table.add_row("  judged up to the unstable point", str(upto), "", "", "")
    return table


def cause_table(rows: Sequence[Mapping[str, Any]]) -> Table:
    """Every cause of every class but right: its count, and where in the box its scenes lie."""
    table = Table("class", "cause", "scenes", "core", "examples", "where (10 to 90 % of its scenes)")
    for name in CLASSES[1:]:
        members = {}
        for row in rows:
            if row["class"] == name:
                for cause in causes(row):
                    members.setdefault(cause, []).append(row)
        for cause, group in sorted(members.items(), key=lambda item: -len(item[1])):
            examples = ", ".join(str(row["index"]) for row in group[:4])
            core = sum(row["place"]["core"] for row in group)
            table.add_row(name, escape(cause), str(len(group)), str(core), examples, where(group, rows))
    return table


def where(group: Sequence[Mapping[str, Any]], rows: Sequence[Mapping[str, Any]]) -> str:
    """In words: the quantities in which a group of rows lies furthest from all rows, with their range there."""
    words = []
    for name in rows[0]["place"]:
        every = np.array([row["place"].get(name) for row in rows if _number(row["place"].get(name))])
        own = np.array([row["place"].get(name) for row in group if _number(row["place"].get(name))])
        if len(own) and 2 * len(own) >= len(group):
            rank = np.mean(np.searchsorted(np.sort(every), own) / len(every))
            low, high = np.quantile(own, [0.1, 0.9])
            words.append((abs(rank - 0.5), f"{name} {low:.2g} to {high:.2g}"))
    return "; ".join(word for _, word in sorted(words, reverse=True)[:TELLING])


def _number(value):
    return isinstance(value, float | int) and not isinstance(value, bool)


def off_table(rows: Sequence[Mapping[str, Any]]) -> Table:
    """Every run that was off in silence."""
    table = Table("index", "found", "outcome", "expected", "notes", "place", title="Off and silent")
    for row in rows:
        if row["class"] == "off and silent":
            findings = ", ".join(
                f"{finding['quantity']} {finding['error']:.3g}"
                if isinstance(finding["error"], float)
                else f"{finding['quantity']} {finding['error']}"
                for finding in row["findings"]
            )
            spot = ", ".join(
                f"{name} {value:.3g}" if _number(value) else f"{value}"
                for name, value in row["place"].items()
                if value is not None and name != "mass"
            )
            table.add_row(str(row["index"]), findings, row["outcome"], row["expected"], ", ".join(row["notes"]), spot)
    return table
