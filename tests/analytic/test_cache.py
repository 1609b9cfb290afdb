"""The key of a compiled function is what it does: what it reads counts, and nothing else."""

import pytest

from analytic._cache import digest

PLAIN = """
LIMIT = 2.0
def inner(x):
    return x * LIMIT
def make(step):
    def outer(x, least=0.5):
        '''What it does.'''
        return max(inner(x), least) + step + sum([k for k in (1, 2)])
    return outer
outer = make(3)
"""


def key(text):
    scope = {"__name__": "analytic.made"}  # followed as the model's own
    exec(text, scope)
    return digest(scope["outer"])


@pytest.mark.parametrize(
    "before, after",
    [("LIMIT = 2.0", "\nLIMIT = 2.0  # so far"), ("What it does.", "Another sentence."), ("\ndef", "\nOTHER = 1\ndef")],
)
def test_words_lines_and_what_is_not_read_do_not_count(before, after):
    assert key(PLAIN.replace(before, after, 1)) == key(PLAIN)


@pytest.mark.parametrize(
    "before, after",
    [
        ("2.0", "2.5"),
        ("x * LIMIT", "x / LIMIT"),
        ("0.5", "0.6"),
        ("max", "min"),
        ("make(3)", "make(4)"),
        ("1, 2", "1, 3"),
    ],
)
def test_constants_operations_defaults_closures_and_what_is_called_count(before, after):
    assert key(PLAIN.replace(before, after)) != key(PLAIN)
