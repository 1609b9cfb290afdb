"""The integrators of the speed-error study: each solves the problems, and error and time are of the same runs."""

import itertools

import pytest
from answered import answered, by_runs, stored

from analytic.errors import SettingError
from analytic.twin import METHODS as OFFERED
from comparisons.running.plan import Request
from comparisons.showing.parts import where
from comparisons.studies import get_study
from comparisons.studies.speed_error import integrators, page
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


def found(folder):
    """The study's `Result` of the problems, by runs in this process."""
    asked = plan(Request(quick=True), problem_trials())
    return stored(folder, "speed-error", answered(asked, by_runs(folder))[-1])


def fine(result):
    """The tables of the problems, one for each."""
    return [part for part in get_study("speed-error").page(result).whole().tables if "≤ 10⁻⁹" in part.columns]


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


def test_the_problems_run_and_show_ratios_side_by_side(few, tmp_path):
    result = found(tmp_path)
    rows = where(result.rows, part="work-precision")
    assert len(rows) == 6 and all(row["repeatable"] and not row["failure"] for row in rows)
    assert all(row["timings"] == 3 and row["cpu_low"] <= row["cpu_seconds"] <= row["cpu_high"] for row in rows)
    kept = page.passing(where(page.levels_run(result), scene="problem A"), 1e-9)
    kernel, other = (kept[name] for name in (page.KERNEL, "scipy, DOP853"))
    ratio = other["cpu_seconds"] / kernel["cpu_seconds"]
    assert ratio > 20  # some 300 on a machine left alone
    (table,) = (one for one in fine(result) if one.caption.startswith("problem A"))
    assert [f"({page.number(ratio, 2)} ×" in row[2] for row in table.rows].count(True) == 1


def test_an_integrator_that_gives_up_is_reported_and_not_timed(few, monkeypatch, tmp_path):
    def gives_up(problem, tolerance):
        raise ValueError("f(a) and f(b) must have different signs")

    monkeypatch.setitem(integrators.INTEGRATORS, ("scipy", "DOP853"), gives_up)
    result = found(tmp_path)
    lost = where(result.rows, engine="scipy")
    assert len(lost) == 4 and all(row["failure"] and "cpu_seconds" not in row for row in lost)
    evidence = get_study("speed-error").page(result).whole().evidence
    assert len(evidence) == 4 and "different signs" in evidence[0][0]
    assert not any(row[0] == "scipy, DOP853" for table in fine(result) for row in table.rows)


def test_one_scene_alone_is_asked_for_by_its_name(few, tmp_path):
    asked = plan(Request(quick=True), scene="problem A")
    assert {row["scene"] for row in answered(asked, by_runs(tmp_path))[-1].rows} == {"problem A"}
    with pytest.raises(SettingError, match="--scene problem C: no such scene; give one of free-rigid, .*problem B"):
        next(plan(Request(quick=True), scene="problem C"))
