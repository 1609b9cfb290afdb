"""Commands on a disk that is full, and killed in the write: what was there before is there still, or the whole new one.

All of them: python -m pytest -m long tests/comparisons/cli/test_full_disk.py
"""

import re
import resource
import shutil
import subprocess
import sys

import pytest

from comparisons.running.provenance import RESULTS, read_result

COMMANDS = {
    "sheet": "sheet",
    "check": "study restitution --check 1 --seed 3 --write --workers 1",
    "study": "study fragility --quick --engine pybullet --workers 1",
    "report": "report free-rocking-rigid --engine analytic --studies studies",
    "lessons": "lessons export",
}
ROOM = 20_000  # bytes that a file may have: each command writes a larger one
# in which write each is killed: of the study and the report before, between and behind a result and its arrays
KILLS = {"sheet": (1, 3), "check": (1,), "study": (1, 2, 3), "report": (1, 7, 9, 12), "lessons": (1, 20)}
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
