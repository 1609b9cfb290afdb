"""The vertical motion's effect over its peak, V/H, and over how fast it is; and what the contact then bears."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

from ...measuring.statistics import wilson
from ...running.cases import Case
from .changes import with_vertical

if TYPE_CHECKING:
    from analytic import Scene

RATIOS = (0.3, 0.5, 0.7, 0.9, 1.1, 1.3, 1.5)  # peak vertical over peak horizontal acceleration
FASTER = (1, 2, 4)  # how many times as fast as the horizontal motion: vertical ones hold higher frequencies
FRICTIONS = (0.3, 0.5, 0.7)  # coefficients that the demand is held against


def vertical_cases(bases: Sequence[Sequence[Scene]], count: int) -> list[Case]:
    """The first `count` scenes of every ensemble under every vertical motion, in the analytic model."""
    return [
        Case(
            base.with_(motion=with_vertical(base.motion, seed, ratio, faster)),
            settings={"history": False},
            tag={"change": "vertical", "ratio": ratio, "faster": faster, "seed": seed, "place": place},
        )
        for place, ensemble in enumerate(bases)
        for seed, base in enumerate(ensemble[:count])
        for faster in FASTER
        for ratio in RATIOS
    ]


def vertical_rows(name: str, usual: dict[tuple[int, int], dict[str, Any]], results: Iterable[Any]) -> list[dict]:
    """A row for every (ratio, faster), and one of ratio 0, without vertical motion: runs, verdicts flipped, contact.

    lifts_off: runs in which N reaches zero, where the model ends. sliding: {coefficient: runs whose friction demand
    lies above it}. usual: {(place, seed): values} of the same motions without a vertical one.
    """
    groups: dict[tuple[float, float], list] = {}
    for row in results:
        key = row.case.tag["place"], row.case.tag["seed"]
        if not row.failed and key in usual:
            groups.setdefault((row.case.tag["faster"], row.case.tag["ratio"]), []).append((usual[key], row.values))
    rows = [_row(name, faster, ratio, pairs) for (faster, ratio), pairs in groups.items()]
    if rows:
        without = [(before, before) for before, _ in next(iter(groups.values()))]
        rows.insert(0, _row(name, 1, 0.0, without))
    return rows


def _row(name, faster, ratio, pairs):
    flips = sum(before["overturns"] != after["overturns"] for before, after in pairs)
    low, high = wilson(flips, len(pairs))
    return {
        "part": "vertical",
        "scene": name,
        "faster": faster,
        "ratio": ratio,
        "runs": len(pairs),
        "flips": flips,
        "low": low,
        "high": high,
        "lifts_off": sum(after["normal"] <= 0 for _, after in pairs),
        "sliding": {f"{limit:g}": sum(_demand(after) > limit for _, after in pairs) for limit in FRICTIONS},
    }


def _demand(values):
    """The friction demand; what is not finite was without limit."""
    return float("inf") if values["demand"] is None else values["demand"]
