"""The equations and the law of impact against Lagrange's equations, Newton's, momentum, and those of one block."""

import math
from itertools import product

import numpy as np
import pytest
from stack_scenes import FIGURE, GRAVITY, STACK, random_stack, rectangle

from analytic import Pedestal, Scene
from analytic.rocking import RockingModel, momentum_restitution, uplift_of_both
from analytic.stack.equations import LOWER, UPPER, StackModel


def turned(across, up, tilt):
    return np.array([across * np.cos(tilt) + up * np.sin(tilt), up * np.cos(tilt) - across * np.sin(tilt)])


def centres(model, sides, tilts, rates, v):
    """Return (from the pedestal's pivot, velocity) of both centres; a vector turns on by a quarter at its velocity."""
    (one, two), (s1, s2), (p1, p2) = model.slabs, sides, tilts
    parts = [
        [(-s1 * one.b, one.h, p1, rates[0])],
        [(s2 * two.b - s1 * one.b, 2 * one.h, p1, rates[0]), (-s2 * two.b, two.h, p2, rates[1])],
    ]
    places = [sum(turned(x, z, tilt) for x, z, tilt, _ in each) for each in parts]
    return [
        (place, np.array([v, 0]) + sum(turned(x, z, tilt + np.pi / 2) * w for x, z, tilt, w in each))
        for place, each in zip(places, parts, strict=True)
    ]


def energies(model, sides, q, qd, gravity):
    """Return (T, V) of coordinates (x, phi_1, phi_2), analytic in them."""
    moving, height = 0.5 * model.base * qd[0] ** 2, 0.0
    for slab, w, (place, velocity) in zip(
        model.slabs, qd[1:], centres(model, sides, q[1:], qd[1:], qd[0]), strict=True
    ):
        moving += 0.5 * (slab.mass * (velocity**2).sum() + slab.inertia * w**2)
        height += slab.mass * gravity * place[1]
    return moving, height


def lagrange(model, sides, q, qd, ground, force, gravity):
    """Return q'' of Lagrange's equations: the mass matrix by polarisation of T, derivatives by complex steps."""
    one, step = np.eye(3), 1e-30

    def mass(q):
        def kinetic(qd):
            return energies(model, sides, q, qd, gravity)[0]

        return np.array([[(kinetic(a + b) - kinetic(a - b)) / 2 for a in one] for b in one])

    turning = np.imag(mass(q + 1j * step * qd)) / step @ qd
    gradient = [np.subtract(*energies(model, sides, q + 1j * step * each, qd, gravity)).imag / step for each in one]
    return np.linalg.solve(mass(q), gradient - turning - mass(q)[0] * ground - np.array([force, 0, 0]))


def test_they_are_lagranges_equations():
    rng = np.random.default_rng(0)
    for _ in range(50):
        model = StackModel.of(random_stack(rng, base=rng.uniform(0.1, 2)))
        sides, (p1, p2, w1, w2, v), (ground, up, force) = (
            rng.choice([-1, 1], 2).tolist(),
            rng.uniform(-1, 1, 5).tolist(),
            rng.uniform(-5, 5, 3),
        )
        now = model.instant(sides, (p1, p2), (w1, w2), ground, 1e3 * force, up)
        q, qd = np.array([0, p1, p2]), np.array([v, w1, w2])
        expected = lagrange(model, sides, q, qd, ground, 1e3 * force, GRAVITY + up)
        assert [now.a - ground, *now.spins] == pytest.approx(expected, abs=1e-12 * np.abs(expected).max())


@pytest.mark.parametrize("sides", list(product((-1, 0, 1), repeat=2)))
def test_its_forces_are_newtons_in_all_nine_states(sides):
    """Moments about both centres, and the base's equation, of forces that act at the centres of pressure."""
    rng = np.random.default_rng(1)
    for base in (None, 0.5):
        model = StackModel.of(random_stack(rng, base))
        p1, w1 = rng.uniform(-0.4, 0.4, 2) * (sides[0] != 0)
        p2, w2 = (p1, w1) + rng.uniform(-0.4, 0.4, 2) * (sides[1] != 0)
        now = model.instant(sides, (p1, p2), (w1, w2), 2.0, 700.0)
        (one, two), (x1, x2) = model.slabs, now.pressure
        G, F = np.array([now.along[0], now.normal[0]]), turned(now.along[1], now.normal[1], p1)
        arms = turned(x1, -one.h, p1), turned(x2, one.h, p1), turned(x2, -two.h, p1)
        if sides[1]:
            arms = (*arms[:2], turned(x2, -two.h, p2))
        moments = [arm[1] * push[0] - arm[0] * push[1] for arm, push in zip(arms, (G, -F, F), strict=True)]
        scale = model.slabs[0].mass * GRAVITY
        assert moments[0] + moments[1] == pytest.approx(one.inertia * now.spins[0], abs=1e-12 * scale)
        assert moments[2] == pytest.approx(two.inertia * now.spins[1], abs=1e-12 * scale)
        held = now.a - 2.0 if base is None else model.base * now.a + 700.0 + G[0]
        assert held == pytest.approx(0, abs=1e-11 * scale)


@pytest.mark.parametrize("side", (-1, 1))
def test_what_is_weaker_lifts_first(side):
    slim = STACK.with_(pedestal={"width": 0.3})
    limits = GRAVITY * math.tan(FIGURE.slenderness), uplift_of_both(slim)
    assert limits[1] < limits[0] < uplift_of_both(STACK)
    for scene, limit, lifted in ((STACK, limits[0], [0, -side]), (slim, limits[1], [-side, 0])):
        for share, sides in ((1 - 1e-9, [0, 0]), (1 + 1e-9, lifted)):
            loads = side * limit * share, 0.0, 0.0
            assert StackModel.of(scene).opened((0, 0), (True, True), (0, 0), (0, 0), *loads) == sides


@pytest.mark.parametrize("base", (None, 0.2))
def test_a_statue_on_a_wide_pedestal_lands_by_eqs_7_and_8(base):
    rng, flat = np.random.default_rng(2), 0
    for _ in range(60):
        scene = random_stack(rng, base)
        stocky = scene.with_(block={"slenderness": float(rng.uniform(0.1, 1.0))}, pedestal={"width": 200.0})
        rate, v, e = -float(rng.uniform(0.1, 2)), 0.3 * (base is not None), momentum_restitution(stocky)
        kept, flat = max(e, 0.0), flat + (e < 0)  # of a stocky one e < 0: it lands flat
        answer, *others = StackModel.of(stocky).impact((0, 1), (0.0, 0.0), (0.0, rate), v, (True, True))
        jump = RockingModel.of(stocky).jump_arm * (rate - kept * rate)
        assert not others and answer.sides == [0, 0 if e < 0 else -1]
        assert [answer.rates[1], answer.v - v] == pytest.approx([kept * rate, jump], abs=1e-11)
    assert 0 < flat < 60


def test_a_landing_by_hand():
    """A statue of 120 kg, .2 x .6 m, lands at 1 rad/s on a pedestal .74 m high.

    By eq. (7) e = 1 - 1.5 b^2/R^2 = 1 - .015/.1 = .85. The statue gets m b (1 + e) = 22.2 N s upward and m h (1 - e) =
    5.4 N s along. So the pedestal stays down if 22.2 (b_1 - .1) > 5.4 x .74: if it is wider than 2 x .28 m.
    """
    scene = Scene(block=rectangle(0.2, 0.6, 120.0), pedestal=Pedestal(width=0.561, mass=600.0, height=0.74, free=True))
    landing = (0, 1), (0.0, 0.0), (0.0, -1.0), 0.0, (True, True)
    wide, *none = StackModel.of(scene).impact(*landing)
    assert not none and wide.sides == [0, -1] and wide.rates == pytest.approx((0.0, -0.85), abs=1e-12)
    assert wide.impulses == pytest.approx((5.4 + 22.2j, 5.4 + 22.2j), abs=1e-10)
    narrow, *none = StackModel.of(scene.with_(pedestal={"width": 0.559})).impact(*landing)
    assert not none and narrow.sides == [-1, -1] and -1e-2 < narrow.rates[0] < 0


def moment(slab, place, velocity, rate):
    """Return the angular momentum about the point from which the place is counted."""
    return slab.inertia * rate + slab.mass * (place[1] * velocity[0] - place[0] * velocity[1])


@pytest.mark.parametrize("landing", (LOWER, UPPER))
@pytest.mark.parametrize("base", (None, 0.5))
def test_it_keeps_the_momenta_of_the_published_impact_formulas(landing, base):
    """Of the whole about the new pivot, of the statue about its corner, and that of the whole along the base."""
    rng, used, gains = np.random.default_rng(3), 0, []
    for _ in range(100):
        model, sides = StackModel.of(random_stack(rng, base)), rng.choice([-1, 1], 2).tolist()
        rates, tilts, shut = rng.uniform(-1, 1, 2), sides * rng.uniform(0.01, 0.2, 2), [k == landing for k in (0, 1)]
        rates[landing], tilts[landing] = -sides[landing] * abs(rates[landing]), 0.0
        before, absolute, v = np.cumsum(rates).tolist(), np.cumsum(tilts).tolist(), 0.4 * (base is not None)
        answers = model.impact(sides, absolute, before, v, shut)
        for answer in answers:
            if None in answer.sides or 0 in answer.sides:
                continue
            found, used = [], used + 1
            for corners, ws, x in ((sides, before, v), (answer.sides, answer.rates, answer.v)):
                states = centres(model, corners, absolute, ws, x)
                places = [place for place, _ in centres(model, answer.sides, absolute, ws, x)]
                reach = answer.sides[1] * model.slabs[1].b - answer.sides[0] * model.slabs[0].b
                own = places[1] - turned(reach, 2 * model.slabs[0].h, absolute[0])
                parts = list(zip(model.slabs, [velocity for _, velocity in states], ws, strict=True))
                whole = sum(moment(part[0], place, *part[1:]) for place, part in zip(places, parts, strict=True))
                along = 0.0 if base is None else model.base * x + sum(slab.mass * u[0] for slab, u, _ in parts)
                energy = model.kinetic_energy(corners, absolute, ws, x)
                found.append([whole, moment(model.slabs[1], own, states[1][1], ws[1]), along, energy])
            assert found[1][:3] == pytest.approx(found[0][:3], abs=1e-10 * model.slabs[0].mass)
            gains.append(found[1][3] - found[0][3])
    assert used > 50 and max(gains) < 0


def test_an_impact_has_at_most_one_answer_that_keeps_all_interfaces():
    rng, jumping = np.random.default_rng(4), 0
    for _ in range(300):
        model, (s1, s2) = StackModel.of(random_stack(rng)), rng.choice([-1, 1], 2)
        tilt, w = s1 * rng.uniform(0.005, 0.3), -s2 * rng.uniform(0, 1)
        w1 = rng.uniform(-1, 1)
        answers = model.impact((s1, s2), (tilt, tilt), (w1, w1 + w), 0.0, (False, True))
        assert sum(None not in answer.sides for answer in answers) <= 1
        jumping += any(None in answer.sides for answer in answers)
    assert 0 < jumping < 60
