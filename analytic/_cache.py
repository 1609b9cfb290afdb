"""The folder of numba's cache for the compiled kernel: one per state of the compiled source.

Numba checks only the file of the function itself, so that after a change in taylor.py a stale kernel would be used.
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
        if b"compiled" in text or b"numba" in text:  # at least all files with compiled functions
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
