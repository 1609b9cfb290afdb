"""What the page says of one impact in steps."""

import math
import re

import pytest

from analytic import simulate
from analytic.time_stepping import simulate_time_stepping
from comparisons.lessons.engine_runs import SCENE
from comparisons.report.equations import STEP, frames


def errors(step):
    """(shift of the first impact [ms], error of the rate after it [%]), rms over 201 steps within a tenth."""
    exact = simulate(SCENE).impacts[0]
    hits = [simulate_time_stepping(SCENE, step=step * (0.9 + 0.001 * k)).impacts[0] for k in range(201)]
    shifts, rates = [hit.time - exact.time for hit in hits], [hit.rate_after / exact.rate_after - 1 for hit in hits]
    return [scale * math.hypot(*some) / math.sqrt(len(some)) for scale, some in ((1e3, shifts), (100, rates))]


def test_the_error_that_is_told_falls_with_the_step_and_whose_steps_they_are_is_said():
    first, _, third, fourth = (words for _, words in frames())
    shift, half = map(float, re.search(r"by ([\d.]+) ms, half of them by ([\d.]+) ms", first).groups())
    rate, finer = map(float, re.search(r"off by ([\d.]+) %, with half the step by ([\d.]+) %", fourth).groups())
    assert 1.8 < shift / half < 2.2 and 1.8 < rate / finer < 2.2  # of first order
    assert [shift, rate] == pytest.approx(errors(STEP), rel=0.1)
    assert [half, finer] == pytest.approx(errors(STEP / 2), rel=0.1)
    assert f"{1e3 * STEP:g} ms" in first and "project’s own time stepping, not an engine’s" in first
    assert "Drawn by hand" in third
