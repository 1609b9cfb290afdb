"""What is shown of random scenes: how often each engine is right, and every run that is not."""

from typing import Any

from analytic.response import EDGE

from ...measuring.statistics import wilson
from ...running.provenance import Result
from ...showing.charts import Axis
from ...showing.figures import as_it_comes, ranks
from ...showing.parts import NAME, Column, Judgement, Mark, Page, grouped, table, typeset, where
from ...showing.wording import ends, left_out, tally

TRUSTED = 0.95  # share of right runs, of those not left out
LEAST = 1e-3  # that the figure's axis begins at
TICKS = ((1e-3, "≤ 0.1 %"), (1e-2, "1 %"), (0.1, "10 %"), (1.0, "100 %"))
WRONG = Column("runs that differ or fail", "wrong", percent=True, within="wrong_within")
TOLD = "A run that differs from the analytic model is reported as differing wherever it is shown."


def page(result: Result) -> Page:
    counts = tallies(result)
    tuned = where(counts, tier="tuned")
    right, judged, failed = (sum(row[key] for row in tuned) for key in ("right", "judged", "failed"))
    differing = [row for row in where(result.rows, **{"class": "differs"}) if row["tier"] != "defaults"]
    settings = result.settings
    limits = settings["range"].replace("J_O/(m R^2)", "inertia about a corner over m R²")
    return Page(
        f"Random statues: {right} of {judged} runs of tuned engines are right, {failed} failed",
        (TOLD,),
        first=(
            ranks(
                counts,
                NAME,
                WRONG,
                "Share of runs that differ from the analytic model or fail, with 95 % Wilson intervals. Open marks: "
                "defaults; arrowheads: none.",
                Axis("runs that differ or fail", LEAST, 1.0, "log", TICKS),
                opened=as_it_comes,
            ),
            table(
                "Random scenes in the range of a statue: right in the outcome, the time of a fall, the number of "
                "impacts, and within 2 % of both peaks, 0.01 of the restitution and 10 % of an impact's loss",
                counts,
                NAME,
                Column("kind", "tier"),
                Column("right [-]", "right"),
                *ends(counts),
                Column("right, of those not left out", "share", percent=True, within="share_within"),
                Column("near an outcome boundary, and beyond it", "{beyond} of {edge}"),
            ),
        ),
        more=(
            table(
                "Runs that differ, without the variants “defaults”",
                differing,
                NAME,
                Column("scene", "index"),
                Column("in what", lambda row: typeset("; ".join(row["differences"]))),
            ),
        ),
        how=(
            f"{settings['scenes']} scenes drawn at random (seed {result.provenance['seed']}, of the commit): "
            f"{limits}; released or under a pulse, until the outcome is decided. {settings['below_range']} "
            "whose peak tilt stays below the range are not run.",
            "Left out, of all engines alike: the normal force falls to 0, the friction demand is more than any contact "
            "provides, or the scene is near an outcome boundary: a change by 10⁻⁴ makes such a difference in the "
            "analytic model. Beyond it: runs of those scenes that fail, or lie outside what such changes do in the "
            "model.",
        ),
        evidence=tuple(
            (f"{NAME.text(row)}, scene {row['index']}: {row['failure']['reason']}", row["failure"]["message"])
            for row in where(result.rows, **{"class": "failed"})
        ),
    )


def tallies(result: Result) -> list[dict[str, Any]]:
    """A row for each variant: the `tally` of its runs, how many are right, the shares of right and of wrong ones with
    their 95 % intervals; None where none is judged."""
    found = []
    for (engine, variant), rows in grouped(result.rows, "engine", "variant").items():
        counts = tally(rows, "index", _turned)
        judged, wrong = counts["runs"], counts["differing"]
        edge = where(rows, comparable=EDGE)
        beyond = [row for row in edge if row.get("failure") or row.get("differences")]
        right = judged - wrong
        found.append(
            {
                "engine": engine,
                "variant": variant,
                "tier": rows[0]["tier"],
                **counts,
                "right": right,
                "judged": judged,
                "beyond": len(beyond),
                "share": right / judged if judged else None,
                "share_within": wilson(right, judged) if judged else None,
                "wrong": counts["share"],
                "wrong_within": wilson(wrong, judged) if judged else None,
            }
        )
    return found


def _turned(row):
    """Whether the sentence on the outcome has one that overturns and one that does not: no row keeps the model's."""
    return any(words.count("overturns") == 1 for words in row["differences"] if words.startswith("the block "))


def judgements(result: Result) -> tuple[Judgement, ...]:
    marks = {}
    for row in tallies(result):
        if row["judged"]:
            level = "good" if row["share"] >= TRUSTED else "fair" if row["share"] >= 0.5 else "bad"
            words = f"{row['right']} of {row['judged']}"
            note = f"{row['differing'] - row['failed']} differ, {row['failed']} failed"
            note += f"; {left_out(row)}"
            marks[row["engine"], row["variant"]] = Mark(words, level, note, row["share"])
    return (Judgement("random scenes right", marks),)
