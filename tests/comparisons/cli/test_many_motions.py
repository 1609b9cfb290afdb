"""run and margin under many motions: a row for each, as single runs find them; the odds by record; margins of one."""

import json

import numpy as np
import pytest

from analytic import PulseMotion, SampledMotion, Scene, load_scene, simulate
from analytic.advice.margins import Band, Contact, Margin, margins
from comparisons.execution.command_runs import OWN
from comparisons.metrics.statistics import wilson
from comparisons.plotting.margins import LIFTED, draw_margins, odds, print_margins
from comparisons.studies.stability.cases import BLOCK, GAP, THRESHOLD

BLOCK_100 = "[block]\nmass = 100.0\nradius = 1.0\nslenderness = 0.25\n"
OWN_RECORD = BLOCK_100 + '[motion]\nrecord = "records/A090.csv"\n'
PULSE = BLOCK_100 + '[motion]\npulse = "one-sine"\namplitude = 3.0\nfrequency = 6.0\n'
TIME = 0.01 * np.arange(300)
PEAKS = {"A000.csv": 4.0, "A090.csv": 2.0, "weak.csv": 0.1, "plain.txt": 0.1}


def columns(peak, head="t [s],a [m/s2]"):
    return "\n".join([head, *(f"{t:.2f},{peak * np.sin(6 * t):.8f}" for t in TIME)])


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A pair of components, a weak single one, and a file that is none; the scans of margins are coarse."""
    monkeypatch.setattr("comparisons.commands.advice.STEPS", 20)
    monkeypatch.setattr("analytic.advice.margins.BISECTIONS", 3)
    (tmp_path / "records").mkdir()
    for name, peak in [*PEAKS.items()][:3]:
        (tmp_path / "records" / name).write_text(columns(peak))
    (tmp_path / "records" / "notes.txt").write_text("words\n")
    return tmp_path / "records"


RECORDS = ["A*.csv", "A*.csv", "weak.csv"]
SIGNS = ("--directions", 2, "--both-signs")
UP = {"A-UP.csv": columns(0.1).replace("0.00,0.0", "0.00,0.1")}
PLAIN = columns(0.1, "").replace(",", " ").strip()
# (scene, options, more files, records of the rows, how many are counted, what is left out beside the notes)
MANY = {
    "a symmetric block under both signs": (PULSE, SIGNS, {}, [OWN, *RECORDS], "3 motions", 1),
    "a tilted block under both signs": (
        OWN_RECORD + "scale = 0.3\n[start]\ntilt = 0.02\n",
        SIGNS[2:],
        {},
        [OWN, OWN, *["A*.csv"] * 4, *["weak.csv"] * 2],
        "3 motions",
        0,
    ),
    "the scene's own record": (OWN_RECORD, (), {}, RECORDS, "2 records", 0),
    "with its vertical one": (OWN_RECORD + 'vertical = "records/A-UP.csv"\n', (), UP, RECORDS, "2 records", 0),
    "the vertical one of another": (PULSE, (), UP, [OWN, *RECORDS], "3 motions", 1),
    "read otherwise": (
        OWN_RECORD.replace("A090.csv", "plain.txt") + 'units = "g"\n',
        ("--units", "m/s2"),
        {"plain.txt": PLAIN, "weak.csv": "words"},
        ["plain.txt", "plain.txt", "A*.csv", "A*.csv"],
        "2 records",
        1,
    ),
    "a copy": (PULSE, (), {"copy.csv": columns(0.1)}, [OWN, *RECORDS[:2], "copy.csv"], "3 motions", 1),
}


@pytest.mark.parametrize("command", ["run", "margin"])
@pytest.mark.parametrize("text, options, more, records, count, left", MANY.values(), ids=MANY)
def test_every_motion_has_its_row_as_a_run_of_its_own_finds_it_and_each_record_counts_once(
    rocking, folder, command, text, options, more, records, count, left
):
    for name, lines in more.items():
        (folder / name).write_text(lines)
    (folder.parent / "own.toml").write_text(text)
    status, out, err = rocking(command, folder.parent / "own.toml", "--records", folder, *options, "--json", "-")
    answer, scene = json.loads(out), load_scene(folder.parent / "own.toml")
    rows = answer["motions"]
    assert status == 0 and [row["record"] for row in rows] == records and f"of {count} (" in answer["headline"]
    assert ("mirrored the same" in err) == (options == SIGNS) and len(answer["left_out"]) == 1 + left
    assert "notes.txt: left out" in err and all(line in err for line in answer["left_out"])
    own_row, *_ = rows
    assert own_row["outcome"] == simulate(scene, history=False).outcome and own_row["peak"] == pytest.approx(
        scene.motion.peak
    )
    for row in rows[1:]:
        if row["motion"] in PEAKS:
            samples = np.round(PEAKS[row["motion"]] * np.sin(6 * TIME), 8)
            alone = simulate(scene.with_(motion=SampledMotion(0.01, samples)), history=False)
            assert row["outcome"] == alone.outcome
            assert command == "margin" or row["tilt"] == pytest.approx(alone.peak_tilt_ratio, rel=1e-9)


def test_the_page_reads_a_folder_by_the_unit_given(rocking, folder, monkeypatch):
    """It was said to belong to a record of its own."""
    by_name = {}
    monkeypatch.setattr("comparisons.report.runs.make_own_results", lambda *_, motions, **__: by_name.update(motions))
    monkeypatch.setattr("comparisons.report.write.write_page", lambda *_: 1 / 0)
    for file in folder.glob("*.csv"):
        file.write_text(file.read_text().replace("a [m/s2]", "a"))
    with pytest.raises(ZeroDivisionError):
        rocking("report", "caryatid-rigid", "--records", folder, "--units", "g", "--output", folder.parent / "page")
    weak = by_name["caryatid-rigid"]["weak.csv"][0]
    assert weak.peak == pytest.approx(0.1 * 9.80665, rel=1e-3)


def test_run_prints_the_odds_of_records_and_not_of_motions(rocking, folder):
    status, out, _ = rocking("run", "caryatid-isolated", "--records", folder, "--both-signs")
    assert status == 0
    low, high = wilson(0, 3)
    words = " ".join(out.split())  # the scene's own motion is no record
    assert f"under 0 of 3 motions ({100 * low:.0f} to {100 * high:.0f} % at 95 %)" in words
    assert "Components, directions and signs count as one motion. Left out of the folder: 1 file or channel." in words


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


def test_ten_times_a_weak_motion_does_not_lift_the_block(rocking, folder):
    status, out, err = rocking("margin", "caryatid-rigid", "--records", folder, "--span", 900, "--json", "-")
    (weak,) = (row for row in json.loads(out)["motions"] if row["motion"] == "weak.csv")
    assert status == 0 and (weak["outcome"], weak["changes"]["lifts"], weak["reached"]) == ("stands", None, []), err


def test_margin_tells_what_is_reached_now_from_what_a_change_reaches(rocking, folder):
    _, out, _ = rocking("margin", "caryatid-rigid", "--records", folder, "--json", folder.parent / "found.json")
    shown = json.loads((folder.parent / "found.json").read_text())["motions"]
    strong = next(row for row in shown if row["motion"] == "A000.csv")
    assert strong["outcome"] == "overturns" and strong["reached"] == ["lifts", "tilt", "overturns"]
    table, kept = out[out.index("[g]") :], [row["changes"][state] for row in shown for state in row["reached"]]
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


def margin(rocking, folder, text, *options):
    """(what is printed, the JSON) of the margins of a scene."""
    (folder / "scene.toml").write_text(text)
    status, out, err = rocking("margin", folder / "scene.toml", *options, "--json", folder / "margin.json")
    assert status == 0, err
    return " ".join(out.split()), json.loads((folder / "margin.json").read_text())


def test_margin_names_the_nearest_change_of_the_outcome_and_draws_it(rocking, tmp_path):
    words, content = margin(rocking, tmp_path, RELEASED.format(tilt=0.26), "--plot", tmp_path / "margin.png")
    assert "Nearest change of the outcome: slenderness -7.14 %, the block then overturns." in words
    assert "scene: rocks now: lifts, tilt > 0.5 γ" in words
    assert (tmp_path / "margin.png").read_bytes().startswith(b"\x89PNG")
    nearest = content["margins"][0]
    assert (nearest["quantity"], nearest["nearest"]) == ("slenderness", pytest.approx(0.26 / 0.28 - 1, abs=1e-7))
    assert nearest["changes"] == {"lifts": None, "tilt": None, "overturns": nearest["nearest"]}
    assert [(band["reached"], band["outcome"]) for band in nearest["bands"]] == [
        (["lifts", "tilt", "overturns"], "overturns"),
        (["lifts", "tilt"], "rocks"),
    ]


def test_margin_of_a_friction_says_where_the_block_slides(rocking, tmp_path):
    """Under a constant acceleration of 2.5 m/s2, .2548 g, it slides from friction .26 (1 - .0198) down."""
    words, content = margin(rocking, tmp_path, PUSHED)
    assert "Nearest change of the outcome: friction -1.98 %, the block then slides." in words
    assert "quantity value slides lifts > 0.5 γ" in words and "friction 0.26 -1.98 %" in words
    assert "The friction demand is 0.255, the scene's coefficient 0.26." in words
    nearest = next(each for each in content["margins"] if each["quantity"] == "friction")
    assert nearest["nearest"] == pytest.approx(2.5 / 9.81 / 0.26 - 1, abs=1e-7)
    assert [band["outcome"] for band in nearest["bands"]] == ["slides", "stands"]


SAID = {
    (0.01, "--span", "5"): (
        "No change of up to 5 % of any one quantity changes the outcome.",
        "No change of up to 5 % of slenderness, restitution, size, start changes any of these",
    ),
    (0.03, "--tilt", "0.1"): (  # a limit of one's own
        "scene: rocks now: lifts, tilt > 0.1 γ",
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
    tilt, *options = arguments
    words, _ = margin(rocking, tmp_path, RELEASED.format(tilt=tilt), *options)
    assert all(sentence in words for sentence in sentences)


def test_every_limit_state_has_its_column_and_the_widest_numbers_fit(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    scene = load_scene("caryatid-isolated")
    result = Margin(
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
    print_margins(scene, [result], Contact.of(scene, simulate(scene.with_(duration=None), history=False)), 900.0, 0.25)
    shown = capsys.readouterr().out
    assert max(map(len, shown.splitlines())) <= 80 and "…" not in shown and "now: lifts\n" in shown
    words = " ".join(shown.split())
    assert "no longer tilt base" in words and "quantity value lifts > 0.25 γ > x_max overturns left at" in words
    assert "yield force 1.2345e-11 kg -0.123 % -0.123 % -0.123 % +123 % -12.3 %" in words


@pytest.mark.parametrize("least, is_shown", [(0.9996, False), (0.98, True)])
def test_a_normal_force_that_does_not_fall_is_not_said_to(least, is_shown, capsys):
    scene = Scene(block=BLOCK, motion=PulseMotion("one-sine", 0.5 * THRESHOLD, 7.8))
    print_margins(scene, margins(scene, span=0.01, step=0.01), Contact(least, 0.1, None), 1.0, 0.5)
    assert ("The normal force falls to" in " ".join(capsys.readouterr().out.split())) == is_shown


def test_interleaved_outcomes_are_said(capsys):
    scene = Scene(block=BLOCK, motion=PulseMotion("one-sine", 1.1 * GAP * THRESHOLD, 7.8))
    for step, interleaved in ((0.04, True), (0.01, False)):
        results = [margin for margin in margins(scene, span=0.16, step=step) if margin.quantity == "motion"]
        print_margins(scene, results, Contact.of(scene, simulate(scene.with_(duration=None), history=False)), 16.0, 0.5)
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
