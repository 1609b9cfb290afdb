"""Commands that write what a user goes on with: ``rocking new``, ``rocking script`` and ``rocking sheet``."""

import io
import json
import math
from pathlib import Path

import pytest
from made_up_records import VALUES, cosmos

from analytic import load_scene
from analytic.records import read_record
from analytic.rocking import BearingLaw, properties
from comparisons.sheet.pages import PROBLEMS

BUST = ("--height", "1.9", "--width", "0.55", "--material", "marble")


ISOLATED = (*BUST, "--base-mass", "400")
CONSTANTS = (*ISOLATED, "--ka", "1e5", "--kb", "1e4", "--alpha", "44")
DESIGN = (*ISOLATED, "--period", 2.5, "--xmax", 0.2)


def new(rocking, folder, *arguments):
    """(the scene, what is printed) of a new one in a folder."""
    status, out, err = rocking("new", folder / "bust.toml", *arguments)
    assert status == 0, err
    return load_scene(folder / "bust.toml"), out


def test_new_writes_a_scene_and_says_what_follows(rocking, tmp_path):
    scene, out = new(rocking, tmp_path, *DESIGN)
    assert scene.block.mass == pytest.approx(2700 * 1.9 * 0.55**2, rel=1e-5)
    assert (scene.bearings.count, scene.motion.dt) == (4, 0.005) and "0.28177 rad" in out


def test_new_names_a_record_as_seen_from_the_scene_and_a_channel_of_it(rocking, tmp_path):
    record = tmp_path / "records" / "own.v2c"
    record.parent.mkdir()
    record.write_text(cosmos(VALUES))
    scene, _ = new(rocking, tmp_path, *CONSTANTS, "--xmax", 0.2, "--record", record, "--channel", "Up")
    assert scene.bearings.x_max == 0.2
    assert scene.motion.digest() == read_record(record, channel="Up").digest()
    text = (tmp_path / "bust.toml").read_text()
    assert 'record = "records/own.v2c"' in text and 'channel = "Up"' in text


IMPLAUSIBLE = {
    "centimetres": (
        ("--height", "190", "--width", "55", "--mass", "1500"),
        ("--height 190", "0.1 to 10 m", "--height 1.9 --width 0.55 (from cm)?"),
    ),
    "one of them": (
        ("--height", "1.9", "--width", "55", "--mass", "1500"),
        ("0.1 to 10 m", "did you mean --height 1.9 --width 0.55 (from cm)?"),
    ),
    "exchanged": (
        ("--height", "0.55", "--width", "1.9", "--material", "marble"),
        ("1.29 rad", "0.1 to 0.5 rad", "exchange them"),
    ),
    "tonnes": ((*BUST[:4], "--mass", "1.5"), ("--mass 1.5", "2.61 kg/m3", "100", "8800", "in kg")),
    "g/cm3": ((*BUST[:4], "--density", "2.7"), ("--density", "2.7 kg/m3", "100", "8800")),
    "a fallen block": ((*BUST, "--tilt", "-1"), ("--tilt -1 is beyond its balance", "between 0 and", "0.2818 rad")),
    "a block that stands": ((*BUST, "--tilt", "0"), ("--tilt 0 releases the block where it stands", "0.2818 rad")),
    "stiff bearings": (
        (*ISOLATED, "--ka", "1e6", "--kb", "1e4", "--alpha", "44"),
        ("yield at 23.6 m/s2", "lifts at 2.84 m/s2", "a lower --ka"),
    ),
    "rough pendula": (
        (*ISOLATED, "--pendulum-radius", "2", "--pendulum-friction", "0.3"),
        (
            "yield at 2.94 m/s2",
            "lifts at 2.84 m/s2",
            "--pendulum-radius and --pendulum-friction",
            "a lower --pendulum-fric",
        ),
    ),
    "a short period": (
        (*ISOLATED, "--period", "0.5", "--xmax", "0.2"),
        ("yield at 8.07 m/s2", "lifts at 2.84 m/s2", "a longer --period, a lower --damping or a smaller --xmax"),
    ),
}


@pytest.mark.parametrize("arguments, words", IMPLAUSIBLE.values(), ids=IMPLAUSIBLE)
def test_what_cannot_well_be_is_refused_unless_wanted(rocking, tmp_path, arguments, words):
    file = tmp_path / "bust.toml"
    status, _, err = rocking("new", file, *arguments)
    assert status == 2 and not file.exists() and len(err.splitlines()) == 1
    assert all(word in err for word in (*words, "--anyway"))
    assert rocking("new", file, *arguments, "--anyway")[0] == 0 and load_scene(file)


@pytest.mark.parametrize("answer, status", [("y\n", 0), ("n\n", 2), ("\n", 2), ("", 2)])
def test_in_a_terminal_it_asks_back(rocking, tmp_path, monkeypatch, answer, status):
    terminal = io.StringIO(answer)
    monkeypatch.setattr(terminal, "isatty", lambda: True)
    monkeypatch.setattr("sys.stdin", terminal)
    file = tmp_path / "bust.toml"
    ended, _, err = rocking("new", file, *IMPLAUSIBLE["centimetres"][0])
    assert ended == status and file.exists() == (status == 0)
    assert "Write it anyway? [y/N]" in err and "Traceback" not in err


@pytest.mark.parametrize(
    "words",
    [*((*BUST[:4], "--mass", mass) for mass in (100, 4000)), *((*BUST, "--tilt", x) for x in (0.2817, -0.2817))],
)
def test_hollow_bronze_wood_and_a_tilt_short_of_the_balance_are_taken(rocking, tmp_path, words):
    """174 and 6960 kg/m3."""
    scene, _ = new(rocking, tmp_path, *words)
    assert words[-1] in (pytest.approx(scene.block.mass), scene.start.tilt)


def test_a_base_that_nothing_holds_is_asked_for_by_name(rocking, tmp_path):
    file = tmp_path / "bust.toml"
    status, _, err = rocking("new", file, *ISOLATED)
    assert status == 2 and not file.exists() and len(err.splitlines()) == 1
    for words in ("--base-mass 400", "a pedestal fixed to the ground, leave it out", "--period", "--slides-freely"):
        assert words in err
    scene, _ = new(rocking, tmp_path, *ISOLATED, "--slides-freely")
    assert scene.base.mass == 400 and scene.bearings is None


@pytest.mark.parametrize("more", [BUST, DESIGN])
def test_no_other_block_slides_freely(rocking, tmp_path, more):
    status, _, err = rocking("new", tmp_path / "bust.toml", *more, "--slides-freely")
    assert status == 2 and err.startswith("Error: --slides-freely") and not (tmp_path / "bust.toml").exists()


PENDULUM = (*ISOLATED, "--pendulum-radius", 2, "--pendulum-friction", 0.05)


def test_a_pendulum_is_written_with_its_limits_and_told(rocking, tmp_path):
    """Q = mu W and kb = W/R of the weight W on each of four; the period is that of the radius."""
    scene, out = new(rocking, tmp_path, *PENDULUM, "--xmax", 0.2)
    weight, law = scene.total_mass * 9.81 / 4, BearingLaw.of(scene.bearings)
    assert scene.bearings.law == "bilinear" and scene.bearings.x_max == 0.2
    assert (law.f0, law.kb) == pytest.approx((0.05 * weight, weight / 2), rel=1e-5)
    assert f"{2 * math.pi * math.sqrt(2 / 9.81):.4g}" in out
    text = (tmp_path / "bust.toml").read_text()
    for words in ("radius of curvature 2 m, friction 0.05", "Not modelled: friction that depends on velocity"):
        assert words in text and words in " ".join(out.split())
    (tmp_path / "bust.toml").unlink()
    form = json.loads(rocking("new", tmp_path / "bust.toml", *PENDULUM, "--json", "-")[1])  # without x_max, too
    assert form["sizes"]["kind"] == "pendulum" and form["sizes"]["radius"] == pytest.approx(2.0, rel=1e-5)


def test_new_says_that_no_such_bearing_is_made(rocking, tmp_path):
    _, out = new(rocking, tmp_path, *DESIGN)
    words = " ".join(out.split())
    assert "Each lead-rubber bearing: lead core 4.5 mm, rubber 31.2 mm in diameter, 133.3 mm high" in words
    assert "No such bearing is made: lead core 4.48 mm, below 50 mm" in words and "Assumed: lead yields at" in words
    (tmp_path / "bust.toml").unlink()
    assert "bearing:" not in new(rocking, tmp_path, *CONSTANTS)[1]  # without x_max the rubber is unknown


@pytest.mark.parametrize(
    "more, message",
    [
        (PENDULUM[:-2], "give the bearings' --period and --xmax, or --ka"),
        ((*PENDULUM, "--period", 2, "--xmax", 0.2), "or --pendulum-radius and --pendulum-friction"),
        ((*PENDULUM[:-1], -0.1), "--pendulum-friction = -0.1: give a number from"),
        ((*BUST, *PENDULUM[-4:]), "give its mass with --base-mass"),
    ],
)
def test_half_a_pendulum_is_refused(rocking, tmp_path, more, message):
    status, _, err = rocking("new", tmp_path / "bust.toml", *more)
    assert status == 2 and message in err and not (tmp_path / "bust.toml").exists()


def test_a_pedestal_is_written_and_its_mass_is_carried_by_the_bearings(rocking, tmp_path):
    words = ("--pedestal-width", 0.8, "--pedestal-mass", 430, "--pedestal-height", 1.0)
    scene, out = new(rocking, tmp_path, *DESIGN, *words)
    assert (scene.pedestal.width, scene.pedestal.mass, scene.pedestal.height) == (0.8, 430.0, 1.0)
    assert "uplift acceleration of block and pedestal together" in out
    on_base = properties(scene.bearings, scene.block.mass + 400 + 430, 0.2)
    assert on_base.period == pytest.approx(2.5, rel=1e-4) and scene.total_mass == scene.block.mass + 830


@pytest.mark.parametrize(
    "words, message",
    [
        (("--pedestal-mass", 430, "--pedestal-height", 1.0), "--pedestal-width: missing"),
        (("--pedestal-width", 0.8, "--pedestal-mass", 430), "--pedestal-height: missing; give mass and height"),
        (("--pedestal-width", 0.5), "--pedestal-width = 0.5: narrower than the block; give at least 0.55 m"),
    ],
)
def test_what_no_pedestal_can_be_is_refused_by_its_option(rocking, tmp_path, words, message):
    status, _, err = rocking("new", tmp_path / "bust.toml", *BUST, *words)
    assert status == 2 and message in err and not (tmp_path / "bust.toml").exists()


def test_the_script_says_that_its_support_has_no_edge(rocking, tmp_path):
    new(rocking, tmp_path, *BUST, "--pedestal-width", 0.8, "--friction", 0.6)
    status, out, _ = rocking("script", "pybullet", tmp_path / "bust.toml", "--output", tmp_path / "own.py")
    assert status == 0 and "The script's support has no edge" in out


def test_new_overwrites_nothing(rocking, tmp_path):
    file = tmp_path / "bust.toml"
    file.write_text("mine")
    status, _, err = rocking("new", file, *BUST)
    assert status == 2 and "exists" in err and file.read_text() == "mine"


@pytest.mark.parametrize("design_options", ["--damping 0.15", "--damping 0.3 --definition paper"])
def test_what_was_asked_for_is_in_the_json_in_the_sense_of_its_row(rocking, tmp_path, design_options):
    design = f"--base-mass 400 --period 2 --xmax 0.2 --ratio 20 {design_options}".split()
    content = json.loads(rocking("new", tmp_path / "bust.toml", *BUST, *design, "--json", "-")[1])
    scene, rows = load_scene(tmp_path / "bust.toml"), content["derived"]
    assert scene.bearings.ka / scene.bearings.kb == pytest.approx(20, rel=1e-5)
    targets = {row["name"]: (row["asked"], row["value"]) for row in rows if row["asked"] is not None}
    assert set(targets) == {"secant period at x_max", "equivalent damping at x_max"}
    assert targets["equivalent damping at x_max"][0] == 0.15
    assert [value for _, value in targets.values()] == pytest.approx(
        [wanted for wanted, _ in targets.values()], rel=1e-3
    )


def test_the_script_and_its_record_are_written(rocking, tmp_path):
    _, out, _ = rocking("script", "pybullet", "caryatid-isolated", "--output", tmp_path / "own.py")
    assert out.split() == [str(tmp_path / "own.py"), "written", str(tmp_path / "own-motion.txt"), "written"]
    assert "own-motion.txt" in (tmp_path / "own.py").read_text()
    assert (tmp_path / "own-motion.txt").read_text().startswith("# time [s], ground acceleration [m/s2]\n0 ")


def test_without_a_name_it_is_the_scenes_and_the_engines(rocking, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    status, out, err = rocking("script", "pybullet", "free-rocking-rigid")
    (file,) = tmp_path.iterdir()
    assert status == 0 and file.name.endswith("-pybullet.py") and out == f"{file.name} written\n"


@pytest.mark.parametrize(
    "arguments, message",
    [
        (("mujoco", "caryatid-rigid"), "mujoco: no engine with a script; choose one of"),
        (("bullet", "caryatid-rigid"), "bullet: no engine with a script; choose one of"),
        (("pybullet", "caryatid-rigid", "--output", "own.txt"), "--output own.txt: end the name in .py"),
        (("pybullet", "nowhere"), "nowhere"),
    ],
)
def test_mistakes_are_named(rocking, arguments, message):
    status, _, err = rocking("script", *arguments)
    assert status == 2 and message in err


def test_a_friction_that_the_script_does_not_keep_is_named(rocking, tmp_path):
    scene = tmp_path / "scene.toml"
    scene.write_text(
        "friction = 0.6\n[block]\nmass = 300.0\nradius = 1.0\nslenderness = 0.2\nrestitution = 0.8\n"
        "[start]\ntilt = 0.12\n"
    )
    status, out, err = rocking("script", "pybullet", scene, "--output", tmp_path / "own.py")
    assert status == 0, err
    assert "The scene's friction, 0.6, is not kept, and the block does not slide: below 4.93 it slips" in out


def test_the_sheet_and_its_answers_are_written(rocking, tmp_path):
    status, out, _ = rocking("sheet", "--output", tmp_path, "--json", tmp_path / "sheet.json")
    content = json.loads((tmp_path / "sheet.json").read_text())
    assert (
        status == 0 and content["files"] == out.splitlines() and all(Path(file).exists() for file in content["files"])
    )
    for written, problem in zip(content["problems"], PROBLEMS, strict=True):
        questions = [
            (quantity["quantity"], quantity["answer"], quantity["tolerance"]) for quantity in written["quantities"]
        ]
        assert questions == [
            (quantity.name, problem.answers[quantity.name], problem.tolerance(quantity))
            for quantity in problem.quantities
        ]
