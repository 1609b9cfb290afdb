"""A given restitution in contact engines: the couple before each landing, against eqs (7) and (8) and the model."""

import math

import numpy as np
import pytest

from analytic import PulseMotion, load_scene, simulate
from analytic.errors import SceneError
from analytic.rocking import RockingModel, momentum_restitution
from engines import ENGINES, get_engine
from engines.couple import ALONE, Couple, holding
from engines.scripting import write_script

# rms of e/given - 1 over impacts faster than .06 of the fastest; wide: at the ends of the range exudyn's corners swing,
# most on a light base at f = .8
BOUNDS = {"pybullet": 1.2e-3, "mujoco": 1.2e-3, "exudyn": 2e-3}
WIDE = {**BOUNDS, "exudyn": 5e-3}
# {(ground, slenderness, share of e that is kept): pulse over omega_r, amplitude over g tan(slenderness) from which the
# model overturns}
BOUNDARIES = {("rigid", 0.2, 0.8): (3.0, 1.4954777), ("isolated", 0.2, 0.8): (3.0, 2.2679915)}
every_engine = pytest.mark.parametrize("engine", BOUNDS)


def released(ground, slenderness, kept):
    scene = load_scene(f"free-rocking-{ground}")
    scene = scene.with_(block={"slenderness": slenderness, "restitution": None}, start={"tilt": 0.6 * slenderness})
    return scene.with_(block={"restitution": kept * momentum_restitution(scene)})


@pytest.mark.parametrize("kept", [0.8, 0.95, 1.02])
def test_a_flight_without_pull_keeps_the_share_at_any_step(kept):
    """Steps of any length: the rate at the ground is the share of that before it."""
    for steps in (2e-7, 1e-6, 7e-6):
        couple, tilt, rate = Couple(kept, 3.0, 1e-4), 1e-3, -0.7
        while tilt > 0:
            rate += couple.moment(steps, tilt, rate) * steps / couple.inertia
            tilt += rate * steps
        assert rate == pytest.approx(-0.7 * kept, rel=1e-9)


def test_a_scene_without_a_restitution_has_no_couple():
    assert Couple.of(load_scene("free-rocking-rigid").with_(block={"restitution": None}), 1e-4) is None


@every_engine
@pytest.mark.parametrize("kept, why", [(1 + 1e-6, "above"), (0.09, "below")])
def test_what_a_couple_does_not_reach_is_refused_by_engine_and_script_alike(engine, kept, why):
    scene = released("isolated", 0.2, kept)
    given, own = scene.block.restitution, momentum_restitution(scene)
    words = f"block.restitution = {given!r}: {why} what a couple .*, 0.1 to 1 times the {own:.6g} of eq.*{ALONE}"
    for run in (get_engine(engine).simulate, lambda scene: write_script(ENGINES["exudyn"], scene)):
        with pytest.raises(SceneError, match=words):
            run(scene)
    assert simulate(scene).outcome == "rocks"  # the model takes any


@pytest.mark.parametrize("kept, remedy", [(0.9, f"use the variant impact-aware, {ALONE}"), (1.01, ALONE)])
def test_a_variant_that_takes_none_names_one_that_does_where_there_is_one(kept, remedy):
    with pytest.raises(SceneError) as caught:
        get_engine("pybullet").simulate(released("rigid", 0.2, kept), variant="fixed-step")
    assert str(caught.value).endswith(f"the impact itself; leave it out, {remedy}")


@every_engine
@pytest.mark.parametrize(
    "ground, slenderness, kept, bounds, jump, least",
    [(ground, 0.2, kept, BOUNDS, 1e-3, 8) for ground, kept in (("rigid", 0.9), ("isolated", 0.9), ("isolated", 0.95))]
    + [
        ("rigid", 0.1, 0.8, WIDE, 2e-3, 2),
        ("isolated", 0.4, 0.8, WIDE, 2e-3, 2),
        ("isolated", 0.1, 1.0, WIDE, 2e-3, 2),
    ],
)
def test_impacts_have_the_given_restitution(engine, ground, slenderness, kept, bounds, jump, least):
    check_impacts(engine, released(ground, slenderness, kept), bounds[engine], jump, least)


@every_engine
def test_the_pivot_holds_whatever_friction_the_scene_gives(engine):
    """With the scene's own, .7 being what the model needs, the couple would make it slip: e was off by up to .3."""
    scene = released("rigid", 0.2, 0.8)
    check_impacts(engine, scene.with_(friction=0.72), BOUNDS[engine], least=7)
    assert holding(scene) is scene and holding(scene.with_(friction=6.0)).friction == 6.0
    assert holding(scene.with_(friction=0.6)).friction == pytest.approx(1 / math.tan(0.2))
    assert holding(scene.with_(friction=0.6, block={"restitution": None})).friction == 0.6
    isolated = released("isolated", 0.2, 0.8).with_(friction=0.6)
    assert holding(isolated) is isolated  # the base follows
    found = get_engine(engine).simulate(scene.with_(friction=0.6, duration=0.1))
    assert "the contact's friction is 4.93" in found.warnings[-1].text


def check_impacts(engine, scene, bound, jump=1e-3, least=8):
    """jump: bound of the rms error of the base velocity's jump, over the largest; least: so many impacts are more."""
    ground = "isolated" if scene.base else "rigid"
    found, model = get_engine(engine).simulate(scene), RockingModel.of(scene)
    before = np.array([impact.rate_before for impact in found.impacts])
    after = np.array([impact.rate_after for impact in found.impacts])
    fast = np.abs(before) > 0.06 * np.abs(before).max()
    assert fast.sum() > least
    error = (after / before)[fast] / scene.block.restitution - 1
    assert np.sqrt((error**2).mean()) < bound
    if ground == "isolated":  # (8): the base takes the momentum, of the couple, too
        jumps = np.array([impact.base_velocity_jump for impact in found.impacts])[fast]
        wanted = (model.jump_arm * (before - after))[fast]
        assert np.sqrt(((jumps - wanted) ** 2).mean()) < jump * np.abs(wanted).max()
    assert found.outcome == simulate(scene).outcome == "rocks"
    (said,) = [one for one in found.warnings if one.quantity == "restitution"]
    assert str(said).startswith(f"restitution given, {scene.block.restitution:.4g}")


@every_engine
@pytest.mark.parametrize("place", BOUNDARIES)
def test_a_pulse_overturns_from_the_amplitude_of_the_model_on(engine, place):
    """Within .1 %; f moves it by 2 to 6 %."""
    ratio, boundary = BOUNDARIES[place]
    scene = released(*place).with_(start={"tilt": 0.0}, duration=None)

    def outcome(simulate, share):
        amplitude = boundary * share * scene.gravity * math.tan(scene.block.slenderness)
        pulse = PulseMotion("one-sine", amplitude, ratio * scene.rocking_frequency)
        return simulate(scene.with_(motion=pulse), history=False).outcome

    assert [outcome(simulate, share) for share in (1 - 1e-6, 1 + 1e-6)] == ["rocks", "overturns"]
    assert [outcome(get_engine(engine).simulate, share) for share in (0.999, 1.001)] == ["rocks", "overturns"]


@every_engine
def test_a_pulse_with_a_given_restitution_follows_the_model(engine):
    scene = load_scene("caryatid-isolated").with_(duration=6.0)
    scene = scene.with_(block={"slenderness": 0.12, "restitution": 0.93 * momentum_restitution(scene)})
    found, model = get_engine(engine).simulate(scene), simulate(scene)
    assert found.outcome == model.outcome
    assert found.peak_tilt == pytest.approx(model.peak_tilt, rel=2e-3)
    assert found.peak_base_displacement == pytest.approx(model.peak_base_displacement, rel=2e-3)
