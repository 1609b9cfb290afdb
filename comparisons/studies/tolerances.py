"""The table of agreement tolerances, every row measured anew: how far is each engine, and what is it held to?"""

from __future__ import annotations

from typing import TYPE_CHECKING

from engines import ENGINES, get_engine

from ..measuring.tolerances import TABLE, measure_all
from ..running.study import Found, Study, say
from ..showing.parts import Section, Table, number

if TYPE_CHECKING:
    from ..running.provenance import Result
    from ..running.study import Ask, Plan


def plan(ask: Ask) -> Plan:
    """The plan of the study: rows of `TABLE`, where it is quick of default variants only, engine by engine."""
    results = []
    for engine in ask.engines:
        say(f"tolerances: {engine}")
        default = get_engine(engine).default_variant
        results += measure_all(
            [row for row in TABLE if row.engine == engine and (row.variant == default or not ask.quick)]
        )
    bounds = tuple(f"{ENGINES[name].tolerances}:TOLERANCES" for name in ask.engines if ENGINES[name].tolerances)
    yield from ()
    return Found({"engines": ask.engines, "quick": ask.quick}, results, solvers=bounds)


def problems(result: Result) -> list[str]:
    """Sentences on the rows that do not hold."""
    return [
        f"does not hold: {row['quantity']}, {row['engine']}, {row['variant']}, {row['scenes']}: "
        f"{row['failure'] or row['found']}, tolerated {row['bound']:g} {row['unit']}"
        for row in result.rows
        if not row["holds"]
    ]


def section(result: Result) -> Section:
    """The table as a section of the report."""
    broken = [row for row in result.rows if not row["holds"]]
    text = [
        f"{engine} states no tolerances, so none is measured."
        for engine in result.settings["engines"]
        if not any(row["engine"] == engine for row in result.rows)
    ]
    if result.rows:
        text = [
            f"{len(result.rows)} tolerances, each the assertion of a test; a bound is at most twice the worst measured "
            "when it was set, but for round-off.",
            "All of them hold." if not broken else f"{len(broken)} of them do not hold.",
            *text,
        ]
    rows = [
        [
            f"{row['engine']}, {row['variant']}: {row['quantity']}",
            row["scenes"],
            number(row["bound"], 2),
            number(row["measured"], 3),
            row["failure"] or number(row["found"], 3),
            row["unit"],
            "yes" if row["holds"] else "no",
            row["source"],
        ]
        for row in result.rows
    ]
    return Section(
        "Agreement tolerances",
        tuple(text),
        (
            Table(
                "Tolerances and what is measured",
                (
                    "engine, variant: quantity",
                    "scenes",
                    "tolerance",
                    "measured when set",
                    "measured now",
                    "unit",
                    "holds",
                    "where the error comes from",
                ),
                rows,
            ),
        ),
    )


STUDY = Study(
    "tolerances",
    "How far each engine is from the analytic model, beside what it is held to. Status 1: a row does not hold.",
    plan,
    lambda result: {},
    section,
    problems,
)
