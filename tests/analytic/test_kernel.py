"""The compiled kernel against closed forms, conservation laws, symmetry and its own order."""

import math

import numpy as np
import pytest
from literature import A_IMPACTS, A_REST, A_TILT, B_TILT, ONE_SINE, ONE_SINE_SLENDER, under_a_pulse
from rough_motions import rough

from analytic import Scene, SettingError, Start, closed_form, simulate
from analytic.caryatid import BASE, caryatid_block
from analytic.caryatid import BEARINGS as LRB
from analytic.kernel import run
from analytic.layout import END_TILT, END_Z
from analytic.problems import problem_a, problem_b
from analytic.solver import ground, options, parameters

P = 2.6
CARYATID = caryatid_block(0.28)
PROBLEM_A, PROBLEM_B = problem_a(12.0), problem_b(12.0)


def isolated(slenderness=0.18, **parts):
    scene = Scene(block=CARYATID, base=BASE, bearings=LRB, motion=rough(3), duration=8.0)
    return scene.with_(block={"slenderness": slenderness}, **parts)


def end_state(scene, tolerance):
    chosen = options(tolerance, record=False)
    return run(parameters(scene), ground(scene.motion), chosen)[0][END_TILT : END_Z + 1]


def impacts_until(response, rate):
    """Number and time of the first impact that leaves less than `rate` [rad/s]."""
    return next((n, impact.time) for n, impact in enumerate(response.impacts, 1) if abs(impact.rate_after) < rate)


@pytest.mark.parametrize(("settings", "accuracy"), [({"tolerance": 1e-16}, 1e-13), ({}, 1e-10)])
def test_a(settings, accuracy):
    response = simulate(PROBLEM_A, **settings)
    times = [impact.time for impact in response.impacts[:10]]
    assert times == pytest.approx(A_IMPACTS, rel=accuracy)
    end = simulate(PROBLEM_A.with_(duration=7.0), **settings).end
    assert abs(end.tilt) == pytest.approx(A_TILT, rel=10 * accuracy)


def test_a_comes_to_rest_after_every_impact():
    response = simulate(PROBLEM_A, tolerance=1e-16)
    for rate, (number, time) in A_REST.items():
        assert impacts_until(response, rate * P) == (number, pytest.approx(time, abs=1e-11))
    limit = closed_form.rest_time(P, 0.25, 1 - 1.5 * math.sin(0.25) ** 2, 0.9 * 0.25)
    assert response.rests == (pytest.approx(limit, abs=1e-11),)
    assert (response.end.tilt, response.end.tilt_rate) == (0, 0)


@pytest.mark.parametrize("number", [5, 20, 40, 60])
def test_a_run_may_end_in_any_swing_however_short(number):
    known = P, 0.25, 1 - 1.5 * math.sin(0.25) ** 2, 0.9 * 0.25
    begin, end = closed_form.free_rocking(*known, number + 1).times[-2:]
    duration = float(begin + 0.3 * (end - begin))
    found = simulate(problem_a(duration)).end
    assert (found.time, found.tilt) == (
        duration,
        pytest.approx(closed_form.free_rocking_tilt(*known, duration), rel=1e-5),
    )


def test_b():
    response = simulate(PROBLEM_B, tolerance=1e-16)
    assert response.uplifts == pytest.approx([math.asin(1 / 1.2) / 5.2], abs=1e-15)
    assert impacts_until(response, 1e-4 * P) == (81, pytest.approx(9.145490645, abs=1e-9))
    end = simulate(PROBLEM_B.with_(duration=6.0), tolerance=1e-16).end
    assert abs(end.tilt) == pytest.approx(B_TILT, rel=1e-12)


@pytest.mark.parametrize("ratio", ONE_SINE)
@pytest.mark.parametrize("table, slenderness", [(ONE_SINE, 0.25), (ONE_SINE_SLENDER, 1e-4)])
def test_boundaries(table, slenderness, ratio):
    # one-sine pulse, p = 2.14, e = 0.9: given to five decimals
    for k, boundary in enumerate(table[ratio]):
        for factor, above in ((1 - 1e-5, False), (1 + 1e-5, True)):
            scene = under_a_pulse(boundary * factor, ratio, slenderness)
            response = simulate(scene, history=False)
            overturns = response.outcome == "overturns" and response.unstable_time is not None
            assert overturns == (above == (k % 2 == 0))


@pytest.mark.parametrize("amplitude", [1.2, 2.0, 5.0])
def test_the_shortest_rectangular_pulse_that_overturns_a_slender_block(amplitude):
    """Without an impact: log(a/(a - 1))/p (Housner 1963), a over g gamma."""
    shortest = math.log(amplitude / (amplitude - 1)) / 2.14
    for factor in (1 - 1e-4, 1 + 1e-4):
        scene = under_a_pulse(amplitude, math.pi / (factor * shortest * 2.14), 1e-4, "rectangular")
        assert (simulate(scene, history=False).outcome == "overturns") == (factor > 1)


@pytest.mark.parametrize(
    "scene",
    [PROBLEM_A.with_(duration=3.0), isolated(motion=None, start=Start(tilt=0.1), duration=0.5)],
    ids=["rigid", "base"],
)
def test_error_falls_as_asked(scene):
    exact = end_state(scene, 1e-17)
    tolerances = np.array([1e-4, 1e-6, 1e-8, 1e-10, 1e-12])
    errors = np.array([np.abs(end_state(scene, tolerance) - exact).max() for tolerance in tolerances])
    slope = np.polyfit(np.log10(tolerances), np.log10(errors), 1)[0]
    assert 0.8 < slope < 1.3
    # a steady factor above the tolerance: what the motion makes of a local error
    scale = np.abs(exact[2:]).max() if scene.base else 1.0
    assert (errors[2:] < 1e4 * tolerances[2:] * scale).all()


@pytest.mark.parametrize(
    ("setting", "value"),
    [("tolerance", 0.0), ("tolerance", 1.0), ("rest_rate", 0.0), ("output_step", -1.0), ("tolerance", math.nan)],
)
def test_out_of_range(setting, value):
    with pytest.raises(SettingError, match=setting):
        simulate(PROBLEM_A, **{setting: value})


def test_more_events_than_the_first_try_keeps(monkeypatch):
    monkeypatch.setattr("analytic.solver.CAPACITY", 16)
    assert simulate(PROBLEM_A).impact_count == 177
