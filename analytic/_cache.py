"""Where numba keeps the compiled kernel: one folder per state of the compiled source.

Numba's own cache looks at the file of a function alone, so a change in taylor.py would leave a stale kernel in use.
"""

import hashlib
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numba


def _folder() -> str:
    source = Path(__file__).parent
    digest = hashlib.sha256()
    for file in sorted(source.rglob("*.py")):
        text = file.read_bytes()
        if b"compiled" in text or b"numba" in text:  # more than what is compiled, never less
            digest.update(str(file.relative_to(source)).encode() + text)
    name = f"numba-{digest.hexdigest()[:16]}"
    for parent in (source / "__pycache__", Path.home() / ".cache" / "rocking", Path(tempfile.gettempdir())):
        try:
            (parent / name).mkdir(parents=True, exist_ok=True)
            if os.access(parent / name, os.W_OK):
                return str(parent / name)
        except OSError:
            continue
    return ""


@contextmanager
def kernel_cache() -> Iterator[None]:
    """Functions decorated inside are cached in a folder of this source; NUMBA_CACHE_DIR, if set, wins."""
    before = numba.config.CACHE_DIR  # type: ignore[attr-defined]  # made when numba is imported
    if not before:
        numba.config.CACHE_DIR = _folder()  # type: ignore[attr-defined]  # as above
    try:
        yield
    finally:
        numba.config.CACHE_DIR = before  # type: ignore[attr-defined]  # as above
