"""The card of a statue: what it says against runs; the command that it gives next runs on the file."""

import html
import json
import re
import shlex
import shutil

import numpy as np
import pytest
from own_scenes import BRONZE, BUST, CLIFF
from record_files import pairs
from sliding_scenes import SLIDES

from analytic import Bearings, PulseMotion, SampledMotion, load_scene, simulate, synthetic_motion
from analytic.errors import SceneError
from analytic.response import COMPARED, EDGE, OUTCOMES
from comparisons.commands.report import form
from comparisons.execution.results import RESULTS, read_result
from comparisons.report import statue
from comparisons.report.detail import assets, environment
from comparisons.report.runs import RESTITUTION, SCENES, load_scenes, make_own_results
from comparisons.report.statue import (
    _by_record,
    _engine_sentences,
    _sentences,
    _worst_words,
    needed_by,
    next_step,
    on_plate,
    statue_of,
)
from comparisons.report.write import PAGE, write_page

GROUND = load_scene("caryatid-rigid")
ISOLATED = load_scene("caryatid-isolated")


def written(folder, text):
    (folder / "scene.toml").write_text(text)
    return load_scene(folder / "scene.toml")


@pytest.mark.slow
def test_the_nearest_change_and_five_per_cent_of_the_motion_are_where_single_runs_are(tmp_path):
    scene = written(tmp_path, BRONZE.format(scale=CLIFF))
    statue, response = statue_of(scene, {}), simulate(scene, history=False)
    assert statue["own"]["outcome"] == response.outcome and any("below 5%" in words for words in statue["cautions"])
    first = statue["margins"][0]
    assert first["quantity"] == "slenderness"
    for way, outcome in ((-1e-4, response.outcome), (1e-4, first["then"])):
        changed = scene.with_(block={"slenderness": scene.block.slenderness * (1 + first["nearest"] + way)})
        assert simulate(changed, history=False).outcome == outcome
    for row in statue["near"][:3]:
        run = simulate(scene.with_(motion=scene.motion.scaled(1 + row["change"])), history=False)
        assert row["outcome"] == run.outcome
        assert row["tilt"] == pytest.approx(run.peak_tilt_ratio, rel=1e-9)
    assert statue["near"][3]["tilt"] >= max(row["tilt"] for row in statue["near"][:3])


@pytest.fixture
def quick(monkeypatch):
    monkeypatch.setattr(statue, "margins", lambda *_, **__: [])  # they take most of it


def test_a_copy_reversed_or_free_standing_is_a_run_of_its_own(quick, tmp_path):
    bearings = "[bearings]\nka = 22950.5\nkb = 2295.05\nalpha = 66.6021\ncount = 4\nx_max = 0.2"
    scene = written(tmp_path, BUST.format(bearings=bearings))
    statue = statue_of(scene, {})
    free = simulate(scene.with_(base=None, bearings=None), history=False)
    assert "reversed" not in statue and statue["free"]["outcome"] == free.outcome == "overturns"
    assert statue["sizes"]["core"] == pytest.approx(4.48e-3, rel=1e-3) and statue["sizes"]["reasons"]
    about = dict(_sentences(statue))["Bearings"]
    assert "No such bearing is made: lead core 4.48 mm" in about and "Assumed: lead yields at 10 MPa" in about
    started = GROUND.with_(start={"tilt": 0.05})
    statue, mirrored = statue_of(started, {}), simulate(started.with_(start={"tilt": -0.05}), history=False)
    assert "free" not in statue and statue["reversed"]["outcome"] == mirrored.outcome
    assert statue["reversed"]["tilt"] == pytest.approx(mirrored.peak_tilt_ratio, rel=1e-6)
    slid = simulate(SLIDES, history=False).sliding
    numbers = statue_of(SLIDES, {})["own"]
    assert (numbers["slip"], numbers["slip_end"]) == (slid.peak, slid.end)


TITLES = {  # outcomes: of each record, the scene's own motion first; whether that run was decided
    ("stands", "stands"): "does not lift under any of 2 records, its own among them",
    ("rocks", "overturns"): "overturns under 1 of 2 records; under its own motion it rocks and stays upright",
    ("overturns", "overturns", "rocks"): "overturns under 2 of 3 records, its own among them",
    ("stands", "failed", "rocks"): "leaves the model under 1 of 3 records; under its own motion it does not lift",
    ("rocks",): "rocks and stays upright under 1 of 1 record; without a motion it rocks and stays upright",
}


@pytest.mark.parametrize("outcomes, words", TITLES.items())
def test_the_title_is_the_worst_of_all_records_and_what_the_scenes_own_motion_does(outcomes, words):
    run = {"outcome": outcomes[0], "decided": True}
    rows = [{"record": k, "outcome": outcome} for k, outcome in enumerate(outcomes)]
    assert _worst_words({"own": run, "motions": rows}, {"motion": "own" if outcomes[1:] else None}) == words
    cut = _worst_words({"own": run | {"decided": False}, "motions": rows[1:]}, {"motion": "own"})
    assert cut.endswith("(not decided when the run ended)")
    assert _worst_words({"own": {"outcome": "rocks", "decided": True}, "motions": []}, {"motion": "own"}) == (
        "rocks and stays upright"
    )


def test_the_engines_that_agree_and_what_the_others_have_other():
    fell = {"quantity": "outcome", "here": "overturns", "model": "rocks", "limit": None}
    known = {"analytic": COMPARED, "one": COMPARED, "near": EDGE, "two": EDGE, "three": "N <= 0", "four": "no"}
    rows = [
        {"engine": name, "failure": None, "comparable": how, "differences": [fell] * (name == "two")}
        for name, how in known.items()
    ]
    agree, two, *others = _engine_sentences(
        [*rows, {**rows[-1], "engine": "five", "failure": {"reason": "it gave up"}}]
    ).split("; ")
    assert agree == "one and near agree with the analytic model"
    assert two.startswith("two differs from the analytic model: the block overturns")
    three = "three cannot be compared with the analytic model: N <= 0"
    assert others == [three, "four was not compared", "five failed: it gave up."]


def test_the_scenes_own_motion_counts_among_the_records_and_once(quick, tmp_path):
    scene, other = written(tmp_path, BRONZE.format(scale=CLIFF)), synthetic_motion(seed=7).scaled(0.1)
    same = SampledMotion(scene.motion.dt, scene.motion.samples, "the record in the folder")
    for motions, count in (({"other": [other]}, 2), ({"a pair": [other, same]}, 1), ({}, 0)):
        rows = _by_record(statue_of(scene, motions)["motions"])
        assert len(rows) == count
        assert [row["falls"] for row in rows if row["record"] != "other"] == [1] * bool(count)


@pytest.mark.slow
def test_one_that_rocks_gets_its_own_restitution_and_replaces_an_older_report(quick, tmp_path):
    (tmp_path / SCENES).write_text("of an older report")
    bust = ISOLATED.with_(name="bust", motion=PulseMotion("one-sine", 1.0, 6.0))
    released = load_scene("free-rocking-rigid").with_(name="released", block={"restitution": 0.9})
    make_own_results(tmp_path, {"bust": bust, "released": released}, engines=[])
    page = write_page(tmp_path, studies=tmp_path / "none").read_text()
    assert read_result(tmp_path / SCENES).settings["scenes"]["released"]["restitution"] == 0.9
    result = read_result(tmp_path / RESTITUTION)
    assert result.settings["bases"] == [None] and max(row["rms"] for row in result.rows) < 1e-9
    assert sum(row["impacts"] for row in result.rows) >= 8
    assert "Table 1(a)" not in page and "aryatid" not in page
    report = json.loads(form(tmp_path / PAGE).text())
    assert report["schema"] == "rocking report 6" and len(report["results"]) == 2
    assert [(row["scene"], row["outcome"]) for row in report["rows"]] == [("bust", "stands"), ("released", "rocks")]
    make_own_results(tmp_path, {"bust": bust}, engines=[])
    assert not (tmp_path / RESTITUTION).exists()  # of a block that never rocks


def test_a_record_takes_the_place_of_the_scenes_motions(tmp_path):
    motion = synthetic_motion()
    scenes = load_scenes(["caryatid-rigid", "free-rocking-rigid"], motion)
    assert [scene.motion for scene in scenes.values()] == [motion, motion]
    assert list(load_scenes(["free-rocking-rigid"] * 2)) == ["free-rocking-rigid", "free-rocking-rigid-2"]
    assert load_scenes(["caryatid-rigid"])["caryatid-rigid"].digest() == load_scene("caryatid-rigid").digest()
    with pytest.raises(SceneError):
        load_scenes([str(tmp_path / "none.toml")])


@pytest.mark.parametrize(
    "foot, based", [({"width": 0.8, "mass": 600.0, "height": 0.7}, True), ({"width": 0.8, "height": None}, False)]
)
def test_a_pedestal_stands_between_block_and_base_or_ground(foot, based):
    block = {"name": "s", "half_width": 0.2, "half_height": 0.9, "block": {"mass": 400.0}, "bearings": None}
    draw = environment().get_template("statue.html").module.block
    shown = draw({**block, "base": {"mass": 900.0} if based else None, "pedestal": foot})
    rows = re.findall(r'class="(\w+)" x="(\S+)" y="(\S+)" width="(\S+)" height="(\S+)"', shown)
    rects = [(kind, *map(float, numbers)) for kind, *numbers in rows]
    assert [kind for kind, *_ in rects] == [*["steel"] * based, "steel", "stone"]
    *lower, (_, x, y, width, height), (_, _, top, _, tall) = rects
    assert (x, width) == (-0.4, 0.8) and top + tall == pytest.approx(y) and height == (foot.get("height") or 0.216)
    assert y + height == pytest.approx(lower[0][2] if based else 0.0) and "pedestal 0.800 m" in shown


def test_every_outcome_has_a_colour_in_the_bar_of_a_margin():
    draw = environment().get_template("statue.html").module.bar
    for outcome in OUTCOMES:
        shown = draw({"quantity": "motion", "bands": [(-0.2, 0.2, outcome)]})
        kind = re.search('<rect class="(.*?)" x="20.0" y="18"', shown)[1]
        assert f"rect.{kind} {{" in assets()["style"]


WEAK = "[bearings]\nka = 229505\nkb = 22950.5\nalpha = 66.6021\ncount = 4\n"
CARDS = {
    "a block's file.toml": (BRONZE.format(scale=CLIFF), "design", "739"),
    "bust.toml": (BUST.format(bearings=WEAK + "x_max = 0.2"), "design", None),
    "calm.toml": (BRONZE.format(scale=0.2), "margin", None),
}
FIRST = "First write this motion into the table [motion] of its file."


def fate(scene, motion, width=None):
    block = scene.block if width is None else on_plate(scene.block, width)
    return simulate(scene.with_(block=block, motion=motion, duration=None), history=False).outcome


COSTS = {"a block's file.toml": [pytest.mark.slow], "calm.toml": [pytest.mark.slow], "bust.toml": [pytest.mark.long]}


@pytest.mark.parametrize("name", [pytest.param(name, marks=COSTS.get(name, [])) for name in CARDS])
def test_the_command_on_the_card_runs_on_this_file(rocking, tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    text, command, base_mass = CARDS[name]
    (tmp_path / name).write_text(text)
    (tmp_path / "my records").mkdir()
    shutil.copytree(RESULTS / "tolerances", tmp_path / "stored" / "tolerances")
    pairs(tmp_path / "my records", 1, seconds=2.0)
    many = ("--records", "my records", "--directions", "2", "--both-signs") if command == "design" else ()
    place = str(tmp_path / name) if command == "margin" else name
    status, _, err = rocking("report", place, *many, "--engine", "analytic", "--output", "page", "--studies", "stored")
    assert status == 0, err
    stages = [line for line in err.splitlines() if line.startswith(("runs:", "studies")) and "done in" not in line]
    assert stages[0] == "runs: 1 to do in 1 solver"  # though nobody sees a bar
    page = (tmp_path / "page/report.html").read_text()
    (shown,) = re.findall('<p class="next">.*?data-copies="(.*?)"', page)
    words = shlex.split(html.unescape(shown))
    assert words[:3] == ["rocking", command, place] and FIRST not in page and set(many) <= set(words)
    given = dict(zip(words, words[1:], strict=False))
    assert given.get("--base-mass") == base_mass
    status, out, err = rocking(*words[1:])
    assert status == 0 and "Traceback" not in err, err
    assert ("of critical damping" in out) == (command == "design")


def test_a_block_on_a_plate_has_the_same_mass_and_height_and_moves_about_the_plates_corners():
    block = on_plate(GROUND.block, 0.9)
    assert 2 * block.half_width == pytest.approx(0.9, rel=1e-14)
    assert block.half_height == pytest.approx(GROUND.block.half_height, rel=1e-14)
    assert block.centre_inertia == pytest.approx(GROUND.block.centre_inertia, rel=1e-12)


def test_on_the_ground_the_width_that_does_not_lift_is_the_height_times_the_peak_in_g():
    motions = [GROUND.motion, synthetic_motion(seed=7).scaled(1.4)]
    needed = needed_by(GROUND, motions)
    height = 2 * GROUND.block.half_height
    assert needed["stands"] == pytest.approx(height * max(motion.peak for motion in motions) / GROUND.gravity, rel=5e-3)
    assert [fate(GROUND, motion, needed["stands"]) for motion in motions] == ["stands"] * 2
    assert "rocks" in [fate(GROUND, motion, 0.99 * needed["stands"]) for motion in motions]


def test_the_width_that_stays_upright_does_so_under_all_motions_and_a_little_less_does_not():
    motions = [GROUND.motion, synthetic_motion(seed=7).scaled(1.4)]
    upright = needed_by(GROUND, motions)["upright"]
    assert "overturns" in [fate(GROUND, motion) for motion in motions]
    assert 2 * GROUND.block.half_width < upright
    assert "overturns" not in [fate(GROUND, motion, upright) for motion in motions]
    less = upright * np.linspace(0.984, 0.999, 16)
    assert "overturns" in [fate(GROUND, motion, width) for motion in motions for width in less]
    assert needed_by(GROUND, [PulseMotion("one-sine", 3.5, 20.0)])["upright"] is None  # it rocks as it is


def test_the_width_on_bearings_and_under_vertical_motion_is_that_of_the_run():
    stiff = ISOLATED.with_(bearings=Bearings(law="linear", ka=1e6, count=4, damping=1e4))
    up = SampledMotion(GROUND.motion.dt, 0.5 * np.roll(GROUND.motion.samples, 40))
    both = SampledMotion(GROUND.motion.dt, GROUND.motion.samples, vertical=up)
    for scene, motion in ((stiff, stiff.motion), (GROUND, both)):
        width = needed_by(scene, [motion])["stands"]
        assert fate(scene, motion, width) == "stands" and fate(scene, motion, 0.99 * width) == "rocks"
    weightless = SampledMotion(GROUND.motion.dt, GROUND.motion.samples, vertical=up.scaled(6.0))
    assert needed_by(GROUND, [weightless])["stands"] is None  # nothing presses it on the ground


def test_the_stroke_is_the_x_max_of_the_bearings_and_none_where_none_would_do():
    weak = ISOLATED.with_(motion=ISOLATED.motion.scaled(3.0))
    assert needed_by(weak, [weak.motion])["stroke"] > 0.1
    built = weak.with_(bearings={"x_max": 0.07})
    assert needed_by(built, [built.motion])["stroke"] == 0.07
    assert needed_by(GROUND, [PulseMotion("one-sine", 10.0, 2.3)])["stroke"] is None
    nothing = dict.fromkeys(("stroke", "stands", "upright", "slip", "friction"))
    assert needed_by(load_scene("free-rocking-isolated"), []) == nothing
    assert needed_by(GROUND.with_(start={"tilt": 0.01}), [GROUND.motion]) == nothing


SCENE = {"block": {"mass": 1551.83}, "base": None, "bearings": None, "half_width": 0.275}
BASE = {**SCENE, "base": {"mass": 400.0}}
NEEDED = {"stroke": 0.25, "stands": 0.8, "upright": 0.61}
SAID = [
    (SCENE, None, "rocking margin FILE", "there is nothing to do"),
    (SCENE, NEEDED, "rocking design FILE --base-mass 1550 --stroke 0.25", "Both numbers are examples"),
    (BASE, None, "rocking margin FILE", "On a base that nothing holds, the block does not lift"),
    (BASE, NEEDED, "rocking design FILE --stroke 0.25", "The stroke [m] is an example"),
    (
        {**BASE, "bearings": {"x_max": 0.25}},
        NEEDED,
        "rocking design FILE --stroke 0.25",
        "is the x_max of its bearings",
    ),
    (SCENE, NEEDED, "", "0.610 m wide (now 0.550 m) it does not overturn; fixed to one 0.800 m wide it does not lift"),
    (SCENE, {**NEEDED, "upright": None}, "", "fixed to a plate 0.800 m wide (now 0.550 m) it does not lift"),
    (SCENE, {**NEEDED, "stroke": None}, "rocking margin FILE", "likely to keep the block from lifting; widen"),
    (
        {**SCENE, "friction": 0.3},
        {**NEEDED, "upright": None, "friction": 0.4},
        "rocking design FILE --base-mass 1550 --stroke 0.25",
        "neither lifts nor slides. Both",
    ),
    (
        {**SCENE, "friction": 0.3},
        {"stroke": None, "stands": None, "upright": None, "friction": 0.4},
        "rocking margin FILE",
        "from lifting or sliding; it needs a friction coefficient of 0.400 (now 0.300) to stay in place.",
    ),
    (
        {**SCENE, "friction": 0.3},
        {**NEEDED, "slip": 0.0123, "friction": 0.4},
        "",
        "one 0.800 m wide it does not lift, but slides by up to 0.0123 m; it needs a friction coefficient of 0.400",
    ),
    (
        {**SCENE, "friction": 0.3},
        {"stroke": None, "stands": 0.8, "upright": None, "slip": 0.41, "friction": 0.4},
        "rocking margin FILE",
        "or sliding; fix it, as a plate does not suffice: on one 0.800 m wide (now 0.550 m) it slides by 0.410 m, more "
        "than half that width; it needs a friction coefficient of 0.400 (now 0.300) to stay in place.",
    ),
    (SCENE, dict.fromkeys(NEEDED), "rocking margin FILE", "lifting; widen, fix or lower it."),
]


@pytest.mark.parametrize("scene, needed, command, words", SAID)
def test_what_is_said_next(scene, needed, command, words):
    given, sentence = next_step(scene, needed, "FILE")
    assert command in ("", given) and words in sentence and sentence.endswith(".")


@pytest.mark.parametrize("amplitude, beyond", [(5.0, False), (8.0, True)])
def test_a_plate_on_which_the_block_slips_beyond_half_of_it_is_not_advised(amplitude, beyond):
    """A block that does not lift slips as far on every plate: by the run of a broad one."""
    motions = [PulseMotion("one-sine", amplitude, 3.0), PulseMotion("one-sine", 1.0, 3.0)]
    rubs = GROUND.with_(friction=0.35)
    needed = needed_by(rubs, motions)
    broad = rubs.with_(block=on_plate(rubs.block, 9.0), motion=motions[0], duration=None)
    assert needed["slip"] == pytest.approx(simulate(broad, history=False).sliding.peak, rel=1e-6)
    assert (needed["slip"] > needed["stands"] / 2) == beyond
    words = next_step({**SCENE, "friction": 0.35}, needed, "FILE")[1]
    assert ("a plate does not suffice" in words) == beyond and ("fixed to a plate" in words) != beyond


def test_where_the_friction_is_less_than_the_block_needs_it_is_said_and_how_wide_it_only_slides():
    rubs = GROUND.with_(friction=0.35)  # tan(gamma) is .288, the peak of the motion .515 g
    needed = needed_by(rubs, [rubs.motion])
    assert needed["friction"] == pytest.approx(rubs.motion.peak / rubs.gravity, rel=5e-3)
    assert fate(rubs, rubs.motion, needed["stands"]) == "slides"
    assert fate(rubs, rubs.motion, 0.95 * needed["stands"]) in ("rocks", "overturns")
    held = rubs.with_(friction=needed["friction"])
    assert fate(held, held.motion, needed["stands"] * needed["friction"] / 0.35 * 1.01) == "stands"
    assert needed_by(held, [held.motion])["friction"] is None
    slides = needed_by(rubs.with_(friction=0.2), [rubs.motion])  # before it lifts, on any plate
    assert (slides["stands"], slides["upright"]) == (None, None) and slides["friction"] == needed["friction"]
