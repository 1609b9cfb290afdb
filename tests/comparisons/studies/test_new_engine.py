"""An engine from outside is in every study, with no line here that knows it: its cases, its words, its pictures.

Two fakes: one whose adapter applies the impact, and one that says it decides it, with an accuracy parameter
that no engine here has.
"""

import dataclasses
import importlib
import itertools
import sys

import pytest
from answered import answered, by_model, by_runs, stored
from installed_package import FAKE_ENGINE, install_fake_engine
from record_files import pairs
from table_tests import published

import engines
from analytic import synthetic_motion
from comparisons.report.runs import restitution_cases
from comparisons.running.by_solver import read
from comparisons.running.plan import Request
from comparisons.running.provenance import RESULTS, json_ready
from comparisons.showing.parts import where
from comparisons.studies import BUILT_IN, get_study
from comparisons.studies.caryatid.runs import simulations
from comparisons.studies.overturning import study as overturning
from comparisons.studies.restitution.cases import CARYATID_BASE, Grid
from comparisons.studies.rows import wrong_with
from comparisons.studies.shake_table import campaign
from comparisons.studies.shake_table import study as shake_table
from comparisons.studies.speed_error.cases import near_overturning
from engines.plugins import find_engines
from engines.simulating import Simulator

ASK, ASK_ALL = Request(("crude",), quick=True), Request(("crude",))
DECIDING = FAKE_ENGINE.replace("takes_restitution=True,", "").replace("step: float", "span: float")
DECIDING = DECIDING.replace("settings.step", "settings.span").replace('kind="assisted"', 'kind="tuned"')
COLOUR = "#d55e00"
# study: what its plan is given so that it stays short
SHORT = {
    "restitution": {"grid": Grid((0.2,), (None, CARYATID_BASE), (0.6,), ((0.2, None),), 4, ((0.25,), (1.0,), (2.0,)))},
    "fragility": {"scenes": {"free-standing": ("caryatid-rigid", (0.2, 0.3))}, "runs": (40, 6, 2)},
    "sensitivity": {"scenes": {"free-standing": ("caryatid-rigid", (0.2,))}, "motions": (3, 1, 1)},
    "statues": {"boundaries": 1, "seed": 1, "scenes": 12, "sliders": 80},
    "stability": {"names": ("uplift 0.99", "critical pulse +0.01")},
    "speed-error": {"keep": lambda entry: entry.engine in ("crude", "analytic"), "repeats": 1},
}


STUDIES = [each if each != "statues" else pytest.param(each, marks=pytest.mark.slow) for each in SHORT]
APPLIES = pytest.param(FAKE_ENGINE, id="applies the impact")
DECIDES = pytest.param(DECIDING, id="decides the impact", marks=pytest.mark.slow)


@pytest.fixture(params=[APPLIES, DECIDES])
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
    yield found["crude"].variants["euler"]
    del sys.modules["crude_engine"]


def shown(study, found, tmp_path):
    """The study's section of an answer that went through a result file."""
    result = stored(tmp_path, study.name, found)
    section, finding = study.page(result).whole(), study.page(result).opening()
    assert all(len(row) == len(table.columns) for table in section.tables for row in table.rows)
    assert finding is None or rows_with(finding) or drawn(finding)
    for judgement in study.judgements(result):
        assert "crude" in {engine for engine, _ in judgement.marks}
    return section


def drawn(section):
    return any(COLOUR in figure.svg.decode().lower() for figure in section.figures)


def rows_with(section):
    return [row for table in section.tables for row in table.rows if any("crude" in str(cell) for cell in row)]


@pytest.mark.parametrize("name", STUDIES)
def test_a_study_runs_and_shows_it(crude, tmp_path, name):
    study = get_study(name)
    more = {"scenes": [near_overturning("one-sine")]} if name == "speed-error" else {}
    as_model = name in ("fragility", "sensitivity")
    run = by_model() if as_model else by_runs(tmp_path)
    found = answered(study.plan(ASK, **SHORT[name], **more), run)[-1]
    section = shown(study, found, tmp_path)
    assert rows_with(section) and (name == "stability" or drawn(section))  # which shows words alone
    # the fake may blow up under scenes of any kind
    assert name == "statues" or not [row for row in found.rows if row.get("failure")]


FAILURES = (
    {"kind": "crash", "reason": "the worker process ended", "exit_code": -11, "message": "SIGSEGV"},
    {"kind": "time limit", "reason": "no result", "time_limit": 300.0, "message": ""},
    {"kind": "solver", "reason": "not finite", "message": "step 3", "last_state": {"time": 0.1}},
    {"kind": "exception", "reason": "ValueError: x", "message": "x"},
)


def failing(**options):
    """Answers batches by the model, but for runs of the fake, which fail in every way in turn."""
    kinds = itertools.cycle(FAILURES)
    return by_model(failure=lambda case: next(kinds) if case.solver == "crude" else None, **options)


@pytest.mark.parametrize("crude", [APPLIES], indirect=True)
@pytest.mark.parametrize("name", [each for each in STUDIES if each != "stability"])  # which needs runs
def test_runs_of_it_that_fail_make_rows_that_are_declared_and_shown(crude, tmp_path, name):
    study = get_study(name)
    more = {"scenes": [near_overturning("one-sine")]} if name == "speed-error" else {}
    found = answered(study.plan(ASK, **SHORT[name], **more), failing())[-1]
    study.page(stored(tmp_path, name, found)).whole()


@pytest.mark.parametrize("crude", [APPLIES], indirect=True)
def test_so_they_do_in_the_longer_studies(crude, monkeypatch, tmp_path):
    grid = dataclasses.replace(overturning.QUICK, grounds=("rigid ground",), size=(60, 8))
    monkeypatch.setitem(overturning.STEPPING, "levels", (1e-2,))
    monkeypatch.setitem(engines.ENGINES["crude"].variants, "euler", dataclasses.replace(crude, kind="tuned"))
    records = str(pairs(tmp_path, 2))
    (paper, _), *_ = answered(simulations(synthetic_motion(), ASK.engines, True), failing(history=True))
    rows = {
        "overturning": answered(get_study("overturning").plan(ASK, grid), failing())[-1].rows,
        "recorded": answered(get_study("recorded").plan(ASK, records=records), failing(history=True))[-1].rows,
        "caryatid": paper,
    }
    for kind, some in rows.items():
        failed = [row for row in json_ready(some) if row.get("failure") or row["part"] == "failure"]
        assert len(failed) >= len(FAILURES) and not [wrong for row in failed if (wrong := wrong_with(row, kind))]


def test_the_overturning_study_runs_and_shows_it(crude, monkeypatch, tmp_path):
    monkeypatch.setitem(overturning.STEPPING, "levels", (1e-2,))
    grid = dataclasses.replace(overturning.QUICK, grounds=("rigid ground",), size=(60, 8))
    study = get_study("overturning")
    found = answered(study.plan(ASK, grid), by_model())[-1]
    section = shown(study, found, tmp_path)
    assert section.tables[0].rows[0][:2] == ["crude, euler", "trusted"] and drawn(section)
    assert crude.applies_impact != bool(where(found.rows, part="refinement", engine="crude"))


@pytest.mark.parametrize("crude", [APPLIES], indirect=True)
def test_the_study_of_the_paper_runs_and_shows_it(crude, tmp_path):
    """Its simulations; what the analytic model alone finds is taken from the stored result."""
    stored, plan = (read(RESULTS / "caryatid-under-synthetic"), simulations(synthetic_motion(), ASK.engines, True))
    ((rows, histories),) = answered(plan, by_model(history=True))
    assert {row["engine"] for row in rows} == {"analytic", "crude"}
    assert {f"{scene}/crude/tilt" for scene in ("free-standing", "isolated")} <= histories.keys()
    rows = [row for row in stored.rows if row.get("engine") is None] + rows
    section = shown(get_study("caryatid"), dataclasses.replace(stored, rows=rows), tmp_path)
    ends = {row[0]: row[2] for row in rows_with(section)}
    assert len(ends) >= 6 and ends["isolated Caryatid"] == "stands" and drawn(section)


def test_the_report_runs_it(crude):
    cases = restitution_cases(ASK.engines, [near_overturning("one-sine").scene])
    assert {case.variant for case in cases if case.solver == "crude"} == {"euler"}


def test_every_study_of_this_project_is_covered():
    # recorded, shake-table: below; and test_mistakes
    own_tests = {"overturning", "caryatid", "recorded", "mistakes", "shake-table"}
    assert set(BUILT_IN) == SHORT.keys() | own_tests


@pytest.mark.parametrize("crude", [APPLIES], indirect=True)
def test_the_study_of_recorded_motions_runs_it_where_it_is_tuned(crude, monkeypatch, tmp_path):
    kind = dataclasses.replace(crude, kind="tuned")
    monkeypatch.setitem(engines.ENGINES["crude"].variants, "euler", kind)
    study = get_study("recorded")
    found = answered(study.plan(ASK, records=str(pairs(tmp_path, 2))), by_model(history=True))[-1]
    assert rows_with(shown(study, found, tmp_path))


@pytest.mark.parametrize("crude", [APPLIES], indirect=True)
def test_the_study_of_a_shake_table_runs_it_on_some_of_the_tests(crude, monkeypatch, tmp_path):
    monkeypatch.setattr(campaign, "GRID", 9)
    monkeypatch.setattr(shake_table, "KINDS", ({},))
    place = tmp_path / "tests"
    place.mkdir()
    plan = get_study("shake-table").plan(ASK_ALL, data=str(published(place)))
    found = answered(plan, by_model())[-1]
    assert rows_with(shown(get_study("shake-table"), found, tmp_path))
    row = where(found.rows, part="engine", engine="crude")[0]
    assert row["size"] == len(found.settings["tests"]) / shake_table.OTHERS
