"""The mistakes study: scripts are run as they are and with a mistake, and a run that is none is a result."""

import math

import pytest
from answered import answered, by_model, by_runs, stored

from comparisons.execution.by_solver import read
from comparisons.execution.cases import Case
from comparisons.execution.plan import Request
from comparisons.execution.results import RESULTS
from comparisons.metrics.scripts import ScriptFailed, run_script
from comparisons.plotting.parts import where
from comparisons.studies import get_study
from comparisons.studies.mistakes import study
from engines import ENGINES, get_engine
from engines.contract import NO_MATTER, Mistake

ABLE = [name for name, engine in ENGINES.items() if engine.mistakes]
STUDY = get_study("mistakes")
SCENES = study.scenes()
# A script of two steps in a table, to which things happen.
STANDING = (
    "import numpy as np\ncontact = 1e-9\ndef simulate():\n    {}\n    return np.zeros((2, 6)) + [[0], [5]], 0.0\n"
)


def found(engine, mistake, scene="released"):
    return study.cost(Case(SCENES[scene], engine, tag={"mistake": mistake}), None)


@pytest.mark.parametrize("engine", ABLE)
@pytest.mark.parametrize("scene", ["released", "released, bearings"])
def test_a_script_as_it_is_is_exact(engine, scene):
    values = found(engine, None, scene)
    assert (values["outcome"], values["reason"]) == ("rocks", None)
    assert values["error"] <= 4e-4 and values["graph"] <= 1e-3
    assert (values["energy"] is None) == (scene != "released") != (values["displacement"] is None)


def test_an_error_between_impacts_shows_in_energy_and_tilt_alone():
    engine = next(name for name in ABLE if "default damping" in ENGINES[name].known_mistakes())
    values = found(engine, "default damping")
    assert values["error"] < 1e-4 and values["energy"] > 5e-3 and values["graph"] > 0.1


@pytest.mark.parametrize("engine", ABLE)
def test_a_per_cent_of_inertia_is_what_the_formula_says(engine):
    """e = 1 - 2 m b^2/J: J/J_c = 4 to one per cent of J_c, of a rectangle."""
    values, scene = found(engine, "inertia + 1 %"), SCENES["released"]
    lost = 1.5 * math.sin(scene.block.slenderness) ** 2
    assert values["energy"] == pytest.approx(lost * (1 - 1 / 1.0025), rel=0.1)


@pytest.mark.parametrize(
    "happens, words",
    [
        ("raise ValueError('no such thing')", "ValueError: no such thing"),
        ("import os; os.abort()", "killed by signal 6"),
        ("import time; time.sleep(60)", "no end within 1 s"),
        ("return np.zeros((2, 6)), 0.0", "its rows are no steps"),
        ("return np.zeros((2, 5)), 0.0", "its rows are no steps"),
    ],
)
def test_a_script_that_does_not_come_to_its_end_says_why(happens, words):
    with pytest.raises(ScriptFailed, match=words):
        run_script({"script.py": STANDING.format(happens)}, 1.0 if "sleep" in happens else 30.0)


def test_a_run_that_is_none_is_a_row_with_its_reason(monkeypatch):
    plain = study.with_mistake

    def broken(engine, scene, mistake):
        return {**plain(engine, scene, mistake), "script.py": STANDING.format("raise SystemExit('it fell apart')")}

    monkeypatch.setattr(study, "with_mistake", broken)
    assert found(ABLE[0], None) == {**study.NOTHING, "outcome": "failed", "reason": "it fell apart"}


def test_without_an_engine_that_has_mistakes_there_is_a_page_and_a_lost_run_is_a_failure(monkeypatch, tmp_path):
    answer = answered(STUDY.plan(Request(("mujoco",))), by_model())[-1]
    assert answer.rows == [] and "no engine" in STUDY.page(stored(tmp_path, "mistakes", answer)).whole().title
    monkeypatch.setattr(study, "QUICK", ())
    failure = {"kind": "time limit", "reason": "no result", "time_limit": 1.0, "message": ""}
    answer = answered(STUDY.plan(Request((ABLE[0],), quick=True)), by_model(failure=lambda case: failure))[-1]
    (row,) = stored(tmp_path, "mistakes", answer).rows
    assert (row["outcome"], row["reason"], row["graph"]) == ("failed", "no result", None)


@pytest.mark.slow
def test_a_quick_study_has_a_row_for_each_mistake(tmp_path):
    answer = answered(STUDY.plan(Request((ABLE[0], "mujoco"), quick=True)), by_runs(tmp_path))[-1]
    known = ENGINES[ABLE[0]].known_mistakes()
    assert [row["mistake"] for row in answer.rows] == [None, *(key for key in known if key in study.QUICK)]


def test_another_text_of_a_script_is_another_run():
    scene, case = SCENES["released"], next(STUDY.plan(Request((ABLE[0],), quick=True))).cases[0]
    assert case.scene == scene and len(case.tag["script"]) == 16
    changed = Mistake("one", "Something", "body", {"import math": "import math as math"})
    texts = [study.with_mistake(get_engine(ABLE[0]), scene, one) for one in (None, changed)]
    assert texts[0] != texts[1]


@pytest.mark.parametrize("engine", ABLE)
def test_in_the_stored_result_each_mistake_costs_more_than_none_but_what_does_not_matter(engine):
    result = read(RESULTS / "mistakes")
    rows = where(result.rows, engine=engine)
    for row in where(rows, group=NO_MATTER):
        assert row["outcome"] == row["expected"], row
        assert (row["error"] or 0.0) <= (4e-4 if row["scene"] in result.settings["on_bearings"] else 3e-5), row
    plain = {row["scene"]: row for row in where(rows, mistake=None)}
    for mistake in ENGINES[engine].known_mistakes().values():
        own = where(rows, mistake=mistake.key)
        assert own and (mistake.group == NO_MATTER or any(_costs(row, plain[row["scene"]]) for row in own)), mistake.key


def _costs(row, plain):
    """Whether a run differs from that without a mistake: in its outcome, or tenfold in an error."""
    return row["outcome"] != row["expected"] or any(
        (row[name] or 0.0) > 10 * plain[name] for name in ("error", "energy", "graph") if plain[name] is not None
    )
