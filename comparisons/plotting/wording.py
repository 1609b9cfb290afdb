"""Words that several pages share: ratings, tallies of runs, outcomes, and lists in sentences."""

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from analytic.response import COMPARED, EDGE, UNCOMPARED, Difference
from engines.comparison import END

from ..metrics.statistics import EQUAL, equality, wilson
from ..schemas.columns import NAME, Column, percent
from .parts import Mark

# Largest rms error of restitution that is trusted, or usable. Measured restitution of stone scatters by some per cent.
TRUSTED, USABLE = 1e-3, 1e-2
INDEX = re.compile(r"(?<![\w.])([^\W\d_])_([A-Za-zα-ω0]{1,3})(?![\w_])")  # index of a quantity of one letter: m_b

ON_EDGE = "agrees with the analytic model within what a change of the scene by 1e-4 does in the model"
RATINGS = {
    "good": "may be trusted",
    "fair": "is usable where a per cent does not matter",
    "bad": "is not to be trusted",
}
NOT_COMPARED = {EDGE: "near an outcome boundary"}  # {value of `comparable`: its name in tables}
OUTCOMES = {
    "stands": "never lifts",
    "slides": "slides and never lifts",
    "rocks": "rocks and stays upright",
    "falls off": "falls off its pedestal",
    "overturns": "overturns",
    "pedestal overturns": "stands on a pedestal that overturns",
}
MOST_NAMED = 3  # more solvers with the commonest outcome are counted, not named


def indexed(html: str) -> str:
    """Return HTML with the indices of quantities below the line."""
    return INDEX.sub(r"\1<sub>\2</sub>", html)


def listed(names: Sequence[str]) -> str:
    """Return names as in a sentence: "a", "a and b", "a, b and c"."""
    return " and ".join(filter(None, (", ".join(names[:-1]), *names[-1:])))


def with_counts(words: str, counts: Mapping[str, int]) -> str:
    """Return words with the counts {what: how many} that are not 0 in brackets behind them."""
    behind = ", ".join(f"{count} {what}" for what, count in counts.items() if count)
    return f"{words} ({behind})" if behind else words


def rating(rms: float | None, failed: int) -> str:
    """Return the level, a key of `RATINGS`, for an rms error of restitution (None: no error known) and failed runs."""
    if rms is None or failed:
        return "bad"
    return "good" if rms <= TRUSTED else "fair" if rms <= USABLE else "bad"


def trust(rms: float | None, failed: int) -> str:
    """Return the `rating` in words."""
    return RATINGS[rating(rms, failed)]


# {key in a `tally`: head of its column}: ways in which a judged run is not right, and reasons why runs are left out.
TURNED, FALL, INSTEAD, ELSE = "turned", "fall", "instead", "else"
ENDS = {
    TURNED: "overturning missed or added [-]",
    FALL: "falls at another time [-]",
    INSTEAD: "stands, slides or rocks instead [-]",
    ELSE: "differs in other quantities [-]",
    "failed": "failed [-]",
    "edge": "left out near an outcome boundary [-]",
    "out": "left out for other reasons [-]",
}


def end_of(row: Mapping[str, Any], turned: Callable[[Mapping[str, Any]], bool]) -> str:
    """Return the key of `ENDS` of a run, or "right".

    turned: tells of a run that differs whether the block overturns in engine or model alone.
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
    """Return counts of a variant's runs, and the share of judged runs that differ from the model or fail.

    Keys: runs, judged ones, not left out; groups, their number of values of the column `group`, which count as one in
    the interval; differing; one for each way of `ENDS`; share and its interval; equal, the verdict of `equality`.
    turned: as in `end_of`.
    """
    judged = [row for row in rows if row["class"] != "left out"]
    differs, groups = [row["class"] != "right" for row in judged], [row[group] for row in judged]
    equal, interval = equality(differs, groups) if judged else (None, None)
    ends = [end_of(row, turned) for row in rows]
    counts = {"runs": len(judged), "groups": len(set(groups)), "differing": sum(differs)}
    counts |= {way: ends.count(way) for way in ENDS}
    return {**counts, "share": sum(differs) / len(judged) if judged else None, "equal": equal, "interval": interval}


def ends(rows: Sequence[Mapping[str, Any]]) -> tuple[Column, ...]:
    """Return columns for `tally` rows: one for each way that occurs, or that matters even at 0."""
    always = {TURNED, FALL, "failed", "edge"}
    return tuple(Column(head, way) for way, head in ENDS.items() if way in always or any(row[way] for row in rows))


def ends_in_words(rows: Sequence[Mapping[str, Any]]) -> str:
    """Return `tally` rows of variants as a clause: how many runs differ, and how many overturnings are wrong."""
    judged = [row for row in rows if row["runs"]]
    if not judged:
        return "no run is judged"
    single = len({row["engine"] for row in judged}) == len(judged)
    names = [f"{row['engine']}, {row['tier']}" if single else NAME.of(row) for row in judged]
    clauses = [
        f"{row['differing']} of {row['runs']}{' runs' * (not k)} ({name})"
        for k, (row, name) in enumerate(zip(judged, names, strict=True))
    ]
    turned, failed = (sum(row[way] for row in judged) for way in (TURNED, "failed"))
    lost = f"{turned} miss or add an overturning" if turned else "no overturning is missed or added"
    return f"{listed(clauses)} differ from the model’s{' or fail' * bool(failed)}; {lost}"


def least_shown(rows: Iterable[Mapping[str, Any]], what: str) -> str:
    """Return a clause on the smallest share that the groups of `tally` rows can show; what: the groups' name."""
    sizes = sorted({row["groups"] for row in rows if row["groups"]}, reverse=True)
    limits = [f"{size}{f' {what}' * (not k)} cannot show less than {percent(wilson(0, size)[1])}"
              for k, size in enumerate(sizes)]  # fmt: skip
    return listed(limits)


def left_out(row: Mapping[str, Any]) -> str:
    """Return in words how many runs of a `tally` are not judged, and why."""
    others = f", {row['out']} for other reasons" if row["out"] else ""
    return f"left out: {row['edge']} near an outcome boundary{others}"


def equal_mark(row: Mapping[str, Any], *more: str) -> Mark:
    """Return the `Mark` of a `tally`; more: further clauses of its note.

    Good: the upper limit of the interval is below `EQUAL`. Bad: the lower limit is above it. Fair: neither, or too few
    runs to be good and a share above `EQUAL`. Part: too few runs, and a share of at most `EQUAL`.
    """
    if not row["runs"]:
        return Mark("no run judged", "part")
    equal, (low, high) = row["equal"], row["interval"]
    limit = f"{100 * EQUAL:g} %"
    level, note = {
        "yes": ("good", f"shown to be below {limit}"),
        "no": ("bad", f"shown to be above {limit}") if low > EQUAL else ("fair", f"not shown to be below {limit}"),
    }.get(equal) or ("fair" if row["share"] > EQUAL else "part", f"too few motions to show less than {limit}")
    words = f"{row['differing']} of {row['runs']} (at most {percent(high)})"
    return Mark(words, level, "; ".join((note, f"{row['failed']} failed", *more)), row["share"])


def differing(comparable: str, differences: Iterable[Difference]) -> list[str]:
    """Return how a run differs from the analytic model, or why it cannot be compared: no or one end of a sentence."""
    words = "; ".join(map(str, differences))
    if comparable == COMPARED:
        return [f"differs from the analytic model: {words}"] if words else []
    if comparable == EDGE:
        return [f"differs from the analytic model: {words}" if words else ON_EDGE]
    return [] if comparable == UNCOMPARED else [f"cannot be compared with the analytic model: {comparable}"]


def outcomes(rows: Sequence[Mapping[str, Any]]) -> str:
    """Return the outcomes and their solvers: "in all 3 solvers it overturns"."""
    by_outcome: dict[str, list[str]] = {}
    for row in rows:
        undecided = not row.get("decided", True) and row["outcome"] != "failed"
        words = f"is {row['outcome_text']}" if undecided else OUTCOMES.get(row["outcome"], row["outcome"])
        by_outcome.setdefault(words, []).append(row["engine"])
    off = [row["engine"] for row in rows if row.get("differences")]
    most = max(map(len, by_outcome.values()), default=0)

    def who(solvers):
        """Name solvers, or count them: all, or the many with the commonest outcome."""
        if len(solvers) == len(rows):
            return {1: solvers[0], 2: "both solvers"}.get(len(solvers), f"all {len(solvers)} solvers")
        if len(solvers) == most > MOST_NAMED:
            return f"{len(solvers)} of {len(rows)} solvers"
        return listed(solvers)

    words = ", ".join(f"in {who(solvers)} it {outcome}" for outcome, solvers in by_outcome.items())
    if len(by_outcome.keys() - {"failed"}) > 1:
        words = f"outcomes differ: {words}"
    return f"{words}; {listed(off)} differ{'s' * (len(off) == 1)} from the analytic model" if off else words
