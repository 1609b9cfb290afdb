"""The speed-error study: its errors against known ones, its boundary search, repetition and what is shown."""

import itertools
import math

import numpy as np
import pytest
from answered import answered, by_runs

from analytic import simulate
from analytic.checks.time_stepping import simulate_time_stepping
from analytic.checks.twin import METHODS as OFFERED
from analytic.errors import SettingError
from analytic.rocking import restitution
from comparisons.execution.by_solver import read
from comparisons.execution.cases import Case, solver
from comparisons.execution.plan import Request
from comparisons.execution.results import Result
from comparisons.execution.runner import compute
from comparisons.metrics import errors as models
from comparisons.metrics import scripts
from comparisons.plotting.parts import where
from comparisons.studies import get_study
from comparisons.studies.speed_error import integrators
from comparisons.studies.speed_error.integrators import METHODS, PROBLEMS, run_of
from comparisons.studies.speed_error.page import APART, KERNEL, fit, keeping, level_costs, levels_run, passing
from comparisons.studies.speed_error.study import (
    NEEDED,
    TICK,
    entries,
    errors,
    margin,
    measure,
    plan,
    problem_trials,
    searched,
    trials,
)
from engines import get_engine

STUDY = get_study("speed-error")


@pytest.fixture(scope="module")
def by_name():
    return {trial.name: trial for trial in trials()}


@pytest.fixture(scope="module")
def free(by_name):
    return by_name["free-rigid"]


@pytest.fixture(scope="module")
def near(by_name):
    return by_name["near-overturning"]


def test_the_scenes_do_what_their_names_say_and_the_reference_has_no_error_against_itself(by_name):
    for name, trial in by_name.items():
        assert trial.reference.outcome == ("stands" if name == "isolated-standing" else "rocks")
        found = errors(trial, trial.reference.to_json())
        assert found.pop("lost") == 0
        assert set(found) == set(trial.measures) - {"boundary_shift"}
        assert max(found.values()) < 1e-12


@pytest.mark.parametrize("delay, loss", [(1e-4, 0.0), (0.0, 0.01)])
def test_changed_impacts_are_seen_for_what_they_are(free, delay, loss):
    """Rates that fall by 1 % more from impact to impact than eq. (7) says: e is 1 % low, whatever the impact shows."""
    values = free.reference.to_json()
    impacts = [
        impact | {"time": impact["time"] + delay, "rate_before": impact["rate_before"] * (1 - loss) ** k}
        for k, impact in enumerate(values["impacts"])
    ]
    found = errors(free, values | {"impacts": impacts})
    expected = [delay, loss * restitution(free.scene), 0]
    assert [found[key] for key in ("impact_time", "restitution", "lost")] == pytest.approx(
        expected, rel=1e-6, abs=1e-12
    )
    assert errors(free, values | {"impacts": impacts[:1] + impacts[2:]})["lost"] == 1


def test_the_margin_is_conserved_in_flight_and_its_sign_decides(near):
    for factor, overturns in ((0.98, False), (1.02, True)):
        runs = [at(factor)(near.scene.with_(duration=time)) for time in (1.2, 1.7, 20.0)]
        early, late = (margin(near.scene, run.end) for run in runs[:2])
        assert early == pytest.approx(late, abs=1e-12)
        assert (early > 0) == (runs[2].outcome == "overturns") == overturns


def boundary_found(near, run):
    """Errors of a search for the boundary by `run`."""
    return errors(near, near.reference.to_json(), searched(run, near.scene, near.boundary)[1])


def at(factor):
    return lambda scene: simulate(scene.with_(motion=scene.motion.scaled(factor)), history=False)


@pytest.mark.parametrize("factor, nearby", [(1 + 1e-8, True), (1.001, True), (0.97, True), (1.06, True), (0.5, False)])
def test_a_shifted_boundary_is_found_where_it_is_unless_none_is_nearby(near, factor, nearby):
    found = boundary_found(near, at(factor)).get("boundary_shift")
    assert found == (pytest.approx(abs(1 / factor - 1), rel=0.05, abs=1e-12) if nearby else None)


def test_time_stepping_shows_its_order_in_the_boundary(near):
    """The time at which an impact is noticed is one step late at most: the boundary moves with the first power."""
    shifts = [
        boundary_found(near, lambda scene, step=step: simulate_time_stepping(scene, step=step, history=False))
        for step in (1e-3, 1e-4, 1e-5)
    ]
    assert shifts[0]["boundary_shift"] < 2e-3
    assert shifts[2]["boundary_shift"] < 0.1 * shifts[0]["boundary_shift"]


def test_error_and_cpu_time_are_of_the_same_runs(free):
    case = Case(free.scene, "time-stepping", None, {"step": 1e-3, "history": False}, {"boundary": None})
    values = measure(case, alone := case.run())
    assert values["impacts"] == alone.to_json()["impacts"] and values["cost"]["cpu_seconds"] > 0
    assert values["cost"]["repeats"] > 1  # a run this short is repeated


def test_solvers_take_turns_from_coarse_to_fine(free, near):
    pytest.importorskip("pybullet")
    made = entries([free, near], ("pybullet",), quick=True)
    first = [(one.engine, one.variant, one.model) for one in made if one.trial is free]
    assert 10 < len(set(first[: len(set(first))])) == len(set(first)) < len(first)  # the first levels before any second
    kernel = [one.level for one in made if one.trial is near and one.engine == "analytic" and one.model == NEEDED]
    assert kernel == sorted(kernel, reverse=True) and len(kernel) == 3
    cases = [one.case(0) for one in made]
    assert {case.variant for case in cases} == {None, *get_engine("pybullet").variants}
    assert [bool(case.tag["boundary"]) for case in cases] == [one.trial is near for one in made]


def test_a_heavy_base_errs_by_its_mass_ratio_and_a_tuned_free_block_rocks_as_the_planar_one(free):
    found = errors(free, simulate(models.on_heavy_base(free.scene), history=False).to_json())
    assert 0.01 / models.HEAVY < found["restitution"] < 1 / models.HEAVY
    pytest.importorskip("pybullet")
    free_block = solver(get_engine("pybullet").variants["fixed-step"].free_block)
    found = errors(free, free_block(free.scene, step=1e-3, history=False).to_json())
    assert found["lost"] == 0 and found["restitution"] < 5e-3


def test_a_first_script_is_not_touched_by_other_clients(free):
    """Bullet's contact threshold is process-global: a tuned run must not leak into a script with default settings."""
    pybullet = pytest.importorskip("pybullet")
    ends = []
    for threshold in (1e-3, 5e-2):
        client = pybullet.connect(pybullet.DIRECT)
        pybullet.setPhysicsEngineParameter(contactBreakingThreshold=threshold, physicsClientId=client)
        pybullet.disconnect(client)
        ends.append(get_engine("pybullet").simulate(free.scene, variant="first-script", history=False).end)
    assert ends[0] == ends[1]


def test_fit_of_a_power():
    x = np.array([1.0, 2.0, 4.0, 8.0])
    assert fit(x, 5 * x**0.7) == pytest.approx((0.7, 0.0), abs=1e-12)
    # residuals of log 1.1 at every other point: their squares add up to 4/5 of its square
    d = math.log(1.1) / math.log(2.0)
    assert fit(x, x * [1.0, 1.1, 1.0, 1.1]) == pytest.approx((1 + d / 5, d * math.sqrt(0.8 / 2 / 5)))


def row(variant, cpu, error, **other):
    """A row of an engine's level; finer ones come later."""
    return {
        "part": "work-precision", "scene": "s", "engine": "exudyn", "variant": variant, "model": NEEDED, "law": None,
        "parameter": "step", "level": 1e-3, "failure": None, "errors": {"restitution": error}, "lost": 0,
        "cpu_seconds": cpu, "cpu_low": cpu, "cpu_high": 1.2 * cpu, "cpu_per_second": cpu, "step": 1e-3,
        "repeatable": True,
    } | other  # fmt: skip


def result_of(*rows):
    scene = {"title": "a scene", "measures": ["restitution"], "reference_difference": {"restitution": 2e-12}}
    settings = {"rounds": 1, "scenes": {"s": {**scene, "bouc_wen": {"peak_displacement": 0.01, "peak_tilt": None}}}}
    machine = {"processor": "one", "logical_cores": 2}
    return Result(STUDY.name, {**settings, "variants": []}, list(rows), {"machine": machine, "commit": None})


@pytest.mark.parametrize(
    "found, failed, chosen",
    [
        ([1e-1, 1e-2, 1e-4, 1e-5], (), 2),
        ([1e-5, 1e-2, 1e-4, 1e-5], (), 2),  # the first passes by luck: a finer one does not
        ([1e-1, 1e-5, 1e-2], (), None),  # the finest does not pass: nothing may be recommended
        ([1e-1, 1e-5, 1e-5, 1e-5], (2,), 3),  # one that failed separates the levels
    ],
)
def test_the_cheapest_setting_is_one_that_no_finer_one_contradicts(found, failed, chosen):
    failure = {True: {"reason": "NaN"}, False: None}
    rows = [row("a", 1.0 + k, e, level=10.0**-k, failure=failure[k in failed]) for k, e in enumerate(found)]
    levels = [one["level"] for one in passing(levels_run(result_of(*rows)), 1e-3).values()]
    assert levels == ([] if chosen is None else [10.0**-chosen])


def test_a_level_that_failed_or_lost_impacts_has_no_error():
    lost, failed = row("a", 2, 1e-5, lost=2), row("a", 3, 1e-5, failure={"reason": "x"})
    rows = levels_run(result_of(row("a", 1, 1e-5), lost, failed))
    assert [one["error"] for one in rows] == [1e-5, None, None] and passing(rows, 1e-3) == {}


def test_solvers_come_cheapest_first():
    rows = levels_run(result_of(row("a", 3.0, 1e-2), row("a", 5.0, 1e-5), row("b", 4.0, 1e-4)))
    for error, costs in ((1e-2, {"exudyn, a": 3.0, "exudyn, b": 4.0}), (1e-3, {"exudyn, b": 4.0, "exudyn, a": 5.0})):
        found = passing(rows, error)
        assert {name: one["cpu_seconds"] for name, one in found.items()} == costs and [*found] == [*costs]


def test_more_than_needed_stands_beside_what_is_needed():
    rows = [row("a", 2.0, 1e-4), row("a", 6.0, 1e-2, model="more", lost=1), row("a", 3.0, 1e-4, law="bouc-wen")]
    more, law = (table.rows for table in STUDY.page(result_of(*rows)).whole().tables[-2:])
    assert more == [["more", "exudyn, a", "step = 0.001 s", "a scene", "3.00", "1.0·10⁻⁴", "0.010 (missed: 1)"]]
    assert [one[2:6] for one in law] == [["1.50", "1.50", "1.50", "1.0 %"]]  # the ratio's median and range


@pytest.mark.parametrize("error, cost", [(1e-2, 2.0), (1e-3, 8.0), (1e-4, 8.0)])
def test_a_cost_at_an_error_is_that_of_the_level_that_keeps_it(error, cost):
    """Of no level between two, as none was run."""
    found = level_costs(result_of(row("a", 2.0, 1e-2), row("a", 8.0, 1e-4)))
    assert found["exudyn, a"]["s", "restitution"][error] == cost


def test_a_cost_is_that_of_the_round_that_took_least():
    (one,) = levels_run(result_of(row("a", 3.0, 1e-3, cpu_low=2.0, cpu_per_second=0.3, cpu_per_step=None)))
    assert (one["cpu_seconds"], one["cpu_per_second"]) == (2.0, pytest.approx(0.2))


def test_no_cost_is_told_where_a_finer_level_contradicts():
    contradicted = result_of(row("a", 1.0, 1e-4), row("a", 2.0, 1e-2), row("a", 4.0, 1e-1, lost=1))
    assert level_costs(contradicted)["exudyn, a"]["s", "restitution"] == {}  # the finest missed an impact
    coarse = result_of(row("a", 1.0, 1e-4, lost=1), row("a", 2.0, 1e-5))
    assert level_costs(coarse)["exudyn, a"]["s", "restitution"][1e-3] == 2.0


def costly(**finest):
    """A result in which two levels of a subject engine, and the model, rock on bearings and reach a boundary."""
    name = ("exudyn", "compliant-corners")
    tilts = [("analytic", "kernel", 1e-2, 1.0, 1e-9), (*name, 1e-2, 50.0, 5e-2), (*name, 1e-3, 200.0, 5e-4)]
    rows = []
    for scene, kind in (("isolated-rocking", "peak_tilt"), ("near-overturning", "boundary_shift")):
        for engine, variant, level, cpu, error in tilts:
            off = {kind: finest.get(kind, error) if level == 1e-3 else error}
            known = {"scene": scene, "engine": engine, "level": level, "errors": off | {"restitution": error}}
            rows.append(row(variant, cpu, error, **known))
    result = result_of(*rows)
    scene = result.settings["scenes"]["s"]
    result.settings["scenes"] = {
        "isolated-rocking": scene | {"measures": ["restitution", "peak_tilt"]},
        "near-overturning": scene | {"title": "a boundary", "measures": ["boundary_shift"]},
    }
    shared = {"default": 1e-3, "applies_impact": False, "parameter": "stiffness", "tier": "tuned"}
    result.settings["variants"] = [{"engine": name[0], "variant": name[1], **shared}]
    return result


def test_costs_are_those_of_the_level_over_the_models():
    """At an error of .001: that of the level with .0005, 200 s, over the model's 1 s."""
    result, pair = costly(), ("exudyn", "compliant-corners")
    assert STUDY.judgements(result)[0].marks[pair].value == 200.0
    glance = STUDY.glance(result)
    assert [(curve.who, len(curve.points)) for curve in glance.curves] == [(KERNEL, 1), (", ".join(pair), 2)]
    result.provenance["engines"] = {"exudyn": result.provenance | {"machine": {"processor": "another"}}}
    mark = STUDY.judgements(result)[0].marks[pair]
    assert (mark.words, mark.value) == (APART, None) and "on another processor" in mark.note
    assert STUDY.glance(result).says["cost"] == ("", "")


def test_a_level_keeps_an_error_if_it_keeps_peak_tilt_and_boundary():
    name = "exudyn, compliant-corners"
    found = [keeping(costly(), error).get(name, {"level": None})["level"] for error in (1e-1, 1e-3, 1e-4)]
    assert found == [1e-2, 1e-3, None]
    assert name not in keeping(costly(boundary_shift=2e-3), 1e-3)


@pytest.mark.parametrize("error, said", [(5e-4, False), (5e-3, True)])
def test_other_scenes_in_which_no_level_reaches_the_error_are_told(error, said):
    result = costly()
    result.settings["scenes"]["near-overturning"]["measures"] = ["boundary_shift", "peak_tilt"]
    for line in where(result.rows, scene="near-overturning", level=1e-3):
        line["errors"]["peak_tilt"] = error
    glance = STUDY.glance(result)
    assert ("In 1 (exudyn) of 1 other scenes" in glance.says["cost"][1]) == said
    assert glance.levels == (("exudyn", 1e-3),)


@pytest.mark.parametrize("cost, same", [(280.0, True), (330.0, False)])
def test_engines_that_cost_the_same_are_said_to(cost, same):
    """Medians are one and a half times the least: costs nearer than that are not told apart."""
    result = costly()
    other = {"engine": "pybullet", "variant": "impact-aware"}
    paid = other | {"cpu_seconds": cost, "cpu_per_second": cost}
    result.rows.extend([line | paid for line in result.rows if (line["engine"], line["level"]) == ("exudyn", 1e-3)])
    for line in result.rows:
        line["cpu_low"] = line["cpu_seconds"] / 1.5
    result.settings["variants"].append(result.settings["variants"][0] | other)
    assert ("the engines are not shown to differ in cost" in STUDY.glance(result).says["cost"][1]) == same


@pytest.mark.long
def test_a_study_repeats_bit_for_bit(tmp_path, near):
    pytest.importorskip("pybullet")
    some = (("analytic", "kernel"), ("time-stepping", ""), ("pybullet", "fixed-step"))
    given = dict(quick=True, repeats=2, scenes=[near], keep=lambda entry: (entry.engine, entry.variant or "") in some)
    paths = [
        compute(STUDY, tmp_path / name, engines=("pybullet",), progress=False, **given)[0] for name in ("one", "other")
    ]
    rows, again = (read(path).rows for path in paths)
    assert rows and all(row["repeatable"] and row["timings"] == 2 for row in rows)
    assert [row["errors"] for row in rows] == [row["errors"] for row in again]


@pytest.mark.parametrize("name", ["exudyn", pytest.param("pybullet", marks=pytest.mark.slow)])
def test_a_script_as_it_is_written_is_a_solver_with_errors_of_its_own(free, name):
    (entry,) = (one for one in entries([free], [name], quick=False) if one.variant == scripts.NAME)
    values = measure(entry.case(0), entry.case(0).run())
    found = errors(free, values)
    assert found.pop("lost") == 0 and 0 < found["restitution"] < 1e-4 and values["cost"]["cpu_seconds"] > 0


def test_what_is_stored_of_a_run_of_an_integrator_has_all_its_errors():
    """Else a run that is done again differs from the one stored."""
    (some,) = (trial for trial in problem_trials() if trial.name == "problem A")
    found = [measure(one.case(0), None) for one in entries([some], (), quick=True) if one.variant == "DOP853"]
    assert found and all("lost" in one["errors"] and len(one["errors"]) > 1 for one in found)


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


@pytest.mark.slow
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
