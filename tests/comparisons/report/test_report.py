"""The report: its pages say what the result files say, and need nothing but themselves."""

import json
import re
from html import unescape
from pathlib import Path
from types import SimpleNamespace
from xml.etree import ElementTree

import numpy as np
import pytest
from page_numbers import number_in

from analytic import EngineNotInstalled, load_scene, simulate, synthetic_motion
from analytic.records import read_record
from comparisons.report import runs, write
from comparisons.report.study import make_results
from comparisons.report.write import write_page
from comparisons.running.provenance import read_result, write_result
from comparisons.showing import parts
from comparisons.showing.parts import Table
from comparisons.studies import get_study
from engines import available_engines, installed_engines

pytestmark = pytest.mark.xdist_group("report")  # one worker: its runs are made once

CUT = 7.0  # s: the free-standing Caryatid overturns within it, the isolated one's outcome is still open
RUNS = "pages/runs.html"
NO_STUDIES = Path(__file__).parent / "no such folder"
DUZCE = Path(__file__).parents[4] / "shared" / "records" / "RSN1605_DUZCE_DZC270.AT2"


def inside(tags, source):
    """What stands between the tags."""
    return re.findall(rf"<(?:{tags})\b[^>]*>(.*?)</(?:{tags})>", source, flags=re.DOTALL)


def words(source):
    return " ".join(unescape(re.sub(r"<[^>]*>", "", source)).split())


class Page:
    """Tables by caption, links, list items and tags of a page."""

    def __init__(self, path):
        self.source = path.read_text(encoding="utf-8")
        body = re.sub(r"<(script|style).*?</\1>", "", self.source, flags=re.DOTALL)
        self.tags = set(re.findall(r"<(\w+)", body))
        self.links = re.findall(r'\s(?:href|src|data|action)="([^"]*)"', body)
        self.items = [words(item) for item in inside("li", body)]
        self.tables = {}
        for table in inside("table", body):
            rows = [[words(cell) for cell in inside("th|td", row)] for row in inside("tr", table)]
            self.tables[words(inside("caption", table)[0])] = rows

    def table(self, caption):
        """{(row, column): cell} of the table whose caption starts so."""
        (rows,) = [rows for title, rows in self.tables.items() if title.startswith(caption)]
        return {(row[0], head): cell for row in rows[1:] for head, cell in zip(rows[0], row, strict=True)}


@pytest.fixture(scope="module")
def folder(copy_of, tmp_path_factory):
    """A report on the synthetic motion, with every engine installed here."""
    folder = copy_of(tmp_path_factory.mktemp("report"))
    write_page(folder, studies=NO_STUDIES)
    return folder


@pytest.fixture
def copied(copy_of, tmp_path):
    """A copy of the result files that a test may change."""
    return copy_of(tmp_path)


def displacement(folder):
    """Peak base displacement of the isolated Caryatid in the analytic model [m], from the result file."""
    (peak,) = [
        row["peak_base_displacement"]
        for row in read_result(folder / runs.SCENES).rows
        if (row["scene"], row["engine"]) == ("caryatid-isolated", "analytic")
    ]
    return peak


def changed(path, change):
    content = json.loads(path.read_text())
    change(content)
    path.write_text(json.dumps(content))


def test_outcomes_in_the_page_are_those_of_the_solvers(folder):
    page = Page(folder / RUNS)
    engines = installed_engines()
    for name in runs.CARYATID:
        scene = load_scene(name)
        expected = simulate(scene)
        table = page.table(f"{scene.name}, until decided")
        assert table["outcome", "analytic"] == expected.outcome
        assert number_in(table["peak |φ|/γ [-]", "analytic"]) == pytest.approx(expected.peak_tilt_ratio, rel=1e-3)
        assert {head for _, head in table} == {"quantity", "analytic", *engines}


def test_every_cell_of_the_outcome_tables_equals_the_result_file(folder):
    page, result = Page(folder / RUNS), read_result(folder / runs.SCENES)
    shown = {
        "overturns at [s]": "overturning_time",
        "peak base displacement [m]": "peak_base_displacement",
        "CPU time [s]": "cpu_seconds",
        "work of the bearings [J]": "bearing_work",
    }
    compared = 0
    for row in result.rows:
        table = page.table(f"{result.settings['scenes'][row['scene']]['name']}, until decided")
        for label, key in shown.items():
            cell = table.get((label, row["engine"]), "–")
            if cell != "–":
                assert number_in(cell) == pytest.approx(row[key], rel=0.05 if key == "cpu_seconds" else 1e-4)
                compared += 1
    assert compared >= 2 * len(result.rows)


def test_histories_in_the_result_file_are_those_of_the_model(folder):
    arrays = read_result(folder / runs.SCENES).arrays
    history = simulate(load_scene("caryatid-isolated")).history
    for column in history.COLUMNS:
        np.testing.assert_array_equal(arrays[f"caryatid-isolated/analytic/{column}"], getattr(history, column))


def test_summary_follows_the_numbers(folder, copied):
    def items():
        return Page(write_page(copied, studies=NO_STUDIES)).items

    rows = [row for row in read_result(copied / runs.SCENES).rows if row["scene"] == "caryatid-rigid"]
    off = [row["engine"] for row in rows if row["differences"]]
    names = [row["engine"] for row in rows]
    solvers = {1: "analytic", 2: "both solvers"}.get(len(rows), f"all {len(rows)} solvers")
    words = (
        f"in {' and '.join(names)} it overturns; {' and '.join(off)} differ" if off else f"in {solvers} it overturns"
    )
    assert any(words in item for item in items())
    assert any("it never lifts" in item and f"{displacement(folder):.4f} m" in item for item in items())

    def analytic_stands(content):
        (row,) = [row for row in content["rows"] if (row["scene"], row["engine"]) == ("caryatid-rigid", "analytic")]
        row.update(outcome="rocks", overturning_time=None)

    changed(copied / runs.SCENES, analytic_stands)
    assert any("in analytic it rocks and stays upright" in item for item in items())


def test_every_number_of_the_decision_table_is_that_of_a_study(copied, studies):
    page = Page(write_page(copied, studies))
    best = page.table("Engines at their best settings")
    summaries = [row for row in read_result(studies / "restitution.json").rows if row.get("scope") == "all"]
    checked = 0
    for (name, head), cell in best.items():
        key = {"restitution error, rms": "rms", "CPU s per simulated s": "cpu_per_second"}.get(head)
        if key:
            rows = [row for row in summaries if f"{row['engine']}, {row['variant']}" == name]
            assert number_in(cell) == pytest.approx(max(row[key] for row in rows), rel=0.06)
            checked += 1
    assert checked >= 8
    marks = get_study("stability").judgements(read_result(studies / "stability.json"))[0].marks
    for name in {name for name, _ in best}:
        known = marks.get(tuple(name.split(", ")))
        assert best[name, "hard cases right"] == (known.words if known else "not tested")
    assert "Engines at their best settings" not in Page(write_page(copied, studies=NO_STUDIES)).tables


def test_pages_need_nothing_but_themselves(folder):
    for file in (folder / "report.html", *(folder / "pages").glob("*.html")):
        page = Page(file)
        assert all(link.startswith(("#", "pages/", "../report.html", "../pages/")) for link in page.links)
        assert not {"link", "iframe", "object", "img"} & page.tags
        assert not re.search(r"@import|src=|url\((?!#)", page.source)
        assert set(re.findall(r"https?://[^\"']*", page.source)) <= {
            "http://www.w3.org/2000/svg",
            "http://www.w3.org/1999/xlink",
        }
        anchors = set(re.findall(r' id="([^"]+)"', page.source))
        assert {link[1:] for link in page.links if link.startswith("#") and link != "#"} <= anchors
        assert len(anchors) == len(re.findall(r' id="', page.source))
        assert all((file.parent / link).exists() for link in page.links if ".html" in link)


def test_every_picture_is_drawn_of_text_and_has_words_for_those_who_cannot_see_it(folder):
    pictures = re.findall(r'<svg class="(chart|drawn)"[^>]*aria-label="([^"]*)"', (folder / "report.html").read_text())
    assert len(pictures) >= 4 and all(len(words) > 30 for _, words in pictures)
    runs_page = (folder / RUNS).read_text()
    drawn = re.findall(r'<svg class="drawn".*?</svg>', runs_page, flags=re.DOTALL)
    assert len(drawn) == 5
    for picture in drawn:
        root = ElementTree.fromstring(picture.replace("xlink:href", "href"))
        assert root.get("role") == "img" and len(root.get("aria-label")) > 40
        assert len(list(root.iter("text"))) > 4  # lettering is text, to be found and read aloud


def test_synthetic_motion_is_named_so(folder):
    page = Page(folder / "report.html")
    title = re.search("<title>(.*?)</title>", page.source).group(1)
    assert "synthetic" in title
    assert page.source.count("synthetic duzce-like motion") == 2  # title, earthquake
    assert (folder / RUNS).read_text().count("synthetic duzce-like motion") >= 4


def test_no_path_of_this_machine_and_no_leftovers(folder):
    names = {file.name for file in folder.iterdir()}
    assert names == {"scenes.json", "scenes.npz", "pages", "report.html"}
    assert str(Path(__file__).parents[3]) not in (folder / "report.html").read_text()


def test_equal_result_files_give_equal_pages(folder, copied, monkeypatch):
    monkeypatch.setattr(write, "age", lambda result: None)  # the code may be edited meanwhile
    for one in (folder, copied):
        write_page(one, studies=NO_STUDIES)
    for name in ("report.html", RUNS):
        assert (folder / name).read_bytes() == (copied / name).read_bytes()


def test_missing_engines_are_named_with_their_remedy(tmp_path, monkeypatch):
    def nothing_installed(name):
        raise EngineNotInstalled(f"engine {name!r} needs the package {name}: install it so")

    monkeypatch.setattr("engines.get_engine", nothing_installed)
    make_results(tmp_path, synthetic_motion(), duration=CUT)
    page, all_of_it = Page(write_page(tmp_path, studies=NO_STUDIES)), Page(tmp_path / RUNS)
    assert any(
        "Not in this report: engine 'pybullet' needs the package pybullet: install it so" in item for item in page.items
    )
    assert all_of_it.table("Caryatid on rigid ground, 7 s")["outcome", "analytic"] == "overturns"
    assert all_of_it.table("Caryatid isolated, 7 s")["outcome", "analytic"] == "undecided (stands so far)"
    assert any("in analytic it is undecided (stands so far)" in item for item in page.items)


def test_a_failed_run_shows_its_evidence(folder, copied):
    def fail(content):
        row = content["rows"][-1]
        row.update(outcome="failed", failure={"kind": "crash", "reason": "the worker ended", "message": "<SIGSEGV>"})
        row.pop("agreement", None)

    changed(copied / runs.SCENES, fail)
    page = Page(write_page(copied, studies=NO_STUDIES))
    assert any(item.startswith("Failed runs:") and "the worker ended" in item for item in page.items)
    assert "<pre>&lt;SIGSEGV&gt;</pre>" in page.source


def test_a_study_is_shown_by_its_own_page_and_says_when_it_is_old(folder, copied, tmp_path_factory, monkeypatch):
    studies = tmp_path_factory.mktemp("results")
    file = write_result(studies / "fake.json", "fake", {}, [{"kappa": 0.75}], modules=["analytic.errors"])
    write_page(copied, studies=studies)
    assert "fake.json cannot be shown: unknown study" in (copied / "pages/fake.html").read_text()
    tables = [Table(name, ("solver", "kappa [-]"), [["exudyn", "0.75"]]) for name in ("Agreement", "All of it")]
    shown = parts.Page("A fake study: agrees", ("Two paragraphs < one.",), tuple(tables[:1]), tuple(tables[1:]))
    study = SimpleNamespace(page=lambda result: shown, judgements=lambda result: ())
    monkeypatch.setattr("comparisons.report.studies.get_study", lambda kind: study)
    path = write_page(copied, studies=studies)
    for page in (Page(path), Page(copied / "pages/fake.html")):
        assert page.table("Agreement")["exudyn", "kappa [-]"] == "0.75"
        assert "Two paragraphs &lt; one." in page.source
    assert "All of it" in (copied / "pages/fake.html").read_text() and "All of it" not in path.read_text()
    assert "pages/fake.html" in Page(path).links
    warnings = path.read_text().count("Out of date")
    changed(file, lambda content: content["provenance"]["sources"].update({"analytic.errors": "another"}))
    assert write_page(copied, studies=studies).read_text().count("Out of date") == warnings + 1


def test_undecided_outcomes_and_warnings_stand_beside_the_outcomes_and_at_the_top(copied):
    def cut(content):
        for row in content["rows"]:
            if row["scene"] == "caryatid-rigid":
                row.update(
                    outcome="rocks",
                    overturning_time=None,
                    decided=False,
                    verdict="undecided (rocks so far)",
                    warnings=[{"kind": "record", "text": "the record peaks at 5 g"}],
                    differences=[],
                )
        content["rows"][-1]["warnings"] = [{"kind": "model", "text": "the base is light"}]

    changed(copied / runs.SCENES, cut)
    top, page = Page(write_page(copied, studies=NO_STUDIES)), Page(copied / RUNS)
    last = read_result(copied / runs.SCENES).rows[-1]["engine"]
    free, isolated = (page.table(f"Caryatid {name}, until decided") for name in ("on rigid ground", "isolated"))
    assert free["outcome", "analytic"] == "undecided (rocks so far)" and free["warnings [-]", "analytic"] == "1"
    assert isolated["warnings [-]", "analytic"] == "none" and isolated["warnings [-]", last] == "1"
    words = "outside what is modelled, or differing"
    assert page.table("Caryatid isolated: warnings")[last, words] == "the base is light"
    assert any("it is undecided (rocks so far). Warning: the record peaks at 5 g." in item for item in top.items)


@pytest.mark.skipif(not DUZCE.exists(), reason="the Duzce record does not lie beside the project")
def test_duzce_record_overturns_the_free_caryatid_and_not_the_isolated_one(tmp_path):
    make_results(tmp_path, read_record(DUZCE))
    write_page(tmp_path, studies=NO_STUDIES)
    page = Page(tmp_path / RUNS)
    free, isolated = (page.table(f"Caryatid {name}, until decided") for name in ("on rigid ground", "isolated"))
    for solver in {"analytic", "exudyn", "pybullet"} - set(available_engines()[1]):
        assert free["outcome", solver] == "overturns"
        assert 6 < number_in(free["overturns at [s]", solver]) < 9
        assert isolated["outcome", solver] == "stands"
        assert number_in(isolated["peak base displacement [m]", solver]) == pytest.approx(0.212, rel=0.01)
