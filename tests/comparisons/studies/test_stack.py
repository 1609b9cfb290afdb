"""The study of a free pedestal: its solvers and mountings by other ways, the class of a run, and what is counted."""

import numpy as np
import pytest
from answered import answered, by_model, stored

from analytic.response import COMPARED, EDGE
from analytic.stack.equations import StackModel
from comparisons.execution.cases import Case
from comparisons.execution.plan import Request
from comparisons.execution.sweep import Row
from comparisons.plotting.parts import where
from comparisons.studies import get_study
from comparisons.studies.stack import page, study

LOST = {"kind": "solver", "reason": "outside the model: contact is lost", "message": ""}


def ran(solver="analytic", outcome="rocks", tilts=(0.1, 0.2), landings=((1.0,), (0.5, 1.5)), failure=None, held=""):
    """A `Row` of a run as `study.measured` measures it, of scene 0."""
    values = {"outcome": outcome, "tilts": list(tilts), "landings": [*map(list, landings)], "held": held}
    values |= {"demand": 0.3, "impulse": 0.2, "closest": None, "simulated": 6.0}
    variant = "impact-aware" if solver == "pybullet" else None
    case = Case(study.museum(0), solver, variant, tag={"index": 0})
    return Row(case, {"outcome": "failed"} if failure else values, failure, {"cpu_seconds": 3.0}, False)


@pytest.mark.parametrize(
    "own, kind, quantities",
    [
        (ran("pybullet"), "right", []),
        (ran("pybullet", tilts=(0.1, 0.21)), "differs", ["peak_tilt"]),
        (ran("pybullet", "pedestal overturns"), "differs", ["outcome"]),
        (ran("pybullet", failure=LOST), "failed", []),
    ],
)
def test_the_class_of_a_run(own, kind, quantities):
    row = study.run_row(own, ran(), COMPARED)
    assert (row["class"], row.get("quantities", [])) == (kind, quantities)
    assert (
        study.run_row(own, ran(), EDGE)["class"] == study.run_row(own, ran(failure=LOST), "no")["class"] == "left out"
    )


def test_errors_are_those_of_the_nearest_landings_of_the_same_block():
    own = ran(study.SOLVER, tilts=(0.1, 0.201), landings=((0.5, 1.01), (0.52, 1.5)))
    row = study.run_row(own, ran(landings=((1.0, 3.0), (0.5, 1.5))), COMPARED)
    assert row["time_error"] == pytest.approx(0.02) and row["statue_error"] == pytest.approx(1e-3)


@pytest.mark.parametrize(
    "model, copies, comparable, change",
    [
        (ran(), [ran(tilts=(0.1, 0.203)), ran()], COMPARED, 3e-3),
        (ran(), [ran(), ran(outcome="overturns")], EDGE, None),
        (ran(), [ran(failure=LOST), ran()], EDGE, None),
        (ran(held="pulls"), [ran(), ran()], "pulls", 0.0),
        (ran(failure=LOST), [ran(), ran()], LOST["reason"], None),
    ],
)
def test_a_scene_is_compared_where_its_near_copies_end_alike(model, copies, comparable, change):
    row = study.scene_row(model, *copies)
    assert row["comparable"] == comparable and row.get("change") == (change and pytest.approx(change))


def test_the_glued_bust_is_the_stack_that_turns_as_one():
    """Its first moment and its inertia about the corner are those of the equations of two blocks."""
    block, model = study.bust("glued", 0.5).block, StackModel.of(study.bust("free", 0.5))
    *_, inertia, shared, own, below, above = model.geometry([1, 0], [0.0, 0.0])
    assert block.inertia == pytest.approx(inertia + 2 * shared + own, rel=1e-12)
    assert block.mass * block.half_height == pytest.approx(below + above, rel=1e-12)


def test_a_landing_is_found_between_steps():
    times = np.arange(0, 3, 1e-3)
    found = study.landings(times, 0.1 * np.sin(np.pi * times / 0.7) * (times < 2.1))
    assert [each.time for each in found] == pytest.approx([0.7, 1.4, 2.1], abs=1e-6)


@pytest.mark.slow
def test_the_model_in_every_solvers_place_agrees_with_itself(monkeypatch, tmp_path):
    for name, few in {"WAYS": ("fixed", "glued", "free"), "PULSES": (1.2,), "WIDTHS": ()}.items():
        monkeypatch.setattr(study, name, few)
    plan = get_study("stack").plan(Request(("mujoco",), True), (2, (1.2,), 0.12, 2))
    result = stored(tmp_path, "stack", answered(plan, by_model())[-1])
    runs, falls = where(result.rows, part="run"), where(result.rows, part="mounting")
    assert {(row["class"], row["time_error"] or 0.0) for row in runs} == {("right", 0.0)} and len(runs) == 6
    assert [row["fall"] for row in falls] == [0.48, 0.48, 0.36]  # .44, .40 and .36 g in finer steps
    (edge,) = where(result.rows, part="edge")
    assert 0.34 < edge["amplitude"] * result.settings["unit"] < 0.36
    assert all(abs(row["shift"]) <= row["half_width"] for row in where(result.rows, part={"shift", "check"}))
    assert [(each.runs, each.differing) for each in page.glance(result).endings] == [(2, 0)] * 2
