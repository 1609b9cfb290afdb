"""What the blocks of every engine and each of its variants do: symmetry, rest, impacts, bearings, exact solutions; with
the friction that a scene gives, and with a restitution that it gives.

The table of tolerances holds their main variants to the model's restitution, times and peaks. Measured bounds stand by
engine and variant in tables here; one that is not in a table is held to the table's default.
"""

import math
from dataclasses import replace
from functools import partial
from itertools import pairwise

import numpy as np
import pytest
from bearing_laws import bearings_of
from engine_cases import ACCURATE, CASES, PULSE, accurate_variant, every_variant, scene, shaking, simulate
from sliding_scenes import LANDS, LOST, PASSES, SAVED, SLIDES, scene_of

from analytic import Base, Bearings, Block, PulseMotion, SampledMotion, Scene, Start, load_scene
from analytic import simulate as exact
from analytic.advice.bearing_sizes import pendulum_bearings
from analytic.errors import SceneError
from analytic.kernel.decision import RIGID_BEARINGS
from analytic.response import Failure
from analytic.rocking import BearingLaw, RockingModel, momentum_restitution, restitution
from analytic.scene import BEARINGS
from comparisons.metrics.errors import impact_errors
from engines import ENGINES, get_engine
from engines.comparison import RESTITUTION, compare
from engines.events import STILL, contact_measures, impacts_of
from engines.loads import ALONE, Couple, holding
from engines.scripting import write_script
from engines.simulating import Simulator
from engines.swings import Trace
from engines.trace_checks import energy_balance, energy_gain, pivoting_centre


def ratios(response):
    return [impact.rate_after / impact.rate_before for impact in response.impacts]


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


@pytest.mark.parametrize(
    "engine, variant, base", [*((*case, None) for case in CASES), *((*case, 212.0) for case in ACCURATE.items())]
)
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
def test_overturning_stops_cleanly(engine, variant):
    given = scene(0.2, motion=PulseMotion("one-sine", 2.812, 3.194), duration=8.0, gravity=3.7)
    response, reference = simulate(engine, variant, given), exact(given)
    assert response.outcome == reference.outcome == "overturns"
    assert response.end.time == response.history.time[-1] == pytest.approx(response.overturning_time)
    assert abs(response.end.tilt) == response.peak_tilt == pytest.approx(math.pi / 2)
    assert response.unstable_time == response.fall_time < response.overturning_time < 8.0
    if ACCURATE.get(engine) == variant:
        assert response.fall_time == pytest.approx(reference.fall_time, abs=2e-3)
        assert response.overturning_time == pytest.approx(reference.overturning_time, abs=2e-3)


@accurate_variant
@pytest.mark.filterwarnings("ignore:(overflow|invalid value):RuntimeWarning")
def test_a_shock_beyond_the_engines_numbers_is_not_survived_in_silence(engine, variant):
    given = load_scene("caryatid-isolated").with_(motion=PulseMotion("half-sine", 1e30, 3.0), duration=3.0)
    response = simulate(engine, variant, given, history=False)
    assert response.outcome in ("overturns", "failed")
    assert response.failure is None or (response.failure.message and math.isfinite(response.failure.last_state.tilt))


@every_variant
def test_bearing_force_is_the_law_on_the_engines_own_path(engine, variant):
    bearings, start = bearings_of("bouc-wen", count=4, damping=500.0), Start(base_displacement=0.02, base_velocity=-0.1)
    given = scene(0.15, 212.0, 2.0, bearings=bearings, motion=PULSE, start=start)
    _, trace = get_engine(engine).traced(given, variant=variant)
    rule = BearingLaw.of(given.bearings)
    z, x, worst = rule.start(0.02), 0.02, 0.0
    for moved, speed, force in zip(trace.base_displacement, trace.base_velocity, trace.bearing_force, strict=True):
        z, x = rule.hysteretic(z, moved - x), moved
        worst = max(worst, abs(rule.force(x, z, speed) - force))
    assert worst < 1e-9 * BearingLaw.of(BEARINGS).f0
    assert np.ptp(trace.bearing_force) > 1e3  # N: it was used


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
def test_impact_times_of_a_released_block_under_vertical_motion(engine, variant):
    given, limit = HEAVED.with_(base=Base(mass=212.0)), bound(engine, "impact times", "sliding base")
    expected, response = first_impacts(exact(given)), simulate(engine, variant, given, history=False)
    assert response.outcome == "rocks" and response.failure is None
    np.testing.assert_allclose(first_impacts(response), expected, rtol=0, atol=limit)
    assert abs(first_impacts(exact(without(given)))[1] - expected[1]) > 50 * limit


@accurate_variant
def test_rocking_on_bearings_under_vertical_motion(engine, variant):
    reference, level = exact(DRIVEN), exact(without(DRIVEN))
    response = simulate(engine, variant, DRIVEN, history=False)
    tilt, shift = (
        bound(engine, f"peak {quantity}", "rocking on bearings, one-sine") for quantity in ("tilt", "displacement")
    )
    assert response.peak_tilt_ratio == pytest.approx(reference.peak_tilt_ratio, abs=tilt)
    assert abs(level.peak_tilt_ratio - reference.peak_tilt_ratio) > 50 * tilt
    assert response.peak_base_displacement == pytest.approx(reference.peak_base_displacement, rel=shift)
    assert response.min_normal_ratio == pytest.approx(reference.min_normal_ratio, abs=2e-3)
    assert len(response.impacts) == len(reference.impacts) > 5
    assert response.uplifts[0] == pytest.approx(reference.uplifts[0], abs=1e-5)
    assert RIGID_BEARINGS in map(str, response.warnings)


@every_variant
def test_every_variant_feels_vertical_motion_and_says_where_a_block_would_jump(engine, variant):
    run = partial(simulate, engine, variant, history=False)
    heaving, level = (given_scene.with_(duration=0.6) for given_scene in (HEAVED, without(HEAVED)))
    wanted, felt = (first_impacts(solve(heaving))[0] - first_impacts(solve(level))[0] for solve in (exact, run))
    assert felt == pytest.approx(wanted, rel=0.15)
    up = SampledMotion(0.005, 12.0 * np.sin(9.0 * TIMES))
    response = run(HEAVED.with_(motion=replace(HEAVING, vertical=up), start=Start(tilt=0.05), duration=1.0))
    assert response.failure is not None or any("the block would jump" in warning.text for warning in response.warnings)


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


@pytest.mark.parametrize("base, after", [(3172.05, 1e-4), (None, 3e-4)])
@pytest.mark.parametrize("engine", ["exudyn", "pybullet", "mujoco", "pymunk"])
def test_a_run_that_ends_in_an_impact_reads_it_as_one_that_goes_on(engine, base, after):
    """e was off by .028 (exudyn, with a warning), .017 (PyBullet) and .97 (MuJoCo), in silence."""
    given, _ = cut(base, after)
    response = get_engine(engine).simulate(given, history=False)
    assert response.outcome == "rocks" and not [each for each in response.warnings if "impact" in each.text]
    assert all(impact.time <= given.duration for impact in response.impacts)
    assert ratios(response) == pytest.approx([restitution(given)] * 2, abs=2e-3)


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
    once, short, twice, unsound = (kind.of(get_engine(engine)) for kind in (Counted, Counted, Counted, Unsound))
    plain, _ = once.traced(given.with_(duration=at - 0.1), history=False)
    short.traced(given.with_(duration=1e-3), history=False)  # its first swing begins at the start, by no uplift
    response, _ = twice.traced(given, history=False)
    assert len(once.durations) == len(short.durations) == 1 and len(twice.durations) == 2
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
@pytest.mark.parametrize("slenderness, base", [(0.3, 400.0)])
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
        reported = response.failure or compare(given, response).differences
        assert reported or worst(given, response) < limit, value


every_subject = pytest.mark.parametrize("engine", ["exudyn", "pybullet"])


def flight_of(model):
    """(the first flight, the mode after it), each with its time."""
    modes = model.sliding.modes
    return next((begin, end) for begin, end in pairwise(modes) if begin[1] == "flight")


@every_subject
def test_a_block_on_pendulum_bearings_rocks_as_in_the_model(engine):
    """.8 m by .3 m, 160 kg; measured: tilt 2e-5 of the slenderness, base 2e-6 of its displacement."""
    pendula = pendulum_bearings(260.0, 1.0, 0.1, count=3)
    block = Block(mass=160.0, radius=0.427, slenderness=0.3588)
    motion = PulseMotion("one-sine", amplitude=4.2, frequency=6.0)
    given = Scene(block=block, base=Base(mass=100.0), bearings=pendula, motion=motion)
    model, run = exact(given), get_engine(engine).simulate(given)
    assert (run.failure, run.outcome, run.differences) == (None, "rocks", ()) and model.outcome == "rocks"
    assert run.peak_tilt_ratio == pytest.approx(model.peak_tilt_ratio, abs=2e-4)
    assert run.peak_base_displacement == pytest.approx(model.peak_base_displacement, rel=2e-5)


@every_subject
@pytest.mark.parametrize("scene", [SAVED, LOST, SLIDES], ids=["saved", "overturned", "slides"])
def test_a_block_that_slides_does_so_in_engines(engine, scene):
    model, run = exact(scene), get_engine(engine).simulate(scene)
    assert (run.failure, run.outcome, run.differences) == (None, model.outcome, ())
    assert run.comparable in ("yes", "on an edge") and not [
        warning for warning in run.warnings if warning.kind == "model"
    ]
    assert run.sliding.peak == pytest.approx(model.sliding.peak, rel=1e-3)
    assert run.friction_demand <= scene.friction
    if model.outcome == "overturns":
        assert run.overturning_time == pytest.approx(model.overturning_time, abs=2e-3)
    else:
        assert run.peak_tilt == pytest.approx(model.peak_tilt, abs=1e-4)
        slip = np.interp(model.history.time, run.history.time, run.history.slip)
        np.testing.assert_allclose(slip, model.history.slip, atol=1e-3 * np.abs(model.history.slip).max())


@every_subject
@pytest.mark.parametrize("scene", [LANDS, PASSES], ids=["lands", "passes the upright"])
def test_neither_a_landing_nor_a_passage_in_the_air_is_an_impact_that_differs(engine, scene):
    """The landing is one in the model only, and off the upright; in the air the tilt changes side without any."""
    model, run = exact(scene, history=False), get_engine(engine).simulate(scene)
    begin, end = (each[0] for each in flight_of(model))
    assert (run.failure, run.outcome, run.differences, run.comparable) == (None, "rocks", (), "yes")
    assert [each.time for each in model.impacts if begin <= each.time <= end] == [end]
    assert not [each.time for each in run.impacts if begin <= each.time <= end]
    run_rows, model_rows = (impacts_of(each)[:5] for each in (run, model))
    assert np.allclose(run_rows, model_rows, rtol=1e-3) and len(impacts_of(model)) == len(model.impacts) - 1


def test_a_run_that_does_not_slip_where_the_model_does_differs():
    """A first script, which reads no place, is not asked."""
    stuck = replace(exact(SAVED, history=False).sliding, peak=0.0, end=0.0, path=0.0)
    for given, outcome, differs in ((SAVED, "rocks", ["peak_slip"]), (SLIDES, "stands", ["outcome", "peak_slip"])):
        run = replace(exact(given, history=False), engine="any", outcome=outcome)
        for slid, quantities in ((stuck, differs), (None, [])):
            assert [
                difference.quantity for difference in compare(given, replace(run, sliding=slid)).differences
            ] == quantities


@pytest.mark.parametrize("engine", ["pybullet", "mujoco", "dart"])
def test_a_first_script_slides_too(engine):
    """As much as its step and its contact allow; the block's place is read from the engine."""
    model, run = exact(SLIDES, history=False), get_engine(engine).simulate(SLIDES, variant="first-script")
    assert (run.failure, run.outcome) == (None, "slides")
    assert run.sliding.peak == pytest.approx(model.sliding.peak, rel=0.1)


def test_a_level_block_that_slides_gains_no_energy_while_its_tilt_changes_sign():
    """The tilt of one in soft contact does; what the ground does meanwhile counts, until the contact is settled."""
    scene = SLIDES.with_(motion=PulseMotion("half-sine", 8.0, 6.0), duration=0.52)
    seen = exact(scene, output_step=1e-3).history
    still, speed = np.zeros_like(seen.time), np.gradient(seen.slip, seen.time)
    tilt = 1e-9 * np.where((seen.time > 0.02) & (seen.time < 0.5), (-1.0) ** np.arange(len(still)), 1.0)
    trace = Trace(seen.time, tilt, still, still, still, still, 1e-6, settle=5e-3)
    centre = pivoting_centre(scene, trace)
    centre[:, 0], centre[:, 2] = seen.slip, speed
    assert np.abs(speed[-1]) > 0.5 and energy_gain(scene, replace(trace, centre=centre)) < 1e-2


@pytest.mark.parametrize("engine, room", [("exudyn", 2e-2), ("pybullet", 1e-3)])
def test_an_impact_may_turn_the_energy_of_the_slip_into_rotation(engine, room):
    """The tilt rate rises by a third at it; which is no failure of an engine that does the same.

    The contact of exudyn lasts: with five times its stiffness the error is .6 of that.
    """
    pulse = PulseMotion("ricker", -12.025, 15.53, vertical=PulseMotion("ricker", 8.017, 15.53))
    scene = scene_of(0.571, 0.21366, 0.22704, base=2.213, motion=pulse).with_(
        block={"mass": 3.0487}, bearings={"ka": 594.84, "kb": 242.085, "alpha": 308.23}
    )
    (model,) = exact(scene, history=False).impacts
    run = get_engine(engine).simulate(scene)
    assert run.failure is None and model.rate_after > 1.2 * model.rate_before
    assert run.impacts[0].rate_after == pytest.approx(model.rate_after, rel=room)


@pytest.mark.slow
def test_what_mujoco_is_said_to_get_wrong_it_gets_wrong():
    """A block with friction .2 and tan(gamma) .2027 can only slide; and the impact of `LOST`, into which it slides."""
    engine, low = get_engine("mujoco"), scene_of(0.2, 0.2, motion=PulseMotion("rectangular", 4.0, 6.0))
    (model,), (seen,) = (run(LOST, history=False).impacts for run in (exact, engine.simulate))
    assert model.rate_after < 0.9 * model.rate_before and seen.rate_after > 0.99 * seen.rate_before
    for variant in ("impact-aware", "fixed-step"):
        assert engine.simulate(low, variant=variant).outcome == "overturns" != exact(low, history=False).outcome
        assert engine.variants[variant].faults


LIGHT = Scene(  # on a light base, whose acceleration the friction decides
    block=Block(mass=1500.0, radius=1.0, slenderness=0.28),
    base=Base(mass=300.0),
    bearings=Bearings(law="linear", ka=4.0e3, count=4),
    motion=PulseMotion("one-cosine", 6.0, 5.0),
    friction=0.3,
    duration=1.2,
)
MOVING = {
    "slides": LIGHT.with_(block={"slenderness": 0.4}, motion=PulseMotion("one-sine", 6.0, 8.0)),
    "slides and rocks": LIGHT,
    "flies": scene_of(
        0.5, 0.3, motion=PulseMotion("one-sine", 4.0, 12.0, vertical=PulseMotion("one-sine", 16.0, 12.0)), duration=1.0
    ),
}


@every_subject
@pytest.mark.parametrize("name", MOVING)
def test_forces_and_base_acceleration_are_those_of_a_block_that_moves_on_its_base(engine, name):
    """By the equations of a block that sticks they were up to three times off."""
    scene = MOVING[name]
    model, run = exact(scene, history=False), get_engine(engine).simulate(scene, history=False)
    assert model.outcome == run.outcome and model.sliding.peak > 0
    assert run.peak_base_acceleration == pytest.approx(model.peak_base_acceleration, rel=2e-3)
    assert run.min_normal_ratio == pytest.approx(model.min_normal_ratio, abs=5e-3)
    assert run.friction_demand == pytest.approx(scene.friction, rel=1e-9)


def test_a_contact_that_yields_lifts_no_block():
    """A peak tilt of 2e-6 of the slenderness is no rocking, in the run as in the comparison."""
    scene = scene_of(0.2, 0.28, motion=PulseMotion("one-sine", 6.0, 8.0))
    run = get_engine("exudyn").simulate(scene, history=False)
    assert 0 < run.peak_tilt_ratio < STILL and run.outcome == "slides" and not run.differences


@every_subject
def test_with_a_given_restitution_and_a_smaller_friction_nothing_is_compared(engine):
    scene = SLIDES.with_(block={"restitution": 0.7})
    run = get_engine(engine).simulate(scene, history=False)
    assert run.comparable.startswith("the contact's friction is ") and "not the scene's 0.2" in run.comparable
    assert not run.differences


# rms of e/given - 1 over impacts faster than .06 of the fastest; wide: at the ends of the range exudyn's corners swing,
# most on a light base at f = .8
BOUNDS = {"pybullet": 1.2e-3, "mujoco": 1.2e-3, "exudyn": 2e-3}
WIDE = {**BOUNDS, "exudyn": 5e-3}
# Amplitude over g tan(slenderness) of a pulse at 3 omega_r from which the model overturns.
BOUNDARY = 2.2679915
every_coupled = pytest.mark.parametrize("engine", BOUNDS)


def let_go(ground, slenderness, kept):
    scene = load_scene(f"free-rocking-{ground}")
    scene = scene.with_(block={"slenderness": slenderness, "restitution": None}, start={"tilt": 0.6 * slenderness})
    return scene.with_(block={"restitution": kept * momentum_restitution(scene)})


@pytest.mark.parametrize("kept", [0.8, 0.95, 1.02])
def test_a_flight_without_pull_keeps_the_share_at_any_step(kept):
    """Steps of any length: the rate at the ground is the share of that before it."""
    for steps in (2e-7, 1e-6, 7e-6):
        couple, tilt, rate = Couple(kept, 3.0, 1e-4), 1e-3, -0.7
        while tilt > 0:
            rate += couple.moment(steps, tilt, rate) * steps / couple.inertia
            tilt += rate * steps
        assert rate == pytest.approx(-0.7 * kept, rel=1e-9)


@every_coupled
@pytest.mark.parametrize("kept, why", [(1 + 1e-6, "above"), (0.09, "below")])
def test_what_a_couple_does_not_reach_is_refused_by_engine_and_script_alike(engine, kept, why):
    scene = let_go("isolated", 0.2, kept)
    given, momentum = scene.block.restitution, momentum_restitution(scene)
    words = f"block.restitution = {given!r}: {why} what a couple .*, 0.1 to 1 times the {momentum:.6g} of eq.*{ALONE}"
    for run in (get_engine(engine).simulate, lambda scene: write_script(ENGINES["exudyn"], scene)):
        with pytest.raises(SceneError, match=words):
            run(scene)
    assert exact(scene).outcome == "rocks"  # the model takes any


@pytest.mark.parametrize("kept, remedy", [(0.9, f"use the variant impact-aware, {ALONE}"), (1.01, ALONE)])
def test_a_variant_that_takes_none_names_one_that_does_where_there_is_one(kept, remedy):
    with pytest.raises(SceneError) as caught:
        get_engine("pybullet").simulate(let_go("rigid", 0.2, kept), variant="fixed-step")
    assert str(caught.value).endswith(f"the impact itself; leave it out, {remedy}")


@every_coupled
@pytest.mark.parametrize(
    "ground, slenderness, kept, bounds, jump, least",
    [
        ("rigid", 0.2, 0.9, BOUNDS, 1e-3, 8),
        ("isolated", 0.2, 0.95, BOUNDS, 1e-3, 8),
        ("isolated", 0.4, 0.8, WIDE, 2e-3, 2),
        ("isolated", 0.1, 1.0, WIDE, 2e-3, 2),
    ],
)
def test_impacts_have_the_given_restitution(engine, ground, slenderness, kept, bounds, jump, least):
    check_impacts(engine, let_go(ground, slenderness, kept), bounds[engine], jump, least)


@every_coupled
def test_the_pivot_holds_whatever_friction_the_scene_gives(engine):
    """With the scene's own, .7 being what the model needs, the couple would make it slip: e was off by up to .3."""
    scene = let_go("rigid", 0.2, 0.8)
    check_impacts(engine, scene.with_(friction=0.72), BOUNDS[engine], least=7)
    assert holding(scene) is scene and holding(scene.with_(friction=6.0)).friction == 6.0
    assert holding(scene.with_(friction=0.6)).friction == pytest.approx(1 / math.tan(0.2))
    assert holding(scene.with_(friction=0.6, block={"restitution": None})).friction == 0.6
    isolated = let_go("isolated", 0.2, 0.8).with_(friction=0.6)
    assert holding(isolated) is isolated  # the base follows
    response = get_engine(engine).simulate(scene.with_(friction=0.6, duration=0.1))
    assert "the contact's friction is 4.93" in response.warnings[-1].text


def check_impacts(engine, scene, bound, jump=1e-3, least=8):
    """jump: bound of the rms error of the base velocity's jump, over the largest; least: so many impacts are more."""
    ground = "isolated" if scene.base else "rigid"
    response, model = get_engine(engine).simulate(scene), RockingModel.of(scene)
    before = np.array([impact.rate_before for impact in response.impacts])
    after = np.array([impact.rate_after for impact in response.impacts])
    fast = np.abs(before) > 0.06 * np.abs(before).max()
    assert fast.sum() > least
    error = (after / before)[fast] / scene.block.restitution - 1
    assert np.sqrt((error**2).mean()) < bound
    if ground == "isolated":  # (8): the base takes the momentum, of the couple, too
        jumps = np.array([impact.base_velocity_jump for impact in response.impacts])[fast]
        wanted = (model.jump_arm * (before - after))[fast]
        assert np.sqrt(((jumps - wanted) ** 2).mean()) < jump * np.abs(wanted).max()
    assert response.outcome == exact(scene).outcome == "rocks"
    (caution,) = [warning for warning in response.warnings if warning.quantity == "restitution"]
    assert str(caution).startswith(f"restitution given, {scene.block.restitution:.4g}")


@every_coupled
def test_a_pulse_overturns_from_the_amplitude_of_the_model_on(engine):
    """Within .1 %; f moves it by 2 to 6 %."""
    scene = let_go("isolated", 0.2, 0.8).with_(start={"tilt": 0.0}, duration=None)

    def outcome(simulate, share):
        amplitude = BOUNDARY * share * scene.gravity * math.tan(scene.block.slenderness)
        pulse = PulseMotion("one-sine", amplitude, 3 * scene.rocking_frequency)
        return simulate(scene.with_(motion=pulse), history=False).outcome

    assert [outcome(exact, share) for share in (1 - 1e-6, 1 + 1e-6)] == ["rocks", "overturns"]
    assert [outcome(get_engine(engine).simulate, share) for share in (0.999, 1.001)] == ["rocks", "overturns"]
