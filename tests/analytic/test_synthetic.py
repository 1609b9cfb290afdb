"""The shipped synthetic motion: its peaks, its determinism, the paper's three outcomes."""

import math

import numpy as np
import pytest

from analytic import SceneError, load_scene, simulate
from analytic.records import G
from analytic.synthetic import DECIMALS, DT, pulse_acceleration, synthetic_motion

FIRST_SHIPPED = [-0.096058605, 5.05215, 0.513379882]  # m/s2, of the default seed


def velocity(motion):
    """Ground velocity [m/s] at the samples, shape (n,): exact for a piecewise linear acceleration."""
    steps = 0.5 * (motion.samples[1:] + motion.samples[:-1]) * motion.dt
    return np.concatenate([[0.0], np.cumsum(steps)])


def test_peaks_and_end():
    motion = synthetic_motion()
    assert (motion.dt, motion.end) == (DT, pytest.approx(25.0, abs=0.01))
    assert motion.peak == pytest.approx(0.515 * G, abs=10.0**-DECIMALS)
    assert np.abs(velocity(motion)).max() == pytest.approx(0.80, abs=0.02)
    assert velocity(motion)[-1] == pytest.approx(0.0, abs=1e-5)


def test_the_same_bits_every_time():
    assert synthetic_motion(seed=7).digest() == synthetic_motion(seed=7).digest()
    # The motion as first shipped, to the decimals kept: a change would silently change every published result.
    samples = synthetic_motion().samples
    np.testing.assert_allclose(samples[[400, 773, 1000]], FIRST_SHIPPED, rtol=0, atol=2 * 10.0**-DECIMALS)


def test_ensemble_varies_within_the_stated_ranges():
    motions = [synthetic_motion(seed=seed) for seed in range(100)]
    assert len({motion.digest() for motion in motions}) == 100
    assert all(motion.peak == pytest.approx(0.515 * G, abs=10.0**-DECIMALS) for motion in motions)
    fastest = [np.abs(velocity(motion)).max() for motion in motions]
    assert 0.55 < min(fastest) < 0.70 and 0.80 < max(fastest) < 0.95
    assert np.mean(fastest) == pytest.approx(0.75, abs=0.02)
    assert np.std([motion.peak_time for motion in motions]) > 0.2
    assert all(abs(velocity(motion)[-1]) < 1e-4 for motion in motions)


def test_energy_lies_in_the_stated_band():
    """Above 0.3 Hz comes the pulse, and above 20 Hz nearly nothing."""
    motion = synthetic_motion(seed=3)
    power, frequency = np.abs(np.fft.rfft(motion.samples)) ** 2, np.fft.rfftfreq(len(motion.samples), motion.dt)
    assert power[frequency > 20].sum() < 1e-3 * power.sum()
    assert power[frequency < 0.3].sum() < 0.05 * power.sum()


@pytest.mark.parametrize("phase", [0.0, 1.0, math.pi / 2])
def test_pulse_acceleration_is_the_derivative_of_the_velocity_pulse(phase):
    speed, frequency, cycles = 0.7, 0.8, 2.5

    def pulse(t):
        bell = 0.5 * speed * (1 + np.cos(2 * math.pi * frequency * t / cycles))
        return np.where(np.abs(t) <= cycles / (2 * frequency), bell * np.cos(2 * math.pi * frequency * t + phase), 0.0)

    t = np.linspace(-2, 2, 41)
    step = 1e-5
    np.testing.assert_allclose(
        pulse_acceleration(t, speed, frequency, cycles, phase),
        (pulse(t + step) - pulse(t - step)) / (2 * step),
        atol=1e-8,
    )


def test_the_papers_isolated_caryatid_stands():
    isolated = simulate(load_scene("caryatid-isolated"), history=False)
    assert isolated.outcome == "stands"
    assert 0.15 < isolated.peak_base_displacement < 0.30


@pytest.mark.parametrize(
    "changes", [{}, {"slenderness": 0.26}, {"slenderness": 0.29}, {"restitution": 0.87}, {"restitution": 0.90}]
)
def test_the_papers_free_caryatid_overturns_by_no_accident_of_the_last_digit(changes):
    scene = load_scene("caryatid-rigid").with_(block=changes)
    assert simulate(scene, history=False).outcome == "overturns"


@pytest.mark.parametrize(
    "arguments, message",
    [
        ({"style": "kobe-like"}, "motion.synthetic = 'kobe-like': not a known synthetic motion; choose duzce-like"),
        ({"seed": -1}, "motion.seed = -1: not a whole number from 0 on; give an integer seed"),
        ({"seed": 1.5}, "motion.seed = 1.5"),
        ({"seed": True}, "motion.seed = True"),
    ],
)
def test_bad_arguments(arguments, message):
    with pytest.raises(SceneError) as caught:
        synthetic_motion(**arguments)
    assert message in str(caught.value)
