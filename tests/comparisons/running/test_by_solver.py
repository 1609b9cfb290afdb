"""An engine computed anew into a stored result: as if all had been computed at once, or nothing is written."""

import json
import shutil
from typing import Any

import numpy as np
import pytest
from answered import answered, by_model, edit
from comparisons.running.merge import _joined, engine_of, merged, opened
from fake_study import MADE

from analytic.errors import SettingError
from comparisons.report.answer import origin_of
from comparisons.report.gallery import origins
from comparisons.running.age import age
from comparisons.running.cases import name_of
from comparisons.running.check import check, differences
from comparisons.running.plan import Request, Study
from comparisons.running.provenance import RESULTS, ResultError, made_here, read_result, save
from comparisons.running.sources import source_digests
from comparisons.running.study import RUNS, compute
from comparisons.studies import BUILT_IN, get_study
from comparisons.studies.overturning import study as overturning
from engines import ENGINES

FIRST, SECOND = "pybullet", "exudyn"
MADE_ONCE = pytest.mark.xdist_group("merge")  # what several tests need


def computed(folder, *engines, **options):
    (path,) = compute(MADE, folder, engines=engines, workers=1, progress=False, **options)
    return path


def ordered(array):
    return array[np.lexsort(array.T)]


@pytest.fixture(scope="module")
def one(tmp_path_factory):
    """The result of the first engine alone, of blocks of 2 kg."""
    return computed(tmp_path_factory.mktemp("one") / "runs", FIRST, mass=2.0)


@pytest.fixture
def both(one, tmp_path):
    """Into a copy of it, the second engine; its folder keeps the runs."""
    path = save(tmp_path / "made.json", read_result(one))
    return computed(one.parent, SECOND, into=path)


@MADE_ONCE
def test_one_engine_then_another_is_both_at_once(one, both, tmp_path):
    (tmp_path / "whole").mkdir()
    shutil.copy(one.with_name(RUNS), tmp_path / "whole")  # runs of both by now
    whole, found = read_result(computed(tmp_path / "whole", FIRST, SECOND, mass=2.0)), read_result(both)
    assert not list(differences("rows", whole.rows, found.rows))
    assert whole.settings == found.settings and whole.settings["engines"] == [FIRST, SECOND]
    assert whole.arrays.keys() == found.arrays.keys()
    for name, array in whole.arrays.items():
        np.testing.assert_array_equal(
            *map(ordered, (array, found.arrays[name])) if name == "points" else (array, found.arrays[name])
        )
    assert (found.run_count, len(found.runs)) == (whole.run_count, len(whole.runs)) == (6, 6)
    assert check(both, 30, 1, workers=1, progress=False).held == 6
    assert read_result(one).rows == [row for row in found.rows if row.get("engine") != SECOND]


@MADE_ONCE
def test_the_engine_says_where_it_comes_from_and_is_judged_by_that(one, both):
    before, found = read_result(one), read_result(both)
    rest, (own,) = found.provenance, found.provenance["engines"].values()
    assert rest["time"] == before.provenance["time"] and own["time"] >= rest["time"] and age(found) is None
    plan, first, second = name_of(MADE.plan), ENGINES[FIRST].adapter, ENGINES[SECOND].adapter
    assert first in rest["sources"] and second not in rest["sources"] and [*own["sources"]] == [plan, second]
    assert own["packages"].keys() == {"numpy", "scipy", "numba", SECOND} and SECOND not in rest["packages"]
    own |= {"time": "2030-02-03T00:00:00+00:00", "commit": "f" * 40, "dirty": False}
    assert f"; {SECOND}: 2030-02-03, commit ffffffffffff, " in origin_of(found)
    assert f"; {SECOND}: 2030-02-03 | " in origins({"made": found})
    variants = source_digests([second])[f"{second}.VARIANTS"]
    own["sources"][second] = own["sources"][second].replace(variants, "")
    assert age(found) == (
        f"in the rows of {SECOND} older than the code: computed on 2030-02-03 at commit fffffff; since then changed: "
        f"{second}.VARIANTS"
    )
    rest["packages"]["numpy"] = "1.0"
    assert age(found).startswith(f"apart from the rows of {SECOND} computed with other versions than those here: numpy")


@MADE_ONCE
def test_rows_of_an_engine_are_put_right_and_others_stay_byte_for_byte(one, both):
    right = both.read_text().splitlines()

    def spoil(content):
        for row in content["rows"]:
            row |= {"tilt": 9.0} if row.get("engine") == FIRST else {}
        content["rows"].insert(2, {"part": "swing", "engine": FIRST, "start": 0.07, "tilt": 1.0})

    edit(both, spoil)
    assert both.read_text() != "\n".join(right)
    computed(one.parent, FIRST, into=both)
    found = both.read_text().splitlines()
    begin = right.index(' "rows": [')
    assert [json.loads(line.strip(" ,")) for line in found[-len(right) + begin + 1 : -2]] == read_result(both).rows
    rows = [
        [line for line in lines[lines.index(' "rows": [') :] if f'"{FIRST}"' not in line] for lines in (right, found)
    ]
    assert rows[0] == rows[1]
    assert found[found.index(' "rows": [') :] == right[begin:]  # its own too: runs are kept, with what they took
    assert read_result(both).provenance["engines"].keys() == {FIRST, SECOND}


@MADE_ONCE
@pytest.mark.parametrize(
    "spoil, words",
    [
        (lambda found: found["rows"][1].update(tilt=9.0), r"rows, 2 \(swing, analytic\)\.tilt: stored 9, now 0\.05"),
        (lambda found: found["rows"][0].update(starts=[1.0]), r"rows, 1 \(starts\)\.starts\[0\]: stored 1, now 0\.05"),
        (lambda found: found["rows"].pop(0), "rows: how many there are of the model and of no solver: stored 2, now 3"),
        (lambda found: found["settings"].update(note=1), "note: stored 1, now None"),
        (lambda found: found["settings"]["variants"].pop(), "variants: how many"),
        (lambda found: found["provenance"].update(seed=4), "seed: stored 4, now 3"),
    ],
)
def test_where_anything_else_has_changed_nothing_is_written(one, both, spoil, words):
    before = edit(both, spoil).read_bytes()
    with pytest.raises(ResultError, match=f"{words}.* nothing was written: rocking study made without --into"):
        computed(one.parent, SECOND, into=both)
    assert both.read_bytes() == before


@MADE_ONCE
def test_an_array_of_the_model_that_has_changed_is_named(one, tmp_path):
    old = read_result(one)
    old.arrays["swings/analytic/tilt"][0] += 1e-6
    path = save(tmp_path / "made.json", old)
    with pytest.raises(ResultError, match="array swings/analytic/tilt: stored"):
        computed(one.parent, SECOND, into=path)


@MADE_ONCE
def test_a_result_is_asked_what_it_was_asked(one, tmp_path):
    assert opened(MADE, one, False, {})[1:] == (False, {"mass": 2.0})
    assert opened(MADE, one, False, {"mass": 2.0})[1:] == (False, {"mass": 2.0})
    with pytest.raises(SettingError, match="--mass 3.0: .* was computed with 2.0; leave it out"):
        opened(MADE, one, False, {"mass": 3.0})
    with pytest.raises(SettingError, match="--quick: .* was computed in full; leave it out"):
        opened(MADE, one, True, {})
    with pytest.raises(ResultError, match="a result of made; give one that rocking study other wrote"):
        opened(Study("other", "", MADE.plan), one, False, {})
    with pytest.raises(SettingError, match="study made cannot take one engine by itself: of one piece"):
        opened(Study("made", "", MADE.plan, whole="of one piece"), one, False, {})
    random = read_result(RESULTS / "random-scenes.json")
    seeded = save(tmp_path / "random-scenes.json", random)
    drawn = {"seed": random.provenance["seed"], "scenes": 500}
    assert opened(get_study("random-scenes"), seeded, False, {})[2] == drawn and drawn["seed"] > 0
    recorded = save(tmp_path / "recorded.json", read_result(RESULTS / "recorded.json"))
    assert opened(get_study("recorded"), recorded, False, {"records": "mine"})[2] == {"records": "mine"}


@pytest.mark.slow
@MADE_ONCE
def test_random_scenes_take_one_engine_after_the_other(tmp_path):
    study, options = get_study("random-scenes"), {"workers": 2, "progress": False}
    (path,) = compute(study, tmp_path, engines=[FIRST], seed=1, scenes=3, **options)
    first = read_result(path)
    compute(study, tmp_path, engines=[SECOND], into=path, **options)
    found, (whole,) = read_result(path), compute(study, tmp_path, engines=[FIRST, SECOND], seed=1, scenes=3, **options)
    assert found.rows == read_result(whole).rows and len(found.rows) > len(first.rows) > 0
    assert found.settings == read_result(whole).settings and found.run_count == len(found.runs) == len(found.rows)


@pytest.mark.parametrize("file", sorted(RESULTS.glob("*.json")), ids=lambda file: file.stem)
def test_rows_of_every_stored_result_go_back_to_their_places(file):
    """Of every one that takes an engine by itself."""
    result = read_result(file)
    rows = [] if get_study(result.kind).whole else result.rows
    shared = set(map(engine_of, rows)) - set(ENGINES)
    for name in set(map(engine_of, rows)) & set(ENGINES):
        new = [row for row in rows if engine_of(row) in {*shared, name}]
        assert _joined(rows, new, name, shared) == rows
        added = _joined([row for row in rows if engine_of(row) != name], new, name, shared)
        assert sorted(map(json.dumps, added)) == sorted(map(json.dumps, rows))
        assert [row for row in added if engine_of(row) in {*shared, name}] == new


FALLEN = {"kind": "crash", "reason": "fell over", "message": ""}
GRID = overturning.Grid(("rigid ground",), ("one-sine",), (2.0,), (2.0, 6.0), (4, 3), slice(1, 2), 1)
SMALL: dict[str, dict[str, Any]] = {
    "restitution": {},
    "random-scenes": {},
    "sliding": {"scenes": 80},
    "constants": {},
    "stability": {"names": ("zeno",)},
    "overturning": {"grid": GRID},
    "fragility": {"scenes": {"free-standing": ("caryatid-rigid", (0.15, 0.3))}, "runs": (40, 3, 1)},
    "sensitivity": {"scenes": {"free-standing": ("caryatid-rigid", (0.2,))}, "motions": (8, 2, 1)},
    "autopsy": {},
    "sheet": {},
    "mistakes": {},
}
OF_MOTIONS_OR_TOLERANCES = ("recorded", "tolerances")  # a row of an engine there is made of its own run alone


def test_every_study_takes_one_engine_or_says_why_not():
    assert {name for name in BUILT_IN if not get_study(name).whole} == {*SMALL, *OF_MOTIONS_OR_TOLERANCES}


@pytest.mark.parametrize("name", SMALL)
def test_no_row_of_a_study_that_takes_one_engine_hangs_on_another(name, monkeypatch):
    """The plan, answered by the model in each engine's place: two engines at once, and one after the other."""
    monkeypatch.setattr("comparisons.studies.mistakes.study.QUICK", ())  # scripts are run: those as they are suffice
    study = get_study(name)
    # of the stability of engines other measures are taken
    run = by_model(history=True, failure=lambda case: None if case.solver == "analytic" else FALLEN)

    def found(*engines):
        plan = study.plan(Request(engines, True), **SMALL[name])
        answer = answered(plan, run if name == "stability" else by_model())[-1]
        own = ["analytic", name_of(study.plan), *(ENGINES[one].adapter for one in engines)]
        return made_here(name, answer.settings, answer.rows, answer.arrays, modules=own, seed=answer.seed)

    def same(whole, joined):
        assert sorted(map(json.dumps, joined)) == sorted(map(json.dumps, whole))

    whole, old, new = found(FIRST, SECOND), found(FIRST), found(SECOND)
    joined = merged(study, old, new, (SECOND,), {SECOND: 1})
    same(whole.rows, joined.rows)
    same(whole.settings.pop("variants", ()), joined.settings.pop("variants", ()))
    assert joined.settings == whole.settings and joined.arrays.keys() == whole.arrays.keys()
    for key, array in whole.arrays.items():
        pair = array, joined.arrays[key]
        np.testing.assert_array_equal(*map(ordered, pair) if key in study.indexed else pair)
