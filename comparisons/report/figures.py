"""The figures of the report, each drawn from the arrays and rows of a result file."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from ..showing.parts import figure_of, number
from ..showing.plots import style

if TYPE_CHECKING:
    from ..running.provenance import Result
    from ..showing.parts import Figure as Picture

WIDTH = 5.4  # in: narrow, so that the words stay readable on a phone


def ground_motion(result: Result) -> Picture:
    """Ground acceleration over time."""
    motion = result.settings["motion"]
    figure = Figure(figsize=(WIDTH, 2.3), layout="constrained")
    axis = figure.subplots()
    axis.plot(result.arrays["motion/time"], result.arrays["motion/acceleration"], color="0.25", linewidth=0.8)
    axis.axvline(motion["peak_time"], color="0.7", linewidth=0.8, linestyle=":", zorder=0)
    axis.set(xlabel="time [s]", ylabel="ground acceleration [m/s²]", title=motion["label"])
    return figure_of(
        figure,
        f"Ground acceleration over time; its peak of {motion['peak']:.3f} m/s² is at {motion['peak_time']:.2f} s.",
        f"Ground acceleration, {motion['label']}: peak {number(motion['peak'])} m/s² "
        f"({number(motion['peak'] / 9.81)} g) at {number(motion['peak_time'])} s, dotted.",
    )


def histories(
    result: Result,
    name: str,
    column: str,
    label: str,
    scale: float = 1.0,
    limits: tuple[float | None, float | None] = (None, None),
) -> Picture:
    """One column of all solvers over each other, and below what the engines differ by from the analytic model."""
    solvers = [
        row["engine"] for row in result.rows if row["scene"] == name and f"{name}/{row['engine']}/time" in result.arrays
    ]
    figure = Figure(figsize=(WIDTH, 4.0), layout="constrained")
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=[3, 2])
    worst = {}
    for solver in solvers:
        time, values = (result.arrays[f"{name}/{solver}/{key}"] for key in ("time", column))
        above.plot(time, values / scale, label=solver, **style(solver))
        if solver != "analytic" and f"{name}/{solver}/apart/time" in result.arrays:
            time, apart = (result.arrays[f"{name}/{solver}/apart/{key}"] for key in ("time", column))
            below.plot(time, apart / scale, **style(solver))
            worst[solver] = np.abs(apart / scale).max()
    horizon = result.settings["scenes"][name]["horizon"]
    ends = [result.arrays[f"{name}/{solver}/time"][-1] for solver in solvers]
    # copies of a block that overturns part as it falls: nothing to mark
    parts = horizon is not None and horizon < 0.99 * max(ends)
    for axis in (above, below):
        axis.axhline(0, color="0.85", linewidth=0.8, zorder=0)
        if parts:
            axis.axvline(horizon, color="0.5", linewidth=1, linestyle=":")
    title = result.settings["scenes"][name]["name"]
    above.set(ylabel=label, ylim=limits, title=title)
    above.legend(fontsize=9, loc="best")
    below.set(xlabel="time [s]", ylabel="engine − analytic")
    below.ticklabel_format(axis="y", scilimits=(-2, 2))
    apart = "; ".join(f"{solver} {number(value, 2)}" for solver, value in worst.items()) or "no engine ran"
    dotted = (
        ""
        if not parts
        else (
            f" Dotted: the earliest sensitivity horizon of a solver, {number(horizon)} s; after it "
            "no two solutions can be compared point by point."
        )
    )
    return figure_of(
        figure,
        f"{title}: {label} over time, {', '.join(solvers)} over each other.",
        f"{title}: {label}. Below, the difference from the analytic model; largest: {apart}.{dotted}",
    )


def loops(result: Result, name: str) -> Picture:
    """Force over displacement of all bearings together."""
    figure = Figure(figsize=(WIDTH, 3.4), layout="constrained")
    axis = figure.subplots()
    solvers = []
    for row in result.rows:
        key = f"{name}/{row['engine']}/"
        if row["scene"] == name and key + "time" in result.arrays:
            axis.plot(
                result.arrays[key + "base_displacement"],
                result.arrays[key + "bearing_force"] / 1e3,
                label=row["engine"],
                **style(row["engine"]),
            )
            solvers.append(row["engine"])
    title = result.settings["scenes"][name]["name"]
    axis.set(xlabel="base displacement x [m]", ylabel="force of all bearings [kN]", title=title)
    axis.legend(fontsize=9)
    return figure_of(
        figure,
        f"{title}: hysteresis loops of {', '.join(solvers)} over each other.",
        f"{title}: hysteresis of the bearings, all of them together.",
    )
