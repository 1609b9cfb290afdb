"""The overturning study on solvers whose boundaries are known: the analytic model itself, shifted on purpose."""

import dataclasses
from collections import Counter

import numpy as np
import pytest
from answered import answered, by_model, stored
from page_numbers import number_in

from analytic import Block, PulseMotion, Scene, simulate
from comparisons.running.refine import drive
from comparisons.running.study import Ask
from comparisons.showing.rows import where
from comparisons.studies.overturning import STUDY
from comparisons.studies.overturning.edges import Edge, edges, least_normal, locate, pulse
from comparisons.studies.overturning.study import QUICK

# the block of the published boundaries: one sine, p = 2.14, slenderness .25, restitution .9
GRAVITY, FREQUENCY, SLENDERNESS = 9.81, 2.14, 0.25
RADIUS = 3 * GRAVITY / (4 * FREQUENCY**2)
SCENE = Scene(block=Block(mass=1.0, radius=RADIUS, slenderness=SLENDERNESS, restitution=0.9))
OVER_TANGENT = SLENDERNESS / np.tan(SLENDERNESS)
PUBLISHED = {2.0: (1.25090, 2.37418, 2.40806), 4.0: (1.84430, 5.07937, 5.43676), 8.0: (15.90490,)}
EDGE = Edge("rigid ground", "one-sine", 4.0, 5.0, True, 0, 4.9, 6.0, 0.1)


def test_edges_are_the_published_boundaries_and_the_safe_gap():
    found = edges(SCENE, "rigid", "one-sine", tuple(PUBLISHED))
    for frequency, amplitudes in PUBLISHED.items():
        column = [edge for edge in found if edge.frequency == frequency]
        # published over g gamma, here over g tan(gamma)
        assert [edge.amplitude for edge in column] == pytest.approx([a * OVER_TANGENT for a in amplitudes], rel=2e-5)
        assert [(edge.rises, edge.mode) for edge in column] == [(True, 1), (False, 1), (True, 0)][-len(amplitudes) :]
        for one, other in zip(column, column[1:], strict=False):
            assert one.high == other.low == pytest.approx(np.sqrt(one.amplitude * other.amplitude))


def test_a_column_without_overturning_has_no_edges():
    assert edges(SCENE, "rigid", "one-cosine", (8.0,)) == []


def test_a_run_beside_a_boundary_is_decided():
    for edge in edges(SCENE, "rigid", "one-sine", (4.0,)):
        for side, falls in ((1 - 1e-4, not edge.rises), (1 + 1e-4, edge.rises)):
            response = simulate(SCENE.with_(motion=pulse(SCENE, edge.shape, edge.frequency, edge.amplitude * side)))
            assert response.decided and (response.outcome == "overturns") == falls
    assert least_normal(SCENE, PulseMotion("one-sine", 0.1, 5.0)) == 1.0


def search(edge, outcome, ladder=((2e-4, 1.2e-2), (0.1,)), tolerance=2e-5):
    (found,) = drive([locate(edge, ladder, tolerance)], lambda batch: [outcome(a) for _, a in batch])
    return found


@pytest.mark.parametrize("shift", [0.0, 3e-5, -1e-4, 4e-3, -0.015, 0.08])
def test_a_shifted_boundary_is_found_to_its_tolerance(shift):
    found = search(EDGE, lambda amplitude: bool(amplitude > 5.0 * (1 + shift)))
    assert found.half_width <= 1e-5
    assert abs(found.shift - shift) <= found.half_width * (1 + 1e-9)
    falling = dataclasses.replace(EDGE, rises=False)
    mirrored = search(falling, lambda amplitude: bool(amplitude < 5.0 * (1 + shift)))
    assert mirrored.shift == pytest.approx(shift, abs=1e-5)


@pytest.mark.parametrize(
    "answer, reason", [(True, "overturns on both sides"), (False, "stands on both sides"), (None, "no run was decided")]
)
def test_a_boundary_that_is_not_there_is_said_to_be_missing(answer, reason):
    found = search(EDGE, lambda amplitude: answer)
    assert found.shift is None and found.half_width is None and found.reason.startswith(reason)
    wrong_way = search(EDGE, lambda amplitude: bool(amplitude < 5.0))
    assert wrong_way.shift is None and wrong_way.reason.startswith("outcomes the other way round")


def test_the_search_stays_on_its_side_of_the_middle_between_two_boundaries():
    asked = []
    search(EDGE, lambda amplitude: asked.append(amplitude) or False)
    assert 4.9 < min(asked) and max(asked) < 6.0
    assert min(asked) == pytest.approx(5.0 - 0.9 * 0.1)
    assert search(EDGE, lambda amplitude: bool(amplitude > 5.0)).runs <= 4 + 7


def test_an_undecided_run_widens_the_bracket_instead_of_taking_a_side():
    found = search(EDGE, lambda amplitude: None if abs(amplitude / 5.0 - 1) < 1e-4 else bool(amplitude > 5.0))
    assert found.shift is not None and abs(found.shift) <= found.half_width
    assert 1e-4 <= found.half_width <= 2e-4


def test_a_bracket_too_wide_to_tell_is_no_boundary():
    found = search(EDGE, lambda amplitude: None if abs(amplitude / 5.0 - 1) < 0.011 else bool(amplitude > 5.0))
    assert found.shift is None and found.reason == "undecided between -1.2 and +1.2 %"


FAILURE = {"kind": "solver", "reason": "it failed", "message": "raw evidence"}


def shifted(shift, moves=lambda case: True, fails=lambda case: False):
    """In place of the engines: the analytic model under `shift` times larger pulses where it moves, failing at some."""
    return by_model(
        lambda case: case.scene.with_(motion=case.scene.motion.scaled(1 / (1 + shift * moves(case)))),
        lambda case: FAILURE if fails(case) else None,
    )


def study(tmp_path, work, shape="one-sine", levels=True):
    """What the study finds where `work` answers on rigid ground under one shape of pulse, and its page.

    levels: whether it goes on after the default settings.
    """
    grid = dataclasses.replace(QUICK, grounds=("rigid ground",), shapes=(shape,))
    found = answered(STUDY.plan(Ask(("exudyn", "pybullet"), quick=True), grid), work, None if levels else 1)[-1]
    result = stored(tmp_path, "overturning", found)
    page = STUDY.page(result).whole()
    assert page.tables and all(len(row) == len(table.columns) for table in page.tables for row in table.rows)
    return result, page


def shifts_of(rows):
    return [row["shift"] for row in rows]


def wrong(result, region):
    rows = where(result.rows, part="confusion", region=region)
    assert len(rows) == 2  # an engine each
    return sum(row["only_a"] + row["only_b"] for row in rows)


@pytest.mark.parametrize("shift", [0.0, 0.02])
def test_the_study_measures_the_shift_it_is_given_and_rates_it(tmp_path, shift):
    result, page = study(tmp_path, shifted(shift))
    shifts = where(result.rows, part="shift")
    assert len(shifts) == 12
    # a safe gap narrower than the shift is filled from both sides: its boundaries may not be found
    found = [row for row in shifts if row["shift"] is not None]
    assert len(found) == 12 if shift == 0 else len(found) >= 8
    assert shifts_of(found) == pytest.approx([shift] * len(found), abs=2e-5)
    assert (wrong(result, "outside") == 0) == (shift == 0)
    assert bool(where(result.rows, part="disagreement")) == (shift != 0)
    assert [row[1] for row in page.tables[0].rows] == ["trusted" if shift == 0 else "not to be trusted"] * 2
    # at default settings gaps are lost, too; the first script is asked at one frequency, where none is as narrow
    marks = STUDY.judgements(result)[0].marks
    assert {mark.level for mark in marks.values()} == ({"good"} if shift == 0 else {"bad", "fair"})


def test_failed_runs_are_no_outcomes_and_their_evidence_is_kept(tmp_path):
    result, page = study(tmp_path, shifted(0.0, fails=lambda case: case.scene.motion.peak > 25))
    failures = where(result.rows, part="failure", kind="solver")
    undecided = where(result.rows, part="failure", kind="undecided")
    assert failures and all(row["message"] == "raw evidence" for row in failures)
    assert all(row["message"].startswith("tilt ") for row in undecided)
    assert any("raw evidence" in text for _, text in page.evidence)
    (counts,) = (table for table in page.tables if "reason" in table.columns)
    shown = {(row[0], row[1]): int(row[2]) for row in counts.rows}
    assert shown == Counter((f"{row['engine']}, {row['variant']}", row["reason"]) for row in failures + undecided)
    assert (result.arrays["points"][:, 6] == -1).sum() == len(failures) + len(undecided)


def test_the_page_shows_every_boundary_and_every_level(tmp_path):
    result, page = study(tmp_path, shifted(0.0))
    edges = where(result.rows, part="edge")
    for figure in page.figures[:2]:  # maps, and shifts over frequency
        assert figure.svg.count(b'class="dot') == 2 * len(edges) == 12  # two engines
    (boundaries,) = (table for table in page.tables if table.columns[-1] == "pybullet, impact-aware [%]")
    shown = np.array([[number_in(row[column]) for column in (3, -2, -1)] for row in boundaries.rows])
    assert shown[:, 0] == pytest.approx([edge["amplitude"] for edge in edges], rel=1e-5)
    for column, engine in enumerate(result.settings["engines"], start=1):
        shifts = [row["shift"] for row in where(result.rows, part="shift", engine=engine)]
        assert shown[:, column] / 100 == pytest.approx(shifts, rel=0.06)
    levels = {(row["engine"], row["variant"], row["level"]) for row in where(result.rows, part="refinement")}
    at_default = {(*pair, None) for pair in result.settings["default_variants"].items()}
    assert len(page.tables[-1].rows) == len(levels | at_default) > len(levels)
    assert "time-stepping" in {row[0] for row in page.tables[-1].rows} & set(page.figures[-1].solvers)


def slides(case):
    """A contact in place of the model's corner moves boundaries where that would have to be held down."""
    return case.variant != "switched-joints" and simulate(case.scene, history=False).min_normal_ratio < 0


def test_boundaries_at_which_the_model_holds_the_corner_down_are_told_apart(tmp_path):
    result, page = study(tmp_path, shifted(-0.05, slides), "one-cosine", levels=False)
    pulled = [row["amplitude"] for row in where(result.rows, part="edge") if row["min_normal"] < 0]
    held = where(result.rows, part="held")
    assert len(pulled) == len(held) > 0
    assert shifts_of(held) == pytest.approx([0.0] * len(held), abs=2e-5)
    shifts = where(result.rows, part="shift")
    moved = where(shifts, amplitude=set(pulled))
    assert 0 < len(moved) < len(shifts)
    assert shifts_of(moved) == pytest.approx([-0.05] * len(moved), abs=2e-5)
    assert wrong(result, "outside") == 0 < wrong(result, "held down")
    assert all(row["min_normal"] < 0 for row in where(result.rows, part="disagreement"))
    # they are not rated, and shown in a table of their own
    assert [row[1] for row in page.tables[0].rows] == ["trusted"] * 2
    assert [mark.level for mark in STUDY.judgements(result)[0].marks.values()] == ["good", "good"]
    (table,) = (table for table in page.tables if "exudyn, switched-joints [%]" in table.columns)
    assert [number_in(row[3]) for row in table.rows] == pytest.approx(pulled, rel=1e-5)
    assert [abs(number_in(row[-1])) < 2e-3 for row in table.rows] == [True] * len(held)
