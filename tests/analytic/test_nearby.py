"""What little of the motion decides, against closed forms and single runs."""

import math
from dataclasses import replace

import numpy as np
import pytest

from analytic import Block, PulseMotion, Scene, SceneError, load_scene, simulate, synthetic_motion
from analytic.nearby import cliffs, nearby

G, GAMMA = 9.81, 0.25
UPLIFT = G * math.tan(GAMMA)


def scene(amplitude, shape="half-sine", frequency=4.0):
    block = Block(mass=100.0, radius=0.6, slenderness=GAMMA)
    return Scene(block=block, motion=PulseMotion(shape, amplitude, frequency), name="block")


def cautions(what):
    return {caution.quantity: caution for caution in cliffs(what, *nearby(what))}


@pytest.mark.parametrize("share", [-0.0302, 0.0302])
def test_uplift_is_where_the_pulse_reaches_g_tan_gamma(share):
    found = cautions(scene(UPLIFT / (1 + share)))["outcome"]
    assert found.value == pytest.approx(share, abs=5e-4)
    assert (found.limit, found.kind) == (0.05, "motion")


def test_a_scene_at_six_tenths_of_uplift_carries_no_sentence():
    assert cautions(scene(0.6 * UPLIFT)) == {}
    isolated = load_scene("caryatid-isolated")
    assert simulate(isolated, history=False).friction_demand < 0.96 * math.tan(isolated.block.slenderness)
    assert cautions(isolated) == {}


def test_a_cliff_is_said_and_single_runs_show_it():
    ground = synthetic_motion("duzce-like", 26).scaled(0.55)
    what = scene(1.0).with_(motion=ground)
    found = cautions(what)["peak tilt"]
    own, other = (
        simulate(what.with_(motion=ground.scaled(1 + change)), history=False).peak_tilt_ratio
        for change in (0.0, found.value)
    )
    assert max(own, other) >= max(5 * min(own, other), 0.01)
    assert f"{own:.3g} of the slenderness" in found.text and f"{other:.3g} at" in found.text


def test_the_changes_are_even_and_hold_the_scene_itself():
    what = scene(1.5 * UPLIFT)
    changes, found = nearby(what)
    assert changes == pytest.approx(np.linspace(-0.05, 0.05, len(changes)), abs=1e-12)
    assert (
        changes[len(changes) // 2] == 0
        and found.peak_tilt[len(changes) // 2] == simulate(what, history=False).peak_tilt
    )


def test_the_mirrored_motion_has_the_same_cliffs():
    what = scene(UPLIFT / 1.02)
    mirrored = what.with_(motion=replace(what.motion, amplitude=-what.motion.amplitude))
    assert cautions(what) == cautions(mirrored)


def test_a_scene_that_costs_too_much_is_refused():
    stiff = load_scene("caryatid-isolated").with_(bearings={"ka": 1e14}, duration=1e5)
    with pytest.raises(SceneError, match="201 runs"):
        nearby(stiff)


@pytest.mark.parametrize(
    "own, other, told",
    [(0.02, 0.098, False), (0.02, 0.102, True), (0.102, 0.02, True), (0.0015, 0.0098, False), (0.0015, 0.0102, True)],
)
def test_a_peak_tilt_five_times_as_large_is_told_unless_it_is_small(own, other, told):
    """Tilts over the slenderness; below a hundredth of it nothing is promised."""
    what = scene(1.5 * UPLIFT)
    changes, found = nearby(what)
    tilts = np.full(len(changes), own * GAMMA)
    tilts[0] = other * GAMMA
    still = np.zeros(len(changes), dtype=bool)
    said = cliffs(what, changes, replace(found, peak_tilt=tilts, lifted=~still, overturns=still, failed=still))
    assert [(one.quantity, one.value) for one in said] == [("peak tilt", -0.05)] * told
