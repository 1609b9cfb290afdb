"""The stored results: all can be shown, README shows and says what they do, and each says where it comes from."""

import json
from xml.etree import ElementTree

import pytest

from analytic import EngineNotInstalled
from comparisons.execution.by_solver import read, results_in
from comparisons.execution.results import RESULTS
from comparisons.report.answer import stored_studies
from comparisons.report.gallery import (
    CLAIMED,
    CLAIMS,
    GALLERY,
    README,
    RESULTS_README,
    claims,
    first_screen,
    gallery,
    headlines,
    origins,
    with_findings,
)
from engines import ENGINES
from engines.contract import Engine

pytestmark = pytest.mark.xdist_group("stored")  # they are shown once


@pytest.fixture(scope="module")
def studies():
    """The stored studies as they are shown where no engine is installed."""

    def missing(self):
        raise EngineNotInstalled(f"{self.name} is not installed")

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Engine, "load", missing)
        return stored_studies()


@pytest.mark.slow
def test_every_stored_result_can_be_shown_without_any_engine(studies):
    assert [study.name for study in studies if study.wrong] == []
    assert {study.name for study in studies} == {path.name for path in results_in(RESULTS)}


@pytest.mark.slow
def test_the_readme_shows_and_says_what_the_stored_results_do(studies):
    first, readme = first_screen(studies), README.read_text(encoding="utf-8")
    made, words = gallery(first), headlines(first)
    assert {file.name: file.read_text(encoding="utf-8") for file in GALLERY.iterdir()} == made and len(made) == 2
    for name, svg in made.items():
        assert f"comparisons/report/gallery/{name}" in readme and ElementTree.fromstring(svg).get("aria-label")
        assert "prefers-color-scheme" in svg and "http://" not in svg.replace("http://www.w3.org", "")
    assert words in readme and with_findings(readme, words) == readme != with_findings(readme, "- something else")
    results = {path.name: read(path) for path in results_in(RESULTS)}
    assert with_findings(readme, claims(studies, results), CLAIMED) == readme
    counted = {name: results[name].run_count for _, name, *_ in CLAIMS}
    assert all(f"| {runs} | " in readme for runs in counted.values()) and min(counted.values()) > 0


def test_the_readme_of_the_results_says_where_each_of_them_comes_from():
    folders, readme = results_in(RESULTS), RESULTS_README.read_text(encoding="utf-8")
    table = origins({path.name: read(path) for path in folders})
    assert readme == with_findings(readme, table)
    lines = {line.split("`")[1]: line for line in table.splitlines()[2:]}
    assert list(lines) == [path.name for path in folders]
    for path in folders:  # as the files themselves have it
        line, contents = lines[path.name], [json.loads(file.read_text()) for file in path.glob("*.json")]
        engines = {str(row.get("engine")) for content in contents for row in content["rows"]}
        assert {name for name in ENGINES if name in line} == ENGINES.keys() & engines
        for origin in (content["provenance"] for content in contents):
            assert all(words in line for words in (origin["time"][:10], origin["machine"]["processor"]))
            assert origin["commit"][:12] + ", with uncommitted changes" * origin["dirty"] in line
        if checks := [check for content in contents if (check := content["provenance"].get("check"))]:
            held, runs = (sum(check[name] for check in checks) for name in ("held", "runs"))
            assert f"| {held} of {runs}, {min(check['date'] for check in checks)} |" in line
