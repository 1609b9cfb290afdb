"""Curves of the paper: its misprints beside their corrections, and its bearings."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ...showing.charts import Axis, Chart, figure
from ...showing.parts import Figure, number
from . import runs as paper

PRINTED, CORRECT, LIMIT = "var(--ghost)", "var(--accent)", "var(--soft)"  # colours of curves
GAMMA = "slenderness γ [rad]"


def curves(title: str, x: Axis, y: Axis, named: Mapping[str, tuple], right: int = 106) -> Chart:
    """A `Chart` of {name: (colour, xs, ys)}, each named where it ends; a name in parentheses is not written."""
    chart = Chart(x, y, f"{title}: {y.label} over {x.label}; {', '.join(named)}.", right=right, title=title)
    for name, (tone, xs, ys) in named.items():
        chart.line(xs, ys, tone=tone)
        if not name.startswith("("):
            chart.label(ys[-1], name, tone=tone)
    return chart


def misprints(arrays: Mapping[str, Any]) -> Figure:
    """Eqs (8) and (12), as printed and corrected."""
    forms = (("as printed", PRINTED, "printed"), ("corrected", CORRECT, "right"))
    charts = [
        curves(
            title,
            x,
            Axis("momentum after / before [-]", *ends),
            {name: (tone, arrays[f"impact/{by}"], arrays[f"impact/{form} by {by}"]) for name, tone, form in forms},
        )
        for title, by, x, ends in (
            ("Eq. (8), R = 1.0884 m", "slenderness", Axis(GAMMA, 0.1, 0.45), (0.985, 1.02)),
            ("Eq. (8), γ = 0.28 rad", "radius", Axis("radius R [m]", 0.1, 10.0, "log"), (0.5, 4.0)),
        )
    ]
    unloading = {
        name: (tone, arrays["reversal/x"][::-1], arrays[f"reversal/{form}"][::-1] / 1e3) for name, tone, form in forms
    }
    x, loading = arrays["reversal/loading"]
    jump = arrays["reversal/right"][0] - arrays["reversal/printed"][0]
    force_curves = {"loading": (LIMIT, x, loading / 1e3), **unloading}
    displacement, force = Axis("displacement x [m]", -0.2, 0.2), Axis("force of one bearing [kN]", -2.5, 2.5)
    return figure(
        [*charts, curves("Eq. (12), unloading from 0.2 m", displacement, force, force_curves)],
        "Horizontal momentum after an impact over that before: eq. (8) as printed is right only where R cos γ happens "
        f"to be 1 m. With eq. (12) as printed the force jumps by {number(jump / 1e3)} kN = 2 f₀ at a reversal.",
    )


def bearings(arrays: Mapping[str, Any]) -> Figure:
    """Fig. 3, and the definitions of Table 1(a) over the amplitude."""
    ends, amplitude = np.array([-0.34, 0.34]), Axis("amplitude [m]", 0.0, 0.4)
    limits = {
        name: (LIMIT, ends, (abs(slope) * ends / 0.34 + s * f0) / 1e3)
        for name, (s, slope, f0) in zip(("(lower)", "limit curves"), arrays["loops/limits"], strict=True)
    }
    loops = curves(
        "Fig. 3",
        Axis("displacement x [m]", -0.34, 0.34),
        Axis("force of one bearing [kN]", -3.0, 3.0),
        {**limits, "algebraic law": (CORRECT, arrays["loops/x"], arrays["loops/force"] / 1e3)},
    )
    loops.dots(*(arrays["loops/reversals"].T / [[1.0], [1e3]]), tone=PRINTED)
    period, ours, usual = (arrays[f"amplitude/{name}"] for name in ("period", "damping 2 pi", "damping 4 pi"))
    at, energy = arrays["amplitude/x"], {"loss/(2π energy)": (PRINTED, ours), "loss/(4π energy)": (CORRECT, usual)}
    dampings = {name: (tone, at, 100 * share) for name, (tone, share) in energy.items()}
    periods = curves("Period", amplitude, Axis("secant period [s]", 0.0, 2.5), {"(one)": (CORRECT, at, period)}, 14)
    damping = curves("Damping", amplitude, Axis("damping [% of critical]", 0.0, 60.0), dampings, 132)
    for chart, value in ((periods, paper.PERIOD), (damping, 100 * paper.DAMPING)):
        chart.dots([paper.X_MAX], [value], says=[f"Table 1(a): {value:g}"], tone="var(--bad)")
    return figure(
        [loops, periods, damping],
        "The bearing law between its limit curves; its history is fixed at the reversal points, dots. Dots on period "
        "and damping: Table 1(a), the secant period at 0.30 m, and loss of a cycle over 2π times the elastic energy.",
    )
