"""What is shown of a shake table: how often the outcome is predicted, by what, and how surely."""

import math
from collections.abc import Sequence
from itertools import count
from typing import Any

from ...measuring.statistics import EQUAL, TOO_FEW, wilson
from ...running.provenance import Result
from ...showing.charts import Axis
from ...showing.figures import as_it_comes, ranks
from ...showing.glance import Endings, Glance
from ...showing.parts import NAME, Column, Figure, Head, Judgement, Page, Table, grouped, number, percent, table, where
from ...showing.wording import equal_mark
from . import at_hand
from .campaign import outcomes_of
from .drawn import agreement, plane, reliabilities
from .judging import AS_IT_IS, AUTHORS, BEYOND, BY_RECORD, CURVE, FREQUENT, IN_SAMPLE, MODEL, ONE, THRESHOLD
from .measures import TABLE
from .runs import ALL, ANSWERS, counted
from .words import (
    apart,
    at_a_glance,
    bounds,
    how,
    more_right,
    name_of,
    near_boundaries,
    not_shown,
    sentence,
    title,
    together,
)

APART = 0.15  # between what was observed and what was predicted, of cells that are listed
FORECAST, CHANGE = Column("predicted by", "forecast"), Column("change of the model", "change")
SHARE = Column("right answers [%]", "share", percent=True, within="within")
SHARE_RIGHT = Column(
    "", lambda row: row["right"] / row["size"], percent=True, within=lambda row: (row["low"], row["high"])
)
RIGHT = Column("right", lambda row: f"{row['right']}, {SHARE_RIGHT.text(row)}")
ERRORS = Column("missed / false alarms", "{misses} / {false_alarms}")
BRIER = Column("Brier score [-]", "brier", 2, within="brier_interval")
BARS = (BEYOND, MODEL, CURVE, AUTHORS, THRESHOLD, "PGA, threshold", FREQUENT)  # besides the solvers


def page(result: Result) -> Page:
    if absent := where(result.rows, part="absent"):
        return Page("Shake table: not computed, the tests are not at hand", (f"{absent[0]['reason']}.",))
    engines, settings = engines_of(result), result.settings
    scores = where(result.rows, part="score")
    main = [row for row in where(scores, judged=BY_RECORD) if TABLE not in row["forecast"]]
    return Page(
        title(scores, settings),
        (sentence(result, engines),),
        first=(_bars(result, engines), _table_of_engines(result, engines)),
        more=(
            bounds(result),
            _right_of_engines(engines),
            Head("Each record held out in turn"),
            _scores("Share of right answers and Brier score (smaller is better), with 95 % intervals by record", main),
            Head("The probability"),
            reliabilities(where(result.rows, part="reliability")),
            _pairs(result),
            Head("Where the model is wrong"),
            plane(where(result.rows, part="cell"), at_hand.of(settings)),
            _quarters(result),
            _worst(result),
            _where(result),
            Head("What is fitted, and what is not known"),
            _fitted(result),
            agreement(settings["specimens"], _by_restitution(result)),
            _fits(result),
            _scores(
                "Judged otherwise, and by measures of the table’s own acceleration",
                [row for row in scores if row not in main],
            ),
            *not_shown(result),
        ),
        how=how(result),
        evidence=tuple(
            (f"{NAME.text(row)}, {row['specimen']}, test {row['test']}: {row['reason']}", row["message"])
            for row in where(result.rows, part="failure")
        ),
    )


def _by_specimen(caption: str, rows: Sequence[dict[str, Any]], names: Sequence[Column], *columns: Column) -> Table:
    """A line for rows that differ in their specimen alone, with these columns of each specimen."""
    specimens = list(dict.fromkeys(row["specimen"] for row in rows))
    lines = [{row["specimen"]: row for row in some} for some in grouped(rows, *(name.text for name in names)).values()]

    def of_first(column):
        return Column(column.head, lambda line: column.text(next(iter(line.values()))))

    def of_one(column, specimen):
        head = f"{specimen}: {column.head}" if len(specimens) > 1 else column.head
        return Column(head, lambda line: column.text(line[specimen]) if specimen in line else None)

    shown = [of_one(column, specimen) for specimen in specimens for column in columns]
    return table(caption, lines, *map(of_first, names), *shown)


def _scores(caption, rows):
    ways = {row["judged"] for row in rows}
    judged = (Column("judged on tests", "judged"),) if len(ways) > 1 else ()
    columns = (RIGHT, BRIER) if judged else (RIGHT, ERRORS, BRIER)
    return _by_specimen(caption, rows, (FORECAST, *judged), *columns)


def _pairs(result):
    rows = [row for some in grouped(where(result.rows, part="paired"), "forecast", "beside").values() for row in some]
    return table(
        "Paired: how many more answers of the first are right, and by how much its Brier score is smaller (a yes or no "
        "is a probability of 1 or 0), with 95 % intervals by record; and who is right where the two disagree",
        rows,
        FORECAST,
        Column("compared with", "beside"),
        Column("specimen", "specimen"),
        Column("more right", more_right),
        Column("Brier score smaller by [-]", "difference", within="interval"),
        Column("first right where they disagree", "{right} of {disagree}"),
    )


def judgements(result: Result) -> tuple[Judgement, ...]:
    """Whether an engine ends as the model does under a table's motions, by (engine, variant)."""
    marks = {(row["engine"], row["variant"]): equal_mark(tally_of(row)) for row in together(result)}
    heading = "outcomes that differ under shake-table motions, near outcome boundaries too"
    return (Judgement(heading, marks),) if marks else ()


def glance(result: Result) -> Glance:
    endings = tuple(_endings(row, result.settings["records"]) for row in together(result))
    told = {"real": at_a_glance(result), "near": near_boundaries(result)}
    return Glance(says={key: words for key, words in told.items() if words}, endings=endings)


def _endings(row, records):
    """Away from the model's outcome boundaries. Where runs near one differ too, it is not stored which way the others
    do; each record is taken to have runs away from them."""
    runs, differing = row["size"] - row["near"], apart(row) - row["on_edge"]
    hidden, groups = row["on_edge"] > 0, min(records, runs)
    return Endings(
        "shake-table motions",
        row["engine"],
        row["variant"],
        row["tier"],
        runs,
        failed=0 if hidden else row["failed"],
        missed=0 if hidden else row["only_a"],
        added=0 if hidden else row["only_b"],
        other=0,
        interval=wilson(differing / runs * groups, groups) if runs else (0.0, 1.0),
        untold=differing if hidden else 0,
        left_out=row["near"],
        left_differing=row["on_edge"],
    )


def tally_of(row: dict[str, Any]) -> dict[str, Any]:
    """The row of an engine as `wording.equal_mark` reads it."""
    said = {"runs": row["size"], "differing": apart(row), "share": apart(row) / row["size"]}
    return said | {key: row[key] for key in ("failed", "equal", "interval")}


def engines_of(result: Result) -> list[dict[str, Any]]:
    """The rows of engines; with the campaign at hand their right answers are counted where they are not told."""
    rows, here = where(result.rows, part="engine"), at_hand.of(result.settings)
    if here is None:
        return rows
    names = [one["name"] for one in result.settings["specimens"]]
    records, found = [test.record for test in here.campaign.tests], []
    for row in rows:
        if row["specimen"] != ALL and row["right"] is None:
            runs = where(result.rows, part="run", specimen=row["specimen"])
            (own,) = where(runs, engine=row["engine"], variant=row["variant"])
            measured = outcomes_of(here.campaign.tests, names.index(row["specimen"]))
            said = counted(own["outcomes"], runs[0]["outcomes"], measured, records)
            row = row | {key: said[key] for key in ANSWERS}
        found.append(row)
    return found


def _score(rows, **wanted):
    return next(iter(where(rows, **wanted)), None)


def _bars(result: Result, engines: Sequence[dict[str, Any]]) -> Figure | None:
    scores, rows = where(result.rows, part="score"), []
    for one in result.settings["specimens"]:
        mine = where(scores, specimen=one["name"])
        for name in BARS:
            if (row := _score(mine, forecast=name, judged=BY_RECORD)) is not None:
                rows.append(_bar(row, name, row["right"], (row["low"], row["high"])))
        same = _score(mine, forecast=ONE, judged=IN_SAMPLE)
        rows.append(_bar(same, "model, as engines", same["right"], (same["low"], same["high"])))
        for row in where(engines, specimen=one["name"]):
            failed = f" ({row['failed']} failed)" if row["failed"] else ""
            rows.append(_bar(row, name_of(row) + failed, *_between(row, same)))
    hidden = (
        " Where an engine differs from the model in fewer than five tests, its right answers are not given: the line "
        "spans what is possible."
    ) * any(row["right"] is None for row in engines)
    agree = result.settings["agree"]
    rules = () if agree is None else ((agree / len(result.settings["tests"]), "the other boulder"),)
    first = min(math.floor(10 * min(low for row in rows for low in row["within"])), 9)  # tenths
    marked = range(first, 11, 1 if first >= 5 else 2)
    return ranks(
        rows,
        Column("predicted by", "name"),
        SHARE,
        "Share of outcomes predicted, with 95 % intervals by record. “model, as engines” and the engines use one "
        f"slenderness, fitted to all tests; the rest are held out by record. A failed run is not right.{hidden}",
        Axis(SHARE.head, first / 10, 1.0, ticks=tuple((tenth / 10, str(10 * tenth)) for tenth in marked)),
        panel="specimen",
        rules=rules,
        opened=as_it_comes,
    )


def _bar(row, name, right, within):
    kept = {key: row.get(key) for key in ("engine", "specimen", "tier")}
    return {**kept, "name": name, "share": right / row["size"], "within": within}


def _between(row, model):
    """Right answers of an engine, with their interval; where they are not told, with those that are possible."""
    if row["right"] is not None:
        return row["right"], (row["low"], row["high"])
    ends = (model["right"] - apart(row), model["right"] + apart(row))
    return model["right"], (max(ends[0], 0) / row["size"], min(ends[1], row["size"]) / row["size"])


def _table_of_engines(result, engines):
    judged = wilson(0, result.settings["records"])[1] < EQUAL  # else no engine can be equal, whatever it does
    equal = Column("equal", lambda row: "inconclusive" if row["equal"] == TOO_FEW else row["equal"])
    return table(
        "Engines and the model at the same slenderness. At most: the upper end of the 95 % interval (Wilson, by "
        f"record). {'Equal: at most 5 %. ' if judged else ''}In brackets: records in which most differences go "
        "that way. Last column: differences among the runs in which a change of the scene by 10⁻⁴ changes the model’s "
        "own outcome or time of a fall",
        where(engines, specimen=ALL) or engines,
        NAME,
        Column("kind", "tier"),
        Column("outcomes that differ", lambda row: f"{apart(row)} of {row['size']}"),
        Column("at most", lambda row: row["interval"][1], percent=True),
        *([equal] if judged else ()),
        Column("overturnings missed", "{only_a} ({records_a})"),
        Column("added", "{only_b} ({records_b})"),
        Column("p, sign test by record", "p_records"),
        Column("failed", "failed"),
        Column("the model’s own end is sensitive", "{on_edge} of {near}"),
    )


def _right_of_engines(engines):
    return _by_specimen(
        "Engines and the model at the same slenderness, beside what was measured; peak tilt: median over the tests in "
        "which both rock and stay upright",
        [row for row in engines if row["specimen"] != ALL],
        (NAME,),
        Column("outcomes that differ", lambda row: f"{apart(row)} of {row['size']}"),
        Column("right", "right"),
        Column("model right", "model_right"),
        ERRORS,
        Column("peak tilt over the model’s", "tilt", 3),
    )


OBSERVED = Column("overturned", lambda row: row["overturned"] / row["size"], percent=True)
PREDICTED = Column("predicted", "mean", percent=True)


def _quarters(result):
    rows = [row | {"quarter": f"{place}"} for row, place in _numbered(where(result.rows, part="quarter"))]
    return _by_specimen(
        "Quarters of the tests by PGV/PGA, the model held out by record",
        rows,
        (Column("quarter", "quarter"), Column("PGV/PGA [s], mean", "ratio"), Column("tests", "size")),
        OBSERVED,
        PREDICTED,
    )


def _numbered(rows):
    """(row, its number among those of its specimen)."""
    return [pair for members in grouped(rows, "specimen").values() for pair in zip(members, count(1), strict=False)]


def _worst(result):
    """The cells in which the model errs most."""

    def error(row):
        return abs(row["overturned"] / row["size"] - row["mean"])

    cells = [row for row in where(result.rows, part="cell") if error(row) > APART]
    cells.sort(key=error, reverse=True)
    return table(
        f"Cells of the figure whose shares, observed and predicted, are more than {percent(APART)} apart",
        cells,
        Column("specimen", "specimen"),
        Column("PGA [g]", "pga"),
        Column("PGV/PGA [s]", "ratio"),
        Column("tests", "size"),
        OBSERVED,
        PREDICTED,
    )


def _where(result):
    rows = where(result.rows, part="where")
    names = (Column("among the tests in which", "among"), FORECAST)
    return _by_specimen("Right answers among some of the tests", rows, names, Column("right", "{right} of {size}"))


def _fitted(result):
    said = []
    for row in where(result.rows, part="fit", change=AS_IT_IS):
        angles = [number(math.degrees(row[name]), 2) for name in ("slenderness", "centre", "spread")]
        (one,) = (each for each in result.settings["specimens"] if each["name"] == row["specimen"])
        said.append(
            f"{row['specimen']}: {angles[0]} deg by itself, {angles[1]} deg with a spread of {angles[2]} deg "
            f"({one['note']})."
        )
    return (
        "The one exception to the rule that no constant is fitted, as nobody knows on which points a block stands. "
        "Slenderness that fits all tests best: " + " ".join(said)
    )


def _by_restitution(result):
    """{kind of model: right answers by specimen and slenderness}, of every other factor on the restitution."""
    names = [kind for kind in result.settings["kinds"] if kind == AS_IT_IS or kind.startswith("restitution")][::2]
    return {name: result.arrays[f"right/{name}"] for name in names}


def _degrees(name):
    return lambda row: math.degrees(row[name])


def _fits(result):
    return _by_specimen(
        "The model with one thing changed. Slenderness by itself, and mean and spread, fitted to all tests; right "
        "answers and Brier score held out by record",
        where(result.rows, part="fit"),
        (CHANGE,),
        Column("slenderness [deg]", _degrees("slenderness")),
        Column("mean, spread [deg]", lambda row: [math.degrees(row["centre"]), math.degrees(row["spread"])]),
        Column("right", "right"),
        BRIER,
    )
