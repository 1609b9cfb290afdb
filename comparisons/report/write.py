"""Write the report's pages from result files: the report, and a page for each study."""

import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from os import PathLike
from pathlib import Path
from typing import Any

from markupsafe import Markup

from engines.simulating import RANGE, in_words

from ..execution.by_solver import age
from ..execution.results import PACKAGES, RESULTS, Result, read_result
from ..execution.writing import write_all
from ..metrics.statistics import wilson
from ..plotting import diagrams
from ..plotting.parts import SIGNS, Section, Table
from ..plotting.wording import TRUSTED, USABLE
from ..schemas.columns import NAME, percent, spelled_page
from .answer import (
    Stored,
    commit_of,
    judgements_of,
    not_to_do,
    origin_of,
    own_restitution,
    screen,
    setups_of,
    stored_studies,
    summary,
    variants_of,
)
from .detail import EQUATIONS, GLOSSARY, REFERENCES, assets, detail, environment, frames
from .figures import animation
from .kept import digest_of, kept
from .runs import RESTITUTION, SCENES
from .sections import earthquake, restitution_section, scene_sections
from .statue import card_of

PAGE, PAGES = "report.html", "pages"
HERE = Path(__file__).parent
CONTACT_OURS = "contact law: ours"  # begin of `Variant.imposes` if the adapter supplies the contact law
# {study: short name of its section in the contents}, in order; studies of other packages follow.
SHORT = {
    "restitution": "One impact",
    "overturning": "Many pulses",
    "statues": "Random statues",
    "stack": "Stacked blocks",
    "recorded": "Recorded motions",
    "shake-table": "Shake table",
    "fragility": "Many earthquakes",
    "sensitivity": "What matters more",
    "speed-error": "Cost against error",
    "stability": "Hard cases",
    "mistakes": "What a mistake costs",
}


FOLDED = ("sensitivity", "mistakes")  # studies that do not answer the page's question by themselves


@dataclass(frozen=True)
class Part:
    """A section of the page. short: its name in the contents. page: the study's own page. folded: shown by a click."""

    id: str
    short: str
    section: Section | None
    origin: str = ""
    page: str = ""
    folded: bool = False


def write_page(
    folder: str | PathLike[str],
    studies: Path = RESULTS,
    progress: Callable[[int, int], object] = lambda done, total: None,
    calls: Mapping[str, Sequence[str]] | None = None,
) -> Path:
    """Write ``report.html`` and ``pages/`` into `folder`, from result files there and in `studies`. Return its path.

    progress : called with (steps done, all steps). calls : {scene: (its file, and options for its motions, as on a
    command line; what must be done to the file first)}.

    Raises
    ------
    ResultError
        A result file of the report is missing or damaged.
    PlaceError
        A page cannot be written; pages not written yet are as before.
    """
    folder = Path(folder)
    scenes = read_result(folder / SCENES)
    block = read_result(folder / RESTITUTION) if (folder / RESTITUTION).exists() else None
    read = {SCENES: scenes} | ({RESTITUTION: block} if block else {})
    stored = stored_studies(studies, lambda done, total: progress(done, total + 1))  # and the pages themselves
    pages = [
        ("runs", "The report’s own runs"),
        *((study.name, study.section.title.partition(":")[0]) for study in stored),
    ]
    listed = [{"file": f"{PAGES}/{name}.html", "title": title} for name, title in pages]
    first = (
        environment()
        .get_template("page.html")
        .render(
            **_first_screen(scenes, block, stored),
            **assets(),
            cards=_cards(scenes, calls or {}),
            motion=scenes.settings["motion"]["label"] if scenes.settings["motion"] else "no motion",
            contents=_contents(scenes, stored),
            equations=EQUATIONS,
            drawings=[diagrams.rocking(), diagrams.impact(), diagrams.isolated()],
            frames=frames(),
            modes=(diagrams.modes(), diagrams.CAPTION),
            glossary=GLOSSARY,
            references=REFERENCES,
            provenance=_provenance(scenes, block),
            pages=listed,
            ages=[f"{name} is {text}" for name, text in ((name, age(result)) for name, result in read.items()) if text],
            damaged=[study.wrong.rstrip(".") for study in stored if study.wrong],
            files=[file for name in read for file in (name, name.replace(".json", ".npz"))],
        )
    )
    given = any(scene["block"]["restitution"] is not None for scene in scenes.settings["scenes"].values())
    sections_of_runs = [*scene_sections(scenes), *([restitution_section(block, given)] if block else ())]
    files: dict[str, str] = {}
    for name, title, sections, origin, key in (
        ("runs", "The report’s own runs", sections_of_runs, origin_of(scenes), ""),
        *((study.name, study.section.title, [study.section], study.origin, study.key) for study in stored),
    ):
        file = f"{PAGES}/{name}.html"
        make = partial(detail, title, sections, origin, pages=listed, home=PAGE, file=file)
        files[file] = kept(key and digest_of(key, listed), make)
    return write_all(folder, {**files, PAGE: spelled_page(first)})[
        -1
    ]  # each page is there before the one that leads to it


def _cards(scenes, calls):
    """Return the cards of the user's scenes."""
    names = scenes.settings["scenes"] if scenes.settings["own"] else ()
    return [card_of(scenes, name, *calls.get(name, ())) for name in names]


def _first_screen(scenes: Result, block: Result | None, stored: list[Stored]) -> dict[str, Any]:
    """Return the first screen: the studies' numbers; restitution of the scenes' own block if it rocks."""
    where = {judgement.heading: f"{PAGES}/{study.name}.html" for study in stored for judgement in study.judgements}
    outside = _outside(scenes)
    judgements = judgements_of(stored)
    if block:
        own_block = own_restitution(block, outside)
        where[own_block.heading] = f"{PAGES}/runs.html"
        judgements = [own_block, *(judgement for judgement in judgements if judgement.key != own_block.key)]
    own_variants = [
        {**kind, "engine": engine, "variant": variant}
        for engine, variants in scenes.settings["variants"].items()
        for variant, kind in variants.items()
    ]
    setups = setups_of(variants_of(stored, *own_variants), judgements)
    return {
        **screen(setups, judgements, [study.glance for study in stored if study.glance]),
        "outside": outside,
        "own": _contact_ours(scenes),
        "limits": in_words(),
        "summary": summary(scenes, block),
        "not_to_do": not_to_do(setups),
        "decision": setups,
        "headings": {judgement.heading: where[judgement.heading] for judgement in judgements},
        "signs": SIGNS,
        "least": percent(wilson(0, 50)[1]),
        "trusted": f"{TRUSTED:g}",
        "usable": f"{USABLE:g}",
        "computed": _computed(scenes),
        "origin": origin_of(scenes),
        "stage": _stage(scenes),
    }


def _contact_ours(scenes: Result) -> set[tuple[str, str]]:
    """Return (engine, variant) of the variants whose contact law is the adapter's."""
    return {
        (engine, variant)
        for engine, variants in scenes.settings["variants"].items()
        for variant, kind in variants.items()
        if kind["imposes"].startswith(CONTACT_OURS)
    }


def _outside(scenes: Result) -> str:
    """Return an engine's warning of a scene outside the range of statues, or ""."""
    warnings = (warning for row in scenes.rows if "engine" in row for warning in row.get("warnings", ()))
    return next(
        (warning["text"] for warning in warnings if warning["kind"] == "engine" and warning["quantity"] in RANGE), ""
    )


def _stage(scenes: Result) -> Mapping[str, Any] | None:
    """Return the animation with the frame that is shown without a script."""
    stage = animation(scenes)
    if stage is None:
        return None
    data = json.dumps(stage, separators=(",", ":"), ensure_ascii=False).replace("<", "\\u003c")
    frame = round(stage["still"] / stage["step"])
    for scene in stage["scenes"]:
        b, h = scene["size"]
        falls = any(abs(tilt) > 1.0 for track in scene["tracks"] for tilt in track["tilt"])
        scene["width"] = 2 * (max(b + 2 * h if falls else 0.0, b + 0.5) + scene["reach"] + 0.15)
        scene["poses"] = [_pose(track, frame, b) for track in scene["tracks"]]
        scene["moved"] = round(_number_at(scene["tracks"][0], "x", frame), 4)
        scene["skew"] = round(-math.degrees(math.atan2(scene["moved"], 0.2)), 3)  # of a bearing .2 m high
    peak = max((abs(value) for value in stage["ground"]), default=0.0) or 1.0
    path = "M" + "L".join(f"{k} {-value / peak:.3f}" for k, value in enumerate(stage["ground"]))
    return {**stage, "data": Markup(data), "path": path, "at": frame}


def _pose(track, frame, b):
    """Return (displacement [m], angle [degrees], corner [m]) of a block at a frame."""
    tilt, x = _number_at(track, "tilt", frame), _number_at(track, "x", frame) + _number_at(track, "slip", frame)
    return round(x, 4), round(math.degrees(tilt), 3), -b if tilt < 0 else b


def _number_at(track, name, frame):
    """Return a number of a run at a frame, or at its end; 0 if it has none of that name."""
    return track[name][min(frame, len(track[name]) - 1)] if name in track else 0.0


def _contents(scenes: Result, stored: list[Stored]) -> list[Part]:
    """Return the sections of the page in reading order."""
    setting = Section(
        "Scene and equations: a block that rocks about its corners, on a base carried by bearings",
        (
            "The block is rigid and planar, and impacts are instantaneous. It slides only if the scene gives a "
            "friction coefficient, and only where the friction demand exceeds it: equations (S) and (I). The force of "
            "the bearings depends on their last reversal. Equation numbers without a letter are those of the paper.",
        ),
    )
    parts = [Part("equations", "Scene and equations", setting)]
    findings = {study.name: study for study in stored if study.finding is not None}
    name = "One earthquake" if scenes.settings["motion"] else "The scenes"
    own_part = Part("earthquake", name, earthquake(scenes), made(origin_of(scenes)), f"{PAGES}/runs.html")
    order = [name for name in SHORT if name in findings] + [name for name in findings if name not in SHORT]
    for name in order:
        study = findings[name]
        anchor = "impact" if name == "restitution" else name
        short, page = SHORT.get(name, study.section.title), f"{PAGES}/{name}.html"
        parts.append(Part(anchor, short, study.finding, made(study.origin), page, name in FOLDED))
        if name == "restitution":
            parts += [Part("autopsy", "Why engines err", None), own_part]
    if own_part not in parts:
        parts.insert(1, own_part)
    return [*parts, Part("method", "Method and words", None)]


def made(origin: str) -> str:
    """Return date and commit of an origin; machine and versions stand on the study's own page."""
    return ", ".join(origin.split(", ")[:2])


def _computed(result: Result) -> Table:
    return Table(
        "What each engine computes, and what our adapter imposes in addition to loads and settings",
        ("engine, variant", "kind", "the engine computes", "the adapter imposes"),
        [
            [f"{solver}, {variant}", kind["tier"], kind["computes"], kind["imposes"]]
            for solver, variants in result.settings.get("variants", {}).items()
            for variant, kind in variants.items()
        ],
    )


def _provenance(scenes: Result, block: Result | None) -> Section:
    """Return versions, machine and settings, which are needed to obtain the same numbers."""
    origin = scenes.provenance
    machine = origin["machine"]
    rows = [
        ["computed", origin["time"]],
        ["commit", commit_of(origin)],
        ["processor", machine["processor"]],
        ["cores (physical, logical)", f"{machine['cores']}, {machine['logical_cores']}"],
        ["memory [GiB]", str(machine["memory_gib"])],
        ["system", machine["system"]],
        ["Python", origin["python"]],
    ]
    rows += [[name, origin["packages"].get(name) or "not installed"] for name in PACKAGES]
    settings = {}
    for row in [*scenes.rows, *(block.rows if block else ())]:
        if row.get("settings") is not None:
            settings[NAME.of(row)] = row["settings"]
    listed = [
        [name, ", ".join(f"{key} = {value}" for key, value in chosen.items())] for name, chosen in settings.items()
    ]
    return Section(
        "Versions, machine, settings",
        (),
        (
            Table("Versions and machine", ("what", "value"), rows),
            Table("Settings of each solver and variant (SI units)", ("solver", "settings"), listed),
        ),
    )
