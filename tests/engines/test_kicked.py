"""Bases that still vibrate when impacts kick them: whose displacement is said to be unsure, and whose is not."""

import numpy as np
import pytest
from engine_cases import needs
from sampled_traces import SCENES, sampled

from analytic import Base, Bearings, Block, PulseMotion, Scene, Start, simulate
from engines import get_engine
from engines.contract import Run
from engines.kicked import UNSURE, warnings

BODY = Block(mass=0.94646, radius=0.09755, slenderness=0.11642, corner_inertia=0.0140705)
BEARINGS = Bearings(law="linear", count=8, ka=286367.0)
FAST = Scene(block=BODY, base=Base(mass=0.17814), bearings=BEARINGS, start=Start(tilt=0.06803), duration=1.0945)
# Of a base kicked three times the third impact, not the first, leaves the largest displacement
THRICE = Scene(
    block=Block(mass=1254.4825, radius=0.48839664, slenderness=0.13554789, corner_inertia=812.979494),
    base=Base(mass=546.699364),
    bearings=Bearings(law="linear", count=6, ka=609484185.7),
    start=Start(tilt=-0.09658),
    duration=3.588409,
)
# A jump of the ground makes the base vibrate; what the corners yield damps it before the block lifts
JUMP = Scene(
    block=Block(mass=8.346713, radius=5.954584, slenderness=0.344822, corner_inertia=315.49296),
    base=Base(mass=20.086502),
    bearings=Bearings(law="bouc-wen", count=1, ka=52797649.0, kb=1271191.5, alpha=3.827835),
    motion=PulseMotion("rectangular", -13.462247, 1.46918),
    duration=11.023727,
)


def said(scene, drift, late=0.0):
    trace, _ = sampled(scene, 2e-5 if scene is FAST else 1e-3, step=1e-5 if scene is FAST else 2.5e-4)
    return list(warnings(scene, Run(trace, len(trace.time) - 1, 0.0, drift=drift, late=late)))


def test_a_base_that_vibrates_undamped_at_447_omega_r_is_said():
    """By what its peak changes in the analytic model, within a factor of 4, when the vibration is off by the drift."""
    (sentence,) = said(FAST, drift=2e-4)
    assert "vibrates at 44" in sentence and "give the bearings their damping" in sentence
    peak = simulate(FAST, history=False).peak_base_displacement
    faster = [FAST.with_(bearings={"ka": BEARINGS.ka * (1 + sign * 2 * 2e-4)}) for sign in (-1, 1)]
    moved = max(abs(simulate(scene, history=False).peak_base_displacement / peak - 1) for scene in faster)
    named = float(sentence.split("displacement to ")[1].split(" of itself")[0])
    assert named > UNSURE and named / 4 < moved < 4 * named
    assert said(FAST, drift=0.0, late=2e-5) and not said(FAST, drift=1e-6)


@pytest.mark.parametrize("name", ["rigid ground", "sliding base", "isolated", "isolated, shaken"])
def test_where_nothing_vibrates_at_an_impact_nothing_is_said(name):
    assert not said(SCENES[name], drift=2e-3)


def test_dampers_make_it_sure():
    damped = FAST.with_(bearings={"damping": 0.2 * (BEARINGS.ka * 0.17814 / 8) ** 0.5})
    assert not said(damped, drift=1e-3)


def test_a_soft_base_that_impacts_drive_is_no_vibration():
    """At omega_r/4 and less it moves as the block pushes it: the bound was 86 times its peak displacement."""
    soft = FAST.with_(bearings={"ka": BEARINGS.ka * (0.25 / 447) ** 2}, start={"tilt": 6.8e-3}, duration=3.0)
    assert not said(soft, drift=1e-3)
    trace, _ = sampled(soft, 2e-4, step=1e-4)
    assert np.abs(trace.base_velocity).max() > 5 * np.abs(trace.base_displacement).max() * 0.25 * soft.rocking_frequency


@pytest.mark.parametrize("scene", [FAST, THRICE, JUMP])
def test_exudyn_says_it(scene):
    """Displacements were off in silence: by 3.8, 48 and 6.6 %."""
    needs("exudyn")
    said = get_engine("exudyn").simulate(scene, history=False).warnings
    assert any("its phase is sure to" in warning for warning in said)


def test_where_small_swings_grow_from_impact_to_impact_it_is_said():
    """A pulse that begins at 1.07 times uplift, whose peak tilt is .0097 slendernesses."""
    needs("mujoco")
    body = Block(mass=3.7233, radius=0.234198, slenderness=0.0955116, corner_inertia=0.235956)
    shaken = Scene(block=body, motion=PulseMotion("one-cosine", -1.009475, 24.767135), duration=1.9)
    for scale, is_said in ((1.0, True), (3.0, False)):
        told = get_engine("mujoco").simulate(shaken.with_(motion=shaken.motion.scaled(scale)), history=False).warnings
        assert any("impacts of a block that the ground hardly lifts" in words for words in told) == is_said
