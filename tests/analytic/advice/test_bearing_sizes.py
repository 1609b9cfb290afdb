"""Sizes of bearings by hand, and pendulum bearings against closed forms."""

import math

import numpy as np
import pytest
from pytest import approx
from scipy.integrate import quad
from scipy.optimize import brentq

from analytic import Base, Bearings, Block, Scene, SettingError, Start, load_scene, simulate
from analytic.advice.bearing_sizes import (
    SLIDES_AT,
    bearing_sizes,
    design_pendulum,
    overlap_share,
    pendulum_bearings,
    pendulum_of,
)
from analytic.rocking import BearingLaw, design_bearings, properties

G = 9.81
BLOCK = Block(mass=1551.83, radius=0.989, slenderness=0.2818)
NAMES = ("core", "diameter", "height", "overlap", "pressure", "radius", "friction")


def bust():
    """Four bearings of 2.5 s and 15 % at .2 m under 1551.83 + 400 = 1951.83 kg, 4786.9 N on each.

    Secant 1951.83 (2 pi/2.5)^2/4 = 3082.2 N/m, 616.4 N at .2 m, of which kb x = 2295.05 x .2 = 459.0 N, so f0 = 157.4
    N: core sqrt(4 x 157.4/(pi 1e7)) = 4.48 mm. Height .2/1.5 = 133.3 mm; area 2295.05 x .13333/.4e6 = 765.0 mm2, a
    circle of 31.2 mm, less than the .2 m that it moves: nothing overlaps. Pressure 4786.9/765.0e-6 = 6.257 MPa.
    Pendulum: the loop .15 x 2 pi x 3082.2 x .2^2 = 116.2 J = 4 Q (.2 - .001), so Q = 145.97 N, mu = .03049;
    kb = 3082.2 - 145.97/.2 = 2352.4 N/m, R = 4786.9/2352.4 = 2.0349 m.
    """
    bearings = Bearings(count=4, ka=22950.5, kb=2295.05, alpha=66.6021, x_max=0.2)
    return bearings, 1951.83, (4.48e-3, 31.2e-3, 0.13333, 0.0, 6.257e6, 2.0349, 0.03049)


def urn():
    """An urn of 540 kg on a base of 200 kg, designed for 2.5 s and 15 % at .2 m.

    All forces of the bust scale by 740/1951.83 = .37913: core and diameter by its root, .61573, to 2.757 mm and
    19.22 mm; height, pressure, radius and friction stay.
    """
    return design_bearings(740.0, 2.5, 0.15, 0.2), 740.0, (2.757e-3, 19.22e-3, 0.13333, 0.0, 6.257e6, 2.0349, 0.03049)


def caryatid():
    """The paper's Caryatid, Table 1: 3172.05 + 212 = 3384.05 kg, 8299.4 N on each of four bearings, x_max .3 m.

    Force of eqs (11), (14) at .3 m 2506.65 N, less 6220 x .3 = 1866 N: f0 = 640.6 N, core sqrt(4 x 640.6/(pi 1e7)) =
    9.03 mm. Height .3/1.5 = 200 mm; area 6220 x .2/.4e6 = 3110 mm2, 62.9 mm. Pressure 8299.4/3110e-6 = 2.669 MPa.
    Pendulum: secant 2506.65/.3 = 8355.5 N/m; .15 x 2 pi x 8355.5 x .3^2 = 708.7 J = 4 Q (.3 - .001), Q = 592.6 N, mu =
    .0714; kb = 8355.5 - 592.6/.3 = 6380 N/m, R = 8299.4/6380 = 1.301 m.
    """
    scene = load_scene("caryatid-isolated")
    return scene.bearings, scene.total_mass, (9.03e-3, 62.9e-3, 0.2, 0.0, 2.669e6, 1.301, 0.0714)


@pytest.mark.parametrize("case", [bust, urn, caryatid])
def test_sizes_are_those_by_hand_and_no_such_bearing_is_made(case):
    bearings, mass, by_hand = case()
    sizes = bearing_sizes(bearings, mass)
    assert [getattr(sizes, name) for name in NAMES] == approx(by_hand, rel=1e-3)
    assert sizes.kind == "lead-rubber" and sizes.overlap_pressure is None
    assert [reason.partition(" ")[0] for reason in sizes.reasons] == ["lead", "rubber", "overlap"]
    size, unmade, instead = sizes.sentences
    assert (
        f"lead core {round(1000 * by_hand[0], 1):g} mm, rubber {1000 * by_hand[1]:.1f} mm" in size
        and "No such bearing is made: lead core" in unmade
    )
    assert f"radius of curvature {by_hand[5]:.3g} m, friction {by_hand[6]:.3g}" in instead
    assert "Assumed: lead yields at 10 MPa" in sizes.assumed


def test_bearings_of_a_building_are_made_and_nothing_alarms():
    """4 MN on 150 % of .2 m: kb = G A/T_r of 1 m^2 by .4e6/.13333 = 3 MN/m; Q_d of a core of 180 mm is 254 kN."""
    strength, kb = 1e7 * math.pi / 4 * 0.18**2, 3e6
    ka = 10 * kb
    bearings = Bearings(law="bilinear", count=1, ka=ka, kb=kb, yield_force=strength / 0.9, x_max=0.2)
    sizes = bearing_sizes(bearings, 4e6 / G)
    assert (sizes.core, sizes.height) == approx((0.18, 0.2 / 1.5)) and math.pi / 4 * sizes.diameter**2 == approx(1.0)
    assert sizes.pressure == approx(4e6) and sizes.overlap_pressure == approx(4e6 / sizes.overlap)
    assert sizes.reasons == () and len(sizes.sentences) == 1


def test_linear_bearings_are_of_rubber_alone_and_viscous_damping_counts():
    """1000 kg on one spring of (4 pi)^2 1000 N/m: .5 s; c of 10 % of critical, 2 x .1 x 4 pi x 1000 N s/m."""
    spring = Bearings(law="linear", ka=16000 * math.pi**2, damping=800 * math.pi, x_max=0.1)
    sizes = bearing_sizes(spring, 1000.0)
    assert (sizes.kind, sizes.core) == ("rubber", None)
    assert (sizes.radius, sizes.friction) == approx(pendulum_of(0.5, 0.1, 0.1))
    assert "outside what is made: radius" in sizes.sentences[-1]
    undamped = bearing_sizes(spring.model_copy(update={"damping": 0.0}), 1000.0)
    assert undamped.radius is None and undamped.sentences[-1].endswith("Olympia does.")
    assert bearing_sizes(spring.model_copy(update={"x_max": None}), 1000.0) is None


@pytest.mark.parametrize("share", [0.0, 0.1, 0.5, 0.9, 1.0, 2.0])
def test_the_overlap_is_that_of_two_circles(share):
    """Twice the segment of a unit circle beyond half the displacement."""
    half = min(share, 1.0)
    segment = quad(lambda x: 2 * math.sqrt(max(1 - x**2, 0.0)), half, 1.0, epsabs=1e-12)[0]
    assert overlap_share(2.0, 2 * share) == approx(2 * segment / math.pi, abs=1e-9)


@pytest.mark.parametrize("radius, friction, count", [(0.5, 0.15, 1), (2.0, 0.05, 4), (6.0, 0.03, 3)])
def test_a_pendulum_is_the_bilinear_law_whatever_the_mass(radius, friction, count):
    for mass in (50.0, 2000.0):
        bearings = pendulum_bearings(mass, radius, friction, count=count, x_max=0.2)
        law, weight = BearingLaw.of(bearings), mass * G / count
        assert (law.f0, law.kb) == approx((friction * weight, weight / radius))
        back = properties(bearings, mass, 0.2)
        assert back.period_kb == approx(2 * math.pi * math.sqrt(radius / G))
        assert back.force == approx(friction * weight + weight * 0.2 / radius)
        assert back.cycle_loss == approx(4 * friction * weight * (0.2 - SLIDES_AT))
        assert pendulum_of(back.period, back.damping_equivalent, 0.2) == approx((radius, friction))
        again = design_pendulum(mass, back.period, back.damping_equivalent, 0.2, count=count)
        assert again.model_dump() == approx(bearings.model_dump())
        sizes = bearing_sizes(bearings, mass)
        assert sizes.kind == "pendulum" and (sizes.radius, sizes.friction) == approx((radius, friction))
        assert sizes.reasons == () and "temperature" in sizes.assumed and "sliding begins at 1 mm" in sizes.assumed


@pytest.mark.parametrize(
    "radius, friction, reason", [(0.1, 0.05, "radius 0.1 m, below 0.25 m"), (2.0, 0.5, "friction 0.5, above 0.2")]
)
def test_a_pendulum_that_is_not_made_is_told(radius, friction, reason):
    sizes = bearing_sizes(pendulum_bearings(1000.0, radius, friction), 1000.0)
    assert reason in sizes.reasons[0] and "No such bearing is made" in sizes.sentences[1]


def released(radius, friction, displacement, duration):
    """The run of a statue whose base on pendula is released; it stands."""
    bearings = pendulum_bearings(1951.83, radius, friction)
    start = Start(base_displacement=displacement)
    response = simulate(Scene(block=BLOCK, base=Base(mass=400.0), bearings=bearings, start=start, duration=duration))
    assert response.outcome == "stands"
    return response.history


def test_a_pendulum_almost_without_friction_has_the_period_of_its_radius():
    history = released(2.0, 1e-6, 0.1, 12.0)
    falls = np.flatnonzero((history.base_displacement[:-1] > 0) & (history.base_displacement[1:] <= 0))
    x, t = history.base_displacement, history.time
    crossings = [t[k] + (t[k + 1] - t[k]) * x[k] / (x[k] - x[k + 1]) for k in falls]
    assert np.diff(crossings) == approx(2 * math.pi * math.sqrt(2.0 / G), rel=1e-4)


@pytest.mark.parametrize("radius, friction, displacement", [(2.0, 0.05, 0.35), (0.8, 0.05, 0.15), (6.0, 0.02, 0.9)])
def test_the_free_slide_decays_as_the_energy_of_the_loop_says(radius, friction, displacement):
    """From x0 to -x1 the law turns from Q to -Q over 2 x_y without work on the whole, and then takes Q a metre:
    kb (x0^2 - x1^2)/2 = Q (x0 + x1 - 2 x_y), over the weight; with x_y = 0 it is x0 - x1 = 2 mu R."""
    x = released(radius, friction, displacement, 1.3 * math.pi * math.sqrt(radius / G)).base_displacement

    def gap(turn):
        return (displacement**2 - turn**2) / (2 * radius) - friction * (displacement + turn - 2 * SLIDES_AT)

    expected = brentq(gap, 0.0, displacement)
    assert -x.min() == approx(expected, rel=1e-4)
    assert expected == approx(
        displacement - 2 * friction * radius, abs=4.1 * friction * radius * SLIDES_AT / displacement
    )


@pytest.mark.parametrize(
    "call, problem",
    [
        (lambda: pendulum_bearings(1000.0, 0.0, 0.05), "radius = 0.0: give a number from"),
        (lambda: pendulum_bearings(1000.0, 2.0, math.nan), "friction = nan"),
        (lambda: pendulum_bearings(1000.0, 2.0, 0.05, count=0), "count = 0"),
        (lambda: pendulum_of(2.0, 0.7, 0.2), "damping = 0.7: a pendulum has from 0 to 0.633"),
        (lambda: pendulum_of(2.0, 0.1, 0.001), "x_max = 0.001"),
    ],
)
def test_what_no_pendulum_has_is_refused(call, problem):
    with pytest.raises(SettingError, match=problem.replace(".", r"\.")):
        call()
