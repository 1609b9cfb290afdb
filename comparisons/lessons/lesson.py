"""The type of a lesson: a question, symbols and equations, a guess, a picture with controls, common errors, exercises.

Texts are paragraphs with ``$formulas$`` in TeX: a notebook shows the TeX, a page MathML (`mathml.prose`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from markupsafe import Markup
    from matplotlib.figure import Figure

    from ..showing.parts import Table


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
    """tex: the formula. number: its number in the paper, "" without one. says: its meaning, one sentence."""

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
        """A value as it is shown."""
        if isinstance(value, str):
            return value
        return f"{value:.{self.digits}f}".replace("-", "−") + (f" {self.unit}" if self.unit else "")


@dataclass(frozen=True)
class View:
    """The view of a lesson at one combination of its controls.

    figure : matplotlib Figure. numbers : {label: (value, unit)}, the value a number or a word. says : the picture in a
    sentence, for readers who cannot see it.
    """

    figure: Figure
    numbers: dict[str, tuple[float | str, str]]
    says: str


@dataclass(frozen=True)
class Exercise:
    """A question whose answer is computed: `compute()` is a number in `unit`; `because` explains the solution."""

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
    number of the lesson, `found`; their text is a cell of the notebook. playground : positions of the playground's
    sliders, as its address after #. drawing : at the head of the lesson. table : rows below the picture. example : a
    second picture, without controls, and its caption `says`.
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

    def glossary(self) -> list[tuple[str, str]]:
        """(symbol as TeX, meaning) of each symbol of the lesson."""
        return [(symbol, SYMBOLS[symbol]) for symbol in self.symbols]

    def first(self) -> View:
        """The view at the initial values of the controls."""
        return self.view(*(control.start for control in self.controls))

    def places(self) -> list[tuple[float | str, ...]]:
        """All combinations of the controls, the last one changing fastest."""
        return list(product(*(control.values for control in self.controls)))
