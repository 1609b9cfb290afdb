"""Suppression of what a package prints when it is imported; other output passes."""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Iterator


@contextlib.contextmanager
def without(greeting: bytes) -> Iterator[None]:
    """Remove lines on standard error that begin with `greeting`, also those that compiled code prints.

    For a few milliseconds only: other output of this process to standard error, from any thread, is delayed until then.
    """
    with contextlib.ExitStack() as closing:
        try:
            kept = os.dup(2)
            closing.callback(os.close, kept)
            held = closing.enter_context(tempfile.TemporaryFile())
        except OSError:  # no standard error, or no disk space: the greeting is printed
            yield
            return
        os.dup2(held.fileno(), 2)
        try:
            yield
        finally:
            os.dup2(kept, 2)
            held.seek(0)
            with contextlib.suppress(OSError):  # standard error is closed
                os.write(2, b"".join(line for line in held if not line.startswith(greeting)))
