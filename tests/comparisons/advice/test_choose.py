"""What makes a setting pass, and what does not; the answers of runs are made up, but for one."""

import dataclasses
import doctest
import importlib
import math

import pytest

from analytic import PulseMotion, SampledMotion, Start, load_scene, simulate
from analytic.errors import SettingError
from analytic.response import Impact
from comparisons.advice import choose, criteria
from comparisons.advice.search import Search, problem
from comparisons.running.cases import Case
from comparisons.running.sweep import Row
from comparisons.sheet.problems import PROBLEMS
from engines import get_engine

RIGID = load_scene("free-rocking-rigid")
STANDING = next(one.scene for one in PROBLEMS if one.name == "isolated-standing")
ENGINE, VARIANT = "exudyn", "switched-joints"


def row(error, outside=None, cpu=1.0, failure=None):
    values = {"outcome": "rocks", "error": error, "outside": outside, "simulated": 1.0}
    return Row(Case(RIGID, ENGINE, VARIANT), values, failure, {"cpu_seconds": cpu}, False)


def test_neighbours_have_start_and_motion_scaled():
    motion = SampledMotion(0.1, [0.0, 1.0, 0.0])
    family = criteria.neighbours(RIGID.with_(motion=motion), "tilt")
    assert list(family) == [1.0, *criteria.FACTORS]
    for factor, scene in family.items():
        assert scene.start.tilt == pytest.approx(factor * RIGID.start.tilt)
        assert scene.motion.peak == pytest.approx(factor)
    assert len(criteria.neighbours(RIGID, "outcome")) == 9
    with pytest.raises(SettingError, match="nothing moves"):
        criteria.neighbours(RIGID.with_(start={"tilt": 0.0}), "tilt")


def test_outcomes_are_those_of_runs_that_no_duration_cuts():
    falling = RIGID.with_(start=Start(), motion=PulseMotion("one-sine", 6.0, 5.0), duration=1.0)
    assert simulate(falling).end.time == 1.0
    whole = criteria.neighbours(falling, "outcome")[1.0]
    assert simulate(whole).outcome == "overturns" and criteria.until(whole, "outcome") == simulate(whole).end.time > 1.0
    assert criteria.neighbours(falling, "tilt")[1.0].duration == 1.0


def test_restitution_is_looked_at_up_to_the_eighth_strong_impact():
    end = criteria.until(RIGID, "restitution")
    impacts = [impact for impact in simulate(RIGID).impacts if impact.time < end]
    assert len(impacts) >= criteria.IMPACTS
    with pytest.raises(SettingError, match="never hits"):
        criteria.until(STANDING, "restitution")
    with pytest.raises(SettingError, match="has no base"):
        criteria.until(RIGID, "displacement")


def test_a_block_that_never_hits_is_judged_by_what_it_shows():
    assert criteria.fitting(RIGID) == "restitution"
    assert criteria.fitting(STANDING) == "displacement"
    weak = PulseMotion("one-sine", 0.5, 5.0)
    assert criteria.fitting(RIGID.with_(start=Start(), motion=weak)) == "outcome"


def test_errors_are_those_of_the_criterion():
    scene = RIGID.with_(duration=4.0)
    reference = simulate(scene)
    history = dataclasses.replace(reference.history, tilt=reference.history.tilt + 0.01 * scene.block.slenderness)
    shifted = dataclasses.replace(reference, history=history)
    assert criteria.error("tilt", scene, shifted, reference) == pytest.approx(0.01)
    assert criteria.error("outcome", scene, dataclasses.replace(shifted, outcome="overturns"), reference) == 1.0
    lossy = [Impact(i.time, i.rate_before, 0.99 * i.rate_after, 0.0) for i in reference.impacts]
    e = reference.impacts[0].rate_after / reference.impacts[0].rate_before
    wrong = dataclasses.replace(reference, impacts=tuple(lossy))
    assert criteria.error("restitution", scene, wrong, reference) == pytest.approx(0.01 * e, rel=1e-6)
    assert criteria.error("restitution", scene, dataclasses.replace(reference, impacts=()), reference) is None


def test_a_run_that_loses_an_impact_shows_no_restitution():
    scene = RIGID.with_(duration=4.0)
    reference = simulate(scene)
    for kept in ((0, 2, 3), (1, 2, 3)):
        lost = dataclasses.replace(reference, impacts=tuple(reference.impacts[k] for k in kept))
        assert criteria.error("restitution", scene, lost, reference) is None


@pytest.mark.parametrize(
    "rows, why",
    [
        ({1.0: row(4e-4), 0.95: row(4.9e-4)}, None),
        ({1.0: row(4e-4), 0.95: row(6e-4)}, "less than 2 times below"),
        ({1.0: row(4e-4), 0.95: row(2e-3)}, "error 2.0e-03"),
        ({1.0: row(1e-6), 0.95: row(None)}, "shows no tilt at 0.95"),
        ({1.0: row(math.nan)}, "shows no tilt"),
        ({1.0: row(1e-6, failure={"reason": "it fell"})}, "it fell"),
    ],
)
def test_what_keeps_a_setting_from_passing(rows, why):
    found = problem(rows, 1e-3, "tilt")[1]
    assert found is None if why is None else why in found


def test_of_outcomes_the_share_counts():
    alike = {float(k): row(0.0) for k in range(7)} | {8.0: row(1.0)}
    assert problem(alike, 0.13, "outcome") == (0.125, None)
    assert problem(alike, 0.12, "outcome")[1] is not None


class Made:
    """In place of runs: errors by level (of the scene, of the neighbours), costs falling along the ladder."""

    def __init__(self, errors):
        self.family = criteria.neighbours(RIGID, "tilt")
        self.ladder = get_engine(ENGINE).variants[VARIANT].ladder
        self.errors = dict(zip(self.ladder, errors, strict=True))
        self.rows = {
            (ENGINE, VARIANT, value): {1.0: row(self.errors[value][0], cpu=1 / value)} for value in self.ladder
        }
        self.asked = []

    def __call__(self, levels, factors, label):
        self.asked += [level[2] for level in levels]
        for level in levels:
            self.rows[level] |= {factor: row(self.errors[level[2]][1]) for factor in factors}

    def chosen(self, whole=0.1):
        level = Search(self, 1e-3, "tilt", lambda level: whole).cheapest(list(self.rows))[0]
        return level and self.ladder.index(level[2])


GOOD, BAD = (1e-5, 1e-5), (1e-2, 1e-2)


def test_the_cheapest_is_chosen_whose_finer_ones_pass_everywhere():
    assert Made([GOOD, GOOD, GOOD]).chosen() == 0
    assert Made([BAD, GOOD, GOOD]).chosen() == 1
    assert Made([GOOD, BAD, GOOD]).chosen() == 2  # the coarsest passed by luck
    assert Made([GOOD, GOOD, BAD]).chosen() is None
    assert Made([(1e-5, 1e-2), GOOD, GOOD]).chosen() == 1  # passes the scene, not its neighbours
    assert Made([GOOD, (1e-5, 1e-2), GOOD]).chosen() == 2


def test_neighbours_are_run_of_hopeful_settings_only():
    made = Made([BAD, BAD, GOOD])
    assert made.chosen() == 2 and set(made.asked) == {made.ladder[2]}


def test_one_that_fails_on_the_whole_scene_is_not_chosen():
    assert Made([GOOD, GOOD, GOOD]).chosen(whole=None) is None


@pytest.mark.slow
def test_the_docstrings_example_is_right():
    assert doctest.testmod(importlib.import_module("comparisons.advice.choose")) == (0, 3)


@pytest.mark.slow
def test_a_choice_from_python_runs_what_it_names():
    pulse = RIGID.with_(
        name="pulse",
        start={"tilt": 0.0},
        motion=PulseMotion("one-sine", 3.5, 8.0),
        duration=2.0,
        block={"slenderness": 0.2},
    )
    found = choose(pulse, criterion="outcome", error=0.3, engines=[ENGINE], source="pulse.toml")
    assert found.chosen is not None and found.chosen.error <= 0.3 and found.chosen.passes
    assert found.command.startswith(f"rocking run pulse.toml --engine {ENGINE} --variant {found.chosen.variant}")
    assert f'get_engine("{ENGINE}")' in found.snippet
    assert {part.part: part.needed for part in found.parts}["base"] is False
    assert found.model_dump(by_alias=True)["schema"] == "rocking choose 3"


@pytest.mark.parametrize(
    "arguments, words",
    [
        (("--for", "speed"), "choose one of restitution"),
        (("--error", "2"), "below 1"),
        (("--for", "displacement"), "has no base"),
        (("--engine", "none"), "unknown engine"),
    ],
)
def test_what_cannot_be_chosen_is_one_message(rocking, arguments, words):
    status, _, err = rocking("choose", "free-rocking-rigid", *arguments)
    assert status == 2 and words in err
