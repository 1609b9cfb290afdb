"""What is shown of the fragility surface."""

import math

import numpy as np

from ...running.provenance import Result
from ...showing.charts import Axis, Chart, figure
from ...showing.parts import NAME, Column, Page, grouped, number, percent, table
from .study import crossing

LEVELS = (0.16, 0.5, 0.84)  # shares whose lines are drawn
TICKS = (0.1, 0.2, 0.5, 1, 2, 3, 5)  # g
SHOWN = 9  # rows of the table for each engine, at most
GAMMA = Column("slenderness γ [rad]", "slenderness", digits=3)
HALF = Column("half at [g]", "half", digits=3)
OVER_UPLIFT = Column("over g tan γ [-]", lambda row: row["half"] and row["half"] / math.tan(row["slenderness"]), 3)
FALLS = Column("falls again by", "falls_by", percent=True)


def page(result: Result) -> Page:
    s, engines = result.settings, grouped(result.rows, "engine")
    first = next(iter(engines.values()))
    worst = max(first, key=lambda row: row["falls_by"])
    return Page(
        _title(first),
        (
            "Each point is the share of synthetic motions that overturn a block of that slenderness when they are "
            "scaled to that peak ground acceleration. A stronger motion is not always worse: at slenderness "
            f"{GAMMA.text(worst)} the share drops by {number(100 * worst['falls_by'], 2)} percentage points as the "
            "acceleration increases.",
        ),
        more=(
            figure(
                [_surface(result, engine, rows) for (engine,), rows in engines.items()],
                "Where the share of motions that overturn the block first reaches 16, 50 and 84 %; above, it may fall "
                "again. Shaded: more than half. Below the line of uplift, peak ground acceleration g tan γ, no block "
                "lifts.",
            ),
            table(
                "Peak ground acceleration that overturns half, with its 95 % interval",
                [row for rows in engines.values() for row in _some(rows)],
                NAME,
                GAMMA,
                HALF,
                Column("interval [g]", lambda row: " to ".join(number(limit) for limit in row["interval"])),
                OVER_UPLIFT,
                FALLS,
                Column("widest Wilson interval of a share", "widest", percent=True),
            ),
        ),
        how=(
            f"{s['runs']:,} runs: {len(s['slendernesses'])} slendernesses, {len(s['intensities'])} peak ground "
            f"accelerations and {s['motions']} synthetic motions for each of {', '.join(name for (name,) in engines)}; "
            f"scene {s['scene']}. {s['failed']} failed, {s['undecided']} ended undecided.",
        ),
    )


def _some(rows):
    return [rows[k] for k in np.unique(np.linspace(0, len(rows) - 1, min(SHOWN, len(rows))).astype(int))]


def _title(rows):
    """From where to where the intensity goes that overturns half."""
    known = [row for row in rows if row["half"] is not None]
    if len(known) < 2:
        return "Fragility surface: one half is crossed at fewer than two slendernesses; add intensities"
    first, last = (OVER_UPLIFT.text(row) for row in (known[0], known[-1]))
    return (
        f"Fragility surface: half of the motions overturn the block at {first} times its uplift acceleration at "
        f"slenderness {GAMMA.text(known[0])}, at {last} times at {GAMMA.text(known[-1])}"
    )


def _surface(result, engine, rows):
    gammas, intensities = (np.array(result.settings[key]) for key in ("slendernesses", "intensities"))
    sound = result.arrays[f"{engine}/sound"]
    shares = result.arrays[f"{engine}/overturned"] / np.where(sound > 0, sound, 1)
    chart = Chart(
        Axis(GAMMA.head, float(gammas[0]), float(gammas[-1])),
        Axis(
            "peak ground acceleration [g]",
            float(intensities[0]),
            float(intensities[-1]),
            "log",
            tuple((value, f"{value:g}") for value in TICKS if intensities[0] <= value <= intensities[-1]),
        ),
        f"{engine}: peak ground acceleration that overturns {', '.join(percent(level) for level in LEVELS)} of the "
        "motions over slenderness, with the line of uplift.",
        title=NAME.of(rows[0]),
        height=320,
        right=70,
    )
    for level in LEVELS:
        crossed = np.array([crossing(intensities, share, level) for share in shares], dtype=float)  # NaN for None
        known = np.isfinite(crossed)
        if not known.any():
            continue
        x, y = gammas[known], crossed[known]
        chart.line(x, y)
        chart.label(y[-1], percent(level))
        if level == 0.5:
            chart.area([*x, x[-1], x[0]], [*y, intensities[-1], intensities[-1]], "falls")
    chart.line(gammas, np.tan(gammas), tone="var(--accent)")
    chart.label(math.tan(gammas[-1]), "uplift", tone="var(--accent)")
    return chart
