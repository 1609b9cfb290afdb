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
from made_up_shake_table import published
from record_files import pairs

import engines
from analytic import synthetic_motion
from comparisons.execution.by_solver import read
from comparisons.execution.plan import Request
from comparisons.execution.results import RESULTS, json_ready
from comparisons.plotting.parts import where
from comparisons.report.runs import restitution_cases
from comparisons.studies import BUILT_IN, get_study
from comparisons.studies.caryatid.study import simulations
from comparisons.studies.overturning import study as overturning
from comparisons.studies.restitution.study import CARYATID_BASE, Grid
from comparisons.studies.rows import wrong_with
from comparisons.studies.shake_table import campaign
from comparisons.studies.shake_table import study as shake_table
from comparisons.studies.speed_error.study import near_overturning
from engines.contract import find_engines
from engines.simulating import Simulator

ASK = Request(("crude",), quick=True)
DECIDING = FAKE_ENGINE.replace("takes_restitution=True,", "").replace("step: float", "span: float")
DECIDING = DECIDING.replace("settings.step", "settings.span").replace('kind="assisted"', 'kind="tuned"')
COLOUR = "#d55e00"
STILL = Grid((0.2,), (None, CARYATID_BASE), (0.6,), ((0.2, None),), 4, ((0.25,), (1.0,), (2.0,)))
# study: what its plan is given so that it stays short, by a folder
SHORT = {
    "restitution": lambda folder: {"grid": STILL},
    "fragility": lambda folder: {"scenes": {"free-standing": ("caryatid-rigid", (0.2, 0.3))}, "runs": (40, 6, 2)},
    "sensitivity": lambda folder: {"scenes": {"free-standing": ("caryatid-rigid", (0.2,))}, "motions": (3, 1, 1)},
    "statues": lambda folder: {"boundaries": 1, "seed": 1, "scenes": 12, "sliders": 80},
    "stability": lambda folder: {"names": ("uplift 0.99", "critical pulse +0.01")},
    "speed-error": lambda folder: {
        "keep": lambda entry: entry.engine in ("crude", "analytic"),
        "repeats": 1,
        "scenes": [near_overturning("one-sine")],
    },
    "overturning": lambda folder: {
        "grid": dataclasses.replace(overturning.QUICK, grounds=("rigid ground",), size=(60, 8))
    },
    "recorded": lambda folder: {"records": str(pairs(folder, 2))},
    "shake-table": lambda folder: {"data": str(published(folder))},
}
RUN = ("restitution", "stability", "speed-error", "statues")  # the fake itself; in others the model in its place
SLOW = ("restitution", "speed-error", "statues", "shake-table")


def but(*slow):
    """Studies; these belong to the second command."""
    return [pytest.param(each, marks=pytest.mark.slow) if each in slow else each for each in SHORT]


APPLIES = pytest.param(FAKE_ENGINE, id="applies the impact")
DECIDES = pytest.param(DECIDING, id="decides the impact", marks=pytest.mark.long)


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


def answer_of(name, run, folder):
    """(the answer of a study; its section, after a way through a result file)."""
    study, ask = get_study(name), dataclasses.replace(ASK, quick=name != "shake-table")
    found = answered(study.plan(ask, **SHORT[name](folder)), run)[-1]
    return found, shown(study, found, folder)


def shown(study, found, folder):
    result = stored(folder, study.name, found)
    assert all("crude" in {engine for engine, _ in one.marks} for one in study.judgements(result))
    return study.page(result).whole()


def rows_with(section):
    return [row for table in section.tables for row in table.rows if any("crude" in str(cell) for cell in row)]


def drawn(section):
    return any(COLOUR in figure.svg.decode().lower() for figure in section.figures)


@pytest.fixture
def short(crude, monkeypatch):
    """Coarse grids."""
    monkeypatch.setitem(overturning.STEPPING, "levels", (1e-2,))
    monkeypatch.setattr(campaign, "GRID", 9)
    monkeypatch.setattr(shake_table, "KINDS", ({},))


@pytest.fixture
def tuned(crude, monkeypatch):
    """As else recorded motions are not for it."""
    monkeypatch.setitem(engines.ENGINES["crude"].variants, "euler", dataclasses.replace(crude, kind="tuned"))


@pytest.mark.parametrize("name", but(*SLOW))
def test_a_study_runs_and_shows_it(short, request, tmp_path, name):
    if name == "recorded":
        request.getfixturevalue("tuned")
    found, section = answer_of(name, by_runs(tmp_path) if name in RUN else by_model(history=True), tmp_path)
    assert rows_with(section) and (name in ("stability", "recorded", "shake-table") or drawn(section))
    # the fake may blow up under scenes of any kind
    assert name == "statues" or not [row for row in found.rows if row.get("failure")]
    if name == "overturning":
        applies = engines.ENGINES["crude"].variants["euler"].applies_impact
        assert applies != bool(where(found.rows, part="refinement", engine="crude"))
    if name == "shake-table":
        row = where(found.rows, part="engine", engine="crude")[0]
        assert row["size"] == len(found.settings["tests"]) / shake_table.OTHERS


FAILURES = (
    {"kind": "crash", "reason": "the worker process ended", "exit_code": -11, "message": "SIGSEGV"},
    {"kind": "time limit", "reason": "no result", "time_limit": 300.0, "message": ""},
    {"kind": "solver", "reason": "not finite", "message": "step 3", "last_state": {"time": 0.1}},
    {"kind": "exception", "reason": "ValueError: x", "message": "x"},
)


def failing():
    """Answers batches by the model, but for runs of the fake, which fail in every way in turn."""
    kinds = itertools.cycle(FAILURES)
    return by_model(failure=lambda case: next(kinds) if case.solver == "crude" else None, history=True)


@pytest.mark.parametrize("crude", [APPLIES], indirect=True)
# but for stability, which needs runs
@pytest.mark.parametrize("name", [each for each in but("statues", "shake-table") if each != "stability"])
def test_runs_of_it_that_fail_make_rows_that_are_declared_and_shown(short, tuned, tmp_path, name):
    found, _ = answer_of(name, failing(), tmp_path)
    assert [row for row in found.rows if row.get("failure") or row["part"] == "failure" or row.get("failed")]


@pytest.mark.parametrize("crude", [APPLIES], indirect=True)
def test_the_study_of_the_paper_runs_and_shows_it(crude, tmp_path):
    """Its simulations; what the analytic model alone finds is taken from the stored result."""
    stored = read(RESULTS / "caryatid-under-synthetic")
    plans = (simulations(synthetic_motion(), ASK.engines, True) for _ in range(2))
    (rows, histories), (failed, _) = (
        answered(plan, run)[0] for plan, run in zip(plans, (by_model(history=True), failing()), strict=True)
    )
    assert {row["engine"] for row in rows} == {"analytic", "crude"}
    assert {f"{scene}/crude/tilt" for scene in ("free-standing", "isolated")} <= histories.keys()
    assert not [wrong for row in json_ready(failed) if (wrong := wrong_with(row, "caryatid"))]
    rows = [row for row in stored.rows if row.get("engine") is None] + rows
    section = shown(get_study("caryatid"), dataclasses.replace(stored, rows=rows), tmp_path)
    ends = {row[0]: row[2] for row in rows_with(section)}
    assert len(ends) >= 6 and ends["isolated Caryatid"] == "stands" and drawn(section)


def test_the_report_runs_it(crude):
    cases = restitution_cases(ASK.engines, [near_overturning("one-sine").scene])
    assert {case.variant for case in cases if case.solver == "crude"} == {"euler"}


def test_every_study_of_this_project_is_covered():
    assert set(BUILT_IN) == SHORT.keys() | {"caryatid", "mistakes", "stack"}  # which need scripts, or two blocks
