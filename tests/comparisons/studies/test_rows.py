"""Studies declare their rows, and each column is explained; a row that is not so is named with its remedy."""

import dataclasses
import shutil
from collections import Counter

import pytest
from answered import answered, by_model, edit
from made_up_shake_table import published
from record_files import pairs

from comparisons.execution.by_solver import read, results_in
from comparisons.execution.cases import name_of
from comparisons.execution.code_digests import source_digests
from comparisons.execution.plan import Request
from comparisons.execution.results import RESULTS, Result, ResultError, read_result, write_result
from comparisons.metrics.agreement import TABLE
from comparisons.plotting.parts import where
from comparisons.schemas.columns import TYPES, Declaration, declared, number_of
from comparisons.studies import BUILT_IN, STUDIES, TOLERANCES, get_study, study_names
from comparisons.studies.rows import SHARED, columns_of, fields_of, read_study, wrong_with
from comparisons.studies.shake_table import campaign
from engines import installed_engines

CELL = {**{"part": "order", "engine": "exudyn", "variant": "step", "ground": "rigid ground"}, "order": 2.0}


@pytest.mark.parametrize("file", results_in(RESULTS), ids=lambda path: path.name)
def test_rows_of_every_stored_result_are_those_of_its_study(file):
    result = read_study(file)
    assert result.rows == read(file).rows and get_study(result.kind).parts
    assert all(isinstance(words, str) for words in get_study(result.kind).problems(result))


def test_every_study_declares_rows_of_columns_that_are_explained():
    for kind in STUDIES:
        study, known = get_study(kind), columns_of(kind)
        assert study.parts and all(
            known.keys() >= columns.keys() for part in study.parts.values() for columns in fields_of(part)
        ), kind
        assert all(
            column.declaration.meaning and set(column.declaration.type.split(" or ")) <= TYPES.keys()
            for column in known.values()
        )


@pytest.mark.parametrize(
    "change, words",
    [
        ({"part": "ordre"}, "part = 'ordre' is none of cell, summary, order, "),
        ({"part": ["order"]}, r"part = \['order'\] is none of "),
        ({"order": ...}, "column 'order' is missing"),
        ({"engine": None}, "column 'engine' is null"),
        ({"engine": 3}, "column 'engine' = 3 is no word"),
        ({"order": "2.0"}, "column 'order' = '2.0' is no number"),
        ({"order": True}, "column 'order' = True is no number"),
        ({"runs": 2.0}, "column 'runs' = 2.0 is no whole number"),
        ({"tag": [1]}, r"column 'tag' = \[1\] is no table"),
        ({"of": []}, r"column 'of' = \[\] is no number or word"),
        ({"oder": 2.0}, "column 'oder' = 2.0 is none of this study"),
    ],
)
def test_a_row_that_is_not_as_declared_is_named_with_its_place_and_the_remedy(tmp_path, change, words):
    row = {name: value for name, value in {**CELL, **change}.items() if value is not ...}
    path = write_result(tmp_path / "r.json", "restitution", {}, [CELL, row], modules=["analytic.errors"])
    with pytest.raises(ResultError, match=rf"^r\.json, row 2: {words}.*; run rocking study restitution again$"):
        read_study(path)
    assert read_result(path).rows[0] == CELL  # as whole as it was written


@pytest.mark.parametrize("more", [{"order": None}, {"order": 2}, {"runs": 4, "of": "all"}, {"failure": None}])
def test_null_where_it_may_be_and_further_columns_of_the_study_are_taken(more):
    assert wrong_with(CELL | more, "restitution") is None


def test_a_row_without_numbers_says_why_and_needs_no_more():
    row = {"part": "run", "engine": "exudyn", "variant": "x", "tier": "tuned", "index": 3, "friction": None}
    row |= {"class": "failed", "comparable": "yes"}
    assert wrong_with(row, "statues") == "column 'differences' is missing"
    assert wrong_with(row | {"failure": {"kind": "crash"}}, "statues") is None


def test_a_result_of_another_study_is_refused_by_name_and_a_foreign_one_is_not_looked_at(tmp_path):
    path = write_result(tmp_path / "r.json", "swings", {}, [{"height": "high"}], modules=["analytic.errors"])
    assert read_study(path).rows == [{"height": "high"}] and read_study(path, "swings").kind == "swings"
    with pytest.raises(ResultError, match=r"r\.json: a result of swings; give one that rocking study statues wrote"):
        read_study(path, "statues")


def test_a_number_changed_in_a_stored_result_is_seen(tmp_path):
    """By the digest; by one who makes it anew it is not, and cannot be."""
    path = shutil.copytree(RESULTS / "restitution", tmp_path / "restitution")
    file = path / "exudyn.json"
    text, rms = file.read_text(), read_result(file).rows[0]["rms"]
    assert f'"rms": {rms},' in text
    file.write_text(text.replace(f'"rms": {rms},', f'"rms": {rms * 1.001:.5g},', 1))
    with pytest.raises(ResultError, match=r"restitution/exudyn\.json: damaged"):
        read_study(path)
    file.write_text(text)
    edit(file, lambda content: None)
    assert rms == where(read_study(path).rows, engine="exudyn")[0]["rms"]


def test_a_wrong_row_is_named_by_its_file_and_its_place_there(tmp_path):
    path = shutil.copytree(RESULTS / "restitution", tmp_path / "restitution")
    edit(path / "pybullet.json", lambda content: content["rows"][4].update(ground=7))
    with pytest.raises(ResultError, match=r"^restitution/pybullet\.json, row 5: column 'ground' = 7 is no word"):
        read_study(path)


def test_a_type_is_that_of_json():
    assert Declaration("what").holds(1) and Declaration("what").holds(1.5) and not Declaration("what").holds(True)
    assert Declaration("what", type="number or list").holds([]) and not Declaration("what", type="flag").holds(1)


def test_a_unit_a_name_and_digits_are_those_of_the_declaration_wherever_a_column_is_shown():
    time = number_of("time", "time", "of an impact", "s", shown="ms", digits=3, within="range")
    row = {"time": 0.25, "range": [0.2, 0.3]}
    assert (time.head, time.text(row), time.of({})) == ("time [ms]", "250 (200 to 300)", None)
    assert (time.called("first").head, time.called("first", digits=1).digits) == ("first [ms]", 1)
    assert number_of("share", "share", "", percent=True).head == "share"
    with pytest.raises(ValueError, match="shown = 'km' of a column in 's': add it to UNITS_SHOWN"):
        number_of("time", "time", "", "s", shown="km")
    with pytest.raises(AssertionError, match="declared twice"):
        declared(time, time)


# Of no stored result: an impact about which nothing can be determined.
UNSEEN = {"restitution": {"why_not"}}
FAILED = {"kind": "solver", "reason": "the solver gave up", "message": "no convergence"}
UNSEEN_OF_ANY = {"exit_code", "time_limit"}  # of failures that no stored run had


@pytest.fixture(scope="module")
def columns(tmp_path_factory):
    """{study: columns of its rows}; those of recorded motions and of a shake table are made up here, too."""
    ask = Request(installed_engines()[:1], quick=True)
    records = str(pairs(tmp_path_factory.mktemp("records"), 2))
    recorded = answered(get_study("recorded").plan(ask, records=records), by_model(history=True))[-1].rows
    last = get_study("shake-table").plan(Request(ask.engines), data=str(published(tmp_path_factory.mktemp("table"))))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(campaign, "GRID", 5)
        shaken = answered(last, by_model(failure=lambda case: FAILED if case.solver != "analytic" else None))[-1].rows
    found = {"recorded": set().union(*recorded), "shake-table": set().union(*shaken)}
    for result in map(read, results_in(RESULTS)):
        found.setdefault(result.kind, set()).update(*result.rows)
    return found


@pytest.mark.slow
def test_every_column_is_explained_and_every_explained_one_is_a_column(columns):
    assert {*STUDIES} == columns.keys()
    for kind, own in columns.items():
        known = columns_of(kind)
        assert own and own <= known.keys() and own, kind
        assert known.keys() - SHARED.keys() - own == UNSEEN.get(kind, set()), kind
    uses = Counter(column for found in columns.values() for column in found)
    assert {column for column in SHARED if uses[column] < 2} == UNSEEN_OF_ANY  # else it is one study's own


@pytest.mark.parametrize("name", BUILT_IN)
def test_what_shows_is_no_part_of_what_a_result_depends_on(name):
    behind = source_digests([name_of(get_study(name).plan)])
    assert behind and not [module for module in behind if module.endswith(".page") or ".plotting" in module]


@pytest.mark.parametrize("found, bound, holds", [(0.1, 0.2, "yes"), (0.3, 0.2, "no"), (0.1, None, "no bound stated")])
def test_a_tolerance_that_does_not_hold_is_said(found, bound, holds):
    row = {"part": "tolerance", **dataclasses.replace(TABLE[0], bound=bound).result(found, None)}
    page = get_study(TOLERANCES).page(Result(TOLERANCES, {}, [row], {}))
    assert page.whole().tables[0].rows[0][7] == holds
    assert ("1 of 1 do not hold" in page.title) == (holds == "no")


def test_tolerances_are_no_study_and_who_asks_for_them_as_one_is_told_the_command(rocking, tmp_path):
    status, out, err = rocking("study", "tolerances", "--output", tmp_path / "study")
    assert status == 2 and "rocking verify --output DIR measures and writes it" in err
    assert "tolerances" not in study_names() and not (tmp_path / "study").exists()
