"""Sentences on a shake table: what was found, how far it reaches, and how it was measured."""

import math
from collections.abc import Sequence
from typing import Any

from ...running.provenance import Result
from ...showing.parts import number, percent, short, where
from ...showing.wording import listed
from .judging import AS_IT_IS, BY_RECORD, CURVE, EACH, FREQUENT, MODEL, THRESHOLD
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
    together = where(engines, specimen=ALL) or engines
    if tuned := where(together, tier="tuned"):
        said = [f"{apart(row)} of {row['size']} ({row['engine']})" for row in tuned]
        fits = [one for row in where(result.rows, part="fit", change=AS_IT_IS) for one in row["neighbours"]]
        first, second, *_ = result.settings["specimens"][0]["grid"]
        words.append(
            f"Tuned engines differ from the model in {listed(said)} runs. A slenderness "
            f"{number(math.degrees(second - first), 1)} deg smaller or larger changes {min(fits)} to {max(fits)} of "
            f"{len(result.settings['tests'])} outcomes of the model itself."
        )
    if unsafe := [row for row in where(together, tier="defaults") if _unsafe(row)]:
        chances = listed([f"{number(row['p_records'], 2)} in {row['engine']}" for row in unsafe])
        words.append(
            "With defaults, engines err on the unsafe side: they miss more overturnings than they add (p by record: "
            f"{chances})."
        )
    return " ".join(words)


def at_a_glance(result: Result) -> str:
    """How often the model is right about real blocks, beside a guess and tuned engines; "" where it was not judged."""
    count = len(result.settings["tests"])
    scores = where(result.rows, part="score", judged=BY_RECORD)
    right = {name: [row["right"] for row in where(scores, forecast=name)] for name in (MODEL, FREQUENT)}
    if not right[MODEL]:
        return ""
    shares = listed([percent(one / count) for one in right[MODEL]])
    guess = listed([percent(one / count) for one in right[FREQUENT]])
    own = [row["right"] for row in where(result.rows, part="engine", tier="tuned") if row["right"] is not None]
    engines = [percent(one / count) for one in (min(own), max(own))] if own else []
    tuned = f", tuned engines {' to '.join(dict.fromkeys(engines))}" if engines else ""
    always = f" Always guessing the more frequent outcome is right in {guess}." if guess else ""
    names = listed([one["name"] for one in result.settings["specimens"]])
    return (
        f"on a shake table, the model predicts {shares} of {count} outcomes ({names}){tuned}.{always} Restitution was "
        "not measured."
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
