"""The bearings that a scene needs, as a table for the terminal and as a picture."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from analytic import Scene
from analytic.bearing_scan import BearingScan

from ..running.readable import readable
from .parts import percent
from .plots import TITLE_CHARACTERS
from .terminal import echo, grid

HELD = "#009E73"  # Okabe and Ito


def print_bearings(
    scene: Scene, scan: BearingScan, stroke: float, tilt: float, motions: int, chosen: Mapping[str, Mapping[str, Any]]
) -> None:
    """Print the bearings named, a column each, or how near the best ones come where none hold."""
    assert scene.base is not None  # the search asks for one
    name, wanted = readable(scene.name, TITLE_CHARACTERS), _wanted(stroke, tilt)
    echo(f"{name}: {wanted}; base: {scene.base.mass:g} kg; motions: {motions}", wrap=True)
    if not chosen:
        return echo(nothing_holds(scan, stroke), wrap=True)
    if len({(one["period"], one["damping"]) for one in chosen.values()}) == 1:
        chosen = {" and ".join(chosen): next(iter(chosen.values()))}
    rows = {
        "secant period at the stroke [s]": "{period:.3g}",
        "equivalent damping at the stroke": "{damping:.3g}",
        "ka of each [N/m]": "{bearings.ka:.6g}",
        "kb of each [N/m]": "{bearings.kb:.6g}",
        "alpha": "{bearings.alpha:.6g}",
        "base displacement, worst motion [m]": "{stroke:.4g}",
        "acceleration over that of uplift": "{uplift:.3g}",
        "peak tilt / slenderness": "{tilt:.3g}",
    }
    cells = [[label, *(form.format(**one) for one in chosen.values())] for label, form in rows.items()]
    echo(
        grid(["bearings", *chosen], cells, wraps=["bearings", *chosen]),
        f"Of bearings {_scanned(scan)}, {percent(float(np.mean(scan.demand <= 1)))} hold.",
        wrap=True,
    )


def nothing_holds(scan: BearingScan, stroke: float) -> str:
    """That no bearings hold, and which come nearest."""
    period, damping = scan.nearest
    row, column = np.abs(scan.dampings - damping).argmin(), np.abs(scan.periods - period).argmin()
    return (
        f"no bearings {_scanned(scan)} hold. Nearest: {period:.3g} s with {damping:.3g}, at "
        f"{scan.demand[row, column]:.3g} times a limit, the base moving {scan.stroke[row, column]:.3g} m of {stroke:g}."
        " Allow more stroke, or --tilt; or widen, fix or lower the block."
    )


def _scanned(scan):
    low, high = scan.dampings[0], scan.dampings[-1]
    return f"of {scan.periods[0]:g} to {scan.periods[-1]:g} s and {percent(low)} to {percent(high)} of critical damping"


def draw_bearings(scene: Scene, scan: BearingScan, stroke: float, tilt: float) -> Figure:
    """The region of period and damping that holds, and the points named: a matplotlib Figure."""
    figure = Figure(figsize=(7, 4.5), layout="constrained")
    axis = figure.subplots()
    shown = np.clip(scan.demand, 0, 3)
    axis.contourf(scan.periods, 100 * scan.dampings, shown, [0, 1], colors=[HELD], alpha=0.35)
    axis.contour(scan.periods, 100 * scan.dampings, shown, [1], colors=[HELD], linewidths=1.5)
    lines = axis.contour(scan.periods, 100 * scan.dampings, shown, [1.25, 1.5, 2], colors="0.5", linewidths=0.8)
    axis.clabel(lines, fmt="%g", fontsize="small")
    for name, point, marker in (("least stroke", scan.least_stroke, "o"), ("softest", scan.softest, "D")):
        if point is not None:
            label = f"{name}: {point[0]:.3g} s, {point[1]:.1%}"
            axis.plot(point[0], 100 * point[1], marker, color="black", fillstyle="none", label=label, clip_on=False)
    axis.set_xscale("log")
    ticks = [t for t in (0.3, 0.5, 0.7, 1, 1.5, 2, 3, 4, 5, 7, 10) if scan.periods[0] <= t <= scan.periods[-1] * 1.001]
    axis.set_xticks(ticks, [f"{tick:g}" for tick in ticks], minor=False)
    axis.minorticks_off()
    axis.set_xlabel(f"secant period at {stroke:g} m [s]")
    axis.set_ylabel(f"equivalent damping at {stroke:g} m [%]")
    axis.set_title(f"{readable(scene.name, TITLE_CHARACTERS)}: {_wanted(stroke, tilt)}", loc="left", fontsize="medium")
    handles = [Patch(facecolor=HELD, alpha=0.35, label="hold"), *axis.get_legend_handles_labels()[0]]
    lines_label = Patch(facecolor="none", edgecolor="0.5", label="times the nearer limit")
    figure.legend(handles=[*handles, lines_label], loc="outside lower center", ncols=4, frameon=False, fontsize="small")
    return figure


def _wanted(stroke, tilt):
    limit = "no uplift" if tilt == 0 else f"tilt up to {tilt:g} of the slenderness"
    return f"bearings for {limit} within {stroke:g} m"
