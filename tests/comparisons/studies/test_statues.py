"""The study of drawn statues: what is run, which fate a scene has, and that tables, titles and marks count the rows."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from answered import answered, by_model, stored
from sliding_scenes import LOST, SAVED, SLIDES, scene_of

from analytic import Block, PulseMotion, Scene, SceneError, Start, simulate, synthetic_motion
from analytic.response import COMPARED, EDGE
from comparisons.ensembles import SHAPES, random_slider
from comparisons.execution.cases import Case
from comparisons.execution.plan import Request
from comparisons.execution.sweep import Row
from comparisons.metrics.boundaries import pulse
from comparisons.plotting.parts import where
from comparisons.studies import get_study
from comparisons.studies.statues import study
from comparisons.studies.statues.advice import advised_levels, alarms, level_tables, missed_at_levels
from comparisons.studies.statues.levels import advised, holds, level_settings, misses, tally
from comparisons.studies.statues.study import fates
from engines import ENGINES, get_engine
from engines.simulating import outside

pytestmark = pytest.mark.xdist_group("statues")  # its runs are made once

NAMES = list(ENGINES)[:2]  # the subjects
RECORDS = (synthetic_motion(seed=1).scaled(0.5), synthetic_motion(seed=2))
STUDY = get_study("statues")
STANDS = scene_of(5.0, 0.2, motion=SAVED.motion.scaled(0.2))
FALLEN = {"kind": "solver", "reason": "fell over", "message": "step 3"}


@pytest.fixture(scope="module", autouse=True)
def records():
    """Two made-up motions in place of the recorded ones, which need not be installed."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(study, "folder_motions", lambda folder: ({"a": RECORDS[:1], "b": RECORDS[1:]}, []))
        yield


def computed(tmp_path, run=None, engines=NAMES, boundaries=0, scenes=12, sliders=80):
    plan = STUDY.plan(Request(tuple(engines), True), boundaries, seed=3, scenes=scenes, sliders=sliders)
    return stored(tmp_path, "statues", answered(plan, run or by_model())[-1])


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    return computed(tmp_path_factory.mktemp("statues"))


def test_without_the_package_of_records_none_is_drawn_and_an_own_folder_must_be_there(monkeypatch):
    def missing(folder):
        raise SceneError("motion.record", folder, "not installed", "install it")

    monkeypatch.setattr(study, "folder_motions", missing)
    assert study._recorded(None) == ([], "")
    with pytest.raises(SceneError, match="not installed"):
        study._recorded("mine")


@pytest.mark.parametrize("amplitude, word", [(2.0, "failed"), (6.0, "left out")])  # [g]; at 6 g the model's N < 0
def test_a_run_that_failed_is_left_out_where_no_run_is_compared(amplitude, word):
    block = Block(mass=1000.0, radius=1.0, slenderness=0.2)
    scene = Scene(block=block, motion=PulseMotion("one-sine", amplitude * 9.81, 20.0))
    case = Case(scene, NAMES[0], get_engine(NAMES[0]).default_variant, tag={"index": 0})
    row = study._run_row(Row(case, {}, FALLEN, {}, False), {})
    assert row["class"] == word and (row["comparable"] == COMPARED) == (word == "failed")


def test_fates_are_those_of_the_known_cases():
    """19 of the reference cases is saved by sliding, 21 overturned by it; one slides only, one needs less."""
    scenes = [scene.with_(duration=None) for scene in (SAVED, LOST, SLIDES, STANDS)]
    found = fates(scenes)
    counted = [{name for name, values in found.items() if values[k]} for k in range(len(scenes))]
    shared = {"runs", "moves", "lacking", "chosen"}
    assert counted[0] == shared | {"falls_without", "saved"}
    assert counted[1] == shared | {"overturned"}
    assert counted[2] == shared | {"slides"}
    assert counted[3] == {"runs"} and simulate(scenes[3], history=False).outcome == "stands"


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


def test_cells_hold_every_scene_once_and_engines_run_those_that_slide_beside_those_without_a_friction(result):
    scenes, free = where(result.rows, part="scene"), 12 - result.settings["below_range"]
    assert sum(cell["runs"] for cell in where(result.rows, part="cell")) == 80 and len(scenes) == 10
    drawn = [random_slider(RECORDS, 3, index)[0] for index in range(80)]
    assert [row["index"] for row in scenes] == np.flatnonzero(fates(drawn)["chosen"]).tolist()[:10]
    for row in scenes:
        scene = drawn[row["index"]]
        assert row["outcome"] == simulate(scene, history=False).outcome and row["friction"] == scene.friction
    for engine in map(get_engine, NAMES):
        for variant in engine.variants:
            mine = where(result.rows, part="run", engine=engine.name, variant=variant)
            step = 1 if engine.subject and variant == engine.default_variant else 5
            counts = [sum((row["friction"] is None) == none for row in mine) for none in (True, False)]
            assert counts == [math.ceil(free / step), math.ceil(10 / step)]
            assert {row["class"] for row in mine} <= {"right", "left out"}


def test_the_same_seed_gives_the_same_rows_and_known_faults_are_kept(tmp_path, monkeypatch):
    engine = get_engine(NAMES[0])
    monkeypatch.setitem(vars(engine.variants[engine.default_variant]), "faults", "it slides up hill")
    one, other = (computed(tmp_path, engines=NAMES[:1], scenes=4, sliders=20) for _ in range(2))
    assert one.rows == other.rows and len(where(one.rows, part="run")) > 4
    known = {"engine": engine.name, "variant": engine.default_variant, "words": "it slides up hill"}
    assert known in one.settings["faults"]


@pytest.mark.slow
def test_drawn_statues_lie_in_the_promised_range_and_have_one_boundary_to_find():
    found = study.drawn_edges(5)
    assert [edge.shape for _, edge in found] == list(SHAPES) and len({edge.ground for _, edge in found}) == 5
    for scene, edge in found:
        assert scene.motion is None and not any(scene.start.model_dump().values())
        assert not outside(scene, simulate(scene.with_(duration=1.0), history=False))
        assert edge.rises and edge.min_normal >= 0 and study.FREQUENCY[0] <= edge.frequency <= study.FREQUENCY[1]
        assert edge.low < 0.98 * edge.amplitude and edge.high > 1.02 * edge.amplitude
        outcomes = [
            simulate(scene.with_(motion=pulse(scene, edge.shape, edge.frequency, edge.amplitude * side))).outcome
            for side in (0.995, 0.9999, 1.0001, 1.005)
        ]
        assert [outcome == "overturns" for outcome in outcomes] == [False, False, True, True]
    again = study.drawn_edges(2)
    assert [edge for _, edge in again] == [edge for _, edge in found[:2]]  # as many as one asks, the same first


@pytest.mark.slow
def test_boundaries_of_drawn_statues_are_rated(tmp_path):
    """In place of the engines the model, shifted by .3 % under the pulses that a boundary is sought with."""
    statues = {scene.block for scene, _ in study.drawn_edges(2)}

    def moved(case):
        sought = case.scene.block in statues and not case.tag
        return case.scene.with_(motion=case.scene.motion.scaled(1 / 1.003)) if sought else case.scene

    result = computed(tmp_path, by_model(moved), boundaries=2)
    shifts = where(result.rows, part="drawn shift")
    assert len(where(result.rows, part="drawn edge")) == 2 and len(shifts) == 2 * 4  # tuned and as they come
    assert all(row["shift"] == pytest.approx(3e-3, abs=1.01 * row["half_width"]) for row in shifts)
    judged, page = STUDY.judgements(result)[0], STUDY.page(result)
    assert {mark.words for mark in judged.marks.values()} == {"0.30 % (2 of 2 random statues)"}
    assert "at most 0.30 %" in page.title


def run_at(level, index, error, draw=1, model="rocks", outcome=None, comparable=COMPARED, **more):
    """A row of a statue at a level."""
    return {
        "part": "level",
        "engine": "exudyn",
        "variant": "compliant-corners",
        "level": level,
        "draw": draw,
        "index": index,
        "model_outcome": model,
        "outcome": outcome or model,
        "comparable": comparable,
        "peak_error": error,
        "displacement_error": None,
        "warned": False,
        "cpu_per_second": 0.01 * level,
    } | more


def test_draws_at_levels_are_of_both_motions_with_and_without_friction_and_the_model_answers_them(result):
    rows = where(result.rows, part="level")
    assert len(rows) == 2 * 4 * len(level_settings(NAMES))
    assert {row["motion"] for row in rows} == {"pulse", "recorded"} and {row["draw"] for row in rows} == {1, 2}
    assert {row["friction"] is None for row in rows} == {True, False}
    for row in rows:
        assert row["outcome"] == row["model_outcome"] in ("rocks", "overturns") and row["tilt"] >= 0.01
        assert (row["peak_error"] is None) == (row["outcome"] == "overturns") and not row["peak_error"]
        assert row["cpu_per_second"] > 0 and row["warned"] is False and not misses(row, 1e-4)


def test_a_statue_is_missed_by_either_peak_another_outcome_or_a_failure():
    assert not misses(run_at(1, 0, 1e-3), 1e-3) and misses(run_at(1, 0, 1.1e-3), 1e-3)
    assert misses(run_at(1, 0, 0.0, displacement_error=2e-3), 1e-3)
    assert misses(run_at(1, 0, None, outcome="overturns"), 1.0) and misses(run_at(1, 0, None, outcome="failed"), 1.0)
    near = run_at(1, 1, None, outcome="overturns", comparable=EDGE)
    fell = run_at(1, 2, None, model="overturns", outcome="rocks")
    rows = [run_at(1, 0, 0.0), near, fell, run_at(1, 3, 0.5)]
    known = {"statues": 4, "upright": 3, "missed": 2, "missed_near": 1, "changed": 2, "away": 1}
    assert tally(rows, 1e-2) == known
    assert (
        not holds(tally([], 1e-2), 1.0)
        and not holds(known, 1.0)
        and holds(known | {"away": 0}, 2 / 3)
        and not holds(known | {"away": 0}, 0.6)
    )


@pytest.mark.parametrize(
    "errors, chosen",
    [
        ({1: 0.1, 2: 1e-3, 3: 1e-4}, (2, True)),
        ({1: 1e-3, 2: 0.1, 3: 1e-4}, (3, True)),  # a finer level contradicts the coarsest
        ({1: 1e-3, 2: 1e-3, 3: 0.1}, (3, False)),
    ],
)
def test_the_coarsest_level_is_advised_that_holds_as_all_finer_ones_do(errors, chosen):
    """One miss in 50 is 2 %, two are more."""
    for spoiled in (1, 2):
        rows = [
            run_at(level, index, error if index < spoiled else 0.0)
            for level, error in errors.items()
            for index in range(50)
        ]
        assert advised(rows, (1, 2, 3), 1e-2) == (chosen if spoiled == 2 else (1, True))


def test_the_second_draw_says_whether_an_advised_level_passes():
    variant = {"engine": "exudyn", "variant": "compliant-corners", "parameter": "stiffness", "tier": "tuned"}
    settings = {"variants": [variant | {"default": 1e10, "applies_impact": False}]}
    rows = [
        run_at(level, index, 0.02 if level == 1e9 and draw == 2 and index < 3 else 0.002, draw)
        for level in (1e9, 1e10)
        for draw in (1, 2)
        for index in range(40)
    ]
    rows[-1] |= {"warned": True}
    rows[40] |= {"comparable": "on an edge"}  # the first of the three that miss
    made = SimpleNamespace(rows=rows, settings=settings)
    first, second = level_tables(made)
    assert [row[0] for row in first.rows] == ["1 %", "0.1 %", "0.01 %"]
    coarse, unreached, _ = first.rows
    assert coarse[2:6] == ["stiffness = 10⁹ N/m", "no", "3 of 40 (7.5 %; 20 %), 1", "0 of 40 (0)"]
    assert coarse[-1].endswith("--engine exudyn --set stiffness=1e+09")
    assert unreached[3].startswith("no;") and unreached[3].endswith("none held on the first draw")
    assert [row[2] for row in second.rows] == ["3 of 40 (7.5 %)", "0 of 40 (0 %)"]
    (short,) = advised_levels(made)
    assert [row[0] for row in short.rows] == ["1 %: 3 of 40 ✗ (at most 20 %)", "0.1 %: 40 of 40 ✗ (at most 100 %)"]
    assert "rocking run caryatid-isolated --engine exudyn --set stiffness=1e+09" in short.rows[0]
    assert alarms(made).rows[1] == ["2", "80", "1 of 77 (1.3 %)", "3 of 3 (100 %)"]
    assert missed_at_levels(made) == {("exudyn", 1e9): (40, 40), ("exudyn", 1e10): (40, 40)}
    empty = SimpleNamespace(rows=[], settings={})
    assert level_tables(empty) == advised_levels(empty) == () and missed_at_levels(empty) == {}
