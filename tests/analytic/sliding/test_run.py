"""The march against closed forms, the kernel, energy, and answers of two other methods."""

import math
import re
from itertools import product

import numpy as np
import pytest
from sliding_scenes import GRAVITY, random_slider, scene_of, slider_of

import analytic.sliding.run as sliding
from analytic import PulseMotion, SceneError, load_scene, overturning_map, simulate, simulate_many
from analytic.checks.time_stepping import simulate_time_stepping
from analytic.kernel import layout as S
from analytic.kernel.decision import RIGID_BEARINGS
from analytic.records.synthetic import synthetic_motion
from analytic.response import Response
from analytic.rocking import RockingModel
from analytic.sliding.run import contact_of, marched, slipping_friction
from analytic.solver import ground, options, parameters


def march_of(scene, **settings):
    """Return (totals, impacts, changes) of a march, without asking the kernel first."""
    shaking = ground(scene.motion)
    totals, impacts, changes, _ = marched(parameters(scene), contact_of(scene), shaking, options(**settings))
    return totals, impacts, changes


RECTANGLE, BELL = PulseMotion("rectangular", 4.0, 2 * math.pi), PulseMotion("half-sine", 5.0, 2 * math.pi)


def newmarks(friction, pulse):
    """Return (path, speed, time of the stop, what a step h may add to it over h^2) of a block under the ground's pulse.

    It slides at mu g from where the ground exceeds that; under a half-sine the speed is off by up to a'_g h^2/8.
    """
    mg, a, w = friction * GRAVITY, pulse.amplitude, pulse.frequency
    end, begin = math.pi / w, 0.0 if pulse.shape == "rectangular" else math.asin(mg / a) / w
    speed, way = (a - mg) * end, (a - mg) * end**2 / 2
    if begin:  # from there the velocity is a (cos(w begin) - cos(w t))/w - mu g (t - begin)
        speed = a / w * (math.cos(w * begin) + 1) - mg * (end - begin)
        way = a / w * (math.cos(w * begin) * (end - begin) + math.sin(w * begin) / w) - mg * (end - begin) ** 2 / 2
    begun = a * w * math.cos(w * begin) / 8 * (end - begin + speed / mg) if begin else 0.0
    return way + speed**2 / (2 * mg), speed, end + speed / mg, begun + mg


@pytest.mark.parametrize("friction, pulse", [(0.2, RECTANGLE), (0.15, BELL)], ids=["rectangular", "half-sine"])
def test_a_sliding_block_is_newmarks(friction, pulse):
    scene = scene_of(friction, slenderness=0.4, motion=pulse, duration=3.0)
    totals, impacts, changes = march_of(scene)
    way, speed, stop, loose = newmarks(friction, pulse)
    assert not len(impacts) and speed > 0
    assert totals[S.END_SLIP] == pytest.approx(-way, abs=1e-10)
    assert changes[-1] == pytest.approx((stop, S.STICK), abs=1e-10)
    assert totals[S.FRICTION_WORK] == pytest.approx(friction * GRAVITY * 3172.05 * totals[S.PATH], rel=1e-12)
    for step in (1e-3, 3.1e-4, 1e-4):  # it stops within a step, in which it could go mu g step^2
        run = simulate_time_stepping(scene, step=step, history=False)
        assert run.outcome == "slides" and not run.impacts and run.peak_tilt == 0
        assert run.sliding.end == pytest.approx(-way, abs=loose * step**2)
        assert run.sliding.path == pytest.approx(run.sliding.peak) == pytest.approx(-run.sliding.end)


def shentons_mode(slenderness, a, friction):
    """Return the mode of a rectangular block at rest when the ground's acceleration jumps to a g (Shenton 1996)."""
    sine, cosine, tangent, q = math.sin(slenderness), math.cos(slenderness), math.tan(slenderness), 0.75
    if a <= min(friction, tangent):
        return S.STICK
    if friction < tangent:
        return S.SLIDE
    needed = (a * (1 - q * cosine**2) + q * sine * cosine) / (1 - q * sine**2 + q * a * sine * cosine)
    return S.ROCK if friction >= needed else S.SLIDE_ROCK


def test_the_first_mode_is_shentons():
    grid = np.linspace(0.1, 0.5, 3), np.linspace(0.05, 1.5, 14), np.linspace(0.02, 1.2, 13)
    for slenderness, a, friction in product(*(axis.tolist() for axis in grid)):
        pulse = PulseMotion("rectangular", a * GRAVITY, 1000.0)
        _, _, changes = march_of(scene_of(friction, slenderness, motion=pulse, duration=1e-3))
        assert changes[0, 1] == shentons_mode(slenderness, a, friction), (slenderness, a, friction)


@pytest.mark.parametrize("base", [None, 212.0, 3000.0, 1e9])
@pytest.mark.parametrize("share", [0.3, 0.6, 0.9, 1.001, 1.5, 4.0])
def test_a_first_impact_is_equation_7_or_slips(base, share):
    scene = scene_of(1.0, 0.3, base=base, start={"tilt": 1e-4, "tilt_rate": -0.5}, duration=1e-3)
    limit = slipping_friction(parameters(scene))
    scene = scene.with_(friction=share * limit)
    _, impacts, _ = march_of(scene)
    _, before, after, jump, kind, speed = impacts[0]
    model = RockingModel.of(scene)
    if share > 1:
        assert kind == S.NEW_STICKS and speed == 0
        assert after / before == pytest.approx(model.restitution, abs=1e-12)  # (7)
        assert jump == pytest.approx(model.jump_arm * (before - after), abs=1e-12)  # (8)
    else:
        assert kind == S.NEW_SLIPS and speed != 0
        b, h = scene.block.half_width, scene.block.half_height  # on any base
        gripping = scene.block.mass * b * (b - scene.friction * h) / scene.block.centre_inertia
        assert after / before == pytest.approx((1 - gripping) / (1 + gripping), abs=1e-12)


@pytest.mark.parametrize("seed", [*range(3), *(pytest.param(seed, marks=pytest.mark.long) for seed in range(3, 10))])
def test_energy_is_conserved_with_exactly_one_mode(seed):
    """In 100 scenes no march ends because no mode or a second one is admissible, and no impact gains energy."""
    rng = np.random.default_rng([55, seed])
    for number in range(100):
        scene = random_slider(rng, number)
        totals, impacts, _ = march_of(scene)
        assert totals[S.STATUS] == 0, number
        response = simulate(scene, history=False)
        if response.sliding is None:
            continue
        energy = response.energy
        size = max(abs(energy.input), energy.friction, energy.impact_loss, abs(energy.kinetic), abs(energy.potential))
        assert abs(energy.imbalance) <= 1e-9 * size, number
        assert energy.friction >= 0 and energy.impact_loss >= 0


def test_friction_that_is_never_used_is_the_kernels_run():
    """Times, rates, jumps and peaks of the march are the kernel's, up to the fall, in which the block slides."""
    rng, compared = np.random.default_rng(50), 0
    while compared < 20:
        scene = random_slider(rng, 6 * compared + 1 + compared % 2).with_(friction=None)
        model = simulate(scene, history=False)
        if model.min_normal_ratio < 0.05 or model.friction_demand > 40:
            continue
        compared += 1
        totals, impacts, _ = march_of(scene.with_(friction=50.0))
        expected = [(hit.time, hit.rate_after, hit.base_velocity_jump) for hit in model.impacts[: len(impacts)][:8]]
        np.testing.assert_allclose(impacts[:8][:, [0, 2, 3]], np.reshape(expected, (-1, 3)), rtol=0, atol=1e-9)
        falls = model.outcome == "overturns"
        assert falls or len(impacts) == len(model.impacts)
        peaks = totals[[S.PEAK_TILT, S.FALL_TIME if falls else S.PEAK_X]]
        expected_peaks = model.peak_tilt, model.fall_time if falls else model.peak_base_displacement
        assert peaks == pytest.approx(expected_peaks, abs=1e-9)


def test_the_history_is_the_trajectory():
    scene = scene_of(0.4, 0.348, 1.86, motion=PulseMotion("half-sine", 9.38, 6.34), duration=3.0)
    history = simulate(scene, output_step=1e-3).history
    assert np.abs(np.diff(history.slip)).max() < 1e-3 * 2.0 and (np.diff(history.time) >= 0).all()  # no jump
    assert np.abs(np.gradient(history.tilt, history.time) - history.tilt_rate)[5:2000].max() < 0.05
    assert history.slip[-1] == simulate(scene).sliding.end


# Answers of a scene with friction, and where the march is asked at all.
DUZCE = synthetic_motion("duzce-like", 620)
RELEASED = {"tilt": 0.168}


def pulse(shape, amplitude, frequency):
    return PulseMotion(shape, amplitude, frequency)


# scene, outcome, time of overturning, peak tilt, largest slip, slip at the end; to 1e-8: two methods that share no code
# agree to what each can do (event-driven RK8 to 1e-10, Moreau's time stepping to 1e-4..1e-9)
CASES = {
    "slides, rectangular": (
        scene_of(0.2, 0.4, motion=pulse("rectangular", 4.0, 2 * math.pi), duration=2.0),
        "slides", None, 0.0, None, None,
    ),
    "lifts and slides from rest": (
        scene_of(0.3, motion=pulse("rectangular", 8.0, 26.179938779914945), duration=6.0),
        "overturns", 2.359512875, math.pi / 2, 0.040808741, -0.040808741,
    ),
    "overturns with slip": (
        scene_of(0.3, motion=pulse("one-sine", 6.0, 6.0), duration=5.0),
        "overturns", 1.903758585, math.pi / 2, 0.042705879, 0.008032760,
    ),
    "isolated, overturns with slip": (
        scene_of(0.25, base=212.0, motion=pulse("one-sine", 6.0, 4.0), duration=3.0),
        "overturns", 1.423906000, math.pi / 2, 0.413549916, 0.179554402,
    ),
    "heavy base, after an impact": (
        scene_of(0.21, base=3000.0, motion=pulse("one-sine", 5.0, 5.0), duration=5.0),
        "overturns", 2.516190967, math.pi / 2, 0.131944450, 0.070870001,
    ),
    "record, slides": (
        scene_of(0.2, 0.28, motion=DUZCE, duration=30.0), "slides", None, 0.0, 0.137434513, -0.016019202,
    ),
    "record, overturns": (
        scene_of(0.3, 0.28, motion=DUZCE, duration=30.0),
        "overturns", 6.569824533, math.pi / 2, 0.047588270, -0.021357512,
    ),
    "isolated, slipping impacts": (
        scene_of(0.1, 0.28, base=212.0, start=RELEASED, duration=3.0),
        "rocks", None, 0.168, 0.082855869, 0.058374054,
    ),
    "saved by sliding": (
        scene_of(0.4, 0.348, 1.86, motion=pulse("half-sine", 9.38, 6.34), duration=6.0),
        "rocks", None, 0.256686363, 0.192112106, -0.192112106,
    ),
    "overturned by sliding": (
        scene_of(0.5, 0.449, 1.044, motion=pulse("one-sine", 17.39, 10.13), duration=4.0),
        "overturns", 2.250170330, math.pi / 2, 0.405575703, -0.373159666,
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_cases(name):
    scene, outcome, over, tilt, largest, end = CASES[name]
    response = simulate(scene, history=False)
    assert response.outcome == outcome and response.failure is None
    assert response.overturning_time == (over and pytest.approx(over, abs=1e-8))
    assert response.peak_tilt == pytest.approx(tilt, abs=1e-8)
    # slipping impacts accumulate there, and the slip is sure to 1e-5 m
    close = 1e-5 if "impacts" in name else 1e-8
    if largest is not None:
        assert response.sliding.peak == pytest.approx(largest, abs=close)
        assert response.sliding.end == pytest.approx(end, abs=close)
    assert response.sliding.modes[0][0] == 0 and Response.from_json(response.to_json()).sliding == response.sliding


@pytest.mark.parametrize(
    "name, share",
    [("caryatid-isolated", None), ("caryatid-rigid", None), ("free-rocking-rigid", 1.05), ("free-rocking-rigid", 0.95)],
)
def test_a_friction_that_is_not_given_or_not_exceeded_leaves_the_kernels_answer(name, share, monkeypatch):
    """Near the demand, which may exceed the friction between the points at which it is read, the march decides."""
    scene = load_scene(name)
    plain = simulate(scene)
    tight = scene.with_(friction=share and share * plain.friction_demand / sliding.NEAR)
    if share != 0.95:
        monkeypatch.setattr(sliding, "marched", None)  # a call would fail
    run, many = simulate(tight), simulate_many([scene, tight], contact=True)
    assert (run.sliding, run.warnings, run.impacts, run.end) == (None, plain.warnings, plain.impacts, plain.end)
    assert many.peak_tilt[0] == many.peak_tilt[1] and many.peak_slip.max() == 0 and not many.slid.any()


def test_a_block_that_slides_warns_of_what_any_run_does():
    up = PulseMotion("one-sine", 2.0, 6.0)
    scene = scene_of(0.2, 0.4, base=212.0, motion=PulseMotion("one-sine", 6.0, 6.0, vertical=up), duration=2.0)
    run = simulate(scene.with_(bearings={"x_max": None}), history=False)
    assert run.outcome == "slides" and [caution.text for caution in run.warnings] == [RIGID_BEARINGS]
    pushed = scene.with_(bearings=None, motion=None, start={"base_velocity": 3.0})
    assert [caution.quantity for caution in simulate(pushed, history=False).warnings] == ["base_velocity"]


def test_a_fall_slides_at_any_friction():
    scene = scene_of(0.6, radius=1.0, motion=pulse("one-sine", 4.0, 5.0), duration=5.0)
    plain, slid = simulate(scene.with_(friction=None)), simulate(scene)
    assert slid.fall_time == pytest.approx(plain.fall_time, abs=1e-9)
    assert plain.overturning_time == pytest.approx(2.63284, abs=1e-4)
    stepped = simulate_time_stepping(scene.with_(duration=3.0), step=1.07e-6, history=False)
    assert slid.overturning_time == pytest.approx(stepped.overturning_time, abs=1e-5)
    assert slid.overturning_time == pytest.approx(2.63644, abs=1e-5)  # engines with a friction of their own: 2.6365
    assert slid.sliding.modes[-1][1] == "slide-rock" and slid.sliding.modes[-1][0] > slid.fall_time


def test_a_release_below_the_slipping_friction_is_refused():
    scene = scene_of(0.15, 0.28, start=RELEASED, duration=2.0)
    limit = slipping_friction(parameters(scene))
    words = rf"friction = 0.15: below {limit:.4g}, .*; give 0.2114 or more, or let the block start at rest"
    with pytest.raises(SceneError, match=words):
        simulate(scene)
    assert simulate_many([scene]).failed.all()
    assert simulate(scene.with_(friction=1.01 * limit), history=False).outcome == "rocks"


def test_a_friction_above_painleves_bound_is_refused_only_where_it_is_used():
    thin = scene_of(1.5, 0.78, motion=pulse("one-sine", 60.0, 13.0), duration=2.0)
    thin = thin.with_(block={"corner_inertia": 1.02 * thin.block.mass * thin.block.radius**2})
    with pytest.raises(SceneError, match=r"friction = 1.5: above 0.2857 \(Painleve\)"):
        simulate(thin)
    assert simulate(thin.with_(motion=None, start={"tilt": 0.1}, friction=50.0), history=False).outcome == "rocks"


def refused_scene(rng, number):
    """Return a scene whose block slides and has a restitution, or is released by hand, or both.

    Every fourth block is almost a point mass.
    """
    scene = random_slider(rng, number) if number % 2 else slider_of("flight", rng)
    share, tilt, near, mu = (
        rng.uniform(0.5, 1.05),
        rng.uniform(-0.9, 0.9),
        rng.uniform(1.01, 1.3),
        rng.uniform(0.2, 2.0),
    )
    if number % 3:
        scene = scene.with_(block={"restitution": min(RockingModel.of(scene).restitution * float(share), 1.0)})
    if number % 3 != 1:
        scene = scene.with_(start={"tilt": scene.block.slenderness * float(tilt)})
    if number % 4 == 0:
        inertia = float(near) * scene.block.mass * scene.block.radius**2
        scene = scene.with_(block={"corner_inertia": inertia}, friction=float(mu))
    return scene.with_(duration=None) if number % 5 == 0 else scene


REMEDIES = {
    "let the block start at rest": {"start": {"tilt": 0.0}},
    "leave it out": {"block": {"restitution": None}},
    "leave the friction out": {"friction": None},
}


def followed(scene, key, words):
    """Return the scene changed as a remedy says."""
    if number := re.search(r"give (?:a friction of )?(\S+) or (more|less)$", words):
        mu = float(number[1])
        assert mu > scene.friction if number[2] == "more" else mu < scene.friction
        return scene.with_(friction=mu)
    return scene.with_(**REMEDIES["leave the friction out" if key == "friction" and "leave" in words else words])


# what fails: whether its number does
FAILS = {
    r"needs, at the impact at \S+ s, a friction of (\S+) \(it is (\S+)\)": lambda needed, given: needed > given,
    r"needs a block that sticks; at a friction of (\S+) it lands sliding, (\S+) s": lambda mu, time: time > 0,
    r"needs a block that stays on a corner; it lands after a jump, (\S+) s": lambda time: time > 0,
    r"below (\S+), where an impact of a block released by hand .*": lambda limit, mu: mu < limit,
    r"above (\S+) \(Painleve\), where a block that slides, as at \S+ s, may .*": lambda bound, mu: mu > bound,
}


def test_a_refusal_names_what_fails_and_a_remedy_that_works():
    rng, seen = np.random.default_rng(3), []
    for number in range(300):
        scene = refused_scene(rng, number)
        try:
            simulate(scene, history=False)
            continue
        except SceneError as error:
            refusal = error
        ((which, match),) = [(k, re.fullmatch(k, refusal.problem)) for k in FAILS if re.fullmatch(k, refusal.problem)]
        numbers = [float(text) for text in match.groups()]
        assert FAILS[which](*numbers, *([scene.friction] if refusal.key == "friction" else [])), refusal
        for words in refusal.remedy.split(", or "):
            simulate(followed(scene, refusal.key, words), history=False)  # else it raises
            seen.append((which, refusal.key, re.sub(r"\d\S*", "#", words)))
    assert {which for which, *_ in seen} == set(FAILS) and len(set(seen)) >= 9, set(seen)


def test_many_runs_are_the_single_ones():
    scenes = [case[0].with_(duration=None) for case in CASES.values()]
    outcomes = simulate_many(scenes)
    for i, scene in enumerate(scenes):
        response = simulate(scene, history=False)
        assert (outcomes.names[i], outcomes.decided[i]) == (response.outcome, response.decided)
        assert outcomes.peak_slip[i] == pytest.approx(response.sliding.peak, abs=1e-9)
    assert (simulate_many(scenes, workers=1).peak_slip == outcomes.peak_slip).all()


def test_a_map_slides():
    scene = scene_of(0.2, 0.4)
    outcomes = overturning_map(scene, "one-sine", [2.0, 4.0], [0.3, 1.5, 3.0])
    assert (outcomes.names == np.array([["stands", "stands"], ["slides", "slides"], ["slides", "slides"]])).all()
