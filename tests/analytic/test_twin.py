import math

import numpy as np
import pytest
from literature import A_REST, A_TILT, B_TILT
from record_files import RECORDS, needs_records
from scipy.integrate import solve_ivp

from analytic import closed_form
from analytic.caryatid import BASE, caryatid_block
from analytic.caryatid import BEARINGS as LRB
from analytic.errors import SettingError
from analytic.motion import PulseMotion, SampledMotion
from analytic.problems import problem_a, problem_b
from analytic.records import read_record
from analytic.scene import Block, Scene, Start
from analytic.twin import segments, simulate_twin

P, GAMMA = 2.60, 0.25
HOUSNER = 1 - 1.5 * math.sin(GAMMA) ** 2
CARYATID, SLENDER = caryatid_block(0.28), caryatid_block(0.15)


def count_to(run, rate):
    """Number of impacts until |w+| < rate."""
    return next(n for n, impact in enumerate(run.impacts, 1) if abs(impact.rate_after) < rate)


@pytest.mark.parametrize(
    ("method", "rtol", "tolerance"),
    [("DOP853", 1e-12, 2e-11), ("RK45", 1e-10, 5e-9), ("LSODA", 1e-11, 2e-8), ("Radau", 1e-8, 5e-8)],
)
def test_problem_a(method, rtol, tolerance):
    run = simulate_twin(problem_a(), method=method, rtol=rtol, history=False, energy=False)
    exact = closed_form.free_rocking(P, GAMMA, HOUSNER, 0.9 * GAMMA, 10)
    assert run.impact_count == 10 and run.variant == method
    np.testing.assert_allclose([impact.time for impact in run.impacts], exact.times, rtol=0, atol=tolerance)
    np.testing.assert_allclose([abs(impact.rate_after) for impact in run.impacts], exact.rates_after, rtol=tolerance)
    assert abs(run.end.tilt) == pytest.approx(A_TILT, abs=tolerance)


def test_rest_of_problem_a():
    scene = problem_a(12.0)
    run = simulate_twin(scene, rtol=1e-12)
    assert [count_to(run, share * P) for share in A_REST] == [count for count, _ in A_REST.values()]
    assert run.impact_count == 177
    assert run.rests[0] == pytest.approx(closed_form.rest_time(P, GAMMA, HOUSNER, 0.9 * GAMMA), abs=1e-9)
    assert (run.end.tilt, run.end.tilt_rate, run.energy.input, run.energy.kinetic) == (0, 0, 0, 0)
    released = scene.block.mass * 9.81 * scene.block.radius * (math.cos(0.025) - math.cos(0.25))
    assert (-run.energy.potential, run.energy.impact_loss) == pytest.approx((released, released), rel=1e-10)


@pytest.mark.parametrize("method", ["DOP853", "RK45"])
def test_problem_b(method):
    run = simulate_twin(problem_b(10.0), method=method, rtol=1e-11)
    assert run.uplifts == (pytest.approx(math.asin(1 / 1.2) / 5.2, abs=1e-14),)
    assert count_to(run, 1e-4 * P) == 81
    assert run.impacts[80].time == pytest.approx(9.145490645, abs=2e-8)
    end = simulate_twin(problem_b(), method=method, rtol=1e-11).end
    assert abs(end.tilt) == pytest.approx(B_TILT, abs=1e-9)


def test_error_falls_with_the_tolerance():
    runs = [simulate_twin(problem_a(), rtol=rtol, history=False, energy=False) for rtol in (1e-6, 1e-8, 1e-10, 1e-12)]
    errors = [abs(abs(run.end.tilt) - A_TILT) for run in runs]
    assert errors == sorted(errors, reverse=True) and errors[-1] < 1e-11


def test_start_flat_with_a_rate_rocks_to_the_side_of_the_rate():
    for rate in (0.1, -0.1):
        run = simulate_twin(problem_a(0.05).with_(start=Start(tilt_rate=rate)))
        assert run.end.tilt * rate > 0 and run.outcome == "rocks" and run.uplifts == ()


def test_rest_limit_is_the_same_whenever_impacts_are_declared_accumulated():
    # under a bearing force the two corners are pressed down unequally
    scene = Scene(block=SLENDER, base=BASE, bearings=LRB, duration=4.0, start=Start(tilt=0.02, base_displacement=0.1))
    limits = [simulate_twin(scene, rtol=1e-12, rest_rate=rate).rests[0] for rate in (1e-5, 1e-7, 1e-9)]
    assert abs(limits[1] - limits[2]) < 1e-9 and abs(limits[0] - limits[2]) < 1e-6


def test_restitution_of_one_fails_instead_of_bouncing_for_ever(monkeypatch):
    monkeypatch.setattr("analytic.twin.IMPACT_LIMIT", 100)
    run = simulate_twin(problem_a().with_(block={"restitution": 1.0}, start=Start(tilt=1e-9)))
    assert run.outcome == "failed" and "pile up" in run.failure.reason
    assert run.failure.last_state.time < 7


def test_event_that_scipy_cannot_find_is_a_failure_with_scipys_words(monkeypatch):
    """LSODA's dense output may miss its own sign change: brentq then raises inside `solve_ivp`."""
    calls, words = [], "f(a) and f(b) must have different signs"

    def third_call_raises(*args, **settings):
        calls.append(args[1])
        if len(calls) == 3:
            raise ValueError(words)
        return solve_ivp(*args, **settings)

    scene = Scene(block=SLENDER, base=BASE, bearings=LRB, start=Start(tilt=0.1), duration=3.0)
    whole = simulate_twin(scene, method="LSODA", rtol=1e-8)
    monkeypatch.setattr("analytic.twin.solve_ivp", third_call_raises)
    run = simulate_twin(scene, method="LSODA", rtol=1e-8)
    assert whole.outcome == "rocks" and run.outcome == "failed"
    assert (run.failure.reason, run.to_json()["failure"]["message"]) == ("scipy could not find an event", words)
    # it broke off where the third stretch began, and says so; what was found before is kept
    assert run.failure.last_state == run.end and 0 < run.end.time == calls[2][0] < 3.0
    assert run.impacts == tuple(impact for impact in whole.impacts if impact.time <= run.end.time)
    assert run.history.time[-1] == run.end.time and run.peak_tilt == 0.1


def test_extra_energy_and_history_do_not_change_the_outcome():
    bare = simulate_twin(problem_b(), rtol=1e-12, history=False, energy=False)
    full = simulate_twin(problem_b(), rtol=1e-12)
    assert bare.history is bare.energy is None and full.history.time[[0, -1]].tolist() == [0, 6]
    assert bare.end.tilt == pytest.approx(full.end.tilt, abs=1e-9)


@pytest.mark.parametrize("settings", [{"method": "Euler"}, {"rtol": 0.0}])
def test_settings_are_checked(settings):
    with pytest.raises(SettingError, match=str(next(iter(settings.values())))):
        simulate_twin(problem_a(), **settings)


def test_segments_cover_the_run_and_equal_the_motion():
    pulses = [
        PulseMotion(shape, 2.0, 3.0, 0.5) for shape in ("one-sine", "one-cosine", "half-sine", "rectangular", "ricker")
    ]
    record = SampledMotion(0.1, np.random.default_rng(1).normal(size=30))
    for motion in (*pulses, record, None):
        pieces = segments(motion, 20.0)
        assert pieces[0][0] == 0 and pieces[-1][1] == 20
        for (start, end, ground), after in zip(pieces, [*pieces[1:], (20.0,)], strict=True):
            assert end == after[0] and end > start
            inside = np.linspace(start, end, 7)[1:-1]
            values = [ground(t) for t in inside.tolist()]
            expected = motion.acceleration(inside) if motion else np.zeros(5)
            np.testing.assert_allclose(values, expected, rtol=0, atol=1e-13)
            assert (np.diff(values) >= 0).all() or (np.diff(values) <= 0).all()


@needs_records
def test_the_papers_outcomes_under_duzce():
    free = Scene(block=CARYATID, motion=read_record(RECORDS / "RSN1605_DUZCE_DZC270.AT2"), duration=12.0)
    run = simulate_twin(free, rtol=1e-8)
    assert run.outcome == "overturns" and 6 < run.overturning_time < 9
    run = simulate_twin(free.with_(base=BASE, bearings=LRB), rtol=1e-8)
    assert run.outcome == "stands"
    assert run.peak_base_displacement == pytest.approx(0.212, rel=5e-3)
    assert run.peak_base_acceleration / 9.81 == pytest.approx(0.236, rel=5e-3)


def test_two_crossings_within_one_step_are_found():
    # coarse records make the block graze the ground and leave again between two samples
    block, uplift = Block(mass=1000.0, radius=1.0, slenderness=0.4), 9.81 * math.tan(0.4)
    for seed in range(12):
        samples = np.random.default_rng(seed).normal(size=25) * 1.5 * uplift
        scene = Scene(block=block, motion=SampledMotion(0.1, samples), duration=2.5)
        coarse = simulate_twin(scene, history=False, energy=False)
        fine = simulate_twin(scene, max_step=1e-2, history=False, energy=False)
        assert coarse.impact_count == fine.impact_count, seed
