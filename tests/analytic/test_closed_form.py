import math

import numpy as np
import pytest
from literature import A_IMPACTS, A_REST, A_TILT
from scipy.special import ellipk, ellipkinc

from analytic import closed_form

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
