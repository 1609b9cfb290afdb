"""``rocking verify`` as a maker of an engine calls it."""

import dataclasses
import json

import pytest

from comparisons import cli
from comparisons.measuring import tolerances
from engines import get_engine

ROW = next(
    row
    for row in tolerances.TABLE
    if (row.engine, row.quantity) == ("exudyn", "peak tilt") and row.variant == get_engine("exudyn").default_variant
)
WRONG = dataclasses.replace(ROW, quantity="peak tilt, held to nothing", bound=1e-12)


@pytest.fixture
def verify(capfd, monkeypatch):
    def call(table, *arguments):
        monkeypatch.setattr(tolerances, "TABLE", table)
        capfd.readouterr()
        with pytest.raises(SystemExit) as end:
            cli.main(["verify", *map(str, arguments)])
        out, err = capfd.readouterr()
        return end.value.code or 0, out, err

    return call


def test_verify_measures_each_row_and_names_the_one_that_fails(verify, tmp_path):
    file = tmp_path / "verify.json"
    status, out, _ = verify((ROW, WRONG), "--engine", "exudyn", "--json", file)
    assert status == 1
    assert "1 of 2 tolerances hold" in out
    (line,) = [line for line in out.splitlines() if "FAILS" in line]
    assert "held to nothing" in line
    content = json.loads(file.read_text())
    assert content["schema"] == "rocking verify 2" and "exudyn" in content["versions"]["exudyn"]
    assert [row["holds"] for row in content["rows"]] == [True, False]
    assert content["rows"][0]["found"] == content["rows"][1]["found"] > 0


def test_a_row_checks_itself_in_the_tests_of_others():
    runs = {}
    assert 0 < ROW.check(runs) <= ROW.bound
    with pytest.raises(AssertionError, match="held to nothing.*tolerated 1e-12"):
        WRONG.check(runs)


def test_rows_are_those_of_the_default_variant_or_the_one_named():
    assert ROW in tolerances.rows("exudyn")
    assert {row.variant for row in tolerances.rows("exudyn", "native-contact")} == {"native-contact"}


@pytest.mark.parametrize(
    "arguments, words",
    [
        (("--engine", "exudyn", "--variant", "none"), "choose among compliant-corners"),
        (("--variant", "compliant-corners"), "name it with --engine"),
    ],
)
def test_what_cannot_be_verified_is_one_message(verify, arguments, words):
    status, _, err = verify((ROW,), *arguments)
    assert status == 2 and words in err
