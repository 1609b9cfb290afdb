"""What the blocks of every engine and each of its variants do: symmetry, rest, impacts, bearings, exact solutions.

The table of tolerances holds their main variants to the model's restitution, times and peaks. Measured bounds stand by
engine and variant in tables here; one that is not in a table is held to the table's default.
"""

import math
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from bearing_laws import bearings_of
from engine_cases import ACCURATE, PULSE, accurate_variant, every_variant, scene, shaking, simulate
from record_files import RECORDS, needs_records

from analytic import Base, PulseMotion, SampledMotion, Start, load_scene
from analytic import simulate as exact
from analytic.bearing import BearingLaw
from analytic.caryatid import BEARINGS
from analytic.decision import RIGID_BEARINGS
from analytic.records import read_record
from analytic.response import Failure
from analytic.rocking import restitution
from comparisons.measuring.errors import impact_errors
from engines import get_engine
from engines.checks import energy_balance, pivoting_centre
from engines.comparison import RESTITUTION, compare
from engines.events import contact_measures
from engines.simulating import Simulator
from engines.swings import Trace


def ratios(response):
    return [impact.rate_after / impact.rate_before for impact in response.impacts]


# [rad] and [m]. Adaptive steps follow round-off: a hundred times their local tolerance.
# Ten iterations from left to right are not those from right to left: measured 4.7e-3.
MIRROR, MIRROR_DEFAULT = {("exudyn", "compliant-corners"): 1e-5, ("pymunk", "first-script"): 9e-3}, 1e-6


@every_variant
def test_mirrored_start_gives_the_mirrored_response(engine, variant):
    starts = (Start(tilt=side * 0.12) for side in (1, -1))
    left, right = (simulate(engine, variant, scene(0.2, 212.0, 1.3, start=start)) for start in starts)
    bound = MIRROR.get((engine, variant), MIRROR_DEFAULT)
    assert left.outcome == right.outcome
    assert np.abs(left.history.tilt + right.history.tilt).max() < bound
    assert np.abs(left.history.base_displacement + right.history.base_displacement).max() < bound


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
    motion = shaking(0.5 if base else 0.9 * 9.81 * math.tan(0.2), 3.0)
    given = scene(0.2, base, 3.0, bearings=BEARINGS if base else None, motion=motion)
    response, trace = get_engine(engine).traced(given, variant=variant)
    bound = LIFT.get((engine, variant), LIFT_DEFAULT)
    assert response.outcome == "stands", response.failure
    assert response.peak_tilt * 1.0884 < bound
    if (engine, variant) in ACCURATE.items():
        assert response.impacts == response.uplifts == response.rests == ()
    if trace.centre is not None:  # a first script need not look where its block is
        assert np.abs(trace.centre - pivoting_centre(given, trace))[:, :2].max() < bound
    np.testing.assert_allclose(response.history.time, 0.01 * np.arange(301), rtol=0, atol=1e-11)  # the motion's own


@every_variant
@pytest.mark.parametrize(
    "shape, peak, frequency, gravity, late",
    [("one-sine", 2.812, 3.194, 3.7, 2e-3), ("half-sine", 9.6, 3.0, 9.81, 0.17)],
)
def test_overturning_stops_cleanly(engine, variant, shape, peak, frequency, gravity, late):
    """By the second it is thrown off its corner, which the model does not allow: engines fall up to 0.09 s later."""
    given = scene(0.2, motion=PulseMotion(shape, peak, frequency), duration=8.0, gravity=gravity)
    response, reference = simulate(engine, variant, given), exact(given)
    assert response.outcome == reference.outcome == "overturns"
    assert response.end.time == response.history.time[-1] == pytest.approx(response.overturning_time)
    assert abs(response.end.tilt) == response.peak_tilt == pytest.approx(math.pi / 2)
    assert response.unstable_time == response.fall_time < response.overturning_time < 8.0
    if ACCURATE.get(engine) == variant:
        assert response.fall_time == pytest.approx(reference.fall_time, abs=2e-3)
        assert response.overturning_time == pytest.approx(reference.overturning_time, abs=late)


@accurate_variant
@pytest.mark.filterwarnings("ignore:(overflow|invalid value):RuntimeWarning")
def test_a_shock_beyond_the_engines_numbers_is_not_survived_in_silence(engine, variant):
    given = load_scene("caryatid-isolated").with_(motion=PulseMotion("half-sine", 1e30, 3.0), duration=3.0)
    response = simulate(engine, variant, given, history=False)
    assert response.outcome in ("overturns", "failed")
    assert response.failure is None or (response.failure.message and math.isfinite(response.failure.last_state.tilt))


@every_variant
@pytest.mark.parametrize("law, damping", [("algebraic", 0.0), ("bilinear", 0.0), ("bouc-wen", 500.0)])
def test_bearing_force_is_the_law_on_the_engines_own_path(engine, variant, law, damping):
    bearings, start = bearings_of(law, count=4, damping=damping), Start(base_displacement=0.02, base_velocity=-0.1)
    given = scene(0.15, 212.0, 2.0, bearings=bearings, motion=PULSE, start=start)
    _, trace = get_engine(engine).traced(given, variant=variant)
    rule = BearingLaw.of(given.bearings)
    z, x, worst = rule.start(0.02), 0.02, 0.0
    for moved, speed, force in zip(trace.base_displacement, trace.base_velocity, trace.bearing_force, strict=True):
        z, x = rule.hysteretic(z, moved - x), moved
        worst = max(worst, abs(rule.force(x, z, speed) - force))
    assert worst < 1e-9 * BearingLaw.of(BEARINGS).f0
    assert np.ptp(trace.bearing_force) > 1e3  # N: it was used


@accurate_variant
@pytest.mark.parametrize("law, damping", [("linear", 0.0), ("bilinear", 500.0), ("bouc-wen", 0.0)])
def test_isolated_block_moves_as_the_exact_solution(engine, variant, law, damping):
    bearings, start = bearings_of(law, count=4, damping=damping), Start(base_displacement=0.02, base_velocity=-0.1)
    given = scene(0.5, 212.0, 4.0, bearings=bearings, motion=PulseMotion("one-sine", 2.0, 5.0), start=start)
    response, reference = simulate(engine, variant, given), exact(given)
    assert response.outcome == reference.outcome == "stands"
    assert response.peak_base_displacement == pytest.approx(reference.peak_base_displacement, rel=1e-4)


# Error of restitution at starts of .01 slendernesses: slow impacts err as the inverse square of their speed.
SMALL = {("pymunk", "impact-aware"): 2e-3}  # measured 1.8e-3


@accurate_variant
@pytest.mark.parametrize(
    "slenderness, inertia, tilt, radius, gravity",
    [
        (0.1, 2.0, 0.6, 0.1, 9.81),
        (0.5, 1.2, 0.6, 10.0, 9.81),
        (0.5, 4 / 3, 0.01, 1.0, 9.81),
        (0.2, 4 / 3, 0.6, 1.0, 1.6),
    ],
)
def test_impacts_at_the_ends_of_the_range_and_under_another_gravity(
    engine, variant, slenderness, inertia, tilt, radius, gravity
):
    block = {"radius": radius, "corner_inertia": inertia * 3172.05 * radius**2}
    given = scene(slenderness, duration=90.0, start=Start(tilt=tilt * slenderness), gravity=gravity).with_(block=block)
    first, second, third, *_ = exact(given, history=False).impacts
    response = simulate(engine, variant, given.with_(duration=0.5 * (second.time + third.time)), history=False)
    bound = 1e-4 if tilt > 0.1 else SMALL.get((engine, variant), 1e-3)
    assert ratios(response) == pytest.approx([restitution(given)] * 2, abs=bound)
    assert response.impacts[0].time == pytest.approx(first.time, rel=1e-3)


@accurate_variant
@pytest.mark.parametrize("mass, slenderness", [(0.05 * 3172.05, 0.5), (31720.0, 0.1)])
def test_base_masses_and_slenderness_at_the_ends_of_the_range(engine, variant, mass, slenderness):
    given = scene(slenderness, mass, 2.0, start=Start(tilt=0.6 * slenderness))
    response, reference = simulate(engine, variant, given), exact(given)
    assert response.outcome == reference.outcome == "rocks"
    assert response.impacts[0].time == pytest.approx(reference.impacts[0].time, abs=5e-4)
    assert response.peak_base_displacement == pytest.approx(reference.peak_base_displacement, rel=1e-3)


# Error of the peak base displacement, relative; exudyn's is 1e-5 m.
PEAK, PEAK_DEFAULT = ({("exudyn", "compliant-corners"): 1e-5 / 0.212190, ("mujoco", "impact-aware"): 1e-5}, 1e-4)


@needs_records
@accurate_variant
def test_isolated_caryatid_under_a_recorded_motion(engine, variant):
    given = load_scene("caryatid-isolated").with_(duration=12.0)
    given = given.with_(motion=read_record(RECORDS / "RSN1605_DUZCE_DZC270.AT2"))
    response = simulate(engine, variant, given, history=False)
    assert response.outcome == "stands"
    bound = PEAK.get((engine, variant), PEAK_DEFAULT)
    assert response.peak_base_displacement == pytest.approx(0.212190, rel=bound)


# Vertical motion, within the rows of the tolerance table.

TIMES = np.arange(0, 4.001, 0.005)
HEAVING = SampledMotion(0.005, 0 * TIMES, vertical=SampledMotion(0.005, 2.0 * np.sin(9.0 * TIMES)))
HEAVED = scene(0.2, None, 2.5, start=Start(tilt=0.1), motion=HEAVING)
UPWARD = PulseMotion("one-sine", 3.0, 8.0, vertical=PulseMotion("one-sine", -1.0, 8.0))
DRIVEN = scene(0.15, 212.0, 3.0, bearings=BEARINGS, motion=UPWARD)
# Twice what is measured where the vertical motion adds to it. MuJoCo's errors without it are no scale: half of the
# tilt's, 3.6e-5 for 7.3e-5, and by chance next to nothing of the displacement's, 2.4e-8 for 3.2e-6.
OWN = {("mujoco", "peak tilt"): 1.4e-4, ("mujoco", "peak displacement"): 6.4e-6}


def bound(engine, quantity, scenes):
    """Of the engine's main variant; its own of this file, where it has one."""
    rows = get_engine(engine).tolerance_rows()[ACCURATE[engine]]
    (row,) = (row for row in rows if (row.quantity, row.scenes) == (quantity, scenes))
    return OWN.get((engine, quantity), row.bound)


def without(given):
    return given.with_(motion=replace(given.motion, vertical=None))


def first_impacts(response):
    return np.array([impact.time for impact in response.impacts[:3]])


@accurate_variant
@pytest.mark.parametrize("scenes, base", [("rigid ground", None), ("sliding base", Base(mass=212.0))])
def test_impact_times_of_a_released_block_under_vertical_motion(engine, variant, scenes, base):
    given, limit = HEAVED.with_(base=base), bound(engine, "impact times", scenes)
    wanted, found = first_impacts(exact(given)), simulate(engine, variant, given, history=False)
    assert found.outcome == "rocks" and found.failure is None
    np.testing.assert_allclose(first_impacts(found), wanted, rtol=0, atol=limit)
    assert abs(first_impacts(exact(without(given)))[1] - wanted[1]) > 50 * limit


@accurate_variant
def test_rocking_on_bearings_under_vertical_motion(engine, variant):
    reference, level = exact(DRIVEN), exact(without(DRIVEN))
    found = simulate(engine, variant, DRIVEN, history=False)
    tilt, shift = (bound(engine, f"peak {one}", "rocking on bearings, one-sine") for one in ("tilt", "displacement"))
    assert found.peak_tilt_ratio == pytest.approx(reference.peak_tilt_ratio, abs=tilt)
    assert abs(level.peak_tilt_ratio - reference.peak_tilt_ratio) > 50 * tilt
    assert found.peak_base_displacement == pytest.approx(reference.peak_base_displacement, rel=shift)
    assert found.min_normal_ratio == pytest.approx(reference.min_normal_ratio, abs=2e-3)
    assert len(found.impacts) == len(reference.impacts) > 5
    assert found.uplifts[0] == pytest.approx(reference.uplifts[0], abs=1e-5)
    assert RIGID_BEARINGS in map(str, found.warnings)


@every_variant
def test_every_variant_feels_vertical_motion_and_says_where_a_block_would_jump(engine, variant):
    run = partial(simulate, engine, variant, history=False)
    heaving, level = (one.with_(duration=0.6) for one in (HEAVED, without(HEAVED)))
    wanted, felt = (first_impacts(solve(heaving))[0] - first_impacts(solve(level))[0] for solve in (exact, run))
    assert felt == pytest.approx(wanted, rel=0.15)
    up = SampledMotion(0.005, 12.0 * np.sin(9.0 * TIMES))
    found = run(HEAVED.with_(motion=replace(HEAVING, vertical=up), start=Start(tilt=0.05), duration=1.0))
    assert found.failure is not None or any("the block would jump" in warning.text for warning in found.warnings)


@pytest.mark.parametrize("given", [HEAVED.with_(duration=0.4), DRIVEN.with_(duration=0.7)], ids=["heaved", "driven"])
def test_measures_on_exact_states(given):
    reference = exact(given, output_step=1e-3)
    trace = Trace(*(getattr(reference.history, column) for column in Trace.COLUMNS), contact_tilt=1e-6)
    demand, normal, _ = contact_measures(given, trace)
    assert (demand, normal) == pytest.approx((reference.friction_demand, reference.min_normal_ratio), rel=1e-3)
    balance, kinetic = energy_balance(given, trace)
    assert np.abs(balance).max() < 1e-4 * kinetic.max()
    assert np.abs(energy_balance(without(given), trace)[0]).max() > 5e-3 * kinetic.max()


# A run that ends during an impact: the impact is read from a longer run.


def cut(base, after):
    """A scene that ends so long after the second impact of the analytic model, and that impact's time [s]."""
    given = scene(0.15, base, 3.0, start=Start(tilt=0.07))
    impact = exact(given, history=False).impacts[1]
    return given.with_(duration=impact.time + after), impact.time


@pytest.mark.parametrize("base, after", [(3172.05, 1e-9), (3172.05, 1e-4), (None, 3e-4), (None, 5e-3)])
@pytest.mark.parametrize("engine", ["exudyn", "pybullet", "mujoco", "pymunk"])
def test_a_run_that_ends_in_an_impact_reads_it_as_one_that_goes_on(engine, base, after):
    """e was off by .028 (exudyn, with a warning), .017 (PyBullet) and .97 (MuJoCo), in silence."""
    given, _ = cut(base, after)
    response = get_engine(engine).simulate(given, history=False)
    assert response.outcome == "rocks" and not [each for each in response.warnings if "impact" in each.text]
    assert all(impact.time <= given.duration for impact in response.impacts)
    assert len(response.impacts) == 2 or after < 1e-4  # before the engine's own impact
    assert ratios(response) == pytest.approx([restitution(given)] * len(response.impacts), abs=2e-3)


@every_variant
def test_only_events_are_read_beyond_the_end(engine, variant):
    given, _ = cut(3172.05, 1e-4)
    response, trace = get_engine(engine).traced(given, variant=variant)
    assert abs(trace.time[-1] - given.duration) <= np.diff(trace.time).max()  # equal steps end at the nearest one
    assert response.end.time == response.history.time[-1] == trace.time[-1]
    reached = abs(response.history.base_displacement).max()
    assert response.peak_base_displacement == pytest.approx(reached, rel=1e-3)
    events = (*response.uplifts, *response.rests, *(impact.time for impact in response.impacts))
    assert all(time <= response.end.time for time in events)


class Counted(Simulator):
    """An engine that counts its runs; those longer than a scene's end fail where `sound` is False."""

    sound, durations = True, ()

    def run(self, given, variant, settings):
        object.__setattr__(self, "durations", (*self.durations, given.duration))
        ran = super().run(given, variant, settings)
        late = not self.sound and given.duration > self.durations[0]
        return replace(ran, failure=Failure("the solver gave up", "it is a fake")) if late else ran


class Unsound(Counted):
    sound = False


@pytest.mark.parametrize("engine", ["exudyn", "mujoco"])
def test_a_run_goes_on_only_where_it_ends_in_an_impact_and_costs_both(engine):
    given, at = cut(None, 1e-4)
    once, twice, unsound = (kind.of(get_engine(engine)) for kind in (Counted, Counted, Unsound))
    plain, _ = once.traced(given.with_(duration=at - 0.1), history=False)
    response, _ = twice.traced(given, history=False)
    assert len(once.durations) == 1 and len(twice.durations) == 2
    assert twice.durations[0] == given.duration < twice.durations[1] < given.duration + 0.1
    assert response.steps > 1.8 * plain.steps
    # one that cannot go on says that its last impact is not to be trusted
    (warning,) = unsound.traced(given, history=False)[0].warnings
    assert "during an impact, and fails if it goes on" in warning.text


def worst(given, response):
    """Largest error of the restitution of two impacts, by the energies of swings; inf where one is lost."""
    errors = impact_errors(given, response, 2)["swing"]
    return np.abs(errors).max() if len(errors) == 2 else np.inf


@pytest.mark.slow
@every_variant
@pytest.mark.parametrize("slenderness, base", [(0.2, None), (0.3, 400.0)])
def test_a_level_is_right_or_told(engine, variant, slenderness, base):
    """Of a block released, up to the third peak of its tilt."""
    given = scene(slenderness, base, 10.0, start=Start(tilt=0.6 * slenderness))
    second, third = first_impacts(exact(given, history=False))[1:]
    record, given = get_engine(engine), given.with_(duration=0.3 * second + 0.7 * third)
    kind = record.variants[variant]
    # what flight takes between two impacts is no part of their restitution: first scripts' damping
    limit = RESTITUTION if kind.flight_damping is None else 0.02
    for value in kind.levels:
        response, _ = record.traced(given, variant=variant, **{kind.accuracy_parameter: value})
        told = response.failure or compare(given, response).differences
        assert told or worst(given, response) < limit, value
