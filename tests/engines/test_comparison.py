"""The comparison with the analytic model: what differs is told, what does not or cannot be compared is not."""

import math
from dataclasses import replace

import numpy as np
import pytest

from analytic import Base, Bearings, Block, Failure, Impact, PulseMotion, Response, Scene, Start, load_scene, simulate
from analytic.errors import SceneError
from analytic.response import COMPARED, DIFFERENCES, EDGE, Difference
from engines.comparison import FRICTION, Reference, compare, outcome_of
from engines.matching import STILL

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
@pytest.mark.parametrize("share, found", [(0.0, False), (0.018, False), (0.022, True), (float("nan"), True)])
def test_peaks_differ_by_more_than_the_limit(scene, quantity, share, found):
    value = getattr(simulate(scene, history=False), quantity)
    wanted = [quantity] if found and (value > 0 or share != share) else []
    assert told(scene, **{quantity: value * (1 + share)}) == wanted


def test_a_tilt_below_the_range_is_compared_as_one_at_its_limit():
    scene = Scene(block=BLOCK, start=Start(tilt=1e-3 * BLOCK.slenderness))
    least = 0.01 * BLOCK.slenderness
    peak = simulate(scene, history=False).peak_tilt
    assert told(scene, peak_tilt=peak + 0.018 * least) == []
    assert told(scene, peak_tilt=peak + 0.022 * least) == ["peak_tilt"]


def test_a_displacement_too_small_to_count_is_compared_as_one_at_its_limit():
    """A thousandth of a per cent of R gamma, .01 mm of a statue's."""
    least = 1e-5 * BLOCK.radius * BLOCK.slenderness
    scene = SHAKEN.with_(motion=PulseMotion("one-sine", 1e-6, 6.0))
    peak = simulate(scene, history=False).peak_base_displacement
    assert 0 < peak < least
    assert told(scene, peak_base_displacement=peak + 0.018 * least) == []
    assert told(scene, peak_base_displacement=peak + 0.022 * least) == ["peak_base_displacement"]


def test_another_outcome_and_one_that_is_not_decided():
    assert told(FREE, outcome="overturns") == ["outcome"]
    assert told(FREE, outcome="overturns", decided=False) == []


@pytest.mark.parametrize("tilt, found", [(1.5, []), (2.5, ["peak_tilt"])])
def test_outcomes_that_are_told_alike_do_not_differ(tilt, found):
    """Of two blocks that rock, one by less than counts, the peak tilts tell; tilt: over that, the other's."""
    scene = FREE.with_(start=Start(tilt=0.9 * STILL * BLOCK.slenderness))
    model = simulate(scene, history=False)
    assert (model.outcome, outcome_of(scene, model)) == ("rocks", "stands")
    assert told(scene, peak_tilt=tilt * STILL * BLOCK.slenderness) == found
    assert told(scene, peak_tilt=tilt * STILL * BLOCK.slenderness, outcome="stands") == found


# It overturns after three impacts, on bearings that swing on after the pulse; under a stronger one at once.
FALLING = Scene(
    block=Block(mass=1000.0, radius=1.0, slenderness=0.15),
    base=Base(mass=400.0),
    bearings=Bearings(law="linear", ka=3e4),
    motion=PulseMotion("one-sine", 2.5, 6.0),
)


def fall(scene=FALLING):
    response = simulate(scene, history=False)
    assert response.outcome == "overturns"
    return response


PERIOD = 2 * math.pi / FALLING.rocking_frequency


@pytest.mark.parametrize(
    "changed, found",
    [
        ({}, []),
        ({"fall_time": 0.019 * PERIOD, "overturning_time": 0.019 * PERIOD}, []),
        ({"fall_time": -0.021 * PERIOD}, ["fall_time"]),
        ({"fall_time": PERIOD, "overturning_time": PERIOD}, ["fall_time"]),  # nor the time that follows from it
        ({"fall_time": math.nan}, ["fall_time"]),
        ({"peak_base_displacement": 0.1}, ["peak_base_displacement"]),
    ],
)
def test_a_fall_at_another_time_and_the_base_up_to_it(changed, found):
    own = fall()
    assert told(FALLING, **{name: getattr(own, name) + by for name, by in changed.items()}) == found


def test_a_fall_in_another_swing_is_another_end():
    """The model under a stronger pulse, in place of an engine, falls at once, before any impact."""
    wrong = simulate(FALLING.with_(motion=FALLING.motion.scaled(1.3)), history=False)
    assert wrong.outcome == "overturns" and (len(wrong.impacts), len(fall().impacts)) == (0, 3)
    run = compare(FALLING, wrong)
    assert run.comparable == COMPARED
    found = {one.quantity: one for one in run.differences}
    assert {"fall_time", "impacts_before_fall", "peak_base_displacement"} <= found.keys()
    assert (found["fall_time"].here, found["fall_time"].model) == (wrong.fall_time, fall().fall_time)
    assert found["fall_time"].limit == pytest.approx(0.02 * PERIOD)
    counts = found["impacts_before_fall"]
    assert (counts.here, counts.model, counts.limit) == (0, 3, 0)


def test_impacts_before_the_fall_are_counted_where_none_is_missed_for_its_time():
    own = fall()
    assert len(own.impacts) > 1
    assert "impacts_before_fall" in told(FALLING, impacts=own.impacts[1:])
    first = own.impacts[0]
    twice = (first, replace(first, time=first.time + 0.2 * PERIOD), *own.impacts[1:])
    assert "impacts_before_fall" in told(FALLING, impacts=twice)
    fastest = max(abs(impact.rate_before) for impact in own.impacts)
    small = Impact(own.fall_time - 0.01, 0.0999 * fastest, -0.09 * fastest, 0.0)  # within 2 % of counting: it may
    assert "impacts_before_fall" not in told(FALLING, impacts=(*own.impacts, small))


def test_in_the_last_fall_an_engine_slides_from_where_the_contact_of_the_model_does_not_hold():
    """There the horizontal force passes `FRICTION` times the normal one, by the model's own history."""
    own, step = fall(), 1e-4
    history = simulate(FALLING, output_step=step).history
    tilt, rate = history.tilt, history.tilt_rate
    block, late = FALLING.block, history.time > own.fall_time
    c, n = (block.radius * f(np.sign(tilt) * block.slenderness - tilt) for f in (np.cos, np.sin))
    spin, base = np.gradient(rate, history.time), np.gradient(history.base_velocity, history.time)
    normal = 9.81 + n * spin - c * rate**2
    push = base + history.ground_acceleration + c * spin + n * rate**2
    released = history.time[late & ((normal <= 0) | (np.abs(push) > FRICTION * normal))][0]
    rest = own.overturning_time - released
    assert 0.05 < rest < own.overturning_time - own.fall_time
    room = 0.02 * PERIOD + rest
    assert told(FALLING, overturning_time=own.overturning_time + 0.97 * room) == []
    assert told(FALLING, overturning_time=own.overturning_time + 1.03 * room) == ["overturning_time"]


def impacts(scene):
    return simulate(scene, history=False).impacts


@SCENES
@pytest.mark.parametrize("factor, found", [(1.009, []), (0.98, ["restitution"]), (float("nan"), ["restitution"])])
def test_restitution_of_one_impact(scene, factor, found):
    own = list(impacts(scene))
    one = own[1]
    own[1] = replace(one, rate_after=one.rate_after * factor)
    assert told(scene, impacts=tuple(own)) == found


def slower(impact, energy):
    """The impact that takes so much of the rotational energy [share]."""
    return replace(impact, rate_after=math.copysign(abs(impact.rate_before) * math.sqrt(1 - energy), impact.rate_after))


@pytest.mark.parametrize("slenderness, loss", [(0.01, 3e-4), (0.1, 0.0297)])
def test_a_loss_is_told_where_restitution_is_near_one(slenderness, loss):
    """Of a slender block 1 - e^2 tells what e does not; below .02, the least of a statue, it is compared as that."""
    scene = Scene(block=Block(mass=1000.0, radius=1.0, slenderness=slenderness), start=Start(tilt=0.6 * slenderness))
    own = list(impacts(scene))
    taken = 1 - (own[0].rate_after / own[0].rate_before) ** 2
    assert taken == pytest.approx(loss, rel=2e-3)
    room = 0.1 * max(taken, 0.02)
    assert told(scene, impacts=(slower(own[0], taken + 0.95 * room), *own[1:])) == []
    assert told(scene, impacts=(slower(own[0], taken + 1.05 * room), *own[1:])) == ["impact_loss"]
    assert told(scene, impacts=(slower(own[0], taken + 0.1), *own[1:])) == ["restitution"]  # which says it


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


def test_impacts_out_of_phase_and_beside_the_end_have_no_match_to_miss():
    own = impacts(FREE)
    swing = own[2].time - own[1].time
    for late, found in ((0.05, ["missing_impacts"]), (0.2, [])):
        moved = [replace(impact, time=impact.time + late * swing * (k > 0)) for k, impact in enumerate(own)]
        assert told(FREE, impacts=(*moved[:2], *moved[3:])) == found
    period = 2 * math.pi / FREE.rocking_frequency
    for before, found in ((0.005, []), (0.05, ["missing_impacts"])):
        cut = FREE.with_(duration=own[2].time + before * period)
        run = compare(cut, replace(simulate(cut, history=False), impacts=own[:2]))
        assert [one.quantity for one in run.differences] == found


def test_what_cannot_be_compared_and_the_friction_with_which_it_can():
    jumps = Scene(block=Block(mass=1.0, radius=1.0, slenderness=1.2), start=Start(tilt_rate=3.4), duration=0.5)
    slides = Scene(
        block=Block(mass=1.0, radius=1.0, slenderness=1.45), motion=PulseMotion("half-sine", 60.0, 30.0), duration=0.5
    )
    for scene, words, does in ((jumps, "normal force", "flies"), (slides, "friction demand", "slides")):
        run = compare(scene, replace(simulate(scene, history=False), peak_tilt=1.0))
        assert words in run.comparable and "friction = 0.6" in run.comparable and does in run.comparable
        assert run.differences == ()
    run = slides.with_(friction=0.6)
    assert compare(run, simulate(run, history=False)).comparable == COMPARED
    failed = replace(simulate(FREE, history=False), outcome="failed", failure=Failure("it broke"))
    assert compare(FREE, failed) is failed


def test_a_difference_is_data_and_a_sentence():
    assert all("7" in str(Difference(quantity, 7, 7, None)) for quantity in DIFFERENCES)
    run = compare(FREE, replace(simulate(FREE, history=False), peak_tilt=0.2))
    assert Response.from_json(run.to_json()).differences == run.differences
    (found,) = run.differences
    assert (found.here, found.model, found.limit) == (0.2, pytest.approx(0.14), 0.02)
    assert found.near == (pytest.approx(0.14 * (1 - 1e-4)), pytest.approx(0.14 * (1 + 1e-4)))


EDGE_SCENE = Scene(block=BLOCK, start=Start(tilt=BLOCK.slenderness * (1 - 1e-5)))


def test_near_an_outcome_boundary_either_outcome_is_right_and_a_third_is_not():
    """Let go a hundred-thousandth short of balance: what overturns there is no fault of an engine."""
    own = simulate(EDGE_SCENE, history=False)
    over = simulate(EDGE_SCENE.with_(start=Start(tilt=BLOCK.slenderness * (1 + 1e-5))), history=False)
    assert (own.outcome, over.outcome) == ("rocks", "overturns")
    for run in (own, over):
        assert (compare(EDGE_SCENE, run).comparable, compare(EDGE_SCENE, run).differences) == (EDGE, ())
    stands = replace(own, outcome="stands", peak_tilt=0.0, impacts=())
    run = compare(EDGE_SCENE, stands)
    assert run.comparable == EDGE and "outcome" in [one.quantity for one in run.differences]


def test_what_lies_outside_what_near_copies_do_is_a_difference_with_their_span():
    """A rectangular pulse at 1.001 of uplift: a change of 1e-4 of the pulse changes the peak tilt by a tenth."""
    block = Block(mass=1000.0, radius=1.0, slenderness=0.25)
    scene = Scene(block=block, motion=PulseMotion("rectangular", 2.5074, 2.0))
    model = simulate(scene, history=False)
    peaks = [
        simulate(scene.with_(motion=scene.motion.scaled(factor)), history=False).peak_tilt
        for factor in (0.9999, 1.0001)
    ]
    peaks += [
        simulate(scene.with_(block={"slenderness": 0.25 * factor}), history=False).peak_tilt
        for factor in (0.9999, 1.0001)
    ]
    low, high = min(peaks), max(peaks)
    assert low < 0.95 * model.peak_tilt and high > 1.05 * model.peak_tilt
    for peak in (0.985 * low, low, model.peak_tilt, high, 1.015 * high):
        run = compare(scene, replace(model, peak_tilt=peak))
        assert (run.comparable, run.differences) == (EDGE, ())  # the model's word alone, whatever a run does
    for peak in (0.975 * low, 1.025 * high, 0.01891):
        run = compare(scene, replace(model, peak_tilt=peak))
        (found,) = run.differences
        assert run.comparable == EDGE and (found.here, found.model) == (peak, model.peak_tilt)
        assert found.near == (pytest.approx(low), pytest.approx(high))
        assert f"({low:.3g} to {high:.3g} in the analytic model within 0.01 % of the scene)" in str(found)


def test_where_only_copies_end_as_the_run_does_no_number_is_called_the_models():
    """The block of `EDGE_SCENE` starts just beyond its balance and falls; some copies come back."""
    scene = EDGE_SCENE.with_(start=Start(tilt=BLOCK.slenderness * (1 + 5e-5)))
    model = simulate(scene, history=False)
    back = simulate(scene.with_(start=Start(tilt=BLOCK.slenderness * (1 - 4e-5))), history=False)
    assert (model.outcome, back.outcome) == ("overturns", "rocks")
    run = compare(scene, replace(back, peak_tilt=0.5 * back.peak_tilt))
    (found,) = (one for one in run.differences if one.quantity == "peak_tilt")
    assert found.model is None and found.near is not None
    low, high = found.near
    words = f"peak tilt {found.here:.4g} rad ({low:.3g} to {high:.3g} in the analytic model within 0.01 % of the scene)"
    assert str(found) == words


def test_a_near_copy_that_reaches_no_end_leaves_the_run_uncompared(monkeypatch):
    """The run is kept: a finished one of an engine is not lost to a copy."""

    def of_the_scene_alone(scene, **options):
        if scene is not EDGE_SCENE:
            raise SceneError("run.duration", 3e6, "too many impacts", "shorten it")
        return simulate(scene, **options)

    monkeypatch.setattr("engines.comparison.simulate", of_the_scene_alone)
    reference = Reference.of(EDGE_SCENE)
    assert reference.model is not None
    assert reference.comparable.startswith("the analytic model refuses a scene within 0.0001 of it: ")


@pytest.mark.parametrize("change, comparable", [(5e-5, EDGE), (2e-4, COMPARED)])
def test_near_is_one_part_in_ten_thousand(change, comparable):
    scene = EDGE_SCENE.with_(start=Start(tilt=BLOCK.slenderness * (1 - change)))
    reference = Reference.of(scene)
    assert reference.comparable == reference.end_comparable == comparable
    assert reference.near == ({"outcome"} if comparable == EDGE else frozenset())


def test_a_scene_near_an_edge_of_a_peak_alone_can_be_judged_by_how_it_ends():
    scene = Scene(
        block=Block(mass=1000.0, radius=1.0, slenderness=0.25), motion=PulseMotion("rectangular", 2.5074, 2.0)
    )
    reference = Reference.of(scene)
    assert reference.near == {"peak_tilt"} and (reference.comparable, reference.end_comparable) == (EDGE, COMPARED)


def test_impacts_are_compared_up_to_where_near_copies_part():
    """Beside the boundary the copies that overturn have no second impact: nothing is missed after the first."""
    scene = EDGE_SCENE
    own = simulate(scene, history=False)
    assert Reference.of(scene).until == own.impacts[0].time
    wrong = compare(scene, replace(own, impacts=own.impacts[:1]))
    assert wrong.differences == ()
