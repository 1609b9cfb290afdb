"""``rocking study all``: every study of this project, side by side, and the report on them."""

from pathlib import Path

import pytest

from comparisons.commands import study as command
from comparisons.running.study import Found, Study


def _plan(ask):
    return Found({"quick": ask.quick}, [{"value": 1.5}], name="")
    yield  # a plan is a generator


def _study(name):
    return Study(name, "A study that asks for no run?", _plan)


@pytest.fixture
def two_studies(monkeypatch):
    monkeypatch.setattr(command, "BUILT_IN", ("first", "second"))
    monkeypatch.setattr(command, "get_study", _study)


def test_results_lie_side_by_side_and_a_second_call_keeps_them(rocking, two_studies, tmp_path):
    for _ in range(2):
        status, out, _ = rocking("study", "all", "--quick", "--output", tmp_path)
        assert status == 0
        assert [Path(line).name for line in out.split()] == ["first.json", "second.json"]
    assert {file.name for file in tmp_path.glob("*.json")} == {"first.json", "second.json"}
    assert (tmp_path / "first" / "first.json").exists()


def test_the_report_refuses_a_folder_without_results(rocking, tmp_path):
    status, _, err = rocking("report", "--studies", tmp_path / "none", "--output", tmp_path / "report")
    assert status == 2 and "holds no result file" in err and "rocking study all" in err
