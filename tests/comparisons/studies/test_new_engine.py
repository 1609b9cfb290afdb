"""An engine from outside is in every study, with no line here that knows it: its cases, its words, its pictures.

Two fakes: one whose adapter applies the impact, and one that says it decides it, with a knob no engine here has.
"""

import dataclasses
import importlib
import sys

import pytest
from answered import answered, by_model, by_runs, stored
from installed_package import FAKE_ENGINE, install_fake_engine
from record_files import pairs

import engines
from analytic import synthetic_motion
from comparisons.report.runs import restitution_cases
from comparisons.running.provenance import RESULTS, read_result
from comparisons.running.study import Ask
from comparisons.sheet.problems import PROBLEMS
from comparisons.showing.rows import where
from comparisons.studies import BUILT_IN, get_study
from comparisons.studies.caryatid.runs import simulations
from comparisons.studies.overturning import study as overturning
from comparisons.studies.restitution.cases import CARYATID_BASE, Grid
from comparisons.studies.speed_error import growth
from comparisons.studies.speed_error.cases import near_overturning, trials
from engines.plugins import find_engines
from engines.simulating import Simulator

ASK = Ask(("crude",), quick=True)
DECIDING = FAKE_ENGINE.replace("takes_restitution=True,", "").replace("step: float", "span: float")
DECIDING = DECIDING.replace("settings.step", "settings.span")
COLOUR = "#d55e00"
# study: what its plan is given so that it stays short
SHORT = {
    "restitution": {"grid": Grid((0.2,), (None, CARYATID_BASE), (0.6,), ((0.2, None),), 4)},
    "fragility": {"scenes": {"free-standing": ("caryatid-rigid", (0.2, 0.3))}, "runs": (40, 6, 2)},
    "matters": {"scenes": {"free-standing": ("caryatid-rigid", (0.2,))}, "motions": (3, 1, 1)},
    "autopsy": {},
    "random-scenes": {"seed": 1},
    "stability": {"names": ("uplift 0.99", "critical pulse +0.01")},
    "speed-error": {"keep": lambda entry: entry.engine in ("crude", "analytic"), "grow": False, "repeats": 1},
}


@pytest.fixture(params=[FAKE_ENGINE, DECIDING], ids=["applies the impact", "decides the impact"])
def crude(request, monkeypatch, tmp_path):
    """A fake, installed for the time of a test; its variant."""
    packages = tmp_path / "packages"
    packages.mkdir()
    monkeypatch.syspath_prepend(install_fake_engine(packages))
    (packages / "crude_engine.py").write_text(request.param)
    importlib.invalidate_caches()
    found, broken = find_engines(engines.BUILT_IN)
    assert broken == {}
    monkeypatch.setitem(engines.ENGINES, "crude", Simulator.of(found["crude"]))
    variant = found["crude"].variants["euler"]
    assert (variant.takes_restitution, variant.knob) == (
        (True, "step") if request.param is FAKE_ENGINE else (False, "span")
    )
    yield variant
    del sys.modules["crude_engine"]


def shown(study, found, tmp_path):
    """The study's section of an answer that went through a result file."""
    result = stored(tmp_path, study.name, found)
    page = study.page(result)
    section, finding = page.whole(), page.opening()
    for one in filter(None, (section, finding)):
        assert all(len(row) == len(table.columns) for table in one.tables for row in table.rows)
    if finding is not None:
        assert finding.title and len(finding.figures) == 1 and finding.measured
        assert rows_with(finding) or drawn(finding)
    judgement = study.judgement(result)
    assert judgement is None or "crude" in {engine for engine, _ in judgement.marks}
    return section


def drawn(section):
    return any(COLOUR in figure.svg.decode().lower() for figure in section.figures)


def rows_with(section):
    return [row for table in section.tables for row in table.rows if any("crude" in str(cell) for cell in row)]


@pytest.mark.parametrize("name", SHORT)
def test_a_study_runs_and_shows_it(crude, tmp_path, name):
    study, options = get_study(name), dict(SHORT[name])
    if name == "speed-error":
        options["scenes"] = [near_overturning()]
    run = by_model() if name in ("fragility", "matters") else by_runs(tmp_path)
    found = answered(study.plan(ASK, **options), run)[-1]
    section = shown(study, found, tmp_path)
    assert rows_with(section)
    assert name == "stability" or drawn(section)  # its picture is a table of words
    failed = [row for row in found.rows if row.get("failure")]
    assert not failed or name == "random-scenes", failed[0]  # where the fake may blow up


def test_the_overturning_study_runs_and_shows_it(crude, monkeypatch, tmp_path):
    monkeypatch.setitem(overturning.STEPPING, "levels", (1e-2,))
    grid = dataclasses.replace(overturning.QUICK, grounds=("rigid ground",), size=(60, 8))
    study = get_study("overturning")
    found = answered(study.plan(ASK, grid), by_model())[-1]
    section = shown(study, found, tmp_path)
    assert section.tables[0].rows[0][:2] == ["crude, euler", "trusted"] and drawn(section)
    (variant,) = (variant for variant in found.settings["variants"] if variant["engine"] == "crude")
    tried = where(found.rows, part="refinement", engine="crude")
    assert variant["applies_impact"] == crude.takes_restitution != bool(tried)


@pytest.mark.parametrize("crude", [FAKE_ENGINE], indirect=True)
def test_the_study_of_the_paper_runs_and_shows_it(crude, tmp_path):
    """Its simulations; what the analytic model alone finds is taken from the stored result."""
    stored = read_result(RESULTS / "caryatid-under-synthetic.json")
    plan, batches = simulations(synthetic_motion(), ASK.engines, quick=True), []
    try:
        batch = next(plan)
        while True:
            batches.append(batch)
            batch = plan.send(by_model(history=True)(batch))
    except StopIteration as stop:
        rows, histories = stop.value
    assert {case.solver for batch in batches for case in batch.cases} == {"analytic", "crude"}
    assert {f"{scene}/crude/tilt" for scene in ("free-standing", "isolated")} <= histories.keys()
    rows = [row for row in stored.rows if row.get("engine") is None] + rows
    section = shown(get_study("caryatid"), dataclasses.replace(stored, rows=rows), tmp_path)
    ends = {row[0]: row[2] for row in rows_with(section)}
    assert len(ends) >= 6 and ends["isolated Caryatid"] == "stands" and drawn(section)


def test_the_problem_sheet_runs_and_shows_it(crude, monkeypatch, tmp_path):
    monkeypatch.setattr("comparisons.studies.sheet.study.PROBLEMS", PROBLEMS[:1])
    study = get_study("sheet")
    found = answered(study.plan(ASK), by_model(history=True))[-1]
    assert found.rows[0]["error"] < 1e-5  # the model in its place: what interpolation leaves
    assert rows_with(shown(study, found, tmp_path))


def test_the_tolerances_say_that_it_states_none(crude, tmp_path):
    study = get_study("tolerances")
    (found,) = answered(study.plan(ASK), None)
    assert "crude states no tolerances, so none is measured." in shown(study, found, tmp_path).text


def test_the_growth_of_cost_and_the_report_run_it(crude):
    (scene,) = (trial.scene for trial in trials() if trial.name == "isolated-standing")
    assert [case.solver for case in growth.growth_cases(scene, ASK.engines, True)].count("crude") == 3
    cases = restitution_cases(ASK.engines, [near_overturning().scene])
    assert {case.variant for case in cases if case.solver == "crude"} == {"euler"}


def test_every_study_of_this_project_is_covered():
    # surface takes any solver a run at a time: test_surface; kernel takes none; recorded: below
    assert set(BUILT_IN) == {*SHORT, "overturning", "caryatid", "tolerances", "sheet", "surface", "kernel", "recorded"}


@pytest.mark.parametrize("crude", [FAKE_ENGINE], indirect=True)
def test_the_study_of_recorded_motions_runs_it_where_it_is_tuned(crude, monkeypatch, tmp_path):
    kind = dataclasses.replace(crude, tier="tuned")
    monkeypatch.setitem(engines.ENGINES["crude"].variants, "euler", kind)
    study = get_study("recorded")
    found = answered(study.plan(ASK, records=str(pairs(tmp_path, 2))), by_model(history=True))[-1]
    assert rows_with(shown(study, found, tmp_path))
