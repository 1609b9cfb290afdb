"""The answers side by side: ratings are the worst of what was tested, and what was not tested is said."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from analytic import Block, Scene, Start, simulate
from comparisons.report.answer import Stored, judgements_of, not_to_do, own_restitution, setups_of
from comparisons.report.runs import restitution_computed
from comparisons.report.sections import restitution_section
from comparisons.report.write import _outside
from comparisons.showing.parts import RESTITUTION, Judgement, Mark, Section
from comparisons.showing.wording import rating

FINE, COARSE, GIVEN, OTHER = ("exudyn", "fine"), ("exudyn", "coarse"), ("exudyn", "given"), ("mujoco", "fine")
TIERS = {FINE: "tuned", COARSE: "defaults", GIVEN: "assisted", OTHER: "tuned"}
VARIANTS = [
    dict(engine=engine, variant=variant, tier=tier, best=variant == "fine", applies_impact=tier == "assisted")
    for (engine, variant), tier in TIERS.items()
]


def restitution(fine=1e-5):
    errors = {FINE: fine, COARSE: 0.2, GIVEN: 1e-9, OTHER: 1e-4}
    marks = {name: Mark(f"{error:g}", rating(error, 0), value=error) for name, error in errors.items()}
    return Judgement("restitution", marks, RESTITUTION)


def test_rows_of_one_heading_are_one_that_says_what_each_study_found_and_is_as_bad_as_the_worst():
    one, other = ("e", ""), ("e", "fine")
    first = Judgement("shift", {one: Mark("1 % (3 of 4)", "bad", "a", 0.01), other: Mark("2 %", "good", "b", 0.02)})
    second = Judgement("shift", {one: Mark("3 % (5 of 5)", "fair", "c", 0.03)})
    marks = {one: Mark("3 % (5 of 5); 1 % (3 of 4)", "bad", "c; a", 0.03), other: first.marks[other]}
    for order in ((first, second), (second, first)):
        stored = [Stored(str(k), Section(""), judgements=(each,)) for k, each in enumerate(order)]
        assert judgements_of([*stored, Stored("x", Section(""))]) == [Judgement("shift", marks)]
    none = Judgement("shift", {one: Mark("none found", "bad")})
    (row,) = judgements_of([Stored("a", Section(""), judgements=(first, none))])
    assert row.marks[one] == Mark("none found; 1 % (3 of 4)", "bad", "; a")


def decided(*judgements):
    return {(one.engine, one.variant): one for one in setups_of(VARIANTS, judgements)}


def test_what_was_not_tested_is_said_and_counts_for_less_than_trust():
    found = decided(restitution(), Judgement("boundary", {FINE: Mark("0.1 %", "good")}))
    assert found[FINE].rating.level == "good"
    assert found[GIVEN].marks["boundary"].words == "not tested" and found[GIVEN].rating.level == "part"
    assert list(found) == [FINE, COARSE, GIVEN, OTHER]  # the subject's tuned and default settings, then the others
    assert [one.in_first_table for one in found.values()] == [True, True, False, False]
    assert not decided(Judgement("a", {}))  # nothing judges any of them


@pytest.mark.parametrize("level", ["fair", "bad"])
def test_the_worst_mark_is_the_rating(level):
    judgement = Judgement("a", {FINE: Mark("x", level)})
    assert decided(restitution(), judgement)[FINE].rating.level == level


def test_a_row_that_only_informs_changes_no_rating():
    """Whatever it says of whom; where it rates one, whom it does not test is not trusted in all."""
    informs = Judgement("peak", {FINE: Mark("42 %", "none"), COARSE: Mark("0.1 %", "none")})
    alone, beside = decided(restitution()), decided(restitution(), informs)
    assert {name: one.rating for name, one in alone.items()} == {name: one.rating for name, one in beside.items()}
    assert alone[FINE].rating.words == "✓ trust" and not informs.rates
    few = Judgement("outcomes", {FINE: Mark("0 of 9 (at most 30 %)", "part")})
    assert few.rates and decided(restitution(), few)[FINE].rating.words == "✓ as far as tested"
    rates = Judgement("peak", {FINE: Mark("42 %", "none"), COARSE: Mark("x", "bad")})
    assert decided(restitution(), rates)[FINE].rating.level == "part"


def test_a_study_of_engines_as_they_come_judges_the_default_variant():
    judgement = Judgement("odds", {("exudyn", ""): Mark("0 of 9", "good"), COARSE: Mark("5 of 9", "bad")})
    found = decided(judgement)
    assert found[FINE].marks["odds"].words == "0 of 9" and found[COARSE].marks["odds"].words == "5 of 9"


def test_what_not_to_do_counts_the_defaults_that_are_not_to_be_trusted():
    assert "1 of 1 tested are not to be trusted" in not_to_do(list(decided(restitution()).values()))[0]
    good = Judgement("restitution", {COARSE: Mark("1e-5", "good", value=1e-5)}, RESTITUTION)
    assert "0 of 1 tested are" in not_to_do(list(decided(good).values()))[0]


def test_the_blocks_own_restitution_is_that_of_its_engines():
    """The model's row, which has no error to tell, is no setup; a failed run takes the trust away and is said."""
    row = {"engine": "exudyn", "variant": "fine", "rms": 1e-5, "worst": 2e-5, "failed": 0, "lost": 0, "impacts": 9}
    rows = [
        {**row, "engine": "analytic", "variant": None, "rms": 1e-12},
        row,
        {**row, "variant": "coarse", "failed": 2, "lost": 1},
        {**row, "variant": "deaf", "lost": 3},
    ]
    judgement = own_restitution(SimpleNamespace(rows=rows))
    assert {name: (mark.words, mark.level) for name, mark in judgement.marks.items()} == {
        FINE: ("1.0·10⁻⁵", "good"),
        COARSE: ("1.0·10⁻⁵ (2 failed, 1 missed)", "bad"),
        ("exudyn", "deaf"): ("1.0·10⁻⁵ (3 missed)", "bad"),
    }
    outside = own_restitution(SimpleNamespace(rows=rows), "slenderness 0.01 is outside the range")
    assert {mark.level for mark in outside.marks.values()} == {"part"}


def test_impacts_that_an_engine_misses_on_the_scenes_own_block_are_counted():
    scene = Scene(block=Block(mass=1000.0, radius=1.0, slenderness=0.25), start=Start(tilt=0.15), duration=3.0)
    model = simulate(scene, history=False)
    deaf = replace(model, engine="exudyn", impacts=model.impacts[1:])
    rows = [
        SimpleNamespace(
            case=SimpleNamespace(scene=scene, solver=solver, variant=variant),
            failed=False,
            values=response.to_json(),
            cost={"cpu_seconds": 1.0},
        )
        for solver, variant, response in (("analytic", None, model), ("exudyn", "compliant-corners", deaf))
    ]
    found = restitution_computed(rows).rows
    assert [row["lost"] for row in found] == [0, 1] and found[1]["failed"] == 0
    settings = {"starts": [0.6], "seconds": 3.0, "bases": [None]}
    (shown,) = restitution_section(SimpleNamespace(rows=found, settings=settings)).tables
    assert [row[1] for row in shown.rows] == ["may be trusted", "is not to be trusted"]


def test_a_scene_is_outside_the_range_by_what_an_engine_warns_of():
    def rows(kind, quantity):
        warning = {"kind": kind, "quantity": quantity, "text": "slenderness 0.01 is outside the range"}
        return SimpleNamespace(rows=[{"engine": "exudyn", "warnings": [warning]}, {"part": "statue"}])

    assert _outside(rows("engine", "slenderness")) == "slenderness 0.01 is outside the range"
    assert _outside(rows("engine", None)) == _outside(rows("limit", "tilt")) == ""
