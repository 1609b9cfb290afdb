"""The length of steps: small where a point lands, held after it, growing else; jumps of the ground and the end met."""

import math

import pytest

from engines.step_size import GROWTH, HOLD, NEAR, SHARE, aligned, fixed_rule, gap_rule, limits

LARGEST, SMALLEST, G = 1e-3, 1e-6, 9.81
APART = (1.0, 0.0)  # gap and closing speed of a point that nothing is about to happen to


def grown(rule=None, points=(APART, APART)):
    """A rule that has come to the largest step."""
    rule = rule or gap_rule(LARGEST, SMALLEST, G)
    while rule(points) < LARGEST:
        pass
    return rule


def dropped(height, rest=0.0, seconds=0.6, count=1):
    """(step, gap before it, closing before it) of `count` points that fall on a floor and stop, as leapfrog has it."""
    rule, gap, closing, h, t, rows = gap_rule(LARGEST, SMALLEST, G), height, 0.0, 0.0, 0.0, []
    while t < seconds:
        step = rule(((gap, closing),) * count)
        rows.append((step, gap, closing))
        closing = -rest * closing if gap <= 0 < closing else closing + G * (h + step) / 2
        if gap <= 0 and closing > 0:
            closing = 0.0
        gap, t, h = gap - step * closing, t + step, step
    return rows


@pytest.mark.parametrize("height", [1e-4, 1e-2, 0.3])
@pytest.mark.parametrize("count", [1, 2, 5])
def test_a_falling_point_lands_in_the_smallest_step_whatever_its_height(height, count):
    rows = dropped(height, count=count)
    landing = next(k for k, row in enumerate(rows) if row[1] <= 0)
    assert rows[landing - 1][0] == SMALLEST
    assert -rows[landing][1] <= SMALLEST * rows[landing][2]  # how deep
    assert max(row[0] for row in rows) == LARGEST and rows == dropped(height, count=1)


def test_each_step_to_a_landing_is_the_share_of_the_time_that_is_left():
    rule = grown()
    for gap in (1e-3, 5e-4, 1e-4, 1e-5):
        assert rule((APART, (gap, 0.5))) == pytest.approx(min(LARGEST, SHARE * gap / 0.5))


def test_the_nearest_landing_of_all_points_decides():
    points = [(0.1, 0.2), (1e-4, 0.4), (1e-4, -0.4), (3e-4, 0.1)]
    lengths = {grown(points=(APART,) * 4)(tuple(points[k:] + points[:k])) for k in range(4)}
    assert lengths == {SHARE * 1e-4 / 0.4}


def test_steps_are_held_after_a_jump_of_a_speed_and_then_grow():
    rule, before, after = gap_rule(LARGEST, SMALLEST, G), ((1.0, 0.3), APART), ((1.0, -0.2), APART)
    first = rule(before)
    assert [rule(after) for _ in range(HOLD)] == [first] * HOLD
    assert [rule(after) for _ in range(3)] == pytest.approx([first * GROWTH ** (k + 1) for k in range(3)])


def test_steps_are_held_while_a_point_lands():
    """An engine that meets a contact in the step after it has sunk must not meet it in a longer one."""
    rule = gap_rule(LARGEST, SMALLEST, G)
    first = rule((APART,))
    assert {rule(((-1e-8, 0.3),)) for _ in range(3 * HOLD)} == {first}


def test_what_a_contact_leaves_to_a_pivot_is_no_landing():
    """It hops by less than NEAR g h^2, and falls back at less than 2 g h: steps stay the largest."""
    rule = grown()
    hop, fall = 0.9 * NEAR * G * LARGEST**2, 1.9 * G * LARGEST
    assert {rule((APART, (hop, fall * (k % 2)))) for k in range(50)} == {LARGEST}
    assert rule((APART, (1.1 * NEAR * G * LARGEST**2, fall))) < LARGEST


def test_a_slow_landing_is_seen_as_well():
    """At a tenth of what gravity gives in a largest step."""
    rule, slow = grown(), 0.1 * G * LARGEST
    gap, lengths = 1e-4, []
    while gap > 0 and len(lengths) < 1000:
        lengths.append(rule((APART, (gap, slow))))
        gap -= lengths[-1] * slow
    assert lengths[-1] == pytest.approx(SMALLEST)


def test_times_go_with_the_root_of_a_length():
    """Lengths by 4 and times by 2: no digit changes."""
    small, large = gap_rule(LARGEST, SMALLEST, G), gap_rule(2 * LARGEST, 2 * SMALLEST, G)
    for k in range(60):
        gap, closing = abs(math.cos(k)) ** 9 * 1e-3, math.sin(k)
        assert large(((4 * gap, 2 * closing),)) == 2 * small(((gap, closing),))


def test_a_fixed_step_stays():
    rule = fixed_rule(1e-3)
    assert {rule(((1e-9, 5.0),)), rule((APART,))} == {1e-3}


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
