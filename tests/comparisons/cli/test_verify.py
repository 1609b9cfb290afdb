"""``rocking verify`` as a maker of an engine calls it."""

import dataclasses
import json

from comparisons.measuring import tolerances
from engines import get_engine

ROW = next(
    row
    for row in tolerances.TABLE
    if (row.engine, row.quantity) == ("exudyn", "peak tilt") and row.variant == get_engine("exudyn").default_variant
)
WRONG = dataclasses.replace(ROW, quantity="peak tilt, held to nothing", bound=1e-12)


def test_verify_measures_each_row_and_names_the_one_that_fails(rocking, monkeypatch, tmp_path):
    monkeypatch.setattr(tolerances, "TABLE", (ROW, WRONG))
    file = tmp_path / "verify.json"
    status, out, _ = rocking("verify", "--engine", "exudyn", "--json", file)
    assert status == 1 and "1 of 2 tolerances hold" in out
    (line,) = [line for line in out.splitlines() if "FAILS" in line]
    assert "held to nothing" in line
    content = json.loads(file.read_text())
    assert content["schema"] == "rocking verify 2" and "exudyn" in content["versions"]["exudyn"]
    assert [row["holds"] for row in content["rows"]] == [True, False]
    assert content["rows"][0]["found"] == content["rows"][1]["found"] > 0
