"""The sheet as files: a page a problem in HTML and Markdown, the record, and an empty file for the answers."""

from __future__ import annotations

from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

from .problems import PROBLEMS, VERSION, record
from .statement import RECORD_FILE, UNITS, scale_words, statement

if TYPE_CHECKING:
    from .problems import Problem

TITLE = "Rocking blocks: problems for a code to be held against"
ANSWERS = "answers.csv"
COLUMNS = ("scene", "quantity", "value")
HEADS = {"rows": ("symbol", "value", "meaning"), "asked": ("quantity", "unit", "meaning", "scale of its error")}
INTRODUCTION = (
    "Each page states one problem completely. Solve those that your code can, and write the answers into answers.csv.",
    "answers.csv has three columns, parted by commas, with a head: scene (the name of a page), quantity (its name in "
    "the page's last table) and value (a number in the unit of that table with a decimal point, or a word). A line "
    "without a value is a question not answered; lines that begin with # are not read. The order is free.",
    "The error of an answer is its difference from the exact one over the scale in the page's last table; of a page it "
    "is the largest. The exact answers are known to 1e-10 of these scales, so give ten digits or more.",
)
STYLE = """
body { font: 16px/1.45 system-ui, sans-serif; max-width: 46rem; margin: 2rem auto; padding: 0 1rem; color: #1a1a1a }
table { border-collapse: collapse; margin: .6rem 0 } td, th { padding: .1rem .8rem .1rem 0; text-align: left }
th { border-bottom: 1px solid #999 } .equation { margin: .3rem 2rem; font-family: Cambria, Georgia, serif }
@media print { body { font-size: 10.5pt; margin: 0 } }
"""


def write_sheet(folder: Path) -> list[Path]:
    """Write the sheet into `folder`, which exists; returns the paths written, the first to be read first.

    Answers that are there already are kept.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     [path.name for path in write_sheet(Path(folder))][:3]
    ['index.md', 'index.html', 'answers.csv']
    """
    files = {
        "index.md": _index_markdown(),
        "index.html": _html(TITLE, _index_html()),
        ANSWERS: _empty_answers(),
        f"inputs/{RECORD_FILE}": _record(),
    }
    for problem in PROBLEMS:
        files[f"{problem.name}.md"] = markdown(problem)
        files[f"{problem.name}.html"] = html(problem)
    if (folder / ANSWERS).exists():
        del files[ANSWERS]
    (folder / "inputs").mkdir(exist_ok=True)
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8")
    return [folder / name for name in files]


def markdown(problem: Problem) -> str:
    """The page of a problem as Markdown."""
    pieces = [f"# {problem.title}", f"Scene `{problem.name}`"]
    for part in statement(problem):
        if part.kind == "rows":
            pieces.append(_markdown_table(HEADS["rows"], part.content))
        else:
            pieces.append(str(part.content) if part.kind == "text" else f"    {part.content}")
    pieces += ["## Asked for", _markdown_table(HEADS["asked"], _asked(problem))]
    return "\n\n".join(pieces) + "\n"


def html(problem: Problem) -> str:
    """The page of a problem as HTML, readable without anything else."""
    pieces = [f"<h1>{escape(problem.title)}</h1>", f"<p>Scene <code>{problem.name}</code></p>"]
    for part in statement(problem):
        if part.kind == "rows":
            pieces.append(_html_table(HEADS["rows"], part.content))
        else:
            kind = ' class="equation"' if part.kind == "equation" else ""
            pieces.append(f"<p{kind}>{escape(str(part.content))}</p>")
    pieces += ["<h2>Asked for</h2>", _html_table(HEADS["asked"], _asked(problem))]
    return _html(problem.title, pieces)


def _asked(problem):
    return [(one.name, UNITS[one.kind], one.words, scale_words(problem, one.kind)) for one in problem.quantities]


def _index_markdown():
    pages = "\n".join(f"- [{one.title}]({one.name}.md) (`{one.name}`)" for one in PROBLEMS)
    return "\n\n".join([f"# {TITLE}", f"Version {VERSION}", *INTRODUCTION, pages]) + "\n"


def _index_html():
    pages = "".join(f'<li><a href="{one.name}.html">{escape(one.title)}</a> ({one.name})</li>' for one in PROBLEMS)
    paragraphs = "".join(f"<p>{escape(text)}</p>" for text in (f"Version {VERSION}", *INTRODUCTION))
    return [f"<h1>{TITLE}</h1>", paragraphs, f"<ul>{pages}</ul>"]


def _empty_answers():
    lines = [f"# problem sheet, version {VERSION}", ",".join(COLUMNS)]
    lines += [f"{problem.name},{one.name}," for problem in PROBLEMS for one in problem.quantities]
    return "\n".join(lines) + "\n"


def _record():
    motion = record()
    rows = (f"{k * motion.dt:.3f},{value!r}" for k, value in enumerate(motion.samples.tolist()))
    return "\n".join(["time [s],acceleration [m/s2]", *rows]) + "\n"


def _markdown_table(heads, rows):
    def line(cells):
        return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"

    return "\n".join([line(heads), "|---" * len(heads) + "|", *map(line, rows)])


def _html_table(heads, rows):
    def line(cells, tag):
        return "<tr>" + "".join(f"<{tag}>{escape(cell)}</{tag}>" for cell in cells) + "</tr>"

    return f"<table>{line(heads, 'th')}{''.join(line(row, 'td') for row in rows)}</table>"


def _html(title, pieces):
    head = f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>{escape(title)}</title>'
    return f"{head}<style>{STYLE}</style></head>\n<body>\n" + "\n".join(pieces) + "\n</body></html>\n"
