"""Writers by damages: each file is the old or the new one, the message names it, and a kill or a full disk costs no
result. Places where nothing can be written are refused before the work."""

import contextlib
import itertools
import json
import os
import re
import resource
import signal
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest
from bad_scenes import SCENE, write_scene
from forks import fork

from comparisons import cli
from comparisons.execution import results, sweep, writing
from comparisons.execution.results import copy_result, read_result, record_check, write_result
from comparisons.execution.sweep import Store, StoreError
from comparisons.execution.writing import PlaceError, write, write_all, write_pair
from comparisons.lessons import export
from comparisons.lessons.topics import lesson
from engines import guard


def line(key, value):
    return json.dumps({"key": key, "values": value})


def page(folder, number):
    write(folder / "page.html", f"{number}\n" * 5000)


def result(folder, number):
    rows, arrays = [{"value": number}], {"a": np.full(1000, number)}
    return write_result(folder / "r.json", "k", {}, rows, arrays, modules=["analytic.errors"])


def check(folder, number):
    """The record of a check in a result that is there."""
    path = folder / "r.json"
    if not path.exists():
        result(folder, 1)
    record_check(path, {"date": "", "commit": None, "dirty": None, "seed": 1, "runs": number, "held": number})


def several(folder, number):
    write_all(folder, {f"pages/{name}": f"{name} {number}" * 20 for name in ("a.html", "b.png", "c.svg")})


def runs(folder, number):
    with Store(folder / "runs.jsonl") as store:
        store.append([line("a", [number] * 20 * number)])


def scene(folder, number):
    (folder / "bust.toml").unlink(missing_ok=True)
    words = ("--height", "1.9", "--width", "0.55", "--mass", str(500 + number))
    cli.main(["new", str(folder / "bust.toml"), *words])


def run(folder, number):
    name = ("caryatid-rigid", "free-rocking-rigid")[number % 2]
    cli.main(["run", name, "--json", str(folder / "run.json"), "--csv", str(folder / "run.csv")])


def exported(*words):
    def export(folder, number):
        """The same whenever: what was there before has other words."""
        try:
            cli.main([*words, "--output", str(folder)])
        finally:
            for file in folder.rglob("*.*") if number == 1 else ():
                file.write_text("of before")

    return export


WRITERS = {writer.__name__: writer for writer in (page, result, check, several, runs, scene, run)}
WRITERS |= {"sheet": exported("sheet"), "lesson": exported("lessons", "export")}
DEAR = ("sheet", "lesson")
SLOW = (*DEAR, "run", "scene", "check", "several")


def full():
    raise OSError(28, "No space left on device")


def killed():
    os.kill(os.getpid(), signal.SIGKILL)


def interrupted():
    os.kill(os.getpid(), signal.SIGINT)


def read_only():
    """Its folder would let it be; who runs the tests may be allowed everything, so the system's answer is set."""
    return False


# (the system's call that meets it, what it meets)
DAMAGES = [
    *((call, met) for call in ("fsync", "replace") for met in (full, killed, interrupted)),
    ("access", read_only),
]
DAMAGES.append(("write", full))


def damaged(call, met, number, work):
    """(status, words) of some work in a process of its own, where the `number`-th call of a function of os is met by a
    damage, or no file may become longer."""
    reads, tells = os.pipe()
    child = fork()
    if child == 0:
        signal.signal(signal.SIGINT, signal.default_int_handler)  # else ignored in the background
        sys.stdout = sys.stderr = os.fdopen(tells, "w", 1)
        whole, calls, status = getattr(os, call), itertools.count(1), 0
        if call == "write" and number == 1:
            resource.setrlimit(resource.RLIMIT_FSIZE, (100, resource.RLIM_INFINITY))
        elif call != "write":
            setattr(os, call, lambda *given, **how: met() if next(calls) == number else whole(*given, **how))
        try:
            work()
        except BaseException as error:
            status = error.code if isinstance(error, SystemExit) else 1
            print(f"{type(error).__name__}: {error}")
        finally:
            sys.stderr.flush()
            os._exit(status or 0)
    os.close(tells)
    with open(reads) as stderr:
        words = stderr.read()
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), words


def content(file):
    """What a file says; of a result with what its arrays say, which belong to it."""
    if file.suffix == ".jsonl":
        with Store(file) as store:
            return store.rows
    if file.suffix != ".json":
        return file.read_bytes()
    actual = json.loads(file.read_text())
    if "provenance" not in actual:
        return actual | {"cpu_seconds": None}
    actual = read_result(file)
    assert not actual.arrays or set(actual.arrays["a"]) == {actual.rows[0]["value"]}
    return actual.rows, actual.provenance.get("check")


def contents(folder):
    files = [file for file in folder.rglob("*") if file.is_file() and file.suffix != ".npz" and file.name[0] != "."]
    return {file.relative_to(folder).as_posix(): content(file) for file in files}


NAMED = re.compile(
    r"(\S+): (?:(?:could not be written|rows cannot be stored there|nothing can be written there) "
    r"\((?:No space left on device|File too large|is read-only)\)|is read-only)"
    r"(?:, nor anywhere else)?; (?:make room|the rows so far are kept: make room|the result is in|give another)"
)
KEEPS = ("run", "scene")


@pytest.fixture
def here(tmp_path, monkeypatch):
    """Folders of the file, and of what is kept elsewhere; runs are quick."""
    for name in ("place", "else"):
        (tmp_path / name).mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "else"))
    monkeypatch.setattr(results, "checkout", lambda: {"commit": None, "dirty": None})
    monkeypatch.setattr(results, "version_of", lambda package: "1")
    monkeypatch.setattr(sweep, "SYNC_SECONDS", 0.0)
    monkeypatch.setattr(guard, "run_apart", lambda function, *arguments, **_: (function(*arguments), None))
    monkeypatch.setattr(export, "lessons", lambda: [lesson("bearing")])
    monkeypatch.setattr(export, "_lesson_page", lambda *parts: "<!DOCTYPE html><title>left out</title>")
    return tmp_path / "place"


def undamaged(writer, folder, number):
    """What a writer writes where nothing happens."""
    folder.mkdir(exist_ok=True)
    with contextlib.suppress(SystemExit):
        WRITERS[writer](folder, number)
    return contents(folder)


# runs are appended; a scene that is there is not written
NONE_SUCH = [("runs", "replace"), ("runs", "access"), ("scene", "access")]
TABLE = [
    pytest.param(
        writer,
        *damage,
        marks=[pytest.mark.slow] * (writer in SLOW and (writer, *damage) != ("run", "replace", full)),  # what is kept
        id=f"{writer}-{damage[0]}-{damage[1].__name__}",
    )
    for writer in WRITERS
    for damage in (DAMAGES[1::3] if writer in DEAR else DAMAGES)
    if (writer, damage[0]) not in NONE_SUCH
]


@pytest.mark.parametrize("writer, call, met", TABLE)
def test_each_file_is_the_old_or_the_new_one_and_the_message_names_it(here, tmp_path, writer, call, met):
    before = undamaged(writer, here, 1)
    for number in (1, 3, 0) if writer in DEAR else itertools.count(1):  # 0: nothing happens
        new = undamaged(writer, tmp_path / "new", number + 1)
        status, words = damaged(call, met, number, lambda number=number: WRITERS[writer](here, number + 1))
        after = contents(here)
        if status == 0:
            break
        match = NAMED.search(words)
        assert bool(match) == (met in (full, read_only)) and (status == -9) == (met is killed), words
        for name in new:
            assert after.get(name) in (before.get(name), new[name]) or (name, after.get(name)) == ("bust.toml", None)
        if match:
            name = Path(match[1]).relative_to(here).as_posix()
            assert after.get(name) in (before.get(name), None)
        elsewhere = [*(tmp_path / "else").iterdir()]
        assert len(elsewhere) == (writer in KEEPS and call != "write" and "could not be written" in words)
        for kept in elsewhere:
            assert f"the result is in {kept}" in words and content(kept) in new.values()
            kept.unlink()
        before = after
    assert number != 1 and after == new
    left = [*here.rglob(".rocking-*")]  # another process may be writing it
    assert bool(left) == (met is killed and writer != "runs")
    for part in left:
        os.utime(part, (0, part.stat().st_mtime - writing.STALE - 1))
    undamaged(writer, here, number + 2)
    assert not [*here.rglob(".*")]


def rows(path, *lines):
    """{key: values} of the rows in a file after these lines were appended."""
    with Store(path) as store:
        store.append(lines)
        return {key: row["values"] for key, row in store.rows.items()}


def test_rows_come_back_the_last_of_a_key_counts_and_a_torn_end_is_dropped(tmp_path):
    path = tmp_path / "new" / "s.jsonl"
    assert rows(path, line("a", 1), line("b", 2)) == {"a": 1, "b": 2}
    assert rows(path, line("a", 3)) == rows(path) == {"a": 3, "b": 2}
    for cut in (1, 20):
        rows(path, line("c", 3))
        path.write_bytes(path.read_bytes()[:-cut])
        assert rows(path) == {"a": 3, "b": 2} and path.read_bytes().endswith(b"\n")


@pytest.mark.parametrize("damage", [b"not json", b'{"values": 1}', b'{"key": []}', b"[1]", b"\xff\xfe", b"[" * 100_000])
def test_a_damaged_line_of_runs_is_named(tmp_path, damage):
    path = tmp_path / "s.jsonl"
    path.write_bytes(b"\n".join([line("a", 1).encode(), damage, line("b", 2).encode(), b""]))
    with pytest.raises(StoreError, match="s.jsonl, line 2: not a row of results"):
        Store(path)


def test_arrays_that_wait_for_a_result_are_not_removed_by_an_equal_one_that_fails(tmp_path, monkeypatch):
    path = result(tmp_path, 1)
    damaged("replace", killed, 3, lambda: result(tmp_path, 2))
    text, (waiting,), whole = path.read_text(), tmp_path.glob(".r.*.npz"), os.replace
    monkeypatch.setattr(writing.os, "replace", lambda part, place: full() if place == path else whole(part, place))
    with pytest.raises(PlaceError):
        write_pair(path, text, path.with_suffix(".npz"), waiting.read_bytes())
    assert content(path)[0] == [{"value": 2}]
    (tmp_path / "copies").mkdir()
    copies = copy_result(path, tmp_path / "copies")
    assert content(copies[0]) == content(path) and len(copies) == 2


def test_several_that_write_one_file_at_once_do_not_meet(tmp_path):
    path, texts, done = tmp_path / "page.html", [str(number) * 50_000 for number in range(8)], []

    def work(text):
        for _ in range(20):
            write(path, text)
        done.append(text)

    threads = [threading.Thread(target=work, args=(text,)) for text in texts]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(done) == 8 and path.read_text() in texts and list(tmp_path.iterdir()) == [path]


def test_a_link_is_followed_a_mode_kept_and_a_result_without_arrays_is_one_file(tmp_path):
    (tmp_path / "there").mkdir()
    file, link = tmp_path / "there" / "r.json", tmp_path / "link.json"
    file.touch(0o640)
    link.symlink_to(file)
    write(link, "new")
    assert file.read_text() == "new" and link.is_symlink() and file.stat().st_mode & 0o777 == 0o640
    path = write_result(tmp_path / "alone.json", "k", {}, [], modules=["analytic.errors"])
    assert copy_result(path, tmp_path / "there") == [tmp_path / "there" / "alone.json"]
    assert content(tmp_path / "there" / "alone.json") == ([], None)


def one_message(status, out, err):
    """One message of a mistake and nothing else."""
    return status == 2 and out == "" and err.startswith("Error: ") and err.count("\n") == 1 and len(err) < 800


QUICK = ("run", "free-rocking-rigid")
PLACES = ("fifo", "x" * 300, "file/x.json", "/proc/x.json", "/dev/full", "a\0b")
FILE = (".", "none/x.json", "/dev/null", "/dev/tty", "")
FOLDER = ("file",)
WORDS = {(*QUICK, "--json"): FILE, (*QUICK, "--csv"): FILE}
WORDS |= {
    (*command.split(), "--output"): FOLDER
    for command in ("report", "lessons export", "sheet", "study restitution", "study all")
}


@pytest.mark.parametrize("words", WORDS, ids=" ".join)
def test_places_where_nothing_can_be_written_are_refused_before_the_work(rocking, tmp_path, monkeypatch, words):
    monkeypatch.setattr("comparisons.commands.runs.simulate", lambda *_, **__: pytest.fail("it ran"))
    monkeypatch.chdir(tmp_path)
    os.mkfifo("fifo")
    Path("file").touch()
    for place in (*PLACES, *WORDS[words]):
        assert one_message(*rocking(*words, place)), place
    assert sorted(os.listdir()) == ["fifo", "file"]  # nothing left of the trials


def test_a_result_does_not_overwrite_what_is_read_nor_another_result(rocking, tmp_path):
    scene = write_scene(tmp_path, SCENE)
    assert one_message(*rocking("run", scene, "--json", scene))
    assert one_message(*rocking("run", scene, "--json", tmp_path / "a", "--csv", tmp_path / "." / "a"))
    assert scene.read_text() == SCENE


def test_runs_that_are_damaged_in_use_or_no_file_are_told_before_the_work(rocking, tmp_path):
    study, path = ("study", "fragility", "--quick", "--output", tmp_path), tmp_path / "runs.jsonl"
    with Store(path):
        with pytest.raises(StoreError, match="another sweep is writing to it"):
            Store(path)
        assert one_message(*rocking(*study))
    path.write_bytes(b"not json\n")
    assert one_message(*rocking(*study))
    for make in (Path.mkdir, os.mkfifo):
        path.rmdir() if path.is_dir() else path.unlink()
        make(path)
        assert one_message(*rocking(*study))
    for wrong in (["--workers", "1000000"], ["--engine", "nope"], ["--engine", "analytic"]):
        assert one_message(*rocking(*study[:-1], tmp_path / "new", *wrong)), wrong
    assert not (tmp_path / "new").exists()


@pytest.mark.slow
@pytest.mark.parametrize(
    "shell, status, words", [(">/dev/full", 2, "the result is in"), (">&-", 2, "standard output"), ("| true", 1, "")]
)
def test_standard_output_that_is_full_closed_or_not_read(tmp_path, shell, status, words):
    command = f"{sys.executable} -m comparisons {' '.join(QUICK)} --json - {shell}; exit ${{PIPESTATUS[0]}}"
    environment = {**os.environ, "TMPDIR": str(tmp_path)}
    done = subprocess.run(["bash", "-c", command], stderr=subprocess.PIPE, text=True, env=environment)
    assert done.returncode == status and words in done.stderr and "Traceback" not in done.stderr
    assert bool(words) == bool(done.stderr)
    for kept in tmp_path.glob("*.json"):
        assert str(kept) in done.stderr and json.loads(kept.read_text())["outcome"] == "rocks"
