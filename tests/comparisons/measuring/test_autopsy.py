"""The story of one contact: its impulses are the momentum's, its parts add up to the error of e."""

import dataclasses
import json

import numpy as np
import pytest
from engine_cases import released
from fixed_steps import fixed_steps
from sampled_traces import BASE, SCENES, sampled

from analytic.rocking import restitution
from comparisons.measuring.agreement import Unmeasurable
from comparisons.measuring.autopsy import PARTS, contact_of, frames
from engines import get_engine
from engines.checks import pivoting_centre
from engines.swings import Trace

GROUNDS = {"rigid ground": None, "sliding base": BASE}


def exact(name, mean_step=2e-3, **changes):
    scene = SCENES[name].with_(**changes)
    trace, _ = sampled(scene, mean_step)
    return scene, dataclasses.replace(trace, centre=pivoting_centre(scene, trace))


def run(engine, variant, scene, **settings):
    return contact_of(scene, get_engine(engine).traced(scene, variant=variant, history=False, **settings)[1])


@pytest.mark.parametrize("name", SCENES)
def test_exact_motion_has_no_part_wherever_the_steps_fall(name):
    """A step straddles each impact, by up to 5 ms: what it holds is told apart to a fiftieth of what it could be."""
    scene, trace = exact(name)
    for which in range(3):
        contact = contact_of(scene, trace, which)
        assert abs(contact.error) < 1e-8
        assert all(abs(contact.parts[part]) < 0.02 * contact.phase for part in (*PARTS, "shape")), contact.parts
        assert abs(contact.parts["flight"]) < 3e-4  # by the trapezoidal rule over the bearings' force


@pytest.mark.parametrize("name", ["rigid ground", "sliding base"])
def test_impulse_of_the_landing_corner_turns_the_fall_of_the_centre_into_a_rise(name):
    scene, trace = exact(name)
    contact = contact_of(scene, trace)
    # From b w downward to b e w upward.
    expected = scene.block.mass * scene.block.half_width * (1 + restitution(scene)) * abs(contact.before)
    bearing = scene.total_mass * 9.81 * np.diff(contact.time).max()
    window = slice(contact.first, contact.last)
    assert contact.impulse[window, 0].sum() == pytest.approx(expected, abs=2 * bearing)
    assert contact.strike.sum() == pytest.approx(1.0, abs=1e-12)
    assert contact.energy[contact.last] == pytest.approx(restitution(scene) ** 2, abs=2e-3)


@pytest.mark.parametrize("ground", GROUNDS)
@pytest.mark.parametrize(
    "engine, variant, settings",
    [
        ("exudyn", "compliant-corners", {"stiffness": 1e8}),
        ("mujoco", "impact-aware", {}),
        ("pymunk", "impact-aware", {}),
        ("dart", "impact-aware", {}),
    ],
)
def test_parts_add_up_to_the_error(ground, engine, variant, settings):
    contact = run(engine, variant, released(GROUNDS[ground]), **settings)
    parts = [contact.parts[name] for name in PARTS]
    # What is left is flight within the contact: a share of the parts, and of what gravity gains in a step.
    assert sum(parts) == pytest.approx(contact.error, abs=0.25 * max(map(abs, parts)) + 0.15 * contact.phase)


def test_a_sliding_corner_keeps_the_ratio_of_its_friction():
    contact = run("pymunk", "impact-aware", released(None).with_(friction=0.05))
    assert abs(contact.friction.sum() / contact.impulse.sum()) == pytest.approx(0.05, rel=0.05)


def test_frames_show_the_fall_the_step_that_is_struck_and_the_energy_that_is_lost():
    contact = contact_of(released(None), fixed_steps(released(None), 1e-4))
    told = json.loads(json.dumps(frames(contact), allow_nan=False))
    assert sorted(told) == ["energy", "penetration", "rebound", "straddle"]
    near, speed = told["straddle"], told["rebound"]["speed"]
    assert near["time"][0] < -2e-4 and near["time"][-1] > 2e-4 and near["landing"][0] > 0 and contact.deepest < 2e-5
    ends = [speed[0], speed[-1], told["energy"]["energy"][-1]]
    assert ends == pytest.approx([-1.0, 0.0, restitution(released(None)) ** 2], abs=2e-3)


def test_without_its_place_only_the_whole_is_told():
    scene = released(None)
    trace = fixed_steps(scene, 4e-3)
    seen, blind = contact_of(scene, trace), contact_of(scene, dataclasses.replace(trace, centre=None))
    assert seen.placed and not blind.placed and blind.error == seen.error
    assert list(blind.parts) == ["contact", "flight"]
    assert blind.parts["contact"] == pytest.approx(sum(seen.parts[name] for name in PARTS), rel=0.2)
    assert sorted(frames(blind)) == ["energy", "straddle"]


def test_what_cannot_be_told_is_said():
    """Of an impact that is not there, and of a block that turns in the air."""
    with pytest.raises(Unmeasurable, match=r"impact 99: the trace has \d+ between two swings"):
        contact_of(*exact("rigid ground"), 99)
    scene, time = SCENES["rigid ground"], np.linspace(0.0, 0.2, 201)
    rest, fall = np.zeros_like(time), 9.81 * time
    centre = np.column_stack([rest, 1.0 - 0.5 * fall * time, rest, -fall])
    trace = Trace(time, 0.05 - 0.5 * time, rest - 0.5, rest, rest, rest, 1e-3, centre=centre)
    with pytest.raises(Unmeasurable, match=r"no corner is struck while the tilt is below 0\.001"):
        contact_of(scene, trace)
