"""How the age of a result is said in a heading."""

import pytest

from comparisons.running.age import briefly


@pytest.mark.parametrize(
    "words, brief",
    [
        ("older than the code: computed on 2026-01-01 at commit abc; since then changed: a", "older than the code"),
        ("apart from the rows of b older than the code: computed on 2026-01-01", "in part older than the code"),
        ("in the rows of b older than the code: computed on 2026-01-01", "in part older than the code"),
        ("computed with other versions than those here: b 1 (here 2)", "computed with other versions"),
    ],
)
def test_a_heading_says_that_it_is_old_and_not_why(words, brief):
    assert briefly(words) == brief
