"""Runs on a Dask cluster: the same rows as here, one case for a crash or a hang, nothing lost with a worker."""

import contextlib
import os
import signal
import socket
import subprocess
import sys
import threading
import time

import pytest

pytest.importorskip("distributed")

import fake_solvers
from distributed import Client
from fake_solvers import cases, results, scene, sweep

from analytic import SettingError
from analytic.motion import PulseMotion
from comparisons.execution import cluster as module
from comparisons.execution.cases import Case
from comparisons.execution.cluster import Cluster, ClusterError

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


@pytest.mark.parametrize(
    "other, words",
    [
        ({}, None),
        ({"numpy": "1.0.0"}, r"worker a differs: numpy 1\.0\.0 there, [\d.]+ here; install"),
        ({"analytic.newer": "0"}, "differs: the code of analytic.newer; install"),
        ({"analytic.kernel.march": "0"}, "differs: the code of analytic.kernel.march; install"),
        (ModuleNotFoundError("no analytic"), "cannot load this project .ModuleNotFoundError: no analytic"),
    ],
)
def test_a_worker_with_other_code_or_versions_is_one_message_before_the_first_run(monkeypatch, other, words):
    state = other if isinstance(other, Exception) else module._state(("analytic",)) | other
    with pytest.raises(ClusterError, match=words) if words else contextlib.nullcontext():
        checked(monkeypatch, Workers({"a": state}, lost=(), gone_after=0))


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


@pytest.mark.parametrize(
    "address, words",
    [
        ("local:many", "give local:N"),
        ("local:0", "give 1 to"),
        *((address, "no scheduler answers there .*; give host:port") for address in ("nowhere", "127.0.0.1:{}")),
    ],
)
def test_an_address_that_is_none_is_one_message(address, words):
    with pytest.raises(SettingError, match=words):
        Cluster(address.format(free_port()))


@pytest.fixture
def programs(tmp_path):
    """(address, processes) of a scheduler and two workers, each a program of its own, as on a cluster."""
    address = f"127.0.0.1:{free_port()}"
    worker = ("worker", address, "--nthreads", "1", "--death-timeout", "30")
    options = dict(cwd=tmp_path, env=fake_solvers.ENVIRONMENT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    started = [
        subprocess.Popen(
            [sys.executable, "-m", f"distributed.cli.dask_{name}", *arguments, "--no-dashboard"],
            start_new_session=True,
            **options,
        )
        for name, *arguments in (("scheduler", "--host", *address.replace(":", " --port ").split()), worker, worker)
    ]
    with Client(address, timeout=60, set_as_default=False) as client:
        client.wait_for_workers(2, timeout=60)
    yield address, started
    for process in started:
        os.killpg(process.pid, signal.SIGKILL)  # its family, too


@pytest.mark.long
def test_a_dead_worker_costs_nothing_a_dead_scheduler_ends_with_one_message_and_the_same_sweep_resumes(
    tmp_path, programs, local
):
    (address, (scheduler, worker, _)), log, store = programs, tmp_path / "log", tmp_path / "s.jsonl"

    def kill():
        for process, rows in ((worker, 10), (scheduler, 40)):
            while not (store.exists() and store.read_bytes().count(b"\n") >= rows):
                time.sleep(0.02)
            process.kill()

    which, killer = fake_solvers.slow(log, 200), threading.Thread(target=kill)
    killer.start()
    with (
        pytest.raises(ClusterError, match="is gone; rows done so far are kept"),
        Cluster(address, ["fake_solvers:counted"]) as executor,
    ):
        sweep(which, store, executor)
    killer.join()
    kept = store.read_bytes().count(b"\n")
    rows = sweep(which, store, local)
    assert 40 <= kept < 200 and sum(row.reused for row in rows) == kept
    assert [row.values["peak"] for row in rows] == [(1e-3 * i) ** 2 for i in range(200)]
