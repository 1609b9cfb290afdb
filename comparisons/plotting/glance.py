"""Studies' parts of the report's first screen, and its two charts: error against cost, ends of runs.

Each chart is drawn for a wide page and for a phone; a style shows one of them.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from markupsafe import Markup

from ..metrics.statistics import equality
from ..schemas.columns import percent, short
from .charts import LETTER, WIDTH, Axis, Chart, broad
from .parts import Figure, Table, grouped


@dataclass(frozen=True)
class Endings:
    """Counts of a variant's runs that end otherwise than the model's, under one kind of motion.

    motions: the kind of motion. kind: of the variant. runs: judged runs, away from the model's outcome boundaries. Six
    counts of them: failed; missed, the block overturns in the model alone; added, in the engine alone; other, neither
    overturns and the outcomes differ; late, both overturn, at different times (None: not tested); untold, another
    outcome or failed, but not known which. interval: 95 % interval of the share of all six.

    left_out: further runs, near a boundary. left_differing: those of them that overturn in engine or model alone, or
    failed; None: not known.
    """

    motions: str
    engine: str
    variant: str
    kind: str
    runs: int
    failed: int
    missed: int
    added: int
    other: int
    interval: tuple[float, float]
    late: int | None = None
    untold: int = 0
    left_out: int = 0
    left_differing: int | None = None

    @property
    def changed(self) -> int:
        """Number of runs with another outcome, or none."""
        return self.failed + self.missed + self.added + self.other + self.untold

    @property
    def differing(self) -> int:
        """Number of runs that end otherwise in any way."""
        return self.changed + (self.late or 0)


@dataclass(frozen=True)
class Curve:
    """Error over cost of a solver.

    who: engine and variant. name: a short name. kind: of the variant, or "model" for the equations themselves. subject:
    whether it is a subject engine. points: from coarse to fine, (CPU time [s/s], error [-], whether no impact was
    missed, words under the pointer).
    """

    who: str
    name: str
    kind: str
    subject: bool
    points: tuple[tuple[float, float, bool, str], ...]


@dataclass(frozen=True)
class Glance:
    """A study's part of the report's first screen.

    says: {line of the answer: its sentences}. endings: by motion and variant. curves: of solvers, in the scene named
    `scene`. advice: tables of which level to use.
    """

    says: Mapping[str, str] = field(default_factory=dict)
    endings: tuple[Endings, ...] = ()
    curves: tuple[Curve, ...] = ()
    scene: str = ""
    advice: tuple[Table, ...] = ()


WIDE = 590
WORST = 1.0  # largest error on the axis; a larger one stands at the frame
FINEST = -6  # power of ten at which the axis of errors ends if no engine has an error
LINE = 15  # height of a row of the second chart
COLUMNS: tuple[tuple[int, str, Callable[[Endings], str]], ...] = (
    (80, "differ", lambda row: f"{row.differing} of {row.runs}"),
    (130, "missed", lambda row: _count_text(row, "missed")),
    (176, "added", lambda row: _count_text(row, "added")),
    (216, "other", lambda row: _count_text(row, "other")),
    (248, "late", lambda row: _count_text(row, "late")),
    (292, "failed", lambda row: _count_text(row, "failed")),
    (350, "left out", lambda row: _left_out_text(row)),
)  # beside the bars: where a column ends, its head, its words
WAYS = {
    "missed": "overturning missed",
    "added": "overturning added",
    "other": "another outcome",
    "late": "falls at another time",
    "failed": "failed",
    "untold": "another outcome or failed",
}


def _count_text(row, way):
    """Return how many runs end in that way; a dash where that is not known."""
    count = getattr(row, way)
    return "–" if count is None or (row.untold and way != "late") else str(count)


def _left_out_text(row):
    return f"{'–' if row.left_differing is None else row.left_differing} of {row.left_out}" if row.left_out else "0"


def counted(motions: str, rows: Iterable[Mapping[str, Any]]) -> tuple[Endings, ...]:
    """Return the `Endings` of every variant from rows of its runs under `motions`.

    Columns of a row: engine, variant, `tier` (the variant's kind) and class; falls and model_falls, whether the block
    overturns in engine and model (falls None: the run failed); changed, whether the outcomes differ; group: runs of one
    group count as one in the interval.
    """
    endings_of = []
    for (engine, variant, kind), members in grouped(rows, "engine", "variant", "tier").items():
        left, runs = ([row for row in members if (row["class"] == "left out") == out] for out in (True, False))
        wrong = [row for row in runs if row["class"] == "differs"]
        ways = [(row["model_falls"], row["falls"]) for row in wrong]
        missed, added = ways.count((True, False)), ways.count((False, True))
        failed = sum(row["class"] == "failed" for row in runs)
        late = sum(not row["changed"] for row in wrong)
        _, interval = equality([row["class"] != "right" for row in runs], [row["group"] for row in runs])
        counts = len(runs), failed, missed, added, len(wrong) - missed - added - late
        near = sum(row["falls"] != row["model_falls"] for row in left)
        endings_of.append(Endings(motions, engine, variant, kind, *counts, interval, late, 0, len(left), near))
    return tuple(endings_of)


class Box(NamedTuple):
    """Where a name stands in a chart."""

    left: float
    top: float
    right: float
    bottom: float

    def holds(self, x: float, y: float) -> bool:
        return self.left - 3 < x < self.right + 3 and self.top - 3 < y < self.bottom + 3

    def meets(self, other: "Box") -> bool:
        apart = self.right < other.left or other.right < self.left or self.bottom < other.top or other.bottom < self.top
        return not apart


def costs(curves: Sequence[Curve]) -> Figure:
    """Draw error over cost: a curve through the levels of each solver, its name beside it."""
    caption = (
        "Each mark is one step size, stiffness or tolerance. Crosses: levels at which impacts were missed. Open marks: "
        "defaults that missed none. Marks on the edge lie outside the plot. Lower left is better."
    )
    return broad(_cost_chart(curves, WIDE), [_cost_chart(curves, WIDTH)], caption)


def _cost_chart(curves: Sequence[Curve], width: int) -> Chart:
    shown = [curve for curve in curves if curve.points]
    values = [cpu for curve in shown for cpu, *_ in curve.points]
    low, high = math.floor(math.log10(min(values))), math.ceil(math.log10(max(values)))
    decades = tuple((10.0**power, _seconds(power)) for power in range(low, high + 1))
    engines = [error for curve in shown for _, error, *_ in curve.points if error and curve.kind != "model"]
    finest = math.floor(math.log10(min(engines))) - 1 if engines else FINEST  # one more, for names at the frame
    shares = tuple((10.0**power, f"{short(10.0 ** (power + 2))} %") for power in range(finest, 1))
    x = Axis("CPU time per simulated second", 10.0**low, 10.0**high, "log", decades)
    y = Axis("error of peak tilt / slenderness γ", 10.0**finest, WORST * 1.0001, "log", shares)
    says = f"Error of peak tilt over CPU time of {', '.join(curve.who for curve in shown)}."
    chart = Chart(x, y, says, height=400 if width == WIDE else 420, width=width, left=72, right=16)
    places, ordered = {}, sorted(shown, key=lambda curve: curve.subject)
    drawn = [
        [(cpu, min(max(error, 10.0**finest), WORST), sound, says) for cpu, error, sound, says in curve.points]
        for curve in ordered
    ]
    for curve, points in zip(ordered, drawn, strict=True):
        cpu, errors, *_ = zip(*points, strict=True)
        chart.line(cpu, errors, curve.who, thin=not curve.subject)
        places[curve.who] = chart.at(cpu, errors)
    for missed in (False, True):  # crosses last: no mark hides that impacts were missed
        for curve, points in zip(ordered, drawn, strict=True):
            chosen = [point for point in points if point[2] != missed]
            chart.dots(
                [point[0] for point in chosen],
                [point[1] for point in chosen],
                curve.who,
                filled=missed or curve.kind != "defaults",  # a cross has no inside to leave open
                small=not curve.subject and curve.kind != "model",
                says=[point[3] for point in chosen],
                mark="x" if missed else None,
            )
    named = [
        curve for curve in shown if width == WIDE or curve.subject or curve.kind == "model"
    ]  # the others: by the pointer
    _write_names(chart, sorted(named, key=lambda curve: not curve.subject), places)
    return chart


def _seconds(power: int) -> str:
    """Return a power of ten of a second in words."""
    return f"{10.0**power:g} s" if power >= 0 else f"{10.0 ** (power + 3):g} ms"


def _write_names(chart, curves, places):
    """Write the name of each curve where it covers least: no other name, and no mark."""
    taken: list[Box] = []
    marks = [tuple(mark) for points in places.values() for mark in _points_of_line(points)]
    for curve in {curve.name: curve for curve in curves}.values():
        points = np.concatenate([places[each.who] for each in curves if each.name == curve.name])
        box, place, aside, anchor = min(
            _name_places(curve, points), key=lambda spot: _covering(chart, spot[0], taken, marks)
        )
        taken.append(box)
        kind = "soft" if curve.subject else "soft plain"
        chart.named(place, curve.name, curve.who, aside=aside, anchor=anchor, kind=kind)


def _name_places(curve, places):
    """Yield where a name may stand, (box, mark, offset, anchor): beside the last mark, the first, then any."""
    long = len(curve.name) * LETTER * (0.6 if curve.subject else 0.53)  # the names of subject engines are bold
    for at in dict.fromkeys([len(places) - 1, 0, *range(len(places))]):
        x, y = places[at]
        for aside, anchor, left in (
            ((8, 4.5), "start", x + 8),
            ((0, -9), "middle", x - long / 2),
            ((0, 18), "middle", x - long / 2),
            ((-8, 4.5), "end", x - 8 - long),
            ((0, -24), "middle", x - long / 2),
            ((0, -39), "middle", x - long / 2),
            ((6, -8), "start", x + 6),
            ((6, 17), "start", x + 6),
            ((-6, -8), "end", x - 6 - long),
            ((-6, 17), "end", x - 6 - long),
        ):
            yield Box(left, y + aside[1] - 10, left + long, y + aside[1] + 3), (x, y), aside, anchor


def _covering(chart, box, taken, marks):
    outside = box.left < chart.left or box.right > chart.right or box.top < chart.top or box.bottom > chart.bottom
    return 1000 * outside + 100 * sum(box.meets(other) for other in taken) + sum(box.holds(*mark) for mark in marks)


def _points_of_line(places):
    """Yield the marks of a curve and points between them, as names must not cover its line either."""
    for begin, end in zip(places, places[1:], strict=False):
        for k in range(5):
            yield tuple(begin + (end - begin) * k / 5)
    yield tuple(places[-1])


def endings(shares: Sequence[Endings]) -> Figure:
    """Draw the shares of runs that end otherwise than the model's, motion by motion."""
    caption = (
        "Lines: 95 % intervals; runs under one motion count as one. Missed: overturns in the model alone. Added: "
        "overturns in the engine alone. Other: stands, slides or rocks instead, or the other one of two blocks "
        "overturns. Late: both overturn, at different times. Failed: no result, or an unphysical one. Left out in "
        "every row: runs near an outcome boundary of the model, where a change of the scene by 10⁻⁴ changes its end "
        "(pulses: within 1 % of the boundary); the column says how many of them overturn in engine or model alone, or "
        "fail. –: not tested, or not stored. Defaults were run in fewer scenes. Pulses under which the block would "
        "jump, and stacked blocks that leave the model, are not counted."
    )
    return broad(_endings_chart(shares, WIDE), [_endings_chart(shares, WIDTH)], caption)


def _endings_chart(rows: Sequence[Endings], width: int) -> Chart:
    groups = grouped(rows, lambda row: row.motions)
    lines: list[Endings | str] = [line for (motions,), members in groups.items() for line in (motions, *members)]
    shown = COLUMNS if width == WIDE else COLUMNS[:1]
    chart = Chart(
        Axis("", 0, 1, ticks=((0, "0"), (0.5, "50"), (1, "100 %"))),
        Axis("", len(lines) - 0.4, -0.6, ticks=()),
        f"Share of runs whose outcome differs: {'; '.join(map(_in_words, rows))}.",
        height=52 + LINE * len(lines),
        width=width,
        left=12 + round(LETTER * 0.57 * max(len(f"{row.engine}, {row.kind}") for row in rows)),
        right=shown[-1][0] + 12,
        head=12,
    )
    for aside, heading, _ in shown:
        chart.beside(1, -0.6, heading, aside=(aside, -5), anchor="end")
    for place, row in enumerate(lines):
        if isinstance(row, str):
            chart.beside(0, place, row, aside=(4 - chart.left, 4.5), kind="title")
            continue
        who = f"{row.engine}, {row.variant}"
        chart.beside(0, place, f"{row.engine}, {row.kind}", who=who, aside=(-6, 4.5), anchor="end")
        at = 0.0
        for way, words in WAYS.items():
            if count := getattr(row, way):
                chart.bar(at, at + count / row.runs, place, who, f"ends-{way}", f"{count} of {row.runs}: {words}")
                at += count / row.runs
        chart.reach([at], [place], [row.interval[0]], [row.interval[1]], along="x")
        for aside, _, text in shown:
            chart.beside(1, place, text(row), aside=(aside, 4.5), anchor="end")
    return chart


def _in_words(row: Endings) -> str:
    share = percent(row.differing / row.runs)
    ways = [f"{count} {words}" for way, words in WAYS.items() if (count := getattr(row, way))]
    return f"{row.motions}, {row.engine}, {row.kind}: {'; '.join((f'{share} of {row.runs}', *ways))}"


def swatches(shares: Sequence[Endings]) -> list[tuple[Markup, str]]:
    """Return (picture, words) of each part of bars that occurs."""
    shape = '<rect class="ends-{}" width="31" height="12" x=".5" y="1"/></svg>'
    picture = f'<svg class="chart mini" viewBox="0 0 32 14" aria-hidden="true" style="--c:var(--soft)">{shape}'
    shown = {way: words for way, words in WAYS.items() if any(getattr(row, way) for row in shares)}
    return [(Markup(picture.format(way)), words) for way, words in shown.items()]
