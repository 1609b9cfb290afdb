"""The study of random scenes: what is drawn and run, and that tables, sentences and marks count the rows."""

import math
from collections import Counter

import pytest
from page_numbers import number_in

from comparisons.running.provenance import RESULTS, read_result
from comparisons.running.study import Ask
from comparisons.studies import get_study
from comparisons.studies.random_scenes.scenes import random_scene
from comparisons.studies.random_scenes.study import plan
from engines import ENGINES
from engines.statue_range import RANGE

ENGINE = next(iter(ENGINES))


@pytest.fixture(scope="module")
def result():
    return read_result(RESULTS / "random-scenes.json")


def test_scenes_are_repeatable_and_within_the_range():
    assert random_scene(3, 7).digest() == random_scene(3, 7).digest() != random_scene(4, 7).digest()
    for scene in (random_scene(1, index) for index in range(100)):
        block = scene.block
        values = {
            "slenderness": block.slenderness,
            "radius": block.radius,
            "inertia": block.inertia / (block.mass * block.radius**2),
            "base_mass": scene.base.mass / block.mass if scene.base else math.inf,
        }
        for name, value in values.items():
            assert RANGE[name][0] * (1 - 1e-12) <= value <= RANGE[name][1] * (1 + 1e-12), (scene.name, name)


@pytest.mark.parametrize("quick, scenes, most", [(True, None, 20), (True, 40, 40), (False, 3, 3)])
def test_the_number_of_scenes_is_what_the_user_asks_for(quick, scenes, most):
    batch = next(plan(Ask((ENGINE,), quick), seed=5, scenes=scenes))
    engine = ENGINES[ENGINE]
    others = min(most, max(5, most // 5))
    for variant in engine.variants:
        drawn = [case for case in batch.cases if case.variant == variant]
        assert 0 < len(drawn) <= (most if variant == engine.default_variant else others)
        assert all(case.scene.digest() == random_scene(5, case.tag["index"]).digest() for case in drawn)


def test_tables_and_marks_count_the_stored_rows(result):
    study = get_study("random-scenes")
    classes = {}
    for row in result.rows:
        classes.setdefault(f"{row['engine']}, {row['variant']}", Counter())[row["class"]] += 1
    page = study.page(result)
    for section in (page.whole(), page.opening()):
        table = section.tables[0]
        assert [row[0] for row in table.rows] == list(classes)
        for name, _, right, differs, failed, left_out, share in table.rows:
            count = classes[name]
            assert [int(right), int(differs), int(failed), int(left_out)] == [
                count[word] for word in ("right", "differs", "failed", "left out")
            ]
            judged = count.total() - count["left out"]
            assert number_in(share) == pytest.approx(100 * count["right"] / judged, rel=0.06)
    marks = study.judgement(result).marks
    for (engine, variant), mark in marks.items():
        count = classes[f"{engine}, {variant}"]
        assert mark.words == f"{count['right']} of {count.total() - count['left out']}"
        assert mark.note == f"{count['failed']} failed"


def test_every_run_that_failed_is_evidence_and_every_tuned_one_that_differs_is_named(result):
    section = get_study("random-scenes").page(result).whole()
    assert len(section.evidence) == sum(row["class"] == "failed" for row in result.rows)
    differ = [row for row in result.rows if row["class"] == "differs" and row["tier"] != "defaults"]
    named = section.tables[1].rows if len(section.tables) > 1 else []
    assert [(row[0], int(row[1])) for row in named] == [
        (f"{row['engine']}, {row['variant']}", row["index"]) for row in differ
    ]
