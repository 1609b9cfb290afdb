"""Scenes: derived quantities, changes, digests, refusals."""

import math

import pytest

from analytic import Base, Bearings, Block, PulseMotion, SampledMotion, Scene, SceneError, Start

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
