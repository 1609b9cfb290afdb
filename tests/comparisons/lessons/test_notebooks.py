"""Every notebook runs from top to bottom, and its few lines give the lesson's own number."""

import functools
import runpy
import textwrap

import pytest

from comparisons.lessons import engine_runs
from comparisons.lessons.notebook import code_of, notebook_of, open_notebook
from comparisons.lessons.topics import NAMES, corner, cost, lesson
from engines import installed_engines

pytest.importorskip("marimo", reason="needs marimo: pip install marimo")

# The exercise that the few lines answer; in the first lesson it is the picture's number.
PLACES = {"impacts": 0, "bearing": 0, "caryatid": 1, "corner": 0, "chaos": 2, "cost": 2, "checks": 0}
QUICK = ("impacts", "checks")


def run(name, folder):
    """The outputs of the lesson's notebook, whose few lines find the lesson's own number."""
    file = folder / f"{name}.py"
    file.write_text(notebook_of(lesson(name)), encoding="utf-8")
    outputs, definitions = runpy.run_path(str(file))["app"].run()
    if name == "tipping":
        known = lesson(name).first().numbers["peak tilt / γ"][0]
    else:
        known = lesson(name).exercises[PLACES[name]].compute()
    assert definitions["found"] == pytest.approx(known, rel=1e-9)
    return outputs


@pytest.mark.parametrize(
    "name", [name if name in QUICK else pytest.param(name, marks=pytest.mark.long) for name in NAMES]
)
def test_it_runs_to_its_end(name, tmp_path):
    outputs = run(name, tmp_path)
    assert len(outputs) == 6 and outputs[-1] is not None


@pytest.mark.parametrize(
    "engines", [(), *(pytest.param((engine,), marks=pytest.mark.long) for engine in installed_engines())], ids=str
)
@pytest.mark.parametrize("name", ["corner", "cost"])
def test_it_runs_with_one_engine_or_none(name, engines, monkeypatch, tmp_path):
    asked = functools.cache(engine_runs.engine_runs.__wrapped__)
    monkeypatch.setattr(engine_runs, "engine_runs", asked)
    for module in (corner, cost):
        monkeypatch.setattr(module, "engine_runs", asked)
    monkeypatch.setattr(engine_runs, "installed_engines", lambda: engines)
    run(name, tmp_path)
    assert tuple({one.solver: 0 for one in asked()}) == engines


@pytest.mark.parametrize("name", NAMES)
def test_the_few_lines_stand_in_the_notebook_and_are_few(name):
    code = code_of(lesson(name))
    assert "found = " in code and "return" not in code and len(code.splitlines()) <= 12
    assert textwrap.indent(code, "    ") in notebook_of(lesson(name))


def test_a_students_work_is_kept_where_it_was_asked_for(tmp_path, monkeypatch, capsys):
    opened = []
    monkeypatch.setattr("subprocess.call", lambda words: opened.append(words[-1]) or 0)
    folder = tmp_path / "mine"
    assert open_notebook("tipping", str(folder)) == 0
    file = folder / "tipping.py"
    assert opened == [str(file)] and file.read_text() == notebook_of(lesson("tipping"))
    assert str(file) in capsys.readouterr().err
    file.write_text("changed")
    open_notebook("tipping", str(folder))
    assert file.read_text() == "changed"
    open_notebook("tipping")
    assert "--to FOLDER" in capsys.readouterr().err
