"""Runs of a sweep on a cluster, by Dask.

    with Cluster("tcp://scheduler:8786", solvers) as executor:
        rows = run_sweep(cases, store="results/map.jsonl", measure=outcome, executor=executor)

Each thread of a Dask worker has a child process that guards its runs by `Processes`. If a run crashes or hangs, only
its row is lost, and the worker goes on.
"""

import asyncio
import contextlib
import logging
import multiprocessing
import pickle
import queue
import threading
import time
from collections.abc import Iterable
from concurrent import futures
from functools import partial
from typing import Any

from analytic.errors import SettingError

from .cases import compile_for, root_of, versions
from .code_digests import PROJECT, source_digests
from .progress import say
from .sweep import Done, Executor, Processes, Task, end_with, number_of
from .writing import Mendable

LOCAL = "local:"
PATIENCE = 5.0  # s, for a scheduler that does not answer
GRACE = 1.0  # s, for an idle guard to end
INSTALL = 'pip install -e ".[cluster]" in a checkout of this project'


class ClusterError(Mendable):
    """The cluster cannot make the runs, or no longer can; the message names the part and the remedy."""


class Cluster(Executor):
    """Runs on the workers of a Dask scheduler, or on ``local:N`` workers started here for the purpose.

    Parameters
    ----------
    address : str
        Address of the scheduler, "host:port" or as Dask writes it; or "local:N".
    solvers : iterable of str
        Solvers that the runs need.

    Raises
    ------
    SettingError
        Dask is not installed, no scheduler answers there, or it has no workers.
    ClusterError
        A worker has other versions or other code than this process; the message names both.
    """

    def __init__(self, address: str, solvers: Iterable[str] = ()) -> None:
        self._solvers = tuple(sorted(set(solvers)))
        self._ended: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self._under_way: dict[Any, Task] = {}
        self._address, self._answered = address, time.monotonic()
        with contextlib.ExitStack() as stack:
            self._client = _connect(address, stack)
            stack.callback(self._dismiss)
            self._check_workers()
            self.slots = 2 * sum(self._client.nthreads().values())
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
        except (OSError, TimeoutError, asyncio.CancelledError, futures.CancelledError):  # no other code cancels a task
            raise self._gone() from None
        if isinstance(error, KilledWorker):
            return _crashed(task.ticket, "several workers of the cluster ended while they did it")
        raise ClusterError(f"a worker of the cluster cannot do the runs: {type(error).__name__}: {error}")

    def __exit__(self, *_: object) -> None:
        self._exits.close()

    def _check_workers(self):
        """Raise `ClusterError` if a worker is not of this version. A worker lost meanwhile is named and left out."""
        mine, end = _state(self._solvers), time.monotonic() + PATIENCE
        same: set[str] = set()
        lost: set[str] = set()
        while unknown := sorted(self._client.nthreads().keys() - same):  # some may have come in the place of those lost
            answers = self._client.run(partial(_state, self._solvers), workers=unknown, on_error="return")
            for worker, state in answers.items():
                if not isinstance(state, OSError):
                    _check_same(worker, state, mine)
                    same.add(worker)
                elif time.monotonic() < end:  # the scheduler has not yet detected the loss
                    lost.add(worker)
                else:
                    raise ClusterError(f"worker {worker} does not answer ({state}): end it, or start it again")
            time.sleep(0.1 if lost - same else 0.0)
        for worker in sorted(lost - same):
            say(f"worker {worker} was lost while versions were compared: the others do its runs")
        if not same:
            raise SettingError(
                f"the scheduler at {self._address} has no workers: start some with dask worker {self._address}"
            )

    def _dismiss(self):
        if self._client.status == "running":
            with contextlib.suppress(Exception):
                self._client.run(_dismiss_guards, wait=False)

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
    """A Dask client of the scheduler at an address, or of a scheduler started here. `stack` closes both."""
    try:
        import dask
        from distributed import Client, LocalCluster
    except ImportError:
        raise SettingError(f"--scheduler {address}: Dask is not installed; {INSTALL}") from None
    stack.enter_context(dask.config.set({"distributed.comm.timeouts.connect": f"{PATIENCE:g}s"}))
    for name in [name for name in logging.root.manager.loggerDict if name.startswith("distributed")]:
        logging.getLogger(name).setLevel(logging.CRITICAL)  # this module reports what is lost, once
    if address.startswith(LOCAL):
        number = address.removeprefix(LOCAL)
        if not number.isdecimal():
            raise SettingError(f"--scheduler {address}: give local:N with a number of workers")
        local = LocalCluster(
            n_workers=number_of(int(number)),
            threads_per_worker=1,
            processes=True,
            dashboard_address=":0",  # any port: the usual one may be taken
            memory_limit=0,
            silence_logs=logging.CRITICAL,
        )
        stack.callback(local.close, timeout=PATIENCE)
        address = local.scheduler_address
    try:
        asyncio.run(_reach(address))  # a client without a scheduler leaves threads running
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


def _state(solvers):
    """{name: version or digest} of all that rows depend on, in the process that calls."""
    known = {package: str(number) for name in solvers for package, number in versions(name).items()}
    return known | source_digests([*map(root_of, solvers), *PROJECT, __name__])


def _check_same(worker, state, mine):
    """Raise `ClusterError` if the `_state` of a worker differs from mine, or is an error."""
    if isinstance(state, Exception):
        raise ClusterError(
            f"worker {worker} cannot load this project ({type(state).__name__}: {state}): install the same version of "
            "it there"
        )
    other = sorted(name for name in mine.keys() | state.keys() if mine.get(name) != state.get(name))
    if not other:
        return
    numbers = [
        f"{name} {state.get(name)} there, {mine.get(name)} here"
        for name in other
        if "." in f"{state.get(name)}{mine.get(name)}"
    ]
    what = ", ".join(numbers) or f"the code of {', '.join(other[:3])}{' and more' if len(other) > 3 else ''}"
    raise ClusterError(f"worker {worker} differs: {what}; install the same there, and start its worker again")


# In a Dask worker: for each thread the process that guards its runs, and this end of the pipe to it.
_guards: dict[tuple[int, tuple[str, ...]], tuple[Any, Any]] = {}


def _serve_here(data: bytes, solvers: tuple[str, ...]) -> Done:
    """In a Dask worker: let this thread's guard do a pickled `Task`, and return its `Done`."""
    place = threading.get_ident(), solvers
    if place not in _guards:
        _guards[place] = _start_guard(solvers)
    try:
        _guards[place][1].send_bytes(data)
        return _guards[place][1].recv()
    except (OSError, EOFError):
        del _guards[place]
        return _crashed(pickle.loads(data).ticket, "the process that guards the runs was killed")


def _start_guard(solvers):
    multiprocessing.current_process().daemon = False  # Dask's workers are daemons, which may not start processes
    context = multiprocessing.get_context("spawn")  # a new interpreter: the code is that of the files as they are now
    ours, theirs = context.Pipe()
    guard = context.Process(target=guard_runs, args=(theirs, solvers))
    guard.start()
    theirs.close()
    return guard, ours


def _dismiss_guards() -> None:
    """In a Dask worker: end its guards. The results of runs under way are dropped."""
    while _guards:
        guard, ours = _guards.popitem()[1]
        ours.close()
        guard.join(GRACE)
        guard.kill()


def guard_runs(connection: Any, solvers: tuple[str, ...]) -> None:
    """In a child process of a Dask worker: receive tasks and send their results until the worker disconnects."""
    threading.Thread(target=end_with, args=(multiprocessing.parent_process(),), daemon=True).start()
    compile_for(solvers)
    with Processes(1, solvers) as executor, contextlib.suppress(EOFError):
        while True:
            executor.submit(pickle.loads(connection.recv_bytes()))
            connection.send(executor.next())


def _crashed(ticket, reason):
    return Done(ticket, lost={"kind": "crash", "reason": reason, "exit_code": -9, "message": ""})
