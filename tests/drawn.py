"""What pages show of a small fixed set of made-up rows; `python tests/drawn.py` renews it and prints what changed.

Rows are in tests/comparisons/report/rows: NAME.json of each study, and a folder of the own runs of each report. They
hold the cases that a page treats differently (good, fair and bad variants, runs that failed or were not made, an engine
timed on another processor), and neither age nor origin. The text is kept itself, not its digest: it is as small as the
rows, and a change of a cell is seen as one, here and in a diff.
"""

import difflib
import json
import re
import shutil
import sys
import zlib
from contextlib import contextmanager
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from tempfile import TemporaryDirectory
from unittest.mock import patch

import numpy as np

from comparisons.execution.results import Result
from comparisons.report.write import write_page
from engines import ENGINES

FOLDER = Path(__file__).parent / "comparisons" / "report"
ROWS, PAGES = FOLDER / "rows", FOLDER / "pages"
WITH_STUDIES = "caryatid"  # the report that shows them, too
APART = ("speed-error", "pybullet")  # timed on another processor
OLD = {"sensitivity": "older than the code: computed on another day"}
MACHINE = {"processor": "one", "cores": 2, "logical_cores": 4, "memory_gib": 8.0, "system": "a system"}
ORIGIN = {"time": "2030-01-02T03:04:05", "commit": 40 * "1", "dirty": False, "machine": MACHINE, "python": "3.11"}
ORIGIN |= {"packages": {"numpy": "2.0"}, "sources": {}, "seed": 3}
# What the report has of studies stands on their pages too; its formulas are tests/comparisons/lessons/test_lesson.py's.
ELSEWHERE = re.compile('<section id="(?!answer|decision|earthquake|method|part).*?</section>', re.DOTALL)
DRAWN = ("svg", "math")
MOST = 5000  # characters of a line; what is longer is what a script reads
SAID = ("href", "title", "aria-label", "data-says", "data-copies")


class Words(HTMLParser):
    """The words of a page by lines: of each piece, cell and tooltip one; of a picture a digest."""

    def __init__(self, html):
        super().__init__()
        self.lines, self.shapes, self.depth, self.hidden = [], [], 0, False
        self.feed(html)

    def handle_starttag(self, tag, attrs):
        given = dict(attrs)
        self.hidden = tag == "style" or tag == "script" and "id" not in given
        self.depth += tag in DRAWN
        self.lines += [f"[{name}] {given[name]}" for name in SAID if given.get(name)]
        if tag == "td" and given.get("class"):
            self.lines.append(f"<{given['class']}>")
        if self.depth:
            self.shapes.append(f"{tag} {given}")

    def handle_endtag(self, tag):
        self.hidden = False
        self.depth -= tag in DRAWN
        if tag in DRAWN and not self.depth:
            self.lines.append(f"[drawn] {len(self.shapes)} shapes, {zlib.crc32(repr(self.shapes).encode()):08x}")
            self.shapes.clear()

    def handle_data(self, data):
        words = " ".join(data.split())
        if words and not self.hidden:
            self.lines.append(words if len(words) < MOST else f"[data] {zlib.crc32(words.encode()):08x}")


def made(file):
    """The `Result` of the made-up rows in a file."""
    content = json.loads(file.read_text(encoding="utf-8"))
    arrays = {key: np.array(values) for key, values in content["arrays"].items()}
    arrays = {key: array.astype(float) if array.dtype == object else array for key, array in arrays.items()}
    engines = {row.get("engine") for row in content["rows"]} & ENGINES.keys()
    apart = {"machine": MACHINE | {"processor": "another"}}
    origins = {one: ORIGIN | (apart if (file.stem, one) == APART else {}) for one in ENGINES if one in engines}
    return Result(content["kind"], content["settings"], content["rows"], ORIGIN | {"engines": origins}, arrays)


@contextmanager
def made_up():
    """Read made-up rows in place of stored results; one study is old, whatever the code is."""
    with (
        patch("comparisons.report.answer.results_in", lambda folder: [one.with_suffix("") for one in listed(folder)]),
        patch("comparisons.report.answer.read_study", lambda path: made(path.with_suffix(".json"))),
        patch("comparisons.report.answer.age", lambda result: OLD.get(result.kind)),
        patch("comparisons.report.write.read_result", made),
        patch("comparisons.report.write.age", lambda result: None),
    ):
        yield


def listed(folder):
    return sorted(folder.glob("*.json"))


def write_all(place):
    """Write the pages of each report into a folder of its name in `place`."""
    with made_up():
        for report in filter(Path.is_dir, ROWS.iterdir()):
            shutil.copytree(report, Path(place, report.name))
            write_page(Path(place, report.name), ROWS if report.name == WITH_STUDIES else report / "none")


@cache
def drawn():
    """{name: text} of all pages."""
    found = {}
    with TemporaryDirectory() as place:
        write_all(place)
        for page in Path(place).rglob("*.html"):
            name = "-".join(page.relative_to(place).with_suffix("").parts).replace("-pages", "")
            shown = ELSEWHERE.sub("", page.read_text(encoding="utf-8"))
            found[name.removeprefix(f"{WITH_STUDIES}-")] = "\n".join(Words(shown).lines) + "\n"
    return found


def renew():
    """Write what is drawn now; returns what changed, a line for each piece and cell."""
    kept = {file.stem: file.read_text(encoding="utf-8") for file in PAGES.glob("*.txt")}
    changed = []
    for name in sorted(kept.keys() | drawn().keys()):
        old, new = kept.get(name, ""), drawn().get(name, "")
        changed += difflib.unified_diff(old.splitlines(), new.splitlines(), name, name, lineterm="", n=1)
        file = PAGES / f"{name}.txt"
        file.write_text(new, encoding="utf-8") if new else file.unlink()
    return changed


if __name__ == "__main__":
    sys.stdout.write("\n".join(renew()) + "\n")
