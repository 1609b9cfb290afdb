"""Words that several pages share."""

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from analytic.response import COMPARED, EDGE, UNCOMPARED, Difference

from ..measuring.statistics import EQUAL, equality
from .parts import Mark, percent

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


def tally(rows: Sequence[Mapping[str, Any]], group: str) -> dict[str, Any]:
    """Of the runs of a variant: how many are judged (not left out), differ from the model, failed ones among them, and
    whether that is equal, with the interval of the share that differs; runs alike in the column `group` count as one.
    """
    judged = [row for row in rows if row["class"] != "left out"]
    differs = [row["class"] != "right" for row in judged]
    equal, interval = equality(differs, [row[group] for row in judged]) if judged else (None, None)
    failed = sum(row["class"] == "failed" for row in judged)
    counts = {"runs": len(judged), "left_out": len(rows) - len(judged), "differing": sum(differs), "failed": failed}
    return {**counts, "share": sum(differs) / len(judged) if judged else None, "equal": equal, "interval": interval}


def equal_mark(found: Mapping[str, Any]) -> Mark:
    """What a study says of a `tally`. An engine that is neither shown to be equal nor shown to differ by more than
    `EQUAL` is fair.
    """
    if not found["runs"]:
        return Mark("no run judged", "part")
    equal, (low, high) = found["equal"], found["interval"]
    levels = {"yes": "good", "no": "bad" if low > EQUAL else "fair"}
    words, most = f"{found['differing']} of {found['runs']}", percent(high)
    note = {"yes": "equal", "no": "not shown to be equal"}.get(equal, "inconclusive: too few motions")
    note += f"; {found['failed']} failed"
    return Mark(f"{words} (at most {most})", levels.get(equal, "part"), note, found["share"])


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
