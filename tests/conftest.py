"""What all tests share."""

import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import settings

from analytic.errors import EngineNotInstalled
from comparisons import cli
from engines import ENGINES

# The same scenes every time; others with HYPOTHESIS=explore, where somebody looks at a new counterexample.
settings.register_profile("same", derandomize=True)
settings.load_profile("default" if os.environ.get("HYPOTHESIS") == "explore" else "same")

PROJECT = Path(__file__).parents[1]

# What is compiled once for all workers, without and with vertical motion: the kernel, and the march of what slides.
COMPILED = """
from analytic import PulseMotion, load_scene, simulate
scene = load_scene("caryatid-rigid").with_(motion=PulseMotion("one-sine", 1.0, 60.0), duration=0.1, friction={friction})
simulate(scene)
simulate(scene.with_(motion=PulseMotion("one-sine", 1.0, 60.0, vertical=scene.motion)))
"""


def pytest_configure(config):
    """New processes that tests start find the project too, and workers the kernel, which each would compile."""
    signal.signal(signal.SIGHUP, signal.SIG_DFL)  # else ignored under nohup, and by all that tests start
    others = os.environ.get("PYTHONPATH")
    os.environ["PYTHONPATH"] = os.pathsep.join([str(PROJECT), *([others] if others else [])])
    if getattr(config.option, "numprocesses", None) and not hasattr(config, "workerinput"):
        codes = [COMPILED.format(friction=friction) for friction in (None, 0.01)]
        for compiling in [subprocess.Popen([sys.executable, "-c", code], cwd=PROJECT) for code in codes]:
            compiling.wait()


@pytest.hookimpl(tryfirst=True)  # before pytest looks at the marks
def pytest_collection_modifyitems(items):
    """What is tried on an engine beside exudyn and PyBullet, the subjects, belongs to the second command."""
    others = {name for name, engine in ENGINES.items() if not engine.subject}
    for item in items:
        if others & set(re.split(r"[\W_]+", item.nodeid.partition("[")[2])) and not item.get_closest_marker("long"):
            item.add_marker("slow")


@pytest.hookimpl(wrapper=True)
def pytest_runtest_setup(item):
    return (yield from without_engines())


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item):
    return (yield from without_engines())


def without_engines():
    """Skip, saying so, what needs an engine that is an extra, or PyBullet under a Python for which it has no wheels."""
    try:
        return (yield)
    except EngineNotInstalled as lost:
        wanted = [engine for name, engine in ENGINES.items() if f"engine {name!r} needs" in str(lost)]
        if any(not one.subject or one.name == "pybullet" and sys.version_info >= (3, 12) for one in wanted):
            pytest.skip(str(lost))
        raise


@pytest.fixture
def rocking(capfd):
    """Runs ``rocking ARGUMENTS`` in this process; returns (exit status, standard output, standard error)."""

    def call(*arguments):
        capfd.readouterr()
        with pytest.raises(SystemExit) as end:
            cli.main([str(argument) for argument in arguments])
        out, err = capfd.readouterr()
        return end.value.code or 0, out, err

    return call
