"""Peaks are peaks: within one step, between steps, and without what the last fall of a block adds."""

import math

import numpy as np
import pytest

from analytic import Base, Bearings, PulseMotion, Scene, simulate, simulate_many
from analytic.caryatid import BASE, BEARINGS, caryatid_block
from analytic.polynomial import BISECTIONS, MAX_ORDER, largest
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
    block = caryatid_block(gamma)
    amplitude = 9.81 * math.tan(gamma) * rng.uniform(1.0002, 1.3)
    supported = {"base": BASE, "bearings": BEARINGS} if seed % 2 else {}
    motion = PulseMotion(shape, amplitude * (2.0 if supported else 1.0), rng.uniform(8.0, 20.0))
    response = simulate(Scene(block=block, motion=motion, **supported), output_step=2e-4)
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
    history = response.history
    last = np.flatnonzero(np.abs(history.tilt) <= scene.block.slenderness)[-1] + 1
    assert response.outcome == "overturns"
    before = np.abs(history.base_displacement[: last + 1]).max()
    assert response.peak_base_displacement == pytest.approx(before, rel=1e-3)
    many = simulate_many([scene], contact=True)
    assert many.peak_base_displacement[0] == pytest.approx(response.peak_base_displacement, rel=1e-9)
    assert many.friction_demand[0] == pytest.approx(response.friction_demand, rel=1e-9)
    assert simulate_many([scene]).peak_base_displacement[0] == pytest.approx(before, rel=1e-3)
    second = simulate_twin(scene, rtol=1e-11)
    for name in ("peak_base_displacement", "unstable_time"):
        assert getattr(second, name) == pytest.approx(getattr(response, name), rel=1e-7), name
    for name in ("peak_base_acceleration", "friction_demand", "min_normal_ratio"):  # at its steps
        assert getattr(second, name) == pytest.approx(getattr(response, name), rel=1e-2), name
    coarse = simulate_time_stepping(scene, step=1e-4)
    assert coarse.peak_base_displacement == pytest.approx(response.peak_base_displacement, rel=1e-3)
    assert coarse.peak_base_acceleration == pytest.approx(response.peak_base_acceleration, rel=1e-3)


def test_a_limit_that_only_the_fall_goes_beyond_is_not_warned_of():
    scene = Scene(
        block=caryatid_block(0.3),
        base=Base(mass=50.0),
        bearings=Bearings(count=4, ka=2e5, kb=2e4, alpha=44.69),
        motion=PulseMotion("half-sine", 14.0, 4.0),
    )
    response = simulate(scene)
    history = response.history
    whole = np.abs(history.base_displacement).max()
    assert response.outcome == "overturns" and whole > 1.05 * response.peak_base_displacement
    limit = 0.5 * (whole + response.peak_base_displacement)
    assert not any(one.kind == "limit" for one in simulate(scene.with_(bearings={"x_max": limit})).warnings)
    limit = 0.99 * response.peak_base_displacement
    assert any(one.kind == "limit" for one in simulate(scene.with_(bearings={"x_max": limit})).warnings)


@pytest.mark.parametrize("seed", range(30))
def test_the_largest_value_of_a_polynomial_is_that_of_a_fine_grid(seed):
    rng = np.random.default_rng(seed)
    order, h = int(rng.integers(3, 19)), rng.uniform(0.3, 3.0)
    f = np.zeros(MAX_ORDER + 2)
    f[: order + 1] = rng.normal(size=order + 1) / h ** np.arange(order + 1)
    scratch, work = np.empty(MAX_ORDER + 2), np.empty((BISECTIONS + 2, MAX_ORDER + 1))
    grid = np.polynomial.Polynomial(f[: order + 1])(np.linspace(0.0, h, 200_001))
    for sign in (1.0, -1.0):
        assert largest(f, sign, order, h, -np.inf, scratch, work) == pytest.approx((sign * grid).max(), abs=1e-8)
        assert largest(f, sign, order, h, 1e3, scratch, work) == 1e3
