"""The first screen: five lines, two charts and one recommendation say what the studies found, and no more."""

import math
from dataclasses import replace
from xml.etree import ElementTree

import pytest

from comparisons.report.answer import setups_of
from comparisons.report.first import QUESTION, advice, lines, screen, shown, title
from comparisons.showing.charts import SHAPES
from comparisons.showing.glance import WIDE, Advised, Curve, Endings, Glance, Peaks, costs, counted, endings
from comparisons.showing.parts import RESTITUTION, Judgement, Mark

TUNED, PLAIN, MORE = ("exudyn", "compliant-corners"), ("exudyn", "native-contact"), ("mujoco", "impact-aware")
KINDS = {TUNED: "tuned", PLAIN: "defaults", MORE: "tuned"}
VARIANTS = [
    dict(engine=engine, variant=variant, tier=tier, best=tier == "tuned", applies_impact=False)
    for (engine, variant), tier in KINDS.items()
]
MARKS = {TUNED: Mark("1e-05", "good", value=1e-5), PLAIN: Mark("0.2 (3 missed)", "bad", value=0.2)}
JUDGED = (Judgement("restitution", MARKS, RESTITUTION),)
SETUPS = setups_of(VARIANTS, JUDGED)
SHARES = [
    Endings("recorded motions", *pair, KINDS[pair], 50, 4, 3, 2, 1, (0.1, 0.3), late=6, left_out=5, left_differing=2)
    if pair == PLAIN
    else Endings("recorded motions", *pair, KINDS[pair], 170, 0, 0, 1, 0, (0.0, 0.04), late=2, left_out=30)
    for pair in KINDS
]
TABLE = Endings("a table", *TUNED, "tuned", 80, 0, 0, 0, 0, (0.0, 0.2), untold=7, left_out=20, left_differing=9)
ADVICE = (
    Advised(1e-2),
    Advised(1e-3, *TUNED, "stiffness", 2e9, 0.02, "rocking run SCENE", {"a pulse": 2e-3, "a jump": 4e-4}),
)
PEAKS = Peaks("recorded motions", *TUNED, "stiffness", 1e9, (1e-5, 5e-4, 2e-3, math.inf))
CURVES = (
    Curve("analytic, kernel", "analytic model", "model", False, ((1e-4, 1e-13, True, "fine"),)),
    Curve(
        "exudyn, compliant-corners", "exudyn, tuned", "tuned", True, ((1e-2, 1e-2, True, "a"), (2e-2, 1e-4, True, "b"))
    ),
    Curve("exudyn, native-contact", "exudyn, defaults", "defaults", True, ((1e-2, 7.0, False, "far off"),)),
)


def test_the_lines_say_the_numbers_of_the_studies_and_only_of_engines_in_question():
    says = {"cost": "it costs 2 ms.", "real": "9 of 10.", "near": "There it is seldom right."}
    restitution = (
        "tuned engines are off by 1.0·10⁻⁵ (exudyn). With defaults they are off by 0.20 (exudyn). With defaults, "
        "impacts are missed by exudyn. This is the restitution; restitution lies between 0 and 1."
    )
    outcomes = (
        "under recorded motions the outcome is another or the run fails: tuned, in 1 of 170 (exudyn); with defaults, "
        "in 10 of 50 (exudyn). Engine and model both overturn, but at another time: tuned, in 2 (exudyn) more; with "
        "defaults, in 6 (exudyn) more. Under all other motions the outcome is another or the run fails: tuned, in 7 of "
        "80 (7 under a table)."
    )
    near = "the counts above leave out, of the runs of each tuned engine, 30 of 200 (recorded motions) and 20 of 100 "
    assert lines(SETUPS, JUDGED, shown([*SHARES, TABLE], SETUPS), says) == [
        ("Restitution", restitution),
        ("Outcomes", outcomes),
        ("Near outcome boundaries", f"{near}(a table). There it is seldom right."),
        ("Cost", "it costs 2 ms."),
        ("Real blocks", "9 of 10."),
    ]
    assert lines(SETUPS, (), [], {}) == []


def test_the_title_counts_outcomes_that_are_changed_and_asks_where_one_kind_was_not_run():
    """Of 170 + 80 runs 1 + 7, of 50 ten; a fall at another time is no other outcome."""
    found = title(shown([*SHARES, TABLE], SETUPS))
    assert "tuned exudyn end otherwise than the model, or fail, in 8 of 250 runs; with defaults, in 10 of 50." in found
    assert title([]) == title([TABLE]) == QUESTION


def test_engines_that_are_not_in_question_are_shown_where_no_other_was_run():
    alone = setups_of(VARIANTS, (Judgement("right", {MORE: Mark("9 of 9", "good")}),))
    assert [one.engine for one in shown([*SHARES, TABLE], alone)] == ["mujoco"]


def test_advice_says_what_its_levels_give_elsewhere_and_where_they_were_not_run():
    found = Glance(advice=ADVICE, asked=("exudyn",), scene="a scene", alike=1.5)
    first, second = advice(found, [PEAKS])
    assert "one scene (a scene)" in first.caption and "a factor of 1.5" in first.caption
    assert first.rows == [
        ["1 %", "not reached", "–", "–", "–"],
        ["0.1 %", "exudyn", "stiffness = 2·10⁹ N/m", "20 ms", "rocking run SCENE"],
    ]
    assert second.columns == ("accuracy", "engine, level", "a pulse", "a jump", "recorded motions")
    name = "exudyn, stiffness = 2·10⁹ N/m"
    there = "not run; at stiffness = 10⁹ N/m: 2 of 4 (50 %)"
    assert second.rows == [["0.1 %", name, "0.20 %: missed", "0.040 %", there]]
    (row,) = advice(found, [replace(PEAKS, level=2e9)])[1].rows
    assert row[-1] == "2 of 4 (50 %)"
    (row,) = advice(found, [replace(PEAKS, engine="another")])[1].rows
    assert row[-1] == "not run"
    assert len(advice(replace(found, advice=ADVICE[:1]), [PEAKS])) == 1  # nothing to be seen elsewhere


def texts(svg):
    return [node.text for node in ElementTree.fromstring(svg).iter("text")]


def charts(figure):
    """(wide, narrow) charts of a figure."""
    return [ElementTree.tostring(one[0]) for one in ElementTree.fromstring(f"<both>{figure.svg.decode()}</both>")]


def test_every_solver_is_drawn_and_named_and_what_lies_beyond_stands_at_the_frame():
    for svg in charts(costs(CURVES)):
        for one in CURVES:
            assert one.name in texts(svg)
        assert svg.count(b"data-says") == 4
        assert b"far off" in svg  # at the frame, and told under the pointer


def test_impacts_that_were_missed_are_crosses_whatever_the_variant_is_and_no_mark_covers_them():
    curves = [*CURVES, Curve("mujoco, x", "mujoco", "tuned", False, ((1e-2, 0.1, False, "b"), (2e-2, 0.1, True, "c")))]
    for svg in charts(costs(curves)):
        marks = [node for node in ElementTree.fromstring(svg).iter("path") if "dot" in node.get("class").split()]
        crosses = [mark for mark in marks if mark.get("d") == SHAPES["x"]]
        assert {mark.get("data-says") for mark in crosses} == {"far off", "b"} and crosses == marks[-2:]
        assert all(mark.get("class") == "dot" for mark in crosses)


def test_names_stand_inside_and_off_each_other():
    root = ElementTree.fromstring(charts(costs(CURVES))[0])
    names = {one.name for one in CURVES}
    places = [(float(node.get("x")), float(node.get("y"))) for node in root.iter("text") if node.text in names]
    assert len(places) == 3 and all(0 < x < WIDE for x, _ in places)
    assert len({round(y / 12) for _, y in places}) == 3


def test_bars_are_as_long_as_the_counts_and_failed_runs_stand_apart():
    svg = charts(endings(shown(SHARES, SETUPS)))[0]
    every = [*ElementTree.fromstring(svg).iter("rect")]  # those of defaults come first
    bars = {node.get("class"): float(node.get("width")) for node in reversed(every)}
    assert bars["ends-missed"] / bars["ends-failed"] == pytest.approx(3 / 4, rel=0.01)
    assert bars["ends-late"] / bars["ends-failed"] == pytest.approx(6 / 4, rel=0.01)
    told = {"recorded motions", "exudyn, defaults", "16 of 50", "3 of 170", "0", "4", "3", "2 of 5", "– of 30"}
    assert told <= set(texts(svg))
    assert "mujoco, tuned" not in texts(svg)  # not in question


def test_differences_of_which_the_way_is_not_told_have_no_count_of_it():
    found = [text for text in texts(charts(endings([TABLE]))[0]) if text]
    assert found[found.index("7 of 80") :][:7] == ["7 of 80", "–", "–", "–", "–", "–", "9 of 20"]
    (bar,) = ElementTree.fromstring(charts(endings([TABLE]))[0]).iter("rect")
    assert bar.get("class") == "ends-untold"


def test_endings_are_counted_run_by_run_and_an_interval_goes_by_group():
    """Of runs left out those count that overturn in one of both alone, or failed."""
    rows = [
        dict(engine="e", variant="v", tier="tuned", model_falls=model, falls=own, changed=other, group=group)
        | {"class": kind}
        for kind, model, own, other, group in (
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
    ]
    (found,) = counted("pulses", rows)
    assert (found.runs, found.failed, found.missed, found.added, found.other, found.late) == (6, 1, 1, 1, 1, 1)
    assert (found.changed, found.differing, found.left_out, found.left_differing) == (4, 5, 3, 2)
    (alone,) = counted("pulses", [{**row, "group": k} for k, row in enumerate(rows)])
    assert alone.interval[0] > found.interval[0] and alone.interval[1] < found.interval[1]


def test_a_screen_without_studies_has_nothing_to_draw():
    empty = screen([], (), [])
    assert (empty["title"], empty["lines"], empty["costs"], empty["endings"], empty["advice"]) == (
        QUESTION,
        [],
        None,
        None,
        [],
    )
    glance = Glance({"cost": "2 ms"}, tuple(SHARES), CURVES, "a scene", ADVICE)
    found = screen(SETUPS, JUDGED, [glance, Glance(peaks=(PEAKS,))])
    assert found["advice"] == advice(glance, [PEAKS]) and found["lines"][-1] == ("Cost", "2 ms")
    assert found["costs"] and found["endings"]
    assert {words for _, words in found["swatches"]} >= {"failed", "overturning added"}
