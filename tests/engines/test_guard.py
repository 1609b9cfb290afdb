"""Each way an engine's process can end badly is provoked; the test module is what the process imports."""

import faulthandler
import os
import signal
import time

import pytest

from analytic import Block, Scene, SettingError, Start, simulate
from engines.guard import OUT_OF_TIME, check_time_limit, run_apart

SCENE = Scene(block=Block(mass=1000.0, radius=1.0, slenderness=0.2), start=Start(tilt=0.1), duration=1.0, name="nod")


def hang():
    time.sleep(60.0)


def kill():
    os.kill(os.getpid(), signal.SIGKILL)


def speak():
    os.write(1, b"engine: assertion failed in contact\n")
    os.abort()


def unsendable():
    return lambda: None


def interrupted():
    raise KeyboardInterrupt


def ignores_ctrl_c():
    os.kill(os.getpid(), signal.SIGINT)
    time.sleep(0.2)
    return "went on"


def err():
    raise RuntimeError("Newton did not converge at 0.25 s")


def wrong_setting():
    raise SettingError("step = 0.001: unknown")


@pytest.mark.parametrize(
    "run, arguments, limit, evidence",
    [
        (hang, (), 1.0, "in hang"),  # where it hung
        (kill, (), 30.0, "SIGKILL"),
        (speak, (), 30.0, "assertion failed in contact"),
        (unsendable, (), 30.0, "pickle"),
        (interrupted, (), 30.0, "KeyboardInterrupt"),
        (faulthandler._sigsegv, (), 30.0, "SIGSEGV"),
        (os._exit, (3,), 30.0, "exit code 3"),
        (err, (), 30.0, "RuntimeError: Newton did not converge at 0.25 s"),
    ],
)
def test_a_run_that_ends_badly_is_a_failure_with_evidence(run, arguments, limit, evidence):
    began = time.monotonic()
    value, failure = run_apart(run, *arguments, time_limit=limit)
    assert time.monotonic() - began < limit + 5
    assert value is None and evidence in failure.message
    assert (failure.reason == OUT_OF_TIME) == (run is hang)


def test_a_good_run_comes_back_as_it_is():
    here, (response, failure) = simulate(SCENE), run_apart(simulate, SCENE, time_limit=60.0)
    assert failure is None and response.impacts == here.impacts
    assert (response.history.tilt == here.history.tilt).all()


def test_ctrl_c_is_the_parents_to_handle_and_a_wrong_setting_the_callers_mistake():
    assert run_apart(ignores_ctrl_c, time_limit=60.0) == ("went on", None)
    with pytest.raises(SettingError, match="step"):
        run_apart(wrong_setting, time_limit=30.0)


@pytest.mark.parametrize("limit", [0.0, -1.0, float("nan"), 2e6])
def test_a_time_limit_that_no_timer_takes_is_refused(limit):
    with pytest.raises(ValueError, match="time_limit"):
        check_time_limit(limit)
