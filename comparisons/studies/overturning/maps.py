"""Maps of outcomes with the boundaries of the model and of engines."""

import itertools
from collections.abc import Iterable, Sequence

import numpy as np

from ...running.provenance import Result
from ...showing.boundaries import AMPLITUDE, DECADES, FREQUENCY, LIMIT, SHIFT
from ...showing.charts import Axis, Chart, figure, key_of
from ...showing.figures import lines
from ...showing.parts import NAME, Column, Figure, Row, number, percent, short, where


def model_map(result: Result, ground: str, shape: str) -> Chart:
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
