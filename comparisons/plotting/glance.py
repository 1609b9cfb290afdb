"""What studies give to the report's first screen, and its two charts: error against cost, and how runs end; each once
for a wide page and once for a phone, of which a style shows one.
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
from .parts import Figure, grouped, setting_of


@dataclass(frozen=True)
class Endings:
    """How many runs of a variant end otherwise than the model's, under one kind of motion.

    kind: of the variant. runs: those judged, away from the model's outcome boundaries; of these failed; missed:
    overturn in the model alone; added: in the engine alone; other: neither overturns, and the outcome is another; late:
    both overturn, at another time, None: not asked; untold: another outcome or failed, which of them is not known.
    interval: 95 % of the share of all six. left_out: further runs, near a boundary; left_differing: those of them that
    overturn in engine or model alone, or failed, None: not known.
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
        """Runs with another outcome, or none."""
        return self.failed + self.missed + self.added + self.other + self.untold

    @property
    def differing(self) -> int:
        return self.changed + (self.late or 0)


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
class Advised:
    """A level that is recommended for an accuracy [-], or that none keeps it: engine "". parameter, level: what is set,
    and its value; cost: CPU time [s/s]; command: which sets it.

    elsewhere: {what was measured in another scene: its error [-], None where the run has none}.
    """

    accuracy: float
    engine: str = ""
    variant: str = ""
    parameter: str = ""
    level: float = math.nan
    cost: float = math.nan
    command: str = ""
    elsewhere: Mapping[str, float | None] = field(default_factory=dict)

    @property
    def setting(self) -> str:
        return setting_of(vars(self))


@dataclass(frozen=True)
class Peaks:
    """How far the peak tilt of a variant's runs is off at one level, over slenderness, of runs that have a peak."""

    motions: str
    engine: str
    variant: str
    parameter: str
    level: float
    errors: tuple[float, ...]

    @property
    def setting(self) -> str:
        return setting_of(vars(self))

    def within(self, error: float) -> str:
        kept = [one <= error for one in self.errors]
        return f"{sum(kept)} of {len(kept)} ({percent(sum(kept) / len(kept))})" if kept else "none has a peak"


@dataclass(frozen=True)
class Glance:
    """What a study gives to the report's first screen.

    says: {place in the answer: a sentence}. endings: of variants. curves: of solvers, in the scene that is called
    `scene`. advice: the recommendation by accuracy, of the engines `asked`, judged in that scene; alike: the factor
    below which costs are the same. peaks: by which a recommendation is seen elsewhere.
    """

    says: Mapping[str, str] = field(default_factory=dict)
    endings: tuple[Endings, ...] = ()
    curves: tuple[Curve, ...] = ()
    scene: str = ""
    advice: tuple[Advised, ...] = ()
    asked: tuple[str, ...] = ()
    alike: float = 1.0
    peaks: tuple[Peaks, ...] = ()


WIDE = 590
WORST = 1.0  # of errors; what lies beyond stands at the frame
FINEST = -6  # power of ten at which the errors end where no engine has one
LINE = 15  # height of a row of the second chart
COLUMNS: tuple[tuple[int, str, Callable[[Endings], str]], ...] = (
    (80, "differ", lambda one: f"{one.differing} of {one.runs}"),
    (130, "missed", lambda one: _way(one, "missed")),
    (176, "added", lambda one: _way(one, "added")),
    (216, "other", lambda one: _way(one, "other")),
    (248, "late", lambda one: _way(one, "late")),
    (292, "failed", lambda one: _way(one, "failed")),
    (350, "left out", lambda one: _left_out(one)),
)  # beside the bars: where a column ends, its head, its words
WAYS = {
    "missed": "overturning missed",
    "added": "overturning added",
    "other": "another outcome",
    "late": "falls at another time",
    "failed": "failed",
    "untold": "another outcome or failed",
}


def _way(one, way):
    """How many end in that way, where that is known."""
    count = getattr(one, way)
    return "–" if count is None or (one.untold and way != "late") else str(count)


def _left_out(one):
    return f"{'–' if one.left_differing is None else one.left_differing} of {one.left_out}" if one.left_out else "0"


def counted(motions: str, rows: Iterable[Mapping[str, Any]]) -> tuple[Endings, ...]:
    """The `Endings` of every variant from its runs: rows of a study, each with engine, variant and its kind, and its
    class; falls and model_falls, whether the block overturns, falls None where the run failed; changed: whether the
    outcome is another; group: runs of one count as one in the interval.
    """
    found = []
    for (engine, variant, kind), every in grouped(rows, "engine", "variant", "tier").items():
        left, runs = ([row for row in every if (row["class"] == "left out") == out] for out in (True, False))
        wrong = [row for row in runs if row["class"] == "differs"]
        ways = [(row["model_falls"], row["falls"]) for row in wrong]
        missed, added = ways.count((True, False)), ways.count((False, True))
        failed = sum(row["class"] == "failed" for row in runs)
        late = sum(not row["changed"] for row in wrong)
        _, interval = equality([row["class"] != "right" for row in runs], [row["group"] for row in runs])
        counts = len(runs), failed, missed, added, len(wrong) - missed - added - late
        near = sum(row["falls"] != row["model_falls"] for row in left)
        found.append(Endings(motions, engine, variant, kind, *counts, interval, late, 0, len(left), near))
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
        "Each mark is one step size, stiffness or tolerance. Crosses: levels at which impacts were missed. Open marks: "
        "defaults that missed none. Marks on the edge lie outside the plot. Lower left is better."
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
    places, ordered = {}, sorted(shown, key=lambda one: one.subject)
    drawn = [
        [(cpu, min(max(error, 10.0**finest), WORST), sound, says) for cpu, error, sound, says in one.points]
        for one in ordered
    ]
    for one, points in zip(ordered, drawn, strict=True):
        cpu, errors, *_ = zip(*points, strict=True)
        chart.line(cpu, errors, one.who, thin=not one.subject)
        places[one.who] = chart.at(cpu, errors)
    for missed in (False, True):  # crosses last: no mark hides that impacts were missed
        for one, points in zip(ordered, drawn, strict=True):
            some = [point for point in points if point[2] != missed]
            chart.dots(
                [point[0] for point in some],
                [point[1] for point in some],
                one.who,
                filled=missed or one.kind != "defaults",  # a cross has no inside to leave open
                small=not one.subject and one.kind != "model",
                says=[point[3] for point in some],
                mark="x" if missed else None,
            )
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
        "Lines: 95 % intervals, runs under one motion as one. Missed, added: overturns in the model alone, in the "
        "engine alone. Other: stands, slides or rocks instead. Late: both overturn, at another time. Failed: no "
        "result, or unphysical. Left out, in every row: runs near an outcome boundary of the model, where a change of "
        "the scene by 10⁻⁴ changes its end (pulses: within 1 % of the boundary); of them are counted those that "
        "overturn in engine or model alone, or fail. –: not asked, or not stored. Defaults: fewer scenes. Pulses under "
        "which the block would jump are not counted."
    )
    return broad(_endings(rows, WIDE), [_endings(rows, WIDTH)], caption)


def _endings(rows: Sequence[Endings], width: int) -> Chart:
    lines: list[Endings | str] = []
    for (motions,), members in grouped(rows, lambda one: one.motions).items():
        lines += [motions, *members]
    shown = COLUMNS if width == WIDE else COLUMNS[:1]
    chart = Chart(
        Axis("", 0, 1, ticks=((0, "0"), (0.5, "50"), (1, "100 %"))),
        Axis("", len(lines) - 0.4, -0.6, ticks=()),
        f"Share of runs whose outcome differs: {'; '.join(map(_told, rows))}.",
        height=52 + LINE * len(lines),
        width=width,
        left=12 + round(LETTER * 0.57 * max(len(f"{one.engine}, {one.kind}") for one in rows)),
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
    share = percent(one.differing / one.runs)
    ways = [f"{count} {words}" for way, words in WAYS.items() if (count := getattr(one, way))]
    return f"{one.motions}, {one.engine}, {one.kind}: {'; '.join((f'{share} of {one.runs}', *ways))}"


def swatches(found: Iterable[Endings]) -> list[tuple[Markup, str]]:
    """(picture, words) of the parts that the bars have."""
    rows = list(found)
    shape = '<rect class="ends-{}" width="31" height="12" x=".5" y="1"/></svg>'
    picture = f'<svg class="chart mini" viewBox="0 0 32 14" aria-hidden="true" style="--c:var(--soft)">{shape}'
    shown = {way: words for way, words in WAYS.items() if any(getattr(one, way) for one in rows)}
    return [(Markup(picture.format(way)), words) for way, words in shown.items()]
