"""The integrators of the speed-error study: each solves the problems, and error and time are of the same runs."""

import itertools

import pytest
from answered import answered, by_runs

from analytic.errors import SettingError
from analytic.twin import METHODS as OFFERED
from comparisons.running.plan import Request
from comparisons.showing.parts import where
from comparisons.studies.speed_error import integrators
from comparisons.studies.speed_error.cases import entries, problem_trials
from comparisons.studies.speed_error.integrators import METHODS, PROBLEMS, run_of
from comparisons.studies.speed_error.study import TICK, measure, plan

# (engine, variant): relative tolerance, and what its error then stays below
REACHED = {
    ("analytic", "kernel"): (1e-16, 1e-13),
    ("scipy", "DOP853"): (1e-11, 1e-8),
    ("scipy", "RK45"): (1e-9, 2e-8),
    ("scipy", "LSODA"): (1e-11, 1e-8),
    ("scipy", "Radau"): (1e-6, 1e-5),
}


@pytest.mark.parametrize("problem", PROBLEMS)
@pytest.mark.parametrize("name", REACHED)
def test_every_integrator_reaches_the_reference_with_all_impacts(problem, name):
    (engine, variant), (tolerance, most) = name, REACHED[name]
    tilt, impacts = run_of(problem, engine, variant, tolerance)()
    assert impacts == PROBLEMS[problem].impacts and PROBLEMS[problem].error(tilt) < most


def test_methods_are_those_the_twin_offers():
    assert set(METHODS) == set(OFFERED) == {variant for engine, variant in REACHED if engine == "scipy"}


@pytest.fixture
def few(monkeypatch):
    """The study with two integrators at a setting each, that gives up when it is told to."""
    levels = {("analytic", "kernel"): [(), (1e-12,)], ("scipy", "DOP853"): [(), (1e-11, 1e-10)]}  # full, quick
    monkeypatch.setattr(integrators, "TOLERANCES", levels)
    run_of.cache_clear()
    yield
    run_of.cache_clear()


def test_error_and_time_are_of_the_same_runs(few, monkeypatch):
    case = next(one.case(0) for one in entries(problem_trials(), (), True) if one.engine == "scipy")
    called = itertools.count(1)

    def run():
        return -PROBLEMS["problem A"].reference - 0.25 * next(called), 10

    monkeypatch.setitem(integrators.INTEGRATORS, ("scipy", "DOP853"), lambda *_: run)
    values = measure(case, None)
    error = values["errors"]["horizon_tilt"]
    assert error == pytest.approx(next(called) - 1)  # of the last timed run, and of the size of its tilt
    assert error > 100  # a run this short is repeated
    assert values["errors"]["lost"] == 0 and 0 < values["cost"]["cpu_seconds"] < TICK


def test_the_problems_run_and_one_that_gives_up_is_reported_and_not_timed(few, monkeypatch, tmp_path):
    def gives_up(problem, tolerance):
        raise ValueError("f(a) and f(b) must have different signs")

    for fails in (False, True):
        if fails:
            run_of.cache_clear()
            monkeypatch.setitem(integrators.INTEGRATORS, ("scipy", "DOP853"), gives_up)
        rows = answered(plan(Request(quick=True), scene="problem A"), by_runs(tmp_path / str(fails)))[-1].rows
        (kernel, *others) = where(rows, part="work-precision")
        assert {row["scene"] for row in rows} == {"problem A"}
        assert (kernel["engine"], kernel["timings"]) == ("analytic", 3) and len(others) == 2
        assert kernel["cpu_low"] <= kernel["cpu_seconds"] <= kernel["cpu_high"] and kernel["repeatable"]
        for row in others:
            assert ("cpu_seconds" in row) != fails == bool(row["failure"])
            assert fails and "different signs" in str(row["failure"]) or row["cpu_seconds"] > 20 * kernel["cpu_seconds"]


def test_a_scene_that_is_none_is_refused():
    with pytest.raises(SettingError, match="--scene problem C: no such scene; give one of free-rigid, .*problem B"):
        next(plan(Request(quick=True), scene="problem C"))
