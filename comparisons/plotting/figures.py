"""From a study's rows to figures: lines and marks by engine and variant, values one below the other, and maps.

lines(rows, Column("slenderness γ [rad]", "slenderness"), Column("error, rms [-]", "rms"), "Error of ...",
      panel="ground", log="y", rules=[("y", 1e-3, "trusted")])
shades(rows, Column("base over block mass [-]", "ratio"), Column("slenderness γ [rad]", "slenderness"),
       Column("error, rms [-]", "rms", digits=1), "Error of ...", bounds=(1e-4, 1e-3, 1e-2), panel=NAME.of)
ranks(rows, NAME, Column("share [-]", "share", within="interval"), "Share of ...", Axis("share [-]", 0, 1))

Overturning boundaries of engines beside those of the analytic model: each at its shift, how far off, and how rated.

Of a result with rows "edge" and "shift", or "drawn edge" and "drawn shift"; its settings list variants, main variants
(`default_variants`) and how closely boundaries are known (`tolerance`).
"""

import math
import statistics
from bisect import bisect_right
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
from matplotlib.ticker import MaxNLocator

from analytic import PulseMotion
from engines import ENGINES

from ..execution.provenance import Result
from ..schemas.columns import NAME, Column, Key, Row, number, percent, short, value_of
from .charts import REFERENCE, WIDTH, Axis, Chart, curve, figure, key_of, log_axis, room, slanting
from .parts import Figure, Judgement, Mark, Table, grouped, table, where
from .wording import listed

# Of the first, second, ... series of one engine; all have the engine's colour, dashes and shape of marks.
LOOKS: tuple[dict[str, Any], ...] = (
    {"filled": True, "small": False},
    {"filled": False, "small": False},
    {"filled": True, "small": True},
    {"filled": False, "small": True},
)
LONGEST = 14  # characters of a name beside a line; longer ones stand in the legend alone
Rule = tuple[str, float, str]


def lines(
    rows: Iterable[Row],
    x: Column,
    y: Column,
    caption: str,
    *,
    panel: Key = lambda row: "",
    by: Key = "variant",
    grey: Callable[[Row], bool] = lambda row: False,
    log: str = "",
    rules: Sequence[Rule] = (),
    says: Callable[[Row], str] | None = None,
    joined: bool = True,
    like: Iterable[Row] = (),
    opened: Callable[[Row], bool] | None = None,
) -> Figure | None:
    """Panels of lines and marks, one series for each engine and what tells its series apart; None: nothing to draw.

    Where the model alone has several, each has a colour, dashes and marks of its own, and its name beside it.

    Parameters
    ----------
    rows : iterable of dict
        In the order in which a line joins them, each with its ``engine`` ("analytic": the model, a line without marks).
        Rows whose x or y is None, or not positive on a logarithmic axis, are left out.
    x, y : Column
        Their heads label the axes, which all panels share.
    panel : key
        Title of a row's panel.
    by : key
        What tells the series of an engine apart: a name, part of the legend's "engine, name".
    grey : function
        Rows whose series stand behind in grey, out of the legend, named under the pointer alone.
    log : str
        The logarithmic axes: "", "x", "y" or "xy".
    rules : sequence of (axis, value, words)
        Values to compare with: ("y", 1e-3, "trusted"). Words stand outside the plot, where no line crosses them.
    says : function
        What a row's mark tells under the pointer; without it series, y and x.
    joined : bool
        Whether a line joins the marks.
    like : iterable of dict
        Rows whose series get their looks first: figures of the same `like` draw a series alike.
    opened : function
        Rows whose series have open marks, all others filled ones, in place of looks in the order of the series.
    """
    rows = list(rows)
    kept = [row for row in rows if _drawn(x.of(row), "x" in log) and _drawn(y.of(row), "y" in log)]
    if not kept:
        return None

    def name(row):
        return ", ".join(filter(None, (row["engine"], str(value_of(row, by)))))

    def axis(which, column):
        values = [column.of(row) for row in kept] + [value for along, value, _ in rules if along == which]
        return log_axis(column.head, values) if which in log else _linear_axis(column.head, values)

    coloured = list(grouped((row for row in kept if not grey(row)), "engine", name))
    # of all rows: a series looks the same where another of its engine's has nothing to draw
    ranked = grouped([*like, *(row for row in rows if not grey(row))], "engine", name)
    engines = grouped(ranked, lambda pair: pair[0]).values()
    looks = {who: LOOKS[rank % len(LOOKS)] for pairs in engines for rank, (_, who) in enumerate(pairs)}
    if opened:
        looks = {who: LOOKS[opened(members[0])] for (_, who), members in ranked.items()}
    looks |= _of_one([who for _, who in ranked], {engine for engine, _ in ranked})
    panels = grouped(kept, panel)
    names = {who: who.removeprefix(f"{engine}, ") if "look" in looks[who] else engine for engine, who in coloured}
    ends = joined and len(set(names.values())) == len(coloured) and max(map(len, names.values()), default=0) <= LONGEST
    charts = []
    for (title,), members in panels.items():
        series = grouped(members, lambda row: not grey(row), "engine", name)
        chart = Chart(
            axis("x", x),
            axis("y", y),
            f"{title + ': ' if title else ''}{y.head} over {x.head}; {', '.join(who for *_, who in series)}.",
            title=str(title),
            height=300 + 20 * (not title),
            right=max(92, 19 + room(names.values()) * ends) if ends or any(along == "y" for along, *_ in rules) else 14,
            head=16 * len(rules) * any(along == "x" for along, *_ in rules),
        )
        for line, (along, value, words) in enumerate(rules):
            chart.rule(value, along)
            if along == "y":
                chart.label(value, words, tone="var(--soft)")
            else:
                chart.heading(value, words, line)
        for (shown, engine, who), points in sorted(series.items(), key=lambda item: item[0][0]):
            places = [x.of(row) for row in points], [y.of(row) for row in points]
            told = [says(row) if says else f"{who}: {y.text(row)} at {x.text(row)}" for row in points]
            look = looks[who] if shown else LOOKS[1]
            if joined:
                chart.line(*places, who, grey=not shown, look=look.get("look"))
            if engine != REFERENCE or "look" in look:
                chart.dots(*places, who, grey=not shown, says=told, **look)
            if ends and shown:
                chart.label(places[1][-1], names[who], who, look=look.get("look"))
        charts.append(chart)
    keys = {who: key_of(who, joined=joined, **looks[who]) for _, who in coloured}
    return figure(charts, caption, keys, keys)


def subject(row: Row) -> bool:
    """Whether a row is of an engine in question; the others are shown for comparison."""
    return row["engine"] in ENGINES and ENGINES[row["engine"]].subject


def mains(variants: Iterable[Row]) -> dict[str, str]:
    """{engine: its main variant}: the first that settings list, as engines need not be installed to be shown."""
    return {one["engine"]: one["variant"] for one in reversed([*variants])}


def leading(rows: Sequence[Row], variants: Iterable[Row]) -> list[Row]:
    """Of rows of variants those of the tuned main variants of the engines in question; all of them if there are none.

    variants: those that settings list, as of `mains`.
    """
    main = mains(variants)
    return [
        row for row in rows if row["tier"] == "tuned" and subject(row) and main[row["engine"]] == row["variant"]
    ] or [*rows]


def kind(row: Row) -> str:
    """Engine and kind of a row's variant: "exudyn, tuned"."""
    return f"{row['engine']}, {row['tier']}"


def as_it_comes(row: Row) -> bool:
    """Whether a row is of a variant as the engine comes: open marks."""
    return row.get("tier") == "defaults"


def _of_one(series, engines):
    """{series: its look} where all are of one solver, and more than its own looks tell apart: the model has one."""
    most = 1 if engines == {REFERENCE} else len(LOOKS)
    if len(engines) > 1 or len(series) <= most:
        return {}
    return {who: {"look": curve(rank)} for rank, who in enumerate(series)}


def beside(*figures: Figure | None) -> Figure | None:
    """Figures as one, panel beside panel, one caption after the other, equal ones once; None: none is there."""
    found = [one for one in figures if one is not None]
    if not found:
        return None
    keys = {who: key for one in found for who, key in one.keys.items()}
    svg, alt = b"".join(one.svg for one in found), " ".join(one.alt for one in found)
    return Figure(svg, alt, " ".join(dict.fromkeys(one.caption for one in found)), tuple(keys), keys)


def _drawn(value: Any, log: bool) -> bool:
    return value is not None and math.isfinite(value) and (value > 0 or not log)


def _linear_axis(label, values):
    """An axis from tick to tick about the values."""
    ticks = MaxNLocator(nbins=5, steps=[1, 2, 2.5, 5, 10]).tick_values(min(values), max(values))
    return Axis(label, float(ticks[0]), float(ticks[-1]))


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
    """Panels of values one below the other, each with its interval; None: nothing to draw.

    Parameters
    ----------
    rows : iterable of dict
        From above, each with its ``engine`` ("analytic": in ink). Rows whose value is None are left out.
    name : Column
        What stands beside a row.
    value : Column
        With ``within`` for the interval.
    axis : Axis
        Of the values; what lies beyond stands at its end, with an arrowhead.
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
            told = [f"{name.text(row)}: {value.text(row)}"]
            chart.dots([value.of(row)], [place], who, filled=not opened(row), says=told, beyond=True)
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
    """Maps of a quantity: a cell for each row, shaded by the bounds that its value passes; None: no rows.

    Parameters
    ----------
    rows : iterable of dict
        One for each panel and cell; coordinates stand in the order in which they come first, y upward.
    x, y : Column
        Coordinates, as their texts.
    value : Column
        The shaded quantity, its number in the cell; a dash where it is None.
    bounds : sequence of float
        At most five, ascending: the scale, drawn as the last panel.
    panel : key
        Title of a row's panel.
    failed : function
        What failed in a row, in a word or two that take the number's place beside a cross; "": nothing.
    """
    rows = list(rows)
    if not rows:
        return None
    across, up = ([text for (text,) in grouped(rows, column.text)] for column in (x, y))
    left, charts = room(up, 44) + 20, []
    foot = 46 + round(0.5 * room(across) * slanting(across, WIDTH - left))
    for (title,), members in grouped(rows, panel).items():
        chart = Chart(
            _places(x.head, across),
            _places(y.head, up),
            f"{title + ': ' if title else ''}{value.head} over {x.head} and {y.head}.",
            title=str(title),
            height=32 + 25 * len(up) + foot,
            left=left,
            foot=foot,
        )
        for row in members:
            lost, found, size = failed(row), value.text(row), value.of(row)
            kind = "shade" if size is None else f"shade s{bisect_right(bounds, size)}"
            words = f"{y.text(row)}, {x.text(row)}: {found}" + (f"; failed: {lost}" if lost else "")
            sign = f"✗ {lost}" if lost else found
            chart.cell(across.index(x.text(row)), up.index(y.text(row)), f"{kind} lost" if lost else kind, sign, words)
        charts.append(chart)
    return figure([*charts, _scale(value, bounds)], caption)


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
    """Maps of too many cells for numbers in them: panels, to draw more on, and the legend of their `figure`.

    Parameters
    ----------
    x, y : str
        Labels of the axes.
    xs, ys : array
        Centres of the cells, even.
    panels : dict
        {title: shape (xs, ys), each cell's place among the kinds}.
    kinds : dict
        {name: class of its cells, as "s3" or "right"; "" leaves them empty}.
    right : int
        Room there for names of lines.
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


def _places(label, words):
    return Axis(label, -0.5, len(words) - 0.5, ticks=tuple(enumerate(words)))


def _scale(value, bounds):
    """The shades with the bounds between them."""
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
LINE, LANE = 28, 0.27  # height of a variant's row, and how far apart the grounds stand in it, over that

GROUND, PULSE = Column("ground", "ground"), Column("pulse", "shape")
FREQUENCY = Column("pulse frequency over rocking frequency [-]", "frequency", digits=None)
AMPLITUDE = Column("amplitude over g tan γ [-]", "amplitude", digits=6)
SHIFT = Column("shift of the boundary, absolute [%]", lambda row: 100 * abs(row["shift"]))
NORMAL = Column("least N/(m g) of the analytic model [-]", "min_normal")
FOUND = Column("found [-]", "{found} of {of}")
MEDIAN = Column("median shift [%]", lambda row: row["median"] and 100 * row["median"])
LARGEST = Column("largest shift [%]", lambda row: row["largest"] and 100 * row["largest"])


def place(row: Row) -> tuple[Any, ...]:
    """Which boundary a row is of."""
    return tuple(row[key] for key in PLACE)


def pressed(result: Result) -> set[tuple[Any, ...]]:
    """Places of the boundaries at which the block stays pressed on its base."""
    return {place(edge) for edge in where(result.rows, part=EDGES) if edge["min_normal"] >= 0}


def strip(result: Result, title: str) -> Figure | None:
    """Each boundary at its shift, a row for each main variant and each of the kind "defaults"; None: there is none."""
    settings, own = result.settings, result.settings["default_variants"]
    rows = grouped(where(result.rows, part=SHIFTS), NAME.of)
    every = [one for one in settings["variants"] if (NAME.of(one),) in rows]
    shown = [one for one in every if as_it_comes(one) or own.get(one["engine"]) == one["variant"]]
    if not shown:
        return None
    shown.sort(key=lambda one: not subject(one))
    left_out = "; ".join(NAME.of(one) for one in every if one not in shown)
    sound, grounds = pressed(result), list(settings.get("grounds", ()))
    lanes = (
        f"in a row from above: {', '.join(grounds)}; bars, and + at the frame: N\u00a0<\u00a00, which does not count; "
    )
    caption = (
        f"Shift of each boundary, known to ±\u00a0{percent(settings['tolerance'] / 2, 1)}; {lanes if grounds else ''}"
        "filled: tuned, open: defaults. Cross at the frame: number not found. Arrowhead: nearer to 0."
        + f" Not drawn, but in the table: {left_out}."
        * bool(left_out)
    )
    return figure([_strip(shown, rows, sound, grounds, title)], caption)


def _strip(shown, rows, sound, grounds, title):
    names = list(map(kind, shown))
    known = [SHIFT.of(row) for some in rows.values() for row in some if row["shift"]]
    axis = log_axis(SHIFT.head, [*known, 100 * LIMIT])
    told, lost = [], []
    for one in shown:
        mine = rows[NAME.of(one),]
        found = [row for row in mine if row["shift"] is not None]
        largest = percent(max((abs(row["shift"]) for row in found), default=None))
        told.append(f"{NAME.of(one)} {len(found)} of {len(mine)} found, largest {largest}")
        missing = [place(row) in sound for row in mine if row["shift"] is None]
        lost.append((missing.count(True), missing.count(False)))
    chart = Chart(
        Axis(axis.label, axis.low, axis.high, "log", tuple((tick, short(tick)) for tick in DECADES)),
        Axis(
            "", len(shown) - 0.5, -0.5, ticks=tuple((k, f"{name}\u2002") for k, name in enumerate(names))
        ),  # room for an arrowhead
        f"{SHIFT.head}: {'; '.join(told)}.",
        title=title,
        height=92 + LINE * len(shown),
        left=room(names),
        right=58,
        head=16,
    )
    chart.rule(100 * LIMIT)
    chart.heading(100 * LIMIT, "trusted")
    chart.beside(axis.high, -0.5, "not found", aside=(54, -5), anchor="end")
    for line, (one, name) in enumerate(zip(shown, names, strict=True)):
        _row(chart, line, name, rows[NAME.of(one),], sound, grounds, not as_it_comes(one))
        if any(lost[line]):
            chart.dots([axis.high], [line], name, mark="x", says=[f"{name}: {sum(lost[line])} not found"])
            words = f"{lost[line][0]}" + f" + {lost[line][1]}" * bool(lost[line][1])
            chart.beside(axis.high, line, words, who=name, aside=(8, 4.5))
    return chart


def _row(chart, line, name, members, sound, grounds, filled):
    """The boundaries of a variant that were found; those at which the model holds the corner down as bars."""
    found = [row for row in members if row["shift"] is not None]
    for whole in (False, True):
        some = [row for row in found if (place(row) in sound) == whole]
        lanes = [grounds.index(row["ground"]) if row["ground"] in grounds else len(grounds) for row in some]
        told = [
            f"{NAME.of(row)}: {percent(row['shift'])} on {row['ground']}, {row['shape']}, frequency "
            f"{number(row['frequency'])}, amplitude {number(row['amplitude'])}"
            for row in some
        ]
        chart.dots(
            [SHIFT.of(row) for row in some],
            [line + LANE * (lane - len(grounds) / 2) for lane in lanes],
            name,
            filled=filled,
            small=whole,
            says=told,
            mark=None if whole else "|",
            beyond=True,
        )


def rated(result: Result) -> Iterator[dict[str, Any]]:
    """A summary and a rating of each variant that is run at its default, where the block stays pressed on its base;
    beyond: the boundaries where it does not."""
    sound = pressed(result)
    for (name,), every in grouped(where(result.rows, part=SHIFTS), NAME.of).items():
        members, others = ([row for row in every if (place(row) in sound) == inside] for inside in (True, False))
        beyond = summary(others) if others else {"of": 0, "found": 0, "largest": None}
        counts = [row for row in where(result.rows, part="confusion", region="outside") if NAME.of(row) == name]
        found, wrong = summary(members), sum(row["only_a"] + row["only_b"] for row in counts)
        complete = found["found"] == found["of"]
        good = complete and found["largest"] <= LIMIT and not wrong
        rating = "good" if good else "fair" if complete and found["largest"] <= FAIR else "bad"
        outcomes = wrong + sum(row["both_stand"] + row["both_overturn"] for row in counts)
        yield {
            **found,
            "rating": rating,
            "wrong": wrong,
            "outcomes": outcomes,
            "beyond": beyond["of"],
            "beyond_found": beyond["found"],
            "beyond_largest": beyond["largest"],
        }


def summary(rows: Sequence[Row]) -> dict[str, Any]:
    """How many of these boundaries of a variant were found, and how far off they lie."""
    found = [row for row in rows if row["shift"] is not None]
    shifts = [abs(row["shift"]) for row in found]
    return {
        "engine": rows[0]["engine"],
        "variant": rows[0]["variant"],
        "of": len(rows),
        "found": len(found),
        "gaps": f"{sum(not row['rises'] for row in found)} of {sum(not row['rises'] for row in rows)}",
        "median": statistics.median(shifts) if shifts else None,
        "largest": max(shifts, default=None),
    }


def judged(result: Result, what: str) -> Judgement:
    """The row of the table of trust, which other studies have, too. what: the boundaries are of."""
    marks = {}
    for row in rated(result):
        every = row["of"] + row["beyond"]
        words = f"{percent(row['largest'])} ({row['found']} of {every} {what})"
        note = f"{what}: median {percent(row['median'])}; {row['of'] - row['found']} not found"
        if row["beyond"]:
            note += f"; {row['beyond']} with N < 0 do not count, found {row['beyond_found']}"
            note += f", {percent(row['beyond_largest'])}" if row["beyond_found"] else ""
        if row["largest"] is None:
            words = f"none found ({what})"
        marks[row["engine"], row["variant"]] = Mark(words, row["rating"], note, row["largest"])
    return Judgement("overturning boundary under pulses: shift, worst", marks)


def largest(result: Result) -> str:
    """The largest shift, and what was not found: over the engines' main variants that are tuned; over all main variants
    if none is tuned."""
    own = result.settings["default_variants"]
    tuned = {NAME.of(one) for one in result.settings["variants"] if one["tier"] == "tuned"}
    best = [row for row in rated(result) if own[row["engine"]] == row["variant"]]
    chosen = [row for row in best if NAME.of(row) in tuned]
    how, chosen = ("tuned engines", chosen) if chosen else ("engines not tuned", best)
    most = max((row["largest"] for row in chosen if row["largest"] is not None), default=None)
    lost = [f"{row['found']} of {row['of']} found ({row['engine']})" for row in chosen if row["found"] < row["of"]]
    words = f"{how} shift the overturning boundary by {percent(most)} at most"
    return "; ".join(filter(None, [words, listed(lost)]))


def under_jumps(result: Result) -> Iterator[str]:
    """A sentence on the tuned engines whose largest shift is under a pulse that begins with a jump; none without."""
    own = result.settings["default_variants"]
    rows = where(result.rows, part=SHIFTS)
    sound, found = pressed(result), []
    for engine in own:
        mine = [row for row in where(rows, engine=engine, variant=own[engine]) if row["shift"] and place(row) in sound]
        worst = max(mine, key=lambda row: abs(row["shift"]), default=None)
        if worst and PulseMotion(worst["shape"], 1.0, 1.0, start=1.0).jumps:
            found.append(f"{percent(worst['shift'])} under a {worst['shape']} pulse ({engine})")
    if found:
        yield f"The shift is largest where the acceleration of the ground jumps at the start: {listed(found)}."


def listing(caption: str, edges: Iterable[Row], shifts: Sequence[Row], *columns: Column) -> Table:
    """A table of boundaries, with more columns, and the shifts of each setting in a column of its own."""
    found = {(NAME.of(row), *place(row)): row["shift"] for row in shifts}

    def shift(name, edge):
        value = found.get((name, *place(edge)))
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
    """Those that were not found, and why."""
    return table(
        "Boundaries not found, within 30 % or half-way to the next one",
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
    """Evidence of runs without an outcome, of `EVIDENCE` at most."""
    return tuple(
        (
            f"{NAME.text(row)}, {row['ground']}, {row['shape']}, frequency {row['frequency']:g}, amplitude "
            f"{row['amplitude']:.6g}",
            f"{row['reason']}\n{row.get('message') or ''}",
        )
        for row in where(result.rows, part="failure")[:EVIDENCE]
    )
