"""Where results are written: bad places are refused before the work, and no result is lost to a full disk or a kill.

On a full disk, or killed in the write, a command leaves what was there before, or the whole new one.
"""

import json
import os
import re
import resource
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from bad_scenes import SCENE, write_scene

from comparisons.running.provenance import RESULTS, read_result
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
    for shell, status, words in ((">&-", 2, "standard output"), ("| true", 1, "")):
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


COMMANDS = {
    "sheet": "sheet",
    "check": "study restitution --check 1 --seed 3 --write --workers 1",
    "study": "study fragility --quick --engine pybullet --workers 1",
    "report": "report free-rocking-rigid --engine analytic --studies studies",
    "lessons": "lessons export",
}
ROOM = 20_000  # bytes that a file may have: each command writes a larger one
# in which write each is killed: of the study and the report before, between and behind a result and its arrays
KILLS = {"sheet": (3,), "check": (1,), "study": (1, 2, 3), "report": (1, 7, 9, 12), "lessons": (1, 20)}
EARLIER = b"of before"
# Ends the process, as kill -9 does, before it puts the file of that number in its place.
KILL = """
import os, signal, sys
whole, seen = os.replace, []
def replace(part, place):
    if ".rocking-" in str(part) or str(part).endswith(".npz"):
        seen.append(place)
        if len(seen) == int(sys.argv[1]):
            os.kill(os.getpid(), signal.SIGKILL)
    return whole(part, place)
os.replace = replace
from comparisons import cli
cli.main(sys.argv[2:])
"""


def each(*commands):
    """Parameters of tests, each with a command first; but for one command they take long."""
    long = [pytest.mark.long, pytest.mark.timeout(1400)]
    return [pytest.param(*words, marks=pytest.mark.slow if words[0] == "sheet" else long) for words in commands]


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    """Makes a folder with what a command has written there before: pages with other words, results as they are."""
    root = tmp_path_factory.mktemp("disk")
    shutil.copytree(RESULTS / "sensitivity", root / "studies" / "sensitivity")

    def made(name, number):
        first, folder = root / name, root / f"{name}-{number}"
        if not first.exists() and name == "check":
            shutil.copytree(RESULTS / "restitution", first / "restitution")
        elif not first.exists():
            assert run(name, first).returncode == 0
        shutil.copytree(first, folder)
        for file in folder.rglob("*"):
            if file.is_file() and file.suffix not in (".json", ".npz", ".jsonl"):
                file.write_bytes(EARLIER)
        return folder, contents(folder), contents(first)

    return made


def run(name, folder, *python, **how):
    words = [*COMMANDS[name].split(), "--output", str(folder)]
    command = [sys.executable, *(python or ("-m", "comparisons")), *words]
    return subprocess.run(command, cwd=folder.parent, capture_output=True, text=True, **how)


def contents(folder):
    files = [file for file in sorted(folder.rglob("*")) if file.is_file() and not file.name.startswith(".")]
    return {file.relative_to(folder).as_posix(): file.read_bytes() for file in files}


def assert_whole(folder, before, first):
    """Each file of before is as it was, or a whole new one: as the first time, a page, or a result that can be read."""
    after = contents(folder)
    assert before.keys() <= after.keys()
    for name in [name for name in before if after[name] not in (before[name], first[name])]:
        whole = after[name].rstrip().endswith((b"</html>", b"</svg>", b"IEND\xaeB`\x82"))
        assert whole or name.endswith((".json", ".npz", ".jsonl")), name
    for file in folder.rglob("*.json"):
        read_result(file)


@pytest.mark.parametrize("name", each(*((name,) for name in COMMANDS)))
def test_on_a_full_disk_the_message_names_the_file_and_nothing_is_lost(folders, name):
    folder, before, first = folders(name, 0)
    room = (ROOM, resource.RLIM_INFINITY)
    done = run(name, folder, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, room))
    assert done.returncode == 2 and done.stdout == "" and "Traceback" not in done.stderr, done.stderr
    [message] = [line for line in done.stderr.splitlines() if line.startswith("Error: ")]
    named = re.search(rf"{re.escape(str(folder))}/(\S+): could not be written \(File too large\); make room", message)
    assert named, message
    assert contents(folder).get(named[1]) == before.get(named[1])
    assert_whole(folder, before, first)


@pytest.mark.parametrize("name, number", each(*((name, number) for name in KILLS for number in KILLS[name])))
def test_killed_in_the_write_each_file_is_the_old_or_the_new_one(folders, name, number):
    folder, before, first = folders(name, number)
    done = run(name, folder, "-c", KILL, str(number))
    assert done.returncode == -9, done.stderr
    assert_whole(folder, before, first)
    assert number > 1 or contents(folder) | before == contents(folder)
    assert run(name, folder).returncode == 0
    assert_whole(folder, before, first)
