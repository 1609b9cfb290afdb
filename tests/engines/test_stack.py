"""Engines that build a statue on a free pedestal against the analytic model, those that fail, those that refuse."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from analytic import Base, Bearings, Block, Pedestal, PulseMotion, Scene, SceneError, Start, simulate
from analytic.solver import simulate_stack
from engines import ENGINES, get_engine, installed_engines
from engines.comparison import Reference
from engines.contract import Run
from engines.loop import FixedStep, Pair, run_of
from engines.stack import observe_stack, release

BUST = Block(mass=120.0, radius=math.hypot(0.125, 0.35), slenderness=math.atan2(0.125, 0.35))
STACK = Scene(block=BUST, pedestal=Pedestal(width=0.4, mass=430.0, height=1.0, free=True), duration=1.0)
SOFT = {"base": Base(mass=60.0), "bearings": Bearings(ka=4e4, kb=4e3, alpha=44.69, damping=500.0)}


def shaken(share, hertz, **parts):
    return STACK.with_(duration=2.2, motion=PulseMotion("one-sine", share * 9.81, 2 * math.pi * hertz), **parts)


# {name: (scene, tilt of the pedestal at the start)}
SCENES = {
    "same side": (STACK.with_(start=Start(tilt=0.05)), 0.15),
    "opposite": (STACK.with_(start=Start(tilt=-0.08)), 0.1),
    "joined": (STACK, 0.08),
    "pulse": (shaken(0.32, 1.5).with_(duration=1.3), 0.0),
}
# Twice the largest errors of the first three impacts' times [s], and up to the third of the tilts of pedestal and
# statue [rad], that were measured.
ERRORS = {
    ("mujoco", "impact-aware"): (2.2e-5, 2.2e-5, 1.3e-4),
    ("mujoco", "fixed-step"): (2.4e-4, 8.7e-5, 3.7e-4),
    ("pybullet", "impact-aware"): (2.3e-5, 3.1e-5, 1.6e-4),
    ("pybullet", "fixed-step"): (6.3e-4, 4e-4, 1.4e-3),
}
BOTH = pytest.mark.parametrize("engine", ["mujoco", "pybullet"])


def landings(response):
    """Return (time, block, rates before and after) in order of time."""
    each = ((k, impact) for k, impacts in enumerate([response.stack.impacts, response.impacts]) for impact in impacts)
    return np.array(sorted((impact.time, k, impact.rate_before, impact.rate_after) for k, impact in each))


def tilts(response, times):
    """Return the absolute tilts of pedestal and statue at these times, shape (2, n)."""
    time, pedestal, block = (getattr(response.history, name) for name in ("time", "pedestal_tilt", "tilt"))
    return np.array([np.interp(times, time, tilt) for tilt in (pedestal, pedestal + block)])


@pytest.mark.parametrize("engine, variant", ERRORS)
@pytest.mark.parametrize("name", SCENES)
def test_three_impacts_and_the_tilts_up_to_them_are_the_models(engine, variant, name):
    scene, tilt = SCENES[name]
    run, model = release(get_engine(engine), scene, tilt, variant=variant), simulate_stack(scene, pedestal_tilt=tilt)
    found, expected = landings(run)[:3], landings(model)[:3]
    times = np.linspace(0.0, expected[-1, 0], 400)
    time, *tilted = ERRORS[engine, variant]
    assert found[:, 0] == pytest.approx(expected[:, 0], abs=time) and (found[:, 1] == expected[:, 1]).all()
    assert variant == "fixed-step" or found[:, 2:] == pytest.approx(expected[:, 2:], abs=2.4e-4)  # rad/s, likewise
    assert (np.abs(tilts(run, times) - tilts(model, times)).max(axis=1) <= tilted).all()
    assert run.outcome == model.outcome == "rocks" and run.stack.rocked == model.stack.rocked


@BOTH
def test_the_mirrored_scene_has_the_mirrored_run(engine):
    scene, tilt = SCENES["opposite"]
    run = release(get_engine(engine), scene, tilt)
    other = release(get_engine(engine), scene.with_(start=Start(tilt=-scene.start.tilt)), -tilt)
    times = run.history.time
    assert tilts(other, times) == pytest.approx(-tilts(run, times), abs=1e-8)  # the contact solver's residual


@BOTH
@pytest.mark.parametrize(
    "scene, outcome",
    [
        (shaken(0.3735, 1.5), "rocks"),
        (shaken(0.377, 1.5), "overturns"),
        (shaken(1.2, 1.2), "pedestal overturns"),
        (shaken(0.8, 1.5, **SOFT), "rocks"),
        (shaken(0.9, 1.5, **SOFT), "overturns"),
    ],
)
def test_who_falls_and_all_that_is_compared_are_the_models(engine, scene, outcome):
    run, model = get_engine(engine).simulate(scene), simulate(scene, history=False)
    assert (run.outcome, run.comparable, run.differences) == (outcome, "yes", ())
    assert run.decided == model.decided and run.history.pedestal_tilt is not None


@BOTH
def test_a_run_without_a_duration_goes_on_until_its_outcome_is_decided(engine):
    run = get_engine(engine).simulate(shaken(0.34, 1.5).with_(duration=None), compare=False)
    assert run.outcome == "rocks" and run.decided and run.end.time > 4.0


def test_a_run_near_a_boundary_or_beyond_the_model_says_so_and_defaults_differ():
    near = Reference.of(shaken(0.37648, 1.5).with_(duration=4.0))  # falls from 0.376474 g on
    assert near.comparable == "on an edge" and "outcome" in near.near and near.model.outcome == "overturns"
    assert Reference.of(shaken(1.9, 2.0)).comparable.startswith("the analytic model fails: outside the model: ")
    plain = get_engine("pybullet").simulate(shaken(0.42, 1.5), variant="first-script")
    assert plain.differences[0].quantity == "outcome" and plain.differences[0].model == "overturns"


@pytest.mark.parametrize("engine", sorted({*installed_engines()} - {"mujoco", "pybullet"}))
def test_other_engines_refuse_it_and_name_those_that_build_it(engine):
    with pytest.raises(SceneError, match=f"pedestal.free = True: not supported by {engine}.*pybullet, mujoco"):
        ENGINES[engine].simulate(STACK)


STILL = [0.0] * 12  # tilt, rate, x, z, x', z' of the pedestal, and of the block
LIES = {
    "the state is no longer finite": [*STILL[:7], math.nan, *STILL[8:]],
    "the run gained energy": [*STILL[:10], 9.0, 0.0],
    "the statue has left its place": [*STILL[:8], 0.1, *STILL[9:]],
    "the pedestal has left its place": [*STILL[:3], -0.1, *STILL[4:]],
}
FAKE = dict(engine="a fake", variant="", cpu_seconds=0.0, steps=0, settings={}, versions={}, warnings=())


def run_of_lies(state):
    bodies = SimpleNamespace(step=lambda *loads: [*state, 0.0, 0.0], weigh=None)
    return run_of(STACK, FixedStep(1e-3), lambda step: bodies, None)


@pytest.mark.parametrize("reason", LIES)
def test_bodies_that_lie_have_failed(reason):
    response = observe_stack(STACK, run_of_lies(LIES[reason]), **FAKE)
    assert response.outcome == "failed" and response.failure.reason == reason and not response.decided


def test_a_run_that_ends_early_has_failed_and_one_that_is_no_stack_is_an_error():
    run = run_of_lies(STILL)
    assert observe_stack(STACK, run, **FAKE).outcome == "stands"
    assert observe_stack(STACK.with_(duration=2.0), run, **FAKE).failure.reason == "the run ended early"
    with pytest.raises(TypeError, match="no engines.swings.StackTrace"):
        observe_stack(STACK, Run(run.trace.pedestal, 1, 0.0), **FAKE)


@pytest.mark.parametrize("engine, part", [("mujoco", "_body"), ("pybullet", "without_losses")])
def test_an_engine_that_holds_other_values_has_failed(monkeypatch, engine, part):
    adapter = get_engine(engine).load()
    true = getattr(adapter, part)
    heavier = {"_body": lambda slab, *rest: true(type(slab)(1.01 * slab.mass, slab.inertia, slab.b, slab.h), *rest)}
    monkeypatch.setattr(adapter, part, heavier.get(part, lambda *given, **limits: None))
    response = get_engine(engine).simulate(STACK)
    assert response.failure.reason == "the engine does not hold the scene"


@pytest.mark.parametrize("scene, tilt", list(SCENES.values())[:3])
def test_gaps_and_closing_speeds_are_those_of_the_corners(scene, tilt):
    pair = Pair(SimpleNamespace(weigh=None), scene, tilt)
    gaps = np.array(pair.corners())[:, 0].reshape(2, 2)
    widths = [2 * slab.b * math.sin(abs(each)) for slab, each in zip(pair.slabs, (tilt, scene.start.tilt), strict=True)]
    assert np.sort(gaps) == pytest.approx(np.column_stack([[0.0, 0.0], widths]), abs=1e-15)
    state, speeds = np.array(pair.now).reshape(2, 6), np.random.default_rng(1).normal(size=(2, 3))
    state[:, [1, 4, 5]] = speeds

    def moved(time):
        pair.now = (state + time * np.insert(speeds, [1, 3, 3], 0.0, axis=1)).ravel().tolist()
        return np.array(pair.corners()).T

    assert -moved(0.0)[1] == pytest.approx((moved(1e-6) - moved(-1e-6))[0] / 2e-6, abs=1e-8)
