"""Executors of the runs of a sweep: worker processes that may crash or hang."""

import contextlib
import faulthandler
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
from collections.abc import Callable, Iterable
from concurrent.futures import TimeoutError
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from multiprocessing import forkserver, resource_tracker
from typing import Any

from pebble import ProcessExpired, ProcessPool

from analytic.errors import SettingError
from engines.guard import end_with_parent, raised

from .cases import Case, root_of
from .files import PlaceError, TemporaryFolder
from .progress import redirected
from .provenance import json_ready, scrub

ENOUGH_SECONDS = 0.2  # of a task, in which short runs are combined; a kill loses at most that
MOST_BROKEN = 3  # pools in a row that end without finishing a task
MOST_WORKERS = 64  # where there are no more cores than that
GRACE_SECONDS = 0.5  # beyond the time limit, for the worker to write down where it hangs
EVIDENCE_CHARACTERS = 4000
THREAD_VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")


@dataclass(frozen=True)
class Task:
    """Cases done one after the other by one worker.

    The worker stops after `ENOUGH_SECONDS` and hands back what it has by then, at least one line. The time
    limit [s] holds for the task as a whole.
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
    """The place where the runs of a sweep are done; the end of a `with` statement drops what is under way."""

    slots: int  # tasks to keep submitted so that no worker waits

    @abstractmethod
    def submit(self, task: Task) -> None:
        """Take a task; returns at once."""

    @abstractmethod
    def next(self) -> Done:
        """Wait for any submitted task to end; every task ends, lost or done."""


def number_of(workers: int | None) -> int:
    """How many worker processes that is, one per core for None; raises `SettingError` if they are too many or few."""
    cores = os.cpu_count() or 1
    most, number = max(MOST_WORKERS, cores), cores if workers is None else workers
    if not 1 <= number <= most:
        raise SettingError(f"{workers} worker processes: give 1 to {most}")
    return number


class Processes(Executor):
    """Runs in `workers` processes (default: one per core), each with one numerical thread.

    Workers are forked from a server that has imported the `solvers`: one that crashed is replaced in
    hundredths of a second, and nothing of this process's state reaches them.
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
                ["comparisons.running.executors", *(root_of(name).partition(":")[0] for name in solvers)]
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
        """A new pool: a pool ends when a worker dies that has no task, as when it is killed while idle."""
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
    """The rows of a task's first cases, run in this process, as lines of JSON."""
    start, lines = time.monotonic(), []
    for case, key in zip(task.cases, task.keys, strict=True):
        row: dict[str, Any] = {"key": key, "values": {}, "failure": None, "cost": {}}
        try:
            response = case.run()
            if math.isfinite(response.cpu_seconds):  # nan: nothing was stepped
                row["cost"] = {"cpu_seconds": response.cpu_seconds}
            if response.outcome == "failed":
                # Measures see sound responses only; of a failed one everything is kept as evidence.
                row["values"] = response.to_json()
                row["failure"] = {"kind": "solver", **row["values"].pop("failure")}
            else:
                row["values"] = task.measure(case, response)
                row["cost"] |= row["values"].pop("cost", {})
            row["values"] = json_ready(row["values"])
            row["values"].pop("cpu_seconds", None)
            line = json.dumps(row, allow_nan=False)
        except PlaceError:  # a disk that is full is no failure of a solver
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
    """End this process when its `parent` (of `multiprocessing.parent_process`) has ended."""
    parent.join()  # end with the parent, even if that is killed
    os._exit(1)


def _work(task, log):
    """In a worker: the lines of a task; what it prints and where it hangs goes to `log`."""
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
    """One numerical thread for processes started inside: libraries read these variables when loaded."""
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
