"""A study: a question, the runs that answer it, what is measured in each, and how the answer is shown.

    STUDY = Study("outcomes", "Who overturns?", plan, "outcomes.page")

    def plan(request):
        rows = yield Batch([Case(scene, solver) for solver in ("analytic", *request.engines)], outcome, "outcomes")
        return Computed({"quick": request.quick}, [row.values for row in rows])

`plan` is a generator: it yields a `Batch` of cases and is sent their rows, as often as it needs (a search asks again
where the answers point, a timing turn by turn). A `Computed` that it yields is written at once: whole as far as it
goes; the last one is returned. What runs, stores, resumes and writes is `study.compute`, the same for every study. How
to write a study, from the first file to its page: `comparisons.studies`.

Location of the changes of an outcome along a line, with evaluations near the changes only.

A search is a generator: it yields a list of points, is sent the list of their outcomes, and returns its result.
`together` runs many searches in rounds, so that every round is one batch (one sweep); `drive` asks a function for the
outcomes. Outcomes are any labels that compare equal or not. Labels that say more find more: between "overturns after
one impact" and "overturns without" bisection must meet the safe gap, however thin; between two plain "overturns" it
cannot.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Generator, Mapping, Sequence
from dataclasses import dataclass, field
from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np

from ..schemas.columns import Column
from .cases import SOLVERS, Case
from .sweep import Row

if TYPE_CHECKING:
    from ..plotting.glance import Glance
    from ..plotting.parts import Judgement, Page
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

    name: on the command line, of its files, and the kind of its result. question: the command's help;
    its first sentence, of at most 60 characters, is its line among the commands.
    plan: ``(request, **options)`` -> generator, see above; its keyword-only parameters, annotated as Typer wants them,
    are options of the command. shown_by: the module that shows it, imported only there: its ``page(result)`` gives the
    `comparisons.plotting.parts.Page`; its ``judgements(result)``, if it has them, rows of the report's first table, and
    its ``glance(result)`` what stands above them.
    problems: result -> sentences that end the command with status 1. whole: why one engine's rows cannot be computed
    anew by themselves (`by_solver`); "" where they can: then its arrays bear its name. by_solver: whether its result is
    a folder of files by solver, or one file. columns: {field: its `Column`} of its rows. parts: {value of a row's
    ``part``, "" where rows have none: fields that each such row has}, separated by blanks; "?" behind one: null may
    stand there; those behind "|" a row that failed need not have. Rows of another package's
    study are not checked.
    """

    name: str
    question: str
    plan: Callable[..., Plan]
    shown_by: str = ""
    problems: Callable[[Result], list] = lambda result: []
    whole: str = ""
    by_solver: bool = True
    columns: Mapping[str, Column] = field(default_factory=dict)
    parts: Mapping[str, str] = field(default_factory=dict)

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


@dataclass(frozen=True)
class Transition:
    """The outcome changes from `before` to `after` between `low` and `high`."""

    low: float
    high: float
    before: object
    after: object

    @property
    def position(self) -> float:
        return 0.5 * (self.low + self.high)


@dataclass(frozen=True)
class Transitions:
    """All transitions found along one line, in rising order, and the number of evaluations they took."""

    transitions: tuple[Transition, ...]
    evaluations: int


def together(
    searches: Sequence[Generator[list[Any], list[Any], Any]],
) -> Generator[list[tuple[int, Any]], list[Any], list[Any]]:
    """Many searches as one, in rounds.

    Parameters
    ----------
    searches : list of generators
        As `boundaries` makes them.

    Returns
    -------
    generator
        Yields once a round a list of (index of the search, point), is sent the list of their outcomes, and returns a
        list of what each search returned.

    Raises
    ------
    ValueError
        It was sent another number of outcomes than it gave points.
    """
    results = [None] * len(searches)
    answers: dict[int, Any] = dict.fromkeys(range(len(searches)))
    while answers:
        asked = {}
        for index, answer in answers.items():
            try:
                asked[index] = list(searches[index].send(answer))
            except StopIteration as stop:
                results[index] = stop.value
        batch = [(index, point) for index, points in asked.items() for point in points]
        answers = {index: [] for index in asked}
        for (index, _), outcome in zip(batch, (yield batch) if batch else (), strict=True):
            answers[index].append(outcome)
    return results


def drive(
    searches: Sequence[Generator[list[Any], list[Any], Any]], evaluate: Callable[[list[tuple[int, Any]]], list[Any]]
) -> list[Any]:
    """What each of `searches` returned; evaluate(batch) gives the outcomes of a round, see `together`."""
    rounds, outcomes = together(searches), None
    while True:
        try:
            batch = rounds.send(outcomes)  # type: ignore[arg-type]  # None starts it
        except StopIteration as stop:
            return stop.value
        outcomes = evaluate(batch)


def boundaries(
    low: float, high: float, scan: int, tolerance: float, near: int = 4
) -> Generator[list[float], list[Any], Transitions]:
    """Search for all transitions on [low, high]: scan, look closer beside each change, then bisect each.

    The outcome need not be monotone. Found for certain: every stretch of one outcome wider than the scan
    step (high - low)/(scan - 1); within one step of a change, every stretch wider than step/near; between
    two points with different outcomes, at least one transition.

    Parameters
    ----------
    low, high : float
    scan : int
        Points of the first, equidistant scan, at least 2.
    tolerance : float
        Transitions are located within brackets no wider than this.
    near : int
        Parts into which the scan's intervals with a change, and their neighbours, are divided.

    Returns
    -------
    generator
        For `together`; yields lists of float, returns `Transitions`.
    """
    known: dict[float, Any] = {}

    def learn(points):
        points = [point for point in points if point not in known]
        if points:
            known.update(zip(points, (yield points), strict=True))

    yield from learn(np.linspace(low, high, scan).tolist())
    edges = sorted(known)
    changes = {i for i in range(scan - 1) if known[edges[i]] != known[edges[i + 1]]}
    close = sorted({j for i in changes for j in (i - 1, i, i + 1) if 0 <= j < scan - 1})
    yield from learn([point for i in close for point in np.linspace(edges[i], edges[i + 1], near + 1)[1:-1].tolist()])
    edges = sorted(known)
    waiting = [(a, b) for a, b in zip(edges, edges[1:], strict=False) if known[a] != known[b]]
    narrow = []
    while waiting:
        halves = [(a, 0.5 * (a + b), b) for a, b in waiting]
        wide = [(a, middle, b) for a, middle, b in halves if b - a > tolerance and a < middle < b]
        narrow += [(a, b) for a, middle, b in halves if not (b - a > tolerance and a < middle < b)]
        yield from learn([middle for _, middle, _ in wide])
        waiting = [(c, d) for a, middle, b in wide for c, d in ((a, middle), (middle, b)) if known[c] != known[d]]
    transitions = tuple(Transition(a, b, known[a], known[b]) for a, b in sorted(narrow))
    return Transitions(transitions, len(known))
