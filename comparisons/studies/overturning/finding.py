"""What the report shows of the overturning study: one sentence, one figure, one short table, a column of verdicts."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...showing.charts import Axis, Chart, figure
from ...showing.parts import Judgement, Mark, Section, Table, number, percent
from .figures import LIMIT
from .rows import least_normal_of, median, rows_of

if TYPE_CHECKING:
    from ...running.provenance import Result

FLOOR = 1e-5  # relative shift drawn at the left end: less than the search resolves
FAIR = 0.03


def finding(result: Result) -> Section:
    """The `Section` of the report about boundaries under pulses."""
    grounds = list(result.settings["grounds"])
    worst = [_summary(result, solver) for solver in result.settings["solvers"]]
    largest = max((row["largest"] for row in worst if row["largest"] is not None), default=None)
    lost = sum(row["of"] - row["found"] for row in worst)
    title = f"Many pulses: at their best engines move the overturning boundary by {percent(largest)} at most" + (
        f", and miss {lost} of {sum(row['of'] for row in worst)}" if lost else ""
    )
    shape = result.settings["shapes"][0]
    text = (
        "A pulse overturns a block above some amplitude; higher up may lie a safe gap, where the first impact takes so "
        "much that it stands again. Engines are judged by where they put these boundaries, as long as the analytic "
        "model keeps the block pressed on its base; a verdict nearer to one than the shift is anybody's.",
    )
    panels = [_map(result, ground, shape) for ground in grounds]
    caption = (
        f"Analytic model, {shape} pulse: shaded overturns, blank stands; marks: the engines' boundaries. Amplitude "
        "over g tan γ. Shifts too small to be seen here are in the table."
    )
    return Section(
        title,
        text,
        (_table(worst),),
        (figure(panels, caption, (name.split(",")[0] for name in result.settings["solvers"])),),
        measured=(_how(result),),
    )


def judgement(result: Result) -> Judgement:
    """Largest shift of a boundary, by (engine, variant)."""
    marks = {}
    for solver in (*result.settings["solvers"], *result.settings["first_scripts"]):
        found = _summary(result, solver)
        if not found["of"]:
            continue
        share = f"{found['found']} of {found['of']} boundaries found"
        if found["largest"] is None:
            marks[_pair(solver)] = Mark("none found", "bad", share)
            continue
        missed = found["found"] < found["of"]
        good = found["largest"] <= LIMIT / 100 and not missed
        level = "good" if good else "fair" if found["largest"] <= FAIR and not missed else "bad"
        words = percent(found["largest"]) + (f", {found['of'] - found['found']} lost" if missed else "")
        marks[_pair(solver)] = Mark(words, level, share)
    return Judgement("boundary shift, worst", marks)


def _pair(solver):
    name, _, variant = solver.partition(", ")
    return name, variant


def _summary(result, solver):
    """Boundaries found and how far they lie off, where the block stays pressed on its base."""
    rows = rows_of(result, "shift", solver=solver) or rows_of(result, "knob", solver=solver)
    rows = [row for row in rows if least_normal_of(result, row) >= 0]
    shifts = [abs(row["shift"]) for row in rows if row["shift"] is not None]
    return {
        "solver": solver,
        "of": len(rows),
        "found": len(shifts),
        "median": median(shifts) if shifts else None,
        "largest": max(shifts, default=None),
    }


def _map(result, ground, shape):
    """Outcomes of the analytic model with the boundaries of every solver."""
    frequency, amplitude = result.arrays["frequency"], result.arrays["amplitude"]
    falls = result.arrays[f"{ground}/{shape}"]
    chart = Chart(
        Axis("pulse frequency over ω_r [-]", float(frequency[0]), float(frequency[-1])),
        Axis("amplitude [-]", float(amplitude[0]), float(amplitude[-1]), "log", ((1, "1"), (3, "3"), (10, "10"))),
        f"Outcomes on {ground} over pulse frequency and amplitude, with boundaries of the engines.",
        title=ground,
        height=300,
    )
    _shade(chart, frequency, amplitude, falls >= 0)
    for solver in result.settings["solvers"]:
        rows = [
            row
            for row in rows_of(result, "shift", solver=solver, ground=ground, shape=shape)
            if row["shift"] is not None
        ]
        chart.dots(
            [row["frequency"] for row in rows],
            [row["amplitude"] * (1 + row["shift"]) for row in rows],
            _pair(solver)[0],
            filled=False,
            says=[
                f"{solver}: amplitude {number(row['amplitude'], 4)}, shifted by {percent(row['shift'])}" for row in rows
            ],
        )
    return chart


def _shade(chart, frequency, amplitude, falls):
    """Runs of amplitudes that overturn, as a polygon for each stretch of frequencies with the same number of runs."""
    runs = []
    for column in falls.T:
        edges = np.flatnonzero(np.diff(np.concatenate([[0], column.astype(np.int8), [0]])))
        runs.append([(amplitude[a], amplitude[min(b, len(amplitude)) - 1]) for a, b in edges.reshape(-1, 2)])
    begin = 0
    for end in range(1, len(runs) + 1):
        if end < len(runs) and len(runs[end]) == len(runs[begin]):
            continue
        last = min(end, len(runs) - 1)
        xs = list(frequency[begin:end]) + ([frequency[last]] if end < len(runs) else [])
        for k in range(len(runs[begin])):
            low = [runs[i][k][0] for i in range(begin, end)]
            high = [runs[i][k][1] for i in range(begin, end)]
            low, high = (side + [side[-1]] * (len(xs) - len(side)) for side in (low, high))
            chart.area([*xs, *xs[::-1]], [*low, *high[::-1]], "falls")
        begin = end


def _table(worst):
    return Table(
        "Boundaries under three pulses on both grounds, block pressed on its base",
        ("engine, variant", "found [-]", "median shift [%]", "largest shift [%]"),
        [
            [
                row["solver"],
                f"{row['found']} of {row['of']}",
                "–" if row["median"] is None else number(100 * row["median"], 2),
                "–" if row["largest"] is None else number(100 * row["largest"], 2),
            ]
            for row in worst
        ],
    )


def _how(result):
    s = result.settings
    return (
        f"{len(rows_of(result, 'edge'))} boundaries of the analytic model, pulses {', '.join(s['shapes'])} of "
        f"{min(s['frequencies']):g} to {max(s['frequencies']):g} times ω_r; each engine bisects for its own to "
        f"± {percent(s['tolerance'] / 2, 1)} at default settings. Where the normal force of the analytic model becomes "
        "negative, that model is the one not to be trusted, and the boundary is left out here."
    )
