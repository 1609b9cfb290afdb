"""A run in a process of its own, so that a hang, a crash or Ctrl-C loses only that run.

`without` suppresses what a package prints when it is imported; other output passes.
"""

from __future__ import annotations

import contextlib
import ctypes
import faulthandler
import math
import multiprocessing
import os
import signal
import sys
import tempfile
import traceback
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager
from multiprocessing import connection
from multiprocessing.reduction import ForkingPickler
from typing import IO, Any

from analytic.errors import EngineNotInstalled, SceneError, SettingError
from analytic.response import Failure

LONGEST = 1e6  # s; longer limits overflow the system's timers
GRACE_SECONDS = 0.3  # after the time limit, for the process to write its traceback
EVIDENCE_CHARACTERS = 4000
OUT_OF_TIME = "the run did not end in time"
RAISED = "the run raised an error"
MISTAKES = (SettingError, SceneError, EngineNotInstalled)  # errors of the caller, not of the engine
STOPPING = {signal.SIGINT, signal.SIGTERM, getattr(signal, "SIGHUP", signal.SIGTERM)}
PR_SET_PDEATHSIG = 1
TRACE = getattr(signal, "SIGUSR1", None)  # asks a process that hangs for its traceback


def check_time_limit(time_limit: float) -> None:
    """Raise `ValueError` unless `time_limit` [s] is positive and at most `LONGEST`."""
    if not (math.isfinite(time_limit) and 0 < time_limit <= LONGEST):
        raise ValueError(f"time_limit = {time_limit!r}: give a time above 0 and up to {LONGEST:g} [s]")


def run_apart(
    function: Callable[..., Any],
    *arguments: Any,
    time_limit: float,
    meanwhile: AbstractContextManager[Any] | None = None,
) -> tuple[Any, Failure | None]:
    """Call a function in a process of its own: (result, None), or (None, `Failure`) without a result.

    Parameters
    ----------
    function : callable
        A module-level function. Its output goes to standard error.
    *arguments
        Arguments that can be pickled.
    time_limit : float
        Wall-clock time [s] after which the process is killed.
    meanwhile : context manager or None
        Entered while the process runs, such as a progress bar, whose threads are not forked.

    Raises
    ------
    SettingError, SceneError, EngineNotInstalled
        If the function raises them.
    """
    # Fork where that is safe: starting Python and importing the model takes longer than most runs.
    context = multiprocessing.get_context("fork" if sys.platform == "linux" else "spawn")
    reader, writer = context.Pipe(duplex=False)
    with _evidence() as log:
        process = context.Process(target=_work, args=(writer, _number(context, log), function, arguments, time_limit))  # type: ignore[attr-defined]  # every context has it
        # Ctrl-C is blocked until the child ignores it: this process handles it, and an engine would take it for an
        # error of its own.
        blocked = signal.pthread_sigmask(signal.SIG_BLOCK, STOPPING) if hasattr(signal, "pthread_sigmask") else None
        try:
            process.start()
            if blocked is not None:
                signal.pthread_sigmask(signal.SIG_SETMASK, blocked)
            writer.close()
            with meanwhile or contextlib.nullcontext():
                answer = _answer(reader, process, time_limit)
        finally:
            if process.pid is not None:
                process.kill()
                process.join()
            reader.close()
            if blocked is not None:
                signal.pthread_sigmask(signal.SIG_SETMASK, blocked)
        log.seek(0)
        printed = log.read().decode(errors="replace")
    kind, content = answer
    if kind == "mistake":
        raise content
    if kind == "value":
        if printed:
            print(printed, end="", file=sys.stderr, flush=True)
        return content, None
    return None, Failure(content[0], f"{content[1]}\n{_ends(printed)}".strip())


def _answer(reader: Any, process: Any, time_limit: float) -> tuple[str, Any]:
    """Await the process: ("value", result of the function), ("mistake", error) or ("failure", (reason, message))."""
    if not connection.wait([reader, process.sentinel], time_limit):
        if TRACE is not None:
            os.kill(process.pid, TRACE)
            process.join(GRACE_SECONDS)
        return "failure", (OUT_OF_TIME, f"killed after the time limit of {time_limit:g} s")
    try:
        if reader.poll():
            return reader.recv()
    except (EOFError, OSError):  # closed without an answer
        pass
    process.join()
    return "failure", ("the engine's process died", _last_words(process.exitcode))


def _work(
    writer: Any, log: int | None, function: Callable[..., Any], arguments: Sequence[Any], time_limit: float
) -> None:
    """Run the function in the child process and answer through `writer`; log: file number for its output, or None."""
    signal.set_wakeup_fd(-1)
    for number in STOPPING:
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, signal.SIG_DFL)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, STOPPING)
    end_with_parent()
    if hasattr(signal, "setitimer"):  # in case the parent does not kill it
        signal.signal(signal.SIGALRM, signal.SIG_DFL)
        signal.setitimer(signal.ITIMER_REAL, time_limit + 10 * GRACE_SECONDS)
    place = 2 if log is None else log
    if log is not None:
        os.dup2(log, 2)
    os.dup2(2, 1)
    faulthandler.enable(place, all_threads=False)
    if TRACE is not None:
        faulthandler.register(TRACE, file=place, all_threads=False)
    try:
        answer = ForkingPickler.dumps(("value", function(*arguments)))
    except MISTAKES as error:
        answer = ForkingPickler.dumps(("mistake", error))
    except BaseException as error:  # any error of an engine is a failed run with its message
        message = f"{raised(error)}\n{traceback.format_exc()}"[:EVIDENCE_CHARACTERS]
        answer = ForkingPickler.dumps(("failure", (RAISED, message)))
    sys.stdout.flush(), sys.stderr.flush()
    writer.send_bytes(answer)
    os._exit(0)  # without exit handlers, in which an engine could fail


def raised(error: BaseException) -> str:
    """An error in words: its type and message, with its notes in the first line."""
    first, end, rest = f"{type(error).__name__}: {error}".partition("\n")
    notes = "".join(f" ({note})" for note in getattr(error, "__notes__", ()))
    return f"{first}{notes}{end}{rest}"


def end_with_parent() -> None:
    """Let this process end when its parent ends, even in compiled code, where the system supports that."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)


def _evidence() -> IO[bytes]:
    try:
        return tempfile.TemporaryFile()
    except OSError:  # no disk space: the run goes on without a log
        return open(os.devnull, "r+b")


def _number(context: Any, log: IO[bytes]) -> int | None:
    """The file number of `log` as a forked process has it; a spawned one has none."""
    return log.fileno() if context.get_start_method() == "fork" else None


def _ends(text: str) -> str:
    """Beginning and end of the output: the engine's message comes first, the traceback last."""
    half = EVIDENCE_CHARACTERS // 2
    return text if len(text) <= 2 * half else f"{text[:half]}\n[...]\n{text[-half:]}"


def _last_words(code: int | None) -> str:
    """An exit code in words; a negative one is the signal that killed the process."""
    if code is not None and code < 0:
        try:
            return f"killed by signal {-code} ({signal.Signals(-code).name})"
        except ValueError:
            return f"killed by signal {-code}"
    return f"exit code {code}"


@contextlib.contextmanager
def without(greeting: bytes) -> Iterator[None]:
    """Remove lines on standard error that begin with `greeting`, also those that compiled code prints.

    For a few milliseconds only: other output of this process to standard error, from any thread, is delayed until then.
    """
    with contextlib.ExitStack() as closing:
        try:
            original = os.dup(2)
            closing.callback(os.close, original)
            captured = closing.enter_context(tempfile.TemporaryFile())
        except OSError:  # no standard error, or no disk space: the greeting is printed
            yield
            return
        os.dup2(captured.fileno(), 2)
        try:
            yield
        finally:
            os.dup2(original, 2)
            captured.seek(0)
            with contextlib.suppress(OSError):  # standard error is closed
                os.write(2, b"".join(line for line in captured if not line.startswith(greeting)))
