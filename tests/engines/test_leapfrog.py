"""What leapfrog engines share: places and speeds at the start, the ground's velocity, the length of steps, rows to
traces; the loop that steps them, its order, what it gives and how runs end; and what is particular to each.
"""

import bisect
import importlib
import math
from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest
from engine_cases import CASES, impact_errors, scene

from analytic import Base, Bearings, Block, PulseMotion, SampledMotion, Scene, Start
from analytic import simulate as exact
from analytic.motion import PULSES
from analytic.rocking import restitution
from analytic.scene import BEARINGS
from comparisons.metrics import errors
from comparisons.metrics.errors import rms
from engines import get_engine
from engines import loop as stepping
from engines.contract import Mismatch
from engines.loads import added_mass, ground_gain, ground_velocities, ground_velocity, placement
from engines.loop import (
    GROWTH,
    HOLD,
    NEAR,
    SHARE,
    ImpactAware,
    NoSolution,
    aligned,
    failure_of,
    gap_rule,
    limits,
    march,
    mean_loads,
    raw_trace_of,
    require,
    sampled_loads,
    step_limits,
    trace_of,
)
from engines.trace_checks import IMPULSE_LIMIT, energy_gain, impulse_error

LINEAR = Bearings(law="linear", count=1, ka=2e6)
RULED = ["pybullet", "mujoco", "pymunk", "dart"]
TILTED = Scene(block=Block(mass=10.0, radius=1.0, slenderness=0.3), start=Start(tilt=0.2), duration=1.0)


def test_what_an_engine_holds_is_compared_with_what_it_was_given_and_all_that_differs_is_named():
    round_off = 3172.05 * (1 + 5e-13)
    require([("mass", round_off, 3172.05), ("damping", np.zeros(4), 0.0), ("contact", [1.0, 1.0], [1.0])])
    for used, wanted, words in (
        (3172.05 * (1 + 3e-12), 3172.05, "mass is 3172.05"),
        (math.nan, 1.0, "mass is nan, not 1.0"),
        ([1.0, 2.0], [1.0, 3.0], r"mass is \[1.0, 2.0\], not \[1.0, 3.0\]"),
        ([1.0, 2.0], [1.0, 2.0, 3.0], "mass is"),
        (np.zeros(3), 1e-13, "mass is"),
    ):
        with pytest.raises(Mismatch, match=f"^{words}.*; friction is 0.5, not 0.7$"):
            require([("step", 1.0, 1.0), ("mass", used, wanted), ("friction", 0.5, 0.7)])


@pytest.mark.parametrize("tilt, rate", [(0.1, 0.3), (-0.1, 0.3), (0.0, -0.2), (0.0, 0.0)])
def test_the_block_at_the_start_turns_about_its_lower_corner_which_stays_on_the_base(tilt, rate):
    start = Start(tilt=tilt, tilt_rate=rate, base_displacement=0.2, base_velocity=-0.4)
    given = TILTED.with_(base=Base(mass=5.0), start=start)
    x, z, vx, vz = placement(given)
    b, h = math.copysign(1.0, tilt or rate) * given.block.half_width, given.block.half_height
    # The corner from the centre, turned by the tilt toward +x: (b, -h).
    across, up = b * math.cos(tilt) - h * math.sin(tilt), -h * math.cos(tilt) - b * math.sin(tilt)
    corner = x + across, z + h + up, vx + rate * up, vz - rate * across
    assert corner == pytest.approx((0.2 + b, 0.0, -0.4, 0.0), abs=1e-14)


PHASES = [("one-sine", 0.8), ("half-sine", 0.8), ("one-cosine", 0.8)]


@pytest.mark.parametrize("shape, phase", [*((shape, 0.0) for shape in PULSES), *PHASES])
def test_the_grounds_velocity_is_the_integral_of_its_acceleration(shape, phase):
    pulse = PulseMotion(shape, 2.0, 5.0, start=0.3, phase=phase)
    velocity, time = ground_velocity(pulse), np.linspace(pulse.start, pulse.end, 200_001)
    gained = np.cumsum(pulse.acceleration(0.5 * (time[1:] + time[:-1]))) * (time[1] - time[0])
    assert velocity(pulse.end + 1.0) == pytest.approx(gained[-1], abs=1e-8)
    np.testing.assert_allclose([velocity(t) for t in time[4000::4000].tolist()], gained[3999::4000], rtol=0, atol=1e-8)


@pytest.mark.parametrize(
    "motion", [PulseMotion("one-sine", 2.0, 5.0, start=0.3), SampledMotion(0.3, np.array([1.0, -2.0, 3.0, 4.0]))]
)
def test_the_grounds_velocity_is_the_same_at_many_times_and_between_two(motion):
    """At samples, between them, at the last one and beyond it."""
    velocity, gain, times = ground_velocity(motion), ground_gain(motion), np.linspace(0.0, 2.0, 41)
    values = [velocity(t) for t in times.tolist()]
    np.testing.assert_allclose(ground_velocities(motion, times), values, rtol=0, atol=1e-15)
    for i, begin in enumerate(times.tolist()):
        assert [gain(begin, t) for t in times[i:].tolist()] == [value - values[i] for value in values[i:]]


# The length of steps: small where a point lands, held after it, growing else; jumps of the ground and the end met.

LARGEST, SMALLEST, G = 1e-3, 1e-6, 9.81
APART = (1.0, 0.0)  # gap and closing speed of a point that nothing is about to happen to


@pytest.fixture
def fresh():
    return gap_rule(LARGEST, SMALLEST, G)


@pytest.fixture
def grown(fresh):
    """A rule that has come to the largest step."""
    while fresh([APART] * 4) < LARGEST:
        pass
    return fresh


@pytest.mark.parametrize("height, closing, pull", [(1e-4, 0.0, G), (0.3, 0.0, G), (1e-4, 0.1 * G * LARGEST, 0.0)])
def test_a_falling_point_lands_in_the_smallest_step_whatever_its_height(fresh, height, closing, pull):
    """As leapfrog has it fall; a slow landing, at a tenth of what gravity gives in a largest step, is seen as well."""
    gap, h, lengths = height, 0.0, []
    while gap > 0:
        lengths.append(fresh(((gap, closing),) * 5))
        closing += pull * (h + lengths[-1]) / 2
        h = lengths[-1]
        gap -= h * closing
    assert lengths[-2:] == [SMALLEST] * 2 and -gap <= SMALLEST * closing  # how deep
    assert max(lengths) == LARGEST or height < 1e-3


def test_each_step_to_a_landing_is_the_share_of_the_time_that_is_left_to_the_nearest_one(grown):
    for gap in (1e-3, 5e-4, 1e-4, 1e-5):
        assert grown((APART, (gap, 0.5))) == pytest.approx(min(LARGEST, SHARE * gap / 0.5))
        while grown((APART, APART)) < LARGEST:
            pass
    points = [(0.1, 0.2), (1e-4, 0.4), (1e-4, -0.4), (3e-4, 0.1)]
    for turn in range(4):
        assert grown(points[turn:] + points[:turn]) == SHARE * 1e-4 / 0.4


def test_steps_grow_but_not_while_a_point_lands(fresh):
    """An engine that meets a contact in the step after it has sunk must not meet it in a longer one."""
    first = fresh((APART,))
    assert {fresh(((-1e-8, 0.3), APART)) for _ in range(12)} == {first}
    standing = (-1e-8, 1.9 * G * first)  # falls in a step at g h or less
    assert {fresh((standing, APART)) for _ in range(HOLD - 1)} == {first}
    assert [fresh((standing, APART)) for _ in range(3)] == pytest.approx([first * (1 + GROWTH) ** k for k in (1, 2, 3)])


def test_what_a_contact_leaves_to_a_pivot_is_no_landing(grown):
    """It hops by less than NEAR g h^2, and falls back at less than 2 g h: steps stay the largest."""
    hop, fall = 0.9 * NEAR * G * LARGEST**2, 1.9 * G * LARGEST
    assert {grown((APART, (hop, fall * (k % 2)))) for k in range(50)} == {LARGEST}
    assert grown((APART, (1.1 * NEAR * G * LARGEST**2, fall))) < LARGEST


def test_the_smallest_step_goes_with_the_square_of_the_largest():
    usual, twice = (step_limits(TILTED, ImpactAware(largest_step=step)) for step in (2e-4, 4e-4))
    assert twice == pytest.approx((2 * usual[0], 4 * usual[1]))


@pytest.mark.parametrize("step", [0.29, 0.31, 1.7e-3])
def test_steps_meet_the_jumps_between_two_kicks_and_end_with_the_run(step):
    """A kick acts from half the step before to half the step after; none of them holds a jump."""
    t, before, halves = 0.0, 0.0, []
    limit, fitted = limits(3.0, step, [1.0, 1.25, 2.0])
    while t < 3.0 - 1e-9 * step:
        h = step
        if t + h >= limit:
            h, limit = fitted(t, h)
        assert 0 < h <= step * (1 + 1e-9)
        halves += [t - 0.5 * before, t + 0.5 * h]
        t, before = t + h, h
    assert t == pytest.approx(3.0, abs=1e-9 * step)
    assert all(min(abs(half - jump) for half in halves) < 1e-3 * step for jump in (1.0, 1.25, 2.0))
    assert aligned(1.0, -0.2) == aligned(1.0, 1.001) == aligned(1.0, math.inf) == aligned(1.0, 1e-4) == 1.0


# Velocities half a step early become those at the steps' ends.


def rows():
    """The motion tilt = .2 + .1 t - t^2, x = .3 t^2 at random steps; the rates are those half a step before the row."""
    h = np.append(0.0, np.random.default_rng(0).uniform(5e-4, 2e-3, 400))
    t = np.cumsum(h)
    early, zeros = t - 0.5 * h, np.zeros_like(t)
    return np.column_stack([t, h, 0.2 + 0.1 * t - t**2, 0.1 - 2 * early, 0.3 * t**2, 0.6 * early, zeros, zeros])


def test_velocities_are_brought_to_the_displacements_but_in_a_first_script():
    trace, raw = trace_of(rows(), TILTED, 1e-9), raw_trace_of(rows(), TILTED, 1e-9)
    np.testing.assert_allclose(trace.tilt_rate, 0.1 - 2 * trace.time, atol=1e-12)
    np.testing.assert_allclose(trace.base_velocity, 0.6 * trace.time, atol=1e-12)
    assert np.abs(raw.tilt_rate - trace.tilt_rate)[1:].min() > 4e-4 and raw.first_script
    place = np.random.default_rng(1).normal(size=(401, 4))
    table = np.column_stack([rows(), place])
    assert raw_trace_of(table, TILTED, 1e-9).centre is None
    np.testing.assert_array_equal(raw_trace_of(table, TILTED.with_(friction=0.3), 1e-9).centre, place)


def test_an_impact_is_not_smeared_over_the_steps_beside_it():
    table = rows()
    after = table[:, 2] < 0
    table[after, 3] *= 0.5  # a jump of the rate where the tilt changes side
    k, trace = int(np.argmax(after)), trace_of(table, TILTED, 1e-9)
    exact_rate = 0.1 - 2 * trace.time
    assert trace.tilt_rate[k - 1 : k + 1] == pytest.approx(exact_rate[k - 1 : k + 1] * [1.0, 0.5], abs=1e-9)


@pytest.mark.parametrize("ended, words", [("not finite", "no longer finite"), ("too many steps", "too many steps")])
def test_the_failure_says_where_the_run_ended(ended, words):
    failure = failure_of(TILTED, rows(), ended)
    assert words in failure.reason and f"{rows()[-1, 0]:.9g} s" in failure.message and "400" in failure.message


# The loop.


class Flying:
    """A block that flies and a base on its bearings, moved exactly as leapfrog has it; nothing touches."""

    def __init__(self, given, spin=0.7, after=None):
        self.place, self.given, self.after = [0.3, 0.0, 5.0, given.start.base_displacement], given, after
        self.speed, self.added, self.loads = [spin, 0.0, 0.0, 0.0], 0.0, []

    def step(self, step, before, across, up, impulse):
        if self.after and len(self.loads) == 10:
            self.after(self)
        gains = 0.0, across, up, across + impulse / (self.given.base.mass + self.added)
        self.loads.append((step, *gains[1:3], impulse))
        self.speed = [v + gain for v, gain in zip(self.speed, gains, strict=True)]
        self.place = [x + step * v for x, v in zip(self.place, self.speed, strict=True)]
        (tilt, x, z, base), (rate, vx, vz, v) = self.place, self.speed
        return tilt, rate, x, z, vx, vz, base, v

    def weigh(self, added):
        self.added = added


def flown(given, step, plain=False):
    """Rows of a `Flying` block in steps of this length and half of it in turn."""
    bodies, lengths = Flying(given), iter([step, 0.5 * step, 0.5 * step] * 10**5)
    loads = sampled_loads(given) if plain else mean_loads(given, bodies, step)
    rows, ended = march(bodies, given, given.duration, lambda points: next(lengths), loads, step)
    assert ended == "done"
    return rows, bodies


@pytest.mark.parametrize("damping", [0.0, 2e3])
def test_loads_for_the_mean_of_two_steps_are_of_second_order_in_uneven_steps(monkeypatch, damping):
    """In uneven steps loads as they are, of one step, are wrong at any length."""
    monkeypatch.setattr(stepping, "driven_mass", lambda model: 212.0)  # nothing stands on this base
    bearings = LINEAR.model_copy(update={"damping": damping})
    given = scene(0.2, 212.0, 0.2, bearings=bearings, start=Start(base_displacement=0.01))
    decay, frequency = damping / 424.0, math.sqrt(2e6 / 212.0 - (damping / 424.0) ** 2)
    wanted = 0.01 * math.exp(-decay * 0.2) * (math.cos(0.2 * frequency) + decay / frequency * math.sin(0.2 * frequency))
    off = [abs(flown(given, step)[0][-1, 4] - wanted) for step in (1e-3, 5e-4)]
    assert 3.3 < off[0] / off[1] < 4.7
    assert abs(flown(given, 5e-4, plain=True)[0][-1, 4] - wanted) > 20 * off[1]


def test_the_ground_and_gravity_give_exactly_what_they_have():
    """Sums of what all steps give: the ground's velocity and g t, at half a step before the end, in any steps."""
    motion = PulseMotion("one-sine", 3.0, 21.0, start=0.013, vertical=PulseMotion("one-sine", 2.0, 21.0, start=0.013))
    rows, bodies = flown(scene(0.2, 212.0, 0.2, motion=motion, gravity=3.7), 7e-3)
    step, across, up, _ = np.array(bodies.loads).T
    fine = np.linspace(0.0, step.sum() - 0.5 * step[-1], 400_001)
    middle = 0.5 * (fine[1:] + fine[:-1])
    for sums, level in ((across, motion.acceleration(middle)), (up, motion.vertical.acceleration(middle) + 3.7)):
        assert -sums.sum() == pytest.approx(level.sum() * fine[1], abs=1e-6)
    assert rows[-1, 0] == pytest.approx(0.2, abs=1e-9)


@pytest.mark.parametrize("damping", [1e4, 1e9])
def test_a_damper_of_any_strength_is_stable(damping):
    """A base under the acceleration a creeps at a m/c."""
    bearings = Bearings(law="linear", count=1, ka=1e-3, damping=damping)
    pushed = scene(0.2, 212.0, 0.1, bearings=bearings, motion=PulseMotion("rectangular", -2.0, math.pi / 0.1))
    rows, _ = flown(pushed, 1e-3)
    assert np.abs(rows[:, 5]).max() <= 2.0 * 212.0 / damping + 2e-3 and np.isfinite(rows).all()


@pytest.mark.parametrize("damping", [1e-9, 50.0, 1e9])
def test_mass_added_for_damping_is_exact_and_bounded(damping):
    """v' after an interval under c v alone: v exp(-c t/m)."""
    after = 1 - damping * 0.1 / (2.0 + added_mass(damping, 0.1, 2.0))
    assert after == pytest.approx(math.exp(-damping * 0.05), abs=1e-9)


def lost(bodies):
    raise NoSolution("no way: the words")


def unfinite(bodies):
    bodies.speed[0] = math.nan


@pytest.mark.parametrize(
    "spin, after, words, count",
    [(0.7, lost, "no way: the words", 11), (0.7, unfinite, "not finite", 12)]
    + [(100.0, None, "overturned", 14), (0.7, None, "too many steps", 51)],
)
def test_how_a_run_ends(monkeypatch, spin, after, words, count):
    monkeypatch.setattr(stepping, "row_limit", lambda duration, largest: 50)
    given = scene(0.2, 212.0, 0.1, bearings=LINEAR)
    bodies = Flying(given, spin, after)
    rows, ended = march(bodies, given, 0.1, lambda points: 1e-3, mean_loads(given, bodies, 1e-3), 1e-3)
    assert (ended, len(rows)) == (words, count)


# In the engines.

every_ruled = pytest.mark.parametrize("engine", RULED)


@every_ruled
def test_the_error_of_restitution_falls_along_the_ladder(engine):
    """From the energies of swings, which count what flight loses."""
    engine, errors_found = get_engine(engine), []
    scenes = [scene(0.2, 212.0, 3.5, start=Start(tilt=share * 0.2)) for share in (0.3, 0.55, 0.8)]
    for step in engine.variants["impact-aware"].levels:
        off = [errors.impact_errors(given, engine.simulate(given, largest_step=step), 2)["swing"] for given in scenes]
        errors_found.append(rms(np.concatenate(off)))
    assert errors_found == sorted(errors_found, reverse=True)
    assert errors_found[0] > 20 * errors_found[-1] and errors_found[1] < 2e-4 and errors_found[-1] < 5e-6


@pytest.mark.parametrize("engine, variant", [*((name, "impact-aware") for name in RULED), ("pybullet", "fixed-step")])
def test_momentum_is_kept_and_no_energy_comes_from_nowhere(engine, variant):
    """Nothing pushes a free base and its block from outside: m x' + m_b v = 0, through impacts."""
    block = Block(mass=2.46, radius=0.1, slenderness=0.25)
    given = Scene(block=block, base=Base(mass=0.1 * block.mass), start=Start(tilt=0.15), duration=0.64)
    response, trace = get_engine(engine).traced(given, variant=variant, history=False)
    ratios = [impact.rate_after / impact.rate_before for impact in response.impacts[:2]]
    assert ratios == pytest.approx([restitution(given)] * 2, abs=1e-4 if variant == "impact-aware" else 5e-3)
    assert energy_gain(given, trace) < 2e-3
    momentum = 10 * trace.centre[:, 2] + trace.base_velocity
    assert np.abs(momentum).max() < 1e-6 * np.abs(trace.base_velocity).max()


@every_ruled
def test_friction_of_the_scene_is_coulombs(engine):
    """A push of .3 g for .05 s on a block that slides at .2 g: (.1 g t^2/2)(1 + .1/.2), and it stays there."""
    engine = get_engine(engine)
    given = scene(0.45, duration=0.5, friction=0.2, motion=PulseMotion("rectangular", -0.3 * 9.81, math.pi / 0.05))
    _, trace = engine.traced(given)
    assert abs(trace.centre[-1, 0]) == pytest.approx(0.5 * 0.1 * 9.81 * 0.05**2 * 1.5, rel=1e-3)
    assert engine.simulate(given.with_(friction=0.35)).outcome == "stands"


@every_ruled
@pytest.mark.parametrize("base, damping", [(160.0, 1e4), (3e4, 300.0)])
def test_bases_on_bearings(engine, base, damping):
    bearings = BEARINGS.model_copy(update={"damping": damping})
    given = scene(0.28, base, 1.0, bearings=bearings, start=Start(tilt=0.168))
    model, response = exact(given), get_engine(engine).simulate(given)
    assert response.outcome == model.outcome, response.failure
    assert response.peak_base_displacement == pytest.approx(model.peak_base_displacement, rel=5e-3)
    run_ratio, model_ratio = (
        result.impacts[0].rate_after / result.impacts[0].rate_before for result in (response, model)
    )
    assert run_ratio == pytest.approx(model_ratio, abs=1e-3)


@every_ruled
def test_a_pulse_that_begins_with_a_jump_lifts_the_block_at_once(engine):
    """Where a kick held the jump the block lifted a step late: .03 of the tilt five steps later."""
    pulse = PulseMotion("rectangular", 1.3 * 9.81 * math.tan(0.2), 6.0, 0.10037)
    given, late = scene(0.2, duration=0.3, motion=pulse), [pulse.start + 0.02, pulse.start + 0.1]
    histories = exact(given).history, get_engine(engine).simulate(given).history
    expected, computed = (np.interp(late, history.time, history.tilt) for history in histories)
    np.testing.assert_allclose(computed, expected, rtol=1e-3)


@every_ruled
def test_a_block_comes_to_rest_under_a_motion_below_uplift_and_stays_there(engine):
    """A push beyond uplift, peak tilt .0033 slendernesses, then .8 of uplift for 6 s: no corner lifts by itself."""
    time, unit = 0.01 * np.arange(801), 9.81 * math.tan(0.28)
    level = 0.8 * np.sin(8 * time)
    level[100:153] += 0.3 * np.sin(12 * (time[100:153] - 1.0))
    block = Block(mass=2000.0, radius=0.989, slenderness=0.28)
    given = Scene(block=block, motion=SampledMotion(0.01, unit * level), duration=8.0)
    model, (response, trace) = exact(given), get_engine(engine).traced(given)
    assert response.peak_tilt == pytest.approx(model.peak_tilt, rel=2e-2)
    late = trace.time > model.rests[-1] + 0.2
    assert np.abs(trace.tilt[late]).max() < 1e-5 * 0.28 < 1e-2 * model.peak_tilt


@every_ruled
def test_bearings_too_stiff_for_any_number_of_steps_fail_at_once(engine):
    response = get_engine(engine).simulate(scene(0.2, 212.0, 1e4, bearings=Bearings(law="linear", ka=1e12)))
    assert response.outcome == "failed" and response.failure.reason == "too many steps"
    assert response.cpu_seconds != response.cpu_seconds  # nothing was stepped


ROCKING = scene(0.2, 212.0, start=Start(tilt=0.1))


def built(engine):
    """The module that builds an engine's scene."""
    get_engine(engine)  # skips the test where it is an extra that is not installed
    return importlib.import_module(f"engines.{engine}.adapter")


# What an engine does not hold as asked is refused: calls of its API, each with the right function first.


def without_mass(change, body, link, mass=None, localInertiaDiagonal=None, **rest):
    change(body, link, **rest)


def other_text(old, new):
    def read(right, text):
        assert old in text
        return right(text.replace(old, new))

    return read


def forgetful_space(name):
    """Chipmunk's space with a setting that stays at 0.9."""
    stuck = {name: property(lambda space: 0.9, lambda space, value: None)}
    return lambda right: type("Forgetful", (right,), stuck)()


@pytest.mark.parametrize(
    "engine, call, wrong, words",
    [
        ("pybullet", "pybullet.changeDynamics", without_mass, "block: inertia is"),
        (
            "pybullet",
            "pybullet.changeDynamics",
            lambda change, body, link, **values: change(body, -1, **values),
            "friction",
        ),
        ("mujoco", "mujoco.MjModel.from_xml_string", other_text('mass="3172.05"', 'mass="3000.0"'), "3000.0], not"),
        ("mujoco", "mujoco.MjModel.from_xml_string", other_text('cone="elliptic"', ""), "cone is 0"),
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
        ("mujoco", None, "adapter.contact_reference", lambda usual: lambda step, recovery: (-1 / step**2, -1 / step)),
        # without split impulses what has sunk is thrown out
        ("dart", None, "adapter.DartBodies", lambda usual: lambda scene, plain: usual(scene, True)),
        # a light base needs iterations by the ratio of the masses
        ("pymunk", 212.0, "adapter.LIGHT", lambda usual: 0),
    ],
)
def test_settings_of_the_contact_bring_a_tenth_of_the_error(monkeypatch, engine, base, setting, other):
    simulate, (module, name) = get_engine(engine).simulate, setting.split(".")
    usual, module = impact_errors(simulate, 0.3, base, 2, 2.5)[0], importlib.import_module(f"engines.{engine}.{module}")
    monkeypatch.setattr(module, name, other(getattr(module, name)))
    assert impact_errors(simulate, 0.3, base, 2, 2.5)[0] > 10 * usual


# Troubles in an engine's own words.


@pytest.mark.parametrize(
    "trouble, reason, words",
    [
        (lambda mujoco, data: data.qvel.fill(math.inf), "finite", "unstable"),
        (lambda mujoco, data: mujoco.get_mju_user_warning()("Contact buffer is full"), "MuJoCo warned", "is full"),
    ],
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
    simulator = built("drake").Simulator
    advance = simulator.AdvanceTo

    def stuck(self, time):
        if time > 0.1:
            raise RuntimeError("solver failed to converge at simulation time = 0.1 with dt = 0.001.")
        advance(self, time)

    monkeypatch.setattr(simulator, "AdvanceTo", stuck)
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
    from engines.exudyn import scene as model

    commit = model.Bearing.commit

    def changed(self, mbs, x):
        def change(connector, name, value):
            if name == "stiffness":
                value = [gain * value[0], 0.0, 0.0]
                damping = self.law.count * self.law.damping - value[0] * delay  # the spring's force at x - delay v
                mbs.SetObjectParameter(connector, "damping", [damping, 0.0, 0.0])
            mbs.SetObjectParameter(connector, name, value)

        return commit(self, SimpleNamespace(SetObjectParameter=change), x)

    monkeypatch.setattr(model.Bearing, "commit", changed)


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


@pytest.mark.parametrize("engine", ["exudyn", "pybullet", "mujoco", "pymunk", "dart"])
@pytest.mark.parametrize("gain, delay", [(1.0, 0.0), (0.0, 0.0), (1.0, 1e-3), (1.01, 0.0)])
def test_a_force_inside_an_engine_that_is_lost_late_or_off_is_measured_and_a_large_error_a_failure(
    monkeypatch, engine, gain, delay
):
    (mutate_exudyn if engine == "exudyn" else mutate_leapfrog)(monkeypatch, gain, delay)
    response, trace = get_engine(engine).traced(DRIVEN)
    error, wrong = impulse_error(DRIVEN, trace), abs(gain - 1) > 0.1
    assert response.outcome == ("failed" if wrong else "rocks")  # by its energy, too, where the force is too small
    assert (error > IMPULSE_LIMIT) == wrong and (error > 4e-4) == ((gain, delay) != (1, 0))  # a clean run shows 4e-5
    assert delay or error == pytest.approx(abs(gain - 1), rel=0.02, abs=4e-5)


# What a record says that its adapter imposes on steps and loads is what `stepping` does with settings of their kind.

MEANS = {
    "loads times (step + step before)/(2 step), the ground's as its mean",
    "dampers and stiff bearings as mass added to the base",
    "velocities read half a step early",
}
IMPOSED = {
    stepping.ImpactAware: {"steps by gaps and closing speeds, which meet jumps of the ground's acceleration", *MEANS},
    stepping.FixedStep: MEANS,
    stepping.FirstScript: {"loads as where a step begins"},
}


@pytest.mark.parametrize("engine, variant", [case for case in CASES if case[0] != "exudyn"])
def test_a_leapfrog_engines_record_says_what_its_adapter_imposes(engine, variant):
    engine = get_engine(engine)
    record = engine.variants[variant]
    couple = {"restitution given: a couple before each landing"} if record.takes_restitution else set()
    assert {*record.imposes.split("; ")} - {"a plane, by joints"} == IMPOSED[type(record.settings)] | couple
    trace = engine.run(scene(0.2, 212.0, 0.01, start=Start(tilt=2e-3)), variant, record.settings).trace
    assert trace.first_script == isinstance(record.settings, stepping.FirstScript)
