"""Progress on standard error: lines, bars, and redirected output of others. Where that is no terminal a bar is a line
as it begins, and one as it ends if it took long.

How far the compiling of the analytic model has come.
"""

from __future__ import annotations

import contextlib
import os
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager

from numba.core.dispatcher import Dispatcher
from numba.core.event import Event, Listener, register, unregister

from .files import readable

COMPILING = "compiling the analytic model, once on this machine"
PATIENCE = 2.0  # s that something may take before it is said
SHOWN = 60  # characters of what is under way


def compile_kernels(vertical: bool = False) -> None:
    """`analytic.solver.compile_kernels` before a clock starts; shown where it takes a while.

    vertical : also for motions with a vertical component.
    """
    from analytic import solver

    with compiling():
        solver.compile_kernels(vertical)


@contextlib.contextmanager
def compiling() -> Iterator[None]:
    """Shows how many functions of the analytic model are compiled so far inside: a bar, or a line that it takes a while
    where that is no terminal. Nothing where they are found on the disk."""
    pass

    counted = Counted()
    with contextlib.ExitStack() as shown:

        def show():
            if sys.stderr.isatty():
                counted.show(shown.enter_context(bar(COMPILING, counted.known)))
            else:
                say(f"{COMPILING}: some ten seconds")

        with _if_it_takes_long(show), counted:
            yield


@contextlib.contextmanager
def _if_it_takes_long(tell):
    """Calls `tell`, in another thread, once what is done inside has taken `PATIENCE`."""
    telling = threading.Timer(PATIENCE, tell)
    telling.start()
    try:
        yield
    finally:
        telling.cancel()
        telling.join()


@contextlib.contextmanager
def lines(text: str) -> Iterator[None]:
    """A line on standard error as what is done inside begins, and one as it ends if it took more than `PATIENCE`."""
    began, text = time.monotonic(), readable(text, SHOWN)
    say(text)
    yield
    if (seconds := time.monotonic() - began) > PATIENCE:
        say(f"{text}: done in {seconds:.0f} s")


def say(text: str) -> None:
    """A line of progress on standard error."""
    print(text, file=sys.stderr, flush=True)


def log(text: str) -> None:
    """A line of progress on standard error, with the time."""
    print(f"{time.strftime('%H:%M:%S')} {text}", file=sys.stderr, flush=True)


@contextlib.contextmanager
def spinner(text: str) -> Iterator[Callable[[str], None]]:
    """A line on standard error with the time elapsed, while something runs; where that is no terminal, `text` once it
    takes more than `PATIENCE`."""
    from rich.console import Console
    from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    console, shown = Console(stderr=True), readable(text, SHOWN)
    if not console.is_terminal:
        with _if_it_takes_long(lambda: say(shown)):
            yield lambda words: None
        return
    columns = SpinnerColumn(), TextColumn("{task.description}", markup=False), TimeElapsedColumn()
    with Progress(*columns, transient=True, console=console) as progress:
        task = progress.add_task(shown)
        yield lambda words: progress.update(task, description=readable(words, SHOWN))


@contextlib.contextmanager
def bar(text: str, functions: int | None = None) -> Iterator[Callable[[int, int], None]]:
    """A bar on standard error that is told (done, known of) while something runs; `lines` where that is no terminal.

    functions: about how many are to be compiled; they are counted behind the bar.
    """
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    console, count = Console(stderr=True), TextColumn("{task.completed:.0f} of about {task.total:.0f} functions")
    if not console.is_terminal:
        with lines(text):
            yield lambda done, total: None
        return
    counting = TextColumn("{task.description}", markup=False), BarColumn(), count, TimeElapsedColumn()
    columns = counting if functions else Progress.get_default_columns()
    with Progress(*columns, transient=True, console=console) as progress:
        task = progress.add_task(readable(text, SHOWN), total=functions)
        yield lambda done, total: progress.update(task, completed=done, total=total)


@contextlib.contextmanager
def redirected(*descriptors: int, to: int) -> Iterator[None]:
    """What this process prints to `descriptors` (1 and 2), compiled code included, goes to the file number `to`."""
    sys.stdout.flush(), sys.stderr.flush()
    kept = {number: os.dup(number) for number in descriptors}
    for number in descriptors:
        os.dup2(to, number)
    try:
        yield
    finally:
        sys.stdout.flush(), sys.stderr.flush()
        for number, copy in kept.items():
            os.dup2(copy, number)
            os.close(copy)


def stdout_to_stderr() -> contextlib.AbstractContextManager[None]:
    """What this process prints to standard output goes to standard error."""
    return redirected(1, to=2)


PACKAGE, COMPILE = "analytic", "numba:compile"  # whose functions are counted; as numba calls the event


class Counted(Listener, AbstractContextManager["Counted"]):
    """Counts functions of the model that are compiled in a `with` statement, and tells (how many, of about how many).

    known: how many there are and are not compiled yet; a few are compiled twice, for other types, and some may not be
    needed, or are on the disk.
    """

    def __init__(self) -> None:
        self.done, self.known = 0, _known()
        self._tell: Callable[[int, int], object] = lambda done, known: None

    def __enter__(self) -> Counted:
        register(COMPILE, self)
        return self

    def __exit__(self, *_: object) -> None:
        unregister(COMPILE, self)

    def on_start(self, event: Event) -> None:
        """Nothing to say yet."""

    def on_end(self, event: Event) -> None:
        """A function is compiled, by numba, the model's or what that calls."""
        if _own(event.data["dispatcher"].py_func.__module__):
            self.done += 1
            self._tell(self.done, max(self.done, self.known))

    def show(self, tell: Callable[[int, int], object]) -> None:
        """From now on tell how far it is."""
        self._tell = tell
        tell(self.done, max(self.done, self.known))


def _own(module):
    return module.partition(".")[0] == PACKAGE


def _known():
    """Functions not yet compiled of loaded modules, and that these hold (`analytic.kernel.compiled.chosen`)."""
    waiting = [one for name, module in sys.modules.copy().items() if _own(name) for one in vars(module).values()]
    found = set()
    while waiting:
        one = waiting.pop()
        if isinstance(one, Dispatcher) and one not in found:
            found.add(one)
            waiting += [cell.cell_contents for cell in one.py_func.__closure__ or ()]
    return sum(not one.overloads for one in found)
