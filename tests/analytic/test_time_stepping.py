import math

import numpy as np
import pytest
from bearing_laws import NAMES, bearings_of
from literature import under_a_pulse

from analytic import closed_form
from analytic.errors import SettingError
from analytic.motion import PulseMotion
from analytic.problems import problem_a, problem_b
from analytic.scene import Base, Block, Scene, Start
from analytic.time_stepping import simulate_time_stepping
from analytic.twin import simulate_twin


def order(steps, errors):
    """Slope of log error over log step, least squares."""
    return np.polyfit(np.log(steps), np.log(errors), 1)[0]


def test_flight_is_first_order():
    # up to the first impact of problem A: semi-implicit Euler alone
    exact = closed_form.free_rocking_tilt(2.60, 0.25, 1 - 1.5 * math.sin(0.25) ** 2, 0.225, 1.0)
    errors = [
        abs(simulate_time_stepping(problem_a(1.0), step=h, history=False).end.tilt - exact)
        for h in 1.0 / np.array([100, 200, 400, 800])
    ]
    assert order(1.0 / np.array([100, 200, 400, 800]), errors) == pytest.approx(1.0, abs=0.05)


@pytest.mark.parametrize("step, shift", [(0.02, 0.03), (0.0025, 0.002), (0.000625, 0.001)])
def test_overturning_boundary_shifts_with_the_step(step, shift):
    # safe -> one impact at w/p = 3; hard case 6: of the order of the step
    scenes = [under_a_pulse(1.43539 * (1 + share), 3, duration=8.0) for share in (-shift, shift)]
    runs = [simulate_time_stepping(scene, step=step, history=False) for scene in scenes]
    assert runs[0].outcome != "overturns" == runs[1].outcome


def test_rest_and_uplift_again():
    run = simulate_time_stepping(problem_a(30.0), step=1e-3)
    assert run.rests[0] == pytest.approx(10.05, abs=0.2)
    assert (run.end.tilt, run.end.tilt_rate) == (0, 0)
    pulse = PulseMotion("half-sine", 1.3 * 9.81 * math.tan(0.25), 3.0, start=15.0)
    again = simulate_time_stepping(problem_a(30.0).with_(motion=pulse), step=1e-3)
    assert (len(again.uplifts), len(again.rests)) == (1, 2) and again.uplifts[0] > 15


@pytest.mark.parametrize("law", NAMES)
def test_isolated_rocking_tends_to_the_twin(law):
    scene = Scene(
        block=Block(mass=3172.05, radius=1.0884, slenderness=0.15),
        base=Base(mass=212.0),
        bearings=bearings_of(law, count=4, damping=300.0),
        motion=PulseMotion("one-sine", 3.0, 4.0),
        duration=1.4,
        start=Start(base_displacement=0.02),
    )
    twin = simulate_twin(scene, rtol=1e-9)
    assert twin.outcome == "rocks"
    steps = np.array([1e-3, 5e-4, 2.5e-4, 1.25e-4]) / 2
    ends = [simulate_time_stepping(scene, step=h, history=False).end for h in steps]
    errors = [abs(end.base_displacement - twin.end.base_displacement) for end in ends]
    assert errors[-1] < 2e-4
    assert order(steps, errors) > 0.6


def test_a_free_base_takes_the_momentum_of_the_impacts():
    """Of eq. (8): horizontal momentum m (x' + R cos(gamma - |tilt|) tilt') + m_b x' stays 0."""
    block = Block(mass=3000.0, radius=1.0, slenderness=0.2)
    scene = Scene(block=block, base=Base(mass=300.0), start=Start(tilt=0.1), duration=2.0)
    run = simulate_time_stepping(scene, step=1e-4)
    history = run.history
    arm = block.mass * block.radius * np.cos(block.slenderness - np.abs(history.tilt))
    momentum = 3300.0 * history.base_velocity + arm * history.tilt_rate
    assert len(run.impacts) >= 2 and np.abs(momentum).max() < 1e-3 * np.abs(arm * history.tilt_rate).max()


def test_problem_b_lifts_within_a_step():
    run = simulate_time_stepping(problem_b(), step=1e-3)
    assert 0 <= run.uplifts[0] - math.asin(1 / 1.2) / 5.2 < 1e-3
    assert run.history.time.shape == run.history.bearing_force.shape == (6001,)


def test_step_must_be_positive():
    with pytest.raises(SettingError, match="step"):
        simulate_time_stepping(problem_a(), step=0.0)
