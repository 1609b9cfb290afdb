"""Whether the code of today would find the same as a result holds: in words, by engine where engines differ in it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from .by_solver import MODEL
from .provenance import at_commit
from .sources import changes, version_of

if TYPE_CHECKING:
    from .provenance import Result

OLDER = "older than the code"
NAMED = 3  # definitions that a sentence on a stale result names


def age(result: Result) -> str | None:
    """In words: None if code, shipped scenes and packages behind `result` are those here, else what has changed since.

    Code counts wherever it has moved; comments, docstrings and packages that are not installed here do not. Files of
    one commit are told together.
    """
    origins = origins_of(result)
    groups: dict[tuple[str, str | None], dict[str, list[str]]] = {}
    for name, origin in origins.items():
        if changed := changes(origin["sources"]):
            groups.setdefault((date_of(origin), origin["commit"]), {})[name] = changed
    found = [_older(date, commit, names, len(names) == len(origins)) for (date, commit), names in groups.items()]
    found += dict.fromkeys(filter(None, map(_other_versions, origins.values())))
    return "; ".join(filter(None, (*found, last_check(result)))) if found else None


def origins_of(result: Result) -> dict[str, Mapping[str, Any]]:
    """{solver: where its part of a result comes from}, the model's first."""
    return {MODEL: result.provenance, **(result.provenance.get("engines") or {})}


def timed_apart(result: Result) -> dict[str, str]:
    """{engine: why} its CPU times cannot be set against the model's: another processor, or code of another commit."""
    origins = origins_of(result)
    own, found = origins[MODEL], {}
    for name, origin in origins.items():
        if (processor := origin["machine"]["processor"]) != own["machine"]["processor"]:
            found[name] = f"on another processor ({processor})"
        elif origin["commit"] != own["commit"]:
            found[name] = f"with the code of another commit ({at_commit(origin['commit'])})"
    return found


def briefly(words: str) -> str:
    """What `age` says, for a heading: that it is so, not why."""
    if OLDER not in words:
        return "computed with other versions"
    return OLDER if words.startswith(OLDER) else f"in part {OLDER}"


def last_check(result: Result) -> str | None:
    """In words when some of a result's runs were done again and how many held; None if never."""
    found = checked(result)
    return f"last check: {found['date']}, {at_commit(found['commit'])}, {held(found)} runs hold" if found else None


def checked(result: Result) -> dict[str, Any] | None:
    """The checks of a result's files together, with the oldest one's date and commit; None without any."""
    known = [origin["check"] for origin in origins_of(result).values() if origin.get("check")]
    if not known:
        return None
    runs, held = (sum(one[name] for one in known) for name in ("runs", "held"))
    return {**min(known, key=lambda one: one["date"]), "runs": runs, "held": held}


def held(check: Mapping[str, Any]) -> str:
    """How many runs held, of how many."""
    return f"{check['held']} of {check['runs']}"


def by_engine(result: Result, words: Callable[[Mapping[str, Any]], str]) -> str:
    """What is said of where the files of a result come from: the model's, and those of which something else holds."""
    told = {name: words(origin) for name, origin in origins_of(result).items()}
    others: dict[str, list[str]] = {}
    for name, text in told.items():
        if text != told[MODEL]:
            others.setdefault(text, []).append(name)
    return "; ".join((told[MODEL], *(f"{', '.join(names)}: {text}" for text, names in others.items())))


def date_of(origin: Mapping[str, Any]) -> str:
    """The day of a provenance."""
    return origin["time"][:10]


def _older(date, commit, changed, whole):
    """changed: {solver: definitions}. whole: whether these are all solvers."""
    every = list(dict.fromkeys(name for names in changed.values() for name in names))
    others = f" and {len(every) - NAMED} more" if len(every) > NAMED else ""
    where = "" if whole else f"in the rows of {', '.join(changed)} "
    words = f"computed on {date} {at_commit(commit)}; since then changed: {', '.join(every[:NAMED])}{others}"
    return f"{where}{OLDER}: {words}"


def _other_versions(origin):
    then = origin["packages"]
    here = {name: version_of(name) for name, version in then.items() if version}
    found = [f"{name} {then[name]} (here {own})" for name, own in here.items() if own and own != then[name]]
    return f"computed with other versions than those here: {', '.join(found)}" if found else None
