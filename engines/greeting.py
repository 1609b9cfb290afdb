"""What a package prints as it is imported, held back; whatever else is printed meanwhile is not."""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Iterator


@contextlib.contextmanager
def without(greeting: bytes) -> Iterator[None]:
    """Lines on standard error that begin so are left out, also where compiled code prints them.

    For a few milliseconds: what this process prints to standard error meanwhile, in any thread, comes after them.
    """
    with contextlib.ExitStack() as closing:
        try:
            kept = os.dup(2)
            closing.callback(os.close, kept)
            held = closing.enter_context(tempfile.TemporaryFile())
        except OSError:  # there is no standard error, or no room: then it is said
            yield
            return
        os.dup2(held.fileno(), 2)
        try:
            yield
        finally:
            os.dup2(kept, 2)
            held.seek(0)
            with contextlib.suppress(OSError):  # nobody reads it
                os.write(2, b"".join(line for line in held if not line.startswith(greeting)))
