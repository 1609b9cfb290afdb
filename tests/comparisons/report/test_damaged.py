"""A damaged study result is one line, in --replot and in the report, which goes on; no changed number is shown."""

import json
import re
import shutil
from html import unescape

import pytest
from answered import edit
from mutated_results import damaged, resealed

from comparisons.report.answer import stored_studies
from comparisons.report.detail import write_study
from comparisons.report.write import write_page
from comparisons.running.provenance import RESULTS, ResultError
from comparisons.studies import get_study

SOLVERS = {"restitution": "exudyn", "overturning": "analytic", "sensitivity": "exudyn"}  # whose file is damaged
SEED = 52
DAMAGED, RESEALED = 8, 6  # mutations of each here; with 300 and 60 it holds as well


def placed(folder, name, text, arrays):
    """A study's result in a folder, one solver's file with these contents."""
    path = shutil.copytree(RESULTS / name, folder / name, dirs_exist_ok=True)
    file = path / f"{SOLVERS[name]}.json"
    file.write_bytes(text)
    file.with_suffix(".npz").unlink(missing_ok=True)
    if arrays is not None:
        file.with_suffix(".npz").write_bytes(arrays)
    return path


def refused(name, path, into):
    """Whether the page of a result is refused in one line, alone and in a report."""
    [shown] = stored_studies(path.parent)
    try:
        write_study(get_study(name), path, into)
    except ResultError as error:
        assert name in str(error) and "\n" not in str(error)
        [line] = shown.section.text
        assert line.startswith(f"{name} cannot be shown: ") and "\n" not in line
        assert not shown.judgements and shown.finding is None
        return True
    assert "cannot be shown" not in " ".join(shown.section.text)
    return False


@pytest.mark.parametrize("name", SOLVERS)
def test_a_damaged_result_is_one_line_and_what_is_shown_is_as_it_was(tmp_path, name):
    whole, seen = RESULTS / name / f"{SOLVERS[name]}.json", 0
    for what, text, arrays in damaged(whole, SEED, DAMAGED):
        path = placed(tmp_path, name, text, arrays)
        if refused(name, path, tmp_path / "pages"):
            seen += 1
        else:
            assert repr(json.loads(text)) == repr(json.loads(whole.read_bytes())), what
            assert arrays == whole.with_suffix(".npz").read_bytes(), what
    assert seen > 0.8 * DAMAGED


@pytest.mark.parametrize("name", SOLVERS)
def test_one_whose_digest_is_made_anew_is_shown_or_one_line(tmp_path, name):
    found = [
        refused(name, placed(tmp_path, name, text, arrays), tmp_path / "pages")
        for _, text, arrays in resealed(RESULTS / name / f"{SOLVERS[name]}.json", SEED, RESEALED)
    ]
    assert sum(found) > 0.4 * RESEALED  # a digit changed so cannot be seen


@pytest.mark.parametrize("change", [{"variants": 3}, {"variants": ["step"]}, {"variants": [{"variant": []}]}])
def test_settings_of_a_wrong_type_are_one_line(tmp_path, change):
    path = shutil.copytree(RESULTS / "restitution", tmp_path / "restitution")
    edit(path / "exudyn.json", lambda content: content["settings"].update(change))
    assert refused("restitution", path, tmp_path / "pages")


def without_settings(folder):
    """The result of mistakes in a folder, its files without their settings."""
    path = shutil.copytree(RESULTS / "mistakes", folder / "mistakes")
    for file in path.glob("*.json"):
        edit(file, lambda content: content["settings"].clear())
    return path


@pytest.mark.xdist_group("report")
def test_a_report_goes_on_beside_damaged_results(copy_of, studies, tmp_path):
    folder, shown = tmp_path / "studies", tmp_path / "report"
    shutil.copytree(studies, folder)
    copy_of(shown)
    cut = folder / "restitution" / "exudyn.json"
    cut.write_bytes(cut.read_bytes()[:-1000])
    (folder / "sensitivity" / "exudyn.npz").write_bytes(b"")
    shutil.copytree(RESULTS / "mistakes", folder / "statues")
    without_settings(folder)
    write_page(shown, folder)
    pages = {
        file.stem: unescape(re.sub("<[^>]*>", "", file.read_text(encoding="utf-8")))
        for file in (shown / "pages").glob("*.html")
    }
    opening = unescape(re.sub("<[^>]*>", "", (shown / "report.html").read_text(encoding="utf-8")))
    for name, words in {
        "restitution": "restitution/exudyn.json: not JSON",
        "sensitivity": "sensitivity/exudyn.npz: missing or not the one exudyn.json was written with",
        "statues": "a result of mistakes; call its folder mistakes",
        "mistakes": "its page fails (KeyError(",
    }.items():
        assert f"{name} cannot be shown: {words}" in pages[name]
        assert f"Missing here: {name} cannot be shown: {words}" in opening
    assert {name for name, text in pages.items() if "cannot be shown" not in text} == {"runs", "stability"}


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
