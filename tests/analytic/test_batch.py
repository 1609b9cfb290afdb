"""Batches: the same outcomes as one run at a time, whatever the number of workers."""

import itertools
import math
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest
from bearing_laws import bearings_of
from rough_motions import rough

from analytic import (
    Block,
    PulseMotion,
    SampledMotion,
    Scene,
    Start,
    batch,
    overturning_map,
    rocking_spectrum,
    simulate,
    simulate_many,
)
from analytic.caryatid import BASE, caryatid_block

G = 9.81
BLOCK = Block(mass=1.0, radius=3 * G / (4 * 2.14**2), slenderness=0.25, restitution=0.9)
CARYATID = caryatid_block(0.18)


def mixed_scenes():
    """Rigid and isolated, pulses, two records and free motion, with and without vertical motion, in no order."""
    pulses = PulseMotion("ricker", 4.0, 5.0), PulseMotion("one-cosine", 5.0, 7.0), PulseMotion("rectangular", 4.0, 3.0)
    rigid = [Scene(block=CARYATID, motion=motion, duration=12.0) for motion in (rough(1, 4.0), *pulses, rough(2, 6.0))]
    rigid[2:2] = [Scene(block=CARYATID, start=Start(tilt=0.02 * k), duration=12.0) for k in range(5)]
    bearings = [bearings_of(law, count=4) for law in ("algebraic", "bilinear")]
    scenes = [scene.with_(base=BASE, bearings=one) for one in bearings for scene in rigid[::-1]] + rigid
    shaken = [(scene, scene.motion) for scene in scenes if scene.motion]
    return [scene.with_(motion=replace(motion, vertical=motion.scaled(0.5))) for scene, motion in shaken] + scenes


def test_simulate_many_equals_one_at_a_time():
    scenes = mixed_scenes()
    many = simulate_many(scenes, tolerance=1e-14)
    assert len(set(many.overturns)) == 2  # the set holds both outcomes
    assert not many.failed.any()
    for i, scene in enumerate(scenes):
        one = simulate(scene, tolerance=1e-14, history=False)
        assert many.overturns[i] == (one.outcome == "overturns")
        assert many.lifted[i] == (one.outcome != "stands")
        assert many.peak_tilt[i] == pytest.approx(one.peak_tilt, rel=1e-8, abs=1e-12)
        if not many.overturns[i]:
            assert many.peak_base_displacement[i] == pytest.approx(one.peak_base_displacement, rel=1e-9)


def test_workers_are_as_many_as_are_asked_for_and_do_not_change_a_bit(monkeypatch):
    scenes, pools = mixed_scenes(), []
    monkeypatch.setattr(
        batch, "ThreadPoolExecutor", lambda workers: pools.append(workers) or ThreadPoolExecutor(workers)
    )
    one, two = simulate_many(scenes, workers=1), simulate_many(scenes, workers=2)
    for name in ("overturns", "peak_tilt", "peak_base_displacement", "impacts"):
        assert np.array_equal(getattr(one, name), getattr(two, name))
    assert set(pools) == {2}  # one worker needs no thread


def test_no_scenes():
    assert simulate_many([]).overturns.shape == (0,)


@pytest.mark.parametrize(
    "shape, vertical, fine",
    [("one-sine", 0.0, 1), ("one-sine", 0.8, 4), ("one-cosine", 0.0, 4), ("half-sine", -0.5, 4), ("ricker", 0.0, 4)],
)
def test_an_overturning_map_is_that_of_full_runs(shape, vertical, fine):
    """After the pulse the energy integral decides; a full run must agree in outcome and peak."""
    scene = Scene(block=BLOCK, duration=60.0)
    frequencies, amplitudes = np.linspace(1.5, 7, 23)[::fine], np.linspace(1.05, 9, 29)[::fine]
    phase = 0.7 if vertical else 0.0
    found = overturning_map(
        scene.with_(duration=None if vertical else 60.0),
        shape,
        frequencies,
        amplitudes,
        tolerance=1e-16,
        vertical_ratio=vertical,
        vertical_phase=phase,
    )
    full = []
    for a, f in itertools.product(amplitudes * G * math.tan(0.25), frequencies * scene.rocking_frequency):
        up = PulseMotion(shape, vertical * a, f, phase=phase) if vertical else None
        full.append(simulate(scene.with_(motion=PulseMotion(shape, a, f, vertical=up)), history=False, tolerance=1e-16))
    assert found.overturns.ravel().tolist() == [one.outcome == "overturns" for one in full]
    assert found.peak_tilt.ravel() == pytest.approx([one.peak_tilt for one in full], rel=1e-9)


def test_a_rocking_spectrum_runs_until_decided_and_is_that_of_full_runs():
    motion, periods = rough(5, 5.0, duration=8.0), np.linspace(0.8, 7.0, 21)
    cut = SampledMotion(motion.dt, motion.samples[: round(4.0 / motion.dt)])  # in the strong shaking
    found = rocking_spectrum(cut, periods, 0.25)
    assert found.decided.all() and 0 < found.overturns.sum() < len(periods)
    for i, period in enumerate(periods):
        block = Block(mass=1.0, radius=0.75 * G * (period / (2 * math.pi)) ** 2, slenderness=0.25)
        one = simulate(Scene(block=block, motion=cut, duration=cut.end + 60.0), history=False)
        assert found.overturns[i] == (one.outcome == "overturns")
        # to rounding, and what the motion makes of it where the block hardly rocks
        assert found.peak_tilt[i] == pytest.approx(one.peak_tilt, abs=1e-8)
    short = rocking_spectrum(cut, periods, 0.25, duration=0.9 * cut.end)
    assert not short.decided[~short.overturns].any()
