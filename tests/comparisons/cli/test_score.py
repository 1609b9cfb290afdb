"""``rocking sheet`` and ``rocking score`` as a maker of another code calls them."""

import json

from sheet_solver import solve

from comparisons.sheet.problems import PROBLEMS


def test_answers_are_scored_and_kept(rocking, tmp_path):
    status, out, _ = rocking("sheet", "--output", tmp_path / "sheet")
    assert status == 0 and "answers.csv" in out
    file = tmp_path / "sheet" / "answers.csv"
    problem = PROBLEMS[0]
    right = solve(problem.name, problem.times)
    lines = [f"{problem.name},{one.name},{right[one.name]}" for one in problem.quantities]
    file.write_text("# mine\nscene,quantity,value\n" + "\n".join(lines) + "\nhard,outcome,\n")
    status, out, _ = rocking("score", file, "--json", tmp_path / "score.json")
    assert status == 0 and "1 of 1 scenes answered within" in out
    content = json.loads((tmp_path / "score.json").read_text())
    assert content["schema"] == "rocking score 2" and content["scenes"][0]["scene"] == "free-rigid"
    _, out, _ = rocking("sheet", "--output", tmp_path / "sheet", "--json", "-")
    asked = json.loads(out)["problems"][0]["quantities"]
    assert [(one["quantity"], one["scale"]) for one in asked] == [
        (one.name, problem.scale(one)) for one in problem.quantities
    ]
    assert file.read_text().startswith("# mine")  # no sheet overwrites answers


def test_wrong_answers_are_status_1_with_a_cause(rocking, tmp_path):
    file = tmp_path / "answers.csv"
    problem = PROBLEMS[1]
    wrong = solve(problem.name, problem.times, printed8=True)
    lines = [f"{problem.name},{one.name},{wrong[one.name]}" for one in problem.quantities]
    file.write_text("scene,quantity,value\n" + "\n".join(lines) + "\n")
    status, out, _ = rocking("score", file)
    assert out.startswith(f"First wrong answer: {problem.name}, ")
    assert status == 1 and "eq. (8) as printed" in out and "factor R cos" in out
