"""Overturning boundaries of engines beside those of the analytic model: each at its shift, how far off, and how rated.

Of a result with rows "edge" and "shift", or "drawn edge" and "drawn shift"; its settings list variants, main variants
(`default_variants`) and how closely boundaries are known (`tolerance`).
"""

import statistics
from collections.abc import Iterable, Iterator, Sequence
from functools import partial
from typing import Any

from analytic import PulseMotion

from ..running.provenance import Result
from .charts import Axis, Chart, figure, log_axis, room
from .figures import as_it_comes, kind, subject
from .parts import NAME, Column, Figure, Judgement, Mark, Row, Table, grouped, number, percent, short, table, where
from .wording import listed

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
