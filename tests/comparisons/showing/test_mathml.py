"""The lessons' formulas as MathML: every element has the children it needs."""

import re
import xml.etree.ElementTree as xml

import pytest

from comparisons.lessons.export import PAGES, _environment
from comparisons.lessons.topics import lessons
from comparisons.showing.mathml import mathml, prose

CHILDREN = {"mfrac": 2, "msub": 2, "msup": 2, "msubsup": 3, "mover": 2}


def check(text):
    for part in xml.fromstring(text).iter():
        assert len(part) == CHILDREN.get(part.tag, len(part)), text


@pytest.mark.parametrize("lesson", lessons(), ids=lambda lesson: lesson.name)
def test_every_formula_of_a_lesson(lesson):
    for equation in lesson.equations:
        check(mathml(equation.tex, display=True))
    texts = [lesson.question, lesson.look, *lesson.wrong, *(equation.says for equation in lesson.equations)]
    for text in [*texts, *(t for exercise in lesson.exercises for t in (exercise.question, exercise.because))]:
        assert text.count("$") % 2 == 0
        check(f"<p>{prose(text)}</p>")


def test_every_formula_of_the_derivation():
    page = _environment().get_template("derivations.html").render(rocking="", impact="", isolated="")
    found = re.findall("<math.*?</math>", page)
    assert len(found) >= (PAGES / "derivations.html").read_text().count("eq(") - 1 > 10
    check(f"<all>{''.join(found)}</all>")


def test_a_power_of_a_function():
    assert "<msup><mi>sin</mi><mn>2</mn></msup>" in mathml(r"\sin^2 \gamma")


@pytest.mark.parametrize("tex", [r"\unknown", "{a", "a}", r"\frac{a}"])
def test_what_it_does_not_know_is_refused(tex):
    with pytest.raises(ValueError):
        mathml(tex)
