"""The first screen: three lines, two charts and one recommendation say what the studies found, and no more."""

from dataclasses import replace
from xml.etree import ElementTree

import pytest

from comparisons.report.answer import setups_of
from comparisons.report.first import QUESTION, lines, screen, shown, title
from comparisons.showing.glance import WIDE, Curve, Endings, Glance, costs, counted, endings
from comparisons.showing.parts import RESTITUTION, Judgement, Mark, Table

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
    Endings("recorded motions", *pair, KINDS[pair], 50, 4, 3, 2, 1, (0.1, 0.3))
    if pair == PLAIN
    else Endings("recorded motions", *pair, KINDS[pair], 170, 0, 0, 1, 0, (0.0, 0.04))
    for pair in KINDS
]
ADVICE = Table("What to use", ("accuracy", "engine, variant"), [["1 %", "exudyn, compliant-corners"]])
CURVES = (
    Curve("analytic, kernel", "analytic model", "model", False, ((1e-4, 1e-13, True, "fine"),)),
    Curve(
        "exudyn, compliant-corners", "exudyn, tuned", "tuned", True, ((1e-2, 1e-2, True, "a"), (2e-2, 1e-4, True, "b"))
    ),
    Curve("exudyn, native-contact", "exudyn, defaults", "defaults", True, ((1e-2, 7.0, False, "far off"),)),
)


def test_the_lines_say_the_numbers_of_the_studies_and_only_of_engines_in_question():
    found = lines(SETUPS, JUDGED, shown(SHARES, SETUPS), {"cost": "it costs 2 ms.", "real": "9 of 10."})
    restitution = (
        "tuned, the coefficient (between 0 and 1) is off by 1.0·10⁻⁵ in exudyn (rms). With defaults, it is off by 0.20 "
        "in exudyn, and exudyn misses impacts."
    )
    outcomes = (
        "under recorded motions, tuned engines differ from the model or fail in 1 of 170 (exudyn) runs; defaults in "
        "10 of 50 (exudyn). Over all motions, tuned engines miss 0 overturnings and add 1; defaults miss 3 "
        "and add 2."
    )
    assert found == [
        [("Restitution", restitution)],
        [("Outcomes", outcomes)],
        [("Cost", "it costs 2 ms."), ("Real blocks", "9 of 10.")],
    ]
    assert lines(SETUPS, (), [], {}) == []


def test_the_title_answers_only_where_the_answer_is_clear():
    assert title(SETUPS) != QUESTION
    careful = replace(SETUPS[0], rating=Mark("x", "bad")), *SETUPS[1:]
    good = SETUPS[0], replace(SETUPS[1], rating=Mark("x", "fair"))
    assert title(careful) == title(good) == title([]) == QUESTION


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


def test_names_stand_inside_and_off_each_other():
    root = ElementTree.fromstring(charts(costs(CURVES))[0])
    names = {one.name for one in CURVES}
    places = [(float(node.get("x")), float(node.get("y"))) for node in root.iter("text") if node.text in names]
    assert len(places) == 3 and all(0 < x < WIDE for x, _ in places)
    assert len({round(y / 12) for _, y in places}) == 3


def test_bars_are_as_long_as_the_counts_and_failed_runs_stand_apart():
    svg = charts(endings(shown(SHARES, SETUPS)))[0]
    bars = {node.get("class"): float(node.get("width")) for node in ElementTree.fromstring(svg).iter("rect")}
    assert bars["ends-missed"] / bars["ends-failed"] == pytest.approx(3 / 4, rel=0.01)
    assert {"recorded motions", "exudyn, defaults", "10 of 50", "1 of 170", "0", "4", "3"} <= set(texts(svg))
    assert "mujoco, tuned" not in texts(svg)  # not in question


def test_endings_are_counted_run_by_run_and_an_interval_goes_by_group():
    rows = [
        dict(engine="e", variant="v", tier="tuned", model_falls=model, falls=own, group=group, **{"class": kind})
        for kind, model, own, group in (
            ("right", True, True, 1),
            ("differs", True, False, 1),
            ("differs", False, True, 2),
            ("differs", True, True, 2),
            ("failed", True, False, 3),
        )
    ]
    (found,) = counted("pulses", rows)
    assert (found.runs, found.failed, found.missed, found.added, found.other, found.differing) == (5, 1, 1, 1, 1, 4)
    (alone,) = counted("pulses", [{**row, "group": k} for k, row in enumerate(rows)])
    assert alone.interval[0] > found.interval[0] and alone.interval[1] < found.interval[1]


def test_a_screen_without_studies_has_nothing_to_draw():
    empty = screen([], (), [])
    assert (empty["title"], empty["lines"], empty["costs"], empty["endings"], empty["advice"]) == (
        QUESTION,
        [],
        None,
        None,
        None,
    )
    glance = Glance({"cost": "2 ms"}, tuple(SHARES), CURVES, "a scene", ADVICE)
    found = screen(SETUPS, JUDGED, [glance])
    assert (
        found["advice"] is ADVICE and found["costs"] and found["endings"] and found["lines"][-1] == [("Cost", "2 ms")]
    )
    assert {words for _, words in found["swatches"]} >= {"failed", "overturning added"}
