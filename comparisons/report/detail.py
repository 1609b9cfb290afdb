"""Pages beside the report, one for each study; the templates, and the report's equations and glossary.

The equations stand as the model uses them; words beside them name the misprints of the paper.
"""

import hashlib
import math
import re
from base64 import b64encode
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from os import PathLike
from pathlib import Path
from typing import Any

from jinja2 import Environment
from markupsafe import Markup, escape

from analytic.checks.time_stepping import simulate_time_stepping

from ..execution.by_solver import age, briefly
from ..execution.plan import Study
from ..execution.results import ResultError
from ..execution.writing import readable, write_all
from ..lessons.lesson import SCENE, straddled
from ..plotting import diagrams
from ..plotting.charts import STYLE, colour, key_of
from ..plotting.diagrams import Drawing, mathml
from ..plotting.parts import Section, templates
from ..plotting.wording import indexed
from ..schemas.columns import number, signed, spelled_page, unbroken
from ..studies.rows import read_study
from .answer import origin_of


@dataclass(frozen=True)
class Equation:
    """An equation of the model.

    number: as in the paper; with a letter: ours. tex: for `comparisons.plotting.diagrams.mathml`. words: its meaning.
    modes: whether a link to the drawing of the modes follows.
    """

    number: str
    tex: str
    words: str
    modes: bool = False


EQUATIONS = (
    Equation(
        "1",
        r"\omega_r^2 = \frac{m g R}{J_O}",
        "The rocking frequency: how fast the tilted block falls. It is the block's only time scale.",
    ),
    Equation("2", r"(m + m_b)(a_g + \ddot{x}) + n_d f = 0", "Full contact: block and base are one mass on bearings."),
    Equation(
        "3, 5",
        r"(m + m_b)(a_g + \ddot{x}) + m (c \ddot{\phi} + n \dot{\phi}^2) + n_d f = 0",
        "Rocking, horizontal forces: c = R cos(sγ − φ), n = R sin(sγ − φ), s is the side to which the block tips.",
    ),
    Equation(
        "4, 6",
        r"J_O \ddot{\phi} + m c (a_g + \ddot{x}) + m g n = 0",
        "Rocking, moments about the corner on which the block turns.",
    ),
    Equation(
        "7",
        r"e_{\phi} = \frac{\omega^+}{\omega^-} = 1 - \frac{2 m b^2}{J_O - m \tilde{m} h^2}",
        "Restitution, from momentum alone, with m̃ = m/(m + m_b). On rigid ground m̃ = 0, which gives Housner's "
        "1 − 1.5 sin² γ for a rectangle.",
    ),
    Equation(
        "8",
        r"e_x = \frac{2 R^3 \sin^2 \gamma \cos \gamma \, m \tilde{m}}{R^2 \cos^2 \gamma \, m \tilde{m} - J_O}",
        "Jump of the base velocity, ẋ⁺ = ẋ⁻ − e_x φ̇⁻. The paper prints one factor R cos γ too many; for a block of "
        "about a metre this hardly shows.",
    ),
    Equation(
        "9, 11",
        r"f = k_b x + s \left( (k_a - k_b) \frac{D^{1 - \alpha} - D_0}{1 - \alpha} + f_0 \right)",
        "Force of a bearing, with D = D_c + s (x − x_c) since the last reversal at x_c. D_c keeps the force "
        "continuous.",
    ),
    Equation(
        "12",
        r"1 - x + x_j^- + 2 x_0",
        "The bracket while unloading, corrected. As the paper prints it, the force jumps by 2 f₀ at every reversal.",
    ),
    Equation(
        "S1",
        r"J_G \ddot{\phi} = -c H - n N",
        "A block that may slide, by Newton and Euler. J_G is about its centre of mass; H and N are the forces of its "
        "support. Its mode closes (S1) to (S4). Stick: φ = u = 0. Slide: φ = 0 and |H| = μ N, against the slip. Rock: "
        "u and η are at rest, which gives (3) to (6). Slide-rock: η is at rest and |H| = μ N. Flight: H = N = 0.",
        modes=True,
    ),
    Equation(
        "S2",
        r"m (a_g + \ddot{x} + \ddot{u} + c \ddot{\phi} + n \dot{\phi}^2) = H",
        "Horizontal forces: u is the slip of the corner along its support.",
    ),
    Equation(
        "S3",
        r"m (g + a_v + \ddot{\eta} + n \ddot{\phi} - c \dot{\phi}^2) = N",
        "Vertical forces: η is the gap under the corner, a_v is the ground's vertical acceleration.",
    ),
    Equation("S4", r"m_b (a_g + \ddot{x}) = -n_d f - H", "The base under the block; on rigid ground x = 0."),
    Equation(
        "I1",
        r"J_G (\dot{\phi}^+ - \dot{\phi}^-) = -c P - n Q",
        "A plastic impact, by the horizontal and upward impulses P and Q of the support, with |P| ≤ μ Q. The first "
        "admissible case of these holds: the new corner sticks, which is (7) and (8) if it did not slip before; it "
        "slips; both corners stay and stick; both stay and slip.",
        modes=True,
    ),
    Equation(
        "I2",
        r"D^+ - D^- = P \left( \frac{1}{m} + \frac{1}{m_b} \right)",
        "D is the horizontal velocity of the centre of mass relative to the base. On rigid ground 1/m_b drops out.",
    ),
    Equation("I3", r"m (Y^+ - Y^-) = Q", "Y is the vertical velocity of the centre of mass."),
    Equation("I4", r"m_b (\dot{x}^+ - \dot{x}^-) = -P", "The impulse on the base."),
)

GLOSSARY = {
    "slenderness γ": "angle between the vertical and the line from a base corner to the centre of mass",
    "tilt φ": "rotation of the block; at |φ| = γ, the unstable point, it may fall, and at 90° it has overturned",
    "uplift": "the instant at which a corner leaves its base",
    "restitution": "tilt rate after an impact over that before, e_φ",
    "safe gap": "range of amplitudes at which a block survives, although smaller ones overturn it after an impact",
    "boundary shift": "how far an engine moves the amplitude at which the outcome changes",
    "isolation period": "2π times the square root of the mass over the bearings' stiffness",
    "lead-rubber bearing": "rubber with a lead core: stiff k_a at first and after each reversal, then k_b",
    "friction demand": "horizontal over normal force under the block: the friction needed not to slide",
    "slip u": "displacement of the block along its support, where the friction demand exceeds the scene's μ",
    "sensitivity horizon": "time after which a change of the scene by 10⁻⁴ visibly changes the motion; a solver’s own "
    "horizon is that of a change as large as its errors",
    "analytic model": "the rocking equations solved directly from event to event; its compiled part is the kernel",
    "second implementation": "an independent, simple implementation of the same equations, which checks the first",
    "accuracy parameter": "the setting of a solver that trades time for error; its levels are the values tried",
    "variant": "one way of using an engine; its main variant is the one that runs if none is named",
    "defaults, tuned, assisted": "kinds of variants. Defaults: as in a first script. Tuned: as a skilled user can set "
    "it, with all motion computed by the engine. Assisted: the adapter sets a velocity, position or constraint at the "
    "model's event",
    "root mean square (rms)": "square root of the mean of the squares of all errors",
    "kappa": "Cohen's measure of the agreement of two yes-or-no judges: 1 if they always agree, 0 if only by chance",
    "McNemar's test": "whether two solvers that judge the same motions differ by more than chance; adjusted by Holm's "
    "rule for many tests",
    "Wilson interval": "95 % interval of a share, which is sound for few cases, too",
}

REFERENCES = (
    "“Seismic protection of cultural heritage artefacts by means of elastomeric isolators: a case study”: the paper "
    "whose equation numbers, table and figures are used here. What it prints is compared in a study of its own.",
    "G. W. Housner (1963), The behavior of inverted pendulum structures during earthquakes, Bulletin of the "
    "Seismological Society of America 53(2), 403–417.",
    "H. W. Shenton (1996), Criteria for initiation of slide, rock, and slide-rock rigid-body modes, Journal of "
    "Engineering Mechanics 122(7), 690–693.",
    "N. Makris, J. Zhang (2001), Rocking response of anchored blocks under pulse-type motions, Journal of Engineering "
    "Mechanics 127.",
)

STEP = 0.018  # s
EXAGGERATED = 8  # angles of the four frames
SIZE = 190, 112  # of a frame


def frames() -> list[tuple[Markup, str]]:
    """Return (drawing, words) of four frames of one impact in equal steps of `STEP`: why engines err at a corner.

    Steps are of the project's own integrator; the third frame is drawn by hand. Errors are rms values over many steps
    of about that size, as the error of one step may be small by chance.
    """
    run = simulate_time_stepping(SCENE, step=STEP)
    history = run.history
    assert history is not None  # it was asked for
    landed = int((history.tilt <= 0).argmax())
    before, inside, after = (float(history.tilt[landed + k]) for k in (-1, 0, 1))
    depth = 1e3 * 2 * SCENE.block.half_width * math.sin(abs(inside))  # of the far corner below the ground, mm
    (late, rate), (less, finer) = straddled(STEP), straddled(STEP / 2)
    words = (
        "1. A step straddles the impact. In this project’s own time stepping, which is no engine’s, steps of about "
        f"{STEP * 1e3:g} ms shift the impact by {number(1e3 * late, 2)} ms, and steps half as long by "
        f"{number(1e3 * less, 2)} ms (rms over phases).",
        f"2. The new corner penetrates, here by {number(depth, 2)} mm; the block still turns about the old one.",
        "3. Drawn by hand: where an engine pushes the corner out again, it may bounce or slide. Housner’s corner does "
        "neither.",
        f"4. The block turns about the new corner. Its rate is off by {number(100 * rate, 2)} %, and with half the "
        f"step by {number(100 * finer, 2)} % (rms): the step causes this error.",
    )
    feet = (
        _foot(before, 1, "above the ground"),
        _foot(inside, 1, "its corner in the ground"),
        _foot(-0.4 * abs(inside), -1, "bouncing", lift=14.0),
        _foot(after, -1, "turning about the new corner"),
    )
    return list(zip(feet, words, strict=True))


def _foot(tilt, corner, says, lift=0.0):
    """Draw the foot of a block, its angle exaggerated, about its right (1) or left (-1) corner, `lift` above ground."""
    drawing = Drawing(*SIZE, 98, f"The foot of the block, {says}")
    return drawing.svg(
        drawing.line((6, 0), (184, 0), "floor"),
        drawing.block((95 + 50.0 * corner, lift), EXAGGERATED * tilt, 50.0, 74.0, corner),
    )


HERE = Path(__file__).parent


def write_study(
    study: Study, path: str | PathLike[str], folder: str | PathLike[str] | None = None
) -> tuple[Path, Section]:
    """Write the page of the result at `path` into `folder`, by default beside it. Return (its path, its section).

    Raises
    ------
    ResultError
        The result is missing or damaged, or of another study.
    PlaceError
        The page cannot be written.
    """
    path = Path(path)
    if path.name in ("", ".."):  # the folder one is in, or the one above
        path = path.resolve()
    result = read_study(path, study.name)
    outdated, file = age(result), path.name
    try:
        page = study.page(result).whole()
    except Exception as error:
        if outdated is None:  # of the very code that fails
            raise
        words = f"{file}: its page cannot be drawn ({readable(repr(error))}); it is {outdated}"
        raise ResultError(f"{words}; run rocking study {study.name}") from error
    into = (path if folder is None else Path(folder) / file).with_suffix(".html")
    html = detail(page.title, [replace(page, age=outdated)], origin_of(result))
    write_all(into.parent, {into.name: html})
    return into, page


def detail(
    title: str,
    sections: Iterable[Section],
    origin: str,
    *,
    pages: Sequence[Mapping[str, str]] = (),
    home: str = "",
    file: str = "",
) -> str:
    """Return the HTML of a page that needs no other file.

    pages: {"file", "title"} of all pages in its navigation, itself among them. home: file of the report; "": the page
    stands alone. file: its own place among `pages`.
    """
    template = environment().get_template("detail.html")
    shown = {"title": title, "sections": sections, "origin": origin}
    return spelled_page(template.render(**shown, pages=pages, home=home, file=file, **assets()))


@cache
def environment() -> Environment:
    """Return the templates' environment, with filters for numbers, formulas and the glossary's terms."""
    environment_ = templates(HERE)
    known = {re.sub(" [^ ]$", "", word): meaning for word, meaning in GLOSSARY.items()}
    words = re.compile("|".join(rf"\b{re.escape(word)}\b" for word in sorted(known, key=len, reverse=True)))

    def glossed(text):
        """Return the text with an explanation at the first use of each term of the glossary."""
        seen = set()

        def explained(environment_):
            if environment_[0] in seen:
                return environment_[0]
            seen.add(environment_[0])
            return f'<abbr title="{escape(known[environment_[0]])}">{environment_[0]}</abbr>'

        return Markup(words.sub(explained, indexed(str(escape(unbroken(text))))))

    environment_.filters |= {
        "math": lambda tex: Markup(mathml(tex, display=True)),
        "indexed": lambda text: Markup(indexed(str(escape(unbroken(str(text)))))),
        "glossed": glossed,
        "unbroken": unbroken,
        "briefly": briefly,
        "number": number,
        "signed": signed,
        "key": lambda who: Markup(key_of(who)),
        "colour": colour,
    }
    return environment_


def assets() -> dict[str, Any]:
    """Return style and scripts for the page itself, and a policy that forbids other scripts and all loading."""
    parts = {
        "style": Markup(
            "".join(file.read_text(encoding="utf-8") for file in (STYLE, diagrams.STYLE, HERE / "style.css"))
        ),
        "script": Markup((HERE / "page.js").read_text(encoding="utf-8")),
        "animation": Markup((HERE / "animation.js").read_text(encoding="utf-8")),
    }
    digests = (hashlib.sha256(parts[name].encode()).digest() for name in ("script", "animation"))
    scripts = " ".join(f"'sha256-{b64encode(digest).decode()}'" for digest in digests)
    return {**parts, "policy": f"default-src 'none'; style-src 'unsafe-inline'; script-src {scripts}"}
