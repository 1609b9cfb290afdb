"""Whether the pedestal stays, against statics by hand, a landing's closed form, and two blocks by Moreau's method."""

import math

import numpy as np
import pytest

from analytic import Base, Bearings, Block, Pedestal, PulseMotion, Scene, simulate
from analytic.advice import pedestal
from analytic.advice.pedestal import check_pedestal
from analytic.checks.two_bodies import simulate_two_bodies
from analytic.rocking import momentum_restitution, uplift_of_both

G = 9.81
BUST = Block(mass=120.0, radius=math.hypot(0.125, 0.35), slenderness=math.atan2(0.125, 0.35))
UNDER = Pedestal(width=0.4, mass=430.0, height=1.0)
# a tuple: stiff bearings, of which the peak of the base is not that of the ground
ON_BASE = {"base": Base(mass=200.0), "bearings": Bearings(law="linear", ka=2e5, damping=500.0)}


def shaken(amplitude, frequency=2 * math.pi * 1.5, **more):
    return Scene(block=BUST, pedestal=UNDER, motion=PulseMotion("one-sine", amplitude, frequency), **more)


def test_at_rest_it_stays_up_to_the_uplift_of_both_by_hand():
    by_hand = G * 0.2 * (120 + 430) / (430 * 0.5 + 120 * 1.35)  # g b_1/h_c
    assert uplift_of_both(shaken(1.0)) == pytest.approx(by_hand, rel=1e-14)
    for factor, stays in ((0.998, True), (1.002, False)):
        check = check_pedestal(shaken(factor * by_hand))
        assert (check.most <= 1) == stays and check.share == pytest.approx(factor, rel=1e-3) and check.landing == 0.0
        assert check.text.startswith("The pedestal stays: this answer holds" if stays else "The pedestal may lift: ")
        assert len(check.cautions) == (not stays)


def test_no_peak_between_samples_is_missed():
    """The bound is above the peak of a level block, which is known, and by little, wherever the samples fall."""
    for frequency in np.linspace(3.0, 60.0, 23):
        check = check_pedestal(shaken(2.0, frequency))
        assert 2.0 / uplift_of_both(shaken(1.0)) <= check.share < 1.01 * 2.0 / uplift_of_both(shaken(1.0))


def test_a_landing_on_the_ground_is_the_closed_form():
    scene = shaken(3.7)
    b, h, e = BUST.half_width, BUST.half_height, momentum_restitution(scene)
    check = check_pedestal(scene)
    assert simulate(scene).impacts
    assert check.landing * 0.2 == pytest.approx(b + 1.0 * h * (1 - e) / (b * (1 + e)), rel=1e-12)


def test_a_landing_on_a_base_is_the_balance_of_momentum():
    """By hand from the velocities before and after: of the block, its centre, the pedestal and the base."""
    scene = shaken(4.0, 25.0, **ON_BASE)
    response = simulate(scene)
    impact = response.impacts[0]
    b, h = BUST.half_width, BUST.half_height
    before, after, jump = impact.rate_before, impact.rate_after, impact.base_velocity_jump
    s = -math.copysign(1.0, before)  # the side from which it comes; it lands on the other corner
    across = BUST.mass * (jump + h * (after - before))
    up = BUST.mass * (-s * b * after - s * b * before)
    moment = -s * b * up - 1.0 * across - UNDER.mass * 0.5 * jump
    assert up > 0 and across == pytest.approx(-(200 + UNDER.mass) * jump, rel=1e-9)
    assert check_pedestal(scene).landing * 0.2 == pytest.approx(abs(moment) / up, rel=1e-9)


def test_a_given_restitution_takes_its_couple_from_the_pedestal():
    scene = shaken(3.7).with_(block={"restitution": 0.7})
    b, h, inertia = BUST.half_width, BUST.half_height, BUST.centre_inertia / BUST.mass
    lost = 0.3 / (1.7 * b)  # P/Q = h lost; the moment about the centre places Q
    assert check_pedestal(scene).landing * 0.2 == pytest.approx(lost * (inertia + h * h + 1.0 * h), rel=1e-12)


@pytest.mark.parametrize("more", [{}, ON_BASE, {"friction": 0.3}], ids=["ground", "base", "slides"])
def test_on_the_width_that_it_needs_it_stays(more):
    scene = shaken(4.5, **more)
    check = check_pedestal(scene)
    assert check.most > 1 and check.width is not None and f"widen it to {check.width:.4g} m" in check.text
    wider = check_pedestal(scene.with_(pedestal={"width": check.width}))
    assert wider.most <= 1 and wider.width == check.width
    assert check_pedestal(scene.with_(pedestal={"width": check.width - 0.02})).most > 1


def test_mirrored_it_is_the_same():
    for more in ({}, ON_BASE, {"friction": 0.3}):
        one, other = (check_pedestal(shaken(sign * 4.5, **more)) for sign in (1, -1))
        assert one.most == pytest.approx(other.most, rel=1e-9)


def test_a_block_that_slides_asks_for_what_friction_passes_on():
    """Level and sliding, by hand: H = -mu N at the block's centre of pressure, under its slip."""
    scene = shaken(5.0, 2.5, friction=0.1, duration=0.3)
    scene = scene.with_(pedestal={"width": 1.0})
    run = simulate(scene)
    ground = 5.0 * np.sin(2.5 * run.history.time)
    across, weight = np.where(run.history.slip < 0, 0.1 * 120 * G, 120 * ground), 120 * G
    place = run.history.slip - BUST.half_height * across / weight
    share = np.abs(place * weight - 1.0 * across - 430 * 0.5 * ground) / (550 * G) / 0.5
    assert run.outcome == "slides" and check_pedestal(scene).share == pytest.approx(share.max(), rel=0.01)


def test_nothing_is_said_without_its_mass_or_where_the_model_has_no_run():
    assert check_pedestal(shaken(3.0).with_(pedestal=Pedestal(width=0.4))) is None
    assert check_pedestal(shaken(3.0).with_(pedestal=None)) is None
    refused = shaken(3.0).with_(friction=0.05, start={"tilt": 0.2})
    assert check_pedestal(refused) is None


def museum(rng, on_base):
    """A statue on a pedestal as in museums, under a sine beyond its uplift."""
    width, height, share, tan = (
        rng.uniform(0.35, 1.1),
        rng.uniform(0.3, 1.2),
        rng.uniform(0.25, 0.8),
        rng.uniform(0.12, 0.4),
    )
    across = width * share
    mass, carried = 2700 * width**2 * height, 1500 * across**3 / tan
    block = Block(mass=carried, radius=0.5 * math.hypot(across, across / tan), slenderness=math.atan(tan))
    motion = PulseMotion(
        "one-sine", rng.uniform(1.1, 5 if on_base else 2) * G * tan, 2 * math.pi * rng.uniform(0.8, 2.5)
    )
    parts = {}
    if on_base:  # the paper's bearings, scaled by the weight
        base = rng.uniform(0.1, 0.5) * (carried + mass)
        scale = 4 * (carried + mass + base) / 3384.05
        parts = {"base": Base(mass=base), "bearings": Bearings(ka=6.22e4 * scale, kb=6.22e3 * scale, alpha=44.69)}
    pedestal = Pedestal(width=width, mass=mass, height=height)
    return Scene(block=block, pedestal=pedestal, motion=motion, duration=motion.end + 4, **parts)


def compared(rng, on_base):
    """(whether it is said to stay, whether it lifts up to a fall, whether the block's fate is another)."""
    scene = museum(rng, on_base)
    model, two = simulate(scene, history=False), simulate_two_bodies(scene, step=1e-4)
    until = math.inf if model.fall_time is None else model.fall_time
    lifts = np.abs(two.lower[two.time <= until]).max() > 1e-6
    return check_pedestal(scene).most <= 1, lifts, (model.outcome == "overturns") != bool(two.fallen)


@pytest.mark.parametrize(
    "on_base, count",
    [(False, 10), (True, 10), *(pytest.param(way, 50, marks=pytest.mark.slow) for way in (False, True))],
)
def test_it_is_never_said_to_stay_where_of_two_blocks_the_lower_one_lifts(on_base, count):
    rng = np.random.default_rng(1 + on_base)
    rows = np.array([compared(rng, on_base) for _ in range(count)])
    stays, lifts, changes = rows.T
    assert stays.sum() >= 0.3 * count and (~stays & lifts).any()
    assert not (stays & lifts).any() and not (stays & changes).any()


@pytest.mark.parametrize("on_base", [False, True])
def test_the_bound_is_just_above_a_finer_run(monkeypatch, on_base):
    rng = np.random.default_rng(5 + on_base)
    for _ in range(6):
        scene = museum(rng, on_base)
        monkeypatch.setattr(pedestal, "POINTS", 1000)
        share = check_pedestal(scene).share
        monkeypatch.setattr(pedestal, "POINTS", 7000)
        finer = check_pedestal(scene).share
        assert finer * (1 - 1e-4) < share < 1.01 * finer
