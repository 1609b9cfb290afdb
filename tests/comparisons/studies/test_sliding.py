"""The study of sliding: what is drawn, which fate a scene has, and that tables and titles count the rows."""

import math
import re

import numpy as np
import pytest
from answered import answered, by_model, stored
from sliding_scenes import LOST, SAVED, SLIDES, scene_of

from analytic import SceneError, Start, simulate, synthetic_motion
from comparisons.running.by_solver import read
from comparisons.running.cases import Case
from comparisons.running.plan import Request
from comparisons.running.provenance import RESULTS
from comparisons.showing.parts import NAME, number, percent, where
from comparisons.studies import get_study
from comparisons.studies.sliding import study
from comparisons.studies.sliding.page import SHARES, judged, summed, tallies
from comparisons.studies.sliding.study import FRICTION, MOTIONS, PULSE, RECORDED, SUPPORTS, SYNTHETIC, fates
from engines import ENGINES, get_engine
from engines.statue_range import RANGE

NAMES = [name for name, engine in ENGINES.items() if engine.installed][:2]
RECORDS = (synthetic_motion(seed=1).scaled(0.5), synthetic_motion(seed=2))
STUDY = get_study("sliding")
STANDS = scene_of(5.0, 0.2, motion=SAVED.motion.scaled(0.2))
FALLEN = {"kind": "solver", "reason": "fell over", "message": "step 3"}


@pytest.fixture(autouse=True)
def records(monkeypatch):
    """Two made-up motions in place of the recorded ones, which need not be installed."""
    monkeypatch.setattr(study, "folder_motions", lambda folder: ({"a": RECORDS[:1], "b": RECORDS[1:]}, []))


def computed(tmp_path, run=None, scenes=80, engines=NAMES):
    plan = STUDY.plan(Request(tuple(engines), True), seed=3, scenes=scenes)
    return stored(tmp_path, "sliding", answered(plan, run or by_model())[-1])


def test_scenes_are_repeatable_within_the_range_and_of_every_kind():
    drawn = [study.random_slider(RECORDS, 1, index) for index in range(120)]
    again, other = study.random_slider(RECORDS, 1, 7)[0], study.random_slider(RECORDS, 2, 7)[0]
    assert drawn[7][0].digest() == again.digest() != other.digest()
    scenes, kinds = zip(*drawn, strict=True)
    assert set(kinds) == set(MOTIONS) and {study.support_of(scene) for scene in scenes} == set(SUPPORTS)
    assert all((scene.base is None) == (scene.bearings is None) for scene in scenes)
    assert 0 < sum(scene.motion.vertical is not None for scene in scenes) < 60
    for low, high, values in (
        (*FRICTION, [scene.friction for scene in scenes]),
        (*RANGE["slenderness"][:2], [scene.block.slenderness for scene in scenes]),
        (*study.PEAKS, [scene.motion.peak / (9.81 * math.tan(scene.block.slenderness)) for scene in scenes]),
    ):
        assert low <= min(values) < low + 0.2 * (high - low) and high - 0.2 * (high - low) < max(values) <= high


def test_without_records_pulses_stay_as_they_are_and_synthetic_motions_take_their_place(monkeypatch):
    with_them, without = ([study.random_slider(some, 1, k) for k in range(40)] for some in (RECORDS, ()))
    assert {kind for _, kind in without} == {PULSE, SYNTHETIC}
    same = [a.digest() == b.digest() for (a, _), (b, _) in zip(with_them, without, strict=True)]
    assert same == [kind != RECORDED for _, kind in with_them] and not all(same)

    def missing(folder):
        raise SceneError("motion.record", folder, "not installed", "install it")

    monkeypatch.setattr(study, "folder_motions", missing)
    assert study._recorded(None) == ([], "")
    with pytest.raises(SceneError, match="not installed"):
        study._recorded("mine")


def test_fates_are_those_of_the_known_cases():
    """19 of the reference cases is saved by sliding, 21 overturned by it; one slides only, one needs less."""
    scenes = [scene.with_(duration=None) for scene in (SAVED, LOST, SLIDES, STANDS)]
    found = fates(scenes)
    counted = [
        {name for name, what in study.COUNTS.items() if what({key: bool(values[k]) for key, values in found.items()})}
        for k in range(len(scenes))
    ]
    shared = {"runs", "moves", "lacking"}
    assert counted[0] == shared | {"falls_without", "saved"}
    assert counted[1] == shared | {"overturned"}
    assert counted[2] == shared | {"slides"}
    assert counted[3] == {"runs"} and simulate(scenes[3], history=False).outcome == "stands"
    assert found["chosen"].tolist() == [True, True, True, False]


def test_what_a_run_leaves_open_is_undecided_unless_its_block_can_never_lift():
    """A level block with a friction below tan(gamma) cannot, whatever its slip comes to."""
    pushed = SLIDES.with_(motion=SLIDES.motion.scaled(6))
    found = fates([pushed.with_(duration=0.5), pushed.with_(duration=0.2)])  # the motion lasts .52 s
    assert not simulate(pushed.with_(duration=0.5), history=False).decided
    assert found["undecided"].tolist() == [False, True] and found["falls_without"].tolist() == [True, False]
    assert found["slides"].tolist() == [True, False] and not found["chosen"].any()


def test_an_impact_slips_where_the_corner_slides_before_or_after():
    """With mu_c below the friction the impact of a block that did not slide before does not slip."""
    sticks = simulate(scene_of(0.6, start=Start(tilt=0.168), duration=4.0), history=False)
    assert sticks.impact_count == 3 and not any(study.slips_at(sticks, impact.time) for impact in sticks.impacts)
    slides = simulate(LOST, history=False)
    (impact,) = slides.impacts
    assert study.slips_at(slides, impact.time)
    assert "slide-rock" in [mode for when, mode in slides.sliding.modes if when == impact.time]


def test_the_model_in_an_engines_place_is_right_without_error():
    case = Case(LOST.with_(duration=None), NAMES[0], None, {}, {})
    response = simulate(case.scene, history=False)
    values = study.of_engine(case, response)
    assert (values["quantities"], values["slip_error"], values["lost"]) == ([], None, 0)
    assert values["slipping"] == [0.0] and values["sticking"] == []
    upright = study.of_engine(Case(SAVED, NAMES[0]), simulate(SAVED, history=False))
    assert upright["slip_error"] == upright["tilt_error"] == 0.0 and len(upright["sticking"]) == 2


def test_errors_of_the_slip_are_relative_and_a_small_one_counts_as_one_that_just_does():
    case = Case(SLIDES, NAMES[0])
    less = study.of_engine(case, simulate(SLIDES.with_(friction=0.21), history=False))
    here, there = (simulate(SLIDES.with_(friction=mu), history=False).sliding.peak for mu in (0.21, 0.2))
    assert less["slip_error"] == pytest.approx(here / there - 1) and "peak_slip" in less["quantities"]
    radius = SLIDES.block.radius
    for friction, low, high in ((0.407, 1e-4, 5e-3), (0.4077, 1e-8, 1e-4)):  # just below the acceleration over g
        hardly = SLIDES.with_(friction=friction)
        slip = simulate(hardly, history=False).sliding.peak
        stuck = study.of_engine(Case(hardly, NAMES[0]), simulate(hardly.with_(friction=0.42), history=False))
        assert low < slip / radius < high
        assert stuck["slip_error"] == (None if low < 1e-5 else pytest.approx(-slip / (0.005 * radius)))


def test_cells_hold_every_scene_once_and_engines_run_those_that_slide(tmp_path):
    result = computed(tmp_path)
    cells, scenes = where(result.rows, part="cell"), where(result.rows, part="scene")
    assert sum(cell["runs"] for cell in cells) == 80 and len(scenes) == 10
    drawn = [study.random_slider(RECORDS, 3, index)[0] for index in range(80)]
    lacking = np.flatnonzero(fates(drawn)["chosen"]).tolist()
    assert [row["index"] for row in scenes] == lacking[:10]
    for row in scenes:
        scene = drawn[row["index"]]
        assert row["outcome"] == simulate(scene, history=False).outcome and row["friction"] == scene.friction
    for name in NAMES:
        engine = get_engine(name)
        for variant in engine.variants:
            mine = where(result.rows, part="run", engine=name, variant=variant)
            assert len(mine) == (10 if engine.subject and variant == engine.default_variant else 2)
    again = computed(tmp_path)
    assert again.rows == result.rows or _timeless(again.rows) == _timeless(result.rows)


def _timeless(rows):
    return [{key: value for key, value in row.items() if not key.startswith("cpu_")} for row in rows]


def test_shares_and_the_title_count_the_cells(tmp_path):
    result = computed(tmp_path)
    cells, page = where(result.rows, part="cell"), STUDY.page(result)
    (every,) = summed(cells, lambda cell: "all")
    falls = sum(cell["falls_without"] for cell in cells)
    others = sum(cell["runs"] - cell["failed"] - cell["undecided"] - cell["falls_without"] for cell in cells)
    saved, lost = (sum(cell[name] for cell in cells) for name in ("saved", "overturned"))
    assert f"saves {saved} of {falls} " in page.title and f"overturns {lost} of {others} " in page.title
    table = page.whole().tables[0]
    assert [row[0] for row in table.rows] == [*SUPPORTS, "all"] and f"{saved} of {falls}, " in " ".join(table.rows[-1])
    assert every["saved_within"][0] < every["saved_share"] < every["saved_within"][1] and len(SHARES) == 3


def test_failed_runs_are_shown_apart_and_counted_as_wrong(tmp_path):
    second = NAMES[-1]
    run = by_model(failure=lambda case: FALLEN if case.solver == second else None)
    result = computed(tmp_path, run)
    page, known = STUDY.page(result), {NAME.of(row): row for row in tallies(result)}
    for name in NAMES:
        row = known[f"{name}, {get_engine(name).default_variant}"]
        assert row["judged"] > 0 and row["edge"] + row["out"] == len(where(judged_scenes(result), judged=False))
        assert (row["right"], row["alike"], row["failed"]) == (
            (0, 0, row["judged"]) if name == second else (row["judged"], row["judged"], 0)
        )
    failed = [row for row in judged(result) if row["class"] == "failed"]
    whole = page.whole()
    assert len(whole.evidence) == len(failed) > 0 and all("fell over" in head for head, _ in whole.evidence)
    told = next(table for table in whole.tables if table.caption == "Runs that failed, by reason")
    assert {why for _, why, *_ in told.rows} == {"fell over"}
    assert sum(int(count) for *_, count, _ in told.rows) == len(failed)
    assert sum(len(scenes.split(", ")) for *_, scenes in told.rows) == len(failed)
    (judgement,) = STUDY.judgements(result)
    mark = judgement.marks[second, get_engine(second).default_variant]
    assert (mark.words, mark.level) == (f"0 of {row['judged']}", "bad") and "failed" in mark.note


def test_what_is_right_as_a_whole_in_its_outcome_and_at_slipping_impacts_is_told_apart():
    """From stored rows, counted here by hand: three counts that differ, each with what it counts."""
    result = read(RESULTS / "sliding")
    _, counted, errors = STUDY.page(result).opening().text
    for name in (name for name, engine in ENGINES.items() if engine.subject):
        runs = where(result.rows, part="run", engine=name, variant=get_engine(name).default_variant)
        runs = [row for row in runs if row["class"] != "left out"]
        assert f"{sum(row['class'] == 'right' for row in runs)} of {len(runs)} ({name})" in counted
        other = sum("failure" in row or "outcome" in row["quantities"] for row in runs)
        assert re.search(rf"another one or none in .*\b{other} \({name}\).* of these", counted)
        hits = [error for row in runs for error in row["slipping"]]
        assert f"{number(math.sqrt(np.mean(np.square(hits))), 2)} ({name})" in errors
        assert (
            f"{percent(max(abs(row['slip_error']) for row in runs if row['slip_error']))} (worst) in {name}" in errors
        )
    assert "is one for impacts without slip" in errors


def judged_scenes(result):
    return [{"judged": row["comparable"] == "yes"} for row in where(result.rows, part="scene")]


def test_without_engines_the_model_alone_is_shown(tmp_path):
    page = STUDY.page(computed(tmp_path, engines=()))
    assert page.opening().figures and page.whole().tables[0].rows and STUDY.judgements(computed(tmp_path, engines=()))


def test_known_faults_of_variants_that_were_run_are_said(tmp_path, monkeypatch):
    engine = get_engine(NAMES[0])
    spec = engine.variants[engine.default_variant]
    monkeypatch.setitem(vars(spec), "faults", "it slides up hill")
    page = STUDY.page(computed(tmp_path))
    assert f"{NAMES[0]}, {engine.default_variant}: it slides up hill" in page.whole().shown
