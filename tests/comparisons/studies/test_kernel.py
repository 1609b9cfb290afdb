"""The kernel study: every integrator solves the problems, and error and time are of the same runs."""

import itertools

import pytest
from answered import answered, by_runs, stored

from analytic.twin import METHODS as OFFERED
from comparisons.running.plan import Request
from comparisons.showing.rows import where
from comparisons.studies import get_study
from comparisons.studies.kernel import page, peers, study
from comparisons.studies.kernel.integrators import METHODS
from comparisons.studies.kernel.problems import PROBLEMS
from comparisons.studies.kernel.study import KERNEL, measured, run_of

# (engine, variant): relative tolerance, and what its error then stays below
REACHED = {
    KERNEL: (1e-16, 1e-13),
    ("scipy", "DOP853"): (1e-11, 1e-8),
    ("scipy", "RK45"): (1e-9, 2e-8),
    ("scipy", "LSODA"): (1e-11, 1e-8),
    ("scipy", "Radau"): (1e-6, 1e-5),
} | dict.fromkeys(peers.PEERS, (1e-12, 1e-9))


@pytest.mark.parametrize("problem", PROBLEMS)
@pytest.mark.parametrize("name", REACHED)
def test_every_integrator_reaches_the_reference_with_all_impacts(problem, name):
    (engine, variant), (tolerance, most) = name, REACHED[name]
    if name in peers.PEERS:
        pytest.importorskip(engine, reason=f"{engine} comes with the extra `peers`")
        assert name in peers.installed()
    tilt, impacts = run_of(variant, engine, problem, tolerance)()
    assert impacts == PROBLEMS[problem].impacts and PROBLEMS[problem].error(tilt) < most


def test_methods_are_those_the_twin_offers():
    assert set(METHODS) == set(OFFERED) == {variant for engine, variant in REACHED if engine == "scipy"}


@pytest.fixture
def few(monkeypatch):
    """The study with two integrators at a setting each, that gives up when it is told to."""
    ladders = {KERNEL: [(), (1e-12,)], ("scipy", "DOP853"): [(), (1e-11, 1e-10)]}  # of a full and of a quick run
    monkeypatch.setattr(study, "TOLERANCES", ladders)
    run_of.cache_clear()
    yield
    run_of.cache_clear()


def found(folder):
    """The study's `Result`, by runs in this process."""
    return stored(folder, "kernel", answered(study.plan(Request(quick=True)), by_runs(folder))[-1])


def test_error_and_time_are_of_the_same_runs(few, monkeypatch):
    case = next(case for case in study._cases(True, {}, 0) if case.settings["engine"] == "scipy")
    called = itertools.count(1)

    def run():
        return -PROBLEMS["problem A"].reference - 0.25 * next(called), 10

    monkeypatch.setitem(study.INTEGRATORS, ("scipy", "DOP853"), lambda *_: run)
    values = measured(case, None)
    assert values["error"] == pytest.approx(next(called) - 1)  # of the last timed run, and of the size of its tilt
    assert values["error"] > 100  # a run this short is repeated
    assert values["impacts"] == 10 and values["cost"]["cpu_seconds"] > 0


def test_the_study_runs_and_shows_ratios_side_by_side(few, tmp_path):
    result = found(tmp_path)
    rows = where(result.rows, part="work-precision")
    assert len(rows) == 6 and all(row["repeatable"] and not row["failure"] for row in rows)
    assert all(row["timings"] == 3 and row["cpu_low"] <= row["cpu_seconds"] <= row["cpu_high"] for row in rows)
    kernel, other = (page.passing(rows, "problem A", 1e-9)[name] for name in (page.KERNEL, "scipy, DOP853"))
    ratio = other["cpu_seconds"] / kernel["cpu_seconds"]
    assert ratio > 20  # some 300 on a machine left alone
    section = get_study("kernel").page(result).whole()
    assert [f"{page.number(ratio, 3)} ×" in row[2] for row in section.tables[0].rows].count(True) == 1
    assert len(section.figures) == 1 and not section.evidence


def test_an_integrator_that_gives_up_is_reported_and_not_timed(few, monkeypatch, tmp_path):
    def gives_up(problem, tolerance):
        raise ValueError("f(a) and f(b) must have different signs")

    monkeypatch.setitem(study.INTEGRATORS, ("scipy", "DOP853"), gives_up)
    result = found(tmp_path)
    lost = where(result.rows, engine="scipy")
    assert len(lost) == 4 and all(row["failure"] and "cpu_seconds" not in row for row in lost)
    section = get_study("kernel").page(result).whole()
    assert len(section.evidence) == 4 and "different signs" in section.evidence[0][1]
    assert {row[1] for row in section.tables[0].rows if row[0] == "scipy, DOP853"} == {"–"}


def row(tolerance, error, seconds, impacts=10, variant="DOP853"):
    known = {"problem": "problem A", "engine": "scipy", "failure": None, "expected_impacts": 10}
    return {
        **known, "variant": variant, "tolerance": tolerance, "error": error, "impacts": impacts, "cpu_seconds": seconds
    }  # fmt: skip


@pytest.mark.parametrize(
    "rows, chosen",
    [
        ([row(1e-9, 1e-12, 1.0, impacts=9), row(1e-10, 1e-12, 2.0)], 1e-10),  # a wrong count is never the cheapest
        ([row(1e-8, 1e-12, 1.0), row(1e-9, 1e-6, 2.0), row(1e-10, 1e-12, 3.0)], 1e-10),  # nor a lucky point
        ([row(1e-9, 1e-12, 3.0), row(1e-10, 1e-12, 2.0)], 1e-10),  # a finer one may be cheaper
        ([row(1e-9, 1e-12, 1.0), row(1e-10, None, 2.0)], None),  # the finest is no number
    ],
)
def test_the_cheapest_setting_is_one_that_no_finer_one_contradicts(rows, chosen):
    cheapest = page.passing(rows, "problem A", 1e-9)
    assert [one["tolerance"] for one in cheapest.values()] == ([] if chosen is None else [chosen])


def test_a_stored_run_is_known_by_the_version_of_its_peer(monkeypatch):
    name = next(iter(peers.PEERS))
    keys = {
        case.key(measured)
        for version in ("1.0", "2.0")
        for case in study._cases(True, {name: version}, 0)
        if case.settings["engine"] == name[0]
    }
    assert len(keys) == 2 * len(PROBLEMS) * len(study.TOLERANCES[name][1])
