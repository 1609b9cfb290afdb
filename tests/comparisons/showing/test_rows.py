"""Rows: chosen, grouped, and written as cells; a page says once what the report and the study's own page show."""

import doctest
import math

import pytest
from page_numbers import number_in

from comparisons.showing import parts as module
from comparisons.showing.parts import NAME, Column, Figure, Head, Page, grouped, number, percent, short, table, where

ROWS = [
    {"part": "cell", "engine": "one", "variant": "fine", "ratio": None, "rms": 1.234e-5, "failed": 0, "runs": 4},
    {"part": "cell", "engine": "two", "variant": "fine", "ratio": 0.5, "rms": None, "failed": 4, "runs": 4},
    {"part": "order", "engine": "one", "variant": "fine", "order": 2.0},
    {"part": "cell", "engine": "one", "variant": "coarse", "ratio": 0.5, "rms": 0.25, "failed": 1, "runs": 4}
    | {"state": {"tilt": 0.1}},
]


def test_the_examples():
    found = doctest.testmod(module)
    assert found.attempted and not found.failed


def test_a_row_without_the_column_is_chosen_for_no_value():
    assert where(ROWS, ratio=None) == ROWS[:1]
    assert where(ROWS, part="cell", ratio={None, 0.5}, engine="one") == [ROWS[0], ROWS[3]]
    assert where(ROWS, part="none") == [] and where(ROWS) == ROWS


def test_groups_keep_the_order_of_rows_and_of_keys():
    groups = grouped(ROWS, "engine", lambda row: row["part"])
    assert list(groups) == [("one", "cell"), ("two", "cell"), ("one", "order")]
    assert groups["one", "cell"] == [ROWS[0], ROWS[3]]
    with pytest.raises(KeyError, match="rms"):
        grouped(ROWS, "rms")


@pytest.mark.parametrize(
    "column, cells",
    [
        (Column("rms", "rms"), ["1.2·10⁻⁵", "–", "0.25"]),
        (Column("rms", "rms", digits=3), ["1.23·10⁻⁵", "–", "0.250"]),
        (Column("rms", "rms", digits=None), ["1.23·10⁻⁵", "–", "0.25"]),
        (Column("share", lambda row: row["failed"] / row["runs"], percent=True), ["0 %", "100 %", "25 %"]),
        (Column("failed", "{failed} of {runs}"), ["0 of 4", "4 of 4", "1 of 4"]),  # whatever else the row holds
        (Column("both", lambda row: [row["runs"], row["rms"]]), ["4, 1.2·10⁻⁵", "4, –", "4, 0.25"]),
        (
            Column("rms", "rms", within=lambda row: row["rms"] and [0.1, 2]),
            ["1.2·10⁻⁵ (0.10 to 2)", "–", "0.25 (0.10 to 2)"],
        ),
        (NAME, ["one, fine", "two, fine", "one, coarse"]),
    ],
)
def test_cells(column, cells):
    assert [column.text(row) for row in where(ROWS, part="cell")] == cells
    assert NAME.text({"engine": "analytic", "variant": ""}) == "analytic"


def test_a_table_names_its_rows_first_and_asks_for_its_columns():
    made = table("Errors", where(ROWS, part="cell"), NAME, Column("error [-]", "rms"))
    assert made.columns == ("engine, variant", "error [-]") and made.rows[0] == ["one, fine", "1.2·10⁻⁵"]
    assert number_in(made.rows[2][1]) == 0.25
    with pytest.raises(KeyError, match="rms"):
        table("Errors", ROWS, Column("error [-]", "rms"))


@pytest.mark.parametrize("value, words", [(10.0, "10"), (0.3, "0.3"), (2e11, "2·10¹¹"), (1e-4, "10⁻⁴"), (100, "100")])
def test_chosen_numbers_are_as_short_as_they_are(value, words):
    assert short(value) == words


def test_a_page_opens_the_report_and_leaves_out_what_is_not_there():
    figure, tables = Figure(b"<svg/>", "A line.", "Look."), [table(str(k), ROWS, NAME) for k in range(2)]
    empty = table("None", [], NAME)
    more = (Head("More"), "Words.", tables[1], None, empty)
    page = Page("Subject: found", ("Lead.",), (figure, tables[0]), more, ("How.",), (("reason", "message"),))
    opening, whole = page.opening(), page.whole()
    assert opening.shown == (figure, tables[0]) and opening.evidence == () and opening.measured == ("How.",)
    assert whole.shown == (figure, tables[0], Head("More"), "Words.", tables[1])
    assert whole.tables == tuple(tables) and whole.figures == (figure,) and whole.evidence == (("reason", "message"),)
    assert Page("Subject: found", ("Lead.",), more=more).opening() is None


@pytest.mark.parametrize(
    "given, shown",
    [
        (None, "–"),
        (math.nan, "–"),
        (0.0, "0"),
        (0.21234, "0.212"),
        (-1.5, "−1.50"),
        (12345.6, "12346"),
        (0.001, "0.00100"),
        (0.000999, "9.99·10⁻⁴"),
        (-1.25e-17, "−1.25·10⁻¹⁷"),
        (123456.0, "1.23·10⁵"),
    ],
)
def test_numbers_are_written_for_reading(given, shown):
    assert number(given) == shown


def test_fractions_in_per_cent():
    assert percent(0.0213) == "2.1 %" and percent(None) == "–"


@pytest.mark.parametrize(
    "fraction, words",
    [
        (0, "0 %"),
        (1, "100 %"),
        (0.004, "0.40 %"),
        (3e-4, "0.030 %"),
        (0.995, "99.5 %"),
        (0.99996, "99.996 %"),
        (2.0, "200 %"),
    ],
)
def test_a_share_is_0_and_100_per_cent_only_where_it_is_none_and_all(fraction, words):
    assert percent(fraction) == words
