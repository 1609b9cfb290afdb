"""``rocking sheet`` as a maker of another code calls it."""

import json

from comparisons.sheet.problems import PROBLEMS


def test_the_sheet_and_its_answers_are_written(rocking, tmp_path):
    status, out, _ = rocking("sheet", "--output", tmp_path, "--json", tmp_path / "sheet.json")
    assert status == 0 and out.splitlines()[0] == str(tmp_path / "index.md")
    content = json.loads((tmp_path / "sheet.json").read_text())
    assert content["schema"] == "rocking sheet 2" and content["files"] == out.splitlines()
    assert [one["scene"] for one in content["problems"]] == [problem.name for problem in PROBLEMS]
    for written, problem in zip(content["problems"], PROBLEMS, strict=True):
        asked = [(one["quantity"], one["answer"], one["tolerance"]) for one in written["quantities"]]
        assert asked == [(one.name, problem.answers[one.name], problem.tolerance(one)) for one in problem.quantities]
