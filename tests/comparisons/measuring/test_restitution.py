"""The error of restitution, on responses whose error is known."""

import numpy as np
import pytest

from analytic import Scene, Start, simulate
from analytic.caryatid import BASE, BEARINGS, MASS, caryatid_block
from analytic.rocking import restitution
from comparisons.measuring.restitution import impact_errors, rate_restitution, strong_impacts
from comparisons.studies.restitution.cases import free_scene

CARYATID_BASE = BASE.mass / MASS


@pytest.mark.parametrize("ratio", [None, 10.0, CARYATID_BASE])
@pytest.mark.parametrize("slenderness", [0.1, 0.45])
def test_exact_responses_have_no_error_and_the_printed_jump_has(slenderness, ratio):
    scene = free_scene(slenderness, ratio, 0.5)
    errors = impact_errors(scene, simulate(scene), 3)
    assert len(errors["time"]) == 3
    assert np.abs(errors["swing"]).max() < 1e-8
    assert np.abs(errors["state"]).max() < 1e-9
    if ratio:
        assert np.abs(errors["jump"]).max() < 1e-9
        assert np.abs(errors["jump_8"]).max() < 1e-9
        np.testing.assert_allclose(errors["jump_8_printed"], 1 / scene.block.half_height - 1, atol=1e-9)


def test_another_impact_law_is_measured_as_what_it_is():
    scene = free_scene(0.2, None, 0.6)
    wrong = simulate(scene.with_(block={"restitution": 0.9}))
    errors = impact_errors(scene, wrong, 3)
    np.testing.assert_allclose(errors["swing"], 0.9 - restitution(scene), atol=1e-8)


def test_chatter_does_not_count_as_impacts():
    scene = free_scene(0.2, None, 0.6).with_(duration=30.0)
    response = simulate(scene)
    rates = [abs(impact.rate_before) for impact in strong_impacts(response)]
    assert len(rates) < len(response.impacts)
    assert min(rates) >= 0.1 * max(rates)


def test_successive_rates_give_the_restitution_of_free_rocking():
    for ratio in (None, 1.0):
        scene = free_scene(0.3, ratio, 0.6)
        np.testing.assert_allclose(rate_restitution(simulate(scene, history=False)), restitution(scene), atol=1e-9)


def test_swings_are_measured_in_free_rocking_alone():
    scene = Scene(block=caryatid_block(0.2), base=BASE, bearings=BEARINGS, start=Start(tilt=0.1), duration=1.5)
    errors = impact_errors(scene, simulate(scene))
    assert "swing" not in errors and np.abs(errors["state"]).max() < 1e-9
    free = free_scene(0.2, None, 0.5)
    assert "swing" not in impact_errors(free, simulate(free, history=False))
