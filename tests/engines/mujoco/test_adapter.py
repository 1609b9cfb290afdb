"""MuJoCo, beside what every engine must fulfil: accuracy of its variants, what goes wrong surfaces, long rest."""

import math

import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco", reason="mujoco is not installed: see README.md")

from engine_cases import impact_errors, scene  # noqa: E402

from analytic import Base, Bearings, Block, PulseMotion, Start  # noqa: E402
from analytic import Scene as AnyScene  # noqa: E402
from analytic import simulate as exact  # noqa: E402
from analytic.rocking import restitution  # noqa: E402
from engines import get_engine  # noqa: E402
from engines.contract import Mismatch  # noqa: E402
from engines.mujoco import scene as built  # noqa: E402

simulate = get_engine("mujoco").simulate


def swing_peaks(response, slenderness):
    tilt = response.history.tilt
    swings = np.split(np.abs(tilt), np.flatnonzero(np.diff(np.sign(tilt))) + 1)
    return [swing.max() / slenderness for swing in swings]


@pytest.mark.parametrize("step", [2e-3, 5e-4])
@pytest.mark.parametrize("slenderness, base, peak", [(0.1, None, 0.544), (0.1, 212.0, 0.328)])
def test_first_script_loses_too_much_of_a_slender_block_at_every_step(slenderness, base, peak, step):
    """MuJoCo's default contact is soft: the second swing from .6 reaches .544 and .328 of gamma, not .570 and .510."""
    given = scene(slenderness, base, 1.5, start=Start(tilt=0.6 * slenderness))
    second = swing_peaks(simulate(given, variant="first-script", step=step), slenderness)[1]
    assert second == pytest.approx(peak, abs=0.005)
    assert second < swing_peaks(exact(given), slenderness)[1] - 0.02


def test_a_state_that_mujoco_makes_not_finite_fails_with_its_own_words(monkeypatch):
    step = mujoco.mj_step

    def breaks(model, data):
        if data.time > 0.1:
            data.qvel[:] = math.inf
        step(model, data)

    monkeypatch.setattr(built.mujoco, "mj_step", breaks)
    response = simulate(scene(0.2, start=Start(tilt=0.1)))
    assert response.outcome == "failed"
    assert "finite" in response.failure.reason and "unstable" in response.failure.message
    assert mujoco.get_mju_user_warning() is None  # the handler is given back


def test_warning_alone_fails(monkeypatch):
    step = mujoco.mj_step

    def warns(model, data):
        step(model, data)
        if abs(data.time - 0.1) < 1e-3:
            mujoco.get_mju_user_warning()("Contact buffer is full")

    monkeypatch.setattr(built.mujoco, "mj_step", warns)
    response = simulate(scene(0.2, start=Start(tilt=0.1)))
    assert response.outcome == "failed" and "buffer is full" in response.failure.message


@pytest.mark.parametrize(
    "asked, given, words",
    [
        (f'mass="{3172.05!r}"', 'mass="3000.0"', "masses is .3000.0., not .3172.05."),
        ('cone="elliptic"', "", "cone is 0"),
        ('autoreset="disable"', "", "disabled parts is 0"),
        ('friction="5.0 0 0"', "", "contact: friction is"),
        ('type="hinge"', 'type="hinge" damping="1"', "dof_damping"),
        ("<option", "<optoin", "optoin"),
    ],
)
def test_what_mujoco_does_not_hold_as_asked_is_refused(monkeypatch, asked, given, words):
    class Forgetful:
        @staticmethod
        def from_xml_string(text):
            assert asked in text
            return mujoco.MjModel.from_xml_string(text.replace(asked, given))

    class Engine:
        MjModel = Forgetful

        def __getattr__(self, name):
            return getattr(mujoco, name)

    monkeypatch.setattr(built, "mujoco", Engine())
    response = simulate(scene(0.2, start=Start(tilt=0.1)))
    assert response.outcome == "failed"
    with pytest.raises(Mismatch, match=words):
        built.build(scene(0.2), 1e-3, plain=False)


@pytest.mark.parametrize("setting, value, most", [("RECOVERY", 150.0, 2e-4), ("IMPEDANCE", 0.9995, 2e-4)])
def test_constants_of_the_contact_are_insensitive(monkeypatch, setting, value, most):
    usual = impact_errors(simulate, 0.3, 212.0, 2, 2.0)[0]
    monkeypatch.setattr(built, setting, value)
    assert abs(impact_errors(simulate, 0.3, 212.0, 2, 2.0)[0] - usual) < most


def test_a_contact_that_takes_back_more_than_it_must_throws_the_block(monkeypatch):
    """k = 1/h^2: what has sunk comes back within a step, with its speed."""
    usual = impact_errors(simulate, 0.3, None, 2, 2.5)[0]
    monkeypatch.setattr(built, "contact_reference", lambda step, recovery: (-1 / step**2, -1 / step))
    assert impact_errors(simulate, 0.3, None, 2, 2.5)[0] > 10 * usual


# Classes of scenes far from the Caryatid.


def released(slenderness=0.28, tilt=0.6, base=212.0, damping=0.0, stiffness=1.0, duration=2.0, **block):
    bearings = Bearings(count=4, ka=6.22e4 * stiffness, kb=6.22e3 * stiffness, alpha=44.69, damping=damping)
    given = scene(slenderness, base, duration, start=Start(tilt=tilt * slenderness), bearings=bearings)
    return given.with_(block=block) if block else given


def assert_like_the_model(given, peak=5e-3, error=1e-3, variant=None):
    model, response = exact(given), simulate(given, variant=variant)
    assert response.outcome == model.outcome, response.failure
    assert response.peak_tilt == pytest.approx(model.peak_tilt, rel=peak)
    if given.base is not None:
        assert response.peak_base_displacement == pytest.approx(model.peak_base_displacement, rel=peak)
    strong = [
        impact
        for impact in response.impacts
        if abs(impact.rate_before) > 0.2 * max(abs(other.rate_before) for other in model.impacts)
    ]
    assert strong
    for impact in strong:
        assert impact.rate_after / impact.rate_before == pytest.approx(max(restitution(given), 0.0), abs=error)
    return response


def test_viscous_force_is_of_second_order():
    """At the velocity half a step early or late it is of first: the errors of twice the step are twice as large."""
    given = AnyScene(
        block=Block(mass=100.0, radius=1.0, slenderness=0.6),
        base=Base(mass=20.0),
        duration=0.2,
        bearings=Bearings(law="linear", ka=2e4, damping=1e3),
        start=Start(base_velocity=0.2),
    )
    wanted = exact(given).end.base_displacement
    errors = [simulate(given, variant="fixed-step", step=step).end.base_displacement - wanted for step in (2e-3, 1e-3)]
    assert 3 < errors[0] / errors[1] < 5


def test_an_undamped_base_keeps_its_frequency():
    """x = x_0 cos(omega t) under a standing block, after 200 periods; .25 rad off without the mass that goes by h^2."""
    stiff = Bearings(law="linear", count=4, ka=1e10)
    still = scene(0.2, 4e5, duration=1.0, bearings=stiff, start=Start(base_displacement=1e-6))
    frequency = math.sqrt(4 * stiff.ka / still.total_mass)
    end = simulate(still.with_(duration=200.25 * 2 * math.pi / frequency), history=False).end
    assert abs(end.base_displacement) < 0.01 * 1e-6 and end.base_velocity == pytest.approx(-1e-6 * frequency, rel=0.01)


def test_a_base_that_vibrates_when_impacts_kick_it():
    """181 times as fast as the block rocks: its peak displacement was off by 8.5 %."""
    body = Block(mass=0.0028408, radius=0.00431217, slenderness=0.190836)
    fast = AnyScene(
        block=body,
        base=Base(mass=0.0753736),
        bearings=Bearings(law="linear", count=4, ka=1058839.0),
        start=Start(tilt=-0.1155137),
        duration=0.287935,
    )
    peaks = [solver(fast, history=False).peak_base_displacement for solver in (simulate, exact)]
    assert peaks[0] == pytest.approx(peaks[1], rel=0.015)


@pytest.mark.parametrize(
    "slenderness, share, base", [(0.45, 1.05, None), (0.28, 1.1, 212.0), (0.7, 4 / 3, None), (0.3, 3.0, None)]
)
def test_inertia_near_a_point_mass_and_stocky_blocks(slenderness, share, base):
    given = scene(slenderness, base, 2.0, start=Start(tilt=0.6 * slenderness))
    assert_like_the_model(given.with_(block={"corner_inertia": share * 3172.05 * 1.0884**2}), error=5e-4)


@pytest.mark.parametrize("tilt", [2e-4, 2e-3])
def test_small_swings_are_seen(tilt):
    given = scene(0.25, duration=0.1 * math.sqrt(tilt / 2e-3), start=Start(tilt=tilt * 0.25))
    assert_like_the_model(given, error=1e-3)


@pytest.mark.parametrize(
    "slenderness, tilt, base", [(0.05, 0.08, 1.4), (0.05, 0.08, None), (0.03, 0.5, None), (0.11, 6e-3, None)]
)
def test_restitution_of_slender_blocks_and_small_swings_is_read_after_the_impact(slenderness, tilt, base):
    """The block lands a little beyond level: e was 1.00 where flat contact began even nearer to it."""
    given = scene(slenderness, base, 20.0, start=Start(tilt=tilt * slenderness))
    times = [impact.time for impact in exact(given, history=False).impacts[:5]]
    assert_like_the_model(given.with_(duration=0.5 * (times[-1] + times[-2])), error=1e-3)


@pytest.mark.parametrize("slenderness", [0.1, 0.3])
@pytest.mark.parametrize("base", [None, 2633.0])
def test_small_swings_keep_their_rate(slenderness, base):
    given = scene(slenderness, base, 2.0, start=Start(tilt=1e-2 * slenderness))
    found = [impact.rate_after / impact.rate_before for impact in simulate(given, history=False).impacts[:3]]
    np.testing.assert_allclose(found, restitution(given), atol=1e-3)


def test_a_pulse_little_above_uplift():
    """One sine at 1.076 times uplift: lifting up to a step late takes 2.4 % of the peak, .004 slendernesses."""
    body = Block(mass=7539.3872, radius=3.8157178, slenderness=0.14997602, corner_inertia=169121.3955)
    given = AnyScene(
        block=body, motion=PulseMotion("one-sine", -1.5947104159, 5.8384598, start=0.0344393), duration=5.0
    )
    wanted = exact(given, history=False).peak_tilt
    late, less = (abs(simulate(given, largest_step=step).peak_tilt / wanted - 1) for step in (2e-4, 5e-5))
    assert late < 0.05 and less < 0.5 * late
