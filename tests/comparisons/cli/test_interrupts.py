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
from forks import fork

from analytic import load_scene, simulate
from comparisons.cli import stoppable
from comparisons.execution import runner
from comparisons.execution.results import RESULTS
from comparisons.execution.writing import TemporaryFolder
from comparisons.report.runs import UNFINISHED
from engines.guard import run_apart

# On bearings without loss the block lifts again and again: minutes.
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


@pytest.fixture
def endless(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(ENDLESS)
    return path


@pytest.mark.slow
def test_the_time_limit_costs_the_run_alone(rocking, endless):
    status, out, err = rocking("run", endless, "--time-limit", "1", "--json", "-")
    assert status == 1 and json.loads(out)["failure"]["reason"] == "the run did not end in time"
    assert "killed after the time limit of 1 s; --time-limit allows more" in err and err.count("\n") == 1


@pytest.mark.parametrize(
    "number, status, words",
    [
        (signal.SIGINT, 130, b"Interrupted.\n"),
        (signal.SIGTERM, 143, b"Ended by SIGTERM.\n"),
        (signal.SIGHUP, 129, b"Ended by SIGHUP.\n"),
    ],
)
def test_signals_while_this_process_itself_is_in_the_kernel(tmp_path, monkeypatch, endless, number, status, words):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    simulate(load_scene("caryatid-isolated"))  # compiled
    reads, tells = os.pipe()
    child = fork()
    if child == 0:
        os.dup2(tells, 2)
        with stoppable():
            folder = TemporaryFolder("sweep-")
            os.write(2, b"+")
            simulate(load_scene(endless).with_(name=folder.name))
        os._exit(0)
    os.close(tells)
    assert os.read(reads, 1) == b"+" and len([*tmp_path.iterdir()]) == 2
    time.sleep(0.3)
    os.kill(child, number)
    began = time.monotonic()
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == status
    assert time.monotonic() - began < 3 and os.read(reads, 1000) == words
    assert [*tmp_path.iterdir()] == [endless]  # no temporary folder is left


def test_a_hangup_that_is_ignored_as_by_nohup_stays_so():
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with stoppable():
            os.kill(os.getpid(), signal.SIGHUP)
            kept, failure = run_apart(signal.getsignal, signal.SIGHUP, time_limit=30.0)
        assert (kept, failure) == (signal.SIG_IGN, None)
    finally:
        signal.signal(signal.SIGHUP, before)


def broken_off(begun, *arguments):
    """Errors of a command that hears Ctrl-C, as from a terminal, when it has begun: begun(its process)."""
    command, pipe = [sys.executable, "-m", "comparisons", *map(str, arguments)], subprocess.PIPE
    process = subprocess.Popen(command, start_new_session=True, text=True, stdout=pipe, stderr=pipe)
    deadline = time.monotonic() + 120
    while time.monotonic() < deadline and not begun(psutil.Process(process.pid)):
        time.sleep(0.02)
    family = psutil.Process(process.pid).children(recursive=True)
    os.killpg(process.pid, signal.SIGINT)
    began = time.monotonic()
    out, err = process.communicate(timeout=60)
    assert (process.returncode, out) == (130, "") and time.monotonic() - began < 3 and "Traceback" not in err
    assert not psutil.wait_procs(family, timeout=5)[1]  # none lives on
    return err


def kept(store, count):
    runs = f"{count} run{'s are' if count > 1 else ' is'} kept in {store}"
    return f"Interrupted. {runs}; the same command goes on from there.\n"


@pytest.mark.slow
def test_an_interrupted_run_leaves_nothing(endless):
    assert broken_off(psutil.Process.children, "run", endless, "--json", endless.parent / "r.json") == "Interrupted.\n"
    assert [*endless.parent.iterdir()] == [endless]


@pytest.mark.parametrize(
    "command, place",
    [
        pytest.param("study restitution --quick", "", marks=pytest.mark.slow),
        pytest.param("report free-rocking-rigid --engine exudyn --studies studies", UNFINISHED, marks=pytest.mark.long),
    ],
)
def test_an_interrupted_study_or_report_says_what_is_kept_and_goes_on_from_there(
    rocking, tmp_path, monkeypatch, command, place
):
    monkeypatch.chdir(tmp_path)
    shutil.copytree(RESULTS / "sensitivity", tmp_path / "studies" / "sensitivity")
    words, store = (*command.split(), "--output", tmp_path / "page"), tmp_path / "page" / place / "runs.jsonl"
    err = broken_off(lambda _: store.exists() and store.read_bytes(), *words)
    text = store.read_bytes()
    count = text.count(b"\n")
    assert err.endswith(kept(store, count)) and text.endswith(b"\n") and b"Interrupt" not in text
    if place:
        status, _, err = rocking(*words)
        assert status == 0 and f" {count} found in {place}/runs.jsonl" in err
        assert not store.exists()  # now there is nothing to go on from, and nothing of it would be said


def test_nothing_is_said_of_runs_that_are_gone_or_not_yet_there(tmp_path, monkeypatch):
    store, messages = tmp_path / "runs.jsonl", []
    monkeypatch.setattr(runner, "_stored", store)
    for text in ("", "{", "{}\n{", "{}\n{}\n"):  # a line that is not whole is no run
        store.write_text(text)
        messages.append(runner.kept())
    assert messages == ["", "", *(kept(store, count).removeprefix("Interrupted. ").rstrip() for count in (1, 2))]
    store.unlink()
    assert runner.kept() == ""
