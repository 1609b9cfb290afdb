"""The playground: one HTML page that needs nothing else, with the equations as plain scripts.

polynomial.js, scene.js, series.js and model.js are the compiled kernel in JavaScript, engines.js the fixed-step
integrator of `analytic.time_stepping` and a block on soft corners; tests hold their numbers to those of `analytic`.
"""

import base64
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from markupsafe import Markup

from analytic import synthetic_motion

from ...showing.parts import templates

FOLDER = Path(__file__).parent
# Of the equations, run in the page and in its workers; then those of the page alone.
SHARED = ("polynomial.js", "scene.js", "series.js", "model.js", "engines.js", "jobs.js")
SCRIPTS = ("charts.js", "views.js", "workers.js", "page.js")
PAGE = "playground.html"


def sources(names: tuple[str, ...] = SHARED) -> str:
    """The scripts of these names, one after the other."""
    return "\n".join((FOLDER / name).read_text(encoding="utf-8") for name in names)


def playground_page(pages: Sequence[tuple[str, str]] = ()) -> str:
    """The page as HTML; pages: (file, title) of those it leads to, beside it."""
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
