"""The Caryatid over time: Figs 4 and 6."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...showing.plots import style
from .canvas import Drawing, axes_of
from .runs import FREE, ISOLATED

if TYPE_CHECKING:
    from ...running.provenance import Result


def free_standing(result: Result) -> Drawing:
    """Fig. 4: the motion, and the free-standing Caryatid."""
    figure, (above, below) = axes_of(2, 1, height=4.4, sharex=True)
    _ground(above, result)
    _draw(below, result, FREE, "tilt", result.settings["slenderness"])
    for level in (-1, 1):
        below.axhline(level, color="0.6", linewidth=0.8, linestyle=":")
    ends = [row["end"]["time"] for row in result.rows if row["scene"] == FREE and row["end"]]
    below.set(xlabel="time [s]", ylabel="tilt φ / γ [-]", ylim=(-2.5, 2.5), xlim=(0, 1.5 * max(ends)))
    below.legend(fontsize=9)
    return Drawing(
        figure,
        "Ground acceleration, and below it the tilt of the free-standing Caryatid in all solvers until it overturns.",
        f"Fig. 4, {result.settings['motion']['label']}: the free-standing Caryatid. Dotted: |φ| = γ.",
    )


def isolated(result: Result) -> Drawing:
    """Fig. 6: tilt and displacement of the isolated Caryatid."""
    figure, (above, below) = axes_of(2, 1, height=4.4, sharex=True)
    _draw(above, result, ISOLATED, "tilt", result.settings["slenderness"])
    _draw(below, result, ISOLATED, "base_displacement")
    for level in (-1, 1):
        below.axhline(level * result.settings["x_max"], color="0.6", linewidth=0.8, linestyle=":")
    above.set(ylabel="tilt φ / γ [-]", ylim=(-0.05, 0.05))
    above.legend(fontsize=9)
    below.set(xlabel="time [s]", ylabel="displacement x [m]")
    return Drawing(
        figure,
        "Tilt at zero and base displacement over time, all solvers over each other.",
        f"Fig. 6, {result.settings['motion']['label']}: the isolated Caryatid does not rock; dotted: x_max.",
    )


def _draw(axis, result, scene, column, unit=1.0):
    """A column of the histories of one scene over time, in every solver, in that unit."""
    for row in result.rows:
        key = f"{scene}/{row['solver']}/"
        if row["scene"] == scene and key + "time" in result.arrays:
            values = result.arrays[key + column] / unit
            axis.plot(result.arrays[key + "time"], values, label=row["solver"], **style(row["solver"]))


def _ground(axis, result):
    axis.plot(result.arrays["motion/time"], result.arrays["motion/acceleration"] / 9.81, color="0.35", linewidth=0.8)
    axis.axvline(result.settings["motion"]["peak_time"], color="0.7", linestyle=":", linewidth=0.8)
    axis.set_ylabel("ground acceleration [g]")
