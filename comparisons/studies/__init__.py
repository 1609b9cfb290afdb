"""The studies: each answers one question from many runs, as one `comparisons.execution.plan.Study`.

A study is a folder of its name with two files, ``study.py`` and ``page.py``, and a line of `QUESTIONS`. Another
file holds another subject, such as its cases.

``study.py`` computes, and imports nothing that draws. It declares the columns of its rows, ``COLUMNS``, and by ``part``
(what a row is) which of them a row has, ``PARTS``; see `comparisons.schemas.columns`, `comparisons.studies.rows`. Its
``plan(request)`` yields a `Batch` of cases with their ``measure``, and returns `Computed`: plain rows and settings. It
may also have ``problems`` and ``WHOLE``, see `Study`. All rows have ``engine`` and ``variant``; ``level`` is a value of
the accuracy parameter. Settings list ``variants``, each with engine, variant, ``tier`` (its kind), parameter, default
and levels.

    COLUMNS = SHARED | declared(number_of("rms", "error of restitution, rms", "over impacts"), ...)
    PARTS = {"summary": "engine variant ground slenderness rms? failed runs"}

``page.py`` shows: one function from a `Result` to a `comparisons.plotting.parts.Page`. The report's first page shows
title, lead and first; the study's own page shows all of it. Nothing is said or drawn twice.

    ERROR, GAMMA = COLUMNS["rms"], COLUMNS["slenderness"]  # columns of tables and axes of figures

    def page(result):
        rows = where(result.rows, part="summary")
        return Page(
            "One impact: 6 of 13 variants reproduce restitution to within 0.001",
            ("What the question is, in two sentences.",),
            first=(lines(rows, GAMMA, ERROR, "What to look at.", panel="ground", log="y"),
                   table("Least error first", rows, NAME, ERROR, Column("failed", "{failed} of {runs}"))),
            more=(Head("Base mass"), shades(rows, BASE, GAMMA, ERROR, "...", bounds=(1e-3, 1e-2), panel=NAME.of)),
            how=("What was run, and how it is measured.",),
        )

The layer: `comparisons.plotting.parts` (where, grouped, table), `comparisons.plotting.figures` (lines, shades,
beside); what they cannot draw is a `comparisons.plotting.charts.Chart`. The page is imported only where it is shown.

Other packages declare theirs in the entry point group `rocking.studies`; an entry resolves to a `Study` of its name.
"""

from __future__ import annotations

from importlib import import_module
from importlib.metadata import entry_points
from typing import TYPE_CHECKING

from analytic.errors import SettingError

if TYPE_CHECKING:  # it loads engines, which the names alone do not need
    from ..execution.plan import Study

GROUP = "rocking.studies"
PACKAGE = "comparisons.studies"
# {name: its question}, in the order of the report and of its first table. The first sentence is the line of the study
# in ``rocking study --help``: at most 60 characters.
QUESTIONS = {
    "restitution": (
        "Errors of the restitution at an impact, and their causes. How do the errors of restitution and of the base "
        "velocity jump depend on slenderness, base mass and level, and what does a run cost?"
    ),
    "overturning": (
        "Overturning boundaries under pulses. Where does each solver put them, on rigid ground and isolated?"
    ),
    "recorded": "Outcomes under recorded motions. Does an engine overturn the same blocks as the analytic model?",
    "fragility": (
        "Probability of overturning over intensity. Does a lognormal curve fit, and does the engine shift it?"
    ),
    "shake-table": (
        "Predictions of shake-table tests. How often are the model, the engines and simpler measures right?"
    ),
    "sensitivity": (
        "Effects that change the outcome more than engines do. How often is it changed by vertical motion, or by one "
        "per cent of slenderness?"
    ),
    "statues": (
        "Statues drawn at random in the promised range. How often is an engine right, with and without friction? "
        "Where are its overturning boundaries, and is every wrong run reported?"
    ),
    "stack": (
        "A statue on a free pedestal: two blocks on each other. Are engines right, what falls first and when, and is "
        "the answer always unique?"
    ),
    "stability": (
        "Hard cases in every solver and variant. Is each right, different or failed, by which measures, and do finer "
        "levels help?"
    ),
    "speed-error": (
        "Error and CPU time of the same runs. They are compared for the kernel, scipy, time stepping, Bouc-Wen, and "
        "the engines and their variants."
    ),
    "caryatid": (
        "The Caryatid paper, reproduced or corrected. Every equation, figure and table is checked, and so is what the "
        "paper leaves out."
    ),
    "mistakes": (
        "The cost of typical mistakes in an engine's script. Each script models a rocking block in the engine's own "
        "calls, with one mistake."
    ),
}
BUILT_IN = tuple(QUESTIONS)
TOLERANCES = "tolerances"  # a result that is shown as a study's, but computed by rocking verify
STUDIES = (*BUILT_IN, TOLERANCES)
# What a study.py may have beside its plan: {its name there: the field of `Study`}.
OWN = {"COLUMNS": "columns", "PARTS": "parts", "problems": "problems", "WHOLE": "whole"}


class StudyBroken(SettingError):
    """Raised where a study that another package declares cannot be used; the message names the package."""


def study_names() -> tuple[str, ...]:
    """Return the names of all studies, those of this project first, each once."""
    return tuple(dict.fromkeys([*BUILT_IN, *sorted(entry.name for entry in entry_points(group=GROUP))]))


def get_study(name: str) -> Study:
    """Return the `Study` called `name`.

    Raises
    ------
    KeyError
        The name is unknown; the message lists the known ones.
    StudyBroken
        Another package declares it, and it cannot be used.
    """
    from ..execution.plan import Study

    if name in QUESTIONS:
        package = f"{PACKAGE}.{name.replace('-', '_')}"
        module = import_module(f"{package}.study")
        optional = {field: getattr(module, constant) for constant, field in OWN.items() if hasattr(module, constant)}
        return Study(name, QUESTIONS[name], module.plan, f"{package}.page", **optional)
    if name == TOLERANCES:
        shown_by = f"{PACKAGE}.{name}"
        module = import_module(shown_by)
        return Study(name, "", _verified, shown_by, columns=module.COLUMNS, parts=module.PARTS)
    entries = list(entry_points(group=GROUP, name=name))
    if not entries:
        raise KeyError(f"unknown study {name!r}: choose one of {', '.join(study_names())}")
    origin = f"study {name!r}, declared as {entries[0].value} by {', '.join(sorted(map(_distribution, entries)))}"
    if len(entries) > 1:
        raise StudyBroken(f"{origin}: several declare that name; uninstall all but one")
    try:
        study = entries[0].load()
    except Exception as error:  # importing another package may raise anything
        raise StudyBroken(f"{origin}: it cannot be imported ({type(error).__name__}: {error})") from error
    if not isinstance(study, Study) or study.name != name:
        raise StudyBroken(f"{origin}: it is no comparisons.execution.plan.Study called {name!r}")
    return study


def _verified(request):
    raise SettingError(f"study {TOLERANCES}: rocking verify --output DIR measures and writes it")


def _distribution(entry):
    return f"{entry.dist.name} {entry.dist.version}" if entry.dist else "a distribution of no name"
