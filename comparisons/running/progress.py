"""Progress on standard error: lines, bars, and redirected output of others."""

from __future__ import annotations

import contextlib
import os
import sys
import threading
import time
from collections.abc import Callable, Iterator

from .readable import readable

COMPILING = "compiling the analytic model, once on this machine"
PATIENCE = 2.0  # s that compiled functions may take to load before a message
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
    from .compiled import Counted

    counted = Counted()
    with contextlib.ExitStack() as shown:

        def show():
            if sys.stderr.isatty():
                counted.show(shown.enter_context(bar(COMPILING, counted.known)))
            else:
                say(f"{COMPILING}: some ten seconds")

        telling = threading.Timer(PATIENCE, show)
        telling.start()
        try:
            with counted:
                yield
        finally:
            telling.cancel()
            telling.join()


def say(text: str) -> None:
    """A line of progress on standard error."""
    print(text, file=sys.stderr, flush=True)


def log(text: str) -> None:
    """A line of progress on standard error, with the time."""
    print(f"{time.strftime('%H:%M:%S')} {text}", file=sys.stderr, flush=True)


@contextlib.contextmanager
def spinner(text: str) -> Iterator[Callable[[str], None]]:
    """A line on standard error with the time elapsed, while something runs; nothing where that is no terminal."""
    from rich.console import Console
    from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    console = Console(stderr=True)
    columns = SpinnerColumn(), TextColumn("{task.description}", markup=False), TimeElapsedColumn()
    with Progress(*columns, transient=True, console=console, disable=not console.is_terminal) as progress:
        task = progress.add_task(readable(text, SHOWN))
        yield lambda words: progress.update(task, description=readable(words, SHOWN))


@contextlib.contextmanager
def bar(text: str, functions: int | None = None) -> Iterator[Callable[[int, int], None]]:
    """A bar on standard error that is told (done, known of) while something runs; nothing where that is no terminal.

    functions: about how many are to be compiled; they are counted behind the bar.
    """
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    console, count = Console(stderr=True), TextColumn("{task.completed:.0f} of about {task.total:.0f} functions")
    counting = TextColumn("{task.description}", markup=False), BarColumn(), count, TimeElapsedColumn()
    columns = counting if functions else Progress.get_default_columns()
    with Progress(*columns, transient=True, console=console, disable=not console.is_terminal) as progress:
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
