"""The first screen: ratings are the worst of what was tested, and what was not tested is said."""

import pytest

from comparisons.report.answer import best_of, not_to_do, recommendation, rows_of
from comparisons.showing.parts import Judgement, Mark


def rated(engine, variant, tier, rms, cpu, failed=0):
    return {
        "engine": engine,
        "variant": variant,
        "tier": tier,
        "best": variant != "coarse",
        "applies_impact": tier == "assisted",
        "rms": rms,
        "worst": 3 * rms,
        "cpu_per_second": cpu,
        "failed": failed,
    }


def decided(*columns, fine=1e-5, failed=0):
    return rows_of(
        [
            rated("one", "coarse", "defaults", 0.2, 0.01),
            rated("one", "fine", "tuned", fine, 0.05, failed),
            rated("two", "given", "assisted", 1e-9, 0.02),
        ],
        columns,
    )


def of(rows, variant):
    return next(row for row in rows if row.variant == variant)


def test_what_was_not_tested_is_said_and_counts_for_less_than_trust():
    column = Judgement("boundary", {("one", "fine"): Mark("0.1 %", "good")})
    rows = decided(column)
    assert of(rows, "fine").rating.level == "good"
    assert of(rows, "given").marks[1].words == "not tested" and of(rows, "given").rating.level == "part"
    assert rows[0].variant == "fine" and rows[-1].variant == "coarse"  # trusted ones first


@pytest.mark.parametrize("level", ["fair", "bad"])
def test_the_worst_column_is_the_rating(level):
    columns = [Judgement("a", {("one", "fine"): Mark("x", mark)}) for mark in ("good", level)]
    assert of(decided(*columns), "fine").rating.level == level


def test_a_study_of_engines_as_they_come_judges_the_default_variant():
    column = Judgement("odds", {("one", ""): Mark("0 of 9", "good"), ("one", "coarse"): Mark("5 of 9", "bad")})
    rows = decided(column)
    assert of(rows, "fine").marks[1].words == "0 of 9" and of(rows, "coarse").marks[1].words == "5 of 9"


@pytest.mark.parametrize(
    "found, level", [({"failed": 1}, "bad"), ({"fine": 5e-3}, "fair"), ({"fine": 5e-2}, "bad")], ids=str
)
def test_failed_runs_and_errors_take_trust_away(found, level):
    assert of(decided(**found), "fine").rating.level == level


def test_the_recommendation_decides_its_impacts_itself_and_says_where_it_ends():
    rows = decided()
    assert best_of(rows).variant == "fine"  # “given” is cheaper, but its adapter applies the impact
    words = " ".join(recommendation(rows, "slenderness [rad] 0.1 to 0.5"))
    assert "one set as “fine”" in words and "0.050 s of CPU time" in words and "slenderness [rad] 0.1 to 0.5" in words
    assert "no engine that was run here" in " ".join(recommendation(decided(fine=0.1), ""))
    assert "Do not use default settings: 1 of 1 fail" in not_to_do(rows)[0] and len(not_to_do(rows)) == 3
