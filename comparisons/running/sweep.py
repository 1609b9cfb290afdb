"""Many runs: a row for each case, computed in parallel, resumable, and safe against crashes and hangs.

    with Processes() as executor:
        rows = run_sweep(cases, store="results/map.jsonl", measure=outcome, executor=executor)

The store can be reused: rows whose scene, solver, variant, settings, tag, measure, versions and source code are
unchanged are not run again. It is a file of one line of JSON per run, appended; what a killed sweep leaves is found
again.
"""

import contextlib
import io
import json
import os
import time
from collections import deque
from collections.abc import Callable, Iterable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from functools import partial
from os import PathLike
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from analytic import Response

from .cases import Case, compile_for, solver
from .executors import Executor, Task
from .progress import lines
from .provenance import json_ready
from .readable import Mendable

try:
    import fcntl
except ImportError:  # Windows has none: no lock there
    fcntl = None  # type: ignore[assignment]  # Windows has none

SYNC_SECONDS = 1.0  # a killed process loses nothing written, a power cut at most this much


class StoreError(Mendable):
    """A file of results that cannot be used; the message names file, line and remedy."""


class Store(contextlib.AbstractContextManager["Store"]):
    """Append-only file of rows keyed by their case: a context manager around one JSONL file.

    A row is a dict with at least "key". A torn last line (the process was killed while it wrote) is
    dropped when the file is opened.

    Raises
    ------
    StoreError
        Another sweep has the file open, it cannot be read and written, or a whole line in it is no row.
    """

    def __init__(self, path: str | PathLike[str]) -> None:
        self.path = Path(path)
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            if self.path.exists() and not self.path.is_file():
                raise StoreError(f"{self.path}: is no file; remove it, or give another place")
            self._file = open(self.path, "ab+", buffering=0)
        except (OSError, ValueError) as error:  # ValueError: a NUL character
            raise self._unusable(error) from error
        try:
            self._lock()
            self.rows = self._read()
        except BaseException:
            self._file.close()
            raise
        self._synced = time.monotonic()

    def __exit__(self, *_: object) -> None:
        with contextlib.suppress(OSError):  # said when the rows were written
            self._sync()
        self._file.close()

    def append(self, lines: Sequence[str]) -> None:
        """Write rows given as lines of JSON (str, no line end).

        Raises
        ------
        StoreError
            The disk is full or failed; the file holds the rows before these.
        """
        data, end = memoryview("".join(line + "\n" for line in lines).encode()), self._file.seek(0, os.SEEK_END)
        try:
            while data:
                data = data[self._file.write(data) :]
            if time.monotonic() - self._synced > SYNC_SECONDS:
                self._sync()
        except OSError as error:
            with contextlib.suppress(OSError):
                self._file.truncate(end)
            raise self._unusable(error, "the rows so far are kept: make room and run again") from error
        self.rows.update((row["key"], row) for row in map(json.loads, lines))

    def _sync(self):
        os.fsync(self._file.fileno())
        self._synced = time.monotonic()

    def _unusable(self, error, remedy="give another place"):
        return StoreError(f"{self.path}: rows cannot be stored there ({getattr(error, 'strerror', error)}); {remedy}")

    def _lock(self):
        if fcntl is None:
            return
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise StoreError(
                f"{self.path}: another sweep is writing to it; wait for it or give another place"
            ) from error
        except OSError:  # a file system without locks
            pass

    def _read(self):
        self._file.seek(0)
        rows, end = {}, 0
        for number, line in enumerate(io.BufferedReader(io.FileIO(self._file.fileno(), closefd=False)), 1):
            if not line.endswith(b"\n"):
                self._file.truncate(end)
                break
            end += len(line)
            try:
                row = json.loads(line)
                rows[row["key"]] = row
            except (ValueError, KeyError, TypeError, RecursionError) as error:
                raise StoreError(
                    f"{self.path}, line {number}: not a row of results ({error}); remove the "
                    "line, or the file to start afresh"
                ) from error
        return rows


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
            solvers = len({case.solver for case in waiting.values()})
            advance = _bar(stack, label, len(waiting), solvers) if progress else lambda count: None
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


def _bar(stack, label, total, solvers):
    """A function that moves a bar on by a count; shown until `stack` ends. `lines` where that is no terminal."""
    console = Console(stderr=True)
    if not console.is_terminal:
        stack.enter_context(lines(f"{label}: {total} to do in {solvers} solver{'s' * (solvers > 1)}"))
        return lambda count: None
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    bar = stack.enter_context(Progress(*columns, console=console))
    return partial(bar.advance, bar.add_task(label, total=total))
