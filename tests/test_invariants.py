"""What holds in every scene, whoever solves it: energy, mirror, similarity, accuracy, unused friction."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from bearing_laws import NAMES, bearings_of
from engine_cases import ACCURATE
from hypothesis import HealthCheck, Phase, assume, given, settings
from hypothesis import strategies as st

from analytic import Base, Block, PulseMotion, Scene, simulate
from analytic.checks.twin import simulate_twin
from engines import get_engine

GRAVITY = 9.81
EXAMPLES = {"kernel": 60, "march": 30, "twin": 8}  # of an engine 4
# Largest difference of two runs that should be the same: of tilts, over the slenderness, of displacements over the
# half width, of rates over these times the frequency. Of the twin as its tolerance.
BOUND = {"kernel": 1e-8, "march": 1e-6, "twin": 1e-6}
ENGINE_BOUND = 1e-2
# Two runs are told apart only where the model's own answer moves less than this as the motion grows by 1e-6.
STEADY = 1e-4

SIMILAR = ("linear", "bilinear")  # laws without a length of their own

SOLVERS = ("kernel", "march", "twin", *ACCURATE)
# DART slips where the demand is 0.83 of the friction: its comparison says so. What does not slip is not marched:
# sliding/test_run compares the march itself with the kernel.
HOLDS_BY_FRICTION = [name for name in SOLVERS if name not in ("dart", "march")]


def solve(solver, scene):
    if solver in ACCURATE:
        return get_engine(solver).simulate(scene)
    return simulate_twin(scene) if solver == "twin" else simulate(scene)


def bound(solver):
    return BOUND.get(solver, ENGINE_BOUND)


@st.composite
def scenes(draw, solver, laws=NAMES):
    """A statue at rest under a pulse that lifts it, on the ground or on bearings; for the march one that may slide."""
    radius, slenderness = draw(st.floats(0.3, 3.0)), draw(st.floats(0.12, 0.4))
    omega = math.sqrt(0.75 * GRAVITY / radius)
    shape = draw(st.sampled_from(["one-sine", "one-cosine", "half-sine"]))
    amplitude = GRAVITY * math.tan(slenderness) * draw(st.floats(1.05, 2.5)) * draw(st.sampled_from([-1.0, 1.0]))
    motion = PulseMotion(shape, amplitude, omega * draw(st.floats(1.5, 5.0)))
    scene = Scene(
        block=Block(mass=1000.0, radius=radius, slenderness=slenderness),
        motion=motion,
        duration=motion.end + 2.5 / omega,
        friction=draw(st.floats(0.1, 0.9)) if solver == "march" else None,
    )
    if draw(st.booleans()):
        carried, law = 1000.0 * draw(st.floats(1.2, 2.0)), draw(st.sampled_from(laws))
        stiff = carried * (2 * math.pi / draw(st.floats(0.5, 3.0))) ** 2 / 4
        keys = {"ka": 8 * stiff, "kb": stiff, "count": 4, "damping": draw(st.sampled_from([0.0, 100.0]))}
        scene = scene.with_(base=Base(mass=carried - 1000.0), bearings=bearings_of(law, **keys))
    return scene


def numbers(scene, response):
    """What is compared, without units: peaks and the end."""
    omega, end = scene.rocking_frequency, response.end
    width = scene.block.radius * math.sin(scene.block.slenderness)
    tilts = np.array([response.peak_tilt, end.tilt, end.tilt_rate / omega]) / scene.block.slenderness
    moved = np.array([response.peak_base_displacement, end.base_displacement, end.base_velocity / omega]) / width
    return np.concatenate([tilts, moved])


def assert_same(solver, scene, response, other, its_scene=None, sign=1.0):
    """The same outcome and the same numbers, those with a sign times `sign`."""
    assert response.outcome == other.outcome
    signs = np.array([1.0, sign, sign, 1.0, sign, sign])
    found, expected = numbers(scene, response), signs * numbers(its_scene or scene, other)
    if solver in ACCURATE:  # an impact a moment later has another rate at the end
        found, expected = found[[0, 1, 3, 4]], expected[[0, 1, 3, 4]]
    np.testing.assert_allclose(found, expected, rtol=bound(solver), atol=bound(solver))


@cache
def is_steady(scene):
    """Whether the block comes back, and the model's answer is no matter of the last digit."""
    one, other = (simulate(scene.with_(motion=scene.motion.scaled(factor))) for factor in (1.0, 1 + 1e-6))
    comes_back = one.outcome == other.outcome != "failed" and one.peak_tilt < scene.block.slenderness
    return comes_back and np.abs(numbers(scene, one) - numbers(scene, other)).max() < STEADY


def each_scene(solvers=SOLVERS, **options):
    """Decorator: a test of (solver, scene) for every solver, on scenes of it."""

    def made(test):
        @pytest.mark.parametrize("solver", solvers)
        def run(solver):
            examples = settings(
                max_examples=EXAMPLES.get(solver, 4),
                deadline=None,
                # an engine's scene is listed, not drawn
                derandomize=solver in ACCURATE or settings.default.derandomize,
                phases=[Phase.explicit, Phase.reuse, Phase.generate],  # an engine would shrink for minutes
                suppress_health_check=[HealthCheck.filter_too_much, HealthCheck.too_slow],
            )

            @examples
            @given(scenes(solver, **options))
            def checked(scene):
                assume(is_steady(scene))
                test(solver, scene)

            checked()

        run.__name__ = test.__name__
        return run

    return made


@each_scene()
def test_energy_neither_comes_from_nothing_nor_is_lost_on_the_way(solver, scene):
    response = solve(solver, scene)
    if response.energy:
        ledger = response.energy
        parts = (ledger.kinetic, ledger.potential, ledger.input, ledger.hysteretic, ledger.impact_loss, ledger.friction)
        assert abs(ledger.imbalance) < 1e-6 * max(map(abs, parts))
    if scene.base is None and not scene.friction:
        block, free = scene.block, response.history.time > scene.motion.end
        tilt, rate = (np.abs(getattr(response.history, name)[free]) for name in ("tilt", "tilt_rate"))
        height = block.radius * (np.cos(block.slenderness - tilt) - math.cos(block.slenderness))
        energy = 0.5 * block.inertia * rate**2 + block.mass * GRAVITY * height
        tip = block.mass * GRAVITY * block.radius * (1 - math.cos(block.slenderness))
        assert (energy - np.minimum.accumulate(energy)).max(initial=0.0) < max(bound(solver), 1e-6) * tip


@each_scene()
def test_a_mirrored_scene_is_mirrored(solver, scene):
    mirrored = solve(solver, scene.with_(motion=scene.motion.scaled(-1.0)))
    assert_same(solver, scene, solve(solver, scene), mirrored, sign=-1.0)


@each_scene(laws=SIMILAR)
def test_a_scene_twice_as_large_and_three_times_as_heavy_does_the_same_more_slowly(solver, scene):
    slower = math.sqrt(2.0)
    block = {"mass": 3 * scene.block.mass, "radius": 2 * scene.block.radius}
    motion = replace(scene.motion, frequency=scene.motion.frequency / slower)
    large = scene.with_(block=block, motion=motion, duration=slower * scene.duration)
    if scene.base:
        old = scene.bearings.model_dump(exclude_none=True)
        powers = {"ka": 3 / 2, "kb": 3 / 2, "damping": 3 / slower, "yield_force": 3.0}
        bearings = old | {name: factor * old[name] for name, factor in powers.items() if name in old}
        large = large.with_(base=Base(mass=3 * scene.base.mass), bearings=bearings)
    assert_same(solver, scene, solve(solver, scene), solve(solver, large), its_scene=large)


@each_scene()
def test_the_answer_is_the_models_at_a_hundredth_of_its_tolerance(solver, scene):
    assert_same(solver, scene, solve(solver, scene), simulate(scene, tolerance=1e-13))


@each_scene(HOLDS_BY_FRICTION)
def test_a_friction_above_the_demand_is_none(solver, scene):
    demand = simulate(scene, history=False).friction_demand
    assume(demand < 3.0)
    assert_same(solver, scene, solve(solver, scene), solve(solver, scene.with_(friction=1.05 * demand)))
