"""The length of steps: small where a point lands, held after it, growing else; jumps of the ground and the end met."""

import math

import pytest

from engines.step_size import GROWTH, HOLD, NEAR, SHARE, aligned, gap_rule, limits

LARGEST, SMALLEST, G = 1e-3, 1e-6, 9.81
APART = (1.0, 0.0)  # gap and closing speed of a point that nothing is about to happen to


@pytest.fixture
def fresh():
    return gap_rule(LARGEST, SMALLEST, G)


@pytest.fixture
def grown(fresh):
    """A rule that has come to the largest step."""
    while fresh((APART, APART)) < LARGEST:
        pass
    return fresh


@pytest.mark.parametrize(
    "height, closing, pull", [(1e-4, 0.0, G), (1e-2, 0.0, G), (0.3, 0.0, G), (1e-4, 0.1 * G * LARGEST, 0.0)]
)
@pytest.mark.parametrize("count", [1, 5])
def test_a_falling_point_lands_in_the_smallest_step_whatever_its_height(fresh, height, closing, pull, count):
    """As leapfrog has it fall; a slow landing, at a tenth of what gravity gives in a largest step, is seen as well."""
    gap, h, lengths = height, 0.0, []
    while gap > 0:
        lengths.append(fresh(((gap, closing),) * count))
        closing += pull * (h + lengths[-1]) / 2
        h = lengths[-1]
        gap -= h * closing
    assert lengths[-2:] == [SMALLEST] * 2 and -gap <= SMALLEST * closing  # how deep
    assert max(lengths) == LARGEST or height < 1e-3


@pytest.mark.parametrize("gap", [1e-3, 5e-4, 1e-4, 1e-5])
def test_each_step_to_a_landing_is_the_share_of_the_time_that_is_left(grown, gap):
    assert grown((APART, (gap, 0.5))) == pytest.approx(min(LARGEST, SHARE * gap / 0.5))


@pytest.mark.parametrize("turn", range(4))
def test_the_nearest_landing_of_all_points_decides(fresh, turn):
    points = [(0.1, 0.2), (1e-4, 0.4), (1e-4, -0.4), (3e-4, 0.1)]
    while fresh([APART] * 4) < LARGEST:
        pass
    assert fresh(points[turn:] + points[:turn]) == SHARE * 1e-4 / 0.4


def test_steps_grow_but_not_while_a_point_lands(fresh):
    """An engine that meets a contact in the step after it has sunk must not meet it in a longer one."""
    first = fresh((APART,))
    assert {fresh(((-1e-8, 0.3), APART)) for _ in range(12)} == {first}
    standing = (-1e-8, 1.9 * G * first)  # falls in a step at g h or less
    assert {fresh((standing, APART)) for _ in range(HOLD - 1)} == {first}
    assert [fresh((standing, APART)) for _ in range(3)] == pytest.approx([first * (1 + GROWTH) ** k for k in (1, 2, 3)])


def test_what_a_contact_leaves_to_a_pivot_is_no_landing(grown):
    """It hops by less than NEAR g h^2, and falls back at less than 2 g h: steps stay the largest."""
    hop, fall = 0.9 * NEAR * G * LARGEST**2, 1.9 * G * LARGEST
    assert {grown((APART, (hop, fall * (k % 2)))) for k in range(50)} == {LARGEST}
    assert grown((APART, (1.1 * NEAR * G * LARGEST**2, fall))) < LARGEST


def test_times_go_with_the_root_of_a_length(fresh):
    """Lengths by 4 and times by 2: no digit changes."""
    large = gap_rule(2 * LARGEST, 2 * SMALLEST, G)
    for k in range(60):
        gap, closing = abs(math.cos(k)) ** 9 * 1e-3, math.sin(k)
        assert large(((4 * gap, 2 * closing),)) == 2 * fresh(((gap, closing),))


@pytest.mark.parametrize("step", [0.29, 0.31, 1.7e-3])
def test_steps_meet_the_jumps_between_two_kicks_and_end_with_the_run(step):
    """A kick acts from half the step before to half the step after; none of them holds a jump."""
    t, before, halves = 0.0, 0.0, []
    limit, fitted = limits(3.0, step, [1.0, 1.25, 2.0])
    while t < 3.0 - 1e-9 * step:
        h = step
        if t + h >= limit:
            h, limit = fitted(t, h)
        assert 0 < h <= step * (1 + 1e-9)
        halves += [t - 0.5 * before, t + 0.5 * h]
        t, before = t + h, h
    assert t == pytest.approx(3.0, abs=1e-9 * step)
    assert all(min(abs(half - jump) for half in halves) < 1e-3 * step for jump in (1.0, 1.25, 2.0))


def test_a_jump_that_is_gone_or_far_changes_no_step():
    assert aligned(1.0, -0.2) == aligned(1.0, 1.001) == aligned(1.0, math.inf) == aligned(1.0, 1e-4) == 1.0
