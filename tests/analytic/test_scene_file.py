"""Scene files: what they give, and one clear message for every mistake."""

import pickle
from pathlib import Path

import pytest
from bad_scenes import BAD, SCENE, write_scene
from mutated_files import VALUES, csmip

from analytic import Base, Bearings, Block, PulseMotion, SceneError, Start, load_scene, shipped_scenes
from analytic.synthetic import synthetic_motion


def test_full_file(tmp_path):
    text = """
        name = "everything"
        gravity = 10
        [block]
        mass = 3172.05
        radius = 1.0884
        slenderness = 0.28
        corner_inertia = 5010.2
        restitution = 0.9
        [base]
        mass = 212.0
        [bearings]
        law = "bouc-wen"
        count = 4
        ka = 6.22e4
        kb = 6.22e3
        alpha = 44.69
        delta_k = 1e-18
        damping = 5.0
        [motion]
        pulse = "one-cosine"
        amplitude = -2.0
        frequency = 3
        start = 0.5
        scale = 2
        [start]
        tilt = 0.1
        tilt_rate = 0.2
        base_displacement = 0.3
        base_velocity = 0.4
        [run]
        duration = 20
    """
    scene = load_scene(write_scene(tmp_path, text))
    assert (scene.name, scene.gravity, scene.duration) == ("everything", 10.0, 20.0)
    assert scene.block == Block(mass=3172.05, radius=1.0884, slenderness=0.28, corner_inertia=5010.2, restitution=0.9)
    assert scene.base == Base(mass=212.0)
    assert scene.bearings == Bearings(
        law="bouc-wen", count=4, ka=6.22e4, kb=6.22e3, alpha=44.69, delta_k=1e-18, damping=5.0
    )
    assert scene.motion == PulseMotion("one-cosine", -4.0, 3.0, 0.5)
    assert scene.start == Start(tilt=0.1, tilt_rate=0.2, base_displacement=0.3, base_velocity=0.4)


def test_least_file(tmp_path):
    text = "[block]\nmass = 1\nradius = 1\nslenderness = 0.2\n[run]\nduration = 1\n"
    scene = load_scene(write_scene(tmp_path, text))
    assert (scene.base, scene.bearings, scene.motion, scene.gravity, scene.name) == (None, None, None, 9.81, "scene")


def with_motion(tmp_path, lines):
    return load_scene(write_scene(tmp_path, SCENE.replace('synthetic = "duzce-like"', lines))).motion


def test_record_is_looked_up_beside_the_scene_file(tmp_path, monkeypatch):
    (tmp_path / "records").mkdir()
    (tmp_path / "records" / "r.txt").write_text("0 1\n0.5 2\n")
    monkeypatch.chdir("/")
    motion = with_motion(tmp_path, 'record = "records/r.txt"\nunits = "cm/s2"\nscale = 3')
    assert motion.samples.tolist() == pytest.approx([0.03, 0.06])


@pytest.mark.parametrize("channel", ["2", '"2"', '"Up"'])
def test_a_channel_of_a_record_by_number_or_direction(tmp_path, channel):
    (tmp_path / "r.v2").write_text(csmip(VALUES))
    motion = with_motion(tmp_path, f'record = "r.v2"\nchannel = {channel}')
    assert motion.label == "r.v2, channel 2 (Up)" and motion.samples[0] == pytest.approx(2 * VALUES[0])


@pytest.mark.parametrize(
    "words, level, vertical",
    [
        ("", [0.03, 0.06, 0], [0.09, 0.12, 0.15]),
        ("time (s), acceleration (g)\n", [0.03, 0.06, 0], [3 * 3 * 9.81, 4 * 3 * 9.81, 5 * 3 * 9.81]),  # its own unit
    ],
)
def test_vertical_file_beside_the_record(tmp_path, words, level, vertical):
    (tmp_path / "h.txt").write_text("0 1\n0.5 2\n")
    (tmp_path / "v.txt").write_text(words + "0, 3\n0.5, 4\n1.0, 5\n")
    motion = with_motion(tmp_path, 'record = "h.txt"\nvertical = "v.txt"\nunits = "cm/s2"\nscale = 3')
    assert (motion.samples.tolist(), motion.vertical.samples.tolist()) == (
        pytest.approx(level),
        pytest.approx(vertical),
    )
    assert motion.label == "h.txt x 3, vertical v.txt x 3"
    assert motion.warnings[-1] == "h.txt x 3: 0.5 s of zeros put at its end, as the other component is longer"


@pytest.mark.parametrize("file", ["", 'vertical = "v.v2"\n'])
def test_vertical_channel_of_the_same_file_or_another(tmp_path, file):
    for name in ("r.v2", "v.v2"):
        (tmp_path / name).write_text(csmip(VALUES))
    motion = with_motion(tmp_path, f'record = "r.v2"\nchannel = 1\n{file}vertical_channel = "Up"\nscale = 0.5')
    assert motion.samples[0] == pytest.approx(0.5 * VALUES[0])
    assert motion.vertical.samples[0] == pytest.approx(VALUES[0])
    assert motion.vertical.label == f"{'v' if file else 'r'}.v2, channel 2 (Up) x 0.5"


def test_columns_of_a_logger_at_a_step_that_is_given(tmp_path):
    (tmp_path / "r.csv").write_text("x;y;z\n" + "".join(f"{a};{-a};{0.5 * a}\n" for a in VALUES))
    motion = with_motion(tmp_path, 'record = "r.csv"\nunits = "g"\ndt = 0.02\ncolumn = 2\nvertical_column = 3')
    assert (motion.dt, motion.label) == (0.02, "r.csv, column 2 (y), vertical r.csv, column 3 (z)")
    assert motion.samples[1] == pytest.approx(-9.81 * VALUES[1])
    assert motion.vertical.samples[1] == pytest.approx(0.5 * 9.81 * VALUES[1])


def test_vertical_ratio_of_a_pulse_with_a_phase(tmp_path):
    lines = 'pulse = "one-sine"\namplitude = 2\nfrequency = 5\nvertical_ratio = 0.5\nvertical_phase = 0.7\nscale = 3'
    up = PulseMotion("one-sine", 3.0, 5.0, phase=0.7)
    assert with_motion(tmp_path, lines) == PulseMotion("one-sine", 6.0, 5.0, vertical=up)
    for lines in (
        lines.replace("vertical_ratio = 0.5\nvertical_phase = 0.7\n", more) for more in ("", "vertical_ratio = 0\n")
    ):
        assert with_motion(tmp_path, lines) == PulseMotion("one-sine", 6.0, 5.0)


def test_vertical_ratio_of_a_synthetic_motion_has_a_seed_of_its_own(tmp_path):
    for more, seed in (("", 6), ("\nvertical_seed = 9", 9)):
        motion = with_motion(tmp_path, f'synthetic = "duzce-like"\nseed = 5\nscale = 2\nvertical_ratio = 0.6{more}')
        assert motion.samples.tolist() == pytest.approx(synthetic_motion(seed=5).scaled(2).samples.tolist())
        wanted = synthetic_motion(seed=seed).scaled(1.2).samples.tolist()
        assert motion.vertical.samples.tolist() == pytest.approx(wanted, rel=1e-12)


def test_shipped_scenes():
    names = ("caryatid-rigid", "caryatid-isolated", "free-rocking-rigid", "free-rocking-isolated")
    assert sorted(shipped_scenes()) == sorted(names)
    scenes = [load_scene(name) for name in names]
    block, table_1b = scenes[0].block, Bearings(count=4, ka=6.22e4, kb=6.22e3, alpha=44.69, delta_k=1e-20, x_max=0.30)
    assert [scene.block for scene in scenes] == 4 * [block]
    assert [scene.bearings for scene in scenes] == [None, table_1b, None, table_1b]
    assert all("synthetic" in scene.motion.label for scene in scenes[:2])
    assert [scene.start.tilt for scene in scenes[2:]] == pytest.approx(2 * [0.6 * block.slenderness])


def test_a_file_goes_before_a_shipped_scene_of_that_name(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("caryatid-rigid").write_text(SCENE.replace("20.0", "3.0"))
    assert load_scene("caryatid-rigid").duration == 3.0


@pytest.mark.parametrize("change, message", BAD.values(), ids=BAD)
def test_bad_file(tmp_path, change, message):
    path = write_scene(tmp_path, change(SCENE))
    with pytest.raises(SceneError) as caught:
        load_scene(path)
    error = caught.value
    assert str(error).startswith(f"{path}: {message}")
    assert error.file == str(path) and error.key and error.remedy


def test_all_mistakes_of_a_file_are_told_at_once(tmp_path):
    text = SCENE.replace("3172.05", "-1.0").replace("212.0", '"light"').replace("20.0", "20.0\nend = 3")
    path = write_scene(tmp_path, text)
    with pytest.raises(SceneError) as caught:
        load_scene(path)
    error = pickle.loads(pickle.dumps(caught.value))  # as it comes from another process
    assert [mistake.key for mistake in (error, *error.others)] == ["run.end", "block.mass", "base.mass"]
    assert str(error).splitlines() == [
        f"{path}: run.end = 3: unknown key; remove it, known are duration",
        f"{path}: block.mass = -1.0: out of range; give a number above 0 [kg]",
        f"{path}: base.mass = 'light': wrong type (str); give a number [kg]",
    ]


def test_the_lines_of_a_message_are_no_more_than_a_screen_holds(tmp_path):
    with pytest.raises(SceneError) as caught:
        load_scene(write_scene(tmp_path, "".join(f"a{n} = 1\n" for n in range(100)) + SCENE))
    assert len(caught.value.others) == 99 and str(caught.value).splitlines()[20:] == ["and 80 more"]


def test_no_such_scene():
    with pytest.raises(SceneError) as caught:
        load_scene("no-such-scene")
    assert str(caught.value) == (
        "no-such-scene: scene: cannot be read (No such file or directory); give a scene file "
        "or one of caryatid-isolated, caryatid-rigid, free-rocking-isolated, "
        "free-rocking-rigid"
    )


@pytest.mark.parametrize(
    ("changes", "keys"),
    [
        ({"3172.05": "-1", 'synthetic = "duzce-like"': 'record = "no.AT2"'}, ["block.mass", "motion.record"]),
        (
            {"[base]\nmass = 212.0\n": "", 'synthetic = "duzce-like"': 'record = "no.AT2"'},
            ["motion.record", "bearings"],
        ),
        ({"3172.05": "-1", '"duzce-like"': '"kobe"'}, ["block.mass", "motion.synthetic"]),  # told once
    ],
)
def test_the_motion_is_told_with_other_mistakes(tmp_path, changes, keys):
    text = SCENE
    for before, after in changes.items():
        assert before in text
        text = text.replace(before, after)
    with pytest.raises(SceneError) as caught:
        load_scene(write_scene(tmp_path, text))
    assert [one.key for one in (caught.value, *caught.value.others)] == keys
