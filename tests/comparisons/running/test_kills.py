"""Studies killed at random moments, on a full disk and two at once: the same results in the end.

All of it: python -m pytest -m slow tests/comparisons/running
"""

import json
import os
import random
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import psutil
import pytest

from comparisons.running.provenance import read_result
from comparisons.running.store import Store
from engines import installed_engines

PROJECT = Path(__file__).parents[3]
pytestmark = [pytest.mark.slow, pytest.mark.timeout(1400), pytest.mark.xdist_group("kills")]

# study: what it is given so that it stays short, and how often it is killed; 20 times in all
STUDIES = {"surface": ((), 7), "restitution": (("--engine",), 7), "stability": (("--engine",), 6)}
COSTS = ("cpu", "seconds", "steps_per_second")  # names of what differs from run to run


def command(study, folder, *options):
    given, _ = STUDIES[study]
    engine = [installed_engines()[-1]] if given else []
    return [
        sys.executable,
        "-m",
        "comparisons",
        "study",
        study,
        "--quick",
        "--output",
        folder,
        *given,
        *engine,
        *options,
    ]


def start(study, folder, *options, **how):
    environment = {**os.environ, "PYTHONPATH": str(PROJECT)}
    return subprocess.Popen(
        command(study, folder, *options),
        cwd=PROJECT,
        env=environment,
        text=True,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        **how,
    )


def finished(study, folder, *options):
    process = start(study, folder, *options)
    words = process.communicate(timeout=900)[1]
    assert process.returncode == 0, words[-2000:]
    return results(study, folder)


def results(study, folder):
    """(rows of the result, rows of the store by key), without costs."""
    with Store(folder / "runs.jsonl") as store:
        runs = {key: (without_costs(row["values"]), row["failure"]) for key, row in store.rows.items()}
    return without_costs(read_result(folder / f"{study}.json").rows), runs


def without_costs(value):
    if isinstance(value, dict):
        return {name: without_costs(each) for name, each in value.items() if not any(cost in name for cost in COSTS)}
    return [without_costs(each) for each in value] if isinstance(value, list) else value


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """What an uninterrupted study finds, each made once; the seconds it took."""
    kept = {}

    def of(study):
        if study not in kept:
            began = time.monotonic()
            kept[study] = finished(study, tmp_path_factory.mktemp(study)), time.monotonic() - began
        return kept[study]

    return of


@pytest.mark.parametrize("study", STUDIES)
def test_a_study_killed_again_and_again_ends_with_the_same_results(tmp_path, whole, study):
    expected, seconds = whole(study)
    moments, (_, kills) = random.Random(study), STUDIES[study]
    for number in range(kills):
        process = start(study, tmp_path, start_new_session=True)
        try:
            process.wait(moments.uniform(0.2, 1.0) * seconds)
        except subprocess.TimeoutExpired:
            family = psutil.Process(process.pid).children(recursive=True)
            if number % 2:
                os.killpg(process.pid, signal.SIGKILL)
            process.kill()
            assert not psutil.wait_procs(family, timeout=10)[1]  # nobody goes on computing
        process.communicate()
    assert finished(study, tmp_path) == expected


def test_a_study_on_a_full_disk_says_so_and_resumes_when_there_is_room(tmp_path, whole):
    expected, _ = whole("surface")
    room = 5_000  # bytes in a file, for the disk: more than what a place is tried with, less than all rows take
    process = start(
        "surface",
        tmp_path,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (room, resource.RLIM_INFINITY)),
    )
    words = process.communicate(timeout=900)[1]
    assert process.returncode == 2 and "Traceback" not in words, words[-2000:]
    assert "the rows so far are kept: make room and run again" in words
    with Store(tmp_path / "runs.jsonl") as store:
        assert 0 < len(store) < len(expected[1]) and not store.torn
    assert finished("surface", tmp_path) == expected


def test_of_two_at_once_one_says_that_the_place_is_in_use(tmp_path, whole):
    expected, _ = whole("surface")
    first = start("surface", tmp_path)
    while first.poll() is None and not (tmp_path / "runs.jsonl").exists():
        time.sleep(0.02)
    second = start("surface", tmp_path)
    words = second.communicate(timeout=900)[1]
    assert second.returncode == 2 and "another sweep is writing to it" in words
    first.communicate(timeout=900)
    assert first.returncode == 0 and results("surface", tmp_path) == expected


@pytest.mark.parametrize("study", ["surface", "stability"])
def test_a_cluster_finds_what_this_machine_finds(tmp_path, whole, study):
    pytest.importorskip("distributed")
    assert finished(study, tmp_path, "--scheduler", "local:2") == whole(study)[0]
    assert json.loads((tmp_path / f"{study}.json").read_text())["rows"]
