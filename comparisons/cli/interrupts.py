"""Ctrl-C, SIGTERM and SIGHUP: a command ends within a second, in whatever compiled code it is."""

import contextlib
import os
import shutil
import signal
import sys
import threading
from collections.abc import Iterator

GRACE_SECONDS = 0.5  # to close workers and files in good order; then the process is ended
SIGHUP = getattr(signal, "SIGHUP", signal.SIGTERM)  # a terminal is closed; not every system has it
SIGNALS = tuple(dict.fromkeys((signal.SIGINT, signal.SIGTERM, SIGHUP)))
_ending = threading.Lock()  # of the thread that says so
SHOW_CURSOR = b"\x1b[?25h"  # a progress bar that was cut off has hidden it


class Stopped(BaseException):
    """The command was told to end, by a signal of this number.

    No KeyboardInterrupt: libraries turn that into something of their own.
    """


@contextlib.contextmanager
def stoppable() -> Iterator[None]:
    """SIGINT, SIGTERM and SIGHUP raise `Stopped` inside, and then end the process with status 130, 143 or 129.

    Where compiled code does not let the exception through, the process is ended in the midst. For the main thread.
    A SIGHUP that is ignored (nohup) stays so.
    """
    read, write = os.pipe()
    os.set_blocking(write, False)
    wakeup = signal.set_wakeup_fd(write, warn_on_full_buffer=False)  # written to in C, at once
    watch = threading.Thread(target=_watch, args=(read,), daemon=True)
    watch.start()
    handlers = {number: signal.getsignal(number) for number in SIGNALS}
    if handlers[SIGHUP] is signal.SIG_IGN:
        del handlers[SIGHUP]
    try:
        for number in handlers:
            signal.signal(number, _stop)
        yield
    except Stopped as stop:  # all is closed by now
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
        signal.signal(each, signal.SIG_IGN)  # a second Ctrl-C must not break off the closing
    raise Stopped(number)


def _watch(read):
    if told := os.read(read, 1):
        threading.Event().wait(GRACE_SECONDS)
        _end(told[0])


def _end(number):
    if _ending.acquire(blocking=False):
        words = "Interrupted." if number == signal.SIGINT else f"Ended by {signal.Signals(number).name}."
        with contextlib.suppress(OSError):
            os.write(2, (SHOW_CURSOR if os.isatty(2) else b"") + words.encode() + b"\n")
    with contextlib.suppress(Exception):  # a module that is not loaded, too: nothing may be imported now
        _end_children()
    with contextlib.suppress(Exception):
        _remove_folders()
    os._exit(128 + number)


def _end_children():
    psutil = sys.modules["psutil"]  # where processes are started it has been imported; guarded runs end anyway
    for child in psutil.Process().children(recursive=True):
        with contextlib.suppress(psutil.Error):
            child.kill()


def _remove_folders():
    """This project's temporary folders, and the one of multiprocessing's sockets: removed at an exit in good order."""
    sys.modules["comparisons.running.files"].remove_temporary_folders()
    shutil.rmtree(sys.modules["multiprocessing.util"].get_temp_dir(), ignore_errors=True)


def open_streams() -> None:
    """Give standard streams that are closed a place: reading ends at once, writing results is an error, notes vanish.

    What the terminal cannot show is printed as its code.
    """
    for number, name, mode in ((0, "stdin", os.O_RDONLY), (1, "stdout", os.O_RDONLY), (2, "stderr", os.O_WRONLY)):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, mode)  # takes the lowest number that is free
            setattr(sys, name, open(number, "w" if number else "r", closefd=False))
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(AttributeError, OSError, ValueError):
            stream.reconfigure(errors="backslashreplace")  # type: ignore[union-attr]  # what Python itself opens has it
