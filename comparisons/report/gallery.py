"""What the README shows of the studies' stored results, four small figures and what they found in words.

``python -m comparisons.report.gallery`` makes both anew.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING
from xml.etree import ElementTree

from ..running.provenance import PROJECT_FOLDER, RESULTS, read_result
from ..showing.charts import alone
from ..studies import get_study

if TYPE_CHECKING:
    from ..showing.parts import Section

GALLERY, README = Path(__file__).with_name("gallery"), PROJECT_FOLDER / "README.md"
BEGIN, END = "<!-- findings of the stored studies -->", "<!-- end of findings -->"
HEADLINES = ("restitution", "random-scenes", "overturning", "matters", "speed-error")
PANELS = {"restitution": 0, "overturning": -1, "matters": 0, "speed-error": -1}  # study: which panel of its finding


def stored(studies: Path = RESULTS) -> dict[str, Section]:
    """{study: its finding}, of those in `HEADLINES` whose result lies in `studies`.

    Raises
    ------
    ResultError
        A result file is damaged.
    """
    pages = {
        name: get_study(name).page(read_result(file)).opening()
        for name in HEADLINES
        if (file := studies / f"{name}.json").exists()
    }
    return {name: opening for name, opening in pages.items() if opening is not None}


def gallery(found: Mapping[str, Section]) -> dict[str, str]:
    """{name of a file: SVG} of findings as `stored` has them."""
    made = {}
    for name in PANELS.keys() & found.keys():
        (picture,) = found[name].figures
        panels = ElementTree.fromstring(f"<panels>{picture.svg.decode()}</panels>")
        made[f"{name}.svg"] = alone(ElementTree.tostring(panels[PANELS[name]], encoding="unicode"))
    return made


def headlines(found: Mapping[str, Section]) -> str:
    """What was found, a Markdown list."""
    lines = []
    for section in found.values():
        subject, _, words = section.title.partition(": ")
        lines.append(f"- **{subject}**: {words}.")
    return "\n".join(lines)


def with_findings(readme: str, words: str) -> str:
    """The README's text with these words between its marks."""
    before, begin, rest = readme.partition(BEGIN)
    _, end, after = rest.partition(END)
    return f"{before}{begin}\n{words}\n{end}{after}"


if __name__ == "__main__":
    found = stored()
    README.write_text(with_findings(README.read_text(encoding="utf-8"), headlines(found)), encoding="utf-8")
    GALLERY.mkdir(exist_ok=True)
    for name, svg in gallery(found).items():
        (GALLERY / name).write_text(svg, encoding="utf-8")
