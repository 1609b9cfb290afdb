"""Margins against closed forms, and against scans by full runs."""

import contextlib
import math

import numpy as np
import pytest

from analytic import Block, PulseMotion, Scene, SettingError, Start, load_scene, simulate
from analytic.margins import FINER, QUANTITIES, STEP, Band, Margin, _finer, contact_margins, margins
from comparisons.bench.random_scenes import random_scene
from comparisons.studies.stability.cases import BLOCK, GAP, THRESHOLD

G = 9.81


def block_scene(restitution=None, **parts):
    block = Block(mass=3172.05, radius=1.0884, slenderness=0.28, restitution=restitution)
    return Scene(block=block, name="block", **parts)


def by_name(scene, **keywords):
    return {margin.quantity: margin for margin in margins(scene, **keywords)}


def test_a_released_block_flips_where_its_tilt_reaches_the_slenderness():
    scene = block_scene(start=Start(tilt=0.26))
    found = by_name(scene)
    assert found["start"].outcome == "rocks"
    assert found["start"].up == pytest.approx(0.28 / 0.26 - 1, abs=1e-7)
    assert found["start"].beyond(found["start"].up) == "overturns"
    assert found["start"].down is None
    assert found["slenderness"].down == pytest.approx(0.26 / 0.28 - 1, abs=1e-7)
    assert found["size"].nearest is None and len(found["size"].bands) == 1
    assert "motion" not in found and "ka" not in found and "base mass" not in found
    assert next(iter(found.values())).nearest == found["slenderness"].nearest, "the nearest comes first"


def test_a_standing_block_flips_at_its_uplift_acceleration():
    """The uplift acceleration of a block on rigid ground is g tan(slenderness); its friction demand is a/g."""
    a = 2.5
    scene = block_scene(motion=PulseMotion("rectangular", a, 12.0), friction=0.26)
    found = by_name(scene)
    assert found["motion"].outcome == "stands"
    assert found["motion"].up == pytest.approx(G * math.tan(0.28) / a - 1, abs=1e-7)
    assert found["slenderness"].down == pytest.approx(math.atan(a / G) / 0.28 - 1, abs=1e-7)
    assert found["motion"].leaves_model == pytest.approx(0.26 * G / a - 1, abs=1e-7)
    assert contact_margins(scene).friction_demand == pytest.approx(a / G, rel=1e-12)


def test_changes_that_are_no_scene_end_the_range():
    scene = block_scene(start=Start(tilt=0.1), restitution=0.95)
    margin = by_name(scene)["restitution"]
    assert margin.bands[-1].high == pytest.approx(0.0525, abs=1e-9), "the last whole step below e = 1"
    assert margin.bands[0].low == -0.2


def test_an_isolated_scene_has_the_quantities_of_its_bearings():
    found = by_name(load_scene("caryatid-isolated"), span=0.01, step=5e-3)
    assert {"base mass", "ka", "kb", "alpha"} < set(found) and "yield force" not in found


@pytest.mark.parametrize("keywords", [{"span": 0.0}, {"span": 1.0}, {"step": 0.0}, {"span": 0.01, "step": 0.1}])
def test_settings_out_of_range_are_refused(keywords):
    with pytest.raises(SettingError):
        margins(block_scene(start=Start(tilt=0.1)), **keywords)


def test_a_narrow_band_frays_the_boundary():
    """Between overturning after an impact and without one lies a narrow band of standing amplitudes (Zhang, Makris)."""
    scene = Scene(block=BLOCK, motion=PulseMotion("one-sine", 1.1 * GAP * THRESHOLD, 7.8))
    fine = by_name(scene, span=0.16)["motion"]
    coarse = by_name(scene, span=0.16, step=0.04)["motion"]
    assert [band.outcome for band in fine.bands] == ["overturns", "rocks", "overturns"] and not fine.frayed
    assert coarse.frayed and coarse.nearest == pytest.approx(fine.nearest, abs=3e-6)
    assert coarse.nearest == coarse.down and coarse.up is None


def test_before_a_frayed_boundary_the_scan_is_finer():
    bands = ((-0.2, -0.1, "overturns"), (-0.1, 0.05, "rocks"), (0.05, 0.0504, "overturns"), (0.0504, 0.2, "rocks"))
    margin = Margin("size", 1.0, "m", tuple(Band(*band, holds=True) for band in bands))
    assert margin.frayed
    coarse = STEP * np.arange(-400, 401)
    finer = _finer(margin, coarse)
    assert set(coarse) <= set(finer)
    gap = finer[(finer > -0.1) & (finer < 0.05)]
    assert np.diff(gap).max() == pytest.approx(STEP / FINER, rel=1e-9) and len(finer) == 801 + 19 * 300


def run_at(scene, name, change):
    """The outcome of a full run with one quantity changed; ValueError where that is no scene."""
    if name == "motion":
        other = scene.with_(motion=scene.motion.scaled(1 + change))
    else:
        other = QUANTITIES[name].changed(scene, 1 + change)
    return simulate(other, history=False).outcome


def scanned(scene, name, count, span=0.2):
    """(changes, outcomes) of `count` full runs over the changes that the quantity allows."""
    found = {}
    for change in np.linspace(-span, span, count):
        with contextlib.suppress(ValueError):
            found[change] = run_at(scene, name, change)
    return np.array(list(found)), np.array(list(found.values()))


def assert_scan_agrees(scene, margin, changes, outcomes):
    """The nearest flip within 1 %, every gap of the scan wider than .1 % in the bands, each flip named a true one.

    At a frayed boundary both find bands between the other's runs: there no flip of the scan is nearer by 1 %, and no
    stretch of it above .1 % is told otherwise.
    """
    bands = margin.bands
    spacing = changes[1] - changes[0]
    assert bands[0].low - changes[0] < STEP and changes[-1] - bands[-1].high < STEP  # whole steps that are scenes
    looked = (changes >= bands[0].low - 1e-6) & (changes <= bands[-1].high + 1e-6)
    changes, outcomes = changes[looked], outcomes[looked]
    missed = 0
    for change, outcome in zip(changes, outcomes, strict=True):
        near = [band.outcome for band in bands if band.low - 1e-6 <= change <= band.high + 1e-6]
        missed = 0 if outcome in near else missed + 1
        wide = missed * spacing
        if missed and not margin.frayed:  # in a gap that the margins do not have: it must be a narrow one
            same = np.flatnonzero(outcomes == outcome)
            wide = np.ptp(changes[same[np.abs(changes[same] - change) <= 1e-3]]) + spacing
        assert wide <= 1e-3, f"{scene.name}, {margin.quantity} {change:+.5f}"
    others = changes[outcomes != margin.outcome]
    if len(others):
        nearest = others[np.abs(others).argmin()]
        assert margin.nearest is not None
        farther = abs(margin.nearest) - abs(nearest)
        assert (farther if margin.frayed else abs(farther)) <= max(0.01 * abs(nearest), spacing)
    for flip in (margin.down, margin.up):
        if flip is not None:  # nearer than the scan's, perhaps: between two of its runs
            band = next(band for band in bands if flip in (band.low, band.high) and band.outcome != margin.outcome)
            assert run_at(scene, margin.quantity, 0.5 * (band.low + band.high)) == band.outcome


@pytest.mark.parametrize("index", range(3))
def test_margins_agree_with_scans(index):
    scene = random_scene(11, index).with_(duration=None)
    for margin in margins(scene):
        assert_scan_agrees(scene, margin, *scanned(scene, margin.quantity, 101))


@pytest.mark.slow
@pytest.mark.timeout(1400)
@pytest.mark.parametrize("index", range(100))
def test_margins_agree_with_scans_of_2000_runs(index):
    scene = random_scene(12, index).with_(duration=None)
    for margin in margins(scene):
        assert_scan_agrees(scene, margin, *scanned(scene, margin.quantity, 2000))
