"""Names and quantities as a reader writes them."""

import pytest

from comparisons.showing.wording import indexed, listed


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
