"""The first screen: ratings are the worst of what was tested, counts are those of runs, what was not tested is said."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from analytic import Block, Scene, Start, simulate
from comparisons.plotting.glance import Endings, Glance, counted
from comparisons.plotting.parts import RESTITUTION, Judgement, Mark, Section
from comparisons.plotting.wording import rating
from comparisons.report.answer import (
    QUESTION,
    Stored,
    judgements_of,
    lines,
    own_restitution,
    screen,
    setups_of,
    shown,
    title,
)
from comparisons.report.runs import restitution_computed
from comparisons.report.sections import restitution_section
from comparisons.report.write import _outside

FINE, COARSE, GIVEN, OTHER = ("exudyn", "fine"), ("exudyn", "coarse"), ("exudyn", "given"), ("mujoco", "fine")
TIERS = {FINE: "tuned", COARSE: "defaults", GIVEN: "assisted", OTHER: "tuned"}
VARIANTS = [
    dict(engine=engine, variant=variant, tier=tier, best=variant == "fine", applies_impact=tier == "assisted")
    for (engine, variant), tier in TIERS.items()
]
ERRORS = {FINE: 1e-5, COARSE: 0.2, GIVEN: 1e-9, OTHER: 1e-4}
JUDGED = Judgement(
    "restitution",
    {who: Mark(f"{error:g}", rating(error, 0), value=error) for who, error in ERRORS.items()},
    RESTITUTION,
)


def decided(*judgements):
    return {(setup.engine, setup.variant): setup for setup in setups_of(VARIANTS, judgements)}


def test_rows_of_one_heading_are_one_that_says_what_each_study_found_and_is_as_bad_as_the_worst():
    main, finer = ("e", ""), ("e", "fine")
    first = Judgement("shift", {main: Mark("1 % (3 of 4)", "bad", "a", 0.01), finer: Mark("2 %", "good", "b", 0.02)})
    second = Judgement("shift", {main: Mark("3 % (5 of 5)", "fair", "c", 0.03)})
    marks = {main: Mark("3 % (5 of 5); 1 % (3 of 4)", "bad", "c; a", 0.03), finer: first.marks[finer]}
    for order in ((first, second), (second, first)):
        stored = [Stored(str(k), Section(""), judgements=(each,)) for k, each in enumerate(order)]
        assert judgements_of([*stored, Stored("x", Section(""))]) == [Judgement("shift", marks)]


@pytest.mark.parametrize(
    "marks, level",
    [
        ({FINE: Mark("x", "good")}, "good"),
        ({FINE: Mark("x", "fair")}, "fair"),
        ({FINE: Mark("x", "bad")}, "bad"),
        ({COARSE: Mark("x", "good")}, "part"),  # not tested in all
        ({FINE: Mark("0 of 9 (at most 30 %)", "part")}, "part"),
        ({FINE: Mark("42 %", "none"), COARSE: Mark("0.1 %", "none")}, "good"),  # it informs, and rates nobody
        ({FINE: Mark("42 %", "none"), COARSE: Mark("x", "bad")}, "part"),
        ({("exudyn", ""): Mark("9 of 9", "fair")}, "fair"),  # of an engine's main variant
    ],
)
def test_the_rating_is_the_worst_mark_and_what_was_not_tested_is_no_trust(marks, level):
    setups = decided(JUDGED, Judgement("a", marks))
    assert setups[FINE].rating.level == level and setups[COARSE].rating.level == "bad"
    assert list(setups) == [FINE, COARSE, GIVEN, OTHER]  # the subject's tuned and default variants, then the others
    assert [setup.in_first_table for setup in setups.values()] == [True, True, False, False]
    assert setups[GIVEN].marks["a"].words == "not tested"


def test_the_blocks_own_restitution_is_that_of_its_engines():
    """The model's row, which has no error to tell, is no setup; a failed run takes the trust away and is said."""
    row = {"engine": "exudyn", "variant": "fine", "rms": 1e-5, "worst": 2e-5, "failed": 0, "lost": 0, "impacts": 9}
    model = {**row, "engine": "analytic", "variant": None, "rms": 1e-12}
    rows = [model, row, {**row, "variant": "coarse", "failed": 2, "lost": 1}, {**row, "variant": "deaf", "lost": 3}]
    judgement = own_restitution(SimpleNamespace(rows=rows))
    assert {name: (mark.words, mark.level) for name, mark in judgement.marks.items()} == {
        FINE: ("1.0·10⁻⁵", "good"),
        COARSE: ("1.0·10⁻⁵ (2 failed, 1 missed)", "bad"),
        ("exudyn", "deaf"): ("1.0·10⁻⁵ (3 missed)", "bad"),
    }
    outside = own_restitution(SimpleNamespace(rows=rows), "slenderness 0.01 is outside the range")
    assert {mark.level for mark in outside.marks.values()} == {"part"}


@pytest.mark.parametrize("rms, level", [(1e-3, "good"), (1.01e-3, "fair"), (1e-2, "fair"), (1.01e-2, "bad")])
def test_restitution_is_trusted_to_a_thousandth_and_usable_to_a_hundredth(rms, level):
    assert rating(rms, 0) == level and rating(rms, 1) == rating(None, 0) == "bad"


def test_impacts_that_an_engine_misses_on_the_scenes_own_block_are_counted():
    scene = Scene(block=Block(mass=1000.0, radius=1.0, slenderness=0.25), start=Start(tilt=0.15), duration=3.0)
    model = simulate(scene, history=False)
    deaf = replace(model, engine="exudyn", impacts=model.impacts[1:])
    runs = (("analytic", None, model), ("exudyn", "compliant-corners", deaf))
    cases = [SimpleNamespace(scene=scene, solver=solver, variant=variant) for solver, variant, _ in runs]
    rows = [
        SimpleNamespace(case=case, failed=False, values=response.to_json(), cost={"cpu_seconds": 1.0})
        for case, (_, _, response) in zip(cases, runs, strict=True)
    ]
    rows_of_block = restitution_computed(rows).rows
    assert [row["lost"] for row in rows_of_block] == [0, 1] and rows_of_block[1]["failed"] == 0
    settings = {"starts": [0.6], "seconds": 3.0, "bases": [None]}
    (table,) = restitution_section(SimpleNamespace(rows=rows_of_block, settings=settings)).tables
    assert [row[1] for row in table.rows] == ["may be trusted", "is not to be trusted"]


def test_a_scene_is_outside_the_range_by_what_an_engine_warns_of():
    def rows(kind, quantity):
        warning = {"kind": kind, "quantity": quantity, "text": "slenderness 0.01 is outside the range"}
        return SimpleNamespace(rows=[{"engine": "exudyn", "warnings": [warning]}, {"part": "statue"}])

    assert _outside(rows("engine", "slenderness")) == "slenderness 0.01 is outside the range"
    assert _outside(rows("engine", None)) == _outside(rows("limit", "tilt")) == ""


SETUPS = setups_of(VARIANTS, (JUDGED,))
PLAIN = Endings("recorded motions", *COARSE, "defaults", 50, 4, 3, 2, 1, (0.1, 0.3), late=6, left_out=5)
TUNED = Endings("recorded motions", *FINE, "tuned", 170, 0, 0, 1, 0, (0.0, 0.04), late=2, left_out=30)
TABLE = Endings("a table", *FINE, "tuned", 80, 0, 0, 0, 7, (0.0, 0.2), left_out=20)
SHARES = [PLAIN, TUNED, replace(TUNED, engine="mujoco"), TABLE]


def test_the_first_screen_counts_outcomes_that_are_changed_of_subject_engines():
    """Of 170 + 80 runs 1 + 7, of 50 ten; a fall at another time is no other outcome."""
    kept = shown(SHARES, SETUPS)
    assert {share.engine for share in kept} == {"exudyn"}
    assert (
        "tuned exudyn reach another outcome than the model, or fail, in 8 of 250 runs (3.2 %); with defaults"
        in title(kept)
    )
    assert title([]) == title([TABLE]) == QUESTION
    said = {line.subject: f"{line.answer} {line.details}" for line in lines(SETUPS, (JUDGED,), kept, {})}
    counts = (
        "in 1 of 170 (exudyn) runs; engines with defaults, in 10 of 50 (exudyn) runs.",
        "Tuned engines let the block fall at another time in 2 (exudyn) more runs",
        "7 of 80 runs (all under",
        "limits of tuned engines are 4.0 % to 20 %",
        "counted, 4 failed",
    )
    assert all(words in said["Outcomes"] for words in counts)
    errors = "the rms error of tuned engines is 1.0·10⁻⁵ (exudyn). That of engines with defaults is 0.20 (exudyn)"
    assert errors in said["Restitution (0 to 1)"]


def test_runs_near_a_boundary_are_counted_in_and_what_else_changes_outcomes_stands_beside_them():
    """9 of 30 differ; with the 8 of 250 that are judged, 17 of 280. Where they are not known, no sum is given."""
    kept = shown([replace(TUNED, left_differing=9), TABLE], SETUPS)
    matters = {"matters": ("", "A rotation changes 30 %.")}
    (line,) = (line for line in lines(SETUPS, (JUDGED,), kept, matters) if line.subject == "Outcomes")
    unknown = "For 20 further runs near a boundary it is not known."
    assert line.details.endswith(f"9 of 30 differ; with them, 17 of 280 (6.1 %) do. {unknown} A rotation changes 30 %.")
    (line,) = (line for line in lines(SETUPS, (JUDGED,), shown(SHARES, SETUPS), {}) if line.subject == "Outcomes")
    assert "with them" not in line.details


def test_the_level_whose_cost_is_given_is_seen_on_the_random_statues():
    cost = Glance(says={"cost": ("36 ms.", "Levels: 4.")}, levels=(("exudyn", 4.0), ("pybullet", 0.1)))
    missed = {("exudyn", 4.0): (23, 61), ("exudyn", 5.0): (1, 61), ("pybullet", 0.1): (18, 61)}
    for statues, begin in ((missed, "On the random statues, the levels of this scene miss "), ({}, "Le")):
        (line,) = screen(SETUPS, (), [cost, Glance(missed=statues)])["lines"]
        assert line.answer == "36 ms." and line.details.startswith(begin) and line.details.endswith("Levels: 4.")
        assert ("23 of 61 (exudyn) and 18 of 61 (pybullet)." in line.details) == bool(statues)


def test_endings_are_counted_run_by_run_and_an_interval_goes_by_group():
    """Of runs left out those count that overturn in one of both alone, or failed."""
    kinds = (
        ("right", True, True, False, 1),
        ("differs", True, False, True, 1),
        ("differs", False, True, True, 2),
        ("differs", True, True, False, 2),
        ("differs", False, False, True, 2),
        ("failed", True, None, False, 3),
        ("left out", True, True, False, 3),
        ("left out", True, False, True, 4),
        ("left out", False, None, False, 4),
    )
    names = ("class", "model_falls", "falls", "changed", "group")
    rows = [dict(zip(names, kind, strict=True), engine="e", variant="v", tier="tuned") for kind in kinds]
    (shares,) = counted("pulses", rows)
    assert (shares.runs, shares.failed, shares.missed, shares.added, shares.other, shares.late) == (6, 1, 1, 1, 1, 1)
    assert (shares.changed, shares.differing, shares.left_out, shares.left_differing) == (4, 5, 3, 2)
    (alone,) = counted("pulses", [{**row, "group": k} for k, row in enumerate(rows)])
    assert alone.interval[0] > shares.interval[0] and alone.interval[1] < shares.interval[1]
