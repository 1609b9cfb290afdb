"""The first screen: what was found in five lines, two charts, and the one recommendation; from the studies alone."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from ..showing.glance import Advised, Endings, Glance, Peaks, costs, endings, swatches
from ..showing.parts import RESTITUTION, Judgement, Table, grouped, number, percent
from ..showing.wording import listed
from .answer import Setup

QUESTION = "How far can a multibody engine be trusted with a rocking body, and at what cost?"
TUNED, DEFAULTS = "tuned", "defaults"


def screen(setups: Sequence[Setup], judgements: Sequence[Judgement], glances: Iterable[Glance]) -> dict[str, Any]:
    """What the page's template is given: title, lines, charts and tables of advice; charts None and no advice where no
    study has them."""
    found = list(glances)
    curves = next((one for one in found if one.curves), None)
    shares = shown([one for glance in found for one in glance.endings], setups)
    says = {key: words for glance in found for key, words in glance.says.items()}
    advised = next((one for one in found if one.advice), None)
    return {
        "title": title(shares),
        "lines": lines(setups, judgements, shares, says),
        "scene": curves and curves.scene,
        "costs": curves and costs(curves.curves),
        "endings": endings(shares) if shares else None,
        "swatches": swatches(shares),
        "advice": advice(advised, [one for glance in found for one in glance.peaks]) if advised else [],
    }


def shown(found: Sequence[Endings], setups: Sequence[Setup]) -> list[Endings]:
    """Those of the engines in question in the order of the first table, of each kind of motion: defaults first; of all
    engines where none of these was run."""
    asked = [one for one in setups if one.in_first_table] or setups
    columns = {(one.engine, one.variant): place for place, one in enumerate(asked)}
    kept = [one for one in found if (one.engine, one.variant) in columns]
    motions = list(dict.fromkeys(one.motions for one in kept))
    return sorted(
        kept, key=lambda one: (motions.index(one.motions), one.kind == TUNED, columns[one.engine, one.variant])
    )


def title(shares: Sequence[Endings]) -> str:
    """The answer as a count of runs, where tuned engines and defaults were run; else the question."""
    counts = [_changed(_tier(shares, tier)) for tier in (TUNED, DEFAULTS)]
    if not all(runs for _, runs in counts):
        return QUESTION
    names = listed(list(dict.fromkeys(one.engine for one in _tier(shares, TUNED))))
    tuned, plain = (f"{changed} of {runs}" for changed, runs in counts)
    return (
        f"Away from outcome boundaries, tuned {names} end otherwise than the model, or fail, in {tuned} runs; with "
        f"defaults, in {plain}."
    )


def lines(
    setups: Sequence[Setup], judgements: Sequence[Judgement], shares: Sequence[Endings], says: Mapping[str, str]
) -> list[tuple[str, str]]:
    """Five lines, each (what it is about, its sentences). What no study tells is left out."""
    near = " ".join(filter(None, (_left_out(shares), says.get("near", ""))))
    found = [
        ("Restitution", _restitution(setups, judgements)),
        ("Outcomes", _outcomes(shares)),
        ("Near outcome boundaries", near),
        ("Cost", says.get("cost", "")),
        ("Real blocks", says.get("real", "")),
    ]
    return [pair for pair in found if pair[1]]


def advice(found: Glance, peaks: Sequence[Peaks]) -> list[Table]:
    """The recommendation by accuracy, and what its levels give elsewhere: in other scenes, and in the runs of `peaks`,
    of which most are at another level."""
    kept = [one for one in found.advice if one.engine]
    names, scenes = listed(found.asked), list(dict.fromkeys(scene for one in kept for scene in one.elsewhere))
    first = Table(
        f"What to use of {names}, tuned. Judged in one scene ({found.scene}): the cheapest level that, as all finer "
        "ones, keeps peak tilt over slenderness, and the overturning boundary of pulses, this accurate. Costs "
        f"within a factor of {number(found.alike, 2)} are the same; then each engine is named",
        ("accuracy", "engine", "level", "CPU time per simulated second", "command"),
        [
            [percent(one.accuracy, 1), one.engine, one.setting, f"{number(1e3 * one.cost, 2)} ms", one.command]
            if one.engine
            else [percent(one.accuracy, 1), "not reached", "–", "–", "–"]
            for one in found.advice
        ],
    )
    motions = list(dict.fromkeys(one.motions for one in peaks))
    second = Table(
        "The same levels elsewhere: error of peak tilt over slenderness in other scenes, and runs within the accuracy. "
        "Under recorded motions engines were run at one level",
        ("accuracy", "engine, level", *scenes, *motions),
        [
            [
                percent(one.accuracy, 1),
                f"{one.engine}, {one.setting}",
                *(_missed(one, one.elsewhere.get(scene)) for scene in scenes),
                *(_runs_within(one, [peak for peak in peaks if peak.motions == name]) for name in motions),
            ]
            for one in kept
        ],
    )
    return [first, *([second] if kept and (scenes or motions) else [])]


def _missed(one: Advised, error: float | None) -> str:
    words = percent(error)
    return f"{words}: missed" if error is None or error > one.accuracy else words


def _runs_within(one, peaks):
    """Runs of an advised level within its accuracy; where it was not run, those of the variant's level that was."""
    mine = [peak for peak in peaks if (peak.engine, peak.variant) == (one.engine, one.variant)]
    if not mine:
        return "not run"
    here = next((peak for peak in mine if peak.level == one.level), None)
    return here.within(one.accuracy) if here else f"not run; at {mine[0].setting}: {mine[0].within(one.accuracy)}"


def _tier(shares, tier):
    return [one for one in shares if one.kind == tier]


def _changed(shares):
    """(runs with another outcome or none, runs) of all of them."""
    return sum(one.changed for one in shares), sum(one.runs for one in shares)


def _by_engine(counts):
    """ "3 (a) and 2 (b)" of {engine: words}."""
    return listed([f"{words} ({engine})" for engine, words in counts.items()])


def _restitution(setups, judgements):
    """How far the restitution is off, in the first study that tells it."""
    head = next((one.heading for one in judgements if one.key == RESTITUTION), None)
    parts = []
    for tier, how, begin in (
        (TUNED, "Tuned", "tuned engines are off by"),
        (DEFAULTS, "With defaults", "With defaults they are off by"),
    ):
        marks = {one.engine: one.marks[head] for one in setups if one.in_first_table and one.tier == tier and head}
        known = {engine: mark for engine, mark in marks.items() if mark.value is not None}
        if known:
            parts.append(f"{begin} {_by_engine({engine: number(mark.value, 2) for engine, mark in known.items()})}.")
        deaf = [engine for engine, mark in known.items() if "missed" in mark.words]
        if deaf:
            who = "both" if len(deaf) == len(known) == 2 else listed(deaf)
            parts.append(f"{how}, impacts are missed by {who}.")
    return f"{' '.join(parts)} This is the {head}; restitution lies between 0 and 1." if parts else ""


def _outcomes(shares):
    """How many runs end otherwise under recorded motions, or under the first others that were run, and under all of the
    others together."""
    motions = next((one.motions for one in shares if "record" in one.motions), shares[0].motions if shares else "")
    here = [one for one in shares if one.motions == motions]
    found = (
        (f"under {motions} the outcome is another or the run fails", _ends, here),
        ("Engine and model both overturn, but at another time", _late, here if any(one.late for one in here) else []),
        (
            "Under all other motions the outcome is another or the run fails",
            _together,
            [one for one in shares if one.motions != motions],
        ),
    )
    told = []
    for words, count, chosen in found:
        tiers = ((how, _tier(chosen, tier)) for tier, how in ((TUNED, "tuned"), (DEFAULTS, "with defaults")))
        if parts := [f"{how}, in {count(some)}" for how, some in tiers if some]:
            told.append(f"{words}: {'; '.join(parts)}.")
    return " ".join(told)


def _ends(shares):
    return _by_engine({one.engine: f"{one.changed} of {one.runs}" for one in shares})


def _late(shares):
    return f"{_by_engine({one.engine: one.late or 0 for one in shares})} more"


def _together(shares):
    """Of all of them, and under which motions those of tuned engines are."""
    changed, runs = _changed(shares)
    by_motions = {motions: _changed(some)[0] for (motions,), some in grouped(shares, lambda one: one.motions).items()}
    told = [f"{count} under {motions}" for motions, count in by_motions.items() if count and shares[0].kind == TUNED]
    return f"{changed} of {runs}{f' ({listed(told)})' if told else ''}"


def _left_out(shares):
    """How many runs of tuned engines are left out above, by motion."""
    told = []
    for (motions,), some in grouped(_tier(shares, TUNED), lambda one: one.motions).items():
        counts = dict.fromkeys(f"{one.left_out} of {one.runs + one.left_out}" for one in some)
        told.append(f"{' or '.join(counts)} ({motions})")
    return f"the counts above leave out, of the runs of each tuned engine, {listed(told)}." if told else ""
