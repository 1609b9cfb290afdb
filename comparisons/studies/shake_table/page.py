"""What is shown of a shake table: how often the outcome is foretold, by what, and how sure of itself."""

import math
from collections.abc import Sequence
from typing import Any

from ...measuring.statistics import TOO_FEW
from ...running.provenance import Result
from ...showing.charts import Axis
from ...showing.figures import ranks
from ...showing.parts import NAME, Column, Figure, Head, Judgement, Page, number, short, table, where
from ...showing.wording import equal_mark, listed
from . import at_hand
from .campaign import outcomes_of
from .drawn import agreement, plane, reliabilities
from .judging import AS_IT_IS, AUTHORS, BY_RECORD, IN_SAMPLE, MODEL, ONE, PGV
from .runs import ALL, ANSWERS, counted

SHARES = (0.5, 1.0)  # between which shares of right answers are drawn
BARS = (MODEL, AUTHORS, "PGA and PGV, logistic", PGV, "PGV, threshold", "PGA, threshold")  # besides the solvers
SPECIMEN, FORECAST = Column("specimen", "specimen"), Column("foretold by", "forecast")
RIGHT = Column("right", lambda row: None if row["right"] is None else f"{row['right']} of {row['size']}")
SHARE = Column("right answers [%]", "share", percent=True, within="within")
BRIER = Column("Brier score [-]", "brier", 2, within="brier_interval")
CHANGE = Column("change of the model", "change")


def page(result: Result) -> Page:
    if absent := where(result.rows, part="absent"):
        return Page("Shake table: not computed, the tests are not at hand", (f"{absent[0]['reason']}.",))
    engines, settings = engines_of(result), result.settings
    scores = where(result.rows, part="score")
    return Page(
        _title(scores, settings),
        (_sentence(result, engines), _bounds(result)),
        first=(_bars(result, engines), _table_of_engines(engines)),
        more=(
            Head("On tests that nothing was fitted to"),
            _scores(
                "Each record held out in turn: right answers with the 95 % interval of their share, and Brier scores "
                "(smaller is better) with theirs",
                where(scores, judged=BY_RECORD),
            ),
            Head("As a probability"),
            reliabilities(where(result.rows, part="reliability")),
            table(
                "By how much the Brier score is smaller, paired, with its 95 % interval by record; and who is right "
                "where the two disagree",
                where(result.rows, part="paired"),
                FORECAST,
                Column("beside", "beside"),
                SPECIMEN,
                Column("smaller by [-]", "difference", within="interval"),
                Column("disagree in", "disagree"),
                Column("the first is right in", "right"),
            ),
            *_where_alike(result),
            Head("Where it is wrong"),
            plane(where(result.rows, part="cell"), at_hand.of(settings)),
            Head("What is fitted, and what is not known"),
            _fitted(result),
            agreement(settings["specimens"], _by_restitution(result)),
            _fits(result),
            _scores("Judged otherwise", [row for row in scores if row["judged"] != BY_RECORD]),
            _not_shown(result),
        ),
        how=_how(result),
        evidence=tuple(
            (f"{NAME.text(row)}, {row['specimen']}, test {row['test']}: {row['reason']}", row["message"])
            for row in where(result.rows, part="failure")
        ),
    )


def _scores(caption, rows):
    ways = {row["judged"] for row in rows}
    return table(
        caption,
        rows,
        FORECAST,
        SPECIMEN,
        *((Column("judged on tests", "judged"),) if len(ways) > 1 else ()),
        RIGHT,
        Column("share", _share, percent=True, within=lambda row: (row["low"], row["high"])),
        Column("misses", "misses"),
        Column("false alarms", "false_alarms"),
        BRIER,
    )


def judgements(result: Result) -> tuple[Judgement, ...]:
    """Whether an engine ends as the model does under a table's motions, by (engine, variant)."""
    rows = where(result.rows, part="engine")
    alone = len({row["specimen"] for row in rows}) == 1
    marks = {
        (row["engine"], row["variant"]): equal_mark(tally_of(row)) for row in rows if row["specimen"] == ALL or alone
    }
    return (Judgement("outcomes that differ under motions of a shake table", marks),) if marks else ()


def tally_of(row: dict[str, Any]) -> dict[str, Any]:
    """The row of an engine as `wording.equal_mark` reads it."""
    differing = row["only_a"] + row["only_b"] + row["failed"]
    said = {"runs": row["size"], "differing": differing, "share": differing / row["size"]}
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


def _share(row):
    return row["right"] / row["size"]


def _score(rows, **wanted):
    return next(iter(where(rows, **wanted)), None)


def _title(scores, settings):
    def right(name):
        rows = where(scores, forecast=name, judged=BY_RECORD)
        return listed([str(row["right"]) for row in rows])

    return (
        f"Shake table: of {len(settings['tests'])} outcomes the model foretells {right(MODEL)}, "
        f"a threshold of PGV {right('PGV, threshold')}"
    )


def _sentence(result, engines):
    """How large the error of engines is beside that of the model."""
    scores = where(result.rows, part="score", judged=BY_RECORD, forecast=MODEL)
    wrong = listed([str(row["size"] - row["right"]) for row in scores])
    words = [f"The model itself is wrong in {wrong} of {len(result.settings['tests'])} tests."]
    together = where(engines, specimen=ALL) or engines
    for kind, told in (("tuned", "Tuned"), ("defaults", "With their defaults")):
        rows = where(together, tier=kind)
        said = [
            f"{row['engine']} ends otherwise than the model in {_apart(row)} of {row['size']} runs, "
            f"{row['on_edge']} of them near an outcome boundary"
            for row in rows
        ]
        if said:
            words.append(f"{told}, {listed(said)}.")
    one_way = [row for row in where(together, tier="defaults") if row["p_records"] is not None]
    unsafe = [row for row in one_way if row["only_a"] > row["only_b"] and row["p_records"] < 0.05]
    if unsafe:
        said = [
            f"{row['engine']} misses {row['only_a']} overturnings and adds {row['only_b']} "
            f"(sign test by record, p = {number(row['p_records'], 2)})"
            for row in unsafe
        ]
        words.append(f"Defaults err on the unsafe side: {listed(said)}.")
    return " ".join(words)


def _apart(row):
    return row["only_a"] + row["only_b"] + row["failed"]


def _bounds(result):
    """What a model can be asked for at most."""
    settings = result.settings
    names = listed([one["name"] for one in settings["specimens"]])
    words = f"{settings['campaign'].capitalize()}, {len(settings['tests'])} tests under {settings['records']} records"
    words += f" at many scales; {listed([str(count) for count in settings['overturned']])} overturned ({names})."
    if settings["agree"] is not None:
        words += (
            f" The two end alike in {settings['agree']} of them. No test of one was repeated: of two blocks that "
            "differ a little, that is the nearest to a repeatability that is known, and no model can be asked for very "
            "much more."
        )
    return words + (
        " The model is planar, the block is not; one number of it is fitted, the slenderness, with its spread, and "
        "judged on records that it was not fitted to."
    )


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
            rows.append(_bar(row, NAME.text(row), *_between(row, same)))
    agree = result.settings["agree"]
    rules = () if agree is None else ((agree / len(result.settings["tests"]), "the two boulders alike"),)
    return ranks(
        rows,
        Column("foretold by", "name"),
        SHARE,
        "Share of outcomes foretold, with 95 % intervals by record. “model, as engines” and the engines: one "
        "slenderness, fitted to all tests. Where an engine differs in fewer than five tests, its right answers are "
        "told as between those that this leaves.",
        Axis(SHARE.head, *SHARES, ticks=tuple((share / 100, str(share)) for share in range(50, 101, 10))),
        panel="specimen",
        rules=rules,
    )


def _bar(row, name, right, within):
    share = right / row["size"]
    return {"engine": row["engine"], "specimen": row["specimen"], "name": name, "share": share, "within": within}


def _between(row, model):
    """Right answers of an engine, with their interval; where they are not told, with those that are possible."""
    if row["right"] is not None:
        return row["right"], (row["low"], row["high"])
    ends = (model["right"] - _apart(row), model["right"] + _apart(row))
    return model["right"], (max(ends[0], 0) / row["size"], min(ends[1], row["size"]) / row["size"])


def _table_of_engines(engines):
    return table(
        "Engines beside the model at the same slenderness; equal: at most 5 % of outcomes differ, by the upper limit "
        "of the interval (95 %, Wilson, by record); tests that overturn in one alone, in brackets records by most of "
        "theirs",
        engines,
        NAME,
        Column("kind", "tier"),
        SPECIMEN,
        Column("outcomes that differ", lambda row: f"{_apart(row)} of {row['size']}"),
        Column("of these near an outcome boundary", "on_edge"),
        Column("up to", lambda row: row["interval"][1], percent=True),
        Column("equal", lambda row: "inconclusive" if row["equal"] == TOO_FEW else row["equal"]),
        Column("only the model’s overturns", "{only_a} ({records_a})"),
        Column("only the engine’s", "{only_b} ({records_b})"),
        Column("p, by test", "p_value"),
        Column("p, by record", "p_records"),
        Column("failed", "failed"),
        RIGHT,
        Column("model right", "model_right"),
        Column("misses", "misses"),
        Column("false alarms", "false_alarms"),
        Column("peak tilt over the model’s", "tilt"),
    )


def _where_alike(result):
    rows = where(result.rows, part="where")
    return (table("Where the two boulders end alike", rows, FORECAST, SPECIMEN, RIGHT),) if rows else ()


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
        "The one exception to the rule that no constant is fitted, as nobody knows on which points a boulder stands. "
        "Slenderness that fits all tests best: " + " ".join(said)
    )


def _by_restitution(result):
    """{kind of model: right answers by specimen and slenderness}, of those that differ in the restitution alone."""
    names = [kind for kind in result.settings["kinds"] if kind == AS_IT_IS or kind.startswith("restitution")]
    return {name: result.arrays[f"right/{name}"] for name in names}


def _degrees(name):
    return lambda row: math.degrees(row[name])


def _fits(result):
    return table(
        "The model with one thing changed; right answers and Brier score held out by record",
        where(result.rows, part="fit"),
        CHANGE,
        SPECIMEN,
        *(
            Column(f"{head} [deg]", _degrees(name))
            for head, name in (("slenderness", "slenderness"), ("mean", "centre"), ("spread", "spread"))
        ),
        Column("right by itself, same tests", "alone_right"),
        RIGHT,
        BRIER,
    )


def _not_shown(result):
    pairs = where(result.rows, part="paired", beside=PGV)
    sure = [row["specimen"] for row in pairs if row["interval"][0] > 0]
    better = f"the difference is above 0 for {listed(sure)}" if sure else "for no specimen the difference is above 0"
    return (
        "What this does not show: it is one campaign, of one kind of stone, on one axis; boulders of another size or "
        "slenderness may do otherwise. A threshold of PGV has nearly as many right answers: what the model knows more "
        f"shows in its probability alone, and {better} with 95 %. Records repeat at many scales; intervals go by record"
        " and say nothing of records unlike these. Restitution and friction of granite on the table were not measured; "
        "the table above says what they move."
    )


def _how(result: Result) -> tuple[str, ...]:
    s = result.settings
    steps = listed([f"{round(1 / step):g} Hz" for step in s["steps"]])
    blocks = "; ".join(
        f"{one['name']}: centre of mass {one['height']:.3g} m up, radius of gyration {one['gyration']:.3g} m"
        for one in s["specimens"]
    )
    speed = f"{s['model_runs']:,} runs of the model took {short(s['model_seconds'])} s of CPU time"
    return tuple(
        filter(
            None,
            (
                f"Data: {s['cite']}. Nothing of them is stored here but sums and cells of five tests or more; "
                "rocking study shake-table --data FOLDER draws every test."
                if s["cite"]
                else "",
                f"Motions as the table moved, at {steps}, as published less the median of the first second; "
                f"{s['missing']} further tests have no motion at hand and are left out. Rigid planar block on rigid "
                f"ground; {blocks}. Moment of inertia: of the two horizontal axes of the meshes the mean. {speed}.",
                "Said before the results: right answers, misses and false alarms; intervals by bootstrap over records "
                f"(seed {result.provenance['seed']}); the sign of engines’ differences; Brier scores and their paired "
                "difference to PGV’s; reliability in cells of five tests or more; who is right where model and PGV "
                "disagree. Each record is held out in turn. PGA and PGV: as the campaign states them of what the table "
                "was to play; “of the table”: of its measured acceleration, whose noise the integral gathers.",
                f"Engines in question run all tests, the others one in {s['others']}, at the slenderness that is right "
                "most often in the model. A failed run is not right, and differs.",
            ),
        )
    )
