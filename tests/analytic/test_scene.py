"""Scene files: the scenes that they give, and one clear message for every mistake."""

import math
import pickle
from pathlib import Path

import pytest
from bad_scenes import BAD, SCENE, write_scene
from made_up_records import VALUES, csmip

from analytic import (
    Base,
    Bearings,
    Block,
    PulseMotion,
    SampledMotion,
    Scene,
    SceneError,
    SettingError,
    Start,
    load_scene,
    shipped_scenes,
)
from analytic.records.synthetic import synthetic_motion
from analytic.rocking import design_bearings
from analytic.scene_file import DAMPING, MATERIALS, PERIOD, block_from, derived, scene_text, with_bearings


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
    """Return the motion of a scene whose [motion] holds these lines."""
    return load_scene(write_scene(folder, SCENE.replace('synthetic = "duzce-like"', lines))).motion


def refusal(folder, text):
    """Return the error that a scene file of this text gives."""
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
    *((f'record = "r.v2"\nchannel = {number}', "r.v2, channel 2 (Up)", TWICE, None) for number in ("2", '"2"', '"Up"')),
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
    assert [mistake.key for mistake in (error, *error.others)] == keys


# Scenes: derived quantities, changes, digests, refusals.


BLOCK = Block(mass=3172.05, radius=1.0884, slenderness=0.28)
CARYATID = Scene(
    block=BLOCK, base=Base(mass=212.0), duration=1.0, bearings=Bearings(count=4, ka=6.22e4, kb=6.22e3, alpha=44.69)
)


def test_derived_quantities_are_those_of_a_rectangle_unless_told_otherwise():
    assert BLOCK.inertia == pytest.approx(4 / 3 * 3172.05 * 1.0884**2)
    assert BLOCK.centre_inertia == pytest.approx(3172.05 / 3 * (BLOCK.half_width**2 + BLOCK.half_height**2))
    assert Block(mass=1, radius=1, slenderness=0.2, corner_inertia=1.5).inertia == 1.5
    assert CARYATID.rocking_frequency == pytest.approx(2.60, abs=1e-3)  # the paper's omega_r
    assert (CARYATID.total_mass, CARYATID.mass_share) == (3384.05, pytest.approx(3172.05 / 3384.05))
    assert Scene(block=BLOCK, duration=1.0).mass_share == 0.0


def test_with_changes_one_part_and_validates_again():
    thin = CARYATID.with_(block={"slenderness": 0.1}, duration=2.0)
    assert (thin.block.slenderness, thin.block.mass, thin.duration) == (0.1, 3172.05, 2.0)
    assert CARYATID.block.slenderness == 0.28
    for changes in ({"block": {"slenderness": 2.0}}, {"nothing": 1}):
        with pytest.raises(SceneError):
            CARYATID.with_(**changes)


def test_digest_is_of_the_content():
    assert CARYATID.digest() == CARYATID.with_(name="another name").digest()
    others = [
        CARYATID.with_(duration=2.0),
        CARYATID.with_(block={"slenderness": math.nextafter(0.28, 1)}),
        CARYATID.with_(motion=PulseMotion("one-sine", 1.0, 2.0)),
        CARYATID.with_(start=Start(tilt=0.1)),
        CARYATID.with_(bearings=None),
        CARYATID.with_(bearings={"x_max": 0.05}),
        CARYATID.with_(motion=SampledMotion(0.1, [0.0, 1.0])),
    ]
    assert len({scene.digest() for scene in [CARYATID, *others]}) == 8


@pytest.mark.parametrize(
    "make, message",
    [
        (lambda: Block(mass=-1, radius=1, slenderness=0.2), "block.mass = -1: out of range; give a number above 0"),
        (lambda: Block(mass=1, radius=1, slenderness=math.pi / 2), "out of range; give a number below 1.5708"),
        (lambda: Block(mass=1, radius=1, slenderness=0.2, corner_inertia=1.0), "less than a point mass would have"),
        (lambda: Block(mass=1, radius=1, slenderness=0.2, restitution=1.1), "block.restitution = 1.1: out of range"),
        (lambda: Bearings(ka=1.0, kb=1.0, alpha=2.0), "not above kb = 1 N/m"),
        (lambda: Bearings(ka=2.0, kb=1.0, alpha=1.0), "bearings.alpha = 1.0: out of range; give a number above 1"),
        (lambda: Bearings(ka=2.0, kb=1.0), "bearings.alpha: missing"),
        (lambda: Bearings(ka=2.0, alpha=3.0), "bearings.kb: missing"),
        (lambda: Bearings(ka=2.0, kb=1.0, alpha=2.0, delta_k=1.0), "bearings.delta_k = 1.0: not below ka - kb"),
        (lambda: Scene(block=BLOCK, duration=1.0, bearings=CARYATID.bearings), "bearings: need a base to carry"),
        (
            lambda: Scene(block=BLOCK, duration=1.0, start=Start(base_velocity=1.0)),
            "start.base_velocity = 1.0: needs a base",
        ),
        (lambda: Scene(block={"mass": 1.0, "radius": 1.0, "slendernes": 0.2}), "block.slendernes = 0.2: unknown key"),
        (lambda: Scene(), "block: missing; add a table [block]"),
        (lambda: Scene(block=BLOCK, duration=1e16), "run.duration = 1e+16: times up to 1e+16 s are known to 2 s only"),
        (
            lambda: Scene(block=BLOCK, motion=PulseMotion("one-sine", 1.0, 5.0, start=1e16)),
            "motion.start = 1e+16: times up to 1e+16 s",
        ),
        (
            lambda: Scene(block=BLOCK, motion=PulseMotion("one-sine", 1.0, 1e-20)),
            "motion.frequency = 1e-20: times up to 6.28e+20 s",
        ),
        (lambda: Scene(block=BLOCK, motion=PulseMotion("ricker", 5.0, 1e9, start=1e3)), "motion.start = 1000.0"),
        (lambda: Scene(block=BLOCK, motion=SampledMotion(1e14, [0.0, 1.0])), "motion.dt = 100000000000000.0"),
        (lambda: Scene(block=BLOCK, duration=math.nan), "duration = nan: not finite"),
        (lambda: Scene(block=BLOCK, duration=1.0, motion="quake"), "motion = 'quake': wrong type (str)"),
    ],
)
def test_refusals(make, message):
    with pytest.raises(SceneError) as caught:
        make()
    assert message in str(caught.value)


def test_a_linear_bearing_needs_its_stiffness_only():
    assert Bearings(law="linear", ka=2.0).kb is None


# Scene files made from measured dimensions: what is written is read back, and what is derived follows.
BEARINGS = Bearings(count=4, ka=6.22e4, kb=6.22e3, alpha=44.69)


def test_a_block_follows_from_its_dimensions():
    block = block_from(1.9, 0.55, depth=0.4, density=2700.0)
    assert block.mass == pytest.approx(2700 * 1.9 * 0.55 * 0.4, rel=1e-14)
    assert 2 * block.half_height == pytest.approx(1.9, rel=1e-14)
    assert 2 * block.half_width == pytest.approx(0.55, rel=1e-14)
    # of a homogeneous rectangle about its centre m (h^2 + w^2)/12
    assert block.centre_inertia == pytest.approx(block.mass * (1.9**2 + 0.55**2) / 12, rel=1e-14)


def test_the_file_reads_back_as_what_was_asked_for(tmp_path):
    block = block_from(1.9, 0.55, mass=1500.0)
    text = scene_text(
        'bust "of" a man', block, base=Base(mass=400.0), bearings=BEARINGS, tilt=0.1, friction=0.6, about=("first",)
    )
    (tmp_path / "bust.toml").write_text(text, encoding="utf-8")
    scene = load_scene(tmp_path / "bust.toml")
    assert scene.name == 'bust "of" a man' and scene.friction == 0.6 and scene.start.tilt == 0.1
    assert scene.bearings == BEARINGS and scene.base.mass == 400.0
    assert scene.block.radius == pytest.approx(block.radius, rel=1e-5)
    assert text.startswith("# first\n") and "# m; base corner to centre of mass" in text


@pytest.mark.parametrize("end", ["", "\n", "\n[run]\nduration = 3.0", '\n[motion]\nsynthetic = "duzce-like"\n\n\n'])
def test_a_base_and_bearings_are_put_below_a_block_on_the_ground(tmp_path, end):
    before = scene_text("bust", block_from(1.9, 0.55, mass=1500.0)) + end
    after = with_bearings(before, BEARINGS, Base(mass=400.0))
    assert after.startswith(before.rstrip())
    for name, text in (("before", before), ("after", after)):
        (tmp_path / f"{name}.toml").write_text(text)
    scene = load_scene(tmp_path / "after.toml")
    assert scene.base == Base(mass=400.0) and scene.bearings == BEARINGS
    assert scene.with_(base=None, bearings=None).digest() == load_scene(tmp_path / "before.toml").digest()


def test_derived_numbers_are_the_closed_forms():
    scene = Scene(block=block_from(1.9, 0.55, mass=1500.0), base=Base(mass=400.0), bearings=BEARINGS)
    rows = {name: value for name, value, _ in derived(scene)}
    gamma, radius, share = math.atan(0.55 / 1.9), 0.5 * math.hypot(1.9, 0.55), 1500 / 1900
    assert rows["rocking frequency omega_r, eq. (1)"] == pytest.approx(math.sqrt(3 * 9.81 / (4 * radius)), rel=1e-13)
    assert rows["uplift acceleration g tan(slenderness)"] == pytest.approx(9.81 * 0.55 / 1.9, rel=1e-13)
    assert rows["isolation period after yielding"] == pytest.approx(
        2 * math.pi * math.sqrt(1900 / (4 * 6.22e3)), rel=1e-13
    )
    # eq. (7) with J_O = 4/3 m R^2
    expected = 1 - 2 * math.sin(gamma) ** 2 / (4 / 3 - share * math.cos(gamma) ** 2)
    assert rows["restitution e_phi, eq. (7)"] == pytest.approx(expected, rel=1e-13)


def test_what_bearings_give_at_x_max_is_derived():
    parts = {"block": block_from(1.9, 0.55, mass=1500.0), "base": Base(mass=400.0)}
    designed = Scene(**parts, bearings=design_bearings(1900.0, 2.5, 0.15, 0.2))
    rows = {name: value for name, value, _ in derived(designed)}
    assert rows[PERIOD] == pytest.approx(2.5, rel=1e-3) and rows[DAMPING] == pytest.approx(0.15, rel=1e-3)
    linear = Scene(**parts, bearings=Bearings(law="linear", ka=1e4, x_max=0.2))
    rows = {name: value for name, value, _ in derived(linear)}
    assert rows[PERIOD] == pytest.approx(2 * math.pi * math.sqrt(0.19), rel=1e-13) and rows[DAMPING] == 0
    for bearings in (BEARINGS, Bearings(**{**BEARINGS.model_dump(), "x_max": 1e-20})):  # none, and one without yielding
        assert PERIOD not in {name for name, *_ in derived(Scene(**parts, bearings=bearings))}


@pytest.mark.parametrize(
    "arguments, words",
    [
        ({"height": 0.0, "width": 0.5, "mass": 1.0}, "height = 0.0"),
        ({"height": 1.0, "width": math.nan, "mass": 1.0}, "width = nan"),
        ({"height": 1.0, "width": 0.5}, "mass"),
        ({"height": 1.0, "width": 0.5, "mass": 1.0, "density": MATERIALS["marble"]}, "not both"),
    ],
)
def test_dimensions_that_make_no_block_are_refused(arguments, words):
    with pytest.raises(SettingError, match=words):
        block_from(**arguments)
