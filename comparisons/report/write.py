"""The page: result files in, one HTML file out."""

from os import PathLike
from pathlib import Path

from ..running.provenance import PACKAGES, age, read_result
from ..showing.parts import Section, Table
from ..showing.templates import templates
from .own import SCENES_FILE, own_sections
from .runs import CARYATID, FREE_ROCKING
from .sections import caryatid_sections, restitution_sections, variant_groups
from .studies import RESULTS, study_sections
from .summary import summary

PAGE = "report.html"
CARYATID_WORDS = "A rigid block (the Caryatid), free-standing and on lead-rubber bearings"


def write_page(folder: str | PathLike[str], studies: Path = RESULTS) -> Path:
    """Write ``report.html`` into `folder` from the result files there and those of the studies; returns its path.

    Raises
    ------
    ResultError
        A result file of the report is missing or damaged.
    """
    folder = Path(folder)
    own = (folder / SCENES_FILE).exists()
    main = SCENES_FILE if own else CARYATID
    scenes = read_result(folder / main)
    free = read_result(folder / FREE_ROCKING) if not own or (folder / FREE_ROCKING).exists() else None
    environment = templates(Path(__file__).parent)
    sections = [*(own_sections if own else caryatid_sections)(scenes), *(restitution_sections(free) if free else ())]
    read = {main: scenes} | ({FREE_ROCKING: free} if free else {})
    stored = study_sections(studies)
    html = environment.get_template("page.html").render(
        motion=scenes.settings["motion"]["label"] if scenes.settings["motion"] else "none",
        own=own,
        subject=_subject(scenes) if own else CARYATID_WORDS,
        summary=summary(scenes, variant_groups(free) if free else []),
        verdicts=[verdict for section in stored for verdict in section.verdicts],
        sections=sections,
        studies=stored,
        provenance=_provenance(scenes, free),
        ages=[f"{name} is {text}" for name, text in ((name, age(result)) for name, result in read.items()) if text],
        files=[file for name in read for file in (name, name.replace(".json", ".npz"))],
    )
    path = folder / PAGE
    path.write_text(html, encoding="utf-8")
    return path


def _subject(scenes):
    """What the page is about, in words."""
    return " and ".join(scene["name"] for scene in scenes.settings["scenes"].values())


def _provenance(scenes, free):
    """Versions, machine and settings: how to obtain the same numbers."""
    origin = scenes.provenance
    machine = origin["machine"]
    commit = (
        "outside a checkout"
        if origin["commit"] is None
        else origin["commit"][:12] + (", with uncommitted changes" if origin["dirty"] else "")
    )
    rows = [
        ["computed", origin["time"]],
        ["commit", commit],
        ["processor", machine["processor"]],
        ["cores (physical, logical)", f"{machine['cores']}, {machine['logical_cores']}"],
        ["memory [GiB]", str(machine["memory_gib"])],
        ["system", machine["system"]],
        ["Python", origin["python"]],
    ]
    rows += [[name, origin["packages"].get(name) or "not installed"] for name in PACKAGES]
    settings = {}
    for row in [*scenes.rows, *(free.rows if free else ())]:
        if row.get("settings") is not None:
            settings[row["solver"], row["variant"]] = row["settings"]
    listed = [
        [f"{solver}, {variant}", ", ".join(f"{key} = {value}" for key, value in chosen.items())]
        for (solver, variant), chosen in settings.items()
    ]
    decides = [
        [f"{solver}, {variant}", kind["rung"], kind["decides"]]
        for solver, variants in (free or scenes).settings["variants"].items()
        for variant, kind in variants.items()
    ]
    return Section(
        "Versions, machine, settings",
        (),
        (
            Table("What each engine decides by itself", ("engine, variant", "set up as", "what"), decides),
            Table("Versions and machine", ("what", "value"), rows),
            Table("Settings of each solver and variant (SI units)", ("solver", "settings"), listed),
        ),
    )
