"""``rocking sheet`` and ``rocking score`` as a maker of another code calls them."""

import json

from sheet_solver import solve

from comparisons.sheet.problems import PROBLEMS


def answers(problem, folder, more="", **how):
    """A file of answers to a problem, as the second solver gives them."""
    found = solve(problem.name, problem.times, **how)
    lines = [f"{problem.name},{one.name},{found[one.name]}" for one in problem.quantities]
    (folder / "answers.csv").write_text("# mine\nscene,quantity,value\n" + "\n".join(lines) + f"\n{more}")
    return folder / "answers.csv"


def test_answers_are_scored_and_kept(rocking, tmp_path):
    status, out, _ = rocking("sheet", "--output", tmp_path)
    assert status == 0 and "answers.csv" in out
    file, problem = answers(PROBLEMS[0], tmp_path, "hard,outcome,\n"), PROBLEMS[0]
    status, out, _ = rocking("score", file, "--json", tmp_path / "score.json")
    assert status == 0 and "1 of 1 scenes answered within" in out
    content = json.loads((tmp_path / "score.json").read_text())
    assert content["schema"] == "rocking score 2" and content["scenes"][0]["scene"] == "free-rigid"
    _, out, _ = rocking("sheet", "--output", tmp_path, "--json", "-")
    asked = json.loads(out)["problems"][0]["quantities"]
    assert [(one["quantity"], one["scale"]) for one in asked] == [
        (one.name, problem.scale(one)) for one in problem.quantities
    ]
    assert file.read_text().startswith("# mine")  # no sheet overwrites answers


def test_wrong_answers_are_status_1_with_a_cause(rocking, tmp_path):
    status, out, _ = rocking("score", answers(PROBLEMS[1], tmp_path, printed8=True))
    assert out.startswith(f"First wrong answer: {PROBLEMS[1].name}, ")
    assert status == 1 and "eq. (8) as printed" in out and "factor R cos" in out
