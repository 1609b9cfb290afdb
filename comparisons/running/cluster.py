"""Runs of a sweep on a cluster, by Dask: the tasks of `executors`, done by its workers, which guard them likewise.

    with Cluster("tcp://scheduler:8786", solvers) as executor:
        rows = run_sweep(cases, store="results/map.jsonl", measure=outcome, executor=executor)

A Dask worker is a daemon, which may not start processes (unless `distributed.worker.daemon` is False where it starts,
which nobody here can see to). So it starts this module as a program, a servant, which guards the runs by `Processes` as
ever, and ends with its worker.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
import os
import pickle
import platform
import queue
import select
import subprocess
import sys
import threading
import time
from collections.abc import Iterable
from concurrent import futures
from functools import partial
from typing import Any

from analytic.errors import SettingError

from .cases import compile_for, module_of, versions
from .executors import Closing, Done, Processes, Task, number_of
from .sources import PROJECT, source_digests

LOCAL = "local:"
PATIENCE = 5.0  # s, for a scheduler that does not answer
INSTALL = 'pip install -e ".[cluster]" in a checkout of this project'


class ClusterError(RuntimeError):
    """A cluster that cannot do the runs, or no longer; says which part of it, and the remedy."""


class Cluster(Closing):
    """Runs on the workers of a Dask scheduler, or on ``local:N`` workers started here for the purpose.

    Parameters
    ----------
    address : str
        Of the scheduler, "host:port" or as Dask writes it; or "local:N".
    solvers : iterable of str
        Those that the runs will need.

    Raises
    ------
    SettingError
        Dask is not installed, no scheduler answers there, or it has no workers.
    ClusterError
        A worker has other versions or other code than this process: names both.
    """

    def __init__(self, address: str, solvers: Iterable[str] = ()) -> None:
        self._solvers = tuple(sorted(set(solvers)))
        self._ended: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self._under_way: dict[Any, Task] = {}
        self._address, self._answered = address, time.monotonic()
        with contextlib.ExitStack() as stack:
            self._client = _connect(address, stack)
            stack.callback(self._dismiss)
            threads = self._client.nthreads()
            if not threads:
                raise SettingError(f"the scheduler at {address} has no workers: start some with dask worker {address}")
            _check_same(self._ask(partial(_state, self._solvers)), _state(self._solvers))
            self.slots = 2 * sum(threads.values())
            self._exits = stack.pop_all()

    def submit(self, task: Task) -> None:
        future = self._client.submit(_serve_here, pickle.dumps(task), self._solvers, pure=False)
        self._under_way[future] = task
        future.add_done_callback(self._ended.put)

    def next(self) -> Done:
        from distributed import KilledWorker

        while True:
            self._check_alive()
            try:
                future = self._ended.get(timeout=0.5)
            except queue.Empty:
                continue
            if future in self._under_way:
                break
        task = self._under_way.pop(future)
        try:
            error = future.exception(timeout=PATIENCE)
            if error is None:
                return future.result(timeout=PATIENCE)
        except (OSError, TimeoutError, asyncio.CancelledError, futures.CancelledError):  # nobody else drops one
            raise self._gone() from None
        if isinstance(error, KilledWorker):
            reason = "several workers of the cluster ended while they did it"
            return Done(task.ticket, lost={"kind": "crash", "reason": reason, "exit_code": -9, "message": ""})
        raise ClusterError(f"a worker of the cluster cannot do the runs: {type(error).__name__}: {error}")

    def close(self) -> None:
        self._exits.close()

    def _ask(self, function):
        try:
            return self._client.run(function)
        except Exception as error:
            raise ClusterError(
                f"the workers at {self._address} cannot load this project ({type(error).__name__}: {error}): install "
                "the same version of it there"
            ) from None

    def _dismiss(self):
        if self._client.status == "running":
            with contextlib.suppress(Exception):
                self._client.run(_dismiss_servants, wait=False)

    def _check_alive(self):
        if self._client.status == "running":
            self._answered = time.monotonic()
        elif time.monotonic() - self._answered > PATIENCE:
            raise self._gone()

    def _gone(self):
        return ClusterError(
            f"the scheduler at {self._address} is gone; rows done so far are kept: start it and its workers again, and "
            "repeat the command"
        )


def _connect(address, stack):
    """A Dask client of the scheduler at an address, or of one started here; closed by `stack`."""
    try:
        import dask
        from distributed import Client, LocalCluster
    except ImportError:
        raise SettingError(f"--scheduler {address}: Dask is not installed; {INSTALL}") from None
    stack.enter_context(dask.config.set({"distributed.comm.timeouts.connect": f"{PATIENCE:g}s"}))
    for name in [name for name in logging.root.manager.loggerDict if name.startswith("distributed")]:
        logging.getLogger(name).setLevel(logging.CRITICAL)  # what is lost is said here, once
    if address.startswith(LOCAL):
        number = number_of(_whole(address))
        local = LocalCluster(
            n_workers=number,
            threads_per_worker=1,
            processes=True,
            dashboard_address=":0",  # any port: the usual one may be taken
            memory_limit=0,
            silence_logs=logging.CRITICAL,
        )
        stack.callback(local.close, timeout=PATIENCE)
        address = local.scheduler_address
    try:
        asyncio.run(_reach(address))  # a client that finds nobody leaves threads behind
    except (OSError, ValueError) as error:
        raise SettingError(
            f"--scheduler {address}: no scheduler answers there ({type(error).__name__}); give host:port of a dask "
            "scheduler, or local:N"
        ) from None
    client = Client(address, timeout=PATIENCE, set_as_default=False)
    stack.callback(client.close, timeout=PATIENCE)
    return client


async def _reach(address):
    from distributed import Security
    from distributed.comm import connect

    comm = await connect(address, timeout=PATIENCE, **Security().get_connection_args("scheduler"))
    await comm.close()


def _whole(address):
    try:
        return int(address.removeprefix(LOCAL))
    except ValueError:
        raise SettingError(f"--scheduler {address}: give local:N with a number of workers") from None


def _state(solvers):
    """{what: its version or digest} of all that rows depend on, in the process that asks."""
    state = {"python": platform.python_version()}
    for name in solvers:
        state |= {package: str(number) for package, number in versions(name).items()}
    return state | source_digests([module_of(name) for name in solvers]) | source_digests([*PROJECT, __name__])


def _check_same(theirs, mine):
    """Raise `ClusterError` where a worker's `_state` differs from mine."""
    for worker, state in theirs.items():
        other = sorted(name for name in mine.keys() | state.keys() if mine.get(name) != state.get(name))
        if not other:
            continue
        numbers = [
            f"{name} {state.get(name)} there, {mine.get(name)} here"
            for name in other
            if "." in f"{state.get(name)}{mine.get(name)}"
        ]
        what = ", ".join(numbers) or f"the code of {', '.join(other[:3])}{' and more' if len(other) > 3 else ''}"
        raise ClusterError(f"worker {worker} differs: {what}; install the same there, and start its worker again")


# In a Dask worker: the servant of each of its threads, with the solvers it has loaded.
_servants: dict[int, tuple[tuple[str, ...], subprocess.Popen]] = {}


def _serve_here(data: bytes, solvers: tuple[str, ...]) -> Done:
    """In a Dask worker: the `Done` of a pickled `Task`, by this thread's servant."""
    servant = _servant(solvers)
    try:
        servant.stdin.write(data)
        servant.stdin.flush()
        return pickle.load(servant.stdout)
    except (OSError, EOFError):
        _servants.pop(threading.get_ident(), None)
        lost = {
            "kind": "crash",
            "reason": "the process that guards the runs was killed",
            "exit_code": -9,
            "message": "",
        }
        return Done(pickle.loads(data).ticket, lost=lost)


def _servant(solvers):
    kept, servant = _servants.get(threading.get_ident(), ((), None))
    if servant is None or servant.poll() is not None or kept != solvers:
        if servant is not None:
            servant.kill()
        path = os.pathsep.join(sys.path)
        servant = subprocess.Popen(
            [sys.executable, "-m", __name__, *solvers],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env={**os.environ, "PYTHONPATH": path},
        )
        _servants[threading.get_ident()] = solvers, servant
    return servant


def _dismiss_servants() -> None:
    """In a Dask worker: let the servants go; one at work has nothing to lose."""
    for _, servant in list(_servants.values()):
        servant.stdin.close()  # type: ignore[union-attr]  # a pipe
    for _, servant in list(_servants.values()):
        servant.wait()
    _servants.clear()


def serve(solvers: tuple[str, ...]) -> None:
    """As a program under a Dask worker: tasks in on standard input, what became of them out on standard output."""
    busy = threading.Event()
    threading.Thread(target=_end_with_worker, args=(busy,), daemon=True).start()
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # engines greet on standard output
    compile_for(solvers)
    with Processes(1, solvers) as executor, contextlib.suppress(EOFError):
        while True:
            task = pickle.load(sys.stdin.buffer)
            busy.set()
            executor.submit(task)
            pickle.dump(executor.next(), answers)
            answers.flush()
            busy.clear()


def _end_with_worker(busy):
    """End this process, even if `busy`, when nobody holds the other end of its standard input: the worker is gone."""
    watched = select.poll()
    watched.register(0, 0)  # told of a hang-up without being asked for it
    watched.poll()
    if busy.is_set():
        os._exit(1)


if __name__ == "__main__":
    serve(tuple(sys.argv[1:]))


def workers_at(scheduler: str | None, workers: int | None, solvers: Iterable[str]) -> Any:
    """The executor of a Dask scheduler at an address, or without one of so many worker processes here."""
    return Processes(workers, solvers) if scheduler is None else Cluster(scheduler, solvers)
