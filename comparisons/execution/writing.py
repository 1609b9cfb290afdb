"""Writing of files: checked before the work, then complete or not at all; and text made printable.

This project writes every file through `write`, except temporary files and the store of runs, which is appended to
(tests/comparisons/execution/test_writing.py checks this). `readable` makes external text (names, paths, values,
messages) printable, on one line and of limited length.
"""

import contextlib
import errno
import hashlib
import os
import secrets
import shutil
import stat
import sys
import tempfile
import time
from collections.abc import Iterable, Mapping
from os import PathLike
from pathlib import Path

from analytic.errors import SettingError

MOST_CHARACTERS = 600


class Mendable(RuntimeError):
    """An error that the user can correct; its message is shown without a traceback."""


def readable(text: object, most: int = MOST_CHARACTERS) -> str:
    """Return `text` in at most about `most` characters, the middle left out; unprintable characters become codes."""
    text = str(text)
    if len(text) > most:  # both ends matter: the subject, and the remedy
        tail = most // 3
        text = text[: most - tail] + " [...] " + text[-tail:]
    return "".join(char if char.isprintable() else char.encode("unicode_escape").decode() for char in text)


PICTURES = (".png", ".svg", ".pdf")
STANDARD_OUTPUT = "-"
PROBE_BYTES = 4096  # a place without room for them is full
PART = ".rocking-{}.part"  # name of a file that is being written; no result has such a name
DIGITS = 16  # of a digest in the name of a waiting file
STALE = 3600.0  # s since the last byte, after which the process that wrote a part must have been killed
_TEMPORARY: set[str] = set()  # folders of this process


class PlaceError(Mendable):
    """A file could not be written; the message names it and the place, if any, where its content is kept."""


def check_writable(paths: Iterable[str | None], picture: str | None = None, inputs: Iterable[str] = ()) -> None:
    """Raise `SettingError` if a file cannot be written.

    Parameters
    ----------
    paths : iterable of str or None
        Files to be written; None and "-" are skipped.
    picture : str or None
        A further file, whose name must end in a picture format.
    inputs : iterable of str
        Files that are read and must not be overwritten.
    """
    if picture and Path(picture).suffix.lower() not in PICTURES:
        raise SettingError(f"{picture}: not a known picture format; end the name in {', '.join(PICTURES)}")
    paths = list(paths)
    if paths.count(STANDARD_OUTPUT) > 1:
        raise SettingError("-: standard output takes one result; give the other a file")
    taken = {os.path.realpath(path): "is read by this command" for path in inputs if "\0" not in path}
    for path in (path for path in [*paths, picture] if path is not None and path != STANDARD_OUTPUT):
        _check_file(path)
        place = os.path.realpath(path)
        if place in taken:
            raise SettingError(f"{path}: {taken[place]}; give another file")
        taken[place] = "is given for two results"


def check_folder(output: str | PathLike[str], option: str = "--output") -> None:
    """Raise `SettingError` if `output`, the folder to write to, is a file or cannot be written; it need not exist."""
    named, above = f"{option} {output}", Path(output)
    mode = _mode(output, named)
    if mode is not None and not stat.S_ISDIR(mode):
        what = "is a file" if stat.S_ISREG(mode) else "is a device or a pipe"
        raise SettingError(f"{named}: {what}; give a folder")
    while not above.exists():
        above = above.parent
    if not above.is_dir():
        raise SettingError(f"{named}: {above} is no folder; give another place")
    _probe(_part(above), named)


def write(path: str | PathLike[str], content: str | bytes | memoryview, keep: bool = False) -> None:
    """Write a file completely or not at all. Until it is complete the old file stays in place.

    keep: if the file cannot be written, keep the content in another place.

    Raises
    ------
    PlaceError
        The file could not be written; the message names it and the place where the content is kept.
    """
    data = content.encode() if isinstance(content, str) else content
    try:
        _put(Path(os.path.realpath(path)), data)
    except OSError as error:
        raise _not_written(path, error, data if keep else None) from error


def write_text(path: str | PathLike[str], text: str) -> None:
    """Write a command's result as UTF-8 to the file `path`, or to standard output if that is "-".

    If that fails, the result is kept elsewhere, see `write`.
    """
    if path != STANDARD_OUTPUT:
        return write(path, text, keep=True)
    try:
        sys.stdout.write(text)
        sys.stdout.flush()
    except BrokenPipeError:
        raise
    except OSError as error:
        raise _not_written("standard output", error, text.encode()) from error


def write_all(folder: str | PathLike[str], files: Mapping[str, str | bytes]) -> list[Path]:
    """Write files {name below the folder: content} by `write`, make their folders, and return their paths."""
    paths = [Path(folder) / name for name in files]
    for path, content in zip(paths, files.values(), strict=True):
        path.parent.mkdir(parents=True, exist_ok=True)
        write(path, content)
    return paths


def write_pair(path: Path, content: str, beside: Path, data: bytes) -> None:
    """Write a file and the file `beside`, whose digest it holds, so that a matching pair exists at any moment.

    `beside` waits under another name (`waiting`) until `path` is written: a kill leaves the old or the new pair.

    Raises
    ------
    PlaceError
        As `write`.
    """
    wait = waiting(beside, hashlib.sha256(data).hexdigest())
    new = not wait.exists()  # else a kill has left it, and `path` may need it
    try:
        _put(wait, data)
        try:
            write(path, content)
        except PlaceError:
            if new:
                wait.unlink()
            raise
        os.replace(wait, beside)
        for left in beside.parent.glob(waiting(beside, "?" * DIGITS).name):
            left.unlink()
    except OSError as error:
        raise _not_written(beside, error) from error


def _put(place, data):
    """Write bytes to a part and move it to its place. Remove stale parts of killed processes."""
    part = _part(place.parent)
    try:
        with open(part, "xb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())  # some disks report only now that they are full
        if place.exists():
            if not os.access(place, os.W_OK):
                raise PermissionError(errno.EACCES, "is read-only", str(place))
            shutil.copymode(place, part)
        os.replace(part, place)
    finally:
        with contextlib.suppress(OSError):
            part.unlink(missing_ok=True)
    _remove_stale(place.parent)


def waiting(beside: Path, digest: str) -> Path:
    """Return the path at which a file waits until the file that holds its digest is written."""
    return beside.with_name(f".{beside.stem}.{digest[:DIGITS]}{beside.suffix}")


def _mode(path, named):
    """The mode of the file or folder at `path`; None if there is nothing."""
    if not os.fspath(path):
        raise SettingError(f"{named!r}: no name for a file (empty); give one")
    try:
        return os.stat(path).st_mode
    except FileNotFoundError:
        return None
    except (OSError, ValueError) as error:  # ValueError: a NUL character
        raise SettingError(f"{named}: no name for a file ({getattr(error, 'strerror', error)}); give another") from None


def _check_file(path):
    mode, place = _mode(path, path), Path(os.path.realpath(path))
    if mode is not None and stat.S_ISDIR(mode):
        raise SettingError(f"{path}: is a folder; give a file name")
    if mode is not None and not stat.S_ISREG(mode):
        raise SettingError(f"{path}: is a device or a pipe; give a file name")
    if not place.parent.is_dir():
        raise SettingError(f"{path}: there is no folder {Path(path).parent}; make it first")
    if mode is not None and not os.access(place, os.W_OK):
        raise SettingError(f"{path}: is read-only; give another file name")
    _probe(place if mode is None else _part(place.parent), path)


def _probe(place, named):
    """Raise `SettingError` if no file of a few bytes can be made at `place`."""
    try:
        with open(place, "xb") as file:
            file.write(bytes(PROBE_BYTES))
        place.unlink()
    except FileExistsError:  # created by another process meanwhile
        pass
    except OSError as error:
        with contextlib.suppress(OSError):
            place.unlink(missing_ok=True)
        raise SettingError(f"{named}: nothing can be written there ({error.strerror}); give another place") from None


def _part(folder):
    return folder / PART.format(secrets.token_hex(8))


def _remove_stale(folder):
    """Remove the parts that killed processes have left in a folder."""
    for part in folder.glob(PART.format("*")):
        with contextlib.suppress(OSError):
            if time.time() - part.stat().st_mtime > STALE:
                part.unlink()


def _not_written(path, error, kept=None):
    """Return the `PlaceError` of a file that was not written. kept: its content, which is written elsewhere."""
    reason = f"{path}: could not be written ({error.strerror or error})"
    if kept is None:
        return PlaceError(f"{reason}; make room and run again")
    for folder in (tempfile.gettempdir, os.getcwd, Path.home):
        with contextlib.suppress(OSError):
            number, place = tempfile.mkstemp(Path(path).suffix or ".json", "rocking-", folder())
            try:
                with open(number, "wb") as file:
                    file.write(kept)
                return PlaceError(f"{reason}; the result is in {place}")
            except OSError:
                os.unlink(place)
    return PlaceError(f"{reason}, nor anywhere else; make room and run again")


class TemporaryFolder(tempfile.TemporaryDirectory):
    """A temporary folder that `remove_temporary_folders` also removes when the process is ended."""

    def __init__(self, prefix: str) -> None:
        super().__init__(prefix=prefix)
        _TEMPORARY.add(self.name)

    def cleanup(self) -> None:
        super().cleanup()
        _TEMPORARY.discard(self.name)


def remove_temporary_folders() -> None:
    """Remove the temporary folders of this process, before it is ended without a normal exit."""
    for folder in tuple(_TEMPORARY):
        shutil.rmtree(folder, ignore_errors=True)
