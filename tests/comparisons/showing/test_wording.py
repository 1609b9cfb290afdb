"""Names and quantities as a reader writes them."""

import pytest

from analytic.response import COMPARED, EDGE, UNCOMPARED, Difference
from comparisons.showing.wording import differing, equal_mark, indexed, listed


@pytest.mark.parametrize(
    ("names", "words"), [([], ""), (["a"], "a"), (["a", "b"], "a and b"), (["a", "b", "c"], "a, b and c")]
)
def test_names_stand_in_a_sentence(names, words):
    assert listed(names) == words


def test_only_a_letter_has_an_index():
    assert indexed("m/(m + m_b), W_D/(4 π E_s), e_φ, x_max") == (
        "m/(m + m<sub>b</sub>), W<sub>D</sub>/(4 π E<sub>s</sub>), e<sub>φ</sub>, x<sub>max</sub>"
    )
    for name in ("rate_before_1", "RSN1605_DUZCE_DZC270.AT2", "analytic._cache", "tilt_at_0.5", "a_long_name"):
        assert indexed(name) == name


def test_what_differs_is_said_near_an_edge_too():
    found = Difference("peak_tilt", 0.0189, 0.009, 0.02, (0.00807, 0.00999))
    near = "0.00807 to 0.00999 in the analytic model within 0.01 % of the scene"
    words = f"peak tilt 0.0189 rad, in the analytic model 0.009 ({near})"
    assert differing(COMPARED, [found]) == differing(EDGE, [found]) == [f"differs from the analytic model: {words}"]
    assert differing(COMPARED, []) == differing(UNCOMPARED, []) == []
    assert differing(EDGE, []) == [
        "agrees with the analytic model within what a change of the scene by 1e-4 does in the model"
    ]
    assert differing("N <= 0", []) == ["cannot be compared with the analytic model: N <= 0"]


@pytest.mark.parametrize(
    "differing_runs, equal, interval, level",
    [
        (0, "yes", (0.0, 0.03), "good"),
        (1, "no", (0.01, 0.06), "fair"),
        (9, "no", (0.06, 0.2), "bad"),
        (0, "inconclusive (too few runs)", (0.0, 0.071), "part"),
    ],
)
def test_so_few_runs_that_they_say_nothing_are_no_trust_either(differing_runs, equal, interval, level):
    found = {"differing": differing_runs, "failed": 0, "runs": 90, "equal": equal, "interval": interval}
    mark = equal_mark(found | {"share": differing_runs / 90})
    assert mark.level == level and mark.words.startswith(f"{differing_runs} of 90 (at most ")
