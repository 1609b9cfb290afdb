"""The loop that steps leapfrog engines: its order, what it gives, how runs end; and what holds for all its engines."""

import math
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from engine_cases import impact_errors as released_errors
from engine_cases import scene

from analytic import Base, Bearings, Block, PulseMotion, SampledMotion, Scene, Start
from analytic import simulate as exact
from analytic.caryatid import BEARINGS
from analytic.rocking import restitution
from comparisons.measuring.errors import impact_errors, rms
from engines import get_engine, stepping
from engines.checks import energy_gain
from engines.stepping import NoSolution, march, mean_loads, sampled_loads
from engines.vibration import added_mass

LINEAR = Bearings(law="linear", count=1, ka=2e6)
RULED = ["pybullet", "mujoco", "pymunk", "dart"]
VARIANTS = [(name, "impact-aware") for name in RULED] + [(name, "fixed-step") for name in RULED[:2]]


class Flying:
    """A block that flies and a base on its bearings, moved exactly as leapfrog has it; nothing touches."""

    def __init__(self, given):
        self.place, self.speed, self.given = [0.3, 0.0, 5.0, given.start.base_displacement], [0.7, 0.0, 0.0, 0.0], given
        self.added, self.loads = 0.0, []

    def step(self, step, before, across, up, impulse):
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
    errors = [abs(flown(given, step)[0][-1, 4] - wanted) for step in (1e-3, 5e-4)]
    assert 3.3 < errors[0] / errors[1] < 4.7
    assert abs(flown(given, 5e-4, plain=True)[0][-1, 4] - wanted) > 20 * errors[1]


def test_the_ground_and_gravity_give_exactly_what_they_have():
    """Sums of what all steps give: the ground's velocity and g t, at half a step before the end, in any steps."""
    motion = PulseMotion("one-sine", 3.0, 21.0, start=0.013, vertical=PulseMotion("one-sine", 2.0, 21.0, start=0.013))
    rows, bodies = flown(scene(0.2, 212.0, 0.2, motion=motion), 7e-3)
    step, across, up, _ = np.array(bodies.loads).T
    fine = np.linspace(0.0, step.sum() - 0.5 * step[-1], 400_001)
    middle = 0.5 * (fine[1:] + fine[:-1])
    for sums, level in ((across, motion.acceleration(middle)), (up, motion.vertical.acceleration(middle) + 9.81)):
        assert -sums.sum() == pytest.approx(level.sum() * fine[1], abs=1e-6)
    assert rows[-1, 0] == pytest.approx(0.2, abs=1e-9)


@pytest.mark.parametrize("damping", [1e4, 1e6, 1e9])
def test_a_damper_of_any_strength_is_stable(damping):
    """A base under the acceleration a creeps at a m/c."""
    bearings = Bearings(law="linear", count=1, ka=1e-3, damping=damping)
    pushed = scene(0.2, 212.0, 0.1, bearings=bearings, motion=PulseMotion("rectangular", -2.0, math.pi / 0.1))
    rows, _ = flown(pushed, 1e-3)
    assert np.abs(rows[:, 5]).max() <= 2.0 * 212.0 / damping + 2e-3 and np.isfinite(rows).all()


@pytest.mark.parametrize("damping", [1e-9, 1.0, 50.0, 1e9])
def test_mass_added_for_damping_is_exact_and_bounded(damping):
    """v' after an interval under c v alone: v exp(-c t/m)."""
    after = 1 - damping * 0.1 / (2.0 + added_mass(damping, 0.1, 2.0))
    assert after == pytest.approx(math.exp(-damping * 0.05), abs=1e-9)


class Lost(Flying):
    def step(self, *loads):
        if len(self.loads) == 10:
            raise NoSolution("no way: the words")
        return super().step(*loads)


class Unfinite(Flying):
    def step(self, *loads):
        return (math.nan if len(self.loads) == 10 else 0.0, *super().step(*loads)[1:])


class Spinning(Flying):
    def __init__(self, given):
        super().__init__(given)
        self.speed[0] = 100.0


@pytest.mark.parametrize(
    "kind, words, rows",
    [(Lost, "no way: the words", 11), (Unfinite, "not finite", 12), (Spinning, "overturned", 14)]
    + [(Flying, "too many steps", 51)],
)
def test_how_a_run_ends(monkeypatch, kind, words, rows):
    monkeypatch.setattr(stepping, "row_limit", lambda duration, largest: 50)
    given = scene(0.2, 212.0, 0.1, bearings=LINEAR)
    bodies = kind(given)
    found, ended = march(bodies, given, 0.1, lambda points: 1e-3, mean_loads(given, bodies, 1e-3), 1e-3)
    assert (ended, len(found)) == (words, rows)


# In the engines.


@pytest.fixture(params=VARIANTS, ids=" ".join)
def run(request):
    """The function `traced` of an engine with a variant."""
    name, variant = request.param
    return partial(get_engine(name).traced, variant=variant)


@pytest.fixture(params=RULED)
def engine(request):
    return get_engine(request.param)


@pytest.mark.parametrize(
    "name, slenderness, starts, seconds, finer, least, most",
    [("mujoco", 0.2, 4, 2.5, 8, 4, 16), ("pybullet", 0.45, 8, 3.0, 4, 2.5, 6.5)],
)
def test_fixed_steps_are_of_first_order(name, slenderness, starts, seconds, finer, least, most):
    simulate = partial(get_engine(name).simulate, variant="fixed-step")
    coarse, fine = (
        released_errors(simulate, slenderness, None, starts, seconds, step=step)[0] for step in (1.6e-3, 1.6e-3 / finer)
    )
    assert least < coarse / fine < most  # `finer` but for the phase of the steps


@pytest.mark.parametrize("base, fine", [(None, 2e-5), (212.0, 5e-6)])
def test_the_error_of_restitution_falls_along_the_ladder(engine, base, fine):
    """From the energies of swings, which count what flight loses."""
    scenes, errors = [scene(0.2, base, 3.5, start=Start(tilt=share * 0.2)) for share in (0.3, 0.55, 0.8)], []
    for step in engine.variants["impact-aware"].levels:
        off = [impact_errors(given, engine.simulate(given, largest_step=step), 2)["swing"] for given in scenes]
        errors.append(rms(np.concatenate(off)))
    assert errors == sorted(errors, reverse=True)
    assert errors[0] > 20 * errors[-1] and errors[1] < 2e-4 and errors[-1] < fine


def test_momentum_is_kept_and_no_energy_comes_from_nowhere(run):
    """Nothing pushes a free base and its block from outside: m x' + m_b v = 0, through impacts."""
    for base in (None, 212.0):
        given = scene(0.3, base, 3.0, start=Start(tilt=0.2))
        _, trace = run(given)
        assert energy_gain(given, trace) < 2e-3
    momentum = 3172.05 * trace.centre[:, 2] + 212.0 * trace.base_velocity
    assert np.abs(momentum).max() < 1e-6 * 212.0 * np.abs(trace.base_velocity).max()


@pytest.mark.parametrize("radius", [0.1, 10.0])
def test_steps_go_with_the_size_of_the_block(run, radius):
    mass = 2460.0 * radius**3
    given = Scene(
        block=Block(mass=mass, radius=radius, slenderness=0.25),
        base=Base(mass=0.1 * mass),
        start=Start(tilt=0.15),
        duration=2.0 * math.sqrt(radius),
    )
    response, _ = run(given, history=False)
    found = [impact.rate_after / impact.rate_before for impact in response.impacts[:2]]
    assert found == pytest.approx([restitution(given)] * 2, abs=1e-4 if response.variant == "impact-aware" else 5e-3)


def test_friction_of_the_scene_is_coulombs(engine):
    """A push of .3 g for .05 s on a block that slides at .2 g: (.1 g t^2/2)(1 + .1/.2), and it stays there."""
    given = scene(0.45, duration=0.5, friction=0.2, motion=PulseMotion("rectangular", -0.3 * 9.81, math.pi / 0.05))
    _, trace = engine.traced(given)
    assert abs(trace.centre[-1, 0]) == pytest.approx(0.5 * 0.1 * 9.81 * 0.05**2 * 1.5, rel=1e-3)
    assert engine.simulate(given.with_(friction=0.35)).outcome == "stands"
    far = engine.simulate(given.with_(motion=PulseMotion("rectangular", 3.0, math.pi), duration=2.0))
    assert far.failure is None  # Newmark, as above, in a second
    assert far.sliding.peak == pytest.approx(0.5 * (3.0 - 0.2 * 9.81) * 3.0 / (0.2 * 9.81), rel=1e-3)


@pytest.mark.parametrize("base", [160.0, 3e4])
@pytest.mark.parametrize("damping", [0.0, 300.0, 1e4])
def test_bases_on_bearings(engine, base, damping):
    bearings = BEARINGS.model_copy(update={"damping": damping})
    given = scene(0.28, base, 1.0, bearings=bearings, start=Start(tilt=0.168))
    model, response = exact(given), engine.simulate(given)
    assert response.outcome == model.outcome, response.failure
    assert response.peak_base_displacement == pytest.approx(model.peak_base_displacement, rel=5e-3)
    here, there = (one.impacts[0].rate_after / one.impacts[0].rate_before for one in (response, model))
    assert here == pytest.approx(there, abs=1e-3)


@pytest.mark.parametrize("shape", ["one-cosine", "rectangular"])
def test_a_pulse_that_begins_with_a_jump_lifts_the_block_at_once(engine, shape):
    """Where a kick held the jump the block lifted a step late: .03 of the tilt five steps later."""
    pulse = PulseMotion(shape, 1.3 * 9.81 * math.tan(0.2), 6.0, 0.10037)
    given, late = scene(0.2, duration=0.3, motion=pulse), [pulse.start + 0.02, pulse.start + 0.1]
    histories = exact(given).history, engine.simulate(given).history
    wanted, found = (np.interp(late, history.time, history.tilt) for history in histories)
    np.testing.assert_allclose(found, wanted, rtol=1e-3)


def test_a_block_comes_to_rest_under_a_motion_below_uplift_and_stays_there(engine):
    """A push beyond uplift, peak tilt .0033 slendernesses, then .8 of uplift for 6 s: no corner lifts by itself."""
    time, unit = 0.01 * np.arange(801), 9.81 * math.tan(0.28)
    level = 0.8 * np.sin(8 * time)
    level[100:153] += 0.3 * np.sin(12 * (time[100:153] - 1.0))
    given = Scene(
        block=Block(mass=2000.0, radius=0.989, slenderness=0.28), motion=SampledMotion(0.01, unit * level), duration=8.0
    )
    model, (response, trace) = exact(given), engine.traced(given)
    assert response.peak_tilt == pytest.approx(model.peak_tilt, rel=2e-2)
    late = trace.time > model.rests[-1] + 0.2
    assert np.abs(trace.tilt[late]).max() < 1e-5 * 0.28 < 1e-2 * model.peak_tilt


def test_bearings_too_stiff_for_any_number_of_steps_fail_at_once(engine):
    response = engine.simulate(scene(0.2, 212.0, 1e4, bearings=Bearings(law="linear", ka=1e12)))
    assert response.outcome == "failed" and response.failure.reason == "too many steps"
    assert response.cpu_seconds != response.cpu_seconds  # nothing was stepped


def test_steps_of_a_first_script_are_all_the_same(engine):
    settings = engine.variants["first-script"].settings
    run = engine.run(scene(0.2, duration=0.1234, start=Start(tilt=0.1)), "first-script", replace(settings, step=1e-3))
    np.testing.assert_allclose(np.diff(run.trace.time), 1e-3, rtol=1e-9)
    assert run.trace.time[-1] == pytest.approx(0.123)
