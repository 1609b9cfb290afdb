"""Every exercise's answer, found on another way than the lesson finds it."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scripts import run_alone, written

from analytic import PulseMotion, Scene, load_scene, simulate, synthetic_motion
from analytic.checks.closed_form import swing_energy
from analytic.checks.twin import simulate_twin
from analytic.checks.two_bodies import simulate_two_bodies
from analytic.rocking import RockingModel, restitution
from analytic.scene import BASE, BEARINGS, MASS, RADIUS, caryatid_block
from comparisons.execution.results import RESULTS
from comparisons.lessons import lesson as engine_runs
from comparisons.lessons.notebook import answer
from comparisons.lessons.topics import bearing, caryatid, chaos, checks, corner, cost, impacts, lessons, tipping
from comparisons.studies.rows import read_study


def test_every_exercise_is_tried_here():
    """A new exercise needs a line of its own in this file."""
    source = Path(__file__).read_text()
    answers = [exercise.compute for lesson in lessons() for exercise in lesson.exercises]
    names = [f"{answer.__module__.rpartition('.')[2]}.{answer.__name__}" for answer in answers]
    assert [name for name in names if name not in source] == []


E = 1 - 1.5 * math.sin(0.28) ** 2  # eq. (7) of a rectangle on rigid ground
H, B, INERTIA = RADIUS * math.cos(0.28), RADIUS * math.sin(0.28), 4 / 3 * MASS * RADIUS**2
# Horizontal momentum, and angular about the new corner, of an impact at 1 rad/s: two equations, solved as such.
JUMP = np.linalg.solve([[MASS * H, MASS + BASE.mass], [INERTIA, MASS * H]], [MASS * H, INERTIA - 2 * MASS * B**2])[1]
SWINGS = math.log(swing_energy(0.28, 0.1 * 0.28) / swing_energy(0.28, 0.8 * 0.28)) / (2 * math.log(E))
MEASURED = math.log(swing_energy(0.28, 0.1 * 0.28) / swing_energy(0.28, 0.168)) / (2 * math.log(0.8))
F0, ALPHA = bearing.LAW.f0, BEARINGS.alpha
LOSS = 4 * F0 * 0.30 - 2 * (BEARINGS.ka - BEARINGS.kb) / ((ALPHA - 1) * (ALPHA - 2))
TOO_LONG = RADIUS * math.cos(0.28) - 1  # in metres: the factor of eq. (8) as printed
BEHIND = (0.4 - 0.2) * 9.81 * 0.5  # m/s, by which a block on friction .2 lags after half a second of .4 g
LOSSY = 1 - restitution(Scene(block=caryatid_block(0.28), base=BASE))


@pytest.mark.parametrize(
    "answer, known, near",
    [
        (tipping.lifting_acceleration, 0.3 / 1.0, {"rel": 1e-12}),
        (tipping.slip_of_a_push, BEHIND * 0.5 / 2 + BEHIND**2 / (2 * 0.2 * 9.81), {"rel": 1e-9}),
        (impacts.code, E, {"rel": 1e-9}),
        (impacts.swings_to_a_tenth, math.ceil(SWINGS), {"abs": 0}),
        (impacts.with_a_material, E, {"rel": 1e-12}),
        (impacts.swings_of_the_measured, math.ceil(MEASURED), {"abs": 0}),
        (impacts.no_rocking_on, math.asin(math.sqrt(2 / 3)), {"rel": 1e-12}),
        (impacts.momentum_on_the_base, JUMP, {"rel": 1e-12}),
        (bearing.code, LOSS, {"rel": 1e-5}),
        # the force on the limit curve
        (bearing.secant_period, math.pi * math.sqrt((MASS + 212) * 0.30 / (BEARINGS.kb * 0.30 + F0)), {"rel": 1e-4}),
        (bearing.usual_damping, 15, {"rel": 1e-3}),
        (bearing.misprinted_jump, 2 * F0, {"rel": 1e-3}),
        (corner.code, 0.5 * 4.5, {"rel": 0.166}),  # half a step, of 4 to 5 ms
        (corner.order, 1.0, {"abs": 0.15}),
        (checks.misprint_factor, 100 * TOO_LONG, {"rel": 1e-9}),
        (checks.code, 100 * TOO_LONG * LOSSY, {"rel": 1e-9}),
        (checks.observed_order, 1.0, {"abs": 0.15}),
        (checks.mirror_defect, 0.0, {"abs": 0}),
    ],
)
def test_a_closed_form(answer, known, near):
    assert answer() == pytest.approx(known, **near)


def test_the_skill_of_the_model_on_a_shake_table(monkeypatch):
    """Held against a forecast that is made here, test by test."""
    stored = read_study(RESULTS / "shake-table")
    assert (len(stored.settings["tests"]), stored.settings["overturned"][0]) == (checks.TESTS, checks.OVERTURNED)
    fell = np.arange(checks.TESTS) < checks.OVERTURNED
    constant = np.mean((np.full(checks.TESTS, fell.mean()) - fell) ** 2)
    model = next(row for row in stored.rows if row.get("forecast") == "model")  # of the first boulder, held out
    assert checks.skill() == pytest.approx(constant / model["brier"]) and 2 < checks.skill() < 10
    monkeypatch.setattr(checks, "RESULTS", Path("nowhere"))
    assert math.isnan(checks.skill())


@pytest.mark.parametrize("given, e", [(None, E), (0.8, 0.8)])
def test_the_script_of_the_lesson_does_what_is_told_of_it(tmp_path, given, e):
    """A material's restitution changes no impact, a couple does."""
    pytest.importorskip("pybullet")
    scene = load_scene(impacts.SCRIPTED).with_(block={"restitution": given}, duration=2.0)
    script, plain = written(impacts.WHOSE, scene, tmp_path), impacts.WAS
    question = next(
        exercise.question for exercise in impacts.LESSON.exercises if exercise.compute is impacts.with_a_material
    )
    assert f"change `{plain}` to `{plain}, restitution=0.5`" in question
    assert script.read_text().count(plain) == 1 and ("couple" in script.read_text()) == (given is not None)
    if given is None:
        script.write_text(script.read_text().replace(plain, f"{plain}, restitution=0.5"))
    first = re.search(r"impact at [\d.]+ s: e ([\d.]+)", run_alone(script))
    assert float(first[1]) == pytest.approx(e, abs=1e-4)


@pytest.mark.parametrize("side, outcome", [(1e-5, "overturns"), (-1e-5, "rocks")])
def test_an_edge_of_overturning_has_two_sides(side, outcome):
    scene = tipping.pulse_scene(tipping.first_fall() * (1 + side))
    assert simulate_twin(scene.with_(duration=6.0), history=False, energy=False).outcome == outcome
    size = tipping.size_that_survives() * (1 - 0.1 * side)
    assert simulate(tipping.pulse_scene(0.5, size=size), history=False).outcome == outcome
    pulse = PulseMotion("one-sine", caryatid.harmful_pulse() * (1 + 0.1 * side) * 9.81, 2 * math.pi / 1.8)
    assert simulate(caryatid.scene_of(0.28, 1.0, pulse), history=False).outcome == outcome
    assert simulate(caryatid.scene_of(0.28, None, pulse), history=False).outcome == "stands"  # isolation does harm


@pytest.mark.parametrize("less, fallen", [(0.0, "upper"), (0.01, "")])
def test_a_free_pedestal_throws_a_bust_off(less, fallen):
    scene = caryatid.bust_under(caryatid.weakest_on_a_free_pedestal() - less, free=False)
    assert simulate_two_bodies(scene, step=1e-4).fallen == fallen


def test_lifting_is_the_bearings_force():
    """Up to the least slenderness the block is one mass with its base: its peak acceleration is all that counts."""
    run = simulate(caryatid.scene_of(0.45, 1.0, synthetic_motion()), history=False)
    level = run.peak_base_acceleration / 9.81
    assert run.outcome == "stands"
    assert math.tan(caryatid.least_slenderness()) == pytest.approx(level, rel=1e-9)
    assert caryatid.reserve() == pytest.approx(100 * (1 - level / math.tan(0.28)), rel=1e-9)


def test_the_first_step_that_is_off_by_more():
    place = int(np.argmin(np.abs(corner.SCAN - 1e-3 * corner.step_for_one_per_cent())))
    errors = [corner.rate_error(float(step)) for step in corner.SCAN[: place + 2]]
    assert max(errors[:-1]) < 0.01 <= errors[-1]


def test_what_a_damping_hides():
    """The law of the engine's damping, by scipy: a force d m v (1 + |v|), a moment d I w (1 + |w|), of each flight."""
    scene, d = load_scene("free-rocking-rigid"), 0.04
    model, inertia = RockingModel.of(scene), scene.block.inertia - MASS * RADIUS**2

    def flight(t, state):
        tilt, rate = state
        damped = MASS * RADIUS**2 * (1 + RADIUS * abs(rate)) + inertia * (1 + abs(rate))
        return rate, -(MASS * 9.81 * RADIUS * math.sin(model.gamma - tilt) + d * damped * rate) / scene.block.inertia

    def lands(t, state):
        return state[0]

    lands.terminal, lands.direction = True, -1
    rates, state, time = [], (scene.start.tilt, 0.0), 0.0
    while True:
        flown = solve_ivp(flight, (time, time + 5), state, events=lands, rtol=1e-9, atol=1e-12)
        time = flown.t[-1]
        if time > 5:
            break
        rates.append(-flown.y[1, -1])
        state = (1e-15, model.restitution * rates[-1])
    lost = model.restitution - np.divide(rates[1:], rates[:-1])
    assert corner.hidden_loss() == pytest.approx(100 * math.sqrt(np.mean(lost**2)), rel=0.05)


def test_the_exercise_on_a_mistake_stands_without_its_study(monkeypatch, tmp_path):
    monkeypatch.setattr(corner, "RESULTS", tmp_path)
    assert math.isnan(corner.hidden_loss()) and "–" in answer(corner.LESSON.exercises[-1])


def test_two_horizons_give_the_same_growth():
    slope = math.log(1e6) / (chaos.horizon(-9.0) - chaos.horizon(-3.0))
    assert chaos.growth() == pytest.approx(slope, rel=0.6)
    assert chaos.perturbation_for_twenty_seconds() == pytest.approx(math.log(1e15) / chaos.growth(), rel=1e-9)


def test_the_crowd_one_by_one():
    values = chaos.RESTITUTION * (1 + 0.01 * np.linspace(-1, 1, 200))
    runs = [simulate(chaos.scene().with_(block={"restitution": e}), history=False) for e in values]
    assert chaos.code() == 100 * np.mean([run.outcome == "overturns" for run in runs])


def test_over_phases_half_the_step_is_half_the_error():
    for step in (0.02, 0.012, 0.006):
        whole, half = engine_runs.straddled(step), engine_runs.straddled(step / 2)
        assert [whole[0] / half[0], whole[1] / half[1]] == pytest.approx([2, 2], rel=0.15)


def test_the_next_step_is_off_by_more():
    step = 1e-3 * cost.coarsest_step()
    by_step = {run.value: run.error for run in engine_runs.own_runs()}
    assert max(error for value, error in by_step.items() if value <= step) < cost.TARGET
    assert by_step[min(value for value in by_step if value > step)] >= cost.TARGET


def test_the_table_counts_them(monkeypatch):
    monkeypatch.setattr(cost, "engine_runs", lambda: ())
    assert cost.passing_solvers() == len(cost.table().rows) == 2
    assert cost.event_driven_share() > 0


def test_the_event_driven_model_passes_them_all():
    assert max(checks.checks("event-driven", 6.0).values()) < 1e-8
    assert min(value for name, value in checks.checks("fixed steps", 2.0).items() if name != "mirror") > 1e-3
