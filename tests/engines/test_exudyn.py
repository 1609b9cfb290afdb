"""exudyn, beside what every engine must fulfil: its corners, its two integrators, what is imposed, how runs end."""

import gc
import math
import os
import signal
import sys
import threading
import time
from dataclasses import asdict, replace
from types import SimpleNamespace

import numpy as np
import psutil
import pytest
from bearing_laws import NAMES, bearings_of
from engine_cases import scene

from analytic import Base, Bearings, Block, PulseMotion, SampledMotion, Scene, Start, load_scene
from analytic import simulate as exact
from analytic.rocking import BearingLaw, restitution
from analytic.scene import BEARINGS
from engines import get_engine
from engines.contract import Mismatch
from engines.events import find_events
from engines.swings import find_swings

VARIANTS = "compliant-corners", "native-contact"
RELEASED = scene(0.2, duration=1.0, start=Start(tilt=0.12))
JUMP = 1.25 * 9.81 * math.tan(0.2)  # of the ground's acceleration: it lifts a block of this slenderness


def simulate(given, **options):
    return get_engine("exudyn").simulate(given, **options)


def trace_of(given):
    """The trace of exudyn's run."""
    response, trace = get_engine("exudyn").traced(given)
    assert response.failure is None, response.failure
    return trace


def ratio(impact):
    return impact.rate_after / impact.rate_before


def restitution_error(given, **settings):
    """Largest error of restitution; exudyn and the model have the same impacts."""
    response, reference = simulate(given, history=False, **settings), exact(given, history=False)
    assert response.outcome == reference.outcome == "rocks", response.failure
    assert len(response.impacts) == len(reference.impacts) > 0
    return max(abs(ratio(impact) - restitution(given)) for impact in response.impacts)


# Corners.


@pytest.mark.parametrize(
    "gravity, factors",
    [
        (0.25, {"stiffness": 4, "longest_step": 4, "pivoting_step": 4}),
        (4.0, {"stiffness": 64, "rebound": 4, "slip": 4, "tolerance": 0.25}),
    ],
)
def test_settings_go_with_weight_size_and_gravity(gravity, factors):
    """A block scaled by lengths of 4, masses of 64 and times of 4 or 1: each number by its unit."""
    from engines.exudyn.scene import MEASURED, CompliantCorners, scaled

    mass, radius, usual = MEASURED
    block = Block(mass=64 * mass, radius=4 * radius, slenderness=0.2)
    settings = scaled(Scene(block=block, start=Start(tilt=0.1), gravity=gravity * usual), CompliantCorners())
    wanted = {name: factors.get(name, 1) * value for name, value in asdict(CompliantCorners()).items()}
    assert asdict(settings) == pytest.approx(wanted)


@pytest.mark.parametrize("share, base", [(0.59, None), (0.8, 3172.05)])
def test_no_impact_of_a_stocky_fast_block_is_lost(share, base):
    """It hops for 15 ms after an impact, so that the lift carried back lies microseconds after the landing."""
    assert restitution_error(scene(0.45, base, 0.9, start=Start(tilt=0.45 * share))) < 2e-4


def test_error_of_compliant_corners_goes_as_one_over_stiffness():
    given = scene(0.1, duration=0.8, start=Start(tilt=0.06))
    assert 4 < restitution_error(given, stiffness=1e9) / restitution_error(given, stiffness=1e10) < 25


@pytest.mark.parametrize("base", [None, 212.0])
def test_a_block_left_alone_does_not_sink(base):
    """It starts on the corners as they carry it."""
    trace = trace_of(given := scene(0.2, base, 0.2))
    sink, height = 0.5 * trace.contact_tilt * given.block.half_width, trace.centre[:, 1]
    assert height[0] == pytest.approx(-sink, rel=1e-9)
    assert np.ptp(height) < 0.1 * sink  # what the tolerance of the steps leaves


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("ahead", [-3e-2, 2e-5, 0.2])
def test_the_bearings_spring_meets_the_law_at_both_ends_of_a_step(name, ahead):
    """The travel of the last step is that expected of the next one."""
    from engines.exudyn.scene import Bearing

    law, spring = BearingLaw.of(bearings_of(name, count=4)), {}
    bearing = Bearing(law, 0.01 - ahead)
    bearing.commit(SimpleNamespace(SetObjectParameter=lambda number, field, value: spring.update({field: value})), 0.01)
    for travel in (0.0, ahead):
        x, z = 0.01 + travel, law.hysteretic(bearing.z, travel)
        assert spring["stiffness"][0] * (x - spring["offset"][0]) == pytest.approx(law.force(x, z), rel=1e-10)


@pytest.mark.parametrize(
    "shape, frequency, start, bound", [("rectangular", 6.0, 0.3, 1e-4), ("one-cosine", 5.0, 0.0, 2e-3)]
)
def test_a_jump_of_the_ground_lifts_a_block_without_a_kick(shape, frequency, start, bound):
    """Standing under its weight alone it was kicked by the corner that lifts: peaks off by .01 and .13."""
    given = scene(0.2, duration=1.5, motion=PulseMotion(shape, JUMP, frequency, start))
    assert simulate(given).peak_tilt == pytest.approx(exact(given).peak_tilt, rel=bound)


def test_a_leaning_block_starts_as_it_is_given_whatever_the_ground_does():
    given = RELEASED.with_(motion=PulseMotion("rectangular", 4.0, 6.0))
    assert simulate(given).impacts[0].time == pytest.approx(exact(given).impacts[0].time, abs=2e-4)
    assert simulate(scene(0.2, motion=replace(given.motion, start=3.0))).outcome == "stands"


def test_e_does_not_hang_on_how_long_a_contact_is_left_to_settle():
    """In that time a damper takes from the base what the impact gave it: e of the fourth was read off by .023."""
    given = Scene(
        block=Block(mass=1441.73, radius=0.251352, slenderness=0.349489, corner_inertia=121.0244),
        base=Base(mass=109.722),
        bearings=Bearings(law="bouc-wen", count=4, ka=1806.4, kb=1011.87, alpha=480.623, damping=33319.5),
        motion=PulseMotion("one-sine", 7.1271, 42.08717),
        duration=2.0,
    )
    trace = trace_of(given)
    for settle in (0.5 * trace.settle, 2 * trace.settle):
        impacts = find_events(given, trace := replace(trace, settle=settle), find_swings(trace))[0][:4]
        assert 0.29 < min(abs(impact.rate_before) for impact in impacts)
        assert max(abs(ratio(impact) - restitution(given)) for impact in impacts) < 1e-3


# Two integrators: explicit steps through impacts, implicit ones while contact stays as it is.


@pytest.mark.parametrize("base", [None, 212.0])
def test_the_implicit_steps_change_no_impact_and_save_most_steps(base, monkeypatch):
    given = scene(0.2, base, 2.0, start=Start(tilt=0.12))
    both = simulate(given)
    monkeypatch.setattr("engines.exudyn.stepping.WORTHWHILE", math.inf)
    explicit = simulate(given)
    assert both.steps < 0.5 * explicit.steps and len(both.impacts) >= 2
    for impact, reference in zip(both.impacts[:3], explicit.impacts[:3], strict=True):
        assert impact.time == pytest.approx(reference.time, abs=1e-5)
        assert ratio(impact) == pytest.approx(ratio(reference), abs=3e-6)


def test_the_error_of_time_falls_with_the_square_of_the_implicit_step():
    """By the time of the first impact, on corners so stiff that the step alone counts."""
    given = scene(0.2, duration=2.5, start=Start(tilt=0.18))
    coarse, fine = (
        abs(simulate(given, stiffness=1e13, pivoting_step=step).impacts[0].time - exact(given).impacts[0].time)
        for step in (8e-3, 4e-3)
    )
    assert math.log2(coarse / fine) == pytest.approx(2.0, abs=0.3)


def test_where_newton_finds_no_end_the_explicit_steps_go_on(monkeypatch):
    from engines.exudyn import stepping

    usual, usual_settings = simulate(RELEASED).steps, stepping.solver_settings

    def hopeless(*arguments, **values):
        settings = usual_settings(*arguments, **values)
        settings.timeIntegration.newton.relativeTolerance = 1e-300
        return settings

    for name, value in (("solver_settings", hopeless), ("RESIDUAL", 1e-30), ("ROUNDING", 0.0)):
        monkeypatch.setattr(f"engines.exudyn.stepping.{name}", value)
    response = simulate(RELEASED)
    assert response.failure is None and response.steps > 2 * usual
    assert response.impacts[0].time == pytest.approx(exact(RELEASED).impacts[0].time, abs=2e-5)


def test_small_swings_on_the_stiff_corners_they_ask_for_are_stepped_implicitly():
    """Newton's differences must stay within a corner's depth, here 5e-10 m, and its end above rounding errors."""
    given = scene(0.2, duration=3.0, motion=PulseMotion("one-sine", 1.1 * 9.81 * math.tan(0.2), 20.0))
    response = simulate(given, stiffness=5e13)
    assert response.peak_tilt == pytest.approx(exact(given).peak_tilt, rel=0.02) and response.steps < 40_000


@pytest.mark.parametrize("name", ["caryatid-isolated", "free-rocking-isolated"])
def test_a_step_makes_at_most_ten_calls_of_python(name):
    calls = []
    sys.setprofile(lambda frame, event, argument: calls.append(None) if event == "call" else None)
    try:
        response = simulate(load_scene(name))
    finally:
        sys.setprofile(None)
    assert response.failure is None and len(calls) <= 10 * response.steps


# Coulomb's law.


@pytest.mark.parametrize("friction, slenderness, push, duration", [(0.2, 0.45, 0.3, 0.05), (0.31, 0.45, 0.3, 0.1)])
def test_a_block_that_slid_stays_where_it_came_to_rest(friction, slenderness, push, duration):
    """It was drawn back to where it had stood; the slip of a push of acceleration a for T: v T/2 + v^2/(2 mu g)."""
    motion = PulseMotion("rectangular", push * 9.81, 2 * math.pi / duration)
    trace = trace_of(scene(slenderness, friction=friction, duration=1.0, motion=motion))
    speed = max(push - friction, 0.0) * 9.81 * motion.end
    slip = 0.5 * speed * motion.end + speed**2 / (2 * friction * 9.81)
    assert -trace.centre[-1, 0] == pytest.approx(slip, rel=0.03, abs=1e-5)
    assert abs(trace.centre[-1, 2]) < max(1e-4 * speed, 1e-6)


def test_an_impact_that_slips_has_its_restitution():
    """Held viscously up to .1 m/s, as the corners were, e is off by .014."""
    mu = 0.9 * 0.381  # of the friction below which the impact of this block slips
    given = scene(0.5, friction=mu, duration=0.6, start=Start(tilt=0.15))
    fine, usual, coarse = (ratio(simulate(given, slip=slip).impacts[0]) for slip in (1e-3, 1e-2, 1e-1))
    assert abs(usual - fine) < 2e-3 < 1e-2 < abs(coarse - fine)


def test_the_anchor_of_a_block_in_the_air_goes_with_its_lower_corner():
    """Two corners as exudyn tells of them: without force, one lower than the other."""
    from engines.exudyn.scene import DISPLACEMENT, Anchor

    gaps, moved = {"left": (0.3, 0.2, 0.0), "right": (0.1, 0.05, 0.0)}, []
    system = SimpleNamespace(
        GetObjectOutput=lambda corner, kind: gaps[corner] if kind == DISPLACEMENT else (0.0, 0.0, 0.0),
        SetObjectParameter=lambda *given: moved.append(given),
    )
    Anchor(("left", "right"), 0.5, 1e6).commit(system)
    assert moved == [(corner, "offset", [0.1, 0.0, 0.0]) for corner in ("left", "right")]


# How runs end.


@pytest.mark.parametrize("factor, words", [(math.nan, "finite"), (0.0, "sank")])
def test_a_corner_that_does_not_carry_surfaces(monkeypatch, factor, words):
    from engines.exudyn.corners import Corner, Real

    force = Corner.force

    def wrong(self, *moved):
        return [part * Real(factor) for part in force(self, *moved)]

    monkeypatch.setattr(Corner, "force", wrong)
    response = simulate(RELEASED)
    assert response.outcome == "failed" and words in response.failure.reason


def test_newton_failure_surfaces_with_the_engines_message():
    response = simulate(RELEASED, variant="native-contact", stiffness=1e9, sphere=1e-3)
    assert response.outcome == "failed" and "Newton" in response.failure.message
    assert np.isfinite(response.failure.last_state.tilt)


def test_a_mismatch_with_the_engine_is_refused(monkeypatch):
    from engines.exudyn import stepping

    held = stepping.read_back
    monkeypatch.setattr(stepping, "read_back", lambda model: held(model) | {"block.mass": (6344.1, 3172.05)})
    with pytest.raises(Mismatch, match="block.mass is 6344.1 in exudyn, 3172.05 in the scene"):
        simulate(RELEASED)


def test_run_of_too_many_steps_ends_with_its_evidence(monkeypatch):
    monkeypatch.setattr("engines.exudyn.stepping.STEPS_PER_PERIOD", 200)
    response = simulate(RELEASED)
    assert response.outcome == "failed" and "too many steps" in response.failure.reason
    assert "of 1 s" in response.failure.message and response.steps <= 200 * 3


@pytest.mark.parametrize("variant", VARIANTS)
def test_interrupt_ends_the_run_within_a_second_and_is_no_failure(variant):
    simulate(RELEASED.with_(duration=0.01), variant=variant)  # compiled
    sent, outside = [], signal.signal(signal.SIGINT, signal.default_int_handler)  # a job in the background ignores it

    def interrupt():
        sent.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    threading.Timer(0.5, interrupt).start()
    try:
        with pytest.raises(KeyboardInterrupt):
            simulate(RELEASED.with_(duration=1e4), variant=variant)
        assert time.monotonic() - sent[0] < 1.0
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    finally:
        signal.signal(signal.SIGINT, outside)


@pytest.mark.long
@pytest.mark.parametrize("variant, settings", [("native-contact", {"step": 1e-4}), ("compliant-corners", {})])
def test_memory_does_not_grow_with_the_number_of_runs(variant, settings):
    """exudyn keeps a system alive that has a user function: its steps (400 bytes each) and the ground's segments."""
    motion = SampledMotion(1e-4, 0.5 * np.sin(8e-4 * np.arange(10_001)))  # as many samples as steps
    given, used = scene(0.28, 212.0, 1.0, bearings=BEARINGS, motion=motion), []
    for _ in range(8):
        response = simulate(given, variant=variant, history=False, **settings)
        gc.collect()
        used.append(psutil.Process().memory_info().rss)
    assert response.outcome == "stands" and response.steps > 9_000
    assert (used[-1] - used[2]) / 5 < 50 * response.steps  # bytes kept of each run
