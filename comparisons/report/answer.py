"""The answers of all studies side by side, and what not to do; from results alone: the studies' stored ones, of which
it also has what stands on the first page and on pages of their own.

The first screen: what was found in five lines, two charts, and the one recommendation; from the studies alone.

What the report's own runs found, in sentences.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Self

from engines import ENGINES, missing_words

from ..execution.by_solver import age, by_engine, date_of, last_check, origins_of, results_in
from ..execution.files import readable
from ..execution.provenance import RESULTS, Result, ResultError
from ..plotting.glance import Advised, Endings, Glance, Peaks, costs, endings, swatches
from ..plotting.parts import COST, RESTITUTION, Judgement, Mark, Section, Table, grouped
from ..plotting.wording import listed, outcomes, rating, with_counts
from ..schemas.columns import number, percent
from ..studies import StudyBroken, get_study, study_names
from ..studies.rows import read_study


@dataclass(frozen=True)
class Stored:
    """One result. section: all of it; finding: its answer for the first page; judgements: its rows of the first
    table; glance: what the first screen has of it.

    wrong: why it cannot be shown, "" where it can. origin: machine, versions, date and commit in one line. variants:
    those it knows, as `setups_of` takes them.
    """

    name: str
    section: Section
    finding: Section | None = None
    judgements: tuple[Judgement, ...] = ()
    glance: Glance | None = None
    origin: str = ""
    variants: tuple[Mapping[str, Any], ...] = ()
    wrong: str = ""

    @classmethod
    def damaged(cls, name: str, title: str, words: str, **more: Any) -> Self:
        """One of which nothing but why can be shown."""
        return cls(name, Section(title, (words,), age=more.pop("age", None)), wrong=words, **more)


def stored_studies(
    folder: Path = RESULTS, progress: Callable[[int, int], object] = lambda done, total: None
) -> list[Stored]:
    """All results in `folder`, each a folder of files by solver, in the studies' order; one that cannot be shown says
    why.

    progress : is called with how many of them are done, of how many.
    """
    order = {name: place for place, name in enumerate(study_names())}
    found = sorted(results_in(folder), key=lambda path: (order.get(path.name, len(order)), path.name))
    stored = []
    for path in found:
        stored.append(_stored(path))
        progress(len(stored), len(found))
    return stored


def variants_of(stored: Iterable[Stored], *more: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    """Each variant once: `more`, and those that the studies know."""
    listed = [*more, *(variant for one in stored for variant in one.variants)]
    return list({(one["engine"], one["variant"]): one for one in reversed(listed)}.values())


def judgements_of(stored: Iterable[Stored]) -> list[Judgement]:
    """The rows of the first table. Where studies have one of the same heading it says what each found."""
    found: dict[str, Judgement] = {}
    for each in (each for one in stored for each in one.judgements):
        known = found.setdefault(each.heading, each)
        both = known.marks.keys() & each.marks.keys() if known is not each else set()
        marks = {who: _together(known.marks[who], each.marks[who]) for who in both}
        found[each.heading] = replace(known, marks={**known.marks, **each.marks, **marks})
    return list(found.values())


def _together(*marks: Mark) -> Mark:
    """Marks of one solver as one: the greatest error first, the level of the worst."""
    first, *others = sorted(marks, key=lambda one: math.inf if one.value is None else one.value, reverse=True)
    words, notes = ("; ".join(some) for some in zip(*((one.words, one.note) for one in (first, *others)), strict=True))
    return replace(first, words=words, note=notes, level=max(marks, key=_level).level)


def origin_of(result: Result) -> str:
    """Date, commit, processor, versions and the last check, in one line; of engines run apart from the rest, theirs."""

    def words(origin):
        return ", ".join((date_of(origin), f"commit {commit_of(origin)}", origin["machine"]["processor"]))

    used = dict.fromkeys(
        f"{name} {version}"
        for origin in origins_of(result).values()
        for name, version in origin["packages"].items()
        if version
    )
    return "; ".join(filter(None, (by_engine(result, words), ", ".join(used), last_check(result))))


def commit_of(origin: Mapping[str, Any]) -> str:
    """The commit of a provenance, and whether there was more than that."""
    if origin["commit"] is None:
        return "outside a checkout"
    return origin["commit"][:12] + (", with uncommitted changes" if origin["dirty"] else "")


def _stored(path):
    name = path.name
    try:
        result = read_study(path)
        if not f"{name}-".startswith(f"{result.kind}-"):  # <study>-<part> where a study has several
            raise ResultError(f"a result of {result.kind}; call its folder {result.kind}")
    except ResultError as error:
        why = readable(error).removeprefix(f"{name}: ")
        return Stored.damaged(name, f"Study {name}", f"{name} cannot be shown: {why}")
    old, origin = age(result), origin_of(result)
    try:
        study = get_study(result.kind)
    except (KeyError, StudyBroken) as error:
        words = f"{name} cannot be shown: {error.args[0]}."
        return Stored.damaged(name, f"Study {result.kind}", words, age=old, origin=origin)
    try:
        page = study.page(result)  # drawn once
        judgements, variants, glance = study.judgements(result), _variants(result.settings), study.glance(result)
        section, finding = replace(page.whole(), age=old), page.opening()
    except Exception as error:  # settings of another version, or another package's page: the report goes on
        words = f"{name} cannot be shown: its page fails ({readable(repr(error))}); --replot shows where."
        return Stored.damaged(name, f"Study {result.kind}", words, age=old, origin=origin)
    finding = finding and replace(finding, age=old)
    return Stored(name, section, finding, judgements, glance, origin, variants)


def _variants(settings):
    """The variants that settings list with their engine's default one."""
    best = settings.get("default_variants", {})
    return tuple(
        {**one, "best": best[one["engine"]] == one["variant"]}
        for one in settings.get("variants", ())
        if best and one["engine"] in best
    )


# part: good in all that was tested, and something was not
LEVELS = {"good": "✓ trust", "part": "✓ as far as tested", "fair": "~ with care", "bad": "✗ do not trust"}
UNTESTED = Mark("not tested", "none")


@dataclass(frozen=True)
class Setup:
    """A variant with its marks, {heading of a `Judgement`: its `Mark`}, and its rating, the worst of those that rate.

    best: the engine's main variant. subject: `engines.contract.Engine.subject`. applies_impact: the adapter applies
    the model's equations. cost: CPU time over the analytic model's, infinite where not measured.
    """

    engine: str
    variant: str
    tier: str
    best: bool
    subject: bool
    applies_impact: bool
    marks: Mapping[str, Mark]
    rating: Mark
    cost: float

    @property
    def in_first_table(self) -> bool:
        """Whether it is a column of the first table: a subject engine as a user takes it, tuned or by default."""
        return self.subject and not self.applies_impact and (self.best or self.tier == "defaults")

    @property
    def command(self) -> str:
        return f"rocking run SCENE --engine {self.engine} --variant {self.variant}"

    @property
    def snippet(self) -> str:
        return f'get_engine("{self.engine}").simulate(scene, variant="{self.variant}")'


def setups_of(variants: Iterable[Mapping[str, Any]], judgements: Sequence[Judgement]) -> list[Setup]:
    """The variants that any study judges: those of the first table first (tuned, defaults); then by rating and cost.

    variants: dicts of engine, variant, kind (key "tier"), best and applies_impact.
    """
    found = []
    for one in variants:
        marks = {each.heading: _mark(each, one) for each in judgements}
        if all(mark is UNTESTED for mark in marks.values()):
            continue
        how = {key: one[key] for key in ("engine", "variant", "tier", "best", "applies_impact")}
        subject = one["engine"] in ENGINES and ENGINES[one["engine"]].subject
        costs = [marks[each.heading].value for each in judgements if each.key == COST]
        rated = _rating([marks[each.heading] for each in judgements if each.rates])
        found.append(Setup(**how, subject=subject, marks=marks, rating=rated, cost=next(filter(None, costs), math.inf)))
    return sorted(found, key=_place)


def _place(one):
    if one.in_first_table:
        return (0, one.tier == "defaults", list(ENGINES).index(one.engine), one.cost)
    return (1, False, list(LEVELS).index(one.rating.level), one.cost)


def _mark(judgement, one):
    """A study's mark of a variant; a study without variants has marks of the main variant without a name."""
    unnamed = judgement.marks.get((one["engine"], ""), UNTESTED) if one["best"] else UNTESTED
    return judgement.marks.get((one["engine"], one["variant"]), unnamed)


def _rating(marks):
    worst = list(LEVELS)[max(map(_level, marks))]
    return Mark(LEVELS[worst], worst)


def _level(mark):
    """How bad a mark is: the place of its level among `LEVELS`."""
    return list(LEVELS).index(mark.level if mark.level in LEVELS else "part")


def own_restitution(block: Result, outside: str = "") -> Judgement:
    """Restitution of the scenes' own block, from its free rocking; takes the place of the study's.

    outside : the warning of a scene outside the range of a statue; the error of the restitution then says little on the
    loss in an impact.
    """
    marks = {
        (row["engine"], row["variant"]): Mark(
            with_counts(number(row["rms"], 2), {"failed": row["failed"], "missed": row["lost"]}),
            "part" if outside else rating(row["rms"], row["failed"] + row["lost"]),
            f"{row['impacts']} impacts, worst {number(row['worst'], 2)}",
            row["rms"],
        )
        for row in block.rows
        if row["engine"] != "analytic"
    }
    return Judgement(
        "error of restitution by states (tilt rates before and after impacts of this block without slip), rms, free "
        "rocking",
        marks,
        RESTITUTION,
    )


def not_to_do(setups: Sequence[Setup]) -> list[str]:
    """Three lines at most."""
    defaults = [one for one in setups if one.tier == "defaults" and one.rating.level in LEVELS]
    lines = []
    if defaults:
        bad = sum(one.rating.level == "bad" for one in defaults)
        lines.append(f"Do not use an engine with its defaults: {bad} of {len(defaults)} tested are not to be trusted.")
    lines.append(
        "Do not rely on an outcome whose margin (rocking margin SCENE) is smaller than the uncertainty of your data."
    )
    lines.append(
        "Do not compare tilts point by point beyond the sensitivity horizon. Trust a level only if a finer one gives "
        "the same result."
    )
    return lines


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
            _all_motions,
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


def _all_motions(shares):
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


MOST_WARNINGS = 3  # of a scene, at the top of the page


def summary(scenes: Result, block: Result | None) -> list[str]:
    """Sentences, list of str: outcomes, engines that are missing, runs that failed."""
    sentences = []
    for name, scene in scenes.settings["scenes"].items():
        rows = [row for row in scenes.rows if row["scene"] == name]
        sentences.append(f"{scene['name']}: {outcomes(rows)}.{_times(rows)}{_displacement(rows)}{_warned(rows)}")
    sentences += [f"Not in this report: {words}." for words in missing_words(scenes.settings["missing"])]
    failed = [
        f"{row['engine']} on {row['scene']} ({row['failure']['reason']})" for row in scenes.rows if row["failure"]
    ]
    failed += [
        f"{row['failed']} of free rocking in {row['engine']}, {row['variant']} ({row['failures'][0]['reason']})"
        for row in (block.rows if block else ())
        if row["failed"]
    ]
    if failed:
        sentences.append("Failed runs: " + "; ".join(failed) + ".")
    return sentences


def _warned(rows):
    """The warnings of a scene's runs, each once; the table beside the outcomes says whose they are."""
    warnings = list(dict.fromkeys(warning["text"] for row in rows for warning in row.get("warnings", ())))
    if not warnings:
        return ""
    more = f"; {len(warnings) - MOST_WARNINGS} more in the table of warnings" if len(warnings) > MOST_WARNINGS else ""
    return f" Warning: {'; '.join(text.rstrip('.') for text in warnings[:MOST_WARNINGS])}{more}."


def _times(rows):
    times = [row["overturning_time"] for row in rows if row.get("overturning_time") is not None]
    if not times:
        return ""
    low, high = number(min(times), 4), number(max(times), 4)
    return f" Overturning at {low if low == high else f'{low} to {high}'} s."


def _displacement(rows):
    peaks = {row["engine"]: row["peak_base_displacement"] for row in rows if row.get("peak_base_displacement")}
    if "analytic" not in peaks:
        return ""
    text = f" In the model the base moves by at most {number(peaks['analytic'], 4)} m"
    apart = {solver: abs(peak / peaks["analytic"] - 1) for solver, peak in peaks.items() if solver != "analytic"}
    if apart:
        worst = max(apart, key=lambda solver: apart[solver])
        text += f"; engines are off by up to {percent(apart[worst])} ({worst})"
    return f"{text}."
