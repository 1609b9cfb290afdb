"""The figures of the report, each drawn from the arrays and rows of a result file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from ..showing.parts import figure_of, number
from ..showing.plots import marker, style

if TYPE_CHECKING:
    from ..running.provenance import Result
    from ..showing.parts import Figure as Picture

WIDTH = 5.4  # in: narrow, so that the words stay readable on a phone
MARKERS = "osD^v"
ZERO = 1e-16  # an error of 0 is drawn here: below double precision
GROUND_LINES = {"rigid ground": "-", "sliding base": "--"}
FILLED = {"rigid ground": "Filled: rigid ground", "sliding base": "Open: sliding base"}


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
        row["solver"] for row in result.rows if row["scene"] == name and f"{name}/{row['solver']}/time" in result.arrays
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
        key = f"{name}/{row['solver']}/"
        if row["scene"] == name and key + "time" in result.arrays:
            axis.plot(
                result.arrays[key + "base_displacement"],
                result.arrays[key + "bearing_force"] / 1e3,
                label=row["solver"],
                **style(row["solver"]),
            )
            solvers.append(row["solver"])
    title = result.settings["scenes"][name]["name"]
    axis.set(xlabel="base displacement x [m]", ylabel="force of all bearings [kN]", title=title)
    axis.legend(fontsize=9)
    return figure_of(
        figure,
        f"{title}: hysteresis loops of {', '.join(solvers)} over each other.",
        f"{title}: hysteresis of the bearings, all of them together.",
    )


def restitution(result: Result) -> Picture:
    """Measured restitution on the curve of eq. (7), and its error."""
    figure = Figure(figsize=(WIDTH, 6.2), layout="constrained")
    above, below = figure.subplots(2, 1, sharex=True)
    lines = {ground: line for ground, line in GROUND_LINES.items() if ground in result.settings["bases"]}
    for ground, line in lines.items():
        above.plot(
            result.arrays["curve/slenderness"],
            result.arrays[f"curve/{ground}"],
            line,
            color="0.6",
            label=f"eq. (7), {ground}",
        )
    defaults = [row for row in result.rows if row["default"] and row["rms"] is not None]
    solvers = list(dict.fromkeys(row["solver"] for row in defaults))
    for index, solver in enumerate(solvers):
        colour = style(solver)["color"]
        for ground in lines:
            rows = [row for row in defaults if row["solver"] == solver and row["ground"] == ground]
            filled = colour if ground == "rigid ground" else "white"
            points = {"color": colour, "marker": marker(solver), "markerfacecolor": filled}
            points["markersize"] = max(6 - index, 2)
            gammas = [row["slenderness"] for row in rows]
            above.plot(
                gammas,
                [row["restitution"] + row["bias"] for row in rows],
                linestyle="",
                **points,
                label=solver if filled == colour else None,
            )
            if solver != "analytic":
                below.plot(
                    gammas,
                    [row["rms"] for row in rows],
                    linestyle=GROUND_LINES[ground],
                    linewidth=1,
                    **points,
                    label=f"{solver}, {ground}",
                )
    above.set(ylabel="restitution $e_φ$ [-]")
    above.legend(fontsize=8)
    below.set(xlabel="slenderness γ [rad]", ylabel="error of restitution, rms [-]", yscale="log")
    handles, labels = below.get_legend_handles_labels()
    if handles:
        figure.legend(handles, labels, loc="outside lower center", ncols=2, fontsize=8)
    return figure_of(
        figure,
        f"Above, restitution falling with slenderness: curves of eq. (7) for {' and '.join(lines)}, with the measured "
        "values of each solver on them. Below, the root mean square error of each engine on a logarithmic scale.",
        f"Restitution measured in free rocking against eq. (7). {'; '.join(FILLED[name] for name in lines)}. "
        "Engines at their default variant and settings.",
    )


def error_and_cost(groups: Sequence[Mapping[str, Any]]) -> Picture:
    """Error of restitution and of impact times beside the CPU time of the same runs; `groups` as in sections.py."""
    panels = (
        ("rms", "error of restitution\nrms [-]"),
        ("jump_rms", "error of base velocity\njump, relative, rms [-]"),
        ("time_rms", "error of impact times\nrelative, rms [-]"),
    )
    figure = Figure(figsize=(WIDTH, 7.6), layout="constrained")
    axes = figure.subplots(len(panels), 1, sharex=True)
    for axis, (measure, label) in zip(axes, panels, strict=True):
        for index, group in enumerate(groups):
            if group[measure] is not None and group["cpu_per_second"]:
                axis.plot(
                    group["cpu_per_second"],
                    max(group[measure], ZERO),
                    linestyle="",
                    markersize=8,
                    marker=MARKERS[index % len(MARKERS)],
                    color=style(group["solver"])["color"],
                    markerfacecolor=style(group["solver"])["color"] if group["default"] else "white",
                    label=group["name"] if axis is axes[0] else None,
                )
        axis.set(xscale="log", yscale="log", ylabel=label)
        axis.grid(color="0.9")
        axis.set_axisbelow(True)
        axis.yaxis.set_minor_formatter(NullFormatter())
        axis.xaxis.set_minor_formatter(NullFormatter())
    axes[-1].set_xlabel("CPU time per simulated second [s/s]")
    figure.legend(loc="outside lower center", ncols=2, fontsize=9)
    return figure_of(
        figure,
        "Three scatter plots of error over CPU time per simulated second, one point for each "
        "solver and variant: "
        + "; ".join(
            f"{group['name']} {number(group['rms'], 2)} at {number(group['cpu_per_second'], 2)} s/s" for group in groups
        )
        + ".",
        "Error beside cost, both from the same free rocking runs; left and low is better. Filled: default "
        "variant. An error of zero in double precision is drawn at 10⁻¹⁶.",
    )
