"""A run without a duration ends when nothing can change its outcome or raise its peaks; one cut short says so."""

import math

import numpy as np
import pytest
from bearing_laws import NAMES, bearings_of
from from_python import from_python
from random_scenes import random_scene
from scipy.optimize import brentq

from analytic import (
    Base,
    Bearings,
    Block,
    PulseMotion,
    Response,
    SampledMotion,
    Scene,
    Start,
    load_scene,
    simulate,
    simulate_many,
)
from analytic.checks.time_stepping import simulate_time_stepping
from analytic.checks.twin import simulate_twin
from analytic.kernel.decision import (
    PEAK_TOLERANCE,
    longest_duration,
    model_warnings,
    recoverable_energy,
    remaining_energy,
    shortest_duration,
    will_not_overturn,
)
from analytic.kernel.events import settle
from analytic.kernel.layout import Base as State
from analytic.kernel.layout import Body
from analytic.rocking import BearingLaw
from analytic.solver import is_decided, parameters

G = 9.81
BLOCK = Block(mass=1500.0, radius=1.0, slenderness=0.12)
ALPHAS = (1.2, 2.0, 3.0, 44.69, 150.0)
LAWS = {f"algebraic {alpha}": BearingLaw.of(bearings_of("algebraic", alpha=alpha)) for alpha in ALPHAS}
LAWS |= {name: BearingLaw.of(bearings_of(name)) for name in ("bouc-wen", "bilinear")}
STANDING = Body(0.0, 0.0, 0.0)
left, recoverable = from_python(remaining_energy), from_python(recoverable_energy)


def stored(law, z):
    return recoverable(float(law.law), law.constants, z)


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
@pytest.mark.parametrize("share", [-0.999999, -0.5, 0.03, 0.8])
def test_recoverable_energy_is_the_work_on_the_way_back_to_no_force(law, share):
    z = share * law.f0
    back = brentq(lambda travel: law.hysteretic(z, travel), 0.0, -math.copysign(10 * law.f0 / law.kb, z), xtol=1e-15)
    assert stored(law, z) == pytest.approx(-law.work(z, back), rel=1e-6)
    assert stored(law, z) >= 0.5 * z * z / law.dk


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_a_bearing_never_gives_back_more_than_it_holds(law):
    rng, z = np.random.default_rng(3), 0.0
    for move in rng.standard_normal(60) * law.f0 / law.dk * 10.0 ** rng.uniform(-2, 1, 60):
        work, after = law.work(z, move), law.hysteretic(z, move)
        assert stored(law, after) - stored(law, z) <= work + 1e-9 * (abs(work) + stored(law, after))
        z = after


def test_an_undamped_base_with_energy_for_eight_overturnings_is_decided_by_its_acceleration():
    bearings = Bearings(law="linear", ka=(2 * math.pi / 4.0) ** 2 * 3000.0)
    scene = Scene(block=BLOCK, base=Base(mass=1500.0), bearings=bearings, start=Start(base_displacement=0.45))
    barrier = BLOCK.mass * G * (1 - math.cos(0.12))
    assert left(parameters(scene), STANDING, State(0.45, 0.0, 0.0)) > 2.5 * barrier
    response = simulate(scene)
    assert (response.outcome, response.decided) == ("stands", True)
    assert response.end.time < longest_duration(scene) / 5
    assert response.peak_base_displacement == pytest.approx(0.45, rel=1e-9)
    assert simulate(scene.with_(start={"base_displacement": 0.49})).uplifts  # 1.02 of the uplift acceleration


def test_a_free_base_is_decided_without_the_momentum_it_keeps():
    scene = Scene(block=BLOCK, base=Base(mass=1500.0), start=Start(base_velocity=2.0, tilt=0.06))
    response, still = simulate(scene), simulate(scene.with_(start={"base_velocity": 0.0}))
    assert (response.outcome, response.decided) == ("rocks", True)
    assert response.end.time < longest_duration(scene) / 5
    assert any("slides on" in sentence.text for sentence in response.warnings)
    times = [[impact.time for impact in run.impacts[:5]] for run in (response, still)]
    assert times[0] == pytest.approx(times[1], rel=1e-9)


def test_free_rocking_is_decided_at_once_but_its_swings_are_shown():
    scene = Scene(block=BLOCK, start=Start(tilt=0.096))
    assert will_not_overturn(parameters(scene), Body(1.0, 0.096, 0.0), State(0.0, 0.0, 0.0), True)
    response = simulate(scene)
    assert response.decided and len(response.impacts) > 5
    assert response.end.time == pytest.approx(shortest_duration(scene))


@pytest.mark.parametrize(
    "tilt, rate, impacts",
    [
        (0.06, 0.0, 0),
        (0.06, 0.3, 0),
        (0.06, -0.05, 1),
        (0.06, -0.1716, 1),
        (0.06, -0.3, 1),
        (0.13, 0.1, 0),
        (0.13, -0.02, 0),
    ],
)
def test_free_rocking_on_the_ground_is_settled_as_it_goes_on(tilt, rate, impacts):
    """Its energy decides; an impact may take what is above the barrier. Beyond its balance a return is left open."""
    scene = Scene(block=BLOCK, start=Start(tilt=tilt, tilt_rate=rate))
    certain, overturns, peak, count = from_python(settle)(parameters(scene), Body(1.0, tilt, rate))
    response = simulate(scene, history=False)
    assert (certain, overturns, count) == (True, response.outcome == "overturns", impacts)
    assert max(peak, tilt) == pytest.approx(response.peak_tilt, rel=1e-9)
    assert not from_python(settle)(parameters(scene), Body(1.0, 0.13, -1.0))[0]


@pytest.fixture(scope="module")
def toppling():
    """Return a block on rigid ground under the synthetic motion, and the times when it is beyond its slenderness."""
    scene = load_scene("caryatid-rigid")
    history = simulate(scene).history
    return scene, history.time[np.abs(history.tilt) > 1.05 * scene.block.slenderness]


@pytest.mark.parametrize("share", [0.5, 0.9, 0.99])
def test_a_motion_that_ends_while_the_block_topples_overturns(toppling, share):
    scene, times = toppling
    motion = scene.motion
    count = round(times[int(share * len(times))] / motion.dt) + 1
    cut = scene.with_(motion=SampledMotion(motion.dt, motion.samples[:count]))
    short, long = (cut.with_(duration=cut.motion.end + more) for more in (0.0, 60.0))
    for run in (cut, short, long):  # the second ends at the cut, falling
        response = simulate(run)
        assert (response.outcome, response.decided) == ("overturns", True)
        assert response.overturning_time > cut.motion.end
        assert run is not short or response.end.time == run.duration < response.history.time[-1] + motion.dt
    assert simulate_twin(cut, rtol=1e-8, history=False).outcome == "overturns"
    assert simulate_many([short]).overturns[0]


@pytest.mark.parametrize("share", [0.5, 1.0])
def test_a_duration_that_cuts_the_motion_leaves_the_outcome_undecided(toppling, share):
    scene, times = toppling
    cut = scene.with_(duration=float(share * times[0]))
    response = simulate(cut)
    assert response.outcome_text == f"undecided ({response.outcome} so far)"
    assert response.to_json()["decided"] is response.decided is False
    assert not simulate_many([cut]).decided[0]


@pytest.mark.parametrize("index", range(36))
def test_nothing_changes_after_the_end_of_a_decided_run(index):
    scene = random_scene(5, index, NAMES).with_(duration=None)
    response = simulate(scene, history=False)
    assert response.outcome != "failed"
    if not response.decided:
        assert response.end.time >= longest_duration(scene) * (1 - 1e-9)
        return
    later = simulate(scene.with_(duration=response.end.time + 20 * shortest_duration(scene)), history=False)
    assert later.outcome == response.outcome
    if response.end.time < longest_duration(scene) * (1 - 1e-9):
        for name in ("peak_tilt", "peak_base_displacement")[: 2 if scene.bearings else 1]:  # a free base slides on
            assert getattr(later, name) <= getattr(response, name) * (1 + 1.01 * PEAK_TOLERANCE) + 1e-15, name
        # read at five points a step, and the steps differ: good to some 1e-3 only
        assert later.peak_base_acceleration <= response.peak_base_acceleration * 1.005 + 1e-15
    many = simulate_many([scene])
    assert many.decided[0] and many.overturns[0] == (response.outcome == "overturns")
    if response.outcome != "overturns" and scene.bearings is not None:
        assert many.peak_base_displacement[0] == pytest.approx(response.peak_base_displacement, rel=PEAK_TOLERANCE)


def test_the_second_implementation_and_the_time_stepping_run_until_decided_too():
    scene = load_scene("free-rocking-isolated").with_(duration=None)
    for response in (simulate_twin(scene, history=False), simulate_time_stepping(scene, step=1e-3)):
        assert (response.outcome, response.decided) == ("rocks", True)
        assert response.end.time == pytest.approx(shortest_duration(scene), abs=2e-3)


def test_the_model_warns_where_its_contact_would_have_to_pull():
    scene = load_scene("caryatid-rigid")
    assert simulate(scene).warnings == ()  # the last fall itself is not warned of
    pulse = PulseMotion("one-sine", 19 * G * math.tan(scene.block.slenderness), 4 * scene.rocking_frequency)
    response = simulate(scene.with_(motion=pulse))
    assert response.min_normal_ratio < 0
    flown = simulate(scene.with_(motion=pulse, friction=0.5))  # with a friction it is modelled
    assert flown.warnings == () and "slide-rock" in {mode for _, mode in flown.sliding.modes}
    assert any(warning.quantity == "min_normal_ratio" for warning in response.warnings)
    assert Response.from_json(response.to_json()).warnings == response.warnings
    assert model_warnings(scene, 0.3, 0.1) == ()


def test_a_base_that_could_still_make_its_block_slide_is_not_decided():
    """The motion of the base would not lift the standing block, but slides it at a friction of .01."""
    scene = load_scene("caryatid-isolated").with_(motion=None, start=Start(base_displacement=0.02))
    run = simulate_time_stepping(scene.with_(duration=0.5), step=1e-3)
    assert is_decided(scene, run) and is_decided(scene.with_(friction=0.5), run)
    assert not is_decided(scene.with_(friction=0.01), run)


# The reference does not hang on the duration that is asked for; times that doubles cannot resolve are refused.
DURATIONS = (1e2, 1e3, 1e5, 1e7)  # s
SLENDERNESS = 0.25
UPLIFT = 9.81 * math.tan(SLENDERNESS)


def scene_of(kind, radius, on_base, duration):
    """Return a block, on request with a base and bearings of twice its rocking period, all scaled with the radius."""
    made, omega = {"block": Block(mass=100.0, radius=radius, slenderness=SLENDERNESS)}, math.sqrt(0.75 * 9.81 / radius)
    if on_base:
        kb = (omega / 2) ** 2 * 150 / 4
        law = {"law": "bilinear", "count": 4, "ka": 5 * kb, "kb": kb, "yield_force": 0.2 * kb * radius}
        made |= {"base": Base(mass=50.0), "bearings": Bearings(**law)}
    noise = np.convolve(np.random.default_rng(3).normal(size=120), np.ones(12) / 12, "same")
    amplitude, frequency = (6.0 * UPLIFT, 3 * omega) if on_base else (2.0 * UPLIFT, 5 * omega)
    made |= {
        "free": {"start": Start(tilt=0.2)},
        "tail": {"motion": SampledMotion(0.1 / omega, (3.5 if on_base else 2.5) * UPLIFT * noise)},
        "late pulse": {"motion": PulseMotion("one-sine", amplitude, frequency, start=0.5 * duration)},
    }[kind]
    return Scene(**made, duration=duration)


@pytest.mark.parametrize("on_base", [False, True], ids=["rigid", "base"])
@pytest.mark.parametrize("kind", ["free", "tail", "late pulse"])
@pytest.mark.parametrize("radius", [0.1, 1.0, 10.0])
def test_every_duration_beyond_the_decision_gives_the_same(kind, radius, on_base):
    first = None
    for duration in DURATIONS[radius > 1 :]:
        scene = scene_of(kind, radius, on_base, duration)
        response = simulate(scene, history=False)
        started = scene.motion.start if scene.motion else 0.0
        times = np.array([impact.time for impact in response.impacts[:5]]) - started
        peaks = response.peak_tilt, response.peak_base_displacement, response.peak_base_acceleration
        first = first or (response.impact_count, peaks, times)
        assert (response.outcome, response.decided, response.impact_count) == ("rocks", True, first[0])
        assert peaks == pytest.approx(first[1], rel=1e-9)
        np.testing.assert_allclose(times, first[2], rtol=1e-9, atol=4 * np.spacing(started))
