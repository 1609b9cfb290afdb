"""What every bearing law keeps, and the bilinear one against its closed forms."""

import math

import numpy as np
import pytest
from bearing_laws import F0, NAMES, USUAL, bearings_of
from hypothesis import given, settings
from hypothesis import strategies as st

from analytic import Base, Block, Scene, Start, simulate
from analytic.bearing import BearingLaw
from analytic.design import properties, steady_cycle
from analytic.twin import simulate_twin

KA, KB = USUAL["ka"], USUAL["kb"]
YIELD = F0 / (KA - KB)  # x_y [m]

RULES = [BearingLaw.of(bearings_of(name)) for name in NAMES]
RULES.append(BearingLaw.of(bearings_of("algebraic", alpha=2.0, delta_k=1e-6)))
ANY_LAW = st.sampled_from(RULES)
TRAVELS = st.floats(1e-6, 1.0).flatmap(lambda size: st.sampled_from([size, -size]))


NODES, WEIGHTS = np.polynomial.legendre.leggauss(40)


@settings(deadline=None, max_examples=50)
@given(ANY_LAW, st.floats(-1, 1), TRAVELS)
def test_work_is_the_integral_of_the_force(rule, share, dx):
    z, s, cuts = share * rule.f0, math.copysign(1.0, dx), [0.0, *np.geomspace(1e-4, 1, 40)]
    corner = rule.unit.begin.py_func(s, z, 1.0, rule.constants)[2]  # where the force bends
    if corner < math.inf:
        cuts = sorted([*cuts, min((corner - s * z) / rule.dk / abs(dx), 1.0)])
    found = sum(
        0.5 * (b - a) * dx * weight * rule.hysteretic(z, dx * (0.5 * (a + b) + 0.5 * (b - a) * node))
        for a, b in zip(cuts[:-1], cuts[1:], strict=True)
        for node, weight in zip(NODES, WEIGHTS, strict=True)
    )
    assert rule.work(z, dx) == pytest.approx(found, rel=2e-5, abs=1e-7 * F0 * abs(dx))


@pytest.mark.parametrize("name", NAMES)
def test_a_start_in_mid_path_is_continued_as_the_law_says(name):
    """`begin`, `term` and `reached` of the kernel's step, against `after_travel`, on a base that is released."""
    scene = contact(law=name, start=Start(base_displacement=0.5 * YIELD, base_velocity=0.2), duration=0.02)
    end, rule = simulate(scene).end, BearingLaw.of(scene.bearings)
    z = rule.hysteretic(0.0, end.base_displacement)  # still on its way out
    assert end.base_velocity > 0
    assert end.bearing_force == pytest.approx(rule.force(end.base_displacement, z), rel=1e-13)


# The bilinear law.

HEAVY = Block(mass=3172.05, radius=1.0884, slenderness=1.2)  # never lifts here


def contact(law="bilinear", start=None, duration=3.0, motion=None, **keys):
    return Scene(
        block=HEAVY,
        base=Base(mass=212.0),
        bearings=bearings_of(law, count=4, **keys),
        duration=duration,
        motion=motion,
        start=start or Start(),
    )


RELEASED = contact(start=Start(base_velocity=0.9), duration=1.2)


def swing(stiffness, mass, centre, x, v):
    """Of mass x'' = -stiffness (x - centre): its frequency, amplitude, phase and the motion (x, v) at a time."""
    w = math.sqrt(stiffness / mass)
    amplitude, angle = math.hypot(x - centre, v / w), math.atan2(-v / w, x - centre)
    return (
        w,
        amplitude,
        lambda t: (centre + amplitude * math.cos(w * t + angle), -amplitude * w * math.sin(w * t + angle)),
    )


def exact_free_vibration(scene):
    """(x, v) in closed form from x = 0 on the virgin bearing: to yield, to the turn, to yield again, and on."""
    n, mass, v = scene.bearings.count, scene.total_mass, scene.start.base_velocity
    w, amplitude, elastic = swing(n * KA, mass, 0.0, 0.0, v)
    first = math.asin(YIELD / amplitude) / w
    w, amplitude, _ = swing(n * KB, mass, -F0 / KB, *elastic(first))
    turn = math.acos((YIELD + F0 / KB) / amplitude) / w
    far = amplitude - F0 / KB
    w, amplitude, back = swing(n * KA, mass, far - (KB * far + F0) / KA, far, 0.0)
    second = math.acos(1 - 2 * YIELD / amplitude) / w
    left = scene.duration - first - turn - second
    w, _, plastic = swing(n * KB, mass, F0 / KB, *back(second))
    assert 0 < left and plastic(left)[1] < 0  # before it turns again
    return plastic(left)


def test_free_vibration_after_yield_is_the_piecewise_exact_one():
    x, v = exact_free_vibration(RELEASED)
    end = simulate(RELEASED, tolerance=1e-16).end
    assert end.base_displacement == pytest.approx(x, abs=1e-13)
    assert end.base_velocity == pytest.approx(v, abs=1e-12)
    twin = simulate_twin(RELEASED, rtol=1e-12, atol=1e-14).end
    assert (twin.base_displacement, twin.base_velocity) == pytest.approx((x, v), abs=1e-11)


def test_loss_of_a_cycle_and_equivalent_stiffness_are_those_of_the_codes():
    bearings, X = bearings_of("bilinear", count=4), 0.2
    loss, force = steady_cycle(BearingLaw.of(bearings), X)
    assert force == pytest.approx(KB * X + F0, rel=1e-14)
    assert loss == pytest.approx(4 * F0 * (X - YIELD), rel=1e-13)
    assert steady_cycle(BearingLaw.of(bearings), 0.9 * YIELD)[0] == pytest.approx(0.0, abs=1e-12 * F0)  # elastic
    got = properties(bearings, 3384.05, X)
    assert got.secant_stiffness == pytest.approx(KB + F0 / X, rel=1e-14)
    assert got.damping_equivalent == pytest.approx(2 * F0 * (X - YIELD) / (math.pi * (KB + F0 / X) * X**2), rel=1e-13)


@pytest.mark.parametrize("steps", [24, 18, 12, 8])
def test_corners_keep_the_order_of_the_series(steps):
    """The error falls with the tolerance as if there were no corner."""
    end = simulate(RELEASED, tolerance=10.0 ** -(steps / 2)).end
    error = abs(end.base_displacement - exact_free_vibration(RELEASED)[0])
    assert error < max(1e2 * 10.0 ** -(steps / 2), 1e-14)
