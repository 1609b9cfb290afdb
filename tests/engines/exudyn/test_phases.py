"""exudyn's two integrators: when each is used, and that they tell the same story."""

import math

import numpy as np
import pytest

pytest.importorskip("exudyn")

from analytic import simulate as exact  # noqa: E402
from analytic.motion import PulseMotion, SampledMotion  # noqa: E402
from analytic.scene import Base, Block, Scene, Start  # noqa: E402
from engines import get_engine  # noqa: E402
from engines.exudyn import phases  # noqa: E402
from engines.exudyn.ground import Ground  # noqa: E402
from engines.exudyn.scene import build  # noqa: E402
from engines.exudyn.stepping import solver_settings  # noqa: E402

simulate = get_engine("exudyn").simulate
BLOCK = Block(mass=3172.05, radius=1.0884, slenderness=0.2)


@pytest.mark.parametrize("base", [None, Base(mass=212.0)], ids=["rigid ground", "sliding base"])
def test_the_implicit_steps_change_no_impact_and_save_most_steps(base, monkeypatch):
    scene = Scene(block=BLOCK, base=base, start=Start(tilt=0.12), duration=2.0)
    both = simulate(scene)
    monkeypatch.setattr(phases, "WORTHWHILE", math.inf)
    explicit = simulate(scene)
    assert len(both.impacts) >= 2
    for one, other in zip(both.impacts[:3], explicit.impacts[:3], strict=True):
        assert one.time == pytest.approx(other.time, abs=1e-5)
        assert one.rate_after / one.rate_before == pytest.approx(other.rate_after / other.rate_before, abs=3e-6)
    assert both.steps < 0.5 * explicit.steps


def test_the_error_of_time_falls_with_the_square_of_the_implicit_step():
    """By the time of the first impact, on corners so stiff that the step alone counts."""
    scene = Scene(block=BLOCK, start=Start(tilt=0.18), duration=2.5)
    expected = exact(scene).impacts[0].time
    errors = [
        abs(simulate(scene, stiffness=1e13, pivoting_step=step).impacts[0].time - expected) for step in (8e-3, 4e-3)
    ]
    assert math.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.3)


def test_where_newton_finds_no_end_the_explicit_steps_go_on(monkeypatch):
    scene = Scene(block=BLOCK, start=Start(tilt=0.12), duration=1.0)
    usual = simulate(scene).steps

    def hopeless(*asked, **settings):
        made = solver_settings(*asked, **settings)
        made.timeIntegration.newton.relativeTolerance = 1e-300
        return made

    monkeypatch.setattr(phases, "solver_settings", hopeless)
    monkeypatch.setattr(phases, "RESIDUAL", 1e-30)
    monkeypatch.setattr(phases, "ROUNDING", 0.0)
    response = simulate(scene)
    assert response.failure is None
    assert response.impacts[0].time == pytest.approx(exact(scene).impacts[0].time, abs=2e-5)
    assert response.steps > 2 * usual


def test_small_swings_on_the_stiff_corners_they_ask_for_are_stepped_implicitly(monkeypatch):
    """Newton's differences must stay within a corner's depth, here 5e-10 m, and its end above rounding errors."""
    motion = PulseMotion("one-sine", 1.1 * 9.81 * math.tan(0.2), 20.0)
    scene = Scene(block=BLOCK, motion=motion, duration=3.0)
    response, expected = simulate(scene, stiffness=5e13), exact(scene)
    assert 1e-4 < expected.peak_tilt_ratio < 5e-3
    assert response.peak_tilt == pytest.approx(expected.peak_tilt, rel=0.02)
    assert response.steps < 40_000
    monkeypatch.setattr(phases, "DIFFERENCE", 1e3)
    assert simulate(scene, stiffness=5e13).steps > 100_000


@pytest.mark.parametrize(
    "q, state",
    [
        ([0.0, -2e-6, 0.0], phases.BOTH),
        ([0.0, 1e-3, 0.0], phases.NEITHER),
        ([0.0, -0.5e-6, 0.0], phases.NEITHER),
        ([0.0, -2e-6, -1e-3], 1),
        ([0.0, -2e-6, 1e-3], -1),
    ],
)
def test_corners_that_carry(q, state):
    b, h = BLOCK.half_width, BLOCK.half_height
    tilt = -q[2]
    if tilt:  # about the corner of its side
        q[1] += b * math.sin(abs(tilt)) + h * (math.cos(tilt) - 1)
    assert phases.carrying(np.array(q), b, h, 1e-6) == state


def test_equal_steps_meet_the_ends_of_segments():
    samples = SampledMotion(0.005, np.sin(np.arange(101)))
    ground = Ground(build(Scene(block=BLOCK, motion=samples, duration=1.0)))
    ground.begin(0.0112, None)
    assert ground.equal(0.0112, 1e-3) == (pytest.approx(0.015), 4)
    ground.begin(0.015, None)
    end, count = ground.equal(0.015, 1e-3)
    assert (end, count) == (pytest.approx(0.5), 97 * 5)
    ground.begin(end, None)
    assert ground.equal(end, 1e-3) == (1.0, 500)
    pulse = Ground(build(Scene(block=BLOCK, motion=PulseMotion("one-sine", 3.0, 6.0, start=0.25), duration=3.0)))
    pulse.begin(0.1, None)
    assert pulse.equal(0.1, 1e-2) == (0.25, 15)
