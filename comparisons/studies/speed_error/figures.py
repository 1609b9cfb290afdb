"""Figures of the speed-error study; drawn from a result, axes at choice."""

from typing import Annotated

import typer
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import LogFormatterSciNotation, NullFormatter

from analytic.errors import SettingError
from engines import ENGINES

from ...running.provenance import Result
from .growth import AGAINST
from .ladders import NEEDED
from .measure import MEASURES
from .tables import growths, ladder, principal

# Okabe and Ito: kind of solver by colour, member of it by marker.
COLOURS = {"kernel": "#000000", "scipy": "#56B4E9", "time-stepping": "#777777"}
OTHER_COLOUR = "#D55E00"
MARKERS = "osD^vPX*"
COSTS = {
    "cpu": ("CPU time of one run [s]", "cpu_seconds"),
    "cpu-per-second": ("CPU time per simulated second [s/s]", "cpu_per_second"),
    "cpu-per-step": ("CPU time per step [s]", "cpu_per_step"),
    "step": ("mean step [s]", "step"),
    "steps": ("steps [-]", "steps"),
}
PRINCIPAL = "error"
SMALLEST = 1e-17  # an error below it, or none at all, cannot be drawn on a logarithmic axis


def axis_names() -> tuple[str, ...]:
    """What --x and --y may be."""
    return (*COSTS, PRINCIPAL, *(name.replace("_", "-") for name in MEASURES))


def check_axes(*names: str) -> None:
    """Raise `SettingError` for an axis that does not exist."""
    for name in names:
        if name not in axis_names():
            raise SettingError(f"axis {name!r}: choose one of {', '.join(axis_names())}")


def _checked(name: str) -> str:
    """The axis, refused before the work if it does not exist."""
    check_axes(name)
    return name


Horizontal = Annotated[str, typer.Option(help="Horizontal axis of the figure.", callback=_checked)]
Vertical = Annotated[
    str, typer.Option(help="Vertical axis; 'error' is each scene's principal measure.", callback=_checked)
]


def figures(result: Result, *, x: Horizontal = "cpu", y: Vertical = "error") -> dict[str, Figure]:
    """Figures of the study by the suffix of their files."""
    if (x, y) != ("cpu", PRINCIPAL):
        return {f"{x}-{y}": draw_pareto(result, x, y)}
    return {"": draw_pareto(result), "step": draw_pareto(result, "step"), "growth": draw_growth(result)}


def draw_pareto(result: Result, x: str = "cpu", y: str = PRINCIPAL) -> Figure:
    """One panel per scene: every solver's ladder, one point per setting, as a matplotlib Figure.

    Crosses: impacts lost. Hollow markers: modelled with more than the scene needs.
    """
    check_axes(x, y)
    scenes = list(result.settings["scenes"])
    figure = Figure(figsize=(12.5, 8.6), layout="constrained")
    axes = figure.subplots(2, 3).flat
    looks = _looks([row["family"] for row in ladder(result)])
    for axis, scene in zip(axes, scenes, strict=False):
        _panel(axis, result, scene, x, y, looks)
    for axis in figure.axes[len(scenes) :]:
        axis.axis("off")
    _legend(figure.axes[len(scenes)], looks)
    return figure


def _looks(families):
    """{family: line keywords}."""
    counts, styles = {}, {}
    for family in dict.fromkeys(families):
        base, other_law, _ = family.partition(", Bouc-Wen")
        if other_law:
            styles[family] = {**styles[base], "linestyle": (0, (3, 2)), "markersize": 4}
            continue
        kind = family.replace(",", "").split()[0]
        colour = ENGINES[kind].colour if kind in ENGINES else COLOURS.get(kind, OTHER_COLOUR)
        number = counts[colour] = counts.get(colour, -1) + 1
        styles[family] = {
            "color": colour,
            "marker": MARKERS[number % len(MARKERS)],
            "linestyle": "-",
            "markersize": 5.5,
        }
    return styles


def _panel(axis, result, scene, x, y, looks):
    rows = [row for row in ladder(result) if row["scene"] == scene and not row["failure"]]
    drawn = False
    for family, model in dict.fromkeys((row["family"], row["model"]) for row in rows):
        mine = [row for row in rows if (row["family"], row["model"]) == (family, model)]
        points = [(_value(result, row, x), _value(result, row, y), row["lost_impacts"] or 0) for row in mine]
        points = [(a, b, lost) for a, b, lost in points if a and b and a > SMALLEST and b > SMALLEST]
        if not points:
            continue
        drawn, look = True, looks[family]
        hollow = model != NEEDED
        sound = [(a, b) for a, b, lost in points if not lost]
        axis.plot(
            *zip(*sound, strict=True) if sound else ((), ()),
            linewidth=0 if hollow else 1.0,
            **{**look, "markerfacecolor": "none" if hollow else look["color"]},
        )
        wrong = [(a, b) for a, b, lost in points if lost]
        if wrong:
            axis.plot(*zip(*wrong, strict=True), "x", color=look["color"], markersize=7, markeredgewidth=1.6)
    axis.set(xscale="log", yscale="log", xlabel=_label(result, scene, x), ylabel=_label(result, scene, y))
    axis.set_title(result.settings["scenes"][scene]["title"], fontsize=11)
    axis.grid(True, which="major", color="0.9")
    if not drawn:
        axis.text(0.5, 0.5, "not measured here", transform=axis.transAxes, ha="center", color="0.4")


def _value(result, row, name):
    if name in COSTS:
        return row.get(COSTS[name][1])
    measure = principal(result, row["scene"]) if name == PRINCIPAL else name.replace("-", "_")
    return row["errors"].get(measure)


def _label(result, scene, name):
    if name in COSTS:
        return COSTS[name][0]
    return MEASURES[principal(result, scene) if name == PRINCIPAL else name.replace("-", "_")][0]


def _legend(axis, looks):
    lines = [Line2D([], [], label=family, **look) for family, look in looks.items()]
    lines += [
        Line2D([], [], color="0.3", marker="x", linewidth=0, label="impacts lost"),
        Line2D([], [], color="0.3", marker="o", markerfacecolor="none", linewidth=0, label="more than the scene needs"),
    ]
    axis.legend(handles=lines, loc="center", fontsize=9, ncols=1 if len(lines) < 22 else 2, frameon=False)


def draw_growth(result: Result) -> Figure:
    """CPU time against duration, sample rate and number of runs; memory against duration."""
    figure = Figure(figsize=(11, 7), layout="constrained")
    axes = figure.subplots(2, 2)
    series = growths(result)
    looks = _looks([family for _, family in series])
    for axis, (against, label) in zip(axes.flat, AGAINST.items(), strict=False):
        for (what, family), found in series.items():
            if what == against:
                words = f"{family}: exponent {found['exponent']:.3f}" if "exponent" in found else family
                axis.plot(found["value"], found["cpu_seconds"], label=words, **looks[family])
        axis.set(xscale="log", yscale="log", xlabel=label, ylabel="CPU time [s]")
    memory = axes[1, 1]
    for (what, family), found in series.items():
        if what == "duration":
            memory.plot(
                found["value"],
                [value / 2**20 for value in found["traced_bytes"]],
                label=f"{family}: allocated",
                **looks[family],
            )
            resident = [None if value is None else value / 2**20 for value in found["resident_bytes"]]
            if None not in resident:
                memory.plot(
                    found["value"],
                    resident,
                    label=f"{family}: resident",
                    **{**looks[family], "linestyle": ":", "markerfacecolor": "none"},
                )
    memory.set_title("allocated by Python and numpy; resident in the process", fontsize=9)
    memory.set(xscale="log", xlabel=AGAINST["duration"], ylabel="memory of the run, peak [MiB]")
    memory.set_yscale("symlog", linthresh=0.01)
    memory.set_ylim(-0.002, 3 * memory.get_ylim()[1])
    for axis in axes.flat:
        axis.grid(True, which="major", color="0.9")
        axis.xaxis.set_minor_formatter(NullFormatter())
        low, high = axis.get_xlim()
        if axis.lines and high < 100 * low:  # decades alone would be too few labels
            values = axis.lines[0].get_xdata()
            axis.set_xticks(values, [f"{value:g}" for value in values])
        low, high = axis.get_ylim()
        if low > 0:
            axis.yaxis.set_minor_formatter(
                NullFormatter() if high > 100 * low else LogFormatterSciNotation(minor_thresholds=(3, 0.4))
            )
        if axis.lines:
            axis.legend(fontsize=8, **({"loc": "lower left", "bbox_to_anchor": (0.0, 0.08)} if axis is memory else {}))
    return figure
