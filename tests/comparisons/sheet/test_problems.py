"""The reference answers of the problem sheet, held to the second implementation."""

import pytest

from analytic.twin import simulate_twin
from comparisons.sheet.problems import PROBLEMS

EXACT = 1e-7  # of the tolerance: so well the answers are known, as index.md says


def answered(problem):
    """{quantity: what the second implementation answers}, by the meaning of the names on the page."""
    how = {"rtol": 1e-13, "history": False, "energy": False, "max_step": 0.01}
    whole, found = simulate_twin(problem.scene, **how), {}
    for time in {one.name.partition("_at_")[2] for one in problem.quantities} - {""}:
        state = simulate_twin(problem.scene.with_(duration=float(time)), **how).end
        found |= {f"tilt_at_{time}": state.tilt, f"tilt_rate_at_{time}": state.tilt_rate}
        found |= {f"displacement_at_{time}": state.base_displacement, f"force_at_{time}": state.bearing_force}
    for number, hit in enumerate(whole.impacts, 1):
        found |= {f"impact_time_{number}": hit.time, f"base_velocity_jump_{number}": hit.base_velocity_jump}
        found |= {f"rate_before_{number}": hit.rate_before, f"rate_after_{number}": hit.rate_after}
    found |= {"uplift_time": next(iter(whole.uplifts), None), "rest_time": next(iter(whole.rests), None)}
    found |= {"outcome": whole.outcome, "overturning_time": whole.overturning_time}
    return found | {"peak_tilt": whole.peak_tilt, "peak_displacement": whole.peak_base_displacement}


@pytest.mark.parametrize("problem", PROBLEMS, ids=lambda problem: problem.name)
def test_the_second_implementation_gives_the_reference_answers(problem):
    found = answered(problem)
    for one in problem.quantities:
        right, tolerance = problem.answers[one.name], problem.tolerance(one)
        if tolerance is None:
            assert found[one.name] == right
        else:
            assert found[one.name] == pytest.approx(right, rel=0, abs=EXACT * tolerance), one.name


def test_a_tolerance_is_a_thousandth_of_the_scale_of_its_page():
    block = PROBLEMS[0].scene.block  # free-rigid
    rate = (3 * 9.81 / (4 * block.radius)) ** 0.5
    tolerances = {one.kind: PROBLEMS[0].tolerance(one) for one in PROBLEMS[0].quantities}
    expected = {"outcome": None, "time": 1e-3 / rate, "angle": 0.25e-3, "rate": 0.25e-3 * rate}
    assert tolerances == {kind: value and pytest.approx(value, rel=1e-12) for kind, value in expected.items()}
