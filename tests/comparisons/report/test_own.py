"""The report on one's own scenes: it shows what they need, and nothing of the Caryatid."""

import json
import re
from pathlib import Path

import pytest

from analytic import load_scene, synthetic_motion
from analytic.errors import SceneError
from comparisons.commands.report import form
from comparisons.report.runs import RESTITUTION, SCENES, load_scenes
from comparisons.report.study import make_own_results
from comparisons.report.write import PAGE, write_page
from comparisons.running.provenance import read_result

NO_STUDIES = Path(__file__).parent / "no such folder"
STANDS = """
[block]
mass = 1551.8
radius = 0.989
slenderness = 0.3
[base]
mass = 400.0
[bearings]
law = "linear"
count = 4
ka = 3e3
[motion]
pulse = "one-sine"
amplitude = 1.0
frequency = 6.0
"""
ROCKS = """
[block]
mass = 1551.8
radius = 0.989
slenderness = 0.3
[start]
tilt = 0.2
[run]
duration = 3.0
"""


def page_of(folder, **texts):
    files = []
    for name, text in texts.items():
        files.append(str(folder / f"{name}.toml"))
        (folder / f"{name}.toml").write_text(text)
    make_own_results(folder / "report", load_scenes(files), engines=[])
    return "".join(
        page.read_text()
        for page in (write_page(folder / "report", studies=NO_STUDIES), folder / "report/pages/runs.html")
    )


@pytest.mark.slow
def test_a_scene_that_stands_gets_no_word_of_restitution(tmp_path):
    page = page_of(tmp_path, bust=STANDS)
    folder = tmp_path / "report"
    assert (folder / SCENES).exists() and not (folder / RESTITUTION).exists()
    assert "Restitution of this block" not in page and "aryatid" not in page
    titles = re.findall('role="img" aria-label="([^"]*)"', page)
    assert any("base displacement" in title for title in titles) and not any("tilt φ" in title for title in titles)
    assert re.search(r">mass of the block m \[kg\]</th><td[^>]*>1551.8<", page)


def test_one_that_rocks_gets_its_own_restitution_and_replaces_an_older_report(tmp_path):
    (tmp_path / "report").mkdir()
    (tmp_path / "report" / SCENES).write_text("of an older report")
    page = page_of(tmp_path, bust=STANDS, released=ROCKS)
    folder = tmp_path / "report"
    result = read_result(folder / RESTITUTION)
    assert result.settings["bases"] == [None] and max(row["rms"] for row in result.rows) < 1e-9
    assert sum(row["impacts"] for row in result.rows) >= 8
    assert "Restitution of this block" in page and "slides without friction" not in page
    assert "Table 1(a)" not in page
    told = json.loads(form(folder / PAGE).text())
    assert told["schema"] == "rocking report 3" and len(told["results"]) == 2
    assert [(row["scene"], row["outcome"]) for row in told["rows"]] == [("bust", "stands"), ("released", "rocks")]
    assert "released: in analytic it rocks and stays upright" in page and "bust: in analytic it never lifts" in page


def test_a_record_takes_the_place_of_the_scenes_motions(tmp_path):
    motion = synthetic_motion()
    scenes = load_scenes(["caryatid-rigid", "free-rocking-rigid"], motion)
    assert [scene.motion for scene in scenes.values()] == [motion, motion]
    assert list(load_scenes(["free-rocking-rigid"] * 2)) == ["free-rocking-rigid", "free-rocking-rigid-2"]
    assert load_scenes(["caryatid-rigid"])["caryatid-rigid"].digest() == load_scene("caryatid-rigid").digest()
    with pytest.raises(SceneError):
        load_scenes([str(tmp_path / "none.toml")])
