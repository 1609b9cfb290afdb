"""The fragility surface in words, a table and a picture, from the result alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from ...showing.parts import Section, Table, figure_of, number, percent

if TYPE_CHECKING:
    from ...running.provenance import Result

LEVELS = np.linspace(0.0, 1.0, 11)
SHOWN = 9  # rows of the table, at most


def section(result: Result) -> Section:
    """The `Section` of a result of this study."""
    s = result.settings
    asked = (
        f"{s['runs']:,} runs: {len(s['slendernesses'])} slendernesses x {len(s['intensities'])} peak ground "
        f"accelerations x {s['motions']} synthetic motions for each of {', '.join(s['solvers'])}, scene {s['scene']}. "
        f"{s['failed']} failed, {s['undecided']} ended undecided."
    )
    figure = figure_of(
        draw(result),
        "Probability of overturning as filled contours over slenderness and peak ground acceleration, one panel for "
        f"each of {', '.join(s['solvers'])}, with the line of uplift. {_answer(result)}",
        "Share of the motions that overturn the block; lines: 16, 50 and 84 %. Below the dashed line, peak ground "
        "acceleration g tan γ, no block lifts.",
    )
    return Section("Fragility surface", (asked, _answer(result)), (_table(result),), (figure,))


def draw(result: Result) -> Figure:
    """Share of motions that overturn over slenderness and peak ground acceleration; a panel per solver."""
    s = result.settings
    figure = Figure(figsize=(0.9 + 4.6 * len(s["solvers"]), 4.4), layout="constrained")
    axes = figure.subplots(1, len(s["solvers"]), squeeze=False, sharey=True)[0]
    x, y = np.array(s["slendernesses"]), np.array(s["intensities"])
    for axis, solver in zip(axes, s["solvers"], strict=True):
        sound = result.arrays[f"{solver}/sound"]
        share = result.arrays[f"{solver}/overturned"] / np.where(sound > 0, sound, 1)
        filled = axis.contourf(x, y, share.T, LEVELS, cmap="cividis")
        lines = axis.contour(
            x, y, share.T, [0.16, 0.5, 0.84], colors=["white", "black", "black"], linewidths=[0.8, 1.6, 0.8]
        )
        axis.clabel(lines, fmt=lambda level: f"{100 * level:.0f} %", fontsize="small")
        axis.plot(x, np.tan(x), color="white", linestyle="--", linewidth=1.4)
        axis.annotate(
            "uplift, g tan γ", (x[-1], np.tan(x[-1])), (-6, -30), textcoords="offset points", color="white", ha="right"
        )
        axis.set(title=f"{solver}, {s['scene']}", xlabel="slenderness γ [rad]", yscale="log", ylim=(y[0], y[-1]))
        axis.set_yticks([0.1, 0.2, 0.5, 1, 2, 3], labels=["0.1", "0.2", "0.5", "1", "2", "3"])
        axis.minorticks_off()
    axes[0].set_ylabel("peak ground acceleration [g]")
    figure.colorbar(filled, ax=list(axes), label="share of motions that overturn [-]")
    return figure


def _answer(result):
    """From where to where the intensity goes that overturns half, and whether more is always worse."""
    solver = result.settings["solvers"][0]
    rows = [row for row in result.rows if row["solver"] == solver]
    known = [row for row in rows if row["half"] is not None]
    if len(known) < 2:
        return f"{solver}: one half is crossed at fewer than two slendernesses; add intensities."
    words = [
        f"at slenderness {number(row['slenderness'])} half of the motions overturn the block at {number(row['half'])} "
        f"g, {number(row['half'] / np.tan(row['slenderness']))} times its uplift acceleration"
        for row in (known[0], known[-1])
    ]
    worst = max(rows, key=lambda row: row["falls_by"])
    return (
        f"{solver}: {words[0]}; {words[1]}. A stronger motion is not always the worse one: at slenderness "
        f"{number(worst['slenderness'])} the share falls again by {percent(worst['falls_by'])} on the way up."
    )


def _table(result):
    shown = []
    for solver in result.settings["solvers"]:
        rows = [row for row in result.rows if row["solver"] == solver]
        for k in np.unique(np.linspace(0, len(rows) - 1, min(SHOWN, len(rows))).astype(int)):
            row = rows[k]
            over = None if row["half"] is None else row["half"] / np.tan(row["slenderness"])
            shown.append(
                (
                    solver,
                    number(row["slenderness"]),
                    number(row["half"]),
                    " to ".join(number(limit) for limit in row["interval"]),
                    number(over),
                    percent(row["falls_by"]),
                    percent(row["widest"]),
                )
            )
    return Table(
        "Peak ground acceleration that overturns half, with its 95 % interval; widest Wilson interval of a share",
        ("solver", "slenderness [rad]", "half at [g]", "interval [g]", "over g tan γ [-]", "falls again by", "widest"),
        shown,
    )
