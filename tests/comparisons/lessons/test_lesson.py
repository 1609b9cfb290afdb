"""What every lesson has to have: its symbols explained once, and a question before its controls."""

import re

import pytest

from comparisons.lessons.lesson import SYMBOLS
from comparisons.lessons.topics import lessons

WORDS = re.compile(r"\\text\{[^}]*\}|\\(?:frac|sin|cos|tan|exp|left|right|quad|approx|propto|ddot|dot|[,;!])")
NAME = re.compile(r"\\tilde\{m\}|\\Delta (?:\\phi|t)|(?:\\[a-z]+|[A-Za-z])(?:_(?:\{[a-z]+\}|\\phi|[A-Za-z0-9]))?")


def names_of(tex):
    """The symbols of a formula; an index that counts steps belongs to no name."""
    bare = WORDS.sub(" ", tex).replace(r"_{\phi}", r"_\phi").replace("k+1", "k")
    bare = re.sub(r"\{?\\phi\}?_(?:k|\{k\})", r"\\phi k", bare)
    return {name.replace(r"e_\phi", r"e_{\phi}").strip() for name in NAME.findall(bare)}


def test_names_of_a_formula():
    assert names_of(r"e_{\phi} = 1 - \frac{2 m b^2}{J_O - m \tilde{m} h^2}") == {
        r"e_{\phi}", "m", "b", "J_O", r"\tilde{m}", "h",
    }  # fmt: skip


@pytest.mark.parametrize("lesson", lessons(), ids=lambda lesson: lesson.name)
def test_symbols_of_the_equations_are_explained(lesson):
    assert len(set(lesson.symbols)) == len(lesson.symbols)
    used = set().union(*(names_of(equation.tex) for equation in lesson.equations))
    assert used - {r"\pi"} <= set(lesson.symbols)


def test_no_symbol_is_explained_for_nobody():
    assert {symbol for lesson in lessons() for symbol in lesson.symbols} == set(SYMBOLS)


@pytest.mark.parametrize("lesson", lessons(), ids=lambda lesson: lesson.name)
def test_a_question_stands_before_the_controls(lesson):
    assert lesson.guess.rstrip().endswith("?")


def test_the_labelled_block_stands_at_the_head_of_the_first_three():
    assert [lesson.number for lesson in lessons() if lesson.drawing] == [1, 2, 3]
    block = {"b", "h", r"\gamma", "R", "J_O", r"\phi"}
    assert all(block <= set(lesson.symbols) for lesson in lessons()[:3])
