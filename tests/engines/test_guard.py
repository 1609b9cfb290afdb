"""Each way an engine's process can end badly is provoked; the test module is what the process imports."""

import os
import signal
import time

import pytest

from analytic import Block, Scene, SettingError, Start, simulate
from engines import get_engine
from engines.guard import guarded, guarded_simulate

SCENE = Scene(block=Block(mass=1000.0, radius=1.0, slenderness=0.2), start=Start(tilt=0.1), duration=1.0, name="nod")
SETTINGS = {"variant": "odd", "step": 1e-3}


def hang(engine, scene, settings):
    while True:
        time.sleep(0.01)


def kill(engine, scene, settings):
    os.kill(os.getpid(), signal.SIGKILL)


def segfault(engine, scene, settings):
    import faulthandler

    faulthandler._sigsegv()


def leave(engine, scene, settings):
    os._exit(3)


def speak(engine, scene, settings):
    os.write(1, b"engine: assertion failed in contact\n")
    os.abort()


def unsendable(engine, scene, settings):
    return lambda: None


def interrupted(engine, scene, settings):
    raise KeyboardInterrupt


def ignores_ctrl_c(engine, scene, settings):
    os.kill(os.getpid(), signal.SIGINT)
    time.sleep(0.2)
    return simulate(scene)


def err(engine, scene, settings):
    raise RuntimeError("Newton did not converge at 0.25 s")


def wrong_setting(engine, scene, settings):
    raise SettingError("step = 0.001: unknown")


def work(engine, scene, settings):
    return simulate(scene)


@pytest.mark.parametrize(
    "run, limit, reason, evidence",
    [
        (hang, 4.0, "did not end in time", "time limit of 4 s"),
        (hang, 1.0, "did not end in time", "in hang"),  # where it hung
        (kill, 30.0, "process died", "SIGKILL"),
        (speak, 30.0, "process died", "assertion failed in contact"),
        (unsendable, 30.0, "raised an error", "pickle"),
        (interrupted, 30.0, "raised an error", "KeyboardInterrupt"),
        (segfault, 30.0, "process died", "SIGSEGV"),
        (leave, 30.0, "process died", "exit code 3"),
        (err, 30.0, "raised an error", "RuntimeError: Newton did not converge at 0.25 s"),
    ],
)
def test_a_run_that_ends_badly_is_a_failed_response_with_evidence(run, limit, reason, evidence):
    began = time.monotonic()
    response = guarded(run, "fake", SCENE, SETTINGS, limit)
    assert time.monotonic() - began < limit + 5
    assert response.outcome == "failed"
    assert reason in response.failure.reason
    assert evidence in response.failure.message
    assert (response.engine, response.variant, response.settings, response.scene) == ("fake", "odd", SETTINGS, "nod")
    assert response.to_json()["peak_tilt"] is None


def test_a_good_run_comes_back_as_it_is():
    response, here = guarded(work, "fake", SCENE, {}, 60.0), simulate(SCENE)
    assert response.impacts == here.impacts
    assert (response.history.tilt == here.history.tilt).all()


def test_ctrl_c_is_the_parents_to_handle():
    assert guarded(ignores_ctrl_c, "fake", SCENE, {}, 60.0).outcome == "rocks"


def test_a_wrong_setting_is_the_callers_mistake():
    with pytest.raises(SettingError, match="step"):
        guarded(wrong_setting, "fake", SCENE, SETTINGS, 30.0)


def test_an_unknown_engine_or_time_limit_is_refused_before_any_process():
    with pytest.raises(KeyError, match="unknown engine 'ode'"):
        guarded_simulate("ode", SCENE, time_limit=1.0)
    with pytest.raises(ValueError, match="time_limit = 0"):
        guarded_simulate("exudyn", SCENE, time_limit=0.0)


def test_a_real_engine_runs_guarded_as_it_does_here_and_is_killed_at_its_limit():
    pytest.importorskip("exudyn", reason="exudyn is not installed")
    exudyn = get_engine("exudyn")
    here, there = exudyn.simulate(SCENE), guarded_simulate("exudyn", SCENE, time_limit=120.0)
    assert here.impacts == there.impacts and here.end == there.end
    late = guarded_simulate("exudyn", SCENE, time_limit=0.01, stiffness=1e10)
    assert late.outcome == "failed" and "0.01 s" in late.failure.message
    assert late.versions == exudyn.versions() and late.settings == {"stiffness": 1e10}
