import functools
import math
import operator

import numpy as np
import pytest
from bearing_laws import NAMES, bearings_of
from literature import under_a_pulse
from sliding_scenes import KINDS, slider_of

from analytic import Base, Block, PulseMotion, Scene, SceneError, SettingError, Start, closed_form, simulate
from analytic.problems import problem_a, problem_b
from analytic.rocking import momentum_restitution
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


# with a friction: Moreau's time stepping
slid = functools.partial(simulate_time_stepping, history=False)

BLOCK = Block(mass=3172.05, radius=1.0884, slenderness=0.4)
BASES = [None, Base(mass=212.0), Base(mass=3000.0), Base(mass=1e9)]
G = 9.81


def test_a_block_that_hops_slips_when_it_lands():
    """Under a_v = -2 g it flies, and lands with -m eta' and at most mu of it to brake the slip."""
    a, mu, T = 4.0, 0.2, 0.1
    pulse = PulseMotion("rectangular", a, math.pi / T, vertical=PulseMotion("rectangular", -2 * G, math.pi / T))
    v = a * T - mu * G * math.sqrt(2) * T
    exact = -(a * T**2 * (1.5 + math.sqrt(2)) + v**2 / (2 * mu * G))
    for step in (1e-4, 1e-5):
        run = slid(Scene(block=BLOCK, friction=mu, motion=pulse, duration=1.0), step=step)
        assert run.peak_tilt < a * step and run.sliding.end == pytest.approx(exact, abs=5 * a * T * step)


@pytest.mark.parametrize("base", BASES)
@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("share", [0.0, 0.4, 0.9, 1.1, 50.0])
def test_an_impact_is_that_of_the_momentum_equations(base, side, share):
    """With friction above mu_c eqs (7), (8); below it the restitution of an impact that slips, on any base."""
    step, rate = 1e-8, 1.0
    m, J, b, h = BLOCK.mass, BLOCK.centre_inertia, BLOCK.half_width, BLOCK.half_height
    mu = m * b * h / (J + m * h**2 + (J * m / base.mass if base else 0.0)) * share
    start = Start(tilt=-1e-10 * side, tilt_rate=rate * side)
    scene = Scene(block=BLOCK, base=base, friction=max(mu, 1e-15), start=start, duration=step)
    lever = m * b * (b - mu * h)
    e = momentum_restitution(scene) if share > 1 else (J - lever) / (J + lever)
    end = slid(scene, step=step).end
    assert end.tilt_rate * side == pytest.approx(e * rate, abs=20 * step)  # gravity in one step
    if base and share > 1:
        jump = scene.mass_share * h * (rate - e * rate)
        assert end.base_velocity * side == pytest.approx(jump, abs=20 * step)


def isolated(law="algebraic", friction=0.25, sign=1, **changes):
    scene = Scene(
        block=Block(mass=3172.05, radius=1.0884, slenderness=0.2),
        base=Base(mass=212.0),
        bearings=bearings_of(law, count=4),
        motion=PulseMotion("one-sine", 6.0 * sign, 4.0),
        friction=friction,
        duration=3.0,
    )
    return scene.with_(**changes)


@pytest.mark.parametrize("law", NAMES)
def test_without_slip_it_tends_to_the_model(law):
    """Of all bearing laws, with damping and vertical motion.

    Where a corner gapes by rounding or curvature, it is free for a step, in which it slips by up to g step^2.
    """
    pulse = PulseMotion("one-sine", 3.5, 4.0, vertical=PulseMotion("one-sine", 2.0, 4.0, phase=0.5))
    bearings, start = bearings_of(law, count=4, damping=300.0), Start(base_displacement=0.02)
    scene = isolated(law, 5.0, motion=pulse, bearings=bearings, start=start, block={"slenderness": 0.28}, duration=1.6)
    model = simulate(scene)
    assert (model.outcome, len(model.impacts)) == ("rocks", 1)
    for step in (1e-4, 1e-5):
        run = slid(scene, step=step)
        assert (run.outcome, len(run.impacts)) == ("rocks", 1) and run.sliding.path < G * scene.duration * step
        found = run.peak_tilt, run.peak_base_displacement, run.end.tilt, run.end.base_displacement
        exact = model.peak_tilt, model.peak_base_displacement, model.end.tilt, model.end.base_displacement
        assert found == pytest.approx(exact, abs=2 * step)


def test_its_impacts_and_its_history_are_those_of_the_model():
    """Of a block that sticks; without a duration it runs until it is decided."""
    scene = problem_a(7.0).with_(friction=5.0)
    model, run = simulate(scene, output_step=1e-4), simulate_time_stepping(scene, step=1e-4)
    assert len(run.impacts) == len(model.impacts) == 10
    for one, other in zip(run.impacts[:5], model.impacts, strict=False):
        assert (one.time, one.rate_before, one.rate_after) == pytest.approx(
            (other.time, other.rate_before, other.rate_after), abs=2e-3
        )
    for name in ("time", "tilt", "base_displacement", "bearing_force", "ground_acceleration"):
        assert np.allclose(getattr(run.history, name), getattr(model.history, name), atol=2e-3), name
    assert np.abs(run.history.slip).max() == run.sliding.peak < 1e-3
    free = slid(scene.with_(duration=None, start={"tilt": 0.1}), step=1e-3)
    assert free.decided and free.outcome == "rocks" and free.end.time > 3


def test_its_peaks_leave_the_last_fall_out_and_its_history_ends_with_it():
    scene = isolated()
    model, run = simulate(scene), simulate_time_stepping(scene, step=1e-5)
    assert (run.fall_time, run.unstable_time, run.peak_base_displacement) == pytest.approx(
        (model.fall_time, model.unstable_time, model.peak_base_displacement), abs=1e-3
    )
    history = run.history
    assert history.time[-1] == run.overturning_time and abs(history.tilt[-1]) == pytest.approx(math.pi / 2)
    assert history.slip[-1] == run.sliding.end and len(history.time) == run.steps + 1


@pytest.mark.parametrize("solve", [simulate_time_stepping, slid])
@pytest.mark.parametrize("step", [0.0, -1e-3, math.nan, math.inf, 1e-9])
def test_refused_steps(solve, step):
    with pytest.raises(SettingError, match="step"):
        solve(isolated(), step=step)


def test_a_given_restitution_is_refused():
    with pytest.raises(SceneError, match=r"block\.restitution = 0\.9"):
        slid(isolated(block={"restitution": 0.9}), step=1e-3)


LONGER = ("ricker", "viscous", "bouc-wen")


@pytest.mark.parametrize(
    "kind", [pytest.param(kind, marks=pytest.mark.long if kind in LONGER else ()) for kind in KINDS]
)
def test_it_tends_to_the_march_in_scenes_of_each_kind(kind):
    """With a sixteenth of the step a third of the error or less, or 1e-5 (m, rad, s): first order, not monotone."""
    rng, compared = np.random.default_rng([55, KINDS.index(kind)]), 0
    while compared < 3:
        scene = slider_of(kind, rng)
        model = simulate(scene, history=False)
        slides = model.sliding is not None and model.sliding.path > 1e-3
        if not slides or kind == "flight" and "flight" not in {mode for _, mode in model.sliding.modes}:
            continue
        compared += 1
        coarse, fine = (slid(scene, step=step) for step in (4e-5, 2.5e-6))
        # at the end of its duration a block may still fall, which the model follows to its end
        falls = model.outcome == "overturns" and model.overturning_time <= scene.duration
        assert fine.outcome == ("rocks" if model.outcome == "overturns" and not falls else model.outcome)
        exact = {"sliding.peak": model.sliding.peak, "sliding.end": model.sliding.end, "peak_tilt": model.peak_tilt}
        exact |= {"overturning_time": model.overturning_time} if falls else {}
        if model.outcome != "overturns" or falls:  # else the model's is that up to the last fall
            exact["peak_base_displacement"] = model.peak_base_displacement
        for name, value in exact.items():
            errors = [abs(operator.attrgetter(name)(run) - value) for run in (coarse, fine)]
            assert errors[1] <= max(errors[0] / 3, 1e-5), (scene, name, errors)
