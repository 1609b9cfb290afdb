"""The files of the problem sheet: complete for a reader who has another code."""

import re

import numpy as np
import pytest

from comparisons.sheet.pages import markdown, write_sheet
from comparisons.sheet.problems import PROBLEMS, UNITS


@pytest.fixture(scope="module")
def sheet(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sheet")
    write_sheet(folder)
    return folder


def test_pages_say_all_that_is_asked_with_answers_and_nothing_of_our_code(sheet):
    for problem in PROBLEMS:
        text, page = markdown(problem), (sheet / f"{problem.name}.html").read_text()
        assert not re.search(r"python|kernel|exudyn|analytic|comparisons|rocking (sheet|run)", text, re.IGNORECASE)
        for one in problem.quantities:
            assert re.search(rf"\| {re.escape(one.name)} \|.*\| {re.escape(str(problem.answers[one.name]))} \|", text)
            assert f">{one.name}<" in page
        assert not re.search(r"\de[-+]?\d|\b[^\W\d_]_[^\W_]\b", page)  # indices and powers as one writes them
    samples = np.loadtxt(sheet / "inputs" / "record.csv", delimiter=",", skiprows=1)[:, 1]
    motion = next(one.scene.motion for one in PROBLEMS if one.name == "record")
    assert samples.tolist() == motion.samples.tolist()


def test_the_table_of_answers_holds_each_of_each_page(sheet):
    head, *lines = (sheet / "reference.csv").read_text().splitlines()
    assert head == "scene,quantity,unit,answer,tolerance"
    expected = [
        [problem.name, one.name, UNITS[one.kind], str(problem.answers[one.name]), str(problem.tolerance(one) or "")]
        for problem in PROBLEMS
        for one in problem.quantities
    ]
    assert [line.split(",") for line in lines] == expected
