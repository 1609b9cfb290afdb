import math

import numpy as np
import pytest
from literature import A_IMPACTS, A_REST, A_TILT
from scipy.integrate import solve_ivp
from scipy.special import ellipk, ellipkinc

from analytic import closed_form
from analytic.errors import SettingError
from analytic.linear_oscillator import displacement_spectrum
from analytic.motion import PulseMotion, SampledMotion

# Problem A: released at rest from 0.9 gamma, Housner's restitution; times of a high-precision solution.
A = (2.60, 0.25, 1 - 1.5 * math.sin(0.25) ** 2, 0.9 * 0.25)  # omega_r, slenderness, restitution, tilt


def test_impact_times_and_tilt_of_problem_a():
    np.testing.assert_allclose(closed_form.free_rocking(*A, 10).times, A_IMPACTS, rtol=0, atol=1e-13)
    assert abs(closed_form.free_rocking_tilt(*A, 7.0)) == pytest.approx(A_TILT, abs=1e-14)


@pytest.mark.parametrize("threshold", A_REST)
def test_impacts_until_rest_of_problem_a(threshold):
    count, time = A_REST[threshold]
    assert closed_form.impacts_to_rest(*A, threshold * A[0]) == count
    assert closed_form.free_rocking(*A, count).times[-1] == pytest.approx(time, abs=2e-13)


def test_rest_time_is_the_limit_of_the_impact_times():
    assert closed_form.rest_time(*A) == pytest.approx(closed_form.free_rocking(*A, 420).times[-1], abs=2e-13)
    assert closed_form.free_rocking_tilt(*A, 11.0) == 0


def test_remaining_time_is_second_order_in_the_rate():
    run = closed_form.free_rocking(*A, 420)
    deceleration = A[0] ** 2 * math.sin(A[1])
    remaining = [closed_form.remaining_time(run.rates_after[n], A[2], deceleration) for n in (40, 47)]
    errors = [remaining[0] - (run.times[-1] - run.times[40]), remaining[1] - (run.times[-1] - run.times[47])]
    # seven impacts more scale the rate by e^7
    assert math.log(errors[0] / errors[1]) / math.log(A[2] ** -7) == pytest.approx(3, abs=0.1)


def test_quarter_period_equals_the_difference_of_legendre_integrals():
    omega_r, gamma = 2.6, 0.25
    for peak in (0.1, 0.5, 0.9, 0.999):
        k = math.cos(gamma * (1 - peak) / 2)
        psi = math.asin(math.cos(gamma / 2) / k)
        legendre = (ellipk(k * k) - ellipkinc(psi, k * k)) / omega_r
        energy = closed_form.swing_energy(gamma, peak * gamma)
        # the Legendre parameter k^2 is rounded to 1e-16, which its complement k'^2 feels
        tolerance = 1e-16 / (math.sin(gamma * (1 - peak) / 2) ** 2 * omega_r) + 1e-14
        assert closed_form.quarter_period(omega_r, gamma, energy) == pytest.approx(legendre, abs=tolerance)


def test_small_swings_are_parabolas():
    gamma, rate = 0.25, 1e-7
    quarter = closed_form.quarter_period(1.0, gamma, (rate / 2) ** 2)
    assert quarter == pytest.approx(rate / math.sin(gamma), rel=1e-12)


def test_tilt_is_mirrored_and_continuous_at_impacts():
    assert closed_form.free_rocking_tilt(*A[:3], -A[3], 3.0) == -closed_form.free_rocking_tilt(*A, 3.0)
    assert closed_form.free_rocking_tilt(*A, 0.0) == pytest.approx(A[3], abs=1e-16)
    for time in A_IMPACTS:
        assert abs(closed_form.free_rocking_tilt(*A, time)) < 1e-12


@pytest.mark.parametrize("tilt", (0.0, 0.25, -0.3))
def test_tilts_that_do_not_rock_are_refused(tilt):
    with pytest.raises(ValueError, match="slenderness"):
        closed_form.free_rocking(*A[:3], tilt, 3)
    with pytest.raises(ValueError, match="unstable"):
        closed_form.quarter_period(2.6, 0.25, math.sin(0.125) ** 2)


def test_slender_limit_of_the_exact_forms_is_housners():
    """G. W. Housner (1963), Bull. Seismol. Soc. Am. 53(2), 403-417: period and peaks of a slender block."""
    gamma, ratio, e, omega_r = 1e-4, 0.6, 0.93, 2.0
    known = omega_r, gamma, e, ratio * gamma
    run = closed_form.free_rocking(*known, 4)
    assert 4 * run.times[0] == pytest.approx(4 / omega_r * math.acosh(1 / (1 - ratio)), rel=1e-8)
    energies = e ** (2 * np.arange(1, 4)) * (1 - (1 - ratio) ** 2)
    peaks = [closed_form.free_rocking_tilt(*known, time) for time in 0.5 * (run.times[1:] + run.times[:-1])]
    np.testing.assert_allclose(np.abs(peaks) / gamma, 1 - np.sqrt(1 - energies), rtol=1e-7)


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
