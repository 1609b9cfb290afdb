"""Studies as plans of runs, and the search for the points along a line at which an outcome changes.

A study is a question, the runs that answer it, what is measured in each run, and the page that shows the answer.

    STUDY = Study("outcomes", "Who overturns?", plan, "outcomes.page")

    def plan(request):
        rows = yield Batch([Case(scene, solver) for solver in ("analytic", *request.engines)], outcome, "outcomes")
        return Computed({"quick": request.quick}, [row.values for row in rows])

`plan` is a generator. It yields a `Batch` of cases and is sent their rows, as often as it needs: a search continues
where the answers point, a timing goes turn by turn. A `Computed` that it yields is written at once, complete as far as
it goes; the last one is returned. `study.compute` runs, stores, resumes and writes every study in the same way.
`comparisons.studies` tells how to write a study, from the first file to its page.

`boundaries` searches for the changes of an outcome along a line, and evaluates points near the changes only. A search
is a generator: it yields a list of points, is sent the list of their outcomes, and returns its result. `together` runs
many searches in rounds, so that every round is one batch (one sweep); `drive` takes the outcomes from a function.
Outcomes are labels that are equal or not. Labels that say more find more: between "overturns after one impact" and
"overturns without" bisection meets the safe gap, however thin; between two plain "overturns" it cannot.
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
    from .results import Result

TIME_LIMIT = 300.0  # s, of one run


@dataclass(frozen=True)
class Request:
    """The request to a plan. engines: names of the engines to compare; quick: a small version, in minutes."""

    engines: tuple[str, ...] = ()
    quick: bool = False


@dataclass(frozen=True)
class Batch:
    """Cases to run in parallel. measure: module-level function, (`Case`, `Response`) -> dict of JSON values.

    alone: the runs are timed, so they are made one after the other in a fresh process, with nothing else under way.
    rates: engines are judged by the results. long: a run takes seconds, so progress is shown even for few runs.

    Raises
    ------
    ValueError
        With `rates`, a scene gives the restitution: the result would not be the engine's own.
    """

    cases: Sequence[Case]
    measure: Callable
    label: str
    time_limit: float = TIME_LIMIT
    alone: bool = False
    rates: bool = True
    long: bool = False

    def __post_init__(self) -> None:
        given = (case for case in self.cases if case.scene.block.restitution is not None and case.solver not in SOLVERS)
        if self.rates and (case := next(given, None)):
            words = f"{case.solver} is given block.restitution = {case.scene.block.restitution!r}"
            raise ValueError(f"{self.label}: {words}, and not judged by it; leave it out, or use rates=False")


@dataclass(frozen=True)
class Computed:
    """The answer of a plan: settings, rows and arrays.

    solvers: further solvers on whose code it depends, beside those of the batches. name: of the result, if a study has
    several.
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
    """A study as the commands, the report and `compute` use it.

    name: on the command line and of its files, and the kind of its result. question: the command's help; its first
    sentence, of at most 60 characters, is its line among the commands. plan: ``(request, **options)`` -> generator, see
    above; its keyword-only parameters, annotated as Typer wants them, are options of the command.

    shown_by: the module that shows the study, imported only for that. Its ``page(result)`` returns the
    `comparisons.plotting.parts.Page`; its ``judgements(result)``, if any, rows of the report's first table; its
    ``glance(result)``, if any, what stands above that table.

    problems: result -> sentences that end the command with status 1. whole: why the rows of one engine cannot be
    computed alone (`by_solver`); "" if they can, and then the arrays of an engine bear its name. by_solver: the result
    is a folder of files by solver, not one file.

    columns: {field: its `Column`} of the rows. parts: {value of a row's ``part``, "" if rows have none: fields of such
    a row, separated by blanks}. "?" after a field: it may be null. A row that failed may lack the fields after "|".
    Rows of another package's study are not checked.
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
        """Return the options of the plan by name. Annotations kept as text are evaluated in the plan's module."""
        parameters = {}
        for name, parameter in inspect.signature(self.plan).parameters.items():
            if parameter.kind is inspect.Parameter.KEYWORD_ONLY:
                kind = parameter.annotation
                known = eval(kind, self.plan.__globals__) if isinstance(kind, str) else kind
                parameters[name] = parameter.replace(annotation=known)
        return parameters

    def page(self, result: Result) -> Any:
        """Return the page of a result."""
        return import_module(self.shown_by).page(result)

    def judgements(self, result: Result) -> tuple[Any, ...]:
        """Return rows for the report's first table; none if the study judges no engine."""
        return getattr(import_module(self.shown_by), "judgements", lambda result: ())(result)

    def glance(self, result: Result) -> Any:
        """Return what the study adds to the report's first screen, or None."""
        return getattr(import_module(self.shown_by), "glance", lambda result: None)(result)


@dataclass(frozen=True)
class Transition:
    """A change of the outcome from `before` to `after`, between `low` and `high`."""

    low: float
    high: float
    before: object
    after: object

    @property
    def position(self) -> float:
        return 0.5 * (self.low + self.high)


@dataclass(frozen=True)
class Transitions:
    """The transitions found along a line, in rising order, and the number of evaluations."""

    transitions: tuple[Transition, ...]
    evaluations: int


def together(
    searches: Sequence[Generator[list[Any], list[Any], Any]],
) -> Generator[list[tuple[int, Any]], list[Any], list[Any]]:
    """Combine many searches into one, in rounds.

    Parameters
    ----------
    searches : list of generators
        As `boundaries` makes them.

    Returns
    -------
    generator
        In each round it yields a list of (index of the search, point) and is sent the list of their outcomes. It
        returns the list of the searches' results.

    Raises
    ------
    ValueError
        The number of outcomes sent differs from the number of points.
    """
    results = [None] * len(searches)
    answers: dict[int, Any] = dict.fromkeys(range(len(searches)))
    while answers:
        points_asked = {}
        for index, answer in answers.items():
            try:
                points_asked[index] = list(searches[index].send(answer))
            except StopIteration as stop:
                results[index] = stop.value
        batch = [(index, point) for index, points in points_asked.items() for point in points]
        answers = {index: [] for index in points_asked}
        for (index, _), outcome in zip(batch, (yield batch) if batch else (), strict=True):
            answers[index].append(outcome)
    return results


def drive(
    searches: Sequence[Generator[list[Any], list[Any], Any]], evaluate: Callable[[list[tuple[int, Any]]], list[Any]]
) -> list[Any]:
    """Run `searches` and return their results. evaluate(batch) returns the outcomes of a round, see `together`."""
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
    """Search for all transitions on [low, high]: scan, refine beside each change, then bisect each.

    The outcome need not be monotone. The search certainly finds every stretch of one outcome that is wider than the
    scan step (high - low)/(scan - 1); within one step of a change, every stretch wider than step/near; and between two
    points with different outcomes at least one transition.

    Parameters
    ----------
    low, high : float
    scan : int
        Number of points of the first, equidistant scan; at least 2.
    tolerance : float
        Transitions are located within brackets no wider than this.
    near : int
        Number of parts into which intervals of the scan with a change, and their neighbours, are divided.

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
