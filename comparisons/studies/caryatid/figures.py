"""The study's figures, each drawn from a result file alone. Colours of Okabe and Ito; every axis carries its unit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import ScalarFormatter

from ...showing.plots import marker, style
from .paper import X_MAX
from .runs import FREE, ISOLATED
from .variations import CATEGORIES, FRICTION_LIMITS, ONLY_FREE, ONLY_ISOLATED

if TYPE_CHECKING:
    from ...running.provenance import Result

WIDTH = 5.6  # in
BLACK, ORANGE, SKY, GREEN, BLUE, RED, PURPLE = (
    "#000000",
    "#E69F00",
    "#56B4E9",
    "#009E73",
    "#0072B2",
    "#D55E00",
    "#CC79A7",
)
DAMPING_STYLES = ((BLACK, "-"), (ORANGE, "--"), (SKY, "-."), (GREEN, (0, (5, 1))), (RED, ":"))
CATEGORY_COLOURS = ("#FFFFFF", SKY, RED, "#999999")


@dataclass(frozen=True)
class Drawing:
    """A matplotlib figure, what it shows for those who cannot see it, and what to look at."""

    figure: Figure
    alt: str
    caption: str


def drawings(result: Result) -> dict[str, Drawing]:
    """Name -> `Drawing` of all figures of a result file."""
    makers = {
        "paper": {"fig3": loops, "eq8": momentum, "eq12": reversal, "definitions": definitions},
        "motion": {
            "fig5a": rocking,
            "fig5b": displacement,
            "slenderness": vulnerable,
            "benefit": benefit,
            "seeds": seeds,
            "contact": contact,
        },
        "histories": {"fig4": free_standing, "fig6": isolated},
    }[result.settings["part"]]
    return {name: maker(result) for name, maker in makers.items()}


def figures(result: Result) -> dict[str, Figure]:
    """Name -> matplotlib figure of all figures of a result file."""
    return {name: drawing.figure for name, drawing in drawings(result).items()}


def _axes(rows=1, columns=1, height=3.2, **kind):
    figure = Figure(figsize=(WIDTH, height), layout="constrained")
    return figure, figure.subplots(rows, columns, **kind)


def loops(result: Result) -> Drawing:
    """Fig. 3: force of one bearing over displacement."""
    figure, axis = _axes(height=3.6)
    arrays = result.arrays
    for s, slope, f0 in arrays["loops/limits"]:
        axis.axline(
            (0, s * f0 / 1e3),
            slope=abs(slope) / 0.34 / 1e3,
            color="0.6",
            linewidth=0.9,
            linestyle="--",
            label="limit curves k_b x ± f₀" if s > 0 else None,
        )
    axis.plot(arrays["loops/x"], arrays["loops/force"] / 1e3, color=BLUE, linewidth=1.3, label="algebraic law")
    axis.plot(
        *(arrays["loops/reversals"].T * [[1], [1e-3]]),
        linestyle="",
        marker="o",
        color=RED,
        markersize=5,
        label="reversal points",
    )
    axis.set(xlabel="displacement x [m]", ylabel="force of one bearing [kN]")
    axis.legend(fontsize=9)
    return Drawing(
        figure,
        "Hysteresis loops of growing amplitude between two parallel limit curves, reversal points marked.",
        "Fig. 3 of the paper: the bearing law between its limit curves; the history is fixed at the reversal points.",
    )


def momentum(result: Result) -> Drawing:
    """Eq. (8): momentum after an impact over that before."""
    figure, axes = _axes(1, 2, sharey=False)
    for axis, by, label in ((axes[0], "slenderness", "slenderness γ [rad]"), (axes[1], "radius", "radius R [m]")):
        for form, colour, line in (("printed", RED, "--"), ("right", BLUE, "-")):
            axis.plot(
                result.arrays[f"impact/{by}"],
                result.arrays[f"impact/{form} by {by}"],
                line,
                color=colour,
                label="(8) as printed" if form == "printed" else "(8) corrected",
            )
        axis.set_xlabel(label)
    axes[0].set_ylabel("momentum after / before [-]")
    axes[1].set(xscale="log")
    axes[1].xaxis.set_major_formatter(ScalarFormatter())
    axes[0].legend(fontsize=9)
    return Drawing(
        figure,
        "Momentum ratio at 1 for the corrected equation (8); with the printed one it strays with "
        "slenderness and runs away with the radius.",
        "Horizontal momentum after an impact over that before, R = 1.0884 m (left) and γ = 0.28 rad "
        "(right). The printed form is right only where R cos γ happens to be 1 m.",
    )


def reversal(result: Result) -> Drawing:
    """Eq. (12): the force at a reversal."""
    figure, axis = _axes()
    arrays = result.arrays
    axis.plot(arrays["reversal/loading"][0], arrays["reversal/loading"][1] / 1e3, color="0.5", label="loading, eq. (9)")
    axis.plot(arrays["reversal/x"], arrays["reversal/right"] / 1e3, color=BLUE, label="unloading, (12) corrected")
    axis.plot(
        arrays["reversal/x"], arrays["reversal/printed"] / 1e3, "--", color=RED, label="unloading, (12) as printed"
    )
    top, bottom = arrays["reversal/right"][0] / 1e3, arrays["reversal/printed"][0] / 1e3
    axis.annotate(
        "",
        (arrays["reversal/x"][0], bottom),
        (arrays["reversal/x"][0], top),
        arrowprops={"arrowstyle": "<->", "color": BLACK},
    )
    axis.text(arrays["reversal/x"][0] + 0.01, 0.5 * (top + bottom), f"{top - bottom:.2f} kN = 2 f₀")
    axis.set(xlim=(-0.21, 0.34), xlabel="displacement x [m]", ylabel="force of one bearing [kN]")
    axis.legend(fontsize=9, loc="upper left")
    return Drawing(
        figure,
        "Unloading from 0.2 m: the corrected branch starts where loading ended, the printed one 1.28 kN below.",
        "With the sign printed in eq. (12) the force jumps by 2 f₀ at a reversal; corrected it is continuous.",
    )


def definitions(result: Result) -> Drawing:
    """Secant period and both dampings over the amplitude."""
    figure, (left, right) = _axes(1, 2)
    arrays = result.arrays
    left.plot(arrays["amplitude/x"], arrays["amplitude/period"], color=BLUE)
    left.plot(X_MAX, 2.0, "o", color=RED)
    left.annotate("Table 1(a)", (X_MAX, 2.0), (-22, -22), textcoords="offset points", fontsize=9)
    left.set(xlabel="amplitude [m]", ylabel="secant period [s]")
    for name, colour, line in (("2 pi", RED, "--"), ("4 pi", BLUE, "-")):
        right.plot(
            arrays["amplitude/x"],
            100 * arrays[f"amplitude/damping {name}"],
            line,
            color=colour,
            label=f"W_D/({name.replace('pi', 'π')} E_s)",
        )
    right.plot(X_MAX, 30.0, "o", color=RED)
    right.annotate("Table 1(a)", (X_MAX, 30.0), (-18, 14), textcoords="offset points", fontsize=9)
    right.set(xlabel="amplitude [m]", ylabel="damping [% of critical]", ylim=(0, None))
    right.legend(fontsize=9)
    return Drawing(
        figure,
        "Secant period rising and damping falling with amplitude; the usual definition gives half.",
        "T_bi = 2 s is the secant period at 0.30 m, and 30 % is twice the usual equivalent damping there.",
    )


def rocking(result: Result) -> Drawing:
    """Fig. 5(a): rocking spectrum."""
    figure, axis = _axes()
    arrays, gamma = result.arrays, result.settings["slenderness"]
    period, overturns = arrays["rocking/period"], arrays["rocking/overturns"]
    low, high = 0.0, 1.6
    axis.fill_between(period, low, high, where=overturns, color="0.85", step="mid", label="overturns, analytic")
    axis.plot(period, arrays["rocking/tilt"], color=BLACK, linewidth=1.3, label="analytic")
    _points(
        axis,
        [row for row in result.rows if row["part"] == "rocking spectrum"],
        lambda row: 1.53 if row["outcome"] == "overturns" else row["peak_tilt_ratio"],
    )
    axis.set(xlabel="rocking period T_r [s]", ylabel="max |φ| / γ [-]", ylim=(low, high), xlim=(period[0], period[-1]))
    axis.legend(fontsize=9, loc="upper right")
    return Drawing(
        figure,
        "Peak tilt over rocking period; overturning, shaded, up to a largest period.",
        f"Fig. 5(a), γ = {gamma:g} rad, {result.settings['motion']['label']}: shaded where the block "
        "overturns; marks at the top edge: the engine overturns.",
    )


def _points(axis, rows, value):
    for solver in dict.fromkeys(row["solver"] for row in rows if row["solver"] != "analytic"):
        chosen = [row for row in rows if row["solver"] == solver and row["outcome"] != "failed"]
        if chosen:
            axis.plot(
                [row["period"] for row in chosen],
                [value(row) for row in chosen],
                linestyle="",
                marker=marker(solver),
                color=style(solver)["color"],
                markerfacecolor="none",
                markersize=8 if marker(solver) == "s" else 6,
                markeredgewidth=1.5,
                label=solver,
            )


def displacement(result: Result) -> Drawing:
    """Fig. 5(b): displacement spectra."""
    figure, axis = _axes(height=3.6)
    arrays = result.arrays
    for ratio, peak, (colour, line) in zip(
        arrays["displacement/damping"], arrays["displacement/peak"], DAMPING_STYLES, strict=True
    ):
        axis.plot(arrays["displacement/period"], peak, color=colour, linestyle=line, label=f"ξ = {100 * ratio:.0f} %")
    _points(
        axis,
        [row for row in result.rows if row["part"] == "displacement spectrum" and row["outcome"] == "stands"],
        lambda row: row["peak_base_displacement"],
    )
    nonlinear = next(row for row in result.rows if row["part"] == "equivalent")
    axis.plot(
        nonlinear["period"], nonlinear["nonlinear"], "*", color=PURPLE, markersize=13, label="bearings, T_bi at x_max"
    )
    axis.set(xlabel="period T_bi [s]", ylabel="max |x| [m]", xlim=(0, 5), ylim=(0, None))
    axis.legend(fontsize=8, ncols=2)
    return Drawing(
        figure,
        "Displacement spectra for five damping ratios; engine points lie on the curves.",
        f"Fig. 5(b), {result.settings['motion']['label']}: linear oscillators, exact for the sampled "
        "motion; marks: the same oscillators in the engines, 5 and 30 %. Star: the hysteretic bearings.",
    )


def vulnerable(result: Result) -> Drawing:
    """Vulnerable period over slenderness, and the interval that fits all claims."""
    figure, axis = _axes()
    axis.plot(
        result.arrays["claims/slenderness"],
        result.arrays["claims/vulnerable period"],
        color=BLACK,
        marker=".",
        linewidth=1,
    )
    axis.axhspan(3.5, 4.5, color=SKY, alpha=0.4, label="about 4 s: ± 0.5 s")
    for k, (low, high) in enumerate(next(row for row in result.rows if row.get("claim") == "all three")["intervals"]):
        axis.axvspan(low, high, color=GREEN, alpha=0.35, label=None if k else "fits all three claims")
    axis.axvline(result.settings["slenderness"], color=RED, linestyle="--", label="chosen")
    axis.set(xlabel="slenderness γ [rad]", ylabel="largest T_r that overturns [s]")
    axis.legend(fontsize=9)
    return Drawing(
        figure,
        "Largest rocking period that overturns, falling with slenderness, with the interval that "
        "fits the paper's claims.",
        f"Which slenderness the paper can have meant, {result.settings['motion']['label']}.",
    )


def benefit(result: Result) -> Drawing:
    """Who stays upright, over slenderness and intensity."""
    figure, axis = _axes(height=4.2)
    arrays = result.arrays
    gamma, intensity = arrays["benefit/slenderness"], arrays["benefit/intensity"]
    axis.pcolormesh(
        gamma,
        intensity,
        arrays["benefit/category"].T,
        cmap=ListedColormap(CATEGORY_COLOURS),
        norm=BoundaryNorm(np.arange(-0.5, 4), 4),
        rasterized=True,
    )
    axis.contour(
        gamma, intensity, arrays["benefit/isolated displacement"].T, levels=[X_MAX], colors=BLACK, linestyles="--"
    )
    axis.contour(gamma, intensity, arrays["benefit/isolated lifts"].T.astype(float), levels=[0.5], colors=BLUE)
    axis.plot(result.settings["slenderness"], 1.0, "*", color=PURPLE, markersize=14)
    handles = [
        Patch(facecolor=colour, edgecolor="0.4", label=text)
        for colour, text in zip(CATEGORY_COLOURS, CATEGORIES, strict=True)
    ]
    handles += axis.plot([], [], "--", color=BLACK, label="isolated: 0.30 m reached")
    handles += axis.plot([], [], "-", color=BLUE, label="isolated: lifts above")
    handles += axis.plot([], [], "*", color=PURPLE, linestyle="", markersize=10, label="the Caryatid")
    axis.set(xlabel="slenderness γ [rad]", ylabel="intensity: motion times [-]")
    figure.legend(handles=handles, loc="outside lower center", ncols=2, fontsize=8)
    return Drawing(
        figure,
        "Map of who stays upright: " + "; ".join(CATEGORIES) + ".",
        f"Does isolation help? {result.settings['motion']['label']}. Above the dashed line the bearings "
        "would need more than their 0.30 m: what the law says there is no design.",
    )


def seeds(result: Result) -> Drawing:
    """Share of the synthetic motions in which isolation helps, and in which it harms."""
    figure, axes = _axes(1, 2, height=3.4, sharey=True)
    arrays = result.arrays
    total = arrays["seeds/counts"].sum(axis=0).max()
    for axis, kind, title in ((axes[0], ONLY_ISOLATED, "isolation helps"), (axes[1], ONLY_FREE, "isolation harms")):
        mesh = axis.pcolormesh(
            arrays["seeds/slenderness"],
            arrays["seeds/intensity"],
            100.0 * arrays["seeds/counts"][kind].T / total,
            cmap="cividis",
            vmin=0,
            vmax=100,
            rasterized=True,
        )
        axis.set(title=title, xlabel="slenderness γ [rad]")
    axes[0].set_ylabel("intensity: motion times [-]")
    figure.colorbar(mesh, ax=axes, label="synthetic motions [%]")
    return Drawing(
        figure,
        "Two maps: share of synthetic motions in which only the isolated block stays upright, and "
        "in which only the free-standing one does.",
        f"{total} synthetic motions: where only the isolated block stays upright (left), and where only "
        "the free-standing one does (right).",
    )


def contact(result: Result) -> Drawing:
    """Friction demand and least normal force."""
    figure, axes = _axes(2, 2, height=5.4, sharex=True, sharey=True)
    arrays = result.arrays
    gamma, intensity = arrays["contact/slenderness"], arrays["contact/intensity"]
    bounds = (0, 0.1, 0.2, *FRICTION_LIMITS, 1.0)
    for column, name in enumerate((FREE, ISOLATED)):
        friction = np.minimum(arrays[f"contact/{name} friction"], 1e3)
        top = axes[0, column].pcolormesh(
            gamma, intensity, friction.T, cmap="cividis", rasterized=True, norm=BoundaryNorm(bounds, 256, extend="max")
        )
        low = axes[1, column].pcolormesh(
            gamma,
            intensity,
            np.maximum(arrays[f"contact/{name} normal"], -1.0).T,
            cmap="cividis",
            vmin=0,
            vmax=1,
            rasterized=True,
        )
        upright = arrays[f"contact/{name} upright"].T.astype(float)
        for axis in axes[:, column]:
            if 0 < upright.mean() < 1:
                axis.contour(gamma, intensity, upright, levels=[0.5], colors="white", linewidths=1.2)
        axes[0, column].set_title(name)
        axes[1, column].set_xlabel("slenderness γ [rad]")
    for row in (0, 1):
        axes[row, 0].set_ylabel("intensity [-]")
    figure.colorbar(top, ax=axes[0, :], label="friction demand |H|/N [-]")
    figure.colorbar(low, ax=axes[1, :], label="least N/(m g) [-]", extend="min")
    return Drawing(
        figure,
        "Maps of friction demand and least normal force, free-standing and isolated.",
        "What 'no sliding, no jump' asks for; overturning runs up to their unstable point. White line: "
        "beyond it the block overturns.",
    )


def free_standing(result: Result) -> Drawing:
    """Fig. 4: the motion, and the free-standing Caryatid."""
    figure, (above, below) = _axes(2, 1, height=4.4, sharex=True)
    _ground(above, result)
    for row in result.rows:
        key = f"{FREE}/{row['solver']}/"
        if row["scene"] == FREE and key + "time" in result.arrays:
            below.plot(
                result.arrays[key + "time"],
                result.arrays[key + "tilt"] / result.settings["slenderness"],
                label=row["solver"],
                **style(row["solver"]),
            )
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
    figure, (above, below) = _axes(2, 1, height=4.4, sharex=True)
    for row in result.rows:
        key = f"{ISOLATED}/{row['solver']}/"
        if row["scene"] == ISOLATED and key + "time" in result.arrays:
            above.plot(
                result.arrays[key + "time"],
                result.arrays[key + "tilt"] / result.settings["slenderness"],
                label=row["solver"],
                **style(row["solver"]),
            )
            below.plot(result.arrays[key + "time"], result.arrays[key + "base_displacement"], **style(row["solver"]))
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


def _ground(axis, result):
    axis.plot(result.arrays["motion/time"], result.arrays["motion/acceleration"] / 9.81, color="0.35", linewidth=0.8)
    axis.axvline(result.settings["motion"]["peak_time"], color="0.7", linestyle=":", linewidth=0.8)
    axis.set_ylabel("ground acceleration [g]")
