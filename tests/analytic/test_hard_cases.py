"""The hard cases that have broken real integrators, by name: each must end right, or say why not."""

import math
from functools import partial

import numpy as np
import pytest

from analytic import Base, Block, PulseMotion, SampledMotion, Scene, Start, simulate
from analytic.caryatid import BASE, caryatid_block
from analytic.caryatid import BEARINGS as LRB
from analytic.polynomial import BISECTIONS, MAX_ORDER, first_root
from analytic.rocking import RockingModel
from analytic.twin import simulate_twin

SOLVERS = pytest.mark.parametrize("solve", [simulate, partial(simulate_twin, rtol=1e-12)], ids=["kernel", "twin"])
G = 9.81
GAMMA = 0.25
THRESHOLD = G * math.tan(GAMMA)
BLOCK = Block(mass=1000.0, radius=1.0, slenderness=GAMMA)
CARYATID = caryatid_block(0.28)
ISOLATED = Scene(block=CARYATID, base=BASE, bearings=LRB, duration=10.0)


def sampled(values, dt=0.01):
    return SampledMotion(dt, np.asarray(values, dtype=float))


def sound(response):
    """Finite, not failed, and energy neither made nor lost unaccounted."""
    assert response.outcome != "failed", response.failure
    values = [getattr(response.end, name) for name in ("tilt", "tilt_rate", "base_displacement", "base_velocity")]
    assert np.isfinite(values).all()
    energy = response.energy
    turnover = max(abs(energy.input), abs(energy.kinetic), abs(energy.potential), energy.impact_loss, 1e-12)
    assert abs(energy.imbalance) <= 1e-8 * turnover
    assert energy.impact_loss >= -1e-12 * turnover
    return response


def test_zeno_decay_comes_to_rest_and_stays_above_the_floor():
    response = sound(simulate(Scene(block=BLOCK, start=Start(tilt=0.6 * GAMMA), duration=30.0)))
    assert len(response.rests) == 1
    assert response.end.tilt == 0.0 == response.end.tilt_rate
    # every swing lies on its own side: impacts alternate in direction, none is lost
    directions = [math.copysign(1, impact.rate_before) for impact in response.impacts]
    assert all(a == -b for a, b in zip(directions, directions[1:], strict=False))
    rates = np.abs([impact.rate_before for impact in response.impacts])
    after = np.abs([impact.rate_after for impact in response.impacts])
    assert rates[1:] == pytest.approx(after[:-1], rel=1e-9)  # energy is conserved in flight


def test_trivial_root_just_after_an_impact_is_not_an_impact():
    work = np.empty((BISECTIONS + 2, MAX_ORDER + 1))
    # phi = w t - q t^2/2: the root at 0 is the impact just left, the next lies at 2 w/q
    hop = np.zeros(MAX_ORDER + 2)
    hop[1], hop[2] = 1e-9, -0.5
    assert first_root(hop, 8, 1.0, work) == pytest.approx(2e-9, rel=1e-14)
    # a third-order onset that turns back
    onset = np.zeros(MAX_ORDER + 2)
    onset[3], onset[4] = 1.0, -4.0
    assert first_root(onset, 8, 1.0, work) == pytest.approx(0.25, rel=1e-14)


@SOLVERS
def test_rest_inside_a_motion_lifts_again(solve):
    quiet = np.zeros(1500)
    t = np.arange(200) * 0.01
    burst = 1.3 * THRESHOLD * np.sin(2 * np.pi * 2 * t)
    response = sound(
        solve(Scene(block=BLOCK, motion=sampled(np.concatenate([burst, quiet, burst, quiet])), duration=40.0))
    )
    assert len(response.uplifts) >= 2
    assert len(response.rests) >= 2
    assert response.uplifts[-1] > 17.0 > response.rests[0]


def test_third_order_onset_takes_its_side_from_the_acceleration():
    for sign in (1.0, -1.0):
        ramp = sign * np.linspace(0.9, 1.2, 101) * THRESHOLD
        response = sound(simulate(Scene(block=BLOCK, motion=sampled(ramp), duration=0.6), output_step=1e-3))
        time, tilt = response.history.time, response.history.tilt
        uplift = response.uplifts[0]
        assert uplift == pytest.approx(1.0 / 3, abs=1e-9)
        # phi'' = -s p^2 slope (t - t_u)/g cos: phi grows with the third power, against the acceleration
        p2 = 0.75 * G
        slope = 0.3 * THRESHOLD
        later = time > uplift + 0.02
        predicted = -sign * p2 * slope / G * math.cos(GAMMA) * (time[later] - uplift) ** 3 / 6
        assert tilt[later][0] == pytest.approx(predicted[0], rel=0.02)


def test_several_crossings_within_one_step_are_all_found():
    work = np.empty((BISECTIONS + 2, MAX_ORDER + 1))
    roots = np.array([0.11, 0.12, 0.5, 0.500001, 0.93])
    f = np.zeros(MAX_ORDER + 2)
    f[: len(roots) + 1] = -np.polynomial.polynomial.polyfromroots(roots)  # positive at 0
    assert f[0] > 0
    found, start = [], 0.0
    while True:
        shifted = np.zeros_like(f)
        taylor = np.polynomial.Polynomial(f[: len(roots) + 1])(np.polynomial.Polynomial([start, 1.0])).coef
        shifted[: len(taylor)] = taylor if found and len(found) % 2 == 0 or not found else -taylor
        if found:
            shifted[0] = 0.0
        root = first_root(shifted, len(roots), 1.0 - start, work)
        if root < 0:
            break
        start += root
        found.append(start)
    assert found == pytest.approx(roots, abs=1e-8)


def test_double_touch_without_crossing_is_no_event():
    work = np.empty((BISECTIONS + 2, MAX_ORDER + 1))
    f = np.zeros(MAX_ORDER + 2)
    f[:3] = 0.25, -1.0, 1.0  # (t - 1/2)^2
    assert first_root(f, 2, 1.0, work) == -1.0


@SOLVERS
def test_uplift_just_below_and_above_the_threshold(solve):
    below = Scene(block=BLOCK, motion=PulseMotion("one-sine", 0.99 * THRESHOLD, 3.0), duration=5.0)
    assert sound(solve(below)).outcome == "stands"
    above = sound(solve(below.with_(motion=PulseMotion("one-sine", 1.01 * THRESHOLD, 3.0))))
    assert above.outcome == "rocks"
    assert above.uplifts[0] == pytest.approx(math.asin(1 / 1.01) / 3.0, abs=1e-12)


def test_grazing_the_threshold_exactly():
    # the peak touches the threshold at a sample and turns back: nothing may loop
    triangle = np.concatenate([np.linspace(0, THRESHOLD, 50), np.linspace(THRESHOLD, 0, 50)[1:]])
    assert sound(simulate(Scene(block=BLOCK, motion=sampled(triangle), duration=3.0))).outcome == "stands"
    plateau = np.full(300, THRESHOLD)
    assert sound(simulate(Scene(block=BLOCK, motion=sampled(plateau), duration=5.0))).outcome == "stands"


@SOLVERS
def test_flat_drop_lands_and_stays(solve):
    # stocky block on a light base: e_phi <= 0, the block lands flat and its momentum goes to the base
    scene = Scene(
        block=Block(mass=1000.0, radius=1.0, slenderness=1.0),
        base=Base(mass=10.0),
        bearings=LRB,
        start=Start(tilt=0.1),
        duration=5.0,
    )
    response = sound(solve(scene))
    assert RockingModel.of(scene).restitution == 0.0
    assert response.impact_count == 1
    assert response.impacts[0].rate_after == 0.0
    assert response.rests == (response.impacts[0].time,)
    momentum = scene.mass_share * scene.block.half_height * response.impacts[0].rate_before
    assert response.impacts[0].base_velocity_jump == pytest.approx(momentum, rel=1e-14)


@pytest.mark.parametrize("share", [1e-9, -1e-9])
def test_near_critical_start_from_both_sides(share):
    scene = Scene(block=BLOCK, start=Start(tilt=GAMMA * (1 + share)), duration=60.0)
    response = sound(simulate(scene))
    assert response.outcome == ("overturns" if share > 0 else "rocks")


def test_bearing_driven_beyond_the_literal_formula():
    scene = ISOLATED.with_(start=Start(base_velocity=8.0), block={"slenderness": 0.6}, duration=6.0)
    response = sound(simulate(scene))
    assert response.peak_base_displacement > 1.34


@pytest.mark.parametrize("amplitude", [1e-3, 1e-6, 1e-9, 1e-13])
def test_tiny_reversals(amplitude):
    t = np.arange(2000) * 0.005
    scene = ISOLATED.with_(motion=SampledMotion(0.005, amplitude * np.sin(2 * np.pi * 5 * t)), duration=12.0)
    response = sound(simulate(scene))
    assert response.outcome == "stands"
    assert 0 < response.peak_base_displacement < amplitude


@pytest.mark.parametrize("e", [0.0, 1.0, 0.999999])
def test_given_restitution_from_plastic_to_elastic(e):
    scene = Scene(block=BLOCK.model_copy(update={"restitution": e}), start=Start(tilt=0.1), duration=20.0)
    response = sound(simulate(scene))
    if e == 1.0:
        assert response.energy.impact_loss == 0.0
        assert response.peak_tilt == pytest.approx(0.1, rel=1e-9)
    if e == 0.0:
        assert response.impact_count == 1


def test_elastic_block_with_hardly_any_energy_ends():
    # 1e12 bounces would follow; they are below what rest means
    scene = Scene(block=BLOCK.model_copy(update={"restitution": 1.0}), start=Start(tilt_rate=1e-10), duration=20.0)
    assert simulate(scene).impact_count < 10


@pytest.mark.parametrize("dt", [1e-4, 0.05, 0.5])
def test_sampling_from_fine_to_coarse(dt):
    t = np.arange(0, 10, dt)
    motion = SampledMotion(dt, 3.0 * np.sin(2 * np.pi * 0.5 * t))
    one = sound(simulate(ISOLATED.with_(motion=motion, block={"slenderness": 0.2})))
    fine = np.arange(0, t[-1], dt / 4)
    finer = SampledMotion(dt / 4, motion.acceleration(fine))
    other = simulate(ISOLATED.with_(motion=finer, block={"slenderness": 0.2}))
    assert one.peak_base_displacement == pytest.approx(other.peak_base_displacement, rel=1e-4)


def test_ten_minutes_at_rest_under_weak_shaking():
    t = np.arange(60000) * 0.01
    motion = sampled(0.3 * np.sin(2 * np.pi * 1.3 * t))
    rigid = sound(simulate(Scene(block=BLOCK, motion=motion, duration=600.0)))
    assert rigid.outcome == "stands"
    assert rigid.peak_tilt == 0.0
    assert sound(simulate(ISOLATED.with_(motion=motion, duration=600.0))).outcome == "stands"


TIMES = np.arange(10000) * 0.01
GAPS = sampled((2.5 * np.sin(2 * np.pi * TIMES) * (np.sin(2 * np.pi * 0.2 * TIMES) > 0.3))[:1000])
PULSES = sampled(1.5 * THRESHOLD * np.sin(2 * np.pi * TIMES) * (TIMES % 5 < 2))
RELEASED = ISOLATED.with_(start=Start(tilt=0.1))
SOUND = {
    f"base of {ratio:g} blocks, {name}": RELEASED.with_(base=Base(mass=CARYATID.mass * ratio), bearings=bearings)
    for ratio in (1e-6, 1e-4, 1e3, 1e9)
    for name, bearings in (("on bearings", LRB), ("sliding", None))
}
SOUND |= {
    f"bearings of {change}": RELEASED.with_(bearings=change, motion=PulseMotion("one-sine", 3.0, 6.0))
    for change in ({"alpha": 1.5}, {"alpha": 1.05}, {"alpha": 200.0}, {"ka": 6.22e3 * 1.0001})
}
SOUND |= {
    "gaps of zeros, on bearings": ISOLATED.with_(motion=GAPS, block={"slenderness": 0.15}),
    "gaps of zeros, rigid ground": Scene(block=BLOCK, motion=GAPS, duration=15.0),
    "pulses in a row": Scene(block=Block(mass=1.0, radius=5.0, slenderness=GAMMA), motion=PULSES, duration=120.0),
}


@pytest.mark.parametrize("scene", SOUND.values(), ids=SOUND)
def test_scenes_far_from_the_usual_ones_are_sound(scene):
    sound(simulate(scene))


def test_motion_longer_than_the_run_and_shorter():
    motion = sampled(np.sin(np.arange(1000) * 0.06))
    short = simulate(ISOLATED.with_(motion=motion, duration=3.3333))
    assert short.end.time == 3.3333
    long = simulate(ISOLATED.with_(motion=motion, duration=33.0))
    assert long.end.time == 33.0
