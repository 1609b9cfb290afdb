"""Velocities half a step early become those at the steps' ends, for any sequence of steps; how runs end."""

import numpy as np
import pytest

from analytic import Block, Scene, Start
from engines.leapfrog import failure_of, raw_trace_of, trace_of

SCENE = Scene(block=Block(mass=10.0, radius=1.0, slenderness=0.3), start=Start(tilt=0.2), duration=1.0)


def rows(seed=0, count=400):
    """The motion tilt = .2 + .1 t - t^2, x = .3 t^2 at random steps; the rates are those half a step before the row."""
    h = np.append(0.0, np.random.default_rng(seed).uniform(5e-4, 2e-3, count))
    t = np.cumsum(h)
    early, zeros = t - 0.5 * h, np.zeros_like(t)
    return np.column_stack([t, h, 0.2 + 0.1 * t - t**2, 0.1 - 2 * early, 0.3 * t**2, 0.6 * early, zeros, zeros])


def test_velocities_are_brought_to_the_displacements():
    trace, raw = trace_of(rows(), SCENE, 1e-9), raw_trace_of(rows(), SCENE, 1e-9)
    np.testing.assert_allclose(trace.tilt_rate, 0.1 - 2 * trace.time, atol=1e-12)
    np.testing.assert_allclose(trace.base_velocity, 0.6 * trace.time, atol=1e-12)
    assert np.abs(raw.tilt_rate - trace.tilt_rate)[1:].min() > 4e-4 and raw.first_script


def test_the_place_of_the_block_in_a_first_script_is_read_where_it_may_slide():
    place = np.random.default_rng(1).normal(size=(401, 4))
    table = np.column_stack([rows(), place])
    assert raw_trace_of(table, SCENE, 1e-9).centre is None
    np.testing.assert_array_equal(raw_trace_of(table, SCENE.with_(friction=0.3), 1e-9).centre, place)


def test_an_impact_is_not_smeared_over_the_steps_beside_it():
    table = rows()
    after = table[:, 2] < 0
    table[after, 3] *= 0.5  # a jump of the rate where the tilt changes side
    k, trace = int(np.argmax(after)), trace_of(table, SCENE, 1e-9)
    exact = 0.1 - 2 * trace.time
    assert trace.tilt_rate[k - 1] == pytest.approx(exact[k - 1], abs=1e-9)
    assert trace.tilt_rate[k] == pytest.approx(0.5 * exact[k], abs=1e-9)


@pytest.mark.parametrize("ended, words", [("not finite", "no longer finite"), ("too many steps", "too many steps")])
def test_the_failure_says_where_the_run_ended(ended, words):
    table = rows()
    failure = failure_of(SCENE, table, ended)
    assert words in failure.reason and f"{table[-1, 0]:.9g} s" in failure.message and "400" in failure.message
