"""Figures of what needs no ground motion: Fig. 3, and the misprints."""

from __future__ import annotations

from typing import TYPE_CHECKING

from matplotlib.ticker import ScalarFormatter

from .canvas import BLACK, BLUE, RED, Drawing, axes_of
from .paper import X_MAX

if TYPE_CHECKING:
    from ...running.provenance import Result


def loops(result: Result) -> Drawing:
    """Fig. 3: force of one bearing over displacement."""
    figure, axis = axes_of(height=3.6)
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
    figure, axes = axes_of(1, 2, sharey=False)
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
    figure, axis = axes_of()
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
    figure, (left, right) = axes_of(1, 2)
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
