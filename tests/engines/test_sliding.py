"""Engines with the friction that a scene gives: slip is a result, and as the model's."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from sliding_scenes import LANDS, LOST, PASSES, SAVED, SLIDES, scene_of

from analytic import Base, Bearings, Block, PulseMotion, Scene, simulate
from engines import comparison, get_engine
from engines.checks import LEAST_SLIP, energy_gain, pivoting_centre, slips
from engines.matching import STILL, impacts_of
from engines.swings import Trace

ENGINES = ("exudyn", "pybullet")


def flight_of(model):
    """(the first flight, the mode after it), each with its time."""
    modes = model.sliding.modes
    return next((one, after) for one, after in pairwise(modes) if one[1] == "flight")


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("scene", [SAVED, LOST, SLIDES], ids=["saved", "overturned", "slides"])
def test_a_block_that_slides_does_so_in_engines(engine, scene):
    model, run = simulate(scene), get_engine(engine).simulate(scene)
    assert (run.failure, run.outcome, run.differences) == (None, model.outcome, ())
    assert run.comparable in ("yes", "on an edge") and not [one for one in run.warnings if one.kind == "model"]
    assert run.sliding.peak == pytest.approx(model.sliding.peak, rel=1e-3)
    assert run.friction_demand <= scene.friction
    if model.outcome == "overturns":
        assert run.overturning_time == pytest.approx(model.overturning_time, abs=2e-3)
    else:
        assert run.peak_tilt == pytest.approx(model.peak_tilt, abs=1e-4)
        slip = np.interp(model.history.time, run.history.time, run.history.slip)
        np.testing.assert_allclose(slip, model.history.slip, atol=1e-3 * np.abs(model.history.slip).max())


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("scene", [LANDS, PASSES], ids=["lands", "passes the upright"])
def test_neither_a_landing_nor_a_passage_in_the_air_is_an_impact_that_differs(engine, scene):
    """The landing is one in the model only, and off the upright; in the air the tilt changes side without any."""
    model, run = simulate(scene, history=False), get_engine(engine).simulate(scene)
    begin, end = (one[0] for one in flight_of(model))
    assert (run.failure, run.outcome, run.differences, run.comparable) == (None, "rocks", (), "yes")
    assert [one.time for one in model.impacts if begin <= one.time <= end] == [end]
    assert not [one.time for one in run.impacts if begin <= one.time <= end]
    here, there = (impacts_of(one)[:5] for one in (run, model))
    assert np.allclose(here, there, rtol=1e-3) and len(impacts_of(model)) == len(model.impacts) - 1


def test_a_run_that_does_not_slip_where_the_model_does_differs():
    model = simulate(SAVED, history=False)
    still = replace(model.sliding, peak=0.0, end=0.0, path=0.0)
    run = replace(model, engine="any", sliding=still)
    (found,) = comparison.compare(SAVED, run).differences
    assert (found.quantity, found.here, found.model) == ("peak_slip", 0.0, model.sliding.peak)
    unread = comparison.compare(SAVED, replace(run, sliding=None))
    assert unread.differences == ()
    model = simulate(SLIDES, history=False)
    stands = replace(model, engine="any", outcome="stands", sliding=None)  # as a first script, which reads no place
    assert comparison.compare(SLIDES, stands).differences == ()
    (found, _) = comparison.compare(SLIDES, replace(stands, sliding=still)).differences
    assert (found.quantity, found.here, found.model) == ("outcome", "stands", "slides")


@pytest.mark.parametrize("engine", ["pybullet", "mujoco", "dart"])
def test_a_first_script_slides_too(engine):
    """As much as its step and its contact allow; the block's place is read from the engine."""
    model, run = simulate(SLIDES, history=False), get_engine(engine).simulate(SLIDES, variant="first-script")
    assert (run.failure, run.outcome) == (None, "slides")
    assert run.sliding.peak == pytest.approx(model.sliding.peak, rel=0.1)


def test_a_level_block_that_slides_gains_no_energy_while_its_tilt_changes_sign():
    """The tilt of one in soft contact does; what the ground does meanwhile counts, until the contact is settled."""
    scene = SLIDES.with_(motion=PulseMotion("half-sine", 8.0, 6.0), duration=0.52)
    seen = simulate(scene, output_step=1e-3).history
    still, speed = np.zeros_like(seen.time), np.gradient(seen.slip, seen.time)
    tilt = 1e-9 * np.where((seen.time > 0.02) & (seen.time < 0.5), (-1.0) ** np.arange(len(still)), 1.0)
    trace = Trace(seen.time, tilt, still, still, still, still, 1e-6, settle=5e-3)
    centre = pivoting_centre(scene, trace)
    centre[:, 0], centre[:, 2] = seen.slip, speed
    assert np.abs(speed[-1]) > 0.5 and energy_gain(scene, replace(trace, centre=centre)) < 1e-2


@pytest.mark.parametrize("engine, room", [("exudyn", 2e-2), ("pybullet", 1e-3)])
def test_an_impact_may_turn_the_energy_of_the_slip_into_rotation(engine, room):
    """The tilt rate rises by a third at it; which is no failure of an engine that does the same.

    The contact of exudyn lasts: with five times its stiffness the error is .6 of that.
    """
    pulse = PulseMotion("ricker", -12.025, 15.53, vertical=PulseMotion("ricker", 8.017, 15.53))
    scene = scene_of(0.571, 0.21366, 0.22704, base=2.213, motion=pulse).with_(
        block={"mass": 3.0487}, bearings={"ka": 594.84, "kb": 242.085, "alpha": 308.23}
    )
    (model,) = simulate(scene, history=False).impacts
    run = get_engine(engine).simulate(scene)
    assert run.failure is None and model.rate_after > 1.2 * model.rate_before
    assert run.impacts[0].rate_after == pytest.approx(model.rate_after, rel=room)


@pytest.mark.slow
def test_what_mujoco_is_said_to_get_wrong_it_gets_wrong():
    """A block with friction .2 and tan(gamma) .2027 can only slide; and the impact of `LOST`, into which it slides."""
    engine, low = get_engine("mujoco"), scene_of(0.2, 0.2, motion=PulseMotion("rectangular", 4.0, 6.0))
    (model,), (seen,) = (run(LOST, history=False).impacts for run in (simulate, engine.simulate))
    assert model.rate_after < 0.9 * model.rate_before and seen.rate_after > 0.99 * seen.rate_before
    for variant in ("impact-aware", "fixed-step"):
        assert engine.simulate(low, variant=variant).outcome == "overturns" != simulate(low, history=False).outcome
        assert engine.variants[variant].faults


@pytest.mark.slow
@pytest.mark.parametrize("step", [1e-3, 5e-4])
def test_the_corner_under_a_rocking_block_creeps_in_bullet_as_is_said(step):
    """By half the step times the integral of n phi'^2, which is no slip: less than `LEAST_SLIP`."""
    scene = scene_of(5.0, 0.3, start={"tilt": 0.21}, duration=0.9)
    engine = get_engine("pybullet")
    run, trace = engine.traced(scene, largest_step=step)
    turning = scene.block.radius * np.sin(np.sign(trace.tilt) * 0.3 - trace.tilt) * trace.tilt_rate**2
    creep = np.cumsum(np.diff(trace.time) ** 2 * (turning[1:] + turning[:-1])) / 4
    seen = slips(scene, trace)
    assert len(run.impacts) == 1 and "creeps" in engine.variants["impact-aware"].faults
    assert -seen[1:] == pytest.approx(creep, abs=1e-2 * np.abs(creep).max())
    assert 4e-3 * step < np.abs(seen).max() / scene.block.radius < 2e-2 * step < LEAST_SLIP


@pytest.mark.slow
def test_what_exudyn_is_said_to_get_wrong_it_gets_wrong():
    """An impact into which the block slides, and the slip after it; the next one, after which it sticks, is right."""
    engine, up = get_engine("exudyn"), PulseMotion("one-cosine", 7.4, 14.2)
    scene = scene_of(0.69, 0.3066, 1.51, motion=PulseMotion("one-cosine", 8.13, 14.2, vertical=up), duration=1.0)
    model, run = simulate(scene, history=False), engine.simulate(scene)
    wrong, right = (
        abs(a.rate_after / a.rate_before - b.rate_after / b.rate_before)
        for a, b in zip(run.impacts, model.impacts, strict=True)
    )
    assert 0.005 < wrong < 0.015 and right < 1e-3
    assert 0.5e-4 < abs(run.sliding.peak - model.sliding.peak) / scene.block.radius < 2.5e-4
    assert "slides" in engine.variants[engine.default_variant].faults and run.comparable == "yes"


LIGHT = Scene(  # on a light base, whose acceleration the friction decides
    block=Block(mass=1500.0, radius=1.0, slenderness=0.28),
    base=Base(mass=300.0),
    bearings=Bearings(law="linear", ka=4.0e3, count=4),
    motion=PulseMotion("one-cosine", 6.0, 5.0),
    friction=0.3,
    duration=1.2,
)
MOVING = {
    "slides": LIGHT.with_(block={"slenderness": 0.4}, motion=PulseMotion("one-sine", 6.0, 8.0)),
    "slides and rocks": LIGHT,
    "flies": scene_of(
        0.5, 0.3, motion=PulseMotion("one-sine", 4.0, 12.0, vertical=PulseMotion("one-sine", 16.0, 12.0)), duration=1.0
    ),
}


@pytest.mark.parametrize("engine", ["exudyn", "pybullet"])
@pytest.mark.parametrize("name", MOVING)
def test_forces_and_base_acceleration_are_those_of_a_block_that_moves_on_its_base(engine, name):
    """By the equations of a block that sticks they were up to three times off."""
    scene = MOVING[name]
    model, run = simulate(scene, history=False), get_engine(engine).simulate(scene, history=False)
    assert model.outcome == run.outcome and model.sliding.peak > 0
    assert run.peak_base_acceleration == pytest.approx(model.peak_base_acceleration, rel=2e-3)
    assert run.min_normal_ratio == pytest.approx(model.min_normal_ratio, abs=5e-3)
    assert run.friction_demand == pytest.approx(scene.friction, rel=1e-9)


def test_a_contact_that_yields_lifts_no_block():
    """A peak tilt of 2e-6 of the slenderness is no rocking, in the run as in the comparison."""
    scene = scene_of(0.2, 0.28, motion=PulseMotion("one-sine", 6.0, 8.0))
    run = get_engine("exudyn").simulate(scene, history=False)
    assert 0 < run.peak_tilt_ratio < STILL and run.outcome == "slides" and not run.differences


@pytest.mark.parametrize("engine", ["exudyn", "pybullet"])
def test_with_a_given_restitution_and_a_smaller_friction_nothing_is_compared(engine):
    scene = SLIDES.with_(block={"restitution": 0.7})
    run = get_engine(engine).simulate(scene, history=False)
    assert run.comparable.startswith("the contact's friction is ") and "not the scene's 0.2" in run.comparable
    assert not run.differences
