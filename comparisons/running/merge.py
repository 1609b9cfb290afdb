"""An engine computed anew into a stored result: its rows and arrays in place of those there, all else as it is.

What the model finds, and what names no solver, must come out as it is stored, CPU times aside: else the engine would
stand beside others that were measured against something else, and nothing is written.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from itertools import groupby
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, get_args, get_origin

import numpy as np

from analytic.errors import SettingError
from engines import ENGINES

from .cases import SOLVERS, name_of
from .check import ABSOLUTE, RELATIVE, differences, short
from .files import check_writable
from .provenance import Result, ResultError, read_result
from .run_sample import SIZE
from .sources import kept_digests

if TYPE_CHECKING:
    from .plan import Study

EDITED = "changed_while_running"  # of the settings: modules edited meanwhile
SHOWN = 3  # changes that an error names


def opened(
    study: Study, path: str | PathLike[str], quick: bool, options: Mapping[str, Any]
) -> tuple[Result, bool, dict[str, Any]]:
    """The stored result, and what it was asked: whether quick, and the options of the plan.

    options: those given; they must not contradict the stored ones.

    Raises
    ------
    SettingError
        One does; no engine of this study can be computed by itself; or the file cannot be written.
    ResultError
        As `read_result`; or it is of another study.
    """
    if study.whole:
        raise SettingError(f"--into {path}: study {study.name} cannot take one engine by itself: {study.whole}")
    check_writable([str(path)])
    old = read_result(path)
    if old.kind != study.name:
        raise ResultError(f"{path}: a result of {old.kind}; give one that rocking study {study.name} wrote")
    known = {**old.settings, "seed": old.provenance["seed"]}
    stored = {name: known[name] for name, kind in study.options().items() if name in known and _is(known[name], kind)}
    asked = {"quick": bool(old.settings.get("quick")), **stored}
    for name, value in {**({"quick": True} if quick else {}), **options}.items():
        if value is not None and name in asked and value != asked[name]:
            words = ("--quick", "in full") if name == "quick" else (f"--{name} {value}", f"with {asked[name]}")
            raise SettingError(f"{words[0]}: {path} was computed {words[1]}; leave it out")
    return old, asked.pop("quick"), {**options, **asked}


def _is(value, parameter):
    """Whether a stored value can be that of an option."""
    kind = parameter.annotation
    try:
        return isinstance(value, get_args(kind)[0] if get_origin(kind) is Annotated else kind)
    except TypeError:  # list[str]: no type to ask
        return False


def merged(study: Study, old: Result, new: Result, engines: Sequence[str], runs: Mapping[str, int]) -> Result:
    """The `old` result with the rows and arrays of `engines` from the `new` one, which was asked the same.

    runs: how many of each engine there were.

    Raises
    ------
    ResultError
        Something else has changed; it is named.
    """
    shared = {None, *SOLVERS, *map(engine_of, new.rows)} - set(engines)
    kept = set(map(engine_of, old.rows)) - shared - set(engines)  # rows of other engines
    seeds = [one.provenance["seed"] for one in (old, new)]
    settings, changes = _settings(old.settings, new.settings, engines, shared)
    arrays, others = _arrays(study, old, new, engines, kept)
    changes += [*_differing("rows", old.rows, new.rows, shared), *differences("seed", *seeds), *others]
    if changes:
        named = "; ".join(f"{where}: stored {short(then)}, now {short(now)}" for where, then, now in changes[:SHOWN])
        more = f"; and {len(changes) - SHOWN} more" if len(changes) > SHOWN else ""
        raise ResultError(
            f"beside the rows of {', '.join(engines)} others come out changed ({named}{more}), so nothing was written: "
            f"rocking study {study.name} without --into computes all of it"
        )
    rows, added = old.rows, set(engines) - set(map(engine_of, old.rows))
    for name in engines:
        rows = _joined(rows, new.rows, name, shared)
    count = (old.run_count or 0) + sum(runs[name] for name in added)
    origin, sample = _provenance(study, old, new, engines), _sample(old, new, engines)
    return replace(old, settings=settings, rows=rows, arrays=arrays, provenance=origin, runs=sample, run_count=count)


def engine_of(row: Mapping[str, Any]) -> str | None:
    """The solver that a row names; None: none."""
    return row.get("engine", row.get("solver")) or None


def _differing(where, old, new, shared):
    """(quantity, stored, now) of all that differs in rows that both results have."""
    ours, theirs = ([row for row in rows if engine_of(row) in shared] for rows in (old, new))
    if len(ours) != len(theirs):
        yield f"{where}: how many there are of the model and of no solver", len(ours), len(theirs)
        return
    for number, (one, other) in enumerate(zip(ours, theirs, strict=True), 1):
        said = ", ".join(str(one[name]) for name in ("part", "engine", "scene") if one.get(name))
        yield from differences(f"{where}, {number}{f' ({said})' if said else ''}", one, other)


def _settings(old, new, engines, shared):
    """(settings of both, what differs): lists and tables by engine have an entry more, or another one.

    One that an older study did not have yet is added.
    """
    found, changes = {**new, **old}, []
    for name, ours in old.items():
        theirs = new.get(name)
        if name == EDITED:
            found[name] = list(dict.fromkeys((*ours, *theirs)))
        elif _by_engine(ours) and _by_engine(theirs):
            changes += _differing(name, ours, theirs, shared)
            for engine in engines:
                found[name] = _joined(found[name], theirs, engine, shared)
        elif isinstance(theirs, dict) and theirs and theirs.keys() <= set(engines):
            found[name] = {**ours, **theirs}
        elif isinstance(theirs, list) and theirs == list(engines):
            found[name] = list(dict.fromkeys((*ours, *theirs)))
        else:
            changes += differences(name, ours, theirs)
    return found, changes


def _by_engine(value):
    return isinstance(value, list) and all(isinstance(one, dict) and "engine" in one for one in value)


def _joined(old: Sequence[Any], new: Sequence[Any], engine: str, shared: Collection[str | None]) -> list[Any]:
    """The old rows with those of an engine from the new ones.

    Between the same rows of the model, and in the same part, the rows of a variant take the places of those there, one
    by one; of more the rest follows. Where there are none they follow those of the other engines.
    """
    places: dict[tuple, list[int]] = {}  # of the engine's own rows
    last = {0: -1}  # behind which row of a stretch the next one follows, where nothing else says so
    for place, (stretch, row) in enumerate(_stretched(old, shared)):
        last.setdefault(stretch, place)
        if engine_of(row) == engine:
            places.setdefault((stretch, row.get("part"), row.get("variant")), []).append(place)
    ends, put = _ends(old, shared), dict[int, list[Any]]()
    taken: dict[tuple, int] = {}
    for stretch, row in _stretched(new, shared):
        if engine_of(row) == engine:
            label = stretch, row.get("part"), row.get("variant")
            if free := places.get(label):
                taken[label] = free.pop(0)
            last[stretch] = taken.get(label, ends.get(label[:2], last[stretch]))
            put.setdefault(last[stretch], []).append(row)
    found = list(put.get(-1, ()))
    for place, row in enumerate(old):
        found += [row] if engine_of(row) != engine else []
        found += put.get(place, ())
    return found


def _stretched(rows, shared):
    """(how many rows of the model come before it, and itself, row) of each."""
    count = 0
    for row in rows:
        count += engine_of(row) in shared
        yield count, row


def _ends(rows, shared):
    """{(stretch, part): place of the last row of an engine there, be it of a part that takes turns with this one}."""
    found: dict[tuple, int] = {}
    for stretch, some in groupby(enumerate(_stretched(rows, shared)), lambda item: item[1][0]):
        parts = [(place, row.get("part")) for place, (_, row) in some if engine_of(row) not in shared]
        last, end, turns = {part: place for place, part in parts}, -1, set[Any]()
        for place, part in parts:
            turns = {part} if place > end else turns | {part}
            end = max(end, last[part])
            found.update(((stretch, one), end) for one in turns)
    return found


def _arrays(study, old, new, engines, kept):
    """({name: array} of both, what differs)."""
    found, changes = {}, []
    names = old.settings.get("engines", [])
    for name, array in old.arrays.items():
        if name in study.indexed:
            column = study.indexed[name]
            again = [names.index(engine) for engine in engines if engine in names]
            theirs = new.arrays[name].copy()
            every = list(dict.fromkeys((*names, *engines)))
            theirs[:, column] = [every.index(new.settings["engines"][int(one)]) for one in theirs[:, column]]
            found[name] = np.concatenate([array[~np.isin(array[:, column], again)], theirs])
        elif any(_names(name, engine) for engine in engines):
            continue
        else:
            found[name] = array
            if not any(_names(name, engine) for engine in kept) and not _equal(array, new.arrays.get(name)):
                changes.append((f"array {name}", _size(array), _size(new.arrays.get(name))))
    own = {name: array for name, array in new.arrays.items() if any(_names(name, engine) for engine in engines)}
    more = [(f"array {name}", None, _size(new.arrays[name])) for name in new.arrays.keys() - own.keys() - found.keys()]
    return found | own, changes + more


def _names(array, engine):
    """Whether the name of an array has the engine's in it: "phase/exudyn/...", "isolated/exudyn, native/tilt"."""
    return any(part == engine or part.startswith(f"{engine}, ") for part in array.split("/"))


def _equal(one, other):
    if other is None or one.shape != other.shape or one.dtype != other.dtype:
        return False
    if one.dtype.kind != "f":
        return np.array_equal(one, other)
    return np.allclose(one, other, max(RELATIVE, float(np.finfo(one.dtype).eps)), ABSOLUTE, equal_nan=True)


def _size(array):
    return None if array is None else f"{array.dtype} {array.shape}"


def _provenance(study, old, new, engines):
    """Where both come from: the engines from here, the rest from where it was. A check was of the runs before."""
    rest = {name: value for name, value in old.provenance.items() if name != "check"}
    plan, packages = name_of(study.plan), {ENGINES[name].package for name in engines}
    adapters = {ENGINES[name].adapter for name in engines}
    theirs = [digests for root, digests in rest["sources"].items() if root in adapters]  # others may reach them, too
    others = {root: digests for root, digests in rest["sources"].items() if root not in adapters}
    rest["sources"] = {**others, plan: "".join((others.get(plan, ""), *theirs))}
    rest["packages"] = {name: version for name, version in rest["packages"].items() if name not in packages}
    later = dict(old.provenance.get("engines") or {})
    foreign = {engine.package for engine in ENGINES.values()}
    for name in engines:
        own = {part: value for part, value in new.provenance.items() if part not in ("seed", "check", "engines")}
        own["sources"] = kept_digests([plan, ENGINES[name].adapter])
        wanted = {*own["packages"]} - foreign | {ENGINES[name].package}
        own["packages"] = {package: version for package, version in own["packages"].items() if package in wanted}
        later[name] = own
    return {**rest, "engines": later}


def _sample(old: Result, new: Result, engines: Sequence[str]) -> list[Any]:
    """Runs stored with both: of the engines as many as were theirs, or their share."""
    mine, rest = ([run for run in old.runs if (run["engine"] in engines) is own] for own in (True, False))
    again = [run for run in new.runs if run["engine"] in engines]
    solvers = {run["engine"] for run in old.runs} | set(engines)
    again = again[: max(len(mine), SIZE * len(engines) // len(solvers))]
    return [*rest[: SIZE - len(again)], *again]


def the_one(answers: Mapping[Path, Result], into: Path) -> Result:
    """Of what a study has found, the answer that a result file holds."""
    found = dict(zip((path.stem for path in answers), answers.values(), strict=True))
    if len(found) == 1 or into.stem in found:
        return found.get(into.stem) or next(iter(found.values()))
    raise SettingError(f"{into}: the study writes {', '.join(found)}; call the file as it does")
