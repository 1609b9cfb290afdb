import functools
import math
import operator

import numpy as np
import pytest
from bearing_laws import NAMES, bearings_of
from literature import A_REST, A_TILT, B_TILT, under_a_pulse
from record_files import RECORDS, needs_records
from scipy.integrate import solve_ivp
from sliding_scenes import KINDS, slider_of

from analytic import (
    Base,
    Block,
    PulseMotion,
    SampledMotion,
    Scene,
    SceneError,
    SettingError,
    Start,
    load_scene,
    simulate,
)
from analytic.checks import closed_form
from analytic.checks.time_stepping import simulate_time_stepping
from analytic.checks.twin import simulate_twin
from analytic.motion import segments
from analytic.records import read_record
from analytic.rocking import momentum_restitution
from analytic.scene import BASE, caryatid_block, problem_a, problem_b
from analytic.scene import BEARINGS as LRB

P, GAMMA = 2.60, 0.25
HOUSNER = 1 - 1.5 * math.sin(GAMMA) ** 2
CARYATID, SLENDER = caryatid_block(0.28), caryatid_block(0.15)


def count_to(run, rate):
    """Return the number of impacts until |w+| < rate."""
    return next(n for n, impact in enumerate(run.impacts, 1) if abs(impact.rate_after) < rate)


@pytest.mark.parametrize(
    ("method", "rtol", "tolerance"),
    [("DOP853", 1e-12, 2e-11), ("RK45", 1e-10, 5e-9), ("LSODA", 1e-11, 2e-8), ("Radau", 1e-8, 5e-8)],
)
def test_problem_a(method, rtol, tolerance):
    run = simulate_twin(problem_a(), method=method, rtol=rtol, history=False, energy=False)
    exact = closed_form.free_rocking(P, GAMMA, HOUSNER, 0.9 * GAMMA, 10)
    assert run.impact_count == 10 and run.variant == method
    np.testing.assert_allclose([impact.time for impact in run.impacts], exact.times, rtol=0, atol=tolerance)
    np.testing.assert_allclose([abs(impact.rate_after) for impact in run.impacts], exact.rates_after, rtol=tolerance)
    assert abs(run.end.tilt) == pytest.approx(A_TILT, abs=tolerance)


def test_rest_of_problem_a():
    scene = problem_a(12.0)
    run = simulate_twin(scene, rtol=1e-12)
    assert [count_to(run, share * P) for share in A_REST] == [count for count, _ in A_REST.values()]
    assert run.impact_count == 177
    assert run.rests[0] == pytest.approx(closed_form.rest_time(P, GAMMA, HOUSNER, 0.9 * GAMMA), abs=1e-9)
    assert (run.end.tilt, run.end.tilt_rate, run.energy.input, run.energy.kinetic) == (0, 0, 0, 0)
    released = scene.block.mass * 9.81 * scene.block.radius * (math.cos(0.025) - math.cos(0.25))
    assert (-run.energy.potential, run.energy.impact_loss) == pytest.approx((released, released), rel=1e-10)


@pytest.mark.parametrize("method", ["DOP853", "RK45"])
def test_problem_b(method):
    run = simulate_twin(problem_b(10.0), method=method, rtol=1e-11)
    assert run.uplifts == (pytest.approx(math.asin(1 / 1.2) / 5.2, abs=1e-14),)
    assert count_to(run, 1e-4 * P) == 81
    assert run.impacts[80].time == pytest.approx(9.145490645, abs=2e-8)
    end = simulate_twin(problem_b(), method=method, rtol=1e-11).end
    assert abs(end.tilt) == pytest.approx(B_TILT, abs=1e-9)


def test_error_falls_with_the_tolerance():
    runs = [simulate_twin(problem_a(), rtol=rtol, history=False, energy=False) for rtol in (1e-6, 1e-8, 1e-10, 1e-12)]
    errors = [abs(abs(run.end.tilt) - A_TILT) for run in runs]
    assert errors == sorted(errors, reverse=True) and errors[-1] < 1e-11


def test_start_flat_with_a_rate_rocks_to_the_side_of_the_rate():
    for rate in (0.1, -0.1):
        run = simulate_twin(problem_a(0.05).with_(start=Start(tilt_rate=rate)))
        assert run.end.tilt * rate > 0 and run.outcome == "rocks" and run.uplifts == ()


def test_rest_limit_is_the_same_whenever_impacts_are_declared_accumulated():
    # under a bearing force the two corners are pressed down unequally
    scene = Scene(block=SLENDER, base=BASE, bearings=LRB, duration=4.0, start=Start(tilt=0.02, base_displacement=0.1))
    limits = [simulate_twin(scene, rtol=1e-12, rest_rate=rate).rests[0] for rate in (1e-5, 1e-7, 1e-9)]
    assert abs(limits[1] - limits[2]) < 1e-9 and abs(limits[0] - limits[2]) < 1e-6


def test_restitution_of_one_fails_instead_of_bouncing_for_ever(monkeypatch):
    monkeypatch.setattr("analytic.checks.twin.IMPACT_LIMIT", 100)
    run = simulate_twin(problem_a().with_(block={"restitution": 1.0}, start=Start(tilt=1e-9)))
    assert run.outcome == "failed" and "pile up" in run.failure.reason
    assert run.failure.last_state.time < 7


def test_event_that_scipy_cannot_find_is_a_failure_with_scipys_words(monkeypatch):
    """LSODA's dense output may miss its own sign change: brentq then raises inside `solve_ivp`."""
    calls, words = [], "f(a) and f(b) must have different signs"

    def third_call_raises(*args, **settings):
        calls.append(args[1])
        if len(calls) == 3:
            raise ValueError(words)
        return solve_ivp(*args, **settings)

    scene = Scene(block=SLENDER, base=BASE, bearings=LRB, start=Start(tilt=0.1), duration=3.0)
    whole = simulate_twin(scene, method="LSODA", rtol=1e-8)
    monkeypatch.setattr("analytic.checks.twin.solve_ivp", third_call_raises)
    run = simulate_twin(scene, method="LSODA", rtol=1e-8)
    assert whole.outcome == "rocks" and run.outcome == "failed"
    assert (run.failure.reason, run.to_json()["failure"]["message"]) == ("scipy could not find an event", words)
    # it broke off where the third stretch began, and says so; what was found before is kept
    assert run.failure.last_state == run.end and 0 < run.end.time == calls[2][0] < 3.0
    assert run.impacts == tuple(impact for impact in whole.impacts if impact.time <= run.end.time)
    assert run.history.time[-1] == run.end.time and run.peak_tilt == 0.1


def test_extra_energy_and_history_do_not_change_the_outcome():
    bare = simulate_twin(problem_b(), rtol=1e-12, history=False, energy=False)
    full = simulate_twin(problem_b(), rtol=1e-12)
    assert bare.history is bare.energy is None and full.history.time[[0, -1]].tolist() == [0, 6]
    assert bare.end.tilt == pytest.approx(full.end.tilt, abs=1e-9)


@pytest.mark.parametrize("settings", [{"method": "Euler"}, {"rtol": 0.0}])
def test_settings_are_checked(settings):
    with pytest.raises(SettingError, match=str(next(iter(settings.values())))):
        simulate_twin(problem_a(), **settings)


def test_segments_cover_the_run_and_equal_the_motion():
    pulses = [
        PulseMotion(shape, 2.0, 3.0, 0.5) for shape in ("one-sine", "one-cosine", "half-sine", "rectangular", "ricker")
    ]
    record = SampledMotion(0.1, np.random.default_rng(1).normal(size=30))
    for motion in (*pulses, record, None):
        pieces = segments(motion, 20.0)
        assert pieces[0][0] == 0 and pieces[-1][1] == 20
        for (start, end, ground), after in zip(pieces, [*pieces[1:], (20.0,)], strict=True):
            assert end == after[0] and end > start
            inside = np.linspace(start, end, 7)[1:-1]
            values = [ground(t) for t in inside.tolist()]
            expected = motion.acceleration(inside) if motion else np.zeros(5)
            np.testing.assert_allclose(values, expected, rtol=0, atol=1e-13)
            assert (np.diff(values) >= 0).all() or (np.diff(values) <= 0).all()


@needs_records
def test_the_papers_outcomes_under_duzce():
    free = Scene(block=CARYATID, motion=read_record(RECORDS / "RSN1605_DUZCE_DZC270.AT2"), duration=12.0)
    run = simulate_twin(free, rtol=1e-8)
    assert run.outcome == "overturns" and 6 < run.overturning_time < 9
    run = simulate_twin(free.with_(base=BASE, bearings=LRB), rtol=1e-8)
    assert run.outcome == "stands"
    assert run.peak_base_displacement == pytest.approx(0.212, rel=5e-3)
    assert run.peak_base_acceleration / 9.81 == pytest.approx(0.236, rel=5e-3)


def test_two_crossings_within_one_step_are_found():
    # coarse records make the block graze the ground and leave again between two samples
    block, uplift = Block(mass=1000.0, radius=1.0, slenderness=0.4), 9.81 * math.tan(0.4)
    for seed in range(12):
        samples = np.random.default_rng(seed).normal(size=25) * 1.5 * uplift
        scene = Scene(block=block, motion=SampledMotion(0.1, samples), duration=2.5)
        coarse = simulate_twin(scene, history=False, energy=False)
        fine = simulate_twin(scene, max_step=1e-2, history=False, energy=False)
        assert coarse.impact_count == fine.impact_count, seed


# .


def order(steps, errors):
    """Return the slope of log error over log step, by least squares."""
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
    """By eq. (8) the horizontal momentum m (x' + R cos(gamma - |tilt|) tilt') + m_b x' stays 0."""
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

STOCKY = Block(mass=3172.05, radius=1.0884, slenderness=0.4)
BASES = [None, Base(mass=212.0), Base(mass=3000.0), Base(mass=1e9)]
G = 9.81


def test_a_block_that_hops_slips_when_it_lands():
    """Under a_v = -2 g it flies, and lands with the impulse -m eta'; at most mu of that brakes the slip."""
    a, mu, T = 4.0, 0.2, 0.1
    pulse = PulseMotion("rectangular", a, math.pi / T, vertical=PulseMotion("rectangular", -2 * G, math.pi / T))
    v = a * T - mu * G * math.sqrt(2) * T
    exact = -(a * T**2 * (1.5 + math.sqrt(2)) + v**2 / (2 * mu * G))
    for step in (1e-4, 1e-5):
        run = slid(Scene(block=STOCKY, friction=mu, motion=pulse, duration=1.0), step=step)
        assert run.peak_tilt < a * step and run.sliding.end == pytest.approx(exact, abs=5 * a * T * step)


@pytest.mark.parametrize("base", BASES)
@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("share", [0.0, 0.4, 0.9, 1.1, 50.0])
def test_an_impact_is_that_of_the_momentum_equations(base, side, share):
    """With a friction above mu_c it obeys eqs (7), (8); below it has the restitution of a slipping impact."""
    step, rate = 1e-8, 1.0
    m, J, b, h = STOCKY.mass, STOCKY.centre_inertia, STOCKY.half_width, STOCKY.half_height
    mu = m * b * h / (J + m * h**2 + (J * m / base.mass if base else 0.0)) * share
    start = Start(tilt=-1e-10 * side, tilt_rate=rate * side)
    scene = Scene(block=STOCKY, base=base, friction=max(mu, 1e-15), start=start, duration=step)
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
    """The scenes have all bearing laws, damping and vertical motion.

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
        values = run.peak_tilt, run.peak_base_displacement, run.end.tilt, run.end.base_displacement
        exact = model.peak_tilt, model.peak_base_displacement, model.end.tilt, model.end.base_displacement
        assert values == pytest.approx(exact, abs=2 * step)


def test_its_impacts_and_its_history_are_those_of_the_model():
    """The block sticks; without a duration it runs until the outcome is decided."""
    scene = problem_a(7.0).with_(friction=5.0)
    model, run = simulate(scene, output_step=1e-4), simulate_time_stepping(scene, step=1e-4)
    assert len(run.impacts) == len(model.impacts) == 10
    for impact, other in zip(run.impacts[:5], model.impacts, strict=False):
        assert (impact.time, impact.rate_before, impact.rate_after) == pytest.approx(
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
    """With a sixteenth of the step the error is a third or less, or 1e-5 (m, rad, s): first order, not monotone."""
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


def test_every_turn_of_a_base_on_linear_bearings_is_a_peak():
    """A law without memory ends no interval at a turn, so that one interval holds several."""
    scene = load_scene("caryatid-isolated").with_(
        motion=PulseMotion("one-sine", 3.0, 4.0), bearings={"law": "linear", "count": 4, "ka": 2e4}, duration=3.0
    )
    model, twin = simulate(scene), simulate_twin(scene)
    assert model.outcome == twin.outcome == "rocks"
    assert twin.peak_base_displacement == pytest.approx(model.peak_base_displacement, rel=1e-7)
