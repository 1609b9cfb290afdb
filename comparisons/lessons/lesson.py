"""The type of a lesson, its figures, and the runs that several lessons share.

A lesson has a question, symbols and equations, a guess, a picture with controls, common errors and exercises. Texts are
paragraphs with ``$formulas$`` in TeX: a notebook shows the TeX, a page shows MathML (`plotting.diagrams.prose`).
Figures are drawn with stand-ins for colours, which a page replaces by its own, light or dark.

The shared runs are of one small scene, a block released on rigid ground up to its second impact, in every variant of
every installed engine. Without engines the lessons use the model's own fixed-step integrator.
"""

import functools
import io
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import matplotlib
import numpy as np
from markupsafe import Markup
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analytic import Response, Scene, Start, simulate
from analytic.checks.time_stepping import simulate_time_stepping
from analytic.scene import caryatid_block
from engines import get_engine, installed_engines

from ..plotting.parts import Table, element_of

INK, SOFT, GRID, PANEL = "#1c1b19", "#5f5b54", "#e4e0d8", "#fffffe"
MODEL, OTHER, THIRD = "#0072b2", "#d55e00", "#00795c"  # distinguishable for colour-blind readers, and by their dashes
STONE = "#e9e0cb"
# Outcomes in maps: stands, rocks, overturns after impacts, overturns without one.
OUTCOMES = ("#d9d5cc", "#56b4e9", "#f0a500", "#c23b00")
VARIABLES = {
    INK: "ink", SOFT: "soft", GRID: "grid", PANEL: "panel", MODEL: "model", OTHER: "ghost", THIRD: "third",
    STONE: "stone", OUTCOMES[0]: "stands",
}  # fmt: skip
STYLE: Any = {  # keys of matplotlib's rcParams
    "font.family": "sans-serif",
    "font.size": 11,
    "axes.edgecolor": SOFT,
    "axes.labelcolor": INK,
    "axes.facecolor": "none",
    "figure.facecolor": "none",
    "text.color": INK,
    "xtick.color": SOFT,
    "ytick.color": SOFT,
    "axes.grid": True,
    "grid.color": GRID,
    "grid.linewidth": 0.8,
    "axes.axisbelow": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.unicode_minus": True,
    "lines.linewidth": 1.9,
    "legend.frameon": False,
    "legend.fontsize": 10,
    "legend.labelcolor": INK,
    "svg.fonttype": "none",
    "path.simplify_threshold": 0.3,
}
WIDTH, HEIGHT = 5.4, 4.4  # inch; text is readable on a phone
WIDE = (9.6, 5.4)  # inch, size of the figures for slides, 16:9
LICENCE = "rocking lessons, MIT licence"


def canvas(rows: int = 1, heights: tuple[float, ...] = (1,), **more: Any) -> tuple[Figure, Any]:
    """Return (figure, its axes from `Figure.subplots`) in the lessons' style."""
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(WIDTH, HEIGHT))
        axes = figure.subplots(rows, height_ratios=heights, **more)
        figure.subplots_adjust(left=0.14, right=0.97, top=0.965, bottom=0.125, hspace=0.42, wspace=0.12)
    return figure, axes


def tilt_axis(axes: Axes, time: Any, ratio: Any, window: float, **more: Any) -> None:
    """Draw tilt over slenderness in time [s] up to the window, with lines where the block is balanced."""
    axes.plot(time, ratio, color=MODEL)
    for level in (-1, 1):
        axes.axhline(level, color=SOFT, linewidth=0.9, linestyle=(0, (4, 4)))
    axes.set(xlim=(0, window), ylim=(-1.5, 1.5), ylabel="tilt φ / γ", **more)


def legend(axes: Axes, **more: Any) -> None:
    """Draw a legend in the lessons' style."""
    with matplotlib.rc_context(STYLE):
        axes.legend(**more)


def svg(figure: Figure, name: str) -> str:
    """Return the figure as an SVG element in the colours of its page; `name` makes the names of its parts unique."""
    file = io.BytesIO()
    with matplotlib.rc_context({**STYLE, "svg.hashsalt": name}):
        figure.savefig(file, format="svg", transparent=True, metadata={"Date": None, "Creator": None})
    text = element_of(file.getvalue().decode(), 'aria-hidden="true"')
    for colour, variable in VARIABLES.items():
        text = text.replace(colour, f"var(--{variable})")
    return text


def downloads(figure: Figure) -> dict[str, bytes]:
    """Return the figure for slides, 16:9, with a licence line: {"svg": file, "png": file of 1920 by 1080 pixels}."""
    figure.set_size_inches(*WIDE)
    figure.subplots_adjust(left=figure.subplotpars.left * WIDTH / WIDE[0], bottom=0.13)
    figure.text(0.985, 0.012, LICENCE, ha="right", color=SOFT, fontsize=7)
    files = {"svg": io.BytesIO(), "png": io.BytesIO()}
    with matplotlib.rc_context({**STYLE, "svg.hashsalt": "download"}):
        for kind, file in files.items():
            undated = {"Date": None} if kind == "svg" else {}
            figure.savefig(file, format=kind, dpi=200, facecolor="white", metadata=undated)
    return {kind: file.getvalue() for kind, file in files.items()}


# Every symbol of the lessons' equations, as `Lesson.symbols` lists them.
SYMBOLS = {
    "b": "half the width of the block [m]",
    "h": "half its height [m]",
    "R": "distance from a corner to the centre of mass [m]",
    r"\gamma": "slenderness: the angle between the diagonal and the vertical, $\\tan \\gamma = b/h$ [rad]",
    "m": "mass of the block [kg]",
    "J_O": "moment of inertia about a corner, $\\frac{4}{3} m R^2$ for a rectangle [kg m²]",
    r"\phi": "tilt, positive to the right; $\\dot{\\phi}$ is the tilt rate [rad, rad/s]",
    r"\dot{\phi}^{\pm}": "tilt rate just before ($-$) and just after ($+$) an impact [rad/s]",
    r"\phi_0": "a peak of the tilt [rad]",
    r"\phi_1": "the next peak [rad]",
    "s": "$+1$ for a tilt to the right, $-1$ for one to the left",
    "g": "gravity, 9.81 m/s²",
    "a_g": "acceleration of the ground [m/s²]",
    r"\mu": "friction between the block and what it stands on, Coulomb’s coefficient",
    r"e_{\phi}": "restitution: tilt rate after an impact over that before it",
    "e_x": "jump of the base’s velocity over the tilt rate before the impact, negated [m]",
    "m_b": "mass of the base [kg]",
    r"\tilde{m}": "mass share of the block, $m/(m + m_b)$; 0 on rigid ground",
    "x": "displacement of the base relative to the ground [m]",
    "n_d": "number of bearings",
    "f": "force of one bearing [N]",
    "k_a": "stiffness of a bearing before the lead yields [N/m]",
    "k_b": "stiffness of a bearing after the lead has yielded [N/m]",
    "f_0": "half the height of the loop of the lead’s force [N]",
    r"\alpha": "exponent: how sharply the stiffness falls",
    "x_0": "a length that follows from the stiffnesses and $\\alpha$ [m]",
    "x_j": "displacement at the last reversal [m]",
    "D_0": "$(1 + 2 x_0)^{1-\\alpha}$",
    "X": "amplitude of a cycle [m]",
    "W_D": "energy that a bearing dissipates in a cycle [J]",
    r"\xi": "equivalent viscous damping ratio",
    "k_{sec}": "secant stiffness: force over displacement at the amplitude [N/m]",
    "E_s": "elastic energy at the amplitude, with the secant stiffness [J]",
    r"\Delta t": "time step [s]",
    "k": "number of a step",
    "t": "time [s]",
    r"\Delta \phi": "difference between the tilts of two blocks [rad]",
    r"\lambda": "rate at which that difference grows [1/s]",
    "p": "order of convergence",
}


@dataclass(frozen=True)
class Equation:
    """An equation. tex: the formula. number: in the paper, "" without one. says: its meaning, one sentence."""

    tex: str
    number: str
    says: str


@dataclass(frozen=True)
class Control:
    """A control for the reader: label; values, numbers in order or words; the initial value; unit and digits."""

    label: str
    values: tuple[float, ...] | tuple[str, ...]
    start: float | str
    unit: str = ""
    digits: int = 2

    def __post_init__(self) -> None:
        if self.start not in self.values:
            raise ValueError(f"{self.label}: its start {self.start!r} is none of its values {self.values}")

    @property
    def in_words(self) -> bool:
        return isinstance(self.start, str)

    def text(self, value: float | str) -> str:
        """Return a value in words, with its unit."""
        if isinstance(value, str):
            return value
        return f"{value:.{self.digits}f}".replace("-", "−") + (f" {self.unit}" if self.unit else "")


@dataclass(frozen=True)
class View:
    """The view of a lesson at one combination of its controls.

    figure : matplotlib Figure. numbers : {label: (value, unit)}, the value being a number or a word. says : a sentence
    that describes the picture for readers who cannot see it.
    """

    figure: Figure
    numbers: dict[str, tuple[float | str, str]]
    says: str


@dataclass(frozen=True)
class Exercise:
    """A question with a computed answer: `compute()` returns a number in `unit`; `because` explains the solution."""

    question: str
    compute: Callable[[], float]
    unit: str
    because: str
    digits: int = 3


@dataclass(frozen=True)
class Lesson:
    """One lesson; `view` takes the values of the controls in their order.

    minutes : in a lecture. aims : learning outcomes. needs : prerequisites. symbols : keys of `SYMBOLS`. guess : a
    question to answer before the controls are used, which the picture then answers. code : a few lines that compute a
    number of the lesson, `answer`; their text is a cell of the notebook. playground : positions of the playground's
    sliders, as its address after #. drawing : at the head of the lesson. table : rows below the picture. example : a
    second picture, without controls, its caption `says`, and its heading.
    """

    number: int
    name: str
    title: str
    question: str
    aims: tuple[str, ...]
    needs: str
    minutes: int
    symbols: tuple[str, ...]
    equations: tuple[Equation, ...]
    controls: tuple[Control, ...]
    view: Callable[..., View]
    guess: str
    look: str
    wrong: tuple[str, ...]
    exercises: tuple[Exercise, ...]
    code: Callable[[], object]
    playground: str
    drawing: Callable[[], Markup] | None = None
    table: Callable[[], Table] | None = None
    example: Callable[[], View] | None = None
    example_head: str = "A bad example"

    def glossary(self) -> list[tuple[str, str]]:
        """Return (symbol as TeX, meaning) of each symbol of the lesson."""
        return [(symbol, SYMBOLS[symbol]) for symbol in self.symbols]

    def first(self) -> View:
        """Return the view at the initial values of the controls."""
        return self.view(*(control.start for control in self.controls))

    def places(self) -> list[tuple[float | str, ...]]:
        """Return all combinations of the controls' values, the last control changing fastest."""
        return list(product(*(control.values for control in self.controls)))


G = 9.81  # m/s2
HALVINGS = 50


def edge(differs: Callable[[float], bool], low: float, high: float) -> float:
    """Return the value between low and high at which `differs` changes, by bisection, on the side of high.

    Raises
    ------
    ValueError
        `differs` is the same at both ends.
    """
    beyond = differs(high)
    if differs(low) == beyond:
        raise ValueError(f"nothing changes between {low:g} and {high:g}")
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if differs(middle) == beyond else (middle, high)
    return high


def overturns(scene: Scene) -> bool:
    """Return whether the block of a scene overturns in the model."""
    return simulate(scene, history=False).outcome == "overturns"


def history_until(scene: Scene, duration: float) -> Response:
    """Return the response over the first `duration` [s], with its history every 0.01 s."""
    return simulate(scene.with_(duration=duration), output_step=0.01)


SLENDERNESS, START = 0.28, 0.6  # rad, tilt over slenderness
SCENE = Scene(block=caryatid_block(SLENDERNESS), start=Start(tilt=START * SLENDERNESS), duration=1.5)
FIRST = 1.0  # s: between the first and the second impact
OWN = "fixed steps"  # the model's own integrator
# Steps [s]. The impact is at another place in each of these steps, so that the error falls from step to step. Halving
# is not enough: steps of 20 and of 10 ms happen to end at the same time beside the impact.
OWN_STEPS = (0.018, 0.012, 6e-3, 2.4e-3, 1e-3, 5e-4, 2e-4, 1e-4)
PHASES = np.linspace(0.9, 1.1, 41)  # factors on a step, which move the impact through the whole step
ROUNDS = 3  # runs of a timing; the least CPU time counts


@dataclass(frozen=True)
class EngineRun:
    """A run of a solver. name: with the variant, of the kind `kind`. parameter, value: accuracy parameter and level.

    error: relative error of the tilt rate after the first impact, nan without an impact. cpu: CPU time [s].
    """

    solver: str
    name: str
    kind: str
    parameter: str
    value: float
    error: float
    cpu: float


@functools.cache
def exact_rate() -> float:
    """Return the model's tilt rate after the first impact [rad/s]."""
    return simulate(SCENE, history=False).impacts[0].rate_after


def error_of(response: Response) -> float:
    """Return the relative error of the tilt rate after the first impact; nan without an impact."""
    hits = [impact for impact in response.impacts if impact.time < FIRST]
    return abs(hits[0].rate_after / exact_rate() - 1) if hits else math.nan


def straddled(step: float) -> tuple[float, float]:
    """Return (shift of the first impact [s], relative error of the rate after it) with fixed steps.

    Both are root mean squares over steps within a tenth of `step` [s], of the model's own integrator.
    """
    exact = simulate(SCENE, history=False).impacts[0]
    hits = [simulate_time_stepping(SCENE, step=step * factor, history=False).impacts[0] for factor in PHASES]
    errors = [(hit.time - exact.time, hit.rate_after / exact.rate_after - 1) for hit in hits]
    shift, rate = np.sqrt(np.mean(np.square(errors), axis=0))
    return float(shift), float(rate)


def timed(
    solver: str, parameter: str, values: Sequence[float], simulated: Callable[..., Response]
) -> tuple[EngineRun, ...]:
    """Return runs of one of our own solvers, one for each level."""
    rounds = [[simulated(SCENE, history=False, **{parameter: value}) for _ in range(ROUNDS)] for value in values]
    return tuple(
        EngineRun(solver, solver, "", parameter, value, error_of(runs[0]), min(run.cpu_seconds for run in runs))
        for value, runs in zip(values, rounds, strict=True)
    )


@functools.cache
def own_runs() -> tuple[EngineRun, ...]:
    """Return runs of the model's fixed-step integrator."""
    return timed(OWN, "step", OWN_STEPS, simulate_time_stepping)


@functools.cache
def engine_runs() -> tuple[EngineRun, ...]:
    """Return runs of every installed engine: each variant at all its levels."""
    return tuple(
        _engine_run(engine, name, level)
        for engine in map(get_engine, installed_engines())
        for name, variant in engine.variants.items()
        for level in variant.levels
    )


def _engine_run(engine, name, level):
    """Run the scene in a variant of an engine at one of its levels."""
    variant = engine.variants[name]
    settings = {"history": False, "compare": False, variant.accuracy_parameter: level}
    response = engine.simulate(SCENE, variant=name, **settings)
    error = math.nan if response.outcome == "failed" else error_of(response)
    words = engine.name, f"{engine.name}, {name}", variant.kind, variant.accuracy_parameter
    return EngineRun(*words, level, error, response.cpu_seconds)
