"""Figures over a period: the spectra of Fig. 5, and which slenderness they fit."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...showing.plots import marker, style
from .canvas import BLACK, GREEN, ORANGE, PURPLE, RED, SKY, Drawing, axes_of

if TYPE_CHECKING:
    from ...running.provenance import Result

DAMPING_STYLES = ((BLACK, "-"), (ORANGE, "--"), (SKY, "-."), (GREEN, (0, (5, 1))), (RED, ":"))


def rocking(result: Result) -> Drawing:
    """Fig. 5(a): rocking spectrum."""
    figure, axis = axes_of()
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
    figure, axis = axes_of(height=3.6)
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
    figure, axis = axes_of()
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
