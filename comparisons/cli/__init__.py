"""The command ``rocking``: runs a command and ends with a status and at most one message.

Status 0: done; 1: a solver failed, or the output is closed; 2: a mistake that the user can correct; 130: Ctrl-C.
Heavy modules are imported inside `main`, where Ctrl-C is handled.

Ctrl-C, SIGTERM and SIGHUP: a command ends within a second, even in compiled code.
"""

import contextlib
import os
import shutil
import signal
import sys
import threading
from collections.abc import Iterator, Sequence

from ..execution.writing import Mendable, readable

GRACE_SECONDS = 0.5  # to close workers and files; then the process is ended
SIGHUP = getattr(signal, "SIGHUP", signal.SIGTERM)  # the terminal was closed; not on every system
SIGNALS = tuple(dict.fromkeys((signal.SIGINT, signal.SIGTERM, SIGHUP)))
_ending = threading.Lock()  # held while the process ends
SHOW_CURSOR = b"\x1b[?25h"  # an interrupted progress bar has hidden it


class Stopped(BaseException):
    """The command must end, by a signal of this number.

    It is not a KeyboardInterrupt, which libraries convert into errors of their own.
    """


@contextlib.contextmanager
def stoppable() -> Iterator[None]:
    """SIGINT, SIGTERM and SIGHUP raise `Stopped` inside, and then end the process with status 130, 143 or 129.

    If compiled code does not return to let the exception pass, the process is ended. For the main thread only. An
    ignored SIGHUP (nohup) stays ignored.
    """
    read, write = os.pipe()
    os.set_blocking(write, False)
    wakeup = signal.set_wakeup_fd(write, warn_on_full_buffer=False)  # written by C code, immediately
    watch = threading.Thread(target=_watch, args=(read,), daemon=True)
    watch.start()
    handlers = {number: signal.getsignal(number) for number in SIGNALS}
    if handlers[SIGHUP] is signal.SIG_IGN:
        del handlers[SIGHUP]
    try:
        for number in handlers:
            signal.signal(number, _stop)
        yield
    except Stopped as stop:  # everything is closed
        _end(stop.args[0])
    finally:
        for number, handler in handlers.items():
            signal.signal(number, handler)
        signal.set_wakeup_fd(wakeup)
        os.close(write)
        watch.join()
        os.close(read)


def _stop(number, _frame):
    for each in SIGNALS:
        signal.signal(each, signal.SIG_IGN)  # a second Ctrl-C must not interrupt the closing
    raise Stopped(number)


def _watch(read):
    if received := os.read(read, 1):
        threading.Event().wait(GRACE_SECONDS)
        _end(received[0])


def _end(number):
    if _ending.acquire(blocking=False):
        words = "Interrupted." if number == signal.SIGINT else f"Ended by {signal.Signals(number).name}."
        with contextlib.suppress(Exception):  # where no study was begun, its module may not be loaded
            words = f"{words} {readable(sys.modules['comparisons.execution.runner'].kept())}".rstrip()
        with contextlib.suppress(OSError):
            os.write(2, (SHOW_CURSOR if os.isatty(2) else b"") + words.encode() + b"\n")
    with contextlib.suppress(Exception):  # also if a module is not loaded, as nothing may be imported now
        _end_children()
    with contextlib.suppress(Exception):
        _remove_folders()
    os._exit(128 + number)


def _end_children():
    psutil = sys.modules["psutil"]  # imported wherever processes are started; guarded runs end by themselves
    for child in psutil.Process().children(recursive=True):
        with contextlib.suppress(psutil.Error):
            child.kill()


def _remove_folders():
    """Remove the temporary folders that a normal exit would remove: this project's, and that of multiprocessing."""
    sys.modules["comparisons.execution.writing"].remove_temporary_folders()
    shutil.rmtree(sys.modules["multiprocessing.util"].get_temp_dir(), ignore_errors=True)


def open_streams() -> None:
    """Replace closed standard streams: reading ends at once, writing results is an error, messages are discarded.

    Characters that the terminal cannot show are printed as their codes.
    """
    for number, name, mode in ((0, "stdin", os.O_RDONLY), (1, "stdout", os.O_RDONLY), (2, "stderr", os.O_WRONLY)):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, mode)  # takes the lowest free number
            setattr(sys, name, open(number, "w" if number else "r", closefd=False))
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(AttributeError, OSError, ValueError):
            stream.reconfigure(errors="backslashreplace")  # type: ignore[union-attr]  # what Python itself opens has it


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line and exit with its status."""
    open_streams()  # first, so that no other file takes the number of a closed stream
    with stoppable():
        status = _status(arguments)
    sys.exit(status)


def _status(arguments):
    try:
        from ..commands import app

        status = app(arguments, standalone_mode=False)
        sys.stdout.flush()
        return status if isinstance(status, int) else 0
    except BrokenPipeError:  # the reader has closed the pipe
        _silence()
        return 1
    except OSError as error:
        with contextlib.suppress(OSError):
            sys.stdout.flush()
        message = f"{error.filename}: {error.strerror}" if error.filename else error.strerror or error
        return _mistake(f"{message}; give another place, or free space there")
    except MemoryError as error:
        return _mistake(f"not enough memory ({error}); ask for less")
    except Exception as error:
        if type(error).__name__ == "Abort":  # click's, too, at a question
            return _mistake("the input ended at a question; give options instead")
        if hasattr(error, "format_message"):  # click's: a usage error or a help page
            return _usage(error)
        from analytic.errors import EngineNotInstalled, SceneError, SettingError

        if isinstance(error, SceneError | SettingError | EngineNotInstalled | Mendable):
            return _mistake(*getattr(error, "lines", [error]))  # mistakes in a scene, one per line
        raise


def _mistake(*lines):
    with contextlib.suppress(OSError):
        print("Error: " + "\n".join(map(readable, lines)), file=sys.stderr, flush=True)
    _silence()
    return 2


def _usage(error):
    if error.message and "\n" not in error.message:  # not a help page
        error.message = readable(error.message)
    with contextlib.suppress(OSError):
        error.show()
    return error.exit_code


def _silence():
    """Discard the buffers of broken streams, which the interpreter would fail to write when it ends."""
    null = os.open(os.devnull, os.O_WRONLY)
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except OSError:
            os.dup2(null, stream.fileno())
    os.close(null)
