"""Studies killed at random moments and on a full disk: the same results in the end.

All of it: python -m pytest -m long tests/comparisons/running
"""

import functools
import os
import random
import resource
import signal
import subprocess
import sys
import time

import psutil
import pytest

from comparisons.running.by_solver import read
from comparisons.running.sweep import Store

pytestmark = [pytest.mark.long, pytest.mark.timeout(1400), pytest.mark.xdist_group("kills")]

# study: what it is given so that it stays short, and how often it is killed; 20 times in all
ENGINE = ("--engine", "pybullet")
STUDIES = {"fragility": (ENGINE, 7), "restitution": (ENGINE, 7), "stability": (ENGINE, 6)}
COSTS = ("cpu", "seconds", "steps_per_second")  # names of what differs from run to run


def start(study, folder, *options, **how):
    command = [sys.executable, "-m", "comparisons", "study", study, "--quick", "--output", folder, *options]
    return subprocess.Popen(
        [*command, *STUDIES[study][0]], text=True, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, **how
    )


def finished(study, folder, *options):
    """(rows of the result, rows of the store by key) of a study, without costs."""
    process = start(study, folder, *options)
    words = process.communicate(timeout=900)[1]
    assert process.returncode == 0, words[-2000:]
    with Store(folder / "runs.jsonl") as store:
        runs = {key: (without_costs(row["values"]), row["failure"]) for key, row in store.rows.items()}
    return without_costs(read(folder / study).rows), runs


def without_costs(value):
    if isinstance(value, dict):
        return {name: without_costs(each) for name, each in value.items() if not any(cost in name for cost in COSTS)}
    return [without_costs(each) for each in value] if isinstance(value, list) else value


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """What an uninterrupted study finds, each made once; the seconds it took."""

    @functools.cache
    def of(study):
        began = time.monotonic()
        return finished(study, tmp_path_factory.mktemp(study)), time.monotonic() - began

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
    expected, _ = whole("fragility")
    room = 5_000  # bytes in a file, for the disk: more than what a place is tried with, less than all rows take
    process = start(
        "fragility",
        tmp_path,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (room, resource.RLIM_INFINITY)),
    )
    words = process.communicate(timeout=900)[1]
    assert process.returncode == 2 and "Traceback" not in words, words[-2000:]
    assert "the rows so far are kept: make room and run again" in words
    with Store(tmp_path / "runs.jsonl") as store:
        assert 0 < len(store.rows) < len(expected[1])
    assert finished("fragility", tmp_path) == expected
