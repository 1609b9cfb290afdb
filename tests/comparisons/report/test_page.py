"""The page's own words: the age of a section where it is closed, and marks that need no colour."""

import html
import re
import shutil

import pytest

from analytic import load_scene
from comparisons.report import answer
from comparisons.report.study import make_own_results
from comparisons.report.write import write_page
from comparisons.running.provenance import RESULTS
from comparisons.showing.parts import SIGNS

OLD = "sensitivity"


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """The file of a page with no engine's run of its own; one of its studies is made old."""
    folder, studies = tmp_path_factory.mktemp("page"), tmp_path_factory.mktemp("studies")
    for name in ("restitution", OLD, "recorded"):
        shutil.copytree(RESULTS / name, studies / name)
    make_own_results(folder, {"block": load_scene("free-rocking-rigid")}, engines=[])
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(answer, "age", lambda result: "older than the code: ..." if result.kind == OLD else None)
        return write_page(folder, studies)


@pytest.fixture(scope="module")
def page(written):
    return written.read_text(encoding="utf-8")


def test_a_section_that_is_old_says_so_in_its_closed_heading_and_in_the_index(page):
    summaries = re.findall(r"<summary><h2>(.*?)</h2></summary>", page, re.DOTALL)
    old = [heading for heading in summaries if "older than the code" in heading]
    assert len(old) == 1 and old[0].startswith("What matters more than the engine")
    index = re.search(r'<nav aria-label="Contents">(.*?)</nav>', page, re.DOTALL)[1]
    links = dict(re.findall(r'<a href="#([\w-]+)">(.*?)</a>', index, re.DOTALL))
    assert [anchor for anchor, words in links.items() if "(older than the code)" in words] == [OLD]


def test_every_entry_of_the_index_leads_to_its_place_and_why_engines_err_to_the_page_of_the_impact(page, written):
    index = re.search(r'<nav aria-label="Contents">(.*?)</nav>', page, re.DOTALL)[1]
    links = re.findall(r'<a href="#([\w-]+)">\s*(.*?)\s*</a>', index, re.DOTALL)
    assert all(page.count(f' id="{anchor}"') == 1 for anchor, _ in links)
    assert ("autopsy", "Why engines err") in links  # the place that it had as a study of its own
    impact = re.search(r'<section id="impact">(.*?)</section>', page, re.DOTALL)[1]
    (to,) = re.findall(r'<a href="(pages/[^"]*#[^"]*)">Why engines err', impact[impact.index('id="autopsy"') :])
    file, _, place = to.partition("#")
    assert f' id="{place}">Why engines err: ' in (written.parent / file).read_text(encoding="utf-8")


def test_every_cell_of_the_first_tables_has_its_sign_and_the_legend_says_what_it_means(page):
    legend = html.unescape(re.sub("<[^>]*>", "", re.search(r'<p class="legend">(.*?)</p>', page)[1]))
    cells = [
        (level, html.unescape(re.sub("<[^>]*>", "", re.split("<br>", cell)[0])).strip())
        for table in re.findall(r'<table class="answers">(.*?)</table>', page, re.DOTALL)
        for level, cell in re.findall(r'<td class="(\w+)">(.*?)</td>', table, re.DOTALL)
    ]
    assert {level for level, _ in cells} == {"good", "fair", "bad", "part", "none"} and len(cells) > 40
    rated = ("✓ trust", "✓ as far as tested", "~ with care", "✗ do not trust")
    for level, words in cells:
        sign, meaning = SIGNS[level]
        assert words.endswith(f"\u00a0{sign}") or words.startswith(rated), words
        assert f"{sign}\u00a0{meaning}" in legend
