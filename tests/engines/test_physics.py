"""What the blocks of every engine and each of its variants do: symmetry, rest, impacts, bearings, exact solutions.

Measured bounds stand by engine and variant in tables here; one that is not in a table is held to the table's default.
"""

import functools
import math

import numpy as np
import pytest
from bearing_laws import NAMES, bearings_of
from engine_cases import ACCURATE, PULSE, accurate_variant, every_variant, impact_errors, scene, shaking, simulate
from record_files import RECORDS, needs_records

from analytic import PulseMotion, Start, load_scene
from analytic import simulate as exact
from analytic.bearing import BearingLaw
from analytic.caryatid import BEARINGS
from analytic.records import read_record
from analytic.rocking import restitution
from engines import get_engine
from engines.checks import pivoting_centre

# [rad] and [m]. Adaptive steps follow round-off: a hundred times their local tolerance.
# Ten iterations from left to right are not those from right to left: measured 4.7e-3.
MIRROR, MIRROR_DEFAULT = {("exudyn", "compliant-corners"): 1e-5, ("pymunk", "first-script"): 9e-3}, 1e-6


@every_variant
@pytest.mark.parametrize("slenderness, tilt, duration", [(0.3, 0.15, 1.5), (0.2, 0.12, 1.3)])
def test_mirrored_start_gives_the_mirrored_response(engine, variant, slenderness, tilt, duration):
    left, right = (
        simulate(engine, variant, scene(slenderness, 212.0, duration, start=Start(tilt=side * tilt)))
        for side in (1, -1)
    )
    bound = MIRROR.get((engine, variant), MIRROR_DEFAULT)
    assert left.outcome == right.outcome
    assert np.abs(left.history.tilt + right.history.tilt).max() < bound
    assert np.abs(left.history.base_displacement + right.history.base_displacement).max() < bound
    assert left.end.tilt == pytest.approx(-right.end.tilt, abs=bound)
    assert left.end.base_displacement == pytest.approx(-right.end.base_displacement, abs=bound)


# A block that stands; overturning.


# Left alone: peak tilt times R [m]. Of a contact with slop measured 5.9e-4.
ALONE, ALONE_DEFAULT = {("pymunk", "first-script"): 1.2e-3}, 1e-5


@every_variant
@pytest.mark.parametrize("base", [None, 212.0])
def test_block_left_alone_stands(engine, variant, base):
    response = simulate(engine, variant, scene(0.2, base, 1.0, bearings=BEARINGS if base else None))
    if (engine, variant, base) == ("exudyn", "native-contact", None) and response.outcome == "failed":
        assert "solver gave up" in response.failure.reason  # Newton's method, at 0.98 s: exudyn 1.13
        return
    assert response.outcome == "stands", response.failure
    assert response.impacts == response.uplifts == response.rests == ()
    assert response.peak_tilt * 1.0884 < ALONE.get((engine, variant), ALONE_DEFAULT)


# Under shaking below uplift: peak tilt times R, and drift of the lower corner [m]. Contacts that sink: measured 8.7e-4,
# 7.9e-4, 6e-4 and 1.3e-4.
LIFT, LIFT_DEFAULT = (
    {
        ("exudyn", "native-contact"): 1.7e-3,
        ("mujoco", "first-script"): 1.5e-3,
        ("pymunk", "first-script"): 1.2e-3,
        ("drake", "first-script"): 2.5e-4,
    },
    1e-5,
)


@every_variant
@pytest.mark.parametrize("base", [None, 212.0])
def test_block_rests_under_shaking_below_uplift(engine, variant, base):
    motion = shaking(0.5 if base else 0.9 * 9.81 * math.tan(0.2))
    given = scene(0.2, base, 6.0, bearings=BEARINGS if base else None, motion=motion)
    response, trace = get_engine(engine).traced(given, variant=variant)
    bound = LIFT.get((engine, variant), LIFT_DEFAULT)
    assert response.outcome == "stands", response.failure
    assert response.peak_tilt * 1.0884 < bound
    if trace.centre is not None:  # a first script need not look where its block is
        assert np.abs(trace.centre - pivoting_centre(given, trace))[:, :2].max() < bound
    np.testing.assert_allclose(response.history.time, 0.01 * np.arange(601), rtol=0, atol=1e-11)  # the motion's own


@every_variant
@pytest.mark.parametrize(
    "shape, peak, frequency, late", [("one-sine", 7.4556, 5.2, 2e-3), ("half-sine", 9.6, 3.0, 0.17)]
)
def test_overturning_stops_cleanly(engine, variant, shape, peak, frequency, late):
    """By the second it is thrown off its corner, which the model does not allow: engines fall up to 0.09 s later."""
    given = scene(0.2, motion=PulseMotion(shape, peak, frequency), duration=8.0)
    response, reference = simulate(engine, variant, given), exact(given)
    assert response.outcome == reference.outcome == "overturns"
    assert response.end.time == response.history.time[-1] == pytest.approx(response.overturning_time)
    assert abs(response.end.tilt) == response.peak_tilt == pytest.approx(math.pi / 2)
    assert response.unstable_time == response.fall_time < response.overturning_time < 8.0
    if ACCURATE.get(engine) == variant:
        assert response.fall_time == pytest.approx(reference.fall_time, abs=2e-3)
        assert response.overturning_time == pytest.approx(reference.overturning_time, abs=late)


@accurate_variant
@pytest.mark.parametrize("ground", ["caryatid-rigid", "caryatid-isolated"])
@pytest.mark.filterwarnings("ignore:(overflow|invalid value):RuntimeWarning")
def test_a_shock_beyond_the_engines_numbers_is_not_survived_in_silence(engine, variant, ground):
    given = load_scene(ground).with_(motion=PulseMotion("half-sine", 1e30, 3.0), duration=3.0)
    response = simulate(engine, variant, given, history=False)
    assert response.outcome in ("overturns", "failed")
    assert response.failure is None or (response.failure.message and math.isfinite(response.failure.last_state.tilt))


# The bearings' law, and agreement with the analytic model.


@every_variant
@pytest.mark.parametrize(
    "law, damping", [("algebraic", 0.0), ("bouc-wen", 0.0), ("bilinear", 0.0), *((law, 500.0) for law in NAMES)]
)
def test_bearing_force_is_the_law_on_the_engines_own_path(engine, variant, law, damping):
    given = scene(0.15, 212.0, 2.0, bearings=bearings_of(law, count=4, damping=damping), motion=PULSE)
    _, trace = get_engine(engine).traced(given, variant=variant)
    rule = BearingLaw.of(given.bearings)
    z, x, worst = rule.start(trace.base_displacement[0]), trace.base_displacement[0], 0.0
    for moved, speed, force in zip(trace.base_displacement, trace.base_velocity, trace.bearing_force, strict=True):
        z, x = rule.hysteretic(z, moved - x), moved
        worst = max(worst, abs(rule.force(x, z, speed) - force))
    assert worst < 1e-9 * BearingLaw.of(BEARINGS).f0
    assert np.ptp(trace.bearing_force) > 1e3  # N: it was used


# Error of restitution, rms: on a light base a corner of DART lands as far off as it moves in a step.
IMPACTS = {("dart", "impact-aware"): 2e-4}


# Between the ends by default only in the table of tolerances, which runs the same scenes.
@accurate_variant
@pytest.mark.parametrize("base", [None, 212.0])
@pytest.mark.parametrize(
    "slenderness", [0.1, pytest.param(0.2, marks=pytest.mark.long), pytest.param(0.3, marks=pytest.mark.long), 0.45]
)
def test_impacts_are_as_momentum_asks(engine, variant, slenderness, base):
    """Of 8 starts, the first 3 impacts each."""
    run = functools.partial(get_engine(engine).simulate, variant=variant)
    error, jump, largest_jump, _ = impact_errors(run, slenderness, base)
    assert error < IMPACTS.get((engine, variant), 1e-4)
    assert jump < 1e-3 and largest_jump < 1e-3  # relative; m/s


# Error of restitution at starts of .01 slendernesses: slow impacts err as the inverse square of their speed.
SMALL = {("pymunk", "impact-aware"): 2e-3}  # measured 1.8e-3


@accurate_variant
@pytest.mark.parametrize(
    "slenderness, inertia, tilt, radius",
    [(0.1, 1.2, 0.6, 1.0), (0.1, 2.0, 0.6, 1.0), (0.5, 1.2, 0.6, 1.0), (0.5, 2.0, 0.6, 1.0)]
    + [(0.1, 4 / 3, 0.01, 1.0), (0.5, 4 / 3, 0.01, 1.0), (0.2, 4 / 3, 0.6, 0.1), (0.2, 4 / 3, 0.6, 10.0)],
)
def test_restitution_at_the_ends_of_the_range(engine, variant, slenderness, inertia, tilt, radius):
    block = {"radius": radius, "corner_inertia": inertia * 3172.05 * radius**2}
    given = scene(slenderness, duration=60.0, start=Start(tilt=tilt * slenderness)).with_(block=block)
    _, second, third, *_ = exact(given, history=False).impacts
    response = simulate(engine, variant, given.with_(duration=0.5 * (second.time + third.time)), history=False)
    found = [impact.rate_after / impact.rate_before for impact in response.impacts]
    bound = 1e-4 if tilt > 0.1 else SMALL.get((engine, variant), 1e-3)
    assert found == pytest.approx([restitution(given)] * 2, abs=bound)


# Largest error of the tilt [rad].
TILT, TILT_DEFAULT = {("exudyn", "compliant-corners"): 8e-4, ("dart", "impact-aware"): 6.5e-4}, 3e-4


@accurate_variant
def test_rocking_on_bearings_follows_the_exact_solution(engine, variant):
    given = scene(0.15, 212.0, 3.0, bearings=BEARINGS, motion=PulseMotion("one-sine", 3.0, 8.0))
    response, reference = simulate(engine, variant, given), exact(given)
    assert response.outcome == reference.outcome == "rocks"
    assert len(response.impacts) == len(reference.impacts) > 5
    assert response.peak_tilt == pytest.approx(reference.peak_tilt, rel=1e-3)
    error = np.interp(response.history.time, reference.history.time, reference.history.tilt) - response.history.tilt
    assert np.abs(error).max() < TILT.get((engine, variant), TILT_DEFAULT)
    assert response.uplifts[0] == pytest.approx(reference.uplifts[0], abs=1e-5)


@accurate_variant
@pytest.mark.parametrize("law", NAMES)
@pytest.mark.parametrize("damping", [0.0, 500.0])
def test_isolated_block_moves_as_the_exact_solution(engine, variant, law, damping):
    given = scene(
        0.5,
        212.0,
        4.0,
        bearings=bearings_of(law, count=4, damping=damping),
        motion=PulseMotion("one-sine", 2.0, 5.0),
        start=Start(base_displacement=0.02, base_velocity=-0.1),
    )
    response, reference = simulate(engine, variant, given), exact(given)
    assert response.outcome == reference.outcome == "stands"
    assert response.peak_base_displacement == pytest.approx(reference.peak_base_displacement, rel=1e-4)


# Error of the peak base displacement, relative; exudyn's is 1e-5 m.
PEAK, PEAK_DEFAULT = ({("exudyn", "compliant-corners"): 1e-5 / 0.212190, ("mujoco", "impact-aware"): 1e-5}, 1e-4)


@accurate_variant
@pytest.mark.parametrize("motion", ["synthetic", pytest.param("Duzce", marks=needs_records)])
def test_isolated_caryatid(engine, variant, motion):
    given = load_scene("caryatid-isolated").with_(duration=12.0)
    bound = PEAK.get((engine, variant), PEAK_DEFAULT)
    if motion == "Duzce":
        given = given.with_(motion=read_record(RECORDS / "RSN1605_DUZCE_DZC270.AT2"))
    response, reference = simulate(engine, variant, given, history=False), exact(given, history=False)
    assert response.outcome == reference.outcome == "stands"
    assert response.peak_base_displacement == pytest.approx(reference.peak_base_displacement, rel=bound)
    if motion == "Duzce":
        assert response.peak_base_displacement == pytest.approx(0.212190, rel=bound)


@accurate_variant
@pytest.mark.parametrize("mass", [0.05 * 3172.05, 31720.0])
@pytest.mark.parametrize("slenderness", [0.1, 0.5])
def test_base_masses_and_slenderness_at_the_ends_of_the_range(engine, variant, mass, slenderness):
    given = scene(slenderness, mass, 2.0, start=Start(tilt=0.6 * slenderness))
    response, reference = simulate(engine, variant, given), exact(given)
    assert response.outcome == reference.outcome == "rocks"
    assert response.impacts[0].time == pytest.approx(reference.impacts[0].time, abs=5e-4)
    assert response.peak_base_displacement == pytest.approx(reference.peak_base_displacement, rel=1e-3)
