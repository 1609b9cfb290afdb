"""Ctrl-C, signals and time limits: a long run ends at once, leaves no process and no half result."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time

import psutil
import pytest

from comparisons.cli.interrupts import stoppable
from comparisons.report.study import UNFINISHED
from comparisons.running import study
from comparisons.running.provenance import RESULTS
from engines.guard import run_apart

ENDLESS = """
[block]
mass = 3172.05
radius = 1.0884
slenderness = 0.28
[base]
mass = 212.0
[bearings]
law = "linear"
count = 4
ka = 2e4
[start]
base_displacement = 0.2
[run]
duration = 1e7
"""


STANDS = """
[block]
mass = 3172.05
radius = 1.0884
slenderness = 0.28
[motion]
pulse = "one-sine"
amplitude = 1.0
frequency = 1.0
"""


def endless(folder):
    """A scene that takes minutes: on bearings without loss the block lifts again and again."""
    path = folder / "scene.toml"
    path.write_text(ENDLESS)
    return path


def started(*arguments, **how):
    pipes = {"text": True, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    return subprocess.Popen([sys.executable, *map(str, arguments)], start_new_session=True, **pipes, **how)


@pytest.mark.slow
def test_the_time_limit_costs_the_run_alone(rocking, tmp_path):
    scene = endless(tmp_path)
    status, out, err = rocking("run", scene, "--time-limit", "1", "--json", "-")
    assert status == 1 and json.loads(out)["failure"]["reason"] == "the run did not end in time"
    assert "killed after the time limit of 1 s; --time-limit allows more" in err and err.count("\n") == 1


def hears(process, number=signal.SIGINT):
    """Seconds until a process that was told to stop has ended, and those it had started that live on."""
    family = psutil.Process(process.pid).children(recursive=True)
    os.killpg(process.pid, number)  # as a terminal does: to all of them
    began = time.monotonic()
    process.wait(60)
    return time.monotonic() - began, psutil.wait_procs(family, timeout=5)[1]


@pytest.mark.parametrize(
    "command", [pytest.param("run", marks=pytest.mark.slow), pytest.param("compare", marks=pytest.mark.long)]
)
def test_ctrl_c_in_the_kernel(tmp_path, command):
    scene = endless(tmp_path)
    process = started("-m", "comparisons", command, scene, "--json", tmp_path / "r.json")
    deadline = time.monotonic() + 100
    while not psutil.Process(process.pid).children() and time.monotonic() < deadline:
        time.sleep(0.05)
    time.sleep(1.0)
    seconds, alive = hears(process)
    out, err = process.communicate()
    assert (process.returncode, out, err) == (130, "", "Interrupted.\n")
    assert seconds < 3 and not alive  # 0.2 s where the machine has nothing else to do
    assert [path.name for path in tmp_path.iterdir()] == ["scene.toml"]


KERNEL_HERE = """
import sys
from comparisons import cli
from analytic import Block, Scene, Start, simulate
from comparisons.running.files import TemporaryFolder
import comparisons.commands.engines as stand_in
def command():
    folder = TemporaryFolder("sweep-")
    print("begins", flush=True)
    simulate(Scene(block=Block(mass=3172.05, radius=1.0884, slenderness=0.28), base={"mass": 212.0},
                   bearings={"law": "linear", "count": 4, "ka": 2e4}, start=Start(base_displacement=0.2), duration=1e7))
stand_in.command = command
cli.main(["engines"])
"""


@pytest.mark.parametrize(
    "number, status, words",
    [
        pytest.param(signal.SIGINT, 130, "Interrupted.\n", marks=pytest.mark.long),
        pytest.param(signal.SIGTERM, 143, "Ended by SIGTERM.\n", marks=pytest.mark.slow),
        pytest.param(signal.SIGHUP, 129, "Ended by SIGHUP.\n", marks=pytest.mark.long),
    ],
)
def test_signals_while_this_process_itself_is_in_the_kernel(tmp_path, number, status, words):
    process = started("-c", KERNEL_HERE, env={**os.environ, "TMPDIR": str(tmp_path)})
    assert process.stdout.readline() == "begins\n"
    time.sleep(5.0)
    assert process.poll() is None and list(tmp_path.iterdir())
    seconds, _ = hears(process, number)
    assert seconds < 3 and (process.returncode, process.stderr.read()) == (status, words)
    assert not list(tmp_path.iterdir())  # no temporary folder is left


def test_a_hangup_that_is_ignored_as_by_nohup_stays_so():
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with stoppable():
            os.kill(os.getpid(), signal.SIGHUP)
            kept, failure = run_apart(signal.getsignal, signal.SIGHUP, time_limit=30.0)
        assert (kept, failure) == (signal.SIG_IGN, None)
    finally:
        signal.signal(signal.SIGHUP, before)


def broken_off(store, *arguments):
    """Errors of a command that was told to stop as soon as a run is in its store, and how many runs are there then."""
    process, deadline = started("-m", "comparisons", *arguments), time.monotonic() + 120
    while time.monotonic() < deadline and not (store.exists() and store.read_bytes()):
        time.sleep(0.02)
    seconds, alive = hears(process)
    assert process.returncode == 130 and seconds < 3 and not alive
    assert store.read_bytes().endswith(b"\n") and "Interrupt" not in store.read_text()
    return process.stderr.read(), store.read_bytes().count(b"\n")


def kept(store, count):
    runs = f"{count} run{'s are' if count > 1 else ' is'} kept in {store}"
    return f"Interrupted. {runs}; the same command goes on from there.\n"


@pytest.mark.slow
def test_an_interrupted_study_says_what_is_kept(tmp_path):
    store = tmp_path / "runs.jsonl"
    err, count = broken_off(store, "study", "restitution", "--quick", "--output", tmp_path)
    assert "Traceback" not in err and err.endswith(kept(store, count))


@pytest.mark.long
def test_an_interrupted_report_says_what_is_kept_and_goes_on_from_there(tmp_path):
    shutil.copytree(RESULTS / "sensitivity", tmp_path / "studies" / "sensitivity")
    store, one = tmp_path / "page" / UNFINISHED / "runs.jsonl", ("--engine", "exudyn")
    (tmp_path / "stands.toml").write_text(STANDS)  # no run but those of the scene itself
    words = ("report", tmp_path / "stands.toml", *one, "--output", tmp_path / "page", "--studies", tmp_path / "studies")
    err, count = broken_off(store, *words)
    assert err.endswith(kept(store, count))
    again = started("-m", "comparisons", *words)
    _, err = again.communicate()
    assert again.returncode == 0 and f" {count} found in {UNFINISHED}/runs.jsonl" in err
    assert not store.exists()  # now there is nothing to go on from, and nothing of it would be said


def test_nothing_is_said_of_runs_that_are_gone_or_not_yet_there(tmp_path, monkeypatch):
    store = tmp_path / "runs.jsonl"
    monkeypatch.setattr(study, "_stored", store)
    said = []
    for text in ("", "{", "{}\n{", "{}\n{}\n"):  # a line that is not whole is no run
        store.write_text(text)
        said.append(study.kept())
    store.unlink()
    said.append(study.kept())
    assert said == ["", "", *(kept(store, count).removeprefix("Interrupted. ").rstrip() for count in (1, 2)), ""]
