"""PyBullet, MuJoCo, pymunk, DART and Drake, beside what every engine must fulfil: what is particular to each."""

import bisect
import importlib
import math
from dataclasses import dataclass, field
from functools import partial

import numpy as np
import pytest
from engine_cases import CASES, impact_errors, scene

from analytic import Bearings, PulseMotion, Start
from analytic.caryatid import BEARINGS
from engines import get_engine, stepping
from engines.ground_velocity import ground_velocity
from engines.momentum import IMPULSE_LIMIT, impulse_error

ROCKING = scene(0.2, 212.0, start=Start(tilt=0.1))


def built(engine):
    """The module that builds an engine's scene."""
    get_engine(engine)  # skips the test where it is an extra that is not installed
    return importlib.import_module(f"engines.{engine}.scene")


# What an engine does not hold as asked is refused: calls of its API, each with the right function first.


def without_mass(change, body, link, mass=None, localInertiaDiagonal=None, **rest):
    change(body, link, **rest)


def other_text(asked, given):
    def read(right, text):
        assert asked in text
        return right(text.replace(asked, given))

    return read


def forgetful_space(name):
    """Chipmunk's space with a setting that stays at 0.9."""
    stuck = {name: property(lambda space: 0.9, lambda space, value: None)}
    return lambda right: type("Forgetful", (right,), stuck)()


@pytest.mark.parametrize(
    "engine, call, wrong, words",
    [
        ("pybullet", "pybullet.changeDynamics", without_mass, "block: inertia is"),
        ("pybullet", "pybullet.changeDynamics", lambda change, body, link, **one: change(body, -1, **one), "friction"),
        ("mujoco", "mujoco.MjModel.from_xml_string", other_text('mass="3172.05"', 'mass="3000.0"'), "3000.0], not"),
        ("mujoco", "mujoco.MjModel.from_xml_string", other_text('cone="elliptic"', ""), "cone is 0"),
        ("mujoco", "mujoco.MjModel.from_xml_string", other_text('autoreset="disable"', ""), "disabled parts is 0"),
        ("mujoco", "mujoco.MjModel.from_xml_string", other_text('friction="5.0 0 0"', ""), "contact: friction is"),
        (
            "mujoco",
            "mujoco.MjModel.from_xml_string",
            other_text('type="hinge"', 'type="hinge" damping="1"'),
            "dof_damping",
        ),
        ("mujoco", "mujoco.MjModel.from_xml_string", other_text("<option", "<optoin"), "optoin"),
        ("pymunk", "pymunk.Space", forgetful_space("damping"), "damping is 0.9"),
        ("pymunk", "pymunk.Space", forgetful_space("collision_bias"), "bias is 0.9"),
        (
            "dart",
            "dartpy.dynamics.Inertia",
            lambda right, mass, *rest: right(0.9 * mass, *rest),
            "block: mass is 2854.8",
        ),
        ("dart", "_touch", lambda right, *rest: right(*rest[:-1], 0.9), "friction is 0.9, not 5"),
    ],
)
def test_what_an_engine_does_not_hold_as_asked_is_refused(monkeypatch, engine, call, wrong, words):
    *path, name = call.split(".")
    owner = built(engine)
    for part in path:
        owner = getattr(owner, part)
    monkeypatch.setattr(owner, name, partial(wrong, getattr(owner, name)))
    response = get_engine(engine).simulate(ROCKING)
    assert response.outcome == "failed" and response.failure.reason == "the engine does not hold the scene"
    assert words in response.failure.message


# Settings without which e is off.


@pytest.mark.parametrize(
    "engine, base, setting, other",
    [
        # k = 1/h^2: what has sunk comes back within a step, with its speed
        ("mujoco", None, "scene.contact_reference", lambda usual: lambda step, recovery: (-1 / step**2, -1 / step)),
        # without split impulses what has sunk is thrown out
        ("dart", None, "adapter.DartBodies", lambda usual: lambda scene, plain: usual(scene, True)),
        # a light base needs iterations by the ratio of the masses
        ("pymunk", 212.0, "scene.LIGHT", lambda usual: 0),
    ],
)
def test_settings_of_the_contact_bring_a_tenth_of_the_error(monkeypatch, engine, base, setting, other):
    simulate, (module, name) = get_engine(engine).simulate, setting.split(".")
    usual, module = impact_errors(simulate, 0.3, base, 2, 2.5)[0], importlib.import_module(f"engines.{engine}.{module}")
    monkeypatch.setattr(module, name, other(getattr(module, name)))
    assert impact_errors(simulate, 0.3, base, 2, 2.5)[0] > 10 * usual


# Troubles in an engine's own words.


def blows_up(mujoco, data):
    data.qvel[:] = math.inf


def warns(mujoco, data):
    mujoco.get_mju_user_warning()("Contact buffer is full")


@pytest.mark.parametrize(
    "trouble, reason, words", [(blows_up, "finite", "unstable"), (warns, "MuJoCo warned", "buffer is full")]
)
def test_what_mujoco_warns_of_fails_in_its_words(monkeypatch, trouble, reason, words):
    mujoco = built("mujoco").mujoco
    step = mujoco.mj_step

    def troubled(model, data):
        if abs(data.time - 0.1) < 1e-3:
            trouble(mujoco, data)
        step(model, data)

    monkeypatch.setattr(mujoco, "mj_step", troubled)
    response = get_engine("mujoco").simulate(ROCKING)
    assert response.outcome == "failed" and reason in response.failure.reason and words in response.failure.message
    assert mujoco.get_mju_user_warning() is None  # the handler is given back


@pytest.mark.slow
def test_a_step_that_drake_does_not_solve_is_a_failure_in_its_words(monkeypatch):
    module = built("drake")

    class Stuck(module.Simulator):
        def AdvanceTo(self, time):
            if time > 0.1:
                raise RuntimeError("solver failed to converge at simulation time = 0.1 with dt = 0.001.")
            super().AdvanceTo(time)

    monkeypatch.setattr(module, "Simulator", Stuck)
    response = get_engine("drake").simulate(ROCKING)
    assert response.outcome == "failed" and response.failure.reason == "Drake found no solution of a step"
    assert "failed to converge" in response.failure.message and "at step 100" in response.failure.message


def test_bullet_is_disconnected_where_it_raises_an_error(monkeypatch):
    module, clients = built("pybullet"), []
    connect = module.pybullet.connect
    monkeypatch.setattr(module.pybullet, "connect", lambda mode: clients.append(connect(mode)) or clients[-1])
    monkeypatch.setattr(module, "FRICTION", math.nan)
    assert get_engine("pybullet").simulate(ROCKING).outcome == "failed"
    assert clients and not any(module.pybullet.isConnected(client) for client in clients)


def test_bullet_cuts_friction_and_the_response_says_so():
    given, simulate = ROCKING.with_(friction=20.0), get_engine("pybullet").simulate
    (warning,) = simulate(given, history=False).warnings
    assert (warning.kind, warning.quantity, warning.value, warning.limit) == ("engine", "friction", 20.0, 10.0)
    assert simulate(given.with_(friction=2.0), history=False).warnings == ()


def test_first_script_that_reaches_bullets_velocity_limit_fails():
    given = scene(0.2, 212.0, 1.0, start=Start(base_velocity=150.0))
    response = get_engine("pybullet").simulate(given, variant="first-script")
    assert response.outcome == "failed" and "velocit" in response.failure.reason


# The bearings' force that an engine applies: see `test_observe`.

DRIVEN = scene(0.15, 212.0, 2.5, bearings=BEARINGS, motion=PulseMotion("one-sine", 3.0, 8.0))


def mutate_exudyn(monkeypatch, gain, delay):
    """The spring of the bearings is `gain` times as stiff, and acts from where the base was `delay` [s] ago."""
    from engines.exudyn import model

    spring = model.Bearing.spring

    def changed(self, ahead):
        one = spring(self, ahead)
        k = gain * one["stiffness"][0]
        late = {} if self.connector is None else {"damping": [self.law.count * self.law.damping - k * delay, 0.0, 0.0]}
        return {**one, "stiffness": [k, 0.0, 0.0], **late}  # at x - delay v

    monkeypatch.setattr(model.Bearing, "spring", changed)


def mutate_leapfrog(monkeypatch, gain, delay):
    """The engine is given another force than the rows say: `gain` times as much, `delay` [s] later."""
    mean_loads, times, forces = stepping.mean_loads, [], []

    def changed(*given):
        loads = mean_loads(*given)

        def other(t, h, before, v, force):
            times.append(t)
            forces.append(force)
            late = forces[max(bisect.bisect_right(times, t - delay) - 1, 0)]
            return loads(t, h, before, v, gain * late)

        return other

    monkeypatch.setattr(stepping, "mean_loads", changed)


def error_in(engine, monkeypatch, gain, delay):
    """(response, error of the impulse) of the engine's default, with a mutated force."""
    mutate = mutate_exudyn if engine == "exudyn" else mutate_leapfrog
    mutate(monkeypatch, gain, delay)
    response, trace = get_engine(engine).traced(DRIVEN)
    return response, impulse_error(DRIVEN, trace)


@pytest.mark.parametrize("engine", ["exudyn", "pybullet", "mujoco", "pymunk", "dart"])
@pytest.mark.parametrize("gain, delay", [(2.0, 0.0), (1.0, 0.0), (0.0, 0.0), (1.0, 1e-3), (1.01, 0.0)])
def test_a_force_inside_an_engine_that_is_lost_late_or_off_is_measured_and_a_large_error_a_failure(
    monkeypatch, engine, gain, delay
):
    response, error = error_in(engine, monkeypatch, gain, delay)
    wrong = abs(gain - 1) > 0.1
    assert response.outcome == ("failed" if wrong else "rocks")  # by its energy, too, where the force is too small
    assert (error > IMPULSE_LIMIT) == wrong and (error > 4e-4) == ((gain, delay) != (1, 0))  # a clean run shows 4e-5
    assert delay or error == pytest.approx(abs(gain - 1), rel=0.02, abs=4e-5)


def test_where_bodies_will_be_is_where_chipmunk_then_moves_them(monkeypatch):
    """The adapter reads a step ahead: what it said is, to round-off, what the next call begins with."""
    given = scene(0.2, 212.0, 1.0, start=Start(tilt=0.15, tilt_rate=0.1, base_displacement=0.01, base_velocity=0.02))
    bodies, moved = built("pymunk").ChipmunkBodies(given, 1e-4, plain=False), []
    advance = bodies.space.step

    def watched(length):
        advance(length)
        moved.append((-bodies.block.angle, bodies.block.position.x, bodies.slab.position.x))

    monkeypatch.setattr(bodies.space, "step", watched)
    told, before = [], 0.0
    for k in range(400):
        length = 1e-4 * (1 + k % 3)
        tilt, _, x, _, _, _, base, _ = bodies.step(length, before, 0.0, -9.81 * 0.5 * (length + before), 0.0)
        told.append((tilt, x, base))
        before = length
    np.testing.assert_allclose(moved[1:], told[:-1], rtol=0, atol=1e-12)
    np.testing.assert_allclose(moved[0][::2], (0.15, 0.01), rtol=0, atol=1e-12)


# What a record says that its adapter imposes is what it does, and all of it.

BEGIN = 0.02037
MOTION = PulseMotion("rectangular", 2.0, 60.0, start=BEGIN)
DAMPED = Bearings(law="linear", count=4, ka=6e4, damping=300.0)
GIVEN = scene(0.2, 212.0, 0.06, bearings=DAMPED, motion=MOTION, start=Start(tilt=2e-3))


@dataclass
class Seen:
    """A run: its bodies, their loads in each step, masses and couples that were set, rows and trace."""

    bodies: object
    loads: list = field(default_factory=list)
    added: list = field(default_factory=list)
    couples: list = field(default_factory=list)
    moved: float = math.inf  # m/s, of the base by an impulse of 10 N s after the run, where 1e9 kg are added to it

    def __post_init__(self):
        weigh = self.bodies.weigh  # of which the loads know, too
        self.bodies.weigh = lambda added: self.added.append(added) or weigh(added)

    def step(self, *loads):
        self.loads.append(loads)
        return self.bodies.step(*loads)

    def twist(self, moment):
        self.couples.append(moment)
        self.bodies.twist(moment)


def ran(monkeypatch, engine, variant, given):
    """(what was `Seen` of a run, its rows, its trace)."""
    march, found = stepping.march, []

    def watched(held, *rest):
        found.append(Seen(held))
        rows, ended = march(bodies := found[-1], *rest)
        bodies.bodies.weigh(1e9)
        bodies.moved = abs(bodies.step(1e-4, 1e-4, 0.0, 0.0, 10.0)[-1] - rows[-1, 5])
        found.append(rows)
        return rows, ended

    with monkeypatch.context() as patched:
        patched.setattr(stepping, "march", watched)
        run = engine.run(given, variant, engine.variants[variant].settings)
    assert run.failure is None and run.steps > 5
    return *found, run.trace


def planar(bodies):
    """Whether joints leave a body of three dimensions the motions of a plane."""
    if hasattr(bodies, "model"):
        return 0 not in bodies.model.jnt_type  # MuJoCo's number of a free joint
    return hasattr(bodies, "joints")


def imposed(monkeypatch, engine, variant):
    """The clauses that hold of a variant."""
    seen, rows, trace = ran(monkeypatch, engine, variant, GIVEN)
    step, before, across, up, _ = np.array(seen.loads[:-1]).T
    t, velocity = rows[:-1, 0], ground_velocity(MOTION)
    moments = np.sort([*(t - before / 2), *(t + step / 2)])
    couples = [0.0]
    if engine.variants[variant].takes_restitution:
        slower = GIVEN.with_(
            block={"restitution": 0.6}, start={"tilt": 1e-3, "tilt_rate": -0.1}, bearings=None, motion=None
        )
        couples = ran(monkeypatch, engine, variant, slower)[0].couples
    mean = [-(velocity(a + b / 2) - velocity(max(a - c / 2, 0.0))) for a, b, c in zip(t, step, before, strict=True)]
    level = -9.81 * step, -MOTION.acceleration(t) * step
    return {
        "a plane, by joints": planar(seen.bodies),
        "steps by gaps and closing speeds, which meet jumps of the ground's acceleration": (
            step.max() > 10 * step[:-1].min() and np.abs(moments - BEGIN).min() < 1e-9
        ),
        "loads times (step + step before)/(2 step), the ground's as its mean": (
            np.allclose(up, -9.81 * (step + before) / 2) and np.allclose(across, mean, atol=1e-12)
        ),
        "loads as where a step begins": np.allclose(up, level[0]) and np.allclose(across, level[1]),
        "dampers and stiff bearings as mass added to the base": (
            min(seen.added[:-1], default=0) > 0 and seen.moved < 1e-6
        ),
        "velocities read half a step early": not np.allclose(trace.tilt_rate, rows[:, 3], rtol=1e-9),
        "restitution given: a couple before each landing": any(couples),
    }


@pytest.mark.parametrize("engine, variant", [case for case in CASES if case[0] != "exudyn"])
def test_a_leapfrog_engines_record_says_what_its_adapter_imposes(monkeypatch, engine, variant):
    engine = get_engine(engine)
    found = imposed(monkeypatch, engine, variant)
    assert set(engine.variants[variant].imposes.split("; ")) == {clause for clause, holds in found.items() if holds}
