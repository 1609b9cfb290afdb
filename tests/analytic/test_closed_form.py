import math

import numpy as np
import pytest
from literature import A_IMPACTS
from scipy.optimize import brentq
from scipy.special import ellipk, ellipkinc

from analytic import closed_form
from analytic.motion import PulseMotion, SampledMotion

# Problem A: released at rest from 0.9 gamma, Housner's restitution; times of a high-precision solution.
A = (2.60, 0.25, 1 - 1.5 * math.sin(0.25) ** 2, 0.9 * 0.25)  # omega_r, slenderness, restitution, tilt
A_REST = {1e-4: (82, 10.0465490762726), 1e-6: (129, 10.0496394097305), 1e-8: (177, 10.0496728814269)}


def test_impact_times_of_problem_a():
    np.testing.assert_allclose(closed_form.free_rocking(*A, 10).times, A_IMPACTS, rtol=0, atol=1e-13)


def test_tilt_of_problem_a_at_seven_seconds():
    tilt = abs(closed_form.free_rocking_tilt(*A, 7.0))
    assert tilt == pytest.approx(0.01588089793859602683756374, abs=1e-14)


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
    for peak in (0.1, 0.5, 0.9, 0.999):
        omega_r, gamma = 2.6, 0.25
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


def test_peak_and_energy_are_inverse():
    for peak in (1e-9, 1e-3, 0.1, 0.2499):
        energy = closed_form.swing_energy(0.25, peak)
        assert closed_form.swing_peak(0.25, energy) == pytest.approx(peak, rel=1e-12)


def test_tilt_is_mirrored_and_continuous_at_impacts():
    assert closed_form.free_rocking_tilt(*A[:3], -A[3], 3.0) == -closed_form.free_rocking_tilt(*A, 3.0)
    assert closed_form.free_rocking_tilt(*A, 0.0) == pytest.approx(A[3], abs=1e-16)
    for time in A_IMPACTS:
        assert abs(closed_form.free_rocking_tilt(*A, time)) < 1e-12


@pytest.mark.parametrize("tilt", (0.0, 0.25, -0.3))
def test_free_rocking_refuses_tilts_that_do_not_rock(tilt):
    with pytest.raises(ValueError, match="slenderness"):
        closed_form.free_rocking(*A[:3], tilt, 3)


def test_unstable_point_has_no_quarter_period():
    with pytest.raises(ValueError, match="unstable"):
        closed_form.quarter_period(2.6, 0.25, math.sin(0.125) ** 2)


def test_slender_limit_of_the_exact_forms_is_housner():
    gamma, ratio, e, omega_r = 1e-4, 0.6, 0.93, 2.0
    run = closed_form.free_rocking(omega_r, gamma, e, ratio * gamma, 3)
    assert 4 * run.times[0] == pytest.approx(closed_form.linear_period(omega_r, ratio), rel=1e-8)
    for n in range(3):
        assert run.peaks[n] / gamma == pytest.approx(closed_form.linear_decay(e, ratio, n + 1), rel=1e-7)


def test_rectangular_pulse_criterion_is_the_overturning_integral():
    omega_r, gamma, ratio = 2.6, 0.25, 1.4
    duration = closed_form.rectangular_pulse_critical_duration(omega_r, ratio)
    pulse = PulseMotion("rectangular", ratio * 9.81 * gamma, math.pi / duration)
    assert closed_form.no_impact_overturning_integral(omega_r, pulse, 0.0) == pytest.approx(gamma, rel=1e-12)
    assert closed_form.rectangular_pulse_critical_duration(omega_r, 1.0) == math.inf


# amplitude/(g gamma) of the linear boundary safe -> no impact, by frequency/omega_r
NO_IMPACT = {2: 2.34990, 3: 3.63115, 4: 5.23896, 5: 7.16813, 6: 9.41697, 8: 14.87135}


@pytest.mark.parametrize("frequency", NO_IMPACT)
def test_no_impact_overturning_by_one_sine(frequency):
    omega_r, gamma, g = 2.14, 0.25, 9.81

    def excess(ratio):
        pulse = PulseMotion("one-sine", ratio * g * gamma, frequency * omega_r)
        uplift = math.asin(1 / ratio) / pulse.frequency
        return closed_form.no_impact_overturning_integral(omega_r, pulse, uplift, g) - gamma

    assert brentq(excess, 1.5, 30.0) == pytest.approx(NO_IMPACT[frequency], abs=1e-5)


def test_overturning_integral_of_a_record_tends_to_that_of_its_pulse():
    omega_r, uplift = 2.14, 0.05
    pulse = PulseMotion("half-sine", 4.0, 6.0)
    exact = closed_form.no_impact_overturning_integral(omega_r, pulse, uplift)
    errors = []
    for n in (20, 40):
        dt = pulse.end / n
        record = SampledMotion(dt, pulse.acceleration(np.arange(n + 1) * dt * (1 - 1e-15)))
        errors.append(closed_form.no_impact_overturning_integral(omega_r, record, uplift) - exact)
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.05)  # linear interpolation: second order
