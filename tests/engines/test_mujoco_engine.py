"""MuJoCo: accuracy of its variants, what goes wrong surfaces, rest, repeatability; engines that are not installed."""

import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco", reason="mujoco is not installed: pip install 'rocking[mujoco]'")

import engines  # noqa: E402
from analytic import (  # noqa: E402
    Base,
    Bearings,
    Block,
    PulseMotion,
    SampledMotion,
    SceneError,
    SettingError,
    Start,
    load_scene,
)
from analytic import Scene as AnyScene  # noqa: E402
from analytic import simulate as exact  # noqa: E402
from analytic.bearing import BearingLaw  # noqa: E402
from analytic.records import read_record  # noqa: E402
from analytic.rocking import RockingModel, restitution  # noqa: E402
from engines import guard, mujoco_engine  # noqa: E402

simulate = mujoco_engine.simulate
BEARINGS = Bearings(count=4, ka=6.22e4, kb=6.22e3, alpha=44.69)
RECORD = Path(__file__).parents[3] / "shared" / "records" / "RSN1605_DUZCE_DZC270.AT2"


def scene(slenderness, base=None, duration=2.0, **parts):
    return AnyScene(block=Block(mass=3172.05, radius=1.0884, slenderness=slenderness),
                    base=Base(mass=base) if base else None, duration=duration, **parts)


def impact_errors(slenderness, base, starts=8, **settings):
    """Root mean squares of the errors of e (absolute) and of the base velocity jump (relative), 3 impacts a start."""
    errors, jumps = [], []
    for share in np.linspace(0.3, 0.8, starts):
        given = scene(slenderness, base, 2.5, start=Start(tilt=share * slenderness))
        response = simulate(given, history=False, **settings)
        assert response.outcome == "rocks", response.failure
        model = RockingModel.of(given)
        assert len(response.impacts) >= 2
        for impact in response.impacts[:3]:
            errors.append(impact.rate_after / impact.rate_before - restitution(given))
            if base:
                jumps.append(impact.base_velocity_jump / model.impact(impact.rate_before)[1] - 1)
    return np.sqrt(np.mean(np.square(errors))), np.sqrt(np.mean(np.square(jumps or [0.0])))


def swing_peaks(response, slenderness):
    tilt = response.history.tilt
    swings = np.split(np.abs(tilt), np.flatnonzero(np.diff(np.sign(tilt))) + 1)
    return [swing.max() / slenderness for swing in swings]


@pytest.mark.parametrize("base", [None, 212.0])
@pytest.mark.parametrize("slenderness", [0.1, 0.2, 0.3, 0.45])
def test_default_variant_impacts_as_momentum_asks(slenderness, base):
    e_error, jump_error = impact_errors(slenderness, base)
    assert e_error < 1e-4  # measured: at most 3.4e-5
    assert jump_error < 1e-3  # measured: at most 2.4e-4


def test_fixed_step_is_first_order():
    errors = [impact_errors(0.2, None, 4, variant="fixed-step", step=step)[0] for step in (1.6e-3, 2e-4)]
    assert 4 < errors[0] / errors[1] < 16  # 8 but for the phase of the steps


def test_accuracy_knob_means_error_of_restitution():
    errors = [impact_errors(0.45, 212.0, 4, accuracy=accuracy)[0] for accuracy in (1e-4, 5e-6)]
    assert 1e-4 < errors[0] < 1e-3 and errors[1] < 1e-4


@pytest.mark.parametrize("step", [2e-3, 5e-4])
@pytest.mark.parametrize("slenderness, base, peak", [(0.1, None, 0.544), (0.1, 212.0, 0.328)])
def test_first_script_loses_too_much_of_a_slender_block_at_every_step(slenderness, base, peak, step):
    """MuJoCo's default contact is soft: the second swing from .6 reaches .544 and .328 of gamma, not .570 and .510."""
    given = scene(slenderness, base, 1.5, start=Start(tilt=0.6 * slenderness))
    second = swing_peaks(simulate(given, variant="first-script", step=step), slenderness)[1]
    assert second == pytest.approx(peak, abs=0.005)
    assert second < swing_peaks(exact(given), slenderness)[1] - 0.02


def test_rocking_on_bearings_follows_the_exact_solution():
    given = scene(0.15, 212.0, 3.0, bearings=BEARINGS, motion=PulseMotion("one-sine", 3.0, 8.0))
    response, reference = simulate(given), exact(given)
    assert response.outcome == reference.outcome == "rocks"
    assert len(response.impacts) == len(reference.impacts) > 5
    assert response.peak_tilt == pytest.approx(reference.peak_tilt, rel=1e-3)
    error = np.interp(response.history.time, reference.history.time, reference.history.tilt) - response.history.tilt
    assert np.abs(error).max() < 0.002 * 0.15  # measured: 1.1e-4
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


@pytest.mark.parametrize("motion", ["synthetic", pytest.param("Duzce", marks=pytest.mark.skipif(
    not RECORD.exists(), reason="the Duzce record is not at hand"))])
def test_isolated_caryatid(motion):
    given = load_scene("caryatid-isolated").with_(duration=12.0)
    if motion == "Duzce":
        given = given.with_(motion=read_record(RECORD))
    response, reference = simulate(given, history=False), exact(given, history=False)
    assert response.outcome == reference.outcome == "stands"
    assert response.peak_base_displacement == pytest.approx(reference.peak_base_displacement, rel=1e-5)


@pytest.mark.parametrize("base", [None, 212.0])
def test_rest_under_shaking_below_uplift(base):
    time = 0.01 * np.arange(6001)
    level = np.sin(8 * time) + 0.5 * np.sin(26 * time)
    peak = 0.5 if base else 0.9 * 9.81 * math.tan(0.2)
    given = scene(0.2, base, 60.0, bearings=BEARINGS if base else None,
                  motion=SampledMotion(0.01, level / np.abs(level).max() * peak))
    chosen = mujoco_engine.ImpactAware()
    model, data = mujoco_engine.build(given, chosen)
    rows, ended = mujoco_engine.run(model, data, given, chosen)
    assert ended == "done"
    assert max(abs(row[2]) for row in rows) * 1.0884 < 1e-5  # measured: 1e-7
    across, up = data.qpos[-3:-1]
    assert abs(across - rows[-1][4]) < 1e-5 and abs(up) < 1e-5  # measured: 1.2e-7 and 2e-8


@pytest.mark.parametrize("mass", [0.3172, 31720.0])
@pytest.mark.parametrize("slenderness", [0.05, 0.6])
def test_extreme_masses_and_slenderness(mass, slenderness):
    given = scene(slenderness, mass, 2.0, start=Start(tilt=0.6 * slenderness))
    response, reference = simulate(given), exact(given)
    assert response.outcome == reference.outcome == "rocks"
    assert response.impacts[0].time == pytest.approx(reference.impacts[0].time, abs=5e-4)
    assert response.peak_base_displacement == pytest.approx(reference.peak_base_displacement, rel=1e-3)


@pytest.mark.parametrize("variant", ["impact-aware", "first-script"])
@pytest.mark.parametrize("law", ["algebraic", "bouc-wen"])
def test_bearing_force_is_the_law_on_the_engines_own_path(monkeypatch, variant, law):
    traces = []
    bearings = Bearings(law=law, count=4, ka=6.22e4, kb=6.22e3, alpha=44.69)
    name = "raw_trace_of" if variant == "first-script" else "trace_of"
    seen = getattr(mujoco_engine, name)
    monkeypatch.setattr(mujoco_engine, name, lambda *given: traces.append(seen(*given)) or traces[-1])
    simulate(scene(0.15, 212.0, 2.0, bearings=bearings, motion=PulseMotion("one-sine", 6.0, 4.0)), variant=variant)
    trace, rule = traces[0], BearingLaw.of(bearings)
    z, x = 0.0, 0.0
    for moved, force in zip(trace.base_displacement, trace.bearing_force, strict=True):
        z, x = rule.hysteretic(z, moved - x), moved
        assert abs(rule.force(x, z) - force) < 1e-9 * rule.f0


def test_runs_repeat_bit_for_bit_also_in_another_process():
    given = scene(0.15, 212.0, 1.0, bearings=BEARINGS, motion=PulseMotion("one-sine", 6.0, 4.0))
    first, second = simulate(given), simulate(given)
    elsewhere = guard.guarded_simulate("mujoco", given, time_limit=60.0)
    assert first.end == second.end == elsewhere.end
    assert np.array_equal(first.history.tilt, elsewhere.history.tilt)


def test_mirrored_start_gives_the_mirrored_response():
    left, right = (simulate(scene(0.3, 212.0, 1.5, start=Start(tilt=tilt))) for tilt in (0.15, -0.15))
    assert np.abs(left.history.tilt + right.history.tilt).max() < 1e-6


@pytest.mark.parametrize("variant", ["impact-aware", "fixed-step", "first-script"])
def test_state_that_is_not_finite_fails_with_mujocos_own_words(monkeypatch, tmp_path, variant):
    monkeypatch.chdir(tmp_path)
    calls = []

    class Breaking(BearingLaw):
        def hysteretic(self, z, dx):
            calls.append(dx)
            return math.nan if len(calls) > 50 else super().hysteretic(z, dx)

    monkeypatch.setattr(mujoco_engine, "BearingLaw", Breaking)
    given = scene(0.2, 212.0, bearings=BEARINGS, motion=PulseMotion("one-sine", 3.0, 4.0))
    response = simulate(given, variant=variant)
    assert response.outcome == "failed"
    assert "finite" in response.failure.reason and "unstable" in response.failure.message
    assert math.isfinite(response.failure.last_state.tilt)
    assert response.settings
    assert list(tmp_path.iterdir()) == []  # no MUJOCO_LOG.TXT
    assert mujoco.get_mju_user_warning() is None  # the handler is given back


def test_warning_alone_fails(monkeypatch):
    step = mujoco.mj_step

    def warns(model, data):
        step(model, data)
        if abs(data.time - 0.1) < 1e-3:
            mujoco.get_mju_user_warning()("Contact buffer is full")

    monkeypatch.setattr(mujoco_engine.mujoco, "mj_step", warns)
    response = simulate(scene(0.2, start=Start(tilt=0.1)))
    assert response.outcome == "failed" and "buffer is full" in response.failure.message


def test_run_that_does_not_advance_is_given_up(monkeypatch):
    monkeypatch.setattr(mujoco_engine, "MOST_ROWS", 300)
    response = simulate(scene(0.2, start=Start(tilt=0.1)))
    assert response.outcome == "failed"
    assert response.failure.reason == "too many steps"


def test_hanging_run_is_killed_and_fails():
    response = guard.guarded_simulate("mujoco", scene(0.2, None, 1e4, start=Start(tilt=0.1)), time_limit=2.5,
                                      variant="fixed-step", step=1e-6)
    assert response.outcome == "failed" and "time limit" in response.failure.message


@pytest.mark.parametrize("asked, given, words", [
    (f'mass="{3172.05!r}"', 'mass="3000.0"', "masses is .3000.0., not .3172.05."),
    ('cone="elliptic"', "", "cone is 0"),
    ('autoreset="disable"', "", "disabled parts is 0"),
    ('friction="5.0 0 0"', "", "contact: friction is"),
    ('type="hinge"', 'type="hinge" damping="1"', "dof_damping"),
    ("<option", "<optoin", "optoin"),
])
def test_what_mujoco_does_not_hold_as_asked_is_refused(monkeypatch, asked, given, words):
    class Forgetful:
        @staticmethod
        def from_xml_string(text):
            assert asked in text
            return mujoco.MjModel.from_xml_string(text.replace(asked, given))

    class Engine:
        MjModel = Forgetful

        def __getattr__(self, name):
            return getattr(mujoco, name)

    monkeypatch.setattr(mujoco_engine, "mujoco", Engine())
    response = simulate(scene(0.2, start=Start(tilt=0.1)))
    assert response.outcome == "failed"
    with pytest.raises(mujoco_engine.Mismatch, match=words):
        mujoco_engine.build(scene(0.2), mujoco_engine.ImpactAware())


def test_sliding_block_fails(monkeypatch):
    monkeypatch.setattr(mujoco_engine, "FRICTION", 0.2)
    response = simulate(scene(0.4, motion=PulseMotion("rectangular", 3.0, 2.0)))
    assert response.outcome == "failed"
    assert "slid" in response.failure.reason


def test_settings_and_scenes_that_cannot_be_run():
    with pytest.raises(SettingError, match="choose among accuracy, largest_step"):
        simulate(scene(0.2), steep=1e-3)
    with pytest.raises(SettingError, match="impact-aware, fixed-step, first-script"):
        simulate(scene(0.2), variant="best")
    with pytest.raises(SettingError, match="positive"):
        simulate(scene(0.2), variant="fixed-step", step=0.0)
    with pytest.raises(SceneError, match="restitution"):
        simulate(scene(0.2).with_(block={"restitution": 0.9}))


def test_engine_keeps_the_contract():
    engine = engines.get_engine("mujoco")
    assert "mujoco" in engines.installed_engines()
    assert engine.NAME == "mujoco" and engine.DEFAULT_VARIANT in engine.VARIANTS
    assert engine.versions()["mujoco"] == mujoco.__version__
    assert "contact solver" in engine.DECIDES


def test_all_else_works_where_mujoco_is_not_installed():
    program = """
import sys
sys.modules["mujoco"] = None  # what Python does for a package that cannot be imported
from engines import get_engine, installed_engines
from analytic.errors import EngineNotInstalled
assert "mujoco" not in installed_engines()
try:
    get_engine("mujoco")
except EngineNotInstalled as error:
    assert "rocking[mujoco]" in str(error)
else:
    raise AssertionError("mujoco was found")
from comparisons.cli import main
main(["compare", "free-rocking-isolated"])
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    assert "analytic" in done.stdout and "mujoco" not in done.stdout


def test_broken_adapter_does_not_pass_for_absent(monkeypatch):
    monkeypatch.setitem(engines.ENGINES, "broken", ("engines.no_such_adapter", "math", "cannot be installed"))
    with pytest.raises(ModuleNotFoundError, match="no_such_adapter"):
        engines.installed_engines()
