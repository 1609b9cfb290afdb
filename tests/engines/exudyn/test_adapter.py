"""exudyn's variants, beside what every engine must fulfil: accuracy, known faults, failures that must surface."""

import gc

import numpy as np
import psutil
import pytest

pytest.importorskip("exudyn")

from analytic import simulate as exact  # noqa: E402
from analytic.motion import SampledMotion  # noqa: E402
from analytic.rocking import restitution  # noqa: E402
from analytic.scene import Base, Bearings, Block, Scene, Start  # noqa: E402
from engines import get_engine  # noqa: E402
from engines.contract import Mismatch  # noqa: E402
from engines.exudyn import corners, stepping  # noqa: E402

simulate = get_engine("exudyn").simulate
CARYATID = {"mass": 3172.05, "radius": 1.0884}
BEARINGS = {"count": 4, "ka": 6.22e4, "kb": 6.22e3, "alpha": 44.69}


def rocking(slenderness, base=None, part=0.6, duration=1.3, **block):
    return Scene(
        block=Block(slenderness=slenderness, **CARYATID, **block),
        base=Base(mass=base) if base else None,
        start=Start(tilt=part * slenderness),
        duration=duration,
    )


def errors(scene, response):
    """Restitution less eq. (7) of the impacts above a tenth of omega_r gamma."""
    fast = 0.1 * scene.rocking_frequency * scene.block.slenderness
    impacts = [impact for impact in response.impacts if abs(impact.rate_before) > fast]
    assert impacts
    return np.array([i.rate_after / i.rate_before for i in impacts]) - restitution(scene)


def test_a_stocky_block_that_leaves_the_ground_after_an_impact_is_no_failure():
    scene = rocking(0.45, part=0.8, duration=1.5)
    response = simulate(scene)
    assert response.outcome == "rocks"
    assert np.abs(errors(scene, response)).max() < 2e-4


@pytest.mark.parametrize("part", [0.59, 0.73, 0.8])
def test_no_impact_of_a_stocky_fast_block_is_lost(part):
    """It hops for 15 ms after an impact, so that the lift carried back lies microseconds after the landing."""
    response = simulate(rocking(0.45, 3172.05, part, 1.5))
    assert [round(impact.time, 3) for impact in response.impacts[:3]] == [
        round(impact.time, 3) for impact in exact(rocking(0.45, 3172.05, part, 1.5)).impacts[:3]
    ]


def test_error_of_compliant_corners_goes_as_one_over_stiffness():
    scene = rocking(0.1, duration=0.8)
    soft, stiff = (abs(errors(scene, simulate(scene, stiffness=k))[0]) for k in (1e9, 1e10))
    assert 4 < soft / stiff < 25


@pytest.mark.parametrize("base", [None, 212.0])
def test_switched_joints_give_the_restitution_to_the_square_of_the_step(base):
    scene = rocking(0.2, base)
    coarse, fine = (
        np.abs(errors(scene, simulate(scene, variant="switched-joints", step=step))).max() for step in (4e-3, 1e-3)
    )
    assert fine < 1e-6
    assert coarse > 4 * fine


@pytest.mark.parametrize("slenderness", [0.1, 0.2])
def test_native_contact_is_one_to_ten_percent_off(slenderness):
    """A documented fault: a version of exudyn that mends it should be noticed."""
    scene = rocking(slenderness, duration=0.9)
    assert 0.01 < abs(errors(scene, simulate(scene, variant="native-contact"))[0]) < 0.10


@pytest.mark.parametrize("ratio", [1e-4, 1e-2, 1.0, 10.0])
def test_extreme_bases_do_not_fail_in_silence(ratio):
    scene = rocking(0.1, ratio * 3172.05, duration=0.8)
    response = simulate(scene)
    assert response.outcome == "rocks" or response.failure.reason
    if response.outcome == "rocks":
        assert np.abs(errors(scene, response)).max() < 2e-3


def test_newton_failure_surfaces_with_the_engines_message():
    response = simulate(rocking(0.2), variant="native-contact", stiffness=1e9, sphere=1e-3)
    assert response.outcome == "failed"
    assert "Newton" in response.failure.message
    assert np.isfinite(response.failure.last_state.tilt)


def test_non_finite_force_surfaces(monkeypatch):
    force = corners.Corner.force

    def poisoned(self, displacement, velocity, offset):
        x, y, z = force(self, displacement, velocity, offset)
        return [x, y * corners.Real(np.nan), z]

    monkeypatch.setattr(corners.Corner, "force", poisoned)
    response = simulate(rocking(0.2))
    assert response.outcome == "failed"
    assert "finite" in response.failure.reason


def test_a_block_that_sinks_surfaces(monkeypatch):
    monkeypatch.setattr(corners.Corner, "force", lambda self, displacement, velocity, offset: [corners.Real(0.0)] * 3)
    response = simulate(rocking(0.2))
    assert response.outcome == "failed"
    assert "sank" in response.failure.reason


def test_a_mismatch_with_the_engine_is_refused(monkeypatch):
    read_back = stepping.read_back

    def heavier(model):
        return read_back(model) | {"block.mass": (model.scene.block.mass * 2, model.scene.block.mass)}

    monkeypatch.setattr(stepping, "read_back", heavier)
    with pytest.raises(Mismatch, match="block.mass is 6344.1 in exudyn, 3172.05 in the scene"):
        simulate(rocking(0.2))


@pytest.mark.parametrize("variant", ["switched-joints", "compliant-corners"])
def test_memory_does_not_grow_with_the_number_of_runs(variant):
    """exudyn keeps a system alive that has a user function: its steps (400 bytes each) and the ground's segments."""
    dt = 1e-4  # s; as many segments as steps
    motion = SampledMotion(dt, 0.5 * np.sin(8 * dt * np.arange(10_001)))
    scene = Scene(
        block=Block(slenderness=0.28, **CARYATID),
        base=Base(mass=212.0),
        bearings=Bearings(**BEARINGS),
        motion=motion,
        duration=1.0,
    )
    settings = {"switched-joints": {"step": dt}}.get(variant, {})
    process, used = psutil.Process(), []
    for _ in range(8):
        response = simulate(scene, variant=variant, history=False, **settings)
        gc.collect()
        used.append(process.memory_info().rss)
    assert response.outcome == "stands" and response.steps >= 10_000
    growth = (used[-1] - used[2]) / 5 / response.steps
    assert growth < 50, f"{growth:.0f} bytes a step are kept of each run"
