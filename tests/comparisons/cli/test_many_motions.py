"""run and margin under many motions: a row for each, as single runs find them, and the odds by record."""

import json

import numpy as np
import pytest

from analytic import SampledMotion, load_scene, margins, simulate
from comparisons.commands import margin
from comparisons.measuring.statistics import wilson
from comparisons.running.options import OWN
from comparisons.showing.margins import LIFTED, odds

OWN_RECORD = '[block]\nmass = 100.0\nradius = 1.0\nslenderness = 0.25\n[motion]\nrecord = "records/A090.csv"\n'
TIME = 0.01 * np.arange(300)


@pytest.fixture(autouse=True)
def coarse(monkeypatch):
    """What is told of margins holds on any grid; that of a user is fine (`test_roads`)."""
    monkeypatch.setattr(margin, "STEPS", 20)
    monkeypatch.setattr(margins, "BISECTIONS", 3)


@pytest.fixture
def folder(tmp_path):
    """A pair of components, a weak single one, and a file that is none."""
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
