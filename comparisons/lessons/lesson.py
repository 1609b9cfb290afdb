"""What a lesson is: a question, its equations, one picture that answers to controls, what goes wrong, exercises.

Texts are paragraphs with ``$formulas$`` in TeX: a notebook shows them as they are, a page as MathML (`mathml.prose`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import product
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..showing.parts import Table


@dataclass(frozen=True)
class Equation:
    """tex: the formula. number: its place in the paper, "" without one. says: what it means, one sentence."""

    tex: str
    number: str
    says: str


@dataclass(frozen=True)
class Control:
    """What a reader moves: label; values, numbers in order or words; the value at the start; unit and digits."""

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
        """A value as a reader sees it."""
        if isinstance(value, str):
            return value
        return f"{value:.{self.digits}f}".replace("-", "−") + (f" {self.unit}" if self.unit else "")


@dataclass(frozen=True)
class View:
    """What a lesson shows at one place of its controls.

    figure : matplotlib Figure. numbers : {label: (value, unit)}, the value a number or a word. says : the picture in a
    sentence, for those who cannot see it.
    """

    figure: Figure
    numbers: dict[str, tuple[float | str, str]]
    says: str


@dataclass(frozen=True)
class Exercise:
    """A question whose answer is computed: `compute()` is a number in `unit`; `because` says how one finds it."""

    question: str
    compute: Callable[[], float]
    unit: str
    because: str
    digits: int = 3


@dataclass(frozen=True)
class Lesson:
    """One lesson; `view` takes the values of the controls in their order.

    minutes : in a lecture. aims : what one can do afterwards. needs : what one should know before. code : the few lines
    that compute a number of it, `found`; their text is a cell of the notebook. playground : where the playground's
    sliders stand, as its address after #. table : rows beside the picture that need not move.
    """

    number: int
    name: str
    title: str
    question: str
    aims: tuple[str, ...]
    needs: str
    minutes: int
    equations: tuple[Equation, ...]
    controls: tuple[Control, ...]
    view: Callable[..., View]
    look: str
    wrong: tuple[str, ...]
    exercises: tuple[Exercise, ...]
    code: Callable[[], object]
    playground: str
    table: Callable[[], Table] | None = field(default=None)

    def first(self) -> View:
        """The view that stands there before anything is moved."""
        return self.view(*(control.start for control in self.controls))

    def places(self) -> list[tuple[float | str, ...]]:
        """Every place of the controls, the last one changing fastest."""
        return list(product(*(control.values for control in self.controls)))
