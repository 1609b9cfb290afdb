"""The table of tolerances in the report: it shows every row, and what does not hold is a problem."""

import dataclasses

import pytest

from comparisons.measuring.tolerances import TABLE
from comparisons.running.provenance import Result
from comparisons.studies import get_study, study_names

SHOWN = get_study("tolerances")


@pytest.mark.parametrize("broken", [0, 1])
def test_every_row_is_shown_and_what_does_not_hold_is_a_problem(broken):
    rows = [
        {"part": "tolerance", **row.result(3 * row.bound if k < broken else row.measured, None)}
        for k, row in enumerate(TABLE)
    ]
    result = Result("tolerances", {}, rows, {})
    page = SHOWN.page(result)
    (shown,) = page.whole().tables
    assert [row[0] for row in shown.rows] == [f"{row.engine}, {row.variant}" for row in TABLE]
    assert [row[7] for row in shown.rows] == ["no"] * broken + ["yes"] * (len(TABLE) - broken)
    assert (f"{broken} of {len(TABLE)} do not hold" in page.title) is bool(broken)


def test_without_a_bound_nothing_holds_or_fails():
    row = {"part": "tolerance", **dataclasses.replace(TABLE[0], bound=None, measured=None).result(0.1, None)}
    page = SHOWN.page(Result("tolerances", {}, [row], {}))
    ((*_, bound, then, now, _, holds, _),) = page.whole().tables[0].rows
    assert (bound, then, now, holds) == ("–", "–", "0.100", "no bound stated")
    assert page.title == "Agreement tolerances: all hold" and page.lead[0].startswith("0 tolerances")


def test_it_is_no_study_and_who_asks_for_it_as_one_is_told_the_command(rocking, tmp_path):
    status, out, err = rocking("study", "tolerances", "--output", tmp_path / "study")
    assert status == 2 and "rocking verify --output DIR measures and writes it" in err
    assert "tolerances" not in study_names() and not (tmp_path / "study").exists()
