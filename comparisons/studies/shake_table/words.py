"""Sentences on a shake table: what was found, how far it reaches, and how it was measured."""

import math
from collections.abc import Sequence
from typing import Any

from ...running.provenance import Result
from ...showing.parts import grouped, number, percent, short, where
from ...showing.wording import listed
from .judging import AS_IT_IS, BY_RECORD, CURVE, EACH, FREQUENT, IN_SAMPLE, MODEL, ONE, THRESHOLD
from .measures import CORNER
from .runs import ALL


def title(scores: Sequence[dict[str, Any]], settings: dict[str, Any]) -> str:
    def right(name):
        return listed([str(row["right"]) for row in where(scores, forecast=name, judged=BY_RECORD)])

    count = len(settings["tests"])
    return f"Shake table: the model predicts {right(MODEL)} of {count} outcomes, a PGV threshold {right(THRESHOLD)}"


def sentence(result: Result, engines: Sequence[dict[str, Any]]) -> str:
    """How large the error of engines is beside that of the model."""
    scores = where(result.rows, part="score", judged=BY_RECORD, forecast=MODEL)
    wrong = listed([str(row["size"] - row["right"]) for row in scores])
    names = listed([row["specimen"] for row in scores])
    words = [f"The model is wrong in {wrong} of {len(result.settings['tests'])} tests ({names})."]
    every = where(engines, specimen=ALL) or engines
    if tuned := where(every, tier="tuned"):
        said = [f"{apart(row)} of {row['size']} ({row['engine']})" for row in tuned]
        fits = [one for row in where(result.rows, part="fit", change=AS_IT_IS) for one in row["neighbours"]]
        first, second, *_ = result.settings["specimens"][0]["grid"]
        words.append(
            f"Tuned engines differ from the model in {listed(said)} runs. A slenderness "
            f"{number(math.degrees(second - first), 1)} deg smaller or larger changes {min(fits)} to {max(fits)} of "
            f"{len(result.settings['tests'])} outcomes of the model itself."
        )
    if unsafe := [row for row in where(every, tier="defaults") if _unsafe(row)]:
        chances = listed([f"{number(row['p_records'], 2)} in {row['engine']}" for row in unsafe])
        words.append(
            "With defaults, engines err on the unsafe side: they miss more overturnings than they add (p by record: "
            f"{chances})."
        )
    return " ".join(words)


def at_a_glance(result: Result) -> str:
    """How often the model is right about real blocks, beside what is simpler and, fitted alike, beside engines; ""
    where it was not judged."""
    specimens = [one["name"] for one in result.settings["specimens"]]
    held = where(result.rows, part="score", judged=BY_RECORD)
    if not (model := where(held, forecast=MODEL)):
        return ""
    rivals = {CURVE: "The curve is right", THRESHOLD: "one threshold of PGV", FREQUENT: FREQUENT}
    told = [f"{words} in {_right(where(held, forecast=name))}" for name, words in rivals.items()]
    alike = where(result.rows, part="score", judged=IN_SAMPLE, forecast=ONE)
    engines = grouped(where(result.rows, part="engine", specimen=set(specimens)), "engine", "variant").values()
    fitted = [f"{_right(some, False)} ({name_of(some[0])})" for some in engines]
    words = f"on a shake table the model is right in {_right(model)} of {model[0]['size']} tests ({listed(specimens)})."
    if pairs := where(result.rows, part="paired", forecast=MODEL, beside=CURVE):
        words += f" {_beside((where(pairs, specimen=ALL) or pairs)[-1], sum(row['size'] for row in model))}"
    return (
        f"{words} {listed(told)}. All of these are held out by record. Engines go by another rule, one slenderness "
        f"fitted to all tests. By this rule {listed([f'{_right(alike, False)} (the model)', *fitted])} are right. "
        "Restitution was not measured."
    )


def _right(rows, shares=True):
    """Right answers of each specimen, with their shares; "–" where they are not told."""
    right = listed(["–" if row["right"] is None else str(row["right"]) for row in rows])
    return f"{right} ({listed([percent(row['right'] / row['size']) for row in rows])})" if shares else right


def _beside(pair, size):
    """Whether the model is shown to be better than the curve."""
    low, high = pair["more_interval"]
    words = "better" if low > 0 else "worse" if high < 0 else "not shown to be better"
    more = f"{pair['more_right']} more of {size} (95 % interval {low:.0f} to {high:.0f})".replace("-", "−")
    return f"It is {words} than a curve in PGA and PGV: it is right in {more}."


def together(result: Result) -> list[dict[str, Any]]:
    """The rows of engines, of all specimens together."""
    rows = where(result.rows, part="engine")
    return where(rows, specimen=ALL) or rows


def near_boundaries(result: Result) -> str:
    """How many outcomes tuned engines change in all runs, and how many of these are near an outcome boundary."""
    rows = where(together(result), tier="tuned")
    missed, added, failed, size, near, there = (
        sum(row[key] for row in rows) for key in ("only_a", "only_b", "failed", "size", "near", "on_edge")
    )
    if not rows:
        return ""
    return (
        f"On the shake table, with these runs, tuned engines miss {missed} overturnings, add {added} and fail {failed} "
        f"times in {size} runs. Of these {missed + added + failed}, {there} are in the {near} runs near a boundary."
    )


def _unsafe(row):
    return row["only_a"] > row["only_b"] and row["p_records"] is not None and row["p_records"] < 0.05


def apart(row: dict[str, Any]) -> int:
    """Runs that an engine ends differently, failed ones too."""
    return row["only_a"] + row["only_b"] + row["failed"]


def name_of(row: dict[str, Any]) -> str:
    """An engine with the kind of its variant."""
    return f"{row['engine']}, {row['tier']}"


def bounds(result: Result) -> str:
    """What a model can be asked for at most."""
    settings = result.settings
    names = listed([one["name"] for one in settings["specimens"]])
    count = len(settings["tests"])
    words = (
        f"{settings['campaign'].capitalize()}: {count} tests under {settings['records']} records at many scales; "
        f"{listed([str(one) for one in settings['overturned']])} overturned ({names})."
    )
    each = where(result.rows, part="score", forecast=EACH)
    model = where(result.rows, part="score", forecast=MODEL, judged=BY_RECORD)
    words += (
        " A PGA threshold for each record, fitted to the same tests, is right in "
        f"{listed([str(row['right']) for row in each])}"
    )
    own = all(
        2 * (one["size"] - one["right"]) < row["size"] - row["right"] for one, row in zip(each, model, strict=True)
    )
    words += ". Most of the model’s errors are therefore its own, not chance." if own else "."
    if settings["agree"] is not None:
        words += f" The two blocks differ in shape and have the same outcome in {settings['agree']}."
    return words + (
        " The model is planar; the block is not. The mean and the spread of its slenderness are fitted, and judged on "
        "records not used in the fit."
    )


def more_right(row: dict[str, Any]) -> str:
    """Of a pair of forecasts: in how many more tests the first is right, with the interval."""
    low, high = row["more_interval"]
    return f"{row['more_right']} ({low:.0f} to {high:.0f})".replace("-", "−")


def not_shown(result: Result) -> tuple[str, str]:
    """What the figures show, and what they do not."""
    pairs = {(row["specimen"], row["beside"]): row for row in where(result.rows, part="paired", forecast=MODEL)}
    last = list(dict.fromkeys(name for name, _ in pairs))[-1]  # all specimens together, if there are several

    runs = len(result.settings["tests"]) * len(result.settings["specimens"])
    boulders = bool(result.settings["cite"])  # the published campaign; of one's own nothing more is known
    asked = " with five slopes, which was added when a referee asked for it" if boulders else " with five slopes"
    stone = (
        ", of one kind of stone, on one axis. The model’s block is symmetric; a boulder has another angle to either "
        "side, stands on three points, may twist, walk and wear. The spread stands for all of this. It was brought in "
        "after a prototype on the same tests, so no test is untouched by that choice."
    )
    granite = " Restitution and friction of granite on the table were not measured." if boulders else ""
    return (
        f"What this shows: of {runs} outcomes the model is right in {more_right(pairs[last, THRESHOLD])} more than a "
        f"threshold of PGV, and in {more_right(pairs[last, CURVE])} more than a curve in PGA and PGV{asked}. That "
        "curve holds for these blocks alone. Model and curve joined are compared with the curve above.",
        f"What it does not show: it is one campaign{stone if boulders else '.'} Outcomes do not tell slenderness and "
        "restitution apart: the fitted slenderness stands for what the model lacks. Intervals go by record, hold the "
        "fits fixed, are not adjusted for their number, and say nothing of records unlike these. The slenderness of "
        "the engines’ runs is the one at which the model is right most often, which favours the model over them."
        f"{granite}",
    )


def _left_out(settings):
    """Of the tests without a motion: whether they are like the others."""
    missing, names = settings["missing"], listed([one["name"] for one in settings["specimens"]])
    if not missing["tests"]:
        return ""
    words = f"{missing['tests']} tests have no motion at hand and are left out"
    if missing["overturned"]:
        here = len(settings["tests"])
        shares = [percent(one / missing["tests"]) for one in missing["overturned"]]
        others = [percent(one / here) for one in settings["overturned"]]
        words += f": {listed(shares)} of them overturned ({names}), of the others {listed(others)}"
    if missing["ratios"]:
        words += (
            f"; mean PGV/PGA {number(missing['ratios'][0], 2)} s, of the others {number(missing['ratios'][1], 2)} s"
        )
    return f"{words}. "


def how(result: Result) -> tuple[str, ...]:
    s = result.settings
    steps = listed([f"{round(1 / step):g} Hz" for step in s["steps"]])
    blocks = "; ".join(
        f"{one['name']}: centre of mass {one['height']:.3g} m up, radius of gyration {one['gyration']:.3g} m"
        for one in s["specimens"]
    )
    resampled = s["published"] and any(abs(1 / step / s["published"] - 1) > 1e-3 for step in s["steps"])
    published = f" (published at {s['published']:g} Hz; resampled by whoever made these files)" if resampled else ""
    speed = f"{s['model_runs']:,} runs of the model took {short(s['model_seconds'])} s of CPU time"
    rigid = f"{_left_out(s)}Rigid planar block on rigid ground; {blocks}."
    intervals = (
        f"Intervals: percentiles of a bootstrap over records (seed {result.provenance['seed']}); those of reliability "
        "go by test (Wilson), and by record would be somewhat wider. “Fitted to every other test” may have a record "
        "on both sides."
    )
    runs = (
        f"Engines in question run all tests, the others one in {s['others']}, at the slenderness that is right most "
        "often in the model. A failed run is not right, and differs."
    )
    if not s["cite"]:
        return (
            f"Motions: as their files have them, at {steps}. {rigid} {speed}.",
            f"{intervals} PGA and PGV: of these motions, PGV of what they have above {CORNER} Hz.",
            runs,
        )
    return (
        f"Data: {s['cite']}. Nothing of them is stored here but sums and cells of five tests or more; rocking study "
        "shake-table --data FOLDER draws every test.",
        f"Motions: the measured acceleration of the table at {steps}{published}, less the median of the first second. "
        f"{rigid} Moment of inertia: of the two horizontal axes of the meshes the mean. {speed}.",
        f"{intervals} PGA and PGV: as the campaign states them of what the table was to play; “of the table”: of its "
        f"measured acceleration above {CORNER} Hz. The other specimen’s outcome is one of the same shaking. The "
        "setting of the authors’ discrete elements is chosen in the same way; none was fitted to these outcomes as "
        "the slenderness is.",
        runs,
    )
