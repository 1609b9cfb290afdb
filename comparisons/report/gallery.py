"""What the README shows of the studies' stored results, four small figures and what they found in words.

``python -m comparisons.report.gallery`` makes both anew.
"""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

from ..running.provenance import PROJECT_FOLDER, read_result
from ..showing.charts import alone
from ..studies import get_study
from .studies import RESULTS

GALLERY, README = Path(__file__).with_name("gallery"), PROJECT_FOLDER / "README.md"
BEGIN, END = "<!-- findings of the stored studies -->", "<!-- end of findings -->"
HEADLINES = ("restitution", "overturning", "fragility", "matters", "speed-error", "stability")
PANELS = {"restitution": 0, "overturning": -1, "matters": 0, "speed-error": -1}  # study: which panel of its finding


def gallery(studies: Path = RESULTS) -> dict[str, str]:
    """{name of a file: SVG} of those figures whose result lies in `studies`.

    Raises
    ------
    ResultError
        A result file is damaged.
    """
    found = {}
    for name, panel in PANELS.items():
        finding = get_study(name).finding
        if finding is None or not (studies / f"{name}.json").exists():
            continue
        (picture,) = finding(read_result(studies / f"{name}.json")).figures
        panels = ElementTree.fromstring(f"<panels>{picture.svg.decode()}</panels>")
        found[f"{name}.svg"] = alone(ElementTree.tostring(panels[panel], encoding="unicode"))
    return found


def findings(studies: Path = RESULTS) -> str:
    """The headlines of the studies' findings, a Markdown list; raises as `gallery`."""
    lines = []
    for name in HEADLINES:
        finding = get_study(name).finding
        if finding is not None and (studies / f"{name}.json").exists():
            subject, _, found = finding(read_result(studies / f"{name}.json")).title.partition(": ")
            lines.append(f"- **{subject}**: {found}.")
    return "\n".join(lines)


def with_findings(readme: str, words: str) -> str:
    """The README's text with these words between its marks."""
    before, begin, rest = readme.partition(BEGIN)
    _, end, after = rest.partition(END)
    return f"{before}{begin}\n{words}\n{end}{after}"


if __name__ == "__main__":
    README.write_text(with_findings(README.read_text(encoding="utf-8"), findings()), encoding="utf-8")
    GALLERY.mkdir(exist_ok=True)
    for name, svg in gallery().items():
        (GALLERY / name).write_text(svg, encoding="utf-8")
