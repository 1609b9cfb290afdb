"""Analytic trajectories, sampled as an engine would hand them over, must give the analytic events back."""

import dataclasses
import math

import numpy as np
import pytest
from sampled_traces import BASE, BEARINGS, EDGE, SCENES, block, sampled, seen, shaking

from analytic import Base, Bearings, Caution, Failure, PulseMotion, Scene, Start, simulate
from engines.checks import (
    GAIN_LIMIT,
    HEIGHT_TOLERANCE,
    SLIDING_TOLERANCE,
    check_place,
    energy_balance,
    pivoting_centre,
    replayed_force,
)
from engines.observe import Trace, energy_gain, replay_bearing
from engines.swings import find_swings


def strong(response, share=0.05):
    """Impacts whose rate is at least a share of the strongest: those that coarse steps resolve."""
    least = share * max(abs(impact.rate_before) for impact in response.impacts)
    return [impact for impact in response.impacts if abs(impact.rate_before) > least]


# Errors of (time, rate before, rate after, jump). With bearings the worst is a step in which the base turns round
# before the impact: that turn is not followed (3e-4 rad/s where it falls into a step of 25 ms; 1e-8 elsewhere).
@pytest.mark.parametrize(
    "name, mean_step, tolerance",
    [
        ("rigid ground", 1e-3, 1e-9),
        ("rigid ground", 8e-3, 1e-9),
        ("sliding base", 1e-3, 1e-9),
        ("sliding base", 4e-3, 1e-9),
        ("isolated", 5e-4, 1e-9),
        ("isolated", 4e-3, 4e-4),
        ("isolated, shaken", 5e-4, 1e-6),
        ("rigid ground, shaken", 5e-4, 1e-6),
    ],
)
def test_impacts_do_not_depend_on_the_steps(name, mean_step, tolerance):
    scene = SCENES[name]
    trace, reference = sampled(scene, mean_step)
    response = seen(scene, trace)
    wanted, found = strong(reference), strong(response)
    assert len(wanted) >= 4
    assert len(found) == len(wanted)
    for one, other in zip(found, wanted, strict=True):
        np.testing.assert_allclose(dataclasses.astuple(one), dataclasses.astuple(other), rtol=0, atol=tolerance)
    assert response.outcome == reference.outcome == "rocks"


def test_rates_smeared_around_the_impact_do_not_change_what_is_found():
    scene = SCENES["rigid ground"]
    trace, reference = sampled(scene, 2.5e-4, contact_tilt=2e-4)
    near = np.abs(trace.tilt) < 2e-4  # as in a compliant contact: the rates there mean nothing
    smeared = dataclasses.replace(trace, tilt_rate=np.where(near, 0.3 * trace.tilt_rate, trace.tilt_rate))
    for one, other in zip(seen(scene, smeared).impacts[:8], reference.impacts[:8], strict=True):
        np.testing.assert_allclose(dataclasses.astuple(one), dataclasses.astuple(other), rtol=0, atol=1e-9)


def test_ringing_after_an_impact_is_waited_out():
    scene = SCENES["isolated"]
    trace, reference = sampled(scene, 5e-4)
    after = trace.time - np.max(
        np.where([[i.time] < trace.time for i in reference.impacts], [[i.time] for i in reference.impacts], -1.0),
        axis=0,
    )
    ringing = np.where(after < 4e-3, 1e-2 * np.sin(4000 * trace.time), 0.0)
    rung = dataclasses.replace(trace, tilt_rate=trace.tilt_rate + ringing)
    settled = dataclasses.replace(rung, settle=5e-3)
    wanted = np.array([i.rate_after for i in reference.impacts[:3]])
    errors = [
        np.abs(np.array([i.rate_after for i in seen(scene, one).impacts[:3]]) - wanted).max() for one in (rung, settled)
    ]
    assert errors[0] > 1e-4 and errors[1] < 1e-5


@pytest.mark.parametrize("name", ["rigid ground", "isolated, shaken"])
def test_mirror(name):
    scene = SCENES[name]
    mirrored = scene.with_(
        motion=scene.motion.scaled(-1.0) if scene.motion else None, start={"tilt": -scene.start.tilt}
    )
    here, there = seen(scene, sampled(scene, 1e-3)[0]), seen(mirrored, sampled(scene, 1e-3, side=-1)[0])
    assert there.impacts == tuple(
        dataclasses.replace(
            i, rate_before=-i.rate_before, rate_after=-i.rate_after, base_velocity_jump=-i.base_velocity_jump
        )
        for i in here.impacts
    )
    for field in (
        "outcome",
        "uplifts",
        "rests",
        "peak_tilt",
        "peak_base_displacement",
        "friction_demand",
        "min_normal_ratio",
        "peak_base_acceleration",
        "unstable_time",
    ):
        assert getattr(here, field) == getattr(there, field), field


def test_contact_noise_is_no_impact():
    scene = Scene(block=block(0.25), base=BASE, bearings=BEARINGS, motion=shaking(1.0), duration=15.0)
    quiet, reference = sampled(scene, 1e-3)
    trace, _ = sampled(scene, 1e-3, noise=0.99 * EDGE)
    response = seen(scene, trace)
    assert reference.outcome == response.outcome == "stands"
    assert (response.impacts, response.uplifts, response.rests) == ((), (), ())
    # The check can fail: the same noise above the edge of contact is seen.
    assert seen(scene, dataclasses.replace(trace, contact_tilt=0.5 * EDGE)).outcome == "rocks"
    assert seen(scene, quiet).peak_base_displacement == pytest.approx(reference.peak_base_displacement, rel=1e-6)


def test_noise_at_rest_after_rocking_adds_nothing():
    scene = SCENES["sliding base"]
    quiet, _ = sampled(scene, 1e-3)
    at_rest = quiet.time > 2.0
    noise = np.where(at_rest, 0.99 * EDGE * np.random.default_rng(1).uniform(-1, 1, len(at_rest)), 0.0)
    noisy = dataclasses.replace(quiet, tilt=quiet.tilt + noise)
    assert seen(scene, noisy).impacts == seen(scene, quiet).impacts
    assert seen(scene, noisy).rests == seen(scene, quiet).rests


@pytest.mark.parametrize("name, tolerance", [("rigid ground", 1e-6), ("sliding base", 1e-6)])
def test_the_chattering_tail_ends_in_one_rest_at_its_limit(name, tolerance):
    scene = SCENES[name]
    trace, reference = sampled(scene, 5e-4)
    response = seen(scene, trace)
    assert len(response.impacts) < len(reference.impacts)  # the tail below resolution is not reported
    assert all(impact.rate_after != 0 for impact in response.impacts)  # nor is its first unresolved landing
    assert len(response.rests) == len(reference.rests) == 1
    assert response.rests[0] == pytest.approx(reference.rests[0], abs=tolerance)


def test_a_stocky_block_lands_flat():
    scene = Scene(block=block(0.9), base=BASE, start=Start(tilt=0.3), duration=2.0)
    trace, reference = sampled(scene, 2e-3)
    response = seen(scene, trace)
    assert len(response.impacts) == len(reference.impacts) == 1
    np.testing.assert_allclose(
        dataclasses.astuple(response.impacts[0]), dataclasses.astuple(reference.impacts[0]), rtol=0, atol=1e-9
    )
    assert response.impacts[0].rate_after == 0.0
    assert response.rests == pytest.approx(reference.rests, abs=1e-9)


def test_uplift_is_where_the_acceleration_crosses_its_threshold():
    scene = Scene(
        block=block(0.25), duration=3.0, motion=PulseMotion("one-sine", 1.2 * 9.81 * math.tan(0.25), 5.2, start=0.5)
    )
    trace, reference = sampled(scene, 1e-3)
    assert seen(scene, trace).uplifts == pytest.approx(reference.uplifts, abs=1e-5)
    assert reference.uplifts == pytest.approx([0.5 + math.asin(1 / 1.2) / 5.2], abs=1e-9)


@pytest.mark.parametrize("name, tolerance", [("rigid ground, shaken", 0.02), ("isolated, shaken", 0.003)])
def test_every_uplift_and_rest_under_shaking_is_found_and_no_other(name, tolerance):
    scene = SCENES[name]
    trace, reference = sampled(scene, 5e-4)
    response = seen(scene, trace)
    assert len(reference.uplifts) >= 1 and len(reference.rests) >= 1
    assert response.uplifts == pytest.approx(reference.uplifts, abs=1e-5)
    # The limit of the impacts below resolution is taken at constant acceleration.
    assert response.rests == pytest.approx(reference.rests, abs=tolerance)


@pytest.mark.parametrize("mean_step, tolerance", [(5e-4, 1e-4), (4e-3, 5e-3)])
def test_peaks_of_the_base_end_at_the_last_passage_of_the_slenderness(mean_step, tolerance):
    """What the fall from there on adds, 6 % of the displacement here, is not the base's."""
    motion = PulseMotion("half-sine", 14.0, 4.0)
    stiff = Bearings(count=4, ka=2e5, kb=2e4, alpha=44.69)
    scene = Scene(block=block(0.3), base=Base(mass=50.0), bearings=stiff, motion=motion, duration=5.0)
    trace, reference = sampled(scene, mean_step)
    response = seen(scene, trace)
    assert reference.outcome == response.outcome == "overturns"
    whole = np.abs(reference.history.base_displacement).max()
    assert whole > 1.04 * reference.peak_base_displacement
    assert response.peak_base_displacement == pytest.approx(reference.peak_base_displacement, rel=tolerance)
    assert response.peak_base_acceleration == pytest.approx(reference.peak_base_acceleration, rel=4 * tolerance)
    assert response.min_normal_ratio == pytest.approx(reference.min_normal_ratio, abs=10 * tolerance)


def overturning():
    return Scene(block=block(0.2), start=Start(tilt=0.21), duration=5.0)


@pytest.mark.parametrize("step", [1e-3, 1e-2])
def test_overturning_time_of_a_run_stopped_at_1_5_rad(step):
    scene = overturning()
    reference = simulate(scene, output_step=step)
    last = np.searchsorted(reference.history.tilt, 1.5)
    trace = Trace(*(getattr(reference.history, name)[: last + 1] for name in Trace.COLUMNS), EDGE)
    response = seen(scene, trace, ended="overturned")
    assert response.outcome == "overturns"
    # At constant acceleration over the last 0.07 rad: omega_r^2 (0.025 s)^3/6 = 2e-5 s.
    assert response.overturning_time == pytest.approx(reference.overturning_time, abs=2e-5)
    assert seen(scene, trace).outcome == "failed"  # without the adapter's word it only ended early


def test_the_crossing_of_half_a_turn_is_interpolated_to_fourth_order():
    scene, level = overturning(), math.pi / 2
    exact = 1.0
    errors = []
    for step in (0.02, 0.01):
        time = np.arange(0.9 - 0.37 * step, 1.1, step)
        # a fall faster than exponential, pi/2 at t = 1
        tilt, rate = level * np.exp(2.5 * (time - exact)), 2.5 * level * np.exp(2.5 * (time - exact))
        zero = np.zeros_like(time)
        response = seen(scene, Trace(time, tilt, rate, zero, zero, zero, EDGE), failure=Failure("energy not checked"))
        errors.append(abs(response.overturning_time - exact))
        assert response.end.time == response.overturning_time
        assert response.end.tilt == level == response.peak_tilt
    assert errors[0] < 1e-8 and errors[1] < errors[0] / 8


def test_peaks_are_refined_between_steps():
    scene = SCENES["isolated"]
    trace, reference = sampled(scene, 4e-3)
    response = seen(scene, trace)
    assert response.peak_base_displacement == pytest.approx(reference.peak_base_displacement, rel=1e-5)
    assert np.abs(trace.base_displacement).max() < reference.peak_base_displacement * (1 - 1e-5)


@pytest.mark.parametrize("name", ["sliding base", "isolated, shaken"])
def test_contact_forces_match_the_reference(name):
    scene = SCENES[name]
    trace, reference = sampled(scene, 2.5e-4, step=1.25e-4)
    response = seen(scene, trace)
    assert response.friction_demand == pytest.approx(reference.friction_demand, rel=0.01)
    assert response.min_normal_ratio == pytest.approx(reference.min_normal_ratio, rel=0.01)
    assert response.peak_base_acceleration == pytest.approx(reference.peak_base_acceleration, rel=0.01)


def test_history_follows_the_reference_on_the_motions_grid():
    scene = SCENES["isolated, shaken"]
    trace, _ = sampled(scene, 5e-4)
    history, wanted = seen(scene, trace).history, simulate(scene).history
    assert len(history.time) == len(wanted.time)
    np.testing.assert_allclose(history.time, wanted.time, atol=1e-12)
    np.testing.assert_allclose(history.tilt, wanted.tilt, atol=1e-5)
    np.testing.assert_array_equal(history.ground_acceleration, wanted.ground_acceleration)
    assert seen(scene, trace, history=False).history is None


def test_a_state_that_is_not_finite_fails_with_the_last_finite_one():
    scene = SCENES["rigid ground"]
    trace, _ = sampled(scene, 1e-3)
    tilt = trace.tilt.copy()
    tilt[700:] = np.nan
    response = seen(scene, dataclasses.replace(trace, tilt=tilt))
    assert response.outcome == "failed"
    assert "no longer finite" in response.failure.reason and "step 700" in response.failure.message
    assert response.failure.last_state.time == trace.time[699] and response.end.tilt == trace.tilt[699]
    tilt[:] = np.nan
    assert seen(scene, dataclasses.replace(trace, tilt=tilt)).outcome == "failed"


def test_a_run_that_stops_early_fails_and_the_engines_own_failure_is_kept():
    scene = SCENES["rigid ground"]
    trace, _ = sampled(scene, 1e-3)
    assert "ended early" in seen(scene, trace.upto(500)).failure.reason
    own = seen(scene, trace.upto(500), failure=Failure("Newton failed", "error code 7"))
    assert (own.failure.reason, own.failure.message) == ("Newton failed", "error code 7")
    assert own.failure.last_state.time == trace.time[499]


def test_warnings_of_the_engine_and_of_the_record_reach_the_response_once():
    scene = SCENES["rigid ground, shaken"]
    odd = scene.with_(motion=dataclasses.replace(scene.motion, warnings=("the record is odd",)))
    trace, _ = sampled(scene, 2e-3)
    said = Caution("record", "the record is odd"), Caution("engine", "soft")
    assert seen(scene, trace).warnings == ()
    assert seen(odd, trace, warnings=["soft", "soft"]).warnings == said
    gone = dataclasses.replace(trace, tilt=np.full_like(trace.tilt, np.nan))
    assert seen(odd, gone, warnings=("soft",)).warnings == said
    quiet = SCENES["rigid ground"]
    assert seen(quiet, sampled(quiet, 2e-3)[0], warnings=("soft",)).warnings == said[1:]


def test_a_run_outside_the_model_is_warned_of_but_not_a_failed_one():
    scene = SCENES["rigid ground, shaken"]
    trace, reference = sampled(scene, 2e-3)
    slippery = scene.with_(friction=0.5 * reference.friction_demand)
    (warning,) = seen(slippery, trace).warnings
    assert (warning.kind, warning.quantity) == ("model", "friction_demand") and warning.value > warning.limit
    assert seen(scene.with_(friction=2 * reference.friction_demand), trace).warnings == ()
    assert seen(slippery, trace, failure=Failure("it broke")).warnings == ()


def test_a_gain_of_energy_fails():
    scene = SCENES["rigid ground"]
    trace, _ = sampled(scene, 1e-3)
    later = trace.time > 3.0
    thrown = dataclasses.replace(trace, tilt_rate=np.where(later, trace.tilt_rate + 2.0, trace.tilt_rate))
    assert energy_gain(scene, thrown) > GAIN_LIMIT
    assert "energy" in seen(scene, thrown).failure.reason


def thrown(spin=6.0):
    """(scene, trace) of a block thrown off its corner: from there a parabola and an even turn, exact in flight."""
    scene = Scene(block=block(0.25), start=Start(tilt=0.1, tilt_rate=spin), duration=0.2)
    time = np.linspace(0, 0.2, 101)
    zero = np.zeros_like(time)
    trace = Trace(time, 0.1 + spin * time, zero + spin, zero, zero, zero, EDGE)
    x, z, across, up = pivoting_centre(scene, trace)[0]
    fall = scene.gravity * time
    return scene, dataclasses.replace(
        trace, centre=np.column_stack([x + across * time, z + up * time - fall * time / 2, zero + across, up - fall])
    )


def test_free_flight_keeps_its_energy_where_the_centre_is_read():
    scene, trace = thrown()
    balance, kinetic = energy_balance(scene, trace)
    assert np.ptp(balance) < 1e-12 * kinetic.max() and energy_gain(scene, trace) < 1e-12
    # taken to turn about its corner, the same block would change its energy
    assert np.ptp(energy_balance(scene, dataclasses.replace(trace, centre=None))[0]) > 0.05 * kinetic.max()
    pushed = trace.centre + np.where(trace.time > 0.1, 8.0, 0.0)[:, None] * [0, 0, 0, 1]
    assert energy_gain(scene, dataclasses.replace(trace, centre=pushed)) > GAIN_LIMIT


@pytest.mark.parametrize("name", SCENES)
def test_pivoting_centre_is_that_of_the_model(name):
    """Its velocity is the derivative of its place, and the balance with it read is that without."""
    scene = SCENES[name]
    trace, _ = sampled(scene, 2e-3)
    centre = pivoting_centre(scene, trace)
    middle = np.diff(centre[:, :2], axis=0) / np.diff(trace.time)[:, None]
    flight = np.sign(trace.tilt[1:]) == np.sign(trace.tilt[:-1])  # an impact changes the velocity at once
    np.testing.assert_allclose(middle[flight], 0.5 * (centre[1:, 2:] + centre[:-1, 2:])[flight], atol=5e-3)
    np.testing.assert_allclose(
        energy_balance(scene, dataclasses.replace(trace, centre=centre)), energy_balance(scene, trace)
    )


def test_a_block_off_its_place_fails():
    scene = SCENES["rigid ground"]
    trace, _ = sampled(scene, 1e-3)
    R, n = scene.block.radius, len(trace.time)

    def moved(across=0.0, up=0.0, steps=slice(None)):
        centre = pivoting_centre(scene, trace)
        centre[steps, :2] += np.array([across, up]) * R
        return dataclasses.replace(trace, centre=centre)

    middle, slide, lift = slice(n // 3, n // 2), 1.1 * SLIDING_TOLERANCE, 1.1 * HEIGHT_TOLERANCE
    assert check_place(scene, trace, False) is None and check_place(scene, moved(), False) is None
    assert check_place(scene, moved(0.8 * slide, 0.8 * lift), False) is None
    assert "slid" in check_place(scene, moved(across=-slide), False).reason
    assert "left" in check_place(scene, moved(up=lift), False).reason
    assert "sank" in check_place(scene, moved(up=-lift), False).reason
    assert check_place(scene, moved(up=lift, steps=middle), False) is None  # it flew and landed
    assert check_place(scene, moved(across=slide), True) is None  # it fell over: anywhere
    assert "slid" in seen(scene, moved(across=slide)).failure.reason


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("mean_step", [2e-3, 1 / 60])
def test_legitimate_runs_stay_far_below_the_gain_limit(name, mean_step):
    trace, _ = sampled(SCENES[name], mean_step)
    assert energy_gain(SCENES[name], trace) < 0.1 * GAIN_LIMIT


def test_bearing_replay_is_exact_and_sees_a_lag():
    scene = SCENES["isolated, shaken"]
    trace, _ = sampled(scene, 1e-3)
    exact = dataclasses.replace(trace, bearing_force=replayed_force(scene, trace))
    assert replay_bearing(scene, exact) == 0.0
    assert replay_bearing(scene, trace) < 1e-2  # reversals inside the steps are not seen by the replay
    lagging = dataclasses.replace(exact, bearing_force=np.append(0.0, exact.bearing_force[:-1]))
    assert replay_bearing(scene, lagging) > 1e-2
    assert replay_bearing(SCENES["sliding base"], trace) == 0.0


@pytest.mark.parametrize(
    "changes, message",
    [
        ({"tilt": np.zeros(3)}, "trace.tilt has shape"),
        ({"time": np.array([0.0, 1.0, 1.0, 2.0])}, "does not increase"),
        ({"contact_tilt": 0.0}, "contact_tilt"),
        ({"centre": np.zeros((4, 3))}, "trace.centre"),
    ],
)
def test_a_trace_that_makes_no_sense_is_refused(changes, message):
    zero = np.zeros(4)
    good = Trace(np.arange(4.0), zero, zero, zero, zero, zero, EDGE)
    assert len(find_swings(good)) == 0
    with pytest.raises(ValueError, match=message):
        dataclasses.replace(good, **changes)
