"""The bearings' force as an engine really applied it: doubled, late or from another law, it is seen from outside."""

import bisect
import dataclasses

import numpy as np
import pytest
from bearing_laws import NAMES, to_law
from engine_cases import needs
from sampled_traces import SCENES, sampled, seen

from analytic import PulseMotion
from engines import get_engine, stepping
from engines.momentum import IMPULSE_LIMIT, bearing_impulse, check_impulse, impulse_error, missing_impulse

ROCKING = SCENES["isolated"].with_(duration=1.5)
DRIVEN = ROCKING.with_(
    block={"slenderness": 0.15}, start={"tilt": 0.0}, motion=PulseMotion("one-sine", 3.0, 8.0), duration=2.5
)
ENGINES = {
    "exudyn": "compliant-corners",
    "pybullet": "impact-aware",
    "mujoco": "impact-aware",
    "pymunk": "impact-aware",
    "dart": "impact-aware",
}


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
    response = seen(ROCKING, trace)
    assert response.outcome == "failed" and "bearings' force" in response.failure.reason
    assert impulse_error(ROCKING, trace) == pytest.approx(abs(factor - 1), rel=0.1)
    warned = seen(ROCKING, dataclasses.replace(trace, first_script=True))
    assert warned.failure is None and "bearings' force" in warned.warnings[-1].text


def test_a_bearing_too_soft_to_matter_is_not_asked_for():
    soft = ROCKING.with_(bearings={"law": "linear", "ka": 1e-3})
    trace, _ = sampled(soft, 5e-3)
    assert impulse_error(soft, trace) < 0.01 and seen(soft, trace).failure is None


# In the engines.


def force_in_exudyn(monkeypatch, change):
    """change(displacement, velocity, offset, step, force) in place of the symbolic force."""
    from engines.exudyn import scene as model

    force = model.Bearing.force

    def changed(self, displacement, velocity, offset):
        return change(
            lambda shift, gain: [
                gain * part for part in force(self, [displacement[0] - shift * velocity[0]], velocity, offset)
            ]
        )

    monkeypatch.setattr(model.Bearing, "force", changed)


def mutate_exudyn(monkeypatch, gain, delay, step):
    force_in_exudyn(monkeypatch, lambda force: force(delay * step, gain))


def mutate_leapfrog(monkeypatch, gain, delay, step):
    """The engine is given another force than the rows say: `gain` times as much, so many steps [s] later."""
    mean_loads, told = stepping.mean_loads, []

    def changed(*given):
        loads = mean_loads(*given)

        def other(t, h, before, v, force):
            told.append((t, force))
            times = [time for time, _ in told[-100:]]
            late = told[-100:][max(bisect.bisect_right(times, t - delay * step) - 1, 0)][1]
            return loads(t, h, before, v, gain * late)

        return other

    monkeypatch.setattr(stepping, "mean_loads", changed)


MUTATE = {name: mutate_leapfrog for name in ENGINES} | {"exudyn": mutate_exudyn}
LARGEST_STEP = 1e-3  # s, of the delay


def traced(engine, scene):
    """(response, trace) of the engine's default."""
    return get_engine(engine).traced(scene, variant=ENGINES[engine])


@pytest.mark.parametrize("engine", ENGINES)
def test_a_clean_run_of_an_engine_keeps_its_momentum(monkeypatch, engine):
    needs(engine)
    response, trace = traced(engine, DRIVEN)
    assert response.failure is None and len(response.impacts) >= 2
    assert impulse_error(DRIVEN, trace) < 4e-5


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("gain", [2.0, 0.5, 0.0])
def test_a_doubled_halved_or_lost_force_inside_an_engine_is_a_failure(monkeypatch, engine, gain):
    needs(engine)
    MUTATE[engine](monkeypatch, gain, 0, LARGEST_STEP)
    response, trace = traced(engine, DRIVEN)
    assert response.outcome == "failed"  # by its energy, too, where the force is too small
    assert impulse_error(DRIVEN, trace) == pytest.approx(abs(gain - 1), rel=0.02)
    assert check_impulse(DRIVEN, trace) is not None


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("gain, delay", [(1.0, 1), (1.0, 2), (1.01, 0)])
def test_a_force_late_by_a_step_or_off_by_a_hundredth_is_measured(monkeypatch, engine, gain, delay):
    needs(engine)
    MUTATE[engine](monkeypatch, gain, delay, LARGEST_STEP)
    _, trace = traced(engine, DRIVEN)
    assert impulse_error(DRIVEN, trace) > 4e-4  # ten times what a clean run shows
