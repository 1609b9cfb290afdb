"""The problem sheet: answers held to the second implementation, files complete for a reader who has another code."""

import re

import numpy as np
import pytest

from analytic.checks.twin import simulate_twin
from comparisons.sheet.pages import PROBLEMS, UNITS, markdown, write_sheet

EXACT = 1e-7  # of the tolerance: so well the answers are known, as index.md says


def answered(problem):
    """{quantity: what the second implementation answers}, by the meaning of the names on the page."""
    how = {"rtol": 1e-13, "history": False, "energy": False, "max_step": 0.01}
    whole, answers = simulate_twin(problem.scene, **how), {}
    for time in {quantity.name.partition("_at_")[2] for quantity in problem.quantities} - {""}:
        state = simulate_twin(problem.scene.with_(duration=float(time)), **how).end
        answers |= {f"tilt_at_{time}": state.tilt, f"tilt_rate_at_{time}": state.tilt_rate}
        answers |= {f"displacement_at_{time}": state.base_displacement, f"force_at_{time}": state.bearing_force}
    for number, hit in enumerate(whole.impacts, 1):
        answers |= {f"impact_time_{number}": hit.time, f"base_velocity_jump_{number}": hit.base_velocity_jump}
        answers |= {f"rate_before_{number}": hit.rate_before, f"rate_after_{number}": hit.rate_after}
    answers |= {"uplift_time": next(iter(whole.uplifts), None), "rest_time": next(iter(whole.rests), None)}
    answers |= {"outcome": whole.outcome, "overturning_time": whole.overturning_time}
    return answers | {"peak_tilt": whole.peak_tilt, "peak_displacement": whole.peak_base_displacement}


@pytest.mark.parametrize("problem", PROBLEMS, ids=lambda problem: problem.name)
def test_the_second_implementation_gives_the_reference_answers(problem):
    answers = answered(problem)
    for quantity in problem.quantities:
        right, tolerance = problem.answers[quantity.name], problem.tolerance(quantity)
        if tolerance is None:
            assert answers[quantity.name] == right
        else:
            assert answers[quantity.name] == pytest.approx(right, rel=0, abs=EXACT * tolerance), quantity.name


def test_a_tolerance_is_a_thousandth_of_the_scale_of_its_page():
    block = PROBLEMS[0].scene.block  # free-rigid
    rate = (3 * 9.81 / (4 * block.radius)) ** 0.5
    tolerances = {quantity.kind: PROBLEMS[0].tolerance(quantity) for quantity in PROBLEMS[0].quantities}
    expected = {"outcome": None, "time": 1e-3 / rate, "angle": 0.25e-3, "rate": 0.25e-3 * rate}
    assert tolerances == {kind: value and pytest.approx(value, rel=1e-12) for kind, value in expected.items()}


@pytest.fixture(scope="module")
def sheet(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sheet")
    write_sheet(folder)
    return folder


def test_pages_say_all_that_is_asked_with_answers_and_nothing_of_our_code(sheet):
    for problem in PROBLEMS:
        text, page = markdown(problem), (sheet / f"{problem.name}.html").read_text()
        assert not re.search(r"python|kernel|exudyn|analytic|comparisons|rocking (sheet|run)", text, re.IGNORECASE)
        for quantity in problem.quantities:
            assert re.search(
                rf"\| {re.escape(quantity.name)} \|.*\| {re.escape(str(problem.answers[quantity.name]))} \|", text
            )
            assert f">{quantity.name}<" in page
        assert not re.search(r"\de[-+]?\d|\b[^\W\d_]_[^\W_]\b", page)  # indices and powers as one writes them
    samples = np.loadtxt(sheet / "inputs" / "record.csv", delimiter=",", skiprows=1)[:, 1]
    motion = next(problem.scene.motion for problem in PROBLEMS if problem.name == "record")
    assert samples.tolist() == motion.samples.tolist()


def test_the_table_of_answers_holds_each_of_each_page(sheet):
    head, *lines = (sheet / "reference.csv").read_text().splitlines()
    assert head == "scene,quantity,unit,answer,tolerance"
    expected = [
        [
            problem.name,
            quantity.name,
            UNITS[quantity.kind],
            str(problem.answers[quantity.name]),
            str(problem.tolerance(quantity) or ""),
        ]
        for problem in PROBLEMS
        for quantity in problem.quantities
    ]
    assert [line.split(",") for line in lines] == expected
