"""A block that slides off its pedestal: against Newmark's rigid slide, statics by hand, and runs without an edge."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from analytic import Base, Bearings, Block, Pedestal, PulseMotion, Scene, SceneError, simulate, simulate_many
from analytic.checks.time_stepping import simulate_time_stepping

G = 9.81
SLAB = Block(mass=120.0, radius=0.7, slenderness=0.3)
TALL = Block(mass=400.0, radius=1.0, slenderness=0.3)  # it slides and rocks
B, H = SLAB.half_width, SLAB.half_height


def sliding_block(width, friction=0.1, amplitude=5.0, frequency=2.5, **more):
    motion = PulseMotion("one-sine", amplitude, frequency)
    return Scene(block=SLAB, pedestal=Pedestal(width=width), motion=motion, friction=friction, **more)


def newmark(friction, amplitude, frequency, room):
    """Time at which a block that slides from rest under a sine has slid by `room` to -x; no tilt, on rigid ground."""
    begin = math.asin(friction * G / amplitude) / frequency

    def slip(t):
        past = amplitude / frequency * (math.sin(frequency * t) - math.sin(frequency * begin)) / frequency
        return (
            friction * G * (t - begin) ** 2 / 2
            + past
            - amplitude / frequency * math.cos(frequency * begin) * (t - begin)
        )

    return brentq(lambda t: slip(t) + room, begin, math.pi / frequency, xtol=1e-15)


TEN = [  # friction, amplitude, frequency, width: all fall off in the first half of the sine
    *((0.1, 5.0, 2.5, width) for width in (0.45, 0.6, 0.9, 1.2)),
    *((0.2, amplitude, 2.5, 0.6) for amplitude in (5.0, 8.0)),
    *((0.05, 3.0, frequency, 0.5) for frequency in (1.5, 3.0)),
    (0.25, 6.0, 2.0, 0.7),
    (0.15, 4.0, 2.0, 0.55),
]


@pytest.mark.parametrize("friction, amplitude, frequency, width", TEN)
def test_it_falls_off_when_newmarks_slide_and_statics_by_hand_say_so(friction, amplitude, frequency, width):
    """The centre of pressure is friction times h behind the middle, by which the slip is less than half the width."""
    room = 0.5 * width - friction * H
    by_hand = newmark(friction, amplitude, frequency, room)
    for sign in (1, -1):
        run = simulate(sliding_block(width, friction, sign * amplitude, frequency))
        assert run.outcome == "falls off" and run.decided and run.overturning_time is None
        assert run.end.time == pytest.approx(by_hand, rel=1e-9)
        assert run.sliding.end == pytest.approx(-sign * room, rel=1e-9) and run.sliding.peak == abs(run.sliding.end)
        assert run.history.time[-1] == run.end.time and not run.warnings


def test_it_stays_on_where_the_slide_just_ends_and_is_then_said_to_overhang():
    free = simulate(sliding_block(9.0, amplitude=2.0))
    most = 2 * (free.sliding.peak + 0.1 * H)
    assert free.outcome == "slides" and not free.warnings
    on, off = (simulate(sliding_block(most * factor, amplitude=2.0)) for factor in (1 + 1e-6, 1 - 1e-6))
    assert (on.outcome, off.outcome) == ("slides", "falls off")
    (warning,) = on.warnings
    assert (warning.kind, warning.quantity) == ("limit", "overhang") and "overhangs its pedestal" in warning.text
    assert on.sliding == free.sliding and on.end == free.end  # with a wide one, bit for bit without


def test_an_edge_that_is_not_reached_changes_nothing():
    without = sliding_block(9.0).with_(pedestal=None)
    for motion in (PulseMotion("one-sine", 9.0, 14.0), PulseMotion("one-sine", 4.0, 12.0)):
        runs = [simulate(scene.with_(motion=motion, friction=0.33)) for scene in (sliding_block(9.0), without)]
        assert runs[0].end == runs[1].end and runs[0].impacts == runs[1].impacts
        assert np.array_equal(runs[0].history.tilt, runs[1].history.tilt)


def test_a_tilted_block_falls_off_when_its_corner_passes_the_edge():
    scene, b = sliding_block(9.0, 0.33, 9.0, 14.0).with_(block=TALL), TALL.half_width
    free = simulate(scene, output_step=1e-4)
    place = np.where(free.history.tilt != 0, np.abs(free.history.slip + np.sign(free.history.tilt) * b), 0.0)
    half = 0.5 * (place.max() + b)  # between the corner at rest and where it gets to
    run = simulate(scene.with_(pedestal={"width": 2 * half}))
    expected = free.history.time[np.flatnonzero(place > half)[0]]
    assert free.outcome == "rocks" and run.outcome == "falls off" and run.end.tilt != 0
    assert run.end.time == pytest.approx(expected, abs=2e-4)
    assert abs(run.sliding.end + math.copysign(b, run.end.tilt)) == pytest.approx(half, rel=1e-9)


def test_a_block_past_its_balance_overturns_wherever_its_corner_is():
    motion = PulseMotion("one-sine", 9.0, 4.0)
    scene = sliding_block(2 * B, 0.5).with_(motion=motion)
    run, free = simulate(scene), simulate(scene.with_(pedestal=None))
    assert run.outcome == free.outcome == "overturns" and run.end == free.end and run.sliding.peak > 0


@pytest.mark.parametrize("width", [0.6, 9.0])
def test_many_runs_are_the_single_ones(width):
    base = {"base": Base(mass=300.0), "bearings": Bearings(law="linear", ka=3e4)}
    scenes = [sliding_block(width, friction, **more) for friction in (0.05, 0.1, 0.4) for more in ({}, base)]
    outcomes, singles = simulate_many(scenes), [simulate(scene) for scene in scenes]
    assert outcomes.names.tolist() == [run.outcome for run in singles]
    assert outcomes.fell_off.tolist() == [run.outcome == "falls off" for run in singles]
    assert outcomes.decided.all() and (("falls off" in outcomes.names) == (width < 1))
    for slip, run in zip(outcomes.peak_slip, singles, strict=True):
        assert slip == pytest.approx(run.sliding.peak if run.sliding else 0.0, rel=1e-9)


def test_on_a_pedestal_as_wide_as_the_block_rounding_is_no_fall():
    scene = sliding_block(9.0, 0.9, 3.2, 8.0).with_(block=TALL)
    tight = scene.with_(pedestal={"width": 2 * TALL.half_width * (1 - 5e-5)})
    assert simulate(tight).outcome == simulate(scene).outcome == "rocks" and not simulate(tight).warnings


def test_the_mass_of_a_pedestal_on_a_base_is_the_bases():
    law = {"bearings": Bearings(ka=2e4, kb=2e3, alpha=40.0, count=4), "motion": PulseMotion("one-sine", 6.0, 9.0)}
    for friction in (None, 0.25):
        one = Scene(
            block=SLAB, base=Base(mass=400.0), pedestal=Pedestal(width=9, mass=100, height=1), friction=friction, **law
        )
        other = one.with_(base=Base(mass=500.0), pedestal=None)
        runs = [simulate(scene) for scene in (one, other)]
        assert runs[0].end == runs[1].end and runs[0].impacts == runs[1].impacts and runs[0].energy == runs[1].energy
        assert (
            one.total_mass == other.total_mass and one.mass_share == other.mass_share and one.digest() != other.digest()
        )


def test_the_second_method_refuses_an_edge_it_does_not_know():
    with pytest.raises(SceneError) as error:
        simulate_time_stepping(sliding_block(0.6, duration=1.0), step=1e-3)
    assert error.value.key == "pedestal.width"


def test_without_a_friction_an_edge_is_said_to_play_no_part():
    from analytic.response import scene_warnings

    (warning,) = scene_warnings(sliding_block(0.6).with_(friction=None))
    assert "plays no part" in warning.text and not scene_warnings(sliding_block(0.6))
