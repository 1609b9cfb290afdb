"""The study of random scenes: what is drawn and run, and that tables, sentences and marks count the rows."""

import dataclasses
from collections import Counter

import pytest
from page_numbers import number_in

from analytic import Block, PulseMotion, Scene
from analytic.response import COMPARED, EDGE
from comparisons.running.by_solver import read
from comparisons.running.plan import Request
from comparisons.running.provenance import RESULTS
from comparisons.running.sweep import Row
from comparisons.showing.parts import NAME
from comparisons.showing.wording import ENDS, TURNED
from comparisons.studies import get_study
from comparisons.studies.random_scenes.study import plan, random_scene
from engines import ENGINES
from engines.statue_range import RANGE

ENGINE = next(iter(ENGINES))


@pytest.fixture(scope="module")
def result():
    return read(RESULTS / "random-scenes")


def test_scenes_are_repeatable_and_within_the_range():
    assert random_scene(3, 7).digest() == random_scene(3, 7).digest() != random_scene(4, 7).digest()
    scenes = [random_scene(1, index) for index in range(100)]
    drawn = {
        "slenderness": [scene.block.slenderness for scene in scenes],
        "radius": [scene.block.radius for scene in scenes],
        "inertia": [scene.block.inertia / (scene.block.mass * scene.block.radius**2) for scene in scenes],
        "base_mass": [scene.base.mass / scene.block.mass for scene in scenes if scene.base],
    }
    for name, values in drawn.items():
        assert RANGE[name][0] * (1 - 1e-12) <= min(values) < max(values) <= RANGE[name][1] * (1 + 1e-12), name


@pytest.mark.parametrize("quick, scenes, most", [(True, None, 20), (True, 40, 40), (False, 3, 3)])
def test_the_number_of_scenes_is_what_the_user_asks_for(quick, scenes, most):
    cases, engine = next(plan(Request((ENGINE,), quick), seed=5, scenes=scenes)).cases, ENGINES[ENGINE]
    assert all(case.scene.digest() == random_scene(5, case.tag["index"]).digest() for case in cases)
    for variant in engine.variants:
        limit = most if variant == engine.default_variant else min(most, max(5, most // 5))
        assert 0 < [case.variant for case in cases].count(variant) <= limit


@pytest.mark.parametrize("amplitude, word", [(2.0, "failed"), (6.0, "left out")])  # [g]; at 6 g the model's N < 0
def test_a_run_that_failed_is_left_out_where_no_run_is_compared(amplitude, word):
    block = Block(mass=1000.0, radius=1.0, slenderness=0.2)
    scene = Scene(block=block, motion=PulseMotion("one-sine", amplitude * 9.81, 20.0))
    asked = plan(Request((ENGINE,), True), seed=5, scenes=1)
    case = dataclasses.replace(next(asked).cases[0], scene=scene)
    with pytest.raises(StopIteration) as stop:
        asked.send([Row(case, {}, {"kind": "solver", "reason": "made up", "message": ""}, {}, False)])
    (row,) = stop.value.value.rows
    assert row["class"] == word and (row["comparable"] == COMPARED) == (word == "failed")


def test_tables_and_marks_count_the_stored_rows(result):
    study, classes = get_study("random-scenes"), {}
    for row in result.rows:
        classes.setdefault(NAME.of(row), Counter())[row["class"]] += 1
    table, marks = study.page(result).opening().tables[0], study.judgements(result)[0].marks
    assert study.page(result).whole().tables[0] == table and [row[0] for row in table.rows] == list(classes)
    for row in table.rows:
        name, share, edge = row[0], *row[-2:]
        counts = {head: int(cell) for head, cell in zip(table.columns[2:-2], row[2:-2], strict=True)}
        mine = [row for row in result.rows if NAME.of(row) == name and row["comparable"] == EDGE]
        beyond = sum(bool(row.get("failure") or row.get("differences")) for row in mine)
        assert edge == f"{beyond} of {len(mine)}" and all(row["class"] == "left out" for row in mine)
        right, differs, failed, left_out = [classes[name][word] for word in ("right", "differs", "failed", "left out")]
        assert sum(counts.values()) == right + differs + failed + left_out
        assert (counts.pop("right [-]"), counts.pop("failed [-]")) == (right, failed)
        assert sum(count for head, count in counts.items() if head.startswith("left out")) == left_out
        assert counts[ENDS["edge"]] == len(mine) and counts[ENDS[TURNED]] == turned(result, name)
        assert number_in(share) == pytest.approx(100 * right / (right + differs + failed), rel=0.06)
        mark = marks[tuple(name.split(", "))]
        assert (mark.words, mark.note) == (
            f"{right} of {right + differs + failed}",
            f"{differs} differ, {failed} failed; left out: {len(mine)} near an outcome boundary"
            + f", {left_out - len(mine)} otherwise" * (left_out > len(mine)),
        )


def turned(result, name):
    """Runs of a variant with a sentence on the outcome in which one of engine and model overturns."""
    rows = [row for row in result.rows if NAME.of(row) == name and row["class"] == "differs"]
    told = [words.split(", in the analytic model it ") for row in rows for words in row["differences"]]
    return sum(len(two) == 2 and (two[0] == "the block overturns") != (two[1] == "overturns") for two in told)


def test_every_run_that_failed_is_evidence_and_every_tuned_one_that_differs_is_named(result):
    section = get_study("random-scenes").page(result).whole()
    assert len(section.evidence) == sum(row["class"] == "failed" for row in result.rows)
    differ = [row for row in result.rows if row["class"] == "differs" and row["tier"] != "defaults"]
    named = [(row[0], int(row[1])) for table in section.tables[1:2] for row in table.rows]
    assert named == [(NAME.of(row), row["index"]) for row in differ]
