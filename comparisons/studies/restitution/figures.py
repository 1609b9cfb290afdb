"""The figures of the restitution study, drawn from its result alone."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from ...showing.plots import style

if TYPE_CHECKING:
    from ...running.provenance import Result

WIDTH = 6.4  # in
# In the order of an engine's variants: marker, dashes, whether the marker is filled.
LOOKS = (("o", "-", True), ("s", "--", False), ("^", ":", False))
UNITS = {"stiffness": " N/m", "step": " s"}  # of accuracy knobs that have one
FLOOR = 1e-9  # errors below are drawn here
GROUNDS = ("rigid ground", "sliding base")


def figures(result: Result) -> dict[str, Figure]:
    """{name: matplotlib figure}."""
    drawn = {
        "maps": maps(result, "rms", "error of restitution, rms [-]"),
        "jump-maps": maps(result, "jump_rms", "relative error of the base velocity jump, rms [-]"),
        "cost": accuracy(result),
        "causes": causes(result),
        "eq8": equation_8(result),
    }
    return {name: figure for name, figure in drawn.items() if figure is not None}


def select(result: Result, part: str, **wanted: Any) -> list[dict[str, Any]]:
    """Rows of a part whose columns have these values."""
    return [
        row for row in result.rows if row["part"] == part and all(row[key] == value for key, value in wanted.items())
    ]


def knob_of(result: Result, row: Mapping[str, Any]) -> str:
    """Name of the accuracy knob of a row's variant."""
    return next(
        knob["knob"]
        for knob in result.settings["knobs"]
        if (knob["engine"], knob["variant"]) == (row["engine"], row["variant"])
    )


def base_name(ratio: float | None) -> str:
    """A mass ratio as a label."""
    return "rigid" if ratio is None else f"{ratio:.2g}"


def maps(result: Result, measure: str, label: str) -> Figure:
    """Error over slenderness and base mass at the default setting, a panel for each variant."""
    knobs = result.settings["knobs"]
    gammas = result.settings["slendernesses"]
    ratios = [ratio for ratio in result.settings["ratios"] if measure == "rms" or ratio is not None]
    columns = min(3, len(knobs))
    lines = -(-len(knobs) // columns)
    figure = Figure(figsize=(WIDTH, 0.9 + (0.5 + 0.22 * len(gammas)) * lines), layout="constrained")
    axes = figure.subplots(lines, columns, sharex=True, sharey=True, squeeze=False)
    norm, image = LogNorm(1e-6, 1.0), None
    for axis, knob in zip(axes.flat, knobs, strict=False):
        table = np.full((len(gammas), len(ratios)), np.nan)
        for row in select(result, "cell", engine=knob["engine"], variant=knob["variant"], value=knob["default"]):
            if row["ratio"] not in ratios:
                continue
            i, j = gammas.index(row["slenderness"]), ratios.index(row["ratio"])
            if row[measure] is not None:
                table[i, j] = row[measure]
            if row["failed"]:
                axis.text(
                    j,
                    i,
                    f"{row['failed']}/{row['runs']}",
                    ha="center",
                    va="center",
                    fontsize=6.5,
                    color="black",
                    bbox={"facecolor": "white", "alpha": 0.7, "pad": 0.5, "linewidth": 0},
                )
        image = axis.imshow(
            np.clip(table, norm.vmin, norm.vmax), norm=norm, cmap="cividis", origin="lower", aspect="auto"
        )
        axis.set_title(f"{knob['engine']},\n{knob['variant']}", fontsize=8)
        axis.set_xticks(range(len(ratios)), [base_name(ratio) for ratio in ratios], fontsize=7, rotation=40)
        axis.set_yticks(range(len(gammas)), [f"{gamma:g}" for gamma in gammas], fontsize=7)
    for axis in axes.flat[len(knobs) :]:
        axis.axis("off")
    figure.supxlabel("base over block mass $m_b/m$ [-]", fontsize=9)
    figure.supylabel("slenderness γ [rad]", fontsize=9)
    figure.colorbar(image, ax=axes, label=label, extend="both", shrink=0.9)
    return figure


def look(result: Result, engine: str, variant: str) -> dict[str, Any]:
    """Line keywords of a variant."""
    names = [knob["variant"] for knob in result.settings["knobs"] if knob["engine"] == engine]
    marker, dashes, filled = LOOKS[names.index(variant) % len(LOOKS)]
    colour = style(engine)["color"]
    return {
        "color": colour,
        "marker": marker,
        "linestyle": dashes,
        "markersize": 5,
        "markerfacecolor": colour if filled else "white",
    }


def accuracy(result: Result) -> Figure:
    """Error against the accuracy knob, and against the cost of the same runs."""
    figure = Figure(figsize=(WIDTH, 6.2), layout="constrained")
    axes = figure.subplots(2, 2, sharey=True)
    for column, ground in enumerate(GROUNDS):
        for knob in result.settings["knobs"]:
            rows = [
                row
                for row in select(
                    result, "summary", scope="ladder", engine=knob["engine"], variant=knob["variant"], ground=ground
                )
                if row["rms"] is not None
            ]
            if not rows:
                continue
            line = look(result, knob["engine"], knob["variant"])
            errors = [max(row["rms"], FLOOR) for row in rows]
            axes[0, column].plot(
                [row["value"] / knob["default"] for row in rows],
                errors,
                **line,
                label=f"{knob['engine']}, {knob['variant']} ({knob['knob']})",
            )
            axes[1, column].plot([row["cpu_per_second"] for row in rows], errors, **line)
        axes[0, column].set_title(ground, fontsize=10)
        axes[0, column].set_xlabel("accuracy knob over its default [-]")
        axes[1, column].set_xlabel("CPU time per simulated second [s/s]")
    for axis in axes.flat:
        if axis.lines:
            axis.set(xscale="log", yscale="log")
        axis.grid(color="0.9")
        axis.set_axisbelow(True)
        axis.xaxis.set_minor_formatter(NullFormatter())
    for axis in axes[:, 0]:
        axis.set_ylabel("error of restitution, rms [-]")
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=2, fontsize=8)
    return figure


def causes(result: Result) -> Figure | None:
    """Experiments, each changing one suspected cause in one variant; None where no engine ran them."""
    panels = [
        (draw, rows)
        for draw, rows in (
            (_phase, select(result, "phase")),
            (_stiffness, select(result, "experiment", experiment="stiffness")),
            (_friction, select(result, "experiment", experiment="friction")),
            (_flight_damping, select(result, "flight damping")),
        )
        for rows in by_variant(rows)
    ]
    if not panels:
        return None
    lines = -(-len(panels) // 2)
    figure = Figure(figsize=(WIDTH, 3.0 * lines), layout="constrained")
    axes = figure.subplots(lines, 2, squeeze=False).flat
    for axis, (draw, rows) in zip(axes, panels, strict=False):
        draw(axis, rows, result)
        axis.set_title(f"{axis.get_title()}\n{rows[0]['engine']}, {rows[0]['variant']}")
        axis.grid(color="0.9")
        axis.set_axisbelow(True)
        axis.legend(fontsize=7)
        axis.title.set_fontsize(9)
    for axis in list(axes):
        axis.axis("off")
    return figure


def by_variant(rows: Sequence[Mapping[str, Any]]) -> list[list[Any]]:
    """The rows of each engine's variant, list of lists."""
    groups = {}
    for row in rows:
        groups.setdefault((row["engine"], row["variant"]), []).append(row)
    return list(groups.values())


def _phase(axis, rows, result):
    for row, marker, shade in zip(rows, "os^", ("#0072B2", "#56B4E9", "#000000"), strict=False):
        key = f"phase/{row['engine']}/{row['variant']}/{row['step']:g}"
        error = result.arrays[f"{key}/error"] / row["step"]
        axis.plot(
            result.arrays[f"{key}/phase"],
            error,
            marker,
            color=shade,
            markersize=3,
            label=f"step {1e3 * row['step']:g} ms",
        )
    axis.set(
        xlabel="place of the impact within the step [-]",
        ylabel="error of restitution / step [1/s]",
        title="Phase of the step",
    )


def _ladder(axis, rows, floor=FLOOR):
    for ratio, marker, dashes, filled in ((None, "o", "-", True), ("base", "s", "--", False)):
        own = [row for row in rows if (row["ratio"] is None) == (ratio is None) and row["rms"] is not None]
        colour = style(rows[0]["engine"])["color"]
        axis.plot(
            [row["value"] for row in own],
            [max(row["rms"], floor) for row in own],
            marker=marker,
            linestyle=dashes,
            color=colour,
            markerfacecolor=colour if filled else "white",
            label="rigid ground" if ratio is None else "sliding base, $m_b$ = 212 kg",
        )
    axis.set(xscale="log", yscale="log", ylabel="error of restitution, rms [-]")


def _stiffness(axis, rows, result):
    _ladder(axis, rows)
    axis.set(xlabel="contact stiffness [N/m]", title="Stiffness")


def _friction(axis, rows, result):
    _ladder(axis, rows)
    for ground, dashes in zip(GROUNDS, ("-", "--"), strict=True):
        axis.axvline(
            result.settings["friction_needed"][ground],
            color="0.5",
            linewidth=1,
            linestyle=dashes,
            label=f"model's need, {ground}",
        )
    axis.set(xlabel="friction coefficient [-]", ylim=(1e-7, 1e3), title="Friction")


def _flight_damping(axis, rows, result):
    """Blocks that need more friction than the variant's are off the scale: they slide."""
    values, friction = sorted({row["value"] for row in rows}), rows[0]["friction"]
    stick = [row for row in rows if friction is None or row["friction_needed"] < friction]
    knob = knob_of(result, rows[0])
    predicted = sorted({(row["slenderness"], row["predicted"]) for row in rows})
    axis.plot(*zip(*predicted, strict=True), "-", color="black", label="default damping in flight, predicted")
    for value, marker in zip(values, "o^sv", strict=False):
        own = sorted((row["slenderness"], row["measured"]) for row in stick if row["value"] == value)
        axis.plot(
            *(zip(*own, strict=True) if own else ((), ())),
            linestyle="",
            marker=marker,
            markersize=5,
            markerfacecolor="white",
            color=style(rows[0]["engine"])["color"],
            label=f"measured, {knob} {value:.3g}{UNITS.get(knob, '')}",
        )
    if len(stick) < len(rows):
        sliding = min(row["slenderness"] for row in rows if row not in stick)
        axis.axvspan(
            sliding,
            max(row["slenderness"] for row in rows),
            color="0.9",
            label=f"slides: needs friction above {friction:g}",
        )
    axis.set(
        xlabel="slenderness γ [rad]",
        ylabel="mean error of restitution [-]",
        ylim=(-0.05, 0.0),
        title="Damping in flight",
    )


def equation_8(result: Result) -> Figure:
    """Base velocity jump against eq. (8), corrected and as printed, over slenderness and over the block's size."""
    figure = Figure(figsize=(WIDTH, 3.4), layout="constrained")
    left, right = figure.subplots(1, 2, sharey=True)
    for engine, variant in result.settings["default_variants"].items():
        knob = next(one for one in result.settings["knobs"] if (one["engine"], one["variant"]) == (engine, variant))
        cells = [
            row
            for row in select(result, "cell", engine=engine, variant=variant, value=knob["default"])
            if row["ratio"] is not None and row["jump_8"] is not None
        ]
        if not cells:
            continue
        gammas = sorted({row["slenderness"] for row in cells})
        sizes = select(result, "experiment", experiment="size", engine=engine)
        for key, dashes, filled, name in (
            ("jump_8", "-", True, "corrected"),
            ("jump_8_printed", "--", False, "as printed"),
        ):
            line = {**look(result, engine, variant), "linestyle": dashes, "label": f"{engine}, (8) {name}"}
            line["markerfacecolor"] = line["color"] if filled else "white"
            left.plot(
                gammas,
                [np.sqrt(np.mean([row[key] ** 2 for row in cells if row["slenderness"] == gamma])) for gamma in gammas],
                **line,
            )
            right.plot([row["value"] * result.settings["radius"] for row in sizes], [row[key] for row in sizes], **line)
    left.set(xlabel="slenderness γ [rad]", yscale="log", ylabel="jump over eq. (8), less 1, rms [-]")
    right.set(xlabel="size of the block R [m]", xscale="log")
    sizes = sorted(
        {row["value"] * result.settings["radius"] for row in select(result, "experiment", experiment="size")}
    )
    right.set_xticks(sizes, [f"{size:.2g}" for size in sizes])
    right.xaxis.set_minor_formatter(NullFormatter())
    for axis in (left, right):
        axis.grid(color="0.9")
        axis.set_axisbelow(True)
    figure.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncols=2, fontsize=8)
    return figure
