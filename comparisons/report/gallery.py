"""What the README shows of the studies' stored results, four small figures and what they found in words.

``python -m comparisons.report.gallery`` makes both anew.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from textwrap import wrap
from xml.etree import ElementTree

from ..running.provenance import PROJECT_FOLDER, RESULTS, read_result
from ..showing.charts import alone
from .answer import paragraph, setups_of
from .studies import Stored, stored_studies, variants_of

GALLERY, README = Path(__file__).with_name("gallery"), PROJECT_FOLDER / "README.md"
BEGIN, END = "<!-- findings of the stored studies -->", "<!-- end of findings -->"
PANELS = {"restitution": 0, "overturning": -1, "sensitivity": 0, "speed-error": -1}  # study: which panel of its finding


def gallery(stored: Iterable[Stored]) -> dict[str, str]:
    """{name of a file: SVG} of the findings of the studies in `PANELS`."""
    made = {}
    for one in stored:
        if one.name in PANELS and one.finding is not None:
            (picture,) = one.finding.figures
            panels = ElementTree.fromstring(f"<panels>{picture.svg.decode()}</panels>")
            made[f"{one.name}.svg"] = alone(ElementTree.tostring(panels[PANELS[one.name]], encoding="unicode"))
    return made


def headlines(stored: Sequence[Stored]) -> str:
    """The report's first table and its paragraph as Markdown."""
    judgements = [each for one in stored for each in one.judgements]
    columns = [one for one in setups_of(variants_of(stored), judgements) if one.in_first_table]
    rows = [["", *(f"{one.engine}, {one.tier}" for one in columns)], ["---"] + ["---:"] * len(columns)]
    rows += [["rating", *(one.rating.words for one in columns)]]
    rows += [[each.heading, *(one.marks[each.heading].words for one in columns)] for each in judgements]
    lines = [f"| {' | '.join(row)} |" for row in rows]
    return "\n".join((*lines, "", *wrap(paragraph(columns, judgements), 120)))


def with_findings(readme: str, words: str) -> str:
    """The README's text with these words between its marks."""
    before, begin, rest = readme.partition(BEGIN)
    _, end, after = rest.partition(END)
    return f"{before}{begin}\n{words}\n{end}{after}"


if __name__ == "__main__":
    for file in RESULTS.glob("*.json"):
        read_result(file)  # one that cannot be read must not leave the README without its rows
    found = stored_studies()
    README.write_text(with_findings(README.read_text(encoding="utf-8"), headlines(found)), encoding="utf-8")
    GALLERY.mkdir(exist_ok=True)
    for name, svg in gallery(found).items():
        (GALLERY / name).write_text(svg, encoding="utf-8")
