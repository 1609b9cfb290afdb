"""Random valid scenes through the kernel: no NaN, no hang, no failure, no energy from nothing."""

import math
from dataclasses import astuple

import numpy as np
import pytest
from bearing_laws import NAMES
from random_scenes import random_scene

from analytic import Block, Scene, Start, overturning_map, simulate
from analytic.rocking import RockingModel

IMBALANCE_LIMIT = 1e-6  # of the largest energy in the run
# Energies below this share of what it takes to tip the block are rounding (a pulse that just touches the threshold).
ROUND_OFF = 1e-9


def assert_sound(scene):
    """The kernel's run of `scene` ends, with finite numbers, the model's impacts and an energy balance."""
    response = simulate(scene, history=False)
    ledger, model = response.energy, RockingModel.of(scene)
    assert response.failure is None and (response.outcome == "overturns" or response.end.time == scene.duration)
    peaks = response.peak_tilt, response.peak_base_displacement, response.peak_base_acceleration
    assert np.isfinite([*peaks, *astuple(response.end), *astuple(ledger)]).all()
    scale = max(_energy_scale(scene, response), *map(abs, astuple(ledger)))
    assert abs(ledger.imbalance) <= IMBALANCE_LIMIT * scale
    for one in response.impacts:  # they never add energy: test_rocking
        expected = pytest.approx(model.impact(one.rate_before), rel=1e-9, abs=1e-15)
        assert (one.rate_after, one.base_velocity_jump) == expected


def _energy_scale(scene, response):
    """Energies that came and went within the run without a trace in the ledger's final sums [J]."""
    block, bearings, start = scene.block, scene.bearings, scene.start
    scale = 0.5 * block.inertia * start.tilt_rate**2 + 0.5 * scene.total_mass * start.base_velocity**2
    if bearings:
        k = bearings.ka if bearings.law == "linear" else bearings.kb
        scale += 0.5 * bearings.count * k * response.peak_base_displacement**2
    left = math.cos(block.slenderness - min(response.peak_tilt, block.slenderness)) - math.cos(block.slenderness)
    scale += block.mass * scene.gravity * block.radius * (left + ROUND_OFF * (1 - math.cos(block.slenderness)))
    if scene.base and scene.motion:  # what a base gains and loses again when the ground stops: by the rectangle rule
        times = np.linspace(0.0, scene.motion.end, 2000)
        velocity = np.cumsum(scene.motion.acceleration(times)) * times[1]
        scale += 0.5 * scene.total_mass * np.abs(velocity).max() ** 2
    return scale


def test_random_scenes_are_sound():
    for index in range(400):
        assert_sound(random_scene(0, index, NAMES))


@pytest.mark.parametrize("index", range(40))
def test_mirrored_scenes_are_mirrored_bit_for_bit(index):
    scene = random_scene(2, index, NAMES)
    start = Start(**{name: -value for name, value in scene.start.model_dump().items()})
    motion = scene.motion.scaled(-1.0) if scene.motion else None
    one, other = simulate(scene), simulate(scene.with_(start=start, motion=motion))
    assert one.outcome != "failed", one.failure
    for name in ("tilt", "tilt_rate", "base_displacement", "base_velocity", "bearing_force"):
        assert np.array_equal(getattr(one.history, name), -getattr(other.history, name)), name
    assert [impact.time for impact in one.impacts] == [impact.time for impact in other.impacts]


@pytest.mark.long
@pytest.mark.timeout(1400)
@pytest.mark.parametrize("begin", (400, 20_000))
def test_many_more_random_scenes_are_sound(begin):
    for index in range(begin, begin + 5000):
        assert_sound(random_scene(0, index, NAMES))


@pytest.mark.parametrize("ratio", [1.0, 10 / 3, 17 / 3, 8.0])
def test_pulse_that_touches_the_threshold_to_the_last_bit_ends(ratio):
    """Rounding decides whether gravity brings the block back; impacts once shrank for ever here."""
    block = Block(mass=1.0, radius=0.75 * 9.81 / 2.14**2, slenderness=0.25, restitution=0.9)
    outcomes = overturning_map(Scene(block=block, duration=30.0), "one-sine", [ratio], [1.0], workers=1)
    assert not outcomes.failed.any() and not outcomes.overturns.any()
