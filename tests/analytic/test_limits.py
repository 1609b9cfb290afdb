"""A run that does not end is refused with an error that names the part of the scene to blame."""

import math
import re

import numpy as np
import pytest

from analytic import (
    Base,
    Bearings,
    Block,
    PulseMotion,
    SampledMotion,
    Scene,
    SceneError,
    SettingError,
    Start,
    load_scene,
    shipped_scenes,
    simulate,
    simulate_many,
)
from analytic import solver as budget
from analytic.advice.margins import margins
from analytic.checks.time_stepping import simulate_time_stepping
from analytic.checks.twin import simulate_twin
from analytic.response import scene_warnings
from analytic.rocking import RockingModel
from analytic.scene import BASE, BEARINGS, caryatid_block
from engines import get_engine

TABLE_1 = {"count": 4, "ka": 6.22e4, "kb": 6.22e3, "alpha": 44.69}
PULSE = PulseMotion("one-sine", 3.0, 3.0)


def isolated(motion=PULSE, **bearings):
    return Scene(block=caryatid_block(0.28), base=BASE, bearings=Bearings(**bearings), motion=motion)


STIFF = {
    "stiffness": (isolated(**{**TABLE_1, "ka": 1e18}), "bearings.ka = 1e+18: the base vibrates at"),
    "linear stiffness": (isolated(law="linear", ka=1e19), "bearings.ka = 1e+19"),
    "exponent": (isolated(law="bouc-wen", **{**TABLE_1, "alpha": 1e10}), "bearings.alpha = 10000000000.0: the law"),
    "damper": (isolated(**TABLE_1, damping=1e14), "bearings.damping = 100000000000000.0: such dampers stop the base"),
    "slow pulse": (isolated(PulseMotion("one-sine", 2.0, 1e-7), **TABLE_1), "motion.frequency = 1e-07: the motion"),
    "late pulse": (
        Scene(block=caryatid_block(0.28), base=BASE, bearings=BEARINGS, start=Start(base_displacement=0.2),
              motion=PulseMotion("one-sine", 3.0, 3.0, start=1e7)),
        "motion.start = 10000000.0: the motion lasts",
    ),
}  # fmt: skip


@pytest.fixture
def small(monkeypatch):
    """Allow a hundredth of the steps: the scene that is refused need not be as stiff."""
    monkeypatch.setattr(budget, "STEPS", budget.STEPS // 100)
    monkeypatch.setattr(budget, "MOST_STEPS", budget.MOST_STEPS // 100)


@pytest.mark.parametrize("scene, words", STIFF.values(), ids=STIFF)
def test_what_does_not_get_on_is_named(small, scene, words):
    with pytest.raises(SceneError) as caught:
        simulate(scene)
    assert str(caught.value).startswith(words)
    assert "steps of the analytic model reach only" in str(caught.value)
    with pytest.raises(SceneError) as caught:
        margins(scene)
    assert str(caught.value).startswith(words.partition(":")[0])


def test_the_frequency_named_is_that_of_the_base_under_a_block_that_follows_it(small):
    """The mass that counts does not rock with the block: M - (m R cos(gamma))^2/J."""
    scene = isolated(law="linear", count=4, ka=1e19)
    block = scene.block
    free = scene.total_mass - (block.mass * block.radius * math.cos(block.slenderness)) ** 2 / block.inertia
    with pytest.raises(SceneError, match=re.escape(f"vibrates at {math.sqrt(4e19 / free):.3g} rad/s")):
        simulate(scene)


@pytest.mark.parametrize("duration", [None, 1.0])
def test_the_second_implementation_refuses_at_once_what_the_model_gives_up(duration):
    scene = isolated(law="linear", ka=1e20)
    with pytest.raises(SceneError, match=r"bearings.ka = 1e\+20: the base vibrates at .* steps of the second"):
        simulate_twin(scene.with_(duration=duration))


def test_steps_too_short_for_the_run_are_refused_by_the_shortest_that_are_not():
    scene = Scene(block=caryatid_block(0.28), start=Start(tilt=0.2), duration=10.0)
    with pytest.raises(SettingError, match="max_step = 1e-09: 1e\\+10 steps; give at least 2e-06 s"):
        simulate_twin(scene, max_step=1e-9)
    with pytest.raises(SettingError, match="step = 1e-09: 1e\\+10 steps; give at least 1e-06 s"):
        simulate_time_stepping(scene, step=1e-9)
    with pytest.raises(SettingError, match="give at least 1e-07 s"):
        simulate_time_stepping(scene, step=1e-9, history=False)


@pytest.mark.slow
def test_a_stiff_scene_that_runs_is_still_too_much_as_often_as_margins_run_it():
    scene = isolated(**{**TABLE_1, "ka": 1e11})
    with pytest.raises(SceneError, match="bearings.ka.* runs of .* steps are too many"):
        margins(scene)


def test_among_many_the_run_that_does_not_get_on_has_failed(small):
    outcomes = simulate_many([isolated(**TABLE_1), STIFF["stiffness"][0]])
    assert outcomes.failed.tolist() == [False, True]
    assert outcomes.names.tolist() == ["overturns", "failed"]


def test_a_longer_duration_may_take_more_steps_and_a_record_some_for_each_sample():
    scene = isolated(**TABLE_1)
    assert budget.most_steps(scene) == budget.most_steps(scene.with_(duration=20.0)) == budget.STEPS
    assert budget.most_steps(scene.with_(duration=1e9)) == budget.MOST_STEPS
    long = scene.with_(motion=SampledMotion(0.01, np.zeros(1_000_000)))
    assert budget.most_steps(long) == budget.STEPS + budget.STEPS_PER_SAMPLE * 1_000_000


def test_more_impacts_than_are_kept_are_an_error(monkeypatch):
    monkeypatch.setattr("analytic.solver.EVENTS", 50)
    scene = Scene(block=caryatid_block(0.28), start=Start(tilt=0.2), duration=50.0)
    with pytest.raises(SceneError, match="of which no more than 50 are kept"):
        simulate(scene)


def test_a_history_is_thinned_unless_its_interval_is_given():
    scene = Scene(block=caryatid_block(0.28), motion=SampledMotion(0.005, [0.0, 0.1, 0.0]), duration=1e5)
    history = simulate(scene).history
    assert len(history.time) <= budget.ROWS + 2
    assert history.time[1] == pytest.approx(0.005 * math.ceil(1e5 / 0.005 / budget.ROWS))
    assert simulate(scene.with_(duration=10.0)).history.time[1] == 0.005
    with pytest.raises(SettingError, match="1e\\+08 rows of history; give at least 0.01 s, or history=False"):
        simulate(scene, output_step=1e-3)
    assert simulate(scene, output_step=1e-3, history=False).history is None


# What bearings are built for, and how a run beyond it is said.
LIMITED = Bearings(count=4, ka=6.22e4, kb=6.22e3, alpha=44.69, x_max=0.05)
SCENE = Scene(
    block=Block(mass=3172.05, radius=1.0884, slenderness=0.28),
    base=Base(mass=212.0),
    bearings=LIMITED,
    motion=PulseMotion("one-sine", 2.0, 8.0),
    duration=1.0,
)


def answer(solver, scene):
    models = {"kernel": simulate, "twin": simulate_twin}
    return models[solver](scene) if solver in models else get_engine(solver).simulate(scene)


@pytest.mark.parametrize("solver", ["kernel", "twin", "mujoco"])
def test_a_base_beyond_its_bearings_limit_is_said(solver):
    response = answer(solver, SCENE)
    assert response.peak_base_displacement > 0.05
    words = f"the base moves by {response.peak_base_displacement:.3g} m, beyond the x_max = 0.05 m of its bearings"
    assert any(warning.text.startswith(words) for warning in response.warnings)


SLIDER = Scene(
    block=Block(mass=100.0, radius=0.5, slenderness=0.3),
    motion=PulseMotion("one-sine", 5.0, 2.5),
    friction=0.1,
    duration=3.0,
)


@pytest.mark.parametrize("solver", ["kernel", "exudyn", "pybullet", "mujoco"])
def test_a_block_that_slips_beyond_its_half_width_is_said_by_every_solver(solver):
    """A block .3 m wide slips by 2.9 m; under a short pulse by .06 m only."""
    response = answer(solver, SLIDER)
    half = SLIDER.block.half_width
    (warning,) = [caution for caution in response.warnings if caution.quantity == "peak_slip"]
    assert warning.kind == "limit"
    assert (warning.value, warning.limit) == (response.sliding.peak, half) and warning.value > 10 * half
    short = SLIDER.with_(motion=PulseMotion("rectangular", 1.5, 8.0))
    less = answer(solver, short)
    assert 0 < less.sliding.peak < half and "peak_slip" not in [caution.quantity for caution in less.warnings]


def test_a_block_that_falls_slips_as_it_falls_and_that_is_no_warning():
    falls = SLIDER.with_(motion=None, duration=None, block={"slenderness": 0.15}, start=Start(tilt=0.16), friction=0.03)
    response = simulate(falls)
    assert response.outcome == "overturns" and response.sliding.peak > falls.block.half_width
    assert "peak_slip" not in [caution.quantity for caution in response.warnings]


@pytest.mark.parametrize(
    "changes, warned",
    [
        ({"bearings": {"x_max": None}}, []),
        ({"bearings": {"x_max": 1.0}}, []),
        ({"motion": None, "start": {"base_displacement": 0.06}}, ["limit"]),
    ],
)
def test_within_it_nothing_is_said_and_nothing_changes_and_the_start_counts(changes, warned):
    scene = SCENE.with_(**changes)
    response, limited = (simulate(variant, history=False) for variant in (scene, scene.with_(bearings={"x_max": 0.05})))
    assert [warning.kind for warning in response.warnings] == warned and response.end == limited.end


@pytest.mark.parametrize("tilt, over", [(0.28, True), (-0.28, True), (0.279999, False), (-0.279999, False)])
def test_a_start_beyond_the_balance_is_said_of_the_scene_and_falls(tilt, over):
    scene = Scene(block=SCENE.block, start=Start(tilt=1.001 * tilt if over else tilt))
    assert (simulate(scene).outcome == "overturns") == over
    warnings = scene_warnings(scene.with_(start={"tilt": tilt}))
    assert [(each.quantity, each.value, each.limit) for each in warnings] == [("start.tilt", tilt, 0.28)] * over


def test_a_base_that_nothing_holds_is_said_of_the_scene():
    (warning,) = scene_warnings(SCENE.with_(bearings=None))
    assert warning.text.startswith("No friction is modelled under the base, and it has no bearings")
    assert not any(scene_warnings(sound) for sound in (SCENE, SCENE.with_(base=None, bearings=None)))
    assert not any(scene_warnings(load_scene(name)) for name in shipped_scenes())


# Peaks are peaks: within one step, between steps, and without what the last fall of a block adds.


FALLING = Scene(block=caryatid_block(0.2), base=BASE, bearings=BEARINGS, motion=PulseMotion("one-sine", 9.0, 5.0))


def test_a_swing_within_one_step_has_its_peak():
    """A peak of 9.0e-5 was once reported."""
    scene = Scene(block=caryatid_block(0.28), motion=PulseMotion("one-sine", 2.8711, 4.0))
    response = simulate(scene, output_step=1e-4)
    assert response.peak_tilt == pytest.approx(np.abs(response.history.tilt).max(), rel=1e-6)
    assert response.peak_tilt == pytest.approx(1.6632e-4, rel=1e-4)


@pytest.mark.parametrize("seed", range(14))
def test_peaks_of_weak_pulses_are_those_of_a_fine_history(seed):
    rng = np.random.default_rng(seed)
    gamma = rng.uniform(0.1, 0.4)
    shape = rng.choice(["one-sine", "one-cosine", "half-sine", "ricker"]).item()
    amplitude = 9.81 * math.tan(gamma) * rng.uniform(1.0002, 1.3)
    supported = {"base": BASE, "bearings": BEARINGS} if seed % 2 else {}
    motion = PulseMotion(shape, amplitude * (2.0 if supported else 1.0), rng.uniform(8.0, 20.0))
    response = simulate(Scene(block=caryatid_block(gamma), motion=motion, **supported), output_step=2e-4)
    history = response.history
    assert response.outcome in ("stands", "rocks")
    tilt, displacement = np.abs(history.tilt).max(), np.abs(history.base_displacement).max()
    assert tilt * (1 - 1e-12) <= response.peak_tilt <= tilt * (1 + 1e-3) + 1e-12
    assert displacement * (1 - 1e-12) <= response.peak_base_displacement <= displacement * (1 + 1e-5)


@pytest.mark.parametrize("motion", [PulseMotion("ricker", 8.0, 8.5), PulseMotion("one-sine", 5.0, 9.0)])
def test_acceleration_and_contact_forces_are_those_of_a_fine_history(motion):
    scene = Scene(block=caryatid_block(0.2), base=BASE, bearings=BEARINGS, motion=motion)
    response = simulate(scene, output_step=1e-4)
    accelerations, demands, normals = contact(scene, response.history)
    assert response.outcome == "rocks"
    assert response.peak_base_acceleration == pytest.approx(accelerations.max(), rel=5e-4)
    assert response.friction_demand == pytest.approx(demands.max(), rel=5e-4)
    assert response.min_normal_ratio == pytest.approx(normals.min(), abs=5e-4)


def contact(scene, history):
    """Return (|absolute acceleration|, |H|/N, N/(m g)) at the rows of a history."""
    model, forces = RockingModel.of(scene), []
    for tilt, rate, force, ground in zip(
        history.tilt, history.tilt_rate, history.bearing_force, history.ground_acceleration, strict=True
    ):
        absolute, horizontal, normal = -force / model.M, -force / model.M * model.m, model.m * model.g
        if tilt:
            side = math.copysign(1.0, tilt)
            spin, push = model.accelerations(side, tilt, rate, ground, force, 0.0)
            absolute = push + ground
            horizontal, normal = model.contact_forces(side, tilt, rate, spin, absolute, 0.0)
        forces.append((abs(absolute), abs(horizontal) / normal, normal / (model.m * model.g)))
    return np.array(forces).T


@pytest.mark.parametrize("scale", [0.7, 1.0, -1.3])
def test_peaks_of_the_base_end_at_the_last_passage_of_the_slenderness(scale):
    """The fall from there to pi/2, in which a block would slide, does not count for the base."""
    scene = FALLING.with_(motion=FALLING.motion.scaled(scale))
    response = simulate(scene, output_step=1e-4)
    beyond = np.abs(response.history.tilt) > scene.block.slenderness
    last = np.flatnonzero(~beyond)[-1] + 1
    assert response.outcome == "overturns"
    before = np.abs(response.history.base_displacement[: last + 1]).max()
    assert response.peak_base_displacement == pytest.approx(before, rel=1e-3)
    assert response.fall_time == pytest.approx(response.history.time[last], abs=1.01e-4)
    many = simulate_many([scene], contact=True)
    assert many.peak_base_displacement[0] == pytest.approx(response.peak_base_displacement, rel=1e-9)
    assert many.friction_demand[0] == pytest.approx(response.friction_demand, rel=1e-9)
    assert simulate_many([scene]).peak_base_displacement[0] == pytest.approx(before, rel=1e-3)
    second, coarse = simulate_twin(scene, rtol=1e-11), simulate_time_stepping(scene, step=1e-4)
    for other, names, accuracy in (
        (second, ("peak_base_displacement", "unstable_time", "fall_time", "overturning_time"), 1e-7),
        (second, ("peak_base_acceleration", "friction_demand", "min_normal_ratio"), 1e-2),  # at its steps
        (coarse, ("peak_base_displacement", "peak_base_acceleration", "fall_time"), 1e-3),
    ):
        assert [getattr(other, name) for name in names] == pytest.approx(
            [getattr(response, name) for name in names], rel=accuracy
        )


def test_a_limit_that_only_the_fall_goes_beyond_is_not_warned_of():
    scene = Scene(
        block=caryatid_block(0.3),
        base=Base(mass=50.0),
        bearings=Bearings(count=4, ka=2e5, kb=2e4, alpha=44.69),
        motion=PulseMotion("half-sine", 14.0, 4.0),
    )
    response = simulate(scene)
    whole, peak = np.abs(response.history.base_displacement).max(), response.peak_base_displacement
    assert response.outcome == "overturns" and whole > 1.05 * peak
    for limit, warned in ((0.5 * (whole + peak), False), (0.99 * peak, True)):
        warnings = simulate(scene.with_(bearings={"x_max": limit})).warnings
        assert any(caution.kind == "limit" for caution in warnings) == warned


def test_a_block_that_comes_back_from_beyond_the_unstable_point_falls_at_its_last_passage():
    """One sine throws it beyond the slenderness on one side, brings it back, and it falls on the other."""
    scene = Scene(block=caryatid_block(0.2), motion=PulseMotion("one-sine", 4.7, 5.82))
    response = simulate(scene, output_step=1e-4)
    beyond = np.abs(response.history.tilt) > 0.2
    first, last = np.flatnonzero(beyond)[0], np.flatnonzero(~beyond)[-1] + 1
    times = response.history.time[[first, last]]
    assert [response.unstable_time, response.fall_time] == pytest.approx(times, abs=1.01e-4)
    assert response.outcome == "overturns" and len(response.impacts) == 1 and times[1] > 2 * times[0]
    for other in (simulate_twin(scene.with_(duration=4.0), rtol=1e-11), simulate_time_stepping(scene, step=1e-5)):
        assert [other.unstable_time, other.fall_time] == pytest.approx(times, abs=3e-4)
    cut = simulate(scene.with_(duration=2.0), history=False)  # ended while it falls
    assert cut.outcome == "overturns" and cut.fall_time == pytest.approx(response.fall_time, rel=1e-9)
    assert simulate(scene.with_(motion=scene.motion.scaled(0.5))).fall_time is None
