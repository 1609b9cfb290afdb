"""Judging a run: what is off is found, what is excused is excused by the model, and a user is told of it."""

import copy
from dataclasses import replace

import numpy as np
import pytest
from kept_runs import FREE, kept

from analytic import Block, PulseMotion, Scene, simulate
from analytic.rocking import restitution
from comparisons.measuring import verdicts
from comparisons.measuring.verdicts import (
    boundary_copies,
    doubts,
    findings,
    judge,
    lost_impacts,
    near_copies,
    range_warnings,
    rule,
)


def verdict(scene, run):
    copies = [{name: kept(copy) for name, copy in family(scene).items()} for family in (near_copies, boundary_copies)]
    return judge(scene, kept(scene), run, *copies)


def quantities(found):
    return {finding["quantity"] for finding in found}


def test_a_restitution_off_by_more_than_a_hundredth_is_found():
    run, e = kept(FREE), restitution(FREE)
    for off, expected in ((0.009, set()), (0.011, {"restitution"})):
        wrong = copy.deepcopy(run)
        wrong["impacts"][1][2] = (e + off) * wrong["impacts"][1][1]
        assert quantities(findings(FREE, run, wrong)) == expected
    wrong["impacts"][1][2] = None  # NaN in JSON
    assert quantities(findings(FREE, run, wrong)) == {"restitution"}


def test_impacts_too_small_to_see_do_not_count():
    run = kept(FREE)
    rates = np.abs([rate for _, rate, _ in run["impacts"]])
    small = next(k for k in range(len(rates)) if rates[k] < 0.1 * rates[0])
    wrong = copy.deepcopy(run)
    wrong["impacts"][small][2] *= 0.5
    assert findings(FREE, run, wrong) == []
    del wrong["impacts"][small:]
    assert findings(FREE, run, wrong) == []


def test_a_lost_impact_is_found():
    run = kept(FREE)
    wrong = copy.deepcopy(run)
    time = wrong["impacts"].pop(1)[0]
    assert lost_impacts(FREE, run, wrong) == [time]
    assert quantities(findings(FREE, run, wrong)) == {"lost impact"}


def test_impacts_that_come_close_together_may_all_come_late():
    """Of a period that is off by 7e-4: three impacts 5e-4 s apart, after half a second of rocking."""
    run = kept(FREE)
    first, before, after = run["impacts"][0]
    run["impacts"] = [[first + gap, sign * before, sign * after] for gap, sign in ((0, 1), (0.5, -1), (0.5005, 1))]
    late = [[time + 4e-4 * (time > first), *rates] for time, *rates in run["impacts"]]
    assert lost_impacts(FREE, run, {**run, "impacts": late}) == []
    for k in (1, 2):
        one_less = {**run, "impacts": late[:k] + late[k + 1 :]}
        assert lost_impacts(FREE, run, one_less) == [run["impacts"][k][0]]


@pytest.mark.parametrize("share, lost", [(0.005, 0), (0.02, 1)])
def test_an_impact_right_before_the_end_may_come_after_it(share, lost):
    first, second = (impact.time for impact in simulate(FREE).impacts[:2])
    scene = FREE.with_(duration=second + share * (second - first))
    run = kept(scene)
    wrong = copy.deepcopy(run)
    wrong["impacts"].pop()
    assert len(run["impacts"]) == 2 and len(lost_impacts(scene, run, wrong)) == lost
    wrong["impacts"].clear()
    assert len(lost_impacts(scene, run, wrong)) == 1 + lost


@pytest.mark.parametrize("name, scale", [("tilt", 0.25), ("displacement", 0.25)])
def test_peaks_count_from_their_least_value_on(name, scale):
    run = kept(FREE)
    for factor, expected in ((1.019, set()), (1.021, {name}), (0.979, {name})):
        assert quantities(findings(FREE, run, {**run, name: factor * run[name]})) == expected
    least = verdicts.least(FREE)[name]
    still = {**run, name: 0.0}
    for value, expected in ((0.99 * least, set()), (1.019 * least, set()), (1.021 * least, {name})):
        assert quantities(findings(FREE, still, {**run, name: value})) - {"outcome"} == expected
    assert quantities(findings(FREE, run, {**run, name: None})) >= {name}


def pulse(amplitude, duration=4.0):
    return Scene(
        block=Block(mass=1.0, radius=1.0, slenderness=0.25),
        duration=duration,
        motion=PulseMotion("one-sine", amplitude, 6.0),
    )


@pytest.fixture(scope="module")
def boundary():
    """Amplitude [m/s2] at which the block of `pulse` first overturns."""
    low, high = 3.0, 12.0
    assert [simulate(pulse(a), history=False).outcome for a in (low, high)] == ["rocks", "overturns"]
    while high - low > 1e-6:
        middle = (low + high) / 2
        low, high = (low, middle) if simulate(pulse(middle), history=False).outcome == "overturns" else (middle, high)
    return high


def test_another_outcome_counts_unless_the_boundary_is_within_a_percent(boundary):
    near, far = pulse(boundary * 0.9998), pulse(boundary * 0.95)
    overturns = kept(pulse(boundary * 1.0002))
    assert verdict(near, overturns) == ([], ["near a boundary"])
    found, notes = verdict(far, kept(pulse(boundary * 1.01)))
    assert "outcome" in quantities(found) and notes == []


def test_near_a_boundary_the_motion_before_it_still_counts(boundary):
    near, run = pulse(boundary * 0.9998), kept(pulse(boundary * 1.0002))
    run["tilts"] = (1.3 * np.array(run["tilts"])).tolist()  # wrong from the first instant on
    found, notes = verdict(near, run)
    assert quantities(found) == {"tilt"} and notes == ["near a boundary"]


def test_an_ill_conditioned_peak_is_compared_as_long_as_it_is_determined(boundary):
    close = pulse(boundary * (1 - 2e-6), duration=6.0)  # lingers at the unstable point
    for factor, expected in ((1 + 3e-5, set()), (1.1, {"tilt"})):
        run = kept(close.with_(motion=close.motion.scaled(1 - 3e-5)))
        run["tilts"] = (factor * np.array(run["tilts"])).tolist()
        run["tilt"] *= 0.95
        found, notes = verdict(close, run)
        assert notes == ["ill-conditioned"] and quantities(found) == expected


def test_a_well_conditioned_peak_is_not_excused():
    found, notes = verdict(FREE, {**kept(FREE), "displacement": 0.9 * kept(FREE)["displacement"]})
    assert quantities(found) == {"displacement"} and notes == []


def test_scenes_outside_the_model_are_left_out_by_the_model_alone():
    run = kept(FREE)
    assert rule(FREE, run) is None
    assert rule(FREE, {**run, "normal": -0.1}) == "N <= 0"
    assert rule(FREE, {**run, "friction": 5.1}) == "friction demand above 5"
    assert rule(FREE.with_(friction=0.2), {**run, "friction": 0.3}) == "friction demand above 0.2"


def test_a_warning_that_the_model_gives_too_is_none_about_the_engine():
    model, run = ({"warnings": [f"the base slides on at {speed} m/s"]} for speed in ("1e-3", "2e-3"))
    assert range_warnings(model, run) == []
    radius = "radius R [m] = 0.001 is below 0.01, the limit of the range verified"
    assert range_warnings(model, {"warnings": [*run["warnings"], radius]}) == [radius]


def said(scene, response):
    return list(doubts(scene, response, simulate(scene, history=False)))


def test_a_response_that_agrees_is_told_without_a_doubt():
    assert said(FREE, simulate(FREE, tolerance=1e-13)) == []
    decided = FREE.with_(duration=None)  # ends where its outcome is certain
    assert said(decided, simulate(decided, tolerance=1e-13)) == []


def test_a_user_is_told_what_the_analytic_model_says_otherwise():
    model = simulate(FREE)
    impacts = list(model.impacts)
    e = restitution(FREE)
    impacts[0] = replace(impacts[0], rate_after=(e - 0.03) * impacts[0].rate_before)
    wrong = {
        f"its peak tilt is {model.peak_tilt:.3g} rad, here {1.021 * model.peak_tilt:.3g}": {
            "peak_tilt": 1.021 * model.peak_tilt
        },
        f"its peak displacement is {model.peak_base_displacement:.3g} m, here 0": {"peak_base_displacement": 0.0},
        f"its e is {e:.3f} at every impact, here off by up to 0.03": {"impacts": tuple(impacts)},
        "impacts of it that are missing here: 1": {"impacts": model.impacts[:1] + model.impacts[2:]},
        "its block rocks": {"outcome": "overturns"},
    }
    for words, changes in wrong.items():
        assert said(FREE, replace(model, **changes)) == [
            f"the analytic model says otherwise: {words}; see rocking compare"
        ]
    both = replace(model, impacts=tuple(impacts), outcome="overturns")
    (sentence,) = said(FREE, both)
    assert "its block rocks; its e is" in sentence


def test_a_restitution_that_the_scene_gives_is_the_one_that_counts():
    given = FREE.with_(block={"restitution": 0.5})
    assert abs(restitution(FREE) - 0.5) > 0.1 and said(given, simulate(given, tolerance=1e-13)) == []


def test_a_falling_block_is_doubted_for_its_outcome_and_its_impacts_before_it_alone(boundary):
    far = pulse(boundary * 1.05)
    model = simulate(far)
    assert said(far, replace(model, peak_tilt=9.9, peak_base_displacement=9.9)) == []
    (sentence,) = said(far, replace(model, outcome="rocks"))
    assert "its block overturns" in sentence and "peak" not in sentence
    cut = replace(model, outcome="rocks", decided=False)
    assert said(far, cut) == []


def test_the_model_doubts_its_own_outcome_for_a_smaller_change_than_an_engine_s(boundary):
    near = pulse(boundary * (1 - 1e-5))
    model = simulate(near, history=False)
    assert list(doubts(near, model, model)) == []
    (sentence,) = said(near, replace(model))
    assert "hangs on a change of 1e-04" in sentence
