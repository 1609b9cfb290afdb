"""run and margin under many motions: a row for each, as single runs find them; the odds by record; margins of one."""

import json

import numpy as np
import pytest

from analytic import PulseMotion, SampledMotion, Scene, load_scene, simulate
from analytic.margins import Band, Contact, Margin, margins
from comparisons.measuring.statistics import wilson
from comparisons.running.options import OWN
from comparisons.showing.margins import LIFTED, draw_margins, odds, print_margins
from comparisons.studies.stability.cases import BLOCK, GAP, THRESHOLD

OWN_RECORD = '[block]\nmass = 100.0\nradius = 1.0\nslenderness = 0.25\n[motion]\nrecord = "records/A090.csv"\n'
TIME = 0.01 * np.arange(300)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A pair of components, a weak single one, and a file that is none; the scans of margins are coarse."""
    monkeypatch.setattr("comparisons.commands.margin.STEPS", 20)
    monkeypatch.setattr("analytic.margins.BISECTIONS", 3)
    (tmp_path / "records").mkdir()
    for name, peak in (("A000.csv", 4.0), ("A090.csv", 2.0), ("weak.csv", 0.1)):
        rows = (f"{t:.2f},{peak * np.sin(6 * t):.8f}" for t in TIME)
        (tmp_path / "records" / name).write_text("\n".join(["t [s],a [m/s2]", *rows]))
    (tmp_path / "records" / "notes.txt").write_text("words\n")
    return tmp_path / "records"


def test_run_tells_every_motion_as_a_run_of_its_own_does(rocking, folder):
    status, out, err = rocking(
        "run", "caryatid-rigid", "--records", folder, "--directions", 2, "--both-signs", "--json", "-"
    )
    assert status == 0 and "notes.txt: left out" in err and "mirrored the same" in err, err
    rows = json.loads(out)["motions"]
    assert len(rows) == 1 + 2 + 1  # a symmetric block: each motion once
    scene = load_scene("caryatid-rigid")
    for row, peak in zip(rows[1:3], (4.0, 2.0), strict=True):
        found = simulate(scene.with_(motion=SampledMotion(0.01, np.round(peak * np.sin(6 * TIME), 8))), history=False)
        assert row["outcome"] == found.outcome
        assert row["tilt"] == pytest.approx(found.peak_tilt_ratio, rel=1e-9)
    assert rows[-1]["outcome"] == "stands"


def test_a_tilted_block_is_run_under_both_signs(rocking, folder):
    file = folder.parent / "tilted.toml"
    file.write_text(f"{OWN_RECORD}scale = 0.3\n[start]\ntilt = 0.02\n")  # another motion than the record's
    status, out, err = rocking("run", file, "--records", folder, "--both-signs", "--json", "-")
    assert status == 0 and "mirrored" not in err, err
    rows = json.loads(out)["motions"]
    assert len(rows) == 2 * (1 + 2 + 1)
    scene = load_scene(file)
    mirrored = simulate(scene.with_(motion=scene.motion.scaled(-1.0)), history=False)
    assert rows[1]["tilt"] == pytest.approx(mirrored.peak_tilt_ratio, rel=1e-9) != rows[0]["tilt"]


def test_the_scenes_own_record_in_the_folder_counts_once(rocking, folder):
    file = folder.parent / "own.toml"
    file.write_text('[block]\nmass = 100.0\nradius = 1.0\nslenderness = 0.25\n[motion]\nrecord = "records/A090.csv"\n')
    status, out, _ = rocking("run", file, "--records", folder)
    assert status == 0 and "of 2 records" in " ".join(out.split()) and out.count("A090.csv") == 1
    rows = json.loads(rocking("run", file, "--records", folder, "--json", "-")[1])["motions"]
    assert [row["record"] for row in rows] == ["A*.csv", "A*.csv", "weak.csv"]
    assert [row["peak"] for row in rows[:2]] == pytest.approx([2.0, 4.0], rel=1e-3)


def test_the_scenes_own_record_with_a_vertical_one_in_the_folder_counts_once(rocking, folder):
    (folder / "A-UP.csv").write_text((folder / "weak.csv").read_text().replace("0.00,0.0", "0.00,0.1"))
    file = folder.parent / "own.toml"
    file.write_text(f'{OWN_RECORD}vertical = "records/A-UP.csv"\n')
    for command in ("run", "margin"):
        answer = json.loads(rocking(command, file, "--records", folder, "--json", "-")[1])
        assert [row["record"] for row in answer["motions"]] == ["A*.csv", "A*.csv", "weak.csv"]
        assert "vertical A-UP.csv" in answer["motions"][0]["motion"] and "of 2 records" in answer["headline"]
        assert [line.partition(":")[0] for line in answer["left_out"]] == ["notes.txt"]
    answer = json.loads(rocking("run", "caryatid-rigid", "--records", folder, "--json", "-")[1])
    assert sum("A-UP.csv: left out, a vertical motion; a scene whose" in line for line in answer["left_out"]) == 1


def test_the_same_record_read_otherwise_is_another_motion_of_it(rocking, folder):
    (folder / "plain.txt").write_text("".join(f"{t:.2f} {0.1 * np.sin(6 * t):.8f}\n" for t in TIME))
    file = folder.parent / "own.toml"
    file.write_text(OWN_RECORD.replace("A090.csv", "plain.txt") + 'units = "g"\n')
    out = rocking("run", file, "--records", folder, "--units", "m/s2", "--json", "-")[1]
    rows = [row for row in json.loads(out)["motions"] if row["record"] == "plain.txt"]
    assert [row["peak"] for row in rows] == pytest.approx([0.981, 0.1], rel=1e-3)


@pytest.mark.parametrize("command", ["run", "margin", "report"])
@pytest.mark.parametrize("number, words", [(10**9, "give at most"), (0, "give 1 or more")])
def test_directions_out_of_bounds_are_refused_by_the_option(rocking, folder, tmp_path, command, number, words):
    more = ("--output", tmp_path / "page") if command == "report" else ()
    status, _, err = rocking(command, "caryatid-rigid", "--records", folder, "--directions", number, *more)
    assert status == 2 and f"Error: --directions = {number}: " in err and words in err


@pytest.mark.parametrize("command", ["run", "margin", "design --stroke 0.3"])
def test_a_unit_without_records_is_refused(rocking, command):
    name, *options = command.split()
    status, _, err = rocking(name, "caryatid-isolated", *options, "--units", "g")
    assert status == 2 and err == "Error: --units g: give the folder of the records with --records\n"


def test_the_page_reads_a_folder_by_the_unit_given(rocking, folder, monkeypatch):
    """It was said to belong to a record of its own."""
    found = {}
    monkeypatch.setattr("comparisons.report.study.make_own_results", lambda *_, motions, **__: found.update(motions))
    monkeypatch.setattr("comparisons.report.write.write_page", lambda *_: 1 / 0)
    for file in folder.glob("*.csv"):
        file.write_text(file.read_text().replace("a [m/s2]", "a"))
    with pytest.raises(ZeroDivisionError):
        rocking("report", "caryatid-rigid", "--records", folder, "--units", "g", "--output", folder.parent / "page")
    weak = found["caryatid-rigid"]["weak.csv"][0]
    assert weak.peak == pytest.approx(0.1 * 9.80665, rel=1e-3)


def test_run_prints_the_odds_of_records_and_not_of_motions(rocking, folder):
    status, out, _ = rocking("run", "caryatid-isolated", "--records", folder, "--both-signs")
    assert status == 0
    low, high = wilson(0, 3)
    words = " ".join(out.split())  # the scene's own motion is no record
    assert f"under 0 of 3 motions ({100 * low:.0f} to {100 * high:.0f} % at 95 %)" in words
    assert "Components, directions and signs count as one motion. Left out of the folder: 1 file or channel." in words


def test_what_is_counted_is_called_motions_where_the_scenes_own_is_no_record(rocking, folder):
    (folder / "copy.csv").write_text((folder / "weak.csv").read_text())
    rows = json.loads(rocking("run", "caryatid-rigid", "--records", folder, "--json", "-")[1])
    assert [row["record"] for row in rows["motions"]] == [OWN, "A*.csv", "A*.csv", "copy.csv"]
    assert "weak.csv: left out, same as copy.csv" in rows["left_out"] and "of 3 motions (" in rows["headline"]
    for command in ("run", "margin"):
        alone = json.loads(rocking(command, "caryatid-rigid", "--both-signs", "--json", "-")[1])
        assert [row["record"] for row in alone["motions"]] == [OWN] and "of 1 motion (" in alone["headline"]
    file = folder.parent / "own.toml"
    file.write_text(OWN_RECORD)
    rows = json.loads(rocking("run", file, "--records", folder, "--json", "-")[1])
    assert "of 2 records (" in rows["headline"] and "count as one" not in rows["headline"]


# under the strong records the given restitution asks for more than the friction gives, under the weak one not
GIVEN = """friction = 0.3
[block]
mass = 400.0
radius = 1.0
slenderness = 0.25
restitution = 0.5
"""


@pytest.mark.parametrize("command", ["run", "margin"])
def test_a_motion_under_which_the_model_fails_ends_with_status_1_and_the_rest_is_told(rocking, folder, command):
    file = folder.parent / "given.toml"
    file.write_text(GIVEN)
    status, out, _ = rocking(command, file, "--records", folder, "--json", "-")
    answer = json.loads(out)
    failed = [row["motion"] for row in answer["motions"] if row["failure"]]
    assert status == 1 and failed and len(failed) < len(answer["motions"]) and "No outcome under" in answer["headline"]
    for name in failed:
        (folder / name).unlink()
    status, out, _ = rocking(command, file, "--records", folder, "--json", "-")
    assert status == 0 and [row["failure"] for row in json.loads(out)["motions"]] == [None] * (3 - len(failed))


def test_margin_tells_for_each_motion_what_change_of_it_lifts_the_block(rocking, folder):
    status, out, err = rocking("margin", "caryatid-rigid", "--records", folder, "--span", 900, "--json", "-")
    assert status == 0, err
    (weak,) = (row for row in json.loads(out)["motions"] if row["motion"] == "weak.csv")
    scene = load_scene("caryatid-rigid")
    assert weak["peak"] * 10 < scene.gravity * np.tan(scene.block.slenderness)
    assert weak["outcome"] == "stands" and weak["changes"]["lifts"] is None  # ten times .1 m/s2 do not lift it
    assert weak["reached"] == []


def test_margin_tells_what_is_reached_now_from_what_a_change_reaches(rocking, folder):
    _, out, _ = rocking("margin", "caryatid-rigid", "--records", folder, "--json", folder.parent / "found.json")
    told = json.loads((folder.parent / "found.json").read_text())["motions"]
    strong = next(row for row in told if row["motion"] == "A000.csv")
    assert strong["outcome"] == "overturns" and strong["reached"] == ["lifts", "tilt", "overturns"]
    table, kept = out[out.index("[g]") :], [row["changes"][state] for row in told for state in row["reached"]]
    assert (table.count("no longer"), table.count(" now ")) == (len(kept) - kept.count(None), kept.count(None))
    assert 0 < kept.count(None) < len(kept)


@pytest.mark.parametrize(
    ("outcomes", "words"),
    [
        ([("a", "rocks"), ("a", "stands"), ("b", "stands")], "1 of 2"),
        ([("a", "rocks"), ("a", "failed"), ("b", "stands")], "1 of 2"),
        ([("a", "stands"), ("a", "failed"), ("b", "stands")], "0 of 1"),
        ([("a", "overturns"), ("b", "rocks"), ("c", "failed")], "2 of 2"),
        ([("a", "failed")], "no record"),
    ],
)
def test_a_record_counts_once_and_a_failed_one_not_at_all(outcomes, words):
    rows = [{"record": record, "outcome": outcome} for record, outcome in outcomes]
    assert f"lifts under {words}" in odds(rows, LIFTED, "lifts")


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
