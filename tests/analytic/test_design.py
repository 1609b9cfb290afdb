"""Bearing design: Table 1(a) to Table 1(b) and back, and targets that cannot be met."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from analytic import Bearings, SceneError, SettingError
from analytic.bearing import BearingLaw
from analytic.design import design_bearings, properties, steady_cycle

MASS = 3172.05 + 212.0
TABLE_1B = Bearings(count=4, ka=6.22e4, kb=6.22e3, alpha=44.69)


def test_table_1b_comes_out_of_table_1a_to_the_printed_digits():
    bearings = design_bearings(MASS, period=2.0, damping=0.30, x_max=0.30, definition="paper")
    assert f"{bearings.ka:.2e} {bearings.kb:.2e} {bearings.alpha:.2f}" == "6.22e+04 6.22e+03 44.69"


def test_table_1a_comes_out_of_table_1b():
    got = properties(TABLE_1B, MASS, 0.30)
    assert got.period == pytest.approx(1.9993, abs=5e-5)
    assert got.period_kb == pytest.approx(2.317, abs=5e-4)
    assert got.damping_paper == pytest.approx(0.300, abs=5e-4)
    assert got.damping_equivalent == pytest.approx(0.150, abs=5e-4)
    assert got.cycle_loss == pytest.approx(708.752, abs=5e-4)
    assert properties(TABLE_1B, MASS, 0.10).cycle_loss == pytest.approx(196.277, abs=5e-4)


@pytest.mark.parametrize("amplitude", [0.02, 0.10, 0.30, 1.0])
def test_cycle_loss_against_quadrature_and_the_closed_form(amplitude):
    law = BearingLaw.of(TABLE_1B)
    loss, force = steady_cycle(law, amplitude)
    z = -(force - law.kb * amplitude)  # the steady cycle is symmetric
    x = np.linspace(-amplitude, amplitude, 20001)
    forces = np.array([law.hysteretic(z, dx) for dx in x - x[0]])
    assert loss == pytest.approx(2 * np.trapezoid(forces, x), rel=1e-6)
    if amplitude >= 0.15:  # all on the limit curves
        limit = 4 * law.f0 * amplitude - 2 * law.dk / ((law.constants.alpha - 1) * (law.constants.alpha - 2))
        assert loss == pytest.approx(limit, rel=1e-9)


@settings(max_examples=60, deadline=None)
@given(st.floats(1.0, 4.0), st.floats(0.05, 0.3), st.floats(0.15, 0.6), st.sampled_from(["paper", "equivalent"]))
def test_every_design_meets_its_targets(period, damping, x_max, definition):
    try:
        bearings = design_bearings(MASS, period, damping, x_max, definition=definition)
    except SettingError as error:
        assert "damping" in str(error) or "x_max" in str(error)
        return
    got = properties(bearings, MASS, x_max)
    assert got.period == pytest.approx(period, rel=1e-3)
    assert (got.damping_paper if definition == "paper" else got.damping_equivalent) == pytest.approx(damping, rel=1e-3)


def test_impossible_damping_says_the_most_there_is():
    with pytest.raises(SettingError, match=r"cannot be met.*the most is 0\.\d+") as error:
        design_bearings(MASS, period=2.0, damping=1.5, x_max=0.30, definition="paper")
    most = float(str(error.value).split("the most is ")[1].split(";")[0])
    bearings = design_bearings(MASS, period=2.0, damping=0.9 * most, x_max=0.30, definition="paper")
    assert bearings.ka > bearings.kb > 0


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    "change",
    [
        {"period": 0.0},
        {"period": math.nan},
        {"damping": -0.1},
        {"x_max": 0.0},
        {"stiffness_ratio": 1.0},
        {"definition": "mine"},
        {"count": 0},
        {"damping": 1e308},
        {"mass": 1.01e20},
        {"period": 1e-21},
        {"x_max": 1e300},
        {"stiffness_ratio": 1e21},
    ],
)
def test_targets_out_of_range(change):
    targets = {"mass": MASS, "period": 2.0, "damping": 0.3, "x_max": 0.3, **change}
    with pytest.raises(SettingError, match=f"^{next(iter(change))} = "):
        design_bearings(**targets)


def test_one_bearing_carries_what_four_do():
    one, four = (design_bearings(MASS, 2.0, 0.15, 0.3, count=count) for count in (1, 4))
    assert (one.count, one.ka, one.kb) == (1, pytest.approx(4 * four.ka), pytest.approx(4 * four.kb))
    assert one.alpha == pytest.approx(four.alpha)


EXTREMES = (1e-308, 1e-20, 1e-4, 0.01, 0.64, 1.3, 30.0, 1e4, 1e20, 1e308)


@pytest.mark.filterwarnings("error")
@settings(max_examples=300, deadline=None)
@given(
    st.tuples(*(st.sampled_from((usual, *EXTREMES)) for usual in (MASS, 2.0, 0.15, 0.3))),
    st.sampled_from((1 + 1e-15, 1.1, 10.0, 1e6, 1e20, 1e308)),
    st.sampled_from(["paper", "equivalent"]),
)
def test_extreme_targets_are_met_or_refused_in_one_message_and_scipy_is_silent(targets, ratio, definition):
    try:
        design_bearings(*targets, stiffness_ratio=ratio, definition=definition)
    except (SettingError, SceneError):
        pass


def test_a_damping_beyond_that_of_any_loop_is_told_the_most_there_is():
    """No loop is wider than its rectangle: W_D = 4 F x is 2/pi of critical."""
    for damping in (2 / math.pi, 1e3, 1e20):
        with pytest.raises(SettingError, match=r"the most is 0\.2466"):
            design_bearings(MASS, 2.0, damping, 0.3)
