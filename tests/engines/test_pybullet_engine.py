"""PyBullet, beside what every engine must fulfil: accuracy of its variants, what goes wrong surfaces."""

import math

import numpy as np
import pytest

pytest.importorskip("pybullet", reason="pybullet is not installed (its wheels end at CPython 3.11)")

from analytic import Base, Bearings, Block, PulseMotion, Start  # noqa: E402
from analytic import Scene as AnyScene  # noqa: E402
from analytic.rocking import RockingModel, restitution  # noqa: E402
from engines import (  # noqa: E402
    pybullet_engine,
    pybullet_scene,
    pybullet_stepping,
)
from engines.ground_velocity import ground_velocity  # noqa: E402

simulate = pybullet_engine.simulate
BEARINGS = Bearings(count=4, ka=6.22e4, kb=6.22e3, alpha=44.69)


def scene(slenderness, base=None, duration=2.0, **parts):
    return AnyScene(block=Block(mass=3172.05, radius=1.0884, slenderness=slenderness),
                    base=Base(mass=base) if base else None, duration=duration, **parts)


def impact_errors(slenderness, base, **settings):
    """Errors of e (absolute) and of the base velocity jump (relative): 8 starts, 3 impacts each."""
    errors, jumps, cpu, simulated = [], [], 0.0, 0.0
    for share in np.linspace(0.3, 0.8, 8):
        given = scene(slenderness, base, 3.0, start=Start(tilt=share * slenderness))
        response = simulate(given, history=False, **settings)
        assert response.outcome == "rocks", response.failure
        model = RockingModel.of(given)
        assert len(response.impacts) >= 2
        for impact in response.impacts[:3]:
            errors.append(impact.rate_after / impact.rate_before - restitution(given))
            if base:
                jumps.append(impact.base_velocity_jump / model.impact(impact.rate_before)[1] - 1)
        cpu, simulated = cpu + response.cpu_seconds, simulated + given.duration
    return np.sqrt(np.mean(np.square(errors))), np.sqrt(np.mean(np.square(jumps or [0.0]))), cpu / simulated


def test_default_is_ten_times_cheaper_than_fixed_step_at_no_larger_error():
    e_aware, _, cpu_aware = impact_errors(0.2, 212.0)
    given = scene(0.2, 212.0, 0.6, start=Start(tilt=0.06))
    fixed = simulate(given, variant="fixed-step", step=2e-5, history=False)
    e_fixed = abs(fixed.impacts[0].rate_after / fixed.impacts[0].rate_before - restitution(given))
    assert e_fixed > e_aware  # even this step leaves more
    assert fixed.cpu_seconds / 0.6 > 10 * cpu_aware


def test_fixed_step_is_first_order():
    errors = [impact_errors(0.45, None, variant="fixed-step", step=step)[0] for step in (1.6e-3, 4e-4)]
    assert 2.5 < errors[0] / errors[1] < 6.5  # 4 but for the phase of the steps


@pytest.mark.parametrize("accuracy, error", [(4e-5, 2e-4), (1e-5, 5e-5), (2.5e-6, 1.25e-5)])
def test_accuracy_knob_means_error_of_restitution(accuracy, error):
    assert impact_errors(0.3, None, accuracy=accuracy)[0] < error


@pytest.mark.parametrize("step", [1 / 240, 1 / 1000, 1 / 4000])
def test_first_script_is_wrong_at_every_step(step):
    """Default damping takes energy in flight: swing energies give e near .928, not .9408, and do not converge."""
    start = 0.12
    response = simulate(scene(0.2, None, 2.5, start=Start(tilt=start)), variant="first-script", step=step)
    tilt = response.history.tilt
    swings = np.split(np.abs(tilt), np.flatnonzero(np.diff(np.sign(tilt))) + 1)
    energy = [math.cos(0.2 - swing.max()) - math.cos(0.2) for swing in swings[:3]]
    e = (energy[2] / energy[0]) ** 0.25  # over two impacts
    assert e == pytest.approx(0.928, abs=0.009)
    assert abs(e - restitution(scene(0.2))) > 0.005


@pytest.mark.parametrize("shape", ["one-sine", "one-cosine", "half-sine", "rectangular", "ricker"])
def test_ground_velocity_is_the_integral_of_the_acceleration(shape):
    motion = PulseMotion(shape, 2.0, 5.0, start=0.3)
    velocity = ground_velocity(motion)
    time = np.linspace(motion.start, motion.end, 200_001)
    level = motion.acceleration(0.5 * (time[1:] + time[:-1]))
    assert velocity(motion.end + 1.0) == pytest.approx(np.sum(level) * (time[1] - time[0]), abs=1e-8)
    middle = len(time) // 3
    assert velocity(time[middle]) == pytest.approx(np.sum(level[:middle]) * (time[1] - time[0]), abs=1e-8)


def test_state_that_is_not_finite_fails(monkeypatch):
    calls = []

    def breaks(z, *rest):
        calls.append(z)
        return math.nan if len(calls) > 50 else z

    monkeypatch.setattr(pybullet_stepping, "hysteretic_force", breaks)
    response = simulate(scene(0.2, 212.0, bearings=BEARINGS, motion=PulseMotion("one-sine", 3.0, 4.0)))
    assert response.outcome == "failed"
    assert "finite" in response.failure.reason
    assert math.isfinite(response.failure.last_state.tilt)
    assert response.settings["accuracy"] == 1e-5


def test_run_that_does_not_advance_is_given_up(monkeypatch):
    monkeypatch.setattr(pybullet_engine, "ROWS_PER_STEP", 0)
    monkeypatch.setattr(pybullet_engine, "MOST_ROWS", 300)
    response = simulate(scene(0.2, start=Start(tilt=0.1)))
    assert response.outcome == "failed"
    assert response.failure.reason == "too many steps"


def test_mass_that_bullet_does_not_take_is_refused(monkeypatch):
    change = pybullet_scene.pybullet.changeDynamics

    def forgets(body, link, **values):
        values.pop("mass", None)
        values.pop("localInertiaDiagonal", None)
        change(body, link, **values)

    monkeypatch.setattr(pybullet_scene.pybullet, "changeDynamics", forgets)
    response = simulate(scene(0.2, start=Start(tilt=0.1)))
    assert response.outcome == "failed"
    assert "block: inertia is" in response.failure.message


def test_joint_motor_or_friction_left_as_it_is_is_refused(monkeypatch):
    change = pybullet_scene.pybullet.changeDynamics
    monkeypatch.setattr(pybullet_scene.pybullet, "changeDynamics",
                        lambda body, link, **values: change(body, -1, **values))  # trap: the link is missed
    response = simulate(scene(0.2, 212.0, start=Start(tilt=0.1)))
    assert response.outcome == "failed"
    assert "friction" in response.failure.message


def test_sliding_block_fails(monkeypatch):
    monkeypatch.setattr(pybullet_scene, "FRICTION", 0.2)
    response = simulate(scene(0.4, motion=PulseMotion("rectangular", 3.0, 2.0)))
    assert response.outcome == "failed"
    assert "slid" in response.failure.reason


def test_clients_are_closed(monkeypatch):
    open_clients = []
    connect, disconnect = pybullet_engine.pybullet.connect, pybullet_engine.pybullet.disconnect
    monkeypatch.setattr(pybullet_engine.pybullet, "connect",
                        lambda mode: open_clients.append(connect(mode)) or open_clients[-1])
    monkeypatch.setattr(pybullet_engine.pybullet, "disconnect",
                        lambda client: open_clients.remove(client) or disconnect(client))
    monkeypatch.setattr(pybullet_scene, "FRICTION", math.nan)
    assert simulate(scene(0.2)).outcome == "failed"
    assert open_clients == []


def test_bullets_contact_solver_is_named():
    assert "contact solver" in pybullet_engine.DECIDES
