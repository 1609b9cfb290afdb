"""How often each engine is right in random scenes, and every run that is not; all from the result."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from ...measuring.statistics import wilson
from ...showing.charts import Axis, Chart, figure
from ...showing.parts import Judgement, Mark, Section, Table, percent

if TYPE_CHECKING:
    from collections.abc import Iterable

    from ...running.provenance import Result
    from ...showing.parts import Figure

CLASSES = ("right", "differs", "failed", "left out")
TRUSTED = 0.95  # share of right runs, of those not left out
LEAST = 0.1  # % that the figure's axis begins at
TOLD = "Every run that differs is told as one, wherever it is shown."


@dataclass
class Tally:
    """Runs of one variant by class."""

    engine: str
    variant: str
    tier: str
    counts: dict[str, int] = field(default_factory=lambda: dict.fromkeys(CLASSES, 0))

    @property
    def name(self) -> str:
        return f"{self.engine}, {self.variant}"

    @property
    def judged(self) -> int:
        """Runs that are not left out."""
        return sum(self.counts.values()) - self.counts["left out"]

    def share(self, classes: Iterable[str]) -> tuple[float, float, float]:
        """Share of the judged runs in some classes, with its 95 % interval."""
        count = sum(self.counts[word] for word in classes)
        return count / self.judged, *wilson(count, self.judged)


def tallies(result: Result) -> list[Tally]:
    """One for each variant, in the order of the rows."""
    found: dict[tuple[str, str], Tally] = {}
    for row in result.rows:
        key = row["engine"], row["variant"]
        found.setdefault(key, Tally(*key, row["tier"])).counts[row["class"]] += 1
    return list(found.values())


def section(result: Result) -> Section:
    """All that is known, every run that differs or fails among it."""
    names = [f"{row['engine']}, {row['variant']}" for row in result.rows]
    wrong = [
        [name, str(row["index"]), "; ".join(row["differences"])]
        for name, row in zip(names, result.rows, strict=True)
        if row["class"] == "differs" and row["tier"] != "defaults"
    ]
    failed = tuple(
        (f"{name}, scene {row['index']}: {row['failure']['reason']}", row["failure"]["message"])
        for name, row in zip(names, result.rows, strict=True)
        if row["class"] == "failed"
    )
    tables = [_table(result)]
    if wrong:
        tables.append(
            Table("Runs that differ, but for default settings", ("engine, variant", "scene", "in what"), wrong)
        )
    right = "; ".join(f"{one.name} {one.counts['right']} of {one.judged}" for one in tallies(result))
    text = (_asked(result), f"Right are: {right}.", TOLD)
    return Section("Random scenes", text, tuple(tables), (_figure(result),), evidence=failed)


def finding(result: Result) -> Section:
    """The answer: right, differs, failed, by engine and tier."""
    tuned = [one for one in tallies(result) if one.tier == "tuned"]
    right, failed = (sum(one.counts[word] for one in tuned) for word in ("right", "failed"))
    judged = sum(one.judged for one in tuned)
    title = f"Random statues: {right} of {judged} runs of tuned engines are right, {failed} failed"
    return Section(title, (TOLD,), (_table(result),), (_figure(result),), measured=(_asked(result),))


def judgement(result: Result) -> Judgement:
    """The column of the decision table."""
    marks = {}
    for one in tallies(result):
        if one.judged:
            share, right = one.share(["right"])[0], one.counts["right"]
            level = "good" if share >= TRUSTED else "fair" if share >= 0.5 else "bad"
            marks[one.engine, one.variant] = Mark(f"{right} of {one.judged}", level, f"{one.counts['failed']} failed")
    return Judgement("random statues right", marks)


def _asked(result: Result) -> str:
    return (
        f"{result.settings['scenes']} scenes drawn at random (seed {result.provenance['seed']}, of the commit): "
        f"{result.settings['range']}; let go or under a pulse, until the outcome is decided. "
        f"{result.settings['below_range']} whose peak tilt stays below the range are not run. Left out: the normal "
        "force falls to 0 or no contact gives the friction demanded, or the scene is on an edge, where a change by "
        "1e-4 makes such a difference in the analytic model. "
    )


def _table(result: Result) -> Table:
    return Table(
        "Random scenes in the range of a statue: right within 2 % of both peaks, .01 of the restitution, outcome and "
        "number of impacts",
        ("engine, variant", "tier", *CLASSES, "right, of those not left out"),
        [[one.name, one.tier, *map(str, one.counts.values()), _share(one)] for one in tallies(result)],
    )


def _share(one: Tally) -> str:
    return "{} ({} to {})".format(*map(percent, one.share(["right"]))) if one.judged else "–"


def _figure(result: Result) -> Figure:
    """Share of the runs that are not right, a line each."""
    found = tallies(result)
    ticks = ((0.1, "≤ 0.1"), (1, "1"), (10, "10"), (100, "100"))
    chart = Chart(
        Axis("runs that differ or fail [%]", LEAST, 100, "log", ticks),
        Axis("", len(found) - 0.5, -0.5, ticks=tuple((k, one.name) for k, one in enumerate(found))),
        "Share of random scenes in which each engine differs from the analytic model or fails.",
        left=196,
        height=90 + 21 * len(found),
    )
    for k, one in enumerate(found):
        if one.judged:
            share, low, high = (max(100 * value, LEAST) for value in one.share(["differs", "failed"]))
            chart.reach([share], [k], [low], [high], one.engine, along="x")
            says = f"{one.name}: {one.judged - one.counts['right']} of {one.judged}"
            chart.dots([share], [k], one.engine, filled=one.tier != "defaults", says=[says])
    caption = "Share of runs that differ from the analytic model or fail, with 95 % intervals; open: default settings."
    return figure([chart], caption, [one.engine for one in found])
