"""Runs of a stack against one block, Moreau's time stepping, stored answers, energy, and the mirror."""

import itertools
import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from stack_scenes import FIGURE, GRAVITY, PLINTH, SIX, SOFT, STACK, rectangle

import analytic.stack.run as run
from analytic import Block, Pedestal, PulseMotion, Response, Scene, SceneError, Start, simulate, simulate_many
from analytic.checks.time_stepping import simulate_time_stepping
from analytic.checks.twin import simulate_twin
from analytic.checks.two_bodies import simulate_two_bodies
from analytic.scene import BASE, BEARINGS, problem_a, problem_b
from analytic.solver import parameters, simulate_stack
from engines import ENGINES

ANSWERS = json.loads((Path(__file__).parent / "answers.json").read_text(encoding="utf-8"))
COUNTED = 6  # impacts stored of each scene


def fixed(scene):
    return scene.with_(pedestal={"free": False})


def sine(share, hertz):
    return PulseMotion("one-sine", share * GRAVITY, 2 * math.pi * hertz)


def landings(response):
    """Return (time, interface) in order of time."""
    each = [response.stack.impacts, response.impacts]
    return sorted((impact.time, k) for k, impacts in enumerate(each) for impact in impacts)


def numbers(response):
    """Return peaks of pedestal, statue and base, and the end: statue, rate, base, pedestal."""
    peaks = response.stack.peak_tilt, response.peak_tilt, response.peak_base_displacement
    end = response.end.tilt, response.end.tilt_rate, response.end.base_displacement
    return [*peaks, *end, response.history.pedestal_tilt[-1]]


@pytest.mark.parametrize("name", SIX)
def test_the_six_scenes_have_their_stored_answers(name):
    scene, tilt = SIX[name]
    response, answer = simulate_stack(scene, pedestal_tilt=tilt), ANSWERS[name]
    assert np.array(landings(response)[:COUNTED]) == pytest.approx(np.array(answer["impacts"]), abs=1e-8)
    assert numbers(response) == pytest.approx(answer["numbers"], abs=1e-8)


@pytest.mark.parametrize("name", SIX)
def test_moreaus_steps_tend_to_them_in_first_order(name):
    scene, tilt = SIX[name]
    history, errors = simulate_stack(scene, pedestal_tilt=tilt).history, []
    for step in (1e-4, 1e-5):
        two = simulate_two_bodies(fixed(scene), step=step, lower_tilt=tilt)
        pairs = (two.lower, history.pedestal_tilt), (two.upper - two.lower, history.tilt)
        errors.append(max(np.abs(np.interp(history.time, two.time, got) - want).max() for got, want in pairs))
    assert errors[1] < errors[0] / 4 and errors[1] < 1e-4


@pytest.mark.parametrize("problem", [problem_a(), problem_b(), problem_b().with_(base=BASE, bearings=BEARINGS)])
def test_on_a_wide_and_heavy_pedestal_the_statue_is_one_block(problem):
    """On a base a wide pedestal is part of it."""
    heavy = Pedestal(width=60.0, mass=200.0 if problem.base else 1e9, height=0.1)
    one = simulate(problem.with_(pedestal=heavy), tolerance=1e-14)
    two = simulate(problem.with_(pedestal=heavy.model_copy(update={"free": True})))
    assert two.stack.rocked == ("statue",) and one.impacts and two.outcome == one.outcome
    pairs = list(zip(one.impacts, two.impacts, strict=False))[:9]
    assert max(abs(a.time - b.time) for a, b in pairs) < 2e-11
    assert two.peak_tilt == pytest.approx(one.peak_tilt, abs=1e-11)
    assert two.peak_base_displacement == pytest.approx(one.peak_base_displacement, abs=1e-11)


def test_with_a_light_statue_the_pedestal_is_one_block_in_the_limit():
    alone = Scene(block=rectangle(PLINTH.width, PLINTH.height, PLINTH.mass), motion=sine(0.9, 1.5), duration=2.0)
    times, errors = [impact.time for impact in simulate(alone).impacts[:2]], []
    for mass in (1e-3, 1e-4):
        block = rectangle(0.2, 0.1, mass)  # stocky: it stays down
        light = simulate(STACK.with_(block=block, motion=alone.motion, duration=2.0))
        errors.append(max(abs(impact.time - t) for impact, t in zip(light.stack.impacts, times, strict=False)))
    assert 8 < errors[0] / errors[1] < 12 and errors[1] < 1e-5


def test_halves_that_stay_together_are_one_block():
    lower, upper = Pedestal(width=0.4, mass=300.0, height=0.2, free=True), rectangle(0.4, 0.8, 1200.0)
    whole = Scene(block=rectangle(0.4, 1.0, 1500.0), start=Start(tilt=0.1), duration=2.0)
    one = simulate(whole)
    two = simulate_stack(Scene(block=upper, pedestal=lower, duration=one.impacts[0].time + 1e-3), pedestal_tilt=0.1)
    before = two.history.time < one.impacts[0].time
    assert two.stack.impacts[0].time == pytest.approx(one.impacts[0].time, abs=1e-12)
    assert two.stack.impacts[0].rate_before == pytest.approx(one.impacts[0].rate_before, abs=1e-12)
    assert not two.history.tilt[before].any() and before.sum() > 20


def test_a_massless_pedestal_is_a_foot_of_the_statue():
    """Until it lands; after that it tends to a limit, in which the pedestal is a link."""
    statue, foot = rectangle(0.4, 0.5, 200.0), {"width": 0.4, "height": 0.5, "free": True}
    b, h = 0.2, 0.75  # from the corner on the ground to the centre of the statue
    inertia = statue.centre_inertia + 200.0 * (b * b + h * h)
    whole = Block(mass=200.0, radius=math.hypot(b, h), slenderness=math.atan2(b, h), corner_inertia=inertia)
    one, errors, ends = simulate(Scene(block=whole, start=Start(tilt=0.1), duration=1.0)).impacts[0], [], []
    for mass in (1e-2, 1e-3, 1e-4):
        scene = Scene(block=statue, pedestal=Pedestal(mass=mass, **foot), duration=1.0)
        two = simulate_stack(scene, pedestal_tilt=0.1)
        landing = two.stack.impacts[0]
        errors.append(max(abs(landing.time - one.time), abs(landing.rate_before - one.rate_before)))
        ends.append(np.array(numbers(two)))
    assert errors[0] > 9 * errors[1] > 80 * errors[2] and errors[2] < 1e-6
    steps = [np.abs(after - before).max() for before, after in itertools.pairwise(ends)]
    assert steps[0] > 8 * steps[1] and steps[1] < 1e-4


@pytest.mark.parametrize("name", ("leaning", "opposite", "joined"))
def test_free_it_loses_energy_at_impacts_alone(name, monkeypatch):
    energies, land = [], run.Run.land

    def watched(self, k):
        energies.append(self.remaining_energy())
        land(self, k)
        energies.append(self.remaining_energy())

    monkeypatch.setattr(run.Run, "land", watched)
    scene, tilt = SIX[name]
    first = run.Run(scene, parameters(fixed(scene)), False, tilt).remaining_energy()
    simulate_stack(scene, pedestal_tilt=tilt)
    before, after = np.array([first, *energies[:-1]]).reshape(-1, 2).T, np.array(energies).reshape(-1, 2)
    assert np.abs(before[1] - before[0]).max() < 1e-12 * first and (after[:, 1] < after[:, 0]).all()
    assert len(after) > 20


@pytest.mark.parametrize("name", ("jolt", "soft base", "record"))
def test_mirrored_it_is_the_same(name):
    scene, _ = SIX[name]
    mirrored = replace(scene.motion.scaled(-1.0), vertical=scene.motion.vertical)
    one, two = simulate(scene), simulate(scene.with_(motion=mirrored))
    assert np.array(landings(one)) == pytest.approx(np.array(landings(two)), abs=1e-10)
    assert [one.end.tilt, one.peak_tilt] == pytest.approx([-two.end.tilt, two.peak_tilt], abs=1e-11)


def test_where_bounces_end_does_not_matter(monkeypatch):
    scene, tilt = SIX["leaning"]
    runs, counts = [], []
    for rest in (1e-8, run.REST, 1e-12):
        monkeypatch.setattr(run, "REST", rest)
        response = simulate_stack(scene.with_(duration=2.0), pedestal_tilt=tilt)
        runs.append(
            [response.peak_tilt, response.stack.peak_tilt, *(impact.rate_after for impact in response.impacts)][:8]
        )
        counts.append(len(response.stack.impacts))
    assert counts[0] < counts[1] < counts[2]
    assert runs[1] == pytest.approx(runs[2], abs=1e-11) and runs[0] == pytest.approx(runs[2], abs=1e-8)


@pytest.mark.slow
def test_without_a_duration_it_ends_when_nothing_can_grow():
    for scene in (STACK.with_(motion=sine(0.35, 1.5)), STACK.with_(motion=sine(0.2, 1.0)), SIX["soft base"][0]):
        open_end = simulate(scene.with_(duration=None))
        longer = simulate(scene.with_(duration=open_end.end.time + 3))
        assert open_end.decided and longer.decided and longer.outcome == open_end.outcome
        for name in ("peak_tilt", "peak_base_displacement"):
            assert getattr(longer, name) <= getattr(open_end, name) * (1 + 1e-4)
        assert longer.stack.peak_tilt == open_end.stack.peak_tilt


FLAT = Scene(  # a flat, light pedestal under a heavy statue
    block=rectangle(0.58, 1.47, 747.0),
    pedestal=Pedestal(width=0.6875854, mass=513.617937, height=0.40236768, free=True),
    motion=sine(3.1433, 1.2867),
    **SOFT,
)


@pytest.mark.parametrize(
    "scene, outcome, reason",
    [
        (STACK.with_(motion=sine(0.2, 1.5)), "stands", None),
        (STACK.with_(motion=sine(0.7, 1.2)), "overturns", None),
        (STACK.with_(motion=sine(0.7, 1.2), pedestal={"width": 0.3, "height": 2.0}), "pedestal overturns", None),
        (STACK.with_(motion=sine(2.5, 1.2)), "failed", "outside the model: contact is lost"),
        (FLAT, "failed", "outside the model: the pivot would jump"),
    ],
)
def test_what_came_of_it(scene, outcome, reason):
    response = simulate(scene.with_(duration=4.0))
    assert response.outcome == outcome and (response.failure and response.failure.reason) == reason
    fallen = {"overturns": abs(response.end.tilt), "pedestal overturns": response.stack.peak_tilt}.get(outcome)
    assert fallen is None or fallen == pytest.approx(math.pi / 2, abs=1e-12)
    assert (response.overturning_time is None) == (response.fall_time is None) == (fallen is None)
    assert fallen is None or response.fall_time < response.overturning_time == response.end.time


def test_its_response_is_one_like_any_other():
    response = simulate(SIX["soft base"][0])
    again = Response.from_json(json.loads(json.dumps(response.to_json())))
    assert again.stack == response.stack and again.impacts == response.impacts and again.outcome == response.outcome
    assert response.history.columns[-1] == "pedestal_tilt" and simulate(SIX["jolt"][0], history=False).history is None
    assert response.friction_demand > 0 < response.stack.friction_demand and response.stack.impulses[1] > 0


def test_what_does_not_know_a_free_pedestal_refuses_it():
    others = [
        lambda scene: simulate_many([scene]),
        simulate_twin,
        lambda scene: simulate_two_bodies(scene, step=1e-3),
        lambda scene: simulate_time_stepping(scene, step=1e-3),
        ENGINES["exudyn"].simulate,
    ]
    for other in others:
        with pytest.raises(SceneError, match=r"pedestal\.free = True: not supported by"):
            other(STACK)
    # a fixed pedestal has the digest that stored results have
    assert fixed(STACK).digest()[:16] == "efe0bce57c2485ee" != STACK.digest()[:16]


@pytest.mark.parametrize(
    "key, change",
    [
        ("friction", {"friction": 0.5}),
        ("block.restitution", {"block": {"restitution": 0.9}}),
        ("start.tilt_rate", {"start": {"tilt_rate": 0.1}}),
        ("start.base_velocity", {"start": {"base_velocity": 0.1}, **SOFT}),
    ],
)
def test_what_a_stack_does_not_take_is_refused(key, change):
    with pytest.raises(SceneError, match="free") as error:
        STACK.with_(**change)
    assert error.value.key == key
    with pytest.raises(SceneError, match=r"pedestal\.mass: missing; a free pedestal needs"):
        Pedestal(width=FIGURE.radius, free=True)
