"""``rocking margin`` as a user calls it."""

import json

import pytest

from analytic import PulseMotion, Scene
from analytic.margins import contact_margins, margins
from comparisons.showing.margins import print_margins
from comparisons.studies.stability.cases import BLOCK, GAP, THRESHOLD

RELEASED = """
friction = 0.3
[block]
mass = 3172.05
radius = 1.0884
slenderness = 0.28
[start]
tilt = {tilt}
"""


@pytest.fixture
def scene_file(tmp_path):
    def write(tilt):
        path = tmp_path / "released.toml"
        path.write_text(RELEASED.format(tilt=tilt))
        return path

    return write


def test_margin_names_the_nearest_flip_and_draws_it(rocking, tmp_path, scene_file):
    picture, file = tmp_path / "margin.png", tmp_path / "margin.json"
    status, out, _ = rocking("margin", scene_file(0.26), "--plot", picture, "--json", file)
    assert status == 0
    assert "Nearest flip: slenderness -7.14 %, the block then overturns" in " ".join(out.split())
    assert picture.read_bytes().startswith(b"\x89PNG")
    content = json.loads(file.read_text())
    assert content["schema"] == "rocking margin 1" and content["outcome"] == "rocks"
    nearest = content["margins"][0]
    assert nearest["quantity"] == "slenderness"
    assert nearest["nearest"] == pytest.approx(0.26 / 0.28 - 1, abs=1e-7)
    assert content["contact"]["friction"] == 0.3 and 0 < content["contact"]["friction_demand"] < 0.3


def test_margin_says_when_nothing_flips_the_verdict(rocking, scene_file):
    status, out, _ = rocking("margin", scene_file(0.01), "--span", "5")
    assert status == 0
    assert "No change of up to 5 % of any one quantity flips the verdict" in " ".join(out.split())


def test_a_span_out_of_range_is_one_message(rocking):
    status, _, err = rocking("margin", "free-rocking-rigid", "--span", "200")
    assert status == 2 and err == "Error: --span 200: give per cent, from 0.1 on and below 100\n"


def test_a_frayed_boundary_is_said(capsys):
    scene = Scene(block=BLOCK, motion=PulseMotion("one-sine", 1.1 * GAP * THRESHOLD, 7.8))
    for step, frayed in ((0.04, True), (0.01, False)):
        found = [margin for margin in margins(scene, span=0.16, step=step) if margin.quantity == "motion"]
        print_margins(scene, found, contact_margins(scene), 16.0)
        words = " ".join(capsys.readouterr().out.split())
        assert ("Frayed in motion: bands narrower than 8 % alternate" in words) == frayed
