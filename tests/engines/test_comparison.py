"""The comparison with the analytic model: what differs is told, what does not or cannot be compared is not."""

from dataclasses import replace

import pytest

from analytic import Block, Failure, Impact, PulseMotion, Response, Scene, Start, load_scene, simulate
from analytic.response import COMPARED, DIFFERENCES, EDGE, Difference
from engines.comparison import LEAST_TILT, PEAK, compare, differences

BLOCK = Block(mass=3172.05, radius=1.0884, slenderness=0.28)
FREE = Scene(block=BLOCK, start=Start(tilt=0.14))
SHAKEN = load_scene("caryatid-isolated").with_(motion=PulseMotion("one-sine", 3.9, 6.0), duration=4.0)
SCENES = pytest.mark.parametrize("scene", [FREE, SHAKEN], ids=["free", "shaken"])


def told(scene, **changed):
    """Quantities in which the model's own response, changed, differs."""
    response = compare(scene, replace(simulate(scene, history=False), **changed))
    assert response.comparable == COMPARED
    return [one.quantity for one in response.differences]


@SCENES
@pytest.mark.parametrize("quantity", ["peak_tilt", "peak_base_displacement"])
@pytest.mark.parametrize("share, found", [(0.0, False), (0.9 * PEAK, False), (1.1 * PEAK, True), (float("nan"), True)])
def test_peaks_differ_by_more_than_the_limit(scene, quantity, share, found):
    value = getattr(simulate(scene, history=False), quantity)
    wanted = [quantity] if found and (value > 0 or share != share) else []
    assert told(scene, **{quantity: value * (1 + share)}) == wanted


def test_a_tilt_below_the_range_is_compared_as_one_at_its_limit():
    scene = Scene(block=BLOCK, start=Start(tilt=1e-3 * BLOCK.slenderness))
    least = LEAST_TILT * BLOCK.slenderness
    peak = simulate(scene, history=False).peak_tilt
    assert told(scene, peak_tilt=peak + 0.9 * PEAK * least) == []
    assert told(scene, peak_tilt=peak + 1.1 * PEAK * least) == ["peak_tilt"]


def test_another_outcome_and_one_that_is_not_decided():
    assert told(FREE, outcome="overturns") == ["outcome"]
    assert told(FREE, outcome="overturns", decided=False) == []


def impacts(scene):
    return simulate(scene, history=False).impacts


@SCENES
@pytest.mark.parametrize("factor, found", [(1.009, []), (0.98, ["restitution"]), (float("nan"), ["restitution"])])
def test_restitution_of_one_impact(scene, factor, found):
    own = list(impacts(scene))
    one = own[1]
    own[1] = replace(one, rate_after=one.rate_after * factor)
    assert told(scene, impacts=tuple(own)) == found


@SCENES
def test_impacts_that_are_missing_and_too_many(scene):
    own = impacts(scene)
    assert told(scene, impacts=own[:1] + own[2:]) == ["missing_impacts"]
    between = Impact(0.5 * (own[0].time + own[1].time), own[1].rate_before, own[1].rate_after, 0.0)
    assert told(scene, impacts=(own[0], between, *own[1:])) == ["extra_impacts"]
    assert "missing_impacts" in told(scene, impacts=())


def test_small_late_impacts_and_ones_out_of_phase_are_not_missed():
    """In a motion in which each swing takes 1 % longer: after some impacts there is no match to speak of."""
    own = impacts(FREE)
    fastest = max(abs(impact.rate_before) for impact in own)
    assert told(FREE, impacts=tuple(impact for impact in own if abs(impact.rate_before) > 0.1 * fastest)) == []
    assert told(FREE, impacts=tuple(replace(impact, time=1.04 * impact.time) for impact in own)) == []


def test_what_cannot_be_compared():
    jumps = Scene(block=Block(mass=1.0, radius=1.0, slenderness=1.2), start=Start(tilt_rate=3.4), duration=0.5)
    assert "normal force" in compare(jumps, simulate(jumps, history=False)).comparable
    slides = FREE.with_(friction=0.5 * simulate(FREE, history=False).friction_demand)
    run = compare(slides, replace(simulate(slides, history=False), peak_tilt=1.0))
    assert "friction demand" in run.comparable and run.differences == ()
    failed = replace(run, outcome="failed", failure=Failure("it broke"))
    assert compare(FREE, failed) is failed


def test_on_an_edge_a_copy_of_the_scene_differs_too():
    """Let go a millionth short of balance: what overturns there is no fault of an engine."""
    scene = Scene(block=BLOCK, start=Start(tilt=BLOCK.slenderness * (1 - 1e-5)))
    run = compare(scene, replace(simulate(scene, history=False), outcome="overturns"))
    assert run.comparable == EDGE and [one.quantity for one in run.differences] == ["outcome"]
    wrong = replace(simulate(scene, history=False), outcome="overturns", impacts=())
    assert all(one.quantity != "restitution" for one in compare(scene, wrong).differences)


def test_a_difference_is_data_and_a_sentence():
    assert all("7" in str(Difference(quantity, 7, 7, None)) for quantity in DIFFERENCES)
    run = compare(FREE, replace(simulate(FREE, history=False), peak_tilt=0.2))
    assert Response.from_json(run.to_json()).differences == run.differences
    (found,) = run.differences
    assert (found.here, found.model, found.limit) == (0.2, pytest.approx(0.14), PEAK)


def test_differences_up_to_a_time():
    model = simulate(FREE, history=False)
    run = replace(model, impacts=model.impacts[:2])
    assert differences(FREE, model, run, until=model.impacts[1].time) == []
    assert [one.quantity for one in differences(FREE, model, run)] == ["missing_impacts"]
