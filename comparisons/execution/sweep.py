"""Sweeps of many runs: in parallel, resumable, and safe against crashes and hangs.

    with Processes() as executor:
        rows = run_sweep(cases, store="results/map.jsonl", measure=outcome, executor=executor)

`run_sweep` gives a row for each case. The store is a file with one line of JSON for each run. It can be used again,
also after a sweep was killed: a run is not repeated if its scene, solver, variant, settings, tag, measure, versions
and source code are unchanged. An `Executor` makes the runs; `Processes` uses worker processes, which may crash or hang.
"""

import contextlib
import faulthandler
import io
import json
import math
import multiprocessing
import os
import queue
import signal
import sys
import threading
import time
import traceback
from abc import abstractmethod
from collections import deque
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import TimeoutError
from concurrent.futures.process import BrokenProcessPool
from contextlib import ExitStack
from dataclasses import dataclass
from functools import partial
from multiprocessing import forkserver, resource_tracker
from os import PathLike
from pathlib import Path
from typing import Any

from pebble import ProcessExpired, ProcessPool
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from analytic import Response
from analytic.errors import SettingError
from engines.guard import end_with_parent, raised

from .cases import Case, compile_for, root_of, solver
from .progress import lines, redirected
from .results import json_ready, scrub
from .writing import Mendable, PlaceError, TemporaryFolder

ENOUGH_SECONDS = 0.2  # after which a task of several short runs ends; a kill loses no more
MOST_BROKEN = 3  # pools in a row that end without finishing a task
MOST_WORKERS = 64  # unless there are more cores
GRACE_SECONDS = 0.5  # beyond the time limit, for the worker to report where it hangs
EVIDENCE_CHARACTERS = 4000
THREAD_VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")


@dataclass(frozen=True)
class Task:
    """Cases that one worker runs one after the other.

    The worker stops after `ENOUGH_SECONDS` and returns the lines it has by then, at least one. The time limit [s] holds
    for the whole task.
    """

    ticket: str
    cases: tuple[Case, ...]
    keys: tuple[str, ...]
    measure: Callable
    time_limit: float


@dataclass(frozen=True)
class Done:
    """Result of a task: lines of JSON for its first cases, or why it was lost."""

    ticket: str
    lines: tuple[str, ...] = ()
    lost: dict | None = None  # failure: kind, reason, message


class Executor(contextlib.AbstractContextManager["Executor"]):
    """Makes the runs of a sweep. The end of a `with` statement drops the runs under way."""

    slots: int  # tasks to keep submitted so that no worker waits

    @abstractmethod
    def submit(self, task: Task) -> None:
        """Accept a task and return at once."""

    @abstractmethod
    def next(self) -> Done:
        """Wait until any submitted task ends, done or lost, and return its `Done`."""


def number_of(workers: int | None) -> int:
    """Return the number of worker processes; None: one per core. Raises `SettingError` for too many or too few."""
    cores = os.cpu_count() or 1
    most, number = max(MOST_WORKERS, cores), cores if workers is None else workers
    if not 1 <= number <= most:
        raise SettingError(f"{workers} worker processes: give 1 to {most}")
    return number


class Processes(Executor):
    """Runs in `workers` processes (default: one per core), each with one numerical thread.

    Workers are forked from a server that has imported the `solvers`. A worker that crashed is replaced within
    hundredths of a second, and the state of this process does not reach the workers.
    """

    def __init__(self, workers: int | None = None, solvers: Iterable[str] = ()) -> None:
        self._workers = number_of(workers)
        self.slots = 2 * self._workers
        self._ended: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self._evidence = TemporaryFolder("sweep-")
        server = "forkserver" in multiprocessing.get_all_start_methods()
        self._context = multiprocessing.get_context("forkserver" if server else "spawn")
        if server:
            self._context.set_forkserver_preload(
                ["comparisons.execution.sweep", *(root_of(name).partition(":")[0] for name in solvers)]
            )
            resource_tracker.ensure_running()  # of the forkserver, whose start would undo the blocking
            before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
            try:  # the server and its workers leave Ctrl-C to this process
                with _one_thread():
                    forkserver.ensure_running()
            finally:
                signal.pthread_sigmask(signal.SIG_SETMASK, before)
        self._under_way: dict[Any, tuple[Task, str]] = {}  # future: task and its log
        self._broken = 0
        self._pool = self._new_pool()

    def submit(self, task: Task) -> None:
        log = os.path.join(self._evidence.name, f"{task.ticket}.log")
        with _one_thread():  # workers started by this inherit it
            if not self._pool.active:
                self._renew()
            future = self._pool.schedule(_work, (task, log), timeout=task.time_limit + GRACE_SECONDS)
        self._under_way[future] = task, log
        future.add_done_callback(self._ended.put)

    def next(self) -> Done:
        while True:
            try:
                future = self._ended.get(timeout=GRACE_SECONDS)
            except queue.Empty:
                if not self._pool.active:  # it will not start its remaining tasks
                    self._renew()
                continue
            if future not in self._under_way:
                continue
            if isinstance(future.exception(), BrokenProcessPool):
                self._renew()
                continue
            task, log = self._under_way.pop(future)
            self._broken = 0
            try:
                return Done(task.ticket, future.result())
            except TimeoutError:
                reason = f"no result within the time limit of {task.time_limit:g} s"
                lost = {"kind": "time limit", "reason": reason, "time_limit": task.time_limit}
            except ProcessExpired as error:
                lost = {
                    "kind": "crash",
                    "reason": f"the worker process ended: {_exit(error.exitcode)}",
                    "exit_code": error.exitcode,
                }
            lost["message"] = _tail(log)
            return Done(task.ticket, lost=lost)

    def __exit__(self, *_: object) -> None:
        self._close_pool()
        self._evidence.cleanup()

    def _new_pool(self):
        return ProcessPool(self._workers, initializer=_start_worker, initargs=(tuple(sys.path),), context=self._context)

    def _renew(self):
        """Start a new pool. A pool ends when a worker without a task dies, for example when it is killed while idle."""
        self._broken += 1
        if self._broken > MOST_BROKEN:
            raise RuntimeError(
                "worker processes end before they take up any run; try one case by its method `run` to see why. "
                "Rows done so far are kept"
            )
        self._close_pool()
        self._pool = self._new_pool()
        unfinished = {
            future: entry
            for future, entry in self._under_way.items()
            if not future.done() or future.exception() is not None
        }
        for future, (task, _) in unfinished.items():
            del self._under_way[future]
            self.submit(task)

    def _close_pool(self):
        self._pool.stop()
        self._pool.join()


def lines_of(task: Task) -> tuple[str, ...]:
    """Run the first cases of a task in this process, and return their rows as lines of JSON."""
    start, lines = time.monotonic(), []
    for case, key in zip(task.cases, task.keys, strict=True):
        row: dict[str, Any] = {"key": key, "values": {}, "failure": None, "cost": {}}
        try:
            response = case.run()
            if math.isfinite(response.cpu_seconds):  # nan: nothing was stepped
                row["cost"] = {"cpu_seconds": response.cpu_seconds}
            if response.outcome == "failed":
                # Measures get sound responses only. A failed response is kept whole, as evidence.
                row["values"] = response.to_json()
                row["failure"] = {"kind": "solver", **row["values"].pop("failure")}
            else:
                row["values"] = task.measure(case, response)
                row["cost"] |= row["values"].pop("cost", {})
            row["values"] = json_ready(row["values"])
            row["values"].pop("cpu_seconds", None)
            line = json.dumps(row, allow_nan=False)
        except PlaceError:  # a full disk is no failure of a solver
            raise
        except Exception as error:
            row["values"] = {"outcome": "failed"}
            row["failure"] = {
                "kind": "exception",
                "reason": scrub(raised(error)),
                "message": scrub(traceback.format_exc())[-EVIDENCE_CHARACTERS:],
            }
            line = json.dumps(row)
        lines.append(line)
        if time.monotonic() - start > ENOUGH_SECONDS:
            break
    return tuple(lines)


def _start_worker(path):
    sys.path[:] = path  # a preloaded server keeps its own
    signal.signal(signal.SIGTERM, signal.SIG_DFL)  # pebble's handler waits for compiled code, and hides the signal
    end_with_parent()
    threading.Thread(target=end_with, args=(multiprocessing.parent_process(),), daemon=True).start()


def end_with(parent: Any) -> None:
    """End this process when its `parent` (`multiprocessing.parent_process`) has ended."""
    parent.join()  # end with the parent, even if that is killed
    os._exit(1)


def _work(task, log):
    """In a worker: run a task and return its lines. What it prints, and where it hangs, goes to `log`."""
    with open(log, "wb") as file, redirected(1, 2, to=file.fileno()):
        faulthandler.enable(file, all_threads=False)
        faulthandler.dump_traceback_later(task.time_limit, file=file)
        if hasattr(signal, "setitimer"):  # ends an orphan that hangs in compiled code, where no thread gets a turn
            signal.signal(signal.SIGALRM, signal.SIG_DFL)
            signal.setitimer(signal.ITIMER_REAL, task.time_limit + 10 * GRACE_SECONDS)
        try:
            result = lines_of(task)
        finally:
            faulthandler.cancel_dump_traceback_later()
            faulthandler.disable()
            if hasattr(signal, "setitimer"):
                signal.setitimer(signal.ITIMER_REAL, 0)
    os.unlink(log)
    return result


@contextlib.contextmanager
def _one_thread():
    """Give processes started inside one numerical thread each. Libraries read these variables when they are loaded."""
    before = {name: os.environ[name] for name in THREAD_VARIABLES if name in os.environ}
    os.environ.update(dict.fromkeys(THREAD_VARIABLES, "1"))
    try:
        yield
    finally:
        for name in THREAD_VARIABLES:
            del os.environ[name]
        os.environ.update(before)


def _exit(code):
    if code is not None and code < 0:
        return f"signal {-code} ({signal.Signals(-code).name})"
    return f"exit code {code}"


def _tail(log):
    try:
        with open(log, "rb") as file:
            return scrub(file.read().decode(errors="replace"))[-EVIDENCE_CHARACTERS:].strip()
    except FileNotFoundError:
        return ""


try:
    import fcntl
except ImportError:  # Windows has none: no lock there
    fcntl = None  # type: ignore[assignment]  # Windows has none

SYNC_SECONDS = 1.0  # a power cut loses at most the rows of this time; a killed process loses none


class StoreError(Mendable):
    """The store of runs cannot be used; the message names file, line and remedy."""


class Store(contextlib.AbstractContextManager["Store"]):
    """A file of rows in JSONL, to which rows are only appended; a context manager.

    A row is a dict with at least "key", the key of its case. An incomplete last line, left by a killed process, is
    removed when the file is opened.

    Raises
    ------
    StoreError
        Another sweep uses the file, it cannot be read and written, or a complete line in it is no row.
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
        with contextlib.suppress(OSError):  # reported when the rows were written
            self._sync()
        self._file.close()

    def append(self, lines: Sequence[str]) -> None:
        """Append rows, given as lines of JSON without line ends.

        Raises
        ------
        StoreError
            The disk is full or failed; the file keeps the earlier rows.
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
    """The result of a case.

    values: what the measure returned, which is deterministic; the whole response if the solver failed. failure: None,
    or kind ("solver", "exception", "time limit", "crash"), reason and message; the outcome in values is then "failed".
    cost: cpu_seconds, and the measure's "cost", which differs from run to run. reused: found in the store, not run now.
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
    """Run every case and return the `Row`s in the order of the cases.

    Parameters
    ----------
    cases : iterable of Case
        Equal cases are run once.
    store : path or Store
        JSONL file to which rows are appended as they arrive. Cases whose rows are found there are not run again.
    time_limit : float
        Limit of a run [s]; a run that takes longer has failed. Such a run is repeated when the limit is raised, and so
        is a run whose worker was killed from outside.
    measure : callable
        Module-level, (`Case`, `Response`) -> dict of JSON values; runs in the worker, on responses that did not fail.
    executor : Executor
        Makes the runs: `Processes`, or a `comparisons.execution.cluster.Cluster`. It stays open.
    progress : bool
        Show a bar with the remaining time on standard error.

    Raises
    ------
    KeyError, EngineNotInstalled
        A solver does not exist or is not installed. This is checked before anything runs.
    StoreError
        The store is in use or damaged.
    ClusterError
        The scheduler is gone.
    """
    cases = list(cases)
    for name in sorted({case.solver for case in cases}):
        solver(name)  # raises now, in place of a failed row for each case
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
    alone: deque[Any] = deque()  # cases of lost tasks; they run one by one, to find the one that failed
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
        if members is None:  # a task of an interrupted sweep on the same executor
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
    """Whether a stored row is final. A run stopped from outside, or by a shorter time limit, is repeated."""
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
    """Show a bar until `stack` ends, and return a function that advances it by a count. No terminal: `lines`."""
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
