"""Error against CPU time, one panel per problem."""

import math
from collections.abc import Mapping, Sequence
from os import PathLike
from typing import Any

from matplotlib.figure import Figure

# Okabe and Ito: told apart in every colour vision; markers differ as well.
STYLES = {
    "kernel": ("#000000", "o"),
    "heyoka": ("#D55E00", "s"),
    "CyRK DOP853": ("#E69F00", "^"),
    "CVODE Adams": ("#CC79A7", "v"),
    "RK45": ("#56B4E9", "D"),
    "DOP853": ("#0072B2", "P"),
    "LSODA": ("#009E73", "X"),
    "Radau": ("#999999", "*"),
}
FLOOR = 1e-16  # errors below it are drawn on it


def draw(rows: Sequence[Mapping[str, Any]], machine: Mapping[str, Any], path: str | PathLike[str]) -> None:
    """Write the work-precision plot of result rows to `path`; wrong counts of impacts are crossed out, not joined."""
    problems = list(dict.fromkeys(row["problem"] for row in rows))
    columns = min(2, len(problems))
    lines = -(-len(problems) // columns)
    figure = Figure(figsize=(6.2 * columns, 0.8 + 4.2 * lines), layout="constrained")
    axes = figure.subplots(lines, columns, squeeze=False)
    rows = [row for row in rows if row["cpu_seconds"] is not None and math.isfinite(row["error"])]
    for axis, problem in zip(axes.flat, problems, strict=False):
        _panel(axis, problem, [row for row in rows if row["problem"] == problem])
    for axis in axes.flat[len(problems) :]:
        axis.remove()
    known = {
        label: handle for axis in figure.axes for handle, label in zip(*axis.get_legend_handles_labels(), strict=True)
    }
    figure.legend(known.values(), known.keys(), loc="outside lower center", ncols=4, fontsize=8)
    figure.suptitle(f"Error against CPU time of one run; {machine['processor']}, one core", fontsize=11)
    figure.savefig(path, dpi=130)


def _panel(axis, problem, rows):
    for solver in dict.fromkeys(row["solver"] for row in rows):
        base, _, variant = solver.partition(",")
        colour, marker = STYLES[base]
        sound = [row for row in rows if row["solver"] == solver and row["counted"]]
        wrong = [row for row in rows if row["solver"] == solver and not row["counted"]]
        look = {
            "color": colour,
            "marker": marker,
            "markersize": 5,
            "linestyle": "--" if variant else "-",
            "markerfacecolor": "none" if variant else colour,
            "label": solver,
            "linewidth": 1.2,
        }
        axis.plot([row["cpu_seconds"] for row in sound], [max(row["error"], FLOOR) for row in sound], **look)
        if wrong:
            axis.plot(
                [row["cpu_seconds"] for row in wrong],
                [max(row["error"], FLOOR) for row in wrong],
                "x",
                color=colour,
                markersize=8,
                label=f"{solver}: impacts missed",
            )
    axis.set(xscale="log", yscale="log", xlabel="CPU time of one run [s]", ylabel="error / scale", title=problem)
    axis.grid(True, which="major", color="0.9")
