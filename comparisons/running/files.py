"""Result files and folders: refused before the work if they cannot be written; kept elsewhere if that fails later."""

import contextlib
import os
import shutil
import stat
import sys
import tempfile
from collections.abc import Callable, Iterable
from os import PathLike
from pathlib import Path

from analytic.errors import SettingError

from .readable import Mendable

PICTURES = (".png", ".svg", ".pdf")
STANDARD_OUTPUT = "-"
_TEMPORARY: set[str] = set()  # folders of this process
PROBE_BYTES = 4096  # a place without room for this is full


class PlaceError(Mendable):
    """A result could not be written where it was asked for; the message says where it is instead."""


def check_writable(paths: Iterable[str | None], picture: str | None = None, inputs: Iterable[str] = ()) -> None:
    """Raise `SettingError` if a file cannot be written.

    Parameters
    ----------
    paths : iterable of str or None
        Files to be written; None and "-" are skipped.
    picture : str or None
        One more, whose name must end in a picture format.
    inputs : iterable of str
        Files that are read, and must not be written over.
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
    _probe(_part(above, ""), named)


def write(path: str | PathLike[str], writer: Callable[[Path], object]) -> None:
    """Write a result file by ``writer(path)``, whole or not at all.

    Raises
    ------
    PlaceError
        It could not be written; the message names the file in which the result is kept instead, if any.
    """
    place = Path(os.path.realpath(path))
    part = _part(place.parent, place.suffix)
    try:
        writer(part)
        if place.exists():
            shutil.copymode(place, part)
        os.replace(part, place)
    except OSError as error:
        raise _kept(path, error, writer, place.suffix) from error
    finally:
        with contextlib.suppress(OSError):
            part.unlink(missing_ok=True)


def write_text(path: str | PathLike[str], text: str) -> None:
    """Write `text` to the file `path` in UTF-8, or to standard output where that is "-"; see `write`."""

    def writer(place):
        Path(place).write_text(text, encoding="utf-8")

    if path != STANDARD_OUTPUT:
        return write(path, writer)
    try:
        sys.stdout.write(text)
        sys.stdout.flush()
    except BrokenPipeError:
        raise
    except OSError as error:
        raise _kept("standard output", error, writer, ".json") from error


def _mode(path, named):
    """Mode of what is at `path`, None where there is nothing."""
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
    _probe(place if mode is None else _part(place.parent, ""), path)


def _probe(place, named):
    """Raise `SettingError` where no file of a few bytes can be made at `place`."""
    try:
        with open(place, "xb") as file:
            file.write(bytes(PROBE_BYTES))
        place.unlink()
    except FileExistsError:  # somebody else's by now
        pass
    except OSError as error:
        with contextlib.suppress(OSError):
            place.unlink(missing_ok=True)
        raise SettingError(f"{named}: nothing can be written there ({error.strerror}); give another place") from None


def _part(folder, suffix):
    return folder / f".rocking-{os.getpid()}{suffix}"


def _kept(path, error, writer, suffix):
    reason = f"{path}: could not be written ({error.strerror or error})"
    for folder in (tempfile.gettempdir, os.getcwd, Path.home):
        with contextlib.suppress(OSError):
            kept = Path(folder()) / f"rocking-{os.getpid()}{suffix}"
            try:
                writer(kept)
                return PlaceError(f"{reason}; the result is in {kept}")
            except OSError:
                kept.unlink(missing_ok=True)
    return PlaceError(f"{reason}, nor anywhere else; make room and run again")


class TemporaryFolder(tempfile.TemporaryDirectory):
    """A temporary folder that is removed at a hard end, too (`remove_temporary_folders`)."""

    def __init__(self, prefix: str) -> None:
        super().__init__(prefix=prefix)
        _TEMPORARY.add(self.name)

    def cleanup(self) -> None:
        super().cleanup()
        _TEMPORARY.discard(self.name)


def remove_temporary_folders() -> None:
    """Before a process ends without clearing up behind itself."""
    for folder in tuple(_TEMPORARY):
        shutil.rmtree(folder, ignore_errors=True)
