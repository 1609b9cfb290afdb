"""Many runs: a row for each case, computed in parallel, resumable, and safe against crashes and hangs.

    with Processes() as executor:
        rows = run_sweep(cases, store="results/map.jsonl", measure=outcome, executor=executor)

The store can be reused: rows whose scene, solver, variant, settings, tag, measure, versions and source code are
unchanged are not run again.
"""

from __future__ import annotations

import json
from collections import deque
from collections.abc import Callable, Iterable
from contextlib import ExitStack
from dataclasses import dataclass
from functools import partial
from os import PathLike
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from analytic import Response

from .cases import Case, compile_for, solver
from .executors import Executor, Task
from .provenance import json_ready
from .store import Store

MOST_CASES = 512  # in a task


@dataclass(frozen=True)
class Row:
    """Result of one case.

    values: what the measure returned, deterministic; of a run that failed in the solver the whole response.
    failure: None, or kind ("solver", "exception", "time limit", "crash"), reason and message; the
    outcome in values is then "failed". cost: cpu_seconds and whatever else of the measure's "cost" differs from run to
    run.
    """

    case: Case
    values: dict
    failure: dict | None
    cost: dict
    reused: bool

    @property
    def failed(self) -> bool:
        return self.failure is not None


def run_sweep(
    cases: Iterable[Case],
    *,
    store: str | PathLike[str] | Store,
    measure: Callable[[Case, Response], dict[str, Any]],
    executor: Executor,
    time_limit: float = 300.0,
    progress: bool = True,
    label: str = "runs",
) -> list[Row]:
    """Run every case and return its `Row`s in the order of the cases, whatever the order they ran in.

    Parameters
    ----------
    cases : iterable of Case
        Equal cases are run once.
    store : path or Store
        JSONL file of rows, appended to as they arrive. Rows found there are not run again.
    time_limit : float
        Seconds a run may take; beyond, its row is "failed". A row that failed so is run again when the
        limit is raised, and so is one whose worker was killed from outside.
    measure : callable
        Module-level, (`Case`, `Response`) -> dict of JSON values; runs in the worker, on responses that did not fail.
    executor : Executor
        Where to run, `Processes` or a `comparisons.running.cluster.Cluster`; it stays open.
    progress : bool
        Show a bar with the remaining time on standard error.

    Raises
    ------
    KeyError, EngineNotInstalled
        A solver that does not exist or is not installed: before anything runs.
    StoreError
        The store is in use or damaged.
    ClusterError
        The scheduler is gone.
    """
    cases = list(cases)
    for name in sorted({case.solver for case in cases}):
        solver(name)  # what cannot run is an error now, not a failed row each
    keys = [case.key(measure) for case in cases]
    with ExitStack() as stack:
        if not isinstance(store, Store):
            store = stack.enter_context(Store(store))
        waiting = {
            key: case for key, case in zip(keys, cases, strict=True) if not _settled(store.rows.get(key), time_limit)
        }
        if waiting:
            compile_for({case.solver for case in waiting.values()})
            advance = _bar(stack, progress, label, len(waiting))
            _run(waiting, store, executor, measure, time_limit, advance)
        rows = [store.rows[key] for key in keys]
    return [
        Row(case, row["values"], row["failure"], row["cost"], key not in waiting)
        for case, key, row in zip(cases, keys, rows, strict=True)
    ]


def _run(waiting, store, executor, measure, time_limit, advance):
    pending = deque(waiting.items())
    alone: deque[Any] = deque()  # cases of lost tasks, which run one by one to find the cause
    submitted: dict[str, Any] = {}
    size = 1  # of the next task: twice what was done in the last one, which ends after `ENOUGH_SECONDS`
    while pending or alone or submitted:
        while len(submitted) < executor.slots and (alone or pending):
            fair = -(-len(pending) // executor.slots)  # near the end, leave something for every worker
            members = [alone.popleft()] if alone else [pending.popleft() for _ in range(min(size, fair))]
            keys, cases = zip(*members, strict=True)
            ticket = f"{keys[0]}-{len(keys)}"
            submitted[ticket] = members
            executor.submit(Task(ticket, cases, keys, measure, time_limit))
        done = executor.next()
        members = submitted.pop(done.ticket, None)
        if members is None:  # of a sweep that was broken off, on a shared executor
            continue
        if done.lost and len(members) > 1:
            alone.extend(members)
            continue
        lines = [_lost_line(members[0][0], done.lost)] if done.lost else done.lines
        store.append(lines)
        advance(len(lines))
        pending.extendleft(reversed(members[len(lines) :]))
        size = min(2 * len(lines), MOST_CASES)


def _settled(row, time_limit):
    """Whether a stored row is final; a run stopped from outside, or by a shorter time limit, is repeated."""
    fields = (("values", dict), ("failure", dict | None), ("cost", dict))
    if row is None or not all(name in row and isinstance(row[name], kind) for name, kind in fields):
        return False
    failure = row["failure"] or {}
    if failure.get("kind") == "time limit":
        return failure.get("time_limit", 0.0) >= time_limit
    return failure.get("exit_code") not in (-1, -9, -15)  # SIGHUP, SIGKILL, SIGTERM: no solver sends them to itself


def _lost_line(key, lost):
    return json.dumps({"key": key, "values": {"outcome": "failed"}, "failure": json_ready(lost), "cost": {}})


def _bar(stack, shown, label, total):
    """A function that moves a bar on by a count; shown until `stack` ends."""
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    bar = stack.enter_context(Progress(*columns, console=Console(stderr=True), disable=not shown, transient=False))
    return partial(bar.advance, bar.add_task(label, total=total))
