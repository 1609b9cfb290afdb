"""Every measure is tried on analytic responses, where its own error is known, and on ones made wrong on purpose."""

import dataclasses
import math

import numpy as np
import pytest

from analytic import Base, Bearings, Block, History, PulseMotion, Scene, Start, simulate
from analytic.caryatid import BASE, BEARINGS, MASS, caryatid_block
from analytic.rocking import RockingModel, restitution
from comparisons.measuring.errors import (
    base_jump_error,
    compare,
    energy_errors,
    flight_energy,
    graph_distance,
    impact_errors,
    impact_time_errors,
    rate_restitution,
    state_restitution,
    strong_impacts,
    swing_restitution,
)
from comparisons.studies.restitution.cases import free_scene


def free(slenderness=0.25, base=None, start=0.6, duration=10.0, **block):
    return Scene(
        block=Block(mass=3172.05, radius=1.0884, slenderness=slenderness, **block),
        base=base,
        start=Start(tilt=start * slenderness),
        duration=duration,
    )


@pytest.mark.parametrize("slenderness", [0.1, 0.2, 0.3, 0.45])
@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("base", [None, Base(mass=3172.05)])
def test_swing_energies_give_the_restitution_of_eq_7(slenderness, side, base):
    scene = free(slenderness, base, start=0.6 * side)
    response = simulate(scene)
    measured = swing_restitution(scene, response)
    clear = np.isfinite(measured)
    assert clear.sum() >= 5
    assert np.abs(measured[clear] - restitution(scene)).max() < 1e-8


@pytest.mark.parametrize("base", [None, Base(mass=212.0)])
def test_flight_energy_falls_by_the_square_of_restitution_at_impacts_alone(base):
    scene = free(0.3, base, duration=1.2)
    response = simulate(scene)
    history, times = response.history, [impact.time for impact in response.impacts]
    energy = flight_energy(scene, history.tilt, history.tilt_rate)
    swing = np.searchsorted(times, history.time)
    np.testing.assert_allclose(energy, energy[0] * restitution(scene) ** (2 * swing), rtol=1e-9, atol=1e-15)


def test_swing_energies_do_not_depend_on_the_sampling():
    scene = free()
    fine, coarse = simulate(scene, output_step=1e-3), simulate(scene, output_step=0.04)
    np.testing.assert_allclose(swing_restitution(scene, coarse)[:5], swing_restitution(scene, fine)[:5], atol=1e-8)


def test_swing_energies_need_free_rocking_and_a_history():
    scene = free(base=Base(mass=212.0)).with_(bearings=Bearings(count=4, ka=6.22e4, kb=6.22e3, alpha=44.69))
    with pytest.raises(ValueError, match="state_restitution"):
        swing_restitution(scene, simulate(scene))
    with pytest.raises(ValueError, match="history=True"):
        swing_restitution(free(), simulate(free(), history=False))


@pytest.mark.parametrize("slenderness, e", [(0.20, 0.817683), (0.25, 0.729974), (0.28, 0.673321), (0.35, 0.535439)])
def test_states_at_impact_give_restitution_and_jump_on_a_base(slenderness, e):
    block = Block(mass=3172.05, radius=1.088388, slenderness=slenderness)
    scene = Scene(block=block, base=Base(mass=212.0), start=Start(tilt=0.5 * slenderness), duration=3.0)
    response = simulate(scene)
    np.testing.assert_allclose(state_restitution(response), e, atol=1e-6)  # the printed digits of the table
    assert np.abs(base_jump_error(scene, response)).max() < 1e-9


def test_the_jump_error_sees_the_printed_eq_8():
    scene = free(0.28, base=Base(mass=212.0))
    response = simulate(scene)
    factor = scene.block.half_height  # what (8) as printed has too many
    wrong = dataclasses.replace(
        response,
        impacts=tuple(
            dataclasses.replace(i, base_velocity_jump=i.base_velocity_jump * factor) for i in response.impacts
        ),
    )
    np.testing.assert_allclose(base_jump_error(scene, wrong), factor - 1, atol=1e-9)


def test_impact_times_match_by_side_and_a_lost_one_is_nan():
    response = simulate(free())
    late = tuple(dataclasses.replace(impact, time=impact.time + 1e-3) for impact in response.impacts[:8])
    changed = dataclasses.replace(response, impacts=late[:3] + late[4:])
    errors = impact_time_errors(changed, dataclasses.replace(response, impacts=response.impacts[:8]))
    assert np.isnan(errors[3])
    np.testing.assert_allclose(np.delete(errors, 3), 1e-3, atol=1e-12)


def with_tilt(response, time, tilt):
    zero = np.zeros_like(time)
    return dataclasses.replace(response, history=History(time, tilt, zero, zero, zero, zero, zero))


def test_graph_distance_of_a_late_jump_is_its_delay():
    response = simulate(free())
    time = np.linspace(0, 4, 4001)
    early = with_tilt(response, time, np.where(time < 2, 0.0, 1.0))
    late = with_tilt(response, time, np.where(time < 2.05, 0.0, 1.0))
    distance = graph_distance(early, late, tilt_scale=1.0, time_scale=2.0)
    # Both jumps are ramps over one sample, so the distance is the perpendicular one between the ramps.
    assert distance == pytest.approx(0.05 / 2.0 / math.hypot(1.0, 0.001 / 2.0), rel=1e-9)
    assert graph_distance(late, early, tilt_scale=1.0, time_scale=2.0) == distance
    assert graph_distance(early, late, tilt_scale=1.0, time_scale=2.0, until=1.9) < 1e-18  # round-off


def test_graph_distance_of_shifted_lines_is_that_of_their_ends():
    response = simulate(free())
    time = np.linspace(0, 10, 101)
    fine = np.linspace(0, 10, 777)
    below, above = with_tilt(response, time, 2 * time), with_tilt(response, fine, 2 * fine + 0.5)
    middle = graph_distance(below, above, tilt_scale=1.0, time_scale=1.0)
    assert middle == pytest.approx(0.5, rel=1e-12)  # the end point (10, 20.5) is nearest to (10, 20)


@pytest.mark.parametrize("cut", [0.0, 0.003, 0.4])
def test_graph_distance_is_over_the_same_span(cut):
    """A falling block whose history ends `cut` seconds before the other's, off its samples."""
    response = simulate(free())
    time = np.linspace(0, 2, 201)
    fall = with_tilt(response, time, np.exp(time))
    short = np.append(time[time < 2 - cut], 2 - cut)
    part = with_tilt(response, short, np.interp(short, time, np.exp(time)))
    for pair in ((fall, part), (part, fall)):
        assert graph_distance(*pair, tilt_scale=1.0, time_scale=1.0) < 1e-12
        assert graph_distance(*pair, tilt_scale=1.0, time_scale=1.0, until=1.234) < 1e-12


def test_graph_distance_of_blocks_that_fall_one_after_the_other_is_the_delay():
    response = simulate(free())
    time, delay = np.linspace(0, 3, 3001), 2e-3
    falls = [
        with_tilt(response, t, np.expm1(3 * (t - d).clip(0)))
        for d in (0.0, delay)
        for t in (np.append(time[time < 2 + d], 2 + d),)
    ]
    distance = graph_distance(*falls, tilt_scale=1.0, time_scale=1.0)
    assert 0.9 * delay < distance <= delay


def test_energy_errors_vanish_for_exact_runs_and_see_a_drift():
    scene = Scene(
        block=Block(mass=3172.05, radius=1.0884, slenderness=0.2),
        base=Base(mass=212.0),
        start=Start(tilt=0.12),
        duration=4.0,
    )
    response = simulate(scene)
    assert max(energy_errors(scene, response)) < 1e-10
    history = response.history
    growing = dataclasses.replace(history, tilt_rate=history.tilt_rate * (1 + 1e-3 * history.time))
    assert min(energy_errors(scene, dataclasses.replace(response, history=growing))) > 1e-4
    assert max(energy_errors(scene, dataclasses.replace(response, history=growing), until=0.01)) < 1e-5


def test_energy_drift_with_bearings_and_motion_falls_with_the_sampling():
    scene = Scene(
        block=Block(mass=3172.05, radius=1.0884, slenderness=0.15),
        base=Base(mass=212.0),
        bearings=Bearings(count=4, ka=6.22e4, kb=6.22e3, alpha=44.69),
        motion=PulseMotion("one-sine", 4.0, 6.0),
        duration=3.0,
    )
    drifts = [energy_errors(scene, simulate(scene, output_step=step))[0] for step in (4e-3, 2e-3, 1e-3)]
    assert drifts[0] / drifts[1] > 3 and drifts[1] / drifts[2] > 3  # trapezoidal rule: factor 4


def test_a_response_agrees_with_itself():
    scene = free()
    response = simulate(scene)
    agreement = compare(scene, response, response)
    assert agreement.same_outcome and agreement.lost_impacts == 0
    assert (agreement.peak_tilt_error, agreement.impact_time_error, agreement.graph_distance) == (0, 0, 0)


def test_comparison_tells_overturning_times_and_outcomes():
    frequency = 2 * RockingModel.of(free()).g ** 0.5
    scene = free(start=0.0, duration=5.0).with_(motion=PulseMotion("one-sine", 8.0, frequency))
    reference, stronger = simulate(scene), simulate(scene.with_(motion=scene.motion.scaled(1.01)))
    weak = simulate(scene.with_(motion=scene.motion.scaled(0.2)))
    assert reference.outcome == stronger.outcome == "overturns"
    agreement = compare(scene, stronger, reference)
    assert agreement.same_outcome
    assert agreement.overturning_time_error == stronger.overturning_time - reference.overturning_time != 0
    assert not compare(scene, weak, reference).same_outcome
    assert compare(scene, weak, reference).overturning_time_error is None


CARYATID_BASE = BASE.mass / MASS


@pytest.mark.parametrize("ratio", [None, 10.0, CARYATID_BASE])
@pytest.mark.parametrize("slenderness", [0.1, 0.45])
def test_exact_responses_have_no_error_and_the_printed_jump_has(slenderness, ratio):
    scene = free_scene(slenderness, ratio, 0.5)
    errors = impact_errors(scene, simulate(scene), 3)
    assert len(errors["time"]) == 3
    assert np.abs(errors["swing"]).max() < 1e-8
    assert np.abs(errors["state"]).max() < 1e-9
    if ratio:
        assert np.abs(errors["jump"]).max() < 1e-9
        assert np.abs(errors["jump_8"]).max() < 1e-9
        np.testing.assert_allclose(errors["jump_8_printed"], 1 / scene.block.half_height - 1, atol=1e-9)


def test_another_impact_law_is_measured_as_what_it_is():
    scene = free_scene(0.2, None, 0.6)
    wrong = simulate(scene.with_(block={"restitution": 0.9}))
    errors = impact_errors(scene, wrong, 3)
    np.testing.assert_allclose(errors["swing"], 0.9 - restitution(scene), atol=1e-8)


def test_chatter_does_not_count_as_impacts():
    scene = free_scene(0.2, None, 0.6).with_(duration=30.0)
    response = simulate(scene)
    rates = [abs(impact.rate_before) for impact in strong_impacts(response)]
    assert len(rates) < len(response.impacts)
    assert min(rates) >= 0.1 * max(rates)


def test_successive_rates_give_the_restitution_of_free_rocking():
    for ratio in (None, 1.0):
        scene = free_scene(0.3, ratio, 0.6)
        np.testing.assert_allclose(rate_restitution(simulate(scene, history=False)), restitution(scene), atol=1e-9)


def test_swings_are_measured_in_free_rocking_alone():
    scene = Scene(block=caryatid_block(0.2), base=BASE, bearings=BEARINGS, start=Start(tilt=0.1), duration=1.5)
    errors = impact_errors(scene, simulate(scene))
    assert "swing" not in errors and np.abs(errors["state"]).max() < 1e-9
    free = free_scene(0.2, None, 0.5)
    assert "swing" not in impact_errors(free, simulate(free, history=False))
