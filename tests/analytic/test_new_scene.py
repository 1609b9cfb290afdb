"""Scene files made from measured dimensions: what is written is read back, and what is derived follows."""

import math

import pytest

from analytic import Base, Bearings, Scene, SettingError, load_scene
from analytic.design import design_bearings
from analytic.new_scene import DAMPING, MATERIALS, PERIOD, block_from, derived, scene_text, with_bearings

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
