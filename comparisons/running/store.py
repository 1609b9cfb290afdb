"""Store of results: one line of JSON is appended per run, so that the runs of a killed sweep are kept."""

import contextlib
import io
import json
import os
import time
from collections.abc import Sequence
from os import PathLike
from pathlib import Path

from .readable import Mendable

try:
    import fcntl
except ImportError:  # Windows has none: no lock there
    fcntl = None  # type: ignore[assignment]  # Windows has none

SYNC_SECONDS = 1.0  # a killed process loses nothing written, a power cut at most this much


class StoreError(Mendable):
    """A file of results that cannot be used; the message names file, line and remedy."""


class Store(contextlib.AbstractContextManager["Store"]):
    """Append-only file of rows keyed by their case: a context manager around one JSONL file.

    A row is a dict with at least "key". A torn last line (the process was killed while it wrote) is
    dropped when the file is opened.

    Raises
    ------
    StoreError
        Another sweep has the file open, it cannot be read and written, or a whole line in it is no row.
    """

    def __init__(self, path: str | PathLike[str]) -> None:
        self.path = Path(path)
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            if self.path.exists() and not self.path.is_file():
                raise StoreError(f"{self.path}: is no file; remove it, or give another place")
            self._file = open(self.path, "ab+", buffering=0)
        except (OSError, ValueError) as error:  # ValueError: a NUL character
            raise self._unusable(error) from error
        try:
            self._lock()
            self.rows = self._read()
        except BaseException:
            self._file.close()
            raise
        self._synced = time.monotonic()

    def __exit__(self, *_: object) -> None:
        with contextlib.suppress(OSError):  # said when the rows were written
            self._sync()
        self._file.close()

    def append(self, lines: Sequence[str]) -> None:
        """Write rows given as lines of JSON (str, no line end).

        Raises
        ------
        StoreError
            The disk is full or failed; the file holds the rows before these.
        """
        data, end = memoryview("".join(line + "\n" for line in lines).encode()), self._file.seek(0, os.SEEK_END)
        try:
            while data:
                data = data[self._file.write(data) :]
            if time.monotonic() - self._synced > SYNC_SECONDS:
                self._sync()
        except OSError as error:
            with contextlib.suppress(OSError):
                self._file.truncate(end)
            raise self._unusable(error, "the rows so far are kept: make room and run again") from error
        self.rows.update((row["key"], row) for row in map(json.loads, lines))

    def _sync(self):
        os.fsync(self._file.fileno())
        self._synced = time.monotonic()

    def _unusable(self, error, remedy="give another place"):
        return StoreError(f"{self.path}: rows cannot be stored there ({getattr(error, 'strerror', error)}); {remedy}")

    def _lock(self):
        if fcntl is None:
            return
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise StoreError(
                f"{self.path}: another sweep is writing to it; wait for it or give another place"
            ) from error
        except OSError:  # a file system without locks
            pass

    def _read(self):
        self._file.seek(0)
        rows, end = {}, 0
        for number, line in enumerate(io.BufferedReader(io.FileIO(self._file.fileno(), closefd=False)), 1):
            if not line.endswith(b"\n"):
                self._file.truncate(end)
                break
            end += len(line)
            try:
                row = json.loads(line)
                rows[row["key"]] = row
            except (ValueError, KeyError, TypeError, RecursionError) as error:
                raise StoreError(
                    f"{self.path}, line {number}: not a row of results ({error}); remove the "
                    "line, or the file to start afresh"
                ) from error
        return rows
