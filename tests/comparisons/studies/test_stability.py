"""The stability study: its cases are what they claim, its measures see errors, its results carry their evidence."""

import dataclasses
import math

import numpy as np
import pytest
from answered import answered, by_runs, stored
from scipy.optimize import brentq

from analytic import PulseMotion, Scene, SceneError, simulate
from analytic.kernel import layout
from analytic.response import Failure
from analytic.rocking import momentum_restitution, restitution
from analytic.sliding.run import contact_of, marched, slipping_friction
from analytic.solver import TOLERANCE, ground, options, parameters
from comparisons.execution.by_solver import read
from comparisons.execution.plan import Request
from comparisons.execution.results import RESULTS
from comparisons.execution.sweep import Row
from comparisons.plotting.parts import where
from comparisons.studies import get_study
from comparisons.studies.rows import wrong_with
from comparisons.studies.stability.cases import (
    BLOCK,
    GAMMA,
    GAP,
    OVERTURNS_FROM,
    SLIDING,
    SLIPS_FROM,
    THRESHOLD,
    TO_AND_FRO,
    G,
    hard_cases,
)
from comparisons.studies.stability.oracle import beyond_range, oracle
from comparisons.studies.stability.page import judgements
from comparisons.studies.stability.study import (
    DIFFERS,
    FAILED,
    MEASURES,
    RIGHT,
    TIME_STEPPING,
    TOLERANCES,
    Solver,
    measure,
    plan,
    row_of,
    solvers,
    worst,
)
from engines import get_engine, installed_engines

pytestmark = pytest.mark.xdist_group("stability")  # its runs are made once

STUDY = get_study("stability")

CASES = hard_cases()
KERNEL = Solver("analytic")
SLIPPERY = [name for name, case in CASES.items() if case.scene.friction is not None]
QUICK = [name for name, case in CASES.items() if case.quick]


def result_of(name, response, solver=TIME_STEPPING):
    """The row of a response to a case."""
    case = solver.case(CASES[name])
    return row_of(CASES[name], solver, Row(case, measure(case, response), None, {}, False))


def errors_of(response):
    """Errors of a response to the case of free rocking, as of a solver without an energy ledger."""
    response = dataclasses.replace(response, energy=None)
    return measure(TIME_STEPPING.case(CASES["zeno"]), response)["errors"]


@pytest.fixture(scope="module")
def free():
    return simulate(CASES["zeno"].scene)


def test_cases_are_different_scenes_and_every_measure_has_a_tolerance_with_its_reason():
    assert len({case.scene.digest() for case in CASES.values()}) == len(CASES)
    assert set().union(*TOLERANCES.values()) == set(MEASURES)
    assert all(reason for limits in TOLERANCES.values() for _, reason in limits.values())


def test_the_outcome_changes_where_the_critical_pulses_say():
    def outcome(amplitude):
        pulse = PulseMotion("one-sine", amplitude * THRESHOLD, 7.8)
        response = simulate(Scene(block=BLOCK, motion=pulse, duration=12.0), history=False)
        return response.outcome, response.impact_count

    assert [outcome(OVERTURNS_FROM * factor)[0] for factor in (1 - 1e-8, 1 + 1e-8)] == ["rocks", "overturns"]
    assert [outcome(GAP * factor) for factor in (0.97, 1.03)] == [("overturns", 1), ("overturns", 0)]
    assert outcome(GAP)[0] == "rocks"


def test_proportions_are_those_of_the_titles():
    assert restitution(CASES["flat drop"].scene) == pytest.approx(0.0, abs=1e-12)
    stocky = CASES["stocky on a light base"].scene
    assert momentum_restitution(stocky) < 0 and restitution(stocky) == 0
    assert simulate(CASES["beyond 1.33 m"].scene).peak_base_displacement > 1.34


# every third; the others are of the second command
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow if k % 3 else ()) for k, name in enumerate(QUICK)]
)
def test_the_kernel_is_right(name):
    row = result_of(name, simulate(CASES[name].scene), KERNEL)
    assert row["result"] == RIGHT, row


def test_a_jump_lifts_the_block_from_the_threshold_on():
    jump = CASES["jump to 1.001"].scene
    for share, outcome in ((1 - 1e-9, "stands"), (1 + 1e-9, "rocks")):
        scene = jump.with_(motion=jump.motion.scaled(share / 1.001))
        assert simulate(scene, history=False).outcome == outcome


def test_the_time_to_fall_grows_with_the_logarithm_of_the_distance_from_the_unstable_point():
    near, nearer = (CASES[f"unstable point +{share}"] for share in ("1e-06", "1e-09"))
    times = [simulate(case.scene, history=False).overturning_time for case in (near, nearer)]
    # tilts are rounded to 1e-7 of the nearer distance
    assert times[1] - times[0] == pytest.approx(math.log(1000) / near.scene.rocking_frequency, abs=1e-7)
    assert times[1] == pytest.approx(nearer.expected["overturning time"], abs=1e-7)


def test_cases_lie_in_and_outside_the_range_as_their_titles_say():
    assert beyond_range("damping 0.99") == beyond_range("jump to 1.001") == beyond_range("slides") == {}
    assert beyond_range("damping 100") == {"damping": pytest.approx(100)}
    assert beyond_range("inertia 100, pulse") == {"inertia": pytest.approx(100)}
    assert beyond_range("uplift 1.01").keys() == {"tilt"}  # hardly lifts


# modes in turn, of those after an impact with its time
MODES = {
    "slides": ["slide", "stick"],
    "slides to and fro": ["slide", "stick"],
    "flies and slides": ["flight", "slide", "stick"],
    "friction 0.999 of uplift": ["stick", "slide", "stick"],
    "friction 1.001 of uplift": ["stick", "rock", "slide-rock", "rock"],
    "impacts nearly slip": [],
    "impact just sticks": ["slide-rock", "rock", "slide-rock", "slide-rock"],
    "impact just slips": ["slide-rock", "rock", "slide-rock", "slide-rock"],
    "saved by sliding": ["stick", "rock", "slide-rock", "rock"],
    "overturned by sliding": ["stick", "rock", "slide-rock", "slide-rock", "rock", "slide-rock"],
    "isolated, slides": ["stick", "slide", "stick", "slide", "stick"],
    "isolated, slides and rocks": ["stick", "rock", "slide-rock", "rock", "slide-rock"],
}


@pytest.mark.parametrize("name", SLIPPERY)
def test_blocks_slide_as_the_titles_say(name):
    run = simulate(CASES[name].scene)
    modes = run.sliding.modes if run.sliding else ()
    assert [mode for _, mode in modes][: len(MODES[name])] == MODES[name]
    if "by sliding" in name:  # without friction the outcome is the other one
        other = simulate(CASES[name].scene.with_(friction=None), history=False).outcome
        assert {run.outcome, other} == {"rocks", "overturns"}
    if name in ("saved by sliding", "overturned by sliding", "impact just sticks", "impact just slips"):
        struck = [impact.time for impact in run.impacts]
        assert (modes[3][0] in struck) == (name != "saved by sliding") and modes[3][0] <= max(struck)
    if name == "slides to and fro":
        assert (np.diff(np.sign(np.diff(run.history.slip))) != 0).sum() >= 2


def test_slips_are_those_of_newmark():
    for name in ("slides", "flies and slides", "friction 0.999 of uplift", "slides to and fro"):
        slip = simulate(CASES[name].scene, history=False).sliding
        expected = [CASES[name].expected[measure] for measure in ("peak slip", "end slip")]
        assert [slip.peak, slip.end] == pytest.approx(expected, rel=1e-12)


def test_a_block_turns_round_where_its_equation_of_motion_says():
    motion, mu = CASES["slides to and fro"].scene.motion, CASES["slides to and fro"].scene.friction
    a, w, end = motion.amplitude, motion.frequency, motion.end

    def speed(t, begin, sigma):
        return -a / w * (math.sin(w * t) - math.sin(w * begin)) - sigma * mu * G * (t - begin)

    def way(t, begin, sigma):
        turned = math.cos(w * t) - math.cos(w * begin)
        return a / w**2 * turned + a / w * math.sin(w * begin) * (t - begin) - sigma * mu * G * (t - begin) ** 2 / 2

    first = brentq(speed, 0.1, 0.6, args=(0.0, -1), xtol=1e-15)
    second = brentq(speed, 0.6, end, args=(first, 1), xtol=1e-15)
    # there the ground acceleration exceeds what friction holds: it does not stick
    assert min(abs(math.cos(w * first)), abs(math.cos(w * second))) * a > mu * G
    peak = way(first, 0.0, -1) + way(second, first, 1)
    rest = peak + way(end, second, -1) - speed(end, second, -1) ** 2 / (2 * mu * G)
    assert list(TO_AND_FRO.values()) == pytest.approx([peak, rest], rel=1e-13)


def test_the_landing_corner_slips_from_the_friction_that_is_said():
    def kind(share):
        scene = CASES["impact just slips"].scene.with_(friction=share * SLIPS_FROM)
        _, impacts, _, _ = marched(parameters(scene), contact_of(scene), ground(scene.motion), options())
        return impacts[0, 4]

    assert [kind(1 + 1e-8 * sign) for sign in (-1, 1)] == [layout.NEW_STICKS, layout.NEW_SLIPS]


def test_impacts_of_a_released_block_slip_below_a_friction_that_the_case_exceeds_by_a_thousandth():
    scene = CASES["impacts nearly slip"].scene
    limit = slipping_friction(parameters(scene))
    assert scene.friction == pytest.approx(1.001 * limit, rel=1e-12) and limit < math.tan(GAMMA)
    with pytest.raises(SceneError, match="depends on the law of friction"):
        simulate(scene.with_(friction=0.999 * limit))


@pytest.mark.parametrize("name", ["saved by sliding", "isolated, slides"])
def test_slips_that_are_wrong_are_seen(name):
    run = simulate(CASES[name].scene)
    wrong = dataclasses.replace(run, sliding=dataclasses.replace(run.sliding, peak=run.sliding.peak * 1.03))
    assert "peak slip" in result_of(name, wrong, KERNEL)["outside"]
    right, found, stuck = (
        result_of(name, dataclasses.replace(one, engine="", energy=None))
        for one in (run, wrong, dataclasses.replace(run, sliding=None))
    )
    assert right["result"] == RIGHT and found["errors"]["peak slip"][0] == pytest.approx(0.03, rel=1e-3)
    assert stuck["errors"]["peak slip"][0] == 1 and {"peak slip", "end slip"} <= set(stuck["outside"])


def test_only_solvers_that_know_friction_are_asked_cases_with_it():
    names = installed_engines()
    found = {(case.solver, case.variant) for case in next(plan(Request(names), SLIPPERY, solvers(names))).cases}
    able = {("analytic", None), ("pybullet", "impact-aware"), ("exudyn", "compliant-corners")}
    assert {one for one in able if one[0] in ("analytic", *names)} <= found
    assert not found & {("twin", None), ("time-stepping", None)}
    assert SLIPPERY == [name for name, case in CASES.items() if case.oracle == SLIDING]


@pytest.fixture(scope="module")
def tried(tmp_path_factory):
    """The study of a few cases, of which some lie outside the range and one the time stepping needs finer steps."""
    names = ("uplift 0.99", "zeno", "slides", "inertia 1.0001, free rocking", "uplift 1.01", "critical pulse -0.01")
    place = tmp_path_factory.mktemp("stability")
    asked = plan(Request(()), names, [KERNEL, TIME_STEPPING])
    return stored(place, "stability", answered(asked, by_runs(place))[-1])


@pytest.mark.slow
def test_cases_outside_the_range_are_counted_apart(tried):
    outside = {name: set(case["outside"]) for name, case in tried.settings["cases"].items() if case["outside"]}
    assert outside == {"inertia 1.0001, free rocking": {"inertia"}, "uplift 1.01": {"tilt"}}
    right = [row["case"] for row in where(tried.rows, engine="time-stepping", part="default settings", result=RIGHT)]
    assert "zeno" not in right and {"uplift 0.99", "critical pulse -0.01"} <= {*right}
    (judged,) = judgements(tried)
    mark = judged.marks["time-stepping", ""]
    assert judged.marks.keys() == {("time-stepping", "")}  # the analytic model judges
    within = [name for name in right if name not in outside]
    assert mark.words.startswith(f"{len(within)} of 3 ({len(right) - len(within)} of 2") and mark.value == 2 / 3
    before = {name: case | {"outside": {}} for name, case in tried.settings["cases"].items()}
    older = dataclasses.replace(tried, settings={**tried.settings, "cases": before})
    assert judgements(older)[0].marks["time-stepping", ""].words == f"{len(right)} of 5"


def test_the_study_tries_finer_settings_where_it_differs(tried):
    first, finer = where(tried.rows, case="zeno", engine="time-stepping")
    assert (first["part"], first["level"], first["result"]) == ("default settings", 1e-3, DIFFERS)  # too coarse for it
    assert (finer["part"], finer["level"], finer["result"]) == ("finer settings", 1e-4, RIGHT)
    _, value, tolerance = worst(first)
    assert value > tolerance


def test_wrong_histories_and_lost_events_are_seen(free):
    moved = dataclasses.replace(free.history, tilt=free.history.tilt + 0.05 * BLOCK.slenderness)
    wrong = errors_of(dataclasses.replace(free, history=moved, rests=(free.rests[0] * 1.03,)))
    assert [wrong[name] for name in ("tilt", "tilt at rest", "rest time")] == pytest.approx(
        [0.05, 0.05, 0.03], rel=1e-4
    )

    row = result_of("zeno", dataclasses.replace(free, energy=None, impacts=free.impacts[3:], rests=()))
    assert row["errors"]["impacts too few"][0] in (2, 3)  # one just below the limit may stand in for one lost
    assert row["errors"]["lost rests"][0] == 1 and "rest time" not in row["errors"]
    assert row["result"] == DIFFERS and {"impacts too few", "lost rests"} <= set(row["outside"])
    assert result_of("zeno", dataclasses.replace(free, energy=None))["result"] == RIGHT


def test_energy_from_nowhere_is_seen(free):
    history = free.history
    # A swing that grows by 10 % within the first flight.
    growth = 1 + 0.1 * np.clip(history.time / free.impacts[0].time, 0, 1)
    grown = dataclasses.replace(history, tilt=history.tilt * growth, tilt_rate=history.tilt_rate * growth)
    same, found = errors_of(free), errors_of(dataclasses.replace(free, history=grown))
    for name in ("energy gain", "energy drift"):
        assert same[name] < 1e-6 and found[name] > 0.02


def test_a_block_that_lands_flat_is_held_against_the_closed_form():
    """No impact lets it go again: the kernel is not its own judge there."""
    response = simulate(CASES["flat drop"].scene)
    history = response.history
    moved = dataclasses.replace(response, history=dataclasses.replace(history, tilt=history.tilt + 0.01))
    for run, error in ((response, 0.0), (moved, 0.01 / CASES["flat drop"].scene.block.slenderness)):
        assert result_of("flat drop", run, KERNEL)["errors"]["tilt"][0] == pytest.approx(error, rel=1e-2, abs=1e-10)


def test_the_oracle_stops_comparing_where_motions_part():
    truth = oracle("critical pulse +0.01", False)
    reference = simulate(CASES["critical pulse +0.01"].scene)
    assert truth.until <= reference.unstable_time * (1 + 1e-9)
    assert oracle("critical pulse +1e-05", False).outcome == "overturns"  # known beforehand, however sensitive


def test_a_failed_run_keeps_its_evidence(free):
    failure = Failure("the solver gave up", "x" * 5000, free.end)
    values = dataclasses.replace(free, outcome="failed", failure=failure).to_json()
    run = Row(TIME_STEPPING.case(CASES["zeno"]), values, {"kind": "solver", **values.pop("failure")}, {}, False)
    row = row_of(CASES["zeno"], TIME_STEPPING, run)
    assert (row["result"], row["outcome"]) == (FAILED, "failed")
    assert row["failure"]["reason"] == failure.reason and 500 < len(row["failure"]["message"]) < 700
    assert row["last_state"]["time"] == free.end.time and row["settings"]["tolerance"] == TOLERANCE
    assert wrong_with(row, "stability") is None


def test_ten_minutes_are_asked_of_the_default_variants_alone():
    names, other = ("zeno", "10 minutes, rigid ground"), dataclasses.replace(TIME_STEPPING, engine="b", best=False)
    asked = [(case.tag["case"], case.solver) for case in next(plan(Request(), names, (TIME_STEPPING, other))).cases]
    assert asked == [(names[0], "time-stepping"), (names[0], "b"), (names[1], "time-stepping")]


def test_solvers_cover_every_variant_and_finer_settings_are_settings_they_have():
    found = [one for one in solvers(installed_engines()) if one.variant]
    engines = [get_engine(name) for name in installed_engines()]
    assert [(one.engine, one.variant) for one in found] == [
        (one.name, each) for one in engines for each in one.variants
    ]
    for one in found:
        defaults = dataclasses.asdict(get_engine(one.engine).variants[one.variant].settings)
        assert all(set(finer) <= set(defaults) and finer.items() - defaults.items() for finer in one.finer)


def test_committed_result_has_the_kernel_right_in_every_case():
    result = read(RESULTS / "stability")
    kernel = where(result.rows, engine="analytic")
    assert not result.settings["quick"]
    assert {row["case"] for row in kernel} == set(result.settings["cases"]) == set(CASES)
    assert {row["result"] for row in kernel} == {RIGHT}
    assert all(row["failure"]["reason"] and row["set"] is not None for row in where(result.rows, result=FAILED))
