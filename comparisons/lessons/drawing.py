"""Figures of the lessons, drawn with placeholders for colours that a page replaces by its own, light or dark."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

import matplotlib
from matplotlib.figure import Figure

from ..showing.parts import element_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

INK, SOFT, GRID, PANEL = "#1c1b19", "#5f5b54", "#e4e0d8", "#fffffe"
MODEL, OTHER, THIRD = "#0072b2", "#d55e00", "#00795c"  # distinguishable for colour-blind readers, and by their dashes
STONE = "#e9e0cb"
# Outcomes in maps: stands, rocks, overturns after impacts, overturns without one.
OUTCOMES = ("#d9d5cc", "#56b4e9", "#f0a500", "#c23b00")
VARIABLES = {
    INK: "ink", SOFT: "soft", GRID: "grid", PANEL: "panel", MODEL: "model", OTHER: "ghost", THIRD: "third",
    STONE: "stone", OUTCOMES[0]: "stands",
}  # fmt: skip
STYLE: Any = {  # keys of matplotlib's rcParams
    "font.family": "sans-serif",
    "font.size": 11,
    "axes.edgecolor": SOFT,
    "axes.labelcolor": INK,
    "axes.facecolor": "none",
    "figure.facecolor": "none",
    "text.color": INK,
    "xtick.color": SOFT,
    "ytick.color": SOFT,
    "axes.grid": True,
    "grid.color": GRID,
    "grid.linewidth": 0.8,
    "axes.axisbelow": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.unicode_minus": True,
    "lines.linewidth": 1.9,
    "legend.frameon": False,
    "legend.fontsize": 10,
    "legend.labelcolor": INK,
    "svg.fonttype": "none",
    "path.simplify_threshold": 0.3,
}
WIDTH, HEIGHT = 5.4, 4.4  # inch; text is readable on a phone
WIDE = (9.6, 5.4)  # inch, 16:9, of the figures for slides
LICENCE = "rocking lessons, MIT licence"


def canvas(rows: int = 1, heights: tuple[float, ...] = (1,), **more: Any) -> tuple[Figure, Any]:
    """(figure, its axes from `Figure.subplots`) in the lessons' style."""
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(WIDTH, HEIGHT))
        axes = figure.subplots(rows, height_ratios=heights, **more)
        figure.subplots_adjust(left=0.14, right=0.97, top=0.965, bottom=0.125, hspace=0.42, wspace=0.12)
    return figure, axes


def tilt_axis(axes: Axes, time: Any, ratio: Any, window: float, **more: Any) -> None:
    """Tilt over slenderness in time [s] up to the window, with the lines at which the block is balanced."""
    axes.plot(time, ratio, color=MODEL)
    for level in (-1, 1):
        axes.axhline(level, color=SOFT, linewidth=0.9, linestyle=(0, (4, 4)))
    axes.set(xlim=(0, window), ylim=(-1.5, 1.5), ylabel="tilt φ / γ", **more)


def legend(axes: Axes, **more: Any) -> None:
    """A legend in the lessons' style."""
    with matplotlib.rc_context(STYLE):
        axes.legend(**more)


def svg(figure: Figure, name: str) -> str:
    """The figure as an inline SVG element in the colours of its page; `name` makes the names of its parts unique."""
    file = io.BytesIO()
    with matplotlib.rc_context({**STYLE, "svg.hashsalt": name}):
        figure.savefig(file, format="svg", transparent=True, metadata={"Date": None, "Creator": None})
    text = element_of(file.getvalue().decode(), 'aria-hidden="true"')
    for colour, variable in VARIABLES.items():
        text = text.replace(colour, f"var(--{variable})")
    return text


def downloads(figure: Figure) -> dict[str, bytes]:
    """{kind: file} of the figure for slides, 16:9, with its licence line: "svg", and "png" of 1920 by 1080 pixels."""
    figure.set_size_inches(*WIDE)
    figure.subplots_adjust(left=figure.subplotpars.left * WIDTH / WIDE[0], bottom=0.13)
    figure.text(0.985, 0.012, LICENCE, ha="right", color=SOFT, fontsize=7)
    files = {"svg": io.BytesIO(), "png": io.BytesIO()}
    with matplotlib.rc_context({**STYLE, "svg.hashsalt": "download"}):
        for kind, file in files.items():
            undated = {"Date": None} if kind == "svg" else {}
            figure.savefig(file, format=kind, dpi=200, facecolor="white", metadata=undated)
    return {kind: file.getvalue() for kind, file in files.items()}
