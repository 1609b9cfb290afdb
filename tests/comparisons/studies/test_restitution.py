"""The restitution study: its measures on responses whose error is known, and a small run from end to end."""

import math

import numpy as np
import pytest
from answered import answered, by_model
from page_numbers import number_in

from analytic import simulate
from analytic.rocking import restitution
from comparisons.execution.by_solver import read
from comparisons.execution.plan import Request
from comparisons.execution.results import Result
from comparisons.execution.runner import compute
from comparisons.execution.sweep import Row
from comparisons.plotting.parts import where
from comparisons.studies import get_study
from comparisons.studies.restitution.page import contact
from comparisons.studies.restitution.study import (
    CARYATID_BASE,
    FULL,
    GROUNDS,
    IMPACT_SECONDS,
    IMPACTS,
    LAWS,
    STEPS,
    Grid,
    bearing_cases,
    damped_error,
    free_scene,
    friction_needed,
    grid_cases,
    impact_scene,
    plan,
)
from engines import get_engine

STUDY = get_study("restitution")

pytestmark = pytest.mark.xdist_group("restitution study")  # the small study is run once


@pytest.mark.parametrize("start", [0.3, 0.8])
def test_scenes_end_past_the_third_swing(start):
    scene = free_scene(0.2, CARYATID_BASE, start)
    response = simulate(scene)
    assert len(response.impacts) == 3 and response.end.tilt_rate * response.end.tilt < 0  # past its peak


@pytest.mark.parametrize(("variant", "fixed"), [("fixed-step", True), ("impact-aware", False)])
def test_a_variant_with_a_fixed_step_is_run_at_the_steps_that_people_use_beside_its_levels(variant, fixed):
    kind = get_engine("pybullet").variants[variant]
    grid = Grid((0.2,), (None,), (0.3,), ((0.2, None),), 1, ())
    levels = [case.tag["level"] for case in grid_cases(grid, ["pybullet"]) if case.variant == variant]
    assert sorted(levels) == sorted({*kind.levels, *(STEPS.values() if fixed else ())})


def test_damping_in_flight_lowers_restitution_by_what_it_takes():
    scene = free_scene(0.2, None, 0.6)
    assert np.abs(damped_error(scene, 0.0)).max() < 1e-9
    weak, double = (damped_error(scene, damping) for damping in (1e-4, 2e-4))
    assert (weak < 0).all()
    np.testing.assert_allclose(double / weak, 2.0, rtol=1e-3)


@pytest.mark.parametrize("ratio, moved", [(None, 1.0), (1.0, 0.5)])
def test_friction_of_an_impact_is_the_ratio_of_its_impulses(ratio, moved):
    """On a base as heavy as the block the centre of mass moves half as far as the block on it."""
    scene = free_scene(0.3, ratio, 0.5)
    e = restitution(scene)
    assert friction_needed(scene) == pytest.approx(moved * (1 - e) / (math.tan(0.3) * (1 + e)))


def test_cases_are_tagged_and_run_default_settings_unless_on_the_ladder():
    pytest.importorskip("pybullet")
    steps = {0.2: set(), 0.3: set()}
    for case in grid_cases(Grid((0.2, 0.3), (None,), (0.5,), ((0.2, None),), 4, ()), ("pybullet",)):
        if case.variant == "impact-aware":
            steps[case.tag["slenderness"]].add(case.settings.get("largest_step"))
    assert steps == {0.2: {None, 7e-3, 3e-3, 5e-4}, 0.3: {None}}


def test_blocks_on_bearings_rock_and_meet_every_law_with_every_value():
    cases = [case for case in bearing_cases(FULL, ("exudyn",)) if case.variant == get_engine("exudyn").default_variant]
    for factor in ("slenderness", "ratio", "period"):
        pairs = {(case.tag[factor], case.tag["law"]) for case in cases}
        assert len(pairs) == 3 * len(LAWS)
    periods = {case.tag["period"] for case in cases}
    assert min(periods) == 1.0 and max(periods) == 4.0
    for case in cases:
        response, bearings = simulate(case.scene, history=False), case.scene.bearings
        carried = case.scene.block.mass + case.scene.base.mass
        stiffness = bearings.count * (bearings.ka if bearings.law == "linear" else bearings.kb)
        assert 2 * np.pi * np.sqrt(carried / stiffness) == pytest.approx(case.tag["period"])
        assert response.outcome == "rocks" and 1 < len(response.impacts) <= IMPACTS and response.min_normal_ratio > 0


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    pytest.importorskip("pybullet")
    grid = Grid((0.2,), (None, CARYATID_BASE), (0.5, 0.7), ((0.2, None),), 8, ((0.25,), (0.1, 1.0), (2.0,)))
    (path,) = compute(
        STUDY, tmp_path_factory.mktemp("study"), engines=("pybullet",), workers=2, progress=False, grid=grid
    )
    return path


@pytest.mark.slow
def test_a_small_study_finds_what_is_known(small):
    result = read(small)

    def one(part, **wanted):
        (row,) = where(result.rows, part=part, **wanted)
        return row

    aware = one("summary", scope="all", variant="impact-aware", ground="rigid ground")
    assert aware["rms"] < 1e-4 and aware["impacts"] == 6 and aware["failed"] == aware["lost"] == 0
    assert 0.8 < one("order", variant="fixed-step", ground="rigid ground")["order"] < 1.2
    assert one("phase", engine="pybullet", step=1e-3)["explained"] > 0.95
    borne = one("bearings", variant="impact-aware", factor="all")
    assert borne["rms_state"] < 1e-4 and borne["jump_rms"] < 1e-3 and borne["runs"] == 4 and borne["lost"] == 0
    assert one("bearings", variant="impact-aware", factor="excitation", of="pulse")["runs"] == 2
    damped = one("flight damping", level=1e-3)
    assert damped["measured"] == pytest.approx(damped["predicted"], rel=0.15)
    for judgement in STUDY.judgements(result):  # no worst error is less than the root mean square beside it
        worst = [number_in(mark.note.partition("worst ")[2].partition(";")[0]) for mark in judgement.marks.values()]
        rms = [mark.value for mark in judgement.marks.values()]
        assert len(rms) >= 2 and all(most > 0.97 * mean for most, mean in zip(worst, rms, strict=True))
    large = one("experiment", experiment="size", value=4.0)
    assert large["jump_8"] < 1e-3 and large["jump_8_printed"] > 0.5
    assert all(row["cpu_per_second"] > 0 for row in result.rows if row["part"] == "cell")


@pytest.mark.parametrize("ground", GROUNDS)
def test_the_scene_of_one_impact_holds_it_and_the_swing_after_it(ground):
    run = simulate(impact_scene(ground))
    assert run.impacts[0].time < IMPACT_SECONDS - 0.2 and run.end.time == pytest.approx(IMPACT_SECONDS)


def test_rows_of_one_impact_carry_the_diagnosis_or_the_failure():
    def run(batch):
        if batch.label != "one impact":
            return by_model()(batch)
        crash, cost = {"reason": "a crash"}, {"cpu_seconds": 0.1}
        return [
            Row(case, {} if k else {"error": 1.23456e-7}, crash if k else None, cost, False)
            for k, case in enumerate(batch.cases)
        ]

    grid = Grid((0.2,), (None,), (0.6,), (), 4, ((0.25,), (1.0,), (2.0,)))
    first, *others = where(answered(plan(Request(("pymunk",)), grid), run)[-1].rows, part="why")
    assert (first["error"], first["failure"]) == (1.23456e-7, None) and all(row["failure"] for row in others)
    assert {row["ground"] for row in (first, *others)} == {*GROUNDS}


def test_what_cannot_be_told_of_one_impact_is_evidence():
    silent = {"part": "why", "engine": "pybullet", "variant": "v", "ground": "rigid ground", "failure": None}
    rows = [silent | {"why_not": "no corner is struck"}, silent | {"failure": {"reason": "a crash"}}]
    settings = {"why": {"slenderness": 0.2, "start": 0.6, "least": 1e-3, "causes": {}}}
    page = contact(Result("restitution", settings, rows, {}))
    assert page.evidence == tuple(("pybullet, v, rigid ground", why) for why in ("no corner is struck", "a crash"))
