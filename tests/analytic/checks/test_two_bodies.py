"""Two blocks by Moreau's time stepping against the model of one block, momentum, energy, the mirror and its order."""

import math

import numpy as np
import pytest

from analytic import Base, Bearings, Block, Pedestal, PulseMotion, Scene, SceneError, SettingError, Start, simulate
from analytic.checks.two_bodies import simulate_two_bodies
from analytic.rocking import momentum_restitution

BUST = Block(mass=120.0, radius=math.hypot(0.125, 0.35), slenderness=math.atan2(0.125, 0.35))
NARROW, WIDE = Pedestal(width=0.4, mass=430.0, height=1.0), Pedestal(width=6.0, mass=4300.0, height=1.0)
ON_BASE = {"base": Base(mass=500.0), "bearings": Bearings(ka=6.22e4, kb=6.22e3, alpha=44.69)}


STIFF = {"base": Base(mass=500.0), "bearings": Bearings(law="linear", ka=1.3e6, damping=3300.0)}


@pytest.mark.parametrize(
    "amplitude, frequency, more", [(0.42 * 9.81, 3 * math.pi, {}), (4.0, 25.0, STIFF)], ids=["ground", "base"]
)
def test_on_a_wide_pedestal_it_is_the_model_of_one_block_in_first_order(amplitude, frequency, more):
    motion = PulseMotion("one-sine", amplitude, frequency)
    scene = Scene(block=BUST, pedestal=WIDE, motion=motion, duration=1.5, **more)
    history, errors = simulate(scene, output_step=1e-3).history, []
    assert np.abs(history.tilt).max() > 0.1 * BUST.slenderness
    for step in (4e-4, 6.25e-6):  # the time of an impact within its step scatters
        two = simulate_two_bodies(scene, step=step)
        errors.append(np.abs(np.interp(history.time, two.time, two.upper) - history.tilt).max() / BUST.slenderness)
        assert np.abs(two.lower).max() < 1e-9 and not two.fallen
        assert np.abs(np.interp(history.time, two.time, two.base) - history.base_displacement).max() < 3 * step
    assert errors[1] < errors[0] / 15 and errors[1] < 5e-4


def test_two_halves_that_rock_together_are_one_block():
    """The upper half of a block, thrown by no landing before, stays on the lower one until the first impact."""
    lower, upper = (
        Pedestal(width=0.4, mass=300.0, height=0.2),
        Block(mass=1200.0, radius=math.hypot(0.2, 0.4), slenderness=math.atan2(0.2, 0.4)),
    )
    whole = Block(mass=1500.0, radius=math.hypot(0.2, 0.5), slenderness=math.atan2(0.2, 0.5))
    tilt = 0.3 * whole.slenderness
    free = simulate(Scene(block=whole, start=Start(tilt=tilt), duration=2.0))
    until = 0.98 * free.impacts[0].time
    two = simulate_two_bodies(Scene(block=upper, pedestal=lower, duration=until), step=2e-5, lower_tilt=tilt)
    expected = np.interp(two.time, free.history.time, free.history.tilt)
    assert np.abs(two.lower - expected).max() < 1e-4 * tilt + 1e-5 and np.abs(two.upper - two.lower).max() < 1e-6 * tilt


def test_a_block_alone_loses_by_eq_7():
    """The lower block under an upper one of next to nothing lands as a single block."""
    light = Block(mass=1e-6, radius=math.hypot(0.1, 0.1), slenderness=math.atan2(0.1, 0.1))
    single = Block(mass=430.0, radius=math.hypot(0.2, 0.5), slenderness=math.atan2(0.2, 0.5))
    two = simulate_two_bodies(Scene(block=light, pedestal=NARROW, duration=0.9), step=1e-5, lower_tilt=0.1)
    rate = np.gradient(two.lower, two.time)
    k = int(np.flatnonzero(two.lower <= 0)[0])
    assert rate[k + 20] / rate[k - 20] == pytest.approx(momentum_restitution(Scene(block=single)), abs=2e-3)


@pytest.mark.parametrize("start", [(0.15, 0.2), (0.1, -0.02), (0.08, 0.0)])
def test_free_it_never_gains_energy_and_loses_it_at_impacts_alone(start):
    lower, tilt = start
    scene = Scene(block=BUST, pedestal=NARROW, duration=1.0).with_(start={"tilt": tilt})
    two = simulate_two_bodies(scene, step=2e-5, lower_tilt=lower)
    scale = two.energy[0] - 9.81 * (430 * 0.5 + 120 * 1.35)
    assert np.diff(two.energy).max() < 1e-6 * scale and two.energy[-1] < two.energy[0] - 0.01 * scale
    assert (np.diff(two.energy) < -1e-3 * scale).sum() < 20


@pytest.mark.parametrize("more", [{}, ON_BASE], ids=["ground", "base"])
def test_mirrored_it_is_the_same(more):
    runs = [
        simulate_two_bodies(
            Scene(block=BUST, pedestal=NARROW, motion=PulseMotion("one-sine", sign * 12.0, 9.0), duration=1.0, **more),
            step=2e-4,
        )
        for sign in (1, -1)
    ]
    assert np.abs(runs[0].lower).max() > 1e-3
    for name in ("lower", "upper", "base"):
        assert getattr(runs[0], name) == pytest.approx(-getattr(runs[1], name), abs=1e-9)


def test_who_falls_first_is_named():
    for amplitude, fallen in ((0.3, ""), (1.5, "upper")):
        motion = PulseMotion("one-sine", amplitude * 9.81, 3 * math.pi)
        assert (
            simulate_two_bodies(Scene(block=BUST, pedestal=WIDE, motion=motion, duration=4.0), step=2e-4).fallen
            == fallen
        )
    slim = Pedestal(width=0.25, mass=430.0, height=2.0)
    motion = PulseMotion("one-sine", 6.0, 4.0)
    assert (
        simulate_two_bodies(Scene(block=BUST, pedestal=slim, motion=motion, duration=6.0), step=2e-4).fallen == "lower"
    )


def test_what_it_does_not_know_is_refused():
    scene = Scene(block=BUST, pedestal=NARROW, duration=1.0)
    with pytest.raises(SettingError, match="step"):
        simulate_two_bodies(scene, step=0.0)
    for change, key in (
        ({"pedestal": None}, "pedestal"),
        ({"duration": None}, "pedestal"),
        ({"start": {"tilt_rate": 0.1}}, "start.tilt_rate"),
        ({"block": {"restitution": 0.5}}, "block.restitution"),
    ):
        with pytest.raises(SceneError) as error:
            simulate_two_bodies(scene.with_(**change), step=1e-3)
        assert error.value.key == key
