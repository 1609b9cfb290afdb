"""Rows chosen, grouped and written as cells; names, numbers and counts in words."""

import doctest
import math

import pytest
from page_numbers import number_in

from analytic.response import COMPARED, EDGE, UNCOMPARED, Difference
from comparisons.plotting import parts as module
from comparisons.plotting.parts import SIGNS, Mark, grouped, table, where
from comparisons.plotting.wording import (
    ENDS,
    differing,
    ends,
    equal_mark,
    indexed,
    least_shown,
    left_out,
    listed,
    tally,
)
from comparisons.schemas.columns import NAME, Column, number, percent, short, spelled, spelled_page

ROWS = [
    {"part": "cell", "engine": "one", "variant": "fine", "ratio": None, "rms": 1.234e-5, "failed": 0, "runs": 4},
    {"part": "cell", "engine": "two", "variant": "fine", "ratio": 0.5, "rms": None, "failed": 4, "runs": 4},
    {"part": "order", "engine": "one", "variant": "fine", "order": 2.0},
    {"part": "cell", "engine": "one", "variant": "coarse", "ratio": 0.5, "rms": 0.25, "failed": 1, "runs": 4}
    | {"state": {"tilt": 0.1}},
]


def test_the_examples():
    report = doctest.testmod(module)
    assert report.attempted and not report.failed


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


@pytest.mark.parametrize(
    ("names", "words"), [([], ""), (["a"], "a"), (["a", "b"], "a and b"), (["a", "b", "c"], "a, b and c")]
)
def test_names_stand_in_a_sentence(names, words):
    assert listed(names) == words


def test_only_a_letter_has_an_index():
    assert indexed("m/(m + m_b), W_D/(4 π E_s), e_φ, x_max") == (
        "m/(m + m<sub>b</sub>), W<sub>D</sub>/(4 π E<sub>s</sub>), e<sub>φ</sub>, x<sub>max</sub>"
    )
    for name in ("rate_before_1", "RSN1605_DUZCE_DZC270.AT2", "analytic.kernel.cache", "tilt_at_0.5", "a_long_name"):
        assert indexed(name) == name


def test_what_differs_is_said_near_an_edge_too():
    difference = Difference("peak_tilt", 0.0189, 0.009, 0.02, (0.00807, 0.00999))
    near = "0.00807 to 0.00999 in the analytic model within 0.01 % of the scene"
    words = f"peak tilt 0.0189 rad, in the analytic model 0.009 ({near})"
    assert (
        differing(COMPARED, [difference])
        == differing(EDGE, [difference])
        == [f"differs from the analytic model: {words}"]
    )
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
        (5, "inconclusive (too few runs)", (0.02, 0.2), "fair"),  # 5.6 % of them: not good in all that was tested
    ],
)
def test_so_few_runs_that_they_say_nothing_are_no_trust_either(differing_runs, equal, interval, level):
    row = {"differing": differing_runs, "failed": 0, "runs": 90, "equal": equal, "interval": interval}
    mark = equal_mark(row | {"share": differing_runs / 90})
    assert mark.level == level and mark.words.startswith(f"{differing_runs} of 90 (at most ")


def run(word, model="rocks", engine="rocks", quantities=(), comparable=COMPARED, group=0):
    known = {"class": word, "model": model, "outcome": engine, "quantities": quantities, "comparable": comparable}
    return known | {"group": group}


def turned(row):
    return (row["outcome"] == "overturns") != (row["model"] == "overturns")


RUNS = [
    run("right", group=0),
    run("differs", "overturns", "rocks", ["outcome"], group=0),
    run("differs", "rocks", "overturns", ["outcome", "restitution"], group=1),
    run("differs", "overturns", "overturns", ["fall_time", "peak_base_displacement"], group=1),
    run("differs", "overturns", "overturns", ["impacts_before_fall"], group=2),
    run("differs", "rocks", "stands", ["outcome", "peak_tilt"], group=2),
    run("differs", "rocks", "rocks", ["peak_tilt"], group=3),
    run("failed", engine="failed", group=3),
    run("left out", "overturns", "rocks", ["outcome"], EDGE, group=4),
    run("left out", comparable="N <= 0", group=4),
]


def test_a_fall_at_another_time_is_no_other_outcome_and_each_run_is_in_one_column():
    counts = tally(RUNS, "group", turned)
    assert [counts[way] for way in ENDS] == [2, 2, 1, 1, 1, 1, 1]
    assert (counts["runs"], counts["groups"], counts["differing"]) == (8, 4, 7) and counts["share"] == 7 / 8
    assert [column.value for column in ends([counts])] == list(ENDS)
    bare = tally(RUNS[:1], "group", turned)
    assert [ENDS[column.value] for column in ends([bare])] == [
        "overturning missed or added [-]",
        "falls at another time [-]",
        "failed [-]",
        "left out near an outcome boundary [-]",
    ]
    assert left_out(counts) == "left out: 1 near an outcome boundary, 1 for other reasons"
    assert left_out(bare) == "left out: 0 near an outcome boundary"


def test_what_so_few_motions_can_show_is_computed_from_their_number():
    """Wilson's upper limit of none of n: z²/(n + z²)."""
    rows = [{"groups": 50}, {"groups": 20}, {"groups": 50}, {"groups": 0}]
    fifty, twenty = (100 * 1.96**2 / (size + 1.96**2) for size in (50, 20))
    assert least_shown(rows, "records") == (
        f"50 records cannot show less than {fifty:.1f} % and 20 cannot show less than {twenty:.0f} %"
    )


def test_no_mark_is_told_by_its_colour_alone():
    signs = [Mark("1", level).sign for level in SIGNS]
    assert len(set(signs)) == len(SIGNS) == 5 and all(signs)


@pytest.mark.parametrize(
    "text, shown",
    [
        ("1 of 2 (pybullet); none in mujoco.", "1 of 2 (PyBullet); none in MuJoCo."),
        ("rocking run SCENE --engine pybullet", "rocking run SCENE --engine pybullet"),
        ("pip install rocking[dart,drake]", "pip install rocking[dart,drake]"),
        ("engines/dart/adapter.py, import mujoco.viewer", "engines/dart/adapter.py, import mujoco.viewer"),
    ],
)
def test_engines_are_called_as_their_makers_write_them_but_where_a_name_is_typed(text, shown):
    assert spelled(text) == shown
    assert spelled_page(f'<p title="{text}" data-who="pybullet">{text}</p><code>pybullet</code>') == (
        f'<p title="{text}" data-who="pybullet">{shown}</p><code>pybullet</code>'
    )
