"""The length of steps: small at an impact, growing after it, and told what it is for."""

import math

import numpy as np
import pytest
from engine_cases import needs

from analytic import Base, Bearings, Block, PulseMotion, Scene, Start, simulate
from analytic.rocking import RockingModel
from engines import get_engine
from engines.pace import FLIGHT, GROWTH, IMPACT, REST, SETTLING, StepRule, aligned, fixed, impact_aware, limits

SCENE = Scene(block=Block(mass=3172.05, radius=1.0884, slenderness=0.2), start=Start(tilt=0.12), duration=2.0)
MODEL = RockingModel.of(SCENE)
LARGEST, SMALLEST = 1e-3, 1e-7


def ridden(pace, seconds=2.0):
    """(time, step, purpose, |rate|, jumped) of a block that is carried along by the model's equations, as stepped."""
    tilt, rate, t, h, jumped, interval, rows = 0.12, 0.0, 0.0, 0.0, False, 1.0, []
    while t < seconds:
        step, purpose = pace(tilt, rate, jumped, interval)
        rows.append((t, step, purpose, abs(rate), jumped))
        interval, was = 0.5 * (h + step), tilt > 0
        rate += interval * MODEL.accelerations(1.0 if was else -1.0, tilt, rate, 0.0, 0.0)[0]
        tilt += step * rate
        t, h, jumped = t + step, step, (tilt > 0) != was
        if jumped:
            rate = MODEL.impact(rate)[0]
    return rows


def aware(accuracy, **options):
    return impact_aware(MODEL, 0.0, StepRule(LARGEST, SMALLEST, accuracy, approach=0.3, **options))


@pytest.mark.parametrize("step", [0.29, 0.31, 1.7e-3])
def test_steps_meet_the_jumps_between_two_kicks_and_end_with_the_run(step):
    jumps, t, kicks, lengths = [1.0, 1.25, 2.0], 0.0, [], [0.0]
    limit, fitted = limits(3.0, step, jumps)
    while t < 3.0 - 1e-9 * step:
        h = step
        if t + h >= limit:
            h, limit = fitted(t, h)
        kicks.append((t - 0.5 * lengths[-1], t + 0.5 * h))  # the kick at t acts over these
        lengths.append(h)
        t += h
    assert t == pytest.approx(3.0, abs=1e-9 * step) and max(lengths) <= step * (1 + 1e-9)
    for jump in jumps:
        assert min(abs(edge - jump) for kick in kicks for edge in kick) < 1e-3 * step


@pytest.mark.parametrize("accuracy", [1e-3, 1e-5])
@pytest.mark.parametrize("cruise", [False, True])
def test_the_step_of_an_impact_gains_the_share_asked_for(accuracy, cruise):
    rows = ridden(aware(accuracy, cruise=cruise))
    impacts = [k for k, row in enumerate(rows) if row[4]]
    assert len(impacts) >= 2
    for k in impacts:
        _, step, purpose, speed, _ = rows[k - 1]
        pull = abs(MODEL.accelerations(1.0, 0.0, 0.0, 0.0, 0.0)[0])
        assert step * pull / speed == pytest.approx(accuracy, rel=0.02) and purpose == IMPACT
        assert [row[2] for row in rows[k : k + SETTLING]] == [IMPACT] * SETTLING
        assert {row[1] for row in rows[k : k + SETTLING]} == {step}
    for (_, step, *_), (_, following, *_) in zip(rows, rows[1:], strict=False):
        assert following <= GROWTH * step * (1 + 1e-12) and SMALLEST <= following <= LARGEST
    assert max(row[1] for row in rows) == LARGEST and rows[0][1] == 1e-2 * LARGEST


def test_cruising_spares_looks_and_changes_nothing():
    assert ridden(aware(1e-5)) == ridden(aware(1e-5, cruise=True))


def test_a_coarse_accuracy_stays_below_the_largest_step_unless_it_may_not():
    assert max(row[1] for row in ridden(aware(1e-2))) == LARGEST
    assert max(row[1] for row in ridden(aware(1e-2, overlong=True))) > LARGEST


def test_no_step_at_an_impact_is_longer_than_the_sharpest():
    rows = ridden(aware(1e-3, sharpest=1e-5))
    steps = [rows[k - 1][1] for k, row in enumerate(rows) if row[4]]
    assert steps and max(steps) == 1e-5


def test_equal_steps_are_told_apart_by_what_they_are_for():
    pace, g = fixed(MODEL, 1e-3), 0.2
    assert pace(0.5 * g, -1e-3, False, 1e-3) == (1e-3, FLIGHT)
    assert pace(1e-4 * g, -1.0, False, 1e-3) == (1e-3, IMPACT) and pace(0.5 * g, 0.0, True, 1e-3) == (1e-3, IMPACT)
    assert pace(1e-5 * g, 0.0, False, 1e-3) == (1e-3, REST)
    assert aware(1e-5)(1e-5 * g, 0.0, False, 1.0)[1] == REST
    assert math.isfinite(aware(1e-5)(-0.1, 0.0, False, 1.0)[0])


@pytest.mark.parametrize("jump", [0.9, 1.2, 1.499, 1.501, 1.7, 2.0, 2.3])
def test_a_jump_of_the_ground_falls_between_two_kicks(jump):
    """A kick acts from half the step before to half the step after; none of them holds the jump."""
    t, h, halves = 0.0, 1.0, []
    while t < 4.0:
        step = aligned(min(1.0, 1.5 * h), jump - t)
        assert 0 < step <= 1.0
        halves.append(t + 0.5 * step)
        t, h = t + step, step
    assert min(abs(half - jump) for half in halves) < 1e-12


def test_a_jump_that_is_gone_or_far_changes_no_step():
    assert aligned(1.0, -0.2) == aligned(1.0, 1.001) == aligned(1.0, math.inf) == aligned(1.0, 1e-4) == 1.0


@pytest.mark.parametrize("engine", ["pybullet", "mujoco", "pymunk", "dart", "drake"])
@pytest.mark.parametrize("shape", ["one-cosine", "rectangular"])
def test_a_pulse_that_begins_with_a_jump_lifts_the_block_at_once(engine, shape):
    """Where a kick held the jump the block lifted a step late: .03 of the tilt five steps later."""
    needs(engine)
    pulse = PulseMotion(shape, 1.3 * 9.81 * math.tan(0.2), 6.0, 0.10037)
    scene = SCENE.with_(start=Start(), motion=pulse, duration=0.3)
    model, response = simulate(scene), get_engine(engine).simulate(scene)
    late = [pulse.start + 0.02, pulse.start + 0.1]
    wanted, found = (np.interp(late, one.history.time, one.history.tilt) for one in (model, response))
    np.testing.assert_allclose(found, wanted, rtol=1e-3)


@pytest.mark.parametrize("engine, most", [("pybullet", 1e-3), ("mujoco", 8e-3), ("pymunk", 8e-3)])
def test_a_ground_that_moves_throws_the_block_from_a_swing_of_nothing_in_time(engine, most):
    """The base shakes the block, and at 10 ms a push finds it in an impact of .005 rad/s; its peak was off by .02."""
    needs(engine)
    scene = Scene(
        block=Block(mass=0.0095, radius=0.0189, slenderness=0.268),
        base=Base(mass=0.0862),
        bearings=Bearings(count=2, ka=5.81e4, kb=2630.0, alpha=2525.0),
        motion=PulseMotion("half-sine", 3.472, 108.8),
        duration=0.1,
    )
    found = get_engine(engine).simulate(scene, history=False)
    assert found.peak_tilt == pytest.approx(simulate(scene).peak_tilt, rel=most)
