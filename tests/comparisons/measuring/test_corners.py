"""Both corners of a block: kinematics against differences, impulses against what the exact motion is borne by."""

import dataclasses

import numpy as np
import pytest
from sampled_traces import SCENES

from analytic import simulate
from comparisons.measuring.autopsy import corner_impulses, corner_motion
from engines.checks import pivoting_centre
from engines.events import contact_measures
from engines.swings import Trace


def first_swing(name, step=1e-3):
    """(scene, trace with the centre) of the exact motion, before its first impact."""
    scene = SCENES[name]
    history = simulate(scene, output_step=step).history
    count = int(np.argmax(history.tilt < 0.0))
    trace = Trace(*(getattr(history, column)[:count] for column in Trace.COLUMNS), contact_tilt=1e-6)
    return scene, dataclasses.replace(trace, centre=pivoting_centre(scene, trace))


@pytest.mark.parametrize("name", ["rigid ground", "isolated"])
def test_the_pivot_stands_on_its_base_and_the_other_corner_moves_as_its_speeds_say(name):
    scene, trace = first_swing(name)
    told = corner_motion(scene, trace, 1.0)
    np.testing.assert_allclose([told[part][:, 1] for part in ("height", "sinking", "slip")], 0.0, atol=1e-12)
    lifted = 2 * scene.block.half_width * np.sin(trace.tilt)
    np.testing.assert_allclose(told["height"][:, 0], lifted, atol=1e-12)
    sunk = np.gradient(-lifted, trace.time)
    np.testing.assert_allclose(told["sinking"][2:-2, 0], sunk[2:-2], atol=2e-5)


@pytest.mark.parametrize("name", ["rigid ground", "sliding base", "isolated"])
def test_a_pivoting_block_is_borne_by_its_pivot_alone(name):
    scene, trace = first_swing(name)
    told, step = corner_impulses(scene, trace, 1.0), np.diff(trace.time)
    weight = scene.block.mass * scene.gravity * step
    assert np.abs(told["impulse"][:, 0] / weight).max() < 1e-5
    demand, normal, _ = contact_measures(scene, trace)
    found = np.abs(told["friction"]) / told["impulse"][:, 1]
    assert found.max() == pytest.approx(demand, rel=1e-2)
    assert (told["impulse"][:, 1] / weight).min() == pytest.approx(normal, rel=1e-2)
