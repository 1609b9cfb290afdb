"""``rocking study``: all of them side by side, and a stored result checked (running/test_check.py: how)."""

import dataclasses
import json
import shutil
from operator import itemgetter
from pathlib import Path
from unittest.mock import Mock

import pytest
from engine_cases import ACCURATE

from comparisons.commands import study as command
from comparisons.execution import runner as module
from comparisons.execution.by_solver import read
from comparisons.execution.plan import Computed, Study
from comparisons.execution.results import RESULTS
from comparisons.execution.runner import Check, compute
from comparisons.metrics import agreement
from comparisons.metrics import agreement as tolerances
from comparisons.plotting.parts import Page
from comparisons.report.answer import stored_studies
from comparisons.studies.rows import read_study


def _plan(ask):
    return Computed({"quick": ask.quick}, [{"value": 1.5}], name="")
    yield  # a plan is a generator


def _drawing(ask, *, seed: int | None = None):
    return Computed({"seed": seed}, [{"value": 1.5}])
    yield


def _weighing(ask, *, mass: float = 1.0):
    return Computed({"mass": mass}, [{"engine": name, "mass": mass} for name in ask.engines])
    yield


def test_results_lie_side_by_side_and_a_second_call_keeps_them(rocking, monkeypatch, tmp_path):
    monkeypatch.setattr(command, "BUILT_IN", ("first", "second"))
    monkeypatch.setattr(command, "get_study", lambda name: Study(name, "Asks for no run?", _plan))
    for _ in range(2):
        status, out, _ = rocking("study", "all", "--quick", "--engine", "exudyn", "--output", tmp_path)
        assert status == 0 and [Path(line).name for line in out.split()] == ["first", "second"]
    names = {file.relative_to(tmp_path).as_posix() for file in tmp_path.rglob("*.json")}
    assert names == {f"{name}/{solver}.json" for name in ("first", "second") for solver in ("analytic", "exudyn")}


@pytest.mark.parametrize("differences, status", [((), 0), (("exudyn: peak: stored 1, now 2",), 1)])
def test_status_is_whether_all_hold_and_a_seed_repeats_the_draw(rocking, monkeypatch, differences, status):
    check_all = Mock(return_value=[Check("restitution", 1, 4, 60, 1408, differences)])
    monkeypatch.setattr(module, "check_all", check_all)
    for words in ([], [], ["--seed", "7", "--write"]):
        result, out, _ = rocking("study", "restitution", "--check", "4", "--output", "mine", *words)
        assert result == status and check_all.call_args.args[:3] == ("restitution", "mine", 4)
        assert f"{4 - len(differences)} of 4 runs hold" in out and all(difference in out for difference in differences)
    seeds, records = zip(*((call.args[3], call.kwargs["record"]) for call in check_all.call_args_list), strict=True)
    assert seeds[0] != seeds[1] and seeds[2] == 7 and records == (False, False, True)


def test_a_seed_is_the_plans_where_it_takes_one_and_else_belongs_to_a_check(rocking, monkeypatch, tmp_path):
    for name, plan, result in (
        ("draws", _drawing, (0, "")),
        ("draws-nothing", _plan, (2, "Error: --seed 3: belongs to --check; this study draws nothing by a seed\n")),
    ):
        monkeypatch.setattr(command, "get_study", lambda name, plan=plan: Study(name, "Asks?", plan, __name__))
        status, _, err = rocking("study", name, "--seed", "3", "--output", tmp_path / name)
        assert status == result[0] and (not status or err == result[1])
    assert read(tmp_path / "draws" / "draws").settings["seed"] == 3
    assert rocking("study", "stability", "--write")[::2] == (2, "Error: --write: belongs to --check\n")


def test_an_engine_is_run_alone_with_the_options_of_the_result_that_is_there(rocking, monkeypatch, tmp_path):
    monkeypatch.setattr(command, "get_study", lambda name: Study("weighs", "Asks?", _weighing, __name__))
    words, path = ("study", "restitution", "--output", tmp_path, "--engine"), tmp_path / "weighs"
    assert rocking(*words, "pybullet", "--mass", "2")[0] == 0
    before = {file.name: file.read_bytes() for file in path.iterdir()}
    status, out, err = rocking(*words, "exudyn")  # the option's default does not count as given
    assert status == 0 and out.split() == [str(path), str(tmp_path / "weighs.html")], err
    assert sorted(read(path).rows, key=itemgetter("engine")) == [
        {"engine": name, "mass": 2.0} for name in ("exudyn", "pybullet")
    ]
    after = {file.name: file.read_bytes() for file in path.iterdir()}
    assert {name: after[name] for name in before} == before and after.keys() - before.keys() == {"exudyn.json"}
    for more, message in (
        (("--mass", "1"), f"--mass 1.0: {path} was computed with 2.0; leave it out"),
        (("--quick",), f"--quick: {path} was computed in full; leave it out"),
        (("--check", "3"), "--check: takes a result as it is; leave --quick, --engine, --scheduler, --replot out"),
    ):
        status, _, err = rocking(*words, "exudyn", *more)
        assert status == 2 and err.startswith(f"Error: {message}")


def test_where_no_engine_is_to_be_compared_all_is_computed_anew(tmp_path):
    weighs = Study("weighs", "Asks?", _weighing, __name__)
    for engines, mass in ((("exudyn",), 2.0), ((), 3.0)):
        (path,) = compute(weighs, tmp_path, engines=engines, mass=mass, progress=False)
        assert (read(path).settings["mass"], len(read(path).rows)) == (mass, len(engines))
    assert [file.name for file in path.iterdir()] == ["analytic.json"]


def test_the_folder_one_is_in_is_shown_by_its_name(rocking, monkeypatch, tmp_path):
    monkeypatch.chdir(shutil.copytree(RESULTS / "fragility", tmp_path / "fragility"))
    assert rocking("study", "fragility", "--replot", ".", "--output", "page")[:2] == (0, "page/fragility.html\n")
    assert rocking("study", "fragility", "--replot", "..")[::2] == (
        2,
        f"Error: {tmp_path.name}: holds results, and is none; give one of its folders, such as fragility\n",
    )


def page(result):
    """Of the studies above."""
    return Page("It asks", ())


def test_a_damaged_result_is_one_message_of_replot(rocking, tmp_path):
    path = shutil.copytree(RESULTS / "restitution", tmp_path / "restitution")
    (path / "exudyn.json").write_text((path / "exudyn.json").read_text()[:-200])
    for study, message in (
        ("restitution", "restitution/exudyn.json: "),
        ("stability", "restitution: a result of restitution; give one that rocking study stability wrote\n"),
    ):
        status, out, err = rocking("study", study, "--replot", path, "--output", tmp_path / "page")
        assert (status, out) == (2, "") and err.startswith(f"Error: {message}") and err.count("\n") == 1
        shutil.copy(RESULTS / "restitution" / "exudyn.json", path)
    assert not (tmp_path / "page").exists()


@pytest.fixture
def row():
    """Of the tolerance table: the peak tilt of exudyn."""
    return next(
        row
        for row in tolerances.TABLE
        if (row.engine, row.variant, row.quantity) == ("exudyn", ACCURATE["exudyn"], "peak tilt")
    )


def test_verify_measures_each_row_and_names_the_one_that_fails(rocking, monkeypatch, tmp_path, row):
    wrong = dataclasses.replace(row, quantity="peak tilt, held to nothing", bound=1e-12)
    monkeypatch.setattr(tolerances, "TABLE", (row, wrong))
    file = tmp_path / "verify.json"
    words = ("verify", "--engine", "exudyn", "--json", file, "--output", tmp_path / "studies")
    status, out, _ = rocking(*words)
    assert status == 1 and "1 of 2 tolerances hold" in out
    assert ["held to nothing" in line for line in out.splitlines() if "FAILS" in line] == [True]
    content = json.loads(file.read_text())
    assert [row["holds"] for row in content["rows"]] == [True, False]
    assert content["rows"][0]["found"] == content["rows"][1]["found"] > 0
    assert read_study(tmp_path / "studies" / "tolerances").rows == [
        {"part": "tolerance", **row} for row in content["rows"]
    ]
    (shown,) = stored_studies(tmp_path / "studies")
    assert shown.section.title == "Agreement tolerances: 1 of 2 do not hold" and shown.section.age is None


def test_without_a_bound_nothing_holds_or_fails_and_what_was_found_is_said(rocking, monkeypatch, tmp_path, row):
    free = dataclasses.replace(row, bound=None, measured=None)
    lost = dataclasses.replace(free, measure=Mock(side_effect=agreement.Unmeasurable("no impact")))
    words = ("verify", "--engine", "exudyn", "--variant", row.variant)
    for rows, status in (((free,), 0), ((free, lost), 1)):
        monkeypatch.setattr(tolerances, "rows", lambda engine, variant, rows=rows: rows)
        ended, out, _ = rocking(*words, "--json", tmp_path / "verify.json", "--output", tmp_path)
        assert ended == status and " hold." not in out and "FAILS" not in out
        assert f"no bound stated, so nothing holds or fails; 1 of {len(rows)} quantities measured." in out
        shown = json.loads((tmp_path / "verify.json").read_text())["rows"]
        assert [row["holds"] for row in shown] == [None] * len(rows) and shown[0]["found"] > 0
        assert [row["holds"] for row in read_study(tmp_path / "tolerances").rows] == [None] * len(rows)
    assert free.check({}) == shown[0]["found"]
