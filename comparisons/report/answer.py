"""The first screen: one recommendation, the decision table, and what not to do; all from result files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ..showing.parts import Mark, number
from ..showing.wording import rating

if TYPE_CHECKING:
    from ..showing.parts import Judgement

# part: good in all that was tested, and something was not
LEVELS = {"good": "✓ trust", "part": "✓ as far as tested", "fair": "~ with care", "bad": "✗ do not trust"}
UNTESTED = Mark("not tested", "none")


@dataclass(frozen=True)
class Row:
    """One way to set an engine up. marks: a `Mark` for each column; rating: the worst of them, the one rating that all
    pages use.

    best: it is the engine's default; cpu: s of CPU time per simulated second, of the runs behind its restitution.
    """

    engine: str
    variant: str
    tier: str
    best: bool
    marks: tuple[Mark, ...]
    rating: Mark
    cpu: float | None
    applies_impact: bool

    @property
    def command(self) -> str:
        return f"rocking run SCENE --engine {self.engine} --variant {self.variant}"

    @property
    def snippet(self) -> str:
        return f'get_engine("{self.engine}").simulate(scene, variant="{self.variant}")'


def rows_of(rated: Sequence[Mapping[str, Any]], columns: Sequence[Judgement]) -> list[Row]:
    """Rows of the decision table: trusted ones first, the cheapest of equals first.

    rated: of each variant engine, variant, tier, best, applies_impact and, of its restitution, rms, worst, failed,
    cpu_per_second.
    """
    rows = []
    for one in rated:
        marks = (_restitution(one), *(_mark(column, one) for column in columns))
        how = {key: one[key] for key in ("engine", "variant", "tier", "best", "applies_impact")}
        rows.append(Row(**how, marks=marks, rating=_rating(marks), cpu=one["cpu_per_second"]))
    order = list(LEVELS)
    return sorted(rows, key=lambda row: (order.index(row.rating.level), row.cpu or 1e9))


def _mark(judgement, one):
    """What a study says of a variant; one that takes engines as they come knows the default by no name."""
    marks = judgement.marks
    unnamed = marks.get((one["engine"], ""), UNTESTED) if one["best"] else UNTESTED
    return marks.get((one["engine"], one["variant"]), unnamed)


def _restitution(one):
    if one["rms"] is None:
        return Mark("none measured", "bad", f"{one['failed']} runs failed")
    words = number(one["rms"], 2) + (f", {one['failed']} failed" if one["failed"] else "")
    return Mark(words, rating(one["rms"], one["failed"]), f"worst impact {number(one['worst'], 2)}")


def _rating(marks):
    level = max((mark.level if mark.level in LEVELS else "part" for mark in marks), key=list(LEVELS).index)
    return Mark(LEVELS[level], level)


def best_of(rows: Sequence[Row]) -> Row | None:
    """The cheapest row that may be trusted and decides the impact itself; None where there is none."""
    return next((row for row in rows if row.rating.level in ("good", "part") and not row.applies_impact), None)


def recommendation(rows: Sequence[Row], limits: str) -> list[str]:
    """What to use, with error, cost and limits, the range in words, within which it was tested; list of str."""
    words = ["One rigid block, planar, on sharp corners: use the analytic model. It is exact to the closed forms."]
    row = best_of(rows)
    if row is None:
        words.append("More bodies or contacts: no engine that was run here may be trusted in all that was tested.")
        return words
    words.append(
        f"More bodies or contacts: {row.engine} set as “{row.variant}”: restitution within {row.marks[0].words} at "
        f"{number(row.cpu, 2)} s of CPU time per simulated second."
    )
    words.append(f"Tested for {limits}; planar, no sliding, no jump.")
    return words


def _error(row):
    return row.marks[0].words.partition(",")[0]


def not_to_do(rows: Sequence[Row]) -> list[str]:
    """Three lines at most."""
    first = [row for row in rows if row.tier == "defaults" and row.marks[0].level != "none"]
    lines = []
    if first:
        worst = max(first, key=lambda row: list(LEVELS).index(row.rating.level))
        bad = [row for row in first if row.rating.level == "bad"]
        lines.append(
            f"Do not use default settings: {len(bad)} of {len(first)} fail (restitution off by "
            f"{', '.join(f'{_error(row)} in {row.engine}' for row in bad or [worst])})."
        )
    lines.append(
        "Check how near the outcome is to changing (rocking margin SCENE): if your data are less certain than that, it "
        "decides nothing."
    )
    lines.append(
        "Do not compare tilt point by point beyond the sensitivity horizon, nor trust a setting until refinement no "
        "longer changes the result."
    )
    return lines
