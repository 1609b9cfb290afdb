"""The search on synthetic outcomes whose boundaries are known, and on published ones of the rocking block."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from literature import ONE_SINE

from analytic import Block, PulseMotion, Scene, simulate
from comparisons.running.refine import boundaries, drive


def steps(*edges, labels=None):
    """Outcome that changes at every edge."""
    names = labels or [bool(i % 2) for i in range(len(edges) + 1)]
    return lambda point: names[int(np.searchsorted(edges, point, side="right"))]


def alone(search, outcome, seen=None):
    def evaluate(batch):
        if seen is not None:
            seen.append([point for _, point in batch])
        return [outcome(point) for _, point in batch]

    (result,) = drive([search], evaluate)
    return result


# What a column of a pulse's map can look like: safe, overturns after one impact, safe gap, overturns without impact
@pytest.mark.parametrize("edges", [(1.2509, 2.37418, 2.40806), (4.91994, 8.50817, 9.91798), (15.9047,), ()])
def test_all_transitions_of_a_column_are_found(edges):
    seen = []
    labels = ["safe", "one", "safe", "none"][: len(edges) + 1]
    column = alone(boundaries(0.5, 20.5, 41, 1e-5), steps(*edges, labels=labels), seen)
    assert [t.position for t in column.transitions] == pytest.approx(edges, abs=1e-5)
    assert all(t.high - t.low <= 1e-5 for t in column.transitions)
    assert [t.before for t in column.transitions] == labels[:-1]
    assert [t.after for t in column.transitions] == labels[1:]
    points = [point for batch in seen for point in batch]
    assert column.evaluations == len(points) == len(set(points))
    assert len(seen) <= 2 + 16  # rounds: scan, near, bisection of 0.125 to 1e-5


def test_a_gap_thinner_than_the_scan_is_found_between_two_ways_to_overturn():
    edges = (1.2509, 7.30001, 7.30051)
    labelled = alone(boundaries(0.5, 20.5, 41, 1e-5), steps(*edges, labels=["safe", "one", "safe", "none"]))
    assert [t.position for t in labelled.transitions] == pytest.approx(edges, abs=1e-5)
    # Plain outcomes cannot show it: why labels should say more.
    plain = alone(boundaries(0.5, 20.5, 41, 1e-5), steps(*edges))
    assert [t.position for t in plain.transitions] == pytest.approx(edges[:1], abs=1e-5)


def test_a_thin_gap_beside_a_change_is_found_by_the_closer_look():
    edges = (5.9, 6.05, 6.20)  # scan step 0.5; gap 0.15 wide, not hit by the scan's points, in neighbouring steps
    near = alone(boundaries(0.5, 20.5, 41, 1e-4), steps(*edges))
    assert [t.position for t in near.transitions] == pytest.approx(edges, abs=1e-4)
    without = alone(boundaries(0.5, 20.5, 41, 1e-4, near=1), steps(*edges))
    assert len(without.transitions) == 1


def test_many_columns_go_through_in_common_rounds():
    edges = {i: (1 + 0.3 * i, 3 + 0.4 * i) for i in range(10)}
    rounds = []

    def evaluate(batch):
        rounds.append(len(batch))
        return [steps(*edges[index])(point) for index, point in batch]

    columns = drive([boundaries(0.0, 10.0, 21, 1e-3) for _ in edges], evaluate)
    for index, column in enumerate(columns):
        assert [t.position for t in column.transitions] == pytest.approx(edges[index], abs=1e-3)
    assert len(rounds) == 2 + 7  # 0.125 halved to below 1e-3
    assert sum(rounds) == sum(column.evaluations for column in columns)
    # brute force to 1e-3 takes 10 001 points a column
    assert sum(rounds) / len(columns) < 60


@given(st.lists(st.floats(0.01, 0.99), min_size=0, max_size=6, unique=True), st.integers(2, 60))
@settings(max_examples=60, deadline=None)
def test_every_bracket_holds_an_edge_and_wide_stretches_are_never_missed(edges, scan):
    edges = sorted(edges)
    column = alone(boundaries(0.0, 1.0, scan, 1e-6), steps(*edges))
    for transition in column.transitions:
        assert any(transition.low <= edge <= transition.high for edge in edges)
        assert transition.before != transition.after
    outer = [0.0, *edges, 1.0]
    if all(b - a > 1 / (scan - 1) for a, b in zip(outer[:-1], outer[1:], strict=True)):
        assert len(column.transitions) == len(edges)


def test_what_cannot_be_searched_is_an_error():
    for wrong in ((1, 0, 5, 0.1), (0, 1, 1, 0.1), (0, 1, 5, 0.0), (0, 1, 5, 0.1, 0)):
        with pytest.raises(ValueError, match="boundaries needs low < high"):
            boundaries(*wrong)
    with pytest.raises(ValueError, match="0 outcomes were sent for 2 points"):
        drive([boundaries(0.0, 1.0, 2, 0.1)], lambda batch: [])


def test_the_rocking_block_s_boundaries_and_safe_gap():
    gravity, gamma, frequency = 9.81, 0.25, 2.14
    block = Block(mass=1.0, radius=0.75 * gravity / frequency**2, slenderness=gamma, restitution=0.9)
    ratios = list(ONE_SINE)

    def evaluate(batch):
        labels = []
        for index, amplitude in batch:
            pulse = PulseMotion("one-sine", amplitude * gravity * gamma, ratios[index] * frequency)
            end = simulate(Scene(block=block, motion=pulse, duration=12.0), history=False)
            labels.append(("overturns", end.impact_count) if end.outcome == "overturns" else "safe")
        return labels

    # 0.7 wide steps would miss the gap of 0.034 at ratio 2; the two ways to overturn give it away
    columns = drive([boundaries(1.01, 18.01, 25, 1e-6) for _ in ratios], evaluate)
    for ratio, column in zip(ratios, columns, strict=True):
        assert [t.position for t in column.transitions] == pytest.approx(ONE_SINE[ratio], abs=1e-5)
        assert column.evaluations < 120
