"""A lesson as a marimo notebook: its file, and the contents of its cells.

`mo` is the module marimo, which only notebooks import. Notebooks kept by users import this module by its name.
"""

import contextlib
import importlib.util
import inspect
import re
import subprocess
import sys
import textwrap
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from analytic.errors import SettingError

from ..execution.progress import say
from ..execution.writing import TemporaryFolder, write_all
from ..plotting import diagrams
from ..plotting.parts import templates
from ..schemas.columns import number
from .lesson import Exercise, Lesson, View, svg
from .topics import lesson

PAGES = Path(__file__).parent / "pages"
# Cells run when the notebook opens; by default marimo does not run them.
SETTINGS = "[tool.marimo.runtime]\nauto_instantiate = true\n"
# Colours for the stand-ins of `lesson` in a notebook, light or dark.
COLOURS = (
    "--ink: currentColor; --soft: #8a867e; --grid: #88888844; --panel: #ffffff; --model: #2b8fd0; --ghost: #e0701a; "
    "--third: #1a9a78; --stone: #c9bea3; --stands: #c4c0b7"
)


def code_of(lesson: Lesson) -> str:
    """Return the code of a lesson for a cell: the body of its `code`, whose last line shows what `code` returns."""
    body = inspect.getsource(lesson.code).partition("\n")[2]
    return re.sub(r"^return ", "", textwrap.dedent(body).rstrip(), flags=re.MULTILINE)


def notebook_of(lesson: Lesson) -> str:
    """Return the notebook of a lesson, a Python file for marimo."""
    return templates(PAGES).get_template("notebook.py.jinja").render(lesson=lesson, code=code_of(lesson))


def open_notebook(name: str, to: str | None = None) -> int:
    """Open the notebook of a lesson in the browser with marimo. Return marimo's exit status when it ends.

    Parameters
    ----------
    name : str
        Name of the lesson.
    to : str or None
        Folder that keeps the notebook; one that is there is opened as it is. None: it is removed when marimo ends.

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
        say(f"the notebook is {file}" + ("; it is removed at the end: keep it with --to FOLDER" if to is None else ""))
        return subprocess.call([sys.executable, "-m", "marimo", "edit", str(file.absolute())])  # "-" is no option


def written(value: float | str, unit: str = "", digits: int = 4) -> str:
    """Return a number with its unit, or a word; digits 0: a whole number."""
    if isinstance(value, str):
        return value
    text = str(value) if isinstance(value, int) else f"{value:.0f}" if digits == 0 else number(float(value), digits)
    return f"{text} {unit}".rstrip()


def answer(exercise: Exercise) -> str:
    """Compute the answer to an exercise, in words."""
    return written(exercise.compute(), exercise.unit, exercise.digits)


def opening(lesson: Lesson, mo: Any) -> Any:
    """Return title, question, drawing, equations, symbols, and what to guess."""
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
    """Return the controls as an array of marimo's elements; its value is the arguments of `Lesson.view`."""
    elements = []
    for control in lesson.controls:
        if control.in_words:
            elements.append(mo.ui.radio(list(control.values), value=control.start, label=control.label, inline=True))
        else:
            label = f"{control.label} [{control.unit}]" if control.unit else control.label
            elements.append(mo.ui.slider(steps=list(control.values), value=control.start, label=label, show_value=True))
    return mo.ui.array(elements)


def place(lesson: Lesson, values: Sequence[float | str], mo: Any) -> Any:
    """Return picture and numbers of the lesson at these values of its controls."""
    return shown(lesson.view(*values), mo)


def shown(view: View, mo: Any) -> Any:
    """Return picture and numbers of a view."""
    numbers = [mo.stat(written(value, unit), label=label) for label, (value, unit) in view.numbers.items()]
    picture = (
        f'<div style="{COLOURS}; max-width: 38rem" role="img" aria-label="{view.says}">{svg(view.figure, "n")}</div>'
    )
    return mo.vstack([mo.Html(picture), mo.hstack(numbers, justify="start", wrap=True)])


def closing(lesson: Lesson, mo: Any) -> Any:
    """Return common errors, and the exercises with their answers folded away."""
    wrong = "\n".join(f"- {text}" for text in lesson.wrong)
    folded = {exercise.question: mo.md(f"**{answer(exercise)}** – {exercise.because}") for exercise in lesson.exercises}
    example = lesson.example() if lesson.example else None
    parts = [mo.md(f"**{lesson.example_head}.** {example.says}"), shown(example, mo)] if example else []
    parts += [mo.md(f"## What goes wrong\n\n{wrong}\n\n## Exercises"), mo.accordion(folded)]
    if lesson.table:
        table = lesson.table()
        parts.append(
            mo.ui.table([dict(zip(table.columns, row, strict=True)) for row in table.rows], label=table.caption)
        )
    return mo.vstack(parts)
