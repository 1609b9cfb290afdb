"""The fragility study's pictures, from its result alone: curves, measures, and what solvers do to them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter
from scipy.stats import norm

from ...showing.plots import marker, style

if TYPE_CHECKING:
    from ...running.provenance import Result

FITS = 0.05  # least p-value of a curve that is shown
ANALYTIC = "analytic"
PERTURBED = "#56B4E9"
DARK, BEST = "#444444", "#D55E00"
UNITS = {"PGA": "g", "PGV": "m/s", "Sa": "g"}


def parted(result: Result, part: str, **wanted: Any) -> list[dict[str, Any]]:
    """The result's rows of a part, with these values."""
    return [
        row for row in result.rows if row["part"] == part and all(row[key] == value for key, value in wanted.items())
    ]


def states_in(result: Result, scene: str) -> list[str]:
    """The scene's limit states."""
    return list(dict.fromkeys(row["state"] for row in parted(result, "fit", scene=scene)))


def is_shown(row: dict[str, Any]) -> bool:
    """Whether a fitted curve fits, so that it may be shown."""
    return row["p_value"] is not None and row["p_value"] >= FITS


def labelled(measure: str) -> str:
    """A measure with its unit."""
    return f"{measure} [{UNITS.get(measure, '-')}]"


def draw_curves(result: Result) -> Figure:
    """Shares of runs that exceed each limit state over its best measure, and the curve where it fits."""
    scenes = list(result.settings["scenes"])
    most = max(len(states_in(result, scene)) for scene in scenes)
    figure = Figure(figsize=(2.9 * most, 2.9 * len(scenes)), layout="constrained")
    grid = figure.subplots(len(scenes), most, squeeze=False, sharey=True)
    for axes, scene in zip(grid, scenes, strict=True):
        for axis in axes[len(states_in(result, scene)) :]:
            axis.set_visible(False)
        for axis, state in zip(axes, states_in(result, scene), strict=False):
            rows = parted(result, "fit", scene=scene, state=state)
            row = next((row for row in rows if row["best"]), rows[0])
            x, share, low, high = (
                np.array([point[key] for point in row["points"]]) for key in ("intensity", "share", "low", "high")
            )
            reach = np.maximum([share - low, high - share], 0)
            axis.errorbar(x, share, reach, fmt="o", color=DARK, markersize=3.5, capsize=2)
            if is_shown(row):
                fine = np.geomspace(x.min(), x.max(), 200)
                axis.plot(fine, norm.cdf(np.log(fine / row["median"]) / row["dispersion"]), color=BEST, linewidth=1.6)
            axis.set_title(f"{scene}\n{state}", fontsize="small")
            axis.set(xlabel=labelled(row["measure"]), xscale="log", ylim=(-0.03, 1.03))
            _few_ticks(axis.xaxis)
            axis.annotate(_told(row), (0.03, 0.9), xycoords="axes fraction", fontsize="x-small")
            axis.grid(color="0.93")
            axis.spines[["top", "right"]].set_visible(False)
        axes[0].set_ylabel("share of runs [-]")
    return figure


def _told(row):
    if row["p_value"] is None:
        return "no curve"
    return f"p = {row['p_value']:.2g}" if is_shown(row) else f"no lognormal curve:\np = {row['p_value']:.1g}"


def draw_dispersions(result: Result) -> Figure:
    """Dispersion of every measure for each limit state, with intervals; the least one in colour."""
    scenes = list(result.settings["scenes"])
    most = max(len(states_in(result, scene)) for scene in scenes)
    figure = Figure(figsize=(1.6 + 2.5 * most, 0.6 + 2.3 * len(scenes)), layout="constrained")
    grid = figure.subplots(len(scenes), most, squeeze=False, sharex=True, sharey=True)
    for axes, scene in zip(grid, scenes, strict=True):
        for axis in axes[len(states_in(result, scene)) :]:
            axis.set_visible(False)
        for axis, state in zip(axes, states_in(result, scene), strict=False):
            rows = parted(result, "fit", scene=scene, state=state)[::-1]
            for place, row in enumerate(rows):
                _dot(axis, row["dispersion"], row["dispersion_interval"], place, BEST if row["best"] else DARK)
            axis.set_yticks(range(len(rows)), labels=[row["measure"] for row in rows], fontsize="small")
            axis.set_title(f"{scene}\n{state}", fontsize="small")
            axis.set(ylim=(-0.6, len(rows) - 0.4))
            axis.grid(axis="x", color="0.9")
            axis.spines[["top", "right"]].set_visible(False)
    grid[0][0].set_xlim(left=0)
    figure.supxlabel("dispersion [-]", fontsize="medium")
    return figure


def draw_effects(result: Result) -> Figure:
    """Shift of the median by every solver for each limit state, with intervals; a panel per scene.

    Grey: shifts that would not have been found.
    """
    scenes = list(result.settings["scenes"])
    labels = result.settings["solvers"]
    states = max(len(states_in(result, scene)) for scene in scenes)
    figure = Figure(figsize=(5.8 * len(scenes), 1.2 + 0.13 * states * len(labels)), layout="constrained")
    for axis, scene in zip(figure.subplots(1, len(scenes), squeeze=False, sharey=True)[0], scenes, strict=True):
        for place, label in enumerate(labels[::-1]):
            rows = parted(result, "effect", scene=scene, solver=label)
            for k, row in enumerate(rows[::-1]):
                height = place + 0.7 * ((k + 0.5) / len(rows) - 0.5)
                if row["detectable_shift"] is not None:
                    least, most = (_per_cent(limit) for limit in (1 / row["detectable_shift"], row["detectable_shift"]))
                    axis.plot([least, most], [height] * 2, color="0.85", linewidth=4, solid_capstyle="butt", zorder=0)
                name = label.partition(",")[0]
                colour = PERTURBED if name == ANALYTIC else style(name)["color"]
                filled = "," not in label or name == ANALYTIC
                _dot(
                    axis,
                    _per_cent(row["median_shift"]),
                    row["median_interval"] and [_per_cent(limit) for limit in row["median_interval"]],
                    height,
                    colour,
                    marker(name),
                    filled,
                )
        axis.axvline(0, color="0.6", linewidth=0.8, zorder=0)
        axis.set_xscale("symlog", linthresh=1.0)
        axis.set(title=scene, xlabel="shift of the median intensity [%]", ylim=(-0.6, len(labels) - 0.4))
        axis.xaxis.set_major_formatter("{x:g}")
        axis.set_yticks(range(len(labels)), labels=labels[::-1], fontsize="small")
        axis.grid(axis="x", color="0.9")
        axis.spines[["top", "right"]].set_visible(False)
    return figure


def _per_cent(ratio):
    return None if ratio is None else 100 * (ratio - 1)


def _dot(axis, value, reach, height, colour, mark="o", filled=True):
    if value is None:
        return
    low, high = reach or (value, value)
    axis.errorbar(
        value,
        height,
        xerr=np.maximum([[value - low], [high - value]], 0),
        fmt=mark,
        color=colour,
        markersize=4,
        capsize=2,
        markerfacecolor=colour if filled else "white",
    )


def _few_ticks(axis):
    axis.set_ticks([0.03, 0.1, 0.3, 1, 3, 10, 30])
    axis.set_major_formatter("{x:g}")
    axis.set_minor_formatter(NullFormatter())
