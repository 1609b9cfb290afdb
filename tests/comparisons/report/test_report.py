"""The report: its pages need nothing but themselves, say how old they are, and its histories are the runs'."""

import html
import json
import re
from pathlib import Path

import numpy as np
import pytest
from drawn import ROWS, WITH_STUDIES, made_up, write_all
from page_numbers import number_in
from sliding_scenes import SAVED

from analytic import EngineNotInstalled, load_scene, simulate, synthetic_motion
from analytic.checks.time_stepping import simulate_time_stepping
from analytic.response import History
from comparisons.execution.cases import Case
from comparisons.execution.results import ResultError, read_result
from comparisons.execution.sweep import Task, lines_of
from comparisons.execution.writing import PlaceError
from comparisons.lessons.lesson import SCENE
from comparisons.plotting.parts import where
from comparisons.report import figures as histories
from comparisons.report import runs
from comparisons.report.detail import STEP, frames
from comparisons.report.runs import make_results
from comparisons.report.write import write_page

PROJECT = Path(__file__).parents[3]
NAMES = ("exudyn", "pybullet")


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """The reports of made-up rows."""
    place = tmp_path_factory.mktemp("reports")
    write_all(place)
    return place


def test_pages_need_nothing_but_themselves_and_each_link_leads_to_its_place(place):
    for file in place.rglob("*.html"):
        source = file.read_text(encoding="utf-8")
        body = re.sub(r"<(script|style).*?</\1>", "", source, flags=re.DOTALL)
        assert not {"link", "iframe", "object", "img"} & set(re.findall(r"<(\w+)", body))
        assert not re.search(r"@import|src=|url\((?!#)", source)
        assert str(PROJECT) not in source
        for link in re.findall(r'\s(?:href|src|data|action)="([^"]*)"', body):
            path, _, anchor = link.partition("#")
            target = (file.parent / path if path else file).read_text(encoding="utf-8")
            assert not anchor or target.count(f' id="{anchor}"') == 1, link


def test_outside_the_range_no_engine_is_recommended(tmp_path):
    file = tmp_path / runs.SCENES
    content = json.loads((ROWS / WITH_STUDIES / runs.SCENES).read_text(encoding="utf-8"))
    recommended = "Which level to use"
    for words in ("", "No engine is recommended here: R 20 is outside."):
        content["rows"][1]["warnings"] = [{"kind": "engine", "quantity": "radius", "text": "R 20 is outside"}] * bool(
            words
        )
        file.write_text(json.dumps(content), encoding="utf-8")
        with made_up():
            page = write_page(tmp_path, ROWS).read_text(encoding="utf-8")
        assert words in page and (recommended in page) != bool(words)


@pytest.mark.slow
def test_a_report_says_what_its_result_file_says(tmp_path):
    make_results(tmp_path, synthetic_motion(), engines=NAMES)
    write_page(tmp_path, studies=tmp_path / "none")
    assert {file.name for file in tmp_path.iterdir()} == {"scenes.json", "scenes.npz", "pages", "report.html"}
    result = read_result(tmp_path / runs.SCENES)
    page = (tmp_path / "pages/runs.html").read_text(encoding="utf-8")
    for name in runs.CARYATID:
        rows, response = where(result.rows, scene=name), simulate(load_scene(name))
        assert [row["engine"] for row in rows] == ["analytic", *NAMES]
        assert (rows[0]["outcome"], rows[0]["peak_tilt_ratio"]) == (response.outcome, response.peak_tilt_ratio)
        table = page[page.index(f"{result.settings['scenes'][name]['name']}, until decided") :]
        cells = re.findall("<td[^>]*>(.*?)</td>", re.search("peak [|]φ[|]/γ.*?</tr>", table, re.DOTALL)[0])
        assert [number_in(cell) for cell in cells] == pytest.approx([row["peak_tilt_ratio"] for row in rows], rel=1e-3)
        for column in response.history.COLUMNS:
            np.testing.assert_array_equal(result.arrays[f"{name}/analytic/{column}"], getattr(response.history, column))


def test_missing_engines_are_named_with_their_remedy(tmp_path, monkeypatch):
    def nothing_installed(name):
        raise EngineNotInstalled(f"engine {name!r} needs the package {name}: install it so")

    monkeypatch.setattr("engines.get_engine", nothing_installed)
    make_results(tmp_path, synthetic_motion(), duration=7.0)  # one falls within it, the other is still open
    page = html.unescape(write_page(tmp_path, studies=tmp_path / "none").read_text(encoding="utf-8"))
    assert "Not in this report: engine 'pybullet' needs the package pybullet: install it so" in page
    assert "in analytic it is undecided (stands so far)" in page and "in analytic it overturns" in page


@pytest.mark.parametrize("scene", [load_scene("caryatid-isolated").with_(duration=5.0), SAVED], ids=["rocks", "slides"])
def test_responses_survive_the_way_through_a_result_file_and_a_lost_history_is_said(tmp_path, scene):
    response = simulate(scene)
    values = json.loads(json.dumps(histories.ToFile(str(tmp_path))(None, response)))
    again = histories.response_of(values, tmp_path)
    assert again.to_json() == response.to_json()
    assert ("slip" in again.history.columns) == (scene is SAVED)
    for column in response.history.columns:
        np.testing.assert_array_equal(getattr(again.history, column), getattr(response.history, column))
    (tmp_path / values["history"]).unlink()
    with pytest.raises(ResultError, match="missing; remove the folder"):
        histories.response_of(values, tmp_path)


def test_a_history_that_cannot_be_kept_is_no_failed_run(tmp_path):
    """A full disk ends the report with a message; the run itself failed nowhere."""
    (tmp_path / "file").write_text("")
    case = Case(load_scene("free-rocking-rigid").with_(duration=0.1))
    task = Task("t", (case,), ("key",), histories.ToFile(str(tmp_path / "file")), 60.0)
    with pytest.raises(PlaceError, match=r"\.npz: could not be written \(Not a directory\)"):
        lines_of(task)


def test_thinning_keeps_ends_and_the_extremes_of_every_part():
    generator = np.random.default_rng(5)
    columns = generator.normal(size=(3, 1_000_000))
    columns[0, 123_456], columns[1, 777_777], columns[2, 999_998] = 50.0, -60.0, 70.0  # one sample wide
    shown = histories.thinned(*columns)
    assert len(shown) <= histories.MOST_SHOWN and (np.diff(shown) > 0).all()
    assert {0, 123_456, 777_777, 999_998, 999_999} <= set(shown)
    begins = np.arange(0, 1_000_000, 10_000)
    for column in columns:  # the band that a drawn line covers
        for extreme in (np.minimum, np.maximum):
            kept = extreme.reduceat(column[shown], np.searchsorted(shown, begins))
            np.testing.assert_array_equal(kept, extreme.reduceat(column, begins))
    np.testing.assert_array_equal(histories.thinned(columns[0, :5177]), np.arange(5177))


def test_differences_are_those_of_all_samples():
    time = np.linspace(0.0, 100.0, 100_001)
    zeros = np.zeros_like(time)
    model = History(time, np.sin(time), *5 * [zeros])
    spike = np.where(np.arange(len(time)) == 54_321, 1e-3, 0.0)
    apart = histories.differences(History(time, np.sin(time) + spike, zeros, zeros - 2e-3, *3 * [zeros]), model)
    assert len(apart["apart/time"]) < 20_000
    assert np.abs(apart["apart/tilt"]).max() == pytest.approx(1e-3, rel=1e-9)
    assert apart["apart/time"][np.abs(apart["apart/tilt"]).argmax()] == time[54_321]
    assert (apart["apart/base_displacement"] == -2e-3).all()


def test_errors_of_one_impact_in_steps_are_those_of_the_time_stepping():
    """Shift of the first impact [ms] and error of the rate after it [%], rms over 201 steps within a tenth."""
    exact = simulate(SCENE).impacts[0]
    first, _, _, fourth = (words for _, words in frames())
    numbers = re.findall(r"by ([\d.]+) [m%]", f"{first} {fourth}")
    for step, shift, rate in ((STEP, numbers[0], numbers[2]), (STEP / 2, numbers[1], numbers[3])):
        hits = [simulate_time_stepping(SCENE, step=step * (0.9 + 0.001 * k)).impacts[0] for k in range(201)]
        apart = (
            [1e3 * (hit.time - exact.time) for hit in hits],
            [100 * (hit.rate_after / exact.rate_after - 1) for hit in hits],
        )
        assert [float(shift), float(rate)] == pytest.approx(
            [np.sqrt(np.mean(np.square(values))) for values in apart], rel=0.1
        )
