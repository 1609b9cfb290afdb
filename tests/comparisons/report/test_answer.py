"""The first screen: verdicts are the worst of what was tested, and what was not tested is said."""

from types import SimpleNamespace

import pytest

from comparisons.report.answer import best_of, not_to_do, recommendation, rows_of
from comparisons.showing.parts import Judgement, Mark

KINDS = {
    "one": {
        "fine": {"tier": "tuned", "best": True, "applies_impact": False},
        "coarse": {"tier": "defaults", "best": False, "applies_impact": False},
    },
    "two": {"given": {"tier": "assisted", "best": True, "applies_impact": True}},
}
REFERENCE = {"cpu_per_second": 1e-4}


def group(solver, variant, rms, cpu, failures=()):
    return {
        "solver": solver,
        "name": f"{solver}, {variant}",
        "default": variant != "coarse",
        "rms": rms,
        "worst": rms and 3 * rms,
        "cpu_per_second": cpu,
        "failures": list(failures),
    }


def decided(*columns, fine=1e-5, failures=()):
    groups = [
        group("one", "coarse", 0.2, 0.01),
        group("one", "fine", fine, 0.05, failures),
        group("two", "given", 1e-9, 0.02),
    ]
    return rows_of(SimpleNamespace(settings={"variants": KINDS}), groups, columns)


def of(rows, variant):
    return next(row for row in rows if row.variant == variant)


def test_what_was_not_tested_is_said_and_counts_for_less_than_trust():
    column = Judgement("boundary", {("one", "fine"): Mark("0.1 %", "good")})
    rows = decided(column)
    assert of(rows, "fine").verdict.level == "good"
    assert of(rows, "given").marks[1].words == "not tested" and of(rows, "given").verdict.level == "part"
    assert rows[0].variant == "fine" and rows[-1].variant == "coarse"  # trusted ones first


@pytest.mark.parametrize("level", ["fair", "bad"])
def test_the_worst_column_is_the_verdict(level):
    columns = [
        Judgement("a", {("one", "fine"): Mark("x", "good")}),
        Judgement("b", {("one", "fine"): Mark("y", level)}),
    ]
    assert of(decided(*columns), "fine").verdict.level == level


def test_a_study_of_engines_as_they_come_judges_the_default_variant():
    column = Judgement("odds", {("one", ""): Mark("0 of 9", "good"), ("one", "coarse"): Mark("5 of 9", "bad")})
    rows = decided(column)
    assert of(rows, "fine").marks[1].words == "0 of 9" and of(rows, "coarse").marks[1].words == "5 of 9"


def test_failed_runs_and_errors_take_trust_away():
    assert of(decided(failures=[{"reason": "NaN"}]), "fine").verdict.level == "bad"
    assert of(decided(fine=5e-3), "fine").verdict.level == "fair"
    assert of(decided(fine=5e-2), "fine").verdict.level == "bad"


def test_the_recommendation_decides_its_impacts_itself_and_says_where_it_ends():
    rows = decided()
    assert best_of(rows).variant == "fine"  # “given” is cheaper, but its adapter applies the impact
    words = " ".join(recommendation(rows, REFERENCE, "slenderness [rad] 0.1 to 0.5"))
    assert "one set as “fine”" in words and "500 times" in words and "slenderness [rad] 0.1 to 0.5" in words
    assert "no engine that was run here" in " ".join(recommendation(decided(fine=0.1), REFERENCE, ""))
    assert "Do not use default settings: 1 of 1 fail" in not_to_do(rows)[0] and len(not_to_do(rows)) == 3
