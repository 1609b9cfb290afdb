"""The comparison with the analytic model: what differs is told, what does not or cannot be compared is not."""

import math
from dataclasses import replace

import numpy as np
import pytest

from analytic import Base, Bearings, Block, Failure, Impact, PulseMotion, Response, Scene, Start, load_scene, simulate
from analytic.errors import SceneError
from analytic.response import COMPARED, EDGE, Sliding
from analytic.rocking import restitution
from engines import get_engine
from engines.comparison import FRICTION, KICK, Reference, compare, is_too_coarse, outcome_of, too_coarse
from engines.events import STILL
from engines.simulating import RANGE, outside

BLOCK = Block(mass=3172.05, radius=1.0884, slenderness=0.28)
FREE = Scene(block=BLOCK, start=Start(tilt=0.14))
SHAKEN = load_scene("caryatid-isolated").with_(motion=PulseMotion("one-sine", 3.9, 6.0), duration=4.0)
# Below the sizes that count: a hundredth of the slenderness; of R gamma a thousandth of a per cent.
LOW = FREE.with_(start=Start(tilt=1e-3 * BLOCK.slenderness))
WEAK = SHAKEN.with_(motion=PulseMotion("one-sine", 1e-6, 6.0))
# It overturns after three impacts, on bearings that swing on after the pulse; under a stronger one at once.
FALLING = Scene(
    block=Block(mass=1000.0, radius=1.0, slenderness=0.15),
    base=Base(mass=400.0),
    bearings=Bearings(law="linear", ka=3e4),
    motion=PulseMotion("one-sine", 2.5, 6.0),
)
PERIOD = 2 * math.pi / FALLING.rocking_frequency
# Under this pulse, at 1.001 of uplift, a change of 1e-4 of the pulse changes the peak tilt by a tenth.
SHARP = Scene(block=Block(mass=1000.0, radius=1.0, slenderness=0.25), motion=PulseMotion("rectangular", 2.5074, 2.0))
SCENES = pytest.mark.parametrize("scene", [FREE, SHAKEN], ids=["free", "shaken"])


def run_of(scene):
    return simulate(scene, history=False)


def beside(change):
    """A block let go at this share short of its balance."""
    return Scene(block=BLOCK, start=Start(tilt=BLOCK.slenderness * (1 - change)))


def differences_with(scene, **changed):
    """The differences of the model's own response, changed."""
    response = compare(scene, replace(run_of(scene), **changed))
    assert response.comparable == COMPARED
    return response.differences


def quantities_with(scene, **changed):
    return [difference.quantity for difference in differences_with(scene, **changed)]


@pytest.mark.parametrize(
    "scene, name, least",
    [
        (FREE, "peak_tilt", 0.0),
        (LOW, "peak_tilt", 0.01 * BLOCK.slenderness),
        (SHAKEN, "peak_base_displacement", 0.0),
        (WEAK, "peak_base_displacement", 1e-5 * SHAKEN.block.radius * SHAKEN.block.slenderness),
    ],
)
def test_peaks_differ_by_more_than_the_limit(scene, name, least):
    value = getattr(run_of(scene), name)
    assert 0 < value and (least == 0 or value < least)
    for share, differs in ((0.0, False), (0.018, False), (0.022, True), (-0.022, True), (math.nan, True)):
        assert quantities_with(scene, **{name: value + share * max(value, least)}) == [name] * differs


def test_outcomes_differ_where_they_are_decided_and_told_otherwise():
    """Of two blocks that rock, one by less than counts, the peak tilts tell."""
    assert quantities_with(FREE, outcome="overturns") == ["outcome"]
    assert quantities_with(FREE, outcome="overturns", decided=False) == []
    limit = STILL * BLOCK.slenderness
    scene = FREE.with_(start=Start(tilt=0.9 * limit))
    assert (run_of(scene).outcome, outcome_of(scene, run_of(scene))) == ("rocks", "stands")
    for tilt, differs in ((1.5, []), (2.5, ["peak_tilt"])):
        for change in ({}, {"outcome": "stands"}):
            assert quantities_with(scene, peak_tilt=tilt * limit, **change) == differs


@pytest.mark.parametrize(
    "changed, quantities",
    [
        ({"fall_time": 0.019 * PERIOD, "overturning_time": 0.019 * PERIOD}, []),
        ({"fall_time": -0.021 * PERIOD}, ["fall_time"]),
        ({"fall_time": PERIOD, "overturning_time": PERIOD}, ["fall_time"]),  # nor the time that follows from it
        ({"fall_time": math.nan}, ["fall_time"]),
        ({"peak_base_displacement": 0.1}, ["peak_base_displacement"]),
    ],
)
def test_a_fall_at_another_time_and_the_base_up_to_it(changed, quantities):
    model = run_of(FALLING)
    assert quantities_with(FALLING, **{name: getattr(model, name) + by for name, by in changed.items()}) == quantities


def test_impacts_before_the_fall_are_counted_where_none_is_missed_for_its_time():
    falling = run_of(FALLING)
    first, *rest = falling.impacts
    fastest = max(abs(impact.rate_before) for impact in falling.impacts)

    def small(share, late=0.0):
        return Impact(falling.fall_time - 0.01 + late, share * fastest, -0.9 * share * fastest, 0.0)

    twice = replace(first, time=first.time + 0.2 * PERIOD)
    # (impacts of the model, of the run, whether they differ); within 2 % of a tenth of the fastest one may count
    for model, run, differs in (
        (falling.impacts, rest, True),
        (falling.impacts, (first, twice, *rest), True),
        (falling.impacts, (*falling.impacts, small(0.0999)), False),
        (falling.impacts, (*falling.impacts, small(0.103)), True),
        ((*falling.impacts, small(0.0999)), (*falling.impacts, small(0.103)), False),
        ((*falling.impacts, small(0.101)), falling.impacts, False),
        ((*falling.impacts, small(0.0999)), (*falling.impacts, small(0.2), small(0.2, 1e-3)), True),
    ):
        reference = replace(Reference.of(FALLING), model=replace(falling, impacts=tuple(model)), copies=())
        differences = compare(FALLING, replace(falling, impacts=tuple(run)), reference).differences
        assert ("impacts_before_fall" in [difference.quantity for difference in differences]) == differs


def test_in_the_last_fall_an_engine_slides_from_where_the_contact_of_the_model_does_not_hold():
    """There the horizontal force passes `FRICTION` times the normal one, by the model's own history."""
    falling, history = run_of(FALLING), simulate(FALLING, output_step=1e-4).history
    tilt, rate = history.tilt, history.tilt_rate
    block, late = FALLING.block, history.time > falling.fall_time
    c, n = (block.radius * f(np.sign(tilt) * block.slenderness - tilt) for f in (np.cos, np.sin))
    spin, base = np.gradient(rate, history.time), np.gradient(history.base_velocity, history.time)
    normal = 9.81 + n * spin - c * rate**2
    push = base + history.ground_acceleration + c * spin + n * rate**2
    released = history.time[late & ((normal <= 0) | (np.abs(push) > FRICTION * normal))][0]
    rest = falling.overturning_time - released
    assert 0.05 < rest < falling.overturning_time - falling.fall_time
    for share, quantities in ((0.97, []), (1.03, ["overturning_time"])):
        time = falling.overturning_time + share * (0.02 * PERIOD + rest)
        assert quantities_with(FALLING, overturning_time=time) == quantities


def slower(impact, energy):
    """The impact that takes so much of the rotational energy [share]."""
    return replace(impact, rate_after=math.copysign(abs(impact.rate_before) * math.sqrt(1 - energy), impact.rate_after))


@SCENES
def test_impacts_that_differ_are_missing_or_too_many_are_told_with_their_numbers(scene):
    known = run_of(scene).impacts
    for factor, quantities in ((1.009, []), (0.98, ["restitution"]), (math.nan, ["restitution"])):
        changed = replace(known[1], rate_after=known[1].rate_after * factor)
        assert quantities_with(scene, impacts=(known[0], changed, *known[2:])) == quantities
    fastest = max(abs(impact.rate_before) for impact in known)
    count = sum(abs(impact.rate_before) > 0.1 * fastest for impact in known)
    between = Impact(0.5 * (known[0].time + known[1].time), known[1].rate_before, known[1].rate_after, 0.0)
    for impacts, wanted in (
        (known[:1] + known[2:], ("missing_impacts", count - 1, count)),
        ((known[0], between, *known[1:]), ("extra_impacts", count + 1, count)),
        ((), ("missing_impacts", 0, count)),
    ):
        (difference,) = differences_with(scene, impacts=impacts)
        assert (difference.quantity, difference.here, difference.model) == wanted


@pytest.mark.parametrize("slenderness, loss", [(0.01, 3e-4), (0.1, 0.0297)])
def test_a_loss_is_told_where_restitution_is_near_one(slenderness, loss):
    """Of a slender block 1 - e^2 tells what e does not; below .02, the least of a statue, it is compared as that."""
    scene = Scene(block=Block(mass=1000.0, radius=1.0, slenderness=slenderness), start=Start(tilt=0.6 * slenderness))
    first, *rest = run_of(scene).impacts
    taken = 1 - (first.rate_after / first.rate_before) ** 2
    assert taken == pytest.approx(loss, rel=2e-3)
    room = 0.1 * max(taken, 0.02)
    for more, quantity in ((0.95 * room, []), (1.05 * room, ["impact_loss"]), (0.1, ["restitution"])):
        assert quantities_with(scene, impacts=(slower(first, taken + more), *rest)) == quantity


def test_small_impacts_ones_out_of_phase_and_ones_beside_the_end_have_no_match_to_miss():
    known = run_of(FREE).impacts
    fastest = max(abs(impact.rate_before) for impact in known)
    counted = tuple(impact for impact in known if abs(impact.rate_before) > 0.1 * fastest)
    assert quantities_with(FREE, impacts=counted) == []
    # each swing takes longer: after some impacts there is no match to speak of
    late = tuple(replace(impact, time=1.04 * impact.time) for impact in known)
    assert quantities_with(FREE, impacts=late) == []
    swing, period = known[2].time - known[1].time, 2 * math.pi / FREE.rocking_frequency
    for late, quantities in ((0.05, ["missing_impacts"]), (0.2, [])):
        moved = [replace(impact, time=impact.time + late * swing * (k > 0)) for k, impact in enumerate(known)]
        assert quantities_with(FREE, impacts=(*moved[:2], *moved[3:])) == quantities
    for before, quantities in ((0.005, []), (0.05, ["missing_impacts"])):
        cut = FREE.with_(duration=known[2].time + before * period)
        differences = compare(cut, replace(run_of(cut), impacts=known[:2])).differences
        assert [difference.quantity for difference in differences] == quantities


def test_what_cannot_be_compared_and_the_friction_with_which_it_can():
    jumps = Scene(block=Block(mass=1.0, radius=1.0, slenderness=1.2), start=Start(tilt_rate=3.4), duration=0.5)
    slides = Scene(
        block=Block(mass=1.0, radius=1.0, slenderness=1.45), motion=PulseMotion("half-sine", 60.0, 30.0), duration=0.5
    )
    for scene, words, does in ((jumps, "normal force", "flies"), (slides, "friction demand", "slides")):
        run = compare(scene, replace(run_of(scene), peak_tilt=1.0))
        assert words in run.comparable and "friction = 0.6" in run.comparable and does in run.comparable
        assert run.differences == ()
    assert quantities_with(slides.with_(friction=0.6)) == []
    failed = replace(run_of(FREE), outcome="failed", failure=Failure("it broke"))
    assert compare(FREE, failed) is failed


def test_near_an_outcome_boundary_either_outcome_is_right_and_a_third_is_not():
    """What overturns there is no fault of an engine; impacts are compared up to where the copies part."""
    scene = beside(1e-5)
    upright, over = run_of(scene), run_of(beside(-1e-5))
    assert (upright.outcome, over.outcome) == ("rocks", "overturns")
    assert Reference.of(scene).until == upright.impacts[0].time
    for run in (upright, over, replace(upright, impacts=upright.impacts[:1])):
        assert (compare(scene, run).comparable, compare(scene, run).differences) == (EDGE, ())
    run = compare(scene, replace(upright, outcome="stands", peak_tilt=0.0, impacts=()))
    assert run.comparable == EDGE and "outcome" in [difference.quantity for difference in run.differences]


def test_what_lies_outside_what_near_copies_do_is_a_difference_with_their_span():
    model, gamma = run_of(SHARP), SHARP.block.slenderness
    copies = [SHARP.with_(motion=SHARP.motion.scaled(factor)) for factor in (0.9999, 1.0001)]
    copies += [SHARP.with_(block={"slenderness": gamma * factor}) for factor in (0.9999, 1.0001)]
    peaks = [run_of(copy).peak_tilt for copy in copies]
    low, high = min(peaks), max(peaks)
    assert low < 0.95 * model.peak_tilt and high > 1.05 * model.peak_tilt
    reference = Reference.of(SHARP)
    assert reference.near == {"peak_tilt"} and (reference.comparable, reference.end_comparable) == (EDGE, COMPARED)
    for peak in (0.985 * low, low, model.peak_tilt, high, 1.015 * high):
        assert compare(SHARP, replace(model, peak_tilt=peak), reference).differences == ()
    for peak in (0.975 * low, 1.025 * high, 0.01891):
        (difference,) = compare(SHARP, replace(model, peak_tilt=peak), reference).differences
        assert (difference.here, difference.model, difference.near) == (
            peak,
            model.peak_tilt,
            pytest.approx((low, high)),
        )
        assert f"({low:.3g} to {high:.3g} in the analytic model within 0.01 % of the scene)" in str(difference)


def test_where_only_copies_end_as_the_run_does_no_number_is_called_the_models():
    """It starts just beyond its balance and falls; some copies come back."""
    scene, back = beside(-5e-5), run_of(beside(4e-5))
    assert (run_of(scene).outcome, back.outcome) == ("overturns", "rocks")
    run = compare(scene, replace(back, peak_tilt=0.5 * back.peak_tilt))
    (difference,) = (difference for difference in run.differences if difference.quantity == "peak_tilt")
    low, high = difference.near
    copies = f"({low:.3g} to {high:.3g} in the analytic model within 0.01 % of the scene)"
    assert difference.model is None and str(difference) == f"peak tilt {difference.here:.4g} rad {copies}"


def test_a_near_copy_that_reaches_no_end_leaves_the_run_uncompared(monkeypatch):
    """The run is kept: a finished one of an engine is not lost to a copy."""

    def of_the_scene_alone(scene, **options):
        if scene is not FREE:
            raise SceneError("run.duration", 3e6, "too many impacts", "shorten it")
        return simulate(scene, **options)

    monkeypatch.setattr("engines.comparison.simulate", of_the_scene_alone)
    reference = Reference.of(FREE)
    assert reference.model is not None
    assert reference.comparable.startswith("the analytic model refuses a scene within 0.0001 of it: ")


@pytest.mark.parametrize("change, comparable", [(5e-5, EDGE), (2e-4, COMPARED)])
def test_near_is_one_part_in_ten_thousand(change, comparable):
    reference = Reference.of(beside(change))
    assert reference.comparable == reference.end_comparable == comparable
    assert reference.near == ({"outcome"} if comparable == EDGE else frozenset())


# The promised range: what lies outside it is said, of each quantity by itself.

STATUE = Block(mass=1000.0, radius=1.0, slenderness=0.25)
ROCKING = Scene(block=STATUE, start=Start(tilt=0.1))


def borne(period, damping=0.0):
    """On bearings that carry 2000 kg, by their period [s]; damping: of the critical."""
    frequency = 2 * math.pi / period
    bearings = Bearings(law="linear", ka=2000 * frequency**2, damping=2 * 2000 * frequency * damping)
    return ROCKING.with_(base=Base(mass=1000.0), bearings=bearings)


def outside_of(scene):
    return [(caution.quantity, caution.value, caution.limit) for caution in outside(scene, run_of(scene))]


@pytest.mark.parametrize(
    "scene, named",
    [
        (ROCKING, []),
        (borne(2.0), []),
        (Scene(block=STATUE), []),  # it stands: no tilt to be too small
        (ROCKING.with_(block={"slenderness": 0.01}, start=Start(tilt=0.006)), [("slenderness", 0.01, 0.1)]),
        (ROCKING.with_(block={"slenderness": 0.6}), [("slenderness", 0.6, 0.5)]),
        (ROCKING.with_(block={"radius": 0.09}), [("radius", 0.09, 0.1)]),
        (
            ROCKING.with_(block={"radius": 11.0, "slenderness": 0.09}, start=Start(tilt=0.05)),
            [("slenderness", 0.09, 0.1), ("radius", 11.0, 10.0)],
        ),
        (ROCKING.with_(block={"corner_inertia": 1100.0}), [("inertia", 1.1, 1.2)]),
        (ROCKING.with_(base=Base(mass=10.0)), [("base_mass", 0.01, 0.05)]),
        (borne(0.25), [("period", 0.25, 0.3)]),
        (borne(6.0), [("period", 6.0, 5.0)]),
        (borne(2.0, 1.5), [("damping", 1.5, 1.0)]),
        (ROCKING.with_(start=Start(tilt=0.001)), [("tilt", 0.004, 0.01)]),
    ],
)
def test_each_quantity_is_held_against_the_limits_of_the_range(scene, named):
    assert outside_of(scene) == [(name, pytest.approx(value), limit) for name, value, limit in named]


def test_a_block_that_stands_has_no_tilt_whatever_an_engine_leaves_of_it():
    scene = Scene(block=STATUE)
    stands = replace(run_of(scene), peak_tilt_ratio=1e-6)
    for outcome, named in (("stands", []), ("slides", []), ("rocks", ["tilt"])):
        assert [caution.quantity for caution in outside(scene, replace(stands, outcome=outcome))] == named
    known = {"engine": "crude", "variant": "", "settings": {}, "versions": {}}
    failed = Response.unmeasured(outcome="failed", failure=Failure("no run", ""), **known)
    assert not outside(scene, failed)  # its peak tilt is no number


@pytest.mark.parametrize("engine", ["exudyn", "pybullet"])
def test_an_engine_says_once_that_a_scene_is_outside_the_range_and_is_compared(engine):
    """At a slenderness of .01 PyBullet takes 45 times the loss of eq. (7), with e off by .007 alone."""
    scene = ROCKING.with_(block={"slenderness": 0.01}, start=Start(tilt=0.006), duration=2.0)
    scenes = scene, ROCKING.with_(duration=0.2)
    run, inside = (get_engine(engine).simulate(given, history=False) for given in scenes)
    texts = ([str(caution) for caution in response.warnings] for response in (run, inside))
    warned, none = ([text for text in each if "outside the range" in text] for each in texts)
    low, high, words = RANGE["slenderness"]
    words = words.format(low=low, high=high)
    assert (warned, none) == (
        [f"slenderness 0.01 is outside the range in which engines are tested ({words}): nothing is promised there"],
        [],
    )
    losses = [difference for difference in run.differences if difference.quantity == "impact_loss"]
    assert len(losses) == (engine == "pybullet")
    assert all(loss.model == pytest.approx(3e-4, rel=1e-3) and loss.here > 10 * loss.model for loss in losses)


TUNED = get_engine("pybullet").variants["impact-aware"]


def impact_of(scene, error, share):
    """The model's run, with one impact: a free swing that reaches `share` of the slenderness, e off by `error`."""
    block = scene.block
    rate = scene.rocking_frequency * math.sqrt(2 * share * math.sin(block.slenderness) * block.slenderness)
    impact = Impact(1.0, -rate, -rate * (restitution(scene) + error), 0.0)
    settings = {"largest_step": TUNED.default}
    return replace(run_of(scene), impacts=(impact,), settings=settings)


@pytest.mark.parametrize("scene", [FREE, SHAKEN], ids=["rigid", "base"])
def test_a_run_is_too_coarse_by_its_own_impacts(scene):
    """By the closed form of a free swing, whose pull toward contact is p^2 sin(gamma)."""
    model = run_of(scene)
    assert len(model.impacts) > 1 and too_coarse(scene, replace(model, settings={"largest_step": 1e-3}), TUNED) == ()
    if scene.base:
        return
    e, share = restitution(scene), 0.5
    for part, warns in ((0.9, False), (1.1, True)):
        error = math.sqrt(e**2 + part * KICK / share) - e  # the swing is higher by this part of what is permitted
        run = impact_of(scene, error, share)
        assert is_too_coarse(replace(run, warnings=too_coarse(scene, run, TUNED))) == warns
        lower = impact_of(scene, math.sqrt(e**2 - part * KICK / share) - e, share)
        assert bool(too_coarse(scene, lower, TUNED)) == warns
    assert too_coarse(scene, impact_of(scene, -0.5, 1e-5), TUNED) == ()  # a swing that matters to nobody


def test_the_warning_names_a_finer_level_of_tuned_variants():
    run = impact_of(FREE, -0.3, 0.5)
    e = restitution(FREE)
    for step, words in ((7e-3, "use largest_step = 0.003"), (1e-3, "use largest_step = 0.0005"), (5e-4, "no finer")):
        (caution,) = too_coarse(FREE, replace(run, settings={"largest_step": step}), TUNED)
        assert words in caution.text and (caution.kind, caution.limit) == ("engine", e)
        assert caution.value == pytest.approx(e - 0.3)
    stiff = get_engine("exudyn").variants["compliant-corners"]
    (caution,) = too_coarse(FREE, replace(run, settings={"stiffness": 4.47e10}), stiff)
    assert "use stiffness = 2e+11" in caution.text
    assert too_coarse(FREE, run, get_engine("pybullet").variants["first-script"]) == ()
    slid = Sliding(peak=0.01, end=0.0, path=0.01, work=math.nan, modes=())
    assert too_coarse(FREE, replace(run, sliding=slid), TUNED) == ()


def test_an_engines_run_carries_the_warning_also_without_the_models():
    """At steps of .05 s PyBullet loses half the rate at an impact; at its default of 1 ms nothing is to be said."""
    for settings, warned in (({"largest_step": 0.05}, True), ({}, False)):
        engine = get_engine("pybullet")
        run = engine.simulate(FREE.with_(duration=3.5), history=False, compare=False, **settings)
        assert run.failure is None and len(run.impacts) > 3 and is_too_coarse(run) == warned
