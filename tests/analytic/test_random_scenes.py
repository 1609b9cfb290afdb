"""Random valid scenes through the kernel: no NaN, no hang, no failure, no energy from nothing."""

import math

import numpy as np
import pytest
from bearing_laws import to_law
from random_scenes import random_scene

from analytic import Base, Block, Impact, PulseMotion, Scene, Start, overturning_map, simulate
from analytic.bearing import BearingLaw

IMBALANCE_LIMIT = 1e-6  # of the largest energy in the run
LOSS_ROUND_OFF = 1e-12  # an impact may seem to add this share of the energy it meets
# Energies below this share of what it takes to tip the block are rounding (a pulse that just touches the threshold).
ROUND_OFF = 1e-9


def faults(scene):
    """What is wrong with the kernel's run of `scene`: a dict of findings, empty for a sound one."""
    response = simulate(scene, history=False)
    wrong = {}
    if response.failure:
        wrong["failure"] = response.failure.reason
    numbers = [
        response.peak_tilt,
        response.peak_base_displacement,
        response.peak_base_acceleration,
        response.end.tilt,
        response.end.tilt_rate,
        response.end.base_displacement,
        response.end.base_velocity,
        response.end.bearing_force,
    ]
    ledger = response.energy
    terms = [ledger.kinetic, ledger.potential, ledger.input, ledger.hysteretic, ledger.viscous, ledger.impact_loss]
    if not np.isfinite(numbers + terms).all():
        wrong["not finite"] = numbers + terms
        return wrong
    scale = max(_energy_scale(scene, response), *map(abs, terms))
    if abs(ledger.imbalance) > IMBALANCE_LIMIT * scale:
        wrong["energy imbalance"] = abs(ledger.imbalance) / scale
    least = least_impact_loss(scene, response.impacts)
    if least < -LOSS_ROUND_OFF:
        wrong["an impact adds energy"] = least
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


def least_impact_loss(scene, impacts):
    """Least share of its tilting energy that an impact takes away; below 0 it would have added some.

    The base velocity drops out: w h J-terms, with j the jump, leave J (w-^2 - w+^2)/2 - m h j w+ - M j^2/2.
    """
    block, least = scene.block, 1.0
    for impact in impacts:
        before, after, jump = impact.rate_before, impact.rate_after, impact.base_velocity_jump
        met = 0.5 * block.inertia * before**2
        loss = met - 0.5 * block.inertia * after**2 - block.mass * block.half_height * jump * after
        if scene.base:
            loss -= 0.5 * scene.total_mass * jump**2
        if met > 0:
            least = min(least, loss / met)
    return least


def test_random_scenes_are_sound_and_repeatable():
    assert random_scene(0, 7).digest() == random_scene(0, 7).digest()
    kinds = {
        (scene.base is None, scene.bearings and scene.bearings.law, type(scene.motion).__name__)
        for scene in (random_scene(0, i) for i in range(200))
    }
    assert len(kinds) >= 12
    for index in range(300):
        for scene in with_bilinear_bearings(random_scene(0, index)):
            assert faults(scene) == {}, index


def with_bilinear_bearings(scene):
    """The scene, and where its bearings yield, the same with bilinear ones."""
    yield scene
    bearings = scene.bearings
    if bearings and bearings.law != "linear":
        changes = to_law("bilinear", bearings.ka, bearings.kb, BearingLaw.of(bearings).f0)
        yield scene.with_(bearings=changes | {"delta_k": 1e-20})


@pytest.mark.parametrize("index", range(150))
def test_mirrored_scenes_are_mirrored_bit_for_bit(index):
    for scene in with_bilinear_bearings(random_scene(2, index)):
        start = Start(**{name: -value for name, value in scene.start.model_dump().items()})
        motion = scene.motion.scaled(-1.0) if scene.motion else None
        one, other = simulate(scene), simulate(scene.with_(start=start, motion=motion))
        assert one.outcome != "failed", one.failure
        for name in ("tilt", "tilt_rate", "base_displacement", "base_velocity", "bearing_force"):
            assert np.array_equal(getattr(one.history, name), -getattr(other.history, name)), name
        assert [impact.time for impact in one.impacts] == [impact.time for impact in other.impacts]


@pytest.mark.slow
@pytest.mark.timeout(1400)
@pytest.mark.parametrize("begin", range(300, 50_300, 5000))
def test_many_more_random_scenes_are_sound(begin):
    faulty = {index: found for index in range(begin, begin + 5000) if (found := faults(random_scene(0, index)))}
    assert not faulty


def test_an_impact_that_adds_energy_is_found():
    scene = Scene(block=Block(mass=10.0, radius=1.0, slenderness=0.3), base=Base(mass=3.0), duration=1.0)
    sound = simulate(scene.with_(start={"tilt": 0.2}), history=False).impacts
    assert sound and least_impact_loss(scene, sound) > 0
    assert least_impact_loss(scene, [Impact(0.1, -1.0, -1.01, 0.0)]) < 0
    pushed = Impact(0.1, -1.0, -0.5, 5.0)  # a jump momentum does not allow
    assert least_impact_loss(scene, [pushed]) < 0


def test_an_imbalance_of_energy_is_found(monkeypatch):
    monkeypatch.setitem(globals(), "IMBALANCE_LIMIT", -1.0)  # nothing is good enough
    assert "energy imbalance" in faults(random_scene(0, 0))


def test_exact_touch_of_a_pulse_is_among_the_random_scenes():
    def touches(scene):
        unit = 9.81 * math.tan(scene.block.slenderness)
        return isinstance(scene.motion, PulseMotion) and abs(scene.motion.amplitude) == unit

    assert any(touches(random_scene(0, index)) for index in range(300))


@pytest.mark.parametrize("ratio", [1.0, 10 / 3, 17 / 3, 8.0])
def test_pulse_that_touches_the_threshold_to_the_last_bit_ends(ratio):
    """Rounding decides whether gravity brings the block back; impacts once shrank for ever here."""
    block = Block(mass=1.0, radius=0.75 * 9.81 / 2.14**2, slenderness=0.25, restitution=0.9)
    outcomes = overturning_map(Scene(block=block, duration=30.0), "one-sine", [ratio], [1.0], workers=1)
    assert not outcomes.failed.any() and not outcomes.overturns.any()


def test_nearly_elastic_impacts_end():
    block = Block(mass=559.3, radius=2.8055, slenderness=0.38, restitution=1 - 1e-6)
    scene = Scene(block=block, base=Base(mass=5.76), duration=2.0, start={"tilt_rate": -0.36})
    response = simulate(scene, history=False)
    assert response.failure is None and response.impact_count < 1e6
