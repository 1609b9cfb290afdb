"""What bearings are built for, and how a run beyond it is said."""

import pytest

from analytic import Base, Bearings, Block, PulseMotion, Scene, Start, load_scene, shipped_scenes, simulate
from analytic.limits import scene_warnings
from analytic.twin import simulate_twin
from engines import get_engine

BEARINGS = Bearings(count=4, ka=6.22e4, kb=6.22e3, alpha=44.69, x_max=0.05)
SCENE = Scene(
    block=Block(mass=3172.05, radius=1.0884, slenderness=0.28),
    base=Base(mass=212.0),
    bearings=BEARINGS,
    motion=PulseMotion("one-sine", 2.0, 8.0),
    duration=1.0,
)
SOLVERS = {"kernel": simulate, "twin": simulate_twin, "mujoco": lambda scene: get_engine("mujoco").simulate(scene)}


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_base_beyond_its_bearings_limit_is_said(solver):
    response = SOLVERS[solver](SCENE)
    assert response.peak_base_displacement > 0.05
    words = f"the base moves by {response.peak_base_displacement:.3g} m, beyond the x_max = 0.05 m of its bearings"
    assert any(warning.text.startswith(words) for warning in response.warnings)


SLIDER = Scene(
    block=Block(mass=100.0, radius=0.5, slenderness=0.3), motion=PulseMotion("one-sine", 5.0, 2.5), friction=0.1
)
SLIDING = {name: lambda scene, name=name: get_engine(name).simulate(scene) for name in ("exudyn", "pybullet", "mujoco")}


@pytest.mark.parametrize("solver", ["kernel", *SLIDING])
def test_a_block_that_slips_beyond_its_half_width_is_said_by_every_solver(solver):
    """A slip of 2.9 m of a block .3 m wide; not one of .06 m under a short pulse."""
    run = {"kernel": simulate, **SLIDING}[solver]
    response = run(SLIDER)
    half = SLIDER.block.half_width
    (told,) = [one for one in response.warnings if one.quantity == "peak_slip"]
    assert told.kind == "limit"
    assert (told.value, told.limit) == (response.sliding.peak, half) and told.value > 10 * half
    short = SLIDER.with_(motion=PulseMotion("rectangular", 1.5, 8.0))
    assert 0 < run(short).sliding.peak < half and "peak_slip" not in [one.quantity for one in run(short).warnings]


def test_a_block_that_falls_slips_as_it_falls_and_that_is_no_warning():
    falls = SLIDER.with_(motion=None, block={"slenderness": 0.15}, start=Start(tilt=0.16), friction=0.03)
    response = simulate(falls)
    assert response.outcome == "overturns" and response.sliding.peak > falls.block.half_width
    assert "peak_slip" not in [one.quantity for one in response.warnings]


@pytest.mark.parametrize("x_max", [None, 1.0])
def test_within_it_nothing_is_said_and_nothing_changes(x_max):
    response = simulate(SCENE.with_(bearings={"x_max": x_max}), history=False)
    assert not response.warnings and response.end == simulate(SCENE, history=False).end


def test_the_start_counts():
    scene = SCENE.with_(motion=None, start=Start(base_displacement=0.06))
    assert [warning.kind for warning in simulate(scene).warnings] == ["limit"]


@pytest.mark.parametrize("tilt, over", [(0.28, True), (-0.28, True), (0.279999, False), (-0.279999, False)])
def test_a_start_beyond_the_balance_is_said_of_the_scene_and_falls(tilt, over):
    scene = Scene(block=SCENE.block, start=Start(tilt=1.001 * tilt if over else tilt))
    assert (simulate(scene).outcome == "overturns") == over
    told = scene_warnings(scene.with_(start={"tilt": tilt}))
    assert [(one.quantity, one.value, one.limit) for one in told] == [("start.tilt", tilt, 0.28)] * over


def test_a_base_that_nothing_holds_is_said_of_the_scene():
    (told,) = scene_warnings(SCENE.with_(bearings=None))
    assert told.text.startswith("No friction is modelled under the base, and it has no bearings")
    assert not any(scene_warnings(one) for one in (SCENE, SCENE.with_(base=None, bearings=None)))
    assert not any(scene_warnings(load_scene(name)) for name in shipped_scenes())
