"""Every column of the studies' rows is explained, and every explained one is a column."""

from collections import Counter

import pytest
from answered import answered, by_model
from record_files import pairs

from comparisons.running.provenance import RESULTS, read_result
from comparisons.running.study import Ask
from comparisons.running.sweep import Row
from comparisons.studies import BUILT_IN, get_study
from comparisons.studies.vocabulary import OWN, SHARED, columns_of
from engines import installed_engines

# Of no stored result: "matters" with a folder of records; an impact of which nothing can be told.
UNSEEN = {"matters": {"record", "outcomes_changed_by_turning"}, "autopsy": {"why_not"}}


def timed(batch):
    """Made-up rows of the kernel study, of which no result is stored."""
    of_a_problem, of_a_work = {"error": 0.0, "impacts": 1}, {"overturned": 0.0, "runs": 1}
    cost = {"cpu_seconds": 1.0, "elapsed_seconds": 1.0}
    return [
        Row(case, of_a_problem if "tolerance" in case.settings else of_a_work, None, cost, False)
        for case in batch.cases
    ]


@pytest.fixture(scope="module")
def columns(tmp_path_factory):
    """{study: columns of its rows}; those made up here have no stored result."""
    made = {"kernel": kernel_rows(), "recorded": recorded_rows(pairs(tmp_path_factory.mktemp("records"), 2))}
    found = {study: {column for row in rows for column in row} for study, rows in made.items()}
    for file in RESULTS.glob("*.json"):
        result = read_result(file)
        found.setdefault(result.kind, set()).update(column for row in result.rows for column in row)
    return found


def kernel_rows():
    return answered(get_study("kernel").plan(Ask(quick=True)), timed)[-1].rows


def recorded_rows(folder):
    ask = Ask(installed_engines()[:1], quick=True)
    return answered(get_study("recorded").plan(ask, records=str(folder)), by_model(history=True))[-1].rows


def test_every_column_is_explained(columns):
    for kind in columns:
        assert columns[kind] and not columns[kind] - columns_of(kind).keys(), kind


def test_every_explained_column_is_one(columns):
    for kind, own in OWN.items():
        assert own.keys() - columns[kind] == UNSEEN.get(kind, set()), kind
    uses = Counter(column for found in columns.values() for column in found)
    assert not [column for column in SHARED if uses[column] < 2]  # else it is one study's own


def test_all_studies_are_explained():
    assert set(BUILT_IN) == set(OWN)


def test_an_explanation_has_words_and_a_unit():
    for kind in (*OWN, "of another package"):
        assert all(what and unit for what, unit in columns_of(kind).values())
