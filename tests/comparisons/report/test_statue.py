"""The report on one's own scenes: each sentence of a statue's card against runs, and nothing of the Caryatid."""

import json
import re

import pytest
from own_scenes import BRONZE, BUST, CLIFF
from sliding_scenes import SAVED, SLIDES

from analytic import PulseMotion, SampledMotion, load_scene, simulate, synthetic_motion
from analytic.errors import SceneError
from analytic.response import COMPARED, EDGE, OUTCOMES
from comparisons.commands.report import form
from comparisons.report import statue
from comparisons.report.detail import assets, environment
from comparisons.report.runs import RESTITUTION, SCENES, load_scenes
from comparisons.report.statue import _by_record, _engines, _worst, statue_of
from comparisons.report.study import make_own_results
from comparisons.report.write import PAGE, write_page
from comparisons.running.provenance import read_result
from comparisons.showing.parts import number

BEARINGS = """[bearings]
ka = 22950.5
kb = 2295.05
alpha = 66.6021
count = 4
x_max = 0.2"""
CABINET = """
friction = 0.4
[block]
mass = 220.0
radius = 0.94868
slenderness = 0.32175
[base]
mass = 60.0
[start]
tilt = 0.05
[motion]
pulse = "one-sine"
amplitude = 2.0
frequency = 6.0
"""
pytestmark = pytest.mark.xdist_group("statue")  # its page is made once
TEXTS = {"bronze": BRONZE.format(scale=CLIFF), "bust": BUST.format(bearings=BEARINGS), "cabinet": CABINET}


@pytest.fixture(scope="module")
def scenes(tmp_path_factory):
    folder = tmp_path_factory.mktemp("scenes")
    for name, text in TEXTS.items():
        (folder / f"{name}.toml").write_text(text)
    return load_scenes([str(folder / f"{name}.toml") for name in TEXTS])


@pytest.fixture(scope="module")
def made(scenes, tmp_path_factory):
    folder = tmp_path_factory.mktemp("page")
    make_own_results(folder, scenes, engines=[], motions={"bust": {"other": MOTIONS}})
    return folder


MOTIONS = [synthetic_motion(seed=7), synthetic_motion(seed=8).scaled(2.5)]


def peak(scene, motion):
    """Peak base displacement [m]."""
    return simulate(scene.with_(motion=motion, duration=None), history=False).peak_base_displacement


@pytest.fixture(scope="module")
def page(made):
    return write_page(made, studies=made / "none").read_text()


@pytest.fixture(scope="module")
def statues(made):
    """What `statue_of` found of each."""
    return read_result(made / SCENES).settings["statues"]


def cards(page):
    return [
        " ".join(re.sub("<[^>]+>", " ", card).split())
        for card in re.findall(r'<section class="statue">(.*?)</section>', page, flags=re.DOTALL)
    ]


def test_each_scene_has_its_card_first_with_its_outcome_in_the_title(page, scenes):
    found, titles = cards(page), page[: page.index("</title>")]
    assert len(found) == len(scenes)
    for card, (name, scene) in zip(found, scenes.items(), strict=True):
        outcome = simulate(scene, history=False).outcome
        words = {"stands": "does not lift", "rocks": "rocks and stays upright", "overturns": "overturns"}[outcome]
        if name == "bust":  # the other record's second motion, which is the worst
            words = f"rocks and stays upright under 1 of 2 motions; under its own motion it {words}"
            assert [peak(scene, motion) > 0.2 for motion in (scene.motion, *MOTIONS)] == [False, True, True]
            words += "; the base exceeds x_max under 1 of 2 motions"
        title = f"{name}: the block {words}"
        assert card.startswith(f"{title} ") and title in titles
        assert "Engines None was run." in card
    assert page.index('class="statue"') < page.index('id="answer"')


def test_the_cliff_is_said_loudly_and_only_where_it_is(page):
    bronze, bust, _ = cards(page)
    assert "sensitive to changes of the motion below 5%" in bronze
    assert "depends on" not in bust


def test_a_base_that_nothing_holds_is_said_loudly_and_only_there(page):
    heads = [card.partition("quantity")[0] for card in cards(page)]  # above the first table
    assert ["No friction is modelled under the base" in head for head in heads] == [False, False, True]
    assert page.count("No friction is modelled") == 1


def test_the_nearest_change_is_where_single_runs_change(scenes, statues):
    scene = scenes["bronze"]
    first = statues["bronze"]["margins"][0]
    assert first["quantity"] == "slenderness"
    own = simulate(scene, history=False).outcome
    for way, outcome in ((-1e-4, own), (1e-4, first["then"])):
        changed = scene.with_(block={"slenderness": scene.block.slenderness * (1 + first["nearest"] + way)})
        assert simulate(changed, history=False).outcome == outcome


def test_five_per_cent_of_the_motion_are_runs_of_their_own(scenes, statues):
    scene = scenes["bust"]
    rows = statues["bust"]["near"]
    for row in rows[:3]:
        found = simulate(scene.with_(motion=scene.motion.scaled(1 + row["change"])), history=False)
        assert row["outcome"] == found.outcome
        assert row["stroke"] == pytest.approx(found.peak_base_displacement, rel=1e-9)
    assert rows[3]["stroke"] >= max(row["stroke"] for row in rows[:3])


TITLES = {  # worst of each record, the scene's own motion and, where it is not that of the first record, its outcome
    ("stands", "stands"): "does not lift under any of 2 records, its own among them",
    ("rocks", "overturns"): "overturns under 1 of 2 records; under its own motion it rocks and stays upright",
    ("overturns", "overturns", "rocks"): "overturns under 2 of 3 records, its own among them",
    ("stands", "failed", "rocks"): "leaves the model under 1 of 3 records; under its own motion it does not lift",
}


@pytest.mark.parametrize("outcomes, words", TITLES.items())
def test_the_title_is_the_worst_of_all_records_and_what_the_scenes_own_motion_does(outcomes, words):
    rows = [{"record": k, "outcome": one} for k, one in enumerate(outcomes)]
    found = {"own": {"outcome": outcomes[0], "decided": True}, "motions": rows}
    assert _worst(found, {"motion": "own"}) == words


def test_the_title_without_other_motions_and_where_the_scene_has_none_or_is_cut():
    rocks = {"outcome": "rocks", "decided": True}
    assert _worst({"own": rocks, "motions": []}, {"motion": "own"}) == "rocks and stays upright"
    words = _worst({"own": rocks, "motions": [{"record": "r", "outcome": "rocks"}]}, {"motion": None})
    assert words == "rocks and stays upright under 1 of 1 record; without a motion it rocks and stays upright"
    words = _worst(
        {"own": {"outcome": "stands", "decided": False}, "motions": [{"record": "r", "outcome": "stands"}]},
        {"motion": "own"},
    )
    assert words.endswith("; under its own motion it does not lift (not decided when the run ended)")


def test_the_scenes_own_motion_counts_among_the_records_and_once(scenes, monkeypatch):
    monkeypatch.setattr(statue, "margins", lambda *_, **__: [])  # they take most of it
    scene, other = scenes["bronze"], synthetic_motion(seed=7).scaled(0.1)
    same = SampledMotion(scene.motion.dt, scene.motion.samples, "the record in the folder")
    for motions, count in (({"other": [other]}, 2), ({"a pair": [other, same]}, 1), ({}, 0)):
        rows = _by_record(statue_of(scene, motions)["motions"])
        assert len(rows) == count
        assert [row["overturns"] for row in rows if row["record"] != "other"] == [1] * bool(count)


def test_a_symmetric_scene_is_the_same_reversed_and_another_is_run(scenes, statues):
    assert "reversed" not in statues["bust"]
    scene = scenes["cabinet"]
    found = statues["cabinet"]["reversed"]
    mirrored = simulate(scene.with_(start={"tilt": -scene.start.tilt}), history=False)
    assert found["outcome"] == mirrored.outcome
    assert found["tilt"] == pytest.approx(mirrored.peak_tilt_ratio, rel=1e-6)


def test_free_standing_beside_isolated(page, scenes, statues):
    found = statues["bust"]
    free = simulate(scenes["bust"].with_(base=None, bearings=None), history=False)
    assert found["free"]["outcome"] == free.outcome == "overturns"
    assert "Free-standing, the block overturns." in cards(page)[1]
    assert "free" not in statues["bronze"] and scenes["bronze"].base is None


def test_other_motions_are_counted_by_record(page, scenes):
    bust, motions = cards(page)[1], (synthetic_motion(seed=7), synthetic_motion(seed=8).scaled(2.5))
    found = [simulate(scenes["bust"].with_(motion=motion, duration=None), history=False) for motion in motions]
    own = simulate(scenes["bust"], history=False)
    lifting = [any(one.outcome != "stands" for one in record) for record in ([own], found)]
    assert f"lifts under {sum(lifting)} of 2 motions" in bust and "Motions Warning" in bust
    assert "By motion motion runs largest peak" in bust
    assert "the scene&#39;s own motion 1 " in bust and "other 2 " in bust
    assert f"{max(one.peak_base_displacement for one in found):.3f}" in bust


def test_the_engines_that_agree_and_what_the_others_have_other():
    fell = {"quantity": "outcome", "here": "overturns", "model": "rocks", "limit": None}
    rows = [
        {"engine": solver, "failure": failure, "comparable": comparable, "differences": differences}
        for solver, failure, comparable, differences in (
            ("analytic", None, COMPARED, []),
            ("one", None, COMPARED, []),
            ("near", None, EDGE, []),
            ("two", None, COMPARED, [fell]),
            ("three", None, EDGE, [fell]),
            ("four", None, "N <= 0", []),
            ("five", {"reason": "it gave up"}, "no", []),
            ("six", None, "no", []),
        )
    ]
    said = _engines(rows).split("; ")
    assert said[0] == "one and near agree with the analytic model"
    assert said[1].startswith("two differs from the analytic model: the block overturns")
    assert said[2].startswith("three differs from the analytic model: the block overturns")
    assert said[3].startswith("four cannot be compared with the analytic model: N <= 0")
    assert said[4:] == ["five failed: it gave up", "six was not compared."]


BUST_ON_PULSE = load_scene("caryatid-isolated").with_(name="bust", motion=PulseMotion("one-sine", 1.0, 6.0))


def page_of(folder, **scenes):
    """The HTML of a report on these scenes, and of the page of its runs."""
    make_own_results(folder, scenes, engines=[])
    return write_page(folder, studies=folder / "none").read_text() + (folder / "pages/runs.html").read_text()


RELEASED = load_scene("free-rocking-rigid").with_(name="released", block={"restitution": 0.9})


def test_one_that_rocks_gets_its_own_restitution_and_replaces_an_older_report(tmp_path):
    (tmp_path / SCENES).write_text("of an older report")
    page = page_of(tmp_path, bust=BUST_ON_PULSE, released=RELEASED)
    assert read_result(tmp_path / SCENES).settings["scenes"]["released"]["restitution"] == 0.9
    result = read_result(tmp_path / RESTITUTION)
    assert result.settings["bases"] == [None] and max(row["rms"] for row in result.rows) < 1e-9
    assert sum(row["impacts"] for row in result.rows) >= 8
    assert "Restitution of this block" in page and "slides without friction" not in page
    assert "it is left out here, as it rates no engine" in page
    assert "Table 1(a)" not in page and "aryatid" not in page
    told = json.loads(form(tmp_path / PAGE).text())
    assert told["schema"] == "rocking report 5" and len(told["results"]) == 2
    assert [(row["scene"], row["outcome"]) for row in told["rows"]] == [("bust", "stands"), ("released", "rocks")]
    assert "released: in analytic it rocks and stays upright" in page and "bust: in analytic it never lifts" in page


@pytest.mark.long
def test_a_scene_that_stands_gets_no_word_of_restitution(tmp_path):
    page = page_of(tmp_path, bust=BUST_ON_PULSE)
    assert (tmp_path / SCENES).exists() and not (tmp_path / RESTITUTION).exists()
    assert "Restitution of this block" not in page and "aryatid" not in page
    titles = " ".join(re.findall('role="img" aria-label="([^"]*)"', page))
    assert "base displacement" in titles and "tilt φ" not in titles
    assert re.search(r">mass of the block m \[kg\]</th><td[^>]*>3172.05<", page)


def test_a_record_takes_the_place_of_the_scenes_motions(tmp_path):
    motion = synthetic_motion()
    scenes = load_scenes(["caryatid-rigid", "free-rocking-rigid"], motion)
    assert [scene.motion for scene in scenes.values()] == [motion, motion]
    assert list(load_scenes(["free-rocking-rigid"] * 2)) == ["free-rocking-rigid", "free-rocking-rigid-2"]
    assert load_scenes(["caryatid-rigid"])["caryatid-rigid"].digest() == load_scene("caryatid-rigid").digest()
    with pytest.raises(SceneError):
        load_scenes([str(tmp_path / "none.toml")])


def test_no_slip_stands_on_the_card_of_a_block_that_its_friction_holds(page):
    assert not any("slip" in card.lower() for card in cards(page))


@pytest.mark.parametrize("place, scene", [pytest.param("saved", SAVED, marks=pytest.mark.long), ("slides", SLIDES)])
def test_the_slip_stands_on_the_card_of_a_block_that_slides(place, scene, tmp_path):
    named = scene.with_(name=place, duration=None)
    make_own_results(tmp_path / place, {place: named}, engines=[], motions={})
    text = write_page(tmp_path / place, studies=tmp_path / "none").read_text()
    (card,) = cards(text)
    slid = simulate(named, history=False).sliding
    assert f"It slides by up to {number(slid.peak, 3)} m, and ends {number(abs(slid.end), 3)} m from" in card
    assert f"largest slip on the support [m] {number(slid.peak, 3)}" in card and "slip [m]" in card
    stage = json.loads(re.search('id="histories">(.*?)</script>', text)[1])
    (track,) = stage["scenes"][0]["tracks"]
    assert max(map(abs, track["slip"])) == pytest.approx(slid.peak, abs=2e-3)
    assert stage["scenes"][0]["reach"] == pytest.approx(max(map(abs, track["slip"])), abs=1e-3)
    moved = float(re.search(r'data-track="0".*?translate[(](-?[\d.]+) 0', text)[1])
    assert moved == pytest.approx(track["slip"][round(stage["still"] / stage["step"])], abs=1e-4)
    assert 'class="stood"' in text and "Shaded: the block slides in" in text


def test_every_outcome_has_a_colour_in_the_bar_of_a_margin():
    draw = environment().get_template("statue.html").module.bar
    for outcome in OUTCOMES:
        shown = draw({"quantity": "motion", "bands": [(-0.2, 0.2, outcome)]})
        kind = re.search('<rect class="(.*?)" x="20.0" y="18"', shown)[1]
        assert f"rect.{kind} {{" in assets()["style"]
