"""Files are written whole or not at all: on a full disk, killed at any moment, by several at once."""

import errno
import os
import signal
import threading

import numpy as np
import pytest

from comparisons.running import files
from comparisons.running.files import PlaceError, write, write_all, write_pair
from comparisons.running.provenance import ResultError, copy_result, read_result, record_check, write_result

BEFORE, AFTER = "what was there before\n" * 1000, "new\n" * 5000
CHECK = {"date": "2026-11-26", "commit": None, "dirty": None, "seed": 1, "runs": 2, "held": 2}


def failing(number, monkeypatch, name="replace"):
    """The `number`-th call from now on of a function of os meets a full disk."""
    whole, calls = getattr(os, name), []

    def call(*given):
        calls.append(given)
        if len(calls) == number:
            raise OSError(errno.ENOSPC, "No space left on device")
        return whole(*given)

    monkeypatch.setattr(files.os, name, call)


def killed_in(name, number, work):
    """Do some work in a process that is killed, as by kill -9, in the `number`-th call of a function of os."""
    child = os.fork()
    if child == 0:
        whole, calls = getattr(os, name), []

        def call(*given):
            calls.append(given)
            if len(calls) == number:
                os.kill(os.getpid(), signal.SIGKILL)
            return whole(*given)

        setattr(os, name, call)
        try:
            work()
        finally:
            os._exit(1)
    return os.WIFSIGNALED(os.waitpid(child, 0)[1])


def result(folder, number):
    """A result file with arrays."""
    rows, arrays = [{"value": number}], {"a": np.full(1000, number)}
    return write_result(folder / "r.json", "k", {}, rows, arrays, modules=["analytic.errors"])


def value(path):
    """The number of a `result`, in its row and in its arrays."""
    found = read_result(path)
    assert set(found.arrays["a"].tolist()) == {found.rows[0]["value"]}
    return found.rows[0]["value"]


@pytest.mark.parametrize("call", ["fsync", "replace"])
def test_on_a_full_disk_what_was_there_stays_and_the_message_names_the_file(tmp_path, monkeypatch, call):
    path = tmp_path / "page.html"
    write(path, BEFORE)
    failing(1, monkeypatch, call)
    with pytest.raises(PlaceError, match=r"page\.html: could not be written \(No space left on device\); make room"):
        write(path, AFTER)
    assert path.read_text() == BEFORE and list(tmp_path.iterdir()) == [path]
    write(path, AFTER)
    assert path.read_text() == AFTER


@pytest.mark.parametrize("call", ["fsync", "replace"])
def test_a_kill_in_the_write_leaves_what_was_there_and_no_part_for_good(tmp_path, call):
    path = tmp_path / "result.json"
    write(path, BEFORE)
    path.chmod(0o640)
    assert killed_in(call, 1, lambda: write(path, AFTER))
    assert path.read_text() == BEFORE
    (part,) = set(tmp_path.iterdir()) - {path}
    assert list(tmp_path.glob("*.json")) == [path]  # a part is no result
    write(path, AFTER)
    assert part.exists()  # another process may be writing it
    os.utime(part, (0, os.stat(part).st_mtime - files.STALE - 1))
    write(path, BEFORE)
    assert list(tmp_path.iterdir()) == [path] and path.stat().st_mode & 0o777 == 0o640


@pytest.mark.parametrize("number", [1, 2, 3])  # arrays aside, result, arrays in their place
def test_a_result_killed_at_any_moment_is_the_old_or_the_new_one(tmp_path, number):
    path = result(tmp_path, 1)
    for again in range(2, 4):  # killed twice: what the first left is not taken from under the result
        assert killed_in("replace", number, lambda again=again: result(tmp_path, again))
        assert value(path) == (again if number == 3 else 1)
        assert [file.name for file in tmp_path.glob("*.json")] == ["r.json"]
    (tmp_path / "copies").mkdir()
    copies = copy_result(path, tmp_path / "copies")
    assert value(copies[0]) == value(path) and len(copies) == 2
    result(tmp_path, 7)
    assert value(path) == 7
    left = {file.name for file in tmp_path.iterdir() if file.suffix != ".part"}
    assert left == {"r.json", "r.npz", "copies"}  # no arrays that wait any more


@pytest.mark.parametrize("number", [1, 2, 3])
def test_a_result_on_a_full_disk_stays_the_old_one(tmp_path, monkeypatch, number):
    path = result(tmp_path, 1)
    failing(number, monkeypatch)
    with pytest.raises(PlaceError, match=r"/r\.(json|npz): could not be written \(No space left"):
        result(tmp_path, 2)
    assert value(path) == (2 if number == 3 else 1)
    assert number == 3 or {file.name for file in tmp_path.iterdir()} == {"r.json", "r.npz"}
    result(tmp_path, 3)
    assert value(path) == 3 and {file.name for file in tmp_path.iterdir()} == {"r.json", "r.npz"}


def test_arrays_that_wait_for_a_result_are_not_removed_by_an_equal_one_that_fails(tmp_path, monkeypatch):
    path = result(tmp_path, 1)
    assert killed_in("replace", 3, lambda: result(tmp_path, 2))
    text, (waiting,) = path.read_text(), tmp_path.glob(".r.*.npz")
    failing(2, monkeypatch)
    with pytest.raises(PlaceError):
        write_pair(path, text, path.with_suffix(".npz"), waiting.read_bytes())
    assert value(path) == 2


@pytest.mark.parametrize("call", ["fsync", "replace"])
def test_the_record_of_a_check_never_harms_the_result(tmp_path, monkeypatch, call):
    path = result(tmp_path, 1)
    before = path.read_bytes()
    assert killed_in(call, 1, lambda: record_check(path, CHECK))
    assert path.read_bytes() == before
    failing(1, monkeypatch, call)
    with pytest.raises(ResultError, match=r"2 of 2 runs hold, but that is not recorded: .*r\.json: could not be"):
        record_check(path, CHECK)
    assert path.read_bytes() == before
    record_check(path, CHECK)
    assert read_result(path).provenance["check"] == CHECK and value(path) == 1  # its digest made anew


def test_several_that_write_one_file_at_once_do_not_meet(tmp_path):
    path, texts = tmp_path / "page.html", [str(number) * 50_000 for number in range(8)]
    failed = []

    def work(text):
        try:
            for _ in range(20):
                write(path, text)
        except Exception as error:
            failed.append(error)

    threads = [threading.Thread(target=work, args=(text,)) for text in texts]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not failed and path.read_text() in texts and list(tmp_path.iterdir()) == [path]


def test_files_of_a_folder_are_written_in_order_each_whole(tmp_path, monkeypatch):
    first = {"pages/a.html": "a", "figures/b.png": b"\x89", "index.html": "i"}
    paths = write_all(tmp_path / "new", first)
    assert [path.relative_to(tmp_path / "new").as_posix() for path in paths] == list(first)
    failing(2, monkeypatch)
    with pytest.raises(PlaceError, match=r"b\.png: could not be written"):
        write_all(tmp_path / "new", dict.fromkeys(first, "second"))
    assert [path.read_bytes() for path in paths] == [b"second", b"\x89", b"i"]


def test_a_link_is_followed_and_a_result_without_arrays_is_one_file(tmp_path):
    (tmp_path / "there").mkdir()
    (tmp_path / "link.json").symlink_to(tmp_path / "there" / "r.json")
    write(tmp_path / "link.json", AFTER)
    assert (tmp_path / "there" / "r.json").read_text() == AFTER and (tmp_path / "link.json").is_symlink()
    path = write_result(tmp_path / "alone.json", "k", {}, [], modules=["analytic.errors"])
    assert copy_result(path, tmp_path / "there") == [tmp_path / "there" / "alone.json"]
    assert read_result(tmp_path / "there" / "alone.json").rows == []


def test_a_read_only_file_is_not_replaced(tmp_path, monkeypatch):
    """Its folder would let it be; who runs the tests may be allowed everything, so the answer of the system is set."""
    place = tmp_path / "kept.html"
    place.write_text(BEFORE)
    monkeypatch.setattr("comparisons.running.files.os.access", lambda path, mode: not os.path.samefile(path, place))
    with pytest.raises(PlaceError, match=r"kept\.html"):
        write(place, AFTER)
    assert place.read_text() == BEFORE and os.listdir(tmp_path) == ["kept.html"]
