"""The report's answer: stored studies, the table of trust, the first screen, and the runs made for it.

All of it comes from result files. `stored_studies` reads the studies' results and draws their pages. `setups_of` builds
the table of trust of all variants. `screen` builds the first screen: five lines, two charts, and the recommendation.
`summary` puts the outcomes of the report's own runs into sentences.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from operator import attrgetter
from pathlib import Path
from typing import Any, NamedTuple, Self

from engines import ENGINES, missing_words

from ..execution.by_solver import age, by_engine, date_of, last_check, origins_of, results_in
from ..execution.results import RESULTS, Result, ResultError
from ..execution.writing import readable
from ..plotting.glance import Endings, Glance, costs, endings
from ..plotting.parts import COST, RESTITUTION, Judgement, Mark, Section, grouped
from ..plotting.wording import listed, outcomes, rating, with_counts
from ..schemas.columns import number, percent
from ..studies import STUDIES, StudyBroken, get_study, study_names
from ..studies.rows import read_study
from .kept import digest_of, digest_of_code, kept


@dataclass(frozen=True)
class Stored:
    """A stored result of a study, drawn.

    section: the study's own page. finding: its section of the first page. judgements: its rows of the first table.
    glance: its part of the first screen. origin: machine, versions, date and commit in one line. variants: those of its
    settings, for `setups_of`. wrong: why it cannot be shown; "": it can. key: digest of what it is drawn from, under
    which it is kept (`comparisons.report.kept`); "": it is not kept.
    """

    name: str
    section: Section
    finding: Section | None = None
    judgements: tuple[Judgement, ...] = ()
    glance: Glance | None = None
    origin: str = ""
    variants: tuple[Mapping[str, Any], ...] = ()
    wrong: str = ""
    key: str = ""

    @classmethod
    def damaged(cls, name: str, title: str, words: str, **more: Any) -> Self:
        """Return a result that cannot be shown, with the reason in words."""
        return cls(name, Section(title, (words,), age=more.pop("age", None)), wrong=words, **more)


def stored_studies(
    folder: Path = RESULTS, progress: Callable[[int, int], object] = lambda done, total: None
) -> list[Stored]:
    """Return all results in `folder`, each a folder of files by solver, in the studies' order.

    A result that cannot be shown has the reason in `wrong`. progress : called with (results done, all results).
    """
    order = {name: place for place, name in enumerate(study_names())}
    paths = sorted(results_in(folder), key=lambda path: (order.get(path.name, len(order)), path.name))
    stored, code = [], digest_of_code()
    for path in paths:
        key = digest_of(path, code)
        stored.append(kept(key, partial(_stored, path, key), attrgetter("key")))
        progress(len(stored), len(paths))
    return stored


def variants_of(stored: Iterable[Stored], *more: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    """Return each variant once: `more`, and those that the studies know."""
    variants = [*more, *(variant for study in stored for variant in study.variants)]
    return list({(variant["engine"], variant["variant"]): variant for variant in reversed(variants)}.values())


def judgements_of(stored: Iterable[Stored]) -> list[Judgement]:
    """Return the rows of the first table. Judgements with the same heading are joined: each mark names all findings."""
    joined: dict[str, Judgement] = {}
    for judgement in (judgement for study in stored for judgement in study.judgements):
        first = joined.get(judgement.heading, replace(judgement, marks={}))
        new = {
            who: _joined(first.marks[who], mark) if who in first.marks else mark
            for who, mark in judgement.marks.items()
        }
        joined[judgement.heading] = replace(first, marks={**first.marks, **new})
    return list(joined.values())


def _joined(*marks: Mark) -> Mark:
    """Join marks of one solver: the words of the greatest error first, the level of the worst."""
    first, *others = sorted(marks, key=lambda mark: math.inf if mark.value is None else mark.value, reverse=True)
    words, notes = (
        "; ".join(parts) for parts in zip(*((mark.words, mark.note) for mark in (first, *others)), strict=True)
    )
    return replace(first, words=words, note=notes, level=max(marks, key=_badness).level)


def origin_of(result: Result) -> str:
    """Return date, commit, processor, versions and last check of a result in one line, by engine where they differ."""

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
    """Return the commit of a provenance, and whether there were uncommitted changes."""
    if origin["commit"] is None:
        return "outside a checkout"
    return origin["commit"][:12] + (", with uncommitted changes" if origin["dirty"] else "")


def _stored(path, key):
    """Draw a result. key: under which it is kept, if it can be shown and its study is of this project."""
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
        if glance and glance.curves:  # placing its names takes a while
            glance = replace(glance, chart=costs(glance.curves))
    except Exception as error:  # settings of another version, or another package's page: the report goes on
        words = f"{name} cannot be shown: its page fails ({readable(repr(error))}); --replot shows where."
        return Stored.damaged(name, f"Study {result.kind}", words, age=old, origin=origin)
    finding = finding and replace(finding, age=old)
    own = key if result.kind in STUDIES else ""
    return Stored(name, section, finding, judgements, glance, origin, variants, key=own)


def _variants(settings):
    """Return the variants in a result's settings, each with whether it is its engine's main variant ("best")."""
    mains = settings.get("default_variants", {})
    return tuple(
        {**variant, "best": mains[variant["engine"]] == variant["variant"]}
        for variant in settings.get("variants", ())
        if mains and variant["engine"] in mains
    )


# {level of a rating: its words}; part: good in all tests made, but tests are missing
LEVELS = {"good": "✓ trust", "part": "✓ as far as tested", "fair": "~ with care", "bad": "✗ do not trust"}
UNTESTED = Mark("not tested", "none")


@dataclass(frozen=True)
class Setup:
    """A variant with its marks.

    best: whether it is the engine's main variant. subject: `engines.contract.Engine.subject`. applies_impact: whether
    the adapter applies the model's equations of impact. marks: {heading of a `Judgement`: `Mark`}. rating: the worst of
    the marks that rate. cost: CPU time over the analytic model's, infinite where not measured.
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
        """Whether it is a column of the first table: a subject engine's main variant, or its defaults."""
        return self.subject and not self.applies_impact and (self.best or self.tier == "defaults")

    @property
    def command(self) -> str:
        return f"rocking run SCENE --engine {self.engine} --variant {self.variant}"

    @property
    def snippet(self) -> str:
        return f'get_engine("{self.engine}").simulate(scene, variant="{self.variant}")'


def setups_of(variants: Iterable[Mapping[str, Any]], judgements: Sequence[Judgement]) -> list[Setup]:
    """Return the variants that a study judges: the first table's, tuned before defaults; then by rating and cost.

    variants: dicts of engine, variant, kind (key "tier"), best and applies_impact.
    """
    setups = []
    for variant in variants:
        marks = {judgement.heading: _mark_of(judgement, variant) for judgement in judgements}
        if all(mark is UNTESTED for mark in marks.values()):
            continue
        fields = {key: variant[key] for key in ("engine", "variant", "tier", "best", "applies_impact")}
        subject = variant["engine"] in ENGINES and ENGINES[variant["engine"]].subject
        costs = [marks[judgement.heading].value for judgement in judgements if judgement.key == COST]
        rating = _rating([marks[judgement.heading] for judgement in judgements if judgement.rates])
        setups.append(
            Setup(**fields, subject=subject, marks=marks, rating=rating, cost=next(filter(None, costs), math.inf))
        )
    return sorted(setups, key=_order)


def _order(setup):
    if setup.in_first_table:
        return (0, setup.tier == "defaults", list(ENGINES).index(setup.engine), setup.cost)
    return (1, False, list(LEVELS).index(setup.rating.level), setup.cost)


def _mark_of(judgement, variant):
    """Return a study's mark of a variant; a study without variants marks the main variant under the name ""."""
    unnamed = judgement.marks.get((variant["engine"], ""), UNTESTED) if variant["best"] else UNTESTED
    return judgement.marks.get((variant["engine"], variant["variant"]), unnamed)


def _rating(marks):
    worst = list(LEVELS)[max(map(_badness, marks))]
    return Mark(LEVELS[worst], worst)


def _badness(mark):
    """Return the place of a mark's level among `LEVELS`; larger is worse."""
    return list(LEVELS).index(mark.level if mark.level in LEVELS else "part")


def own_restitution(block: Result, outside: str = "") -> Judgement:
    """Return the judgement on restitution of the scenes' own block in free rocking, in place of the study's.

    outside : warning of a scene outside the range of statues, "" without. There the error of restitution says little
    about the energy lost in an impact, so that no engine is rated.
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
        "rms error of restitution by states (tilt rate after an impact over that before), in free rocking of this "
        "block without slip",
        marks,
        RESTITUTION,
    )


def not_to_do(setups: Sequence[Setup]) -> list[str]:
    """Return warnings to users, each one line."""
    defaults = [setup for setup in setups if setup.tier == "defaults" and setup.rating.level in LEVELS]
    lines = []
    if defaults:
        bad = sum(setup.rating.level == "bad" for setup in defaults)
        lines.append(
            f"Do not use an engine with its defaults: of {len(defaults)} tested, {bad} got the rating “do not trust”."
        )
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
LEVEL = "Level"  # a line of the first screen
NOTHING = "", ""  # answer and details without a result


class Line(NamedTuple):
    """A line of the first screen: subject, id of the section of the page that it is from, answer, details."""

    subject: str
    section: str
    answer: str
    details: str


def screen(setups: Sequence[Setup], judgements: Sequence[Judgement], glances: Iterable[Glance]) -> dict[str, Any]:
    """Return the first screen for the page's template: title, lines, charts and tables of advice.

    Charts are None, and advice is empty, where no study has them.
    """
    given = list(glances)
    curves = next((glance for glance in given if glance.curves), None)
    shares = shown([ending for glance in given for ending in glance.endings], setups)
    says = {key: words for glance in given for key, words in glance.says.items()}
    if "cost" in says:
        answer, details = says["cost"]
        says["cost"] = answer, f"{_on_statues(given)} {details}".strip()
    return {
        "title": title(shares),
        "lines": lines(setups, judgements, shares, says),
        "scene": curves and curves.scene,
        "costs": curves and curves.chart,
        "endings": endings(shares) if shares else None,
        "advice": next((glance.advice for glance in given if glance.advice), ()),
    }


def shown(shares: Sequence[Endings], setups: Sequence[Setup]) -> list[Endings]:
    """Return the shares of the subject engines; of all engines where no subject engine was run.

    They stand by motion, then defaults before tuned variants, then in the order of the first table.
    """
    columns = [setup for setup in setups if setup.in_first_table] or setups
    places = {(setup.engine, setup.variant): place for place, setup in enumerate(columns)}
    kept = [share for share in shares if (share.engine, share.variant) in places]
    motions = list(dict.fromkeys(share.motions for share in kept))
    return sorted(
        kept, key=lambda share: (motions.index(share.motions), share.kind == TUNED, places[share.engine, share.variant])
    )


def title(shares: Sequence[Endings]) -> str:
    """Return the answer as a count of runs, if tuned engines and defaults were run; else the question."""
    counts = [_changed(_of_kind(shares, tier)) for tier in (TUNED, DEFAULTS)]
    if not all(runs for _, runs in counts):
        return QUESTION
    names = listed(list(dict.fromkeys(share.engine for share in _of_kind(shares, TUNED))))
    tuned, plain = (f"{changed} of {runs} runs ({percent(changed / runs, 2)})" for changed, runs in counts)
    return (
        f"Away from outcome boundaries, tuned {names} reach another outcome than the model, or fail, in {tuned}; with "
        f"defaults, in {plain}."
    )


def lines(
    setups: Sequence[Setup],
    judgements: Sequence[Judgement],
    shares: Sequence[Endings],
    says: Mapping[str, tuple[str, str]],
) -> list[Line]:
    """Return up to five lines; those without a result are left out."""
    found = [
        Line("Restitution (0 to 1)", "impact", *_restitution(setups, judgements, says.get("slip", NOTHING)[1])),
        Line("Outcomes", "recorded", *_outcomes(shares, says.get("matters", NOTHING)[1])),
        Line(LEVEL, "statues", *says.get("level", NOTHING)),
        Line("Cost", "speed-error", *says.get("cost", NOTHING)),
        Line("Real blocks", "shake-table", *says.get("real", NOTHING)),
    ]
    return [line for line in found if line.answer]


def _of_kind(shares, tier):
    return [share for share in shares if share.kind == tier]


def _changed(shares):
    """Return (runs with another outcome or none, all runs) of these shares together."""
    return sum(share.changed for share in shares), sum(share.runs for share in shares)


def _by_engine(counts):
    """Return {engine: words} as "3 (a) and 2 (b)"."""
    return listed([f"{words} ({engine})" for engine, words in counts.items()])


def _restitution(setups, judgements, slip):
    """Return the error of restitution from the first judgement on it, and what it is.

    slip: a sentence on impacts with slip, or "".
    """
    head = next((judgement.heading for judgement in judgements if judgement.key == RESTITUTION), None)
    columns = [setup for setup in setups if setup.in_first_table and head]
    parts = []
    begins = {TUNED: "at impacts, the rms error of tuned engines is", DEFAULTS: "That of engines with defaults is"}
    for tier, begin in begins.items():
        marks = {setup.engine: setup.marks[head] for setup in columns if setup.tier == tier}
        known = {engine: mark for engine, mark in marks.items() if mark.value is not None}
        if known:
            deaf = [engine for engine, mark in known.items() if "missed" in mark.words]
            failing = [engine for engine, mark in known.items() if "failed" in mark.words]
            also = f" ({listed(failing)} also fail{'s' * (len(failing) == 1)})" if failing else ""
            who = "both" if len(deaf) == len(known) == 2 else listed(deaf)
            missing = f", and {who} miss{'es' * (len(deaf) == 1)} impacts{also}" if deaf else ""
            parts.append(f"{begin} {_by_engine({who: number(mark.value, 2) for who, mark in known.items()})}{missing}.")
    return (" ".join(parts), f"Each value is the {head}. {slip}".strip()) if parts else NOTHING


def _on_statues(glances):
    """Return a sentence on how often the levels whose cost is given miss their accuracy on random statues; or ""."""
    missed = {key: counts for glance in glances for key, counts in glance.missed.items()}
    levels = [key for glance in glances for key in glance.levels]
    if not levels or not all(key in missed for key in levels):
        return ""
    counts = {engine: "{} of {}".format(*missed[engine, level]) for engine, level in levels}
    return f"On the random statues, the levels of this scene miss that accuracy on {_by_engine(counts)}."


def _outcomes(shares, matters):
    """Return how many outcomes differ under recorded motions, or the first ones, and sentences on times and others.

    matters: a sentence on what changes outcomes more than engines do, or "".
    """
    motions = next(
        (share.motions for share in shares if "record" in share.motions), shares[0].motions if shares else ""
    )
    first = [share for share in shares if share.motions == motions]
    groups = (
        (f"under {motions}, {{0}} reach another outcome than the model, or fail, in {{1}}", _changed_by_engine, first),
        (
            "{0} let the block fall at another time in {1} more runs",
            _late_by_engine,
            first if any(share.late for share in first) else [],
        ),
        (
            "Under all other motions, {0} reach another outcome, or fail, in {1}",
            _all_motions,
            [share for share in shares if share.motions != motions],
        ),
    )
    sentences = []
    for words, count, chosen in groups:
        kinds = [(who, _of_kind(chosen, kind)) for kind, who in WHO.items()]
        counts = [(who, count(members)) for who, members in kinds if members]
        if counts:
            first_words = words.format(*counts[0])
            begin = first_words[:1].upper() if sentences else first_words[:1]
            others = "".join(f"; {who}, in {runs}" for who, runs in counts[1:])
            sentences.append(f"{begin}{first_words[1:]}{others}.")
    if not sentences:
        return NOTHING
    return sentences[0], " ".join((*sentences[1:], *_limits(shares), matters)).strip()


def _limits(shares):
    """Yield sentences on what the counts do not say: limits, failures, and runs near a boundary."""
    tuned, plain = (_of_kind(shares, kind) for kind in WHO)
    if tuned:
        limits = sorted(share.interval[1] for share in tuned)
        yield (
            f"Runs share motions. By kind of motion, upper 95 % limits of tuned engines are {percent(limits[0], 2)} to "
            f"{percent(limits[-1], 2)}, with times of falls where these are compared."
        )
    if failed := sum(share.failed for share in plain):
        yield f"Of the runs with defaults that are counted, {failed} failed."
    if known := [share for share in tuned if share.left_differing is not None and share.left_out]:
        differing, out = (sum(getattr(share, name) for share in known) for name in ("left_differing", "left_out"))
        changed, runs = _changed(tuned)
        differing_all, runs_all = changed + differing, runs + out
        yield (
            f"Left out are runs near an outcome boundary: of those of tuned engines, {differing} of {out} differ; with "
            f"them, {differing_all} of {runs_all} ({percent(differing_all / runs_all, 2)}) do."
        )
    if unknown := sum(share.left_out for share in tuned if share.left_differing is None):
        yield f"For {unknown} further runs near a boundary it is not known."


WHO = {TUNED: "tuned engines", DEFAULTS: "engines with defaults"}


def _changed_by_engine(shares):
    return f"{_by_engine({share.engine: f'{share.changed} of {share.runs}' for share in shares})} runs"


def _late_by_engine(shares):
    return _by_engine({share.engine: str(share.late or 0) for share in shares})


def _all_motions(shares):
    """Return how many runs of all have another outcome or none; of tuned engines also under which motions."""
    changed, runs = _changed(shares)
    by_motions = {
        motions: _changed(members)[0] for (motions,), members in grouped(shares, lambda share: share.motions).items()
    }
    counts = [
        f"{'all' if count == changed else count} under {motions}"
        for motions, count in by_motions.items()
        if count and shares[0].kind == TUNED
    ]
    return f"{changed} of {runs} runs{f' ({listed(counts)})' if counts else ''}"


MOST_WARNINGS = 3  # of a scene, at the top of the page


def summary(scenes: Result, block: Result | None) -> list[str]:
    """Return sentences on outcomes, missing engines, and failed runs."""
    sentences = []
    for name, scene in scenes.settings["scenes"].items():
        rows = [row for row in scenes.rows if row["scene"] == name]
        sentences.append(
            f"{scene['name']}: {outcomes(rows)}.{_times(rows)}{_displacement(rows)}{_warning_sentence(rows)}"
        )
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


def _warning_sentence(rows):
    """Return the warnings of a scene's runs, each once; a table names the solvers that warn."""
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
    deviations = {solver: abs(peak / peaks["analytic"] - 1) for solver, peak in peaks.items() if solver != "analytic"}
    if deviations:
        worst = max(deviations, key=lambda solver: deviations[solver])
        text += f"; engines are off by up to {percent(deviations[worst])} ({worst})"
    return f"{text}."
