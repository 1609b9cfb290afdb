"""heyoka on every scene of the speed-error study: held against the kernel at its tightest, impact by impact."""

import dataclasses

import numpy as np
import pytest

from analytic import PulseMotion, SampledMotion, Scene, SceneError, SettingError, Start
from analytic.caryatid import BASE, BEARINGS, caryatid_block
from comparisons.studies.speed_error.cases import entries, tight, trials
from comparisons.studies.speed_error.integrators import TAYLOR
from comparisons.studies.speed_error.study import errors, measure

pytest.importorskip("heyoka", reason="heyoka comes with the extra `peers`")

from comparisons.studies.speed_error.taylor import Run, simulate_heyoka

BLOCK = caryatid_block(0.25)
LIMIT = 9.81 * np.tan(0.25)  # m/s2, of uplift
ISOLATED = {"base": BASE, "bearings": BEARINGS}


@pytest.fixture(scope="module")
def by_name():
    return {trial.name: trial for trial in trials()}


def pulse(shape, times, **base):
    """A block under a pulse of so many times its uplift acceleration, that begins after .2 s."""
    return Scene(block=BLOCK, motion=PulseMotion(shape, times * LIMIT, 8.0, start=0.2), duration=4.0, **base)


def record(*samples, **base):
    """A block under samples every .01 s, over its uplift acceleration."""
    return Scene(block=BLOCK, motion=SampledMotion(0.01, np.array(samples) * LIMIT), duration=2.0, **base)


SHAKEN = {
    "a jump of the ground": pulse("one-cosine", 1.5),
    "overturns": pulse("one-cosine", -3.0),
    "rectangular": pulse("rectangular", 1.1),
    "ricker": pulse("ricker", 1.6),
    "isolated, jump": pulse("one-cosine", -1.5, **ISOLATED),
    "overturns, isolated": pulse("one-cosine", 6.0, **ISOLATED),
    "hops within a sample": record(*[1.001, -0.999] * 3, 0, 0),
    "rigid, record": record(0, 0, *np.sin(np.arange(60) / 4) * 1.5),
    "turns within its first sample": record(0.01, *-np.sin(np.arange(1, 60) / 4) * 2, **ISOLATED),
    "nothing at first": record(*[0] * 9, *np.sin(np.arange(60) / 4) * 2, **ISOLATED),
    "pulled aside": Scene(block=BLOCK, start=Start(tilt=0.1, base_displacement=-0.1), duration=3.0, **ISOLATED),
}


def differs(run, reference):
    """The largest of the differences in time [s], tilt [rad] and displacement [m]; the events are the same."""
    assert run.failure is None and run.outcome == reference.outcome
    assert [len(found) for found in (run.impacts, run.uplifts, run.rests)] == [
        len(found) for found in (reference.impacts, reference.uplifts, reference.rests)
    ]
    pairs = [
        *((impact.time, other.time) for impact, other in zip(run.impacts, reference.impacts, strict=True)),
        (run.peak_tilt, reference.peak_tilt),
        (run.end.tilt, reference.end.tilt),
        (run.end.base_displacement, reference.end.base_displacement),
        (run.overturning_time or 0.0, reference.overturning_time or 0.0),
    ]
    if run.outcome != "overturns":  # the fall is no part of the kernel's peak, and of a base there is none here
        pairs.append((run.peak_base_displacement, reference.peak_base_displacement))
    return max(abs(a - b) for a, b in pairs)


@pytest.mark.parametrize("callback", TAYLOR.values(), ids=TAYLOR)
@pytest.mark.parametrize(
    "name", ["free-rigid", "free-sliding", "isolated-standing", "isolated-rocking", "near-overturning"]
)
def test_it_solves_every_scene_of_the_study(by_name, name, callback):
    trial = by_name[name]
    run = simulate_heyoka(trial.scene, tolerance=1e-12, callback=callback)
    found = errors(trial, run.to_json())
    assert found.pop("lost") == 0 and set(found) == set(trial.measures) - {"boundary_shift"}
    assert max(found.values()) < 1e-11
    assert differs(run, trial.reference) < 1e-10
    assert run.cpu_seconds > 0 and run.decided == trial.reference.decided


@pytest.mark.parametrize("callback", TAYLOR.values(), ids=TAYLOR)
@pytest.mark.parametrize("name", SHAKEN)
def test_it_solves_other_scenes(name, callback):
    run, reference = simulate_heyoka(SHAKEN[name], tolerance=1e-13, callback=callback), tight(SHAKEN[name])
    assert differs(run, reference) < 1e-10
    assert (run.outcome == "overturns") == name.startswith("overturns")


def test_its_error_falls_with_the_tolerance(by_name):
    trial = by_name["free-rigid"]
    found = [
        errors(trial, simulate_heyoka(trial.scene, tolerance=tolerance, callback=True).to_json())["impact_time"]
        for tolerance in (1e-3, 1e-6, 1e-9)
    ]
    assert found[0] > 100 * found[1] > 1e4 * found[2] > 0


@pytest.mark.parametrize("callback", TAYLOR.values(), ids=TAYLOR)
def test_a_run_is_the_same_bit_for_bit_after_others(by_name, callback):
    def run(amplitude):
        response = simulate_heyoka(pulse("one-sine", amplitude, **ISOLATED), tolerance=1e-6, callback=callback)
        return dataclasses.replace(response, cpu_seconds=0.0).to_json()

    first = run(1.5)
    assert run(-2.0) != first == run(1.5)


@pytest.mark.parametrize("callback", TAYLOR.values(), ids=TAYLOR)
def test_events_without_end_are_a_failure(monkeypatch, callback):
    monkeypatch.setattr("comparisons.studies.speed_error.taylor.IMPACT_LIMIT", 5)
    run = simulate_heyoka(Scene(block=BLOCK, start=Start(tilt=0.2), duration=9.0), tolerance=1e-9, callback=callback)
    assert run.outcome == "failed" and "without progress" in run.failure.reason and len(run.impacts) == 6


def test_a_state_that_is_not_finite_is_a_failure(monkeypatch):
    monkeypatch.setattr(Run, "nudged", lambda run: [np.nan] * 4)
    run = simulate_heyoka(Scene(block=BLOCK, start=Start(tilt=0.2), duration=1.0), tolerance=1e-9, callback=True)
    assert run.outcome == "failed" and "not finite" in run.failure.reason


@pytest.mark.parametrize(
    "scene, key",
    [
        (pulse("one-sine", 1.0, **ISOLATED).with_(bearings={"law": "bouc-wen"}), "bearings.law"),
        (pulse("one-sine", 1.0).with_(friction=0.7), "friction"),
        (pulse("one-sine", 1.0).with_(duration=None), "run.duration"),
        (
            pulse("one-sine", 1.0).with_(
                motion=PulseMotion("one-sine", 1.0, 8.0, vertical=PulseMotion("one-sine", 1.0, 8.0))
            ),
            "motion.vertical",
        ),
    ],
)
def test_what_is_not_set_up_is_refused(scene, key):
    with pytest.raises(SceneError) as refused:
        simulate_heyoka(scene, tolerance=1e-9, callback=True)
    assert refused.value.key == key


def test_a_history_is_refused():
    with pytest.raises(SettingError, match="history"):
        simulate_heyoka(SHAKEN["ricker"], tolerance=1e-9, callback=True, history=True)


def test_the_study_asks_for_both_variants_by_the_version_installed(by_name):
    asked = [entry for entry in entries([by_name["free-rigid"]], (), True) if entry.engine == "heyoka"]
    assert {entry.variant for entry in asked} == set(TAYLOR) and len(asked) == 4
    keys = set()
    for entry in asked:
        case = entry.case(0)
        again = dataclasses.replace(case, settings={**case.settings, "version": "0.0"})
        keys |= {case.key(measure), again.key(measure)}
        assert case.run().variant == entry.variant
    assert len(keys) == 8
