"""The file of rows: torn ends dropped, damage named, one writer at a time."""

import json

import pytest

from comparisons.running.sweep import Store, StoreError


def line(key, value):
    return json.dumps({"key": key, "values": value})


def rows(path, *lines):
    """{key: values} of the rows in a file after these lines were appended."""
    with Store(path) as store:
        store.append(lines)
        return {key: row["values"] for key, row in store.rows.items()}


def test_rows_come_back_and_the_last_of_a_key_counts(tmp_path):
    path = tmp_path / "new" / "s.jsonl"
    assert rows(path, line("a", 1), line("b", 2)) == {"a": 1, "b": 2}
    assert rows(path, line("a", 3)) == rows(path) == {"a": 3, "b": 2}


@pytest.mark.parametrize("cut", [1, 5, 20])
def test_a_torn_last_line_is_dropped_and_the_file_goes_on(tmp_path, cut):
    path = tmp_path / "s.jsonl"
    rows(path, line("a", 1), line("b", 2), line("c", 3))
    path.write_bytes(path.read_bytes()[:-cut])
    assert rows(path) == {"a": 1, "b": 2} and path.read_bytes().endswith(b"\n")
    assert rows(path, line("d", 4)) == rows(path) == {"a": 1, "b": 2, "d": 4}


@pytest.mark.parametrize(
    "damage", [b"not json", b'{"values": 1}', b'{"key": []}', b"[1]", b"\x00\x00", b"\xff\xfe", b"[" * 100_000]
)
def test_a_damaged_whole_line_is_an_error_that_names_it(tmp_path, damage):
    path = tmp_path / "s.jsonl"
    path.write_bytes(b"\n".join([line("a", 1).encode(), damage, line("b", 2).encode(), b""]))
    with pytest.raises(StoreError, match="s.jsonl, line 2: not a row of results"):
        Store(path)


def test_a_second_writer_is_refused_while_the_first_writes(tmp_path):
    pytest.importorskip("fcntl")
    with Store(tmp_path / "s.jsonl"), pytest.raises(StoreError, match="another sweep is writing to it"):
        Store(tmp_path / "s.jsonl")
    assert rows(tmp_path / "s.jsonl") == {}
