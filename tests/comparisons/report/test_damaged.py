"""A damaged study result is one line, in --replot and in the report, which goes on; no changed number is shown."""

import re
import shutil
from html import unescape

import pytest
from answered import edit
from drawn import ROWS, made

from comparisons.execution.results import RESULTS, ResultError
from comparisons.report.answer import stored_studies
from comparisons.report.detail import write_study
from comparisons.report.write import write_page
from comparisons.studies import get_study

NAME = "sensitivity"


def cut(path):
    path.write_bytes(path.read_bytes()[:-1000])


def digit(path):
    """Another number in a row, under the digest of what it was."""
    path.write_text(re.sub(r'("failed": )\d', r"\g<1>7", path.read_text(), count=1))


def without_settings(folder):
    """The result of mistakes in a folder, its files without their settings."""
    path = shutil.copytree(RESULTS / "mistakes", folder / "mistakes")
    for file in path.glob("*.json"):
        edit(file, lambda content: content["settings"].clear())
    return path


def changed(how):
    return lambda path: edit(path, how)


DAMAGES = {
    "cut": cut,
    "digit": digit,
    "no arrays": lambda path: path.with_name("analytic.npz").write_bytes(b""),
    "another's arrays": lambda path: shutil.copy(
        RESULTS / "fragility" / "analytic.npz", path.with_name("analytic.npz")
    ),
    "no row's column": changed(lambda content: content["rows"][0].pop("failed")),
    "a column too many": changed(lambda content: content["rows"][0].update(failed2=0)),
    "a text for a number": changed(lambda content: content["rows"][0].update(failed="x")),
    "no rows": changed(lambda content: content.pop("rows")),
    "settings of a wrong type": changed(lambda content: content["settings"].update(default_variants=3)),
    "no settings": changed(lambda content: content["settings"].clear()),
}


@pytest.mark.parametrize("damage", DAMAGES)
def test_a_damaged_result_is_refused_in_one_line_alone_and_in_a_report(tmp_path, damage):
    path = shutil.copytree(RESULTS / NAME, tmp_path / NAME)
    DAMAGES[damage](path / "exudyn.json")
    with pytest.raises(ResultError) as error:
        write_study(get_study(NAME), path, tmp_path / "pages")
    assert NAME in str(error.value) and "\n" not in str(error.value)
    [shown] = stored_studies(path.parent)
    [line] = shown.section.text
    assert line.startswith(f"{NAME} cannot be shown: ") and "\n" not in line
    assert not shown.judgements and shown.finding is None


def test_a_report_goes_on_beside_damaged_results(tmp_path, monkeypatch):
    monkeypatch.setattr("comparisons.report.write.read_result", made)
    report, studies = shutil.copytree(ROWS / "own", tmp_path / "report"), tmp_path / "studies"
    for name, place in (("restitution",) * 2, (NAME,) * 2, ("tolerances", "statues")):
        shutil.copytree(RESULTS / name, studies / place)
    cut(studies / "restitution" / "exudyn.json")
    without_settings(studies)
    opening = unescape(re.sub("<[^>]*>", "", write_page(report, studies).read_text(encoding="utf-8")))
    for name, words in {
        "restitution": "restitution/exudyn.json: not JSON",
        "statues": "a result of tolerances; call its folder tolerances",
        "mistakes": "its page fails (KeyError(",
    }.items():
        page = unescape(re.sub("<[^>]*>", "", (report / f"pages/{name}.html").read_text(encoding="utf-8")))
        assert f"{name} cannot be shown: {words}" in page
        assert f"Missing here: {name} cannot be shown: {words}" in opening
    assert "cannot be shown" not in (report / f"pages/{NAME}.html").read_text(encoding="utf-8")


def test_a_page_that_fails_on_a_result_of_the_code_of_today_is_no_damage(tmp_path, monkeypatch):
    """Nobody is told to mend a result where the page itself is wrong."""
    path = without_settings(tmp_path)
    monkeypatch.setattr("comparisons.report.detail.age", lambda result: "older than the code")
    words = r"mistakes: its page cannot be drawn \(KeyError\(.*\); it is older than the code; run rocking study mis"
    with pytest.raises(ResultError, match=words):
        write_study(get_study("mistakes"), path, tmp_path)
    monkeypatch.setattr("comparisons.report.detail.age", lambda result: None)
    with pytest.raises(KeyError):
        write_study(get_study("mistakes"), path, tmp_path)
