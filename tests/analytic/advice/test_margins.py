"""Margins against closed forms, and against full runs."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from random_scenes import random_scene

from analytic import (
    Block,
    Pedestal,
    PulseMotion,
    Scene,
    SceneError,
    SettingError,
    Start,
    load_scene,
    simulate,
    synthetic_motion,
)
from analytic.advice.margins import (
    FINER,
    LIMIT_STATES,
    QUANTITIES,
    STEP,
    Band,
    Contact,
    Margin,
    _finer,
    cliffs,
    limit_states,
    margins,
    nearby,
)
from comparisons.studies.stability.cases import BLOCK, GAP, THRESHOLD

G = 9.81


def block_scene(restitution=None, **parts):
    block = Block(mass=3172.05, radius=1.0884, slenderness=0.28, restitution=restitution)
    return Scene(block=block, name="block", **parts)


def by_name(scene, **keywords):
    return {margin.quantity: margin for margin in margins(scene, **keywords)}


def test_a_released_block_overturns_where_its_tilt_reaches_the_slenderness():
    changes = by_name(block_scene(start=Start(tilt=0.26)))
    assert changes["start"].up == pytest.approx(0.28 / 0.26 - 1, abs=1e-7)
    assert changes["start"].beyond(changes["start"].up) == "overturns"
    assert (changes["start"].outcome, changes["start"].down) == ("rocks", None)
    assert changes["slenderness"].down == pytest.approx(0.26 / 0.28 - 1, abs=1e-7)
    assert changes["size"].nearest is None and len(changes["size"].bands) == 1
    assert changes["size"].reached("tilt") and not changes["size"].reached("overturns")
    assert changes["start"].change("tilt") is None and changes["start"].change("lifts") is None
    assert list(changes)[:2] == ["slenderness", "start"], "the nearest comes first"
    assert not {"motion", "ka", "base mass"} & set(changes)


def test_a_standing_block_rocks_from_its_uplift_acceleration_on():
    """The uplift acceleration of a block on rigid ground is g tan(slenderness)."""
    a = 2.5
    scene = block_scene(motion=PulseMotion("rectangular", a, 12.0))
    changes = by_name(scene)
    assert changes["motion"].up == pytest.approx(G * math.tan(0.28) / a - 1, abs=1e-7)
    assert changes["slenderness"].down == pytest.approx(math.atan(a / G) / 0.28 - 1, abs=1e-7)
    assert Contact.of(scene, simulate(scene.with_(duration=None), history=False)).friction_demand == pytest.approx(
        a / G, rel=1e-12
    )


def test_a_standing_block_slides_where_the_ground_exceeds_its_friction():
    """The friction demand is a/g; below a friction of tan(slenderness) the block slides and never lifts."""
    a, friction = 2.5, 0.26
    changes = by_name(block_scene(motion=PulseMotion("rectangular", a, 12.0), friction=friction))
    assert changes["motion"].change("slides") == changes["motion"].up == pytest.approx(friction * G / a - 1, abs=1e-7)
    assert [outcome for _, _, outcome in changes["motion"].outcomes] == ["stands", "slides"]
    assert (
        changes["friction"].change("slides")
        == changes["friction"].down
        == pytest.approx(a / G / friction - 1, abs=1e-7)
    )
    assert changes["slenderness"].down == pytest.approx(math.atan(a / G) / 0.28 - 1, abs=1e-7)
    assert changes["slenderness"].beyond(changes["slenderness"].down) == "rocks"


def test_a_block_that_lifts_slides_from_shentons_acceleration_on():
    """Under a jump of A g it lifts at A = tan(slenderness), and slides at once where A exceeds Shenton's, q = 3/4."""
    a, friction = 2.5, math.tan(0.28) + 1e-4
    margin = by_name(block_scene(motion=PulseMotion("rectangular", a, 12.0), friction=friction))["motion"]
    sine, cosine, q = math.sin(0.28), math.cos(0.28), 0.75
    shenton = friction * (1 - q * sine**2) - q * sine * cosine
    shenton /= 1 - q * cosine**2 - friction * q * sine * cosine
    assert margin.change("lifts") == pytest.approx(G * math.tan(0.28) / a - 1, abs=1e-7)
    assert margin.change("slides") == pytest.approx(G * shenton / a - 1, abs=1e-7)
    assert margin.beyond(margin.up) == "rocks" and margin.leaves_model is None


@pytest.mark.parametrize("amplitude, change", [(9.5, G / 9.5 - 1), (11.0, 0.0)])
def test_a_block_leaves_the_model_where_the_ground_falls_away_as_fast_as_it(amplitude, change):
    motion = PulseMotion("one-sine", 0.0, 6.0, vertical=PulseMotion("one-sine", amplitude, 6.0))
    (margin,) = margins(block_scene(motion=motion), only=("motion",))
    assert margin.leaves_model == pytest.approx(change, abs=1e-7)


@pytest.mark.parametrize("span, step", [(1.0, 0.0025), (2.0, 1 / 49), (9.0, 0.1)])
def test_no_quantity_comes_to_nothing(span, step):
    margin = by_name(block_scene(start=Start(tilt=0.05)), span=span, step=step)["start"]
    assert margin.bands[0].low == pytest.approx(step - 1, abs=1e-9)


def reached(scene, tilt):
    """Return the limit states that a run of the scene reaches."""
    response = simulate(scene, history=False)
    states = {
        "slides": response.sliding is not None and response.sliding.path > 0,
        "lifts": len(response.uplifts) > 0 or response.outcome in ("rocks", "overturns"),
        "tilt": response.peak_tilt > tilt * scene.block.slenderness or response.outcome == "overturns",
        "stroke": scene.bearings is not None and response.peak_base_displacement > (scene.bearings.x_max or math.inf),
        "falls off": response.outcome == "falls off",
        "overturns": response.outcome == "overturns",
        "pedestal overturns": response.outcome == "pedestal overturns",
    }
    return tuple(state for state in LIMIT_STATES if states[state])


def changed(scene, name, change):
    if name == "motion":
        return scene.with_(motion=scene.motion.scaled(1 + change))
    return QUANTITIES[name].changed(scene, 1 + change)


CARYATID = load_scene("caryatid-isolated")
FALLS_OFF = Scene(  # near where it just stays on
    block=Block(mass=120.0, radius=0.7, slenderness=0.3),
    pedestal=Pedestal(width=0.6),
    motion=PulseMotion("one-sine", 2.5, 4.0),
    friction=0.1,
)
SCANNED = {  # the first under 1.6 times its motion, where it rocks
    "bearings": (CARYATID.with_(motion=CARYATID.motion.scaled(1.6)), ("motion", "slenderness", "ka")),
    "falls off": (FALLS_OFF, ("motion", "friction", "pedestal width")),
    **{f"random {index}": (random_scene(11, index), ()) for index in range(3)},
}


@pytest.mark.parametrize("scene, only", SCANNED.values(), ids=SCANNED)
def test_bands_are_what_runs_in_them_and_just_within_their_ends_reach(scene, only):
    scene = scene.with_(duration=None)
    for margin in margins(scene, tilt=0.3, span=0.8 if only else 0.2, step=0.02 if only else STEP, only=only):
        for band in margin.bands:
            width = band.high - band.low
            within = min(1e-4, 0.25 * width)
            for change in (band.low + within, *(band.low + np.linspace(0.1, 0.9, 5) * width), band.high - within):
                assert reached(changed(scene, margin.quantity, change), 0.3) == band.reached, (margin.quantity, change)
        for band, other in itertools.pairwise(margin.bands):
            assert band.high == other.low and (band.reached, band.holds) != (other.reached, other.holds)


def test_only_bearings_with_a_limit_have_a_stroke_and_only_a_friction_slides():
    scene = load_scene("caryatid-isolated")
    edged = scene.with_(friction=0.3, pedestal=Pedestal(width=1.0))
    assert (
        limit_states(edged) == LIMIT_STATES[:-1]
        and limit_states(edged.with_(friction=None)) == LIMIT_STATES[1:4] + LIMIT_STATES[5:-1]
    )
    assert limit_states(scene) == LIMIT_STATES[1:4] + LIMIT_STATES[5:-1]
    without = scene.with_(bearings={"x_max": None}, motion=scene.motion.scaled(3.0))
    assert limit_states(without) == limit_states(load_scene("caryatid-rigid")) == ("lifts", "tilt", "overturns")
    changes = by_name(without, span=0.01, step=5e-3)
    assert not any(margin.reached("stroke") for margin in changes.values())
    assert {"base mass", "ka", "kb", "alpha"} < set(changes) and "yield force" not in changes


@pytest.mark.parametrize(
    "keywords",
    [{"span": 0.0}, {"span": 9.01}, {"step": 0.0}, {"span": 0.01, "step": 0.1}, {"tilt": 0.0}, {"tilt": 1.01}],
)
def test_settings_out_of_range_are_refused(keywords):
    with pytest.raises(SettingError):
        margins(block_scene(start=Start(tilt=0.1)), **keywords)


def test_a_narrow_band_frays_the_boundary():
    """Between overturning with and without an impact lies a narrow band of standing amplitudes (Zhang, Makris)."""
    scene = Scene(block=BLOCK, motion=PulseMotion("one-sine", 1.1 * GAP * THRESHOLD, 7.8))
    fine = by_name(scene, span=0.16)["motion"]
    coarse = by_name(scene, span=0.16, step=0.04)["motion"]
    assert [outcome for _, _, outcome in fine.outcomes] == ["overturns", "rocks", "overturns"] and not fine.interleaved
    assert coarse.interleaved and coarse.nearest == pytest.approx(fine.nearest, abs=3e-6)
    assert coarse.nearest == coarse.down and coarse.up is None


STANDS, ROCKS, TILTS, OVERTURNS = (), ("lifts",), ("lifts", "tilt"), ("lifts", "tilt", "overturns")


def banded(*bands):
    """Return a margin with bands of (low, reached), the last up to 0.2."""
    ends = [low for low, _ in bands[1:]] + [0.2]
    parts = (Band(low, high, reached, holds=True) for (low, reached), high in zip(bands, ends, strict=True))
    return Margin("size", 1.0, "m", tuple(parts))


@pytest.mark.parametrize(
    "second, third, fourth, interleaved",
    [
        (ROCKS, STANDS, ROCKS, True),
        (OVERTURNS, ROCKS, OVERTURNS, True),
        (ROCKS, STANDS, OVERTURNS, True),
        (STANDS, ROCKS, OVERTURNS, False),  # on the way
        (OVERTURNS, ROCKS, STANDS, False),
        (ROCKS, TILTS, ROCKS, False),  # one outcome
    ],
)
def test_outcomes_that_alternate_fray_a_boundary(second, third, fourth, interleaved):
    margin = banded((-0.2, second), (0.05, third), (0.0504, fourth))
    assert margin.interleaved == interleaved
    assert len(margin.outcomes) == (1 if third is TILTS else 3)


def test_changes_of_other_states_are_no_change_of_the_outcome():
    margin = banded((-0.2, OVERTURNS), (-0.1, TILTS), (-0.05, ROCKS), (0.1, TILTS), (0.15, OVERTURNS))
    assert (margin.down, margin.up, margin.nearest) == (-0.1, 0.15, -0.1)
    assert margin.change("tilt") == -0.05 and margin.change("overturns") == -0.1 and margin.change("lifts") is None
    assert margin.beyond(-0.1) == margin.beyond(0.15) == "overturns"
    assert [outcome for _, _, outcome in margin.outcomes] == ["overturns", "rocks", "overturns"]


def test_before_a_frayed_boundary_the_scan_is_finer():
    margin = banded((-0.2, OVERTURNS), (-0.1, ROCKS), (0.05, OVERTURNS), (0.0504, ROCKS))
    coarse = STEP * np.arange(-400, 401)
    finer = _finer(margin, coarse)
    assert set(coarse) <= set(finer) and len(finer) == 801 + 19 * 300
    gap = finer[(finer > -0.1) & (finer < 0.05)]
    assert np.diff(gap).max() == pytest.approx(STEP / FINER, rel=1e-9)


def test_a_range_ends_where_the_model_refuses_the_changed_scene_and_says_why():
    """Released beyond its balance the block falls; from 6.7 % less it lands, where its friction is below mu_c."""
    changes = by_name(block_scene(start=Start(tilt=0.3), friction=0.2), step=1e-3)
    start, slenderness = changes["start"], changes["slenderness"]
    assert start.outcome == "overturns" and "friction = 0.2: below 0.2113" in start.ends_down and not start.ends_up
    assert -1 + 0.28 / 0.3 <= start.bands[0].low < -1 + 0.28 / 0.3 + 1e-3
    assert "friction = 0.2: below" in slenderness.ends_up and slenderness.bands[-1].high == pytest.approx(0.071)
    assert (
        changes["friction"].ends_down == changes["friction"].ends_up == "" and changes["friction"].bands[0].low == -0.2
    )


@pytest.mark.parametrize("restitution, last", [(0.9, 0.111), (0.95, 0.0525)])
def test_a_range_ends_at_the_last_whole_step_that_is_a_scene_and_says_why(restitution, last):
    """The restitution of eq. (7) is at most 1."""
    margin = by_name(block_scene(restitution=restitution, start=Start(tilt=0.1)))["restitution"]
    assert margin.ends_up.startswith("block.restitution = 1.") and not margin.ends_down
    assert (margin.bands[0].low, margin.bands[-1].high) == (-0.2, pytest.approx(last, abs=1e-9))
    assert restitution * (1 + margin.bands[-1].high) <= 1 < restitution * (1 + margin.bands[-1].high + STEP)


def test_a_scene_that_the_model_refuses_has_no_margins():
    with pytest.raises(SceneError, match="friction = 0.2: below 0.2113"):
        margins(block_scene(start=Start(tilt=0.2), friction=0.2))


# What little of the motion decides, against closed forms and single runs
GAMMA = 0.25
UPLIFT = G * math.tan(GAMMA)


def shaken(amplitude, shape="half-sine", frequency=4.0):
    block = Block(mass=100.0, radius=0.6, slenderness=GAMMA)
    return Scene(block=block, motion=PulseMotion(shape, amplitude, frequency), name="block")


def cautions(what):
    return {caution.quantity: caution for caution in cliffs(what, *nearby(what))}


@pytest.mark.parametrize("share", [-0.0302, 0.0302])
def test_uplift_is_where_the_pulse_reaches_g_tan_gamma(share):
    caution = cautions(shaken(UPLIFT / (1 + share)))["outcome"]
    assert caution.value == pytest.approx(share, abs=5e-4)
    assert (caution.limit, caution.kind) == (0.05, "motion")


def test_a_scene_at_six_tenths_of_uplift_carries_no_sentence():
    assert cautions(shaken(0.6 * UPLIFT)) == {}
    isolated = load_scene("caryatid-isolated")
    assert simulate(isolated, history=False).friction_demand < 0.96 * math.tan(isolated.block.slenderness)
    assert cautions(isolated) == {}


def test_a_cliff_is_said_and_single_runs_show_it():
    ground = synthetic_motion("duzce-like", 26).scaled(0.55)
    what = shaken(1.0).with_(motion=ground)
    caution = cautions(what)["peak tilt"]
    tilt_here, other = (
        simulate(what.with_(motion=ground.scaled(1 + change)), history=False).peak_tilt_ratio
        for change in (0.0, caution.value)
    )
    assert max(tilt_here, other) >= max(5 * min(tilt_here, other), 0.01)
    assert f"{tilt_here:.3g} of the slenderness" in caution.text and f"{other:.3g} at" in caution.text


def test_the_changes_are_even_and_hold_the_scene_itself():
    what = shaken(1.5 * UPLIFT)
    changes, outcomes = nearby(what)
    assert changes == pytest.approx(np.linspace(-0.05, 0.05, len(changes)), abs=1e-12)
    assert (
        changes[len(changes) // 2] == 0
        and outcomes.peak_tilt[len(changes) // 2] == simulate(what, history=False).peak_tilt
    )


def test_a_scene_that_costs_too_much_is_refused(monkeypatch):
    monkeypatch.setattr("analytic.advice.margins.NEARBY_STEPS", 1e5)
    stiff = load_scene("caryatid-isolated").with_(bearings={"ka": 1e9}, duration=10.0)
    with pytest.raises(SceneError, match="201 runs"):
        nearby(stiff)


@pytest.mark.parametrize(
    "tilt_here, other, warned",
    [(0.02, 0.098, False), (0.02, 0.102, True), (0.102, 0.02, True), (0.0015, 0.0098, False), (0.0015, 0.0102, True)],
)
def test_a_peak_tilt_five_times_as_large_is_told_unless_it_is_small(tilt_here, other, warned):
    """The tilts are over the slenderness; below a hundredth of it engines are not tested."""
    what = shaken(1.5 * UPLIFT)
    changes, outcomes = nearby(what)
    tilts = np.full(len(changes), tilt_here * GAMMA)
    tilts[0] = other * GAMMA
    still = np.zeros(len(changes), dtype=bool)
    warnings = cliffs(what, changes, replace(outcomes, peak_tilt=tilts, lifted=~still, overturns=still, failed=still))
    assert [(caution.quantity, caution.value) for caution in warnings] == [("peak tilt", -0.05)] * warned
