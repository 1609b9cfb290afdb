"""The pages of the study of the Caryatid paper, one for each of its three results.

Curves of the paper: its misprints beside their corrections, and its bearings.
"""

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from engines import missing_words

from ...execution.results import Result
from ...plotting.charts import Axis, Chart, figure
from ...plotting.figures import Series, lines, regions
from ...plotting.parts import Figure, Head, Page, grouped, table, where
from ...schemas.columns import Column, number, percent
from . import paper
from .study import CATEGORIES, COLUMNS, FREE, ISOLATED, WITHIN

PRINTED, CORRECT, LIMIT = "var(--ghost)", "var(--accent)", "var(--soft)"  # colours of curves
GAMMA = "slenderness γ [rad]"


def curves(title: str, x: Axis, y: Axis, named: Mapping[str, tuple], right: int = 106) -> Chart:
    """Return a `Chart` of {name: (colour, xs, ys)}, each curve named where it ends.

    A name in parentheses is not written.
    """
    chart = Chart(x, y, f"{title}: {y.label} over {x.label}; {', '.join(named)}.", right=right, title=title)
    for name, (tone, xs, ys) in named.items():
        chart.line(xs, ys, tone=tone)
        if not name.startswith("("):
            chart.label(ys[-1], name, tone=tone)
    return chart


def misprints(arrays: Mapping[str, Any]) -> Figure:
    """Figure of eqs (8) and (12), as printed and corrected."""
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
    """Figure of Fig. 3, and of the definitions of Table 1(a) over the amplitude."""
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
        "Left: the bearing law between its limit curves. Its history is fixed at the reversal points (dots). Middle "
        "and right: the dots are the values of Table 1(a), which are the secant period at 0.30 m, and the loss of a "
        "cycle over 2π times the elastic energy.",
    )


# colours of Fig. 5(b), least damping first
DAMPINGS = ("var(--ink)", "var(--accent)", "var(--good)", "var(--fair)", "var(--bad)")
FLOOR = 1e-9  # smaller differences are drawn here
KEPT = 5  # one of so many samples of a smooth history is drawn
# {which block stays upright: its style class}
HARMS = dict(zip(CATEGORIES, ("", "right", "wrong", "falls"), strict=True))

NUMBER = Column("number of the paper", "{where}: {quantity}")
PAPER = COLUMNS["paper"]
STATUS = Column("status", lambda row: ": ".join(filter(None, (row["status"], row.get("note")))))
SCENE = Column("scene", lambda row: _scene(row))
RUN = (
    SCENE,
    COLUMNS["engine"],
    Column("outcome", lambda row: f"failed: {row['failure']['reason']}" if row["failure"] else row["outcome"]),
    *map(
        COLUMNS.__getitem__,
        (
            "overturning_time",
            "peak_tilt_ratio",
            "peak_base_displacement",
            "friction_demand",
            "min_normal_ratio",
            "cpu_seconds",
        ),
    ),
)
SHARES = (*CATEGORIES, WITHIN, "isolated lifts", "beyond x_max")


def page(result: Result) -> Page:
    """Return the page of a result."""
    return {"paper": _paper, "motion": _motion, "histories": _histories}[result.settings["part"]](result)


def _paper(result):
    """Page of the result ``caryatid-paper``: what needs no motion."""
    rows = where(result.rows, part="equation")
    reproduced, corrected = (len(where(rows, status=status)) for status in (paper.REPRODUCED, paper.CORRECTED))
    return Page(
        f"The Caryatid paper: {reproduced} of {len(rows)} equations, figures and tables are reproduced, {corrected} "
        "corrected",
        (
            "Eq. (8) as printed breaks the conservation of momentum. Eq. (12) as printed makes the bearing force jump. "
            "The damping of 30 % is twice the usual equivalent damping. The period of 2 s is the secant period at "
            "0.30 m.",
            f"Not at hand, and so not compared: {paper.UNKNOWN}",
        ),
        more=(
            Head("What is printed, and what is found"),
            table(
                "Numbers",
                where(result.rows, part="value"),
                NUMBER,
                PAPER,
                COLUMNS["study"],
                COLUMNS["difference"],
                STATUS,
            ),
            table(
                "Equations, Fig. 3 and Table 1",
                rows,
                COLUMNS["number"],
                COLUMNS["what"],
                STATUS,
                COLUMNS["check"],
                COLUMNS["value"],
            ),
            Head("Misprints and definitions"),
            table(
                "What is printed, and what it should be",
                where(result.rows, part="misprint"),
                COLUMNS["where"],
                COLUMNS["printed"],
                COLUMNS["corrected"],
                COLUMNS["measure"],
                COLUMNS["value_corrected"],
                COLUMNS["value_printed"],
            ),
            misprints(result.arrays),
            Head("The bearings"),
            bearings(result.arrays),
        ),
    )


def _motion(result):
    """Page of the paper under one motion."""
    label, missing = result.settings["motion"]["label"], missing_words(result.settings["missing"])
    runs = where(result.rows, part={"run", "rocking spectrum", "displacement spectrum"})
    claims = where(result.rows, part="claim")
    together = _spans(claims[-1]["intervals"])
    shares = where(result.rows, part="benefit")
    others = shares[1:]
    mean = {key: sum(row[key] for row in others) / len(others) for key in SHARES}
    return Page(
        f"The Caryatid under {label}: {_outcomes(where(runs, part='run'))}",
        (
            "The paper prints no slenderness. It makes three claims: the free-standing statue overturns; it is "
            "vulnerable below a rocking period of about 4 s; the isolated statue does not rock. Under this motion all "
            f"three hold for these values of γ [rad]: {together}. This study uses {result.settings['slenderness']:g} "
            "rad.",
            *([f"Not installed, and so not compared: {'; '.join(missing)}"] if missing else ()),
        ),
        more=_motion_details(result, runs, claims, shares, others, mean),
        evidence=tuple(
            (f"{row['engine']}, {_scene(row)}: {row['failure']['reason']}", row["failure"].get("message", ""))
            for row in runs
            if row["failure"]
        ),
    )


def _motion_details(result, runs, claims, shares, others, mean):
    """Parts of the page of the paper under one motion."""
    return (
        Head("What is printed, and what is found"),
        table(
            "Figs 4 to 6",
            _beside(where(result.rows, part="value")),
            NUMBER,
            PAPER,
            COLUMNS["study"].called("analytic model"),
            Column("engines", "engines"),
            STATUS,
        ),
        _spectra(result),
        table(
            "A linear oscillator with the design period, by either definition of damping, compared with the bearings",
            where(result.rows, part="equivalent"),
            COLUMNS["definition"],
            COLUMNS["damping"],
            COLUMNS["displacement"],
            COLUMNS["nonlinear"],
        ),
        Head("Which slenderness?"),
        table(
            "Slendernesses that fit the paper's claims",
            claims,
            COLUMNS["claim"],
            Column("holds for γ [rad]", lambda row: _spans(row["intervals"])),
        ),
        _vulnerable(result),
        Head("Does isolation help other blocks, and under other motions?"),
        _benefit(result),
        table(
            "Shares of the area of the map over slenderness and intensity",
            [shares[0], {"motion": f"mean of {len(others)} synthetic motions", **mean}, *others],
            COLUMNS["motion"],
            *(
                Column(f"isolated upright {key}" if key == SHARES[-1] else key, key, digits=3, percent=True)
                for key in SHARES
            ),
        ),
        Head("All runs"),
        _agreement(runs),
        table("All runs", [row for same in grouped(runs, SCENE.of).values() for row in same], *RUN),
    )


def _scene(row):
    """Name of a row's scene."""
    return {
        "run": "{scene} Caryatid",
        "rocking spectrum": "Fig. 5(a), T_r = {period:.3f} s",
        "displacement spectrum": "Fig. 5(b), T_bi = {period:g} s, ξ = {share}",
    }[row["part"]].format_map({**row, "share": percent(row.get("damping"), 1)})


def _spans(intervals):
    """Intervals of slenderness, in words."""
    return ", ".join(f"{low:.4f} to {high:.4f}" for low, high in intervals) or "none"


def _outcomes(runs):
    """Words on how many solvers end each scene how."""
    return "; ".join(
        f"{scene}, it {end} in {len(where(same, outcome=end))} of {len(same)} solvers"
        for (scene,), same in grouped(runs, "scene").items()
        for (end,) in grouped(same, "outcome")
    )


def _beside(rows: Iterable[Mapping[str, Any]]) -> Iterator[dict[str, Any]]:
    """Yield a row for each number of the paper, with the model's.

    The column ``engines`` has what the engines give, from least to most.
    """
    for same in grouped(rows, "where", "quantity").values():
        of_model = where(same, engine={None, "analytic"}) or [{"study": None}]
        others = dict.fromkeys(row["study"] for row in same if row["engine"] not in (None, "analytic"))
        values = sorted(value for value in others if not isinstance(value, str))
        words = [value for value in others if isinstance(value, str)]
        words += [" to ".join(dict.fromkeys(number(value, 4) for value in (values[0], values[-1])))] if values else []
        status = ", ".join(dict.fromkeys(row["status"] for row in same))
        yield {**same[0], **of_model[0], "engines": "; ".join(words) or None, "status": status}


def _agreement(runs):
    """Figure of the differences of each engine's runs of Fig. 5 from the model's.

    They are differences of overturning times or of peaks.
    """
    rows = []
    for same in grouped((row for row in runs if row["part"] != "run" and not row["failure"]), SCENE.of).values():
        (model,) = where(same, engine="analytic") or [None]
        for row in same if model else ():
            peak = "peak_tilt_ratio" if row["part"] == "rocking spectrum" else "peak_base_displacement"
            key = "overturning_time" if row["outcome"] == "overturns" else peak
            apart = abs(row[key] / model[key] - 1) if row["outcome"] == model["outcome"] else 1.0
            panel = f"Fig. 5(b), ξ = {percent(row['damping'], 1)}" if "damping" in row else "Fig. 5(a)"
            rows.append({**row, "apart": apart, "panel": panel})
    return lines(
        [row for row in rows if row["engine"] != "analytic"],
        COLUMNS["period"],
        Column("relative difference [-]", lambda row: max(row["apart"], FLOOR)),
        "Relative difference of an engine from the analytic model: in the overturning time if the block overturns, "
        "otherwise in the peak. A value of 1 stands for another outcome.",
        panel="panel",
        series=Series(by=lambda row: ""),
        log="y",
    )


def _spectra(result):
    """Figure of Fig. 5 in the analytic model."""
    period, overturns = result.arrays["rocking/period"], result.arrays["rocking/overturns"]
    bearings, peaks = where(result.rows, part="equivalent")[0], result.arrays["displacement/peak"]
    tilt = Chart(
        Axis("rocking period [s]", float(period[0]), float(period[-1])),
        Axis("peak |φ|/γ [-]", 0.0, 1.6),
        "Peak tilt over the rocking period; shaded where the block overturns.",
        title=f"Fig. 5(a), γ = {result.settings['slenderness']:g} rad",
    )
    edges = np.concatenate([period[:1], (period[1:] + period[:-1]) / 2, period[-1:]])
    tilt.area(list(np.repeat(edges, 2)), [0.0, *np.repeat(np.where(overturns, 1.6, 0.0), 2), 0.0], "falls")
    tilt.line(period, result.arrays["rocking/tilt"])
    sway = curves(
        "Fig. 5(b)",
        Axis("period [s]", 0.0, 5.0),
        Axis("peak displacement [m]", 0.0, 1.05 * float(peaks.max())),
        {
            f"{100 * ratio:.0f} % damping": (tone, result.arrays["displacement/period"], peak)
            for tone, ratio, peak in zip(DAMPINGS, result.arrays["displacement/damping"], peaks, strict=True)
        },
        122,
    )
    says = [f"the bearings, at their period: {number(bearings['nonlinear'])} m"]
    sway.dots([bearings["period"]], [bearings["nonlinear"]], says=says, mark="X", tone="var(--bad)")
    return figure(
        [tilt, sway],
        "The analytic model. Shaded: the block overturns. Right: linear oscillators, solved exactly for the sampled "
        "motion; the cross is the peak of the hysteretic bearings, drawn at their secant period.",
    )


def _vulnerable(result):
    """Figure of the longest rocking period that overturns, over the slenderness."""
    about = paper.VULNERABLE_PERIOD - paper.VULNERABLE_ABOUT, paper.VULNERABLE_PERIOD + paper.VULNERABLE_ABOUT
    values = zip(result.arrays["claims/slenderness"], result.arrays["claims/vulnerable period"], strict=True)
    return lines(
        [{"engine": "analytic", "at": float(x), "period": float(y)} for x, y in values],
        Column(GAMMA, "at", digits=3),
        COLUMNS["period"].called("longest period that overturns"),
        "Longest rocking period of a block that overturns. In the paper, blocks are vulnerable below about 4 s. By the "
        "acceleration of the base alone, atan(max|a|/g), a block on the bearings does not lift from a slenderness of "
        f"{result.settings['uplift_slenderness']:.4f} rad on.",
        series=Series(by=lambda row: ""),
        rules=[("x", result.settings["slenderness"], "used here"), *(("y", at, f"{at:g} s") for at in about)],
    )


def _benefit(result):
    """Map of which of the two blocks stays upright, over slenderness and intensity."""
    gamma, intensity = (result.arrays[f"benefit/{name}"].astype(float) for name in ("slenderness", "intensity"))
    panels = {"": result.arrays["benefit/category"]}
    (chart,), keys = regions(GAMMA, "intensity: motion times [-]", gamma, intensity, panels, HARMS, right=76)
    beyond = ~(result.arrays["benefit/isolated displacement"] <= paper.X_MAX)
    lifts = result.arrays["benefit/isolated lifts"]
    for reached, name, tone in ((beyond, "0.30 m", "var(--bad)"), (lifts, "lifts", "var(--ink)")):
        first = np.where(reached.any(axis=1), intensity[reached.argmax(axis=1)], np.nan)
        chart.line(gamma, first, tone=tone)
        chart.label(float(np.nan_to_num(first[-1], nan=intensity[-1])), name, tone=tone)
    chart.dots([result.settings["slenderness"]], [1.0], says=["the Caryatid"], mark="D", tone="var(--ink)")
    return figure(
        [chart],
        "Diamond: the Caryatid. Above one line the isolated block lifts; above the other its bearings move by more "
        "than their 0.30 m, where the law describes no built bearing.",
        keys,
        keys,
    )


def _histories(result):
    """Page of the histories under one motion."""
    arrays, motion, x_max = result.arrays, result.settings["motion"], result.settings["x_max"]
    ended = [row for row in result.rows if not row["failure"]]
    longest = {name: max(row["end"]["time"] for row in where(ended, scene=name)) for name in (FREE, ISOLATED)}
    time, acceleration = arrays["motion/time"], arrays["motion/acceleration"] / 9.81
    peak, most = float(abs(acceleration).max()), max(row["peak_tilt_ratio"] for row in where(ended, scene=ISOLATED))
    charts = []
    for title, label, high, level, end in (
        ("Fig. 4(a)", "ground acceleration [g]", 1.1 * peak, None, 1.5 * longest[FREE]),
        ("Fig. 4(b), free-standing", "tilt φ/γ [-]", 2.5, 1.0, 1.5 * longest[FREE]),
        ("Fig. 6, isolated", "displacement x [m]", 1.1 * x_max, x_max, longest[ISOLATED]),
    ):
        says = f"{title}: {label} over time, all solvers over each other."
        charts.append(Chart(Axis("time [s]", 0.0, end), Axis(label, -high, high), says, title=title))
        for at in (-level, level) if level else ():
            charts[-1].rule(at, "y")
    charts[0].line(time[time < charts[0].x.high], acceleration[time < charts[0].x.high])
    charts[0].rule(motion["peak_time"])
    for row in ended:
        at, tilt, x = (
            arrays[f"{row['scene']}/{row['engine']}/{name}"] for name in ("time", "tilt", "base_displacement")
        )
        if row["scene"] == FREE:
            charts[1].line(at, tilt / result.settings["slenderness"], row["engine"])
        else:
            charts[2].line(at[::KEPT], x[::KEPT], row["engine"])
    solvers = dict.fromkeys(row["engine"] for row in ended)
    caption = (
        "All solvers overlaid. Dashed lines: time of the peak of the motion; |φ| = γ; the design displacement. Largest "
        f"tilt of the isolated Caryatid: {number(most, 2)} slendernesses."
    )
    title = f"The Caryatid over time under {motion['label']}: {_outcomes(result.rows)}"
    return Page(title, (), more=(figure(charts, caption, solvers),))
