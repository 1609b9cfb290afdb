"""Vertical ground motion: gravity becomes g + a_v(t), in the kernel, its twin, batches and time stepping."""

import math
from dataclasses import replace

import numpy as np
import pytest
from record_files import FORMATS, needs_records
from rough_motions import rough

from analytic import Bearings, Caution, PulseMotion, SampledMotion, Scene, Start, simulate
from analytic.batch import simulate_many
from analytic.caryatid import BASE, caryatid_block
from analytic.caryatid import BEARINGS as LRB
from analytic.decision import RIGID_BEARINGS
from analytic.motion import paired
from analytic.records import read_record
from analytic.synthetic import synthetic_motion
from analytic.time_stepping import simulate_time_stepping
from analytic.twin import simulate_twin

G = 9.81
BLOCK = caryatid_block(0.28)
BILINEAR = Bearings(law="bilinear", count=4, ka=6.22e4, kb=6.22e3, yield_force=700.0)
FREE = Scene(block=BLOCK, duration=4.0)
SLIDING = FREE.with_(base=BASE)
ISOLATED = SLIDING.with_(bearings=LRB, block={"slenderness": 0.15})


def shaken(seed, peak=4.0):
    """Rough motions, the vertical one with more of high frequency."""
    return replace(rough(seed, peak, 4.0), vertical=rough(seed + 100, 0.7 * peak, 4.0, frequency=3.0))


def pulse(shape, amplitude, frequency, vertical, phase=0.0):
    level = PulseMotion(shape, amplitude, frequency, 0.2)
    return replace(level, vertical=replace(level, amplitude=vertical, phase=phase))


def heaving(amplitude, frequency, duration=4.0, dt=0.005):
    """No horizontal motion, a vertical sine."""
    t = np.arange(0, duration, dt)
    return SampledMotion(dt, 0 * t, vertical=SampledMotion(dt, amplitude * np.sin(frequency * t)))


def both_synthetic(scale):
    return replace(synthetic_motion(), vertical=synthetic_motion(seed=1).scaled(0.6)).scaled(scale)


SCENES = {
    "released under a sine": FREE.with_(start=Start(tilt=0.1), motion=heaving(4.0, 9.0)),
    "one-sine": FREE.with_(motion=pulse("one-sine", 4.0, 5.0, 2.4, 1.0)),
    "one-cosine": FREE.with_(motion=pulse("one-cosine", 4.0, 5.0, 2.4, 0.4)),
    "half-sine": FREE.with_(motion=pulse("half-sine", 5.0, 5.0, -2.5, 2.0)),
    "ricker": FREE.with_(motion=pulse("ricker", 5.0, 9.0, 2.5)),
    "rectangular": FREE.with_(motion=pulse("rectangular", 3.5, 9.0, 1.05)),
    "rough, rigid ground": FREE.with_(motion=shaken(1)),
    "rough, sliding base": SLIDING.with_(start=Start(tilt=0.15), motion=shaken(2)),
    "rough, on bearings": ISOLATED.with_(motion=shaken(3, peak=6.0)),
    "sine, on bearings": ISOLATED.with_(motion=pulse("one-sine", 5.0, 8.0, 2.5, 2.0)),
    "rough, bilinear bearings": ISOLATED.with_(bearings=BILINEAR, motion=shaken(5, peak=6.0)),
    "long record, rigid ground": FREE.with_(block={"slenderness": 0.4}, motion=both_synthetic(1.0), duration=10.0),
    "long record, on bearings": ISOLATED.with_(block={"slenderness": 0.2}, motion=both_synthetic(1.2), duration=8.0),
}


def state(response):
    end = response.end
    return [end.tilt, end.tilt_rate, end.base_displacement, end.base_velocity]


def impact_times(response, rate=0.0):
    """Of the impacts that leave more than a rate."""
    return [impact.time for impact in response.impacts if abs(impact.rate_after) > rate]


def kernel_and_twin(scene):
    """Their responses, which agree."""
    run = simulate(scene, history=False, tolerance=1e-15)
    twin = simulate_twin(scene, rtol=1e-12, history=False)
    assert (run.outcome, run.impact_count) == (twin.outcome, twin.impact_count)
    np.testing.assert_allclose(impact_times(run, -1.0), impact_times(twin, -1.0), rtol=0, atol=1e-9)
    np.testing.assert_allclose(state(run), state(twin), rtol=0, atol=1e-9)
    return run, twin


def scale_of(scene, response):
    """Energy [J] that an imbalance is measured against."""
    block = scene.block
    tipping = block.mass * G * block.radius * (1 - math.cos(block.slenderness))
    return max(abs(response.energy.input), tipping)


@pytest.mark.parametrize("name", SCENES)
def test_kernel_and_twin_agree_and_the_ledger_closes(name):
    scene = SCENES[name]
    run, twin = kernel_and_twin(scene)
    assert run.outcome != "stands"
    assert run.min_normal_ratio == pytest.approx(twin.min_normal_ratio, abs=2e-3)  # at its steps, and at the kernel's
    assert abs(run.energy.imbalance) < 1e-11 * scale_of(scene, run)
    assert abs(twin.energy.imbalance) < 1e-10 * scale_of(scene, twin)
    assert run.energy.input == pytest.approx(twin.energy.input, rel=1e-8)
    # and the vertical motion matters in it
    level = simulate(scene.with_(motion=replace(scene.motion, vertical=None)), history=False)
    assert abs(run.energy.input - level.energy.input) > 1e-3 * scale_of(scene, run)


@pytest.mark.parametrize("change", [-1.5, 1.0])
@pytest.mark.parametrize("scene", [FREE, SLIDING, ISOLATED], ids=["rigid", "sliding", "on bearings"])
def test_a_constant_vertical_acceleration_is_another_gravity(scene, change):
    scene = scene.with_(start=Start(tilt=0.1), duration=3.0)
    still = SampledMotion(0.01, np.zeros(301))
    held = simulate(scene.with_(motion=replace(still, vertical=SampledMotion(0.01, np.full(301, change)))))
    other = simulate(scene.with_(motion=still, gravity=G + change))
    assert held.outcome == other.outcome == "rocks"
    # the rate below which impacts are summed goes with the scene's own gravity
    times = [impact_times(one, 1e-6) for one in (held, other)]
    assert len(times[0]) > 2 and times[0] == pytest.approx(times[1], rel=1e-12)
    np.testing.assert_allclose(state(held), state(other), rtol=1e-11, atol=1e-13)
    assert held.uplifts == pytest.approx(other.uplifts, rel=1e-12)


@pytest.mark.parametrize("engine", [simulate, simulate_twin, lambda scene: simulate_time_stepping(scene, step=1e-3)])
def test_forces_at_the_contact_of_a_standing_block(engine):
    # the base keeps the block's horizontal acceleration; it weighs m (g + a_v)
    t = np.arange(0, 2.001, 0.01)
    up = SampledMotion(0.01, 5.0 * np.sin(12.0 * t))
    run = engine(FREE.with_(motion=SampledMotion(0.01, 0.2 * up.samples, vertical=up), duration=2.0))
    assert run.outcome == "stands"
    assert run.min_normal_ratio == pytest.approx(1 + up.samples.min() / G, rel=1e-9)
    assert run.friction_demand == pytest.approx((0.2 * np.abs(up.samples) / (G + up.samples)).max(), rel=1e-9)


def test_a_block_that_would_jump_is_said():
    scene = FREE.with_(motion=heaving(1.2 * G, 9.0), start=Start(tilt=0.05))
    for run in (simulate(scene), simulate_twin(scene)):
        assert run.min_normal_ratio <= 0
        assert any(
            "the block would jump, and the outcome is outside the model" in warning.text for warning in run.warnings
        )
    assert not simulate(scene.with_(motion=heaving(0.2 * G, 9.0))).warnings


def test_a_weight_that_vanishes_while_the_block_stands_lifts_it_once():
    # nothing pushes a base that slides freely: the threshold of uplift passes through 0 with the weight
    motions = [pulse("one-sine", 0.5, 3.0 + 0.01 * k, 1.5 * G, 0.02 * k) for k in range(300)]
    found = simulate_many([SLIDING.with_(motion=motion, duration=1.5) for motion in motions], workers=1)
    assert found.lifted.all() and not found.failed.any()


def test_bearings_that_carry_it_are_said():
    scene = SCENES["sine, on bearings"]
    level = scene.with_(motion=replace(scene.motion, vertical=None))
    for one, told in ((scene, True), (level, False), (scene.with_(bearings=None), False)):
        assert (Caution("model", RIGID_BEARINGS) in simulate(one).warnings) == told


def test_it_is_over_before_a_run_may_end():
    up = SampledMotion(0.01, np.repeat([0.0, 3.0], [700, 101]))
    run = simulate(Scene(block=BLOCK, motion=replace(up.scaled(0), vertical=up), start=Start(tilt=0.05)))
    assert run.decided and run.end.time >= 8.0


@needs_records
@pytest.mark.parametrize("scene", [FREE, ISOLATED], ids=["rigid", "on bearings"])
def test_a_recorded_triple(scene):
    records = [read_record(FORMATS / "ferndale.v2", channel=channel, scale=2.0) for channel in (1, "up")]
    strong = [SampledMotion(record.dt, record.samples[2800:4000]) for record in records]
    scene = scene.with_(motion=paired(*strong), block={"slenderness": 0.28 if scene is FREE else 0.12}, duration=14.0)
    assert kernel_and_twin(scene)[0].impact_count > 30


def test_time_stepping_tends_to_the_kernel():
    scene = FREE.with_(motion=pulse("one-sine", 4.5, 5.0, 2.4, 1.0), duration=1.2)
    exact = simulate(scene).end.tilt
    errors = [abs(simulate_time_stepping(scene, step=step).end.tilt - exact) for step in (4e-3, 2.5e-4)]
    level = simulate(scene.with_(motion=replace(scene.motion, vertical=None))).end.tilt
    assert 4 * errors[1] < errors[0] < 0.1 * abs(level - exact)
