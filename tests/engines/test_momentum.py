"""The bearings' force as an engine really applied it: doubled, late or from another law, it is seen from outside."""

import bisect
import dataclasses

import numpy as np
import pytest
from bearing_laws import NAMES, to_law
from sampled_traces import SCENES, sampled, seen

from analytic import PulseMotion
from engines import get_engine, stepping
from engines.momentum import IMPULSE_LIMIT, bearing_impulse, impulse_error, missing_impulse

ROCKING = SCENES["isolated"].with_(duration=1.5)
DRIVEN = ROCKING.with_(
    block={"slenderness": 0.15}, start={"tilt": 0.0}, motion=PulseMotion("one-sine", 3.0, 8.0), duration=2.5
)
ENGINES = ["exudyn", "pybullet", "mujoco", "pymunk", "dart"]


@pytest.mark.parametrize(
    "scene", [ROCKING, DRIVEN, ROCKING.with_(bearings={"damping": 2e3})], ids=["free", "driven", "damped"]
)
@pytest.mark.parametrize("law", NAMES)
def test_an_exact_motion_keeps_the_sum_over_its_impacts(scene, law):
    scene = scene.with_(bearings=to_law(law))
    trace, reference = sampled(scene, 5e-4)
    assert any(abs(impact.base_velocity_jump) > 0.01 for impact in reference.impacts)
    missing, impulse = missing_impulse(scene, trace)
    assert np.ptp(missing) < 1e-4 * np.ptp(impulse)
    assert impulse_error(scene, trace) < 1e-4
    # The jump of the base alone would be seen.
    alone = dataclasses.replace(trace, tilt_rate=np.zeros_like(trace.tilt_rate))
    assert np.ptp(missing_impulse(scene, alone)[0]) > 0.01 * np.ptp(impulse)


def test_the_viscous_impulse_is_damping_times_the_way():
    scene = SCENES["isolated, shaken"].with_(bearings={"law": "linear", "ka": 1e-9, "damping": 500.0})
    trace, _ = sampled(scene, 1e-2)
    way = trace.base_displacement - trace.base_displacement[0]
    np.testing.assert_allclose(bearing_impulse(scene, trace), scene.bearings.count * 500.0 * way, atol=1e-6)


@pytest.mark.parametrize("name", ["isolated", "isolated, shaken"])
@pytest.mark.parametrize("seed", range(3))
def test_coarse_steps_stay_well_below_the_limit(name, seed):
    trace, _ = sampled(SCENES[name], 1 / 60, seed=seed)
    assert impulse_error(SCENES[name], trace) < 0.5 * IMPULSE_LIMIT


@pytest.mark.parametrize("factor", [0.0, 0.5, 2.0])
def test_the_motion_of_another_force_fails(factor):
    """The scene asks for one law; the motion is the exact one of `factor` times its force."""
    bearings = ROCKING.bearings
    other = ROCKING.with_(
        bearings={"ka": factor * bearings.ka, "kb": factor * bearings.kb} if factor else {"law": "linear", "ka": 1e-6}
    )
    trace, _ = sampled(other, 5e-4)
    (failed, warned) = (seen(ROCKING, dataclasses.replace(trace, first_script=first)) for first in (False, True))
    assert failed.outcome == "failed" and "bearing force" in failed.failure.reason
    assert impulse_error(ROCKING, trace) == pytest.approx(abs(factor - 1), rel=0.1)
    assert warned.failure is None and "bearing force" in warned.warnings[-1].text


def test_a_bearing_too_soft_to_matter_is_not_asked_for():
    soft = ROCKING.with_(bearings={"law": "linear", "ka": 1e-3})
    trace, _ = sampled(soft, 5e-3)
    assert impulse_error(soft, trace) < 0.01 and seen(soft, trace).failure is None


# In the engines.


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


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("gain", [2.0, 1.0, 0.5, 0.0])
def test_a_doubled_halved_or_lost_force_inside_an_engine_is_a_failure(monkeypatch, engine, gain):
    response, error = error_in(engine, monkeypatch, gain, 0.0)
    assert response.outcome == ("rocks" if gain == 1 else "failed")  # by its energy, too, where the force is too small
    assert error == pytest.approx(abs(gain - 1), rel=0.02, abs=4e-5)
    assert (error > IMPULSE_LIMIT) == (gain != 1)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("gain, delay", [(1.0, 1e-3), (1.0, 2e-3), (1.01, 0.0)])
def test_a_force_late_by_a_step_or_off_by_a_hundredth_is_measured(monkeypatch, engine, gain, delay):
    _, error = error_in(engine, monkeypatch, gain, delay)
    assert error > 4e-4  # ten times what a clean run shows
