"""What the README shows of the studies' stored results, four small figures and what they found in words, and where
each result comes from, for the README beside them.

``python -m comparisons.report.gallery`` makes all of it anew.
"""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from textwrap import wrap
from xml.etree import ElementTree

from engines import ENGINES

from ..running.age import by_engine, date_of
from ..running.files import write, write_all
from ..running.provenance import PROJECT_FOLDER, RESULTS, Result
from ..showing.charts import alone
from ..studies.rows import read_study
from .answer import Stored, commit_of, paragraph, setups_of, stored_studies, variants_of

GALLERY, README = Path(__file__).with_name("gallery"), PROJECT_FOLDER / "README.md"
RESULTS_README = RESULTS / "README.md"
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


def origins(results: Mapping[str, Result]) -> str:
    """Where results {name: result} come from, as a table in Markdown."""
    rows = [["result", "computed", "commit", "processor, cores, memory", "engines", "runs that held when done again"]]
    rows += [["---"] * len(rows[0])]
    for name, result in results.items():
        origin = result.provenance
        engines = sorted({row["engine"] for row in result.rows if row.get("engine") in ENGINES})
        last = origin.get("check")
        held = f"{last['held']} of {last['runs']}, {last['date']}" if last else "none"
        told = (by_engine(origin, words) for words in (date_of, commit_of, _machine))
        rows.append([f"`{name}`", *told, ", ".join(engines) or "none", held])
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


def _machine(origin):
    machine = origin["machine"]
    return f"{machine['processor']}, {machine['logical_cores']}, {machine['memory_gib']:g} GiB"


def with_findings(readme: str, words: str) -> str:
    """The text of a README with these words between its marks."""
    before, begin, rest = readme.partition(BEGIN)
    _, end, after = rest.partition(END)
    return f"{before}{begin}\n{words}\n{end}{after}"


if __name__ == "__main__":
    # one that cannot be read must not leave the README without its rows
    results = {file.stem: read_study(file) for file in sorted(RESULTS.glob("*.json"))}
    found = stored_studies()
    for readme, words in ((README, headlines(found)), (RESULTS_README, origins(results))):
        write(readme, with_findings(readme.read_text(encoding="utf-8"), words))
    write_all(GALLERY, gallery(found))
