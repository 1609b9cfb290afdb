"""Falling off a pedestal, read from an engine's trace; and a pedestal's mass on a base in the engines."""

import math

import numpy as np
import pytest

from analytic import Base, Bearings, Block, Pedestal, PulseMotion, Scene, simulate
from engines import get_engine
from engines.events import upto_edge
from engines.swings import Trace

SLAB = Block(mass=120.0, radius=0.7, slenderness=0.3)
SLIDES = Scene(
    block=SLAB, pedestal=Pedestal(width=0.6), motion=PulseMotion("one-sine", 5.0, 2.5), friction=0.1, duration=1.0
)
ON_BASE = {"base": Base(mass=400.0), "bearings": Bearings(law="linear", ka=3e4)}
SUBJECTS = ("exudyn", "pybullet")


def made_up(slip, tilt=0.0, rate=0.0, speed=0.0, rise=0.0):
    """Ten steps of 0.01 s: a block that does not move, then has this slip, tilt, rates and height in the last five."""
    later, time = np.arange(10) >= 5, 0.01 * np.arange(10)
    tilts = np.where(later, tilt, 0.0)
    side = np.where(tilts < 0, -1.0, 1.0)
    n, c = SLAB.radius * np.sin(side * 0.3 - tilts), SLAB.radius * np.cos(side * 0.3 - tilts)
    moved, rates = np.where(later, slip, 0.0), np.where(later, rate, 0.0)
    # the centre of mass from a block at rest: the lower corner has slipped by `moved`
    x, z = moved + side * SLAB.half_width - n, c - SLAB.half_height + np.where(later, rise, 0.0)
    centre = np.column_stack([x, z, np.where(later, speed, 0.0) + c * rates, n * rates])
    zeros = np.zeros(10)
    return Trace(time, tilts, rates, zeros, zeros, zeros, contact_tilt=1e-6, centre=centre)


# half width .3 m; the block's is .207 m, its half height .669 m: at friction .1 the centre of pressure is .067 m aside
@pytest.mark.parametrize(
    "trace, off",
    [
        ({"slip": 0.2}, False),
        ({"slip": 0.31}, True),
        ({"slip": 0.25, "speed": 1.0}, True),  # it slides away: the pressure is before it
        ({"slip": 0.25, "speed": -1.0}, False),  # and behind it where it slides back
        ({"slip": 0.11, "tilt": 0.01}, True),  # about the corner that overhangs
        ({"slip": 0.11, "tilt": -0.01}, False),  # about the other one
        ({"slip": 0.08, "tilt": 0.01}, False),
        ({"slip": 0.11, "tilt": 0.31}, False),  # past its balance it overturns
        ({"slip": 0.4, "rise": 0.1}, False),  # in the air
    ],
)
@pytest.mark.parametrize("side", [1, -1])
def test_the_edge_is_read_from_states_as_the_model_has_it(trace, off, side):
    mirrored = {name: value if name == "rise" else side * value for name, value in trace.items()}
    cut, falls = upto_edge(SLIDES.with_(motion=None), made_up(**mirrored))
    assert falls == off and len(cut.time) == (6 if off else 10)


def test_without_an_edge_or_a_friction_nothing_is_cut():
    for scene in (SLIDES.with_(pedestal=None), SLIDES.with_(friction=None)):
        cut, falls = upto_edge(scene, made_up(0.4))
        assert not falls and len(cut.time) == 10


@pytest.mark.parametrize("name", SUBJECTS)
@pytest.mark.parametrize("more", [{}, ON_BASE], ids=["ground", "base"])
def test_engines_fall_off_when_the_model_does(name, more):
    scene = SLIDES.with_(duration=None, **more)
    model, run = simulate(scene, history=False), get_engine(name).simulate(scene, compare=True)
    assert run.outcome == model.outcome == "falls off" and run.decided and run.overturning_time is None
    assert run.end.time == pytest.approx(model.end.time, abs=2e-3) and run.history.time[-1] == run.end.time
    assert not run.differences and run.comparable == "yes" and not run.warnings


def test_an_engine_that_stays_on_differs_in_its_outcome():
    from engines.comparison import Reference, compare

    stays = simulate(SLIDES.with_(pedestal={"width": 9.0}, duration=None), history=False)
    judged = compare(SLIDES, stays, Reference.of(SLIDES.with_(duration=None)))
    assert ("slides", "falls off") in [(each.here, each.model) for each in judged.differences]


@pytest.mark.parametrize("name", SUBJECTS)
def test_the_mass_of_a_pedestal_moves_with_the_base(name):
    motion = PulseMotion("one-sine", 6.0, 9.0)
    one = Scene(
        block=SLAB, pedestal=Pedestal(width=9.0, mass=100.0, height=1.0), motion=motion, duration=1.0, **ON_BASE
    )
    other = one.with_(base=Base(mass=500.0), pedestal=None)
    runs = [get_engine(name).simulate(scene, history=False) for scene in (one, other)]
    assert runs[0].peak_tilt > 0.1 * 0.3 and runs[0].outcome == runs[1].outcome
    for field in ("peak_tilt", "peak_base_displacement"):
        assert getattr(runs[0], field) == pytest.approx(getattr(runs[1], field), rel=1e-9)
    assert math.isclose(runs[0].end.base_displacement, runs[1].end.base_displacement, rel_tol=1e-9)
