"""What the study's figures are drawn on: their size, the colours of Okabe and Ito, and what is said of each."""

from dataclasses import dataclass
from typing import Any

from matplotlib.figure import Figure

WIDTH = 5.6  # in
BLACK, ORANGE, SKY, GREEN = "#000000", "#E69F00", "#56B4E9", "#009E73"
BLUE, RED, PURPLE = "#0072B2", "#D55E00", "#CC79A7"


@dataclass(frozen=True)
class Drawing:
    """A matplotlib figure, what it shows for those who cannot see it, and what to look at."""

    figure: Figure
    alt: str
    caption: str


def axes_of(rows: int = 1, columns: int = 1, height: float = 3.2, **kind: Any) -> tuple[Figure, Any]:
    """(figure, its axes) of this height [in]; kind: as matplotlib's subplots."""
    figure = Figure(figsize=(WIDTH, height), layout="constrained")
    return figure, figure.subplots(rows, columns, **kind)
