"""The paper's misprints: what the corrected equations pass, the printed ones must fail."""

import math

import numpy as np
import pytest

from analytic import Bearings, load_scene, simulate
from analytic.bearing import BearingLaw
from analytic.design import properties, steady_cycle
from analytic.rocking import base_jump_length, base_jump_length_as_printed

ISOLATED = load_scene("caryatid-isolated")
LAW = BearingLaw.of(ISOLATED.bearings)
C = LAW.constants
MASS, X_MAX = ISOLATED.total_mass, 0.30


def fails(check, *arguments):
    """The check must notice the misprint."""
    with pytest.raises(AssertionError):
        check(*arguments)


def agrees_with_the_simulation(jump_length):
    """Eq. (8) against every impact of a rocking run: x'+ - x'- = -e_x phi'-."""
    scene = ISOLATED.with_(block={"slenderness": 0.15})
    run = simulate(scene, history=False)
    assert run.impact_count > 20
    for impact in run.impacts:
        assert impact.base_velocity_jump == pytest.approx(-jump_length(scene) * impact.rate_before, rel=1e-9)


def test_equation_8():
    agrees_with_the_simulation(base_jump_length)
    fails(agrees_with_the_simulation, base_jump_length_as_printed)


def unloading(bracket_sign):
    """Force on the unloading branch from 0.2 m, eq. (12): bracket 1 + sign (x - x_j) + 2 x0, sign -1 if right.

    x_j from the right form at the reversal, in closed form: the bracket there is D_c.
    """
    x_c = 0.20
    z_c = LAW.start(x_c)
    power = C.d0 + (1 - C.alpha) * (-z_c - LAW.f0) / LAW.dk
    x_j = power ** (1 / (1 - C.alpha)) - 1 - 2 * C.x0 + x_c

    def force(x):
        bracket = 1 + bracket_sign * (x - x_j) + 2 * C.x0
        return LAW.kb * x - LAW.dk * (bracket ** (1 - C.alpha) - C.d0) / (1 - C.alpha) - LAW.f0

    return force, x_c, LAW.kb * x_c + z_c


def is_the_law_simulated(bracket_sign):
    force, x_c, _ = unloading(bracket_sign)
    for x in np.linspace(x_c, -0.2, 21):
        assert force(x) == pytest.approx(LAW.kb * x + LAW.hysteretic(LAW.start(x_c), x - x_c), abs=1e-9 * LAW.f0)


def test_equation_12():
    is_the_law_simulated(-1)
    fails(is_the_law_simulated, +1)


def test_equation_12_as_printed_jumps_by_twice_f0():
    force, x_c, expected = unloading(+1)
    assert expected - force(x_c) == pytest.approx(2 * LAW.f0, rel=1e-3)


def is_the_damping_of_an_equivalent_oscillator(damping):
    """A viscous oscillator of that damping loses, in a cycle at its own frequency, what the bearings lose."""
    loss, force = steady_cycle(LAW, X_MAX)
    stiffness = 4 * force / X_MAX
    omega = math.sqrt(stiffness / MASS)
    viscous = math.pi * (2 * damping * omega * MASS) * omega * X_MAX**2
    assert viscous == pytest.approx(4 * loss, rel=1e-3)


def test_damping_of_30_percent_is_twice_the_equivalent_one():
    got = properties(ISOLATED.bearings, MASS, X_MAX)
    is_the_damping_of_an_equivalent_oscillator(got.damping_equivalent)
    fails(is_the_damping_of_an_equivalent_oscillator, 0.30)
    assert got.damping_paper == pytest.approx(0.30, abs=5e-4)
    assert got.damping_paper == pytest.approx(2 * got.damping_equivalent, rel=1e-12)


def test_period_of_2_seconds_holds_at_x_max_only():
    for amplitude in (0.05, 0.10, 0.20, X_MAX, 0.40):
        period = properties(ISOLATED.bearings, MASS, amplitude).period
        assert (abs(period - 2.0) < 0.005) == (amplitude == X_MAX)


def test_the_law_has_a_unit_of_length_inside():
    # the 1 of the brackets is 1 m: the same bearing in other units is another bearing
    scaled = BearingLaw.of(Bearings(ka=ISOLATED.bearings.ka / 1000, kb=LAW.kb / 1000, alpha=C.alpha))  # N/mm
    assert abs(scaled.hysteretic(0.0, 100.0) / LAW.hysteretic(0.0, 0.1) - 1) > 0.5
