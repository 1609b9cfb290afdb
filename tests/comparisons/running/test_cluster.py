"""Runs on a Dask cluster: the same rows as here, one case for a crash or a hang, nothing lost with a worker."""

import contextlib
import os
import signal
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path

import psutil
import pytest

pytest.importorskip("distributed")

from analytic import SettingError
from analytic.motion import PulseMotion
from comparisons.running import cluster as module
from comparisons.running.cluster import Cluster, ClusterError
from comparisons.running.store import Store
from comparisons.running.sweep import Case, Processes, run_sweep
from engines import installed_engines

HERE = Path(__file__).parent
PROJECT = Path(__file__).parents[3]
pytestmark = pytest.mark.xdist_group("cluster")  # its two workers are started once

sys.path.insert(0, str(HERE))  # and from there to the workers
import fake_solvers  # noqa: E402
from fake_solvers import cases, scene  # noqa: E402


@pytest.fixture(scope="module")
def local():
    with Cluster("local:2", ["fake_solvers:sound"]) as executor:
        yield executor


def sweep(which, store, **options):
    return run_sweep(which, store=store, progress=False, measure=fake_solvers.tilt, **options)


def results(rows):
    return [(row.case.tag, row.values, row.failure) for row in rows]


def real_cases():
    pulse = scene(0.0).with_(motion=PulseMotion("one-sine", 6.0, 10.0), duration=3.0)
    return [
        Case(start, solver, settings={"history": False}, tag={"solver": solver})
        for solver in ("analytic", *installed_engines())
        for start in (scene(0.05), scene(0.15), pulse)
    ]


def test_rows_are_those_of_the_workers_here_bit_for_bit(tmp_path, local):
    with Processes(2) as pool:
        here = sweep([*cases(count=60), *real_cases()], tmp_path / "here.jsonl", executor=pool)
    there = sweep([*cases(count=60), *real_cases()], tmp_path / "there.jsonl", executor=local)
    assert results(there) == results(here) and not any(row.failed for row in there)
    assert all(row.reused for row in sweep(cases(count=60), tmp_path / "there.jsonl", executor=local))


def test_a_crash_and_a_hang_cost_one_row_each_with_evidence(tmp_path, local):
    rows = sweep(cases("exits", 40), tmp_path / "s.jsonl", executor=local)
    assert [row.case.tag["i"] for row in rows if row.failed] == [5]
    assert "exit code 3" in rows[5].failure["reason"] and "assertion failed in contact" in rows[5].failure["message"]
    rows = sweep(cases("hangs", 12, seconds=30.0), tmp_path / "s.jsonl", executor=local, time_limit=0.5)
    assert [row.case.tag["i"] for row in rows if row.failed] == [5]
    assert rows[5].failure["kind"] == "time limit" and "in hangs" in rows[5].failure["message"]


def workers(executor):
    """Processes of the Dask workers."""
    return [psutil.Process(pid) for pid in executor._client.run(os.getpid).values()]


def kill_again_and_again(executor, times, log):
    """Kill a worker whenever some more runs were done; what its family left alive 10 s later."""
    left, done = [], 0
    for _ in range(times):
        while log.exists() and len(log.read_text().split()) < done + 8 or not log.exists():
            time.sleep(0.02)
        done = len(log.read_text().split())
        with contextlib.suppress(psutil.Error, TimeoutError):
            victim = workers(executor)[0]
            family = victim.children(recursive=True)
            victim.kill()
            left += psutil.wait_procs(family, timeout=10)[1]
    return left


@pytest.mark.slow
def test_a_worker_killed_five_times_loses_nothing_and_leaves_nothing(tmp_path):
    log, kills = tmp_path / "log", 5
    count = 40 + 40 * kills
    with Cluster("local:2", ["fake_solvers:counted"]) as executor:
        left = []
        killer = threading.Thread(target=lambda: left.extend(kill_again_and_again(executor, kills, log)))
        killer.start()
        rows = sweep(fake_solvers.slow(log, count), tmp_path / "s.jsonl", executor=executor)
        killer.join()
    assert not left
    assert [row.values["peak"] for row in rows] == [(1e-3 * i) ** 2 for i in range(count)]
    with Store(tmp_path / "s.jsonl") as store:
        assert len(store) == count == (tmp_path / "s.jsonl").read_bytes().count(b"\n")


def test_a_worker_with_other_code_or_versions_is_one_message_before_the_first_run():
    mine = module._state(("analytic",))
    module._check_same("tcp://a:1", dict(mine), mine)
    with pytest.raises(ClusterError, match=r"worker tcp://a:1 differs: numpy 1\.0\.0 there, [\d.]+ here; install"):
        module._check_same("tcp://a:1", mine | {"numpy": "1.0.0"}, mine)
    with pytest.raises(ClusterError, match="differs: the code of analytic.newer; install"):
        module._check_same("tcp://a:1", mine | {"analytic.newer": "0"}, mine)
    with pytest.raises(ClusterError, match="differs: the code of analytic.kernel; install"):
        module._check_same("tcp://a:1", mine | {"analytic.kernel": "0"}, mine)
    with pytest.raises(ClusterError, match="cannot load this project .ModuleNotFoundError: no analytic"):
        module._check_same("tcp://a:1", ModuleNotFoundError("no analytic"), mine)


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


def test_an_address_that_is_none_is_one_message():
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        with pytest.raises(SettingError, match=r"no scheduler answers there .*; give host:port"):
            Cluster(f"127.0.0.1:{free.getsockname()[1]}")
    for address, words in (("local:many", "give local:N"), ("local:0", "give 1 to"), ("nowhere", "no scheduler")):
        with pytest.raises(SettingError, match=words):
            Cluster(address)


@contextlib.contextmanager
def scheduler(folder, workers):
    """(address, process) of a scheduler with so many workers, each a program of its own, as on a cluster."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(HERE), str(PROJECT)])}
    address, started = f"127.0.0.1:{port}", []

    def start(name, *arguments):
        started.append(
            subprocess.Popen(
                [sys.executable, "-m", f"distributed.cli.dask_{name}", *arguments, "--no-dashboard"],
                cwd=folder,
                env=environment,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
            )
        )

    start("scheduler", "--host", "127.0.0.1", "--port", str(port))
    try:
        for _ in range(workers):
            start("worker", address, "--nthreads", "1", "--death-timeout", "30")
        wait_for_workers(address, workers)
        yield address, started[0]
    finally:
        family = [child for process in started for child in _family(process)]
        for process in family:
            with contextlib.suppress(psutil.Error):
                process.kill()


def _family(process):
    with contextlib.suppress(psutil.Error):
        parent = psutil.Process(process.pid)
        return [parent, *parent.children(recursive=True)]
    return []


def wait_for_workers(address, count):
    from distributed import Client

    deadline = time.monotonic() + 60
    while time.monotonic() < deadline:
        with contextlib.suppress(OSError), Client(address, timeout=5, set_as_default=False) as client:
            client.wait_for_workers(count, timeout=60)
            return
    raise TimeoutError(f"no scheduler at {address}")


LONG_STUDY = """
import sys
from fake_solvers import slow, tilt
from comparisons.running.cluster import ClusterError
from comparisons.running.sweep import run_sweep
if __name__ == "__main__":
    address, log, store, count = sys.argv[1:]
    try:
        run_sweep(slow(log, int(count)), store=store, scheduler=address, progress=False, measure=tilt)
    except ClusterError as error:
        sys.exit(f"error: {error}")
"""


@pytest.mark.slow
def test_a_scheduler_that_dies_ends_the_sweep_with_one_message_and_the_same_command_resumes(tmp_path):
    script, log, store, count = tmp_path / "study.py", tmp_path / "log", tmp_path / "s.jsonl", 120
    script.write_text(LONG_STUDY)
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(HERE), str(PROJECT)])}

    def command(address):
        return [sys.executable, str(script), address, str(log), str(store), str(count)]

    with scheduler(tmp_path, 2) as (address, process):
        study = subprocess.Popen(command(address), env=environment, stderr=subprocess.PIPE, text=True)
        while study.poll() is None and not (store.exists() and store.read_bytes().count(b"\n") >= 10):
            time.sleep(0.02)
        process.send_signal(signal.SIGKILL)
        began = time.monotonic()
        words = study.communicate(timeout=60)[1]
        assert time.monotonic() - began < 10
    assert study.returncode == 1 and words.count("\n") == 1 and "is gone; rows done so far are kept" in words, words
    kept = store.read_bytes().count(b"\n")
    assert 10 <= kept < count
    with scheduler(tmp_path, 1) as (address, _):
        subprocess.run(command(address), env=environment, check=True, timeout=120)
    with Store(store) as opened:
        peaks = sorted(row["values"]["peak"] for row in opened.rows.values())
    assert peaks == sorted((1e-3 * i) ** 2 for i in range(count)) and store.read_bytes().count(b"\n") == count
