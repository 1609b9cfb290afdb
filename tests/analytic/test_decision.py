"""A run without a duration ends when nothing can change its outcome or raise its peaks; one cut short says so."""

import math

import numpy as np
import pytest
from bearing_laws import NAMES, to_law
from hypothesis import assume, given, settings
from hypothesis import strategies as st

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
    rocking_spectrum,
    simulate,
    simulate_many,
    synthetic_motion,
)
from analytic.bearing import BearingLaw
from analytic.decision import (
    PEAK_TOLERANCE,
    longest_duration,
    model_warnings,
    motion_end,
    recoverable_energy,
    remaining_energy,
    shortest_duration,
    will_not_overturn,
)
from analytic.rocking import RockingModel
from analytic.solver import parameters
from analytic.time_stepping import simulate_time_stepping
from analytic.twin import simulate_twin

G = 9.81
BLOCK = Block(mass=1500.0, radius=1.0, slenderness=0.12)
LAWS = [dict(law="algebraic", ka=6.22e4, kb=6.22e3, alpha=alpha) for alpha in (1.2, 2.0, 3.0, 44.69, 150.0)]
LAWS.append(dict(law="bouc-wen", ka=6.22e4, kb=6.22e3, alpha=44.69))
LAWS.append(dict(law="bilinear", ka=6.22e4, kb=6.22e3, yield_force=700.0))


def law_of(constants):
    return BearingLaw.of(Bearings(**constants))


def stored(law, z):
    return recoverable_energy(law.law, law.dk, law.alpha, law.d0, law.f0, z)


@pytest.mark.parametrize("constants", LAWS, ids=lambda c: f"{c['law']} {c.get('alpha')}")
@pytest.mark.parametrize("share", [-0.999999, -0.5, 0.03, 0.8])
def test_recoverable_energy_is_the_work_on_the_way_back_to_no_force(constants, share):
    law = law_of(constants)
    z = share * law.f0
    step = -math.copysign(law.f0 / law.dk * 1e-4, z)
    travel = [0.0]
    while law.hysteretic(z, travel[-1]) * z > 0:
        travel.append(travel[-1] + step * max(1.0, len(travel) / 100))
    force = [law.hysteretic(z, d) for d in travel]
    work = -np.trapezoid(np.where(np.array(force) * z > 0, force, 0.0), travel)
    assert stored(law, z) == pytest.approx(work, rel=2e-3)
    assert stored(law, z) >= 0.5 * z * z / law.dk


@pytest.mark.parametrize("constants", LAWS, ids=lambda c: f"{c['law']} {c.get('alpha')}")
def test_a_bearing_never_gives_back_more_than_it_holds(constants):
    law, rng = law_of(constants), np.random.default_rng(3)
    z = 0.0
    for move in rng.standard_normal(60) * law.f0 / law.dk * 10.0 ** rng.uniform(-2, 1, 60):
        path = np.linspace(0.0, move, 400)
        force = np.array([law.hysteretic(z, d) for d in path])
        work = np.trapezoid(force, path)
        after = law.hysteretic(z, move)
        assert stored(law, after) - stored(law, z) <= work + 1e-5 * (abs(work) + stored(law, after))
        z = after


def test_the_energy_that_can_reach_the_block_never_rises_after_the_motion():
    motion = synthetic_motion()
    motion = SampledMotion(motion.dt, 0.8 * motion.samples[: round(6.0 / motion.dt)])
    scene = load_scene("caryatid-isolated").with_(block={"slenderness": 0.15}, motion=motion)
    response = simulate(scene)
    assert response.outcome == "rocks" and any(impact.time > motion.end for impact in response.impacts)
    par, history = parameters(scene), response.history
    z = history.bearing_force / par.count - par.kb * history.base_displacement
    after = history.time >= motion_end(scene)
    rows = np.column_stack([history.tilt, history.tilt_rate, history.base_displacement, history.base_velocity, z])
    energy = np.array([remaining_energy(par, row[0] != 0, *row) for row in rows[after]])
    assert len(energy) > 500 and energy[0] > 1.0
    assert (np.diff(energy) <= 1e-9 * energy[0]).all()


def test_an_undamped_base_with_energy_for_eight_overturnings_is_decided_by_its_acceleration():
    stiffness = (2 * math.pi / 4.0) ** 2 * 3000.0
    scene = Scene(
        block=BLOCK,
        base=Base(mass=1500.0),
        bearings=Bearings(law="linear", ka=stiffness),
        start=Start(base_displacement=0.45),
    )
    par = parameters(scene)
    barrier = BLOCK.mass * G * (1 - math.cos(0.12))
    assert remaining_energy(par, False, 0.0, 0.0, 0.45, 0.0, 0.0) > 2.5 * barrier
    response = simulate(scene)
    assert (response.outcome, response.decided) == ("stands", True)
    assert response.end.time < longest_duration(scene) / 5
    assert response.peak_base_displacement == pytest.approx(0.45, rel=1e-9)
    nearer = simulate(scene.with_(start={"base_displacement": 0.49}))  # 1.02 of the uplift acceleration
    assert nearer.uplifts


def test_a_free_base_is_decided_without_the_momentum_it_keeps():
    scene = Scene(block=BLOCK, base=Base(mass=1500.0), start=Start(base_velocity=2.0, tilt=0.06))
    response = simulate(scene)
    assert (response.outcome, response.decided) == ("rocks", True)
    assert response.end.time < longest_duration(scene) / 5
    assert any("slides on" in sentence.text for sentence in response.warnings)
    still = simulate(scene.with_(start={"base_velocity": 0.0}))
    assert [impact.time for impact in still.impacts[:5]] == pytest.approx(
        [impact.time for impact in response.impacts[:5]], rel=1e-9
    )


def test_free_rocking_is_decided_at_once_but_its_swings_are_shown():
    scene = Scene(block=BLOCK, start=Start(tilt=0.096))
    assert will_not_overturn(parameters(scene), True, True, 0.096, 0.0, 0.0, 0.0, 0.0)
    response = simulate(scene)
    assert response.decided and response.end.time == pytest.approx(shortest_duration(scene))
    assert len(response.impacts) > 5


def toppling():
    """A block on rigid ground under the synthetic motion cut where it is beyond its slenderness, and that time."""
    scene = load_scene("caryatid-rigid")
    whole = simulate(scene)
    assert whole.outcome == "overturns"
    history = whole.history
    beyond = np.abs(history.tilt) > 1.05 * scene.block.slenderness
    return scene, history.time[beyond], whole


def test_a_motion_that_ends_while_the_block_topples_overturns():
    scene, times, whole = toppling()
    motion = scene.motion
    for time in times[[len(times) // 2, -20, -2]]:
        count = round(time / motion.dt) + 1
        cut = scene.with_(motion=SampledMotion(motion.dt, motion.samples[:count]))
        assert simulate(cut.with_(duration=cut.motion.end + 60.0)).outcome == "overturns"
        for run in (cut, cut.with_(duration=cut.motion.end)):  # the second ends at the cut, falling
            response = simulate(run)
            assert (response.outcome, response.decided) == ("overturns", True)
            assert response.overturning_time > cut.motion.end
            assert run.duration is None or response.end.time == run.duration < response.history.time[-1] + motion.dt
        assert simulate_twin(cut, rtol=1e-8, history=False).outcome == "overturns"
        assert simulate_many([cut.with_(duration=cut.motion.end)]).overturns[0]


def test_a_duration_that_cuts_the_motion_leaves_the_outcome_undecided():
    scene, times, whole = toppling()
    for time in (0.5 * times[0], times[0]):
        response = simulate(scene.with_(duration=float(time)))
        assert not response.decided
        assert response.verdict == f"undecided ({response.outcome} so far)"
        assert response.to_json()["decided"] is False
        assert not simulate_many([scene.with_(duration=float(time))]).decided[0]
    assert simulate(scene).to_json()["decided"] is True


def test_a_duration_that_cuts_a_base_still_full_of_energy_leaves_the_outcome_undecided():
    scene = Scene(
        block=BLOCK,
        base=Base(mass=1500.0),
        bearings=Bearings(law="linear", ka=2e4),
        start=Start(base_displacement=-0.6),
        duration=0.01,
    )
    assert not simulate(scene).decided
    assert simulate(scene.with_(duration=None)).decided


def test_the_spectrum_runs_until_decided():
    motion = synthetic_motion()
    times = motion.samples[: round(6.0 / motion.dt)]  # in the strong shaking
    cut = SampledMotion(motion.dt, times)
    periods = np.linspace(1.0, 8.0, 141)
    found = rocking_spectrum(cut, periods, 0.2)
    assert found.decided.all()
    for period, overturns in zip(periods[::7], found.overturns[::7], strict=True):
        radius = 3 * G * (period / (2 * math.pi)) ** 2 / 4
        scene = Scene(block=Block(mass=1.0, radius=radius, slenderness=0.2), motion=cut, duration=cut.end + 60.0)
        assert (simulate(scene, history=False).outcome == "overturns") == overturns
    short = rocking_spectrum(cut, periods, 0.2, duration=0.9 * cut.end)
    assert not short.decided[~short.overturns].any()


def log_uniform(low, high):
    return st.floats(math.log10(low), math.log10(high)).map(lambda power: 10.0**power)


@st.composite
def scenes_without_duration(draw):
    block = Block(mass=1.0, radius=draw(log_uniform(0.1, 5)), slenderness=draw(st.floats(0.05, 0.6)))
    scene = Scene(block=block)
    threshold = G * math.tan(block.slenderness)
    motion = PulseMotion(
        draw(st.sampled_from(["one-sine", "ricker", "half-sine"])),
        threshold * draw(st.floats(0.5, 6.0)),
        scene.rocking_frequency * draw(st.floats(0.5, 6)),
    )
    base = bearings = None
    if draw(st.booleans()):
        base = Base(mass=draw(log_uniform(0.05, 20)))
        total = 1 + base.mass
        law = draw(st.sampled_from(NAMES))
        kb = total * (scene.rocking_frequency * draw(log_uniform(0.2, 5))) ** 2
        ka, f0 = kb * draw(st.floats(2, 20)), total * G * draw(log_uniform(0.01, 0.3))
        bearings = Bearings(
            **{"ka": ka, "kb": kb, "alpha": draw(st.floats(1.5, 80)), **to_law(law, ka, kb, f0)},
            damping=draw(st.sampled_from([0.0, 0.1])) * total * scene.rocking_frequency,
        )
    return Scene(block=block, base=base, bearings=bearings, motion=motion)


@settings(max_examples=120, deadline=None)
@given(scenes_without_duration())
def test_nothing_changes_after_the_end_of_a_decided_run(scene):
    response = simulate(scene, history=False)
    assert response.outcome != "failed"
    if not response.decided:
        assert response.end.time >= longest_duration(scene) * (1 - 1e-9)
        return
    # A scene whose outcome hangs on the last digits of its pulse has none to keep: its steps follow the duration, too.
    near = [
        simulate(scene.with_(motion=scene.motion.scaled(1 + part)), history=False) for part in (1e-13, 1e-12, 1e-11)
    ]
    assume(all(copy.outcome == response.outcome for copy in near))
    assume(all(copy.peak_tilt == pytest.approx(response.peak_tilt, rel=1e-3) for copy in near))
    assume(all(copy.end.time == pytest.approx(response.end.time, rel=1e-3) for copy in near))
    later = simulate(scene.with_(duration=response.end.time + 20 * shortest_duration(scene)), history=False)
    assert later.outcome == response.outcome
    if response.end.time < longest_duration(scene) * (1 - 1e-9):
        for name in ("peak_tilt", "peak_base_displacement"):
            assert getattr(later, name) <= getattr(response, name) * (1 + 1.01 * PEAK_TOLERANCE) + 1e-15, name
        # read at five points a step, and the steps differ: good to some 1e-3 only
        assert later.peak_base_acceleration <= response.peak_base_acceleration * 1.005 + 1e-15
    many = simulate_many([scene])
    assert many.decided[0] and many.overturns[0] == (response.outcome == "overturns")
    if response.outcome != "overturns" and scene.base is not None:
        assert many.peak_base_displacement[0] == pytest.approx(response.peak_base_displacement, rel=PEAK_TOLERANCE)


def test_the_second_implementation_and_the_time_stepping_run_until_decided_too():
    scene = load_scene("free-rocking-isolated").with_(duration=None)
    for response in (simulate_twin(scene, history=False), simulate_time_stepping(scene, step=1e-3)):
        assert (response.outcome, response.decided) == ("rocks", True)
        assert response.end.time == pytest.approx(shortest_duration(scene), abs=2e-3)


def test_the_model_warns_where_its_contact_would_have_to_pull_or_stick():
    scene = load_scene("caryatid-rigid")
    assert simulate(scene).warnings == ()  # the last fall itself is not warned of
    slippery = simulate(scene.with_(friction=0.2))
    assert len(slippery.warnings) == 1 and slippery.warnings[0].quantity == "friction_demand"
    assert simulate(scene.with_(friction=0.5)).warnings == ()
    omega = RockingModel.of(scene).uplift_acceleration
    flying = scene.with_(motion=PulseMotion("one-sine", 19 * omega, 4 * scene.rocking_frequency))
    response = simulate(flying)
    assert response.min_normal_ratio < 0
    assert any(warning.quantity == "min_normal_ratio" for warning in response.warnings)
    assert Response.from_json(response.to_json()).warnings == response.warnings
    assert model_warnings(scene, 0.3, 0.1) == ()


@pytest.mark.parametrize("radius", [1e-18, 1e-6, 1e6, 1e18])
@pytest.mark.parametrize("mass", [1e-20, 1e20])
def test_free_rocking_scales_with_size_to_the_ends_of_what_a_scene_may_hold(radius, mass):
    one, other = (
        simulate(Scene(block=Block(mass=m, radius=R, slenderness=0.2), start=Start(tilt=0.1)), history=False)
        for m, R in ((1.0, 1.0), (mass, radius))
    )
    assert (other.outcome, other.decided, other.impact_count) == (one.outcome, one.decided, one.impact_count)
    assert other.impacts[0].time == pytest.approx(one.impacts[0].time * math.sqrt(radius), rel=1e-9)
