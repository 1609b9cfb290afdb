"""What makes a setting pass, and what does not; the answers of runs are made up, but for one."""

import math
from dataclasses import replace

import pytest
from roads import KINDS, write_records
from sliding_scenes import SAVED, SLIDES

from analytic import PulseMotion, SampledMotion, Start, load_scene, simulate
from analytic.errors import SettingError
from comparisons.advice import criteria
from comparisons.advice.choose import Search, choose, problem
from comparisons.execution.cases import Case
from comparisons.execution.sweep import Row
from comparisons.sheet.pages import PROBLEMS
from engines import ENGINES, get_engine

RIGID = load_scene("free-rocking-rigid")
GIVEN = RIGID.with_(block={"restitution": 0.7})
STANDING = next(each.scene for each in PROBLEMS if each.name == "isolated-standing")
ENGINE, VARIANT = "pybullet", "fixed-step"


def row(error, cpu=1.0, failure=None):
    values = {"outcome": "rocks", "error": error, "simulated": 1.0, "too_coarse": False}
    return Row(Case(RIGID, ENGINE, VARIANT), values, failure, {"cpu_seconds": cpu}, False)


def test_a_run_that_says_it_is_too_coarse_does_not_pass():
    good, warned = row(1e-5), row(1e-5)
    warned.values["too_coarse"] = True
    assert problem({1.0: good}, 1e-3, "tilt") == (1e-5, None)
    assert problem({1.0: good, 1.05: warned}, 1e-3, "tilt") == (
        1e-5,
        "warns that it is too coarse at 1.05 of the scene",
    )


def test_neighbours_have_start_and_motion_scaled():
    motion = SampledMotion(0.1, [0.0, 1.0, 0.0])
    family, left = criteria.neighbours(RIGID.with_(motion=motion), "tilt")
    assert not left and list(family) == [1.0, *criteria.FACTORS]
    for factor, scene in family.items():
        assert scene.start.tilt == pytest.approx(factor * RIGID.start.tilt)
        assert scene.motion.peak == pytest.approx(factor)
    assert len(criteria.neighbours(RIGID, "outcome")[0]) == 9
    with pytest.raises(SettingError, match="nothing moves"):
        criteria.neighbours(RIGID.with_(start={"tilt": 0.0}), "tilt")


def test_a_neighbour_that_the_model_refuses_is_left_out_and_named():
    """Released beyond its balance the block falls; from .28 rad down it lands, and slips at a friction below (8)'s."""
    scene = RIGID.with_(start=Start(tilt=0.29), friction=0.2, duration=None)
    family, left = criteria.neighbours(scene, "outcome")
    assert set(left) == {0.95, 0.9625} and all("below 0.2113" in why for why in left.values())
    assert set(family) == {1.0, *criteria.FACTORS, *criteria.MORE_FACTORS} - {0.95, 0.9625}


def test_outcomes_are_those_of_runs_that_no_duration_cuts():
    falling = RIGID.with_(start=Start(), motion=PulseMotion("one-sine", 6.0, 5.0), duration=1.0)
    whole = criteria.neighbours(falling, "outcome")[0][1.0]
    assert simulate(whole).outcome == "overturns" and criteria.until(whole, "outcome") == simulate(whole).end.time > 1.0
    assert criteria.neighbours(falling, "tilt")[0][1.0].duration == 1.0


def test_restitution_is_looked_at_up_to_the_eighth_strong_impact():
    quarter = 0.25 * 2 * math.pi / RIGID.rocking_frequency
    assert criteria.until(RIGID, "restitution") == pytest.approx(simulate(RIGID).impacts[7].time + quarter)


@pytest.mark.parametrize(
    "scene, criterion",
    [
        (RIGID, "restitution"),
        (STANDING, "displacement"),
        (RIGID.with_(start=Start(), motion=PulseMotion("one-sine", 0.5, 5.0)), "outcome"),
        (GIVEN, "tilt"),
        (SAVED, "tilt"),
        (SLIDES, "slip"),
    ],
)
def test_a_block_that_never_hits_is_judged_by_what_it_shows(scene, criterion):
    assert criteria.fitting(scene) == criterion


@pytest.mark.parametrize("engine", ["exudyn", "pybullet"])
def test_the_displacement_of_a_block_that_overturns_is_compared_up_to_its_last_fall(engine):
    """In the fall an engine's block slides, which is no fault of the level. It overturns without an impact."""
    pulse = PulseMotion("half-sine", 5.0, 2.0)
    scene = load_scene("caryatid-isolated").with_(motion=pulse, duration=None)
    model = simulate(scene)
    assert (model.outcome, model.impacts, criteria.fitting(scene)) == ("overturns", (), "displacement")
    cut = scene.with_(duration=criteria.until(scene, "displacement"))
    assert cut.duration < model.end.time and abs(simulate(cut).end.tilt) <= scene.block.slenderness
    run = get_engine(engine).simulate(cut)
    assert run.failure is None and criteria.error("displacement", cut, run, simulate(cut)) < 1e-3


def test_errors_are_those_of_the_criterion():
    scene = RIGID.with_(duration=4.0)
    model = simulate(scene)
    hits = model.impacts
    shifted = replace(model.history, tilt=model.history.tilt + 0.01 * RIGID.block.slenderness)
    lossy = tuple(replace(hit, rate_after=0.99 * hit.rate_after) for hit in hits)
    for criterion, changes, error in (
        ("tilt", {"history": shifted}, 0.01),
        ("tilt", {"history": None}, None),
        ("outcome", {"outcome": "overturns"}, 1.0),
        ("restitution", {"impacts": lossy}, 0.01 * hits[0].rate_after / hits[0].rate_before),
        ("restitution", {"impacts": ()}, None),
        ("restitution", {"impacts": (hits[0], *hits[2:4])}, None),  # one is missed
        ("restitution", {"impacts": hits[1:4]}, None),
    ):
        result = criteria.error(criterion, scene, replace(model, **changes), model)
        assert result == (None if error is None else pytest.approx(error, rel=1e-6)), (criterion, changes)


def test_no_variant_is_chosen_by_a_restitution_that_the_scene_gives():
    with pytest.raises(SettingError, match="--for restitution: .* gives it; choose one of tilt"):
        criteria.until(GIVEN, "restitution")


@pytest.mark.parametrize("engine", ENGINES)
def test_the_cost_of_a_third_dimension_is_known_where_the_restitution_is_given(engine):
    """A free block takes no couple: it was asked for one."""
    assert criteria._space(GIVEN.with_(duration=1.0), [engine])[0] is False


@pytest.mark.parametrize(
    "rows, permitted, error, why",
    [
        ((row(4e-4), row(4.9e-4)), (1e-3, "tilt"), 4.9e-4, None),
        ((row(4e-4), row(6e-4)), (1e-3, "tilt"), 6e-4, "less than 2 times below"),
        ((row(4e-4), row(2e-3)), (1e-3, "tilt"), 2e-3, "error 2.0e-03"),
        ((row(1e-6), row(None)), (1e-3, "tilt"), None, "shows no tilt at 1 "),
        ((row(math.nan),), (1e-3, "tilt"), None, "shows no tilt"),
        ((row(1e-6, failure={"reason": "it fell"}),), (1e-3, "tilt"), None, "it fell"),
        ((*[row(0.0)] * 7, row(1.0)), (0.13, "outcome"), 0.125, None),  # the share counts
        ((*[row(0.0)] * 7, row(1.0)), (0.12, "outcome"), 0.125, "error"),
    ],
)
def test_what_keeps_a_setting_from_passing(rows, permitted, error, why):
    result, words = problem(dict(enumerate(rows)), *permitted)
    assert result == error and (words is None if why is None else why in words)


class Made(Search):
    """In place of runs: errors by level (of the scene, of the neighbours), costs falling along the levels."""

    def __init__(self, errors, whole=None):
        super().__init__(RIGID, criteria.neighbours(RIGID, "tilt")[0], 1e-3, "tilt", None)
        self.levels = get_engine(ENGINE).variants[VARIANT].levels[-3:]
        self.errors, self.failure, self.asked = dict(zip(self.levels, errors, strict=True)), whole, set()
        self.run([(ENGINE, VARIANT, value) for value in self.levels], [1.0], "")

    def _sweep(self, runs, criterion, label):
        if criterion == "outcome":
            return [row(0.0, failure=self.failure)]
        self.asked |= {value for (*_, value), scene in runs if scene is not RIGID}
        return [row(self.errors[value][scene is not RIGID], cpu=1 / value) for (*_, value), scene in runs]


GOOD, BAD, LUCKY = (1e-5, 1e-5), (1e-2, 1e-2), (1e-5, 1e-2)  # lucky: it passes the scene, not its neighbours
FALLS = {"reason": "it fell"}


@pytest.mark.parametrize(
    "errors, whole, chosen, run_there",
    [
        ((GOOD, GOOD, GOOD), None, 0, {0, 1, 2}),
        ((BAD, GOOD, GOOD), None, 1, {1, 2}),
        ((GOOD, BAD, GOOD), None, 2, {2}),  # the coarsest passed by luck
        ((BAD, BAD, GOOD), None, 2, {2}),
        ((GOOD, GOOD, BAD), None, None, set()),
        ((LUCKY, GOOD, GOOD), None, 1, {0, 1, 2}),
        ((GOOD, LUCKY, GOOD), None, 2, {0, 1, 2}),
        ((GOOD, GOOD, GOOD), FALLS, None, {0, 1, 2}),
    ],
)
def test_the_cheapest_is_chosen_whose_finer_ones_pass_everywhere(errors, whole, chosen, run_there):
    made = Made(errors, whole)
    level, spent = made.cheapest(list(made.rows))
    assert (level, spent) == ((None, None) if chosen is None else ((ENGINE, VARIANT, made.levels[chosen]), 1.0))
    assert made.asked == {made.levels[place] for place in run_there}  # neighbours are run of hopeful levels only


@pytest.mark.slow
def test_a_choice_from_python_runs_what_it_names():
    pulse = RIGID.with_(
        name="pulse",
        start={"tilt": 0.0},
        motion=PulseMotion("one-sine", 3.5, 8.0),
        duration=2.0,
        block={"slenderness": 0.2},
    )
    choice = choose(pulse, criterion="outcome", error=0.3, engines=[ENGINE], source="pulse.toml")
    assert choice.chosen is not None and choice.chosen.error <= 0.3 and choice.chosen.passes
    assert choice.command.startswith(f"rocking run pulse.toml --engine {ENGINE} --variant {choice.chosen.variant}")
    assert f'get_engine("{ENGINE}")' in choice.snippet
    assert {part.part: part.needed for part in choice.parts}["base"] is False
    assert choice.model_dump(by_alias=True)["schema"] == "rocking choose 4"


@pytest.mark.parametrize(
    "arguments, words",
    [
        (("free-rocking-rigid", "--for", "speed"), "choose one of restitution"),
        (("free-rocking-rigid", "--error", "2"), "below 1"),
        (("free-rocking-rigid", "--for", "displacement"), "has no base"),
        (("free-rocking-rigid", "--engine", "none"), "unknown engine"),
        (("caryatid-isolated", "--for", "restitution"), "never hits"),
        (("caryatid-isolated", "--for", "tilt"), "never lifts"),
    ],
)
def test_what_cannot_be_chosen_is_one_message(rocking, arguments, words):
    status, _, err = rocking("choose", *arguments)
    assert status == 2 and words in err


def test_slip_is_compared_over_its_peak_and_its_restitution_is_not_that_of_eq_7():
    model = simulate(SAVED)
    off = replace(model.history, slip=model.history.slip + 0.01 * model.sliding.peak)
    assert criteria.error("slip", SAVED, replace(model, history=off), model) == pytest.approx(0.01, rel=1e-6)
    unread = replace(model, history=replace(model.history, slip=None))
    assert criteria.error("slip", SAVED, unread, model) is None
    assert criteria.error("slip", SAVED, replace(model, history=off), unread) == 0.0
    with pytest.raises(SettingError, match="--for restitution: .* slides, .*; choose one of tilt, slip, outcome"):
        criteria.until(SAVED, "restitution")
    with pytest.raises(SettingError, match="--for slip: .* does not slide"):
        criteria.until(RIGID, "slip")
    with pytest.raises(SettingError, match="--for tilt: .* never lifts"):
        criteria.until(SLIDES, "tilt")
    assert 0 < criteria.until(SLIDES, "slip") <= SLIDES.duration


def test_whether_friction_is_needed_is_said_where_it_is_given():
    parts = {}
    for name, scene in {"slides": SLIDES, "holds": RIGID.with_(friction=0.9), "none": RIGID}.items():
        result = criteria.model_parts(scene, {1.0: scene}, 1e-3, None, [], 1e-3)
        parts[name] = {piece.part: piece for piece in result}
    assert parts["slides"]["sliding"].needed and "does not lift" in parts["slides"]["rocking"].why
    assert not parts["holds"]["sliding"].needed and "the friction 0.9" in parts["holds"]["sliding"].why
    assert "sliding" not in parts["none"]


@pytest.mark.parametrize("kind", KINDS)
def test_each_criterion_applies_or_is_refused_with_others_that_do(tmp_path, kind):
    (tmp_path / "scene.toml").write_text(KINDS[kind][0])
    write_records(tmp_path / "records")
    scene, refused = load_scene(tmp_path / "scene.toml"), {}
    for criterion in criteria.CRITERIA:
        try:
            assert criteria.until(scene, criterion) > 0
        except SettingError as error:
            refused[criterion] = str(error).split("; choose one of ")[1].split(", ")
    applies = [each for each in criteria.CRITERIA if each not in refused]
    assert criteria.fitting(scene) in applies and all(others == applies for others in refused.values())
