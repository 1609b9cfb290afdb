"""The answers of all studies side by side, and what not to do; from results alone: the studies' stored ones, of which
it also has what stands on the first page and on pages of their own.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Self

from engines import ENGINES

from ..running.age import age, by_engine, date_of, last_check, origins_of
from ..running.by_solver import results_in
from ..running.provenance import RESULTS, Result, ResultError
from ..running.readable import readable
from ..showing.glance import Glance
from ..showing.parts import COST, RESTITUTION, Judgement, Mark, Section, number
from ..showing.wording import rating, with_counts
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
