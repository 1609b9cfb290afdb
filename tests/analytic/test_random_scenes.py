"""Random valid scenes through the kernel: no NaN, no hang, no failure, no energy from nothing."""

import math
from dataclasses import astuple
from functools import partial

import numpy as np
import pytest
from bearing_laws import NAMES
from from_python import from_python
from random_scenes import random_scene

from analytic import Base, Block, SampledMotion, Scene, Start, overturning_map, simulate
from analytic.caryatid import BASE, caryatid_block
from analytic.caryatid import BEARINGS as LRB
from analytic.polynomial import MAX_ORDER, SCRATCH, first_root
from analytic.rocking import RockingModel
from analytic.twin import simulate_twin

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


MANY = (pytest.mark.long, pytest.mark.timeout(1400))


@pytest.mark.parametrize(
    "begin, count", [(0, 200), *(pytest.param(begin, 5000, marks=MANY) for begin in (200, 20_000))]
)
def test_random_scenes_are_sound(begin, count):
    for index in range(begin, begin + count):
        assert_sound(random_scene(0, index, NAMES))


@pytest.mark.parametrize("ratio", [1.0, 10 / 3, 17 / 3, 8.0])
def test_pulse_that_touches_the_threshold_to_the_last_bit_ends(ratio):
    """Rounding decides whether gravity brings the block back; impacts once shrank for ever here."""
    block = Block(mass=1.0, radius=0.75 * 9.81 / 2.14**2, slenderness=0.25, restitution=0.9)
    outcomes = overturning_map(Scene(block=block, duration=30.0), "one-sine", [ratio], [1.0], workers=1)
    assert not outcomes.failed.any() and not outcomes.overturns.any()


# The hard cases that have broken real integrators, by name: each must end right, or say why not.
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
    energy = response.energy
    assert np.isfinite([*astuple(response.end), *astuple(energy)]).all()
    turnover = max(abs(energy.input), abs(energy.kinetic), abs(energy.potential), energy.impact_loss, 1e-12)
    assert abs(energy.imbalance) <= 1e-8 * turnover and energy.impact_loss >= -1e-12 * turnover
    return response


@SOLVERS
def test_rest_inside_a_motion_lifts_again(solve):
    burst = [*1.3 * THRESHOLD * np.sin(2 * np.pi * 2 * np.arange(200) * 0.01), *np.zeros(900)]
    response = sound(solve(Scene(block=BLOCK, motion=sampled(burst + burst), duration=23.0)))
    assert len(response.uplifts) >= 2 and len(response.rests) >= 2
    assert response.uplifts[-1] > 11.0 > response.rests[0]


@SOLVERS
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_third_order_onset_takes_its_side_from_the_acceleration(solve, sign):
    """phi = -s p^2 cos(gamma) a' t^3/(6 g) after the uplift: against the acceleration, with the third power of time."""
    ramp = SampledMotion(0.01, sign * np.linspace(0.9, 1.2, 101) * THRESHOLD)
    for after in (0.01, 0.02):
        response = sound(solve(Scene(block=BLOCK, motion=ramp, duration=1 / 3 + after)))
        assert response.uplifts == (pytest.approx(1 / 3, abs=1e-9),)
        predicted = -sign * 0.75 * math.cos(GAMMA) * 0.3 * THRESHOLD * after**3 / 6
        assert response.end.tilt == pytest.approx(predicted, rel=5e-3)


POLYNOMIALS = {  # order of the lowest power, roots in ascending order: positive between the first power's 0 and a root
    "five within one step": (0, [0.11, 0.12, 0.5, 0.500001, 0.93], 1e-8),
    "just after an impact": (1, [2e-9], 1e-14),
    "third-order onset that turns back": (3, [0.25], 1e-14),
    "a touch is none": (0, [], 1e-14),
}


@pytest.mark.parametrize(("lowest", "roots", "accuracy"), POLYNOMIALS.values(), ids=POLYNOMIALS)
def test_every_crossing_within_a_step_is_found_and_not_the_trivial_root(lowest, roots, accuracy):
    work, first = np.empty(SCRATCH), from_python(first_root)
    for k in range(max(len(roots), 1)):
        start = roots[k - 1] if k else 0.0
        left = np.array(roots[k:]) - start  # what is left after k crossings, from the last one on
        f = np.zeros(MAX_ORDER + 2)
        shape = np.polynomial.polynomial.polyfromroots(left if roots else [0.5, 0.5])
        power = lowest or min(k, 1)
        f[power : power + len(shape)] = shape * np.sign(shape[0])
        found = first(f, power + len(shape) - 1, 1.0 - start, work)
        assert found == pytest.approx(left[0] if roots else -1.0, rel=accuracy)


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
    (impact,) = response.impacts
    assert RockingModel.of(scene).restitution == impact.rate_after == 0.0 and response.rests == (impact.time,)
    momentum = scene.mass_share * scene.block.half_height * impact.rate_before
    assert impact.base_velocity_jump == pytest.approx(momentum, rel=1e-14)


@pytest.mark.parametrize("e", [0.0, 1.0, 0.999999])
def test_given_restitution_from_plastic_to_elastic(e):
    scene = Scene(block=BLOCK.model_copy(update={"restitution": e}), start=Start(tilt=0.1), duration=20.0)
    response = sound(simulate(scene))
    assert response.peak_tilt == pytest.approx(0.1, rel=1e-9)
    assert (response.energy.impact_loss == 0) == (e == 1) and (response.impact_count == 1) == (e == 0)


RAMP, SECONDS = np.linspace(0, THRESHOLD, 50), np.arange(0, 600, 0.01)
STANDING = {  # the first two touch the threshold at samples and turn back
    "peak": (Scene(block=BLOCK), [*RAMP, *RAMP[-2::-1]]),
    "plateau": (Scene(block=BLOCK), np.full(300, THRESHOLD)),
    "tiny reversals": (ISOLATED, 1e-13 * np.sin(10 * np.pi * SECONDS[:1000])),
    "small reversals": (ISOLATED, 1e-3 * np.sin(10 * np.pi * SECONDS[:1000])),
    "ten minutes on the ground": (Scene(block=BLOCK), 0.3 * np.sin(2.6 * np.pi * SECONDS)),
    "ten minutes on bearings": (ISOLATED, 0.3 * np.sin(2.6 * np.pi * SECONDS)),
}


@pytest.mark.parametrize("scene, samples", STANDING.values(), ids=STANDING)
def test_what_never_lifts_stands_to_the_end(scene, samples):
    response = sound(simulate(scene.with_(motion=sampled(samples), duration=0.01 * len(samples) + 2.0)))
    assert (response.outcome, response.peak_tilt) == ("stands", 0.0)
    assert (scene is ISOLATED) == (0 < response.peak_base_displacement < 1.1 * np.abs(samples).max())
