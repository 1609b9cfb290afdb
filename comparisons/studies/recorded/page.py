"""The page of recorded motions: how many runs differ from the model's, and in which way."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from analytic.records.content import PREFIX
from engines import ENGINES
from engines.comparison import FALL

from ...execution.results import Result
from ...plotting.charts import Axis, Chart, figure, key_of
from ...plotting.figures import SUBJECTS, as_it_comes, kind, leading, mains, subject
from ...plotting.glance import Glance, counted
from ...plotting.parts import Figure, Judgement, Mark, Page, grouped, table, where
from ...plotting.wording import NOT_COMPARED, ends, ends_in_words, equal_mark, least_shown, left_out, tally
from ...schemas.columns import NAME, Column, number, percent, short, typeset
from .study import COLUMNS, ERRORS

MANY = 0.95  # level of the quantile of errors
FALLS = "overturns"
BOTH = "both"  # value of "configuration" for free-standing and isolated together
# Tilt over slenderness at which both axes begin, "overturns" stands, the model's axis ends, and "failed" stands.
LEAST, FALLEN, MOST, FAILED = 0.01, 4.0, 6.0, 10.0
TICKS = ((0.01, "≤ 0.01"), (0.1, "0.1"), (1.0, "1"), (FALLEN, "overturns"))
PEAKS = {"tilt": "peak tilt", "displacement": "peak base displacement"}
WORDS = {
    "slenderness": "slenderness [rad]",
    "intensity": "intensity",
    "base_mass": "base",
    "period": "period",
    "damping": "damping",
}

RECORD = Column("record", lambda row: f"{row['record'].removeprefix(PREFIX)}/{row['component']}")
CONFIGURATION = COLUMNS["configuration"]
JUDGED, DIFFERING = COLUMNS["runs"], Column("that differ or fail [-]", "differing")
SHARE = Column("share that differs or fails", "share", percent=True, within="interval")


def page(result: Result) -> Page:
    """Return the page of a result."""
    if absent := where(result.rows, part="absent"):
        return Page("Recorded motions: not computed, no records are installed", (f"{absent[0]['reason']}.",))
    runs = where(result.rows, part="run")
    summaries = [row for members in grouped(runs, "engine", "variant").values() for row in summary(members)]
    both = where(summaries, configuration=BOTH)
    variants = result.settings["variants"]
    counts = (JUDGED, DIFFERING, *ends(summaries), SHARE)
    return Page(
        f"Recorded motions: {ends_in_words(leading(both, variants))}",
        (
            "A run differs from the model if its outcome (stands, rocks or overturns) is another, or if the block "
            f"falls at another time: more than {percent(FALL, 1)} of a rocking period off, or after another number of "
            "impacts. A failed run counts as differing.",
            f"Runs under one record are not independent, so the interval counts records. Even if no run differs, "
            f"{least_shown(both, 'records')} (upper 95 % limit).",
        ),
        first=(
            _tilts(runs, mains(variants)),
            table(
                "How runs end compared with the analytic model’s, free-standing and isolated together, with 95 % "
                "Wilson intervals by record",
                both,
                NAME,
                COLUMNS["tier"],
                *counts,
            ),
        ),
        more=_details(runs, summaries, counts),
        how=_how(result),
        evidence=tuple(
            (
                f"{NAME.of(row)}, {RECORD.of(row)}, {row['configuration']}: {row['failure']['reason']}",
                row["failure"]["message"] or "",
            )
            for row in where(runs, **{"class": "failed"})
        ),
    )


def _details(runs, summaries, counts):
    """Parts that only the study's own page shows."""
    return (
        table(
            "The same by configuration",
            [row for row in summaries if row["configuration"] != BOTH],
            NAME,
            CONFIGURATION,
            *counts,
        ),
        table(
            "Relative errors of peaks, run by run: median, largest, number of runs, 95 % quantile. They are taken up "
            "to the horizon common to all engines, or up to the engine’s own",
            summaries,
            NAME,
            CONFIGURATION,
            COLUMNS["tilt_error"],
            COLUMNS["displacement_error"],
            COLUMNS["own_tilt_error"],
            COLUMNS["own_displacement_error"],
        ),
        table(
            "Runs that differ or fail. Peak tilts are over the slenderness",
            where(runs, **{"class": {"differs", "failed"}}),
            NAME,
            RECORD,
            CONFIGURATION,
            COLUMNS["model_outcome"],
            COLUMNS["outcome"].called("engine"),
            COLUMNS["model_tilt"],
            COLUMNS["tilt"].called("peak tilt, engine"),
            Column("in what", lambda row: typeset("; ".join(row.get("differences", ()))) or None),
        ),
    )


def judgements(result: Result) -> tuple[Judgement, ...]:
    """Judge how many outcomes differ from the model's, and the errors of the peaks, by (engine, variant)."""
    runs = grouped(where(result.rows, part="run"), "engine", "variant")
    rows = {pair: where(summary(members), configuration=BOTH)[0] for pair, members in runs.items()}
    return (
        Judgement(
            "runs that differ or fail under recorded motions",
            {name: equal_mark(row, left_out(row)) for name, row in rows.items()},
        ),
        *(
            Judgement(
                f"median error of {words} under recorded motions",
                {name: _peak_mark(row[f"{key}_error"]) for name, row in rows.items()},
            )
            for key, words in PEAKS.items()
        ),
    )


def glance(result: Result) -> Glance:
    """Return the outcomes of all runs, and the errors of their peak tilt at the one level that was run."""
    runs = [
        {
            **row,
            "model_falls": row["model_outcome"] == "overturns",
            "falls": None if row["outcome"] == "failed" else row["outcome"] == "overturns",
            "changed": "outcome" in row.get("quantities", ()),
            "group": row["record"],
        }
        for row in where(result.rows, part="run")
    ]
    return Glance(endings=counted("recorded earthquakes", runs))


def summary(rows: Sequence[dict[str, Any]]) -> Iterator[dict[str, Any]]:
    """Yield rows of a variant from its runs: one for each configuration, and one for both together.

    Each has the `tally` of its runs, in which the components and configurations of a record count as one. Each of
    `ERRORS` is [median, largest, number, 95 % quantile] of the absolute values.
    """
    for configuration in (*dict.fromkeys(row["configuration"] for row in rows), BOTH) if rows else ():
        members = [row for row in rows if configuration in (row["configuration"], BOTH)]
        errors = {name: _spread([row.get(name) for row in members if row["class"] != "left out"]) for name in ERRORS}
        named = {**{key: rows[0][key] for key in ("engine", "variant", "tier")}, "configuration": configuration}
        yield named | tally(members, "record", _turned) | errors


def _turned(row):
    """Return whether a run overturns and the model does not, or the other way round."""
    return (row["outcome"] == FALLS) != (row["model_outcome"] == FALLS)


def _spread(errors: Sequence[float | None]) -> list[float | int] | None:
    """Return [median, largest, number, 95 % quantile] of the known errors; None without any."""
    sizes = np.abs([error for error in errors if error is not None])
    high = float(np.quantile(sizes, MANY, method="higher")) if len(sizes) else None
    return [float(np.median(sizes)), float(sizes.max()), len(sizes), high] if len(sizes) else None


def _peak_mark(errors):
    if errors is None:
        return Mark("not compared", "none")
    median, most, count, high = errors
    note = f"{count} runs, {100 * MANY:g} % of them below {percent(high)}, worst {percent(most)}"
    return Mark(percent(median), "none", note, median)


def _tilts(runs: list[dict[str, Any]], main: Mapping[str, str]) -> Figure | None:
    """Figure of each run's peak tilt over the model's, for subject engines, tuned and with defaults.

    There is a panel for each configuration. Tuned variants that are not their engine's main one stand behind, in grey.
    """
    groups = grouped(runs, "engine", "variant", "tier").values()
    subject_groups = [members for members in groups if subject(members[0])]
    firsts = [members[0] for members in subject_groups]

    def other(row):
        return not as_it_comes(row) and main[row["engine"]] != row["variant"]

    ups = tuple((value, f"{word}\u2002") for value, word in (*TICKS, (FAILED, "failed")))  # room for half a mark
    charts = []
    for configuration in dict.fromkeys(row["configuration"] for row in runs):
        names = ", ".join(map(NAME.of, firsts))
        chart = Chart(
            Axis("peak tilt over slenderness, model [-]", LEAST, MOST, "log", TICKS),
            Axis("peak tilt over slenderness, engine [-]", LEAST, FAILED, "log", ups),
            f"{configuration}: peak tilt over slenderness of {names}, over the analytic model's.",
            title=f"{configuration}: peak tilt",
            height=340,
            left=100,
        )
        chart.line([LEAST, FALLEN], [LEAST, FALLEN], tone="var(--faint)")
        for members in sorted(
            subject_groups,
            key=lambda runs_of_variant: (not other(runs_of_variant[0]), not as_it_comes(runs_of_variant[0])),
        ):
            drawn = where(members, configuration=configuration, **{"class": {"right", "differs", "failed"}})
            model, engine = ([_place(row, side) for row in drawn] for side in ("model_", ""))
            filled, says = not as_it_comes(members[0]), [_tooltip(row) for row in drawn]
            series = NAME.of(members[0]) if other(members[0]) else kind(members[0])
            chart.dots(model, engine, series, filled=filled, grey=other(members[0]), says=says)
        charts.append(chart)
    coloured = [row for row in firsts if not other(row)]
    grey = ", ".join(NAME.of(row) for row in firsts if other(row))
    keys = {kind(row): key_of(kind(row), filled=not as_it_comes(row), joined=False) for row in coloured}
    left_out = "; ".join(NAME.of(members[0]) for members in groups if members not in subject_groups)
    caption = (
        "One mark for each record component that is judged. On the diagonal, engine and model agree. A mark in the row "
        "or the column “overturns”, but not in both, is another outcome. Marks at the upper edge: failed runs. Open "
        "marks: defaults, run under fewer records."
        + f" Grey: {grey}." * bool(grey)
        + f" Not drawn, but in the table: {left_out}." * bool(left_out)
    )
    return figure(charts, caption, keys, keys) if charts else None


def _place(row, side):
    """Return the value at which a run's tilt is drawn; overturned and failed runs have places of their own."""
    at = {FALLS: FALLEN, "failed": FAILED}.get(row[f"{side}outcome"])
    return at or max(row[f"{side}tilt"], LEAST)


def _tooltip(row):
    """Tooltip of a mark; a run that is right needs none."""
    if row["class"] == "right":
        return ""
    engine, model = (f"{row[f'{side}outcome']} ({number(row.get(f'{side}tilt'), 2)})" for side in ("", "model_"))
    return f"{NAME.of(row)}, {RECORD.of(row)}: {engine}, in the model {model}; {row['class']}"


def _how(result: Result) -> tuple[str, ...]:
    settings = result.settings
    ranges = "; ".join(
        f"{name}: " + ", ".join(f"{WORDS[key]} {short(low)} to {short(high)}" for key, (low, high) in ends.items())
        for name, ends in settings["ranges"].items()
    )
    mix = "; ".join(
        f"{name}: " + ", ".join(f"{count} {outcome}" for outcome, count in outcomes.items())
        for name, outcomes in settings["mix"].items()
    )
    why = [row["comparable"] for row in where(result.rows, part="scene") if row["comparable"] != "yes"]
    left = [NOT_COMPARED.get(reason, reason) for reason in why]
    run = [row for row in result.rows if row.get("engine") in ENGINES]
    others = "" if all(map(subject, run)) else ", and other tuned engines,"
    reasons = ", ".join(f"{left.count(reason)} {reason}" for reason in dict.fromkeys(left)) or "none"
    return (
        f"The motions are {settings['records']} records ({settings['source']}). Each component is run by itself, "
        f"scaled by a factor. A fixed seed ({result.provenance['seed']}) and the component’s name determine block and "
        f"factor, from these ranges: {ranges}. Intensity is the peak ground velocity times ωᵣ over g tan γ; base is "
        "the base mass over the block mass. Both are drawn evenly over their logarithm. Period [s] and damping of the "
        f"bearings are those at {settings['x_max']:g} m; the bearing law is one of {', '.join(settings['laws'])}. The "
        f"ranges were chosen once, by the outcomes of the model alone: {mix}.",
        f"The tuned variants of {SUBJECTS} run all records. Their defaults{others} run both components of "
        f"{settings['records_of_others']} records. Left out of all engines: {reasons}. A scene is near "
        "an outcome boundary if a change of it by 10⁻⁴ changes how the block ends in the model. Components and "
        "configurations of a record are not independent, so Wilson’s interval counts records, not runs.",
        "The common horizon is the time at which a change of the model by 10⁻⁴ has moved its tilt by a hundredth of "
        "the slenderness. An engine’s own horizon is that of a change as large as the engine’s errors. Peaks too small "
        "to count are not compared.",
    )
