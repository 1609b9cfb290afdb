"""Peaks are peaks: within one step, between steps, and without what the last fall of a block adds."""

import math

import numpy as np
import pytest

from analytic import Base, Bearings, PulseMotion, Scene, simulate, simulate_many
from analytic.caryatid import BASE, BEARINGS, caryatid_block
from analytic.rocking import RockingModel
from analytic.time_stepping import simulate_time_stepping
from analytic.twin import simulate_twin

FALLING = Scene(block=caryatid_block(0.2), base=BASE, bearings=BEARINGS, motion=PulseMotion("one-sine", 9.0, 5.0))


def test_a_swing_within_one_step_has_its_peak():
    """Review A4: 9.0e-5 was reported."""
    scene = Scene(block=caryatid_block(0.28), motion=PulseMotion("one-sine", 2.8711, 4.0))
    response = simulate(scene, output_step=1e-4)
    assert response.peak_tilt == pytest.approx(np.abs(response.history.tilt).max(), rel=1e-6)
    assert response.peak_tilt == pytest.approx(1.6632e-4, rel=1e-4)


@pytest.mark.parametrize("seed", range(40))
def test_peaks_of_weak_pulses_are_those_of_a_fine_history(seed):
    rng = np.random.default_rng(seed)
    gamma = rng.uniform(0.1, 0.4)
    shape = rng.choice(["one-sine", "one-cosine", "half-sine", "ricker"]).item()
    amplitude = 9.81 * math.tan(gamma) * rng.uniform(1.0002, 1.3)
    supported = {"base": BASE, "bearings": BEARINGS} if seed % 2 else {}
    motion = PulseMotion(shape, amplitude * (2.0 if supported else 1.0), rng.uniform(8.0, 20.0))
    response = simulate(Scene(block=caryatid_block(gamma), motion=motion, **supported), output_step=2e-4)
    history = response.history
    assert response.outcome in ("stands", "rocks")
    tilt, displacement = np.abs(history.tilt).max(), np.abs(history.base_displacement).max()
    assert tilt * (1 - 1e-12) <= response.peak_tilt <= tilt * (1 + 1e-3) + 1e-12
    assert displacement * (1 - 1e-12) <= response.peak_base_displacement <= displacement * (1 + 1e-5)


@pytest.mark.parametrize("motion", [PulseMotion("ricker", 8.0, 8.5), PulseMotion("one-sine", 5.0, 9.0)])
def test_acceleration_and_contact_forces_are_those_of_a_fine_history(motion):
    scene = Scene(block=caryatid_block(0.2), base=BASE, bearings=BEARINGS, motion=motion)
    response = simulate(scene, output_step=1e-4)
    accelerations, demands, normals = contact(scene, response.history)
    assert response.outcome == "rocks"
    assert response.peak_base_acceleration == pytest.approx(accelerations.max(), rel=5e-4)
    assert response.friction_demand == pytest.approx(demands.max(), rel=5e-4)
    assert response.min_normal_ratio == pytest.approx(normals.min(), abs=5e-4)


def contact(scene, history):
    """(|absolute acceleration|, |H|/N, N/(m g)) at the rows of a history."""
    model, found = RockingModel.of(scene), []
    for tilt, rate, force, ground in zip(
        history.tilt, history.tilt_rate, history.bearing_force, history.ground_acceleration, strict=True
    ):
        absolute, horizontal, normal = -force / model.M, -force / model.M * model.m, model.m * model.g
        if tilt:
            side = math.copysign(1.0, tilt)
            spin, push = model.accelerations(side, tilt, rate, ground, force, 0.0)
            absolute = push + ground
            horizontal, normal = model.contact_forces(side, tilt, rate, spin, absolute, 0.0)
        found.append((abs(absolute), abs(horizontal) / normal, normal / (model.m * model.g)))
    return np.array(found).T


@pytest.mark.parametrize("scale", [0.7, 1.0, -1.3])
def test_peaks_of_the_base_end_at_the_last_passage_of_the_slenderness(scale):
    """Review A5: the fall from there to pi/2, where a block would slide, is not the base's."""
    scene = FALLING.with_(motion=FALLING.motion.scaled(scale))
    response = simulate(scene, output_step=1e-4)
    beyond = np.abs(response.history.tilt) > scene.block.slenderness
    last = np.flatnonzero(~beyond)[-1] + 1
    assert response.outcome == "overturns"
    before = np.abs(response.history.base_displacement[: last + 1]).max()
    assert response.peak_base_displacement == pytest.approx(before, rel=1e-3)
    assert response.fall_time == pytest.approx(response.history.time[last], abs=1.01e-4)
    many = simulate_many([scene], contact=True)
    assert many.peak_base_displacement[0] == pytest.approx(response.peak_base_displacement, rel=1e-9)
    assert many.friction_demand[0] == pytest.approx(response.friction_demand, rel=1e-9)
    assert simulate_many([scene]).peak_base_displacement[0] == pytest.approx(before, rel=1e-3)
    second, coarse = simulate_twin(scene, rtol=1e-11), simulate_time_stepping(scene, step=1e-4)
    for one, names, accuracy in (
        (second, ("peak_base_displacement", "unstable_time", "fall_time", "overturning_time"), 1e-7),
        (second, ("peak_base_acceleration", "friction_demand", "min_normal_ratio"), 1e-2),  # at its steps
        (coarse, ("peak_base_displacement", "peak_base_acceleration", "fall_time"), 1e-3),
    ):
        assert [getattr(one, name) for name in names] == pytest.approx(
            [getattr(response, name) for name in names], rel=accuracy
        )


def test_a_limit_that_only_the_fall_goes_beyond_is_not_warned_of():
    scene = Scene(
        block=caryatid_block(0.3),
        base=Base(mass=50.0),
        bearings=Bearings(count=4, ka=2e5, kb=2e4, alpha=44.69),
        motion=PulseMotion("half-sine", 14.0, 4.0),
    )
    response = simulate(scene)
    whole, peak = np.abs(response.history.base_displacement).max(), response.peak_base_displacement
    assert response.outcome == "overturns" and whole > 1.05 * peak
    for limit, told in ((0.5 * (whole + peak), False), (0.99 * peak, True)):
        warnings = simulate(scene.with_(bearings={"x_max": limit})).warnings
        assert any(one.kind == "limit" for one in warnings) == told


def test_a_block_that_comes_back_from_beyond_the_unstable_point_falls_at_its_last_passage():
    """One sine throws it beyond the slenderness on one side, brings it back, and it falls on the other."""
    scene = Scene(block=caryatid_block(0.2), motion=PulseMotion("one-sine", 4.7, 5.82))
    response = simulate(scene, output_step=1e-4)
    beyond = np.abs(response.history.tilt) > 0.2
    first, last = np.flatnonzero(beyond)[0], np.flatnonzero(~beyond)[-1] + 1
    times = response.history.time[[first, last]]
    assert [response.unstable_time, response.fall_time] == pytest.approx(times, abs=1.01e-4)
    assert response.outcome == "overturns" and len(response.impacts) == 1 and times[1] > 2 * times[0]
    for other in (simulate_twin(scene.with_(duration=4.0), rtol=1e-11), simulate_time_stepping(scene, step=1e-5)):
        assert [other.unstable_time, other.fall_time] == pytest.approx(times, abs=3e-4)
    cut = simulate(scene.with_(duration=2.0), history=False)  # ended while it falls
    assert cut.outcome == "overturns" and cut.fall_time == pytest.approx(response.fall_time, rel=1e-9)
    assert simulate(scene.with_(motion=scene.motion.scaled(0.5))).fall_time is None
