"""Every row of the tolerance table: the engine is run and held to it."""

import pickle

import pytest
from engine_cases import ACCURATE

from comparisons.measuring import agreement
from comparisons.measuring.tolerances import TABLE
from engines import ENGINES

RUNS, KEPT = {}, {}  # what rows of one variant share; these rows stay on one worker


@pytest.fixture
def shared(monkeypatch):
    """A scene is run once for all rows of a variant."""
    traced = agreement.traced

    def once(engine, variant, scene, history=True):
        asked = engine, variant, pickle.dumps(scene)
        if asked not in KEPT:
            KEPT[asked] = traced(engine, variant, scene)
        return KEPT[asked]

    monkeypatch.setattr(agreement, "traced", once)


DEAR = ("overturning boundary", "synthetic motion", "60 s of shaking")  # of other engines by hand, or `rocking verify`
AGAIN = "2 and 5 times omega_r"  # a boundary whose scenes differ in numbers from those of another row


def marks(row):
    """Main variants of exudyn and PyBullet first; other variants and engines in the second command."""
    long = not ENGINES[row.engine].subject and any(words in row.name for words in DEAR)
    slow = ACCURATE.get(row.engine) != row.variant or AGAIN in row.name
    sets = [pytest.mark.long] * long or [pytest.mark.slow] * slow
    return [pytest.mark.xdist_group(f"{row.engine} {row.variant}"), *sets]


@pytest.mark.parametrize("row", [pytest.param(row, id=row.name, marks=marks(row)) for row in TABLE])
def test_row_of_the_tolerance_table(row, shared):
    value = row.check(RUNS)
    # Much better than when the bound was set: then the bound says nothing any more.
    assert row.round_off or value >= row.measured / 4, f"{row.name}: {value:.3g}; tighten the table"
