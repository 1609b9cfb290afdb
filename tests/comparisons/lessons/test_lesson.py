"""What every lesson has: symbols explained once, formulas that can be set, a notebook that gives its number."""

import functools
import re
import runpy
import textwrap
import xml.etree.ElementTree as xml

import pytest

from comparisons.lessons import lesson as engine_runs
from comparisons.lessons.export import PAGES, _environment
from comparisons.lessons.lesson import SYMBOLS
from comparisons.lessons.notebook import code_of, notebook_of, open_notebook
from comparisons.lessons.topics import NAMES, corner, cost, lesson, lessons
from comparisons.plotting.diagrams import mathml, prose

WORDS = re.compile(r"\\text\{[^}]*\}|\\(?:frac|sin|cos|tan|exp|left|right|quad|approx|propto|ddot|dot|[,;!])")
NAME = re.compile(r"\\tilde\{m\}|\\Delta (?:\\phi|t)|(?:\\[a-z]+|[A-Za-z])(?:_(?:\{[a-z]+\}|\\phi|[A-Za-z0-9]))?")
CHILDREN = {"mfrac": 2, "msub": 2, "msup": 2, "msubsup": 3, "mover": 2}


def names_of(tex):
    """The symbols of a formula; an index that counts steps belongs to no name."""
    bare = WORDS.sub(" ", tex).replace(r"_{\phi}", r"_\phi").replace("k+1", "k")
    bare = re.sub(r"\{?\\phi\}?_(?:k|\{k\})", r"\\phi k", bare)
    return {name.replace(r"e_\phi", r"e_{\phi}").strip() for name in NAME.findall(bare)}


def test_every_symbol_is_explained_once_and_a_question_stands_before_the_controls():
    for each in lessons():
        assert len(set(each.symbols)) == len(each.symbols) and each.guess.rstrip().endswith("?")
        used = set().union(*(names_of(equation.tex) for equation in each.equations))
        assert used - {r"\pi"} <= set(each.symbols), each.name
    assert {symbol for each in lessons() for symbol in each.symbols} == set(SYMBOLS)
    assert [each.number for each in lessons() if each.drawing] == [1, 2, 3]  # the labelled block, at their head
    assert all({"b", "h", r"\gamma", "R", "J_O", r"\phi"} <= set(each.symbols) for each in lessons()[:3])


def check(text):
    """Every element of MathML has the children that it needs."""
    for part in xml.fromstring(text).iter():
        assert len(part) == CHILDREN.get(part.tag, len(part)), text


def test_every_formula_is_set():
    for each in lessons():
        texts = [each.question, each.look, *each.wrong, *(equation.says for equation in each.equations)]
        for text in [*texts, *(t for exercise in each.exercises for t in (exercise.question, exercise.because))]:
            assert text.count("$") % 2 == 0
            check(f"<p>{prose(text)}</p>")
        for equation in each.equations:
            check(mathml(equation.tex, display=True))
    page = _environment().get_template("derivations.html").render(rocking="", impact="", isolated="")
    formulas = re.findall("<math.*?</math>", page)
    assert len(formulas) >= (PAGES / "derivations.html").read_text().count("eq(") - 1 > 10
    check(f"<all>{''.join(formulas)}</all>")
    assert "<msup><mi>sin</mi><mn>2</mn></msup>" in mathml(r"\sin^2 \gamma")


@pytest.mark.parametrize("tex", [r"\unknown", "{a", "a}", r"\frac{a}"])
def test_a_formula_that_is_not_known_is_refused(tex):
    with pytest.raises(ValueError):
        mathml(tex)


# The exercise that the few lines answer; in the first lesson it is the picture's number.
PLACES = {"impacts": 0, "bearing": 0, "caryatid": 1, "corner": 0, "chaos": 2, "cost": 2, "checks": 0}


@pytest.mark.parametrize(
    "name", [name if name == "impacts" else pytest.param(name, marks=pytest.mark.slow) for name in NAMES]
)
def test_a_notebook_runs_and_its_few_lines_give_the_lessons_number(name, monkeypatch, tmp_path):
    """In those that run engines, with none here."""
    pytest.importorskip("marimo", reason="needs marimo: pip install marimo")
    runs = functools.cache(engine_runs.engine_runs.__wrapped__)
    for module in (engine_runs, corner, cost):
        monkeypatch.setattr(module, "engine_runs", runs)
    monkeypatch.setattr(engine_runs, "installed_engines", tuple)
    (tmp_path / "notebook.py").write_text(notebook_of(lesson(name)), encoding="utf-8")
    outputs, definitions = runpy.run_path(str(tmp_path / "notebook.py"))["app"].run()
    first = name == "tipping" and lesson(name).first().numbers["peak tilt / γ"][0]
    known = first or lesson(name).exercises[PLACES[name]].compute()
    assert definitions["answer"] == pytest.approx(known, rel=1e-9)
    assert len(outputs) == 6 and outputs[-1] is not None


@pytest.mark.parametrize("name", NAMES)
def test_the_few_lines_stand_in_the_notebook_and_are_few(name):
    code = code_of(lesson(name))
    assert "answer = " in code and "return" not in code and len(code.splitlines()) <= 12
    assert textwrap.indent(code, "    ") in notebook_of(lesson(name))


def test_a_students_work_is_kept_where_it_was_asked_for(tmp_path, monkeypatch, capsys):
    pytest.importorskip("marimo", reason="needs marimo: pip install marimo")
    opened = []
    monkeypatch.setattr("subprocess.call", lambda words: opened.append(words[-1]) or 0)
    file = tmp_path / "mine" / "tipping.py"
    assert open_notebook("tipping", str(file.parent)) == 0
    assert opened == [str(file)] and file.read_text() == notebook_of(lesson("tipping"))
    assert str(file) in capsys.readouterr().err
    file.write_text("changed")
    open_notebook("tipping", str(file.parent))
    assert file.read_text() == "changed"
    open_notebook("tipping")
    assert "--to FOLDER" in capsys.readouterr().err
