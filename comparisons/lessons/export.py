"""The pages that one can open without a network: `export_pages`."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from os import PathLike
from pathlib import Path

from jinja2 import Environment
from markupsafe import Markup

from ..showing import diagrams
from ..showing.mathml import mathml, prose
from ..showing.templates import templates
from .drawing import LICENCE, download, svg
from .lesson import Lesson, View
from .notebook import PAGES, answer, code_of, written
from .playground import PAGE, playground_page
from .topics import NAMES, lesson

OTHERS = (("index.html", "Lessons"), ("derivations.html", "Derivation"), ("teacher.html", "For teachers"))


def export_pages(
    folder: str | PathLike[str],
    names: Sequence[str] | None = None,
    progress: Callable[[int, int], object] = lambda done, total: None,
) -> list[Path]:
    """Write playground, lessons, derivation and teacher's page into `folder`, which exists; returns their paths.

    names : the lessons whose pages are made, all without it. progress : is told how many lessons are done, of how many.
    """
    folder, environment = Path(folder), _environment()
    written_files: list[Path] = []

    def keep(name: str, content: str | bytes) -> None:
        path = folder / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        written_files.append(path)

    chosen = [lesson(name) for name in names or NAMES]
    keep(PAGE, playground_page(OTHERS))
    keep("index.html", environment.get_template("index.html").render(lessons=chosen))
    drawings = {name: Markup(getattr(diagrams, name)()) for name in ("rocking", "impact", "isolated")}
    keep("derivations.html", environment.get_template("derivations.html").render(**drawings))
    exercises, firsts = [], []
    for done, one in enumerate(chosen):
        progress(done, len(chosen))
        exercises.append([(exercise, answer(exercise)) for exercise in one.exercises])
        keep(f"lesson-{one.number}.html", _lesson_page(environment, one, chosen, exercises[-1]))
        first = one.first()
        firsts.append(first.says)
        for kind in ("svg", "png"):
            keep(f"figures/lesson-{one.number}.{kind}", download(first.figure, kind))
    page = environment.get_template("teacher.html")
    keep("teacher.html", page.render(lessons=chosen, exercises=exercises, firsts=firsts, licence=LICENCE))
    return written_files


def _environment() -> Environment:
    environment = templates(PAGES)
    environment.filters["prose"] = lambda text: Markup(prose(text))
    environment.filters["math"] = lambda tex: Markup(mathml(tex, display=True))
    environment.globals["style"] = Markup((PAGES / "pages.css").read_text(encoding="utf-8"))
    return environment


def _lesson_page(environment: Environment, one: Lesson, chosen: list[Lesson], exercises: list) -> str:
    titles = {other.number: other.title for other in chosen}
    views = [_view_parts(one.view(*values), f"{one.name}-{k}") for k, values in enumerate(one.places())]
    return environment.get_template("lesson.html").render(
        lesson=one,
        count=len(NAMES),
        before=titles.get(one.number - 1),
        after=titles.get(one.number + 1),
        code=code_of(one),
        exercises=exercises,
        table=one.table() if one.table else None,
        texts=json.dumps([[control.text(value) for value in control.values] for control in one.controls]),
        views=views,
        script=Markup((PAGES / "lesson.js").read_text(encoding="utf-8")),
    )


def _view_parts(view: View, name: str) -> dict:
    """What the template shows of a view: picture, numbers as (label, value in full, text), and the sentence."""
    numbers = [
        (label, value if isinstance(value, str) else repr(float(value)), written(value, unit))
        for label, (value, unit) in view.numbers.items()
    ]
    return {"svg": Markup(svg(view.figure, name)), "numbers": numbers, "says": view.says}
