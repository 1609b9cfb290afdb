"""The hard cases that have broken real integrators, by name: each must end right, or say why not."""

import math
from dataclasses import astuple
from functools import partial

import numpy as np
import pytest
from from_python import from_python

from analytic import Base, Block, SampledMotion, Scene, Start, simulate
from analytic.caryatid import BASE, caryatid_block
from analytic.caryatid import BEARINGS as LRB
from analytic.polynomial import MAX_ORDER, SCRATCH, first_root
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
    energy = response.energy
    assert np.isfinite([*astuple(response.end), *astuple(energy)]).all()
    turnover = max(abs(energy.input), abs(energy.kinetic), abs(energy.potential), energy.impact_loss, 1e-12)
    assert abs(energy.imbalance) <= 1e-8 * turnover and energy.impact_loss >= -1e-12 * turnover
    return response


@SOLVERS
def test_rest_inside_a_motion_lifts_again(solve):
    burst = [*1.3 * THRESHOLD * np.sin(2 * np.pi * 2 * np.arange(200) * 0.01), *np.zeros(1500)]
    response = sound(solve(Scene(block=BLOCK, motion=sampled(burst + burst), duration=40.0)))
    assert len(response.uplifts) >= 2 and len(response.rests) >= 2
    assert response.uplifts[-1] > 17.0 > response.rests[0]


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


RAMP = np.linspace(0, THRESHOLD, 50)


@pytest.mark.parametrize("samples", [[*RAMP, *RAMP[-2::-1]], np.full(300, THRESHOLD)], ids=["peak", "plateau"])
def test_grazing_the_threshold_exactly(samples):
    # the motion touches the threshold at a sample and turns back: nothing may loop
    assert sound(simulate(Scene(block=BLOCK, motion=sampled(samples), duration=5.0))).outcome == "stands"


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
    assert response.peak_tilt == pytest.approx(0.1, rel=1e-9)
    assert (response.energy.impact_loss == 0) == (e == 1) and (response.impact_count == 1) == (e == 0)


@pytest.mark.parametrize("dt", [1e-4, 0.05, 0.5])
def test_sampling_from_fine_to_coarse(dt):
    t = np.arange(0, 10, dt)
    motion = SampledMotion(dt, 3.0 * np.sin(2 * np.pi * 0.5 * t))
    one = sound(simulate(ISOLATED.with_(motion=motion, block={"slenderness": 0.2})))
    fine = np.arange(0, t[-1], dt / 4)
    finer = SampledMotion(dt / 4, motion.acceleration(fine))
    other = simulate(ISOLATED.with_(motion=finer, block={"slenderness": 0.2}))
    assert one.peak_base_displacement == pytest.approx(other.peak_base_displacement, rel=1e-4)


@pytest.mark.parametrize("scene", [Scene(block=BLOCK), ISOLATED], ids=["rigid", "isolated"])
def test_ten_minutes_at_rest_under_weak_shaking(scene):
    motion = sampled(0.3 * np.sin(2 * np.pi * 1.3 * np.arange(60000) * 0.01))
    response = sound(simulate(scene.with_(motion=motion, duration=600.0)))
    assert (response.outcome, response.peak_tilt) == ("stands", 0.0)
