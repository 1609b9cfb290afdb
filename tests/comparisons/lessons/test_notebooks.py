"""Every notebook runs from top to bottom, and its few lines give the lesson's own number."""

import runpy
import textwrap

import pytest

from comparisons.lessons import engine_runs
from comparisons.lessons.notebook import code_of, notebook_of
from comparisons.lessons.topics import NAMES, lesson
from engines import installed_engines

pytest.importorskip("marimo", reason="needs marimo: pip install marimo")

# The place of the number that the few lines compute: an exercise's, or None for the picture's first.
PLACES = {"tipping": None, "impacts": 0, "bearing": 0, "caryatid": 1, "corner": 0, "chaos": 2, "cost": 2, "checks": 0}
QUICK = ("impacts", "checks")


@pytest.fixture
def run(tmp_path):
    """run(name) -> (outputs, definitions) of the lesson's notebook."""

    def of(name):
        file = tmp_path / f"{name}.py"
        file.write_text(notebook_of(lesson(name)), encoding="utf-8")
        return runpy.run_path(str(file))["app"].run()

    return of


def expected(name):
    if PLACES[name] is not None:
        return lesson(name).exercises[PLACES[name]].compute()
    return lesson(name).first().numbers["peak tilt / γ"][0]


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
def test_it_runs_to_its_end(name, run):
    outputs, definitions = run(name)
    assert definitions["found"] == pytest.approx(expected(name), rel=1e-9)
    assert len(outputs) == 6 and outputs[-1] is not None


@pytest.mark.slow
@pytest.mark.parametrize("engine", installed_engines())
@pytest.mark.parametrize("name", ["corner", "cost"])
def test_it_runs_with_one_engine(name, engine, only, run):
    only((engine,))
    _, definitions = run(name)
    assert definitions["found"] == pytest.approx(expected(name), rel=1e-9)
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
