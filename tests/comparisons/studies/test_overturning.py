"""The overturning study on solvers whose boundaries are known: the analytic model itself, shifted on purpose."""

import dataclasses
from collections import Counter
from types import SimpleNamespace

import numpy as np
import pytest
from answered import answered, by_model, stored
from literature import ONE_SINE, under_a_pulse
from page_numbers import number_in

from analytic import PulseMotion, simulate
from analytic.caryatid import MASS
from comparisons.running.plan import Request
from comparisons.running.refine import drive
from comparisons.showing.parts import where
from comparisons.studies import get_study
from comparisons.studies.overturning.edges import (
    DRAWN,
    FREQUENCY,
    JUMPS,
    Edge,
    drawn_edges,
    edges,
    least_normal,
    locate,
    pulse,
)
from comparisons.studies.overturning.page import _under_jumps
from comparisons.studies.overturning.study import QUICK
from engines.statue_range import outside

STUDY = get_study("overturning")

# the block of the published boundaries
SCENE = under_a_pulse(1.0, 1.0).with_(motion=None, duration=None)
EDGE = Edge("rigid ground", "one-sine", 4.0, 5.0, True, 0, 4.9, 6.0, 0.1)


def test_edges_are_the_published_boundaries_and_the_safe_gap():
    found = edges(SCENE, "rigid", "one-sine", (2.0, 4.0, 8.0))
    for frequency in (2.0, 4.0, 8.0):
        column, amplitudes = [edge for edge in found if edge.frequency == frequency], ONE_SINE[frequency]
        # published over g gamma, here over g tan(gamma)
        mine = [edge.amplitude * np.tan(0.25) / 0.25 for edge in column]
        assert mine == pytest.approx(amplitudes, rel=2e-5)
        assert [(edge.rises, edge.mode) for edge in column] == [(True, 1), (False, 1), (True, 0)][-len(amplitudes) :]
        for one, other in zip(column, column[1:], strict=False):
            assert one.high == other.low == pytest.approx(np.sqrt(one.amplitude * other.amplitude))
    for edge in found:
        beside = [pulse(SCENE, edge.shape, edge.frequency, edge.amplitude * side) for side in (1 - 1e-4, 1 + 1e-4)]
        runs = [simulate(SCENE.with_(motion=motion)) for motion in beside]
        assert [run.outcome == "overturns" for run in runs] == [not edge.rises, edge.rises]
        assert all(run.decided for run in runs)
    assert edges(SCENE, "rigid", "one-cosine", (8.0,)) == []  # where none overturns
    assert least_normal(SCENE, PulseMotion("one-sine", 0.1, 5.0)) == 1.0


def search(edge, outcome, distances=((2e-4, 1.2e-2), (0.1,)), tolerance=2e-5):
    (found,) = drive([locate(edge, distances, tolerance)], lambda batch: [outcome(a) for _, a in batch])
    return found


@pytest.mark.parametrize("shift", [0.0, 3e-5, -1e-4, 4e-3, -0.015, 0.08])
def test_a_shifted_boundary_is_found_to_its_tolerance(shift):
    for edge in (EDGE, dataclasses.replace(EDGE, rises=False)):
        found = search(edge, lambda amplitude, rises=edge.rises: (amplitude > 5.0 * (1 + shift)) == rises)
        assert found.half_width <= 1e-5 and abs(found.shift - shift) <= found.half_width * (1 + 1e-9)


@pytest.mark.parametrize(
    "outcome, reason",
    [
        (lambda amplitude: True, "overturns on both sides"),
        (lambda amplitude: False, "stands on both sides"),
        (lambda amplitude: None, "no run was decided"),
        (lambda amplitude: bool(amplitude < 5.0), "outcomes the other way round"),
        # too wide a bracket to tell
        (
            lambda amplitude: None if abs(amplitude / 5.0 - 1) < 0.011 else amplitude > 5.0,
            "undecided between -1.2 and +1.2 %",
        ),
    ],
)
def test_a_boundary_that_is_not_there_is_said_to_be_missing(outcome, reason):
    found = search(EDGE, outcome)
    assert found.shift is None and found.half_width is None and found.reason.startswith(reason)


def test_the_search_stays_on_its_side_of_the_middle_between_two_boundaries():
    asked = []
    search(EDGE, lambda amplitude: asked.append(amplitude) or False)
    assert 4.9 < min(asked) and max(asked) < 6.0
    assert min(asked) == pytest.approx(5.0 - 0.9 * 0.1)
    assert search(EDGE, lambda amplitude: bool(amplitude > 5.0)).runs <= 4 + 7


def test_an_undecided_run_widens_the_bracket_instead_of_taking_a_side():
    found = search(EDGE, lambda amplitude: None if abs(amplitude / 5.0 - 1) < 1e-4 else bool(amplitude > 5.0))
    assert abs(found.shift) <= found.half_width and 1e-4 <= found.half_width <= 2e-4


FAILURE = {"kind": "solver", "reason": "it failed", "message": "raw evidence"}


def shifted(shift, moves=lambda case: True, fails=lambda case: False):
    """In place of the engines: the analytic model under `shift` times larger pulses where it moves, failing at some."""
    return by_model(
        lambda case: case.scene.with_(motion=case.scene.motion.scaled(1 / (1 + shift * moves(case)))),
        lambda case: FAILURE if fails(case) else None,
    )


def study(tmp_path, work, shape="one-sine", levels=True, drawn=0):
    """What the study finds where `work` answers on rigid ground under one shape of pulse, and its page.

    levels: whether it goes on after the default settings. drawn: blocks drawn beside it.
    """
    grid = dataclasses.replace(QUICK, grounds=("rigid ground",), shapes=(shape,), drawn=drawn)
    found = answered(STUDY.plan(Request(("exudyn", "pybullet"), quick=True), grid), work, None if levels else 1)[-1]
    result = stored(tmp_path, "overturning", found)
    return result, STUDY.page(result).whole()


def wrong(result, region):
    rows = where(result.rows, part="confusion", region=region)
    assert len(rows) == 2  # an engine each
    return sum(row["only_a"] + row["only_b"] for row in rows)


@pytest.mark.parametrize("shift", [0.0, 0.02])
def test_the_study_measures_the_shift_it_is_given_and_rates_it(tmp_path, shift):
    result, page = study(tmp_path, shifted(shift))
    shifts = where(result.rows, part="shift")
    # a safe gap narrower than the shift is filled from both sides: its boundaries may not be found
    found = [row for row in shifts if row["shift"] is not None]
    assert len(shifts) == 24 and len(found) >= (16 if shift else 24)  # two engines, tuned and as they come
    for row in found:
        assert row["shift"] == pytest.approx(shift, abs=1.01 * row["half_width"])
    assert (wrong(result, "outside") == 0) == (shift == 0)
    assert bool(where(result.rows, part="disagreement")) == (shift != 0)
    assert [row[1] for row in page.tables[0].rows] == ["trusted" if shift == 0 else "not to be trusted"] * 4
    marks = STUDY.judgements(result)[0].marks
    assert {mark.level for mark in marks.values()} == ({"good"} if shift == 0 else {"bad"})


def test_failed_runs_are_no_outcomes_and_their_evidence_is_kept(tmp_path):
    result, page = study(tmp_path, shifted(0.0, fails=lambda case: case.scene.motion.peak > 25))
    failures, undecided = (where(result.rows, part="failure", kind=kind) for kind in ("solver", "undecided"))
    assert failures and all(row["message"] == "raw evidence" for row in failures)
    assert all(row["message"].startswith("tilt ") for row in undecided)
    assert any("raw evidence" in text for _, text in page.evidence)
    (counts,) = (table for table in page.tables if "reason" in table.columns)
    shown = {(row[0], row[1]): int(row[2]) for row in counts.rows}
    assert shown == Counter((f"{row['engine']}, {row['variant']}", row["reason"]) for row in failures + undecided)
    scan = result.settings["scan"]
    counted = where(result.rows, part="confusion", region="scan")
    assert len(counted) == 2  # the main variant of each engine
    for row in counted:
        own = where(failures + undecided, engine=row["engine"], variant=row["variant"], amplitude={*scan})
        outcomes = sum(row[key] for key in ("both_stand", "both_overturn", "only_a", "only_b"))
        assert own and outcomes + len(own) == len(result.settings["frequencies"]) * len(scan)


def test_the_scan_counts_who_errs_which_way(tmp_path):
    """Pulses ten times as large add overturnings and miss none; a run that fails is counted apart."""
    result, _ = study(tmp_path, shifted(-0.9, fails=lambda case: case.scene.motion.peak > 5))
    scans = where(result.rows, part="scan")
    assert len(scans) == 4  # two engines, tuned and as they come
    for row in scans:
        assert row["only_a"] == 0 < row["only_b"] and row["failed"] and row["interval"][0] > 0
        counts = ("failed", "both_stand", "both_overturn", "only_a", "only_b")
        assert row["runs"] == sum(row[key] for key in counts)


def test_the_page_shows_every_boundary_and_every_level(tmp_path):
    result, page = study(tmp_path, shifted(0.0))
    edges = where(result.rows, part="edge")
    strip, *others = page.figures
    assert strip.svg.count(b'class="dot') == len(where(result.rows, part="shift")) + len(edges) == 4 * 6 + 6
    for figure in others[:2]:  # maps, and shifts over frequency
        assert figure.svg.count(b'class="dot') == 2 * len(edges) == 12  # two engines
    (boundaries,) = (table for table in page.tables if "pybullet, impact-aware [%]" in table.columns)
    shown = np.array([[number_in(row[column]) for column in (3, -4, -3, -2, -1)] for row in boundaries.rows])
    assert shown[:, 0] == pytest.approx([edge["amplitude"] for edge in edges], rel=1e-5)
    shifts = [100 * row["shift"] for row in where(result.rows, part="shift")]
    assert shown[:, 1:].T.ravel() == pytest.approx(shifts, rel=0.06)
    levels = {(row["engine"], row["variant"], row["level"]) for row in where(result.rows, part="refinement")}
    at_default = {(*pair, None) for pair in result.settings["default_variants"].items()}
    assert len(page.tables[-1].rows) == len(levels | at_default) > len(levels)
    assert "time-stepping" in {row[0] for row in page.tables[-1].rows} & set(page.figures[-1].solvers)


def slides(case):
    """A contact in place of the model's corner moves boundaries where that would have to be held down."""
    return simulate(case.scene, history=False).min_normal_ratio < 0


def test_boundaries_at_which_the_model_holds_the_corner_down_are_told_apart(tmp_path):
    result, page = study(tmp_path, shifted(-0.05, slides), "one-cosine", levels=False)
    pulled = [row["amplitude"] for row in where(result.rows, part="edge") if row["min_normal"] < 0]
    moved, every = (
        [row["shift"] for row in where(result.rows, **of)]
        for of in ({"part": "shift", "amplitude": set(pulled)}, {"part": "shift"})
    )
    assert 0 < len(pulled) < len(moved) < len(every)
    assert moved == pytest.approx([-0.05] * len(moved), abs=1e-4)
    assert wrong(result, "outside") == 0 < wrong(result, "held down")
    assert all(row["min_normal"] < 0 for row in where(result.rows, part="disagreement"))
    # they are not rated, and shown in a table of their own
    assert [row[1] for row in page.tables[0].rows] == ["trusted"] * 4
    assert [mark.level for mark in STUDY.judgements(result)[0].marks.values()] == ["good"] * 4
    (table,) = (table for table in page.tables if "holds the corner down" in table.caption)
    assert [number_in(row[3]) for row in table.rows] == pytest.approx(pulled, rel=1e-5)
    assert [number_in(row[-1]) for row in table.rows] == pytest.approx([-5.0] * len(pulled), rel=1e-2)


def test_drawn_blocks_lie_in_the_promised_range_and_have_one_boundary_to_find():
    found = drawn_edges(5)
    assert [edge.shape for _, edge in found] == list(DRAWN) and len({edge.ground for _, edge in found}) == 5
    assert set(JUMPS) == {"one-cosine", "rectangular"}
    for scene, edge in found:
        assert scene.motion is None and not any(scene.start.model_dump().values())
        assert not outside(scene, simulate(scene.with_(duration=1.0), history=False))
        assert edge.rises and edge.min_normal >= 0 and FREQUENCY[0] <= edge.frequency <= FREQUENCY[1]
        assert edge.low < 0.98 * edge.amplitude and edge.high > 1.02 * edge.amplitude
        outcomes = [
            simulate(scene.with_(motion=pulse(scene, edge.shape, edge.frequency, edge.amplitude * side))).outcome
            for side in (0.995, 0.9999, 1.0001, 1.005)
        ]
        assert [outcome == "overturns" for outcome in outcomes] == [False, False, True, True]
    again = drawn_edges(2)
    assert [edge for _, edge in again] == [edge for _, edge in found[:2]]  # as many as one asks, the same first


def test_the_bound_that_is_said_is_that_of_the_drawn_blocks_too(tmp_path):
    """In place of the engines the model, shifted by .3 % at the drawn blocks alone, which are not the Caryatid's."""
    moves = shifted(3e-3, lambda case: case.scene.block.mass != MASS)
    result, page = study(tmp_path, moves, levels=False, drawn=2)
    edges, shifts = where(result.rows, part="drawn edge"), where(result.rows, part="drawn shift")
    assert len(edges) == 2 and len(shifts) == 2 * 4  # two engines, tuned and as they come
    for row in shifts:
        assert row["shift"] == pytest.approx(3e-3, abs=1.01 * row["half_width"])
    assert all(abs(row["shift"]) <= 1.01 * row["half_width"] for row in where(result.rows, part="shift"))
    every = len(where(result.rows, part="edge")) + 2
    for mark in STUDY.judgements(result)[0].marks.values():
        assert mark.words == f"0.30 % ({every} of {every} boundaries)"
    (drawn,) = (table for table in page.tables if "drawn at random" in table.caption)
    assert [row[0] for row in drawn.rows] == [edge["ground"] for edge in edges]
    assert [number_in(row[1]) for row in drawn.rows] == pytest.approx([e["slenderness"] for e in edges], rel=5e-3)
    assert "0.30 % at most" in page.title


def test_a_largest_shift_under_a_jump_is_said():
    rows = [
        {"part": "edge", "ground": "g", "shape": shape, "frequency": 2.0, "amplitude": 3.0, "min_normal": 0.5}
        for shape in ("one-sine", "one-cosine")
    ]
    for engine, shifts in (("exudyn", (1e-4, -2e-3)), ("pybullet", (2e-4, 1e-4))):
        for edge, shift in zip(tuple(rows[:2]), shifts, strict=True):
            rows.append({**edge, "part": "shift", "engine": engine, "variant": "v", "shift": shift})
    settings = {"engines": ["exudyn", "pybullet"], "default_variants": {"exudyn": "v", "pybullet": "v"}}
    assert list(_under_jumps(SimpleNamespace(rows=rows, settings=settings))) == [
        "The shift is largest where the acceleration of the ground jumps at the start: −0.20 % under a one-cosine "
        "pulse (exudyn)."
    ]
