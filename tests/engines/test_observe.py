"""Analytic trajectories, sampled as an engine would hand them over, must give the analytic events back.

What measuring cannot resolve, or what cannot be, is a failure with its numbers; sound runs are not accused.
"""

import dataclasses
import math

import numpy as np
import pytest
from bearing_laws import to_law
from sampled_traces import BASE, BEARINGS, EDGE, SCENES, block, observed, sampled, seen, shaking

from analytic import Base, Bearings, Caution, Failure, PulseMotion, Scene, Start, simulate
from engines import swings
from engines.events import MOST_RESTITUTION, check_impacts, find_events, straddled
from engines.swings import Trace, find_swings
from engines.trace_checks import (
    GAIN_LIMIT,
    HEIGHT_TOLERANCE,
    IMPULSE_LIMIT,
    SLIDING_TOLERANCE,
    check_place,
    energy_balance,
    energy_gain,
    impulse_error,
    missing_impulse,
    pivoting_centre,
    replay_bearing,
    replayed_force,
)


def strong(response):
    """Impacts, as rows, whose rate is at least .05 of the strongest: those that coarse steps resolve."""
    rows = np.array([dataclasses.astuple(impact) for impact in response.impacts])
    return rows[np.abs(rows[:, 1]) > 0.05 * np.abs(rows[:, 1]).max()]


# Errors of (time, rate before, rate after, jump). With bearings the worst is a step in which the base turns round
# before the impact: that turn is not followed (3e-4 rad/s where it falls into a step of 25 ms; 1e-8 elsewhere).
@pytest.mark.parametrize(
    "name, mean_step, tolerance",
    [
        ("rigid ground", 8e-3, 1e-9),
        ("sliding base", 4e-3, 1e-9),
        ("isolated", 4e-3, 4e-4),
        ("isolated, shaken", 5e-4, 1e-6),
        ("rigid ground, shaken", 5e-4, 1e-6),
    ],
)
def test_impacts_do_not_depend_on_the_steps(name, mean_step, tolerance):
    _, _, reference, response = observed(name, mean_step)
    assert len(strong(reference)) >= 4 and response.outcome == reference.outcome == "rocks"
    np.testing.assert_allclose(strong(response), strong(reference), rtol=0, atol=tolerance)


def test_ringing_after_an_impact_is_waited_out():
    scene, trace, reference, _ = observed("isolated", 5e-4)
    last = np.searchsorted([impact.time for impact in reference.impacts], trace.time)
    after = trace.time - np.array([-1.0, *(impact.time for impact in reference.impacts)])[last]
    ringing = np.where(after < 4e-3, 1e-2 * np.sin(4000 * trace.time), 0.0)
    rung = dataclasses.replace(trace, tilt_rate=trace.tilt_rate + ringing)
    waited, not_waited = (
        np.abs(strong(seen(scene, dataclasses.replace(rung, settle=settle)))[:3, 2] - strong(reference)[:3, 2]).max()
        for settle in (5e-3, 0.0)
    )
    assert not_waited > 1e-4 and waited < 1e-5


def test_contact_noise_is_no_impact():
    scene = Scene(block=block(0.25), base=BASE, bearings=BEARINGS, motion=shaking(1.0), duration=15.0)
    _, trace, reference, response = observed(scene, 1e-3, noise=0.99 * EDGE)
    assert reference.outcome == response.outcome == "stands"
    assert (response.impacts, response.uplifts, response.rests) == ((), (), ())
    # The check can fail: the same noise above the edge of contact is seen.
    assert seen(scene, dataclasses.replace(trace, contact_tilt=0.5 * EDGE)).uplifts


@pytest.mark.parametrize(
    "name, tolerance",
    [("rigid ground", 1e-6), ("sliding base", 1e-6), ("rigid ground, shaken", 0.02), ("isolated, shaken", 0.003)],
)
def test_every_uplift_and_rest_is_found_and_no_other(name, tolerance):
    """The limit of the impacts below resolution, of which none is reported, is taken at constant acceleration."""
    _, _, reference, response = observed(name, 5e-4)
    assert len(reference.uplifts) >= ("shaken" in name) and len(reference.rests) >= 1
    assert len(response.impacts) < len(reference.impacts) and all(impact.rate_after for impact in response.impacts)
    assert response.uplifts == pytest.approx(reference.uplifts, abs=1e-5)
    assert response.rests == pytest.approx(reference.rests, abs=tolerance)


@pytest.mark.parametrize("mean_step, tolerance", [(5e-4, 1e-4), (4e-3, 5e-3)])
def test_peaks_of_the_base_end_at_the_last_passage_of_the_slenderness(mean_step, tolerance):
    """What the fall from there on adds, 6 % of the displacement here, is not the base's."""
    stiff, motion = Bearings(count=4, ka=2e5, kb=2e4, alpha=44.69), PulseMotion("half-sine", 14.0, 4.0)
    given = Scene(block=block(0.3), base=Base(mass=50.0), bearings=stiff, motion=motion, duration=5.0)
    _, _, reference, response = observed(given, mean_step)
    assert reference.outcome == response.outcome == "overturns"
    assert np.abs(reference.history.base_displacement).max() > 1.04 * reference.peak_base_displacement
    assert response.peak_base_displacement == pytest.approx(reference.peak_base_displacement, rel=tolerance)
    assert response.peak_base_acceleration == pytest.approx(reference.peak_base_acceleration, rel=4 * tolerance)
    assert response.min_normal_ratio == pytest.approx(reference.min_normal_ratio, abs=10 * tolerance)


OVERTURNING = Scene(block=block(0.2), start=Start(tilt=0.21), duration=5.0)


def test_overturning_time_of_a_run_stopped_at_1_5_rad():
    """At constant acceleration over the last 0.07 rad: omega_r^2 (0.025 s)^3/6 = 2e-5 s."""
    reference = simulate(OVERTURNING, output_step=1e-2)
    columns = [getattr(reference.history, name) for name in Trace.COLUMNS]
    trace = Trace(*columns, EDGE).upto(np.searchsorted(reference.history.tilt, 1.5) + 1)
    response = seen(OVERTURNING, trace, ended="overturned")
    assert response.outcome == "overturns"
    assert response.overturning_time == pytest.approx(reference.overturning_time, abs=2e-5)
    assert seen(OVERTURNING, trace).outcome == "failed"  # without the adapter's word it only ended early


def test_the_crossing_of_half_a_turn_is_interpolated_to_fourth_order():
    """Of a fall faster than exponential, pi/2 at t = 1."""
    errors = []
    for step in (0.02, 0.01):
        time = np.arange(0.9 - 0.37 * step, 1.1, step)
        tilt, zero = math.pi / 2 * np.exp(2.5 * (time - 1.0)), np.zeros_like(time)
        trace = Trace(time, tilt, 2.5 * tilt, zero, zero, zero, EDGE)
        response = seen(OVERTURNING, trace, failure=Failure("energy not checked"))
        errors.append(abs(response.overturning_time - 1.0))
        assert response.end.time == response.overturning_time and response.end.tilt == response.peak_tilt == math.pi / 2
    assert errors[0] < 1e-8 and errors[1] < errors[0] / 8


def test_peaks_are_refined_between_steps():
    _, trace, reference, response = observed("isolated", 4e-3)
    assert response.peak_base_displacement == pytest.approx(reference.peak_base_displacement, rel=1e-5)
    assert np.abs(trace.base_displacement).max() < reference.peak_base_displacement * (1 - 1e-5)


@pytest.mark.parametrize("name", ["sliding base", "isolated, shaken"])
def test_contact_forces_match_the_reference(name):
    _, _, reference, response = observed(name, 2.5e-4, step=1.25e-4)
    for field in ("friction_demand", "min_normal_ratio", "peak_base_acceleration"):
        assert getattr(response, field) == pytest.approx(getattr(reference, field), rel=0.01), field


def test_history_follows_the_reference_on_the_motions_grid():
    scene, _, _, response = observed("isolated, shaken", 5e-4)
    history, wanted = response.history, simulate(scene).history
    np.testing.assert_allclose(history.time, wanted.time, atol=1e-12)
    np.testing.assert_allclose(history.tilt, wanted.tilt, atol=1e-5)
    np.testing.assert_array_equal(history.ground_acceleration, wanted.ground_acceleration)


def test_a_run_that_stops_early_fails_with_the_last_finite_state_and_the_engines_own_failure_is_kept():
    scene, trace, *_ = observed("rigid ground", 1e-3)
    steps = np.arange(len(trace.time))
    response, nothing = (
        seen(scene, dataclasses.replace(trace, tilt=np.where(steps < sound, trace.tilt, np.nan))) for sound in (700, 0)
    )
    assert response.outcome == nothing.outcome == "failed"
    assert "no longer finite" in response.failure.reason and "step 700" in response.failure.message
    assert response.failure.last_state.time == trace.time[699] and response.end.tilt == trace.tilt[699]

    assert "ended early" in seen(scene, trace.upto(500)).failure.reason
    kept = seen(scene, trace.upto(500), failure=Failure("Newton failed", "error code 7")).failure
    assert (kept.reason, kept.message, kept.last_state.time) == ("Newton failed", "error code 7", trace.time[499])


def test_warnings_of_the_engine_and_of_the_record_reach_the_response_once():
    scene = SCENES["rigid ground, shaken"]
    odd = scene.with_(motion=dataclasses.replace(scene.motion, warnings=("the record is odd",)))
    trace, _ = sampled(scene, 2e-3)
    gone = dataclasses.replace(trace, tilt=np.full_like(trace.tilt, np.nan))
    cautions = Caution("record", "the record is odd"), Caution("engine", "soft")
    assert seen(scene, trace).warnings == () and seen(scene, trace, warnings=("soft",)).warnings == cautions[1:]
    for steps in (trace, gone):
        assert seen(odd, steps, warnings=["soft", "soft"]).warnings == cautions


def test_a_run_outside_the_model_is_warned_of_but_not_a_failed_one():
    scene, trace, reference, _ = observed("rigid ground, shaken", 2e-3)
    slippery = scene.with_(friction=0.5 * reference.friction_demand)
    (warning,) = seen(slippery, trace).warnings
    assert (warning.kind, warning.quantity) == ("model", "friction_demand") and warning.value > warning.limit
    assert seen(scene.with_(friction=2 * reference.friction_demand), trace).warnings == ()
    assert seen(slippery, trace, failure=Failure("it broke")).warnings == ()


def test_a_gain_of_energy_fails():
    scene, trace, *_ = observed("rigid ground", 1e-3)
    thrown = dataclasses.replace(trace, tilt_rate=trace.tilt_rate + 2.0 * (trace.time > 3.0))
    assert energy_gain(scene, thrown) > GAIN_LIMIT and "energy" in seen(scene, thrown).failure.reason


def test_the_work_of_a_pulse_shorter_than_what_a_contact_takes_to_settle_is_no_gain(monkeypatch):
    """Also in a run of so many steps that its energy is taken in pieces."""
    scene = Scene(block=block(0.25), motion=PulseMotion("half-sine", 4000.0, 1e4), duration=0.1)
    history = simulate(scene, output_step=5e-6).history
    trace = Trace(*(getattr(history, name) for name in Trace.COLUMNS), EDGE, settle=0.01)
    whole = energy_gain(scene, trace)
    monkeypatch.setattr(swings, "PIECE", 100)
    assert whole < 1e-4 and energy_gain(scene, trace) == pytest.approx(whole, rel=1e-6)
    faster = dataclasses.replace(trace, tilt_rate=trace.tilt_rate * np.where(trace.time > 0.05, 1.5, 1.0))
    assert energy_gain(scene, faster) > GAIN_LIMIT


def test_free_flight_keeps_its_energy_where_the_centre_is_read():
    """A block thrown off its corner: from there a parabola and an even turn."""
    scene = Scene(block=block(0.25), start=Start(tilt=0.1, tilt_rate=6.0), duration=0.2)
    time, zero = np.linspace(0, 0.2, 101), np.zeros(101)
    pivoting = Trace(time, 0.1 + 6.0 * time, zero + 6.0, zero, zero, zero, EDGE)
    x, z, across, up = pivoting_centre(scene, pivoting)[0]
    fall = scene.gravity * time
    centre = np.column_stack([x + across * time, z + up * time - fall * time / 2, zero + across, up - fall])
    trace = dataclasses.replace(pivoting, centre=centre)
    balance, kinetic = energy_balance(scene, trace)
    assert np.ptp(balance) < 1e-12 * kinetic.max() and energy_gain(scene, trace) < 1e-12
    # taken to turn about its corner, the same block would change its energy
    assert np.ptp(energy_balance(scene, pivoting)[0]) > 0.05 * kinetic.max()
    pushed = centre + np.where(time > 0.1, 8.0, 0.0)[:, None] * [0, 0, 0, 1]
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


FLOWN, SLIDE, LIFT = slice(20, 50), 1.1 * SLIDING_TOLERANCE, 1.1 * HEIGHT_TOLERANCE


@pytest.mark.parametrize(
    "across, up, steps, overturned, word",
    [
        (0.0, 0.0, slice(None), False, None),
        (0.8 * SLIDE, 0.8 * LIFT, slice(None), False, None),
        (-SLIDE, 0.0, slice(None), False, "slid"),
        (SLIDE, 0.0, slice(None), False, "slid"),
        (0.0, LIFT, slice(None), False, "left"),
        (0.0, -LIFT, slice(None), False, "sank"),
        (0.0, LIFT, FLOWN, False, None),  # it flew and landed
        (SLIDE, 0.0, slice(None), True, None),  # it fell over: anywhere
    ],
)
def test_a_block_off_its_place_fails(across, up, steps, overturned, word):
    scene = SCENES["rigid ground"]
    trace, _ = sampled(scene, 1e-2)
    centre = pivoting_centre(scene, trace)
    centre[steps, :2] += np.array([across, up]) * scene.block.radius
    failure = check_place(scene, dataclasses.replace(trace, centre=centre), overturned)
    assert word in failure.reason if word else failure is None


def test_bearing_replay_is_exact_and_sees_a_lag():
    """Reversals inside the steps are not seen by the replay."""
    scene, trace, *_ = observed("isolated, shaken", 1e-3)
    exact = replayed_force(scene, trace)
    for force, least, most in (
        (exact, 0.0, 0.0),
        (trace.bearing_force, 0.0, 1e-2),
        (np.append(0, exact[:-1]), 1e-2, 9),
    ):
        assert least <= replay_bearing(scene, dataclasses.replace(trace, bearing_force=force)) <= most
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


# Events.


def damped(damping, base=0.067, **changes):
    bearings = BEARINGS.model_copy(update={"damping": damping, **changes})
    return Scene(block=block(0.25), base=Base(mass=base), bearings=bearings, start=Start(tilt=0.15), duration=2.0)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    "scene",
    [damped(1e6), damped(0.0, ka=1e9, kb=1e8), damped(1e6, base=212.0, ka=1e9, kb=1e8)],
    ids=["1e6 N s/m", "1e9 N/m", "both"],
)
def test_impacts_on_stiff_and_damped_bearings_are_carried_stably(scene):
    """A base of 67 g: its velocity settles within 1e-4 s at 1e6 N s/m, and grows as fast backward in time."""
    reference = simulate(scene, output_step=1e-5)
    columns = [getattr(reference.history, name)[::20] for name in Trace.COLUMNS]
    response = seen(scene, Trace(*columns, EDGE, 6e-3))
    assert response.outcome == reference.outcome == "rocks"
    for impact, expected in zip(response.impacts[:2], reference.impacts[:2], strict=True):
        assert impact.time == pytest.approx(expected.time, abs=1e-4)
        assert impact.rate_before == pytest.approx(expected.rate_before, rel=2e-2)
        assert impact.rate_after == pytest.approx(expected.rate_after, rel=2e-2)


def test_a_carry_takes_substeps_as_the_bearing_needs_them():
    """Forward over up to 2 ms, eight time constants of the damping."""
    scene = damped(1e6, base=212.0)
    reference = simulate(scene, output_step=2e-3)
    trace = Trace(*(getattr(reference.history, name) for name in Trace.COLUMNS), EDGE)
    computed, expected = (
        (result.impacts[0].time, result.impacts[0].rate_before) for result in (seen(scene, trace), reference)
    )
    assert computed == pytest.approx(expected, rel=1e-5)


def test_a_carry_takes_no_more_steps_than_it_needs(monkeypatch):
    taken, carry = [], swings._runge_kutta
    monkeypatch.setattr(swings, "_runge_kutta", lambda *given: taken.append(given[-1]) or carry(*given))
    for name in ("rigid ground", "isolated"):
        observed(name, 2e-3)
    assert swings.RK_STEPS <= max(taken) < 0.1 * swings.MOST_STEPS


@pytest.mark.parametrize("direction, step, inner", [(1, "last", -1), (-1, "first", 1)])
def test_a_force_that_is_extrapolated_goes_through_the_two_steps_beside_a_contact(direction, step, inner):
    _, trace, *_ = observed("isolated", 4e-3)
    all_swings = find_swings(trace)
    for at in (edge := getattr(all_swings, step), edge + inner):
        along = swings._tangent(trace, all_swings, direction)(trace.time[at])
        np.testing.assert_allclose(along[:9], trace.bearing_force[at][:9], rtol=1e-9)  # of swings of several steps


@pytest.mark.parametrize("friction, gap, flies", [(0.6, 0.05, True), (0.6, 1e-3, False), (None, 0.05, False)])
def test_a_passage_of_the_upright_is_an_impact_unless_the_block_is_in_the_air(friction, gap, flies):
    """A block that rocks, raised by so much about its first impact; without a friction the model's does not fly."""
    scene, trace, reference, _ = observed("rigid ground", 1e-3)
    first = reference.impacts[0].time
    centre = pivoting_centre(scene, trace)
    centre[:, 1] += np.where(np.abs(trace.time - first) < 0.05, gap * scene.block.radius, 0.0)
    raised = dataclasses.replace(trace, centre=centre)
    impacts, *_, missed = find_events(scene.with_(friction=friction), raised, find_swings(raised))
    count = len(find_events(scene, trace, find_swings(trace))[0])
    assert (len(impacts), missed) == (count - flies, ()) and (abs(impacts[0].time - first) > 0.1) == flies


@pytest.mark.parametrize("share, reason", [(1.05, "an impact added energy"), (0.95, None)])
def test_an_impact_that_gives_energy_fails_with_its_rates(share, reason):
    """All rates of the swing after the seventh impact are multiplied."""
    scene, trace, reference, _ = observed("rigid ground", 1e-3)
    strong, after = reference.impacts[6:8]
    swing = (trace.time > strong.time) & (trace.time < after.time)
    factor = share * MOST_RESTITUTION * abs(strong.rate_before / strong.rate_after)
    thrown = dataclasses.replace(trace, tilt_rate=np.where(swing, factor, 1.0) * trace.tilt_rate)
    response = seen(scene, thrown)
    failure = check_impacts(scene, thrown, response.impacts, ())
    assert (failure and failure.reason) == reason
    assert reason is None or (response.outcome == "failed" and f"{strong.time:.1f}" in failure.message)


def test_a_change_of_side_without_an_impact_fails():
    """The block lands, stands flat for 30 ms and leaves to the other side as fast as after the impact."""
    scene, trace, reference, _ = observed("rigid ground", 1e-3)
    first = int(np.searchsorted(trace.time, reference.impacts[0].time))
    columns = {name: np.insert(getattr(trace, name), [first] * 9, 0.0) for name in Trace.COLUMNS}
    still = trace.time[first - 1] + np.linspace(0.003, 0.027, 9)
    columns["time"] = np.concatenate([trace.time[:first], still, trace.time[first:] + 0.03])
    flat = Trace(**columns, contact_tilt=EDGE)
    assert seen(scene, flat).outcome == "failed"
    *_, missed = find_events(scene, flat, find_swings(flat))
    assert missed == (trace.time[first - 1],)
    assert check_impacts(scene, flat, (), missed).reason == "an impact could not be resolved"
    assert find_events(scene, trace, find_swings(trace))[-1] == ()


@pytest.mark.parametrize("step, resolved", [(0.65, False), (0.025, True)])
def test_steps_longer_than_whole_swings_fail(step, resolved):
    """The stronger swings last some .5 s."""
    scene, trace, *_ = observed("rigid ground", 2.5e-4)
    kept = np.searchsorted(trace.time, np.arange(0.0, trace.time[-1], step))
    coarse = trace.at(np.append(kept, len(trace.time) - 1))
    response = seen(scene, coarse)
    if resolved:
        assert response.outcome == "rocks" and not len(straddled(scene, coarse))
    else:
        assert response.outcome == "failed" and "longer than whole swings" in response.failure.reason


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("column", Trace.COLUMNS[1:])
def test_an_exploded_state_fails_without_a_warning_of_numpy(column):
    scene, trace, *_ = observed("isolated", 2e-3)
    burst = np.where(trace.time > 3.0, 1e300 * np.cos(300 * trace.time), getattr(trace, column))
    response = seen(scene, dataclasses.replace(trace, **{column: burst}))
    assert response.outcome == "failed" or (column == "tilt" and response.outcome == "overturns")
    assert (response.outcome == "failed") == (response.failure is not None)


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("mean_step", [1e-3, 1 / 60])
def test_sound_runs_are_not_accused(name, mean_step):
    scene, trace, reference, response = observed(name, mean_step, seed=1)
    assert response.failure is None and response.outcome == reference.outcome
    assert energy_gain(scene, trace) < 0.1 * GAIN_LIMIT and impulse_error(scene, trace) < 0.5 * IMPULSE_LIMIT


# The bearings' force as the motion shows it: doubled, late or from another law, it is seen from outside.

ROCKING = SCENES["isolated"].with_(duration=1.5)
DRIVEN = ROCKING.with_(
    block={"slenderness": 0.15}, start={"tilt": 0.0}, motion=PulseMotion("one-sine", 3.0, 8.0), duration=2.5
)


@pytest.mark.parametrize(
    "scene, law", [(ROCKING, "bilinear"), (DRIVEN, "bouc-wen"), (ROCKING.with_(bearings={"damping": 2e3}), "algebraic")]
)
def test_an_exact_motion_keeps_the_sum_over_its_impacts(scene, law):
    scene = scene.with_(bearings=to_law(law))
    trace, reference = sampled(scene, 5e-4)
    assert any(abs(impact.base_velocity_jump) > 0.01 for impact in reference.impacts)
    missing, impulse = missing_impulse(scene, trace)
    assert np.ptp(missing) < 1e-4 * np.ptp(impulse)
    assert impulse_error(scene, trace) < 1e-4
    # The jump of the base alone would be seen.
    alone = dataclasses.replace(trace, tilt_rate=np.zeros_like(trace.tilt_rate))
    assert np.ptp(missing_impulse(scene, alone)[0]) > 0.01 * np.ptp(impulse)


@pytest.mark.parametrize("factor", [0.0, 0.5, 2.0])
def test_the_motion_of_another_force_fails(factor):
    """The scene asks for one law; the motion is the exact one of `factor` times its force."""
    bearings = ROCKING.bearings
    other = ROCKING.with_(
        bearings={"ka": factor * bearings.ka, "kb": factor * bearings.kb} if factor else {"law": "linear", "ka": 1e-6}
    )
    trace, _ = sampled(other, 5e-4)
    failed, warned = (seen(ROCKING, dataclasses.replace(trace, first_script=first)) for first in (False, True))
    assert failed.outcome == "failed" and "bearing force" in failed.failure.reason
    assert impulse_error(ROCKING, trace) == pytest.approx(abs(factor - 1), rel=0.1)
    assert warned.failure is None and "bearing force" in warned.warnings[-1].text


def test_a_bearing_too_soft_to_matter_is_not_asked_for():
    soft = ROCKING.with_(bearings={"law": "linear", "ka": 1e-3})
    trace, _ = sampled(soft, 5e-3)
    assert impulse_error(soft, trace) < 0.01 and seen(soft, trace).failure is None


def test_a_fall_of_a_block_whose_place_is_not_read_is_left_out():
    """From the passage of the slenderness on it need not pivot about its corner."""
    scene = ROCKING.with_(start={"tilt": 0.19, "tilt_rate": 0.3}, duration=5.0)
    trace, reference = sampled(scene, 5e-4)
    fallen = np.abs(trace.tilt) > scene.block.slenderness
    spoilt = dataclasses.replace(trace, base_velocity=trace.base_velocity + 10.0 * fallen)
    assert reference.outcome == "overturns" and impulse_error(scene, spoilt) < 0.1 * IMPULSE_LIMIT
    assert impulse_error(scene, dataclasses.replace(spoilt, centre=pivoting_centre(scene, trace))) > IMPULSE_LIMIT
