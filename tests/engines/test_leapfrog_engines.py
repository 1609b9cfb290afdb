"""PyBullet, MuJoCo, pymunk, DART and Drake, beside what every engine must fulfil: what is particular to each."""

import importlib
import math
from functools import partial

import numpy as np
import pytest
from engine_cases import impact_errors, scene

from analytic import Start
from engines import get_engine

ROCKING = scene(0.2, 212.0, start=Start(tilt=0.1))


def built(engine):
    """The module that builds an engine's scene."""
    return importlib.import_module(f"engines.{engine}.scene")


# What an engine does not hold as asked is refused: calls of its API, each with the right function first.


def without_mass(change, body, link, mass=None, localInertiaDiagonal=None, **rest):
    change(body, link, **rest)


def missing_the_link(change, body, link, **values):
    change(body, -1, **values)


def other_text(asked, given):
    def read(right, text):
        assert asked in text
        return right(text.replace(asked, given))

    return read


def forgetful_space(name):
    """Chipmunk's space with a setting that stays at 0.9."""
    stuck = {name: property(lambda space: 0.9, lambda space, value: None)}
    return lambda right: type("Forgetful", (right,), stuck)()


def lighter(right, mass, *rest):
    return right(0.9 * mass, *rest)


def smoother(right, body, size, place, friction):
    right(body, size, place, 0.9)


@pytest.mark.parametrize(
    "engine, call, wrong, words",
    [
        ("pybullet", "pybullet.changeDynamics", without_mass, "block: inertia is"),
        ("pybullet", "pybullet.changeDynamics", missing_the_link, "friction"),
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
        ("pymunk", "pymunk.Space", forgetful_space("collision_slop"), "slop is 0.9"),
        ("pymunk", "pymunk.Space", forgetful_space("collision_bias"), "bias is 0.9"),
        ("dart", "dartpy.dynamics.Inertia", lighter, "block: mass is 2854.8"),
        ("dart", "_touch", smoother, "friction is 0.9, not 5"),
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
