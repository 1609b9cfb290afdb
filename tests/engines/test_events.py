"""What measuring cannot resolve, or what cannot be, is a failure with its numbers; sound runs are not accused."""

import dataclasses
import math

import numpy as np
import pytest
from sampled_traces import BASE, BEARINGS, EDGE, SCENES, block, sampled, seen

from analytic import Base, Bearings, Scene, Start, simulate
from engines.events import MOST_RESTITUTION, check_impacts, find_events, straddled
from engines.swings import Trace, find_swings, to_contact

FREE = SCENES["rigid ground"]


def damped(damping, base=0.067, **changes):
    bearings = BEARINGS.model_copy(update={"damping": damping, **changes})
    return Scene(block=block(0.25), base=Base(mass=base), bearings=bearings, start=Start(tilt=0.15), duration=2.0)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    "scene",
    [damped(1e6), damped(1e5), damped(1e4), damped(0.0, ka=1e9, kb=1e8), damped(1e6, base=212.0, ka=1e9, kb=1e8)],
    ids=["1e6 N s/m", "1e5 N s/m", "1e4 N s/m", "1e9 N/m", "both"],
)
@pytest.mark.parametrize("settle", [0.0, 6e-3])
def test_impacts_on_stiff_and_damped_bearings_are_carried_stably(scene, settle):
    """A base of 67 g: its velocity settles within 1e-4 s at 1e6 N s/m, and grows as fast backward in time."""
    reference = simulate(scene, output_step=1e-5)
    steps = np.arange(0, len(reference.history.time), 20)
    trace = Trace(*(getattr(reference.history, name)[steps] for name in Trace.COLUMNS), EDGE, settle)
    response = seen(scene, trace)
    assert response.outcome == reference.outcome == "rocks"
    for one, other in zip(response.impacts[:2], reference.impacts[:2], strict=True):
        assert one.time == pytest.approx(other.time, abs=1e-4)
        assert one.rate_before == pytest.approx(other.rate_before, rel=2e-2)
        assert one.rate_after == pytest.approx(other.rate_after, rel=2e-2)


def test_a_carry_takes_substeps_as_the_bearing_needs_them():
    """Forward over ten time constants of the damping, against the model's own steps."""
    scene = damped(1e6, base=212.0)
    reference = simulate(scene, output_step=1e-5)
    last = np.searchsorted(reference.history.time, reference.impacts[0].time) - 1
    trace = Trace(*(getattr(reference.history, name)[: last + 1] for name in Trace.COLUMNS), EDGE)
    near = trace.upto(len(trace.time) - 200)  # 2 ms before the impact
    time, rate, _ = to_contact(scene, near, find_swings(near), 1)
    assert time[0] == pytest.approx(reference.impacts[0].time, abs=1e-6)
    assert rate[0] == pytest.approx(reference.impacts[0].rate_before, rel=1e-5)


def with_rate_after(trace, impact, factor):
    """The trace with its rates of the swing after an impact multiplied."""
    swings = find_swings(trace)
    k = int(np.flatnonzero(trace.time[swings.first] > impact.time)[0])
    part = slice(swings.first[k], swings.last[k] + 1)
    rate = trace.tilt_rate.copy()
    rate[part] *= factor
    return dataclasses.replace(trace, tilt_rate=rate)


def test_an_impact_that_gives_energy_fails_with_its_rates():
    trace, reference = sampled(FREE, 1e-3)
    strong = reference.impacts[6]
    e = strong.rate_after / strong.rate_before
    thrown = with_rate_after(trace, strong, 1.05 * MOST_RESTITUTION / abs(e))
    assert seen(FREE, thrown).outcome == "failed"
    failure = check_impacts(FREE, thrown, seen(FREE, thrown).impacts, ())
    assert failure.reason == "an impact gave energy" and f"{strong.time:.1f}" in failure.message
    sound = with_rate_after(trace, strong, 0.95 * MOST_RESTITUTION / abs(e))
    assert check_impacts(FREE, sound, seen(FREE, sound).impacts, ()) is None


def held(trace, first, pause):
    """The trace with a pause [s] in full contact before the step `first`."""
    flat = np.linspace(0.1, 0.9, 9) * pause
    columns = {name: np.insert(getattr(trace, name), [first] * 9, 0.0) for name in Trace.COLUMNS}
    columns["time"] = np.concatenate([trace.time[:first], trace.time[first - 1] + flat, trace.time[first:] + pause])
    return Trace(**columns, contact_tilt=EDGE)


def test_a_change_of_side_without_an_impact_fails():
    """The block lands, stands flat for a while and leaves to the other side as fast as after the impact."""
    trace, reference = sampled(FREE, 1e-3)
    first = int(np.searchsorted(trace.time, reference.impacts[0].time))
    flat = held(trace, first, 0.03)
    assert seen(FREE, flat).outcome == "failed"
    *_, missed = find_events(FREE, flat, find_swings(flat))
    assert missed == (trace.time[first - 1],)
    assert check_impacts(FREE, flat, (), missed).reason == "an impact could not be resolved"
    assert find_events(FREE, trace, find_swings(trace))[-1] == ()


def every(trace, step):
    """The trace read every `step` seconds."""
    kept = np.unique(np.searchsorted(trace.time, np.arange(trace.time[0], trace.time[-1], step)))
    return trace.at(np.append(kept, len(trace.time) - 1))


def test_steps_longer_than_whole_swings_fail():
    trace, _ = sampled(FREE, 2.5e-4)
    swing = 0.5  # s, about that of the stronger ones
    response = seen(FREE, every(trace, 1.3 * swing))
    assert response.outcome == "failed" and "longer than whole swings" in response.failure.reason
    assert not len(straddled(FREE, every(trace, 0.05 * swing)))
    assert seen(FREE, every(trace, 0.05 * swing)).outcome == "rocks"


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("column", Trace.COLUMNS[1:])
@pytest.mark.parametrize("size", [1e30, 1e200, 1e300])
def test_an_exploded_state_fails_without_a_warning_of_numpy(column, size):
    scene = SCENES["isolated"]
    trace, _ = sampled(scene, 2e-3)
    late = trace.time > 3.0
    burst = np.where(late, size * np.cos(300 * trace.time), getattr(trace, column))
    response = seen(scene, dataclasses.replace(trace, **{column: burst}))
    assert response.outcome in ("failed", "overturns") if column == "tilt" else response.outcome == "failed"
    assert (response.outcome == "failed") == (response.failure is not None)


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("mean_step", [1e-3, 1 / 60])
@pytest.mark.parametrize("seed", range(3))
def test_sound_runs_are_not_accused(name, mean_step, seed):
    trace, reference = sampled(SCENES[name], mean_step, seed=seed)
    response = seen(SCENES[name], trace)
    assert response.failure is None and response.outcome == reference.outcome


def test_a_stocky_block_that_lands_flat_misses_no_impact():
    scene = Scene(block=block(0.9), base=BASE, start=Start(tilt=0.3), duration=2.0)
    trace, _ = sampled(scene, 5e-3)
    assert not len(straddled(scene, trace)) and seen(scene, trace).failure is None


def test_a_bearing_without_a_base_velocity_limit_is_linear_too():
    scene = Scene(
        block=block(0.25),
        base=BASE,
        duration=2.0,
        start=Start(tilt=0.12),
        bearings=Bearings(law="linear", count=4, ka=1e8, damping=1e5),
    )
    trace, reference = sampled(scene, 2e-4, step=1e-4)
    found = seen(scene, trace)
    assert found.outcome == reference.outcome
    assert all(abs(i.rate_after) < MOST_RESTITUTION * abs(i.rate_before) for i in found.impacts)
    assert math.isfinite(found.peak_base_acceleration)
