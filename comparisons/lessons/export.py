"""A lesson as a notebook (`mo` is the module marimo, which only notebooks import), and the pages that one can open
without a network: `export_pages`.
"""

import contextlib
import importlib.util
import inspect
import json
import re
import subprocess
import sys
import textwrap
from collections.abc import Callable, Sequence
from os import PathLike
from pathlib import Path
from typing import Any

from jinja2 import Environment
from markupsafe import Markup

from analytic.errors import SettingError

from ..running.files import TemporaryFolder, write_all
from ..running.progress import say
from ..showing import diagrams
from ..showing.mathml import mathml, prose
from ..showing.parts import number, templates
from .lesson import LICENCE, Exercise, Lesson, View, downloads, svg
from .playground import PAGE, playground_page
from .topics import lesson, lessons

OTHERS = (("index.html", "Lessons"), ("derivations.html", "Derivation"), ("teacher.html", "For teachers"))


def export_pages(
    folder: str | PathLike[str], progress: Callable[[int, int], object] = lambda done, total: None
) -> list[Path]:
    """Write playground, lessons, derivation and teacher's page into `folder`; returns their paths.

    progress : called with the number of lessons done and of all lessons.
    """
    environment, chosen = _environment(), lessons()
    drawings = {name: Markup(getattr(diagrams, name)()) for name in ("rocking", "impact", "isolated")}
    files: dict[str, str | bytes] = {
        PAGE: playground_page(OTHERS),
        "index.html": environment.get_template("index.html").render(lessons=chosen),
        "derivations.html": environment.get_template("derivations.html").render(**drawings),
    }
    exercises, firsts = [], []
    for done, one in enumerate(chosen):
        progress(done, len(chosen))
        exercises.append([(exercise, answer(exercise)) for exercise in one.exercises])
        files[f"lesson-{one.number}.html"] = _lesson_page(environment, one, chosen, exercises[-1])
        first = one.first()
        firsts.append(first.says)
        files |= {f"figures/lesson-{one.number}.{kind}": file for kind, file in downloads(first.figure).items()}
    page = environment.get_template("teacher.html")
    files["teacher.html"] = page.render(lessons=chosen, exercises=exercises, firsts=firsts, licence=LICENCE)
    return write_all(folder, files)


def _environment() -> Environment:
    environment = templates(PAGES)
    environment.filters["prose"] = lambda text: Markup(prose(text))
    environment.filters["math"] = lambda tex: Markup(mathml(tex, display=True))
    environment.globals["style"] = Markup(
        "".join(file.read_text(encoding="utf-8") for file in (PAGES / "pages.css", diagrams.STYLE))
    )
    return environment


def _lesson_page(environment: Environment, one: Lesson, chosen: Sequence[Lesson], exercises: list) -> str:
    titles = {other.number: other.title for other in chosen}
    views = [_view_parts(one.view(*values), f"{one.name}-{k}") for k, values in enumerate(one.places())]
    return environment.get_template("lesson.html").render(
        lesson=one,
        count=len(chosen),
        before=titles.get(one.number - 1),
        after=titles.get(one.number + 1),
        code=code_of(one),
        exercises=exercises,
        table=one.table() if one.table else None,
        drawing=one.drawing() if one.drawing else "",
        example=_view_parts(one.example(), f"{one.name}-example") if one.example else None,
        texts=json.dumps([[control.text(value) for value in control.values] for control in one.controls]),
        views=views,
        script=Markup((PAGES / "lesson.js").read_text(encoding="utf-8")),
    )


def _view_parts(view: View, name: str) -> dict:
    """Parts of a view for the template: picture, numbers as (label, value in full, text), and the sentence."""
    numbers = [
        (label, value if isinstance(value, str) else repr(float(value)), written(value, unit))
        for label, (value, unit) in view.numbers.items()
    ]
    return {"svg": Markup(svg(view.figure, name)), "numbers": numbers, "says": view.says}


PAGES = Path(__file__).parent / "pages"
# Cells run when the notebook opens; by default marimo does not run them.
SETTINGS = "[tool.marimo.runtime]\nauto_instantiate = true\n"
# Stand-ins of `lesson` in a notebook, light or dark.
COLOURS = (
    "--ink: currentColor; --soft: #8a867e; --grid: #88888844; --panel: #ffffff; --model: #2b8fd0; --ghost: #e0701a; "
    "--third: #1a9a78; --stone: #c9bea3; --stands: #c4c0b7"
)


def code_of(lesson: Lesson) -> str:
    """The code cell of a lesson: the body of its `code`, whose last line shows the value returned."""
    body = inspect.getsource(lesson.code).partition("\n")[2]
    return re.sub(r"^return ", "", textwrap.dedent(body).rstrip(), flags=re.MULTILINE)


def notebook_of(lesson: Lesson) -> str:
    """The notebook of a lesson in marimo's format, a Python file."""
    return templates(PAGES).get_template("notebook.py.jinja").render(lesson=lesson, code=code_of(lesson))


def open_notebook(name: str, to: str | None = None) -> int:
    """Open the notebook of a lesson in the browser, by marimo; returns its status when it ends.

    Parameters
    ----------
    name : str
        Of the lesson.
    to : str or None
        Folder where the notebook is kept, and from which it is opened again; None: it is removed when marimo ends.

    Raises
    ------
    SettingError
        There is no such lesson, or marimo is not installed.
    """
    text = notebook_of(lesson(name))
    if importlib.util.find_spec("marimo") is None:
        raise SettingError(
            "notebooks need the package marimo: pip install marimo, or this project with .[lessons]; rocking lessons "
            "export writes pages without it"
        )
    with TemporaryFolder("rocking-lesson-") if to is None else contextlib.nullcontext(to) as folder:
        file = Path(folder) / f"{name}.py"
        files = {file.name: text, "pyproject.toml": SETTINGS}
        new = {name: content for name, content in files.items() if not file.with_name(name).exists()}
        write_all(folder, new)  # a student's work is never overwritten
        say(f"the notebook is {file}" + ("; it is removed at the end; --to FOLDER keeps it" if to is None else ""))
        return subprocess.call([sys.executable, "-m", "marimo", "edit", str(file.absolute())])  # "-" is no option


def written(value: float | str, unit: str = "", digits: int = 4) -> str:
    """A number with its unit, or a word; digits 0: a whole number."""
    if isinstance(value, str):
        return value
    text = str(value) if isinstance(value, int) else f"{value:.0f}" if digits == 0 else number(float(value), digits)
    return f"{text} {unit}".rstrip()


def answer(exercise: Exercise) -> str:
    """The answer to an exercise, computed now."""
    return written(exercise.compute(), exercise.unit, exercise.digits)


def opening(lesson: Lesson, mo: Any) -> Any:
    """Title, question, drawing, equations, symbols, and the question to guess."""
    head = [mo.md(f"# {lesson.number}. {lesson.title}\n\n{lesson.question}")]
    if lesson.drawing:
        rules, drawing = diagrams.STYLE.read_text(encoding="utf-8"), lesson.drawing()
        head.append(
            mo.Html(f'<style>{rules}</style><div class="drawing" style="{COLOURS}; max-width: 34rem">{drawing}</div>')
        )
    parts = []
    for equation in lesson.equations:
        place = "".join(rf" \qquad ({part})" for part in equation.number.split(", ") if part)
        parts += [f"$${equation.tex}{place}$$", equation.says]
    symbols = "\n".join(f"- ${symbol}$: {meaning}" for symbol, meaning in lesson.glossary())
    words = [*parts, f"**Symbols**\n\n{symbols}", f"**Guess first.** {lesson.guess}", f"**Then look.** {lesson.look}"]
    return mo.vstack([*head, mo.md("\n\n".join(words))])


def controls(lesson: Lesson, mo: Any) -> Any:
    """The controls as marimo's elements, an array whose value is the argument of `Lesson.view`."""
    made = []
    for control in lesson.controls:
        if control.in_words:
            made.append(mo.ui.radio(list(control.values), value=control.start, label=control.label, inline=True))
        else:
            label = f"{control.label} [{control.unit}]" if control.unit else control.label
            made.append(mo.ui.slider(steps=list(control.values), value=control.start, label=label, show_value=True))
    return mo.ui.array(made)


def place(lesson: Lesson, values: Sequence[float | str], mo: Any) -> Any:
    """Picture and numbers of the lesson at these values of its controls."""
    return shown(lesson.view(*values), mo)


def shown(view: View, mo: Any) -> Any:
    """Picture and numbers of a view."""
    numbers = [mo.stat(written(value, unit), label=label) for label, (value, unit) in view.numbers.items()]
    picture = (
        f'<div style="{COLOURS}; max-width: 38rem" role="img" aria-label="{view.says}">{svg(view.figure, "n")}</div>'
    )
    return mo.vstack([mo.Html(picture), mo.hstack(numbers, justify="start", wrap=True)])


def closing(lesson: Lesson, mo: Any) -> Any:
    """Common errors, and the exercises with their answers folded."""
    wrong = "\n".join(f"- {text}" for text in lesson.wrong)
    folded = {exercise.question: mo.md(f"**{answer(exercise)}** – {exercise.because}") for exercise in lesson.exercises}
    example = lesson.example() if lesson.example else None
    parts = [mo.md(f"**A bad example.** {example.says}"), shown(example, mo)] if example else []
    parts += [mo.md(f"## What goes wrong\n\n{wrong}\n\n## Exercises"), mo.accordion(folded)]
    if lesson.table:
        table = lesson.table()
        parts.append(
            mo.ui.table([dict(zip(table.columns, row, strict=True)) for row in table.rows], label=table.caption)
        )
    return mo.vstack(parts)
