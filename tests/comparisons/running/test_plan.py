"""What a study may ask of engines."""

import pytest

from analytic import load_scene
from comparisons.measuring import agreement
from comparisons.running.cases import Case
from comparisons.running.plan import Batch

GIVEN = load_scene("free-rocking-rigid").with_(block={"restitution": 0.8})


@pytest.mark.parametrize("solver", ["exudyn", "engines.pybullet.free_block:simulate"])
def test_no_engine_is_judged_by_a_restitution_that_it_was_given(solver):
    cases = [Case(GIVEN, name) for name in ("analytic", "twin", "time-stepping", solver)]
    Batch(cases[:3], print, "ours")
    assert len(Batch(cases, print, "shown, not judged", rates=False).cases) == 4
    with pytest.raises(ValueError, match=f"outcomes: {solver} is given block.restitution = 0.8, and not judged by it"):
        Batch(cases, print, "outcomes")


def test_no_tolerance_is_measured_where_the_restitution_is_given():
    with pytest.raises(agreement.Unmeasurable, match="restitution is given"):
        agreement.traced("exudyn", "compliant-corners", GIVEN)
