"""Result files: rows and arrays with the machine, versions, commit, source code and seed behind them."""

import contextlib
import hashlib
import io
import json
import platform
import re
import site
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, is_dataclass
from datetime import UTC, datetime
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
import psutil
from pydantic import ValidationError

from analytic.errors import read_plain
from engines import ENGINES

from ..schemas.runs import StudyResult
from .code_digests import kept_digests, version_of
from .writing import Mendable, PlaceError, readable, waiting, write, write_pair

SHORT = 80  # characters of a value in a message
SCHEMA = StudyResult.model_fields["schema_"].default
NO_DIGEST = "0" * 64  # a placeholder until the content is complete
LARGEST = 2_000_000_000  # bytes of a result file, or of the arrays beside it
PROJECT_FOLDER = Path(__file__).parents[2]
RUNS = "runs.json"  # the array of a result that holds its sample of runs, as text
RESULTS = PROJECT_FOLDER / "comparisons" / "results"  # the shipped results
PACKAGES = ("numpy", "scipy", "numba", *(engine.package for engine in ENGINES.values()))


class ResultError(Mendable):
    """A result file that cannot be written or read; the message names it and the remedy."""


@dataclass(frozen=True)
class Result:
    """The result of a study: kind, settings, rows (list of dict), arrays (dict of ndarray) and provenance.

    runs: a sample of its runs, see `runner.sample_of`. run_count: the number of all runs; None in results written
    before runs were stored.
    """

    kind: str
    settings: dict
    rows: list
    provenance: dict
    arrays: dict = field(default_factory=dict)
    runs: list = field(default_factory=list)
    run_count: int | None = None


def provenance(modules: Iterable[str] = ("analytic",), seed: object = None) -> dict[str, Any]:
    """Return where numbers computed here and now come from, as a JSON-ready dict without paths or names.

    Parameters
    ----------
    modules : iterable of str
        The modules and definitions whose code the numbers depend on: roots of `code_digests.source_digests`.
    seed : int, list or None
        Seed of the random numbers used; None if none are.
    """
    return {
        "time": datetime.now(UTC).isoformat(timespec="seconds"),
        "machine": machine(),
        "python": platform.python_version(),
        "packages": {name: version_of(name) for name in PACKAGES},
        **checkout(),
        "sources": kept_digests(modules),
        "seed": seed,
    }


def machine() -> dict[str, Any]:
    """Return the processor model, cores (physical and logical), memory [GiB] and operating system."""
    model = platform.processor()
    if Path("/proc/cpuinfo").exists():
        named = re.search(r"^model name\s*:\s*(.+)$", Path("/proc/cpuinfo").read_text(), re.MULTILINE)
        model = named.group(1) if named else model
    return {
        "processor": model or platform.machine(),
        "cores": psutil.cpu_count(logical=False),
        "logical_cores": psutil.cpu_count(),
        "memory_gib": round(psutil.virtual_memory().total / 2**30, 1),
        "system": f"{platform.system()} {platform.machine()}",
    }


def write_result(path: str | PathLike[str], *content: Any, modules: Iterable[str], **more: Any) -> Path:
    """Make a `Result` by `made_here` and `save` it at `path`."""
    return save(path, made_here(*content, modules=modules, **more))


def made_here(
    kind: str,
    settings: Mapping[str, Any],
    rows: Sequence[Any],
    arrays: Mapping[str, np.ndarray] | None = None,
    *,
    modules: Iterable[str],
    seed: object = None,
    runs: Sequence[Any] = (),
    run_count: int = 0,
) -> Result:
    """Return the `Result` of numbers computed here and now, JSON-ready. modules, seed: see `provenance`."""
    origin = json_ready(provenance(modules, seed))
    plain = [json_ready(content) for content in (settings, rows, runs)]
    return Result(kind, plain[0], plain[1], origin, dict(arrays or {}), plain[2], run_count)


def save(path: str | PathLike[str], result: Result) -> Path:
    """Write a result as JSON at `path`, which ends in ``.json``, and its arrays, if any, beside it as ``.npz``.

    Raises
    ------
    ResultError
        The content names a path of this machine, or its rows are no dicts.
    PlaceError
        The file cannot be written; an older result stays as it was.
    """
    path, runs = Path(path), result.runs
    content: dict[str, Any] = {
        "schema": SCHEMA,
        "digest": NO_DIGEST,
        "kind": result.kind,
        "provenance": result.provenance,
        "settings": result.settings,
        "arrays": None,
        "runs": {"stored": len(runs), "total": result.run_count},
        "rows": result.rows,
    }
    _check_form(path.name, content)
    text, sample = json.dumps(content, allow_nan=False), json.dumps(runs, allow_nan=False)
    if any(root in each for root, _ in _roots() for each in (text, sample)):
        raise ResultError(
            f"{path.name}: the content names a folder of this machine; pass file names without "
            "folders, or messages through scrub()"
        )
    path.parent.mkdir(parents=True, exist_ok=True)
    arrays = result.arrays | ({RUNS: np.frombuffer(sample.encode(), np.uint8)} if runs else {})
    if not arrays:
        write(path, _layout(content))
        return path
    beside, data = path.with_suffix(".npz"), io.BytesIO()
    np.savez_compressed(data, **arrays)  # no array is called allow_pickle
    content["arrays"] = {"file": beside.name, "digest": hashlib.sha256(data.getbuffer()).hexdigest()}
    write_pair(path, _layout(content), beside, data.getvalue())
    return path


def copy_result(path: Path, folder: Path) -> list[Path]:
    """Copy a result file and its arrays into `folder`, and return the paths of the copies."""
    content, into = _content(path), folder / path.name
    text = path.read_text(encoding="utf-8")
    if content["arrays"] is None:
        write(into, text)
        return [into]
    beside = into.with_suffix(".npz")
    write_pair(into, text, beside, _beside(path, content))
    return [into, beside]


def read_result(path: str | PathLike[str]) -> Result:
    """Read the `Result` in the file at `path`.

    Raises
    ------
    ResultError
        The file is missing, has another layout (`comparisons.schemas.runs`), or is not as it was written; or its arrays
        are missing or are not those it was written with.
    """
    path = Path(path)
    content = _content(path)
    arrays = _arrays(path, content)
    runs = json.loads(arrays.pop(RUNS, np.frombuffer(b"[]", np.uint8)).tobytes())
    count = content["runs"]["total"] if content.get("runs") else None
    return Result(content["kind"], content["settings"], content["rows"], content["provenance"], arrays, runs, count)


def _content(path):
    """The content of a result file, checked against its digest."""
    try:
        content = json.loads(read_plain(path, LARGEST))
        _check_form(path.name, content)
        intact = content["digest"] == digest_of(content)
    except FileNotFoundError as error:
        raise ResultError(f"{path.name}: no such result file; run the study that writes it") from error
    except OSError as error:
        raise ResultError(f"{path.name}: cannot be read ({error.strerror}); give a result file of a study") from error
    except (ValueError, RecursionError) as error:
        raise ResultError(f"{path.name}: not JSON ({error}); run the study again") from error
    if not intact:
        raise ResultError(
            f"{path.name}: damaged, what it holds is not what its digest was made of; take the file from where it is "
            "whole, or run the study again"
        )
    return content


def digest_of(content: Mapping[str, Any]) -> str:
    """Return the SHA-256 of the content of a result file without its digest, as JSON with sorted keys and no spaces."""
    rest = {name: value for name, value in content.items() if name != "digest"}
    return hashlib.sha256(json.dumps(rest, sort_keys=True, separators=(",", ":")).encode()).hexdigest()


def _check_form(name, content):
    """Raise `ResultError` if the content of a file is no result, or has another layout."""
    content = content if isinstance(content, dict) else {}
    if content.get("schema") != SCHEMA:
        origin = content.get("provenance")
        commit = origin.get("commit") if isinstance(origin, dict) else None
        reader = f", the version {at_commit(commit)} reads it" if commit and isinstance(commit, str) else ""
        schema = readable(repr(content.get("schema")), SHORT)
        raise ResultError(f"{name}: schema {schema}, this version reads {SCHEMA!r}{reader}; run the study again")
    try:
        StudyResult.model_validate(content)
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(map(str, first["loc"]))
        raise ResultError(f"{name}: no result file of a study, {where}: {first['msg']}; run the study again") from None


def record_check(path: Path, check: Mapping[str, Any] | None) -> None:
    """Write the outcome of a check, or None, into the provenance of the result at `path`.

    Raises
    ------
    ResultError
        The file is damaged or cannot be written; it stays as it was.
    """
    content = _content(path)
    if content["provenance"].get("check") == check:
        return
    content["provenance"]["check"] = check
    try:
        write(path, _layout(content))
    except PlaceError as error:
        held = f"{check['held']} of {check['runs']} runs hold, but that" if check else "that no run was done again"
        raise ResultError(f"{held} is not recorded: {error}") from error


def _arrays(path, content):
    """{name: array} of the file beside a result file; {} if it has none."""
    if content["arrays"] is None:
        return {}
    with np.load(io.BytesIO(_beside(path, content))) as arrays:
        return {name: arrays[name] for name in arrays.files}


def _beside(path, content):
    """The bytes of the file of arrays that a result file names by its digest."""
    beside, digest = path.with_suffix(".npz"), content["arrays"]["digest"]
    for place in (beside, waiting(beside, digest)):  # a kill may have left it waiting
        with contextlib.suppress(OSError):
            stored = read_plain(place, LARGEST)
            if hashlib.sha256(stored).hexdigest() == digest:
                return stored
    raise ResultError(f"{beside.name}: missing or not the one {path.name} was written with; run the study again")


def at_commit(commit: str | None) -> str:
    """Return in words at which commit the code was."""
    return f"at commit {commit[:7]}" if commit else "outside a checkout"


def scrub(text: str) -> str:
    """Return `text` without this machine's paths and addresses. Paths of the project stay readable."""
    for root, name in _roots():
        text = text.replace(root, name)
    text = re.sub(r'(File ")/[^"]*/', r"\1", text)  # paths in tracebacks that are none of these
    return re.sub(r"0x[0-9a-fA-F]{6,}", "0x...", text)


def json_ready(value: Any) -> Any:
    """Return `value` in plain JSON types: arrays become lists, numbers that are not finite become None."""
    if is_dataclass(value) and not isinstance(value, type):
        value = asdict(value)
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if isinstance(value, dict):
        return {str(key): json_ready(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [json_ready(item) for item in value]
    if isinstance(value, float) and not np.isfinite(value):
        return None
    return value


def _roots():
    """(folder of this machine, its replacement in texts) for the folders not to be named, inner ones first."""
    roots = [(str(PROJECT_FOLDER), ".")] + [(path, "site-packages") for path in site.getsitepackages()]
    roots += [
        (sys.prefix, "<environment>"),
        (sys.base_prefix, "<python>"),
        (tempfile.gettempdir(), "<temporary>"),
        (str(Path.home()), "~"),
    ]
    # "/usr" and "/" are everyone's and may be part of a word
    return [(root, name) for root, name in roots if root not in ("/", "/usr", "/usr/local")]


def _layout(content):
    """The content as JSON with its digest, one line for each row: small, and readable in a diff."""
    head = {**content, "digest": digest_of(content)}
    lines = ",\n  ".join(json.dumps(row, allow_nan=False) for row in head.pop("rows"))
    text = json.dumps(head, indent=1, allow_nan=False)[:-2]
    return f'{text},\n "rows": [\n  {lines}\n ]\n}}\n' if lines else f'{text},\n "rows": []\n}}\n'


def checkout() -> dict[str, Any]:
    """Return the commit of the checkout and whether tracked files differ from it ("dirty"); None outside one."""

    def git(*words):
        return subprocess.run(
            ["git", "-C", str(PROJECT_FOLDER), *words], capture_output=True, text=True, check=True, timeout=20
        ).stdout.strip()

    try:
        if Path(git("rev-parse", "--show-toplevel")).resolve() != PROJECT_FOLDER.resolve():
            return {"commit": None, "dirty": None}  # installed inside some other checkout
        return {"commit": git("rev-parse", "HEAD"), "dirty": bool(git("status", "--porcelain", "-uno"))}
    except (OSError, subprocess.SubprocessError):
        return {"commit": None, "dirty": None}


def commit_seed() -> int:
    """Return a seed that follows from the commit; 0 outside a checkout."""
    return int((checkout()["commit"] or "0")[:8], 16)
