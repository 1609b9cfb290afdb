"""Engines with the friction that a scene gives: slip is a result, and as the model's."""

from dataclasses import replace

import numpy as np
import pytest
from engine_cases import needs
from sliding_scenes import LOST, SAVED, SLIDES, random_slider

from analytic import simulate
from engines import comparison, get_engine

ENGINES = ("exudyn", "pybullet")


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("scene", [SAVED, LOST, SLIDES], ids=["saved", "overturned", "slides"])
def test_a_block_that_slides_does_so_in_engines(engine, scene):
    needs(engine)
    model, run = simulate(scene, history=False), get_engine(engine).simulate(scene)
    assert (run.failure, run.outcome, run.differences) == (None, model.outcome, ())
    assert run.comparable in ("yes", "on an edge") and not [one for one in run.warnings if one.kind == "model"]
    assert run.sliding.peak == pytest.approx(model.sliding.peak, rel=1e-3)
    assert run.friction_demand <= scene.friction
    if model.outcome == "overturns":
        assert run.overturning_time == pytest.approx(model.overturning_time, abs=2e-3)
    else:
        assert run.peak_tilt == pytest.approx(model.peak_tilt, abs=1e-4)


@pytest.mark.parametrize("engine", ENGINES)
def test_slip_over_time_is_the_models(engine):
    needs(engine)
    model, run = simulate(SAVED).history, get_engine(engine).simulate(SAVED, compare=False).history
    slip = np.interp(model.time, run.time, run.slip)
    np.testing.assert_allclose(slip, model.slip, atol=1e-3 * np.abs(model.slip).max())


def test_a_run_that_does_not_slip_where_the_model_does_differs():
    model = simulate(SAVED, history=False)
    still = replace(model.sliding, peak=0.0, end=0.0, path=0.0)
    run = replace(model, engine="any", sliding=still)
    (found,) = comparison.compare(SAVED, run).differences
    assert (found.quantity, found.here, found.model) == ("peak_slip", 0.0, model.sliding.peak)
    unread = comparison.compare(SAVED, replace(run, sliding=None))
    assert unread.differences == ()
    model = simulate(SLIDES, history=False)
    stands = replace(model, engine="any", outcome="stands", sliding=None)  # as a first script, which reads no place
    assert comparison.compare(SLIDES, stands).differences == ()
    (found, _) = comparison.compare(SLIDES, replace(stands, sliding=still)).differences
    assert (found.quantity, found.here, found.model) == ("outcome", "stands", "slides")


@pytest.mark.slow
@pytest.mark.parametrize("engine, most", [("exudyn", 4), ("pybullet", 0)])
def test_forty_random_scenes(engine, most):
    """exudyn is off in some scenes on rigid ground that a jump of the ground's acceleration lifts."""
    needs(engine)
    rng, wrong = np.random.default_rng(7), 0
    for number in range(40):
        scene = random_slider(rng, number)
        scene = scene.with_(friction=float(rng.uniform(0.2, 0.8)))
        run = get_engine(engine).simulate(scene)
        assert run.failure is None
        wrong += bool(run.differences)
    assert wrong <= most
