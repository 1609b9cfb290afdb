"""The sweep layer: resumable after kill -9, proof against crashes and hangs, independent of order and workers."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import fake_solvers
import psutil
import pytest
from answered import Here
from fake_solvers import cases, results, scene, sweep

from analytic import EngineNotInstalled
from comparisons.execution import cases as run_cases
from comparisons.execution.cases import Case
from comparisons.execution.sweep import Processes, Store

OURS = (str(Path(__file__).parents[2]), f"{Path.home()}/", sys.prefix)  # folders that no stored failure names


def test_one_and_two_workers_and_this_process_agree_in_any_order(tmp_path):
    # Of the analytic model, too: compiling takes longer than this limit; compile_kernels has left a cache.
    which = [*cases(count=60), *(Case(scene(0.05 * i), settings={"history": False}) for i in range(1, 6))]
    here = sweep(which, tmp_path / "0.jsonl", executor=Here())
    once = sweep(which, tmp_path / "1.jsonl", workers=1, time_limit=20.0)
    two = sweep(which[::-1], tmp_path / "2.jsonl", workers=2, time_limit=20.0)
    assert results(once) == results(two)[::-1] == results(here) and not any(row.failed for row in here)
    assert [row.values for row in here[:60]] == [
        {"outcome": "stands", "peak": round(0.01 * i, 6) ** 2} for i in range(60)
    ]
    assert all(row.cost["cpu_seconds"] > 0 and "cpu_seconds" not in row.values for row in here)


def test_rows_are_reused_and_equal_cases_run_once(tmp_path):
    log, store = tmp_path / "log", tmp_path / "s.jsonl"
    which = cases("counted", 5, log=str(log))
    first = sweep(which + which, store)
    again = sweep(which[::-1], store)
    assert len(log.read_text().split()) == 5
    assert results(first[:5]) == results(first[5:]) == results(again)[::-1]
    assert all(row.reused for row in again) and not any(row.reused for row in first)


def test_a_key_follows_scene_solver_variant_settings_tag_and_measure():
    base = {"scene": scene(0.1), "solver": "fake_solvers:sound", "settings": {"work": 1}}
    changes = ({"scene": scene(0.2)}, {"solver": "fake_solvers:raises"}, {"variant": "fast"}, {"settings": {}})
    keys = [Case(**base | change).key(fake_solvers.tilt) for change in ({}, *changes, {"tag": {"i": 1}})]
    assert len({*keys, Case(**base).key(fake_solvers.broken)}) == 7
    assert Case(**base | {"scene": scene(0.1)}).key(fake_solvers.tilt) == keys[0]


def test_a_key_follows_versions_and_source_code(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(tmp_path))
    file = tmp_path / "changing_solver.py"

    def key(text):
        file.write_text(text)
        os.utime(file, ns=(time.time_ns(), time.time_ns()))
        run_cases.fingerprint.cache_clear()
        return Case(scene(0.1), "changing_solver:simulate").key(fake_solvers.tilt)

    first = key("def simulate(scene):\n    return 1\n")
    assert key('"""Better words."""\ndef simulate(scene):\n    return 1  # one\n') == first
    assert key("def simulate(scene):\n    return 2\n") != first
    assert key("def simulate(scene):\n    return 1\n") == first
    monkeypatch.setattr(run_cases, "version_of", lambda package: "0.0")
    assert key("def simulate(scene):\n    return 1\n") != first


@pytest.mark.parametrize(
    "solver, settings, kind, reason, message, again",
    [
        ("exits", {}, "crash", "exit code 3", "engine: assertion failed in contact", False),
        ("segfaults", {}, "crash", "SIGSEGV", "in segfaults", False),
        ("hangs", {"seconds": 2.0}, "time limit", "0.5 s", "in hangs", False),
        *(
            ("killed", {"number": int(number)}, "crash", number.name, "", True)
            for number in (signal.SIGKILL, signal.SIGHUP)
        ),
    ],
)
def test_what_ends_a_worker_costs_one_row_with_evidence(tmp_path, solver, settings, kind, reason, message, again):
    which, store = cases(solver, 12, **settings), tmp_path / "s.jsonl"
    limit = 0.5 if solver == "hangs" else 60.0
    rows = sweep(which, store, time_limit=limit)
    assert [row.case.tag["i"] for row in rows if row.failed] == [5] and rows[5].values == {"outcome": "failed"}
    failure = rows[5].failure
    assert failure["kind"] == kind and reason in failure["reason"] and message in failure["message"]
    assert not any(folder in json.dumps(failure) for folder in OURS)
    assert all(row.reused for row in sweep(which[:5], store, time_limit=0.8 * limit))
    # a lower limit runs none again; a higher one what it had cut off, and that alone; what was killed from outside is
    assert [row.reused for row in sweep(which[5:6], store, time_limit=0.8 * limit)] == [not again]
    if kind == "time limit":
        rows = sweep(which, store, time_limit=20.0)
        assert [row.case.tag["i"] for row in rows if not row.reused] == [5] and not rows[5].failed


def test_exceptions_and_failed_responses_become_failed_rows(tmp_path):
    which = [*cases("raises"), *cases("fails", 1), *cases("never_steps", 1)]
    *raised, failed, unstepped = sweep(which, tmp_path / "s.jsonl", executor=Here())
    assert [row.case.tag["i"] for row in raised if row.failed] == [5]
    assert raised[5].failure["reason"] == "ValueError: Newton did not converge"
    shown = json.dumps(raised[5].failure)
    assert "fake_solvers.py" in shown and not any(folder in shown for folder in OURS)
    assert failed.failure["kind"] == "solver" and failed.failure["reason"] == "energy gain"
    assert failed.failure["last_state"]["time"] == 0.5 and failed.values["outcome"] == "failed"
    assert unstepped.failure["reason"] == "too many steps" and "cpu_seconds" not in unstepped.cost
    (unfit,) = sweep(cases(count=1), tmp_path / "s.jsonl", executor=Here(), measure=fake_solvers.broken)
    assert unfit.failure["reason"].startswith("TypeError") and "JSON" in unfit.failure["reason"]


def test_unknown_solvers_and_measures_that_cannot_travel_are_errors_before_anything_runs(tmp_path, monkeypatch):
    log = tmp_path / "log"
    first = cases("counted", 1, log=str(log))
    with pytest.raises(KeyError, match="unknown solver 'exodyn': choose one of analytic"):
        sweep([*first, Case(scene(0.1), "exodyn")], tmp_path / "s.jsonl")
    with pytest.raises(ValueError, match="module-level function"):
        sweep(first, tmp_path / "s.jsonl", measure=lambda case, response: {})
    monkeypatch.setitem(sys.modules, "pybullet", None)
    with pytest.raises(EngineNotInstalled, match="pip install"):
        sweep([*first, Case(scene(0.1), "pybullet")], tmp_path / "s.jsonl")
    assert not log.exists()


def test_two_workers_share_the_work(tmp_path):
    rows = sweep(cases(count=24, sleep=0.05), tmp_path / "s.jsonl", workers=2, measure=fake_solvers.place)
    shares = [[row.values["pid"] for row in rows].count(pid) for pid in {row.values["pid"] for row in rows}]
    assert len(shares) == 2 and min(shares) >= 6


def test_workers_killed_while_idle_are_replaced(tmp_path):
    with Processes(2) as executor, Store(tmp_path / "s.jsonl") as store:
        sweep(cases(count=3), store, executor=executor)
        for worker in executor._pool._pool_manager.worker_manager.workers.values():
            worker.kill()
        rows = sweep(cases(count=12), store, executor=executor)
    assert not any(row.failed for row in rows) and [row.reused for row in rows] == [True] * 3 + [False] * 9


def test_workers_that_cannot_start_are_an_error_not_an_endless_loop(tmp_path, monkeypatch):
    monkeypatch.setattr("comparisons.execution.sweep._start_worker", os._exit)  # the initializer ends every worker
    with pytest.raises(RuntimeError, match="end before they take up any run"):
        sweep(cases(count=3), tmp_path / "s.jsonl", workers=1)


KILLED_SWEEP = """
import sys
from fake_solvers import slow, sweep
sweep(slow(sys.argv[1], 40), sys.argv[2], workers=2)
"""


@pytest.mark.slow
def test_kill_9_then_resume_equals_an_uninterrupted_sweep(tmp_path):
    log, store = tmp_path / "log", tmp_path / "s.jsonl"
    process = subprocess.Popen([sys.executable, "-c", KILLED_SWEEP, log, store], env=fake_solvers.ENVIRONMENT)
    while process.poll() is None and not (store.exists() and store.read_bytes().count(b"\n") >= 10):
        time.sleep(0.01)
    family = psutil.Process(process.pid).children(recursive=True)
    process.kill()
    process.wait()
    saved = store.read_bytes().count(b"\n")
    assert 10 <= saved < 40
    assert not psutil.wait_procs(family, timeout=10)[1]  # no orphan goes on computing
    begun = len(log.read_text().split())
    assert begun - saved <= 2 * 6  # lost at most: the tasks in flight, two workers' worth of a few runs each
    rows = sweep(fake_solvers.slow(log, 40), store)
    assert sum(row.reused for row in rows) == saved and len(log.read_text().split()) - begun == 40 - saved
    assert [row.values["peak"] for row in rows] == [(1e-3 * i) ** 2 for i in range(40)]
