"""Horizons of motions whose sensitivity is known: none for a pendulum-like one, short for a chaotic one."""

import dataclasses

import numpy as np
import pytest
from literature import ONE_SINE, under_a_pulse
from sliding_scenes import LOST

from analytic import Block, PulseMotion, SampledMotion, Scene, Start, simulate
from analytic.rocking import restitution
from comparisons.execution.command_runs import unsure_outcome
from comparisons.execution.plan import drive
from comparisons.metrics.boundaries import Edge, edges, least_normal, locate, pulse
from comparisons.metrics.errors import (
    LADDER,
    LEAST,
    SPREAD,
    perturbation_of,
    restitution_error,
    sensitivity_horizon,
    solver_horizon,
)
from engines import get_engine

BLOCK = Block(mass=3172.05, radius=1.0884, slenderness=0.2)


def long_shaking(slenderness=0.2, seed=3):
    noise = np.random.default_rng(seed).standard_normal(2000)
    return Scene(
        block=BLOCK.model_copy(update={"slenderness": slenderness}),
        duration=20.0,
        motion=SampledMotion(0.01, 2.5 * np.sin(5 * 0.01 * np.arange(2000)) + 0.6 * noise),
    )


@pytest.fixture(scope="module")
def shaken():
    """A scene that parts early, and the model's response."""
    return long_shaking(), simulate(long_shaking(), output_step=2e-3)


def test_free_rocking_is_never_parted():
    scene = Scene(block=BLOCK, start=Start(tilt=0.1), duration=10.0)
    horizon = sensitivity_horizon(scene)
    assert horizon.horizon == 10.0 and not horizon.parts
    assert 0 < horizon.spread[-1] < SPREAD and (np.diff(horizon.spread) >= 0).all()


@pytest.mark.parametrize("short, sizes", [(1e-8, {1e-6, 1e-4}), (1e-5, {1e-4}), (1e-3, set())])
def test_an_outcome_that_a_small_change_turns_is_said(short, sizes):
    """Let go just short of balance, where a block on rigid ground begins to fall outward."""
    scene = Scene(block=BLOCK, start=Start(tilt=BLOCK.slenderness * (1 - short)))
    warnings = {size: unsure_outcome(scene, "rocks", size) for size in (1e-6, 1e-4)}
    assert {size for size, warning in warnings.items() if warning} == sizes
    for size in sizes:
        assert (warnings[size].kind, warnings[size].quantity, warnings[size].value) == ("model", "outcome", size)
        assert (
            "with start up by" in warnings[size].text and "the block overturns, without it rocks" in warnings[size].text
        )


def test_an_independent_copy_parts_where_it_is_said_and_the_horizon_is_that_of_the_first_one(shaken):
    scene, _ = shaken
    horizon = sensitivity_horizon(scene)
    plain, changed = (
        simulate(scene.with_(motion=scene.motion.scaled(by)), output_step=1e-3).history for by in (1, 1.0001)
    )
    apart = np.abs(np.interp(plain.time, changed.time, changed.tilt) - plain.tilt) / 0.2
    assert horizon.copies["motion up"] == pytest.approx(plain.time[apart > SPREAD][0], abs=0.01)
    first = np.flatnonzero(horizon.spread > SPREAD)[0]
    assert horizon.time[first - 1] == horizon.horizon == min(t for t in horizon.copies.values() if t is not None)
    assert horizon.parts and horizon.horizon < scene.duration
    # of the start, which is at rest, there is none
    assert set(horizon.copies) == {"restitution up", "restitution down", "motion up", "motion down"}


def solver(scene, size):
    """A solver whose restitution is off by `size`: the model's response of another scene."""
    return simulate(scene.with_(block={"restitution": restitution(scene) * (1 + size)}), output_step=2e-3)


@pytest.mark.parametrize("size", [1e-5, 1e-4, 1e-3, -1e-3, 1e-2])
def test_the_perturbation_of_a_solver_is_the_error_it_was_given(shaken, size):
    scene, reference = shaken
    result = perturbation_of(scene, solver(scene, size), reference)
    assert abs(size) * 0.99 <= result <= LADDER * abs(size)


def test_a_perfect_solver_has_the_least_perturbation_and_the_longest_horizon(shaken):
    scene, reference = shaken
    perfect, good, poor = (solver_horizon(scene, solver(scene, size), reference) for size in (0.0, 1e-4, 1e-2))
    assert perfect.perturbation == perturbation_of(scene, reference, reference) == LEAST
    assert scene.duration > perfect.horizon > good.horizon > poor.horizon > 0


def test_errors_that_are_none_of_restitution_are_measured_by_what_they_move(shaken):
    """The motion off by 1e-3: every impact is right, the tilt is not."""
    scene, reference = shaken
    response = simulate(scene.with_(motion=scene.motion.scaled(1.001)), output_step=2e-3)
    assert restitution_error(scene, response) < 1e-9
    assert 1e-4 < perturbation_of(scene, response, reference) < 1e-2


def test_restitution_errors_are_weighted_by_the_rate():
    scene = Scene(block=BLOCK, start=Start(tilt=0.1), duration=10.0)
    response, e = simulate(scene), restitution(scene)
    first = response.impacts[0]
    impacts = [
        dataclasses.replace(first, rate_before=rate, rate_after=rate * e * off) for rate, off in ((1, 1.01), (0.1, 1.5))
    ]
    rms = restitution_error(scene, dataclasses.replace(response, impacts=impacts))
    assert rms == pytest.approx(np.sqrt((0.01**2 + 0.05**2) / 1.01), rel=1e-6)
    assert restitution_error(scene, dataclasses.replace(response, impacts=())) == 0.0


def test_errors_of_a_block_that_slides_are_those_against_its_own_impacts():
    """Its restitution is not that of (7): by that the model itself would be off."""
    model = simulate(LOST)
    assert restitution_error(LOST, model) > 0.1
    assert perturbation_of(LOST, model, model) == LEAST
    off = [dataclasses.replace(impact, rate_after=1.01 * impact.rate_after) for impact in model.impacts]
    assert perturbation_of(LOST, dataclasses.replace(model, impacts=tuple(off)), model) == pytest.approx(0.01)


@pytest.mark.parametrize("engine", ["exudyn", "pybullet", "mujoco", "pymunk", "dart", "drake"])
@pytest.mark.parametrize("seed", [3, 4])
def test_no_engine_parts_before_its_own_horizon(engine, seed):
    """Small rocking under long shaking, where exudyn's corners were off before the horizon of 1e-4."""
    scene = long_shaking(0.15, seed).with_(duration=12.0)
    reference, response = simulate(scene, output_step=2e-3), get_engine(engine).simulate(scene)
    own_horizon = solver_horizon(scene, response, reference)
    end = min(own_horizon.horizon, reference.unstable_time or np.inf, response.history.time[-1])
    time = reference.history.time[reference.history.time < end]
    apart = np.interp(time, response.history.time, response.history.tilt) - reference.history.tilt[: len(time)]
    # By the spread: 1.2 for the sampling of the copies, whose tilt changes fast at an impact.
    assert np.abs(apart).max() / scene.block.slenderness < 1.2 * SPREAD, (own_horizon.horizon, own_horizon.perturbation)


# Overturning boundaries of the analytic model, and a search beside one of them.


# the block of the published boundaries
SCENE = under_a_pulse(1.0, 1.0).with_(motion=None, duration=None)
EDGE = Edge("rigid ground", "one-sine", 4.0, 5.0, True, 0, 4.9, 6.0, 0.1)


def test_edges_are_the_published_boundaries_and_the_safe_gap():
    model_edges = edges(SCENE, "rigid", "one-sine", (2.0, 4.0, 8.0))
    for frequency in (2.0, 4.0, 8.0):
        column, amplitudes = [edge for edge in model_edges if edge.frequency == frequency], ONE_SINE[frequency]
        # published over g gamma, here over g tan(gamma)
        mine = [edge.amplitude * np.tan(0.25) / 0.25 for edge in column]
        assert mine == pytest.approx(amplitudes, rel=2e-5)
        assert [(edge.rises, edge.mode) for edge in column] == [(True, 1), (False, 1), (True, 0)][-len(amplitudes) :]
        for edge, next_edge in zip(column, column[1:], strict=False):
            assert edge.high == next_edge.low == pytest.approx(np.sqrt(edge.amplitude * next_edge.amplitude))
    for edge in model_edges:
        beside = [pulse(SCENE, edge.shape, edge.frequency, edge.amplitude * side) for side in (1 - 1e-4, 1 + 1e-4)]
        runs = [simulate(SCENE.with_(motion=motion)) for motion in beside]
        assert [run.outcome == "overturns" for run in runs] == [not edge.rises, edge.rises]
        assert all(run.decided for run in runs)
    assert edges(SCENE, "rigid", "one-cosine", (8.0,)) == []  # where none overturns
    assert least_normal(SCENE, PulseMotion("one-sine", 0.1, 5.0)) == 1.0


def search(edge, outcome, distances=((2e-4, 1.2e-2), (0.1,)), tolerance=2e-5):
    (result,) = drive([locate(edge, distances, tolerance)], lambda batch: [outcome(a) for _, a in batch])
    return result


@pytest.mark.parametrize("shift", [0.0, 3e-5, -1e-4, 4e-3, -0.015, 0.08])
def test_a_shifted_boundary_is_found_to_its_tolerance(shift):
    for edge in (EDGE, dataclasses.replace(EDGE, rises=False)):
        located = search(edge, lambda amplitude, rises=edge.rises: (amplitude > 5.0 * (1 + shift)) == rises)
        assert located.half_width <= 1e-5 and abs(located.shift - shift) <= located.half_width * (1 + 1e-9)


@pytest.mark.parametrize(
    "outcome, reason",
    [
        (lambda amplitude: True, "overturns on both sides"),
        (lambda amplitude: False, "stands on both sides"),
        (lambda amplitude: None, "no run was decided"),
        (lambda amplitude: bool(amplitude < 5.0), "outcomes the other way round"),
        # too wide a bracket to tell
        (
            lambda amplitude: None if abs(amplitude / 5.0 - 1) < 0.011 else amplitude > 5.0,
            "undecided between -1.2 and +1.2 %",
        ),
    ],
)
def test_a_boundary_that_is_not_there_is_said_to_be_missing(outcome, reason):
    located = search(EDGE, outcome)
    assert located.shift is None and located.half_width is None and located.reason.startswith(reason)


def test_the_search_stays_on_its_side_of_the_middle_between_two_boundaries():
    questions = []
    search(EDGE, lambda amplitude: questions.append(amplitude) or False)
    assert 4.9 < min(questions) and max(questions) < 6.0
    assert min(questions) == pytest.approx(5.0 - 0.9 * 0.1)
    assert search(EDGE, lambda amplitude: bool(amplitude > 5.0)).runs <= 4 + 7


def test_an_undecided_run_widens_the_bracket_instead_of_taking_a_side():
    located = search(EDGE, lambda amplitude: None if abs(amplitude / 5.0 - 1) < 1e-4 else bool(amplitude > 5.0))
    assert abs(located.shift) <= located.half_width and 1e-4 <= located.half_width <= 2e-4
