"""What studies give to the report's first screen, and its two charts: error against cost, and how runs end; each once
for a wide page and once for a phone, of which a style shows one.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from markupsafe import Markup

from ..measuring.statistics import equality
from .charts import LETTER, WIDTH, Axis, Chart, broad
from .parts import Figure, Table, grouped, percent, short


@dataclass(frozen=True)
class Endings:
    """How many runs of a variant end otherwise than the model's, under one kind of motion.

    kind: of the variant. runs: those judged; of these failed; missed: overturn in the model alone; added: in the
    engine alone; other: end, or fall, otherwise in another way. interval: 95 % of the share of all four.
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

    @property
    def differing(self) -> int:
        return self.failed + self.missed + self.added + self.other


@dataclass(frozen=True)
class Curve:
    """Error over cost of a solver. who: engine and variant; name: shorter. kind: "defaults", "tuned", or "model" of
    the equations themselves; subject: whether it is an engine in question.

    points: (CPU time [s/s], error [-], whether it missed nothing, what it is in words), from coarse to fine.
    """

    who: str
    name: str
    kind: str
    subject: bool
    points: tuple[tuple[float, float, bool, str], ...]


@dataclass(frozen=True)
class Glance:
    """What a study gives to the report's first screen.

    says: {place in the answer: a sentence}. endings: of variants. curves: of solvers, in the scene that is called
    `scene`. advice: the recommendation by accuracy.
    """

    says: Mapping[str, str] = field(default_factory=dict)
    endings: tuple[Endings, ...] = ()
    curves: tuple[Curve, ...] = ()
    scene: str = ""
    advice: Table | None = None


WIDE = 590
WORST = 1.0  # of errors; what lies beyond stands at the frame
FINEST = -6  # power of ten at which the errors end where no engine has one
LINE = 14  # height of a row of the second chart
COLUMNS: tuple[tuple[int, str, Callable[[Endings], str]], ...] = (
    (76, "differ", lambda one: f"{one.differing} of {one.runs}"),
    (128, "missed", lambda one: str(one.missed)),
    (174, "added", lambda one: str(one.added)),
    (215, "other", lambda one: str(one.other)),
    (260, "failed", lambda one: str(one.failed)),
)  # beside the bars: where a column ends, its head, its words
WAYS = {"missed": "overturning missed", "added": "overturning added", "other": "other", "failed": "failed"}


def counted(motions: str, rows: Iterable[Mapping[str, Any]]) -> tuple[Endings, ...]:
    """The `Endings` of every variant from its judged runs: rows of a study, each with engine, variant and its kind, and
    its class "right", "differs" or "failed"; falls and model_falls, whether the block overturns; group: runs of one
    count as one in the interval.
    """
    found = []
    for (engine, variant, kind), runs in grouped(rows, "engine", "variant", "tier").items():
        wrong = [row for row in runs if row["class"] == "differs"]
        ways = [(row["model_falls"], row["falls"]) for row in wrong]
        missed, added = ways.count((True, False)), ways.count((False, True))
        failed = sum(row["class"] == "failed" for row in runs)
        _, interval = equality([row["class"] != "right" for row in runs], [row["group"] for row in runs])
        counts = len(runs), failed, missed, added, len(wrong) - missed - added
        found.append(Endings(motions, engine, variant, kind, *counts, interval))
    return tuple(found)


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
    """Error over cost of every solver, its levels joined, its name beside it."""
    caption = (
        "Each mark is one step size, stiffness or tolerance. Open marks: defaults; crosses: missed impacts; "
        "marks on the frame lie beyond it. Lower left is better."
    )
    return broad(_costs(curves, WIDE), [_costs(curves, WIDTH)], caption)


def _costs(curves: Sequence[Curve], width: int) -> Chart:
    shown = [one for one in curves if one.points]
    values = [cpu for one in shown for cpu, *_ in one.points]
    low, high = math.floor(math.log10(min(values))), math.ceil(math.log10(max(values)))
    decades = tuple((10.0**power, _seconds(power)) for power in range(low, high + 1))
    engines = [error for one in shown for _, error, *_ in one.points if error and one.kind != "model"]
    finest = math.floor(math.log10(min(engines))) - 1 if engines else FINEST  # one more, for names at the frame
    shares = tuple((10.0**power, f"{short(10.0 ** (power + 2))} %") for power in range(finest, 1))
    x = Axis("CPU time per simulated second", 10.0**low, 10.0**high, "log", decades)
    y = Axis("error of peak tilt / slenderness γ", 10.0**finest, WORST * 1.0001, "log", shares)
    says = f"Error of peak tilt over CPU time of {', '.join(one.who for one in shown)}."
    chart = Chart(x, y, says, height=400 if width == WIDE else 420, width=width, left=72, right=16)
    places = {}
    for one in sorted(shown, key=lambda one: one.subject):
        cpu, errors, sound, told = zip(*one.points, strict=True)
        errors = tuple(min(max(error, 10.0**finest), WORST) for error in errors)
        chart.line(cpu, errors, one.who, thin=not one.subject)
        for whole in (True, False):
            some = [k for k in range(len(cpu)) if sound[k] == whole]
            chart.dots(
                [cpu[k] for k in some],
                [errors[k] for k in some],
                one.who,
                filled=one.kind != "defaults",
                small=not one.subject and one.kind != "model",
                says=[told[k] for k in some],
                mark=None if whole else "x",
            )
        places[one.who] = chart.at(cpu, errors)
    named = [one for one in shown if width == WIDE or one.subject or one.kind == "model"]  # the others: by the pointer
    _name(chart, sorted(named, key=lambda one: not one.subject), places)
    return chart


def _seconds(power: int) -> str:
    """A power of ten of a second in words."""
    return f"{10.0**power:g} s" if power >= 0 else f"{10.0 ** (power + 3):g} ms"


def _name(chart, curves, places):
    """The name of each curve where it covers least: no other name, and no mark."""
    taken: list[Box] = []
    marks = [tuple(place) for some in places.values() for place in _dense(some)]
    for one in {one.name: one for one in curves}.values():
        found = _beside(one, np.concatenate([places[other.who] for other in curves if other.name == one.name]))
        box, place, aside, anchor = min(found, key=lambda one: _cover(chart, one[0], taken, marks))
        taken.append(box)
        chart.named(place, one.name, one.who, aside=aside, anchor=anchor, kind="soft" if one.subject else "soft plain")


def _beside(curve, places):
    """Where a name may stand: beside its last mark, its first, then any."""
    long = len(curve.name) * LETTER * (0.6 if curve.subject else 0.53)  # that of an engine in question is bold
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


def _cover(chart, box, taken, marks):
    outside = box.left < chart.left or box.right > chart.right or box.top < chart.top or box.bottom > chart.bottom
    return 1000 * outside + 100 * sum(box.meets(other) for other in taken) + sum(box.holds(*mark) for mark in marks)


def _dense(places):
    """The marks of a curve and points between them, as its line must not be covered either."""
    for one, other in zip(places, places[1:], strict=False):
        for k in range(5):
            yield tuple(one + (other - one) * k / 5)
    yield tuple(places[-1])


def endings(found: Iterable[Endings]) -> Figure:
    """Shares of runs that end otherwise than the model's, motion by motion."""
    rows = list(found)
    caption = (
        "Lines: 95 % intervals, runs under one motion as one. Other: overturns in another swing, or stands, slides or "
        "rocks instead. Failed: no result, or unphysical. Defaults: fewer scenes."
    )
    return broad(_endings(rows, WIDE), [_endings(rows, WIDTH)], caption)


def _endings(rows: Sequence[Endings], width: int) -> Chart:
    lines: list[Endings | str] = []
    for (motions,), members in grouped(rows, lambda one: one.motions).items():
        lines += [motions, *members]
    shown = COLUMNS if width == WIDE else COLUMNS[:1]
    chart = Chart(
        Axis("", 0, 1, ticks=((0, "0"), (0.25, "25 %"), (0.5, "50 %"), (0.75, "75 %"), (1, "100 %"))),
        Axis("", len(lines) - 0.4, -0.6, ticks=()),
        f"Share of runs whose outcome differs: {'; '.join(map(_told, rows))}.",
        height=52 + LINE * len(lines),
        width=width,
        left=12 + round(LETTER * 0.53 * max(len(f"{one.engine}, {one.kind}") for one in rows)),
        right=shown[-1][0] + 12,
        head=12,
    )
    for aside, heading, _ in shown:
        chart.beside(1, -0.6, heading, aside=(aside, -5), anchor="end")
    for place, one in enumerate(lines):
        if isinstance(one, str):
            chart.beside(0, place, one, aside=(4 - chart.left, 4.5), kind="title")
            continue
        who = f"{one.engine}, {one.variant}"
        chart.beside(0, place, f"{one.engine}, {one.kind}", who=who, aside=(-6, 4.5), anchor="end")
        at = 0.0
        for way, words in WAYS.items():
            if count := getattr(one, way):
                chart.bar(at, at + count / one.runs, place, who, f"ends-{way}", f"{count} of {one.runs}: {words}")
                at += count / one.runs
        chart.reach([at], [place], [one.interval[0]], [one.interval[1]], along="x")
        for aside, _, text in shown:
            chart.beside(1, place, text(one), aside=(aside, 4.5), anchor="end")
    return chart


def _told(one: Endings) -> str:
    share, ways = percent(one.differing / one.runs), (f"{getattr(one, way)} {words}" for way, words in WAYS.items())
    return f"{one.motions}, {one.engine}, {one.kind}: {share} of {one.runs}; {', '.join(ways)}"


def swatches(found: Iterable[Endings]) -> list[tuple[Markup, str]]:
    """(picture, words) of the parts that the bars have."""
    rows = list(found)
    shape = '<rect class="ends-{}" width="31" height="12" x=".5" y="1"/></svg>'
    picture = f'<svg class="chart mini" viewBox="0 0 32 14" aria-hidden="true" style="--c:var(--soft)">{shape}'
    shown = {way: words for way, words in WAYS.items() if any(getattr(one, way) for one in rows)}
    return [(Markup(picture.format(way)), words) for way, words in shown.items()]
