"""The page of the fragility study: runs under synthetic motions that differ, and fragility curves."""

from typing import Any

import numpy as np
from scipy.stats import norm

from engines.comparison import FALL

from ...execution.results import Result
from ...plotting.charts import Axis, Chart, figure
from ...plotting.figures import leading, ranks
from ...plotting.glance import Glance, counted
from ...plotting.parts import Head, Judgement, Page, grouped, table, where
from ...plotting.wording import ends, ends_in_words, equal_mark, least_shown, left_out, tally
from ...schemas.columns import NAME, Column, number, percent, short
from .study import COLUMNS

LEVEL = 0.05  # level of the test between an engine and the model, and least p of a curve that is shown
OVERTURNING = "overturning"
UNITS = {"PGV": "m/s"}
TONES = ("var(--faint)", "var(--soft)", "var(--accent)", "var(--ink)", "var(--ghost)")
MARKS = ("o", "s", "^", "o", "D")  # marks of the limit states; that of overturning is drawn small, to lie on others
TICKS = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0)
OUTCOMES = ("both_stand", "both_overturn", "only_a", "only_b")
RATIOS = (0.5, 0.7, 1.0, 1.4, 2.0)  # ratios of medians that are ticks

SCENE, STATE = (COLUMNS["scene"], Column("limit state", lambda row: row["state"].replace("displacement", "displ.")))
MEASURE = Column(
    "intensity measure", lambda row: f"{row['measure'].replace('_r', 'ᵣ')} [{UNITS.get(row['measure'], '-')}]"
)
MEDIAN_SHIFT = COLUMNS["median_shift"]
COMPARED = Column("runs compared [-]", lambda row: sum(row[key] for key in OUTCOMES))
EFFECT = (
    COMPARED,
    COLUMNS["left_out"],
    Column("exceeded: model alone, engine alone [-]", "{only_a}, {only_b}"),
    COLUMNS["p_holm"],
    MEDIAN_SHIFT,
    COLUMNS["dispersion_shift"],
    COLUMNS["detectable_shift"],
    COLUMNS["detectable_difference"],
)


def page(result: Result) -> Page:
    """Return the page of a result."""
    fits, effects = where(result.rows, part="fit"), where(result.rows, part="effect")
    costs = {(row["scene"], NAME.of(row)): row["cpu_per_run"] for row in where(result.rows, part="cost")}
    tones = dict(zip(dict.fromkeys(row["state"] for row in fits), TONES, strict=False))
    counts = tallies(result)
    return Page(
        f"Many earthquakes: {ends_in_words(leading(counts, result.settings['variants']))}",
        (
            "Rocking cannot be predicted point by point over a whole motion, but probabilities can. Engines are "
            "compared with the analytic model run by run. A run differs if its outcome is another, or if the block "
            f"falls at another time: more than {percent(FALL, 1)} of a rocking period off, or after another number of "
            f"impacts. A failed run counts as differing. Even if no run differs, {least_shown(counts, 'motions')} "
            "(upper 95 % limit).",
        ),
        first=(_ends(counts),),
        more=_details(result, fits, effects, costs, tones),
        how=_how(result.settings),
        evidence=tuple(
            (f"{NAME.of(row)}, {row['scene']}, seed {row['seed']}", f"{row['reason']}\n{row.get('message') or ''}")
            for row in where(result.rows, part="failure")
        ),
    )


def _ends(counts):
    """Table of how runs end; the first screen draws it."""
    return table(
        "How runs end compared with the analytic model’s, all scenes together, with 95 % Wilson intervals by motion",
        counts,
        NAME,
        COLUMNS["runs"],
        Column("that differ or fail [-]", "differing"),
        *ends(counts),
        Column("share that differs or fails", "share", percent=True, within="interval"),
    )


def _details(result, fits, effects, costs, tones):
    """Parts that only the study's own page shows."""
    return (
        table(
            "Overturning: engines compared with the analytic model on the same runs, with 95 % intervals by paired "
            "bootstrap",
            where(effects, state=OVERTURNING),
            NAME,
            SCENE,
            *EFFECT,
            Column("CPU time per run [s]", lambda row: costs[row["scene"], NAME.of(row)]),
        ),
        Head("All limit states"),
        ranks(
            effects,
            NAME,
            MEDIAN_SHIFT,
            "Median intensity over the analytic model's on the same runs, with 95 % intervals by paired bootstrap. "
            "There is no interval where no outcome differs, or where the runs do not determine one.",
            Axis(MEDIAN_SHIFT.head, RATIOS[0], RATIOS[-1], "log", tuple((ratio, short(ratio)) for ratio in RATIOS)),
            panel=lambda row: f"{row['scene']}: {STATE.of(row)}",
        ),
        table(
            "Other limit states: engines compared with the analytic model on the same runs",
            [row for row in effects if row["state"] != OVERTURNING],
            NAME,
            SCENE,
            STATE,
            *EFFECT,
        ),
        Head("The analytic model"),
        _shares(fits, tones),
        table(
            "Lognormal curves of the analytic model, with 95 % intervals by bootstrap over runs",
            fits,
            SCENE,
            STATE,
            MEASURE,
            Column("exceeded [-]", "{exceeded} of {size}"),
            COLUMNS["median"],
            COLUMNS["dispersion"],
            COLUMNS["p_value"],
            Column("fits", lambda row: "no curve" if row["median"] is None else "yes" if _fits(row) else "no"),
        ),
        table(
            "Runs of the analytic model",
            where(result.rows, part="check"),
            SCENE,
            COLUMNS["runs"].called("runs"),
            COLUMNS["undecided"],
            COLUMNS["failed"],
        ),
    )


def tallies(result: Result) -> list[dict[str, Any]]:
    """Return a row for each variant: the `tally` of its runs of all scenes; runs under one motion count as one."""
    tiers = {NAME.of(variant): variant["tier"] for variant in result.settings["variants"]}

    def turned(row):
        return row["overturns"] != row["model_overturns"]

    return [
        {"engine": engine, "variant": variant, "tier": tiers[NAME.of(runs[0])], **tally(runs, "seed", turned)}
        for (engine, variant), runs in grouped(where(result.rows, part="run"), "engine", "variant").items()
    ]


def judgements(result: Result) -> tuple[Judgement, ...]:
    """Judge how many outcomes differ from the model's, by (engine, variant)."""
    marks = {(row["engine"], row["variant"]): equal_mark(row, left_out(row)) for row in tallies(result) if row["runs"]}
    return (Judgement("runs that differ or fail under synthetic motions", marks),)


def glance(result: Result) -> Glance:
    """Return the outcomes of all runs for the report's first screen."""
    tiers = {NAME.of(variant): variant["tier"] for variant in result.settings["variants"]}
    runs = [
        {
            **row,
            "tier": tiers[NAME.of(row)],
            "model_falls": row["model_overturns"],
            "falls": row["overturns"],
            "changed": "outcome" in (row["quantities"] or ()),
            "group": row["seed"],
        }
        for row in where(result.rows, part="run")
    ]
    return Glance(endings=counted("synthetic earthquakes", runs))


def _fits(row):
    """Return whether a curve fits: its p is at least `LEVEL`."""
    return row["p_value"] is not None and row["p_value"] >= LEVEL


def _shares(rows, tones):
    """Figure of shares of the model's runs over intensity, a panel for each scene and measure.

    tones: {limit state: its colour}.
    """
    charts = []
    for (scene, measure), members in grouped(rows, "scene", MEASURE.of).items():
        places = [point["intensity"] for row in members for point in row["points"]]
        low, high = 0.95 * min(places), 1.05 * max(places)
        chart = Chart(
            Axis(measure, low, high, "log", tuple((tick, short(tick)) for tick in TICKS if low <= tick <= high)),
            Axis("share of runs [-]", 0.0, 1.0),
            f"{scene}: share of runs that exceed {', '.join(row['state'] for row in members)}.",
            title=f"{scene}: limit states",
            right=116,
            height=300,
        )
        for row in sorted(members, key=lambda row: row["state"] == OVERTURNING):
            tone, mark = tones[row["state"]], MARKS[list(tones).index(row["state"])]
            xs, ys, lows, highs = zip(
                *([point[key] for key in ("intensity", "share", "low", "high")] for point in row["points"]), strict=True
            )
            chart.reach(xs, ys, lows, highs, tone=tone)
            says = [f"{row['state']}: {number(y)} at {number(x)}" for x, y in zip(xs, ys, strict=True)]
            chart.dots(xs, ys, says=says, tone=tone, mark=mark, small=row["state"] == OVERTURNING)
            if _fits(row):
                fine = np.geomspace(min(xs), max(xs), 80)
                chart.line(fine, norm.cdf(np.log(fine / row["median"]) / row["dispersion"]), tone=tone)
            chart.label(ys[-1], STATE.of(row), tone=tone)
        charts.append(chart)
    caption = (
        "Share of the analytic model's runs that exceed each limit state, over its own intensity measure, with 95 % "
        f"Wilson intervals. A lognormal curve is drawn where it fits (p ≥ {LEVEL:g}). Small marks: overturning."
    )
    return figure(charts, caption)


def _how(settings):
    stretch, radius, peak = (settings["drawn"][key] for key in ("stretch", "radius", "peak"))
    scenes = "; ".join(
        f"{name}, γ = {scene['slendernesses'][0]:g} to {scene['slendernesses'][1]:g} rad"
        for name, scene in settings["scenes"].items()
    )
    return (
        f"The analytic model makes {settings['runs']} independent runs for each scene ({scenes}). Each run has a "
        f"synthetic near-fault motion of its own, with a peak of {peak[0]:g} to {peak[1]:g} g and its time stretched "
        f"by {stretch[0]:g} to {stretch[1]:g}, and a block of its own, with a radius of {radius[0]:g} to "
        f"{radius[1]:g} m. All are drawn evenly over their logarithm. Motions are stretched because all synthetic "
        "motions have nearly the same spectrum.",
        f"Sa: spectral acceleration at the isolation period, {settings['period']:.2f} s (secant at "
        f"{settings['x_max']:g} m), at {percent(settings['damping'])} damping. g tan γ: uplift acceleration; ωᵣ: "
        "rocking frequency. The curve P = Φ(ln(x/median)/dispersion) is that of maximum likelihood; p is that of "
        "Pearson's test of its fit.",
        "For all engines, scenes are left out in which N falls to 0, in which the friction demand exceeds what any "
        "contact provides, or which are near an outcome boundary (a change by 10⁻⁴ changes how the block ends in the "
        "model). Scenes share their motions, so the interval counts the runs under one motion as one.",
        f"Engines run the first {settings['runs_of_engines']} scenes whose PGA is {settings['near'][0]:g} to "
        f"{settings['near'][1]:g} times g tan γ; with defaults they run the first {settings['runs_of_defaults']}. The "
        f"test is McNemar's exact test at a level of {LEVEL:g}, adjusted by Holm's rule for the limit states. "
        "“Analytic, perturbed” is the model with its restitution changed by 1 part in "
        f"{1 / settings['change']:.0f}. An engine that differs no more than this variant cannot be distinguished from "
        "the model.",
    )
