"""The first screen: what was found in three lines, two charts, and the one recommendation; from the studies alone."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from ..showing.glance import Endings, Glance, costs, endings, swatches
from ..showing.parts import RESTITUTION, Judgement, number
from ..showing.wording import listed
from .answer import Setup

QUESTION = "How far can a multibody engine be trusted with a rocking body, and at what cost?"
TUNED, DEFAULTS = "tuned", "defaults"
HOW = ((TUNED, "tuned"), (DEFAULTS, "with defaults"))
KINDS = ((TUNED, "tuned engines"), (DEFAULTS, "defaults"))
WAYS = ("missed", "added")


def screen(setups: Sequence[Setup], judgements: Sequence[Judgement], glances: Iterable[Glance]) -> dict[str, Any]:
    """What the page's template is given: title, lines, charts and advice; charts and advice None where no study has
    them."""
    found = list(glances)
    curves = next((one for one in found if one.curves), None)
    shares = shown([one for glance in found for one in glance.endings], setups)
    says = {key: words for glance in found for key, words in glance.says.items()}
    return {
        "title": title(setups),
        "lines": lines(setups, judgements, shares, says),
        "scene": curves and curves.scene,
        "costs": curves and costs(curves.curves),
        "endings": endings(shares) if shares else None,
        "swatches": swatches(shares),
        "advice": next((one.advice for one in found if one.advice), None),
    }


def shown(found: Sequence[Endings], setups: Sequence[Setup]) -> list[Endings]:
    """Those of the engines in question in the order of the first table, of each kind of motion: defaults first."""
    columns = {(one.engine, one.variant): place for place, one in enumerate(setups) if one.in_first_table}
    kept = [one for one in found if (one.engine, one.variant) in columns]
    motions = list(dict.fromkeys(one.motions for one in kept))
    return sorted(
        kept, key=lambda one: (motions.index(one.motions), one.kind == TUNED, columns[one.engine, one.variant])
    )


def title(setups: Sequence[Setup]) -> str:
    """The answer in a sentence, where it is as clear as that; else the question."""
    levels = {tier: {one.rating.level for one in _columns(setups, tier)} for tier in (TUNED, DEFAULTS)}
    if levels[TUNED] and levels[DEFAULTS] == {"bad"} and "bad" not in levels[TUNED]:
        return "By default, a physics engine often misjudges a rocking block; tuned, it seldom does."
    return QUESTION


def lines(
    setups: Sequence[Setup], judgements: Sequence[Judgement], shares: Sequence[Endings], says: Mapping[str, str]
) -> list[list[tuple[str, str]]]:
    """Three lines, each of (what it is about, a sentence): restitution; outcomes; cost, and real blocks. What no study
    tells is left out."""
    found = [
        [("Restitution", _restitution(setups, judgements))],
        [("Outcomes", _outcomes(shares))],
        [("Cost", says.get("cost", "")), ("Real blocks", says.get("real", ""))],
    ]
    told = [[pair for pair in line if pair[1]] for line in found]
    return [line for line in told if line]


def _columns(setups, tier):
    return [one for one in setups if one.in_first_table and one.tier == tier]


def _restitution(setups, judgements):
    """How far the restitution is off, in the first study that tells it."""
    head = next((one.heading for one in judgements if one.key == RESTITUTION), None)
    parts = []
    for tier, how in HOW if head else ():
        marks = {one.engine: one.marks[head] for one in _columns(setups, tier)}
        known = {engine: mark for engine, mark in marks.items() if mark.value is not None}
        deaf = [engine for engine, mark in known.items() if "missed" in mark.words]
        who = "both" if len(deaf) == len(known) == 2 else listed(deaf)
        missed = f", and {who} miss{'es' * (len(deaf) == 1)} impacts" if deaf else ""
        if known:
            errors = listed([f"{number(mark.value, 2)} in {engine}" for engine, mark in known.items()])
            begin = f"{how.capitalize()}, it is" if parts else f"{how}, the coefficient (between 0 and 1) is"
            parts.append(f"{begin} off by {errors}{'' if parts else ' (rms)'}{missed}.")
    return " ".join(parts)


def _outcomes(shares):
    """How many runs end otherwise under recorded motions, or under the first others that were run; and which way."""
    motions = next((one.motions for one in shares if "record" in one.motions), shares[0].motions if shares else "")
    parts = []
    for tier, who in KINDS:
        some = [one for one in shares if one.motions == motions and one.kind == tier]
        if some:
            differ = listed([f"{one.differing} of {one.runs} ({one.engine})" for one in some])
            first = f"under {motions}, {who} differ from the model or fail in {differ} runs"
            parts.append(f"{who} in {differ}" if parts else first)
    if not parts:
        return ""
    ways = []
    for tier, who in KINDS:
        missed, added = (sum(getattr(one, way) for one in shares if one.kind == tier) for way in WAYS)
        if missed or added:
            ways.append(f"{who} miss {missed}{'' if ways else ' overturnings'} and add {added}")
    over = f" Over all motions, {'; '.join(ways)}." if ways else ""
    return f"{'; '.join(parts)}.{over}"
