"""The command ``rocking``: runs a command and ends with a status and at most one message.

Status 0: done; 1: a solver failed, or the output is closed; 2: a mistake that the user can correct; 130: Ctrl-C.
Heavy modules are imported inside `main`, where Ctrl-C is handled.
"""

import contextlib
import os
import sys
from collections.abc import Sequence

from ..running.readable import Mendable, readable
from .interrupts import open_streams, stoppable


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line and exit with its status."""
    open_streams()  # first, so that no other file takes the number of a closed stream
    with stoppable():
        status = _status(arguments)
    sys.exit(status)


def _status(arguments):
    try:
        from .application import app

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
