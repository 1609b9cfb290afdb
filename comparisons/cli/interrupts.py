"""Ctrl-C and SIGTERM: a command ends within a second, in whatever compiled code it is."""

import contextlib
import os
import shutil
import signal
import sys
import threading
from collections.abc import Iterator

GRACE_SECONDS = 0.5  # to close workers and files in good order; then the process is ended
SHOW_CURSOR = b"\x1b[?25h"  # a progress bar that was cut off has hidden it


class Stopped(BaseException):
    """The command was told to end. No KeyboardInterrupt: libraries turn that into something of their own."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.status = 128 + number
        self.words = "Interrupted." if number == signal.SIGINT else f"Ended by {signal.Signals(number).name}."


@contextlib.contextmanager
def stoppable() -> Iterator[None]:
    """SIGINT and SIGTERM raise `Stopped` inside, and then end the process with status 130 or 143.

    Where compiled code does not let the exception through, the process is ended in the midst. Does nothing outside the
    main thread, where signals cannot be handled.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    state = _State()
    read, write = os.pipe()
    os.set_blocking(write, False)
    wakeup = signal.set_wakeup_fd(write, warn_on_full_buffer=False)  # written to in C, at once
    watch = threading.Thread(target=_watch, args=(read, state), daemon=True)
    watch.start()
    handlers = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        for number in handlers:
            signal.signal(number, state.handle)
        yield
    except Stopped as stop:  # all is closed by now
        _end(state, stop)
    finally:
        for number, handler in handlers.items():
            signal.signal(number, handler)
        signal.set_wakeup_fd(wakeup)
        os.close(write)
        watch.join()
        os.close(read)


class _State:
    def __init__(self) -> None:
        self.stopped = self.told = False

    def handle(self, number, _frame):
        if not self.stopped:  # a second Ctrl-C must not break off the closing
            self.stopped = True
            raise Stopped(number)

    def tell(self, stop):
        if not self.told:
            self.told = True
            with contextlib.suppress(OSError, ValueError):
                os.write(2, (SHOW_CURSOR if os.isatty(2) else b"") + stop.words.encode() + b"\n")


def _watch(read, state):
    told = os.read(read, 1)
    if not told:
        return
    threading.Event().wait(GRACE_SECONDS)
    _end(state, Stopped(told[0]))


def _end(state, stop):
    state.tell(stop)
    with contextlib.suppress(Exception):
        _end_children()
    with contextlib.suppress(Exception):
        _remove_folders()
    os._exit(stop.status)


def _end_children():
    psutil = sys.modules.get("psutil")  # where processes are started it has been imported; guarded runs end anyway
    if psutil is None:
        return
    for child in psutil.Process().children(recursive=True):
        with contextlib.suppress(psutil.Error):
            child.kill()


def _remove_folders():
    """This project's temporary folders, and the one of multiprocessing's sockets: removed at an exit in good order."""
    files, util = (sys.modules.get(name) for name in ("comparisons.running.files", "multiprocessing.util"))
    if files is not None:
        files.remove_temporary_folders()
    if util is not None:
        shutil.rmtree(util.get_temp_dir(), ignore_errors=True)


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
