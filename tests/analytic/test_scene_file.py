"""Scene files: what they give, and one clear message for every mistake."""

import pickle
from pathlib import Path

import pytest
from bad_scenes import BAD, SCENE, write_scene
from made_up_records import VALUES, csmip

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


def with_motion(folder, lines):
    """The motion of a scene whose [motion] holds these lines."""
    return load_scene(write_scene(folder, SCENE.replace('synthetic = "duzce-like"', lines))).motion


def refusal(folder, text):
    """The error that a scene file of this text gives."""
    with pytest.raises(SceneError) as caught:
        load_scene(write_scene(folder, text))
    return caught.value


FILES = {
    "h.txt": "0 1\n0.5 2\n",
    "v.txt": "0 3\n0.5 4\n1.0 5\n",
    "g.txt": "time (s), acceleration (g)\n0, 1\n0.5, 2\n",
    "r.v2": csmip(VALUES),
    "v.v2": csmip(VALUES),
    "r.csv": "x;y;z\n" + "".join(f"{a};{-a};{0.5 * a}\n" for a in VALUES),
}
H, HALF = [0.01, 0.02], [0.5 * a for a in VALUES]
TWICE, IN_G = [2 * a for a in VALUES], [-9.81 * a for a in VALUES]
BOTH = "r.v2, channel 1 (90 Deg) x 0.5, vertical {}.v2, channel 2 (Up) x 0.5"
UP = 'vertical_channel = "Up"\nscale = 0.5'
# lines of [motion], label, samples, those of the vertical motion
RECORDS = [
    ('record = "records/h.txt"\nunits = "cm/s2"\nscale = 3', "h.txt x 3", [0.03, 0.06], None),
    *((f'record = "r.v2"\nchannel = {one}', "r.v2, channel 2 (Up)", TWICE, None) for one in ("2", '"2"', '"Up"')),
    (
        'record = "h.txt"\nvertical = "v.txt"\nunits = "cm/s2"\nscale = 3',
        "h.txt x 3, vertical v.txt x 3",
        [0.03, 0.06, 0],
        [0.09, 0.12, 0.15],
    ),
    # units are for the file that does not say its own
    ('record = "h.txt"\nvertical = "g.txt"\nunits = "cm/s2"', "h.txt, vertical g.txt", H, [9.81, 19.62]),
    (f'record = "r.v2"\nchannel = 1\n{UP}', BOTH.format("r"), HALF, VALUES),
    (f'record = "r.v2"\nchannel = 1\nvertical = "v.v2"\n{UP}', BOTH.format("v"), HALF, VALUES),
    (
        'record = "r.csv"\nunits = "g"\ndt = 0.5\ncolumn = 2\nvertical_column = 3',
        "r.csv, column 2 (y), vertical r.csv, column 3 (z)",
        IN_G,
        [-0.5 * a for a in IN_G],
    ),
]


@pytest.mark.parametrize("lines, label, samples, vertical", RECORDS)
def test_records_beside_the_scene_file(tmp_path, monkeypatch, lines, label, samples, vertical):
    for folder in (tmp_path, tmp_path / "records"):
        folder.mkdir(exist_ok=True)
        for name, text in FILES.items():
            (folder / name).write_text(text)
    monkeypatch.chdir("/")
    motion = with_motion(tmp_path, lines)
    assert (motion.label, motion.dt) == (label, 0.005 if ".v2" in label else 0.5)
    assert motion.samples.tolist() == pytest.approx(samples)
    assert (motion.vertical and motion.vertical.samples.tolist()) == (vertical and pytest.approx(vertical))
    longer = "h.txt x 3: 0.5 s of zeros put at its end, as the other component is longer"
    assert [longer in motion.warnings] == ["v.txt" in label]


def test_vertical_ratio_of_a_pulse_with_a_phase(tmp_path):
    lines = 'pulse = "one-sine"\namplitude = 2\nfrequency = 5\nvertical_ratio = 0.5\nvertical_phase = 0.7\nscale = 3'
    up = PulseMotion("one-sine", 3.0, 5.0, phase=0.7)
    assert with_motion(tmp_path, lines) == PulseMotion("one-sine", 6.0, 5.0, vertical=up)
    for more in ("", "vertical_ratio = 0\n"):
        level = lines.replace("vertical_ratio = 0.5\nvertical_phase = 0.7\n", more)
        assert with_motion(tmp_path, level) == PulseMotion("one-sine", 6.0, 5.0)


def test_vertical_ratio_of_a_synthetic_motion_has_a_seed_of_its_own(tmp_path):
    for more, seed in (("", 6), ("\nvertical_seed = 9", 9)):
        motion = with_motion(tmp_path, f'synthetic = "duzce-like"\nseed = 5\nscale = 2\nvertical_ratio = 0.6{more}')
        assert motion.samples.tolist() == pytest.approx(synthetic_motion(seed=5).scaled(2).samples.tolist())
        wanted = synthetic_motion(seed=seed).scaled(1.2).samples.tolist()
        assert motion.vertical.samples.tolist() == pytest.approx(wanted, rel=1e-12)


def test_shipped_scenes():
    scenes = {name: load_scene(name) for name in shipped_scenes()}
    assert set(scenes) == {"caryatid-rigid", "caryatid-isolated", "free-rocking-rigid", "free-rocking-isolated"}
    for name, scene in scenes.items():
        assert scene.block == scenes["caryatid-rigid"].block
        assert (scene.base is not None) == name.endswith("isolated")
        assert (scene.motion is not None) == name.startswith("caryatid")
        assert scene.start.tilt == (0 if scene.motion else pytest.approx(0.6 * scene.block.slenderness))
    assert all("synthetic" in scene.motion.label for scene in scenes.values() if scene.motion)
    table_1b = Bearings(count=4, ka=6.22e4, kb=6.22e3, alpha=44.69, delta_k=1e-20, x_max=0.30)
    assert scenes["caryatid-isolated"].bearings == scenes["free-rocking-isolated"].bearings == table_1b


def test_a_file_goes_before_a_shipped_scene_of_that_name(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("caryatid-rigid").write_text(SCENE.replace("20.0", "3.0"))
    assert load_scene("caryatid-rigid").duration == 3.0


@pytest.mark.parametrize("change, message", BAD.values(), ids=BAD)
def test_bad_file(tmp_path, change, message):
    error = refusal(tmp_path, change(SCENE))
    assert str(error).startswith(f"{tmp_path / 'scene.toml'}: {message}")
    assert error.file == str(tmp_path / "scene.toml") and error.key and error.remedy


def test_all_mistakes_of_a_file_are_told_at_once(tmp_path):
    text = SCENE.replace("3172.05", "-1.0").replace("212.0", '"light"').replace("20.0", "20.0\nend = 3")
    error = pickle.loads(pickle.dumps(refusal(tmp_path, text)))  # as it comes from another process
    path = tmp_path / "scene.toml"
    assert [mistake.key for mistake in (error, *error.others)] == ["run.end", "block.mass", "base.mass"]
    assert {mistake.file for mistake in error.others} == {str(path)}
    assert str(error).splitlines() == [
        f"{path}: run.end = 3: unknown key; remove it, known are duration",
        f"{path}: block.mass = -1.0: out of range; give a number above 0 [kg]",
        f"{path}: base.mass = 'light': wrong type (str); give a number [kg]",
    ]


def test_the_lines_of_a_message_are_no_more_than_a_screen_holds(tmp_path):
    error = refusal(tmp_path, "".join(f"a{n} = 1\n" for n in range(100)) + SCENE)
    assert len(error.others) == 99 and str(error).splitlines()[20:] == ["and 80 more"]


MEASURED = {"height": "block", "width": "block", "depth": "block", "density": "block", "material": "block"}


DESIGNED = dict.fromkeys(("period", "damping_ratio", "eta", "xi", "zeta"), "bearings")


@pytest.mark.parametrize("key, table", (MEASURED | DESIGNED).items())
def test_a_measured_key_leads_to_the_command_that_computes_it(tmp_path, key, table):
    error = refusal(tmp_path, SCENE.replace(f"[{table}]", f"[{table}]\n{key} = 2"))
    assert error.key == f"{table}.{key}" and "unknown key; give " in str(error)
    words = "which `rocking new FILE --height " if table == "block" else "give ka, kb and alpha, which `rocking new "
    assert words in str(error) and ("--period ... --damping" in str(error)) == (key in DESIGNED)


@pytest.mark.parametrize(
    "head, key, close", [("[motion]", "vertical_scale", "vertical_seed"), ("[start]", "tilt_velocity", "base_velocity")]
)
def test_a_key_like_another_is_no_more_than_a_guess_and_what_is_known_is_listed(tmp_path, head, key, close):
    text = SCENE if head in SCENE else f"{SCENE}\n{head}\n"
    words = str(refusal(tmp_path, text.replace(head, f"{head}\n{key} = 2.0")))
    assert f"unknown key; write {close} if that is meant, else remove it, known are " in words
    assert ("vertical_ratio" if head == "[motion]" else "tilt_rate") in words.partition("known are")[2]


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
    error = refusal(tmp_path, text)
    assert [one.key for one in (error, *error.others)] == keys
