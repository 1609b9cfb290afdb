"""exudyn at the limits of a statue's range, its friction and its way to end."""

import math
import os
import signal
import threading
import time
from dataclasses import replace

import numpy as np
import pytest
from bearing_laws import NAMES, bearings_of

exu = pytest.importorskip("exudyn")

from analytic import simulate as exact  # noqa: E402
from analytic.bearing import BearingLaw  # noqa: E402
from analytic.motion import PulseMotion  # noqa: E402
from analytic.rocking import restitution  # noqa: E402
from analytic.scene import Base, Bearings, Block, Scene, Start  # noqa: E402
from engines import get_engine  # noqa: E402
from engines.events import find_events  # noqa: E402
from engines.exudyn import corners, stepping  # noqa: E402
from engines.exudyn.model import Bearing  # noqa: E402
from engines.swings import find_swings  # noqa: E402

simulate = get_engine("exudyn").simulate
MASS, RADIUS = 3172.05, 1.0884
VARIANTS = sorted(get_engine("exudyn").variants)


def block(slenderness, inertia=4 / 3, mass=MASS, radius=RADIUS):
    return Block(mass=mass, radius=radius, slenderness=slenderness, corner_inertia=inertia * mass * radius**2)


def released(part, body, base=None, impacts=3, **parts):
    """A block released at a part of its slenderness, up to the swing after some impacts of the model."""
    scene = Scene(block=body, base=base, start=Start(tilt=part * body.slenderness), duration=12.0, **parts)
    times = [impact.time for impact in exact(scene, history=False).impacts[: impacts + 1]]
    return scene.with_(duration=0.3 * times[-2] + 0.7 * times[-1] if len(times) > 1 else 1.3 * times[0])


def restitution_error(scene):
    """Largest error of restitution, after as many impacts as the model has."""
    response, reference = simulate(scene, history=False), exact(scene, history=False)
    assert response.outcome == reference.outcome == "rocks", response.failure
    assert len(response.impacts) == len(reference.impacts) > 0
    return max(abs(impact.rate_after / impact.rate_before - restitution(scene)) for impact in response.impacts)


def trace_of(scene):
    """The trace of exudyn's run."""
    response, trace = get_engine("exudyn").traced(scene)
    assert response.failure is None, response.failure
    return trace


# Impacts at the limits of the range.


@pytest.mark.parametrize("slenderness", [0.1, 0.5])
@pytest.mark.parametrize("inertia", [1.2, 2.0])
def test_blocks_of_all_shapes(slenderness, inertia):
    assert restitution_error(released(0.6, block(slenderness, inertia))) < 1e-4


@pytest.mark.parametrize("slenderness", [0.1, 0.5])
def test_small_starts_lose_no_impact(slenderness):
    """Slow impacts err as the inverse square of their speed."""
    assert restitution_error(released(0.01, block(slenderness))) < 1e-3


@pytest.mark.parametrize("mass, radius", [(1.0, 0.1), (0.1, 0.1), (1e6, 10.0)])
def test_blocks_of_all_sizes(mass, radius):
    assert restitution_error(released(0.6, block(0.2, mass=mass, radius=radius))) < 1e-4


# Coulomb's law.


@pytest.mark.parametrize(
    "friction, slenderness, push, duration", [(0.2, 0.45, 0.3, 0.05), (0.1, 0.3, 0.25, 0.05), (0.3, 0.45, 0.4, 0.1)]
)
def test_a_block_that_slid_stays_where_it_came_to_rest(friction, slenderness, push, duration):
    """It was drawn back to where it had stood; the slip of a push of acceleration a for T: v T/2 + v^2/(2 mu g)."""
    scene = Scene(
        block=block(slenderness),
        friction=friction,
        duration=1.0,
        motion=PulseMotion("rectangular", push * 9.81, 2 * math.pi / duration),
    )
    trace, lasting = trace_of(scene), scene.motion.end
    speed = (push - friction) * 9.81 * lasting
    slip = 0.5 * speed * lasting + speed**2 / (2 * friction * 9.81)
    assert -trace.centre[-1, 0] == pytest.approx(slip, rel=0.03)
    assert abs(trace.centre[-1, 2]) < 1e-4 * speed


def test_a_push_below_friction_moves_nothing():
    scene = Scene(
        block=block(0.45), friction=0.31, duration=0.3, motion=PulseMotion("rectangular", 0.3 * 9.81, 2 * math.pi / 0.1)
    )
    assert np.abs(trace_of(scene).centre[:, 0]).max() < 1e-5 * RADIUS


def test_the_scenes_friction_comes_before_the_settings():
    scene = Scene(block=block(0.2), friction=0.7, duration=0.01, start=Start(tilt=0.1))
    for variant in ("compliant-corners", "native-contact"):
        assert simulate(scene, variant=variant, friction=2.0).settings["friction"] == 0.7


def test_joints_that_cannot_slide_say_where_the_block_would():
    scene = Scene(block=block(0.3), friction=0.1, duration=0.5, start=Start(tilt=0.2))
    (warning,) = simulate(scene, variant="switched-joints").warnings
    assert (warning.kind, warning.quantity, warning.limit) == ("model", "friction_demand", 0.1) and warning.value > 0.1
    assert simulate(scene.with_(friction=2.0), variant="switched-joints").warnings == ()


# What is put in.


@pytest.mark.parametrize("base", [None, 212.0])
def test_a_block_left_alone_does_not_sink(base):
    """It starts on the corners as they carry it."""
    scene = Scene(block=block(0.2), base=Base(mass=base) if base else None, duration=0.2)
    _, contact_tilt = corners.assemble(scene, corners.scaled(scene, corners.CompliantCorners()))
    sink = contact_tilt * scene.block.half_width
    height = trace_of(scene).centre[:, 1]
    assert height[0] == pytest.approx(-sink, rel=1e-9)
    assert np.ptp(height) < 0.1 * sink  # what the tolerance of the steps leaves


@pytest.mark.parametrize("law", NAMES)
@pytest.mark.parametrize("way", [-3e-2, -1e-4, 2e-5, 1e-3, 0.2])
def test_force_within_a_step_is_the_law_in_full(law, way):
    """The expression that exudyn evaluates, over steps so long that a wrong exponent shows."""
    rule = BearingLaw.of(bearings_of(law, count=4, damping=300.0))
    bearing, Real = Bearing(rule, 0.01), exu.symbolic.Real
    found = bearing.force([Real(way)], [Real(0.4)], [Real(value) for value in bearing.memory()])[0].Evaluate()
    assert found == pytest.approx(rule.force(0.01 + way, rule.hysteretic(bearing.z, way), 0.4), rel=1e-10)


# How runs end.


@pytest.mark.parametrize("variant", VARIANTS)
def test_interrupt_ends_the_run_within_a_second_and_is_no_failure(variant):
    scene = Scene(block=block(0.2), start=Start(tilt=0.12), duration=1e4)
    simulate(scene.with_(duration=0.01), variant=variant)  # compiled
    sent, outside = [], signal.signal(signal.SIGINT, signal.default_int_handler)  # a job in the background ignores it

    def interrupt():
        sent.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    threading.Timer(0.5, interrupt).start()
    try:
        with pytest.raises(KeyboardInterrupt):
            simulate(scene, variant=variant)
        assert time.monotonic() - sent[0] < 1.0
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    finally:
        signal.signal(signal.SIGINT, outside)


def test_run_of_too_many_steps_ends_with_its_evidence(monkeypatch):
    monkeypatch.setattr(stepping, "STEPS_PER_PERIOD", 200)
    response = simulate(Scene(block=block(0.2), start=Start(tilt=0.12), duration=1.0))
    assert response.outcome == "failed" and "too many steps" in response.failure.reason
    assert "of 1 s" in response.failure.message
    assert response.steps <= 200 * 3


def test_an_impact_at_the_end_of_a_run_is_read_when_corners_have_settled():
    """They had not: e of the last of eight impacts was read as .9622 where it is .9788."""
    scene = Scene(
        block=Block(mass=0.0239329, radius=0.90504, slenderness=0.119293), start=Start(tilt=-0.0511423), duration=5.2527
    )
    response = simulate(scene, history=False)
    last = response.impacts[-1]
    assert len(response.impacts) == 8 and not response.differences
    assert last.rate_after / last.rate_before == pytest.approx(restitution(scene), abs=1e-3)


@pytest.mark.parametrize("settle", [0.5, 1.0, 2.0])
def test_e_does_not_hang_on_how_long_a_contact_is_left_to_settle(settle):
    """In that time a damper takes from the base what the impact gave it: e of the fourth was read off by .023."""
    body = Block(mass=1441.73, radius=0.251352, slenderness=0.349489, corner_inertia=121.0244)
    scene = Scene(
        block=body,
        base=Base(mass=109.722),
        bearings=Bearings(law="bouc-wen", count=4, ka=1806.4, kb=1011.87, alpha=480.623, damping=33319.5),
        motion=PulseMotion("one-sine", 7.1271, 42.08717),
        duration=2.0,
    )
    trace = trace_of(scene)
    trace = replace(trace, settle=settle * trace.settle)
    impacts = find_events(scene, trace, find_swings(trace))[0][:4]
    assert 0.29 < min(abs(impact.rate_before) for impact in impacts)
    assert max(abs(impact.rate_after / impact.rate_before - restitution(scene)) for impact in impacts) < 1e-3
