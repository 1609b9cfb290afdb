"""Runs that end during an impact: the impact is read from a longer run."""

from dataclasses import replace

import numpy as np
import pytest
from engine_cases import every_variant, scene

from analytic import Start, simulate
from analytic.response import Failure
from analytic.rocking import restitution
from engines import get_engine
from engines.simulating import Simulator

RELEASED = {base: scene(0.15, base, 3.0, start=Start(tilt=0.07)) for base in (None, 3172.05)}


def cut(base, after):
    """A scene that ends so long after the second impact of the analytic model, and that impact's time [s]."""
    impact = simulate(RELEASED[base], history=False).impacts[1]
    return RELEASED[base].with_(duration=impact.time + after), impact.time


@pytest.mark.parametrize("after", [1e-9, 1e-5, 1e-4, 3e-4, 1e-3, 5e-3])
@pytest.mark.parametrize("base", [None, 3172.05])
@pytest.mark.parametrize("name", ["exudyn", "pybullet", "mujoco", "pymunk"])
def test_a_run_that_ends_in_an_impact_reads_it_as_one_that_goes_on(name, base, after):
    """e was off by .028 (exudyn, with a warning), .017 (PyBullet) and .97 (MuJoCo), in silence."""
    given, _ = cut(base, after)
    response = get_engine(name).simulate(given, history=False)
    assert response.outcome == "rocks" and not [each for each in response.warnings if "impact" in each.text]
    assert all(impact.time <= given.duration for impact in response.impacts)
    assert len(response.impacts) == 2 or after < 1e-4  # before the engine's own impact
    for impact in response.impacts:
        assert impact.rate_after / impact.rate_before == pytest.approx(restitution(given), abs=2e-3)


@every_variant
def test_only_events_are_read_beyond_the_end(engine, variant):
    given, _ = cut(3172.05, 1e-4)
    response, trace = get_engine(engine).traced(given, variant=variant)
    assert abs(trace.time[-1] - given.duration) <= np.diff(trace.time).max()  # equal steps end at the nearest one
    assert response.end.time == response.history.time[-1] == trace.time[-1]
    reached = abs(response.history.base_displacement).max()
    assert response.peak_base_displacement == pytest.approx(reached, rel=1e-3)
    for times in (response.uplifts, response.rests, [impact.time for impact in response.impacts]):
        assert all(time <= response.end.time for time in times)


class Counted(Simulator):
    """An engine that counts its runs; those longer than a scene's end fail where `sound` is False."""

    sound, durations = True, ()

    def run(self, given, variant, settings):
        object.__setattr__(self, "durations", (*self.durations, given.duration))
        ran = super().run(given, variant, settings)
        late = not self.sound and given.duration > self.durations[0]
        return replace(ran, failure=Failure("the solver gave up", "it is a fake")) if late else ran


class Unsound(Counted):
    sound = False


@pytest.mark.parametrize("name", ["exudyn", "mujoco"])
def test_a_run_goes_on_only_where_it_ends_in_an_impact_and_costs_both(name):
    given, at = cut(None, 1e-4)
    once, twice, unsound = (kind.of(get_engine(name)) for kind in (Counted, Counted, Unsound))
    plain, _ = once.traced(given.with_(duration=at - 0.1), history=False)
    response, _ = twice.traced(given, history=False)
    assert len(once.durations) == 1 and len(twice.durations) == 2
    assert twice.durations[0] == given.duration < twice.durations[1] < given.duration + 0.1
    assert response.steps > 1.8 * plain.steps
    # one that cannot go on says that its last impact is not to be trusted
    (warning,) = unsound.traced(given, history=False)[0].warnings
    assert "during an impact, and fails if it goes on" in warning.text
