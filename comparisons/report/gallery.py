"""Four small figures for the README, from the studies' stored results: ``python -m comparisons.report.gallery``."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

from ..running.provenance import read_result
from ..showing.charts import alone
from ..studies import get_study
from .studies import RESULTS

GALLERY = Path(__file__).with_name("gallery")
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


if __name__ == "__main__":
    GALLERY.mkdir(exist_ok=True)
    for name, svg in gallery().items():
        (GALLERY / name).write_text(svg, encoding="utf-8")
