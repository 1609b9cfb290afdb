"""Studies' parts of the report's first screen, and its two charts: error against cost, ends of runs.

Each chart is drawn for a wide page and for a phone; a style shows one of them.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from ..metrics.statistics import equality
from ..schemas.columns import percent, short
from .charts import LETTER, SHAPES, WIDTH, Axis, Chart, broad, engine_of, legend_height
from .names import Named, write_names
from .parts import Figure, Table, grouped
from .wording import listed


@dataclass(frozen=True)
class Endings:
    """Counts of a variant's runs that end otherwise than the model's, under one kind of motion.

    motions: the kind of motion. kind: of the variant. runs: judged runs, away from the model's outcome boundaries. Five
    counts of them: failed; missed, the block overturns in the model alone; added, in the engine alone; other, neither
    overturns and the outcomes differ; late, both overturn, at different times (None: not tested). interval: 95 %
    interval of the share of all five.

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
    left_out: int = 0
    left_differing: int | None = None

    @property
    def changed(self) -> int:
        """Number of runs with another outcome, or none."""
        return self.failed + self.missed + self.added + self.other

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

    says: {line of the first screen: (answer, details)}, in sentences. endings: by motion and variant. curves: of
    solvers, in the scene named `scene`. advice: tables of which level to use. levels: (engine, level) of the cost that
    is given. missed: {(engine, level): (random statues on which it misses the accuracy of that cost, all that stay
    upright)}. chart: `costs` of the curves, which the report draws and keeps.
    """

    says: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    endings: tuple[Endings, ...] = ()
    curves: tuple[Curve, ...] = ()
    scene: str = ""
    advice: tuple[Table, ...] = ()
    levels: tuple[tuple[str, float], ...] = ()
    missed: Mapping[tuple[str, float], tuple[int, int]] = field(default_factory=dict)
    chart: Figure | None = None


WIDE = 590
WORST = 1.0  # largest error on the axis; a larger one stands at the frame
FINEST = -6  # power of ten at which the axis of errors ends if no engine has an error
LINE = 17  # height of a row of the second chart
NAMES = {"late": "time"}  # of ways that are not called as their field
COLUMNS: tuple[tuple[int, str, Callable[[Endings], str]], ...] = (
    (74, "outcome", lambda row: f"{row.changed} of {row.runs}"),
    (127, "missed", lambda row: _count_text(row, "missed")),
    (172, "added", lambda row: _count_text(row, "added")),
    (211, "other", lambda row: _count_text(row, "other")),
    (258, "failed", lambda row: _count_text(row, "failed")),
    (293, NAMES["late"], lambda row: _count_text(row, "late")),
    (355, "left out", lambda row: _left_out_text(row)),
)  # beside the bars: where a column ends, its head, its words
PHONE_COLUMNS = (COLUMNS[0], (138, *COLUMNS[-1][1:]))
WAYS = {
    "missed": "overturning missed",
    "added": "overturning added",
    "other": "another outcome",
    "failed": "failed",
    "late": "falls at another time",
}


def _count_text(row, way):
    """Return how many runs end in that way; a question mark where that is not known."""
    count = getattr(row, way)
    return "?" if count is None else str(count)


def _left_out_text(row):
    return f"{'?' if row.left_differing is None else row.left_differing} of {row.left_out}" if row.left_out else "0"


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
        endings_of.append(Endings(motions, engine, variant, kind, *counts, interval, late, len(left), near))
    return tuple(endings_of)


def costs(curves: Sequence[Curve]) -> Figure:
    """Draw error over cost: a curve through the levels of each solver, its name beside it.

    A phone has no room for the names of all: there only subject engines and the model are drawn, if there are any.
    """
    caption = (
        "Each mark is one step size, stiffness or tolerance. Marks on the edge lie outside the plot. "
        "Lower left is better."
    )
    drawn = [curve for curve in curves if curve.points]
    few = [curve for curve in drawn if curve.subject or curve.kind == "model"]
    few = few if any(curve.subject for curve in few) else drawn
    others = list(dict.fromkeys(engine_of(curve.who) for curve in drawn if curve not in few))
    title = f"Without {listed(others)}" if others else ""
    return broad(_cost_chart(drawn, WIDE), [_cost_chart(few, WIDTH, title)], caption)


def _cost_chart(shown: Sequence[Curve], width: int, title: str = "") -> Chart:
    values = [cpu for curve in shown for cpu, *_ in curve.points]
    low, high = math.floor(math.log10(min(values))), math.ceil(math.log10(max(values)))
    decades = tuple((10.0**power, _seconds(power)) for power in range(low, high + 1))
    engines = [error for curve in shown for _, error, *_ in curve.points if error and curve.kind != "model"]
    finest = math.floor(math.log10(min(engines))) - 1 if engines else FINEST  # one more, for names at the frame
    shares = tuple((10.0**power, f"{short(10.0 ** (power + 2))} %") for power in range(finest, 1))
    x = Axis("CPU time per simulated second", 10.0**low, 10.0**high, "log", decades)
    y = Axis("error of peak tilt / slenderness γ", 10.0**finest, WORST * 1.0001, "log", shares)
    says = f"Error of peak tilt over CPU time of {', '.join(curve.who for curve in shown)}."
    keys = _cost_keys(shown)
    head = legend_height(keys, width)
    chart = Chart(
        x, y, says, height=500 + head, width=width, left=72, right=16 + 20 * (width == WIDE), head=head, title=title
    )
    chart.legend(keys)
    places, ordered = {}, sorted(shown, key=lambda curve: curve.subject)
    drawn = [
        [(cpu, min(max(error, y.low), WORST), sound, says) for cpu, error, sound, says in curve.points]
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
    names = [
        Named(name, members[0].who, members[0].subject, [places[curve.who] for curve in members])
        for (name,), members in grouped(shown, lambda curve: curve.name).items()
    ]
    # the subjects' first, then those with few marks, which leave the least choice
    write_names(chart, sorted(names, key=lambda named: (not named.bold, sum(map(len, named.curves)))))
    return chart


def _cost_keys(shown):
    """Return (picture, words) of marks that are not the engine's own, where they occur."""
    missed = any(not sound for curve in shown for *_, sound, _ in curve.points)
    opened = any(sound for curve in shown if curve.kind == "defaults" for *_, sound, _ in curve.points)
    keys = (("dot", "x", "impacts missed", missed), ("dot open", "o", "defaults, no impact missed", opened))
    return [(f'<path class="{kind}" d="{SHAPES[mark]}"/>', words) for kind, mark, words, occurs in keys if occurs]


def _seconds(power: int) -> str:
    """Return a power of ten of a second in words."""
    return f"{10.0**power:g} s" if power >= 0 else f"{10.0 ** (power + 3):g} ms"


def endings(shares: Sequence[Endings]) -> Figure:
    """Draw the shares of runs that end otherwise than the model's, motion by motion."""
    caption = (
        "Outcome: another one than the model’s, or failed. Its parts: missed, the block overturns in the model alone; "
        "added, in the engine alone; other; failed, no result or an unphysical one. Time: the block overturns in "
        "both, at another time or after another number of impacts. Lines: 95 % intervals of outcome and time "
        "together, in which runs under one motion count as one. Left out of all: runs near an outcome boundary, where "
        "a change of the scene by 10⁻⁴ (of a pulse by 1 %) changes how the model ends; before “of”: how many of these "
        "fail, or overturn in engine or model alone. ?: not tested, or not stored. Under some motions defaults were "
        "run in fewer scenes. Not counted: pulses under which the block would jump, stacked blocks that leave the "
        "model, random statues without friction, and hard cases."
    )
    return broad(_endings_chart(shares, WIDE), [_endings_chart(shares, WIDTH)], caption)


def _endings_chart(rows: Sequence[Endings], width: int) -> Chart:
    """Draw a bar for each row, counts beside it; on a phone those of its ways stand in a line below it."""
    wide = width == WIDE
    columns = COLUMNS if wide else PHONE_COLUMNS
    keys = [
        (f'<rect class="ends-{way}" x="-12" y="-5.5" width="24" height="11"/>', NAMES.get(way, way))
        for way in WAYS
        if any(getattr(row, way) for row in rows)
    ]
    places: list[tuple[float, Endings | str]] = []
    end = 0.0
    for (motions,), members in grouped(rows, lambda row: row.motions).items():
        places.append((end, motions))
        end += 1
        for row in members:
            places.append((end, row))
            end += 1 if wide or not row.differing else 2
        end += 0.5  # no head touches the rows above
    head = legend_height(keys, width) + 14
    chart = Chart(
        Axis("", 0, 1, ticks=((0, "0"), (0.5, "50"), (1, "100 %"))),
        Axis("", end - 0.8, -0.8, ticks=()),
        f"Share of runs whose outcome differs: {'; '.join(map(_in_words, rows))}.",
        height=40 + head + round(LINE * end),
        width=width,
        left=8 + round(LETTER * 0.57 * max(len(f"{row.engine}, {row.kind}") for row in rows)),
        right=columns[-1][0] + 6,
        head=head,
    )
    chart.legend(keys)
    for aside, heading, _ in columns:
        chart.beside(1, -0.8, heading, aside=(aside, -5), anchor="end")
    for place, row in places:
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
        for aside, _, text in columns:
            chart.beside(1, place, text(row), aside=(aside, 4.5), anchor="end")
        if row.differing and not wide:
            ways = ", ".join(f"{count} {NAMES.get(way, way)}" for way in WAYS if (count := getattr(row, way)))
            chart.beside(1, place + 0.9, ways, aside=(columns[0][0], 4.5), anchor="end", kind="soft clear")
    return chart


def _in_words(row: Endings) -> str:
    share = percent(row.differing / row.runs)
    ways = [f"{count} {words}" for way, words in WAYS.items() if (count := getattr(row, way))]
    return f"{row.motions}, {row.engine}, {row.kind}: {'; '.join((f'{share} of {row.runs}', *ways))}"
