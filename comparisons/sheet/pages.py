"""The problem sheet for other codes: scenes, quantities asked for, reference answers, and its files.

The files are a page for each problem in Markdown and HTML, the record, and a table of all reference answers.
"""

import functools
import math
import re
from collections.abc import Iterable
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

import numpy as np
from markdown_it import MarkdownIt
from markupsafe import Markup

from analytic import (
    Base,
    Bearings,
    Block,
    PulseMotion,
    Response,
    SampledMotion,
    Scene,
    Start,
    simulate,
    synthetic_motion,
)

from ..execution.writing import write_all
from ..plotting.parts import templates
from ..plotting.wording import indexed

VERSION = 1  # version of scenes and quantities; answers to another version cannot be compared
TIGHTEST = 1e-16  # tolerance of the model's run
HISTORY_STEP = 1e-3  # s; every time asked for is a multiple of it
DIGITS = 12  # digits of an answer, which is known to 1e-10 of its scale
TOLERANCE = 1e-3  # largest difference of another code's answer, over the scale of the quantity
RECORD_SAMPLES = 1601  # samples taken of the synthetic motion: its first 8 s
DAMPING = 0.15  # of the linear bearings, as a share of critical damping
PERIOD = 2.0  # s, of the linear bearings under block and base
# {kind of quantity: its unit}, and {kind: its scale in symbols}.
UNITS = {"time": "s", "angle": "rad", "rate": "rad/s", "length": "m", "speed": "m/s", "force": "N", "outcome": "a word"}
SCALES = {
    "time": "1/ω_r",
    "angle": "γ",
    "rate": "γ ω_r",
    "length": "R γ",
    "speed": "R γ ω_r",
    "force": "(m + m_b) g γ",
    "outcome": "–",
}


@dataclass(frozen=True)
class Quantity:
    """A number or word that is asked for.

    kind: "time", "angle", "rate", "length", "speed", "force" or "outcome". source: its attribute of an `Impact`, of a
    `State`, or of the `Response` (the first one of uplifts and of rests). index: number of the impact, from 1 on, or
    time of the state [s].
    """

    name: str
    kind: str
    words: str
    source: str
    index: float = 0.0


@dataclass(frozen=True, eq=False)
class Problem:
    """A page of the sheet; its quantities are within the duration of `scene`."""

    name: str
    title: str
    story: str
    scene: Scene
    quantities: tuple[Quantity, ...]

    @functools.cached_property
    def answers(self) -> dict[str, float | str]:
        """Reference answers of the analytic model, {name of a quantity: answer in its unit}, to `DIGITS` digits."""
        response = simulate(self.scene, tolerance=TIGHTEST, output_step=HISTORY_STEP)
        return {quantity.name: _value_of(quantity, response) for quantity in self.quantities}

    def tolerance(self, quantity: Quantity) -> float | None:
        """Return by how much another code's answer may differ, in the quantity's unit; None for a word.

        It is `TOLERANCE` times the scale of the quantity, which `SCALES` gives in symbols.
        """
        block, omega = self.scene.block, self.scene.rocking_frequency
        scales = {
            "time": 1 / omega,
            "angle": block.slenderness,
            "rate": block.slenderness * omega,
            "length": block.radius * block.slenderness,
            "speed": block.radius * block.slenderness * omega,
            "force": self.scene.total_mass * self.scene.gravity * block.slenderness,
        }
        return TOLERANCE * scales[quantity.kind] if quantity.kind in scales else None


def _value_of(quantity: Quantity, response: Response) -> float | str:
    """Return the value of a quantity in a run with a history: a word, or a number to `DIGITS` digits."""
    value: Any
    if quantity.source in STATE:
        time, values = (getattr(response.history, name) for name in ("time", quantity.source))
        value = np.interp(quantity.index, time, values)
    elif quantity.source in IMPACT:
        value = getattr(response.impacts[int(quantity.index) - 1], quantity.source)
    else:
        value = getattr(response, quantity.source)
        value = value[0] if isinstance(value, tuple) else value  # of uplifts and rests, the first
    return value if isinstance(value, str) else float(f"{value:.{DIGITS}g}")


# {source: (name, kind, words)} of quantities of an impact, with its number, and of a state, with its time [s].
IMPACT = {
    "time": ("impact_time_{:g}", "time", "time of impact {:g}"),
    "rate_before": ("rate_before_{:g}", "rate", "φ′ just before impact {:g}"),
    "rate_after": ("rate_after_{:g}", "rate", "φ′ just after impact {:g}"),
    "base_velocity_jump": ("base_velocity_jump_{:g}", "speed", "x′ just after impact {:g} less x′ just before it"),
}
STATE = {
    "tilt": ("tilt_at_{:g}", "angle", "φ at t = {:g} s"),
    "tilt_rate": ("tilt_rate_at_{:g}", "rate", "φ′ at t = {:g} s"),
    "base_displacement": ("displacement_at_{:g}", "length", "x at t = {:g} s"),
    "bearing_force": ("force_at_{:g}", "force", "force F of all bearings together at t = {:g} s"),
}
OTHERS = {
    "outcome": Quantity(
        "outcome", "outcome", "stands (φ stays 0), rocks, or overturns (|φ| reaches π/2 within the duration)", "outcome"
    ),
    "peak_tilt": Quantity("peak_tilt", "angle", "largest |φ| within the duration", "peak_tilt"),
    "peak_displacement": Quantity(
        "peak_displacement",
        "length",
        "largest |x| within the duration; of a block that overturns, up to the last time of |φ| = γ",
        "peak_base_displacement",
    ),
    "uplift": Quantity("uplift_time", "time", "time at which the block first lifts", "uplifts"),
    "rest": Quantity(
        "rest_time", "time", "limit of the times of the impacts of the first free rocking: it then rests", "rests"
    ),
    "overturning": Quantity("overturning_time", "time", "time at which |φ| = π/2", "overturning_time"),
}


def quantities_at(indices: Iterable[float], *sources: str) -> list[Quantity]:
    """Return quantities of the impacts of these numbers, or of the states at these times [s], by these sources."""
    rows = {source: (IMPACT | STATE)[source] for source in sources}
    return [
        Quantity(name.format(index), kind, words.format(index), source, index)
        for index in indices
        for source, (name, kind, words) in rows.items()
    ]


def _block(slenderness: float) -> Block:
    return Block(mass=1000.0, radius=1.2, slenderness=slenderness)


def record() -> SampledMotion:
    """Return the ground motion of the problem "record": the first 8 s of the synthetic motion."""
    motion = synthetic_motion()
    return SampledMotion(motion.dt, motion.samples[:RECORD_SAMPLES], "record.csv")


BASE = Base(mass=300.0)
RUBBER = Bearings(count=4, ka=2.4e4, kb=2.4e3, alpha=40.0)
OMEGA = 2 * math.pi / PERIOD  # rad/s
SPRINGS = Bearings(law="linear", count=4, ka=1300 * OMEGA**2 / 4, damping=2 * DAMPING * OMEGA * 1300 / 4)


def _pulse(name, words, amplitude):
    """Return a problem beside the amplitude 3.21708 m/s2, beyond which the block overturns after one impact."""
    below = name == "pulse-below"
    return Problem(
        name,
        f"One sine, {words}",
        "The block stands on rigid ground, which moves by one sine.",
        Scene(block=_block(0.25), motion=PulseMotion("one-sine", amplitude, 6.0), duration=4.0),
        (
            OTHERS["outcome"],
            OTHERS["uplift"],
            *quantities_at((1,), "time", "rate_before", "rate_after"),
            OTHERS["peak_tilt" if below else "overturning"],
            *quantities_at((0.5, 1.0, 2.0), "tilt"),
        ),
    )


PROBLEMS = (
    Problem(
        "free-rigid",
        "Free rocking on rigid ground",
        "The block is tilted, released from rest, and rocks on rigid ground that does not move.",
        Scene(block=_block(0.25), start=Start(tilt=0.2), duration=4.0),
        (
            OTHERS["outcome"],
            *quantities_at((1, 2, 3), "time", "rate_before", "rate_after"),
            *quantities_at((1.5, 2.5, 4.0), "tilt", "tilt_rate"),
        ),
    ),
    Problem(
        "free-sliding",
        "Free rocking on a base that slides",
        "The block is tilted and released from rest. Its base slides on the ground without friction; the ground does "
        "not move.",
        Scene(block=_block(0.2), base=BASE, start=Start(tilt=0.15), duration=4.0),
        (
            OTHERS["outcome"],
            *quantities_at((1, 2, 3), "time", "rate_before", "rate_after", "base_velocity_jump"),
            *quantities_at((1.0, 2.0), "tilt", "base_displacement"),
        ),
    ),
    Problem(
        "isolated-standing",
        "A block that stands on bearings",
        "Block and base start at rest on hysteretic bearings. The ground moves by one sine, and the block is too "
        "stocky to lift.",
        Scene(block=_block(0.35), base=BASE, bearings=RUBBER, motion=PulseMotion("one-sine", -3.0, 6.0), duration=4.0),
        (
            OTHERS["outcome"],
            OTHERS["peak_displacement"],
            *quantities_at((0.75, 1.25, 1.5, 2.0, 2.25), "base_displacement", "bearing_force"),
        ),
    ),
    Problem(
        "isolated-rocking",
        "A block that rocks on bearings",
        "Block and base start at rest on hysteretic bearings. The ground moves by one sine, and the block lifts.",
        Scene(block=_block(0.17), base=BASE, bearings=RUBBER, motion=PulseMotion("one-sine", -3.0, 8.0), duration=4.0),
        (
            OTHERS["outcome"],
            OTHERS["uplift"],
            *quantities_at((1, 2), "time", "rate_before", "rate_after", "base_velocity_jump"),
            OTHERS["peak_tilt"],
            OTHERS["peak_displacement"],
            *quantities_at((0.5, 1.25), "tilt", "base_displacement", "bearing_force"),
        ),
    ),
    _pulse("pulse-below", "overturning is near", 3.14),
    _pulse("pulse-above", "the amplitude is 5 % larger", 3.3),
    Problem(
        "record",
        "A recorded motion, linear bearings with a damper",
        "Block and base start at rest on linear springs with viscous dampers. The ground acceleration is that of "
        "the file inputs/record.csv, linear between its samples.",
        Scene(block=_block(0.18), base=BASE, bearings=SPRINGS, motion=record(), duration=6.0),
        (
            OTHERS["outcome"],
            OTHERS["uplift"],
            *quantities_at((1,), "time", "rate_before", "rate_after", "base_velocity_jump"),
            OTHERS["peak_displacement"],
            *quantities_at((3.0, 4.0, 5.0, 6.0), "tilt", "base_displacement", "bearing_force"),
        ),
    ),
    Problem(
        "hard",
        "Rest, and uplift again",
        "The block is tilted and released on rigid ground. Ever faster and weaker impacts bring it to rest in finite "
        "time, after infinitely many of them. From t = 2 s on the ground moves by one sine, and it lifts again.",
        Scene(
            block=_block(0.45), start=Start(tilt=0.1), motion=PulseMotion("one-sine", 6.0, 6.5, start=2.0), duration=6.0
        ),
        (
            OTHERS["outcome"],
            *quantities_at((1, 2, 3), "time"),
            OTHERS["rest"],
            OTHERS["uplift"],
            OTHERS["peak_tilt"],
            *quantities_at((2.4, 3.0), "tilt", "tilt_rate"),
        ),
    ),
)


TEMPLATES = templates(Path(__file__).parent / "templates")
TITLE = "Rocking blocks: reference problems for other codes"
POWER = re.compile(r"(?<![\w.])(\d+(?:\.\d+)?)e([-+]?)0*(\d+)(?!\w)")
ANSWERS, RECORD_FILE = "reference.csv", "record.csv"


def write_sheet(folder: Path) -> list[Path]:
    """Write the sheet into `folder`. Return the paths written; a reader starts with the first.

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
        ANSWERS: _answer_table(),
        f"inputs/{RECORD_FILE}": _record_file(),
    }
    for problem in PROBLEMS:
        text = markdown(problem)
        files |= {f"{problem.name}.md": text, f"{problem.name}.html": _html(problem.title, text)}
    return write_all(folder, files)


def markdown(problem: Problem) -> str:
    """Return the page of a problem as Markdown."""
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
    """Return a page in Markdown as HTML that needs no other file."""
    body = POWER.sub(_power, indexed(MARKDOWN.render(text)))
    body = body.replace("<table>", '<div class="scroll" tabindex="0"><table>').replace("</table>", "</table></div>")
    return TEMPLATES.get_template("page.html").render(title=title, body=Markup(body)) + "\n"


def _power(match):
    """Write a number like 1e-20 with a power of ten."""
    mantissa, sign, exponent = match.groups()
    return f"{'' if mantissa == '1' else mantissa + '·'}10<sup>{'−' if sign == '-' else ''}{exponent}</sup>"


def _equations(renderer, tokens, place, options, environment):
    """Write lines of code, which are equations here, as paragraphs."""
    lines = tokens[place].content.splitlines()
    return "".join(f'<p class="equation">{escape(line)}</p>\n' for line in lines if line)


MARKDOWN = MarkdownIt().enable("table")
MARKDOWN.add_render_rule("code_block", _equations)


def _answer_table():
    rows = [
        (
            problem.name,
            quantity.name,
            UNITS[quantity.kind],
            problem.answers[quantity.name],
            problem.tolerance(quantity) or "",
        )
        for problem in PROBLEMS
        for quantity in problem.quantities
    ]
    return "\n".join(["scene,quantity,unit,answer,tolerance", *(",".join(map(str, row)) for row in rows)]) + "\n"


def _record_file():
    motion = record()
    rows = (f"{k * motion.dt:.3f},{value!r}" for k, value in enumerate(motion.samples.tolist()))
    return "\n".join(["time [s],acceleration [m/s2]", *rows]) + "\n"
