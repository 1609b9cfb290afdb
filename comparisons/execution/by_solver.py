"""Results stored as one file for each solver, and their age.

The model's file also holds everything that belongs to no solver. Each file has the rows, the entries of the settings,
the arrays and the runs of its solver, and states where they come from.

An engine can be computed alone: only its file is written anew. The results of the model must then be as they are
stored, except for CPU times. Otherwise the engine would stand beside engines that were compared with another reference.

`age` tells in words whether the code has changed since a result was computed, engine by engine where they differ.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import zip_longest
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, get_args, get_origin

import numpy as np

from analytic.errors import SettingError
from engines import ENGINES

from .cases import root_of
from .code_digests import changes, kept_digests, version_of
from .results import Result, ResultError, at_commit, read_result, save
from .writing import readable

if TYPE_CHECKING:
    from .plan import Study

RELATIVE, ABSOLUTE = 1e-9, 1e-12  # numbers this close are equal: processors round differently
NOT_COMPARED = ("traced_bytes", "resident_bytes", "versions")  # they differ from run to run or between machines
CPU = "cpu_"  # fields whose names begin so are not compared either
MODEL = "analytic"  # name of the model's file
EDITED = "changed_while_running"  # the setting that lists definitions edited during the run
SCRIPT = "script"  # value of the variant in rows of a script
SHOWN = 3  # changes that an error names


def split(result: Result, engines: Iterable[str]) -> dict[str, Result]:
    """Return {solver: its part of a result}, the model first."""
    names = (MODEL, *engines)
    return {name: _part(result, name, names) for name in names}


def _part(result, name, names):
    def mine(engine):
        return engine == name or name == MODEL and engine not in names

    settings = result.settings.items()
    return replace(
        result,
        settings={key: value if _shared(value, names) else _share(value, mine) for key, value in settings},
        rows=[row for row in result.rows if mine(engine_of(row))],
        arrays={key: array for key, array in result.arrays.items() if mine(_engine_in(key, names))},
        runs=[run for run in result.runs if mine(run["engine"])],
    )


def _shared(value, names):
    """Whether a setting holds for all solvers, because it is no list or table by engine."""
    if isinstance(value, dict):
        return not (value and value.keys() <= {*names})
    listed = isinstance(value, list) and bool(value)
    return not (
        listed and all(_entry(entry) in names or isinstance(entry, dict) and "engine" in entry for entry in value)
    )


def _entry(value):
    return value.get("engine") if isinstance(value, dict) else value if isinstance(value, str) else None


def _share(value, mine):
    if isinstance(value, dict):
        return {name: share for name, share in value.items() if mine(name)}
    return [entry for entry in value if mine(_entry(entry))]


def engine_of(row: Mapping[str, Any]) -> str | None:
    """Return the solver that a row names, or None."""
    return row.get("engine", row.get("solver")) or None


def _engine_in(array, names):
    """The engine that an array belongs to, by its name: "phase/exudyn/...", "isolated/exudyn, native-contact/tilt"."""
    parts = (part.split(", ")[0] for part in array.split("/"))
    return next((part for part in parts if part in names), None)


def joined(parts: Mapping[str, Result]) -> Result:
    """Join the parts {solver: part} of a result. The engines follow the model in the order of `ENGINES`.

    Raises
    ------
    ResultError
        The model's part is missing, a part was computed with other settings than the model's, or an engine has rows of
        variants that its settings do not list.
    """
    if MODEL not in parts:
        raise ResultError(f"{MODEL}.json: missing; run the study again")
    model, known = parts[MODEL], dict(zip(ENGINES, range(len(ENGINES)), strict=True))
    engines = sorted(parts.keys() - {MODEL}, key=lambda name: (known.get(name, len(known)), name))
    ordered = [model, *(parts[name] for name in engines)]
    origin = {**model.provenance, "engines": {name: parts[name].provenance for name in engines}}
    if not engines:
        del origin["engines"]
    for name in engines:
        if wrong := _unlike(name, parts[name], model, engines):
            raise ResultError(f"{name}.json: {wrong}; run the study with --engine {name} again")
    return replace(
        model,
        settings={key: _together(key, [part.settings[key] for part in ordered]) for key in model.settings},
        rows=[row for part in ordered for row in part.rows],
        arrays={key: array for part in ordered for key, array in part.arrays.items()},
        runs=[run for part in ordered for run in part.runs],
        run_count=None if model.run_count is None else sum(part.run_count or 0 for part in ordered),
        provenance=origin,
    )


def _unlike(name, part, model, engines):
    """In words: how an engine's file contradicts the model's, or None."""
    if part.kind != model.kind:
        return f"a result of {part.kind}, beside one of {model.kind}"
    changes: list[tuple[str, Any, Any]] = []
    for key in dict.fromkeys((*model.settings, *part.settings)):
        then, now = (result.settings.get(key) for result in (model, part))
        named, named_by_model = (
            {_entry(entry) for entry in value} if _listed(value) else None for value in (now, then)
        )
        if key != EDITED and (named is None or named_by_model is None or named - {name} or named_by_model & {*engines}):
            changes += differences(key, then, now)
    changes += differences("seed", *(result.provenance["seed"] for result in (model, part)))
    if changes:
        where, then, now = changes[0]
        return f"asked otherwise than {MODEL}.json ({where}: {short(then)} there, {short(now)} here)"
    listed = {entry.get("variant") for entry in part.settings.get("variants", ())}
    unlisted = {row["variant"] for row in part.rows if row.get("variant")} - listed - {SCRIPT}
    if listed and unlisted:
        return f"has rows of a variant that its settings do not list: {', '.join(sorted(unlisted))}"
    return None


def _listed(value):
    """Whether a setting is a list or table that may be by engine."""
    return isinstance(value, list | dict)


def _together(key, values):
    first = values[0]
    if isinstance(first, dict):
        return {name: entry for value in values for name, entry in value.items()}
    if not isinstance(first, list) or all(value == first for value in values):
        return first
    every = [entry for value in values for entry in value]
    return list(dict.fromkeys(every)) if key == EDITED else every


def read(path: str | PathLike[str]) -> Result:
    """Read the `Result` in a folder of files by solver, or in a single file.

    Raises
    ------
    ResultError
        As for `read_result` and `joined`. The message begins with the name of the folder.
    """
    path = Path(path)
    files = sorted(path.glob("*.json"))
    if not path.is_dir() and path.suffix == ".json":
        return read_result(path)
    try:
        if not files:
            inner = results_in(path)
            raise ResultError(
                f"holds results, and is none; give one of its folders, such as {inner[0].name}"
                if inner
                else "no such result; run the study that writes it"
            )
        return joined({file.stem: read_result(file) for file in files})
    except ResultError as error:
        raise ResultError(f"{path.name}/{error}" if files else f"{path.name}: {error}") from None
    except (AttributeError, KeyError, TypeError) as error:  # a file was edited, and its digest renewed
        why = f"settings or rows of its files are of a wrong type ({readable(repr(error))})"
        raise ResultError(f"{path.name}: {why}; run the study again") from error


def results_in(folder: str | PathLike[str]) -> list[Path]:
    """Return the results in a folder, sorted. Each is a folder of files by solver."""
    return sorted(path for path in Path(folder).glob("*") if path.is_dir() and any(path.glob("*.json")))


def check_parent(folder: str | PathLike[str]) -> None:
    """Raise `SettingError` if `folder`, which should contain results, is itself a result."""
    place = Path(folder)
    if (place / f"{MODEL}.json").exists():
        raise SettingError(f"--output {folder}: is itself a result; give the folder that it lies in, {place.parent}")


def check_none_goes(study: Study, folder: Path, engines: Collection[str]) -> None:
    """Raise `SettingError` if a study that is computed as a whole would remove the file of an engine not named."""
    if not study.whole:
        return
    if others := sorted({file.stem for file in folder.glob(f"{study.name}*/*.json")} - {MODEL, *engines}):
        raise SettingError(
            f"--engine: {study.name} is computed as a whole, and {folder} holds {', '.join(others)}, which would go; "
            "name these, too, or give another --output"
        )


def save_parts(
    folder: Path, result: Result, plan: str, engines: Sequence[str], counts: Mapping[str, int], only: bool = False
) -> Path:
    """Write the parts of a result that was just computed into `folder`, and return `folder`.

    plan: `cases.name_of` of the study's plan. engines: the engines that were computed. counts: {solver: number of its
    runs}. only: write the files of these engines alone; otherwise files of other engines are removed.
    """
    foreign = {engine.package for engine in ENGINES.values()}
    for name, part in split(result, engines).items():
        if only and name == MODEL:
            continue
        solvers = [solver for solver in counts if solver == name or name == MODEL and solver not in engines]
        wanted = {ENGINES[solver].package for solver in solvers if solver in ENGINES}
        packages = result.provenance["packages"]
        origin = {
            **result.provenance,
            "packages": {name: version for name, version in packages.items() if name not in foreign - wanted},
            "sources": kept_digests([plan, *dict.fromkeys(map(root_of, solvers))]),
        }
        save(
            folder / f"{name}.json",
            replace(part, provenance=origin, run_count=sum(counts[solver] for solver in solvers)),
        )
    for file in () if only else folder.glob("*"):
        if file.suffix in (".json", ".npz") and file.stem not in (MODEL, *engines):
            file.unlink()
    return folder


def opened(study: Study, folder: Path, quick: bool, options: Mapping[str, Any]) -> tuple[Result, bool, dict[str, Any]]:
    """Read the model's part of the result in `folder`, to which an engine is to be added.

    Returns (the part, whether it was computed with --quick, the options of the plan). options: the options given now.

    Raises
    ------
    SettingError
        An option given contradicts the stored one.
    ResultError
        As for `read_result`; or the result is of another study.
    """
    old = read_result(folder / f"{MODEL}.json")
    if old.kind != study.name:
        raise ResultError(f"{folder} holds a result of {old.kind}; give another --output")
    known = {**old.settings, "seed": old.provenance["seed"]}
    stored = {name: known[name] for name, kind in study.options().items() if name in known and _is(known[name], kind)}
    settled = {"quick": bool(old.settings.get("quick")), **stored}
    for name, value in {**({"quick": True} if quick else {}), **options}.items():
        if value is not None and name in settled and value != settled[name]:
            given, then = ("--quick", "in full") if name == "quick" else (f"--{name} {value}", f"with {settled[name]}")
            raise SettingError(f"{given}: {folder} was computed {then}; leave it out, or give another --output")
    return old, settled.pop("quick"), {**options, **settled}


def _is(value, parameter):
    """Whether a stored value has the type of an option."""
    kind = parameter.annotation
    try:
        return isinstance(value, get_args(kind)[0] if get_origin(kind) is Annotated else kind)
    except TypeError:  # list[str]: no type to ask
        return False


def check_same(study: Study, old: Result, new: Result, engines: Sequence[str]) -> None:
    """Check that the model's part of the `new` result, computed for `engines` alone, equals its stored part `old`.

    Raises
    ------
    ResultError
        They differ; the message names the differences.
    """
    here = split(new, engines)[MODEL]
    names = dict.fromkeys((*old.arrays, *here.arrays))
    arrays = [name for name in names if not _same_array(name, old.arrays, here.arrays)]
    changes = [
        *differences("settings", {**old.settings, EDITED: []}, {**here.settings, EDITED: []}),
        *differences("rows", old.rows, here.rows),
        *((f"array {name}", *(_size(result.arrays.get(name)) for result in (old, here))) for name in arrays),
        *differences("seed", *(result.provenance["seed"] for result in (old, new))),
    ]
    if changes:
        named = "; ".join(f"{where}: stored {short(then)}, now {short(now)}" for where, then, now in changes[:SHOWN])
        more = f"; and {len(changes) - SHOWN} more" if len(changes) > SHOWN else ""
        raise ResultError(
            f"beside the rows of {', '.join(engines)} others come out changed ({named}{more}), so nothing was written: "
            f"rocking study {study.name} without --engine computes all of it"
        )


def _same_array(name, old, new):
    stored, now = old.get(name), new.get(name)
    if stored is None or now is None or stored.shape != now.shape or stored.dtype != now.dtype:
        return False
    if stored.dtype.kind != "f":
        return np.array_equal(stored, now)
    return np.allclose(stored, now, max(RELATIVE, float(np.finfo(stored.dtype).eps)), ABSOLUTE, equal_nan=True)


def _size(array):
    return None if array is None else f"{array.dtype} {array.shape}"


def differences(where: str, stored: Any, now: Any) -> Iterator[tuple[str, Any, Any]]:
    """Yield (quantity, stored value, present value) of each difference."""
    if isinstance(stored, dict) and isinstance(now, dict):
        for name in dict.fromkeys((*stored, *now)):
            if name not in NOT_COMPARED and not name.startswith(CPU):
                yield from differences(f"{where}.{name}", stored.get(name), now.get(name))
    elif isinstance(stored, list) and isinstance(now, list):
        for k, (before, after) in enumerate(zip_longest(stored, now)):
            yield from differences(f"{where}[{k}]", before, after)
    elif not _equal(stored, now):
        yield where.removeprefix("values."), stored, now


def _equal(stored, now):
    if type(stored) is float and isinstance(now, int | float) and type(now) is not bool:
        return math.isclose(stored, now, rel_tol=RELATIVE, abs_tol=ABSOLUTE)
    return type(stored) is type(now) and stored == now


def short(value: object) -> str:
    """Return a value as text, shortened for a sentence."""
    text = f"{value:.9g}" if isinstance(value, float) else str(value)
    return text if len(text) <= 80 else f"{text[:80]}..."


OLDER = "older than the code"
NAMED = 3  # changed definitions that a sentence names


def age(result: Result) -> str | None:
    """Return in words what has changed since a result was computed; None if nothing has.

    Code, shipped scenes and versions of packages are compared. Moved code, comments, docstrings, and packages that are
    not installed here do not count. Files of one commit share a sentence.
    """
    origins = origins_of(result)
    groups: dict[tuple[str, str | None], dict[str, list[str]]] = {}
    for name, origin in origins.items():
        if changed := changes(origin["sources"]):
            groups.setdefault((date_of(origin), origin["commit"]), {})[name] = changed
    sentences = [_older(date, commit, names, len(names) == len(origins)) for (date, commit), names in groups.items()]
    sentences += dict.fromkeys(filter(None, map(_other_versions, origins.values())))
    return "; ".join(filter(None, (*sentences, last_check(result)))) if sentences else None


def origins_of(result: Result) -> dict[str, Mapping[str, Any]]:
    """Return {solver: provenance of its part of a result}, the model first."""
    return {MODEL: result.provenance, **(result.provenance.get("engines") or {})}


def timed_apart(result: Result) -> dict[str, str]:
    """Return {engine: reason} of engines whose CPU times cannot be compared with the model's.

    The reason is another processor, or code of another commit.
    """
    origins = origins_of(result)
    model, reasons = origins[MODEL], {}
    for name, origin in origins.items():
        if (processor := origin["machine"]["processor"]) != model["machine"]["processor"]:
            reasons[name] = f"on another processor ({processor})"
        elif origin["commit"] != model["commit"]:
            reasons[name] = f"with the code of another commit ({at_commit(origin['commit'])})"
    return reasons


def briefly(words: str) -> str:
    """Return what `age` says in a few words, for a heading."""
    if OLDER not in words:
        return "computed with other versions"
    return OLDER if words.startswith(OLDER) else f"in part {OLDER}"


def last_check(result: Result) -> str | None:
    """Return in words when runs of a result were last repeated, and how many held; None if never."""
    check = checked(result)
    return f"last check: {check['date']}, {at_commit(check['commit'])}, {held(check)} runs hold" if check else None


def checked(result: Result) -> dict[str, Any] | None:
    """Return the sum of the checks of a result's files, with date and commit of the oldest; None without any."""
    checks = [origin["check"] for origin in origins_of(result).values() if origin.get("check")]
    if not checks:
        return None
    runs, held = (sum(check[name] for check in checks) for name in ("runs", "held"))
    return {**min(checks, key=lambda check: check["date"]), "runs": runs, "held": held}


def held(check: Mapping[str, Any]) -> str:
    """Return in words how many runs held."""
    return f"{check['held']} of {check['runs']}"


def by_engine(result: Result, words: Callable[[Mapping[str, Any]], str]) -> str:
    """Return `words` of the model's provenance, followed by those of the engines for which they differ."""
    texts = {name: words(origin) for name, origin in origins_of(result).items()}
    others: dict[str, list[str]] = {}
    for name, text in texts.items():
        if text != texts[MODEL]:
            others.setdefault(text, []).append(name)
    return "; ".join((texts[MODEL], *(f"{', '.join(names)}: {text}" for text, names in others.items())))


def date_of(origin: Mapping[str, Any]) -> str:
    """Return the day of a provenance."""
    return origin["time"][:10]


def _older(date, commit, changed, whole):
    """A sentence on {solver: changed definitions}. whole: these are all solvers of the result."""
    every = list(dict.fromkeys(name for names in changed.values() for name in names))
    others = f" and {len(every) - NAMED} more" if len(every) > NAMED else ""
    where = "" if whole else f"in the rows of {', '.join(changed)} "
    words = f"computed on {date} {at_commit(commit)}; since then changed: {', '.join(every[:NAMED])}{others}"
    return f"{where}{OLDER}: {words}"


def _other_versions(origin):
    packages = origin["packages"]
    here = {name: version_of(name) for name, version in packages.items() if version}
    changed = [
        f"{name} {packages[name]} (here {version})"
        for name, version in here.items()
        if version and version != packages[name]
    ]
    return f"computed with other versions than those here: {', '.join(changed)}" if changed else None
