"""The table of tolerances is as tight as it says; its measures see what they should."""

import dataclasses
import json
import math

import numpy as np
import pytest
from engine_cases import needs

from analytic import Scene, simulate
from analytic.bearing import BearingLaw
from comparisons.measuring import agreement
from comparisons.measuring.tolerances import SLACK, TABLE, measure_all, rows
from engines import get_engine, installed_engines

ROWS = pytest.mark.parametrize("row", TABLE, ids=lambda row: row.name)


@ROWS
def test_bounds_are_no_looser_than_twice_the_measured_worst(row):
    assert row.measured <= row.bound
    assert row.round_off or row.bound <= SLACK * row.measured


@ROWS
def test_rows_name_variants_and_scenes_that_exist(row):
    needs(row.engine)
    assert row.variant in get_engine(row.engine).variants
    if row.scenes not in agreement.FREE_ROCKING and row.measure is not agreement.boundary_shift:
        assert isinstance(agreement.named_scene(row.scenes), Scene)


def test_rows_are_named_apart():
    assert len({row.name for row in TABLE}) == len(TABLE)


def test_every_installed_tuned_default_variant_has_its_rows():
    for engine in installed_engines():
        default = get_engine(engine).default_variant
        if get_engine(engine).variants[default].tier != "tuned":
            continue
        quantities = {row.quantity for row in TABLE if (row.engine, row.variant) == (engine, default)}
        assert quantities == {
            "restitution, rms",
            "base velocity jump, rms",
            "impact times",
            "peak tilt",
            "tilt graph",
            "peak displacement",
            "overturning time",
            "overturning boundary",
            "bearing force replayed",
            "bearing impulse in the motion",
            "corner lift at rest",
            "base drift at rest",
        }


def test_the_papers_law_agrees_with_the_models_between_many_reversals():
    scene = agreement.named_scene("isolated Caryatid, synthetic motion")
    history = simulate(scene).history
    law, x = BearingLaw.of(scene.bearings), history.base_displacement
    z, forces = law.start(x[0]), [law.start(x[0])]
    for dx in np.diff(x):
        z = law.hysteretic(z, dx)
        forces.append(z)
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
    row = next(row for row in rows(engine) if row.quantity == "peak tilt")
    runs = {}
    assert 0 < row.check(runs) <= row.bound
    with pytest.raises(AssertionError, match="peak tilt.*tolerated 1e-12"):
        dataclasses.replace(row, bound=1e-12).check(runs)


def test_rows_are_those_of_the_default_variant_or_the_one_named():
    needs("exudyn")
    assert {row.variant for row in rows("exudyn")} == {get_engine("exudyn").default_variant}
    assert {row.variant for row in rows("exudyn", "native-contact")} == {"native-contact"}


def test_a_failed_run_is_a_row_that_does_not_hold(monkeypatch):
    row = next(row for row in TABLE if row.quantity == "overturning time")

    def fails(*_):
        raise agreement.Unmeasurable("exudyn failed: it sank")

    (result,) = measure_all((dataclasses.replace(row, measure=fails),))
    assert not result["holds"] and result["found"] is None and "sank" in result["failure"]
    json.dumps(result, allow_nan=False)
