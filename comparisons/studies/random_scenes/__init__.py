"""Random scenes within the range of a statue: how often is an engine right, and is every wrong run told?"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Annotated, Any

import typer

from analytic import simulate
from analytic.response import COMPARED, UNCOMPARED
from engines import get_engine
from engines.statue_range import RANGE, in_words

from ...measuring.statistics import wilson
from ...running.cases import Case
from ...running.provenance import commit_seed
from ...running.study import Batch, Found, Study
from ...showing.charts import Axis, Chart, figure
from ...showing.parts import Figure, Judgement, Mark, Section, Table, percent
from .scenes import random_scene

if TYPE_CHECKING:
    from analytic import Response

    from ...running.provenance import Result
    from ...running.study import Ask, Plan

CLASSES = ("right", "differs", "failed", "left out")
# scenes: of the engines' default variants, of others
FULL, QUICK = (500, 100), (20, 5)
TRUSTED = 0.95  # share of right runs, of those not left out


def plan(
    ask: Ask,
    *,
    seed: Annotated[int | None, typer.Option(min=0, max=2**63, help="Of the scenes; without it of the commit.")] = None,
) -> Plan:
    """The plan of the study: scenes of an ensemble that every commit draws anew; seed: of another one."""
    seed = commit_seed() if seed is None else seed
    most, fewer = QUICK if ask.quick else FULL
    scenes = [random_scene(seed, index) for index in range(most)]
    reached = [simulate(scene, history=False).peak_tilt_ratio >= RANGE["tilt"][0] for scene in scenes]
    cases = []
    for name in ask.engines:
        engine = get_engine(name)
        for variant in engine.variants:
            count = most if variant == engine.default_variant else fewer
            cases += [
                Case(scenes[k], name, variant, {"history": False, "compare": True}, {"index": k})
                for k in range(count)
                if reached[k]
            ]
    rows = yield Batch(cases, compared, "random scenes")
    found = [
        {
            "engine": row.case.solver,
            "variant": row.case.variant,
            "tier": get_engine(row.case.solver).variants[row.case.variant or ""].tier,
            **row.case.tag,
            **({"class": "failed", "failure": row.failure} if row.failed else row.values),
        }
        for row in rows
    ]
    settings = {"scenes": most, "below_range": reached.count(False), "range": in_words(), "quick": ask.quick}
    return Found(settings, found, seed=seed)


def compared(case: Case, response: Response) -> dict[str, Any]:
    """Measure: the class of a run, and in what it differs, or why it is left out."""
    word = "left out" if response.comparable not in (COMPARED, UNCOMPARED) else "right"
    return {
        "class": "differs" if response.differences and word == "right" else word,
        "comparable": response.comparable,
        "differences": [str(one) for one in response.differences],
        "quantities": [one.quantity for one in response.differences],
    }


def _counted(result: Result) -> dict[tuple[str, str, str], Counter]:
    """{(engine, variant, tier): how many of each class}."""
    found: dict[tuple[str, str, str], Counter] = {}
    for row in result.rows:
        found.setdefault((row["engine"], row["variant"], row["tier"]), Counter())[row["class"]] += 1
    return found


def _table(result: Result) -> Table:
    rows = []
    for (engine, variant, tier), count in _counted(result).items():
        judged = sum(count[word] for word in CLASSES[:3])
        low, high = wilson(count["right"], judged) if judged else (0.0, 1.0)
        share = f"{percent(count['right'] / judged)} ({percent(low)} to {percent(high)})" if judged else "–"
        rows.append([f"{engine}, {variant}", tier, *(str(count[word]) for word in CLASSES), share])
    return Table(
        "Random scenes in the range of a statue: right within 2 % of both peaks, .01 of the restitution, outcome and "
        "number of impacts",
        ("engine, variant", "tier", *CLASSES, "right, of those not left out"),
        rows,
    )


def _asked(result: Result) -> str:
    return (
        f"{result.settings['scenes']} scenes drawn at random (seed {result.provenance['seed']}, of the commit): "
        f"{result.settings['range']}; let go or under a pulse, until the outcome is decided. "
        f"{result.settings['below_range']} whose peak tilt stays below the range are not run. Left out: the normal "
        "force falls to 0 or no contact gives the friction demanded, or the scene is on an edge, where a change by "
        "1e-4 makes such a difference in the analytic model. "
    )


def section(result: Result) -> Section:
    """All that is known, every run that differs or fails among it."""
    wrong = [
        [f"{row['engine']}, {row['variant']}", str(row["index"]), "; ".join(row["differences"])]
        for row in result.rows
        if row["class"] == "differs" and row["tier"] != "defaults"
    ]
    failed = tuple(
        (
            f"{row['engine']}, {row['variant']}, scene {row['index']}: {row['failure']['reason']}",
            row["failure"]["message"],
        )
        for row in result.rows
        if row["class"] == "failed"
    )
    tables = [_table(result)]
    if wrong:
        tables.append(
            Table("Runs that differ, but for default settings", ("engine, variant", "scene", "in what"), wrong)
        )
    text = (_asked(result), _words(result), _TOLD)
    return Section("Random scenes", text, tuple(tables), (_figure(result),), evidence=failed)


def finding(result: Result) -> Section:
    """The answer: right, differs, failed, by engine and tier."""
    tuned: Counter = sum((count for (*_, tier), count in _counted(result).items() if tier == "tuned"), Counter())
    judged = sum(tuned[word] for word in CLASSES[:3])
    title = f"Random statues: {tuned['right']} of {judged} runs of tuned engines are right, {tuned['failed']} failed"
    return Section(title, (_TOLD,), (_table(result),), (_figure(result),), measured=(_asked(result),))


def _words(result: Result) -> str:
    """One sentence: how many are right."""
    told = [
        f"{engine}, {variant} {count['right']} of {sum(count[word] for word in CLASSES[:3])}"
        for (engine, variant, _), count in _counted(result).items()
    ]
    return f"Right are: {'; '.join(told)}."


def _figure(result: Result) -> Figure:
    counted = _counted(result)
    return figure([_chart(counted)], _CAPTION, [engine for engine, *_ in counted])


_TOLD = "Every run that differs is told as one, wherever it is shown."
_CAPTION = "Share of runs that differ from the analytic model or fail, with 95 % intervals; open: default settings."
LEAST = 0.1  # % that the axis begins at


def _chart(counted: dict[tuple[str, str, str], Counter]) -> Chart:
    """Share of the runs that are not right, a line each."""
    names = [f"{engine}, {variant}" for engine, variant, _ in counted]
    chart = Chart(
        Axis("runs that differ or fail [%]", LEAST, 100, "log", ((0.1, "≤ 0.1"), (1, "1"), (10, "10"), (100, "100"))),
        Axis("", len(names) - 0.5, -0.5, ticks=tuple(enumerate(names))),
        "Share of random scenes in which each engine differs from the analytic model or fails.",
        left=196,
        height=90 + 21 * len(names),
    )
    for k, ((engine, _, tier), count) in enumerate(counted.items()):
        judged = sum(count[word] for word in CLASSES[:3])
        if judged:
            wrong = judged - count["right"]
            share, low, high = (max(100 * value, LEAST) for value in (wrong / judged, *wilson(wrong, judged)))
            chart.reach([share], [k], [low], [high], engine, along="x")
            says = [f"{names[k]}: {wrong} of {judged}"]
            chart.dots([share], [k], engine, filled=tier != "defaults", says=says)
    return chart


def judgement(result: Result) -> Judgement:
    """The column of the decision table."""
    marks = {}
    for (engine, variant, _), count in _counted(result).items():
        judged = sum(count[word] for word in CLASSES[:3])
        if judged:
            share = count["right"] / judged
            level = "good" if share >= TRUSTED else "fair" if share >= 0.5 else "bad"
            marks[engine, variant] = Mark(f"{count['right']} of {judged}", level, f"{count['failed']} failed")
    return Judgement("random statues right", marks)


STUDY = Study(
    "random-scenes",
    "Random scenes in the range of a statue: how often is an engine right, and is every wrong run told?",
    plan,
    lambda result: {},
    section,
    finding=finding,
    judgement=judgement,
)
