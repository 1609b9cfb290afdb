"""A given restitution in contact engines: the couple before each landing, against eqs (7) and (8) and the model."""

import numpy as np
import pytest

from analytic import load_scene, simulate
from analytic.errors import SceneError
from analytic.rocking import RockingModel, momentum_restitution
from engines import get_engine
from engines.couple import Couple

# rms of e/given - 1 over impacts faster than .06 of the fastest
BOUNDS = {"pybullet": 1.2e-3, "mujoco": 1.2e-3, "exudyn": 2e-3}


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


def test_a_restitution_far_below_that_of_momentum_is_refused():
    with pytest.raises(SceneError, match="0.1 times"):
        Couple.of(load_scene("free-rocking-rigid").with_(block={"restitution": 0.05}), 1e-4)


@pytest.mark.parametrize("kept", [0.9, 0.95])
@pytest.mark.parametrize("ground", ["rigid", "isolated"])
@pytest.mark.parametrize("engine", BOUNDS)
def test_impacts_have_the_given_restitution(engine, ground, kept):
    pytest.importorskip(engine)
    scene = released(ground, 0.2, kept)
    found, model = get_engine(engine).simulate(scene), RockingModel.of(scene)
    before = np.array([impact.rate_before for impact in found.impacts])
    after = np.array([impact.rate_after for impact in found.impacts])
    fast = np.abs(before) > 0.06 * np.abs(before).max()
    assert fast.sum() > 8
    error = (after / before)[fast] / scene.block.restitution - 1
    assert np.sqrt((error**2).mean()) < BOUNDS[engine]
    if ground == "isolated":  # (8): the base takes the momentum, of the couple, too
        jumps = np.array([impact.base_velocity_jump for impact in found.impacts])[fast]
        wanted = (model.jump_arm * (before - after))[fast]
        assert np.sqrt(((jumps - wanted) ** 2).mean()) < 1e-3 * np.abs(wanted).max()
    assert found.outcome == simulate(scene).outcome == "rocks"


@pytest.mark.parametrize("engine", BOUNDS)
def test_a_pulse_with_a_given_restitution_follows_the_model(engine):
    pytest.importorskip(engine)
    scene = load_scene("caryatid-isolated").with_(duration=6.0)
    scene = scene.with_(block={"slenderness": 0.12, "restitution": 0.93 * momentum_restitution(scene)})
    found, model = get_engine(engine).simulate(scene), simulate(scene)
    assert found.outcome == model.outcome
    assert found.peak_tilt == pytest.approx(model.peak_tilt, rel=2e-3)
    assert found.peak_base_displacement == pytest.approx(model.peak_base_displacement, rel=2e-3)
