"""The march against closed forms, the kernel, energy, and answers of two other methods."""

import math
from itertools import pairwise

import numpy as np
import pytest
from sliding_scenes import GRAVITY, random_slider, scene_of

from analytic import PulseMotion, simulate
from analytic import layout as S
from analytic.rocking import RockingModel
from analytic.sliding.run import contact_of, marched, slipping_friction
from analytic.solver import ground, options, parameters


def march_of(scene, **settings):
    """(totals, impacts, changes) of a march, without asking the kernel first."""
    shaking = ground(scene.motion)
    totals, impacts, changes, _ = marched(parameters(scene), contact_of(scene), shaking, options(**settings))
    return totals, impacts, changes


PULSES = {
    # Newmark: the block slides at mu g under a constant acceleration a for T, then stops; slip -(v T/2 + v^2/(2 mu g))
    "rectangular": (0.2, PulseMotion("rectangular", 4.0, 2 * math.pi)),
    "half-sine": (0.15, PulseMotion("half-sine", 5.0, 2 * math.pi)),
}


@pytest.mark.parametrize("friction, pulse", PULSES.values(), ids=PULSES)
def test_a_sliding_block_is_newmarks(friction, pulse):
    totals, impacts, changes = march_of(scene_of(friction, slenderness=0.4, motion=pulse, duration=6.0))
    mg, a, w = friction * GRAVITY, pulse.amplitude, pulse.frequency
    length = math.pi / w
    if pulse.shape == "rectangular":
        speed, way = (a - mg) * length, (a - mg) * length**2 / 2
    else:
        begin = math.asin(mg / a) / w  # from there the velocity is a (cos(w begin) - cos(w t))/w - mu g (t - begin)
        speed = a / w * (math.cos(w * begin) + 1) - mg * (length - begin)
        way = (
            a / w * (math.cos(w * begin) * (length - begin) + math.sin(w * begin) / w) - mg * (length - begin) ** 2 / 2
        )
    assert not len(impacts) and speed > 0
    assert totals[S.END_SLIP] == pytest.approx(-(way + speed**2 / (2 * mg)), abs=1e-10)
    assert changes[-1] == pytest.approx((length + speed / mg, S.STICK), abs=1e-10)
    assert totals[S.FRICTION_WORK] == pytest.approx(mg * 3172.05 * totals[S.PATH], rel=1e-12)


def shentons_mode(slenderness, a, friction):
    """Of a rectangular block at rest when the ground's acceleration jumps to a g (Shenton 1996)."""
    sine, cosine, tangent, q = math.sin(slenderness), math.cos(slenderness), math.tan(slenderness), 0.75
    if a <= min(friction, tangent):
        return S.STICK
    if friction < tangent:
        return S.SLIDE
    needed = (a * (1 - q * cosine**2) + q * sine * cosine) / (1 - q * sine**2 + q * a * sine * cosine)
    return S.ROCK if friction >= needed else S.SLIDE_ROCK


def test_the_first_mode_is_shentons():
    for slenderness in np.linspace(0.1, 0.5, 5):
        for a in np.linspace(0.05, 1.5, 20):
            for friction in np.linspace(0.02, 1.2, 19):
                pulse = PulseMotion("rectangular", float(a) * GRAVITY, 1000.0)
                scene = scene_of(float(friction), float(slenderness), motion=pulse, duration=1e-3)
                _, _, changes = march_of(scene)
                assert changes[0, 1] == shentons_mode(slenderness, a, friction), (slenderness, a, friction)


@pytest.mark.parametrize("base", [None, 212.0, 3000.0, 1e9])
@pytest.mark.parametrize("share", [0.3, 0.6, 0.9, 1.001, 1.5, 4.0])
def test_a_first_impact_is_equation_7_or_slips(base, share):
    scene = scene_of(1.0, 0.3, base=base, start={"tilt": 1e-4, "tilt_rate": -0.5}, duration=1e-3)
    limit = slipping_friction(parameters(scene))
    scene = scene.with_(friction=share * limit)
    _, impacts, _ = march_of(scene)
    _, before, after, jump, kind, speed = impacts[0]
    model = RockingModel.of(scene)
    if share > 1:
        assert kind == S.NEW_STICKS and speed == 0
        assert after / before == pytest.approx(model.restitution, abs=1e-12)  # (7)
        assert jump == pytest.approx(model.jump_arm * (before - after), abs=1e-12)  # (8)
    else:
        assert kind == S.NEW_SLIPS and speed != 0
        b, h = scene.block.half_width, scene.block.half_height  # on any base
        gripping = scene.block.mass * b * (b - scene.friction * h) / scene.block.centre_inertia
        assert after / before == pytest.approx((1 - gripping) / (1 + gripping), abs=1e-12)


@pytest.mark.parametrize("seed", [*range(3), *(pytest.param(seed, marks=pytest.mark.long) for seed in range(3, 10))])
def test_energy_is_conserved_with_exactly_one_mode(seed):
    """100 scenes: no march ends for want of one mode of contact or for a second one; no impact gains energy."""
    rng = np.random.default_rng([55, seed])
    for number in range(100):
        scene = random_slider(rng, number)
        totals, impacts, _ = march_of(scene)
        assert totals[S.STATUS] == 0, number
        response = simulate(scene, history=False)
        if response.sliding is None:
            continue
        energy = response.energy
        size = max(abs(energy.input), energy.friction, energy.impact_loss, abs(energy.kinetic), abs(energy.potential))
        assert abs(energy.imbalance) <= 1e-9 * size, number
        assert energy.friction >= 0 and energy.impact_loss >= 0


def test_friction_that_is_never_used_is_the_kernels_run():
    """The march called directly: of 20 scenes times, rates and peaks as the kernel's, up to the fall, which slides."""
    rng, compared = np.random.default_rng(50), 0
    while compared < 20:
        scene = random_slider(rng, 6 * compared + 1 + compared % 2).with_(friction=None)
        model = simulate(scene, history=False)
        if model.min_normal_ratio < 0.05 or model.friction_demand > 40:
            continue
        compared += 1
        totals, impacts, _ = march_of(scene.with_(friction=50.0))
        count = min(len(impacts), 8)
        for one, row in zip(model.impacts[:count], impacts, strict=False):
            assert (one.time, one.rate_after) == pytest.approx((row[0], row[2]), abs=1e-9)
            assert one.base_velocity_jump == pytest.approx(row[3], abs=1e-9)
        assert totals[S.PEAK_TILT] == pytest.approx(model.peak_tilt, abs=1e-9)
        if model.outcome == "overturns":
            assert totals[S.FALL_TIME] == pytest.approx(model.fall_time, abs=1e-9)
        else:
            assert len(impacts) == len(model.impacts)
            assert totals[S.PEAK_X] == pytest.approx(model.peak_base_displacement, abs=1e-9)


def test_the_history_is_the_trajectory():
    scene = scene_of(0.4, 0.348, 1.86, motion=PulseMotion("half-sine", 9.38, 6.34), duration=3.0)
    history = simulate(scene, output_step=1e-3).history
    assert np.abs(np.diff(history.slip)).max() < 1e-3 * 2.0  # no jump
    rate = np.gradient(history.tilt, history.time)
    smooth = slice(5, 2000)
    assert np.abs(rate - history.tilt_rate)[smooth].max() < 0.05
    assert history.slip[-1] == simulate(scene).sliding.end
    assert all(a <= b for a, b in pairwise(history.time))
