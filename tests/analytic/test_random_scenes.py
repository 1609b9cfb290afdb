"""Random valid scenes through the kernel: no NaN, no hang, no failure, no energy from nothing."""

import math
from dataclasses import astuple, replace
from functools import partial

import numpy as np
import pytest
from bearing_laws import NAMES
from from_python import from_python
from random_scenes import random_scene
from record_files import FORMATS, needs_records
from rough_motions import rough

from analytic import Base, Bearings, Block, Caution, PulseMotion, SampledMotion, Scene, Start, overturning_map, simulate
from analytic.batch import simulate_many
from analytic.checks.time_stepping import simulate_time_stepping
from analytic.checks.twin import simulate_twin
from analytic.kernel.decision import RIGID_BEARINGS
from analytic.kernel.polynomial import MAX_ORDER, SCRATCH, first_root
from analytic.motion import paired
from analytic.records import read_record
from analytic.records.synthetic import synthetic_motion
from analytic.rocking import RockingModel
from analytic.scene import BASE, caryatid_block
from analytic.scene import BEARINGS as LRB

IMBALANCE_LIMIT = 1e-6  # of the largest energy in the run
# Energies below this share of what it takes to tip the block are rounding (a pulse that just touches the threshold).
ROUND_OFF = 1e-9


def assert_sound(scene):
    """Assert that the kernel's run of `scene` ends with finite numbers, the model's impacts and an energy balance."""
    response = simulate(scene, history=False)
    ledger, model = response.energy, RockingModel.of(scene)
    assert response.failure is None and (response.outcome == "overturns" or response.end.time == scene.duration)
    peaks = response.peak_tilt, response.peak_base_displacement, response.peak_base_acceleration
    assert np.isfinite([*peaks, *astuple(response.end), *astuple(ledger)]).all()
    scale = max(_energy_scale(scene, response), *map(abs, astuple(ledger)))
    assert abs(ledger.imbalance) <= IMBALANCE_LIMIT * scale
    for impact in response.impacts:  # they never add energy: test_rocking
        expected = pytest.approx(model.impact(impact.rate_before), rel=1e-9, abs=1e-15)
        assert (impact.rate_after, impact.base_velocity_jump) == expected


def _energy_scale(scene, response):
    """Return the energies that came and went within the run and leave no trace in the ledger's final sums [J]."""
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
    """Return the response: finite, not failed, and without energy gained or lost unaccounted for."""
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
    """After the uplift phi = -s p^2 cos(gamma) a' t^3/(6 g): against the acceleration, with the third power of time."""
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
        root = first(f, power + len(shape) - 1, 1.0 - start, work)
        assert root == pytest.approx(left[0] if roots else -1.0, rel=accuracy)


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


# Vertical ground motion: gravity becomes g + a_v(t), in the kernel, its twin, batches and time stepping.


GRAVITY = 9.81
STATUE = caryatid_block(0.28)
BILINEAR = Bearings(law="bilinear", count=4, ka=6.22e4, kb=6.22e3, yield_force=700.0)
FREE = Scene(block=STATUE, duration=4.0)
SLIDING = FREE.with_(base=BASE)
CARRIED = SLIDING.with_(bearings=LRB, block={"slenderness": 0.15})


def shaken(seed, peak=4.0):
    """Return rough motions; the vertical one has more of high frequency."""
    return replace(rough(seed, peak, 4.0), vertical=rough(seed + 100, 0.7 * peak, 4.0, frequency=3.0))


def pulse(shape, amplitude, frequency, vertical, phase=0.0):
    level = PulseMotion(shape, amplitude, frequency, 0.2)
    return replace(level, vertical=replace(level, amplitude=vertical, phase=phase))


def heaving(amplitude, frequency, duration=4.0, dt=0.005):
    """Return a motion that is horizontally 0 and vertically a sine."""
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
    "rough, on bearings": CARRIED.with_(motion=shaken(3, peak=6.0)),
    "sine, on bearings": CARRIED.with_(motion=pulse("one-sine", 5.0, 8.0, 2.5, 2.0)),
    "rough, bilinear bearings": CARRIED.with_(bearings=BILINEAR, motion=shaken(5, peak=6.0)),
    "long record, rigid ground": FREE.with_(block={"slenderness": 0.4}, motion=both_synthetic(1.0), duration=10.0),
    "long record, on bearings": CARRIED.with_(block={"slenderness": 0.2}, motion=both_synthetic(1.2), duration=8.0),
}


def state(response):
    end = response.end
    return [end.tilt, end.tilt_rate, end.base_displacement, end.base_velocity]


def impact_times(response, rate=0.0):
    """Return the times of the impacts that leave more than a rate."""
    return [impact.time for impact in response.impacts if abs(impact.rate_after) > rate]


def kernel_and_twin(scene):
    """Return the responses of both, which agree."""
    run = simulate(scene, history=False, tolerance=1e-15)
    twin = simulate_twin(scene, rtol=1e-12, history=False)
    assert (run.outcome, run.impact_count) == (twin.outcome, twin.impact_count)
    np.testing.assert_allclose(impact_times(run, -1.0), impact_times(twin, -1.0), rtol=0, atol=1e-9)
    np.testing.assert_allclose(state(run), state(twin), rtol=0, atol=1e-9)
    return run, twin


def scale_of(scene, response):
    """Return the energy [J] that an imbalance is measured against."""
    block = scene.block
    tipping = block.mass * GRAVITY * block.radius * (1 - math.cos(block.slenderness))
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
@pytest.mark.parametrize("scene", [FREE, SLIDING, CARRIED], ids=["rigid", "sliding", "on bearings"])
def test_a_constant_vertical_acceleration_is_another_gravity(scene, change):
    scene = scene.with_(start=Start(tilt=0.1), duration=3.0)
    still = SampledMotion(0.01, np.zeros(301))
    held = simulate(scene.with_(motion=replace(still, vertical=SampledMotion(0.01, np.full(301, change)))))
    other = simulate(scene.with_(motion=still, gravity=GRAVITY + change))
    assert held.outcome == other.outcome == "rocks"
    # the rate below which impacts are summed goes with the scene's own gravity
    times = [impact_times(response, 1e-6) for response in (held, other)]
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
    assert run.min_normal_ratio == pytest.approx(1 + up.samples.min() / GRAVITY, rel=1e-9)
    assert run.friction_demand == pytest.approx((0.2 * np.abs(up.samples) / (GRAVITY + up.samples)).max(), rel=1e-9)


def test_a_block_that_would_jump_is_said():
    scene = FREE.with_(motion=heaving(1.2 * GRAVITY, 9.0), start=Start(tilt=0.05))
    for run in (simulate(scene), simulate_twin(scene)):
        assert run.min_normal_ratio <= 0
        assert any(
            "the block would jump, and the outcome is outside the model" in warning.text for warning in run.warnings
        )
    assert not simulate(scene.with_(motion=heaving(0.2 * GRAVITY, 9.0))).warnings


def test_a_weight_that_vanishes_while_the_block_stands_lifts_it_once():
    # nothing pushes a base that slides freely: the threshold of uplift passes through 0 with the weight
    motions = [pulse("one-sine", 0.5, 3.0 + 0.01 * k, 1.5 * GRAVITY, 0.02 * k) for k in range(300)]
    outcomes = simulate_many([SLIDING.with_(motion=motion, duration=1.5) for motion in motions], workers=1)
    assert outcomes.lifted.all() and not outcomes.failed.any()


def test_bearings_that_carry_it_are_said():
    scene = SCENES["sine, on bearings"]
    level = scene.with_(motion=replace(scene.motion, vertical=None))
    for shaken, warned in ((scene, True), (level, False), (scene.with_(bearings=None), False)):
        assert (Caution("model", RIGID_BEARINGS) in simulate(shaken).warnings) == warned


def test_it_is_over_before_a_run_may_end():
    up = SampledMotion(0.01, np.repeat([0.0, 3.0], [700, 101]))
    run = simulate(Scene(block=STATUE, motion=replace(up.scaled(0), vertical=up), start=Start(tilt=0.05)))
    assert run.decided and run.end.time >= 8.0


@needs_records
@pytest.mark.parametrize("scene", [FREE, CARRIED], ids=["rigid", "on bearings"])
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
