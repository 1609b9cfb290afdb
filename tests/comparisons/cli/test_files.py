"""Where results are written: bad places are refused before the work, and no result is lost to a full disk."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from bad_scenes import SCENE, write_scene

from comparisons.running.sweep import Store
from comparisons.studies import BUILT_IN

QUICK = ("run", "free-rocking-rigid")


def told(status, out, err):
    """One message of a mistake and nothing else."""
    return status == 2 and out == "" and err.startswith("Error: ") and err.count("\n") == 1 and len(err) < 800


@pytest.mark.parametrize("option", ["--json", "--csv"])
def test_places_where_nothing_can_be_written_are_refused_before_the_run(rocking, tmp_path, monkeypatch, option):
    monkeypatch.setattr("comparisons.commands.run.simulate", lambda *_, **__: pytest.fail("it ran"))
    os.mkfifo(tmp_path / "fifo")
    (tmp_path / "file").write_text("")
    inside = (".", "fifo", "x" * 300, "file/x.json", "none/x.json")
    outside = ("/dev/full", "/dev/null", "/dev/tty", "/proc/x.json", "a\0b", "")
    for place in (*(tmp_path / name for name in inside), *outside):
        assert told(*rocking(*QUICK, option, place)), place
    assert sorted(path.name for path in tmp_path.iterdir()) == ["fifo", "file"]  # nothing left of the trials


def test_a_result_does_not_overwrite_what_is_read_nor_another_result(rocking, tmp_path):
    scene = write_scene(tmp_path, SCENE)
    assert told(*rocking("run", scene, "--json", scene))
    assert told(*rocking("run", scene, "--json", tmp_path / "a", "--csv", tmp_path / "." / "a"))
    assert scene.read_text() == SCENE


FOLDERS = [["report"], ["lessons", "export"], ["sheet"], *(["study", name] for name in BUILT_IN)]


@pytest.mark.parametrize("command", FOLDERS, ids=" ".join)
def test_folders_where_nothing_can_be_written_are_refused_before_the_work(rocking, tmp_path, command):
    (tmp_path / "file").write_text("")
    os.mkfifo(tmp_path / "fifo")
    for place in ("/proc/x", "/dev/full", *(tmp_path / name for name in ("fifo", "file", "file/x", "x" * 300)), "a\0b"):
        assert told(*rocking(*command, "--output", place)), place


def test_a_disk_that_is_full_after_the_run_costs_no_result(rocking, tmp_path, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("comparisons.running.files.os.replace", full)
    (tmp_path / "else").mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "else"))
    status, out, err = rocking(*QUICK, "--json", tmp_path / "r.json", "--csv", tmp_path / "r.csv")
    assert status == 2 and "outcome" in out  # the table is printed all the same
    kept = sorted((tmp_path / "else").iterdir(), key=lambda path: path.suffix, reverse=True)
    assert [path.suffix for path in kept] == [".json", ".csv"] and list(tmp_path.iterdir()) == [tmp_path / "else"]
    assert all(f"the result is in {path}" in err for path in kept)
    assert json.loads(kept[0].read_text())["outcome"] == "rocks"


@pytest.mark.slow
def test_standard_output_that_is_full_closed_or_not_read(tmp_path):
    environment = {**os.environ, "TMPDIR": str(tmp_path)}
    with open("/dev/full", "w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "comparisons", *QUICK, "--json", "-"],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            env=environment,
        )
    (kept,) = tmp_path.glob("*.json")
    assert told(done.returncode, "", done.stderr) and str(kept) in done.stderr
    assert json.loads(kept.read_text())["outcome"] == "rocks"
    for shell, status, words in ((">&-", 2, "standard output"), ("| true", 1, ""), (">&- 2>&-", 2, "")):
        command = f"{sys.executable} -m comparisons {' '.join(QUICK)} --json - {shell}; exit ${{PIPESTATUS[0]}}"
        done = subprocess.run(["bash", "-c", command], stderr=subprocess.PIPE, text=True, env=environment)
        assert done.returncode == status and words in done.stderr and "Traceback" not in done.stderr
        assert words or not done.stderr


def test_a_store_that_is_damaged_in_use_or_no_file(rocking, tmp_path):
    study, path = ("study", "fragility", "--quick", "--output", tmp_path), tmp_path / "runs.jsonl"
    with Store(path):
        assert told(*rocking(*study))
    path.write_bytes(b"not json\n")
    assert told(*rocking(*study))
    for make in (Path.mkdir, os.mkfifo):
        path.rmdir() if path.is_dir() else path.unlink()
        make(path)
        assert told(*rocking(*study))
    for wrong in (["--workers", "1000000"], ["--engine", "nope"], ["--engine", "analytic"]):
        assert told(*rocking(*study[:-1], tmp_path / "new", *wrong)), wrong
    assert not (tmp_path / "new").exists()
