"""Generated parts of the READMEs: the report's first screen, its charts, the origin of each result.

``python -m comparisons.report.gallery`` writes them anew from the stored results.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from textwrap import wrap
from typing import Any
from xml.etree import ElementTree

from engines import ENGINES

from ..execution.by_solver import by_engine, checked, date_of, held, results_in
from ..execution.results import PROJECT_FOLDER, RESULTS, Result
from ..execution.writing import write, write_all
from ..plotting.charts import alone
from ..schemas.columns import spelled, spelled_page
from ..studies.rows import read_study
from .answer import LEVEL, Stored, commit_of, judgements_of, screen, setups_of, shown, stored_studies, variants_of

GALLERY, README = Path(__file__).with_name("gallery"), PROJECT_FOLDER / "README.md"
RESULTS_README = RESULTS / "README.md"
BEGIN, END = "<!-- findings of the stored studies -->", "<!-- end of findings -->"
CLAIMED = "<!-- claims and the stored runs behind them -->"
# (claim, result, command, its minutes on two cores); runs under records are not stored and are repeated as a whole
CLAIMS = (
    ("restitution at impacts", "restitution", "study restitution --check 30", "< 1"),
    ("outcomes under pulses", "overturning", "study overturning --check 30", "< 1"),
    ("outcomes under recorded earthquakes", "recorded", "study recorded", "25"),
    ("outcomes under synthetic earthquakes", "fragility", "study fragility --check 30", "< 1"),
    ("real blocks, outcomes under shake-table motions", "shake-table", "study shake-table --data FOLDER", "90"),
    ("drawn statues: levels, outcomes with sliding", "statues", "study statues --check 30", "1"),
    ("two stacked blocks", "stack", "study stack --check 30", "< 1"),
    ("hard cases", "stability", "study stability --check 30", "< 1"),
    ("cost", "speed-error", "study speed-error --check 30", "< 1"),
)
ALT = {
    "costs": "Error of peak tilt over CPU time of every solver",
    "endings": "Share of runs that differ from the model or fail",
}


def gallery(first: Mapping[str, Any]) -> dict[str, str]:
    """Return {file name: SVG} of the charts of a first screen (`answer.screen`), for a wide page."""
    charts = {name: first[name] for name in ("costs", "endings") if first[name]}
    files = {}
    for name, picture in charts.items():
        wide, *_ = ElementTree.fromstring(f"<both>{spelled_page(picture.element)}</both>")
        files[f"{name}.svg"] = alone(ElementTree.tostring(wide[0], encoding="unicode"))
    return files


def first_screen(stored: Sequence[Stored]) -> dict[str, Any]:
    """Return the report's first screen from stored results alone."""
    judgements = judgements_of(stored)
    columns = setups_of(variants_of(stored), judgements)
    return screen(columns, judgements, [study.glance for study in stored if study.glance])


def headlines(first: Mapping[str, Any]) -> str:
    """Return the first screen as Markdown: its title, the answers, its charts, and the recommendation."""
    charts = " ".join(f"![{ALT[name]}](comparisons/report/gallery/{name}.svg)" for name in ALT if first[name])
    said = [f"- **{line.subject}:** {line.answer}" for line in first["lines"] if line.subject != LEVEL]  # see the table
    items = [
        *wrap(first["title"], 120),
        "",
        *(words for each in said for words in wrap(each, 120, subsequent_indent="  ")),
    ]
    return spelled(
        "\n".join((*items, "", charts, *(line for advised in first["advice"] for line in _markdown(advised))))
    )


def _markdown(table):
    """Return a table as lines of Markdown, with its caption above."""
    rows = [table.columns, ["---"] * len(table.columns), *table.rows]
    return ["", *wrap(f"{table.caption}:", 120), "", _lines(rows)]


def _lines(rows):
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


def claims(stored: Sequence[Stored], results: Mapping[str, Result]) -> str:
    """Return a table, in Markdown, of what checks each claim: runs of all solvers, outcomes compared, those left out.

    Outcomes compared are those of the first screen: of subject engines, away from outcome boundaries.
    """
    setups = setups_of(variants_of(stored), judgements_of(stored))
    judged = {study.name: shown(study.glance.endings, setups) for study in stored if study.glance}
    rows = [["claim", "runs", "outcomes compared", "left out near a boundary", "command", "minutes"], ["---"] * 6]
    for claim, name, command, minutes in CLAIMS:
        shares = judged.get(name)
        counts = [sum(share.runs for share in shares), sum(share.left_out for share in shares)] if shares else ["–"] * 2
        rows.append([claim, *map(str, (results[name].run_count, *counts)), f"`rocking {command}`", minutes])
    return _lines(rows)


def origins(results: Mapping[str, Result]) -> str:
    """Return a table, in Markdown, of the origin of results {name: result}."""
    rows = [["result", "computed", "commit", "processor, cores, memory", "engines", "runs that held when repeated"]]
    rows += [["---"] * len(rows[0])]
    for name, result in results.items():
        engines = sorted({row["engine"] for row in result.rows if row.get("engine") in ENGINES})
        last = checked(result)
        again = f"{held(last)}, {last['date']}" if last else "none"
        cells = (by_engine(result, words) for words in (date_of, commit_of, _machine))
        rows.append([f"`{name}`", *cells, ", ".join(engines) or "none", again])
    return _lines(rows)


def _machine(origin):
    machine = origin["machine"]
    return f"{machine['processor']}, {machine['logical_cores']}, {machine['memory_gib']:g} GiB"


def with_findings(readme: str, words: str, mark: str = BEGIN) -> str:
    """Return the text of a README with these words between a mark and the end after it."""
    before, begin, rest = readme.partition(mark)
    _, end, after = rest.partition(END)
    return f"{before}{begin}\n{words}\n{end}{after}"


if __name__ == "__main__":
    # read all results before writing: an unreadable one must not leave a README without its rows
    results = {path.name: read_study(path) for path in results_in(RESULTS)}
    stored = stored_studies()
    first = first_screen(stored)
    parts = (
        (README, headlines(first), BEGIN),
        (README, claims(stored, results), CLAIMED),
        (RESULTS_README, origins(results), BEGIN),
    )
    for readme, words, mark in parts:
        write(readme, with_findings(readme.read_text(encoding="utf-8"), words, mark))
    write_all(GALLERY, gallery(first))
