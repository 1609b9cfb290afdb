"""Figures of a study's rows: lines by engine and variant, ranks, maps; and of overturning boundaries.

lines(rows, Column("slenderness γ [rad]", "slenderness"), Column("error, rms [-]", "rms"), "Error of ...",
      panel="ground", log="y", rules=[("y", 1e-3, "trusted")])
shades(rows, Column("base over block mass [-]", "ratio"), Column("slenderness γ [rad]", "slenderness"),
       Column("error, rms [-]", "rms", digits=1), "Error of ...", bounds=(1e-4, 1e-3, 1e-2), panel=NAME.of)
ranks(rows, NAME, Column("share [-]", "share", within="interval"), "Share of ...", Axis("share [-]", 0, 1))

The second half shows how far engines shift the overturning boundaries of the analytic model, and rates them. It takes
a result with rows of the parts "edge" and "shift", or "drawn edge" and "drawn shift". Settings of such a result list
variants, main variants (`default_variants`) and how closely boundaries are known (`tolerance`).
"""

import math
import statistics
from bisect import bisect_right
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from matplotlib.ticker import MaxNLocator

from analytic import PulseMotion
from engines import ENGINES

from ..execution.results import Result
from ..schemas.columns import NAME, Column, Key, Row, number, percent, short, value_of
from .charts import REFERENCE, WIDTH, Axis, Chart, curve, engine_of, figure, key_of, log_axis, room, slanting
from .parts import Figure, Judgement, Mark, Table, grouped, table, where
from .wording import listed

# Marks of the first, second, ... series of one engine; all have the engine's colour, dashes and shape of marks.
LOOKS: tuple[dict[str, Any], ...] = (
    {"filled": True, "small": False},
    {"filled": False, "small": False},
    {"filled": True, "small": True},
    {"filled": False, "small": True},
)
LONGEST = 14  # characters of a name beside a line; longer names stand in the legend alone
Rule = tuple[str, float, str]


@dataclass(frozen=True)
class Series:
    """The series of each engine in `lines`: their names and their looks.

    Parameters
    ----------
    by : key
        Name of a row's series; it is part of the legend's "engine, name".
    grey : function
        Rows whose series are drawn behind in grey. They are not in the legend; the pointer tells their names.
    opened : function
        Rows whose series have open marks; all others are filled. None: looks follow the order of the series.
    like : sequence of dict
        Rows whose series get their looks first. Figures with the same `like` draw a series alike.
    joined : bool
        Whether a line joins the marks.
    says : function
        Words of a row's mark under the pointer. None: series, y and x.
    """

    by: Key = "variant"
    grey: Callable[[Row], bool] = lambda row: False
    opened: Callable[[Row], bool] | None = None
    like: Sequence[Row] = ()
    joined: bool = True
    says: Callable[[Row], str] | None = None

    def name(self, row: Row) -> str:
        """Return the series of a row: its engine, and its name if it has one."""
        return ", ".join(filter(None, (row["engine"], str(value_of(row, self.by)))))

    def looks(self, rows: Iterable[Row]) -> dict[str, dict[str, Any]]:
        """Return {series: keywords of `Chart.dots`}, from all rows, even those with nothing to draw.

        If a single solver has more series than usual looks, each series gets a colour; the model has one usual look.
        """
        ranked = grouped([*self.like, *(row for row in rows if not self.grey(row))], "engine", self.name)
        engines = grouped(ranked, lambda pair: pair[0])
        usual = 1 if (REFERENCE,) in engines else len(LOOKS)
        if len(engines) == 1 and len(ranked) > usual:
            return {who: {"look": curve(rank)} for rank, (_, who) in enumerate(ranked)}
        if self.opened:
            return {who: LOOKS[self.opened(members[0])] for (_, who), members in ranked.items()}
        return {who: LOOKS[rank % len(LOOKS)] for pairs in engines.values() for rank, (_, who) in enumerate(pairs)}


def lines(
    rows: Iterable[Row],
    x: Column,
    y: Column,
    caption: str,
    *,
    panel: Key = lambda row: "",
    series: Series = Series(),  # noqa: B008  # frozen
    log: str = "",
    rules: Sequence[Rule] = (),
) -> Figure | None:
    """Return panels of lines and marks, with a series for each engine and name; None: nothing to draw.

    Where the model alone has several series, each has a colour, dashes and marks of its own, and its name beside it.

    Parameters
    ----------
    rows : iterable of dict
        In the order in which a line joins them, each with its ``engine`` ("analytic": the model, a line without marks).
        Rows whose x or y is None, or not positive on a logarithmic axis, are left out.
    x, y : Column
        Their heads label the axes, which all panels share.
    panel : key
        Title of a row's panel.
    series : Series
        What tells series apart, and how they are drawn.
    log : str
        The logarithmic axes: "", "x", "y" or "xy".
    rules : sequence of (axis, value, words)
        Values to compare with: ("y", 1e-3, "trusted"). Words stand outside the plot, where no line crosses them.
    """
    rows = list(rows)
    shown = [row for row in rows if _has_place(x.of(row), "x" in log) and _has_place(y.of(row), "y" in log)]
    if not shown:
        return None
    axes = _axis("x", x, shown, rules, log), _axis("y", y, shown, rules, log)
    looks, charts = series.looks(rows), []
    coloured = [who for _, who in grouped((row for row in shown if not series.grey(row)), "engine", series.name)]
    labels = _line_labels(coloured, looks) if series.joined else {}
    for (title,), members in grouped(shown, panel).items():
        groups = grouped(members, lambda row: not series.grey(row), series.name)
        says = f"{title + ': ' if title else ''}{y.head} over {x.head}; {', '.join(who for _, who in groups)}."
        chart = _panel(axes, str(title), says, labels, rules)
        for (in_colour, who), points in sorted(groups.items(), key=lambda item: item[0][0]):  # grey ones behind
            _draw_series(chart, series, who, points, x, y, looks[who] if in_colour else None)
            if in_colour and who in labels:
                chart.label(y.of(points[-1]), labels[who], who, look=looks[who].get("look"))
        charts.append(chart)
    keys = {who: key_of(who, joined=series.joined, **looks[who]) for who in coloured}
    return figure(charts, caption, keys, keys)


def _axis(name: str, column: Column, rows: Iterable[Row], rules: Iterable[Rule], log: str) -> Axis:
    """Return the axis "x" or "y" about the values of a column and of the rules, in whole decades or ticks."""
    values = [column.of(row) for row in rows] + [value for along, value, _ in rules if along == name]
    if name in log:
        return log_axis(column.head, values)
    ticks = MaxNLocator(nbins=5, steps=[1, 2, 2.5, 5, 10]).tick_values(min(values), max(values))
    return Axis(column.head, float(ticks[0]), float(ticks[-1]))


def _line_labels(coloured: Sequence[str], looks: Mapping[str, Mapping[str, Any]]) -> dict[str, str]:
    """Return {series: short name at the end of its line}; empty if these names are too long or not unique."""
    labels = {who: who.partition(", ")[2] or who if "look" in looks[who] else engine_of(who) for who in coloured}
    fit = len(set(labels.values())) == len(labels) and all(len(label) <= LONGEST for label in labels.values())
    return labels if fit else {}


def _panel(axes: tuple[Axis, Axis], title: str, says: str, labels: Mapping[str, str], rules: Sequence[Rule]) -> Chart:
    """Return a panel with its rules, and with room for their words and for the names of lines."""
    named = labels or any(along == "y" for along, *_ in rules)
    chart = Chart(
        *axes,
        says,
        title=title,
        height=300 + 20 * (not title),
        right=max(92, 19 + room(labels.values())) if named else 14,
        head=16 * len(rules) * any(along == "x" for along, *_ in rules),
    )
    for line, (along, value, words) in enumerate(rules):
        chart.rule(value, along)
        if along == "y":
            chart.label(value, words, tone="var(--soft)")
        else:
            chart.heading(value, words, line)
    return chart


def _draw_series(
    chart: Chart, series: Series, who: str, points: Sequence[Row], x: Column, y: Column, look: dict[str, Any] | None
) -> None:
    """Draw line and marks of one series; look: of `Series.looks`, None for a grey one. The model has no marks."""
    grey, look = look is None, look or LOOKS[1]
    places = [x.of(row) for row in points], [y.of(row) for row in points]
    if series.joined:
        chart.line(*places, who, grey=grey, look=look.get("look"))
    if engine_of(who) != REFERENCE or "look" in look:
        says = series.says or (lambda row: f"{who}: {y.text(row)} at {x.text(row)}")
        chart.dots(*places, who, grey=grey, says=list(map(says, points)), **look)


def subject(row: Row) -> bool:
    """Return whether the row belongs to a subject engine; other engines are shown for comparison."""
    return row["engine"] in ENGINES and ENGINES[row["engine"]].subject


SUBJECTS = listed([name for name, engine in ENGINES.items() if engine.subject])  # their names, in a sentence


def mains(variants: Iterable[Row]) -> dict[str, str]:
    """Return {engine: main variant} from a result's settings, which list it first; engines need not be installed."""
    return {variant["engine"]: variant["variant"] for variant in reversed([*variants])}


def leading(rows: Sequence[Row], variants: Iterable[Row]) -> list[Row]:
    """Return the rows of the subject engines' main variants if these are tuned; all rows if there is none such.

    variants: as listed in a result's settings, see `mains`.
    """
    main = mains(variants)
    return [
        row for row in rows if row["tier"] == "tuned" and subject(row) and main[row["engine"]] == row["variant"]
    ] or [*rows]


def kind(row: Row) -> str:
    """Return engine and kind of a row's variant: "exudyn, tuned"."""
    return f"{row['engine']}, {row['tier']}"


def as_it_comes(row: Row) -> bool:
    """Return whether a row is of the kind "defaults", which has open marks."""
    return row.get("tier") == "defaults"


def beside(*figures: Figure | None) -> Figure | None:
    """Join figures: panel beside panel, captions one after the other, equal ones once; None: there is no figure."""
    drawn = [picture for picture in figures if picture is not None]
    if not drawn:
        return None
    keys = {who: key for picture in drawn for who, key in picture.keys.items()}
    svg, alt = b"".join(picture.svg for picture in drawn), " ".join(picture.alt for picture in drawn)
    return Figure(svg, alt, " ".join(dict.fromkeys(picture.caption for picture in drawn)), tuple(keys), keys)


def _has_place(value: Any, log: bool) -> bool:
    return value is not None and math.isfinite(value) and (value > 0 or not log)


def ranks(
    rows: Iterable[Row],
    name: Column,
    value: Column,
    caption: str,
    axis: Axis,
    *,
    panel: Key = lambda row: "",
    rules: Sequence[tuple[float, str]] = (),
    opened: Callable[[Row], bool] = lambda row: False,
) -> Figure | None:
    """Return panels of values one below the other, each with its interval; None: nothing to draw.

    Parameters
    ----------
    rows : iterable of dict
        From top to bottom, each with its ``engine`` ("analytic": in ink). Rows whose value is None are left out.
    name : Column
        The words beside a row.
    value : Column
        The value; its ``within`` is the interval.
    axis : Axis
        Axis of the values. A value beyond it stands at its end, with an arrowhead.
    panel : key
        Title of a row's panel.
    rules : sequence of (value, words)
        Lines to compare with, in every panel.
    opened : function
        Rows with an open mark.
    """
    kept = [row for row in rows if value.of(row) is not None]
    charts, engines = [], {row["engine"]: None for row in kept if row["engine"] != REFERENCE}
    for (title,), members in grouped(kept, panel).items():
        names = tuple((place, f"{name.text(row)}\u2002") for place, row in enumerate(members))  # room for a mark at 0
        chart = Chart(
            axis,
            Axis("", len(members) - 0.5, -0.5, ticks=names),
            f"{title + ': ' if title else ''}{value.head} of {', '.join(map(name.text, members))}.",
            title=str(title),
            height=90 + 21 * len(members) + 16 * len(rules),
            left=room(map(name.text, kept)),
            right=24,
            head=16 * len(rules),
        )
        for line, (at, words) in enumerate(rules):
            chart.rule(at)
            chart.heading(at, words, line)
        for place, row in enumerate(members):
            who = "" if row["engine"] == REFERENCE else row["engine"]
            middle, *ends = np.clip([value.of(row), *value.ends(row)], axis.low, axis.high)
            chart.reach([middle], [place], ends[:1] or [middle], ends[1:] or [middle], who, along="x")
            words_of = [f"{name.text(row)}: {value.text(row)}"]
            chart.dots([value.of(row)], [place], who, filled=not opened(row), says=words_of, beyond=True)
        charts.append(chart)
    return figure(charts, caption, engines) if charts else None


def shades(
    rows: Iterable[Row],
    x: Column,
    y: Column,
    value: Column,
    caption: str,
    *,
    bounds: Sequence[float],
    panel: Key = lambda row: "",
    failed: Callable[[Row], str] = lambda row: "",
) -> Figure | None:
    """Return maps of a quantity: a cell for each row, shaded by the bounds that its value passes; None: no rows.

    Parameters
    ----------
    rows : iterable of dict
        One row for each panel and cell. Coordinates stand in the order of their first rows, y upward.
    x, y : Column
        Coordinates; cells are placed by their texts.
    value : Column
        The shaded quantity. Its number stands in the cell; a dash where it is None.
    bounds : sequence of float
        Bounds of the shades, ascending, at most five. The last panel is their scale.
    panel : key
        Title of a row's panel.
    failed : function
        What failed in a row, in a word or two; they replace the number, beside a cross. "": nothing failed.
    """
    rows = list(rows)
    if not rows:
        return None
    across, up = ([text for (text,) in grouped(rows, column.text)] for column in (x, y))
    left, charts = room(up, 44) + 20, []
    foot = 46 + round(0.5 * room(across) * slanting(across, WIDTH - left))
    for (title,), members in grouped(rows, panel).items():
        chart = Chart(
            _category_axis(x.head, across),
            _category_axis(y.head, up),
            f"{title + ': ' if title else ''}{value.head} over {x.head} and {y.head}.",
            title=str(title),
            height=32 + 25 * len(up) + foot,
            left=left,
            foot=foot,
        )
        for row in members:
            failure, text, size = failed(row), value.text(row), value.of(row)
            kind = "shade" if size is None else f"shade s{bisect_right(bounds, size)}"
            words = f"{y.text(row)}, {x.text(row)}: {text}" + (f"; failed: {failure}" if failure else "")
            sign = f"✗ {failure}" if failure else text
            chart.cell(
                across.index(x.text(row)), up.index(y.text(row)), f"{kind} lost" if failure else kind, sign, words
            )
        charts.append(chart)
    return figure([*charts, _shade_scale(value, bounds)], caption)


def regions(
    x: str,
    y: str,
    xs: np.ndarray,
    ys: np.ndarray,
    panels: Mapping[str, np.ndarray],
    kinds: Mapping[str, str],
    *,
    right: int = 14,
) -> tuple[list[Chart], dict[str, str]]:
    """Return maps with too many cells for numbers: (panels to draw more on, {name: picture} for a legend).

    Parameters
    ----------
    x, y : str
        Labels of the axes.
    xs, ys : array
        Centres of the cells, evenly spaced.
    panels : dict
        {title: array of shape (xs, ys), the place of each cell's kind among `kinds`}.
    kinds : dict
        {name: class of its cells, like "s3" or "right"; "" leaves them empty}.
    right : int
        Right margin, for names of lines.
    """
    ends = [(float(at[0] - (at[1] - at[0]) / 2), float(at[-1] + (at[1] - at[0]) / 2)) for at in (xs, ys)]
    charts = []
    for title, places in panels.items():
        says = f"{title + ': ' if title else ''}{', '.join(kinds)}, over {x} and {y}."
        chart = Chart(Axis(x, *ends[0]), Axis(y, *ends[1]), says, title=title, height=300, right=right)
        for place, (name, kind) in enumerate(kinds.items()):
            if kind:
                chart.cells(xs, ys, places == place, kind, name)
        charts.append(chart)
    key = (
        '<svg class="chart mini" viewBox="0 0 32 14" aria-hidden="true"><rect class="{}" width="32" height="14"/></svg>'
    )
    return charts, {name: key.format(kind or "shade") for name, kind in kinds.items()}


def _category_axis(label, words):
    return Axis(label, -0.5, len(words) - 0.5, ticks=tuple(enumerate(words)))


def _shade_scale(value, bounds):
    """Draw the shades with the bounds between them."""
    ticks = tuple((k + 0.5, value.words(bound)) for k, bound in enumerate(bounds))
    scale = Chart(
        Axis(value.head, -0.5, len(bounds) + 0.5, ticks=ticks), Axis("", -0.5, 0.5, ticks=()),
        f"Scale of the shades: {value.head}.", height=100, title="scale",
    )  # fmt: skip
    for k in range(len(bounds) + 1):
        scale.cell(k, 0, f"shade s{k}", "", "")
    return scale


EDGES, SHIFTS = {"edge", "drawn edge"}, {"shift", "drawn shift"}
RATINGS = {"good": "trusted", "fair": "usable", "bad": "not to be trusted"}
LIMIT, FAIR = 0.005, 0.03  # shifts of a trusted and of a usable engine
PLACE = ("ground", "shape", "frequency", "amplitude")
DECADES = (1e-4, 1e-2, 1, 100)  # of a shift, as ticks [%]
EVIDENCE = 50  # failed runs shown, at most
LINE, LANE = 28, 0.27  # height of a variant's row; distance of the grounds in it, as a share of that

GROUND, PULSE = Column("ground", "ground"), Column("pulse", "shape")
FREQUENCY = Column("pulse frequency over rocking frequency [-]", "frequency", digits=None)
AMPLITUDE = Column("amplitude over g tan γ [-]", "amplitude", digits=6)
SHIFT = Column("shift of the boundary, absolute [%]", lambda row: 100 * abs(row["shift"]))
NORMAL = Column("least N/(m g) of the analytic model [-]", "min_normal")
FOUND = Column("found [-]", "{found} of {of}")
MEDIAN = Column("median shift [%]", lambda row: row["median"] and 100 * row["median"])
LARGEST = Column("largest shift [%]", lambda row: row["largest"] and 100 * row["largest"])


def place(row: Row) -> tuple[Any, ...]:
    """Return the key of the boundary that a row is about: its values of `PLACE`."""
    return tuple(row[key] for key in PLACE)


def pressed(result: Result) -> set[tuple[Any, ...]]:
    """Return the places of the boundaries at which the block stays pressed on its base, N >= 0."""
    return {place(edge) for edge in where(result.rows, part=EDGES) if edge["min_normal"] >= 0}


def strip(result: Result, title: str) -> Figure | None:
    """Draw each boundary at its shift, in a row for each main variant and each variant of the kind "defaults".

    Return None if no such variant was run.
    """
    settings, main = result.settings, result.settings["default_variants"]
    rows = grouped(where(result.rows, part=SHIFTS), NAME.of)
    stored = [variant for variant in settings["variants"] if (NAME.of(variant),) in rows]
    shown = [variant for variant in stored if as_it_comes(variant) or main.get(variant["engine"]) == variant["variant"]]
    shown = sorted(shown, key=lambda variant: not subject(variant))
    if not shown:
        return None
    left_out = "; ".join(NAME.of(variant) for variant in stored if variant not in shown)
    sound, grounds = pressed(result), list(settings.get("grounds", ()))
    lanes = (
        f"Marks in a row, from top to bottom: {', '.join(grounds)}. Short bars, and the number after +: boundaries at "
        "which the model has N\u00a0<\u00a00; they do not count. "
    )
    caption = (
        f"Shift of each boundary, known to ±\u00a0{percent(settings['tolerance'] / 2, 1)}. {lanes if grounds else ''}"
        "Filled marks: tuned; open marks: defaults. Cross at the right, with a number: so many boundaries were not "
        "found. Arrowhead: the shift is smaller than the axis shows."
        + f" Not drawn, but in the table: {left_out}."
        * bool(left_out)
    )
    return figure([_strip_chart(shown, rows, sound, grounds, title)], caption)


def _strip_chart(shown, rows, sound, grounds, title):
    names = list(map(kind, shown))
    known = [SHIFT.of(row) for group in rows.values() for row in group if row["shift"]]
    axis = log_axis(SHIFT.head, [*known, 100 * LIMIT])
    summaries, not_found = [], []
    for variant in shown:
        members = rows[NAME.of(variant),]
        located = [row for row in members if row["shift"] is not None]
        largest = percent(max((abs(row["shift"]) for row in located), default=None))
        summaries.append(f"{NAME.of(variant)} {len(located)} of {len(members)} found, largest {largest}")
        held_down = [place(row) in sound for row in members if row["shift"] is None]
        not_found.append((held_down.count(True), held_down.count(False)))
    chart = Chart(
        Axis(axis.label, axis.low, axis.high, "log", tuple((tick, short(tick)) for tick in DECADES)),
        Axis(
            "", len(shown) - 0.5, -0.5, ticks=tuple((k, f"{name}\u2002") for k, name in enumerate(names))
        ),  # room for an arrowhead
        f"{SHIFT.head}: {'; '.join(summaries)}.",
        title=title,
        height=92 + LINE * len(shown),
        left=room(names),
        right=58,
        head=16,
    )
    chart.rule(100 * LIMIT)
    chart.heading(100 * LIMIT, "trusted")
    chart.beside(axis.high, -0.5, "not found", aside=(54, -5), anchor="end")
    for line, (variant, name) in enumerate(zip(shown, names, strict=True)):
        _draw_boundaries(chart, line, name, rows[NAME.of(variant),], sound, grounds, not as_it_comes(variant))
        if any(not_found[line]):
            chart.dots([axis.high], [line], name, mark="x", says=[f"{name}: {sum(not_found[line])} not found"])
            words = f"{not_found[line][0]}" + f" + {not_found[line][1]}" * bool(not_found[line][1])
            chart.beside(axis.high, line, words, who=name, aside=(8, 4.5))
    return chart


def _draw_boundaries(chart, line, name, members, sound, grounds, filled):
    """Draw the boundaries of a variant that were found; as bars those at which the model holds the corner down."""
    located = [row for row in members if row["shift"] is not None]
    for held_down in (False, True):
        group = [row for row in located if (place(row) in sound) == held_down]
        lanes = [grounds.index(row["ground"]) if row["ground"] in grounds else len(grounds) for row in group]
        texts = [
            f"{NAME.of(row)}: {percent(row['shift'])} on {row['ground']}, {row['shape']}, frequency "
            f"{number(row['frequency'])}, amplitude {number(row['amplitude'])}"
            for row in group
        ]
        chart.dots(
            [SHIFT.of(row) for row in group],
            [line + LANE * (lane - len(grounds) / 2) for lane in lanes],
            name,
            filled=filled,
            small=held_down,
            says=texts,
            mark=None if held_down else "|",
            beyond=True,
        )


def rated(result: Result) -> Iterator[dict[str, Any]]:
    """Yield a summary and a rating of each variant at its default level, over boundaries with N >= 0.

    wrong, of outcomes: outcomes outside the band of the boundaries. beyond: counts of boundaries with N < 0.
    """
    sound = pressed(result)
    for (name,), members_and_others in grouped(where(result.rows, part=SHIFTS), NAME.of).items():
        members, beyond_others = (
            [row for row in members_and_others if (place(row) in sound) == inside] for inside in (True, False)
        )
        beyond = summary(beyond_others) if beyond_others else {"of": 0, "found": 0, "largest": None}
        counts = [row for row in where(result.rows, part="confusion", region="outside") if NAME.of(row) == name]
        counted, wrong = summary(members), sum(row["only_a"] + row["only_b"] for row in counts)
        complete = counted["found"] == counted["of"]
        good = complete and counted["largest"] <= LIMIT and not wrong
        rating = "good" if good else "fair" if complete and counted["largest"] <= FAIR else "bad"
        outcomes = wrong + sum(row["both_stand"] + row["both_overturn"] for row in counts)
        yield {
            **counted,
            "rating": rating,
            "wrong": wrong,
            "outcomes": outcomes,
            "beyond": beyond["of"],
            "beyond_found": beyond["found"],
            "beyond_largest": beyond["largest"],
        }


def summary(rows: Sequence[Row]) -> dict[str, Any]:
    """Return how many of these boundaries of a variant were found, and their shifts."""
    located = [row for row in rows if row["shift"] is not None]
    shifts = [abs(row["shift"]) for row in located]
    return {
        "engine": rows[0]["engine"],
        "variant": rows[0]["variant"],
        "of": len(rows),
        "found": len(located),
        "gaps": f"{sum(not row['rises'] for row in located)} of {sum(not row['rises'] for row in rows)}",
        "median": statistics.median(shifts) if shifts else None,
        "largest": max(shifts, default=None),
    }


def judged(result: Result, what: str) -> Judgement:
    """Return the study's row of the table of trust. what: the motions of the boundaries, in the plural."""
    marks = {}
    for row in rated(result):
        counts = f"{row['found']} of {row['of']} {what}"
        words = f"none found ({what})" if row["largest"] is None else f"{percent(row['largest'])} ({counts})"
        note = f"{what}: median {percent(row['median'])}; {row['of'] - row['found']} not found"
        if row["beyond"]:
            note += f"; {row['beyond']} with N < 0 do not count: {row['beyond_found']} found"
            note += f", largest shift {percent(row['beyond_largest'])}" if row["beyond_found"] else ""
        marks[row["engine"], row["variant"]] = Mark(words, row["rating"], note, row["largest"])
    return Judgement("largest shift of an overturning boundary under pulses", marks)


def largest(result: Result) -> str:
    """Return a clause: the largest shift, and how many boundaries were not found.

    It is over the engines' main variants that are tuned; over all main variants if none is tuned.
    """
    main = result.settings["default_variants"]
    tuned = {NAME.of(variant) for variant in result.settings["variants"] if variant["tier"] == "tuned"}
    best = [row for row in rated(result) if main[row["engine"]] == row["variant"]]
    chosen = [row for row in best if NAME.of(row) in tuned]
    how, chosen = ("tuned engines", chosen) if chosen else ("engines not tuned", best)
    most = max((row["largest"] for row in chosen if row["largest"] is not None), default=None)
    missed = [f"{row['found']} of {row['of']} ({row['engine']})" for row in chosen if row["found"] < row["of"]]
    words = f"{how} shift the overturning boundary by at most {percent(most)}"
    return f"{words}, but find only {listed(missed)} boundaries" if missed else words


def under_jumps(result: Result) -> Iterator[str]:
    """Yield a sentence on the engines whose largest shift is under a pulse that begins with a jump, if any."""
    main = result.settings["default_variants"]
    rows = where(result.rows, part=SHIFTS)
    sound, clauses = pressed(result), []
    for engine in main:
        members = [
            row for row in where(rows, engine=engine, variant=main[engine]) if row["shift"] and place(row) in sound
        ]
        worst = max(members, key=lambda row: abs(row["shift"]), default=None)
        if worst and PulseMotion(worst["shape"], 1.0, 1.0, start=1.0).jumps:
            clauses.append(f"{percent(worst['shift'])} under a {worst['shape']} pulse in {engine}")
    if clauses:
        yield f"The shift is largest under pulses whose acceleration begins with a jump: {listed(clauses)}."


def listing(caption: str, edges: Iterable[Row], shifts: Sequence[Row], *columns: Column) -> Table:
    """Return a table of boundaries, with more columns, and a column of shifts for each variant."""
    shift_of = {(NAME.of(row), *place(row)): row["shift"] for row in shifts}

    def shift(name, edge):
        value = shift_of.get((name, *place(edge)))
        return "not found" if value is None else number(100 * value, 2)

    return table(
        caption,
        edges,
        GROUND,
        *columns,
        PULSE,
        FREQUENCY,
        AMPLITUDE,
        Column("overturning", lambda row: "begins" if row["rises"] else "ends"),
        Column("after impacts [-]", "mode"),
        NORMAL,
        *(Column(f"{name} [%]", partial(shift, name)) for name in dict.fromkeys(NAME.of(row) for row in shifts)),
    )


def missing(result: Result) -> Table:
    """Return a table of the boundaries that were not found, and why."""
    return table(
        "Boundaries not found by a search within 30 %, or as far as half-way to the next boundary",
        where(result.rows, part=SHIFTS, shift=None),
        NAME,
        GROUND,
        PULSE,
        FREQUENCY,
        AMPLITUDE,
        Column("half-way to the next boundary", "room", percent=True),
        Column("why", lambda row: row["reason"].replace("-", "−")),
    )


def failures(result: Result) -> tuple[tuple[str, str], ...]:
    """Return (run, reason and message) of runs without an outcome, at most `EVIDENCE` of them."""
    return tuple(
        (
            f"{NAME.text(row)}, {row['ground']}, {row['shape']}, frequency {row['frequency']:g}, amplitude "
            f"{row['amplitude']:.6g}",
            f"{row['reason']}\n{row.get('message') or ''}",
        )
        for row in where(result.rows, part="failure")[:EVIDENCE]
    )
