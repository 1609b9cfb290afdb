"""The class of a run: by what counts, and left out by the model's word alone."""

import pytest

from analytic.response import EDGE
from comparisons.measuring.statistics import CLASSES, class_of
from engines.comparison import END


@pytest.mark.parametrize(
    "comparable, quantities, counted, word",
    [
        ("yes", [], None, "right"),
        ("yes", ["peak_tilt"], None, "differs"),
        ("yes", ["peak_tilt"], END, "right"),
        ("yes", ["peak_tilt", "fall_time"], END, "differs"),  # it falls in both, at another time
        ("yes", ["impacts_before_fall"], END, "differs"),
        ("yes", None, END, "failed"),
        (EDGE, None, None, "left out"),
        (EDGE, ["outcome"], None, "left out"),
        ("the normal force falls to 0 in the analytic model", [], None, "left out"),
    ],
)
def test_one_word_for_each_run(comparable, quantities, counted, word):
    assert class_of(comparable, quantities, counted) == word and word in CLASSES
