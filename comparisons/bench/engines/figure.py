"""Where in the wide box an engine is right, warns, fails or is off."""

from collections.abc import Mapping, Sequence
from os import PathLike
from typing import Any

from matplotlib.figure import Figure

from ...measuring.verdicts import CLASSES

# Okabe and Ito: told apart in every colour vision; markers differ as well. The later ones lie on top.
STYLES = {
    "right": ("#56B4E9", "o", 9),
    "left out": ("#BBBBBB", ".", 6),
    "right but warned": ("#009E73", "^", 16),
    "off and warned": ("#E69F00", "v", 18),
    "failed and said": ("#000000", "s", 14),
    "off and silent": ("#D55E00", "X", 44),
}
LABELS = {
    "slenderness": "slenderness [rad]",
    "excess": "J_O/(m R²) - 1",
    "base": "base over block mass",
    "radius": "radius R [m]",
    "tilt": "released at tilt / slenderness",
    "mass": "block mass [kg]",
    "amplitude": "pulse / uplift acceleration",
    "frequency": "base's frequency on bearings / omega_r",
    "damping": "n_d c / (m_b omega_r)",
}
PANELS = (
    ("slenderness", "excess"),
    ("base", "frequency"),
    ("slenderness", "base"),
    ("radius", "mass"),
    ("frequency", "damping"),
    ("tilt", "slenderness"),
    ("amplitude", "slenderness"),
)


def draw(rows: Sequence[Mapping[str, Any]], title: str, path: str | PathLike[str]) -> None:
    """Write the figure of result rows to `path`."""
    figure = Figure(figsize=(14, 7.2), layout="constrained")
    axes = figure.subplots(2, 4).ravel()
    for axis, (across, up) in zip(axes[1:], PANELS, strict=True):
        for name, (colour, marker, size) in STYLES.items():
            points = [(_value(row, across), _value(row, up)) for row in rows if row["class"] == name]
            points = [point for point in points if None not in point and 0 not in point]
            if points:
                axis.scatter(*zip(*points, strict=True), s=size, c=colour, marker=marker, linewidths=0)
        axis.set(xlabel=LABELS[across], ylabel=LABELS[up], xscale=_scale(across), yscale=_scale(up))
        axis.grid(color="0.93", zorder=-1)
    _bars(axes[0], rows)
    figure.suptitle(title)
    figure.savefig(path, dpi=130)


def _bars(axis, rows):
    counts = [sum(row["class"] == name for row in rows) for name in CLASSES]
    places = range(len(CLASSES))
    axis.barh(places, counts, color=[STYLES[name][0] for name in CLASSES])
    axis.scatter([0] * len(CLASSES), places, c="white", s=1)
    for place, name, count in zip(places, CLASSES, counts, strict=True):
        axis.text(count, place, f" {count}", va="center", fontsize=9)
        axis.scatter([-0.045 * max(counts)], [place], c=STYLES[name][0], marker=STYLES[name][1], s=40, clip_on=False)
    axis.set_yticks(list(places), CLASSES)
    axis.tick_params(axis="y", pad=14, length=0)
    axis.set(xlabel="scenes", xlim=(0, 1.18 * max(counts)))
    axis.invert_yaxis()
    axis.spines[["top", "right"]].set_visible(False)


def _value(row, name):
    return row["place"]["inertia"] - 1 if name == "excess" else row["place"].get(name)


def _scale(name):
    return "linear" if name == "slenderness" else "log"
