"""What holds for every engine that moves bodies along their velocities, at its best: sliding, light bases, sizes."""

import math

import pytest
from engine_cases import needs
from released import scene

from analytic import Base, Bearings, Block, PulseMotion, Start
from analytic import Scene as AnyScene
from analytic import simulate as exact
from analytic.rocking import restitution
from engines import get_engine, planar

BEARINGS = Bearings(count=4, ka=6.22e4, kb=6.22e3, alpha=44.69)


@pytest.fixture(params=["pymunk", "dart", "drake"])
def engine(request):
    needs(request.param)
    return get_engine(request.param)


def test_friction_of_the_scene_is_coulombs(engine):
    """A push of .3 g for .05 s on a block that slides at .2 g: (.1 g t^2/2)(1 + .1/.2), and it stays there."""
    given = scene(0.45, duration=0.5, friction=0.2, motion=PulseMotion("rectangular", -0.3 * 9.81, math.pi / 0.05))
    _, trace = engine.traced(given)
    assert abs(trace.centre[-1, 0]) == pytest.approx(0.5 * 0.1 * 9.81 * 0.05**2 * 1.5, rel=0.02)


def test_sliding_block_fails(engine):
    response = engine.simulate(scene(0.4, friction=0.2, motion=PulseMotion("rectangular", 3.0, 2.0)))
    assert response.outcome == "failed"
    assert "slid" in response.failure.reason


@pytest.mark.parametrize("base", [10.0, 0.067])
def test_light_base(engine, base):
    given = scene(0.28, base, 1.0, bearings=BEARINGS, start=Start(tilt=0.168))
    model, response = exact(given), engine.simulate(given)
    assert response.outcome == model.outcome, response.failure
    assert response.peak_base_displacement == pytest.approx(model.peak_base_displacement, rel=2e-3)


@pytest.mark.parametrize("damping", [1e4, 1e6])
def test_viscous_bearings_of_any_strength_are_right_or_warned(engine, damping):
    given = scene(0.28, 212.0, 1.0, bearings=BEARINGS.model_copy(update={"damping": damping}), start=Start(tilt=0.168))
    model, response = exact(given), engine.simulate(given)
    off = response.failure or abs(response.peak_base_displacement / model.peak_base_displacement - 1) > 1e-2
    assert not off or response.warnings


@pytest.mark.parametrize("radius, density", [(1e-3, 2460.0), (30.0, 2460.0), (0.02, 600.0)])
def test_steps_go_with_the_size_of_the_block(engine, radius, density):
    mass = density * radius**3
    given = AnyScene(
        block=Block(mass=mass, radius=radius, slenderness=0.25),
        base=Base(mass=0.1 * mass),
        start=Start(tilt=0.15),
        duration=2.0 * math.sqrt(radius),
    )
    response = engine.simulate(given, history=False)
    assert response.impacts
    for impact in response.impacts[:3]:
        assert impact.rate_after / impact.rate_before == pytest.approx(restitution(given), abs=1e-4)


def test_run_that_does_not_advance_is_given_up(engine, monkeypatch):
    monkeypatch.setattr(planar, "row_limit", lambda duration, largest: 100)
    response = engine.simulate(scene(0.2, start=Start(tilt=0.1)))
    assert response.outcome == "failed"
    assert response.failure.reason == "too many steps"
