"""Every notebook runs from top to bottom, and its few lines give the lesson's own number."""

import runpy
import textwrap

import pytest

from comparisons.lessons import engine_runs
from comparisons.lessons.notebook import code_of, notebook_of
from comparisons.lessons.topics import NAMES, lesson
from engines import installed_engines

pytest.importorskip("marimo", reason="needs marimo: pip install marimo")

# The exercise that the few lines answer; in the first lesson it is the picture's number.
PLACES = {"impacts": 0, "bearing": 0, "caryatid": 1, "corner": 0, "chaos": 2, "cost": 2, "checks": 0}
ANSWERS = {name: lesson(name).exercises[place] for name, place in PLACES.items()}
QUICK = ("impacts", "checks")


def run(name, folder):
    """The outputs of the lesson's notebook, whose few lines find the lesson's own number."""
    file = folder / f"{name}.py"
    file.write_text(notebook_of(lesson(name)), encoding="utf-8")
    outputs, definitions = runpy.run_path(str(file))["app"].run()
    known = lesson(name).first().numbers["peak tilt / γ"][0] if name == "tipping" else ANSWERS[name].compute()
    assert definitions["found"] == pytest.approx(known, rel=1e-9)
    return outputs


@pytest.fixture
def only(monkeypatch):
    """only(names): no other engines are installed."""

    def choose(names):
        engine_runs.engine_runs.cache_clear()
        monkeypatch.setattr(engine_runs, "installed_engines", lambda: names)

    yield choose
    engine_runs.engine_runs.cache_clear()


@pytest.mark.parametrize(
    "name", [name if name in QUICK else pytest.param(name, marks=pytest.mark.slow) for name in NAMES]
)
def test_it_runs_to_its_end(name, tmp_path):
    outputs = run(name, tmp_path)
    assert len(outputs) == 6 and outputs[-1] is not None


@pytest.mark.slow
@pytest.mark.parametrize("engine", installed_engines())
@pytest.mark.parametrize("name", ["corner", "cost"])
def test_it_runs_with_one_engine(name, engine, only, tmp_path):
    only((engine,))
    run(name, tmp_path)
    assert {one.solver for one in engine_runs.engine_runs()} == {engine}


def test_without_engines_the_lessons_on_them_still_show_the_fixed_steps(only):
    only(())
    for name in ("corner", "cost"):
        assert lesson(name).first().numbers


@pytest.mark.parametrize("name", NAMES)
def test_the_few_lines_stand_in_the_notebook_and_are_few(name):
    code = code_of(lesson(name))
    assert "found = " in code and "return" not in code and len(code.splitlines()) <= 12
    assert textwrap.indent(code, "    ") in notebook_of(lesson(name))
