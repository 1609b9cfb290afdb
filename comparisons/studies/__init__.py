"""The studies: each asks one question of many runs and holds one `comparisons.running.plan.Study` called ``STUDY``.

A study is two files in a folder of its name, as `restitution`; another file only for another noun (its cases).

``study.py`` computes and imports nothing that shows: a ``plan(request)`` that yields a `Batch` of cases with their
``measure`` and returns `Computed`, plain rows and settings (`comparisons.running.plan`). All rows of all studies say
``engine``, ``variant`` and ``part`` (what the row is), ``level`` for a value of the accuracy parameter, ``lost`` for
missed impacts; settings list ``variants``, each with engine, variant, ``tier`` (its kind), parameter, default and
levels. `comparisons.studies.vocabulary` explains every column, `comparisons.studies.rows` says which of them a row has.

``page.py`` shows: one function from a `Result` to a `comparisons.showing.parts.Page`. The report's first page takes
title, lead and first, the study's own page all of it; nothing is told or drawn twice.

    ERROR = Column("error of restitution, rms [-]", "rms")  # a column of tables and an axis of figures

    def page(result):
        rows = where(result.rows, part="summary")
        return Page(
            "One impact: 6 of 13 variants reproduce restitution to within 0.001",
            ("What the question is, in two sentences.",),
            first=(lines(rows, SLENDERNESS, ERROR, "What to look at.", panel="ground", log="y"),
                   table("Least error first", rows, NAME, ERROR, Column("failed", "{failed} of {runs}"))),
            more=(Head("Base mass"), shades(rows, BASE, SLENDERNESS, ERROR, "...", bounds=(1e-3, 1e-2), panel=NAME.of)),
            how=("What was run, and how it is measured.",),
        )

The layer: `comparisons.showing.rows` (where, grouped, Column, table), `comparisons.showing.figures` (lines, shades,
beside); what they cannot draw is a `comparisons.showing.charts.Chart`. ``__init__.py`` holds ``STUDY``,
which names the module of the page: it is imported only where it is shown.

Other packages declare theirs in the entry point group `rocking.studies`; an entry resolves to a `Study` of its name.
"""

from __future__ import annotations

from importlib import import_module
from importlib.metadata import entry_points
from typing import TYPE_CHECKING

from analytic.errors import SettingError

if TYPE_CHECKING:
    from ..running.plan import Study

GROUP = "rocking.studies"
PACKAGE = "comparisons.studies"
# in the order of the report and of the rows of its first table
BUILT_IN = (
    "restitution",
    "autopsy",
    "overturning",
    "recorded",
    "fragility",
    "surface",
    "sensitivity",
    "random-scenes",
    "stability",
    "speed-error",
    "kernel",
    "caryatid",
    "tolerances",
    "constants",
    "sheet",
)


class StudyBroken(SettingError):
    """A study that another package declares cannot be used; the message names who declares it."""


def study_names() -> tuple[str, ...]:
    """Names of all studies, those of this project first, each once."""
    return tuple(dict.fromkeys([*BUILT_IN, *sorted(entry.name for entry in entry_points(group=GROUP))]))


def get_study(name: str) -> Study:
    """The `Study` called `name`.

    Raises
    ------
    KeyError
        The name is unknown; the message lists the known ones.
    StudyBroken
        Another package declares it, and it cannot be used.
    """
    if name in BUILT_IN:
        return import_module(f"{PACKAGE}.{name.replace('-', '_')}").STUDY
    entries = list(entry_points(group=GROUP, name=name))
    if not entries:
        raise KeyError(f"unknown study {name!r}: choose one of {', '.join(study_names())}")
    who = f"study {name!r}, declared as {entries[0].value} by {', '.join(sorted(map(_distribution, entries)))}"
    if len(entries) > 1:
        raise StudyBroken(f"{who}: several declare that name; uninstall all but one")
    return _resolve(entries[0], who)


def _resolve(entry, who):
    from ..running.plan import Study

    try:
        study = entry.load()
    except Exception as error:  # whatever another package raises as it is imported
        raise StudyBroken(f"{who}: it cannot be imported ({type(error).__name__}: {error})") from error
    if not isinstance(study, Study) or study.name != entry.name:
        raise StudyBroken(f"{who}: it is no comparisons.running.plan.Study called {entry.name!r}")
    return study


def _distribution(entry):
    return f"{entry.dist.name} {entry.dist.version}" if entry.dist else "a distribution of no name"
