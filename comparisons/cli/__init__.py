"""The command ``rocking``: runs a command and turns its end into a status and at most one message.

Status 0: done; 1: a solver failed, or nobody reads the output; 2: a mistake the user can mend; 130: Ctrl-C.
Heavy modules are imported inside `main`, where Ctrl-C is taken care of.
"""

import contextlib
import os
import sys
from collections.abc import Sequence

from ..running.readable import Mendable, readable
from .interrupts import open_streams, stoppable


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line and exit with its status."""
    open_streams()  # first: else another file takes the number of one that is closed
    with stoppable():
        status = _status(arguments)
    sys.exit(status)


def _status(arguments):
    try:
        from .application import app

        status = app(arguments, standalone_mode=False)
        sys.stdout.flush()
        return status if isinstance(status, int) else 0
    except BrokenPipeError:  # the reader has seen enough
        _silence()
        return 1
    except OSError as error:
        with contextlib.suppress(OSError):
            sys.stdout.flush()
        message = f"{error.filename}: {error.strerror}" if error.filename else error.strerror or error
        return _mistake(f"{message}; give another place, or make room there")
    except MemoryError as error:
        return _mistake(f"not enough memory ({error}); ask for less")
    except Exception as error:
        if type(error).__name__ == "Abort":  # click's as well, of a question
            return _mistake("the input ended where an answer was wanted; give options instead")
        if hasattr(error, "format_message"):  # click's, wherever Typer keeps it: a usage error or a help page
            return _usage(error)
        from analytic.errors import EngineNotInstalled, SceneError, SettingError

        if isinstance(error, SceneError | SettingError | EngineNotInstalled | Mendable):
            return _mistake(*getattr(error, "lines", [error]))  # a scene's mistakes, one a line
        raise


def _mistake(*lines):
    with contextlib.suppress(OSError):
        print("Error: " + "\n".join(map(readable, lines)), file=sys.stderr, flush=True)
    _silence()
    return 2


def _usage(error):
    if error.message and "\n" not in error.message:  # a help page stays whole
        error.message = readable(error.message)
    with contextlib.suppress(OSError):
        error.show()
    return error.exit_code


def _silence():
    """Send what broken streams have left nowhere: the interpreter would fail to write it at its end."""
    null = os.open(os.devnull, os.O_WRONLY)
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except OSError:
            os.dup2(null, stream.fileno())
    os.close(null)
