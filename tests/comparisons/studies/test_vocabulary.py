"""Every column of the studies' rows is explained, and every explained one is a column."""

from collections import Counter

import pytest
from answered import answered, by_model
from record_files import pairs
from table_tests import published

from comparisons.running.by_solver import read, results_in
from comparisons.running.plan import Request
from comparisons.running.provenance import RESULTS
from comparisons.studies import BUILT_IN, TOLERANCES, get_study
from comparisons.studies.explained import SHARED
from comparisons.studies.shake_table import campaign
from comparisons.studies.vocabulary import OWN, columns_of
from engines import installed_engines

# Of no stored result: an impact about which nothing can be determined.
UNSEEN = {"restitution": {"why_not"}}
FAILED = {"kind": "solver", "reason": "the solver gave up", "message": "no convergence"}
UNSEEN_OF_ANY = {"exit_code", "time_limit"}  # of failures that no stored run had


@pytest.fixture(scope="module")
def patch():
    with pytest.MonkeyPatch.context() as patch:
        yield patch


@pytest.fixture(scope="module")
def columns(tmp_path_factory, patch):
    """{study: columns of its rows}; those of recorded motions and of a shake table are made up here, too."""
    folder = str(pairs(tmp_path_factory.mktemp("records"), 2))
    ask = Request(installed_engines()[:1], quick=True)
    recorded = answered(get_study("recorded").plan(ask, records=folder), by_model(history=True))[-1].rows
    tests = str(published(tmp_path_factory.mktemp("table")))
    patch.setattr(campaign, "GRID", 5)
    last = get_study("shake-table").plan(Request(ask.engines), data=tests)
    shaken = answered(last, by_model(failure=lambda case: FAILED if case.solver != "analytic" else None))[-1].rows
    found = {"recorded": set().union(*recorded), "shake-table": set().union(*shaken)}
    for result in map(read, results_in(RESULTS)):
        found.setdefault(result.kind, set()).update(*result.rows)
    return found


@pytest.mark.slow
def test_every_column_is_explained(columns):
    for kind, own in columns.items():
        known = columns_of(kind)
        assert own and own <= known.keys() and all(one.what and one.unit for one in known.values()), kind


@pytest.mark.slow
def test_every_explained_column_is_one(columns):
    assert {*BUILT_IN, TOLERANCES} == set(OWN)
    for kind, own in OWN.items():
        assert own.keys() - columns[kind] == UNSEEN.get(kind, set()), kind
    uses = Counter(column for found in columns.values() for column in found)
    assert {column for column in SHARED if uses[column] < 2} == UNSEEN_OF_ANY  # else it is one study's own
