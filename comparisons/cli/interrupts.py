"""Ctrl-C, SIGTERM and SIGHUP: a command ends within a second, even in compiled code."""

import contextlib
import os
import shutil
import signal
import sys
import threading
from collections.abc import Iterator

from ..running.readable import readable

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
    if told := os.read(read, 1):
        threading.Event().wait(GRACE_SECONDS)
        _end(told[0])


def _end(number):
    if _ending.acquire(blocking=False):
        words = "Interrupted." if number == signal.SIGINT else f"Ended by {signal.Signals(number).name}."
        with contextlib.suppress(Exception):  # where no study was begun, its module may not be loaded
            words = f"{words} {readable(sys.modules['comparisons.running.study'].kept())}".rstrip()
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
    sys.modules["comparisons.running.files"].remove_temporary_folders()
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
