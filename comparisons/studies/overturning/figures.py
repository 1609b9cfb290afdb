"""Figures of the overturning study, drawn from its result alone."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from ...showing.plots import marker, style
from .rows import rows_of

if TYPE_CHECKING:
    from ...running.provenance import Result

MODES = ("white", "#9ecae1", "#6baed6", "#d9d9d9")  # stands; overturns without, after one, after more impacts
SHADES = ("#000000", "#0072B2", "#E69F00", "#009E73", "#CC79A7", "#D55E00")  # Okabe and Ito
ACROSS = 4  # panels beside each other
LIMIT = 0.5  # %, asked of the boundaries at default settings


def draw_maps(result: Result) -> Figure:
    """Analytic map, the engines' boundaries on it, and every scanned point where the outcomes differ."""
    s = result.settings
    figure = Figure(figsize=(4.3 * len(s["shapes"]) + 0.6, 3.9 * len(s["grounds"]) + 0.9), layout="constrained")
    axes = figure.subplots(len(s["grounds"]), len(s["shapes"]), squeeze=False, sharex=True, sharey=True)
    for i, ground in enumerate(s["grounds"]):
        for j, shape in enumerate(s["shapes"]):
            _draw_map(axes[i, j], result, (i, ground), (j, shape))
    for axis in axes[:, 0]:
        axis.set_ylabel("amplitude / (g tan γ) [-]")
    for axis in axes[-1]:
        axis.set_xlabel("pulse frequency / $ω_r$ [-]")
    figure.legend(
        handles=_map_legend(result),
        loc="outside lower center",
        ncols=4 if len(s["shapes"]) > 1 else 2,
        fontsize="small",
    )
    return figure


def _draw_map(axis, result, ground, shape):
    """One pulse on one ground, each as (index, name)."""
    impacts, points = result.arrays[f"{ground[1]}/{shape[1]}"], result.arrays["points"]
    axis.pcolormesh(
        result.arrays["frequency"],
        result.arrays["amplitude"],
        np.where(impacts < 0, 0, np.minimum(impacts, 2) + 1),
        vmin=-0.5,
        vmax=3.5,
        cmap=ListedColormap(MODES),
        shading="nearest",
        rasterized=True,
    )
    for place, engine in enumerate(_engines(result)):
        rows = _shifted(result, engine, ground=ground[1], shape=shape[1])
        axis.plot(
            [row["frequency"] for row in rows],
            [row["amplitude"] * (1 + row["shift"]) for row in rows],
            marker(engine),
            color=style(engine)["color"],
            markersize=max(6.5 - 2 * place, 2.0),
            markerfacecolor="none",
            markeredgewidth=1.3,
        )
    here = (points[:, 0] == ground[0]) & (points[:, 1] == shape[0]) & (points[:, 7] == 1)
    wrong = here & (points[:, 6] >= 0) & (points[:, 5] != points[:, 6])
    axis.plot(points[here, 3], points[here, 4], ".", color="0.35", markersize=2.5)
    axis.plot(points[wrong, 3], points[wrong, 4], "x", color="#D55E00", markersize=9, markeredgewidth=2)
    axis.set(yscale="log", title=f"{ground[1]}, {shape[1]}")
    axis.set_yticks([0.5, 1, 2, 5, 10, 20], ["0.5", "1", "2", "5", "10", "20"])
    axis.minorticks_off()


def _map_legend(result):
    """Handles of all that the maps show."""
    names = ("stands", "overturns without impact", "overturns after one impact", "overturns after more impacts")
    handles: list[Any] = [
        Patch(facecolor=colour, edgecolor="0.5", label=f"analytic: {name}")
        for colour, name in zip(MODES, names, strict=True)
    ]
    handles += [
        Line2D(
            [],
            [],
            marker=marker(engine),
            color=style(engine)["color"],
            markerfacecolor="none",
            linestyle="none",
            label=f"{engine}: boundary",
        )
        for engine in _engines(result)
    ]
    handles += [
        Line2D([], [], marker=".", color="0.35", linestyle="none", label="scanned with all engines"),
        Line2D([], [], marker="x", color="#D55E00", linestyle="none", label="scanned, outcomes differ"),
    ]
    return handles


def draw_shifts(result: Result) -> Figure:
    """Relative difference of every boundary from the analytic one, over the pulse frequency."""
    grounds = list(result.settings["grounds"])
    figure = Figure(figsize=(5.2 * len(grounds), 4.2), layout="constrained")
    axes = figure.subplots(1, len(grounds), squeeze=False, sharey=True)[0]
    fills = {True: "full", False: "none"}
    for axis, ground in zip(axes, grounds, strict=True):
        axis.axhspan(-LIMIT, LIMIT, color="0.94", zorder=0)
        axis.axhline(0, color="0.6", linewidth=0.8)
        engines = _engines(result)
        for place, engine in enumerate(engines):
            for rises in (True, False):
                rows = _shifted(result, engine, ground=ground, rises=rises)
                beside = 0.24 * (place - 0.5 * (len(engines) - 1))
                axis.errorbar(
                    [row["frequency"] + beside for row in rows],
                    [100 * row["shift"] for row in rows],
                    [100 * row["half_width"] for row in rows],
                    fmt=marker(engine),
                    color=style(engine)["color"],
                    fillstyle=fills[rises],
                    markersize=6,
                    linestyle="none",
                    elinewidth=1,
                    label=f"{engine}: overturning {'begins' if rises else 'ends (safe gap)'}",
                )
        axis.set_yscale("symlog", linthresh=0.01)
        axis.set_yticks(
            [-5, -0.5, -0.1, -0.01, 0, 0.01, 0.1, 0.5], ["−5", "−0.5", "−0.1", "−0.01", "0", "0.01", "0.1", "0.5"]
        )
        axis.minorticks_off()
        axis.set(title=ground, xlabel="pulse frequency / $ω_r$ [-]")
        axis.grid(color="0.88", axis="y")
    low, high = axes[0].get_ylim()
    axes[0].set_ylim(min(low, -1), max(high, 1))
    axes[0].set_ylabel("shift of the boundary [%]")
    figure.legend(*axes[0].get_legend_handles_labels(), fontsize="small", loc="outside lower center", ncols=4)
    return figure


def draw_knobs(result: Result) -> Figure:
    """Largest and median |shift| over the setting that buys accuracy, one panel for each solver and variant."""
    curves = knob_curves(result)
    across = min(ACROSS, len(curves)) or 1
    lines = math.ceil(len(curves) / across) or 1
    figure = Figure(figsize=(3.2 * across, 3.4 * lines), layout="constrained")
    axes = figure.subplots(lines, across, squeeze=False, sharey=True).ravel()
    for axis in axes[len(curves) :]:
        axis.set_axis_off()
    for axis, ((solver, knob), values) in zip(axes, curves.items(), strict=False):
        x = sorted(values)
        for shade, (name, measure) in zip(SHADES[1:], (("largest", np.max), ("median", np.median)), strict=False):
            y = [
                100 * measure(np.abs(found)) if len(found) else np.nan  # type: ignore[operator]  # np.max or np.median
                for found in (
                    np.array([row["shift"] for row in values[value] if row["shift"] is not None]) for value in x
                )
            ]
            axis.plot(
                x,
                y,
                marker="o" if name == "largest" else "^",
                color=shade,
                label=name,
                linestyle="-" if name == "largest" else "--",
            )
        for value in x:
            lost = sum(row["shift"] is None for row in values[value])
            if lost:
                axis.annotate(
                    f"{lost} of {len(values[value])}\nnot found",
                    (value, LIMIT),
                    fontsize="x-small",
                    ha="center",
                    va="bottom",
                )
        axis.axhline(LIMIT, color="0.6", linewidth=0.8, linestyle=":")
        unit = {"step": "step [s]", "stiffness": "stiffness [N/m]"}.get(knob, f"{knob} [-]")
        axis.set(xscale="log", yscale="log", xlabel=unit, title=solver.replace(", ", "\n"))
        axis.grid(color="0.92")
    figure.supylabel("shift of the boundaries, absolute [%]")
    axes[0].legend(fontsize="small")
    return figure


def knob_curves(result: Result) -> dict[tuple[str, str], dict[float, list[dict[str, Any]]]]:
    """{(solver, knob): {value: rows}} of the settings tried, the default ones taken from the same boundaries."""
    curves = {}
    keys = {(row["ground"], row["shape"], row["frequency"]) for row in rows_of(result, "knob")}
    for row in rows_of(result, "knob"):
        ((knob, value),) = row["settings"].items()
        if row["solver"] not in result.settings["first_scripts"]:
            curves.setdefault((row["solver"], knob), {}).setdefault(value, []).append(row)
    for solver, knob in curves:
        default = result.settings["default_knobs"].get(solver)
        if default is not None:
            curves[solver, knob][default] = [
                row
                for row in rows_of(result, "shift", solver=solver)
                if (row["ground"], row["shape"], row["frequency"]) in keys
            ]
    return curves


def _engines(result):
    """Names of the engines at default settings."""
    return [solver.partition(",")[0] for solver in result.settings["solvers"]]


def _shifted(result, engine, **wanted):
    """The boundaries that an engine found."""
    return [
        row
        for row in rows_of(result, "shift", **wanted)
        if row["solver"].partition(",")[0] == engine and row["shift"] is not None
    ]
