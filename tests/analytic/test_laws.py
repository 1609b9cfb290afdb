"""What every bearing law keeps, and the bilinear one against its closed forms."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from bearing_laws import F0, NAMES, USUAL, bearings_of, to_law
from hypothesis import given, settings
from hypothesis import strategies as st

from analytic import Base, Bearings, Block, PulseMotion, Scene, Start, load_scene, simulate, synthetic_motion
from analytic.bearing import BearingLaw
from analytic.design import properties, steady_cycle
from analytic.twin import simulate_twin

KA, KB = USUAL["ka"], USUAL["kb"]
YIELD = F0 / (KA - KB)  # x_y [m]
PLAIN = SimpleNamespace(where=lambda condition, a, b: a if condition else b, power=lambda a, b: a**b, exp=math.exp)

RULES = [BearingLaw.of(bearings_of(name)) for name in NAMES]
RULES.append(BearingLaw.of(bearings_of("algebraic", alpha=2.0, delta_k=1e-6)))
ANY_LAW = st.sampled_from(RULES)
TRAVELS = st.floats(1e-6, 1.0).flatmap(lambda size: st.sampled_from([size, -size]))


@settings(deadline=None)
@given(ANY_LAW, st.floats(-1, 1), TRAVELS)
def test_the_formula_for_engines_is_the_law(rule, share, dx):
    z, *sides = rule.moved(share * rule.f0, 0.0)
    assert rule.unit.expression(PLAIN, dx, *sides, *rule.constants) == pytest.approx(
        rule.hysteretic(z, dx), rel=1e-9, abs=1e-12 * F0
    )


NODES, WEIGHTS = np.polynomial.legendre.leggauss(40)


@settings(deadline=None, max_examples=50)
@given(ANY_LAW, st.floats(-1, 1), TRAVELS)
def test_work_is_the_integral_of_the_force(rule, share, dx):
    z, cuts = share * rule.f0, [0.0, *np.geomspace(1e-4, 1, 40)]
    found = sum(
        0.5 * (b - a) * dx * weight * rule.hysteretic(z, dx * (0.5 * (a + b) + 0.5 * (b - a) * node))
        for a, b in zip(cuts[:-1], cuts[1:], strict=True)
        for node, weight in zip(NODES, WEIGHTS, strict=True)
    )
    assert rule.work(z, dx) == pytest.approx(found, rel=2e-5, abs=1e-7 * F0 * abs(dx))


@pytest.mark.parametrize("name", NAMES)
def test_a_start_in_mid_path_is_continued_as_the_law_says(name):
    """`begin`, `term` and `reached` of the kernel's step, against `after_travel`, on a base that is let go."""
    scene = contact(law=name, start=Start(base_displacement=0.5 * YIELD, base_velocity=0.2), duration=0.02)
    end, rule = simulate(scene).end, BearingLaw.of(scene.bearings)
    z = rule.hysteretic(0.0, end.base_displacement)  # still on its way out
    assert end.base_velocity > 0
    assert end.bearing_force == pytest.approx(rule.force(end.base_displacement, z), rel=1e-13)


# The bilinear law.

HEAVY = Block(mass=3172.05, radius=1.0884, slenderness=1.2)  # never lifts here
ROCKING = Scene(
    block=Block(mass=3172.05, radius=1.0884, slenderness=0.2),
    base=Base(mass=212.0),
    bearings=bearings_of("bilinear", count=4),
    motion=PulseMotion("one-sine", 3.0, 6.0),
    duration=4.0,
)


def contact(law="bilinear", start=None, duration=3.0, motion=None, **keys):
    return Scene(
        block=HEAVY,
        base=Base(mass=212.0),
        bearings=bearings_of(law, count=4, **keys),
        duration=duration,
        motion=motion,
        start=start or Start(),
    )


def phase(k, push, mass, x, v):
    """Of mass x'' = -k x - push: (x, v) at time t, and the times at which x is reached moving as v, and of v = 0."""
    w = math.sqrt(k / mass)
    centre = -push / k
    amplitude, angle = math.hypot(x - centre, v / w), math.atan2(-v / w, x - centre)

    def state(t):
        return centre + amplitude * math.cos(w * t + angle), -amplitude * w * math.sin(w * t + angle)

    def reaches(at):
        if abs(at - centre) > amplitude:
            return math.inf
        sign = -1.0 if v > 0 else 1.0
        return (sign * math.acos((at - centre) / amplitude) - angle) % (2 * math.pi) / w

    return state, reaches, -angle % math.pi / w


def exact_free_vibration(scene):
    """(x, v, times of yielding), phase after phase in closed form: from x = 0, v > 0 on the virgin bearing."""
    rule, mass, left = BearingLaw.of(scene.bearings), scene.total_mass, scene.duration
    x, v, z, yields = 0.0, scene.start.base_velocity, 0.0, []
    n, kb, dk, f0 = rule.count, rule.kb, rule.dk, rule.f0
    yielded = False
    while True:
        s = math.copysign(1.0, v)
        if yielded:
            state, _, turn = phase(n * kb, n * s * f0, mass, x, v)
            length = turn
        else:
            at = x + (s * f0 - z) / dk
            state, reaches, turn = phase(n * (kb + dk), n * (z - dk * x), mass, x, v)
            turn = turn or math.pi / math.sqrt(n * (kb + dk) / mass)
            length = min(reaches(at), turn)
        if length >= left:
            x, v = state(left)
            return x, v, yields
        moved, v = state(length)
        left -= length
        if yielded or length == turn:  # at rest: back on the line of ka, to the side that the force says
            z = s * f0 if yielded else z + dk * (moved - x)
            v, yielded = -1e-300 * (kb * moved + z), False
        else:
            z, yielded = s * f0, True
            yields.append(scene.duration - left)
        x = moved


def test_free_vibration_after_yield_is_the_piecewise_exact_one():
    scene = contact(start=Start(base_velocity=0.9), duration=6.0)
    x, v, yields = exact_free_vibration(scene)
    assert len(yields) >= 2 and yields[0] < 0.1 < 6.0 - yields[-1]
    response = simulate(scene, tolerance=1e-16)
    assert response.end.base_displacement == pytest.approx(x, abs=1e-13)
    assert response.end.base_velocity == pytest.approx(v, abs=1e-12)
    twin = simulate_twin(scene, rtol=1e-12, atol=1e-14).end
    assert (twin.base_displacement, twin.base_velocity) == pytest.approx((x, v), abs=1e-11)


@pytest.mark.parametrize(
    "scene",
    [
        ROCKING,
        contact(motion=synthetic_motion(), duration=20.0),
        load_scene("caryatid-isolated").with_(bearings=to_law("bilinear"), duration=20.0),
    ],
    ids=["rocking", "contact", "Caryatid"],
)
def test_ledger_closes(scene):
    energy = simulate(scene).energy
    assert abs(energy.imbalance) < 1e-11 * energy.input and energy.hysteretic > 0.1 * energy.input


def test_loss_of_a_cycle_and_equivalent_stiffness_are_those_of_the_codes():
    bearings, X = bearings_of("bilinear", count=4), 0.2
    loss, force = steady_cycle(BearingLaw.of(bearings), X)
    assert force == pytest.approx(KB * X + F0, rel=1e-14)
    assert loss == pytest.approx(4 * F0 * (X - YIELD), rel=1e-13)
    assert steady_cycle(BearingLaw.of(bearings), 0.9 * YIELD)[0] == pytest.approx(0.0, abs=1e-12 * F0)  # elastic
    got = properties(bearings, 3384.05, X)
    assert got.secant_stiffness == pytest.approx(KB + F0 / X, rel=1e-14)
    assert got.damping_equivalent == pytest.approx(2 * F0 * (X - YIELD) / (math.pi * (KB + F0 / X) * X**2), rel=1e-13)


def test_yield_force_is_where_ka_ends():
    one, at = BearingLaw.of(Bearings(law="bilinear", ka=KA, kb=KB, yield_force=900.0)), 900.0 / KA
    for x, expected in ((0.5 * at, 450.0), (at, 900.0), (3 * at, 900.0 + 2 * at * KB), (-3 * at, -900.0 - 2 * at * KB)):
        assert one.force(x, one.start(x)) == pytest.approx(expected, rel=1e-13)


def test_strong_bearings_stay_on_their_first_line():
    strong = ROCKING.with_(bearings={"yield_force": 1e9}, motion=PulseMotion("one-sine", 1.6, 6.0))
    linear = strong.with_(bearings={"law": "linear", "yield_force": None})
    one, other = simulate(strong), simulate(linear)
    assert one.outcome == other.outcome == "rocks" and one.impact_count == other.impact_count > 0
    assert [impact.time for impact in one.impacts] == pytest.approx([impact.time for impact in other.impacts], rel=1e-9)
    assert one.end.bearing_force == pytest.approx(other.end.bearing_force, rel=1e-7)


def test_equal_stiffnesses_are_a_linear_bearing():
    gaps = []
    for share in (1e-3, 1e-4, 1e-5):
        bilinear = contact(motion=PulseMotion("one-sine", 3.0, 4.0), kb=KA * (1 - share))
        linear = contact("linear", motion=PulseMotion("one-sine", 3.0, 4.0))
        gaps.append(abs(simulate(bilinear).end.base_displacement - simulate(linear).end.base_displacement))
    assert np.diff(np.log10(gaps)) == pytest.approx([-1, -1], abs=0.05)


def test_error_of_the_second_implementation_falls_with_its_tolerance():
    scene = contact(start=Start(base_velocity=0.9), duration=2.0)
    exact = exact_free_vibration(scene)[0]
    errors = [
        abs(simulate_twin(scene, rtol=rtol, method="RK45", max_step=1.0).end.base_displacement - exact)
        for rtol in (1e-4, 1e-6, 1e-8, 1e-10)
    ]
    assert np.diff(np.log10(errors)).mean() == pytest.approx(-2, abs=0.4)


@pytest.mark.parametrize("steps", [24, 18, 12, 8])
def test_corners_keep_the_order_of_the_series(steps):
    """The error falls with the tolerance as if there were no corner."""
    scene = contact(start=Start(base_velocity=0.9), duration=2.0)
    exact = exact_free_vibration(scene)[0]
    error = abs(simulate(scene, tolerance=10.0 ** -(steps / 2)).end.base_displacement - exact)
    assert error < max(1e2 * 10.0 ** -(steps / 2), 1e-14)
