"""``rocking margin`` as a user calls it."""

import json

import pytest

from analytic import PulseMotion, Scene, load_scene, simulate
from analytic.margins import Band, Contact, Margin, margins
from comparisons.showing.margins import draw_margins, print_margins
from comparisons.studies.stability.cases import BLOCK, GAP, THRESHOLD

RELEASED = """
[block]
mass = 3172.05
radius = 1.0884
slenderness = 0.28
[start]
tilt = {tilt}
"""
PUSHED = """
friction = 0.26
[block]
mass = 3172.05
radius = 1.0884
slenderness = 0.28
[motion]
pulse = "rectangular"
amplitude = 2.5
frequency = 12.0
"""


def released(rocking, folder, tilt, *options):
    """(what is printed, the JSON) of the margins of a block released from a tilt."""
    (folder / "released.toml").write_text(RELEASED.format(tilt=tilt))
    status, out, _ = rocking("margin", folder / "released.toml", *options, "--json", folder / "margin.json")
    assert status == 0
    return " ".join(out.split()), json.loads((folder / "margin.json").read_text())


def test_margin_names_the_nearest_change_of_the_outcome_and_draws_it(rocking, tmp_path):
    words, content = released(rocking, tmp_path, 0.26, "--plot", tmp_path / "margin.png")
    assert "Nearest change of the outcome: slenderness -7.14 %, the block then overturns." in words
    assert "released: rocks now: lifts, tilt > 0.5 γ" in words
    assert (tmp_path / "margin.png").read_bytes().startswith(b"\x89PNG")
    assert (content["schema"], content["outcome"], content["tilt"]) == ("rocking margin 4", "rocks", 0.5)
    nearest = content["margins"][0]
    assert nearest["quantity"] == "slenderness"
    assert nearest["nearest"] == pytest.approx(0.26 / 0.28 - 1, abs=1e-7)
    assert content["reached"] == ["lifts", "tilt"]
    assert nearest["changes"] == {"lifts": None, "tilt": None, "overturns": nearest["nearest"]}
    assert [(band["reached"], band["outcome"]) for band in nearest["bands"]] == [
        (["lifts", "tilt", "overturns"], "overturns"),
        (["lifts", "tilt"], "rocks"),
    ]
    assert content["contact"]["friction"] is None and 0 < content["contact"]["friction_demand"] < 0.3


def test_margin_of_a_friction_says_where_the_block_slides(rocking, tmp_path):
    """Under a constant acceleration of 2.5 m/s2, .2548 g, it slides from friction .26 (1 - .0198) down."""
    (tmp_path / "pushed.toml").write_text(PUSHED)
    status, out, _ = rocking("margin", tmp_path / "pushed.toml", "--json", tmp_path / "margin.json")
    words, content = " ".join(out.split()), json.loads((tmp_path / "margin.json").read_text())
    assert status == 0 and "pushed: stands" in words
    assert "Nearest change of the outcome: friction -1.98 %, the block then slides." in words
    assert "quantity value slides lifts > 0.5 γ" in words and "friction 0.26 -1.98 %" in words
    assert "The friction demand is 0.255, the scene's coefficient 0.26." in words
    nearest = next(one for one in content["margins"] if one["quantity"] == "friction")
    assert nearest["nearest"] == pytest.approx(2.5 / 9.81 / 0.26 - 1, abs=1e-7)
    assert [band["outcome"] for band in nearest["bands"]] == ["slides", "stands"]


SAID = {
    (0.01, "--span", "5"): (
        "No change of up to 5 % of any one quantity changes the outcome.",
        "No change of up to 5 % of slenderness, restitution, size, start changes any of these",
    ),
    (0.03, "--tilt", "0.1"): (  # a limit of one's own
        "released: rocks now: lifts, tilt > 0.1 γ",
        "start 0.03 rad, rad/s -6.67 %",
        "slenderness 0.28 rad +7.14 %",
    ),
    (0.15,): (  # lifted and tilted by more than half now: at .14/.15 and .15/.14 of it no longer, overturns at none
        "no longer no longer tilt quantity value lifts > 0.5 γ",
        "start 0.15 rad, rad/s -6.67 %",
        "slenderness 0.28 rad +7.14 %",
    ),
    (0.13,): ("tilt quantity value lifts > 0.5 γ", "start 0.13 rad, rad/s +7.69 %", "slenderness 0.28 rad -7.14 %"),
}


@pytest.mark.parametrize("arguments, sentences", SAID.items())
def test_margin_says_what_changes_a_limit_state_and_when_nothing_does(rocking, tmp_path, arguments, sentences):
    words, _ = released(rocking, tmp_path, *arguments)
    assert all(sentence in words for sentence in sentences)


def test_every_limit_state_has_its_column_and_the_widest_numbers_fit(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    scene = load_scene("caryatid-isolated")
    found = Margin(
        "yield force",
        1.2345e-11,
        "kg",
        (
            Band(-0.9, -0.12345, ("lifts",), False),
            Band(-0.12345, -0.0012345, ("stroke", "tilt"), True),
            Band(-0.0012345, 1.2345, ("lifts",), True),
            Band(1.2345, 9.0, ("lifts", "tilt", "stroke", "overturns"), True),
        ),
    )
    print_margins(scene, [found], Contact.of(scene, simulate(scene.with_(duration=None), history=False)), 900.0, 0.25)
    shown = capsys.readouterr().out
    assert max(map(len, shown.splitlines())) <= 80 and "…" not in shown and "now: lifts\n" in shown
    words = " ".join(shown.split())
    assert "no longer tilt base" in words and "quantity value lifts > 0.25 γ > x_max overturns left at" in words
    assert "yield force 1.2345e-11 kg -0.123 % -0.123 % -0.123 % +123 % -12.3 %" in words


@pytest.mark.parametrize("least, said", [(1.0, False), (0.9996, False), (0.98, True)])
def test_a_normal_force_that_does_not_fall_is_not_said_to(least, said, capsys):
    scene = Scene(block=BLOCK, motion=PulseMotion("one-sine", 0.5 * THRESHOLD, 7.8))
    print_margins(scene, margins(scene, span=0.01, step=0.01), Contact(least, 0.1, None), 1.0, 0.5)
    words = " ".join(capsys.readouterr().out.split())
    assert ("The normal force falls to" in words) == said and "The friction demand is 0.1;" in words


def test_interleaved_outcomes_are_said(capsys):
    scene = Scene(block=BLOCK, motion=PulseMotion("one-sine", 1.1 * GAP * THRESHOLD, 7.8))
    for step, interleaved in ((0.04, True), (0.01, False)):
        found = [margin for margin in margins(scene, span=0.16, step=step) if margin.quantity == "motion"]
        print_margins(scene, found, Contact.of(scene, simulate(scene.with_(duration=None), history=False)), 16.0, 0.5)
        words = " ".join(capsys.readouterr().out.split())
        assert ("The outcomes are interleaved in motion: bands narrower than 8 % alternate" in words) == interleaved


def test_the_picture_marks_limit_states_where_they_are_reached():
    reached = ((), ("lifts", "tilt"), ("lifts", "tilt", "stroke", "overturns"))
    bands = [Band(low, low + 0.2, states, True) for low, states in zip((-0.1, 0.1, 0.3), reached, strict=True)]
    figure = draw_margins(load_scene("caryatid-isolated"), [Margin("ka", 1.0, "N/m", tuple(bands))], 0.25)
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels == ["stands", "rocks", "overturns", "tilt > 0.25 γ", "base > x_max"]
    lines = [patch for patch in figure.axes[0].patches if patch.get_height() < 0.1]
    assert sorted((round(patch.get_x()), round(patch.get_width())) for patch in lines) == [(10, 20), (30, 20), (30, 20)]
