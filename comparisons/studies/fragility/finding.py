"""What the report shows of fragility: one sentence, points with curves that fit, one table, a column of verdicts."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.stats import norm

from ...showing.charts import Axis, Chart, figure
from ...showing.parts import Judgement, Mark, Section, Table, number
from .figures import is_shown, labelled, parted
from .page import ANALYTIC, OVERTURNING, _asked, _efficiency, _reading, _resolved
from .tables import LEVEL, ranged, shift, size

if TYPE_CHECKING:
    from ...running.provenance import Result

TONES = ("var(--faint)", "var(--soft)", "var(--accent)", "var(--ink)", "var(--ghost)")
COARSE = 0.3  # difference of probabilities that must at least be found, if there is one
TICKS = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0)


def finding(result: Result) -> Section:
    """The `Section` of the report about the odds under many earthquakes."""
    judged = judgement(result).marks
    apart = [", ".join(filter(None, pair)) for pair, mark in judged.items() if mark.level == "bad"]
    sound = sum(mark.level == "good" for mark in judged.values())
    title = f"Many earthquakes: no difference of the odds found for {sound} of {len(judged)} settings of engines" + (
        f"; not so for {', '.join(apart)}" if apart else ""
    )
    if few := len(judged) - sound - len(apart):
        title += f"; too few runs to tell for {few}"
    scenes = list(result.settings["scenes"])
    text = (
        "Over a whole motion the rocking of a block cannot be predicted point by point; its odds can. “No difference "
        "found” is not “equal”: the table says which shift of the median intensity would have been found.",
        *(_efficiency(result, scene) for scene in scenes),
    )
    panels = [_panel(result, scene) for scene in scenes]
    caption = (
        "Share of runs of the analytic model that exceed each limit state, with 95 % Wilson intervals, over the "
        "measure of least dispersion for overturning. A lognormal curve only where the test of its fit is passed."
    )
    return Section(
        title, text, (_table(result),), (figure(panels, caption),), measured=(_asked(result), _reading(result))
    )


def judgement(result: Result) -> Judgement:
    """Whether the odds of overturning differ, by (engine, variant); the default variant's name is not stored: ""."""
    marks = {}
    for label in result.settings["solvers"]:
        if label.startswith(ANALYTIC):
            continue
        rows = parted(result, "effect", solver=label)
        engine, _, variant = label.partition(", ")
        if not rows:
            marks[engine, variant] = Mark("no run succeeded", "bad")
            continue
        falls = [row for row in rows if row["state"] == OVERTURNING]
        differ, runs = sum(row["only_a"] + row["only_b"] for row in falls), sum(size(row) for row in falls)
        found = [row["detectable_difference"] for row in falls]
        few = None in found or max(found) > COARSE  # so few runs acquit nobody
        bad = any(row["p_holm"] <= LEVEL for row in rows)
        failed = sum(row["left_out"] for row in falls)
        words = (
            f"{differ} of {runs} differ"
            + (f", {failed} failed" if failed else "")
            + (", too few to tell" if few and not bad else "")
        )
        marks[engine, variant] = Mark(words, "bad" if bad else "none" if few else "good", _resolved(falls))
    return Judgement("verdicts over many earthquakes", marks)


def _panel(result, scene):
    """Shares of runs over one measure, a tone for each limit state."""
    measure = _measure(result, scene)
    rows = [row for row in parted(result, "fit", scene=scene, measure=measure) if row["points"]]
    places = [point["intensity"] for row in rows for point in row["points"]]
    low, high = 0.95 * min(places), 1.05 * max(places)
    chart = Chart(
        Axis(
            labelled(measure), low, high, "log", tuple((value, f"{value:g}") for value in TICKS if low <= value <= high)
        ),
        Axis("share of runs [-]", 0.0, 1.0),
        f"{scene}: share of runs that exceed {', '.join(row['state'] for row in rows)}.",
        title=scene,
        right=116,
        height=300,
    )
    for tone, row in zip(TONES, rows, strict=False):
        xs, ys, lows, highs = ([point[key] for point in row["points"]] for key in ("intensity", "share", "low", "high"))
        says = [f"{row['state']}: {number(y, 3)} at {number(x, 3)}" for x, y in zip(xs, ys, strict=True)]
        chart.reach(xs, ys, lows, highs, tone=tone)
        chart.dots(xs, ys, says=says, tone=tone)
        if is_shown(row):
            fine = np.geomspace(min(xs), max(xs), 80)
            chart.line(fine, norm.cdf(np.log(fine / row["median"]) / row["dispersion"]), tone=tone)
        chart.label(ys[-1], row["state"].replace("displacement", "x"), tone=tone)
    return chart


def _measure(result, scene):
    """The measure of least dispersion for overturning, PGA where there is no curve."""
    rows = parted(result, "fit", scene=scene, state=OVERTURNING)
    return next((row["measure"] for row in rows if row["best"]), "PGA")


def _table(result):
    rows = []
    for label in result.settings["solvers"]:
        found = parted(result, "effect", solver=label, state=OVERTURNING)
        for row in found:
            rows.append(
                [
                    label,
                    row["scene"],
                    f"{row['only_a'] + row['only_b']} of {size(row)}",
                    shift(row["median_shift"], row["median_interval"]) if row["median_shift"] else "–",
                    ranged(row["dispersion_shift"], row["dispersion_interval"], 3) if row["dispersion_shift"] else "–",
                    number(row["p_holm"], 2),
                    shift(row["detectable_shift"]) if row["detectable_shift"] else "–",
                ]
            )
    return Table(
        "Overturning: each solver against the analytic model on the same runs",
        (
            "solver",
            "scene",
            "verdicts differ",
            "shift of the median",
            "dispersion, times",
            "p (Holm)",
            "would be found",
        ),
        rows,
    )
