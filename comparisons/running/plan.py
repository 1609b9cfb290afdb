"""A study: a question, the runs that answer it, what is measured in each, and how the answer is shown.

    STUDY = Study("outcomes", "Who overturns?", plan, "outcomes.page")

    def plan(request):
        rows = yield Batch([Case(scene, solver) for solver in ("analytic", *request.engines)], outcome, "outcomes")
        return Computed({"quick": request.quick}, [row.values for row in rows])

`plan` is a generator: it yields a `Batch` of cases and is sent their rows, as often as it needs (a search asks again
where the answers point, a timing turn by turn). A `Computed` that it yields is written at once: whole as far as it
goes; the last one is returned. What runs, stores, resumes and writes is `study.compute`, the same for every study. How
to write a study, from the first file to its page: `comparisons.studies`.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass, field
from importlib import import_module
from typing import TYPE_CHECKING

from .cases import SOLVERS, Case
from .sweep import Row

if TYPE_CHECKING:
    from ..showing.glance import Glance
    from ..showing.parts import Judgement, Page
    from .provenance import Result

TIME_LIMIT = 300.0  # s, of one run


@dataclass(frozen=True)
class Request:
    """What a plan is asked. engines: names of those to compare; quick: a first look, in minutes."""

    engines: tuple[str, ...] = ()
    quick: bool = False


@dataclass(frozen=True)
class Batch:
    """Cases to run, in parallel. measure: module-level, (`Case`, `Response`) -> dict of JSON values.

    alone: timed, so one after the other in one fresh process, with nothing else under way. rates: engines are judged
    by it, by an answer that is their own. long: a run takes seconds: progress is shown of few, too.

    Raises
    ------
    ValueError
        An engine is to be judged by a scene that gives the restitution.
    """

    cases: Sequence[Case]
    measure: Callable
    label: str
    time_limit: float = TIME_LIMIT
    alone: bool = False
    rates: bool = True
    long: bool = False

    def __post_init__(self) -> None:
        given = (one for one in self.cases if one.scene.block.restitution is not None and one.solver not in SOLVERS)
        if self.rates and (one := next(given, None)):
            words = f"{one.solver} is given block.restitution = {one.scene.block.restitution!r}"
            raise ValueError(f"{self.label}: {words}, and not judged by it; leave it out, or use rates=False")


@dataclass(frozen=True)
class Computed:
    """An answer: what was asked (settings), rows and arrays.

    solvers: on whose code it depends beside the batches'. name: of its file, where a study has several.
    """

    settings: dict
    rows: list
    arrays: dict = field(default_factory=dict)
    seed: object = None
    solvers: tuple[str, ...] = ()
    name: str = ""


Plan = Generator[Batch | Computed, list[Row], Computed]


@dataclass(frozen=True)
class Study:
    """A study, as commands, report and `compute` know it.

    name: on the command line, of its files, and the kind of its result. question: one line, the command's help.
    plan: ``(request, **options)`` -> generator, see above; its keyword-only parameters, annotated as Typer wants them,
    are options of the command. shown_by: the module that shows it, imported only there: its ``page(result)`` gives the
    `comparisons.showing.parts.Page`; its ``judgements(result)``, if it has them, rows of the report's first table, and
    its ``glance(result)`` what stands above them.
    problems: result -> sentences that end the command with status 1. whole: why one engine's rows cannot be computed
    anew by themselves (`by_solver`); "" where they can: then its arrays bear its name. by_solver: whether its result is
    a folder of files by solver, or one file.
    """

    name: str
    question: str
    plan: Callable[..., Plan]
    shown_by: str = ""
    problems: Callable[[Result], list] = lambda result: []
    whole: str = ""
    by_solver: bool = True

    def options(self) -> dict[str, inspect.Parameter]:
        """The plan's options by name; annotations that are kept as text stand for what they do where it is."""
        found = {}
        for name, parameter in inspect.signature(self.plan).parameters.items():
            if parameter.kind is inspect.Parameter.KEYWORD_ONLY:
                kind = parameter.annotation
                known = eval(kind, self.plan.__globals__) if isinstance(kind, str) else kind
                found[name] = parameter.replace(annotation=known)
        return found

    def page(self, result: Result) -> Page:
        """What is shown of a result."""
        return import_module(self.shown_by).page(result)

    def judgements(self, result: Result) -> tuple[Judgement, ...]:
        """Rows of the report's first table; none of a study that judges no engine."""
        return getattr(import_module(self.shown_by), "judgements", lambda result: ())(result)

    def glance(self, result: Result) -> Glance | None:
        """What it gives to the report's first screen; None: nothing."""
        return getattr(import_module(self.shown_by), "glance", lambda result: None)(result)
