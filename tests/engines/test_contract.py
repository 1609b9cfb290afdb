"""What every engine and each of its variants must fulfil; an engine is covered by its name in `engines.BUILT_IN`.

Measured bounds stand by engine and variant in tables here; one that is not in a table is held to the table's default.
"""

import math
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, fields, is_dataclass, replace
from importlib import metadata
from pathlib import Path

import numpy as np
import pytest
from bearing_laws import NAMES, bearings_of

import engines
from analytic import (
    Base,
    Bearings,
    Block,
    PulseMotion,
    SampledMotion,
    Scene,
    SceneError,
    SettingError,
    Start,
    load_scene,
)
from analytic import simulate as exact
from analytic.bearing import BearingLaw
from analytic.errors import EngineNotInstalled
from analytic.records import read_record
from analytic.response import History
from analytic.rocking import RockingModel, restitution
from engines import ENGINES, get_engine, guard
from engines.checks import pivoting_centre
from engines.contract import RUNGS

BEARINGS = Bearings(count=4, ka=6.22e4, kb=6.22e3, alpha=44.69)
PULSE = PulseMotion("one-sine", 6.0, 4.0)
RECORD = Path(__file__).parents[3] / "shared" / "records" / "RSN1605_DUZCE_DZC270.AT2"

# Held to the analytic model beside the default variants.
ALSO_ACCURATE = {("exudyn", "switched-joints")}


def cases(keep):
    """A pytest parameter (engine, variant) for each that `keep` takes; one that is skipped for an absent engine."""
    for name in ENGINES:
        try:
            engine = get_engine(name)
        except EngineNotInstalled as error:
            yield pytest.param(name, None, marks=pytest.mark.skip(reason=str(error)))
            continue
        for variant in engine.variants:
            if keep(name, variant, engine.default_variant):
                yield pytest.param(name, variant)


every_variant = pytest.mark.parametrize("engine, variant", list(cases(lambda *case: True)))
default_variant = pytest.mark.parametrize(
    "engine, variant", list(cases(lambda name, variant, default: variant == default))
)
accurate_variant = pytest.mark.parametrize(
    "engine, variant",
    list(cases(lambda name, variant, default: variant == default or (name, variant) in ALSO_ACCURATE)),
)


def scene(slenderness, base=None, duration=2.0, **parts):
    return Scene(
        block=Block(mass=3172.05, radius=1.0884, slenderness=slenderness),
        name="contract",
        base=Base(mass=base) if base else None,
        duration=duration,
        **parts,
    )


def simulate(engine, variant, given, **settings):
    return get_engine(engine).simulate(given, variant=variant, **settings)


def bearings(law, damping):
    return bearings_of(law, count=4, damping=damping)


def shaking(peak, duration=6.0):
    instants = 0.01 * np.arange(round(100 * duration) + 1)
    level = np.sin(8 * instants) + 0.5 * np.sin(26 * instants)
    return SampledMotion(0.01, level / np.abs(level).max() * peak)


# What an engine's record holds, and what it refuses.


@default_variant
def test_record_holds_what_the_contract_names(engine, variant):
    record = get_engine(engine)
    assert record is ENGINES[engine] and record.installed and engine in engines.installed_engines()
    for name, one in record.variants.items():
        assert is_dataclass(one.settings) and one.settings.__dataclass_params__.frozen
        assert fields(one.settings) and all(0 < value < math.inf for value in asdict(one.settings).values())
        assert one.rung in RUNGS and (name == record.default_variant) == (one.rung == "best")
        assert "decides" in one.decides and "impact" in one.decides
        assert one.verified is not None or one.caveats
        down = sorted(one.ladder, reverse=True)  # from coarse to fine; of a stiffness the finer is the larger
        assert list(one.ladder) == (down[::-1] if one.knob == "stiffness" else down) and len(one.ladder) > 1
    distribution = metadata.packages_distributions()[record.package][0]
    assert record.versions()[record.package] == metadata.version(distribution)


@pytest.mark.parametrize("engine", ENGINES)
def test_records_are_light_and_shadow_no_package(engine):
    """The folder of an engine here has the name of the package it uses."""
    program = f"""
import sys
from engines import ENGINES
record = ENGINES[{engine!r}]
assert record.package not in sys.modules and record.adapter not in sys.modules
if record.installed:
    assert sys.modules[record.package] is not sys.modules["engines." + record.name]
    assert "engines" not in (sys.modules[record.package].__file__ or "")
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr


@default_variant
def test_unknown_variant_is_refused_and_the_known_ones_are_named(engine, variant):
    with pytest.raises(SettingError, match=f"'best'.*: choose one of {', '.join(get_engine(engine).variants)}$"):
        simulate(engine, "best", scene(0.2))


@every_variant
def test_unknown_setting_is_refused_and_the_known_ones_are_named(engine, variant):
    known = ", ".join(field.name for field in fields(get_engine(engine).variants[variant].settings))
    with pytest.raises(SettingError, match=f"{engine} {variant}.*: .* {known}$") as caught:
        simulate(engine, variant, scene(0.2), steep=1e-3)
    assert "'steep'" in str(caught.value)


@every_variant
@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf, True, "1", None])
def test_setting_that_is_not_a_positive_number_is_refused(engine, variant, value):
    for field in fields(get_engine(engine).variants[variant].settings):
        with pytest.raises(SettingError, match=f"{field.name} = {value!r} .*positive number"):
            simulate(engine, variant, scene(0.2), **{field.name: value})


@every_variant
def test_given_restitution_is_refused_or_kept_but_never_ignored(engine, variant):
    given = scene(0.2, duration=0.8, start=Start(tilt=0.12)).with_(block={"restitution": 0.7})
    try:
        first = simulate(engine, variant, given).impacts[0]
    except SceneError as error:
        assert error.key == "block.restitution" and error.value == 0.7
    else:
        assert first.rate_after / first.rate_before == pytest.approx(0.7, abs=1e-6)


# What the response holds.


@every_variant
def test_response_says_what_ran_and_what_it_cost(engine, variant):
    record, given = get_engine(engine), scene(0.2, 212.0, 0.3, start=Start(tilt=0.12))
    clock = time.process_time()
    response = simulate(engine, variant, given)
    spent = time.process_time() - clock
    assert (response.engine, response.variant, response.scene) == (engine, variant, "contract")
    assert response.versions == record.versions()
    assert response.settings == asdict(record.variants[variant].settings)
    assert 0 < response.cpu_seconds <= spent
    assert response.steps > 1
    assert response.failure is None and response.to_json()["outcome"] == "rocks"
    if variant == record.default_variant:
        assert record.simulate(given).end == response.end


@every_variant
def test_every_setting_can_be_replaced_and_is_in_the_response(engine, variant):
    settings = get_engine(engine).variants[variant].settings
    for field in fields(settings):
        change = {field.name: 0.8 * getattr(settings, field.name)}
        response = simulate(engine, variant, scene(0.2, duration=0.02, start=Start(tilt=0.12)), **change)
        assert response.settings == asdict(replace(settings, **change))


@every_variant
def test_history_is_on_equal_intervals_without_a_record_and_can_be_left_out(engine, variant):
    given = scene(0.2, 212.0, 0.5, start=Start(tilt=0.12))
    kept, without = simulate(engine, variant, given), simulate(engine, variant, given, history=False)
    np.testing.assert_allclose(kept.history.time, np.linspace(0, 0.5, 2001), rtol=0, atol=1e-12)
    assert without.history is None
    assert without.end == kept.end and without.impacts == kept.impacts and without.peak_tilt == kept.peak_tilt


# The error 0.1 s after a start in flight: tilt [rad], its rate [rad/s], base displacement [m]. The second is of
# variants that no accuracy is asked of; without its initial velocities a run would be 0.03 rad or 0.01 m off.
IN_FLIGHT, IN_FLIGHT_ROUGHLY = (8.8e-7, 1.5e-5, 5.8e-7), (1e-3, 1e-2, 1e-3)


@every_variant
def test_start_in_flight(engine, variant):
    start = Start(tilt=0.1, tilt_rate=0.3, base_displacement=0.02, base_velocity=-0.1)
    given = scene(0.3, 212.0, 0.1, bearings=BEARINGS, start=start)
    response, reference = simulate(engine, variant, given), exact(given)
    for name in History.COLUMNS:
        assert getattr(response.history, name)[0] == getattr(reference.history, name)[0], name
    accurate = variant == get_engine(engine).default_variant or (engine, variant) in ALSO_ACCURATE
    bounds = IN_FLIGHT if accurate else IN_FLIGHT_ROUGHLY
    for name, bound in zip(("tilt", "tilt_rate", "base_displacement"), bounds, strict=True):
        assert abs(getattr(response.end, name) - getattr(reference.end, name)) < bound, name


@every_variant
@pytest.mark.parametrize("start, base", [(0.1, None), (0.0, None), (0.1, 212.0), (0.0, 212.0)])
def test_ground_motion_that_is_not_finite_fails_with_the_last_finite_state(engine, variant, start, base):
    """Behind the reader's back the record turns to NaN: whatever the engine makes of it must surface."""
    motion = shaking(0.5)
    samples = motion.samples.copy()
    samples[50:] = math.nan
    object.__setattr__(motion, "samples", samples)
    given = scene(0.2, base, bearings=BEARINGS if base else None, start=Start(tilt=start), motion=motion)
    response = simulate(engine, variant, given)
    assert response.outcome == "failed"
    assert response.failure.reason and response.failure.message
    state = response.failure.last_state
    assert all(math.isfinite(value) for value in asdict(state).values())
    assert 0.48 < state.time < 0.5 and response.end == state
    assert all(np.isfinite(getattr(response.history, name)).all() for name in History.COLUMNS[:-1])
    assert (response.engine, response.variant, response.scene) == (engine, variant, "contract")
    assert response.settings == asdict(get_engine(engine).variants[variant].settings)
    assert response.versions == get_engine(engine).versions() and response.cpu_seconds > 0


@default_variant
def test_hang_ends_at_the_time_limit(engine, variant):
    response = guard.guarded_simulate(engine, scene(0.2, duration=1e4, start=Start(tilt=0.12)), time_limit=4.0)
    assert response.outcome == "failed"
    assert "time limit" in response.failure.message
    assert response.versions == get_engine(engine).versions()


# Repeatable and symmetric.


def in_every_variant(engine, given, settings):
    """What the guarded process runs."""
    return [simulate(engine, variant, given) for variant in get_engine(engine).variants]


@default_variant
def test_runs_repeat_bit_for_bit_also_in_other_processes(engine, variant):
    given = scene(0.15, 212.0, 1.0, bearings=BEARINGS, motion=PULSE)
    first, second = (in_every_variant(engine, given, {}) for _ in range(2))
    with ThreadPoolExecutor(2) as two:  # two at once
        elsewhere = list(two.map(lambda _: guard.guarded(in_every_variant, engine, given, {}, 120.0), range(2)))
    for repeated in (second, *elsewhere):
        for here, there in zip(first, repeated, strict=True):
            assert (here.variant, here.end, here.impacts) == (there.variant, there.end, there.impacts)
            assert all(
                np.array_equal(getattr(here.history, name), getattr(there.history, name)) for name in History.COLUMNS
            )


# [rad] and [m]. Adaptive steps follow round-off: a hundred times their local tolerance.
MIRROR, MIRROR_DEFAULT = {("exudyn", "compliant-corners"): 1e-5}, 1e-6


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


@every_variant
@pytest.mark.parametrize("base", [None, 212.0])
def test_block_left_alone_stands(engine, variant, base):
    response = simulate(engine, variant, scene(0.2, base, 1.0, bearings=BEARINGS if base else None))
    if (engine, variant, base) == ("exudyn", "native-contact", None) and response.outcome == "failed":
        assert "solver gave up" in response.failure.reason  # Newton's method, at 0.98 s: exudyn 1.13
        return
    assert response.outcome == "stands", response.failure
    assert response.impacts == response.uplifts == response.rests == ()
    assert response.peak_tilt * 1.0884 < 1e-5


# Under shaking below uplift: peak tilt times R, and drift of the lower corner [m]. Contacts that sink: measured 8.7e-4
# and 7.9e-4.
LIFT, LIFT_DEFAULT = {("exudyn", "native-contact"): 1.7e-3, ("mujoco", "first-script"): 1.5e-3}, 1e-5


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
    # the history is on the motion's own grid
    np.testing.assert_allclose(response.history.time, 0.01 * np.arange(601), rtol=0, atol=1e-11)
    np.testing.assert_array_equal(response.history.ground_acceleration, motion.acceleration(response.history.time))


@every_variant
def test_overturning_under_a_pulse_stops_cleanly(engine, variant):
    given = scene(0.2, motion=PulseMotion("one-sine", 3.8 * 9.81 * 0.2, 5.2), duration=5.0)
    response, reference = simulate(engine, variant, given), exact(given)
    assert response.outcome == reference.outcome == "overturns"
    assert response.end.time == response.history.time[-1] == pytest.approx(response.overturning_time)
    assert abs(response.end.tilt) == response.peak_tilt == pytest.approx(math.pi / 2)
    assert response.unstable_time < response.overturning_time < 5.0
    if variant == get_engine(engine).default_variant or (engine, variant) in ALSO_ACCURATE:
        assert response.overturning_time == pytest.approx(reference.overturning_time, abs=2e-3)


@accurate_variant
@pytest.mark.parametrize("ground", ["caryatid-rigid", "caryatid-isolated"])
@pytest.mark.filterwarnings("ignore:(overflow|invalid value):RuntimeWarning")
def test_a_shock_beyond_the_engines_numbers_is_not_survived_in_silence(engine, variant, ground):
    given = load_scene(ground).with_(motion=PulseMotion("half-sine", 1e30, 3.0), duration=3.0)
    response = simulate(engine, variant, given, history=False)
    assert response.outcome in ("overturns", "failed")
    assert response.failure is None or (response.failure.message and math.isfinite(response.failure.last_state.tilt))


@accurate_variant
def test_overturning_by_a_shock_stops_cleanly(engine, variant):
    """The block is thrown off its corner, which the model does not allow: the engines fall up to 0.09 s later."""
    given = scene(0.25, motion=PulseMotion("half-sine", 12.0, 3.0), duration=8.0)
    response = simulate(engine, variant, given)
    assert response.outcome == "overturns"
    assert response.end.time == pytest.approx(response.overturning_time)
    assert response.overturning_time == pytest.approx(exact(given).overturning_time, abs=0.17)
    assert abs(response.end.tilt) == pytest.approx(math.pi / 2)


# The bearings' law, and agreement with the analytic model.


@every_variant
@pytest.mark.parametrize(
    "law, damping", [("algebraic", 0.0), ("bouc-wen", 0.0), ("bilinear", 0.0), *((law, 500.0) for law in NAMES)]
)
def test_bearing_force_is_the_law_on_the_engines_own_path(engine, variant, law, damping):
    given = scene(0.15, 212.0, 2.0, bearings=bearings(law, damping), motion=PULSE)
    _, trace = get_engine(engine).traced(given, variant=variant)
    rule = BearingLaw.of(given.bearings)
    z, x, worst = rule.start(trace.base_displacement[0]), trace.base_displacement[0], 0.0
    for moved, speed, force in zip(trace.base_displacement, trace.base_velocity, trace.bearing_force, strict=True):
        z, x = rule.hysteretic(z, moved - x), moved
        worst = max(worst, abs(rule.force(x, z, speed) - force))
    assert worst < 1e-9 * BearingLaw.of(BEARINGS).f0
    assert np.ptp(trace.bearing_force) > 1e3  # N: it was used


@accurate_variant
@pytest.mark.parametrize("base", [None, 212.0])
@pytest.mark.parametrize("slenderness", [0.1, 0.2, 0.3, 0.45])
def test_impacts_are_as_momentum_asks(engine, variant, slenderness, base):
    """Of 8 starts, the first 3 impacts each."""
    errors, jumps = [], []
    for share in np.linspace(0.3, 0.8, 8):
        given = scene(slenderness, base, 3.0, start=Start(tilt=share * slenderness))
        response = simulate(engine, variant, given, history=False)
        assert response.outcome == "rocks", response.failure
        assert len(response.impacts) >= 2
        for impact in response.impacts[:3]:
            errors.append(impact.rate_after / impact.rate_before - restitution(given))
            if base:
                jumps.append((impact.base_velocity_jump, RockingModel.of(given).impact(impact.rate_before)[1]))
    assert np.sqrt(np.mean(np.square(errors))) < 1e-4
    if base:
        found, wanted = np.array(jumps).T
        assert np.sqrt(np.mean(np.square(found / wanted - 1))) < 1e-3
        assert np.abs(found - wanted).max() < 1e-3  # m/s


# Largest error of the tilt [rad].
TILT, TILT_DEFAULT = {("exudyn", "compliant-corners"): 8e-4}, 3e-4


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
        bearings=bearings(law, damping),
        motion=PulseMotion("one-sine", 2.0, 5.0),
        start=Start(base_displacement=0.02, base_velocity=-0.1),
    )
    response, reference = simulate(engine, variant, given), exact(given)
    assert response.outcome == reference.outcome == "stands"
    assert response.peak_base_displacement == pytest.approx(reference.peak_base_displacement, rel=1e-4)


# Error of the peak base displacement, relative; exudyn's is 1e-5 m.
PEAK, PEAK_DEFAULT = (
    {
        ("exudyn", "compliant-corners"): 1e-5 / 0.212190,
        ("exudyn", "switched-joints"): 1e-5 / 0.212190,
        ("mujoco", "impact-aware"): 1e-5,
    },
    1e-4,
)


@accurate_variant
@pytest.mark.parametrize(
    "motion",
    [
        "synthetic",
        pytest.param(
            "Duzce",
            marks=pytest.mark.skipif(
                not RECORD.exists(), reason="the Duzce record is not here: its terms do not allow shipping it"
            ),
        ),
    ],
)
def test_isolated_caryatid(engine, variant, motion):
    given = load_scene("caryatid-isolated").with_(duration=12.0)
    bound = PEAK.get((engine, variant), PEAK_DEFAULT)
    if motion == "Duzce":
        given = given.with_(motion=read_record(RECORD))
    response, reference = simulate(engine, variant, given, history=False), exact(given, history=False)
    assert response.outcome == reference.outcome == "stands"
    assert response.peak_base_displacement == pytest.approx(reference.peak_base_displacement, rel=bound)
    if motion == "Duzce":
        assert response.peak_base_displacement == pytest.approx(0.212190, rel=bound)


@accurate_variant
@pytest.mark.parametrize("mass", [0.3172, 31720.0])
@pytest.mark.parametrize("slenderness", [0.05, 0.6])
def test_extreme_masses_and_slenderness(engine, variant, mass, slenderness):
    given = scene(slenderness, mass, 2.0, start=Start(tilt=0.6 * slenderness))
    response, reference = simulate(engine, variant, given), exact(given)
    assert response.outcome == reference.outcome == "rocks"
    assert response.impacts[0].time == pytest.approx(reference.impacts[0].time, abs=5e-4)
    assert response.peak_base_displacement == pytest.approx(reference.peak_base_displacement, rel=1e-3)


# Engines that are absent or broken.


@pytest.mark.parametrize("engine", ENGINES)
def test_all_else_works_where_an_engine_is_not_installed(engine):
    package, remedy = ENGINES[engine].package, ENGINES[engine].install
    program = f"""
import sys
sys.modules[{package!r}] = None  # what Python does for a package that cannot be imported
from engines import get_engine, installed_engines
from analytic.errors import EngineNotInstalled
assert {engine!r} not in installed_engines()
try:
    get_engine({engine!r})
except EngineNotInstalled as error:
    assert {remedy!r} in str(error)
else:
    raise AssertionError("it was found")
from comparisons.cli import main
main(["compare", "free-rocking-isolated"])
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    assert "analytic" in done.stdout and engine not in done.stdout
