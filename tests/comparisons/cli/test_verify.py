"""``rocking verify`` as a maker of an engine calls it."""

import dataclasses
import json

from comparisons.measuring import agreement, tolerances
from comparisons.report.answer import stored_studies
from comparisons.studies.rows import read_study
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
    words = ("verify", "--engine", "exudyn", "--json", file, "--output", tmp_path / "studies")
    status, out, _ = rocking(*words)
    assert status == 1 and "1 of 2 tolerances hold" in out
    (line,) = [line for line in out.splitlines() if "FAILS" in line]
    assert "held to nothing" in line
    content = json.loads(file.read_text())
    assert content["schema"] == "rocking verify 3" and "exudyn" in content["versions"]["exudyn"]
    assert [row["holds"] for row in content["rows"]] == [True, False]
    assert content["rows"][0]["found"] == content["rows"][1]["found"] > 0
    assert read_study(tmp_path / "studies" / "tolerances").rows == [
        {"part": "tolerance", **row} for row in content["rows"]
    ]
    (shown,) = stored_studies(tmp_path / "studies")
    assert shown.section.title == "Agreement tolerances: 1 of 2 do not hold" and shown.section.age is None


def test_without_a_bound_nothing_holds_or_fails_and_what_was_found_is_said(rocking, monkeypatch, tmp_path):
    free = dataclasses.replace(ROW, bound=None, measured=None)
    lost = dataclasses.replace(free, measure=lambda *_: raised(agreement.Unmeasurable("no impact")))
    words = ("verify", "--engine", "exudyn", "--variant", ROW.variant)
    for rows, status in (((free,), 0), ((free, lost), 1)):
        monkeypatch.setattr(tolerances, "rows", lambda engine, variant, rows=rows: rows)
        ended, out, _ = rocking(*words, "--json", tmp_path / "verify.json", "--output", tmp_path)
        assert ended == status and " hold." not in out and "FAILS" not in out
        assert f"no bound stated, so nothing holds or fails; 1 of {len(rows)} quantities measured." in out
        told = json.loads((tmp_path / "verify.json").read_text())["rows"]
        assert [row["holds"] for row in told] == [None] * len(rows) and told[0]["found"] > 0
        assert [row["holds"] for row in read_study(tmp_path / "tolerances").rows] == [None] * len(rows)
    assert free.check({}) == told[0]["found"]


def raised(error):
    raise error
