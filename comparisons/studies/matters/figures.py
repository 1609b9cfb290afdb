"""What matters, in pictures, from the result alone: changes ranked, and the vertical motion's share over V/H."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure

from ...showing.plots import marker, style

if TYPE_CHECKING:
    from ...running.provenance import Result

ANALYTIC = "analytic"
CHANGED = "0.25"
SHADES = {1: "#009E73", 2: "#0072B2", 4: "#CC79A7"}  # of vertical motions so many times as fast


def parted(result: Result, part: str, scene: str) -> list[dict[str, Any]]:
    """The rows of a part in a scene."""
    return [row for row in result.rows if row["part"] == part and row["scene"] == scene]


def ranked(result: Result, scene: str) -> list[dict[str, Any]]:
    """Changes and engines, the one that flips most verdicts first."""
    rows = [row for row in parted(result, "change", scene) if row["runs"]]
    return sorted(rows, key=lambda row: (-row["flips"] / row["runs"], row["change"]))


def at_best(result: Result, row: dict[str, Any]) -> bool:
    """Whether a row is that of an engine's default variant."""
    return row["change"] in result.settings["best"]


def draw(result: Result) -> Figure:
    """Share of flipped verdicts, ranked; a panel per scene."""
    scenes = list(result.settings["scenes"])
    most = max(len(ranked(result, scene)) for scene in scenes)
    figure = Figure(figsize=(6.4 * len(scenes), 1.2 + 0.26 * most), layout="constrained")
    for axis, scene in zip(figure.subplots(1, len(scenes), squeeze=False)[0], scenes, strict=True):
        rows = ranked(result, scene)[::-1]
        for place, row in enumerate(rows):
            engine = row["solver"] != ANALYTIC
            colour = style(row["solver"])["color"] if engine else CHANGED
            share = 100 * row["flips"] / row["runs"]
            reach = [[share - 100 * row["low"]], [100 * row["high"] - share]]
            axis.errorbar(
                share,
                place,
                xerr=np.maximum(reach, 0),
                fmt=marker(row["solver"]) if engine else "o",
                color=colour,
                markersize=5,
                capsize=2,
                markerfacecolor=colour if not engine or at_best(result, row) else "white",
            )
        axis.set_xscale("symlog", linthresh=0.1)
        axis.set(title=scene, xlabel="verdicts flipped [%]", xlim=(-0.02, 110), ylim=(-0.7, len(rows) - 0.3))
        axis.set_xticks([0, 0.1, 0.3, 1, 3, 10, 30, 100], labels=["0", "0.1", "0.3", "1", "3", "10", "30", "100"])
        axis.minorticks_off()
        axis.set_yticks(range(len(rows)), labels=[row["change"] for row in rows], fontsize="small")
        axis.grid(axis="x", color="0.9")
        axis.spines[["top", "right"]].set_visible(False)
    return figure


def speed(faster: float) -> str:
    """How fast a vertical motion is, in words."""
    return "as fast as the horizontal" if faster == 1 else f"{faster:.3g} times as fast"


def draw_vertical(result: Result) -> Figure:
    """Share of verdicts that the vertical motion flips over V/H, for each of its speeds; a panel per scene.

    Diamonds: recorded triples, where the result has any.
    """
    scenes = list(result.settings["scenes"])
    figure = Figure(figsize=(5.2 * len(scenes), 3.6), layout="constrained")
    for axis, scene in zip(figure.subplots(1, len(scenes), squeeze=False, sharey=True)[0], scenes, strict=True):
        rows = [row for row in parted(result, "vertical", scene) if row["ratio"]]
        for place, faster in enumerate(dict.fromkeys(row["faster"] for row in rows)):
            chosen = [row for row in rows if row["faster"] == faster]
            share, low, high = (
                100 * np.array(values)
                for values in zip(
                    *((row["flips"] / row["runs"], row["low"], row["high"]) for row in chosen), strict=True
                )
            )
            axis.errorbar(
                np.array([row["ratio"] for row in chosen]) + 0.012 * (place - 1),
                share,
                np.maximum([share - low, high - share], 0),
                fmt="o-",
                color=SHADES.get(faster, "0.4"),
                markersize=4,
                capsize=2,
                label=f"synthetic, {speed(faster)}",
            )
        for row in parted(result, "record", scene):
            axis.plot(row["ratio"], 100 * row["flips"] / row["runs"], "D", color="black", markerfacecolor="white")
            axis.annotate(
                f"{row['faster']:.1f} x",
                (row["ratio"], 100 * row["flips"] / row["runs"]),
                (5, 4),
                textcoords="offset points",
            )
        axis.set(title=scene, xlabel="peak vertical over peak horizontal acceleration [-]")
        axis.grid(color="0.92")
        axis.spines[["top", "right"]].set_visible(False)
        axis.set_ylabel("verdicts flipped [%]")
        axis.margins(y=0.12)
        axis.set_ylim(bottom=0)
    if figure.axes[0].containers:
        figure.legend(
            *figure.axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=3, fontsize="small"
        )
    return figure
