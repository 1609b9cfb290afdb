"""No two places contradict each other: one rating of a variant everywhere; each number of a title is in a table."""

import itertools
import re

import pytest

from comparisons.report.answer import setups_of
from comparisons.report.studies import stored_studies, variants_of
from comparisons.running.provenance import RESULTS, read_result
from comparisons.studies import BUILT_IN, get_study
from comparisons.studies.restitution.page import rated
from engines import ENGINES

STORED = [name for name in BUILT_IN if (RESULTS / f"{name}.json").exists()]
NUMBER = re.compile(r"(?<![\w.,−·])\d+(?:\.\d+)?(?![\w.])")


@pytest.fixture(scope="module")
def decision():
    """The setups of the first screen from the stored results."""
    stored = stored_studies()
    judgements = [each for one in stored for each in one.judgements]
    return {(one.engine, one.variant): one for one in setups_of(variants_of(stored), judgements)}


def judgements_of(name):
    return get_study(name).judgements(read_result(RESULTS / f"{name}.json"))


def page_of(name):
    return get_study(name).page(read_result(RESULTS / f"{name}.json")).whole()


def numbers_of(tables):
    """Numbers that the cells hold, the number of rows, and of rows whose cells begin alike."""
    found = set()
    for table in tables:
        found |= {number for row in table.rows for cell in row for number in NUMBER.findall(cell)}
        found.add(str(len(table.rows)))
        for column in zip(*table.rows, strict=True):
            found |= {str(column.count(cell)) for cell in set(column)}
            words = {cell.partition(" of ")[0] for cell in column}
            found |= {str(sum(cell.startswith(word) for cell in column)) for word in words if word}
    return found


@pytest.mark.parametrize("name", STORED)
def test_every_number_of_a_title_is_one_of_its_tables(name):
    page = page_of(name)
    known = numbers_of(page.tables)
    if name == "random-scenes":  # its title adds up the tuned engines
        tuned = [row for row in page.tables[0].rows if row[1] == "tuned"]
        right, differs, failed = (sum(int(row[k]) for row in tuned) for k in (2, 3, 4))
        known |= {str(right), str(right + differs + failed), str(failed)}
    if name == "sheet":  # the last row is that of the exact answers
        known.add(str(len(page.tables[0].rows) - 1))
    heads = {
        number for table in page.tables for text in (table.caption, *table.columns) for number in NUMBER.findall(text)
    }
    assert not set(NUMBER.findall(page.title)) - known - heads


def test_the_rating_of_restitution_is_the_same_on_the_first_screen_and_on_its_page(decision):
    words = {"good": "may be trusted", "fair": "is usable", "bad": "is not to be trusted"}
    rows = rated(read_result(RESULTS / "restitution.json"))
    assert len(rows) >= 8
    for row in rows:
        marks = decision[row["engine"], row["variant"]].marks
        assert row["rating"] == words[marks["restitution, free rocking: error, rms"].level]


@pytest.mark.parametrize("name, k", [(name, k) for name in STORED for k, _ in enumerate(judgements_of(name))])
def test_what_a_study_says_on_the_first_screen_stands_in_its_own_tables(name, k):
    judgement = judgements_of(name)[k]
    page = page_of(name)
    marks = {key: mark for key, mark in judgement.marks.items() if key[0] in ENGINES}
    assert marks
    for names, mark in marks.items():
        rows = [row for table in page.tables for row in table.rows if row[0] == ", ".join(filter(None, names))]
        cells = " ".join(itertools.chain.from_iterable(rows))
        first = NUMBER.findall(mark.words)[:1]  # of "36 of 41": the cases are counted elsewhere
        assert rows and set(first) <= set(NUMBER.findall(cells))


def test_the_cheapest_engine_of_the_cost_study_is_one_that_the_first_screen_trusts(decision):
    named = re.search(r"([a-z]+), ([\w-]+), at [\d.]+ times", page_of("speed-error").title)
    assert decision[named[1], named[2]].rating.level in ("good", "part")
