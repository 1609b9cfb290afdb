"""Overturning boundaries of the analytic model, and a search beside one of them."""

import dataclasses

import numpy as np
import pytest
from literature import ONE_SINE, under_a_pulse

from analytic import PulseMotion, simulate
from comparisons.measuring.boundaries import Edge, edges, least_normal, locate, pulse
from comparisons.running.refine import drive

# the block of the published boundaries
SCENE = under_a_pulse(1.0, 1.0).with_(motion=None, duration=None)
EDGE = Edge("rigid ground", "one-sine", 4.0, 5.0, True, 0, 4.9, 6.0, 0.1)


def test_edges_are_the_published_boundaries_and_the_safe_gap():
    found = edges(SCENE, "rigid", "one-sine", (2.0, 4.0, 8.0))
    for frequency in (2.0, 4.0, 8.0):
        column, amplitudes = [edge for edge in found if edge.frequency == frequency], ONE_SINE[frequency]
        # published over g gamma, here over g tan(gamma)
        mine = [edge.amplitude * np.tan(0.25) / 0.25 for edge in column]
        assert mine == pytest.approx(amplitudes, rel=2e-5)
        assert [(edge.rises, edge.mode) for edge in column] == [(True, 1), (False, 1), (True, 0)][-len(amplitudes) :]
        for one, other in zip(column, column[1:], strict=False):
            assert one.high == other.low == pytest.approx(np.sqrt(one.amplitude * other.amplitude))
    for edge in found:
        beside = [pulse(SCENE, edge.shape, edge.frequency, edge.amplitude * side) for side in (1 - 1e-4, 1 + 1e-4)]
        runs = [simulate(SCENE.with_(motion=motion)) for motion in beside]
        assert [run.outcome == "overturns" for run in runs] == [not edge.rises, edge.rises]
        assert all(run.decided for run in runs)
    assert edges(SCENE, "rigid", "one-cosine", (8.0,)) == []  # where none overturns
    assert least_normal(SCENE, PulseMotion("one-sine", 0.1, 5.0)) == 1.0


def search(edge, outcome, distances=((2e-4, 1.2e-2), (0.1,)), tolerance=2e-5):
    (found,) = drive([locate(edge, distances, tolerance)], lambda batch: [outcome(a) for _, a in batch])
    return found


@pytest.mark.parametrize("shift", [0.0, 3e-5, -1e-4, 4e-3, -0.015, 0.08])
def test_a_shifted_boundary_is_found_to_its_tolerance(shift):
    for edge in (EDGE, dataclasses.replace(EDGE, rises=False)):
        found = search(edge, lambda amplitude, rises=edge.rises: (amplitude > 5.0 * (1 + shift)) == rises)
        assert found.half_width <= 1e-5 and abs(found.shift - shift) <= found.half_width * (1 + 1e-9)


@pytest.mark.parametrize(
    "outcome, reason",
    [
        (lambda amplitude: True, "overturns on both sides"),
        (lambda amplitude: False, "stands on both sides"),
        (lambda amplitude: None, "no run was decided"),
        (lambda amplitude: bool(amplitude < 5.0), "outcomes the other way round"),
        # too wide a bracket to tell
        (
            lambda amplitude: None if abs(amplitude / 5.0 - 1) < 0.011 else amplitude > 5.0,
            "undecided between -1.2 and +1.2 %",
        ),
    ],
)
def test_a_boundary_that_is_not_there_is_said_to_be_missing(outcome, reason):
    found = search(EDGE, outcome)
    assert found.shift is None and found.half_width is None and found.reason.startswith(reason)


def test_the_search_stays_on_its_side_of_the_middle_between_two_boundaries():
    asked = []
    search(EDGE, lambda amplitude: asked.append(amplitude) or False)
    assert 4.9 < min(asked) and max(asked) < 6.0
    assert min(asked) == pytest.approx(5.0 - 0.9 * 0.1)
    assert search(EDGE, lambda amplitude: bool(amplitude > 5.0)).runs <= 4 + 7


def test_an_undecided_run_widens_the_bracket_instead_of_taking_a_side():
    found = search(EDGE, lambda amplitude: None if abs(amplitude / 5.0 - 1) < 1e-4 else bool(amplitude > 5.0))
    assert abs(found.shift) <= found.half_width and 1e-4 <= found.half_width <= 2e-4
