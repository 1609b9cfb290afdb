"""The report: its pages say what the result files say, and need nothing but themselves."""

import re
from html import unescape
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from answered import edit
from page_numbers import number_in

from analytic import EngineNotInstalled, load_scene, simulate, synthetic_motion
from comparisons.report import runs, write
from comparisons.report.study import make_results
from comparisons.report.write import write_page
from comparisons.running.by_solver import read
from comparisons.running.provenance import read_result, write_result
from comparisons.showing import parts
from comparisons.showing.parts import Table, where
from comparisons.showing.wording import listed
from comparisons.studies import get_study
from engines import installed_engines

pytestmark = pytest.mark.xdist_group("report")  # one worker: its runs are made once

CUT = 7.0  # s: the free-standing Caryatid overturns within it, the isolated one's outcome is still open
RUNS = "pages/runs.html"
NO_STUDIES = Path(__file__).parent / "no such folder"


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


def test_the_outcome_tables_say_what_the_result_file_says_and_that_is_the_models(folder):
    page, result = Page(folder / RUNS), read_result(folder / runs.SCENES)
    shown = {
        "overturns at [s]": ("overturning_time", 1e-4),
        "peak |φ|/γ [-]": ("peak_tilt_ratio", 1e-3),
        "peak base displacement [m]": ("peak_base_displacement", 1e-4),
        "CPU time [s]": ("cpu_seconds", 0.05),
        "work of the bearings [J]": ("bearing_work", 1e-4),
    }
    compared = 0
    for row in result.rows:
        table = page.table(f"{result.settings['scenes'][row['scene']]['name']}, until decided")
        assert {head for _, head in table} == {"quantity", "analytic", *installed_engines()}
        cells = {label: table.get((label, row["engine"]), "–") for label in shown}
        for key, within, cell in ((*shown[label], cell) for label, cell in cells.items() if cell != "–"):
            assert number_in(cell) == pytest.approx(row[key], rel=within)
            compared += 1
        if row["engine"] == "analytic":
            expected = simulate(load_scene(row["scene"]))
            assert (row["outcome"], row["peak_tilt_ratio"]) == (expected.outcome, expected.peak_tilt_ratio)
            assert table["outcome", "analytic"] == expected.outcome
    assert compared >= 2 * len(result.rows)


def test_histories_in_the_result_file_are_those_of_the_model(folder):
    arrays = read_result(folder / runs.SCENES).arrays
    history = simulate(load_scene("caryatid-isolated")).history
    for column in history.COLUMNS:
        np.testing.assert_array_equal(arrays[f"caryatid-isolated/analytic/{column}"], getattr(history, column))


def test_summary_follows_the_numbers(copied):
    def items():
        return " ".join(Page(write_page(copied, studies=NO_STUDIES)).items)

    def analytic_stands(content):
        content["rows"][0].update(outcome="rocks", overturning_time=None)

    rows = read_result(copied / runs.SCENES).rows
    free, isolated = ([row for row in rows if row["scene"] == name] for name in runs.CARYATID)
    names, off = [row["engine"] for row in free], [row["engine"] for row in free if row["differences"]]
    solvers = {1: "analytic", 2: "both solvers"}.get(len(names), f"all {len(names)} solvers")
    words = f"in {solvers} it overturns" + f"; {listed(off)} differ" * bool(off)
    found = items()
    assert words in found
    assert "it never lifts" in found
    assert f"the base moves by at most {isolated[0]['peak_base_displacement']:.4f} m" in found  # the model's
    edit(copied / runs.SCENES, analytic_stands)
    assert "in analytic it rocks and stays upright" in items()


def test_outside_the_range_no_engine_is_recommended(copied, studies):
    def warn(content):
        row = next(row for row in content["rows"] if row.get("engine") == "exudyn")
        row["warnings"] = [
            {"kind": "engine", "quantity": "radius", "text": "R 20 is outside", "value": 20, "limit": 10}
        ]

    words = "No engine is recommended here: R 20 is outside."
    assert words not in write_page(copied, studies).read_text()
    edit(copied / runs.SCENES, warn)
    assert words in write_page(copied, studies).read_text()


def test_every_number_of_the_first_table_is_that_of_a_study(copied, studies):
    page = Page(write_page(copied, studies))
    found = page.table("With counts") | page.table("All tests of the others")
    summaries = where(read(studies / "restitution").rows, scope="all")
    marks = get_study("stability").judgements(read(studies / "stability"))[0].marks
    columns = {column for _, column in found if column != "engine"}
    (heading,) = {row for row, _ in found if row.startswith("error of restitution by states (")}
    names = {(row["engine"], row["variant"]) for row in summaries}
    assert len(names) == len(columns) >= 4
    for engine, variant in names:
        (column,) = (
            column
            for column in columns
            if column.startswith(f"{engine}, ") and column.split(" ")[2].rstrip(":") == variant
        )
        rows = where(summaries, engine=engine, variant=variant)
        cell = found[heading, column]
        assert number_in(cell.partition(" (")[0]) == pytest.approx(max(row["rms_state"] for row in rows), rel=0.06)
        for key, words in (("failed", "failed"), ("lost", "missed")):
            count = sum(row[key] for row in rows)
            assert bool(re.search(rf"[(, ]{count} {words}[,)]", cell)) == (count > 0)
        known = marks.get((engine, variant))
        assert found["hard cases right", column].startswith(known.words if known else "not tested")
    brief = page.table("All tests of the engines")
    assert all(found[row, column].startswith(cell) for (row, column), cell in brief.items() if column != "engine")
    assert "All tests of the engines" not in " ".join(Page(write_page(copied, studies=NO_STUDIES)).tables)


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
    for file, least in ((folder / "report.html", 4), (folder / RUNS, 8)):
        drawn = re.findall(r'<svg class="(?:chart|drawn)" .*?</svg>(?:.*?</svg>)?', file.read_text(), flags=re.DOTALL)
        named = [words for picture in drawn for words in re.findall('role="img" aria-label="([^"]*)"', picture)]
        assert len(named) >= least and all(len(words) > 30 for words in named)
        assert all("<text" in picture for picture in drawn if 'role="img"' in picture)  # to be found and read aloud


def test_figures_of_the_runs_say_how_far_the_engines_are_apart(folder):
    page, result = (folder / RUNS).read_text(), read_result(folder / runs.SCENES)
    for name, column, label, scale in (
        ("caryatid-rigid", "tilt", "tilt φ/γ [-]", load_scene("caryatid-rigid").block.slenderness),
        ("caryatid-isolated", "base_displacement", "base displacement x [m]", 1.0),
    ):
        largest = re.search(rf"analytic model in {re.escape(label)}; largest: (.*?)\.[ <\"]", page)[1]
        found = {who: number_in(number) for who, number in map(str.split, largest.split("; "))}
        rows = [row["engine"] for row in result.rows if row["scene"] == name and not row["failure"]]
        assert set(found) == {*rows} - {"analytic"}
        for who, number in found.items():
            most = np.abs(result.arrays[f"{name}/{who}/apart/{column}"]).max() / scale
            assert number == pytest.approx(max(most, 1e-9), rel=0.05)


def test_no_two_panels_of_the_report_have_one_title(folder):
    titles = re.findall('<text class="title" x="[^"]*" y="17">([^<]*)</text>', (folder / "report.html").read_text())
    assert len(titles) == len(set(titles)) >= 4


def test_synthetic_motion_is_named_so_and_nothing_else_is_left_in_the_folder(folder):
    source, all_of_it = ((folder / name).read_text() for name in ("report.html", RUNS))
    assert "synthetic" in re.search("<title>(.*?)</title>", source).group(1)
    assert source.count("synthetic duzce-like motion") == 2  # title, earthquake
    assert all_of_it.count("synthetic duzce-like motion") >= 4
    assert {file.name for file in folder.iterdir()} == {"scenes.json", "scenes.npz", "pages", "report.html"}
    assert str(Path(__file__).parents[3]) not in source


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
    items = " ".join(Page(write_page(tmp_path, studies=NO_STUDIES)).items)
    page = Page(tmp_path / RUNS)
    assert "Not in this report: engine 'pybullet' needs the package pybullet: install it so" in items
    assert page.table("Caryatid on rigid ground, 7 s")["outcome", "analytic"] == "overturns"
    assert page.table("Caryatid isolated, 7 s")["outcome", "analytic"] == "undecided (stands so far)"
    assert "in analytic it is undecided (stands so far)" in items


def test_a_study_is_shown_by_its_own_page_and_says_when_it_is_old(folder, copied, tmp_path_factory, monkeypatch):
    studies = tmp_path_factory.mktemp("results")
    file = write_result(studies / "fake" / "analytic.json", "fake", {}, [{"kappa": 0.75}], modules=["analytic.errors"])
    write_page(copied, studies=studies)
    assert "fake cannot be shown: unknown study" in (copied / "pages/fake.html").read_text()
    tables = [Table(name, ("solver", "kappa [-]"), [["exudyn", "0.75"]]) for name in ("Agreement", "All of it")]
    shown = parts.Page("A fake study: agrees", ("Two paragraphs < one.",), tuple(tables[:1]), tuple(tables[1:]))
    study = SimpleNamespace(page=lambda result: shown, judgements=lambda result: (), glance=lambda result: None)
    monkeypatch.setattr("comparisons.report.answer.get_study", lambda kind: study)
    first, own = Page(write_page(copied, studies=studies)), Page(copied / "pages/fake.html")
    for page in (first, own):
        assert page.table("Agreement")["exudyn", "kappa [-]"] == "0.75"
        assert "Two paragraphs &lt; one." in page.source
    assert "All of it" in own.source and "All of it" not in first.source and "pages/fake.html" in first.links
    edit(file, lambda content: content["provenance"]["sources"].update({"analytic.gone": ""}))
    warnings = write_page(copied, studies=studies).read_text().count("Out of date")
    assert warnings == first.source.count("Out of date") + 1


def test_undecided_outcomes_warnings_and_failures_stand_beside_the_outcomes_and_at_the_top(copied):
    def cut(content):
        undecided = {"outcome": "rocks", "overturning_time": None, "decided": False, "differences": []}
        undecided |= {"outcome_text": "undecided (rocks so far)"}
        for row in content["rows"]:
            if row["scene"] == "caryatid-rigid":
                row.update(undecided, warnings=[{"kind": "record", "text": "the record peaks at 5 g"}])
        *_, other, last = content["rows"]
        other["warnings"] = [{"kind": "model", "text": "the base is light"}]
        last.update(outcome="failed", failure={"kind": "crash", "reason": "the worker ended", "message": "<SIGSEGV>"})
        del last["agreement"]

    edit(copied / runs.SCENES, cut)
    top, page = Page(write_page(copied, studies=NO_STUDIES)), Page(copied / RUNS)
    other, items = read_result(copied / runs.SCENES).rows[-2]["engine"], " ".join(top.items)
    free, isolated = (page.table(f"Caryatid {name}, until decided") for name in ("on rigid ground", "isolated"))
    assert free["outcome", "analytic"] == "undecided (rocks so far)" and free["warnings [-]", "analytic"] == "1"
    assert isolated["warnings [-]", "analytic"] == "none" and isolated["warnings [-]", other] == "1"
    words = "outside what is modelled, or differing"
    assert page.table("Caryatid isolated: warnings")[other, words] == "the base is light"
    assert "it is undecided (rocks so far). Warning: the record peaks at 5 g." in items
    assert "the worker ended" in items[items.index("Failed runs:") :]
    assert "<pre>&lt;SIGSEGV&gt;</pre>" in top.source
