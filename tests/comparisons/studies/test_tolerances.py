"""The tolerances study: its page shows every row, and what does not hold is a problem."""

import pytest

from comparisons.measuring.tolerances import TABLE
from comparisons.running.provenance import Result
from comparisons.studies import get_study

STUDY = get_study("tolerances")


@pytest.mark.parametrize("broken", [0, 1])
def test_every_row_is_shown_and_what_does_not_hold_is_a_problem(broken):
    rows = [
        {"part": "tolerance", **row.result(3 * row.bound if k < broken else row.measured, None)}
        for k, row in enumerate(TABLE)
    ]
    result = Result("tolerances", {"engines": sorted({row.engine for row in TABLE})}, rows, {})
    page = STUDY.page(result)
    (shown,) = page.whole().tables
    assert [row[0] for row in shown.rows] == [f"{row.engine}, {row.variant}" for row in TABLE]
    assert [row[7] for row in shown.rows] == ["no"] * broken + ["yes"] * (len(TABLE) - broken)
    assert (f"{broken} of {len(TABLE)} do not hold" in page.title) is bool(broken)
    assert [TABLE[0].quantity in words for words in STUDY.problems(result)] == [True] * broken
