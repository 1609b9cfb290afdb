import math

import numpy as np
import pytest
from bearing_laws import bearings_of
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from analytic.bearing import BearingLaw
from analytic.scene import Bearings

KA, KB, ALPHA = 6.22e4, 6.22e3, 44.69
PAPER = BearingLaw.of(Bearings(ka=KA, kb=KB, alpha=ALPHA))
BOUC_WEN = BearingLaw.of(Bearings(law="bouc-wen", ka=KA, kb=KB, alpha=ALPHA))
EXTREME = [(KA, KB, 1.5), (KA, KB, 200.0), (1.0001 * KB, KB, ALPHA), (KA, KB, 1.001), (KA, 0.0, 3.0)]


def bearing(ka, kb, alpha):
    return BearingLaw.of(Bearings(ka=ka, kb=kb, alpha=alpha, delta_k=min(1e-20, 1e-6 * (ka - kb))))


def rate(law, z, s):
    """dz/dx of the algebraic law in direction s, with the D0-small term in full."""
    c = law.constants
    y = c.d0 + (1 - c.alpha) * (s * z - c.f0) / c.dk
    return c.dk * max(y, 0.0) ** (c.alpha / (c.alpha - 1))


def test_constants_of_table_1b():
    assert 2 * PAPER.constants.x0 == pytest.approx(2.57907793, abs=1e-8)
    assert PAPER.f0 == pytest.approx(640.65003, abs=1e-5)


def test_slopes():
    h = 1e-6  # extrapolated from h and h/2: the law bends within centimetres
    virgin = (4 * PAPER.hysteretic(0.0, h / 2) - PAPER.hysteretic(0.0, h)) / h + KB
    assert virgin == pytest.approx(33769.44, abs=0.01)
    # right after a reversal on the limit curve the stiffness is ka
    limit = PAPER.hysteretic(0.0, 2.0)
    assert (limit - PAPER.hysteretic(limit, -1e-8)) / 1e-8 + KB == pytest.approx(KA, rel=1e-5)


@pytest.mark.parametrize("case", EXTREME)
def test_closed_form_solves_the_rate_form(case):
    law = bearing(*case)
    for share, s in ((0.0, 1), (0.7, -1), (-0.99, 1), (1.0, -1)):
        z0 = share * law.f0
        travel = np.array([1e-4, 0.01, 0.1, 1.0, 2.0])  # beyond 1.33 m
        path = solve_ivp(
            lambda u, z, s=s: [s * rate(law, z[0], s)], (0, 2.0), [z0], "LSODA", travel, rtol=1e-11, atol=1e-11 * law.f0
        )
        closed = [law.hysteretic(z0, s * u) for u in travel]
        np.testing.assert_allclose(closed, path.y[0], rtol=0, atol=1e-8 * law.f0)


def test_bouc_wen_solves_its_rate_and_has_the_same_limits():
    law = BOUC_WEN
    assert (law.f0, law.kb, law.dk) == (PAPER.f0, PAPER.kb, PAPER.dk)
    path = solve_ivp(lambda u, z: [-0.5 * law.dk * (1 + z[0] / law.f0)], (0, 0.1), [law.f0], rtol=1e-11, atol=1e-9)
    assert law.hysteretic(law.f0, -0.1) == pytest.approx(path.y[0, -1], abs=1e-7)


def test_linear_bearing_has_no_memory():
    law = BearingLaw.of(Bearings(law="linear", ka=1e4, count=3, damping=5.0))
    assert law.force(0.1, law.start(0.1), 2.0) == pytest.approx(3 * (1000 + 10))
    assert BearingLaw.of(None).force(0.1, 0.0, 1.0) == 0


BILINEAR = BearingLaw.of(bearings_of("bilinear"))
LAWS = st.sampled_from([PAPER, BOUC_WEN, BILINEAR, *(bearing(*case) for case in EXTREME)])
TRAVELS = st.floats(-3.0, 3.0).filter(lambda u: u == 0 or abs(u) > 1e-12)
SHARES = st.floats(-1.0, 1.0)


@given(LAWS, SHARES, TRAVELS, st.floats(0.0, 1.0))
@settings(deadline=None)
def test_travel_may_be_cut_anywhere(law, share, travel, cut):
    z = share * law.f0
    middle = law.hysteretic(z, cut * travel)
    assert law.hysteretic(middle, travel - cut * travel) == pytest.approx(law.hysteretic(z, travel), abs=1e-9 * law.f0)


@given(LAWS, SHARES, TRAVELS)
@settings(deadline=None)
def test_bounded_monotone_and_odd(law, share, travel):
    z = share * law.f0
    after = law.hysteretic(z, travel)
    assert math.isfinite(after) and abs(after) <= law.f0 * (1 + 1e-12)
    assert (after - z) * travel >= -1e-12 * law.f0 * abs(travel)
    assert law.hysteretic(-z, -travel) == -after


@given(LAWS, SHARES, st.sampled_from([-1, 1]), st.floats(1e-13, 1e-9))
@settings(deadline=None)
def test_force_is_continuous_at_reversals(law, share, s, travel):
    # a tiny travel in either direction changes z by no more than the largest stiffness allows
    z = share * law.f0
    assert abs(law.hysteretic(z, s * travel) - z) <= law.dk * travel * (1 + 1e-6) + 1e-9 * law.f0
    assert law.hysteretic(z, 0.0) == z
