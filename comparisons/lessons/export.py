"""Lessons and playground as HTML pages that need no network.

The playground is one page with the equations as plain scripts. polynomial.js, scene.js, series.js and model.js are the
compiled kernel in JavaScript. engines.js has the integrator of `analytic.checks.time_stepping`, and a block on soft
corners. Tests compare their numbers with those of `analytic`.
"""

import base64
import json
from collections.abc import Callable, Sequence
from os import PathLike
from pathlib import Path

import numpy as np
from jinja2 import Environment
from markupsafe import Markup

from analytic import synthetic_motion

from ..execution.writing import write_all
from ..plotting import diagrams
from ..plotting.diagrams import mathml, prose
from ..plotting.parts import templates
from .lesson import LICENCE, Lesson, View, downloads, svg
from .notebook import answer, code_of, written
from .topics import lessons

PAGES = Path(__file__).parent / "pages"
FOLDER = Path(__file__).parent / "playground"
# Scripts of the equations, run in the page and in its workers; then scripts of the page alone.
SHARED = ("polynomial.js", "scene.js", "series.js", "model.js", "engines.js", "jobs.js")
SCRIPTS = ("charts.js", "views.js", "workers.js", "page.js")
PAGE = "playground.html"


def sources(names: tuple[str, ...] = SHARED) -> str:
    """Return the scripts of these names, one after the other."""
    return "\n".join((FOLDER / name).read_text(encoding="utf-8") for name in names)


def playground_page(pages: Sequence[tuple[str, str]] = ()) -> str:
    """Return the playground as HTML; pages: (file, title) of the pages beside it, for links."""
    motion = synthetic_motion()
    return (
        templates(FOLDER)
        .get_template("page.html")
        .render(
            style=Markup((FOLDER / "style.css").read_text(encoding="utf-8")),
            shared=[Markup(sources((name,))) for name in SHARED],
            scripts=[Markup(sources((name,))) for name in SCRIPTS],
            pages=pages,
            motion_label=motion.label[0].upper() + motion.label[1:],
            motion_step=repr(motion.dt),
            motion_peak=repr(float(np.abs(motion.samples).max())),
            motion_samples=base64.b64encode(motion.samples.astype("<f8").tobytes()).decode(),
        )
    )


OTHERS = (("index.html", "Lessons"), ("derivations.html", "Derivation"), ("teacher.html", "For teachers"))


def export_pages(
    folder: str | PathLike[str], progress: Callable[[int, int], object] = lambda done, total: None
) -> list[Path]:
    """Write playground, lessons, derivation and teacher's page into `folder`. Return their paths.

    progress : called with (lessons done, all lessons).
    """
    environment, all_lessons = _environment(), lessons()
    drawings = {name: Markup(getattr(diagrams, name)()) for name in ("rocking", "impact", "isolated")}
    files: dict[str, str | bytes] = {
        PAGE: playground_page(OTHERS),
        "index.html": environment.get_template("index.html").render(lessons=all_lessons),
        "derivations.html": environment.get_template("derivations.html").render(**drawings),
    }
    exercises, first_views = [], []
    for done, lesson in enumerate(all_lessons):
        progress(done, len(all_lessons))
        exercises.append([(exercise, answer(exercise)) for exercise in lesson.exercises])
        files[f"lesson-{lesson.number}.html"] = _lesson_page(environment, lesson, all_lessons, exercises[-1])
        first = lesson.first()
        first_views.append(first.says)
        files |= {f"figures/lesson-{lesson.number}.{kind}": file for kind, file in downloads(first.figure).items()}
    page = environment.get_template("teacher.html")
    files["teacher.html"] = page.render(lessons=all_lessons, exercises=exercises, firsts=first_views, licence=LICENCE)
    return write_all(folder, files)


def _environment() -> Environment:
    environment = templates(PAGES)
    environment.filters["prose"] = lambda text: Markup(prose(text))
    environment.filters["math"] = lambda tex: Markup(mathml(tex, display=True))
    environment.globals["style"] = Markup(
        "".join(file.read_text(encoding="utf-8") for file in (PAGES / "pages.css", diagrams.STYLE))
    )
    return environment


def _lesson_page(environment: Environment, lesson: Lesson, all_lessons: Sequence[Lesson], exercises: list) -> str:
    titles = {other.number: other.title for other in all_lessons}
    views = [_view_parts(lesson.view(*values), f"{lesson.name}-{k}") for k, values in enumerate(lesson.places())]
    return environment.get_template("lesson.html").render(
        lesson=lesson,
        count=len(all_lessons),
        before=titles.get(lesson.number - 1),
        after=titles.get(lesson.number + 1),
        code=code_of(lesson),
        exercises=exercises,
        table=lesson.table() if lesson.table else None,
        drawing=lesson.drawing() if lesson.drawing else "",
        example=_view_parts(lesson.example(), f"{lesson.name}-example") if lesson.example else None,
        texts=json.dumps([[control.text(value) for value in control.values] for control in lesson.controls]),
        views=views,
        script=Markup((PAGES / "lesson.js").read_text(encoding="utf-8")),
    )


def _view_parts(view: View, name: str) -> dict:
    """Return parts of a view for the template: picture, numbers as (label, value in full, text), and sentence."""
    numbers = [
        (label, value if isinstance(value, str) else repr(float(value)), written(value, unit))
        for label, (value, unit) in view.numbers.items()
    ]
    return {"svg": Markup(svg(view.figure, name)), "numbers": numbers, "says": view.says}
