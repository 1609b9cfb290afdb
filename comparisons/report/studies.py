"""The studies' stored results: what the report's first page takes of them, and their own pages."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import ProcessPoolExecutor
from contextlib import nullcontext
from dataclasses import dataclass, replace
from multiprocessing import get_context
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..running.provenance import RESULTS, ResultError, age, last_check, read_result
from ..showing.parts import Judgement, Section
from ..studies import StudyBroken, get_study, study_names

if TYPE_CHECKING:
    from ..running.provenance import Result

FEW = 4  # files, drawn here: new processes would take longer


@dataclass(frozen=True)
class Stored:
    """One result file. section: all of it; finding: its answer for the first page; judgements: its rows of the first
    table.

    origin: machine, versions, date and commit in one line. variants: those it knows, as `answer.setups_of` takes them.
    """

    name: str
    section: Section
    finding: Section | None = None
    judgements: tuple[Judgement, ...] = ()
    origin: str = ""
    variants: tuple[Mapping[str, Any], ...] = ()


def stored_studies(
    folder: Path = RESULTS, progress: Callable[[int, int], object] = lambda done, total: None
) -> list[Stored]:
    """All result files ``<study>.json`` in `folder`, in the studies' order; one that cannot be shown says why.

    progress : is told how many of them are done, of how many.
    """
    order = study_names()

    def place(file):
        return (order.index(file.stem) if file.stem in order else len(order), file.stem)

    files = sorted(folder.glob("*.json"), key=place)
    stored = []
    with ProcessPoolExecutor(mp_context=get_context("spawn")) if len(files) >= FEW else nullcontext() as workers:
        shown = iter(workers.map(_stored, files) if workers else map(_stored, files))
        for file in files:
            old = _age(file)  # meanwhile: all code is read for the first of them
            stored.append(_aged(next(shown), old))
            progress(len(stored), len(files))
    return stored


def variants_of(stored: Iterable[Stored], *more: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    """Each variant once: `more`, and those that the studies know."""
    listed = [*more, *(variant for one in stored for variant in one.variants)]
    return list({(one["engine"], one["variant"]): one for one in reversed(listed)}.values())


def origin_of(result: Result) -> str:
    """Date, commit, machine, versions and the last check, in one line."""
    origin = result.provenance
    packages = [f"{name} {version}" for name, version in origin["packages"].items() if version]
    first = (origin["time"][:10], f"commit {commit_of(origin)}", origin["machine"]["processor"])
    return ", ".join((*first, *packages)) + (f"; {last}" if (last := last_check(result)) else "")


def commit_of(origin: Mapping[str, Any]) -> str:
    """The commit of a provenance, and whether there was more than that."""
    if origin["commit"] is None:
        return "outside a checkout"
    return origin["commit"][:12] + (", with uncommitted changes" if origin["dirty"] else "")


def _age(file):
    """How the result is older than the code, None if it is not or cannot be read."""
    with contextlib.suppress(ResultError):
        return age(read_result(file))


def _aged(stored, old):
    finding = stored.finding and replace(stored.finding, age=old)
    return replace(stored, section=replace(stored.section, age=old), finding=finding)


def _stored(file):
    """What is shown of a file; whether it is old is not asked here."""
    try:
        result = read_result(file)
    except ResultError as error:
        return Stored(file.stem, Section(f"Study {file.stem}", (f"{file.name} cannot be shown: {error}",)))
    try:
        study = get_study(result.kind)
        page = study.page(result)  # drawn once
        judgements = study.judgements(result)
    except (KeyError, StudyBroken) as error:
        words = f"{file.name} cannot be shown: {error.args[0]}."
        return Stored(file.stem, Section(f"Study {result.kind}", (words,)), origin=origin_of(result))
    return Stored(file.stem, page.whole(), page.opening(), judgements, origin_of(result), _variants(result.settings))


def _variants(settings):
    """The variants that settings list with their engine's default one."""
    best = settings.get("default_variants", {})
    return tuple(
        {**one, "best": best[one["engine"]] == one["variant"]}
        for one in settings.get("variants", ())
        if best and one["engine"] in best
    )
