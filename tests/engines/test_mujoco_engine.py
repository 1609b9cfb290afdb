"""MuJoCo, beside what every engine must fulfil: accuracy of its variants, what goes wrong surfaces, long rest."""

import math

import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco", reason="mujoco is not installed: pip install 'rocking[mujoco]'")

from analytic import (  # noqa: E402
    Base,
    Bearings,
    Block,
    PulseMotion,
    SampledMotion,
    Start,
)
from analytic import Scene as AnyScene  # noqa: E402
from analytic import simulate as exact  # noqa: E402
from analytic.bearing import BearingLaw  # noqa: E402
from analytic.rocking import RockingModel, restitution  # noqa: E402
from engines import mujoco_engine  # noqa: E402

simulate = mujoco_engine.simulate
BEARINGS = Bearings(count=4, ka=6.22e4, kb=6.22e3, alpha=44.69)


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


def test_mujocos_contact_solver_is_named():
    assert "contact solver" in mujoco_engine.DECIDES
