import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from analytic.errors import SettingError
from analytic.linear_oscillator import displacement_spectrum
from analytic.motion import PulseMotion, SampledMotion


def test_long_step_gives_the_overshoot_of_a_damped_oscillator():
    periods, ratios, a = np.array([0.3, 1.0, 2.317]), np.array([0.0, 0.05, 0.3]), 2.0
    step = SampledMotion(0.05, np.full(200, a))  # 10 s: the first peak lies inside, between samples
    zeta, w = ratios[:, None], 2 * math.pi / periods
    overshoot = a / w**2 * (1 + np.exp(-zeta * math.pi / np.sqrt(1 - zeta**2)))
    np.testing.assert_allclose(displacement_spectrum(step, periods, ratios)[1:], overshoot[1:], rtol=1e-12)
    # undamped: the drop to zero after the step may add to it, but never take away
    assert (displacement_spectrum(step, periods, ratios)[0] >= overshoot[0] * (1 - 1e-12)).all()


@pytest.mark.parametrize(
    "shape, frequency, w, response",
    [
        # after a pulse of length t1 the free vibration has amplitude 2 a/w^2 |sin(w t1/2)|; during it 2 a/w^2 at most
        ("rectangular", math.pi / 0.3, 2.0, 2 * math.sin(0.3)),
        ("rectangular", math.pi, 2.0, 2 * math.sin(1.0)),
        # x = -(a/2w^2)(sin u - u cos u), u = w t: after one full turn free vibration of amplitude pi a/w^2
        ("one-sine", 3.0, 3.0, math.pi),
    ],
)
def test_undamped_under_a_pulse(shape, frequency, w, response):
    peak = displacement_spectrum(PulseMotion(shape, 1.5, frequency), [2 * math.pi / w], [0.0])[0, 0]
    assert peak == pytest.approx(response * 1.5 / w**2, rel=1e-12 if shape == "rectangular" else 1e-6)


def test_agrees_with_scipy_on_noise():
    motion = SampledMotion(0.02, np.random.default_rng(3).normal(size=150))
    w, zeta, corners = 2 * math.pi / 0.37, 0.07, 0.02 * np.arange(150)
    state, peak = np.zeros(2), 0.0
    for start in corners[:-1]:

        def slope(t, y):
            return [y[1], -2 * zeta * w * y[1] - w * w * y[0] - np.interp(t, corners, motion.samples)]

        part = solve_ivp(
            slope, (start, start + 0.02), state, "DOP853", rtol=1e-12, atol=1e-14, events=lambda t, y: y[1]
        )
        state = part.y[:, -1]
        peak = max(peak, np.abs(part.y[0]).max(), *(abs(turn[0]) for turn in part.y_events[0]))
    assert displacement_spectrum(motion, [0.37], [zeta])[0, 0] == pytest.approx(peak, rel=1e-9)


def test_shape_scale_and_mirror():
    motion = SampledMotion(0.01, np.random.default_rng(5).normal(size=400))
    periods, ratios = np.linspace(0.1, 4, 17), [0.02, 0.1, 0.3]
    spectrum = displacement_spectrum(motion, periods, ratios)
    assert spectrum.shape == (3, 17)
    np.testing.assert_array_equal(displacement_spectrum(motion, periods, ratios, scale=-1.0), spectrum)
    np.testing.assert_array_equal(displacement_spectrum(motion, periods, ratios, scale=2.0), 2 * spectrum)


@pytest.mark.parametrize(("periods", "ratios"), [([0.0], [0.1]), ([math.nan], [0.1]), ([1.0], [1.0]), ([1.0], [-0.1])])
def test_out_of_range_is_refused(periods, ratios):
    with pytest.raises(SettingError):
        displacement_spectrum(PulseMotion("one-sine", 1.0, 1.0), periods, ratios)
