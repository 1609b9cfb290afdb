"""Drake, beside what every engine must fulfil: what its defaults bring, what it does not solve."""

import numpy as np
import pytest

pytest.importorskip("pydrake", reason="pydrake is not installed: see README.md")

from engine_cases import scene  # noqa: E402

from analytic import PulseMotion, Start  # noqa: E402
from comparisons.measuring.errors import impact_errors as impact_quantities  # noqa: E402
from engines import get_engine  # noqa: E402
from engines.drake import scene as built  # noqa: E402

simulate = get_engine("drake").simulate


@pytest.mark.slow
@pytest.mark.parametrize("step", [1e-3, 2e-4])
def test_first_script_is_off_at_any_step(step):
    """Its contact, soft by default, leaves the block too fast: e from the swings around three impacts."""
    given = scene(0.2, 212.0, 3.0, start=Start(tilt=0.1))
    off = impact_quantities(given, simulate(given, variant="first-script", step=step), 3)["swing"]
    assert 5e-3 < np.mean(off) < 3e-2


def test_a_block_that_overturns_is_seen_to():
    """Its tilt is read as an angle that passes pi/2."""
    given = scene(0.2, duration=4.0, motion=PulseMotion("one-sine", 4.0, 5.0))
    assert simulate(given, history=False).outcome == "overturns"


def test_a_step_that_drake_does_not_solve_is_a_failure_in_its_words(monkeypatch):
    class Stuck(built.Simulator):
        def AdvanceTo(self, time):
            if time > 0.1:
                raise RuntimeError("solver failed to converge at simulation time = 0.1 with dt = 0.001.")
            super().AdvanceTo(time)

    monkeypatch.setattr(built, "Simulator", Stuck)
    response = simulate(scene(0.3, start=Start(tilt=0.1)))
    assert response.outcome == "failed"
    assert response.failure.reason == "Drake found no solution of a step"
    assert "failed to converge" in response.failure.message and "at step 100" in response.failure.message
