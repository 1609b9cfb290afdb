"""Engines that build a statue on a free pedestal, against the analytic model; and those that fail, or do not build it."""

import math

import numpy as np
import pytest

from analytic import Base, Bearings, Block, Pedestal, PulseMotion, Scene, SceneError, Start, simulate
from analytic.stack.equations import StackModel
from analytic.stack.run import simulate_stack
from engines import ENGINES, get_engine, installed_engines
from engines.comparison import Reference, compare
from engines.contract import Run
from engines.loads import placements
from engines.loop import FixedStep
from engines.stack import Pair, observe_stack, release, run_of_stack

BUST = Block(mass=120.0, radius=math.hypot(0.125, 0.35), slenderness=math.atan2(0.125, 0.35))
STACK = Scene(block=BUST, pedestal=Pedestal(width=0.4, mass=430.0, height=1.0, free=True), duration=1.0)
SOFT = {"base": Base(mass=60.0), "bearings": Bearings(ka=4e4, kb=4e3, alpha=44.69, damping=500.0)}


def shaken(share, hertz, **parts):
    return STACK.with_(duration=4.0, motion=PulseMotion("one-sine", share * 9.81, 2 * math.pi * hertz), **parts)


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
TUNED = pytest.mark.parametrize("engine, variant", ERRORS)
BOTH = pytest.mark.parametrize("engine", ["mujoco", "pybullet"])


def landings(response):
    """Return (time, block) in order of time."""
    each = enumerate([response.stack.impacts, response.impacts])
    return np.array(sorted((impact.time, k) for k, impacts in each for impact in impacts))


def tilts(response, times):
    """Return the absolute tilts of pedestal and statue at these times, shape (2, n)."""
    history = response.history
    both = history.pedestal_tilt, history.pedestal_tilt + history.tilt
    return np.array([np.interp(times, history.time, tilt) for tilt in both])


@TUNED
@pytest.mark.parametrize("name", SCENES)
def test_three_impacts_and_the_tilts_up_to_them_are_the_models(engine, variant, name):
    scene, tilt = SCENES[name]
    run, model = release(get_engine(engine), scene, tilt, variant=variant), simulate_stack(scene, pedestal_tilt=tilt)
    found, expected = landings(run)[:3], landings(model)[:3]
    times = np.linspace(0.0, expected[-1, 0], 400)
    time, *tilted = ERRORS[engine, variant]
    assert found[:, 0] == pytest.approx(expected[:, 0], abs=time) and (found[:, 1] == expected[:, 1]).all()
    assert (np.abs(tilts(run, times) - tilts(model, times)).max(axis=1) <= tilted).all()
    assert run.outcome == model.outcome == "rocks" and run.stack.rocked == model.stack.rocked


@TUNED
def test_the_mirrored_scene_has_the_mirrored_run(engine, variant):
    scene, tilt = SCENES["opposite"]
    run = release(get_engine(engine), scene, tilt, variant=variant)
    other = release(get_engine(engine), scene.with_(start=Start(tilt=-scene.start.tilt)), -tilt, variant=variant)
    times = run.history.time
    assert tilts(other, times) == pytest.approx(-tilts(run, times), abs=1e-8)  # the contact solver's residual
    assert other.impact_count == run.impact_count and other.stack.peak_tilt == pytest.approx(run.stack.peak_tilt)


@BOTH
@pytest.mark.parametrize(
    "scene, outcome",
    [
        (shaken(0.34, 1.5), "rocks"),
        (shaken(0.3735, 1.5), "rocks"),
        (shaken(0.377, 1.5), "overturns"),
        (shaken(1.2, 1.2), "pedestal overturns"),
        (shaken(0.6, 1.5, **SOFT), "rocks"),
        (shaken(1.0, 1.5, **SOFT), "overturns"),
    ],
)
def test_the_block_that_falls_and_all_that_is_compared_are_the_models(engine, scene, outcome):
    run = get_engine(engine).simulate(scene)
    assert (run.outcome, run.comparable, run.differences) == (outcome, "yes", ()) and run.decided
    whole = get_engine(engine).simulate(scene.with_(duration=None), compare=False)
    assert whole.outcome == outcome and whole.decided and whole.history.pedestal_tilt is not None


def test_a_run_near_a_boundary_or_beyond_the_model_says_so_and_defaults_differ():
    low, high = 0.3735, 0.377
    while high - low > 1e-6:
        middle = 0.5 * (low + high)
        falls = simulate(shaken(middle, 1.5), history=False).outcome == "overturns"
        low, high = (low, middle) if falls else (middle, high)
    near = Reference.of(shaken(low, 1.5))
    assert near.comparable == "on an edge" and "outcome" in near.near
    assert Reference.of(shaken(1.9, 2.0)).comparable.startswith("the analytic model fails: outside the model: ")
    plain = get_engine("pybullet").simulate(shaken(0.42, 1.5), variant="first-script")
    assert plain.differences[0].quantity == "outcome" and plain.differences[0].model == "overturns"


@pytest.mark.parametrize("engine", sorted({*installed_engines()} - {"mujoco", "pybullet"}))
def test_other_engines_refuse_it_and_name_those_that_build_it(engine):
    with pytest.raises(SceneError, match=f"pedestal.free = True: not known to {engine}.*pybullet, mujoco"):
        ENGINES[engine].simulate(STACK)


class Standing:
    """Bodies that stand, but for what the function `wrong` of the time returns for both blocks."""

    def __init__(self, wrong):
        self.time, self.wrong, self.weigh = 0.0, wrong, None

    def step(self, step, *loads):
        self.time += step
        return *self.wrong(self.time), 0.0, 0.0


LIES = {
    "the state is no longer finite": lambda t: [0.0] * 7 + [math.nan if t > 0.5 else 0.0] + [0.0] * 4,
    "the run gained energy": lambda t: [0.0] * 10 + [9.0 * t, 0.0],
    "the statue has left its place": lambda t: [0.0] * 8 + [0.1 * t] + [0.0] * 3,
    "the pedestal has left its place": lambda t: [0.0] * 3 + [-0.1 * t] + [0.0] * 8,
}


@pytest.mark.parametrize("reason", LIES)
def test_bodies_that_lie_have_failed(reason):
    run = run_of_stack(STACK, FixedStep(1e-3), lambda step: Standing(LIES[reason]), 0.0, 1e-3, 0.0)
    labels = dict(engine="a fake", variant="", cpu_seconds=0.0, steps=0, settings={}, versions={}, warnings=())
    response = observe_stack(STACK, run, **labels)
    assert response.outcome == "failed" and response.failure.reason == reason and not response.decided
    assert compare(STACK, response).comparable == "no"


def test_a_run_that_ends_early_or_is_no_stack_has_failed():
    run = run_of_stack(STACK, FixedStep(1e-3), lambda step: Standing(lambda t: [0.0] * 12), 0.0, 1e-3, 0.0)
    labels = dict(engine="a fake", variant="", cpu_seconds=0.0, steps=0, settings={}, versions={}, warnings=())
    assert observe_stack(STACK, run, **labels).outcome == "stands"
    assert observe_stack(STACK.with_(duration=2.0), run, **labels).failure.reason == "the run ended early"
    with pytest.raises(TypeError, match="no engines.stack.StackTrace"):
        observe_stack(STACK, Run(run.trace.pedestal, 1, 0.0), **labels)


@pytest.mark.parametrize("engine, part", [("mujoco", "_body"), ("pybullet", "without_losses")])
def test_an_engine_that_holds_other_values_has_failed(monkeypatch, engine, part):
    adapter = get_engine(engine).load()
    true = getattr(adapter, part)
    heavier = {"_body": lambda slab, *rest: true(type(slab)(1.01 * slab.mass, slab.inertia, slab.b, slab.h), *rest)}
    monkeypatch.setattr(adapter, part, heavier.get(part, lambda *given, **limits: None))
    response = get_engine(engine).simulate(STACK)
    assert response.failure.reason == "the engine does not hold the scene"


def test_gaps_and_closing_speeds_are_those_of_the_corners():
    one, two = StackModel.of(STACK).slabs

    def heights(state):
        """Return the heights of the four corners, those of the block along the normal of the pedestal's top."""
        first, x1, z1, second, x2, z2 = state
        turn, other = np.exp(-1j * first), np.exp(-1j * second)
        centre, upper = x1 + 1j * (z1 + one.h), x2 + 1j * (z2 + 2 * one.h + two.h)
        lower = [(centre + turn * complex(x, -one.h)).imag for x in (one.b, -one.b)]
        top = [(upper + other * complex(x, -two.h) - centre - 1j * one.h * turn) / turn for x in (two.b, -two.b)]
        return np.array([*lower, *(corner.imag for corner in top)])

    now, rates = np.array([0.13, 0.02, 0.03, -0.07, 0.01, 0.05]), np.array([0.7, -0.2, 0.4, -1.1, 0.3, -0.6])
    pair = Pair(Standing(None), STACK, 0.0)
    pair.now = [part for k in (0, 3) for part in (now[k], rates[k], *now[k + 1 : k + 3], *rates[k + 1 : k + 3])]
    gaps, closing = np.array(pair.corners()).T
    assert gaps == pytest.approx(heights(now), abs=1e-14)
    assert -closing == pytest.approx((heights(now + 1e-6 * rates) - heights(now - 1e-6 * rates)) / 2e-6, abs=1e-8)
    for tilt, psi in ((0.15, 0.05), (0.1, -0.08), (-0.08, 0.0)):
        start = placements(STACK.with_(start=Start(tilt=psi)), tilt)
        (x1, z1, first), (x2, z2, second) = ([pair[0] for pair in body] for body in start)
        down = np.sort(heights([first, x1, z1, second, x2, z2]).reshape(2, 2), axis=1)
        assert down[:, 0] == pytest.approx(0.0, abs=1e-15) and (down[:, 1] > -1e-15).all()
