"""Every engine under a vertical motion, against the analytic model, within the rows of its tolerance table."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from engine_cases import every_variant

from analytic import Base, Bearings, Block, PulseMotion, SampledMotion, Scene, Start, simulate
from analytic.decision import RIGID_BEARINGS
from engines import get_engine
from engines.checks import energy_balance
from engines.events import contact_measures
from engines.swings import Trace

TUNED = ["exudyn", "pybullet", "mujoco", "pymunk", "dart"]
BLOCK = Block(mass=3172.05, radius=1.0884, slenderness=0.2)
LRB = Bearings(count=4, ka=6.22e4, kb=6.22e3, alpha=44.69)
TIMES = np.arange(0, 4.001, 0.005)
HEAVING = SampledMotion(0.005, 0 * TIMES, vertical=SampledMotion(0.005, 2.0 * np.sin(9.0 * TIMES)))
RELEASED = Scene(block=BLOCK, start=Start(tilt=0.1), motion=HEAVING, duration=2.5)
PULSE = PulseMotion("one-sine", 3.0, 8.0, vertical=PulseMotion("one-sine", -1.0, 8.0))
DRIVEN = Scene(
    block=Block(mass=3172.05, radius=1.0884, slenderness=0.15),
    base=Base(mass=212.0),
    bearings=LRB,
    motion=PULSE,
    duration=3.0,
)


# Twice what is measured where the vertical motion adds to it. MuJoCo's errors without it are no scale: half of the
# tilt's, 3.6e-5 for 7.3e-5, and by chance next to nothing of the displacement's, 2.4e-8 for 3.2e-6.
OWN = {"mujoco": {"peak tilt": 1.4e-4, "peak displacement": 6.4e-6}}


def bound(engine, quantity, scenes):
    """Of the engine's main variant; its own of this file, where it has one."""
    if quantity in OWN.get(engine.name, {}):
        return OWN[engine.name][quantity]
    rows = engine.tolerance_rows()[engine.default_variant]
    return next(row.bound for row in rows if (row.quantity, row.scenes) == (quantity, scenes))


def without(scene):
    return scene.with_(motion=replace(scene.motion, vertical=None))


def first_impacts(response):
    return np.array([impact.time for impact in response.impacts[:3]])


@pytest.mark.parametrize("scenes, base", [("rigid ground", None), ("sliding base", Base(mass=212.0))])
@pytest.mark.parametrize("name", TUNED)
def test_impact_times_of_a_released_block(name, scenes, base):
    engine, scene = get_engine(name), RELEASED.with_(base=base)
    limit, wanted = bound(engine, "impact times", scenes), first_impacts(simulate(scene))
    found = engine.simulate(scene, history=False)
    assert found.outcome == "rocks" and found.failure is None
    np.testing.assert_allclose(first_impacts(found), wanted, rtol=0, atol=limit)
    assert abs(first_impacts(simulate(without(scene)))[1] - wanted[1]) > 50 * limit


@pytest.mark.parametrize("name", TUNED)
def test_peaks_on_bearings(name):
    engine, exact, level = get_engine(name), simulate(DRIVEN), simulate(without(DRIVEN))
    found = engine.simulate(DRIVEN, history=False)
    tilt, displacement = (
        bound(engine, f"peak {one}", "rocking on bearings, one-sine") for one in ("tilt", "displacement")
    )
    assert found.peak_tilt_ratio == pytest.approx(exact.peak_tilt_ratio, abs=tilt)
    assert abs(level.peak_tilt_ratio - exact.peak_tilt_ratio) > 50 * tilt
    assert found.peak_base_displacement == pytest.approx(exact.peak_base_displacement, rel=displacement)
    assert found.min_normal_ratio == pytest.approx(exact.min_normal_ratio, abs=2e-3)
    assert RIGID_BEARINGS in map(str, found.warnings)


@every_variant
def test_every_variant_feels_it_and_says_where_a_block_would_jump(engine, variant):
    run = partial(get_engine(engine).simulate, variant=variant, history=False)
    heaving, level = (one.with_(duration=0.6) for one in (RELEASED, without(RELEASED)))
    wanted, felt = (first_impacts(solve(heaving))[0] - first_impacts(solve(level))[0] for solve in (simulate, run))
    assert felt == pytest.approx(wanted, rel=0.15)
    up = SampledMotion(0.005, 12.0 * np.sin(9.0 * TIMES))
    found = run(RELEASED.with_(motion=replace(HEAVING, vertical=up), start=Start(tilt=0.05), duration=1.0))
    assert found.failure is not None or any("the block would jump" in warning.text for warning in found.warnings)


def test_measures_on_exact_states():
    for scene in (RELEASED.with_(duration=0.4), DRIVEN.with_(duration=0.7)):
        exact = simulate(scene, output_step=1e-3)
        assert exact.impact_count == 0
        trace = Trace(*(getattr(exact.history, column) for column in Trace.COLUMNS), contact_tilt=1e-6)
        demand, normal, _ = contact_measures(scene, trace)
        assert (demand, normal) == pytest.approx((exact.friction_demand, exact.min_normal_ratio), rel=1e-3)
        balance, kinetic = energy_balance(scene, trace)
        assert np.abs(balance).max() < 1e-4 * kinetic.max()
        assert np.abs(energy_balance(without(scene), trace)[0]).max() > 5e-3 * kinetic.max()
