"""Histories on their way to the page: kept in files, thinned for drawing, compared in full."""

import contextlib
import json
import subprocess
import sys
from time import sleep

import numpy as np
import psutil
import pytest
from sliding_scenes import SAVED

from analytic import load_scene, simulate, synthetic_motion
from analytic.response import History
from comparisons.report import histories, runs
from comparisons.running.cases import Case
from comparisons.running.executors import Task, lines_of
from comparisons.running.files import PlaceError
from comparisons.running.provenance import ResultError, read_result


@pytest.mark.parametrize("scene", [load_scene("caryatid-isolated").with_(duration=5.0), SAVED], ids=["rocks", "slides"])
def test_responses_survive_the_way_through_a_result_file_and_a_lost_history_is_said(tmp_path, scene):
    response = simulate(scene)
    values = json.loads(json.dumps(histories.ToFile(str(tmp_path))(None, response)))
    again = histories.response_of(values, tmp_path)
    assert again.to_json() == response.to_json()
    assert ("slip" in again.history.columns) == (scene is SAVED)
    for column in response.history.columns:
        np.testing.assert_array_equal(getattr(again.history, column), getattr(response.history, column))
    (tmp_path / values["history"]).unlink()
    with pytest.raises(ResultError, match="missing; remove the folder"):
        histories.response_of(values, tmp_path)


def test_a_history_that_cannot_be_kept_is_no_failed_run(tmp_path):
    """A full disk ends the report with a message; the run itself failed nowhere."""
    (tmp_path / "file").write_text("")
    case = Case(load_scene("free-rocking-rigid").with_(duration=0.1))
    task = Task("t", (case,), ("key",), histories.ToFile(str(tmp_path / "file")), 60.0)
    with pytest.raises(PlaceError, match=r"\.npz: could not be written \(Not a directory\)"):
        lines_of(task)


def test_thinning_keeps_ends_and_the_extremes_of_every_part():
    generator = np.random.default_rng(5)
    columns = generator.normal(size=(3, 1_000_000))
    columns[0, 123_456], columns[1, 777_777], columns[2, 999_998] = 50.0, -60.0, 70.0  # one sample wide
    shown = histories.thinned(*columns)
    assert len(shown) <= histories.MOST_SHOWN and (np.diff(shown) > 0).all()
    assert {0, 123_456, 777_777, 999_998, 999_999} <= set(shown)
    begins = np.arange(0, 1_000_000, 10_000)
    for column in columns:  # the band that a drawn line covers
        for extreme in (np.minimum, np.maximum):
            kept = extreme.reduceat(column[shown], np.searchsorted(shown, begins))
            np.testing.assert_array_equal(kept, extreme.reduceat(column, begins))
    np.testing.assert_array_equal(histories.thinned(columns[0, :5177]), np.arange(5177))


def test_differences_are_those_of_all_samples():
    time = np.linspace(0.0, 100.0, 100_001)
    zeros = np.zeros_like(time)
    model = History(time, np.sin(time), *5 * [zeros])
    spike = np.where(np.arange(len(time)) == 54_321, 1e-3, 0.0)
    apart = histories.differences(History(time, np.sin(time) + spike, zeros, zeros - 2e-3, *3 * [zeros]), model)
    assert len(apart["apart/time"]) < 20_000
    assert np.abs(apart["apart/tilt"]).max() == pytest.approx(1e-3, rel=1e-9)
    assert apart["apart/time"][np.abs(apart["apart/tilt"]).argmax()] == time[54_321]
    assert (apart["apart/base_displacement"] == -2e-3).all()


def memory(process):
    """Memory [B] of a process and its children, shared pages counted once; 0 when it ended meanwhile."""
    with contextlib.suppress(psutil.Error):
        used = [one.memory_full_info() for one in [process, *process.children(recursive=True)]]
        return sum(getattr(one, "pss", one.uss) for one in used)
    return 0


@pytest.mark.long
@pytest.mark.timeout(1400)
def test_a_report_on_a_million_samples_stays_under_800_mb(tmp_path):
    motion, step, count = synthetic_motion(), 2e-4, 1_000_000
    time = step * np.arange(count)
    shaking = 0.7 * motion.acceleration(time % motion.end)  # rocks for 200 s and does not overturn
    np.savetxt(tmp_path / "long.txt", np.column_stack([time, shaking]), fmt="%.6f")
    command = [sys.executable, "-m", "comparisons", "report", "--record", tmp_path / "long.txt", "--units", "m/s2"]
    with open(tmp_path / "log", "w") as log:
        run = subprocess.Popen([*command, "--output", tmp_path / "report"], stdout=log, stderr=log)
        most = 0
        while run.poll() is None:
            most = max(most, memory(psutil.Process(run.pid)))
            sleep(0.2)
    assert run.returncode == 0, (tmp_path / "log").read_text()[-2000:]
    assert most < 800e6, f"{most / 1e6:.0f} MB"
    result = read_result(tmp_path / "report" / runs.SCENES)
    assert {row["outcome"] for row in result.rows if row["scene"] == "caryatid-rigid"} == {"rocks"}
    assert max(len(values) for values in result.arrays.values()) <= histories.MOST_SHOWN
