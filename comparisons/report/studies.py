"""The studies' stored results: what the report's first page takes of them, and their own pages."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Self

from ..running.provenance import RESULTS, Result, ResultError, age, last_check
from ..running.readable import readable
from ..showing.parts import Judgement, Section
from ..studies import StudyBroken, get_study, study_names
from ..studies.rows import read_study


@dataclass(frozen=True)
class Stored:
    """One result file. section: all of it; finding: its answer for the first page; judgements: its rows of the first
    table.

    wrong: why it cannot be shown, "" where it can. origin: machine, versions, date and commit in one line. variants:
    those it knows, as `answer.setups_of` takes them.
    """

    name: str
    section: Section
    finding: Section | None = None
    judgements: tuple[Judgement, ...] = ()
    origin: str = ""
    variants: tuple[Mapping[str, Any], ...] = ()
    wrong: str = ""

    @classmethod
    def damaged(cls, name: str, title: str, words: str, **more: Any) -> Self:
        """One of which nothing but why can be shown."""
        return cls(name, Section(title, (words,), age=more.pop("age", None)), wrong=words, **more)


def stored_studies(
    folder: Path = RESULTS, progress: Callable[[int, int], object] = lambda done, total: None
) -> list[Stored]:
    """All result files ``<study>.json`` in `folder`, in the studies' order; one that cannot be shown says why.

    progress : is called with how many of them are done, of how many.
    """
    order = {name: place for place, name in enumerate(study_names())}
    files = sorted(folder.glob("*.json"), key=lambda file: (order.get(file.stem, len(order)), file.stem))
    stored = []
    for file in files:
        stored.append(_stored(file))
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


def _stored(file):
    try:
        result = read_study(file)
        if not f"{file.stem}-".startswith(f"{result.kind}-"):  # <study>-<part>.json where a study has several
            raise ResultError(f"a result of {result.kind}; call it {result.kind}.json")
    except ResultError as error:
        return Stored.damaged(file.stem, f"Study {file.stem}", f"{file.name} cannot be shown: {readable(error)}")
    old, origin = age(result), origin_of(result)
    try:
        study = get_study(result.kind)
    except (KeyError, StudyBroken) as error:
        words = f"{file.name} cannot be shown: {error.args[0]}."
        return Stored.damaged(file.stem, f"Study {result.kind}", words, age=old, origin=origin)
    try:
        page = study.page(result)  # drawn once
        judgements, variants = study.judgements(result), _variants(result.settings)
        section, finding = replace(page.whole(), age=old), page.opening()
    except Exception as error:  # settings of another version, or another package's page: the report goes on
        words = f"{file.name} cannot be shown: its page fails ({readable(repr(error))}); --replot shows where."
        return Stored.damaged(file.stem, f"Study {result.kind}", words, age=old, origin=origin)
    finding = finding and replace(finding, age=old)
    return Stored(file.stem, section, finding, judgements, origin, variants)


def _variants(settings):
    """The variants that settings list with their engine's default one."""
    best = settings.get("default_variants", {})
    return tuple(
        {**one, "best": best[one["engine"]] == one["variant"]}
        for one in settings.get("variants", ())
        if best and one["engine"] in best
    )
