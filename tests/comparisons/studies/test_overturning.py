"""The overturning study on solvers whose boundaries are known: the analytic model itself, shifted on purpose."""

import dataclasses

import pytest
from answered import answered, by_model, stored

from analytic import simulate
from comparisons.execution.plan import Request
from comparisons.plotting.parts import where
from comparisons.studies import get_study
from comparisons.studies.overturning.study import QUICK

STUDY = get_study("overturning")

FAILURE = {"kind": "solver", "reason": "it failed", "message": "raw evidence"}


def shifted(shift, moves=lambda case: True, fails=lambda case: False):
    """In place of the engines: the analytic model under `shift` times larger pulses where it moves, failing at some."""
    return by_model(
        lambda case: case.scene.with_(motion=case.scene.motion.scaled(1 / (1 + shift * moves(case)))),
        lambda case: FAILURE if fails(case) else None,
    )


def study(tmp_path, work, shape="one-sine", levels=True):
    """What the study finds where `work` answers on rigid ground under one shape of pulse.

    levels: whether it goes on after the default settings.
    """
    grid = dataclasses.replace(QUICK, grounds=("rigid ground",), shapes=(shape,))
    asked = STUDY.plan(Request(("exudyn", "pybullet"), quick=True), grid)
    return stored(tmp_path, "overturning", answered(asked, work, None if levels else 1)[-1])


def levels_of(result):
    return {mark.level for mark in STUDY.judgements(result)[0].marks.values()}


def wrong(result, region):
    rows = where(result.rows, part="confusion", region=region)
    assert len(rows) == 2  # an engine each
    return sum(row["only_a"] + row["only_b"] for row in rows)


def test_the_scan_counts_who_errs_which_way(tmp_path):
    """Pulses ten times as large add overturnings and miss none; a run that fails is counted apart."""
    result = study(tmp_path, shifted(-0.9, fails=lambda case: case.scene.motion.peak > 5))
    scans = where(result.rows, part="scan")
    assert len(scans) == 4  # two engines, tuned and as they come
    for row in scans:
        assert row["only_a"] == 0 < row["only_b"] and row["failed"] and row["interval"][0] > 0
        counts = ("failed", "both_stand", "both_overturn", "only_a", "only_b")
        assert row["runs"] == sum(row[key] for key in counts)


def slides(case):
    """A contact in place of the model's corner moves boundaries where that would have to be held down."""
    return simulate(case.scene, history=False).min_normal_ratio < 0


@pytest.mark.parametrize("shift", [0.0, 0.02])
def test_the_study_measures_the_shift_it_is_given_and_rates_it(tmp_path, shift):
    result = study(tmp_path, shifted(shift))
    shifts = where(result.rows, part="shift")
    # a safe gap narrower than the shift is filled from both sides: its boundaries may not be found
    found = [row for row in shifts if row["shift"] is not None]
    assert len(shifts) == 24 and len(found) >= (16 if shift else 24)  # two engines, tuned and as they come
    assert all(row["shift"] == pytest.approx(shift, abs=1.01 * row["half_width"]) for row in found)
    assert (wrong(result, "outside") == 0) == (shift == 0) != bool(where(result.rows, part="disagreement"))
    assert levels_of(result) == ({"bad"} if shift else {"good"})


def test_failed_runs_are_no_outcomes_and_their_evidence_is_kept(tmp_path):
    result = study(tmp_path, shifted(0.0, fails=lambda case: case.scene.motion.peak > 25))
    failures, undecided = (where(result.rows, part="failure", kind=kind) for kind in ("solver", "undecided"))
    assert failures and all(row["message"] == "raw evidence" for row in failures)
    assert all(row["message"].startswith("tilt ") for row in undecided)
    scan, counted = result.settings["scan"], where(result.rows, part="confusion", region="scan")
    assert len(counted) == 2  # the main variant of each engine
    for row in counted:
        own = where(failures + undecided, engine=row["engine"], variant=row["variant"], amplitude={*scan})
        outcomes = sum(row[key] for key in ("both_stand", "both_overturn", "only_a", "only_b"))
        assert own and outcomes + len(own) == len(result.settings["frequencies"]) * len(scan)


def test_boundaries_at_which_the_model_holds_the_corner_down_are_told_apart(tmp_path):
    result = study(tmp_path, shifted(-0.05, slides), "one-cosine", levels=False)
    pulled = {row["amplitude"] for row in where(result.rows, part="edge") if row["min_normal"] < 0}
    every = where(result.rows, part="shift")
    moved = [row["shift"] for row in where(every, amplitude=pulled)]
    assert 0 < len(pulled) < len(moved) < len(every) and moved == pytest.approx([-0.05] * len(moved), abs=1e-4)
    assert wrong(result, "outside") == 0 < wrong(result, "held down")
    assert all(row["min_normal"] < 0 for row in where(result.rows, part="disagreement"))
    assert levels_of(result) == {"good"}  # they are not rated
