"""Figures of the study: every boundary of every variant at its shift, and maps of outcomes."""

import itertools
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from ...running.provenance import Result
from ...showing.charts import Axis, Chart, figure, key_of, log_axis, room
from ...showing.figures import as_it_comes, beside, kind, lines, subject
from ...showing.parts import NAME, Column, Figure, Row, grouped, number, percent, short, where

LIMIT, FAIR = 0.005, 0.03  # shifts of a trusted and of a usable engine
PLACE = ("ground", "shape", "frequency", "amplitude")
DECADES = (1e-4, 1e-2, 1, 100)  # of a shift, as ticks [%]
LINE, LANE = 28, 0.27  # height of a variant's row, and how far apart the grounds stand in it, over that

GROUND, PULSE = Column("ground", "ground"), Column("pulse", "shape")
FREQUENCY = Column("pulse frequency over rocking frequency [-]", "frequency", digits=None)
AMPLITUDE = Column("amplitude over g tan γ [-]", "amplitude", digits=6)
SHIFT = Column("shift of the boundary, absolute [%]", lambda row: 100 * abs(row["shift"]))


def place(row: Row) -> tuple[Any, ...]:
    """Which boundary a row is of."""
    return tuple(row[key] for key in PLACE)


def pressed(result: Result) -> set[tuple[Any, ...]]:
    """Places of the boundaries at which the block stays pressed on its base."""
    return {place(edge) for edge in where(result.rows, part={"edge", "drawn edge"}) if edge["min_normal"] >= 0}


def shifts(result: Result) -> Figure | None:
    """Each boundary at its shift, a row for each main variant and each of the kind "defaults"; beside them one of the
    model's maps, with the boundaries that are sought there."""
    settings, own = result.settings, result.settings["default_variants"]
    rows = grouped(where(result.rows, part={"shift", "drawn shift"}), NAME.of)
    every = [one for one in settings["variants"] if (NAME.of(one),) in rows]
    shown = [one for one in every if as_it_comes(one) or own.get(one["engine"]) == one["variant"]]
    if not shown:
        return None
    shown.sort(key=lambda one: not subject(one))
    left_out = "; ".join(NAME.of(one) for one in every if one not in shown)
    strip = _strip(shown, rows, pressed(result), list(settings["grounds"]))
    caption = (
        f"Left: shift of each boundary, known to ±\u00a0{percent(settings['tolerance'] / 2, 1)}; in a row from above: "
        f"{', '.join(settings['grounds'])}, drawn blocks. Filled: tuned; open: defaults; bars: boundaries with "
        "N\u00a0<\u00a00, which do not count. Cross at the frame: number not found, + those with N\u00a0<\u00a00. "
        "Arrowhead: nearer to 0." + f" Not drawn, but in the table: {left_out}." * bool(left_out)
    )
    ground, shape = next(iter(settings["grounds"])), settings["shapes"][0]
    words = " Right: analytic model under one pulse; shaded: overturns; dots: boundaries."
    return beside(figure([strip], caption + words), figure([_model(result, ground, shape)], caption + words))


def _strip(shown, rows, sound, grounds):
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
        title="shift of every boundary",
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


def _model(result, ground, shape):
    """Outcomes of the analytic model with its boundaries."""
    chart = _outcomes(result, ground, shape, f"Outcomes of the analytic model on {ground} under a {shape} pulse.")
    edges = where(result.rows, part="edge", ground=ground, shape=shape)
    told = [f"amplitude {number(edge['amplitude'], 4)}, N/(m g) {number(edge['min_normal'], 2)}" for edge in edges]
    chart.dots([edge["frequency"] for edge in edges], [edge["amplitude"] for edge in edges], says=told)
    return chart


def maps(result: Result, shapes: Iterable[str]) -> Figure | None:
    """Outcomes of the analytic model with the boundaries of the engines, and outcomes that differ."""
    chosen = list(shapes)
    panels = [_map(result, ground, shape) for shape, ground in itertools.product(chosen, result.settings["grounds"])]
    if not panels:
        return None
    differ = where(result.rows, part="disagreement", shape=set(chosen))
    caption = (
        "Analytic model: shaded overturns, blank stands. Marks: boundaries of the engines’ main variants, as far as "
        "they were found; shifts too small to be seen here are in the table."
        + f" Crosses: outcomes that differ further than {percent(result.settings['band'], 1)} from every boundary."
        * bool(differ)
    )
    keys = {engine: key_of(engine, filled=False, joined=False) for engine in result.settings["engines"]}
    return figure(panels, caption, keys, keys)


def _outcomes(result, ground, shape, says):
    frequency, amplitude = result.arrays["frequency"], result.arrays["amplitude"]
    chart = Chart(
        Axis(FREQUENCY.head, float(frequency[0]), float(frequency[-1])),
        Axis(AMPLITUDE.head, float(amplitude[0]), float(amplitude[-1]), "log", ((1, "1"), (3, "3"), (10, "10"))),
        says,
        title=f"{ground}, {shape}",
        height=300,
    )
    _shade(chart, frequency, amplitude, result.arrays[f"{ground}/{shape}"] >= 0)
    return chart


def _map(result, ground, shape):
    says = f"Outcomes on {ground} over frequency and amplitude of a {shape} pulse, with boundaries of the engines."
    chart, here = _outcomes(result, ground, shape, says), where(result.rows, ground=ground, shape=shape)
    for engine in result.settings["engines"]:
        own = result.settings["default_variants"][engine]
        rows = [row for row in where(here, part="shift", engine=engine, variant=own) if row["shift"] is not None]
        told = [
            f"{engine}: amplitude {number(row['amplitude'], 4)}, shifted by {percent(row['shift'])}" for row in rows
        ]
        amplitudes = [row["amplitude"] * (1 + row["shift"]) for row in rows]
        chart.dots([row["frequency"] for row in rows], amplitudes, engine, filled=False, says=told, beyond=True)
        rows = where(here, part="disagreement", engine=engine)
        told = [f"{engine}: differs at amplitude {AMPLITUDE.text(row)}" for row in rows]
        chart.dots([row["frequency"] for row in rows], [row["amplitude"] for row in rows], engine, says=told, mark="x")
    return chart


def _shade(chart, frequency, amplitude, falls):
    """Runs of amplitudes that overturn, as a polygon for each stretch of frequencies with the same number of runs."""
    runs = []
    for column in falls.T:
        ends = np.flatnonzero(np.diff(np.concatenate([[0], column.astype(np.int8), [0]])))
        runs.append([(amplitude[a], amplitude[min(b, len(amplitude)) - 1]) for a, b in ends.reshape(-1, 2)])
    begin = 0
    for _, stretch in itertools.groupby(runs, len):
        columns = list(stretch)
        end = begin + len(columns)
        xs = list(frequency[begin:end])
        if end < len(runs):  # into the next one, so that no seam is seen
            xs.append(1.5 * frequency[end] - 0.5 * frequency[end - 1])
            columns.append(columns[-1])
        for run in zip(*columns, strict=True):
            low, high = zip(*run, strict=True)
            chart.area([*xs, *xs[::-1]], [*low, *high[::-1]], "falls")
        begin = end


def over_frequency(rows: Sequence[Row]) -> Figure | None:
    """Shifts of boundaries over the frequency of their pulse, for those that were found."""
    return lines(
        [row for row in rows if row["shift"] is not None],
        FREQUENCY,
        Column(SHIFT.head, lambda row: max(SHIFT.of(row), DECADES[0])),
        "Boundary of the engine over that of the analytic model, less 1, of the main variants; smaller shifts are "
        f"drawn at {short(DECADES[0])} %, boundaries not found are in the table below.",
        panel="ground",
        by=lambda row: f"overturning {'begins' if row['rises'] else 'ends'}",
        log="y",
        rules=[("y", 100 * LIMIT, "trusted")],
        says=lambda row: (
            f"{NAME.of(row)}: {percent(row['shift'])} at {row['shape']}, frequency {row['frequency']:g}, amplitude "
            f"{AMPLITUDE.text(row)}"
        ),
        joined=False,
    )
