"""A result as one file for each solver: an engine by itself is as if all had been computed at once, or nothing is
written."""

import json
import shutil
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from answered import answered, by_model, edit
from fake_study import MADE

from analytic.errors import SettingError
from comparisons.execution.by_solver import (
    MODEL,
    age,
    check_same,
    checked,
    differences,
    joined,
    last_check,
    opened,
    read,
    results_in,
    split,
)
from comparisons.execution.cases import name_of
from comparisons.execution.code_digests import source_digests
from comparisons.execution.plan import Request, Study
from comparisons.execution.results import RESULTS, ResultError, made_here, read_result, save
from comparisons.execution.runner import RUNS, check, check_all, compute
from comparisons.report.answer import origin_of
from comparisons.report.gallery import origins
from comparisons.studies import BUILT_IN, get_study
from comparisons.studies.overturning import study as overturning
from engines import ENGINES

FIRST, SECOND = "pybullet", "exudyn"
MADE_ONCE = pytest.mark.xdist_group("by-solver")  # what several tests need


def computed(folder, *engines, **options):
    (path,) = compute(MADE, folder, engines=engines, workers=1, progress=False, **options)
    return path


@pytest.fixture(scope="module")
def single(tmp_path_factory):
    """The result of the first engine alone, of blocks of 2 kg; its folder keeps the runs."""
    return computed(tmp_path_factory.mktemp("single") / "runs", FIRST, mass=2.0)


@pytest.fixture
def copy(single, tmp_path):
    """A copy of it, and of its runs."""
    return shutil.copytree(single.parent, tmp_path / "runs") / single.name


@pytest.fixture
def both(copy):
    """Beside it, the second engine."""
    return computed(copy.parent, SECOND)


@MADE_ONCE
def test_one_engine_then_another_is_both_at_once(both, tmp_path):
    (tmp_path / "whole").mkdir()
    shutil.copy(both.with_name(RUNS), tmp_path / "whole")  # runs of both by now
    whole, result = read(computed(tmp_path / "whole", FIRST, SECOND, mass=2.0)), read(both)
    assert {file.name for file in both.glob("*.json")} == {"analytic.json", f"{FIRST}.json", f"{SECOND}.json"}
    assert not list(differences("rows", whole.rows, result.rows))
    assert whole.settings == result.settings and set(whole.settings["engines"]) == {FIRST, SECOND}
    assert whole.arrays.keys() == result.arrays.keys()
    for name, array in whole.arrays.items():
        np.testing.assert_array_equal(array, result.arrays[name])
    assert (result.run_count, len(result.runs)) == (whole.run_count, len(whole.runs)) == (6, 6)
    assert check(both, 30, 1, workers=1, progress=False).held == 6


@MADE_ONCE
def test_the_files_of_others_stay_byte_for_byte(copy, both):
    kept = {file: file.read_bytes() for file in both.iterdir() if file.stem != SECOND}
    edit(both / f"{SECOND}.json", lambda content: content["rows"].pop())
    computed(both.parent, SECOND)
    assert {file: file.read_bytes() for file in both.iterdir() if file.stem != SECOND} == kept
    assert len(read_result(both / f"{SECOND}.json").rows) == 3 and all(
        row["engine"] == SECOND for row in read_result(both / f"{SECOND}.json").rows
    )


@pytest.mark.slow
@MADE_ONCE
def test_without_engines_all_is_computed_and_files_of_others_go(both):
    compute(MADE, both.parent, engines=None, workers=1, progress=False)  # of 1 kg, of all that are installed
    assert read(both).settings["mass"] == 1.0 and len(list(both.glob("*.json"))) > 3
    stale = save(both / "gone.json", read_result(both / f"{SECOND}.json"))
    compute(MADE, both.parent, engines=None, workers=1, progress=False)
    assert not stale.exists() and (both / f"{SECOND}.json").exists()


@MADE_ONCE
def test_each_file_says_where_it_comes_from_and_is_judged_by_that(both):
    result = read(both)
    plan, first, second = name_of(MADE.plan), ENGINES[FIRST].adapter, ENGINES[SECOND].adapter
    second_origin, first_origin = (result.provenance["engines"][name] for name in (SECOND, FIRST))
    assert (
        [*second_origin["sources"]] == [plan, second]
        and [*first_origin["sources"]] == [plan, first]
        and age(result) is None
    )
    assert not {first, second} & result.provenance["sources"].keys()
    assert second_origin["packages"].keys() == {"numpy", "scipy", "numba", SECOND}
    assert result.provenance["packages"].keys() == {"numpy", "scipy", "numba"}
    second_origin |= {"time": "2030-02-03T00:00:00+00:00", "commit": "f" * 40, "dirty": False}
    assert f"; {SECOND}: 2030-02-03, commit ffffffffffff, " in origin_of(result)
    assert f"; {SECOND}: 2030-02-03 | " in origins({"made": result})
    variants = source_digests([second])[f"{second}.VARIANTS"]
    second_origin["sources"][second] = second_origin["sources"][second].replace(variants, "")
    assert age(result) == (
        f"in the rows of {SECOND} older than the code: computed on 2030-02-03 at commit fffffff; since then changed: "
        f"{second}.VARIANTS"
    )
    result.provenance["packages"]["numpy"] = "1.0"
    assert "; computed with other versions than those here: numpy" in age(result)


@MADE_ONCE
@pytest.mark.parametrize(
    "spoil, words",
    [
        (lambda result: result["rows"][1].update(tilt=9.0), r"rows\[1\]\.tilt: stored 9, now 0\.05"),
        (lambda result: result["rows"][0].update(starts=[1.0]), r"rows\[0\]\.starts\[0\]: stored 1, now 0\.05"),
        (lambda result: result["rows"].pop(0), r"rows\[0\]"),
        (lambda result: result["settings"].update(note=1), "settings.note: stored 1, now None"),
        (lambda result: result["settings"]["variants"].pop(), r"settings.variants\[0\]: stored None"),
        (lambda result: result["provenance"].update(seed=4), "seed: stored 4, now 3"),
    ],
)
def test_where_anything_of_the_model_has_changed_nothing_is_written(copy, spoil, words):
    before = edit(copy / f"{MODEL}.json", spoil).read_bytes()
    with pytest.raises(ResultError, match=f"{words}.* nothing was written: rocking study made without --engine"):
        computed(copy.parent, SECOND)
    assert (copy / f"{MODEL}.json").read_bytes() == before and not (copy / f"{SECOND}.json").exists()


@MADE_ONCE
def test_an_array_of_the_model_that_has_changed_is_named(copy):
    old = read_result(copy / f"{MODEL}.json")
    old.arrays["swings/analytic/tilt"][0] += 1e-6
    save(copy / f"{MODEL}.json", old)
    with pytest.raises(ResultError, match="array swings/analytic/tilt: stored"):
        computed(copy.parent, SECOND)


@MADE_ONCE
@pytest.mark.parametrize(
    "spoil, words",
    [
        (
            lambda result: result["settings"].update(mass=3.0),
            r"asked otherwise than analytic.json \(mass: 2 there, 3 here",
        ),
        (
            lambda result: result["settings"].update(note=1),
            r"asked otherwise than analytic.json \(note: None there, 1 here",
        ),
        (lambda result: result["settings"].pop("quick"), "asked otherwise than analytic.json .quick"),
        (lambda result: result["settings"].update(engines=["another"]), "asked otherwise .*engines"),
        (lambda result: result["provenance"].update(seed=4), r"asked otherwise than analytic.json \(seed: 3 there, 4"),
        (lambda result: result.update(kind="other"), "a result of other, beside one of made"),
        (lambda result: result["rows"][0].update(variant="more"), "has rows of a variant .*: more"),
    ],
)
def test_a_file_that_does_not_belong_to_the_others_is_refused(both, spoil, words):
    edit(both / f"{SECOND}.json", spoil)
    with pytest.raises(
        ResultError, match=f"^made/{SECOND}.json: {words}.*; run the study with --engine {SECOND} again"
    ):
        read(both)


@MADE_ONCE
def test_a_folder_that_is_no_result_or_is_one_itself_says_what_to_do(copy):
    itself = r"--output .*made: is itself a result; give the folder that it lies in, .*runs$"
    for work in (lambda: computed(copy, SECOND), lambda: check_all("made", copy, 1, 1)):
        with pytest.raises(SettingError, match=itself):
            work()
    (copy / f"{MODEL}.json").unlink()
    for folder, words in (
        (copy, "^made/analytic.json: missing; run the study again"),
        (copy.parent / "none", "^none: no such result; run the study that writes it"),
        (copy.parent, "^runs: holds results, and is none; give one of its folders, such as made"),
    ):
        with pytest.raises(ResultError, match=words):
            read(folder)


@MADE_ONCE
def test_a_study_that_is_computed_as_a_whole_removes_no_engine_unasked(both):
    whole = replace(MADE, whole="costs are compared")
    before = {file: file.read_bytes() for file in both.iterdir()}
    with pytest.raises(SettingError, match=f"made is computed as a whole, and .* holds {FIRST}, which would go; name"):
        compute(whole, both.parent, engines=[SECOND], workers=1, progress=False)
    assert {file: file.read_bytes() for file in both.iterdir()} == before
    compute(whole, both.parent, engines=[FIRST, SECOND], workers=1, progress=False)


@MADE_ONCE
def test_a_check_that_is_recorded_takes_the_place_of_all_before(both):
    for file, held in (("analytic", 30), (FIRST, 1)):
        edit(
            both / f"{file}.json",
            lambda content, held=held: content["provenance"].update(
                check={"runs": held, "held": held, "date": "2020-01-01", "commit": None, "dirty": False, "seed": 1}
            ),
        )
    outcome = check(both, 2, 1, record=True, workers=1, progress=False)
    assert checked(read(both)).items() >= {"runs": 2, "held": outcome.held, "seed": 1}.items()
    assert "2020" not in last_check(read(both))


@MADE_ONCE
def test_a_result_is_asked_what_it_was_asked(single):
    for options in ({}, {"mass": 2.0}):
        assert opened(MADE, single, False, options)[1:] == (False, {"mass": 2.0})
    for study, quick, options, error, words in (
        (MADE, False, {"mass": 3.0}, SettingError, "--mass 3.0: .* was computed with 2.0; leave it out"),
        (MADE, True, {}, SettingError, "--quick: .* was computed in full; leave it out"),
        (Study("other", "", MADE.plan), False, {}, ResultError, "holds a result of made; give another --output"),
    ):
        with pytest.raises(error, match=words):
            opened(study, single, quick, options)
    assert opened(get_study("recorded"), RESULTS / "recorded", False, {"records": "mine"})[2] == {"records": "mine"}


@pytest.mark.parametrize("path", results_in(RESULTS), ids=lambda path: path.name)
def test_every_stored_result_is_the_sum_of_its_files(path):
    parts = {file.stem: read_result(file) for file in path.glob("*.json")}
    whole = read(path)
    again = joined(parts | split(whole, parts.keys() - {MODEL}) | {MODEL: parts[MODEL]})
    assert again.rows == whole.rows and again.settings == whole.settings and again.arrays.keys() == whole.arrays.keys()
    for solver, part in split(whole, parts.keys() - {MODEL}).items():
        own_part = parts[solver]
        assert (part.rows, part.settings, part.runs) == (own_part.rows, own_part.settings, own_part.runs)
        assert part.arrays.keys() == own_part.arrays.keys()


FALLEN = {"kind": "crash", "reason": "fell over", "message": ""}
GRID = overturning.Grid(("rigid ground",), ("one-sine",), (2.0,), (2.0, 6.0), (4, 3), slice(1, 2))
SMALL: dict[str, dict[str, Any]] = {
    "restitution": {},
    "statues": {"boundaries": 1, "sliders": 80},
    "stability": {"names": ("zeno",)},
    "overturning": {"grid": GRID},
    "fragility": {"scenes": {"free-standing": ("caryatid-rigid", (0.15, 0.3))}, "runs": (40, 3, 1)},
    "sensitivity": {"scenes": {"free-standing": ("caryatid-rigid", (0.2,))}, "motions": (8, 2, 1)},
    "mistakes": {},
    "stack": {"size": (1, (), 1.8, 1)},
}
DEAR = {"restitution": "long", "statues": "long", "sensitivity": "slow", "mistakes": "long"}
# an engine's row is made of its own runs alone; of the second by test_shake_table.py, with tests made up
OF_MOTIONS = ("recorded", "shake-table")


def test_every_study_takes_one_engine_or_says_why_not():
    assert {name for name in BUILT_IN if not get_study(name).whole} == {*SMALL, *OF_MOTIONS}


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=getattr(pytest.mark, DEAR[name]) if name in DEAR else ()) for name in SMALL]
)
def test_no_row_of_a_study_that_takes_one_engine_hangs_on_another(name, monkeypatch):
    """The plan, answered by the model in each engine's place: two engines at once, and one after the other."""
    monkeypatch.setattr("comparisons.studies.mistakes.study.QUICK", ())  # scripts are run: those as they are suffice
    study = get_study(name)
    # of the stability of engines other measures are taken
    run = by_model(history=True, failure=lambda case: None if case.solver == "analytic" else FALLEN)

    def result_of(*engines):
        plan = study.plan(Request(engines, True), **SMALL[name])
        answer = answered(plan, run if name == "stability" else by_model())[-1]
        roots = ["analytic", name_of(study.plan), *(ENGINES[engine].adapter for engine in engines)]
        return made_here(name, answer.settings, answer.rows, answer.arrays, modules=roots, seed=answer.seed)

    def alike(rows, other_rows):
        assert sorted(map(json.dumps, rows)) == sorted(map(json.dumps, other_rows))

    whole, old, new = result_of(FIRST, SECOND), result_of(FIRST), result_of(SECOND)
    parts = split(old, [FIRST]) | {SECOND: split(new, [SECOND])[SECOND]}
    check_same(study, parts[MODEL], new, [SECOND])
    together = joined(parts)
    alike(whole.rows, together.rows)
    for key in ("variants", "engines", "faults"):
        alike(whole.settings.pop(key, ()), together.settings.pop(key, ()))
    assert together.settings == whole.settings and together.arrays.keys() == whole.arrays.keys()
    for key, array in whole.arrays.items():
        np.testing.assert_array_equal(array, together.arrays[key])
