"""The page of the shake-table study: how often outcomes are predicted, by what, and how surely."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from ...execution.results import Result
from ...metrics.statistics import EQUAL, TOO_FEW, wilson
from ...plotting.charts import Axis, Chart, curve, figure, key_of
from ...plotting.figures import SUBJECTS, as_it_comes, ranks, subject
from ...plotting.glance import Endings, Glance
from ...plotting.parts import Figure, Head, Judgement, Page, Table, grouped, table, where
from ...plotting.wording import equal_mark, listed, with_counts
from ...schemas.columns import NAME, Column, number, percent, short
from .campaign import ALL, CORNER, TABLE
from .judging import AS_IT_IS, AUTHORS, BEYOND, BY_RECORD, CURVE, EACH, FREQUENT, IN_SAMPLE, MODEL, ONE, THRESHOLD
from .study import COLUMNS


def agreement(specimens: Sequence[dict[str, Any]], right: dict[str, np.ndarray]) -> Figure | None:
    """Figure of right answers over the slenderness, a line for each restitution.

    right: {kind of model: numbers by specimen and slenderness}.
    """
    looks = {name: curve(place) for place, name in enumerate(right)}
    low, high = (float(find([find(counts) for counts in right.values()])) for find in (np.min, np.max))
    charts = []
    for k, specimen in enumerate(specimens):
        angles = np.degrees(specimen["grid"])
        chart = Chart(
            Axis("slenderness [deg]", float(angles[0]), float(angles[-1])),
            Axis("right answers", 0.98 * low, max(1.02 * high, 1.0)),
            f"{specimen['name']}: right answers of the model over the slenderness; {', '.join(right)}.",
            title=specimen["name"],
            height=300,
        )
        for name, look in looks.items():
            chart.line(angles, right[name][k], name, look=look)
        charts.append(chart)
    keys = {name: key_of(name, look=look) for name, look in looks.items()}
    caption = (
        "Right answers of the model over its slenderness, with its own restitution and with that times a factor. They "
        "are sums over all tests; nothing is fitted."
    )
    return figure(charts, caption, keys, keys) if charts else None


def title(scores: Sequence[dict[str, Any]], settings: dict[str, Any]) -> str:
    """Title of the page: the model's right answers beside those of a threshold."""

    def right(name):
        return listed([str(row["right"]) for row in where(scores, forecast=name, judged=BY_RECORD)])

    count = len(settings["tests"])
    return f"Shake table: the model predicts {right(MODEL)} of {count} outcomes, a PGV threshold {right(THRESHOLD)}"


def sentence(result: Result, engines: Sequence[dict[str, Any]]) -> str:
    """Return sentences on the errors of engines beside those of the model."""
    scores = where(result.rows, part="score", judged=BY_RECORD, forecast=MODEL)
    wrong = listed([str(row["size"] - row["right"]) for row in scores])
    names = listed([row["specimen"] for row in scores])
    words = [f"The model is wrong in {wrong} of {len(result.settings['tests'])} tests ({names})."]
    engine_rows = of_all(engines)
    if tuned := where(engine_rows, tier="tuned"):
        counts = [f"{apart(row)} of {row['size']} ({row['engine']})" for row in tuned]
        fits = [count for row in where(result.rows, part="fit", change=AS_IT_IS) for count in row["neighbours"]]
        first, second, *_ = result.settings["specimens"][0]["grid"]
        words.append(
            f"Tuned engines differ from the model in {listed(counts)} runs. In the model itself, a slenderness "
            f"{number(math.degrees(second - first), 1)} deg smaller or larger changes {min(fits)} to {max(fits)} of "
            f"{len(result.settings['tests'])} outcomes."
        )
    if unsafe := [row for row in where(engine_rows, tier="defaults") if _unsafe(row)]:
        chances = listed([f"{number(row['p_records'], 2)} in {row['engine']}" for row in unsafe])
        words.append(
            "With defaults, engines err on the unsafe side: they miss more overturnings than they add (sign test by "
            f"record: p = {chances})."
        )
    return " ".join(words)


def at_a_glance(result: Result) -> tuple[str, str]:
    """Return how often the model and simpler forecasts are right about real blocks; "" where they were not judged.

    Further sentences: whether the model is better, and engines that are fitted with it by one rule.
    """
    specimens = [specimen["name"] for specimen in result.settings["specimens"]]
    held = where(result.rows, part="score", judged=BY_RECORD)
    if not (model := where(held, forecast=MODEL)):
        return "", ""
    size, records = sum(row["size"] for row in model), result.settings["records"]
    missing = result.settings["missing"]["tests"]
    rivals = {CURVE: "a curve in PGA and PGV", THRESHOLD: "a threshold of PGV", FREQUENT: FREQUENT}
    rivals_right = [f"{words} in {_right_in_words(where(held, forecast=name))}" for name, words in rivals.items()]
    better = [
        _beside(pair, words)
        for name, words in ((CURVE, "the curve"), (THRESHOLD, "the threshold"))
        for pair in of_all(where(result.rows, part="paired", forecast=MODEL, beside=name))[-1:]
    ]
    answer = (
        f"on records held out of its fit, the model is right in {_right_in_words(model)} of {size} shake-table tests "
        f"({listed(specimens)}); {listed(rivals_right)}."
    )
    if better:
        answer += f" It is {'; it is '.join(better)}."
    same_rule = where(result.rows, part="score", judged=IN_SAMPLE, forecast=ONE)
    engines = grouped(where(result.rows, part="engine", specimen=set(specimens)), "engine", "variant").values()
    fitted = [
        f"{name_of(rows[0])} in {with_counts(_right_in_words(rows), {'failed': sum(row['failed'] for row in rows)})}"
        for rows in engines
    ]
    return answer, " ".join(
        (
            f"By another fit, not held out (one slenderness for each block, from all of its tests): model in "
            f"{_right_in_words(same_rule)}; {'; '.join(fitted)}.",
            f"The tests share {records} records; intervals are by record.",
            "The blocks stood on the table itself: no test validates bearings.",
            *([f"{missing} tests of each block are left out, as their motions are not at hand."] if missing else ()),
        )
    )


def _right_in_words(rows):
    """Right answers of all specimens together, and their share; "–" where one is not disclosed."""
    right, size = [row["right"] for row in rows], sum(row["size"] for row in rows)
    return "–" if None in right or not size else f"{sum(right)} ({percent(sum(right) / size, 2)})"


def of_all(rows: Sequence[dict[str, Any]]) -> Sequence[dict[str, Any]]:
    """Return the rows of all specimens together, or of the only one."""
    return where(rows, specimen=ALL) or rows


def _beside(pair, words):
    """Clause on whether the model is shown to be better than another forecast."""
    low, high = pair["more_interval"]
    verdict = "shown to be better" if low > 0 else "shown to be worse" if high < 0 else "not shown to be better"
    more = f"{pair['more_right']} more, 95 % interval {low:.0f} to {high:.0f}".replace("-", "−")
    return f"{verdict} than {words} ({more})"


def together(result: Result) -> Sequence[dict[str, Any]]:
    """Return the rows of engines for all specimens together."""
    return of_all(where(result.rows, part="engine"))


def near_boundaries(result: Result) -> str:
    """Return a sentence on the outcomes that tuned engines change, and on how many are near an outcome boundary.

    It is "" without tuned engines.
    """
    rows = where(together(result), tier="tuned")
    missed, added, failed, size, near = (
        sum(row[key] for row in rows) for key in ("only_a", "only_b", "failed", "size", "near")
    )
    on_edge = sum(map(apart_near, rows))
    if not rows:
        return ""
    return (
        f"Runs near an outcome boundary included, tuned engines miss {missed} overturnings, add {added} and fail "
        f"{failed} times in {size} runs. Of these {missed + added + failed} runs, {on_edge} are among the {near} near "
        "a boundary."
    )


def _unsafe(row):
    """Return whether an engine misses significantly more overturnings than it adds."""
    return row["only_a"] > row["only_b"] and row["p_records"] is not None and row["p_records"] < 0.05


def apart(row: dict[str, Any]) -> int:
    """Return the number of runs that an engine ends differently from the model, failed ones included."""
    return row["only_a"] + row["only_b"] + row["failed"]


def apart_near(row: dict[str, Any]) -> int:
    """Return the number of these that are near an outcome boundary of the model."""
    return row["near_missed"] + row["near_added"] + row["near_failed"]


def name_of(row: dict[str, Any]) -> str:
    """Return an engine's name with the kind of its variant."""
    return f"{row['engine']}, {row['tier']}"


def bounds(result: Result) -> str:
    """Return sentences on the most that can be expected of a model."""
    settings = result.settings
    names = listed([specimen["name"] for specimen in settings["specimens"]])
    count = len(settings["tests"])
    words = (
        f"{settings['campaign'].capitalize()}: {count} tests under {settings['records']} records at many scales; "
        f"{listed([str(specimen) for specimen in settings['overturned']])} ended in overturning ({names})."
    )
    thresholds = where(result.rows, part="score", forecast=EACH)
    model = where(result.rows, part="score", forecast=MODEL, judged=BY_RECORD)
    words += (
        " A PGA threshold of its own for each record, fitted to the same tests, is right in "
        f"{listed([str(row['right']) for row in thresholds])}"
    )
    not_by_chance = all(
        2 * (specimen["size"] - specimen["right"]) < row["size"] - row["right"]
        for specimen, row in zip(thresholds, model, strict=True)
    )
    words += ". Most of the model’s errors are therefore its own, not chance." if not_by_chance else "."
    if settings["agree"] is not None:
        words += f" The two blocks, which differ in shape, have the same outcome in {settings['agree']} tests."
    return words + (
        " The model is planar; the block is not. The mean and the spread of the model’s slenderness are fitted, and "
        "the model is judged on records not used in the fit."
    )


def more_right(row: dict[str, Any]) -> str:
    """Return in how many more tests the first of a pair of forecasts is right, with the interval, in words."""
    low, high = row["more_interval"]
    return f"{row['more_right']} ({low:.0f} to {high:.0f})".replace("-", "−")


def not_shown(result: Result) -> tuple[str, str]:
    """Return two paragraphs: what the figures show, and what they do not show."""
    pairs = {(row["specimen"], row["beside"]): row for row in where(result.rows, part="paired", forecast=MODEL)}
    last = list(dict.fromkeys(name for name, _ in pairs))[-1]  # all specimens together, if there are several

    runs = len(result.settings["tests"]) * len(result.settings["specimens"])
    boulders = bool(result.settings["cite"])  # the published campaign; nothing more is known of one's own
    slopes = " with five slopes, which was added when a referee asked for it" if boulders else " with five slopes"
    stone = (
        ", with one kind of stone, shaken along one axis. The model’s block is symmetric. A boulder has a different "
        "slenderness to either side, stands on three points, and may twist, walk and wear. The spread of the "
        "slenderness stands for all of this. It was introduced after a prototype on the same tests, so no test is "
        "untouched by that choice."
    )
    granite = " Restitution and friction of granite on the table were not measured." if boulders else ""
    return (
        f"What this shows: of {runs} outcomes the model predicts {more_right(pairs[last, THRESHOLD])} more than a "
        f"threshold of PGV, and {more_right(pairs[last, CURVE])} more than a curve in PGA and PGV{slopes}. The curve "
        "is valid for these blocks alone. A table above compares the curve joined with the model to the curve alone.",
        f"What it does not show: it is one campaign{stone if boulders else '.'} Outcomes cannot separate slenderness "
        "from restitution: the fitted slenderness stands for all that the model lacks. The intervals count records "
        "and hold the fits fixed. They are not adjusted for the number of comparisons, and say nothing about records "
        "unlike these. The engines run with the slenderness at which the model is right most often, which favours the "
        f"model over them.{granite}",
    )


def _left_out(settings):
    """Sentence on the tests without a motion: whether they are like the others."""
    missing, names = settings["missing"], listed([item["name"] for item in settings["specimens"]])
    if not missing["tests"]:
        return ""
    words = f"{missing['tests']} tests of each block are left out because their motion is not at hand. "
    if missing["overturned"]:
        count = len(settings["tests"])
        shares = [percent(item / missing["tests"]) for item in missing["overturned"]]
        others = [percent(item / count) for item in settings["overturned"]]
        words += (
            f"Of these tests {listed(shares)} ended in overturning ({names}), of the tests that are used "
            f"{listed(others)}. "
        )
    if missing["ratios"]:
        first, second = (number(ratio, 2) for ratio in missing["ratios"])
        words += f"The mean PGV/PGA is {first} s in the tests left out and {second} s in the others. "
    return words


def how(result: Result) -> tuple[str, ...]:
    """Return paragraphs on the data, the motions and the statistics."""
    settings = result.settings
    steps = listed([f"{round(1 / step):g} Hz" for step in settings["steps"]])
    blocks = "; ".join(
        f"{specimen['name']}: centre of mass {specimen['height']:.3g} m up, "
        f"radius of gyration {specimen['gyration']:.3g} m"
        for specimen in settings["specimens"]
    )
    resampled = settings["published"] and any(
        abs(1 / step / settings["published"] - 1) > 1e-3 for step in settings["steps"]
    )
    published = (
        f" (published at {settings['published']:g} Hz; resampled by the makers of these files)" if resampled else ""
    )
    speed = f"{settings['model_runs']:,} runs of the model took {short(settings['cpu_seconds'])} s of CPU time"
    rigid = f"{_left_out(settings)}The model is a rigid planar block on rigid ground; {blocks}."
    intervals = (
        f"Intervals are percentiles of a bootstrap over records (seed {result.provenance['seed']}). With “fitted to "
        "every other test”, tests under one record may be in the fit and among those judged."
    )
    others = ""
    if not all(map(subject, where(result.rows, part="engine"))):
        others = f", one in {settings['others']} in other engines"
    runs = (
        f"All tests are run in {SUBJECTS}{others}, with the slenderness at which the model is right most often. A "
        "failed run counts as wrong and as differing."
    )
    if not settings["cite"]:
        return (
            f"Motions: as in their files, at {steps}. {rigid} {speed}.",
            f"{intervals} PGA and PGV are those of these motions; PGV is taken above {CORNER} Hz.",
            runs,
        )
    return (
        f"Data: {settings['cite']}. Only sums over at least five tests are stored or shown.",
        f"Motions: the measured acceleration of the table at {steps}{published}, minus the median of its first second. "
        f"{rigid} The moment of inertia is the mean of those about the two horizontal axes of the mesh. {speed}.",
        f"{intervals} PGA and PGV are those that the campaign states for the motion sent to the table; “of the table” "
        f"means values of its measured acceleration above {CORNER} Hz. “The other specimen” predicts the outcome that "
        "the other boulder had under the same motion. Of the authors’ settings for discrete elements, the one is taken "
        "that is right most often on the records of the fit; none was fitted to these outcomes as the slenderness is.",
        runs,
    )


FORECAST, CHANGE = COLUMNS["forecast"], COLUMNS["change"]
SHARE = Column("right answers [%]", "share", percent=True, within="within")
SHARE_RIGHT = Column(
    "", lambda row: row["right"] / row["size"], percent=True, within=lambda row: (row["low"], row["high"])
)
RIGHT = Column("right", lambda row: f"{row['right']}, {SHARE_RIGHT.text(row)}")
ERRORS = Column("missed / false alarms", "{misses} / {false_alarms}")
BRIER = COLUMNS["brier"]
BARS = (BEYOND, MODEL, CURVE, AUTHORS, THRESHOLD, "PGA, threshold", FREQUENT)  # forecasts shown beside the solvers


def page(result: Result) -> Page:
    """Return the page of a result."""
    if absent := where(result.rows, part="absent"):
        return Page("Shake table: not computed, the tests are not at hand", (f"{absent[0]['reason']}.",))
    engines, settings = where(result.rows, part="engine"), result.settings
    scores = where(result.rows, part="score")
    main = [row for row in where(scores, judged=BY_RECORD) if TABLE not in row["forecast"]]
    return Page(
        title(scores, settings),
        (" ".join(filter(None, (sentence(result, engines), near_boundaries(result)))),),
        first=(_bars(result, engines), _table_of_engines(result, engines)),
        more=(
            bounds(result),
            _right_of_engines(engines),
            Head("Each record held out of the fit in turn"),
            _scores("Share of right answers and Brier score (smaller is better), with 95 % intervals by record", main),
            Head("Compared in pairs"),
            _pairs(result),
            Head("What is fitted, and what is not known"),
            _fitted(result),
            agreement(settings["specimens"], _by_restitution(result)),
            _fits(result),
            _scores(
                "The same predictions judged on other tests, and predictions from the table’s measured acceleration",
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
    """Table with one line for rows that differ only in their specimen, and these columns for each specimen."""
    specimens = list(dict.fromkeys(row["specimen"] for row in rows))
    lines = [
        {row["specimen"]: row for row in members} for members in grouped(rows, *(name.text for name in names)).values()
    ]

    def of_first(column):
        return Column(column.head, lambda line: column.text(next(iter(line.values()))))

    def of_one(column, specimen):
        head = f"{specimen}: {column.head}" if len(specimens) > 1 else column.head
        return Column(head, lambda line: column.text(line[specimen]) if specimen in line else None)

    shown = [of_one(column, specimen) for specimen in specimens for column in columns]
    return table(caption, lines, *map(of_first, names), *shown)


def _scores(caption, rows):
    rules = {row["judged"] for row in rows}
    judged = (COLUMNS["judged"],) if len(rules) > 1 else ()
    columns = (RIGHT, BRIER) if judged else (RIGHT, ERRORS, BRIER)
    return _by_specimen(caption, rows, (FORECAST, *judged), *columns)


def _pairs(result):
    rows = [
        row for members in grouped(where(result.rows, part="paired"), "forecast", "beside").values() for row in members
    ]
    return table(
        "Predictions in pairs, the first compared with the second: how many more answers are right and by how much the "
        "Brier score is smaller, with 95 % intervals by record; and how often the first is right where the two "
        "disagree. For the Brier score, a yes or no is a probability of 1 or 0",
        rows,
        FORECAST,
        COLUMNS["beside"],
        COLUMNS["specimen"],
        Column("more right", more_right),
        COLUMNS["difference"],
        Column("first right where they disagree", "{right} of {disagree}"),
    )


def judgements(result: Result) -> tuple[Judgement, ...]:
    """Judge whether engines end as the model does under a table's motions, by (engine, variant)."""
    marks = {(row["engine"], row["variant"]): equal_mark(tally_of(row)) for row in together(result)}
    return (Judgement("runs that differ or fail under shake-table motions", marks),) if marks else ()


def glance(result: Result) -> Glance:
    """Return the sentences and outcomes for the report's first screen."""
    endings = tuple(map(_endings, together(result)))
    return Glance(says={"real": at_a_glance(result)}, endings=endings)


def _endings(row):
    """Outcomes of an engine's runs away from the model's outcome boundaries."""
    return Endings(
        "shake-table motions",
        row["engine"],
        row["variant"],
        row["tier"],
        row["size"] - row["near"],
        failed=row["failed"] - row["near_failed"],
        missed=row["only_a"] - row["near_missed"],
        added=row["only_b"] - row["near_added"],
        other=0,
        interval=tuple(row["interval"]),
        left_out=row["near"],
        left_differing=apart_near(row),
    )


def tally_of(row: dict[str, Any]) -> dict[str, Any]:
    """Return the runs of an engine away from outcome boundaries, in the form that `wording.equal_mark` reads."""
    runs, differing = row["size"] - row["near"], apart(row) - apart_near(row)
    tally = {"runs": runs, "differing": differing, "share": differing / runs if runs else 0.0}
    return tally | {"failed": row["failed"] - row["near_failed"], **{key: row[key] for key in ("equal", "interval")}}


def _score(rows, **wanted):
    """First of the rows that have these values; None without one."""
    return next(iter(where(rows, **wanted)), None)


def _bars(result: Result, engines: Sequence[dict[str, Any]]) -> Figure | None:
    """Figure of the share of outcomes that each forecast and each engine predicts."""
    scores, rows = where(result.rows, part="score"), []
    for specimen in result.settings["specimens"]:
        specimen_scores = where(scores, specimen=specimen["name"])
        for name in BARS:
            if (row := _score(specimen_scores, forecast=name, judged=BY_RECORD)) is not None:
                rows.append(_bar(row, name))
        same = _score(specimen_scores, forecast=ONE, judged=IN_SAMPLE)
        rows.append(_bar(same, "model, as engines"))
        for row in where(engines, specimen=specimen["name"]):
            failed = f" ({row['failed']} failed)" if row["failed"] else ""
            if row["right"] is not None:
                rows.append(_bar(row, name_of(row) + failed))
    agree = result.settings["agree"]
    rules = () if agree is None else ((agree / len(result.settings["tests"]), "the other boulder"),)
    first = min(math.floor(10 * min(low for row in rows for low in row["within"])), 9)  # tenths of the axis
    marked = range(first, 11, 1 if first >= 5 else 2)
    return ranks(
        rows,
        Column("predicted by", "name"),
        SHARE,
        "Share of outcomes predicted, with 95 % intervals by record. The engines and “model, as engines” use one "
        "slenderness, fitted to all tests. All others are judged on held-out records. A failed run counts as wrong.",
        Axis(SHARE.head, first / 10, 1.0, ticks=tuple((tenth / 10, str(10 * tenth)) for tenth in marked)),
        panel="specimen",
        rules=rules,
        opened=as_it_comes,
    )


def _bar(row, name):
    return {"tier": None, **row, "name": name, "share": row["right"] / row["size"], "within": (row["low"], row["high"])}


def _table_of_engines(result, engines):
    judged = wilson(0, result.settings["records"])[1] < EQUAL  # otherwise no engine can be equal, whatever it does
    equal = Column("equal", lambda row: "inconclusive" if row["equal"] == TOO_FEW else row["equal"])
    return table(
        "Engines against the model at the same slenderness. At most: the upper end of the 95 % interval (Wilson, by "
        "record) of the share that differs away from outcome boundaries. "
        f"{'Equal: at most 5 %. ' if judged else ''}In brackets: the number of records on which most "
        "differences go that way. Last column: differing runs, of those in which a change of the scene by 10⁻⁴ changes "
        "the model’s own outcome or the time of its fall",
        of_all(engines),
        NAME,
        COLUMNS["tier"],
        Column("outcomes that differ", lambda row: f"{apart(row)} of {row['size']}"),
        Column("at most", lambda row: row["interval"][1], percent=True),
        *([equal] if judged else ()),
        Column("overturnings missed", "{only_a} ({records_a})"),
        Column("added", "{only_b} ({records_b})"),
        COLUMNS["p_records"],
        COLUMNS["failed"],
        Column("differing near an outcome boundary", lambda row: f"{apart_near(row)} of {row['near']}"),
    )


def _right_of_engines(engines):
    return _by_specimen(
        "Engines, and the model at the same slenderness, against the measured outcomes. Ratio of peak tilts: median "
        "over the tests in which the block rocks and stays upright in both",
        [row for row in engines if row["specimen"] != ALL],
        (NAME,),
        Column("outcomes that differ", lambda row: f"{apart(row)} of {row['size']}"),
        COLUMNS["right"],
        COLUMNS["model_right"],
        ERRORS,
        COLUMNS["tilt"],
    )


def _fitted(result):
    """Sentences on the slenderness that fits each specimen best."""
    fits = []
    for row in where(result.rows, part="fit", change=AS_IT_IS):
        angles = [number(math.degrees(row[name]), 2) for name in ("slenderness", "centre", "spread")]
        (specimen,) = where(result.settings["specimens"], name=row["specimen"])
        fits.append(
            f"{row['specimen']}: {angles[0]} deg alone, or {angles[1]} deg with a spread of {angles[2]} deg "
            f"({specimen['note']})."
        )
    return (
        "This is the only constant of the project that is fitted, because nobody knows on which points a block stands. "
        "Slenderness that fits all tests best: " + " ".join(fits)
    )


def _by_restitution(result):
    """Return {kind of model: right answers by specimen and slenderness}, for every other factor on the restitution."""
    names = [kind for kind in result.settings["kinds"] if kind == AS_IT_IS or kind.startswith("restitution")][::2]
    return {name: result.arrays[f"right/{name}"] for name in names}


def _degrees(name):
    return lambda row: math.degrees(row[name])


def _fits(result):
    return _by_specimen(
        "The model with one thing changed. The slenderness alone, and its mean and spread, are fitted to all tests; "
        "right answers and Brier score are those on held-out records",
        where(result.rows, part="fit"),
        (CHANGE,),
        Column("slenderness [deg]", _degrees("slenderness")),
        Column("mean, spread [deg]", lambda row: [math.degrees(row["centre"]), math.degrees(row["spread"])]),
        COLUMNS["right"],
        BRIER,
    )
