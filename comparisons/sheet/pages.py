"""The sheet as files: a page a problem in Markdown and HTML, the record, and a table of all reference answers."""

import re
from html import escape
from pathlib import Path
from typing import Any

from markdown_it import MarkdownIt
from markupsafe import Markup

from analytic import SampledMotion

from ..running.files import write_all
from ..showing.parts import templates
from ..showing.wording import indexed
from .problems import DAMPING, PERIOD, PROBLEMS, SCALES, TOLERANCE, UNITS, VERSION, Problem, record

TEMPLATES = templates(Path(__file__).parent / "templates")
TITLE = "Rocking blocks: reference problems for other codes"
POWER = re.compile(r"(?<![\w.])(\d+(?:\.\d+)?)e([-+]?)0*(\d+)(?!\w)")
ANSWERS, RECORD_FILE = "reference.csv", "record.csv"


def write_sheet(folder: Path) -> list[Path]:
    """Write the sheet into `folder`; returns the paths written, the first to be read first.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     [path.name for path in write_sheet(Path(folder))][:3]
    ['index.md', 'index.html', 'reference.csv']
    """
    index = {
        kind: _text("index", kind=kind, title=TITLE, version=VERSION, problems=PROBLEMS, answers=ANSWERS)
        for kind in ("md", "html")
    }
    files = {
        "index.md": index["md"],
        "index.html": _html(TITLE, index["html"]),
        ANSWERS: _answers(),
        f"inputs/{RECORD_FILE}": _record(),
    }
    for problem in PROBLEMS:
        text = markdown(problem)
        files |= {f"{problem.name}.md": text, f"{problem.name}.html": _html(problem.title, text)}
    return write_all(folder, files)


def markdown(problem: Problem) -> str:
    """The page of a problem as Markdown."""
    return _text(
        "problem",
        problem=problem,
        recorded=isinstance(problem.scene.motion, SampledMotion),
        record_file=RECORD_FILE,
        period=PERIOD,
        damping=DAMPING,
        units=UNITS,
        scales=SCALES,
        tolerance=TOLERANCE,
    )


def _text(name: str, **values: Any) -> str:
    return TEMPLATES.get_template(f"{name}.md.jinja").render(**values)


def _html(title: str, text: str) -> str:
    """A page in Markdown as HTML, readable without anything else."""
    body = POWER.sub(_power, indexed(MARKDOWN.render(text)))
    body = body.replace("<table>", '<div class="scroll" tabindex="0"><table>').replace("</table>", "</table></div>")
    return TEMPLATES.get_template("page.html").render(title=title, body=Markup(body)) + "\n"


def _power(found):
    """1e-20 as one writes it, to all its digits."""
    mantissa, sign, exponent = found.groups()
    return f"{'' if mantissa == '1' else mantissa + '·'}10<sup>{'−' if sign == '-' else ''}{exponent}</sup>"


def _equations(renderer, tokens, place, options, environment):
    """Lines of code are equations here."""
    lines = tokens[place].content.splitlines()
    return "".join(f'<p class="equation">{escape(line)}</p>\n' for line in lines if line)


MARKDOWN = MarkdownIt().enable("table")
MARKDOWN.add_render_rule("code_block", _equations)


def _answers():
    lines = [
        f"{problem.name},{one.name},{UNITS[one.kind]},{problem.answers[one.name]},{problem.tolerance(one) or ''}"
        for problem in PROBLEMS
        for one in problem.quantities
    ]
    return "\n".join(["scene,quantity,unit,answer,tolerance", *lines]) + "\n"


def _record():
    motion = record()
    rows = (f"{k * motion.dt:.3f},{value!r}" for k, value in enumerate(motion.samples.tolist()))
    return "\n".join(["time [s],acceleration [m/s2]", *rows]) + "\n"
