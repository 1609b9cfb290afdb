"""``rocking study NAME --check N``: status and words; what is checked has tests of its own (running/test_check.py)."""

import pytest

from comparisons.running import check as module
from comparisons.running.check import Check


@pytest.mark.parametrize("differences, status", [((), 0), (("exudyn: peak: stored 1, now 2",), 1)])
def test_status_is_whether_all_hold(rocking, monkeypatch, differences, status):
    asked = []

    def check_all(name, folder, number, seed, workers):
        asked.append((name, folder, number))
        return [Check(f"{name}.json", seed, 4, 60, 1408, differences)]

    monkeypatch.setattr(module, "check_all", check_all)
    found, out, _ = rocking("study", "restitution", "--check", "4", "--output", "mine")
    assert found == status and asked == [("restitution", "mine", 4)]
    assert f"{4 - len(differences)} of 4 runs hold" in out and all(words in out for words in differences)


def test_a_result_without_stored_runs_is_one_message(rocking, tmp_path):
    status, out, err = rocking("study", "tolerances", "--check", "3", "--output", tmp_path)
    assert status == 2 and not out and "no such result file" in err


def test_options_of_a_computation_are_refused(rocking):
    for options in (["--quick"], ["--engine", "exudyn"], ["--replot", "FILE"]):
        status, _, err = rocking("study", "restitution", "--check", "3", *options)
        assert status == 2 and "--check: takes a result as it is" in err
