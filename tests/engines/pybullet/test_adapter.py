"""PyBullet, beside what every engine must fulfil: accuracy of its variants, what goes wrong surfaces."""

import math

import numpy as np
import pytest

pytest.importorskip("pybullet", reason="pybullet is not installed (its wheels end at CPython 3.11)")

from engine_cases import impact_errors, scene  # noqa: E402

from analytic import Base, Bearings, Block, PulseMotion, Start  # noqa: E402
from analytic import Scene as AnyScene  # noqa: E402
from analytic import simulate as exact  # noqa: E402
from analytic.rocking import restitution  # noqa: E402
from engines import get_engine  # noqa: E402
from engines.pybullet import adapter  # noqa: E402
from engines.pybullet import scene as bullet  # noqa: E402

simulate = get_engine("pybullet").simulate


def test_default_is_ten_times_cheaper_than_fixed_step_at_no_larger_error():
    e_aware, *_, cpu_aware = impact_errors(simulate, 0.2, 212.0)
    given = scene(0.2, 212.0, 0.6, start=Start(tilt=0.06))
    fixed = simulate(given, variant="fixed-step", step=2e-5, history=False)
    e_fixed = abs(fixed.impacts[0].rate_after / fixed.impacts[0].rate_before - restitution(given))
    assert e_fixed > e_aware  # even this step leaves more
    assert fixed.cpu_seconds / 0.6 > 10 * cpu_aware


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


def test_mass_that_bullet_does_not_take_is_refused(monkeypatch):
    change = bullet.pybullet.changeDynamics

    def forgets(body, link, **values):
        values.pop("mass", None)
        values.pop("localInertiaDiagonal", None)
        change(body, link, **values)

    monkeypatch.setattr(bullet.pybullet, "changeDynamics", forgets)
    response = simulate(scene(0.2, start=Start(tilt=0.1)))
    assert response.outcome == "failed"
    assert "block: inertia is" in response.failure.message


def test_joint_motor_or_friction_left_as_it_is_is_refused(monkeypatch):
    change = bullet.pybullet.changeDynamics
    monkeypatch.setattr(
        bullet.pybullet, "changeDynamics", lambda body, link, **values: change(body, -1, **values)
    )  # trap: the link is missed
    response = simulate(scene(0.2, 212.0, start=Start(tilt=0.1)))
    assert response.outcome == "failed"
    assert "friction" in response.failure.message


def test_clients_are_closed(monkeypatch):
    open_clients = []
    connect, disconnect = adapter.pybullet.connect, adapter.pybullet.disconnect
    monkeypatch.setattr(
        adapter.pybullet, "connect", lambda mode: open_clients.append(connect(mode)) or open_clients[-1]
    )
    monkeypatch.setattr(
        adapter.pybullet, "disconnect", lambda client: open_clients.remove(client) or disconnect(client)
    )
    monkeypatch.setattr(bullet, "FRICTION", math.nan)
    assert simulate(scene(0.2)).outcome == "failed"
    assert open_clients == []


# Far from the usual scenes: each was wrong in silence once.


def worst_restitution(given, **settings):
    response = simulate(given, history=False, **settings)
    assert response.outcome == "rocks" and len(response.impacts) >= 3, response.failure
    return max(abs(k.rate_after / k.rate_before - restitution(given)) for k in response.impacts[:3])


@pytest.mark.parametrize("slenderness, inertia", [(0.1, 1.01), (0.45, 1.05), (0.3, 1.02)])
def test_corner_inertia_near_its_least_value_takes_more_iterations(slenderness, inertia):
    block = Block(mass=10.0, radius=1.0, slenderness=slenderness, corner_inertia=10.0 * inertia)
    given = AnyScene(block=block, start=Start(tilt=0.6 * slenderness), duration=2.5)
    assert worst_restitution(given) < 1e-4


def test_slender_blocks_and_little_inertia_need_many_iterations():
    usual = bullet.iterations(scene(0.45), 1), bullet.iterations(scene(0.45), 2)
    slender = bullet.iterations(scene(0.05), 2)
    little = scene(0.45).with_(block={"corner_inertia": 1.05 * 3172.05 * 1.0884**2})
    assert usual[0] <= 12 and usual[1] < 40
    assert slender > 9.2 * 0.9 / (3 * math.tan(0.05) ** 2)  # 1e-4 at a rate of 1 - 3 tan^2
    assert bullet.iterations(little, 1) > 4 * usual[0]


@pytest.mark.parametrize("power", [-5, 2])
def test_any_size_moves_as_one_of_a_metre_does(power):
    """Lengths by 4^n, times by 2^n: no digit changes."""
    size, time = 4.0**power, 2.0**power
    given = scene(0.25, 212.0, 1.5, start=Start(tilt=0.15))
    other = given.with_(block={"radius": size * 1.0884}, duration=time * 1.5)
    here, there = simulate(given, history=False), simulate(other, history=False)
    assert there.steps == here.steps and there.peak_base_displacement == size * here.peak_base_displacement
    assert [time * k.time for k in here.impacts] == pytest.approx([k.time for k in there.impacts], rel=1e-9)


@pytest.mark.parametrize(
    "base, ka, damping",
    [
        (212.0, 6.22e4, 1e5),
        (212.0, 6.22e4, 1e6),
        (0.067, 6.22e4, 500.0),
        (0.01, 6.22e4, 0.0),
        (212.0, 1e8, 0.0),
        (1.0, 1e7, 1e4),
    ],
    ids=["1e5 N s/m", "1e6 N s/m", "base of 67 g", "base of 10 g", "1e8 N/m", "all at once"],
)
@pytest.mark.parametrize("start", [0.0, 0.06])
def test_stiff_damped_and_light_bases_move_as_the_exact_solution(base, ka, damping, start):
    given = scene(
        0.15,
        base,
        1.5,
        bearings=Bearings(law="linear", count=4, ka=ka, damping=damping),
        motion=None if start else PulseMotion("one-sine", 1.0, 6.0),
        start=Start(tilt=start),
    )
    response, reference = simulate(given, history=False), exact(given, history=False)
    assert response.outcome == reference.outcome
    assert response.peak_tilt == pytest.approx(reference.peak_tilt, rel=1e-2, abs=1e-6)
    assert response.peak_base_displacement == pytest.approx(reference.peak_base_displacement, rel=1e-2)
    if start and not damping:
        assert response.impacts[0].rate_after / response.impacts[0].rate_before == pytest.approx(
            restitution(given), abs=1e-3
        )


@pytest.mark.parametrize("law", ["linear", "bouc-wen"])
def test_stiff_bearings_keep_their_phase(law):
    """A base that swings 300 rad: leapfrog alone is .5 rad ahead at these steps."""
    ka = (3172.05 + 31720.0) * 300.0**2
    bearings = Bearings(law=law, ka=ka, kb=0.8 * ka, alpha=1.7)  # yields at .7 m
    given = scene(0.5, 31720.0, 1.0, bearings=bearings, start=Start(base_displacement=1e-5))
    response, reference = simulate(given), exact(given)
    assert response.steps < 3000
    at = np.linspace(0.9, 1.0, 50)
    shift = np.interp(at, response.history.time, response.history.base_displacement) - np.interp(
        at, reference.history.time, reference.history.base_displacement
    )
    assert np.abs(shift).max() < 0.03 * 1e-5


def test_a_slow_onset_is_that_of_the_model():
    """Both corners carry until the block has lifted: the tilt was 2.5 times as large as the model's."""
    block = Block(mass=0.106, radius=10.4, slenderness=0.036, corner_inertia=2.02 * 0.106 * 10.4**2)
    given = AnyScene(block=block, motion=PulseMotion("ricker", -0.548, 0.786), duration=16.3)
    wanted, found = exact(given).history, simulate(given).history
    late = exact(given).uplifts[0] + np.linspace(0.3, 1.0, 8)
    np.testing.assert_allclose(
        np.interp(late, found.time, found.tilt), np.interp(late, wanted.time, wanted.tilt), rtol=2e-2
    )


def test_a_block_that_lands_flat_and_is_thrown_up_again_loses_all_its_speed():
    """Eq. (7) below 0: it lands on both corners; its base, set off by the impact, lifts it again 1 ms later."""
    given = AnyScene(
        block=Block(mass=0.005537850677, radius=5.524552367, slenderness=0.9707119242, corner_inertia=0.18950932405),
        base=Base(mass=0.01012025917),
        bearings=Bearings(count=4, ka=18.07114119, kb=6.055830422, alpha=40.25874966, damping=0.23719541108),
        start=Start(tilt=-0.1993206787437),
        duration=0.75,
    )
    assert restitution(given) < 0
    response, model = simulate(given), exact(given)
    assert len(model.impacts) == len(response.impacts) == 2
    for found, expected in zip(response.impacts, model.impacts, strict=True):
        assert found.time == pytest.approx(expected.time, rel=1e-3)
        assert found.rate_before == pytest.approx(expected.rate_before, rel=1e-2)
        # What the base gives it until the block counts as in flight.
        assert expected.rate_after == 0.0 and abs(found.rate_after) < 0.01 * abs(found.rate_before)


def test_bullet_cuts_friction_and_the_response_says_so():
    given = scene(0.2, start=Start(tilt=0.1), friction=20.0)
    (warning,) = simulate(given, history=False).warnings
    assert (warning.kind, warning.quantity, warning.value, warning.limit) == ("engine", "friction", 20.0, 10.0)
    assert simulate(given.with_(friction=2.0), history=False).warnings == ()


def test_first_script_that_reaches_bullets_velocity_limit_fails():
    given = scene(0.2, 212.0, 1.0, start=Start(base_velocity=150.0))
    response = simulate(given, variant="first-script")
    assert response.outcome == "failed" and "velocit" in response.failure.reason
