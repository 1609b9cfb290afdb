"""Words that several pages share."""

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from analytic.response import COMPARED, EDGE, UNCOMPARED, Difference
from engines.comparison import END

from ..metrics.statistics import EQUAL, equality, wilson
from ..schemas.columns import NAME, Column, percent
from .parts import Mark

# Root mean square error of restitution: measured restitution of stone scatters by some per cent.
TRUSTED, USABLE = 1e-3, 1e-2
INDEX = re.compile(r"(?<![\w.])([^\W\d_])_([A-Za-zα-ω0]{1,3})(?![\w_])")  # of a quantity of one letter: m_b

ON_EDGE = "agrees with the analytic model within what a change of the scene by 1e-4 does in the model"
RATINGS = {
    "good": "may be trusted",
    "fair": "is usable where a per cent does not matter",
    "bad": "is not to be trusted",
}
NOT_COMPARED = {EDGE: "near an outcome boundary"}  # values of `comparable` that rows name otherwise
OUTCOMES = {
    "stands": "never lifts",
    "slides": "slides and never lifts",
    "rocks": "rocks and stays upright",
    "overturns": "overturns",
}
MOST_NAMED = 3  # solvers of the commonest outcome; more are counted


def indexed(html: str) -> str:
    """HTML with the indices of quantities below the line."""
    return INDEX.sub(r"\1<sub>\2</sub>", html)


def listed(names: Sequence[str]) -> str:
    """Names in a sentence: "a", "a and b", "a, b and c"."""
    return " and ".join(filter(None, (", ".join(names[:-1]), *names[-1:])))


def with_counts(words: str, counts: Mapping[str, int]) -> str:
    """Words with counts {what: how many} behind them that are not 0."""
    behind = ", ".join(f"{count} {what}" for what, count in counts.items() if count)
    return f"{words} ({behind})" if behind else words


def rating(rms: float | None, failed: int) -> str:
    """The level, a key of `RATINGS`, of a root mean square error of restitution, None for none, and of failed runs."""
    if rms is None or failed:
        return "bad"
    return "good" if rms <= TRUSTED else "fair" if rms <= USABLE else "bad"


def trust(rms: float | None, failed: int) -> str:
    return RATINGS[rating(rms, failed)]


# Ways in which a judged run is not right, or why it is not judged: {key in a `tally`: what they are called in a table}.
TURNED, FALL, INSTEAD, ELSE = "turned", "fall", "instead", "else"
ENDS = {
    TURNED: "overturning missed or added [-]",
    FALL: "falls at another time [-]",
    INSTEAD: "stands, slides or rocks instead [-]",
    ELSE: "differs elsewhere [-]",
    "failed": "failed [-]",
    "edge": "left out near an outcome boundary [-]",
    "out": "left out otherwise [-]",
}


def end_of(row: Mapping[str, Any], turned: Callable[[Mapping[str, Any]], bool]) -> str:
    """Key of `ENDS` of a run, or "right".

    turned: of a run that differs, whether the block overturns in one of engine and model alone.
    """
    if row["class"] == "left out":
        return "edge" if row["comparable"] == EDGE else "out"
    if row["class"] != "differs":
        return row["class"]
    quantities = set(row["quantities"])
    if turned(row):
        return TURNED
    return INSTEAD if "outcome" in quantities else FALL if quantities & END else ELSE


def tally(rows: Sequence[Mapping[str, Any]], group: str, turned: Callable[[Mapping[str, Any]], bool]) -> dict[str, Any]:
    """Of the runs of a variant: how many are judged (not left out) and differ from the model or fail, the share of
    those with its interval, what `equality` calls it, and how many end in each way of `ENDS`.

    Runs alike in the column `group` count as one in the interval; groups: how many there are. turned: of `end_of`.
    """
    judged = [row for row in rows if row["class"] != "left out"]
    differs, groups = [row["class"] != "right" for row in judged], [row[group] for row in judged]
    equal, interval = equality(differs, groups) if judged else (None, None)
    ends = [end_of(row, turned) for row in rows]
    counts = {"runs": len(judged), "groups": len(set(groups)), "differing": sum(differs)}
    counts |= {way: ends.count(way) for way in ENDS}
    return {**counts, "share": sum(differs) / len(judged) if judged else None, "equal": equal, "interval": interval}


def ends(rows: Sequence[Mapping[str, Any]]) -> tuple[Column, ...]:
    """Columns of tables of `tally` rows: one for each way that any of them has, or in which outcomes could change."""
    always = {TURNED, FALL, "failed", "edge"}
    return tuple(Column(head, way) for way, head in ENDS.items() if way in always or any(row[way] for row in rows))


def ends_in_words(rows: Sequence[Mapping[str, Any]]) -> str:
    """What `tally` rows of variants found, as a clause: of how many runs each, and how many turn."""
    judged = [row for row in rows if row["runs"]]
    if not judged:
        return "no run is judged"
    single = len({row["engine"] for row in judged}) == len(judged)
    found = [
        f"{row['differing']} of {row['runs']}{' runs' * (not k)} ({row['engine'] if single else NAME.of(row)})"
        for k, row in enumerate(judged)
    ]
    turned, failed = (sum(row[way] for row in judged) for way in (TURNED, "failed"))
    lost = f"{turned} miss or add an overturning" if turned else "no overturning is missed or added"
    how = "tuned, " if all(row["tier"] == "tuned" for row in judged) else ""
    return f"{how}{listed(found)} end otherwise than the model’s{' or fail' * bool(failed)}; {lost}"


def least_shown(rows: Iterable[Mapping[str, Any]], what: str) -> str:
    """What so few groups, `what` they are, can show at best, from `tally` rows: a clause."""
    sizes = sorted({row["groups"] for row in rows if row["groups"]}, reverse=True)
    limits = [f"{size}{f' {what}' * (not k)} cannot show less than {percent(wilson(0, size)[1])}"
              for k, size in enumerate(sizes)]  # fmt: skip
    return listed(limits)


def left_out(row: Mapping[str, Any]) -> str:
    """How many runs of a `tally` are not judged, and why."""
    return f"left out: {row['edge']} near an outcome boundary" + (f", {row['out']} otherwise" if row["out"] else "")


def equal_mark(found: Mapping[str, Any], *more: str) -> Mark:
    """What a study says of a `tally`, and more in its note. Good: the upper limit of the interval is below `EQUAL`;
    bad: the lower is above it; fair: neither, or too few runs to be good, of which more than `EQUAL` differ.
    """
    if not found["runs"]:
        return Mark("no run judged", "part")
    equal, (low, high) = found["equal"], found["interval"]
    limit = f"{100 * EQUAL:g} %"
    level, note = {
        "yes": ("good", f"shown to be below {limit}"),
        "no": ("bad", f"shown to be above {limit}") if low > EQUAL else ("fair", f"not shown to be below {limit}"),
    }.get(equal) or ("fair" if found["share"] > EQUAL else "part", f"too few motions to show less than {limit}")
    words = f"{found['differing']} of {found['runs']} (at most {percent(high)})"
    return Mark(words, level, "; ".join((note, f"{found['failed']} failed", *more)), found["share"])


def differing(comparable: str, differences: Iterable[Difference]) -> list[str]:
    """In what a run differs from the analytic model, or why it cannot be compared: the end of a sentence, or none."""
    found = "; ".join(map(str, differences))
    if comparable == COMPARED:
        return [f"differs from the analytic model: {found}"] if found else []
    if comparable == EDGE:
        return [f"differs from the analytic model: {found}" if found else ON_EDGE]
    return [] if comparable == UNCOMPARED else [f"cannot be compared with the analytic model: {comparable}"]


def outcomes(rows: Sequence[Mapping[str, Any]]) -> str:
    """Who found what: "in all 3 solvers it overturns", or the solvers by outcome."""
    by_outcome: dict[str, list[str]] = {}
    for row in rows:
        undecided = not row.get("decided", True) and row["outcome"] != "failed"
        words = f"is {row['outcome_text']}" if undecided else OUTCOMES.get(row["outcome"], row["outcome"])
        by_outcome.setdefault(words, []).append(row["engine"])
    off = [row["engine"] for row in rows if row.get("differences")]
    most = max(map(len, by_outcome.values()), default=0)

    def who(solvers):
        """All of them, or the many of the commonest outcome, as a number: the others are worth their names."""
        if len(solvers) == len(rows):
            return {1: solvers[0], 2: "both solvers"}.get(len(solvers), f"all {len(solvers)} solvers")
        if len(solvers) == most > MOST_NAMED:
            return f"{len(solvers)} of {len(rows)} solvers"
        return listed(solvers)

    words = ", ".join(f"in {who(solvers)} it {outcome}" for outcome, solvers in by_outcome.items())
    if len(by_outcome.keys() - {"failed"}) > 1:
        words = f"outcomes differ: {words}"
    return f"{words}; {listed(off)} differ{'s' * (len(off) == 1)} from the analytic model" if off else words
