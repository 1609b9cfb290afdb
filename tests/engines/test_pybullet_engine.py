"""PyBullet: accuracy of its variants, what goes wrong surfaces, rest, repeatability."""

import math
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("pybullet", reason="pybullet is not installed (its wheels end at CPython 3.11)")

from analytic import Base, Bearings, Block, PulseMotion, SampledMotion, SceneError, SettingError, Start  # noqa: E402
from analytic import Scene as AnyScene  # noqa: E402
from analytic import simulate as exact  # noqa: E402
from analytic.bearing import BearingLaw  # noqa: E402
from analytic.records import read_record  # noqa: E402
from analytic.rocking import RockingModel, restitution  # noqa: E402
from engines import (  # noqa: E402
    get_engine,
    guard,
    pybullet_check,
    pybullet_engine,
    pybullet_scene,
    pybullet_stepping,
)
from engines.ground_velocity import ground_velocity  # noqa: E402

simulate = pybullet_engine.simulate
BEARINGS = Bearings(count=4, ka=6.22e4, kb=6.22e3, alpha=44.69)
RECORD = Path(__file__).parents[3] / "shared" / "records" / "RSN1605_DUZCE_DZC270.AT2"


def scene(slenderness, base=None, duration=2.0, **parts):
    return AnyScene(block=Block(mass=3172.05, radius=1.0884, slenderness=slenderness),
                    base=Base(mass=base) if base else None, duration=duration, **parts)


def impact_errors(slenderness, base, **settings):
    """Errors of e (absolute) and of the base velocity jump (relative): 8 starts, 3 impacts each."""
    errors, jumps, cpu, simulated = [], [], 0.0, 0.0
    for share in np.linspace(0.3, 0.8, 8):
        given = scene(slenderness, base, 3.0, start=Start(tilt=share * slenderness))
        response = simulate(given, history=False, **settings)
        assert response.outcome == "rocks", response.failure
        model = RockingModel.of(given)
        assert len(response.impacts) >= 2
        for impact in response.impacts[:3]:
            errors.append(impact.rate_after / impact.rate_before - restitution(given))
            if base:
                jumps.append(impact.base_velocity_jump / model.impact(impact.rate_before)[1] - 1)
        cpu, simulated = cpu + response.cpu_seconds, simulated + given.duration
    return np.sqrt(np.mean(np.square(errors))), np.sqrt(np.mean(np.square(jumps or [0.0]))), cpu / simulated


@pytest.mark.parametrize("base", [None, 212.0])
@pytest.mark.parametrize("slenderness", [0.1, 0.2, 0.3, 0.45])
def test_default_variant_impacts_as_momentum_asks(slenderness, base):
    e_error, jump_error, _ = impact_errors(slenderness, base)
    assert e_error < 1e-4  # measured: 1.3e-5 to 2.2e-5
    assert jump_error < 1e-3  # measured: at most 4.3e-4


def test_default_is_ten_times_cheaper_than_fixed_step_at_no_larger_error():
    e_aware, _, cpu_aware = impact_errors(0.2, 212.0)
    given = scene(0.2, 212.0, 0.6, start=Start(tilt=0.06))
    fixed = simulate(given, variant="fixed-step", step=2e-5, history=False)
    e_fixed = abs(fixed.impacts[0].rate_after / fixed.impacts[0].rate_before - restitution(given))
    assert e_fixed > e_aware  # even this step leaves more
    assert fixed.cpu_seconds / 0.6 > 10 * cpu_aware


def test_fixed_step_is_first_order():
    errors = [impact_errors(0.45, None, variant="fixed-step", step=step)[0] for step in (1.6e-3, 4e-4)]
    assert 2.5 < errors[0] / errors[1] < 6.5  # 4 but for the phase of the steps


@pytest.mark.parametrize("accuracy, error", [(4e-5, 2e-4), (1e-5, 5e-5), (2.5e-6, 1.25e-5)])
def test_accuracy_knob_means_error_of_restitution(accuracy, error):
    assert impact_errors(0.3, None, accuracy=accuracy)[0] < error


@pytest.mark.parametrize("step", [1 / 240, 1 / 1000, 1 / 4000])
def test_first_script_is_wrong_at_every_step(step):
    """Default damping takes energy in flight: swing energies give e near .928, not .9408, and do not converge."""
    start = 0.12
    response = simulate(scene(0.2, None, 2.5, start=Start(tilt=start)), variant="first-script", step=step)
    tilt = response.history.tilt
    swings = np.split(np.abs(tilt), np.flatnonzero(np.diff(np.sign(tilt))) + 1)
    energy = [math.cos(0.2 - swing.max()) - math.cos(0.2) for swing in swings[:3]]
    e = (energy[2] / energy[0]) ** 0.25  # over two impacts
    assert e == pytest.approx(0.928, abs=0.009)
    assert abs(e - restitution(scene(0.2))) > 0.005


def test_rocking_on_bearings_follows_the_exact_solution():
    given = scene(0.15, 212.0, 3.0, bearings=BEARINGS, motion=PulseMotion("one-sine", 3.0, 8.0))
    response, reference = simulate(given), exact(given)
    assert response.outcome == reference.outcome == "rocks"
    assert len(response.impacts) == len(reference.impacts) > 5
    assert response.peak_tilt == pytest.approx(reference.peak_tilt, rel=1e-3)
    error = np.interp(response.history.time, reference.history.time, reference.history.tilt) - response.history.tilt
    assert np.abs(error).max() < 0.002 * 0.15  # measured: 6e-4
    assert response.uplifts[0] == pytest.approx(reference.uplifts[0], abs=1e-5)


def test_overturning_under_a_pulse_stops_cleanly():
    given = scene(0.2, motion=PulseMotion("one-sine", 3.8 * 9.81 * 0.2, 5.2), duration=5.0)
    response, reference = simulate(given), exact(given)
    assert response.outcome == reference.outcome == "overturns"
    assert response.overturning_time == pytest.approx(reference.overturning_time, abs=2e-3)


@pytest.mark.parametrize("law", ["algebraic", "linear", "bouc-wen"])
@pytest.mark.parametrize("damping", [0.0, 500.0])
def test_isolated_block_moves_as_the_exact_solution(law, damping):
    bearings = Bearings(law=law, count=4, ka=6.22e4, kb=6.22e3, alpha=44.69, damping=damping)
    given = scene(0.5, 212.0, 4.0, bearings=bearings, motion=PulseMotion("one-sine", 2.0, 5.0),
                  start=Start(base_displacement=0.02, base_velocity=-0.1))
    response, reference = simulate(given), exact(given)
    assert response.outcome == reference.outcome == "stands"
    assert response.peak_base_displacement == pytest.approx(reference.peak_base_displacement, rel=1e-4)


@pytest.mark.skipif(not RECORD.exists(), reason="the Duzce record is not at hand")
def test_isolated_caryatid_under_the_duzce_record():
    given = scene(0.28, 212.0, 10.0, bearings=BEARINGS, motion=read_record(RECORD))
    response, reference = simulate(given, history=False), exact(given, history=False)
    assert response.outcome == "stands"
    assert response.peak_base_displacement == pytest.approx(reference.peak_base_displacement, rel=1e-4)
    assert response.peak_base_displacement == pytest.approx(0.212, abs=5e-4)


@pytest.mark.parametrize("base", [None, 212.0])
def test_rest_under_shaking_below_uplift(base):
    time = 0.01 * np.arange(601)
    level = np.sin(8 * time) + 0.5 * np.sin(26 * time)
    peak = 0.5 if base else 0.9 * 9.81 * math.tan(0.2)
    given = scene(0.2, base, 6.0, bearings=BEARINGS if base else None,
                  motion=SampledMotion(0.01, level / np.abs(level).max() * peak))
    response = simulate(given, history=False)
    assert response.outcome == "stands", response.failure
    assert response.peak_tilt * 1.0884 < 1e-5


@pytest.mark.parametrize("mass", [0.3172, 31720.0])
@pytest.mark.parametrize("slenderness", [0.05, 0.6])
def test_extreme_masses_and_slenderness(mass, slenderness):
    given = scene(slenderness, mass, 2.0, start=Start(tilt=0.6 * slenderness))
    response, reference = simulate(given), exact(given)
    assert response.outcome == reference.outcome == "rocks"
    assert response.impacts[0].time == pytest.approx(reference.impacts[0].time, abs=5e-4)
    assert response.peak_base_displacement == pytest.approx(reference.peak_base_displacement, rel=1e-3)


@pytest.mark.parametrize("law", ["algebraic", "bouc-wen"])
def test_bearing_force_is_the_law_on_the_engines_own_path(monkeypatch, law):
    traces = []
    bearings = Bearings(law=law, count=4, ka=6.22e4, kb=6.22e3, alpha=44.69)
    seen = pybullet_engine.trace_of
    monkeypatch.setattr(pybullet_engine, "trace_of", lambda *given: traces.append(seen(*given)) or traces[-1])
    simulate(scene(0.15, 212.0, 2.0, bearings=bearings, motion=PulseMotion("one-sine", 6.0, 4.0)))
    trace, rule = traces[0], BearingLaw.of(bearings)
    z, x = 0.0, 0.0
    for moved, force in zip(trace.base_displacement, trace.bearing_force, strict=True):
        z, x = rule.hysteretic(z, moved - x), moved
        assert abs(rule.force(x, z) - force) < 1e-9 * rule.f0


@pytest.mark.parametrize("shape", ["one-sine", "one-cosine", "half-sine", "rectangular", "ricker"])
def test_ground_velocity_is_the_integral_of_the_acceleration(shape):
    motion = PulseMotion(shape, 2.0, 5.0, start=0.3)
    velocity = ground_velocity(motion)
    time = np.linspace(motion.start, motion.end, 200_001)
    level = motion.acceleration(0.5 * (time[1:] + time[:-1]))
    assert velocity(motion.end + 1.0) == pytest.approx(np.sum(level) * (time[1] - time[0]), abs=1e-8)
    middle = len(time) // 3
    assert velocity(time[middle]) == pytest.approx(np.sum(level[:middle]) * (time[1] - time[0]), abs=1e-8)


def test_runs_repeat_bit_for_bit_also_in_another_process():
    given = scene(0.15, 212.0, 1.0, bearings=BEARINGS, motion=PulseMotion("one-sine", 6.0, 4.0))
    first, second = simulate(given), simulate(given)
    elsewhere = guard.guarded_simulate("pybullet", given, time_limit=60.0)
    assert first.end == second.end == elsewhere.end
    assert np.array_equal(first.history.tilt, elsewhere.history.tilt)


def test_mirrored_start_gives_the_mirrored_response():
    left, right = (simulate(scene(0.3, 212.0, 1.5, start=Start(tilt=tilt))) for tilt in (0.15, -0.15))
    assert np.abs(left.history.tilt + right.history.tilt).max() < 1e-6


def test_state_that_is_not_finite_fails(monkeypatch):
    calls = []

    def breaks(z, *rest):
        calls.append(z)
        return math.nan if len(calls) > 50 else z

    monkeypatch.setattr(pybullet_stepping, "hysteretic_force", breaks)
    response = simulate(scene(0.2, 212.0, bearings=BEARINGS, motion=PulseMotion("one-sine", 3.0, 4.0)))
    assert response.outcome == "failed"
    assert "finite" in response.failure.reason
    assert math.isfinite(response.failure.last_state.tilt)
    assert response.settings["accuracy"] == 1e-5


def test_run_that_does_not_advance_is_given_up(monkeypatch):
    monkeypatch.setattr(pybullet_engine, "ROWS_PER_STEP", 0)
    monkeypatch.setattr(pybullet_engine, "MOST_ROWS", 300)
    response = simulate(scene(0.2, start=Start(tilt=0.1)))
    assert response.outcome == "failed"
    assert response.failure.reason == "too many steps"


def test_hanging_run_is_killed_and_fails():
    response = guard.guarded_simulate("pybullet", scene(0.2, None, 1e4, start=Start(tilt=0.1)), time_limit=5.0,
                                      variant="fixed-step", step=1e-6)
    assert response.outcome == "failed"


def test_mass_that_bullet_does_not_take_is_refused(monkeypatch):
    change = pybullet_scene.pybullet.changeDynamics

    def forgets(body, link, **values):
        values.pop("mass", None)
        values.pop("localInertiaDiagonal", None)
        change(body, link, **values)

    monkeypatch.setattr(pybullet_scene.pybullet, "changeDynamics", forgets)
    response = simulate(scene(0.2, start=Start(tilt=0.1)))
    assert response.outcome == "failed"
    assert "block: inertia is" in response.failure.message


def test_joint_motor_or_friction_left_as_it_is_is_refused(monkeypatch):
    change = pybullet_scene.pybullet.changeDynamics
    monkeypatch.setattr(pybullet_scene.pybullet, "changeDynamics",
                        lambda body, link, **values: change(body, -1, **values))  # trap: the link is missed
    response = simulate(scene(0.2, 212.0, start=Start(tilt=0.1)))
    assert response.outcome == "failed"
    assert "friction" in response.failure.message


def test_sliding_block_fails(monkeypatch):
    monkeypatch.setattr(pybullet_scene, "FRICTION", 0.2)
    response = simulate(scene(0.4, motion=PulseMotion("rectangular", 3.0, 2.0)))
    assert response.outcome == "failed"
    assert "slid" in response.failure.reason


def test_place_of_a_sunk_block_fails():
    given = scene(0.2)
    assert pybullet_check.check_place(given, 0.0, 0.0, 0.0, 0.0) is None
    assert "sank" in pybullet_check.check_place(given, 0.0, -0.01, 0.0, 0.0).reason


def test_settings_and_scenes_that_cannot_be_run():
    with pytest.raises(SettingError, match="choose among accuracy, largest_step"):
        simulate(scene(0.2), steep=1e-3)
    with pytest.raises(SettingError, match="impact-aware, fixed-step, first-script"):
        simulate(scene(0.2), variant="best")
    with pytest.raises(SettingError, match="positive"):
        simulate(scene(0.2), variant="fixed-step", step=0.0)
    with pytest.raises(SceneError, match="restitution"):
        simulate(scene(0.2).with_(block={"restitution": 0.9}))


def test_clients_are_closed(monkeypatch):
    open_clients = []
    connect, disconnect = pybullet_engine.pybullet.connect, pybullet_engine.pybullet.disconnect
    monkeypatch.setattr(pybullet_engine.pybullet, "connect",
                        lambda mode: open_clients.append(connect(mode)) or open_clients[-1])
    monkeypatch.setattr(pybullet_engine.pybullet, "disconnect",
                        lambda client: open_clients.remove(client) or disconnect(client))
    monkeypatch.setattr(pybullet_scene, "FRICTION", math.nan)
    assert simulate(scene(0.2)).outcome == "failed"
    assert open_clients == []


def test_engine_is_found_by_name():
    engine = get_engine("pybullet")
    assert engine.DEFAULT_VARIANT in engine.VARIANTS
    assert engine.versions()["pybullet"].startswith("3.")
    assert "contact solver" in engine.DECIDES
