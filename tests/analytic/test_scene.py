"""Scenes: derived quantities, changes, digests, refusals."""

import math

import pytest

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
)
from analytic.design import design_bearings
from analytic.new_scene import DAMPING, MATERIALS, PERIOD, block_from, derived, scene_text, with_bearings

BLOCK = Block(mass=3172.05, radius=1.0884, slenderness=0.28)
SCENE = Scene(
    block=BLOCK, base=Base(mass=212.0), duration=1.0, bearings=Bearings(count=4, ka=6.22e4, kb=6.22e3, alpha=44.69)
)


def test_block_is_a_rectangle_unless_told_otherwise():
    assert BLOCK.inertia == pytest.approx(4 / 3 * 3172.05 * 1.0884**2)
    assert BLOCK.centre_inertia == pytest.approx(3172.05 / 3 * (BLOCK.half_width**2 + BLOCK.half_height**2))
    assert Block(mass=1, radius=1, slenderness=0.2, corner_inertia=1.5).inertia == 1.5


def test_rocking_frequency_of_the_caryatid():
    assert SCENE.rocking_frequency == pytest.approx(2.60, abs=1e-3)  # the paper's omega_r


def test_masses():
    assert SCENE.total_mass == 3384.05
    assert SCENE.mass_share == pytest.approx(3172.05 / 3384.05)
    assert Scene(block=BLOCK, duration=1.0).mass_share == 0.0


def test_with_changes_one_part_and_validates_again():
    thin = SCENE.with_(block={"slenderness": 0.1}, duration=2.0)
    assert (thin.block.slenderness, thin.block.mass, thin.duration) == (0.1, 3172.05, 2.0)
    assert SCENE.block.slenderness == 0.28
    for changes in ({"block": {"slenderness": 2.0}}, {"nothing": 1}):
        with pytest.raises(SceneError):
            SCENE.with_(**changes)


def test_digest_is_of_the_content():
    assert SCENE.digest() == SCENE.with_(name="another name").digest()
    others = [
        SCENE.with_(duration=2.0),
        SCENE.with_(block={"slenderness": math.nextafter(0.28, 1)}),
        SCENE.with_(motion=PulseMotion("one-sine", 1.0, 2.0)),
        SCENE.with_(start=Start(tilt=0.1)),
        SCENE.with_(bearings=None),
        SCENE.with_(bearings={"x_max": 0.05}),
        SCENE.with_(motion=SampledMotion(0.1, [0.0, 1.0])),
    ]
    assert len({scene.digest() for scene in [SCENE, *others]}) == 8


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
        (lambda: Scene(block=BLOCK, duration=1.0, bearings=SCENE.bearings), "bearings: need a base to carry"),
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
