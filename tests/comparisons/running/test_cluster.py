"""Runs on a Dask cluster: the same rows as here, one case for a crash or a hang, nothing lost with a worker."""

import contextlib
import os
import signal
import socket
import subprocess
import sys
import threading
import time

import psutil
import pytest

pytest.importorskip("distributed")

import fake_solvers
from distributed import Client
from fake_solvers import cases, results, scene, sweep

from analytic import SettingError
from analytic.motion import PulseMotion
from comparisons.running import cluster as module
from comparisons.running.cases import Case
from comparisons.running.cluster import Cluster, ClusterError

pytestmark = [pytest.mark.slow, pytest.mark.xdist_group("cluster")]  # its two workers are started once


@pytest.fixture(scope="module")
def local():
    with Cluster("local:2", ["fake_solvers:sound"]) as executor:
        yield executor


def test_rows_are_those_of_the_workers_here_bit_for_bit(tmp_path, local):
    pulse = scene(0.0).with_(motion=PulseMotion("one-sine", 6.0, 10.0), duration=3.0)
    real = [
        Case(start, solver, settings={"history": False}, tag={"solver": solver})
        for solver in ("analytic", "exudyn", "pybullet")
        for start in (scene(0.05), scene(0.15), pulse)
    ]
    here = sweep([*cases(count=60), *real], tmp_path / "here.jsonl", workers=2)
    there = sweep([*cases(count=60), *real], tmp_path / "there.jsonl", executor=local)
    assert results(there) == results(here) and not any(row.failed for row in there)


def test_a_crash_and_a_hang_cost_one_row_each_with_evidence(tmp_path, local):
    rows = sweep(cases("exits", 40), tmp_path / "s.jsonl", executor=local)
    assert [row.case.tag["i"] for row in rows if row.failed] == [5]
    assert "exit code 3" in rows[5].failure["reason"] and "assertion failed in contact" in rows[5].failure["message"]
    rows = sweep(cases("hangs", 12, seconds=30.0), tmp_path / "s.jsonl", executor=local, time_limit=0.5)
    assert [row.case.tag["i"] for row in rows if row.failed] == [5]
    assert rows[5].failure["kind"] == "time limit" and "in hangs" in rows[5].failure["message"]


def kill_again_and_again(executor, times, log, left):
    """Kill a worker whenever some more runs were done; what its family left alive 10 s later goes to `left`."""
    done = 0
    for _ in range(times):
        while log.exists() and len(log.read_text().split()) < done + 8 or not log.exists():
            time.sleep(0.02)
        done = len(log.read_text().split())
        with contextlib.suppress(psutil.Error, TimeoutError):
            victim = psutil.Process(min(executor._client.run(os.getpid).values()))
            family = victim.children(recursive=True)
            victim.kill()
            left += psutil.wait_procs(family, timeout=10)[1]


@pytest.mark.long
def test_a_worker_killed_five_times_loses_nothing_and_leaves_nothing(tmp_path):
    log, kills = tmp_path / "log", 5
    count = 40 + 40 * kills
    left = []
    with Cluster("local:2", ["fake_solvers:counted"]) as executor:
        killer = threading.Thread(target=kill_again_and_again, args=(executor, kills, log, left))
        killer.start()
        rows = sweep(fake_solvers.slow(log, count), tmp_path / "s.jsonl", executor=executor)
        killer.join()
    assert not left
    assert [row.values["peak"] for row in rows] == [(1e-3 * i) ** 2 for i in range(count)]
    assert (tmp_path / "s.jsonl").read_bytes().count(b"\n") == count


def test_a_worker_with_other_code_or_versions_is_one_message_before_the_first_run():
    mine = module._state(("analytic",))
    module._check_same("tcp://a:1", dict(mine), mine)
    for other, words in (
        (mine | {"numpy": "1.0.0"}, r"worker tcp://a:1 differs: numpy 1\.0\.0 there, [\d.]+ here; install"),
        (mine | {"analytic.newer": "0"}, "differs: the code of analytic.newer; install"),
        (mine | {"analytic.kernel": "0"}, "differs: the code of analytic.kernel; install"),
        (ModuleNotFoundError("no analytic"), "cannot load this project .ModuleNotFoundError: no analytic"),
    ):
        with pytest.raises(ClusterError, match=words):
            module._check_same("tcp://a:1", other, mine)


class Workers:
    """In place of a client: workers that answer, or are lost as they are asked and gone soon after."""

    def __init__(self, answers, lost, gone_after):
        self.answers, self.lost, self.gone_after, self.asked = answers, lost, gone_after, 0

    def nthreads(self):
        return dict.fromkeys([*self.answers, *(self.lost if self.asked < self.gone_after else ())], 1)

    def run(self, function, workers, on_error):
        self.asked += 1
        return {worker: self.answers.get(worker, OSError("connection broken")) for worker in workers}


def checked(monkeypatch, workers):
    monkeypatch.setattr(module, "PATIENCE", 0.3)
    cluster = object.__new__(Cluster)
    cluster._client, cluster._solvers, cluster._address = workers, ("analytic",), "here"
    cluster._check_workers()


def test_a_worker_lost_while_versions_are_compared_is_no_mismatch_but_named(monkeypatch, capsys):
    mine = module._state(("analytic",))
    checked(monkeypatch, Workers({"a": mine}, lost=("b",), gone_after=2))
    assert "worker b was lost while versions were compared" in capsys.readouterr().err
    checked(monkeypatch, Workers({"a": mine}, lost=(), gone_after=0))
    assert not capsys.readouterr().err
    with pytest.raises(ClusterError, match="worker b differs"):  # what answers is compared all the same
        checked(monkeypatch, Workers({"a": mine, "b": mine | {"numpy": "1.0"}}, lost=("c",), gone_after=2))
    with pytest.raises(ClusterError, match="worker b does not answer"):
        checked(monkeypatch, Workers({"a": mine}, lost=("b",), gone_after=10**6))
    with pytest.raises(SettingError, match="has no workers"):
        checked(monkeypatch, Workers({}, lost=("b",), gone_after=1))


def free_port():
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return free.getsockname()[1]


def test_an_address_that_is_none_is_one_message():
    nobody = "no scheduler answers there .*; give host:port"
    cases = {
        "local:many": "give local:N",
        "local:0": "give 1 to",
        "nowhere": nobody,
        f"127.0.0.1:{free_port()}": nobody,
    }
    for address, words in cases.items():
        with pytest.raises(SettingError, match=words):
            Cluster(address)


@contextlib.contextmanager
def scheduler(folder, workers):
    """(address, process) of a scheduler with so many workers, each a program of its own, as on a cluster."""
    port = free_port()
    worker = ("worker", f"127.0.0.1:{port}", "--nthreads", "1", "--death-timeout", "30")
    options = dict(cwd=folder, env=fake_solvers.ENVIRONMENT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    started = [
        subprocess.Popen(
            [sys.executable, "-m", f"distributed.cli.dask_{name}", *arguments, "--no-dashboard"],
            start_new_session=True,
            **options,
        )
        for name, *arguments in [("scheduler", "--host", "127.0.0.1", "--port", str(port)), *[worker] * workers]
    ]
    try:
        with Client(f"127.0.0.1:{port}", timeout=60, set_as_default=False) as client:
            client.wait_for_workers(workers, timeout=60)
        yield f"127.0.0.1:{port}", started[0]
    finally:
        for process in started:
            os.killpg(process.pid, signal.SIGKILL)  # its family, too


LONG_STUDY = """
import sys
from fake_solvers import slow, sweep
from comparisons.running.cluster import Cluster, ClusterError
try:
    with Cluster(sys.argv[1], ["fake_solvers:counted"]) as executor:
        sweep(slow(sys.argv[2], 120), sys.argv[3], executor)
except ClusterError as error:
    sys.exit(f"error: {error}")
"""


@pytest.mark.long
def test_a_scheduler_that_dies_ends_the_sweep_with_one_message_and_the_same_command_resumes(tmp_path):
    log, store = tmp_path / "log", tmp_path / "s.jsonl"
    with scheduler(tmp_path, 2) as (address, process):
        command = [sys.executable, "-c", LONG_STUDY, address, log, store]
        study = subprocess.Popen(command, env=fake_solvers.ENVIRONMENT, stderr=subprocess.PIPE, text=True)
        while study.poll() is None and not (store.exists() and store.read_bytes().count(b"\n") >= 10):
            time.sleep(0.02)
        process.send_signal(signal.SIGKILL)
        began = time.monotonic()
        words = study.communicate(timeout=60)[1]
        assert time.monotonic() - began < 10
    assert study.returncode == 1 and words.count("\n") == 1 and "is gone; rows done so far are kept" in words, words
    kept = store.read_bytes().count(b"\n")
    assert 10 <= kept < 120
    with scheduler(tmp_path, 1) as (address, _), Cluster(address, ["fake_solvers:counted"]) as executor:
        rows = sweep(fake_solvers.slow(log, 120), store, executor)
    assert [row.values["peak"] for row in rows] == [(1e-3 * i) ** 2 for i in range(120)]
    assert sum(row.reused for row in rows) == kept
