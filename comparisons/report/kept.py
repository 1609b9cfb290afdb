"""What was drawn from stored results, kept in the user's cache folder: a second report does not draw it again.

An entry is found by a digest of all that it is made from: the files of the result; the code of this project and of
packages that declare engines, with templates, styles and scripts; engines, studies and versions. A change of any of
them makes it anew, and so does a damaged entry. Where nothing can be written, nothing is kept.
"""

import contextlib
import hashlib
import importlib.util
import os
import pickle
import platform
from collections.abc import Callable, Iterable, Iterator
from importlib.metadata import entry_points
from pathlib import Path
from typing import TypeVar

from analytic.kernel.cache import USER
from engines import BROKEN, ENGINES
from engines.contract import GROUP

from ..execution.code_digests import PROJECT, package_of, version_of
from ..execution.results import PACKAGES, RESULTS
from ..execution.writing import PlaceError, write
from ..studies import study_names

FOLDER = USER / "pages"
MOST = 100  # entries; beyond them those not used for longest are removed. A report of all studies uses thirty.
TEMPLATES = ("jinja2", "markupsafe")  # packages that draw, beside those behind the numbers
SIZE = hashlib.sha256().digest_size

Kept = TypeVar("Kept")


def kept(key: str, make: Callable[[], Kept], worth: Callable[[Kept], object] = lambda value: True) -> Kept:
    """Return what is kept under a key (`digest_of`); else make it, and keep it if it is worth it. "": nothing is kept.

    An entry is the digest of its content, and the content, as pickle writes it: in the user's own folder only.
    """
    file = FOLDER / f"{key}.pickle"
    with contextlib.suppress(OSError):
        stored = file.read_bytes() if key else b""
        if len(stored) > SIZE and hashlib.sha256(stored[SIZE:]).digest() == stored[:SIZE]:
            with contextlib.suppress(OSError):
                os.utime(file)
            return pickle.loads(stored[SIZE:])
    value = make()
    if key and worth(value):
        content = pickle.dumps(value)
        with contextlib.suppress(OSError, PlaceError):
            FOLDER.mkdir(parents=True, exist_ok=True)
            write(file, hashlib.sha256(content).digest() + content)
            for old in sorted(FOLDER.glob("*.pickle"), key=os.path.getmtime)[:-MOST]:
                old.unlink(missing_ok=True)
    return value


def digest_of(*parts: object) -> str:
    """Return the digest of values, of files by their content. parts: plain values; paths of files or folders."""
    digest = hashlib.sha256()
    for part in parts:
        files = _files(part) if isinstance(part, Path) else ()
        digest.update(repr(part.name if isinstance(part, Path) else part).encode())
        for file in files:
            digest.update(f"{file.name} {hashlib.sha256(file.read_bytes()).hexdigest()}".encode())
    return digest.hexdigest()


def _files(place: Path) -> Iterable[Path]:
    """Return a file, or the files of a folder; of a package without the stored results, and without compiled code."""
    if place.is_file():
        return [place]
    files = (file for file in place.rglob("*") if file.is_file() and "__pycache__" not in file.parts)
    return sorted(file for file in files if place not in RESULTS.parents or RESULTS not in file.parents)


def digest_of_code() -> str:
    """Return the digest of all that draws: the code, templates, styles and scripts, engines, studies and versions."""
    declared = (package_of(entry.value) for entry in entry_points(group=GROUP))
    versions = [platform.python_version(), *((name, version_of(name)) for name in (*PACKAGES, *TEMPLATES))]
    return digest_of(
        *_places(dict.fromkeys((*PROJECT, *declared))), list(ENGINES), list(BROKEN), study_names(), versions
    )


def _places(packages: Iterable[str]) -> Iterator[Path]:
    for package in packages:
        if spec := importlib.util.find_spec(package):
            yield from map(Path, spec.submodule_search_locations or filter(None, [spec.origin]))
