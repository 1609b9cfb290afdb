"""The page of random statues: how often engines are right, their boundaries, and what sliding does."""

from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from analytic.response import EDGE
from engines.comparison import END, PEAK
from engines.comparison import RESTITUTION as RESTITUTION_LIMIT

from ...execution.results import Result
from ...metrics.errors import rms
from ...metrics.statistics import wilson
from ...plotting.charts import Axis, Chart, curve, figure, key_of
from ...plotting.figures import (
    FOUND,
    LARGEST,
    MEDIAN,
    RATINGS,
    SUBJECTS,
    as_it_comes,
    beside,
    failures,
    judged,
    largest,
    leading,
    listing,
    missing,
    ranks,
    rated,
    strip,
    under_jumps,
)
from ...plotting.glance import Glance, counted
from ...plotting.parts import Figure, Judgement, Mark, Page, grouped, table, where
from ...plotting.wording import TRUSTED, ends, left_out, listed, tally
from ...schemas.columns import NAME, Column, number, percent, typeset
from .advice import advised_levels, alarms, at_a_glance, level_tables, missed_at_levels
from .levels import FALLS, SEEDS
from .study import APART, COLUMNS, FREQUENCY

LEAST_RIGHT = 0.95  # share of right runs, of those not left out, from which an engine is rated good
LEAST = 1e-3  # share at which the figure's axis begins
TICKS = ((1e-3, "≤ 0.1 %"), (1e-2, "1 %"), (0.1, "10 %"), (1.0, "100 %"))
WRONG = Column("runs that differ or fail", "wrong", percent=True, within="interval")
ALL = "all"
NONE, DRAWN = "no friction", "friction drawn"  # kinds of a run's scene
# {share: (its words, the count of the scenes that it is a share of, words for those scenes)}
SHARES = {
    "slides": ("slides and never lifts", "moves", "that lift or slide"),
    "saved": ("saved by sliding", "falls_without", "that overturn without sliding"),
    "overturned": ("overturned by sliding", "upright_without", "that stay upright without sliding"),
}


def page(result: Result) -> Page:
    """Return the page of a result."""
    cells, counts, settings = where(result.rows, part="cell"), tallies(result), result.settings
    totals = summed(cells, lambda cell: ALL)
    return Page(
        _title(result, counts),
        (
            "Every run shown that differs from the analytic model is marked as differing.",
            *_friction_sentences(leading(where(counts, friction=DRAWN), settings["variants"])),
            *under_jumps(result),
            *(
                f"In the model sliding saves {row['saved']} of {row['falls_without']} statues that overturn without "
                f"it, and overturns {row['overturned']} of {row['upright_without']} others."
                for row in totals
            ),
        ),
        first=_summary(result, counts),
        more=_details(result, cells, settings, totals),
        how=_how(result),
        evidence=(
            *(
                (f"{NAME.text(row)}, scene {row['index']}: {row['failure']['reason']}", row["failure"]["message"] or "")
                for row in where(_runs(result), **{"class": "failed"})
            ),
            *failures(result),
        ),
    )


def _summary(result, counts):
    """Parts that the report's first page shows too."""
    return (
        beside(
            strip(result, "statues: shift of the boundary"),
            ranks(
                counts,
                NAME,
                WRONG,
                f"Panels “{NONE}” and “{DRAWN}”: share of runs that differ from the analytic model or fail, with 95 % "
                "Wilson intervals. Open marks: defaults. Arrowhead: no such run.",
                Axis(WRONG.head, LEAST, 1.0, "log", TICKS),
                panel="friction",
                opened=as_it_comes,
            ),
        ),
        table(
            "How runs end in the engines. A run is right if its outcome, the time of a fall and the number of impacts "
            f"are those of the model, and if peaks and slip are within {percent(PEAK, 1)}, the restitution within "
            f"{RESTITUTION_LIMIT:g} and the loss at an impact within 10 % of the model's",
            counts,
            NAME,
            COLUMNS["tier"],
            Column("scenes", "friction"),
            Column("right [-]", "right"),
            *ends(counts),
            Column("right, of those not left out", "share", percent=True, within="share_within"),
            Column("near an outcome boundary: differ by more than the model itself", "{beyond} of {edge}"),
            Column("median error of the slip", "slip_median", percent=True),
            Column("worst error of the slip", "slip_worst", percent=True),
            Column("rms error of restitution by states at slipping impacts [-]", "slipping"),
            COLUMNS["lost"].called("slipping impacts missed"),
            Column("CPU time over the model's [-]", lambda row: row["cpu"] and f"{number(row['cpu'], 2)} ×"),
        ),
        table(
            "The lowest overturning boundary of each drawn statue under a pulse",
            rated(result),
            NAME,
            Column("rating", lambda row: RATINGS[row["rating"]]),
            FOUND,
            MEDIAN,
            LARGEST,
        ),
    )


def _details(result, cells, settings, totals):
    """Parts that only the study's own page shows."""
    return (
        table(
            "Runs that differ, without those with defaults",
            [row for row in _runs(result) if row["class"] == "differs" and row["tier"] != "defaults"],
            NAME,
            COLUMNS["index"],
            COLUMNS["friction"],
            Column("in what", lambda row: typeset("; ".join(row["differences"]))),
        ),
        listing(
            "Each drawn statue under one pulse: shift of its lowest boundary",
            where(result.rows, part="drawn edge"),
            where(result.rows, part="drawn shift"),
            COLUMNS["slenderness"].called("slenderness γ", digits=3),
            COLUMNS["radius"],
            Column("base over block mass [-]", lambda row: "rigid" if row["base_mass"] is None else row["base_mass"]),
            Column("bearings", lambda row: row["law"] or "–"),
            COLUMNS["period"],
        ),
        missing(result),
        *level_tables(result),
        alarms(result),
        _shares(cells),
        _sliding([*summed(cells, "support"), *totals]),
        *(f"{NAME.of(row)}: {row['words']}" for row in settings["faults"]),
    )


def _runs(result):
    return where(result.rows, part="run")


def _kind_of_scene(row):
    """Kind of a run's scene: without friction, or with a drawn one."""
    return NONE if row["friction"] is None else DRAWN


def _title(result, counts):
    tuned = where(leading(counts, result.settings["variants"]), tier="tuned")
    right, whole = (
        {name: sum(row[key] for row in where(tuned, friction=name)) for name in (NONE, DRAWN)}
        for key in ("right", "runs")
    )
    return (
        f"Random statues: {right[NONE]} of {whole[NONE]} runs of tuned engines (main variants) are right where blocks "
        f"cannot slide, {right[DRAWN]} of {whole[DRAWN]} where they slide; {largest(result)}"
    )


def _friction_sentences(rows):
    """Yield a sentence on runs with friction: how many are right, how many outcomes are wrong, and the error at slips.

    These are three different counts.
    """
    rows = [row for row in rows if row["runs"]]

    def each(words):
        return listed([f"{words(row)} ({row['engine']})" for row in rows])

    if rows:
        yield (
            "With friction, engines were run only in scenes where the block actually slides. All measures are right "
            f"in {each(lambda row: '{right} of {runs}'.format(**row))} runs. The outcome is wrong or missing in "
            f"{each(lambda row: row['runs'] - row['alike'])} runs. {_slipping(rows)} The limit for a trusted engine, "
            f"{TRUSTED:g}, applies to impacts without slip."
        )


def _slipping(rows):
    """Sentence on the error of restitution at impacts with slip."""
    errors = listed([f"{number(row['slipping'], 2)} ({row['engine']})" for row in rows])
    return f"At impacts with slip, the rms error of restitution by states is {errors}."


def tallies(result: Result) -> list[dict[str, Any]]:
    """Return a row for each variant, without friction and with it.

    Each has the `tally` of its runs, how many are right, shares with their 95 % intervals, and errors where blocks
    slide. A value is None where no run is judged, or no block slides.
    """
    counted_rows = []
    for (friction, engine, variant), rows in grouped(_runs(result), _kind_of_scene, "engine", "variant").items():
        counts = tally(rows, "index", _turned)
        runs, right = counts["runs"], counts["runs"] - counts["differing"]
        sound = [row for row in rows if row["class"] in ("right", "differs")]
        slips = np.abs([row["slip_error"] for row in sound if row.get("slip_error") is not None])
        slipping = np.array([error for row in sound for error in row.get("slipping", ())])
        edge = where(rows, comparable=EDGE)
        ratios = [row["cpu_ratio"] for row in sound if "cpu_ratio" in row]
        counted_rows.append(
            {
                "engine": engine,
                "variant": variant,
                "tier": rows[0]["tier"],
                "friction": friction,
                **counts,
                "right": right,
                "wrong": counts["share"],
                "share": right / runs if runs else None,
                "share_within": wilson(right, runs) if runs else None,
                "beyond": sum(bool(row.get("failure") or row.get("differences")) for row in edge),
                "alike": sum("outcome" not in row["quantities"] for row in sound),
                "slip_median": float(np.median(slips)) if len(slips) else None,
                "slip_worst": float(slips.max()) if len(slips) else None,
                "slipping": rms(slipping) if len(slipping) else None,
                "lost": sum(row["lost"] for row in sound) if friction == DRAWN else None,
                "cpu": float(np.median(ratios)) if ratios else None,
            }
        )
    return sorted(counted_rows, key=lambda row: row["friction"] == DRAWN)


def _turned(row):
    """Return whether a run overturns and the model does not, or the other way round.

    No row stores the model's outcome, so it is read from the sentence on the difference.
    """
    return any(words.count("overturns") == 1 for words in row["differences"] if words.startswith("the block "))


def judgements(result: Result) -> tuple[Judgement, ...]:
    """Judge boundaries, and runs without and with friction, by (engine, variant).

    The counts without and with friction stay apart: in their sum the many would hide the few.
    """
    heads = {NONE: "random scenes right", DRAWN: "sliding scenes right"}
    marks: dict[str, dict[tuple[str, str], Mark]] = {name: {} for name in heads}
    for row in tallies(result):
        if row["runs"]:
            level = "good" if row["share"] >= LEAST_RIGHT else "fair" if row["share"] >= 0.5 else "bad"
            note = f"outcome right in {row['alike']}; {row['differing'] - row['failed']} differ, {row['failed']} failed"
            words = f"{row['right']} of {row['runs']}"
            mark = Mark(words, level, f"{note}; {left_out(row)}", row["share"])
            marks[row["friction"]][row["engine"], row["variant"]] = mark
    return (judged(result, "random statues"), *(Judgement(head, marks[name]) for name, head in heads.items()))


def glance(result: Result) -> Glance:
    """Return the outcomes of the runs with friction.

    A run counts as differing only if it ends otherwise: an error of the slip is no other end. Runs without friction are
    not on the first screen, as the few that differ would be hidden among many.
    """
    outcomes = {row["index"]: row["outcome"] for row in where(result.rows, part="scene")}
    runs = [
        {
            **row,
            "class": "right" if row["class"] == "differs" and not END & set(row["quantities"]) else row["class"],
            "model_falls": outcomes[row["index"]] == FALLS,
            "falls": None if row["outcome"] == "failed" else row["outcome"] == FALLS,
            "changed": "outcome" in row.get("quantities", ()),
            "group": row["index"],
        }
        for row in _runs(result)
        if row["friction"] is not None
    ]
    sliders = leading(where(tallies(result), friction=DRAWN), result.settings["variants"])
    slipping = [row for row in sliders if row["slipping"] is not None]
    return Glance(
        says={"level": at_a_glance(result), "slip": ("", _slipping(slipping) if slipping else "")},
        endings=counted("blocks that may slide", runs),
        advice=advised_levels(result),
        missed=missed_at_levels(result),
    )


def summed(cells: Iterable[Mapping[str, Any]], key: Any) -> list[dict[str, Any]]:
    """Add up the cells' counts by a key, with each of `SHARES`: (how many, of how many, share, its interval)."""
    sums = []
    for (name,), members in grouped(cells, key).items():
        row = {k: sum(cell[k] for cell in members) for k, value in members[0].items() if type(value) is int}
        sound = row["runs"] - row["failed"] - row["undecided"]
        row |= {"engine": "analytic", "name": name, "upright_without": sound - row["falls_without"]}
        for share, (_, whole, _) in SHARES.items():
            fraction = row[share] / row[whole] if row[whole] else None
            within = wilson(row[share], row[whole]) if row[whole] else None
            row |= {f"{share}_share": fraction, f"{share}_within": within}
        sums.append(row)
    return sums


def _sliding(rows):
    """Table of what sliding changes in the analytic model."""
    shares = (
        Column(f"{words}, of those {of}", partial(_share_in_words, share=s)) for s, (words, _, of) in SHARES.items()
    )
    return table(
        "What sliding changes in the analytic model: random statues with a friction coefficient of 0.2 to 0.8, at rest "
        "when the motion begins. Shares with 95 % Wilson intervals",
        rows,
        Column("support", "name"),
        COLUMNS["runs"],
        COLUMNS["moves"],
        COLUMNS["lacking"],
        *shares,
        Column("undecided, failed [-]", "{undecided}, {failed}"),
    )


def _share_in_words(row, share):
    """Words on a share: its counts and its interval."""
    within, words = row[f"{share}_within"], f"{row[share]} of {row[SHARES[share][1]]}"
    return words if within is None else f"{words}, {number(100 * within[0], 2)} to {percent(within[1])}"


def _shares(cells: Sequence[Mapping[str, Any]]) -> Figure | None:
    """Figure of shares over friction, a panel for each support."""
    looks = {words: curve(rank) for rank, (words, *_) in enumerate(SHARES.values())}
    limits = [end for cell in cells for end in cell["friction"]]
    charts = []
    for (support,), members in grouped(cells, "support").items():
        chart = Chart(
            Axis("friction μ [-]", min(limits), max(limits)),
            Axis("share of scenes [-]", 0.0, 1.0),
            f"{support}: share of scenes, over friction, in which the block is {', '.join(looks)}.",
            title=f"{support}: what sliding does",
            height=300,
        )
        rows = summed(members, lambda cell: tuple(cell["friction"]))
        for share, (words, whole, of) in SHARES.items():
            drawn = [row for row in rows if row[whole]]
            xs = [sum(row["name"]) / 2 for row in drawn]
            ys = [row[f"{share}_share"] for row in drawn]
            lows, highs = ([row[f"{share}_within"][end] for row in drawn] for end in (0, 1))
            tooltips = [f"{words}, of those {of}: {_share_in_words(row, share)}" for row in drawn]
            chart.reach(xs, ys, lows, highs, words, look=looks[words])
            chart.line(xs, ys, words, look=looks[words])
            chart.dots(xs, ys, words, says=tooltips, look=looks[words])
        charts.append(chart)
    keys = {words: key_of(words, look=look) for words, look in looks.items()}
    caption = "The analytic model: share of scenes over friction, with 95 % Wilson intervals: " + "; ".join(
        f"{words}, of those {of}" for words, _, of in SHARES.values()
    )
    return figure(charts, f"{caption}.", keys, keys) if charts else None


def _how(result: Result) -> tuple[str, ...]:
    settings, scenes = result.settings, where(result.rows, part="scene")
    recorded = f"components of {settings['source']}" if settings["source"] else "none, as their package is missing here"
    low, high = settings["peak"]
    limits = settings["range"].replace("J_O/(m R^2)", "inertia about a corner over m R²")
    return (
        f"Without friction, {settings['scenes']} scenes are drawn at random (seed {result.provenance['seed']}, derived "
        f"from the commit) from this range: {limits}. The block is released or stands under a pulse; a run lasts until "
        f"its outcome is decided. {settings['below_range']} scenes whose peak tilt stays below the range are not run. "
        f"With friction, {settings['sliders']} scenes are drawn evenly, at rest, on rigid ground or on bearings. (No "
        "motion reaches a block on a base without bearings.) Half of the motions are pulses, a quarter are synthetic "
        f"and a quarter recorded ({recorded}). Each is scaled to a peak of {low:g} to {high:g} times g tan γ. "
        f"{percent(settings['vertical'])} have a vertical component with {number(settings['ratio'], 2)} times the "
        "horizontal peak. All shares depend on how the scenes are drawn.",
        "“Without sliding” is the same scene without a friction coefficient, in which the block turns about corners "
        "that never slip. It needs more than the friction if its demand |H|/N exceeds the coefficient before a final "
        "fall, or if N falls to 0. A run is undecided if the base goes on swinging, so that the end is not certain. "
        "Errors of the slip are relative, for blocks that stay upright; a slip too small to count is taken as 0.005 R. "
        "The ratio of CPU times is that of an engine’s stepping to the model’s integration, as the median over scenes.",
        f"Engines run the first {len(scenes)} scenes whose friction demand exceeds the friction. Only the main "
        f"variants of {SUBJECTS} run all of them; other variants run one in {settings['fewer']}. For all engines, "
        "scenes are left out whose normal force falls to 0 without friction, whose friction demand no contact "
        "provides, or which are near an outcome boundary. A scene is near a boundary if a change by 10⁻⁴, of the "
        "friction too, makes such a difference in the model. A column counts the runs of such scenes that fail, or "
        "differ by more than such changes make the model differ.",
        f"Levels are tested on statues of two draws (seeds {SEEDS[0]} and {SEEDS[1]}) from the same range. They lift "
        "by at least the least tilt of the range, and the model holds for them. Half of them stand under recorded "
        "motions (synthetic ones where none are at hand), half under pulses; half have a friction coefficient.",
        f"Boundaries are those of {len(where(result.rows, part='drawn edge'))} of the statues, at rest. The shapes of "
        f"the pulses take turns; their frequencies are drawn from {FREQUENCY[0]:g} to {FREQUENCY[1]:g} times the "
        "rocking frequency. The lowest boundary is taken, provided that no other one is nearer than "
        f"{percent(APART, 1)} and that the block is pressed on its base.",
    )
