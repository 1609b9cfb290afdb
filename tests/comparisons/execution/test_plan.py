"""The search on synthetic outcomes whose boundaries are known, and on published ones of the rocking block."""

from functools import partial

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from literature import ONE_SINE

from analytic import Block, PulseMotion, Scene, simulate
from comparisons.execution.plan import boundaries, drive


def steps(*edges, labels=None):
    """Outcome that changes at every edge."""
    names = labels or [bool(i % 2) for i in range(len(edges) + 1)]
    return lambda point: names[int(np.searchsorted(edges, point, side="right"))]


def along(*searches_outcomes, seen=None):
    """The `Transitions` of each of (search, outcome of a point); the rounds' points go to `seen`."""
    searches, outcomes = zip(*searches_outcomes, strict=True)
    seen = [] if seen is None else seen

    def evaluate(batch):
        seen.append([point for _, point in batch])
        return [outcomes[index](point) for index, point in batch]

    return drive(searches, evaluate)


def positions(column):
    return [transition.position for transition in column.transitions]


# What a column of a pulse's map can look like: safe, overturns after one impact, safe gap, overturns without impact
COLUMNS = [(1.2509, 2.37418, 2.40806), (4.91994, 8.50817, 9.91798), (15.9047,), ()]


def test_all_transitions_of_columns_are_found_in_common_rounds():
    seen, labels = [], ["safe", "one", "safe", "none"]
    outcomes = [steps(*edges, labels=labels[: len(edges) + 1]) for edges in COLUMNS]
    columns = along(*((boundaries(0.5, 20.5, 41, 1e-5), outcome) for outcome in outcomes), seen=seen)
    for edges, column in zip(COLUMNS, columns, strict=True):
        assert positions(column) == pytest.approx(edges, abs=1e-5)
        assert all(transition.high - transition.low <= 1e-5 for transition in column.transitions)
        assert [transition.before for transition in column.transitions] == labels[: len(edges)]
        assert [transition.after for transition in column.transitions] == labels[1 : len(edges) + 1]
    assert len(seen) == 2 + 14  # rounds: scan, near, bisection of 0.125 to below 1e-5
    for edges, column, close in zip(
        COLUMNS, columns, (5, 8, 3, 0), strict=True
    ):  # intervals with a change or beside it
        assert column.evaluations == 41 + 3 * close + 14 * len(edges)
    assert sum(map(len, seen)) == sum(column.evaluations for column in columns)


def test_a_thin_gap_beside_a_change_is_found_by_the_closer_look():
    edges = (5.9, 6.05, 6.20)  # scan step 0.5; gap 0.15 wide, not hit by the scan's points, in neighbouring steps
    near, without = along(*((boundaries(0.5, 20.5, 41, 1e-4, near), steps(*edges)) for near in (4, 1)))
    assert positions(near) == pytest.approx(edges, abs=1e-4) and len(without.transitions) == 1


@given(st.lists(st.floats(0.01, 0.99), min_size=0, max_size=6, unique=True), st.integers(2, 60))
@settings(max_examples=60, deadline=None)
def test_every_bracket_holds_an_edge_and_wide_stretches_are_never_missed(edges, scan):
    edges = sorted(edges)
    (column,) = along((boundaries(0.0, 1.0, scan, 1e-6), steps(*edges)))
    for transition in column.transitions:
        assert any(transition.low <= edge <= transition.high for edge in edges)
        assert transition.before != transition.after
    outer = [0.0, *edges, 1.0]
    if all(b - a > 1 / (scan - 1) for a, b in zip(outer[:-1], outer[1:], strict=True)):
        assert len(column.transitions) == len(edges)


def test_the_rocking_block_s_boundaries_and_safe_gap():
    gravity, gamma, frequency = 9.81, 0.25, 2.14
    block = Block(mass=1.0, radius=0.75 * gravity / frequency**2, slenderness=gamma, restitution=0.9)

    def outcome(amplitude, ratio):
        pulse = PulseMotion("one-sine", amplitude * gravity * gamma, ratio * frequency)
        end = simulate(Scene(block=block, motion=pulse, duration=12.0), history=False)
        return ("overturns", end.impact_count) if end.outcome == "overturns" else "safe"

    # 0.7 wide steps would miss the gap of 0.034 at ratio 2; the two ways to overturn give it away
    columns = along(*((boundaries(1.01, 18.01, 25, 1e-6), partial(outcome, ratio=ratio)) for ratio in ONE_SINE))
    for ratio, column in zip(ONE_SINE, columns, strict=True):
        assert positions(column) == pytest.approx(ONE_SINE[ratio], abs=1e-5)
        assert column.evaluations < 120
