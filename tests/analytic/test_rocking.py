import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from analytic import load_scene, simulate
from analytic.rocking import (
    RockingModel,
    base_jump_length,
    base_jump_length_as_printed,
    momentum_restitution,
    restitution,
)
from analytic.scene import Base, Block, Scene

RADIUS, MASS, BASE = 1.088388, 3172.05, 212.0
# slenderness: e on rigid ground, e_phi and e_x [m] with the base of 212 kg, e_x as printed
TABLE = {
    0.20: (0.940796, 0.817683, -0.182293, -0.194450),
    0.25: (0.908187, 0.729974, -0.266917, -0.281478),
    0.28: (0.885441, 0.673321, -0.320300, -0.335034),
    0.35: (0.823632, 0.535439, -0.445213, -0.455187),
}


def scene(slenderness, base=BASE, **block):
    return Scene(
        block=Block(mass=MASS, radius=RADIUS, slenderness=slenderness, **block),
        duration=1.0,
        base=Base(mass=base) if base else None,
    )


@pytest.mark.parametrize("slenderness", TABLE)
def test_impact_table(slenderness):
    rigid, isolated, jump, printed = TABLE[slenderness]
    assert restitution(scene(slenderness, base=None)) == pytest.approx(rigid, abs=5e-7)
    assert RockingModel.of(scene(slenderness, base=None)).impact(-1.0) == (pytest.approx(-rigid, abs=5e-7), 0.0)
    assert restitution(scene(slenderness)) == pytest.approx(isolated, abs=5e-7)
    # half the last digit of the table, and of the radius it was made with (lengths go with R or R^2)
    digits = 5e-7 + 2 * 5e-7 / RADIUS * abs(printed)
    assert base_jump_length(scene(slenderness)) == pytest.approx(jump, abs=digits)
    assert base_jump_length_as_printed(scene(slenderness)) == pytest.approx(printed, abs=digits)


@pytest.mark.parametrize("base, by_momentum", [(None, TABLE[0.28][0]), (BASE, TABLE[0.28][1])])
@pytest.mark.parametrize("given", [0.0, 0.9, 1.0, None])
def test_a_restitution_that_is_given_is_the_scenes_and_changes_no_formula(base, by_momentum, given):
    case = scene(0.28, base, restitution=given)
    assert momentum_restitution(case) == pytest.approx(by_momentum, abs=5e-7)
    expected = momentum_restitution(case) if given is None else given
    assert restitution(case) == RockingModel.of(case).restitution == expected


def impact_by_momentum(case, rate):
    """Return (phi'+, jump of x') from two balances alone: linear momentum, and the block's about its new corner.

    The block returns from phi > 0, so it turns from its right corner to its left one; clockwise is positive.
    """
    m, base, b, h = case.block.mass, case.base.mass, case.block.half_width, case.block.half_height
    inertia = case.block.centre_inertia
    # centre of mass before: velocity (v + h w, b w), after: (v' + h w', -b w'); new corner at (-b, -h) from it
    balances = np.array([[m * h, m + base], [inertia + m * (h * h + b * b), m * h]])
    before = np.array([m * h * rate, (inertia + m * (h * h - b * b)) * rate])  # v = 0
    return np.linalg.solve(balances, before)


@pytest.mark.parametrize("slenderness", TABLE)
@pytest.mark.parametrize("base", [50.0, 212.0, 1e5])
def test_impact_follows_from_momentum(slenderness, base):
    case = scene(slenderness, base)
    expected = pytest.approx(impact_by_momentum(case, -0.7), rel=1e-12)
    assert np.array(RockingModel.of(case).impact(-0.7)) == expected
    assert np.array([restitution(case), -base_jump_length(case)]) * -0.7 == expected


@given(st.floats(0.02, 1.5), st.floats(1e-3, 1e6), st.floats(0.0, 1.0) | st.none())
def test_impact_never_adds_energy(slenderness, base, restitution):
    case = scene(slenderness, base, restitution=restitution)
    model, w = RockingModel.of(case), -0.8
    after, jump = model.impact(w)
    h = case.block.half_height
    assert model.kinetic_energy(1, 0.0, after, jump) <= model.kinetic_energy(1, 0.0, w, 0.0) * (1 + 1e-12)
    # momentum holds for any restitution, the scene's own and a clipped one included
    assert model.m * h * after + model.M * jump == pytest.approx(model.m * h * w, rel=1e-12)


SIDES = st.sampled_from([-1.0, 1.0])


@given(SIDES, st.floats(0.0, 1.5), st.floats(-3, 3), st.floats(-5, 5), st.floats(-1e4, 1e4))
def test_accelerations_solve_equations_3_and_4(side, size, rate, ground, force):
    case = scene(0.28)
    model, tilt = RockingModel.of(case), side * size
    spin, push = model.accelerations(side, tilt, rate, ground, force)
    c = RADIUS * math.cos(side * 0.28 - tilt)
    n = RADIUS * math.sin(side * 0.28 - tilt)
    horizontal = model.M * (ground + push) + MASS * (c * spin + n * rate**2) + force
    moment = model.J * spin + MASS * c * (ground + push) + MASS * 9.81 * n
    assert abs(horizontal) < 1e-9 * model.M * 9.81 and abs(moment) < 1e-9 * MASS * 9.81 * RADIUS


@given(SIDES, st.floats(0.0, 1.5), st.floats(-3, 3), st.floats(-5, 5), st.floats(-1e4, 1e4))
def test_contact_force_drives_the_base(side, size, rate, ground, force):
    # the block's horizontal force and the bearings' accelerate the base alone
    model, tilt = RockingModel.of(scene(0.28)), side * size
    spin, push = model.accelerations(side, tilt, rate, ground, force)
    horizontal, normal = model.contact_forces(side, tilt, rate, spin, push + ground)
    assert BASE * (push + ground) == pytest.approx(-horizontal - force, rel=1e-9, abs=1e-6)
    # rotation about the centre of mass: J_c phi'' = -(H c + N n)
    c, n = model.lever(side, tilt)
    assert (model.J - MASS * RADIUS**2) * spin == pytest.approx(-horizontal * c - normal * n, rel=1e-9, abs=1e-5)


def test_uplift_threshold_is_where_the_block_starts_to_turn():
    # in full contact at |a_abs| = g tan(gamma) the tilt acceleration about the corner is zero, on any foundation
    for case in (scene(0.28), scene(0.28, base=None)):
        model = RockingModel.of(case)
        a = model.uplift_acceleration
        assert abs(model.accelerations(-1.0, 0.0, 0.0, a, -model.M * a)[0]) < 1e-12
        assert model.accelerations(-1.0, 0.0, 0.0, 1.01 * a, -1.01 * model.M * a)[0] < 0


# The paper's misprints: what the corrected equations pass, the printed ones must fail.
ISOLATED = load_scene("caryatid-isolated")


def agrees_with_the_simulation(jump_length):
    """Check eq. (8) against every impact of a rocking run: x'+ - x'- = -e_x phi'-."""
    scene = ISOLATED.with_(block={"slenderness": 0.15})
    run = simulate(scene, history=False)
    assert run.impact_count > 20
    for impact in run.impacts:
        assert impact.base_velocity_jump == pytest.approx(-jump_length(scene) * impact.rate_before, rel=1e-9)


def test_equation_8():
    agrees_with_the_simulation(base_jump_length)
    with pytest.raises(AssertionError):
        agrees_with_the_simulation(base_jump_length_as_printed)
