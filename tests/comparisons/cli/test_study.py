"""``rocking study``: all of them side by side, and a stored result checked (running/test_check.py: how)."""

from pathlib import Path
from unittest.mock import Mock

import pytest

from comparisons.commands import study as command
from comparisons.running import check as module
from comparisons.running.check import Check
from comparisons.running.study import Computed, Study


def _plan(ask):
    return Computed({"quick": ask.quick}, [{"value": 1.5}], name="")
    yield  # a plan is a generator


def test_results_lie_side_by_side_and_a_second_call_keeps_them(rocking, monkeypatch, tmp_path):
    monkeypatch.setattr(command, "BUILT_IN", ("first", "second"))
    monkeypatch.setattr(command, "get_study", lambda name: Study(name, "A study that asks for no run?", _plan))
    for _ in range(2):
        status, out, _ = rocking("study", "all", "--quick", "--output", tmp_path)
        assert status == 0
        assert [Path(line).name for line in out.split()] == ["first.json", "second.json"]
    found = sorted(file.relative_to(tmp_path).as_posix() for file in tmp_path.rglob("*.json"))
    assert found == ["first.json", "first/first.json", "second.json", "second/second.json"]


@pytest.mark.parametrize("differences, status", [((), 0), (("exudyn: peak: stored 1, now 2",), 1)])
def test_status_is_whether_all_hold(rocking, monkeypatch, differences, status):
    check_all = Mock(return_value=[Check("restitution.json", 1, 4, 60, 1408, differences)])
    monkeypatch.setattr(module, "check_all", check_all)
    found, out, _ = rocking("study", "restitution", "--check", "4", "--output", "mine")
    assert found == status and check_all.call_args.args[:3] == ("restitution", "mine", 4)
    assert f"{4 - len(differences)} of 4 runs hold" in out and all(words in out for words in differences)
