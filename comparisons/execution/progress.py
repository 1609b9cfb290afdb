"""Progress on standard error: lines, bars, redirected output, and the compilation of the analytic model.

If standard error is no terminal, a bar is a line at the begin, and another at the end if it took long.
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

from .writing import readable

COMPILING = "compiling the analytic model, once on this machine"
PATIENCE = 2.0  # s that something may take without a message
SHOWN = 60  # characters shown of a task's name


def compile_kernels(vertical: bool = False) -> None:
    """Compile the analytic model before a clock starts, and show that if it takes a while.

    vertical: also for motions with a vertical component.
    """
    from analytic import solver

    with compiling():
        solver.compile_kernels(vertical)


@contextlib.contextmanager
def compiling() -> Iterator[None]:
    """Show how many functions of the analytic model have been compiled inside, by a bar or, without a terminal, a line.

    Nothing is shown if they are found on the disk.
    """
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
    """Call `tell`, in another thread, once the code inside has taken `PATIENCE`."""
    telling = threading.Timer(PATIENCE, tell)
    telling.start()
    try:
        yield
    finally:
        telling.cancel()
        telling.join()


@contextlib.contextmanager
def lines(text: str) -> Iterator[None]:
    """Print a line when the code inside begins, and another when it ends if it took more than `PATIENCE`."""
    began, text = time.monotonic(), readable(text, SHOWN)
    say(text)
    yield
    if (seconds := time.monotonic() - began) > PATIENCE:
        say(f"{text}: done in {seconds:.0f} s")


def say(text: str) -> None:
    """Print a line on standard error."""
    print(text, file=sys.stderr, flush=True)


def log(text: str) -> None:
    """Print a line on standard error, with the time of day."""
    print(f"{time.strftime('%H:%M:%S')} {text}", file=sys.stderr, flush=True)


@contextlib.contextmanager
def spinner(text: str) -> Iterator[Callable[[str], None]]:
    """Show `text` and the time elapsed while the code inside runs. Yields a function that changes the text.

    Without a terminal `text` is printed once, if that takes more than `PATIENCE`.
    """
    from rich.console import Console

    console, shown = Console(stderr=True), readable(text, SHOWN)
    if not console.is_terminal:
        with _if_it_takes_long(lambda: say(shown)):
            yield lambda words: None
        return
    from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn  # slow to load

    columns = SpinnerColumn(), TextColumn("{task.description}", markup=False), TimeElapsedColumn()
    with Progress(*columns, transient=True, console=console) as progress:
        task = progress.add_task(shown)
        yield lambda words: progress.update(task, description=readable(words, SHOWN))


@contextlib.contextmanager
def bar(text: str, functions: int | None = None) -> Iterator[Callable[[int, int], None]]:
    """Show a bar while the code inside runs. Yields a function that takes (number done, number known of).

    Without a terminal `lines` are printed. functions: about how many are to be compiled; the bar counts them.
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
    """Redirect what this process, also compiled code, prints to `descriptors` (1 and 2) to the file number `to`."""
    sys.stdout.flush(), sys.stderr.flush()
    copies = {number: os.dup(number) for number in descriptors}
    for number in descriptors:
        os.dup2(to, number)
    try:
        yield
    finally:
        sys.stdout.flush(), sys.stderr.flush()
        for number, copy in copies.items():
            os.dup2(copy, number)
            os.close(copy)


def stdout_to_stderr() -> contextlib.AbstractContextManager[None]:
    """Redirect the standard output of this process to standard error."""
    return redirected(1, to=2)


PACKAGE, COMPILE = "analytic", "numba:compile"  # the package whose functions are counted; numba's name of the event


class Counted(Listener, AbstractContextManager["Counted"]):
    """Counts the functions of the model that are compiled in a `with` statement, and reports (number, about how many).

    known: the number of functions not compiled yet. It is an estimate: a few are compiled twice, for other types, and
    some are not needed or are on the disk.
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
        """Do nothing: a function counts when it is compiled."""

    def on_end(self, event: Event) -> None:
        """Count a function that numba has compiled, if it is the model's."""
        if _own(event.data["dispatcher"].py_func.__module__):
            self.done += 1
            self._tell(self.done, max(self.done, self.known))

    def show(self, tell: Callable[[int, int], object]) -> None:
        """Report the progress to `tell`, now and from now on."""
        self._tell = tell
        tell(self.done, max(self.done, self.known))


def _own(module):
    return module.partition(".")[0] == PACKAGE


def _known():
    """The number of functions not yet compiled in loaded modules and closures (`analytic.kernel.compiled.chosen`)."""
    waiting = [value for name, module in sys.modules.copy().items() if _own(name) for value in vars(module).values()]
    functions = set()
    while waiting:
        dispatcher = waiting.pop()
        if isinstance(dispatcher, Dispatcher) and dispatcher not in functions:
            functions.add(dispatcher)
            waiting += [cell.cell_contents for cell in dispatcher.py_func.__closure__ or ()]
    return sum(not dispatcher.overloads for dispatcher in functions)
