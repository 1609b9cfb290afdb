import math

import numpy as np
import pytest
from bearing_laws import NAMES, bearings_of
from literature import A_TILT
from sliding_scenes import KINDS, slider_of

from analytic import Base, Block, PulseMotion, Scene, SceneError, SettingError, Start, simulate
from analytic.problems import problem_a
from analytic.rocking import momentum_restitution
from analytic.sliding.moreau import simulate_moreau

BLOCK = Block(mass=3172.05, radius=1.0884, slenderness=0.4)
BASES = [None, Base(mass=212.0), Base(mass=3000.0), Base(mass=1e9)]
G = 9.81


def block_on_ground(friction, motion, duration):
    return Scene(block=BLOCK, friction=friction, motion=motion, duration=duration)


@pytest.mark.parametrize("step", [1e-3, 3.1e-4, 1e-4])
def test_newmark_under_a_rectangular_pulse(step):
    """The block stops within one step, in which it could go mu g step^2."""
    a, mu, T = 4.0, 0.2, 0.4
    run = simulate_moreau(block_on_ground(mu, PulseMotion("rectangular", a, math.pi / T), 2.0), step=step)
    v = (a - mu * G) * T
    assert run.outcome == "slides" and run.impacts == run.peak_tilt == 0
    assert run.slip == pytest.approx(-(v * T / 2 + v**2 / (2 * mu * G)), abs=mu * G * step**2)
    assert run.path == pytest.approx(run.peak_slip) == pytest.approx(-run.slip)


@pytest.mark.parametrize("step", [1e-3, 3.1e-4, 1e-4])
def test_newmark_under_a_half_sine_pulse(step):
    """It also begins to slide within a step, in which the speed is off by up to a'_g step^2/8."""
    a, w, mu = 5.0, 6.0, 0.15
    run = simulate_moreau(block_on_ground(mu, PulseMotion("half-sine", a, w), 2.0), step=step)
    begin, end = math.asin(mu * G / a) / w, math.pi / w
    v = a / w * (math.cos(w * begin) + 1) - mu * G * (end - begin)
    way = a / w * (math.cos(w * begin) * (end - begin) + math.sin(w * begin) / w) - mu * G / 2 * (end - begin) ** 2
    begun = a * w * math.cos(w * begin) / 8 * (end - begin + v / (mu * G))
    assert run.slip == pytest.approx(-(way + v**2 / (2 * mu * G)), abs=(begun + mu * G) * step**2)


def test_a_block_that_hops_slips_when_it_lands():
    """Under a_v = -2 g it flies, and lands with -m eta' and at most mu of it to brake the slip."""
    a, mu, T = 4.0, 0.2, 0.1
    pulse = PulseMotion("rectangular", a, math.pi / T, vertical=PulseMotion("rectangular", -2 * G, math.pi / T))
    v = a * T - mu * G * math.sqrt(2) * T
    exact = -(a * T**2 * (1.5 + math.sqrt(2)) + v**2 / (2 * mu * G))
    for step in (1e-4, 1e-5):
        run = simulate_moreau(block_on_ground(mu, pulse, 1.0), step=step)
        assert run.peak_tilt < a * step and run.slip == pytest.approx(exact, abs=5 * a * T * step)


@pytest.mark.parametrize("base", BASES)
@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("share", [0.0, 0.4, 0.9, 1.1, 50.0])
def test_an_impact_is_that_of_the_momentum_equations(base, side, share):
    """With friction above mu_c eqs (7), (8); below it the restitution of an impact that slips, on any base."""
    step, rate = 1e-8, 1.0
    m, J, b, h = BLOCK.mass, BLOCK.centre_inertia, BLOCK.half_width, BLOCK.half_height
    mu = m * b * h / (J + m * h**2 + (J * m / base.mass if base else 0.0)) * share
    start = Start(tilt=-1e-10 * side, tilt_rate=rate * side)
    scene = Scene(block=BLOCK, base=base, friction=max(mu, 1e-15), start=start, duration=step)
    lever = m * b * (b - mu * h)
    e = momentum_restitution(scene) if share > 1 else (J - lever) / (J + lever)
    end = simulate_moreau(scene, step=step).end
    assert end.tilt_rate * side == pytest.approx(e * rate, abs=20 * step)  # gravity in one step
    if base and share > 1:
        jump = scene.mass_share * h * (rate - e * rate)
        assert end.base_velocity * side == pytest.approx(jump, abs=20 * step)


def test_rocking_without_slip_is_first_order():
    steps = 1e-3 / 2.0 ** np.arange(8)
    runs = [simulate_moreau(problem_a(7.0).with_(friction=5.0), step=step) for step in steps]
    errors = [abs(run.end.tilt - A_TILT) for run in runs]
    assert np.polyfit(np.log(steps), np.log(errors), 1)[0] == pytest.approx(1.0, abs=0.2)
    assert runs[-1].impacts == 10 and errors[-1] < 2e-4


def test_slip_is_first_order():
    """Between rocking and sliding on bearings, by the differences of runs with halved steps."""
    steps = 1e-3 / 2.0 ** np.arange(7)
    runs = [simulate_moreau(isolated(), step=step) for step in steps]
    assert {run.outcome for run in runs} == {"overturns"}
    for name in ("overturning_time", "peak_slip", "path"):
        differences = np.abs(np.diff([getattr(run, name) for run in runs]))
        assert np.polyfit(np.log(steps[1:]), np.log(differences), 1)[0] == pytest.approx(1.0, abs=0.2), name


def isolated(law="algebraic", friction=0.25, sign=1, **changes):
    scene = Scene(
        block=Block(mass=3172.05, radius=1.0884, slenderness=0.2),
        base=Base(mass=212.0),
        bearings=bearings_of(law, count=4),
        motion=PulseMotion("one-sine", 6.0 * sign, 4.0),
        friction=friction,
        duration=3.0,
    )
    return scene.with_(**changes)


@pytest.mark.parametrize("friction", [0.15, 0.25])
def test_the_mirrored_scene(friction):
    one, other = (
        simulate_moreau(
            isolated(friction=friction, sign=sign, start=Start(tilt=0.02 * sign, base_velocity=0.1 * sign)), step=1e-4
        )
        for sign in (1, -1)
    )
    assert (one.outcome, one.impacts, one.peak_slip) == (other.outcome, other.impacts, pytest.approx(other.peak_slip))
    for name in ("tilt", "tilt_rate", "base_displacement", "base_velocity"):
        assert getattr(one.end, name) == pytest.approx(-getattr(other.end, name), rel=1e-9)
    assert one.slip == pytest.approx(-other.slip) and one.overturning_time == other.overturning_time


@pytest.mark.parametrize("law", NAMES)
def test_without_slip_it_tends_to_the_model(law):
    """Of all bearing laws, with damping and vertical motion.

    Where a corner gapes by rounding or curvature, it is free for a step, in which it slips by up to g step^2.
    """
    pulse = PulseMotion("one-sine", 3.5, 4.0, vertical=PulseMotion("one-sine", 2.0, 4.0, phase=0.5))
    bearings, start = bearings_of(law, count=4, damping=300.0), Start(base_displacement=0.02)
    scene = isolated(law, 5.0, motion=pulse, bearings=bearings, start=start, block={"slenderness": 0.28}, duration=1.6)
    model = simulate(scene)
    assert (model.outcome, len(model.impacts)) == ("rocks", 1)
    for step in (1e-4, 1e-5):
        run = simulate_moreau(scene, step=step)
        assert (run.outcome, run.impacts) == ("rocks", 1) and run.path < G * scene.duration * step
        found = run.peak_tilt, run.peak_base_displacement, run.end.tilt, run.end.base_displacement
        exact = model.peak_tilt, model.peak_base_displacement, model.end.tilt, model.end.base_displacement
        assert found == pytest.approx(exact, abs=2 * step)


def test_a_block_that_stands_does_not_slide():
    run = simulate_moreau(isolated(friction=5.0, motion=PulseMotion("one-sine", 1.0, 4.0)), step=1e-4)
    assert (run.outcome, run.path, run.peak_tilt) == ("stands", 0, 0) and run.peak_base_displacement > 0.01


@pytest.mark.parametrize(
    "changes, key",
    [
        ({"friction": None}, "friction"),
        ({"duration": None}, "run.duration"),
        ({"block": {"restitution": 0.9}}, "block.restitution"),
    ],
)
def test_refused_scenes(changes, key):
    with pytest.raises(SceneError) as error:
        simulate_moreau(isolated(**changes), step=1e-3)
    assert error.value.key == key


@pytest.mark.parametrize("step", [0.0, -1e-3, math.nan, math.inf, 1e-9])
def test_refused_steps(step):
    with pytest.raises(SettingError, match="step"):
        simulate_moreau(isolated(), step=step)


LONGER = ("ricker", "viscous", "bouc-wen")


@pytest.mark.parametrize(
    "kind", [pytest.param(kind, marks=pytest.mark.slow if kind in LONGER else ()) for kind in KINDS]
)
def test_it_tends_to_the_march_in_ten_scenes_of_each_kind(kind):
    """With a sixteenth of the step a third of the error or less, or 1e-5 (m, rad, s): first order, not monotone."""
    rng, compared = np.random.default_rng([55, KINDS.index(kind)]), 0
    while compared < 10:
        scene = slider_of(kind, rng)
        model = simulate(scene, history=False)
        slides = model.sliding is not None and model.sliding.path > 1e-3
        if not slides or kind == "flight" and "flight" not in {mode for _, mode in model.sliding.modes}:
            continue
        compared += 1
        coarse, fine = (simulate_moreau(scene, step=step) for step in (4e-5, 2.5e-6))
        # at the end of its duration a block may still fall, which the model follows to its end
        falls = model.outcome == "overturns" and model.overturning_time <= scene.duration
        assert fine.outcome == ("rocks" if model.outcome == "overturns" and not falls else model.outcome)
        exact = {"peak_slip": model.sliding.peak, "slip": model.sliding.end, "peak_tilt": model.peak_tilt}
        exact |= {"overturning_time": model.overturning_time} if falls else {}
        if model.outcome != "overturns":  # else the model's is that up to the last fall
            exact["peak_base_displacement"] = model.peak_base_displacement
        for name, value in exact.items():
            errors = [abs(getattr(run, name) - value) for run in (coarse, fine)]
            assert errors[1] <= max(errors[0] / 3, 1e-5), (scene, name, errors)
