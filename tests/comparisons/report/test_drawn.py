"""What all pages show of made-up rows is what they showed: each word, cell and tooltip, and each picture."""

import re

import pytest
from drawn import PAGES, drawn

from comparisons.studies import BUILT_IN


@pytest.mark.parametrize("name", sorted(file.stem for file in PAGES.glob("*.txt")))
def test_it_shows_what_it_showed(name):
    """Renewed, where a change is meant, by `python tests/drawn.py`, which prints what it changes."""
    assert drawn()[name].splitlines() == (PAGES / f"{name}.txt").read_text(encoding="utf-8").splitlines()


def test_every_study_has_its_rows_and_none_of_them_is_refused():
    studies = {name for name in BUILT_IN if any(page.startswith(name) for page in drawn())}
    assert studies == set(BUILT_IN) and drawn().keys() == {file.stem for file in PAGES.glob("*.txt")}
    assert not [name for name, text in drawn().items() if "cannot be shown" in text]


OTHERWISE = re.compile(r"\d[eE][-+]?\d|\b[a-zA-Z]_[a-zA-Z]\b|\bNone\b|\bnan\b")
AS_TYPED = ("[href]", "[data", "[drawn]", "rocking ", " = ", "message: ", "': ")  # a command; settings; evidence


def test_numbers_and_symbols_are_written_as_a_reader_does():
    for name, text in drawn().items():
        words = [line for line in text.splitlines() if not any(part in line for part in AS_TYPED)]
        assert not list(filter(OTHERWISE.search, words)), name
