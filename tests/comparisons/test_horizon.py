"""Horizons of motions whose sensitivity is known: none for a pendulum-like one, short for a chaotic one."""

import numpy as np
import pytest

from analytic import Base, Bearings, Block, PulseMotion, SampledMotion, Scene, Start, simulate
from comparisons.horizon import SPREAD, sensitivity_horizon, twin_scenes

BLOCK = Block(mass=3172.05, radius=1.0884, slenderness=0.2)


def long_shaking(slenderness=0.2, seed=3):
    noise = np.random.default_rng(seed).standard_normal(2000)
    return Scene(block=BLOCK.model_copy(update={"slenderness": slenderness}), duration=20.0,
                 motion=SampledMotion(0.01, 2.5 * np.sin(5 * 0.01 * np.arange(2000)) + 0.6 * noise))


def test_free_rocking_is_never_parted():
    scene = Scene(block=BLOCK, start=Start(tilt=0.1), duration=10.0)
    horizon = sensitivity_horizon(scene)
    assert horizon.horizon == 10.0
    assert 0 < horizon.spread[-1] < SPREAD
    assert (np.diff(horizon.spread) >= 0).all()


def test_long_shaking_parts_and_sooner_for_larger_perturbations():
    scene = long_shaking()
    times = [sensitivity_horizon(scene, perturbation=size).horizon for size in (1e-6, 1e-4, 1e-2)]
    assert 0 < times[2] < times[1] < scene.duration
    assert times[1] <= times[0]


def test_the_horizon_is_where_the_spread_crosses_its_bound():
    horizon = sensitivity_horizon(long_shaking())
    first = np.flatnonzero(horizon.spread > SPREAD)[0]
    assert horizon.time[first] == horizon.horizon == min(t for t in horizon.twins.values() if t is not None)


def test_an_independent_twin_parts_at_the_horizon():
    scene = long_shaking()
    horizon = sensitivity_horizon(scene)
    twin = scene.with_(motion=scene.motion.scaled(1.0001))
    one, other = (simulate(s, output_step=1e-3).history for s in (scene, twin))
    n = min(len(one.time), len(other.time))
    apart = np.abs(one.tilt[:n] - other.tilt[:n]) / 0.2
    before = one.time[:n] < horizon.horizon - 0.05
    assert apart[before].max() < SPREAD


def test_no_rocking_no_horizon():
    scene = Scene(block=BLOCK, base=Base(mass=212.0),
                  bearings=Bearings(count=4, ka=6.22e4, kb=6.22e3, alpha=44.69),
                  motion=PulseMotion("one-sine", 1.0, 6.0), duration=5.0)
    horizon = sensitivity_horizon(scene)
    assert horizon.horizon == 5.0 and horizon.spread[-1] == 0.0


def test_every_twin_differs_and_nothing_that_is_zero_is_scaled():
    scene = long_shaking()
    twins = twin_scenes(scene)
    assert set(twins) == {"restitution up", "restitution down", "motion up", "motion down"}
    assert len({twin.digest() for twin in twins.values()} | {scene.digest()}) == 5
    with pytest.raises(ValueError, match="perturbation = 0"):
        sensitivity_horizon(scene, perturbation=0)
