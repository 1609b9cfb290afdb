"""The file of rows: torn ends dropped, damage named, one writer at a time."""

import json

import pytest

from comparisons.running.store import Store, StoreError


def line(key, value):
    return json.dumps({"key": key, "values": value})


def test_rows_come_back_and_the_last_of_a_key_counts(tmp_path):
    with Store(tmp_path / "new" / "s.jsonl") as store:
        assert store.append([line("a", 1), line("b", 2)])[1]["values"] == 2
        store.append([line("a", 3)])
    with Store(tmp_path / "new" / "s.jsonl") as store:
        assert {key: row["values"] for key, row in store.rows.items()} == {"a": 3, "b": 2}
        assert not store.torn and len(store) == 2 and "c" not in store.rows


@pytest.mark.parametrize("cut", [1, 5, 20])
def test_a_torn_last_line_is_dropped_and_the_file_goes_on(tmp_path, cut):
    path = tmp_path / "s.jsonl"
    with Store(path) as store:
        store.append([line("a", 1), line("b", 2)])
    path.write_bytes(path.read_bytes()[:-cut])
    with Store(path) as store:
        assert store.torn and list(store.rows) == ["a"]
        store.append([line("c", 3)])
    with Store(path) as store:
        assert not store.torn and list(store.rows) == ["a", "c"]


@pytest.mark.parametrize(
    "damage", [b"not json", b'{"values": 1}', b'{"key": []}', b"[1]", b"\x00\x00", b"\xff\xfe", b"[" * 100_000]
)
def test_a_damaged_whole_line_is_an_error_that_names_it(tmp_path, damage):
    path = tmp_path / "s.jsonl"
    path.write_bytes(b"\n".join([line("a", 1).encode(), damage, line("b", 2).encode(), b""]))
    with pytest.raises(StoreError, match="s.jsonl, line 2: not a row of results"):
        Store(path)


def test_a_second_writer_is_refused(tmp_path):
    pytest.importorskip("fcntl")
    with Store(tmp_path / "s.jsonl"), pytest.raises(StoreError, match="another sweep"):
        Store(tmp_path / "s.jsonl")
    Store(tmp_path / "s.jsonl").close()
