"""The overturning study on solvers whose boundaries are known: the analytic model itself, shifted on purpose."""

import dataclasses

import numpy as np
import pytest
from answered import answered

from analytic import Block, PulseMotion, Scene, simulate
from comparisons.running.provenance import read_result, write_result
from comparisons.running.refine import drive
from comparisons.running.study import Ask
from comparisons.running.sweep import Row
from comparisons.studies.overturning import cases as overturning_runs
from comparisons.studies.overturning.edges import Edge, Located, edges, least_normal, locate, pulse
from comparisons.studies.overturning.figures import draw_knobs, draw_maps, draw_shifts
from comparisons.studies.overturning.finding import judgement
from comparisons.studies.overturning.page import section

# the block of the published boundaries: one sine, p = 2.14, slenderness .25, restitution .9
GRAVITY, FREQUENCY, SLENDERNESS = 9.81, 2.14, 0.25
RADIUS = 3 * GRAVITY / (4 * FREQUENCY**2)
SCENE = Scene(block=Block(mass=1.0, radius=RADIUS, slenderness=SLENDERNESS, restitution=0.9))
OVER_TANGENT = SLENDERNESS / np.tan(SLENDERNESS)
PUBLISHED = {2.0: (1.25090, 2.37418, 2.40806), 4.0: (1.84430, 5.07937, 5.43676), 8.0: (15.90490,)}
EDGE = Edge("one-sine", 4.0, 5.0, True, 0, 4.9, 6.0, 0.1)


def test_edges_are_the_published_boundaries_and_the_safe_gap():
    columns = edges(SCENE, "one-sine", tuple(PUBLISHED))
    for column, amplitudes in zip(columns, PUBLISHED.values(), strict=True):
        # published over g gamma, here over g tan(gamma)
        assert [edge.amplitude for edge in column] == pytest.approx([a * OVER_TANGENT for a in amplitudes], rel=2e-5)
        assert [(edge.rises, edge.mode) for edge in column] == [(True, 1), (False, 1), (True, 0)][-len(amplitudes) :]
        for one, other in zip(column, column[1:], strict=False):
            assert one.high == other.low == pytest.approx(np.sqrt(one.amplitude * other.amplitude))


def test_a_column_without_overturning_has_no_edges():
    assert edges(SCENE, "one-cosine", (8.0,)) == [[]]


def test_a_run_beside_a_boundary_is_decided():
    for edge in edges(SCENE, "one-sine", (4.0,))[0]:
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


def test_an_undecided_run_widens_the_bracket_instead_of_taking_a_side():
    found = search(EDGE, lambda amplitude: None if abs(amplitude / 5.0 - 1) < 1e-4 else bool(amplitude > 5.0))
    assert found.shift is not None and abs(found.shift) <= found.half_width
    assert 1e-4 <= found.half_width <= 2e-4


def test_a_bracket_too_wide_to_tell_is_no_boundary():
    found = search(EDGE, lambda amplitude: None if abs(amplitude / 5.0 - 1) < 0.011 else bool(amplitude > 5.0))
    assert found.shift is None and found.reason == "undecided between -1.2 and +1.2 %"


class Shifted:
    """In place of the engines: the analytic model under `shift` times larger pulses, failing at some of them."""

    def __init__(self, shift, fails=lambda case: False):
        self.shift, self.fails = shift, fails

    def __call__(self, batch):
        rows = []
        for case in batch.cases:
            motion = case.scene.motion
            response = simulate(case.scene.with_(motion=motion.scaled(1 / (1 + self.shift))), history=False)
            failed = {"kind": "solver", "reason": "it failed", "message": "raw evidence"} if self.fails(case) else None
            values = {"outcome": response.outcome, "end_tilt": response.end.tilt, "decided": response.decided}
            rows.append(Row(case, values, failed, {"cpu_seconds": 0.1}, False))
        return rows


def study(tmp_path, work, monkeypatch, knobs=True):
    monkeypatch.setattr(overturning_runs, "GROUNDS", {"rigid ground": ("caryatid-rigid", {})})
    one = overturning_runs.ladders_of(("exudyn",))
    monkeypatch.setattr(overturning_runs, "ladders_of", lambda engines: one)
    found = answered(overturning_runs.plan(Ask(("exudyn", "pybullet"), quick=True)), work, None if knobs else 1)[-1]
    return read_result(
        write_result(
            tmp_path / "overturning.json", "overturning", found.settings, found.rows, found.arrays, modules=["analytic"]
        )
    )


@pytest.mark.parametrize("shift", [0.0, 0.02])
def test_the_study_measures_the_shift_it_is_given(tmp_path, monkeypatch, shift):
    result = study(tmp_path, Shifted(shift), monkeypatch)
    shifts = [row for row in result.rows if row["part"] == "shift"]
    assert len(shifts) == 12
    # a safe gap narrower than the shift is filled from both sides: its boundaries may not be found
    found = [row for row in shifts if row["shift"] is not None]
    assert len(found) == 12 if shift == 0 else len(found) >= 8
    assert [row["shift"] for row in found] == pytest.approx([shift] * len(found), abs=2e-5)
    outside = [row for row in result.rows if row["part"] == "confusion" and row["region"] == "outside"]
    assert len(outside) == 2
    assert (sum(row["only_a"] + row["only_b"] for row in outside) == 0) == (shift == 0)
    assert bool([row for row in result.rows if row["part"] == "surprise"]) == (shift != 0)
    text = " ".join(section(result).text)
    assert ("All boundaries lie within 0.5 %" in text) == (shift == 0)
    assert ("Not all boundaries lie within 0.5 %" in text) == (shift != 0)
    assert ("is not to be trusted" in text) == (shift != 0)
    # at default settings gaps are lost, too; the first script is asked at one frequency, where none is as narrow
    assert {mark.level for mark in judgement(result).marks.values()} == ({"good"} if shift == 0 else {"bad", "fair"})


def test_failed_runs_are_no_outcomes_and_their_evidence_is_kept(tmp_path, monkeypatch):
    result = study(tmp_path, Shifted(0.0, fails=lambda case: case.scene.motion.peak > 25), monkeypatch)
    failures = [row for row in result.rows if row["part"] == "failure" and row["kind"] == "solver"]
    undecided = [row for row in result.rows if row["part"] == "failure" and row["kind"] == "undecided"]
    assert failures and all(row["message"] == "raw evidence" for row in failures)
    assert all(row["message"].startswith("tilt ") for row in undecided)
    page = section(result)
    assert any("raw evidence" in text for _, text in page.evidence)
    assert any(f"it failed ({len(failures) // 2})" in paragraph for paragraph in page.text)
    points = result.arrays["points"]
    assert (points[:, 6] == -1).sum() == len(failures) + len(undecided)


def test_page_and_figures_show_every_boundary(tmp_path, monkeypatch):
    result = study(tmp_path, Shifted(0.0), monkeypatch)
    page = section(result)
    assert len(page.figures) == 3 and all(figure.svg.startswith(b"<svg") for figure in page.figures)
    boundaries = next(table for table in page.tables if table.caption.startswith("Boundaries under one pulse"))
    assert len(boundaries.rows) == 6
    assert all(len(row) == len(table.columns) for table in page.tables for row in table.rows)
    drawn = draw_maps(result).axes[0].lines
    assert sum(len(line.get_xdata()) for line in drawn[:2]) == 12
    assert all(
        axis.get_xlabel() and axis.get_title() for draw in (draw_shifts, draw_knobs) for axis in draw(result).axes
    )


def test_located_says_how_many_runs_it_took():
    assert isinstance(search(EDGE, lambda amplitude: True), Located)
    assert search(EDGE, lambda amplitude: bool(amplitude > 5.0)).runs <= 4 + 7


class SlidesWhereItIsPulled(Shifted):
    """The analytic model, but a contact in place of its corner: shifted where that would have to be held down."""

    def __call__(self, batch):
        shift, rows = self.shift, []
        for case in batch.cases:
            pulled = simulate(case.scene, history=False).min_normal_ratio < 0
            self.shift = shift if pulled and case.variant != "switched-joints" else 0.0
            rows += super().__call__(dataclasses.replace(batch, cases=[case]))
        self.shift = shift
        return rows


def test_boundaries_at_which_the_model_holds_the_corner_down_are_told_apart(tmp_path, monkeypatch):
    monkeypatch.setattr(overturning_runs, "SHAPES", ("one-cosine",))
    result = study(tmp_path, SlidesWhereItIsPulled(-0.05), monkeypatch, knobs=False)
    pulled = [row for row in result.rows if row["part"] == "edge" and row["min_normal"] < 0]
    held = [row for row in result.rows if row["part"] == "held"]
    assert len(pulled) == len(held) > 0
    assert [row["shift"] for row in held] == pytest.approx([0.0] * len(held), abs=2e-5)
    shifts = [row for row in result.rows if row["part"] == "shift"]
    moved = [row for row in shifts if row["amplitude"] in [edge["amplitude"] for edge in pulled]]
    assert 0 < len(moved) < len(shifts)
    assert all(row["shift"] == pytest.approx(-0.05, abs=2e-5) for row in moved)
    wrong = {
        region: sum(
            row["only_a"] + row["only_b"]
            for row in result.rows
            if row["part"] == "confusion" and row["region"] == region
        )
        for region in ("outside", "pulled")
    }
    assert wrong["outside"] == 0 < wrong["pulled"]
    assert all(row["min_normal"] < 0 for row in result.rows if row["part"] == "surprise")
    page = section(result)
    text = " ".join(page.text)
    assert "Not all boundaries lie within 0.5 %" in text
    assert text.count("may be trusted for overturning") == 2
    assert [mark.level for mark in judgement(result).marks.values()] == ["good", "good"]
    assert f"give {len(held)} of these {len(held)} boundaries" in text
    (table,) = (table for table in page.tables if "holds the corner down" in table.caption)
    assert len(table.rows) == len(held) and all(len(row) == len(table.columns) for row in table.rows)
