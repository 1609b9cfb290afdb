"""Random valid scenes through the kernel: no NaN, no hang, no failure, no energy from nothing."""

import math

import numpy as np
import pytest
from random_scenes import random_scene

from analytic import Block, Scene, Start, overturning_map, simulate
from analytic.rocking import RockingModel

IMBALANCE_LIMIT = 1e-6  # of the largest energy in the run
# Energies below this share of what it takes to tip the block are rounding (a pulse that just touches the threshold).
ROUND_OFF = 1e-9


def faults(scene):
    """What is wrong with the kernel's run of `scene`: a dict of findings, empty for a sound one."""
    response = simulate(scene, history=False)
    wrong = {}
    if response.failure:
        wrong["failure"] = response.failure.reason
    found, ledger = response.end, response.energy
    numbers = [response.peak_tilt, response.peak_base_displacement, response.peak_base_acceleration]
    numbers += [found.tilt, found.tilt_rate, found.base_displacement, found.base_velocity, found.bearing_force]
    terms = [ledger.kinetic, ledger.potential, ledger.input, ledger.hysteretic, ledger.viscous, ledger.impact_loss]
    if not np.isfinite(numbers + terms).all():
        return wrong | {"not finite": numbers + terms}
    scale = max(_energy_scale(scene, response), *map(abs, terms))
    if abs(ledger.imbalance) > IMBALANCE_LIMIT * scale:
        wrong["energy imbalance"] = abs(ledger.imbalance) / scale
    impact = RockingModel.of(scene).impact
    for one in response.impacts:  # it never adds energy: test_rocking
        if (one.rate_after, one.base_velocity_jump) != pytest.approx(impact(one.rate_before), rel=1e-9, abs=1e-15):
            wrong["not the model's impact"] = one
    if response.end.time < scene.duration * (1 - 1e-12) and response.outcome not in ("overturns", "failed"):
        wrong["ended early"] = response.end.time
    return wrong


def _energy_scale(scene, response):
    """Energies that came and went within the run without a trace in the ledger's final sums [J]."""
    block, bearings, start = scene.block, scene.bearings, scene.start
    scale = 0.5 * block.inertia * start.tilt_rate**2 + 0.5 * scene.total_mass * start.base_velocity**2
    if bearings:
        k = bearings.ka if bearings.law == "linear" else bearings.kb
        scale += 0.5 * bearings.count * k * response.peak_base_displacement**2
    weight = block.mass * scene.gravity * block.radius
    reached = min(response.peak_tilt, block.slenderness)
    scale += weight * (math.cos(block.slenderness - reached) - math.cos(block.slenderness))
    scale += ROUND_OFF * weight * (1 - math.cos(block.slenderness))
    if scene.base and scene.motion:  # what a base gains and loses again when the ground stops
        scale += 0.5 * scene.total_mass * _peak_velocity(scene.motion) ** 2
    return scale


def _peak_velocity(motion):
    """Bound on the ground velocity [m/s], by the rectangle rule."""
    times = np.linspace(0.0, motion.end, 2000)
    return float(np.abs(np.cumsum(motion.acceleration(times))).max() * times[1])


def test_random_scenes_are_sound_and_repeatable():
    assert random_scene(0, 7).digest() == random_scene(0, 7).digest()
    kinds = {
        (scene.base is None, scene.bearings and scene.bearings.law, type(scene.motion).__name__)
        for scene in (random_scene(0, i) for i in range(200))
    }
    assert len(kinds) >= 15
    for index in range(400):
        assert faults(random_scene(0, index)) == {}, index


@pytest.mark.parametrize("index", range(150))
def test_mirrored_scenes_are_mirrored_bit_for_bit(index):
    scene = random_scene(2, index)
    start = Start(**{name: -value for name, value in scene.start.model_dump().items()})
    motion = scene.motion.scaled(-1.0) if scene.motion else None
    one, other = simulate(scene), simulate(scene.with_(start=start, motion=motion))
    assert one.outcome != "failed", one.failure
    for name in ("tilt", "tilt_rate", "base_displacement", "base_velocity", "bearing_force"):
        assert np.array_equal(getattr(one.history, name), -getattr(other.history, name)), name
    assert [impact.time for impact in one.impacts] == [impact.time for impact in other.impacts]


@pytest.mark.slow
@pytest.mark.timeout(1400)
@pytest.mark.parametrize("begin", range(400, 50_400, 5000))
def test_many_more_random_scenes_are_sound(begin):
    faulty = {index: found for index in range(begin, begin + 5000) if (found := faults(random_scene(0, index)))}
    assert not faulty


@pytest.mark.parametrize("ratio", [1.0, 10 / 3, 17 / 3, 8.0])
def test_pulse_that_touches_the_threshold_to_the_last_bit_ends(ratio):
    """Rounding decides whether gravity brings the block back; impacts once shrank for ever here."""
    block = Block(mass=1.0, radius=0.75 * 9.81 / 2.14**2, slenderness=0.25, restitution=0.9)
    outcomes = overturning_map(Scene(block=block, duration=30.0), "one-sine", [ratio], [1.0], workers=1)
    assert not outcomes.failed.any() and not outcomes.overturns.any()
