"""Whether the code of today would find the same as a result holds: in words, by engine where engines differ in it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from .provenance import at_commit
from .sources import changes, version_of

if TYPE_CHECKING:
    from .provenance import Result

OLDER = "older than the code"
NAMED = 3  # definitions that a sentence on a stale result names


def age(result: Result) -> str | None:
    """In words: None if code, shipped scenes and packages behind `result` are those here, else what has changed since.

    Code counts wherever it has moved; comments, docstrings and packages that are not installed here do not. The rows of
    an engine that was run later than the rest are judged by what they come from themselves.
    """
    later = result.provenance.get("engines") or {}
    rest = f"apart from the rows of {', '.join(later)} " if later else ""
    judged = [(rest, result.provenance), *((f"in the rows of {name} ", origin) for name, origin in later.items())]
    found = [(words, "; ".join(filter(None, (_changed(one), _other_versions(one))))) for words, one in judged]
    old = "; ".join(f"{words}{changes}" for words, changes in found if changes)
    return "; ".join(filter(None, (old, last_check(result)))) if old else None


def briefly(words: str) -> str:
    """What `age` says, for a heading: that it is so, not why."""
    if OLDER not in words:
        return "computed with other versions"
    return OLDER if words.startswith(OLDER) else f"in part {OLDER}"


def last_check(result: Result) -> str | None:
    """In words when some of a result's runs were done again and how many held; None if never."""
    last = result.provenance.get("check")
    return (
        last and f"last check: {last['date']}, {at_commit(last['commit'])}, {last['held']} of {last['runs']} runs hold"
    )


def by_engine(origin: Mapping[str, Any], words: Callable[[Mapping[str, Any]], str]) -> str:
    """What is said of a provenance, and of the engines of which something else holds."""
    first = words(origin)
    others = {name: words({**origin, **own}) for name, own in (origin.get("engines") or {}).items()}
    return "; ".join((first, *(f"{name}: {other}" for name, other in others.items() if other != first)))


def date_of(origin: Mapping[str, Any]) -> str:
    """The day of a provenance."""
    return origin["time"][:10]


def _changed(origin):
    changed = changes(origin["sources"])
    if not changed:
        return None
    others = f" and {len(changed) - NAMED} more" if len(changed) > NAMED else ""
    return (
        f"{OLDER}: computed on {date_of(origin)} {at_commit(origin['commit'])}; since then changed: "
        f"{', '.join(changed[:NAMED])}{others}"
    )


def _other_versions(origin):
    then = origin["packages"]
    here = {name: version_of(name) for name, version in then.items() if version}
    found = [f"{name} {then[name]} (here {own})" for name, own in here.items() if own and own != then[name]]
    return f"computed with other versions than those here: {', '.join(found)}" if found else None
