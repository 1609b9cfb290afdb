"""A result as one file for each solver: the model's, which also has what names no solver, and one for each engine.

Each has its rows, its entries of the settings, its arrays and its runs, and says where they come from. An engine that
is computed by itself gets its file anew. What the model finds must then come out as it is stored, CPU times aside: else
the engine would stand beside others that were measured against something else.

Whether the code of today would find the same as a result holds: in words, by engine where engines differ in it.
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
from .files import readable
from .provenance import Result, ResultError, at_commit, read_result, save
from .sources import changes, kept_digests, version_of

if TYPE_CHECKING:
    from .plan import Study

RELATIVE, ABSOLUTE = 1e-9, 1e-12  # numbers this near are equal: another processor rounds otherwise
NOT_COMPARED = ("traced_bytes", "resident_bytes", "versions")  # costs, and what they were paid with,
CPU = "cpu_"  # and all that begins so
MODEL = "analytic"  # its file's name
EDITED = "changed_while_running"  # of the settings: definitions edited meanwhile
SCRIPT = "script"  # what stands for the variant in rows of a script
SHOWN = 3  # changes that an error names


def split(result: Result, engines: Iterable[str]) -> dict[str, Result]:
    """{solver: its part of a result}, the model's first."""
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
    """Whether a setting holds for all solvers: no list or table by engine."""
    if isinstance(value, dict):
        return not (value and value.keys() <= {*names})
    listed = isinstance(value, list) and bool(value)
    return not (listed and all(_entry(one) in names or isinstance(one, dict) and "engine" in one for one in value))


def _entry(value):
    return value.get("engine") if isinstance(value, dict) else value if isinstance(value, str) else None


def _share(value, mine):
    if isinstance(value, dict):
        return {name: one for name, one in value.items() if mine(name)}
    return [one for one in value if mine(_entry(one))]


def engine_of(row: Mapping[str, Any]) -> str | None:
    """The solver that a row names; None: none."""
    return row.get("engine", row.get("solver")) or None


def _engine_in(array, names):
    """Whose array it is by its name: "phase/exudyn/...", "isolated/exudyn, native-contact/tilt"."""
    parts = (part.split(", ")[0] for part in array.split("/"))
    return next((part for part in parts if part in names), None)


def joined(parts: Mapping[str, Result]) -> Result:
    """The result that its parts make, {solver: part}; engines in their order.

    Raises
    ------
    ResultError
        The model's is not among them; one was asked otherwise than it; or an engine's variants are others than its
        rows'.
    """
    if MODEL not in parts:
        raise ResultError(f"{MODEL}.json: missing; run the study again")
    model, known = parts[MODEL], dict(zip(ENGINES, range(len(ENGINES)), strict=True))
    engines = sorted(parts.keys() - {MODEL}, key=lambda name: (known.get(name, len(known)), name))
    whole = [model, *(parts[name] for name in engines)]
    origin = {**model.provenance, "engines": {name: parts[name].provenance for name in engines}}
    if not engines:
        del origin["engines"]
    for name in engines:
        if wrong := _unlike(name, parts[name], model, engines):
            raise ResultError(f"{name}.json: {wrong}; run the study with --engine {name} again")
    return replace(
        model,
        settings={key: _together(key, [one.settings[key] for one in whole]) for key in model.settings},
        rows=[row for one in whole for row in one.rows],
        arrays={key: array for one in whole for key, array in one.arrays.items()},
        runs=[run for one in whole for run in one.runs],
        run_count=None if model.run_count is None else sum(one.run_count or 0 for one in whole),
        provenance=origin,
    )


def _unlike(name, part, model, engines):
    """What an engine's file has otherwise than the model's; None: nothing."""
    if part.kind != model.kind:
        return f"a result of {part.kind}, beside one of {model.kind}"
    found: list[tuple[str, Any, Any]] = []
    for key in dict.fromkeys((*model.settings, *part.settings)):
        then, now = (one.settings.get(key) for one in (model, part))
        own, others = ({_entry(one) for one in value} if _listed(value) else None for value in (now, then))
        if key != EDITED and (own is None or others is None or own - {name} or others & {*engines}):
            found += differences(key, then, now)
    found += differences("seed", *(one.provenance["seed"] for one in (model, part)))
    if found:
        where, then, now = found[0]
        return f"asked otherwise than {MODEL}.json ({where}: {short(then)} there, {short(now)} here)"
    listed = {one.get("variant") for one in part.settings.get("variants", ())}
    others = {row["variant"] for row in part.rows if row.get("variant")} - listed - {SCRIPT}
    if listed and others:
        return f"has rows of a variant that its settings do not list: {', '.join(sorted(others))}"
    return None


def _listed(value):
    """Whether a setting is a list or table that may be by engine."""
    return isinstance(value, list | dict)


def _together(key, values):
    first = values[0]
    if isinstance(first, dict):
        return {name: one for value in values for name, one in value.items()}
    if not isinstance(first, list) or all(value == first for value in values):
        return first
    every = [one for value in values for one in value]
    return list(dict.fromkeys(every)) if key == EDITED else every


def read(path: str | PathLike[str]) -> Result:
    """The `Result` in a folder of files by solver, or in a single file.

    Raises
    ------
    ResultError
        As `read_result` and `joined`; the folder's name stands before the file's.
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
    except (AttributeError, KeyError, TypeError) as error:  # whoever changed a file made its digest anew
        why = f"settings or rows of its files are of a wrong type ({readable(repr(error))})"
        raise ResultError(f"{path.name}: {why}; run the study again") from error


def results_in(folder: str | PathLike[str]) -> list[Path]:
    """The results in a folder, sorted: folders of files by solver."""
    return sorted(path for path in Path(folder).glob("*") if path.is_dir() and any(path.glob("*.json")))


def check_parent(folder: str | PathLike[str]) -> None:
    """Raise `SettingError` if `folder`, in which results are looked for by name, is itself a result."""
    place = Path(folder)
    if (place / f"{MODEL}.json").exists():
        raise SettingError(f"--output {folder}: is itself a result; give the folder that it lies in, {place.parent}")


def check_none_goes(study: Study, folder: Path, engines: Collection[str]) -> None:
    """Raise `SettingError` if a study that is computed as a whole would remove files of engines that are not named."""
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
    """Write the parts of a result that was computed here and now into `folder`; returns it.

    plan: name of the study's, `cases.name_of`. engines: those that were asked for. counts: {solver: how many runs it
    made}. only: the files of the engines alone. Else files of other engines, of an earlier answer, go.
    """
    foreign = {engine.package for engine in ENGINES.values()}
    for name, part in split(result, engines).items():
        if only and name == MODEL:
            continue
        mine = [one for one in counts if one == name or name == MODEL and one not in engines]
        wanted = {ENGINES[one].package for one in mine if one in ENGINES}
        packages = result.provenance["packages"]
        origin = {
            **result.provenance,
            "packages": {one: version for one, version in packages.items() if one not in foreign - wanted},
            "sources": kept_digests([plan, *dict.fromkeys(map(root_of, mine))]),
        }
        save(folder / f"{name}.json", replace(part, provenance=origin, run_count=sum(counts[one] for one in mine)))
    for file in () if only else folder.glob("*"):
        if file.suffix in (".json", ".npz") and file.stem not in (MODEL, *engines):
            file.unlink()
    return folder


def opened(study: Study, folder: Path, quick: bool, options: Mapping[str, Any]) -> tuple[Result, bool, dict[str, Any]]:
    """The model's part of the result in `folder`, where an engine is to be computed alone, and what it was asked:
    whether quick, and the options of the plan.

    options: those given; they must not contradict the stored ones.

    Raises
    ------
    SettingError
        One does.
    ResultError
        As `read_result`; or it is of another study.
    """
    old = read_result(folder / f"{MODEL}.json")
    if old.kind != study.name:
        raise ResultError(f"{folder} holds a result of {old.kind}; give another --output")
    known = {**old.settings, "seed": old.provenance["seed"]}
    stored = {name: known[name] for name, kind in study.options().items() if name in known and _is(known[name], kind)}
    asked = {"quick": bool(old.settings.get("quick")), **stored}
    for name, value in {**({"quick": True} if quick else {}), **options}.items():
        if value is not None and name in asked and value != asked[name]:
            given, then = ("--quick", "in full") if name == "quick" else (f"--{name} {value}", f"with {asked[name]}")
            raise SettingError(f"{given}: {folder} was computed {then}; leave it out, or give another --output")
    return old, asked.pop("quick"), {**options, **asked}


def _is(value, parameter):
    """Whether a stored value can be that of an option."""
    kind = parameter.annotation
    try:
        return isinstance(value, get_args(kind)[0] if get_origin(kind) is Annotated else kind)
    except TypeError:  # list[str]: no type to ask
        return False


def check_same(study: Study, old: Result, new: Result, engines: Sequence[str]) -> None:
    """Check that the `new` result, of `engines` alone, has of the model what its `old` part has.

    Raises
    ------
    ResultError
        It has not; what differs is named.
    """
    here = split(new, engines)[MODEL]
    names = dict.fromkeys((*old.arrays, *here.arrays))
    arrays = [name for name in names if not _same_array(name, old.arrays, here.arrays)]
    changes = [
        *differences("settings", {**old.settings, EDITED: []}, {**here.settings, EDITED: []}),
        *differences("rows", old.rows, here.rows),
        *((f"array {name}", *(_size(one.arrays.get(name)) for one in (old, here))) for name in arrays),
        *differences("seed", *(one.provenance["seed"] for one in (old, new))),
    ]
    if changes:
        named = "; ".join(f"{where}: stored {short(then)}, now {short(now)}" for where, then, now in changes[:SHOWN])
        more = f"; and {len(changes) - SHOWN} more" if len(changes) > SHOWN else ""
        raise ResultError(
            f"beside the rows of {', '.join(engines)} others come out changed ({named}{more}), so nothing was written: "
            f"rocking study {study.name} without --engine computes all of it"
        )


def _same_array(name, old, new):
    one, other = old.get(name), new.get(name)
    if one is None or other is None or one.shape != other.shape or one.dtype != other.dtype:
        return False
    if one.dtype.kind != "f":
        return np.array_equal(one, other)
    return np.allclose(one, other, max(RELATIVE, float(np.finfo(one.dtype).eps)), ABSOLUTE, equal_nan=True)


def _size(array):
    return None if array is None else f"{array.dtype} {array.shape}"


def differences(where: str, stored: Any, now: Any) -> Iterator[tuple[str, Any, Any]]:
    """(quantity, stored, now) of all that differs."""
    if isinstance(stored, dict) and isinstance(now, dict):
        for name in dict.fromkeys((*stored, *now)):
            if name not in NOT_COMPARED and not name.startswith(CPU):
                yield from differences(f"{where}.{name}", stored.get(name), now.get(name))
    elif isinstance(stored, list) and isinstance(now, list):
        for k, (one, other) in enumerate(zip_longest(stored, now)):
            yield from differences(f"{where}[{k}]", one, other)
    elif not _equal(stored, now):
        yield where.removeprefix("values."), stored, now


def _equal(stored, now):
    if type(stored) is float and isinstance(now, int | float) and type(now) is not bool:
        return math.isclose(stored, now, rel_tol=RELATIVE, abs_tol=ABSOLUTE)
    return type(stored) is type(now) and stored == now


def short(value: object) -> str:
    """A value as a sentence has it."""
    text = f"{value:.9g}" if isinstance(value, float) else str(value)
    return text if len(text) <= 80 else f"{text[:80]}..."


if TYPE_CHECKING:
    from .provenance import Result

OLDER = "older than the code"
NAMED = 3  # definitions that a sentence on a stale result names


def age(result: Result) -> str | None:
    """In words: None if code, shipped scenes and packages behind `result` are those here, else what has changed since.

    Code counts wherever it has moved; comments, docstrings and packages that are not installed here do not. Files of
    one commit are told together.
    """
    origins = origins_of(result)
    groups: dict[tuple[str, str | None], dict[str, list[str]]] = {}
    for name, origin in origins.items():
        if changed := changes(origin["sources"]):
            groups.setdefault((date_of(origin), origin["commit"]), {})[name] = changed
    found = [_older(date, commit, names, len(names) == len(origins)) for (date, commit), names in groups.items()]
    found += dict.fromkeys(filter(None, map(_other_versions, origins.values())))
    return "; ".join(filter(None, (*found, last_check(result)))) if found else None


def origins_of(result: Result) -> dict[str, Mapping[str, Any]]:
    """{solver: where its part of a result comes from}, the model's first."""
    return {MODEL: result.provenance, **(result.provenance.get("engines") or {})}


def timed_apart(result: Result) -> dict[str, str]:
    """{engine: why} its CPU times cannot be set against the model's: another processor, or code of another commit."""
    origins = origins_of(result)
    own, found = origins[MODEL], {}
    for name, origin in origins.items():
        if (processor := origin["machine"]["processor"]) != own["machine"]["processor"]:
            found[name] = f"on another processor ({processor})"
        elif origin["commit"] != own["commit"]:
            found[name] = f"with the code of another commit ({at_commit(origin['commit'])})"
    return found


def briefly(words: str) -> str:
    """What `age` says, for a heading: that it is so, not why."""
    if OLDER not in words:
        return "computed with other versions"
    return OLDER if words.startswith(OLDER) else f"in part {OLDER}"


def last_check(result: Result) -> str | None:
    """In words when some of a result's runs were done again and how many held; None if never."""
    found = checked(result)
    return f"last check: {found['date']}, {at_commit(found['commit'])}, {held(found)} runs hold" if found else None


def checked(result: Result) -> dict[str, Any] | None:
    """The checks of a result's files together, with the oldest one's date and commit; None without any."""
    known = [origin["check"] for origin in origins_of(result).values() if origin.get("check")]
    if not known:
        return None
    runs, held = (sum(one[name] for one in known) for name in ("runs", "held"))
    return {**min(known, key=lambda one: one["date"]), "runs": runs, "held": held}


def held(check: Mapping[str, Any]) -> str:
    """How many runs held, of how many."""
    return f"{check['held']} of {check['runs']}"


def by_engine(result: Result, words: Callable[[Mapping[str, Any]], str]) -> str:
    """What is said of where the files of a result come from: the model's, and those of which something else holds."""
    told = {name: words(origin) for name, origin in origins_of(result).items()}
    others: dict[str, list[str]] = {}
    for name, text in told.items():
        if text != told[MODEL]:
            others.setdefault(text, []).append(name)
    return "; ".join((told[MODEL], *(f"{', '.join(names)}: {text}" for text, names in others.items())))


def date_of(origin: Mapping[str, Any]) -> str:
    """The day of a provenance."""
    return origin["time"][:10]


def _older(date, commit, changed, whole):
    """changed: {solver: definitions}. whole: whether these are all solvers."""
    every = list(dict.fromkeys(name for names in changed.values() for name in names))
    others = f" and {len(every) - NAMED} more" if len(every) > NAMED else ""
    where = "" if whole else f"in the rows of {', '.join(changed)} "
    words = f"computed on {date} {at_commit(commit)}; since then changed: {', '.join(every[:NAMED])}{others}"
    return f"{where}{OLDER}: {words}"


def _other_versions(origin):
    then = origin["packages"]
    here = {name: version_of(name) for name, version in then.items() if version}
    found = [f"{name} {then[name]} (here {own})" for name, own in here.items() if own and own != then[name]]
    return f"computed with other versions than those here: {', '.join(found)}" if found else None
