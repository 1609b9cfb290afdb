"""The table of tolerances is as tight as it says; its measures see what they should."""

import dataclasses
import itertools
import json
import math

import numpy as np
import pytest

from analytic import Scene, simulate
from analytic.bearing import BearingLaw
from comparisons.measuring import agreement
from comparisons.measuring.tolerances import QUANTITIES, TABLE, measure_all, rows
from engines import get_engine, installed_engines


def test_bounds_are_no_looser_than_twice_the_measured_worst_and_rows_are_named_apart():
    assert not [
        row for row in TABLE if not row.measured <= row.bound <= (math.inf if row.round_off else 2 * row.measured)
    ]
    assert len({row.name for row in TABLE}) == len(TABLE)
    named = {row.scenes for row in TABLE if row.measure is not agreement.boundary_shift} - {*agreement.FREE_ROCKING}
    assert all(isinstance(agreement.named_scene(scenes), Scene) for scenes in named)


def test_every_installed_tuned_default_variant_has_its_rows():
    wanted = set(QUANTITIES) - {"restitution from swings, |mean error|"}  # of one variant alone
    for name in installed_engines():
        engine = get_engine(name)
        if engine.variants[engine.default_variant].kind == "tuned":
            assert {(row.variant, row.quantity) for row in rows(name)} == {
                (engine.default_variant, quantity) for quantity in wanted
            }


def test_the_papers_law_agrees_with_the_models_between_many_reversals():
    scene = agreement.named_scene("isolated Caryatid, synthetic motion")
    history = simulate(scene).history
    law, x = BearingLaw.of(scene.bearings), history.base_displacement
    forces = list(itertools.accumulate(np.diff(x), law.hysteretic, initial=law.start(x[0])))
    expected = law.force(x, np.array(forces))
    assert (np.diff(np.sign(np.diff(x))) != 0).sum() > 10
    np.testing.assert_allclose(agreement.paper_force(law, x), expected, atol=1e-9 * law.count * law.f0)


@pytest.mark.parametrize("frequency, amplitude", [(2.0, 1.25090), (5.0, 3.03234)])
def test_the_first_boundary_is_the_published_one(monkeypatch, frequency, amplitude):
    """Published over g slenderness, and for a restitution of 0.9; what falls 6 s after the pulse counts as standing."""
    scene = agreement.boundary_scene
    monkeypatch.setattr(agreement, "boundary_scene", lambda *given: scene(*given).with_(block={"restitution": 0.9}))
    found = agreement.first_boundary(0.25, "one-sine", frequency)
    assert found * math.tan(0.25) / 0.25 == pytest.approx(amplitude, rel=1e-5)


def test_a_row_checks_itself_in_the_tests_of_others():
    engine = installed_engines()[0]
    row = next(row for row in rows(engine, get_engine(engine).default_variant) if row.quantity == "peak tilt")
    runs = {}
    assert 0 < row.check(runs) <= row.bound
    with pytest.raises(AssertionError, match="peak tilt.*tolerated 1e-12"):
        dataclasses.replace(row, bound=1e-12).check(runs)


def test_a_failed_run_is_a_row_that_does_not_hold(monkeypatch):
    def fails(*_):
        raise agreement.Unmeasurable("exudyn failed: it sank")

    (result,) = measure_all((dataclasses.replace(TABLE[0], measure=fails),))
    assert not result["holds"] and result["found"] is None and "sank" in result["failure"]
    json.dumps(result, allow_nan=False)
